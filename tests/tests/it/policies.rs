//! What good policies do: a digest of each one's actions, and what they brought.
//!
//! After an intended change, store them with
//! `GYM_UPDATE_KEPT=1 cargo test --package gym-tests --test it policies`.

use std::fmt::Write;
use std::path::Path;

use gym::{EnvExt, registry};
use gym_testing::{Digest, kept};

#[test]
fn good_policies_act_as_kept() {
    let mut told = String::new();
    for entry in registry::self_contained() {
        let id = entry.id();
        // the numbers of rapier2d change with its version
        let Some(policy) = entry.page.policy.filter(|_| !id.starts_with("rapier/")) else {
            continue;
        };
        let mut env = entry.spec().unwrap().make().unwrap();
        let mut controller = policy.controller(&env).unwrap().unwrap();
        let mut observation = env.reset(7).unwrap();
        let (mut digest, mut total) = (Digest::default(), 0.0);
        for _ in 0..40 {
            let action = controller(&env, &observation).unwrap();
            digest.value(&action);
            let step = env.step(&action).unwrap();
            total += step.reward;
            if step.done() {
                break;
            }
            observation = step.observation;
        }
        writeln!(told, "{id} {} {total}", &digest.finish()[..12]).unwrap();
    }
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    kept(&folder.join("policies.txt"), &told);
}
