//! What each environment draws, call by call, beside the calls kept in `tests/drawings`.
//!
//! After an intended change, `GYM_UPDATE_DRAWINGS=1 cargo test --package gym-tests --test drawings` keeps the new
//! ones: look at the pictures (`cargo xtask gif ID`) before that.

use std::path::Path;

use gym::rendering::Recording;
use gym::{Env, registry};

#[test]
fn drawings_are_as_kept() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("drawings");
    let update = std::env::var_os("GYM_UPDATE_DRAWINGS").is_some();
    // on another engine the drawing code is the same, and the picture is a little off
    let is_other_engine = |id: &str| id.starts_with("rapier/");
    for registration in registry::self_contained().iter().filter(|registration| !is_other_engine(registration.id())) {
        let id = registration.id();
        let mut env = registration.spec().unwrap().make().unwrap();
        let mut actions = env.action_sampler(0).unwrap();
        env.reset(0).unwrap();
        let mut drawn = String::new();
        for step in 0..3 {
            let recording = Recording::of(|canvas| env.draw(canvas));
            drawn += &format!("# step {step}\n{recording}\n");
            if env.step(&actions.sample()).unwrap().done() {
                env.reset(()).unwrap();
            }
        }
        let path = folder.join(format!("{}.txt", id.replace('/', "_")));
        if update {
            gym::file::write(&path, drawn.as_bytes()).unwrap();
        }
        let kept = std::fs::read_to_string(&path).unwrap_or_default();
        for (line, (kept, drawn)) in kept.lines().zip(drawn.lines()).enumerate() {
            assert_eq!(drawn, kept, "{id}, line {}", line + 1);
        }
        assert_eq!(drawn.lines().count(), kept.lines().count(), "{id}");
    }
}
