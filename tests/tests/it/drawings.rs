//! Compares the drawing calls of each environment with `tests/drawings`.
//!
//! After an intended change, look at the images (`cargo xtask gif ID`), then store the new calls
//! with `GYM_UPDATE_KEPT=1 cargo test --package gym-tests --test it drawings`.

use std::path::Path;

use gym::render::DrawLog;
use gym::{Env, EnvExt, Registration, registry};
use gym_testing::{Digest, kept};

#[test]
fn drawings_are_as_kept() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("drawings");
    // another engine uses the same drawing code with slightly different numbers
    let is_other_engine = |id: &str| id.starts_with("rapier/");
    // versions of a MuJoCo task look alike
    let all = registry::self_contained();
    let is_older = |registration: &Registration| {
        registration.source.package == "gym-mujoco" && !registration.id().ends_with("-v5")
    };
    // gym-minigrid compares its pictures with checksums of minigrid's, and gym-control and
    // gym-robotics draw as gym-mujoco does
    let is_grid = |registration: &gym::Registration| {
        ["gym-control", "gym-minigrid", "gym-robotics"].contains(&registration.source.package)
    };
    for registration in all
        .iter()
        .filter(|entry| !is_other_engine(entry.id()) && !is_older(entry) && !is_grid(entry))
    {
        let id = registration.id();
        let mut env = registration.spec().unwrap().make().unwrap();
        let mut actions = env.action_sampler(0).unwrap();
        env.reset(0).unwrap();
        let mut drawn = String::new();
        // at first, CarRacing's whole field is visible
        let steps = if id.starts_with("CarRacing") { 1 } else { 3 };
        for step in 0..steps {
            let log = DrawLog::of(|canvas| env.draw(canvas));
            drawn += &format!("# step {step}\n{log}\n");
            if env.step(&actions.sample()).unwrap().done() {
                env.reset(()).unwrap();
            }
        }
        // the last frame of an episode, if the episode is short
        if (0..200).any(|_| env.step(&actions.sample()).unwrap().done()) {
            drawn += &format!("# the end\n{}\n", DrawLog::of(|canvas| env.draw(canvas)));
        }
        let path = folder.join(format!("{}.txt", id.replace('/', "_")));
        kept(&path, &drawn);
    }
}

/// Pictures and texts of whole episodes, which show more states than the first steps do.
#[test]
fn whole_episodes_are_drawn_as_kept() {
    let all = registry::self_contained().into_iter();
    let few = all.filter(|entry| ["gym-classic", "gym-toytext"].contains(&entry.source.package));
    let mut sums = String::new();
    for registration in few {
        let id = registration.id();
        let mut env = registration.spec().unwrap().make().unwrap();
        let mut actions = env.action_sampler(0).unwrap();
        let mut digest = Digest::default();
        for seed in 0..6 {
            env.reset(seed).unwrap();
            for _ in 0..50 {
                digest.bytes(
                    DrawLog::of(|canvas| env.draw(canvas))
                        .to_string()
                        .as_bytes(),
                );
                digest.bytes(env.ansi().unwrap_or_default().as_bytes());
                if env.step(&actions.sample()).unwrap().done() {
                    break;
                }
            }
        }
        sums += &format!("{id} {}\n", &digest.finish()[..16]);
    }
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("drawings");
    kept(&folder.join("episodes.txt"), &sums);
}
