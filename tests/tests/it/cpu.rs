//! Results are equal on every level of the CPU: with AVX-512, with AVX2, with neither. The variable
//! `GYM_CPU` lowers the level of a process, so each level has a process of its own.

use std::collections::BTreeMap;
use std::process::Command;

use gym::vector::VectorEnvExt;
use gym::{EnvExt, Result, make, make_vec};
use gym_testing::Digest;

use super::sample::one_per_module;

/// Plays an environment alone, and nine together.
fn play(id: &str) -> Result<String> {
    let mut digest = Digest::default();
    let mut env = make(id)?;
    digest.value(&env.reset(3)?);
    let mut actions = env.action_sampler(4)?;
    for _ in 0..40 {
        let step = env.step(&actions.sample())?;
        digest.step(&step);
        if step.done() {
            digest.value(&env.reset(())?);
        }
    }
    let mut envs = make_vec(id, 9, None)?;
    let mut columns = envs.reset(5)?;
    let mut actions = envs.action_sampler(6)?;
    for _ in 0..20 {
        envs.step_into(&actions.sample(), &mut columns)?;
        digest.value(&columns.observations);
        digest.numbers(&columns.rewards);
    }
    Ok(digest.finish())
}

#[test]
#[ignore = "run by results_are_equal_on_every_level, once for each level"]
fn on_this_level() {
    for registration in one_per_module() {
        let id = registration.id();
        println!("{id} {}", play(id).expect("no error"));
    }
}

#[test]
fn results_are_equal_on_every_level() {
    let digests = |level: &str| {
        let this = std::env::current_exe().expect("this program");
        let output = Command::new(this)
            .args(["cpu::on_this_level", "--exact", "--ignored", "--nocapture"])
            .env("GYM_CPU", level)
            .output()
            .expect("it runs");
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{level}: {said}");
        let text = String::from_utf8(output.stdout).expect("UTF-8");
        let lines = text.lines().filter_map(|line| line.split_once(' '));
        let lines = lines.filter(|(_, digest)| digest.len() == 64);
        lines
            .map(|(id, digest)| (id.to_owned(), digest.to_owned()))
            .collect::<BTreeMap<_, _>>()
    };
    let [best, avx2, baseline] = ["avx512", "avx2", "baseline"].map(digests);
    assert!(best.len() > 40, "{} ids", best.len());
    assert_eq!(best, avx2);
    assert_eq!(best, baseline);
}
