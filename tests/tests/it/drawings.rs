//! The drawing calls of each environment, compared with those in `tests/drawings`.
//!
//! After an intended change, `GYM_UPDATE_DRAWINGS=1 cargo test --package gym-tests --test it
//! drawings` keeps the new ones: look at the pictures (`cargo xtask gif ID`) before that.

use std::path::Path;

use gym::rendering::Recording;
use gym::{Env, EnvExt, Registration, registry};

#[test]
fn drawings_are_as_kept() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("drawings");
    let update = std::env::var_os("GYM_UPDATE_DRAWINGS").is_some();
    // on another engine the drawing code is the same, and the picture is a little off
    let is_other_engine = |id: &str| id.starts_with("rapier/");
    // versions of a MuJoCo task look alike
    let all = registry::self_contained();
    let is_older = |registration: &Registration| {
        registration.source.package == "gym-mujoco" && !registration.id().ends_with("-v5")
    };
    for registration in all
        .iter()
        .filter(|entry| !is_other_engine(entry.id()) && !is_older(entry))
    {
        let id = registration.id();
        let mut env = registration.spec().unwrap().make().unwrap();
        let mut actions = env.action_sampler(0).unwrap();
        env.reset(0).unwrap();
        let mut drawn = String::new();
        // all of CarRacing's field is in sight at first
        let steps = if id.starts_with("CarRacing") { 1 } else { 3 };
        for step in 0..steps {
            let recording = Recording::of(|canvas| env.draw(canvas));
            drawn += &format!("# step {step}\n{recording}\n");
            if env.step(&actions.sample()).unwrap().done() {
                env.reset(()).unwrap();
            }
        }
        // the last picture of an episode, if it is a short one
        if (0..200).any(|_| env.step(&actions.sample()).unwrap().done()) {
            drawn += &format!("# the end\n{}\n", Recording::of(|canvas| env.draw(canvas)));
        }
        let path = folder.join(format!("{}.txt", id.replace('/', "_")));
        if update {
            gym::rendering::file::write(&path, drawn.as_bytes()).unwrap();
        }
        let kept = std::fs::read_to_string(&path).unwrap_or_default();
        for (line, (kept, drawn)) in kept.lines().zip(drawn.lines()).enumerate() {
            assert_eq!(drawn, kept, "{id}, line {}", line + 1);
        }
        assert_eq!(drawn.lines().count(), kept.lines().count(), "{id}");
    }
}
