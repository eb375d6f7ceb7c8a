//! Checks of how episodes begin and end.

use crate::subject::{SEEDS, Subject};
use crate::verdict::{Verdict, broken};
use gym_core::wrappers::TimeLimit;
use gym_core::{BoxEnv, EnvExt, Error};

pub(crate) fn reset_needed(subject: &Subject<'_>) -> Verdict {
    let mut env = subject.make()?;
    let action = env.action_sampler(0)?.sample();
    match env.step(&action) {
        Err(Error::ResetNeeded(_)) => Ok(()),
        Err(error) => broken(format!(
            "`step` before `reset` gives another error than ResetNeeded: {error}"
        )),
        Ok(_) => broken("`step` before `reset` succeeds"),
    }
}

/// No episode is truncated at once, and none lasts beyond its limit.
pub(crate) fn time_limit(subject: &Subject<'_>) -> Verdict {
    /// Longer episodes are not played to their end.
    const MAX_STEPS: u32 = 2000;
    let spec = subject.spec.as_ref();
    let mut env = subject.make()?;
    // a stack around an environment without a registration has no spec, and perhaps a limit
    let limit = match spec {
        Some(spec) => spec.max_episode_steps,
        None => env
            .layer::<TimeLimit<BoxEnv>>()
            .map(TimeLimit::max_episode_steps),
    };
    // a wrapper may truncate for reasons of its own
    let is_bare = spec.is_some_and(|spec| spec.additional_wrappers.is_empty());
    for seed in SEEDS {
        let mut actions = env.action_sampler(seed)?;
        env.reset(seed)?;
        for length in 1..=limit.unwrap_or(1).min(MAX_STEPS) {
            let step = env.step(&actions.sample())?;
            if step.truncated && length == 1 && limit != Some(1) {
                return broken(format!("seed {seed}: the first step truncates the episode"));
            }
            if Some(length) == limit && !step.truncated {
                return broken(format!(
                    "seed {seed}: step {length} is the last allowed and does not truncate the episode"
                ));
            }
            if let Some(limit) = limit.filter(|limit| step.truncated && is_bare && length < *limit)
            {
                return broken(format!(
                    "seed {seed}: step {length} truncates the episode, and {limit} steps are registered"
                ));
            }
            if step.done() {
                break;
            }
        }
    }
    Ok(())
}
