//! Checks of how episodes begin and end.

use crate::subject::Subject;
use crate::verdict::{Verdict, broken};
use gym_core::{EnvExt, Error};

pub(crate) fn reset_needed(subject: &Subject<'_>) -> Verdict {
    let mut env = subject.make()?;
    let action = env.action_sampler(0)?.sample();
    match env.step(&action) {
        Err(Error::ResetNeeded(_)) => Ok(()),
        Err(error) => broken(format!("`step` before `reset` gives another error than ResetNeeded: {error}")),
        Ok(_) => broken("`step` before `reset` succeeds"),
    }
}

/// No episode is truncated at once, and none lasts beyond its limit.
pub(crate) fn time_limit(subject: &Subject<'_>) -> Verdict {
    /// Longer episodes are not played to their end.
    const MAX_STEPS: u32 = 2000;
    let limit = subject.spec.as_ref().and_then(|spec| spec.max_episode_steps);
    let mut env = subject.make()?;
    let mut actions = env.action_sampler(0)?;
    env.reset(0)?;
    for length in 1..=limit.unwrap_or(1).min(MAX_STEPS) {
        let step = env.step(&actions.sample())?;
        if step.truncated && length == 1 && limit != Some(1) {
            return broken("seed 0: the first step truncates the episode");
        }
        if Some(length) == limit && !step.truncated {
            return broken(format!(
                "seed 0: step {length} is the last allowed and does not truncate the episode"
            ));
        }
        if step.done() {
            break;
        }
    }
    Ok(())
}
