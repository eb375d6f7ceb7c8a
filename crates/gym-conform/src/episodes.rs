//! Checks of the start and the end of episodes.

use crate::inputs::corners;
use crate::subject::{SEEDS, Subject};
use crate::verdict::{Verdict, broken};
use gym_core::wrappers::StepCount;
use gym_core::{BoxEnv, EnvExt, Error, Result, Value};

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

/// Checks that no first step truncates an episode, no episode exceeds its limit, and no step begins
/// the next episode.
pub(crate) fn time_limit(subject: &Subject<'_>) -> Verdict {
    let mut limited = Limited::new(subject)?;
    for seed in SEEDS {
        let mut actions = limited.env.action_sampler(seed)?;
        let place = format!("seed {seed}");
        limited.episode(Some(seed), &place, || actions.sample())?;
        limited.episode(None, &format!("{place}, the second episode"), || {
            actions.sample()
        })?;
    }
    // in some environments only a repeated action makes episodes long
    for action in corners(&gym_core::Env::action_space(&limited.env)) {
        let place = format!("{action} held");
        limited.episode(Some(SEEDS[0]), &place, || action.clone())?;
    }
    limited.always_early()
}

/// An environment, and the lengths of its episodes.
struct Limited {
    env: BoxEnv,
    limit: Option<u32>,
    /// Whether the environment has no additional wrapper. A wrapper may truncate episodes.
    is_bare: bool,
    /// The number of remaining steps of the check.
    budget: u32,
    /// The lengths of episodes that were truncated before their limit.
    early: Vec<u32>,
    /// The length of the longest episode.
    longest: u32,
}

impl Limited {
    fn new(subject: &Subject<'_>) -> Result<Self> {
        /// The check abandons episodes with more steps.
        const MAX_STEPS: u32 = 2000;
        let env = subject.make()?;
        let spec = subject.spec.as_ref();
        // without a registration there is no spec, but there may be a `TimeLimit`
        let limit = match spec {
            Some(spec) => spec.max_episode_steps,
            None => count(&env).map(|count| count.max_episode_steps),
        };
        Ok(Self {
            env,
            limit,
            is_bare: spec.is_some_and(|spec| spec.additional_wrappers.is_empty()),
            budget: 4 * limit.unwrap_or(10).clamp(10, MAX_STEPS),
            early: Vec::new(),
            longest: 0,
        })
    }

    /// Plays an episode, with at most `budget` steps.
    fn episode(
        &mut self,
        seed: Option<u64>,
        place: &str,
        mut action: impl FnMut() -> Value,
    ) -> Verdict {
        let limit = self.limit;
        self.env.reset(seed)?;
        for length in 1.. {
            if self.budget == 0 {
                return Ok(());
            }
            self.budget -= 1;
            let before = count(&self.env);
            let step = self.env.step(&action())?;
            self.longest = self.longest.max(length);
            if step.truncated && length == 1 && limit != Some(1) {
                return broken(format!("{place}: the first step truncates the episode"));
            }
            if Some(length) == limit && !step.truncated {
                return broken(format!(
                    "{place}: step {length} is the last allowed and does not truncate the episode"
                ));
            }
            if let Some(limit) =
                limit.filter(|limit| step.truncated && self.is_bare && length < *limit)
            {
                return broken(format!(
                    "{place}: step {length} truncates the episode, and {limit} steps are registered"
                ));
            }
            if let (Some(before), Some(after)) = (before, count(&self.env)) {
                self.counted(before, after, step.truncated, length, place)?;
                if step.truncated
                    && !step.terminated
                    && after.elapsed_steps < after.max_episode_steps
                {
                    self.early.push(length);
                }
            }
            if step.done() {
                return Ok(());
            }
        }
        Ok(())
    }

    /// Compares the counts of the `TimeLimit` before and after a step that returned `truncated`.
    fn counted(
        &self,
        before: StepCount,
        after: StepCount,
        truncated: bool,
        length: u32,
        place: &str,
    ) -> Verdict {
        if after.elapsed_steps < before.elapsed_steps {
            return broken(format!(
                "{place}: step {length} resets the environment by itself: the count of its time limit goes from {} to {}",
                before.elapsed_steps, after.elapsed_steps
            ));
        }
        if after.elapsed_steps >= after.max_episode_steps && !truncated {
            return broken(format!(
                "{place}: step {length} reaches the limit of {} steps and does not truncate the episode",
                after.max_episode_steps
            ));
        }
        Ok(())
    }

    /// Reports an undeclared time limit: several episodes with different actions that are truncated
    /// after the same number of steps.
    fn always_early(&self) -> Verdict {
        /// With fewer episodes, equal lengths may be chance.
        const MANY: usize = 4;
        match self.early[..] {
            [first, ref others @ ..]
                if others.len() + 1 >= MANY
                    && first == self.longest
                    && others.iter().all(|length| *length == first) =>
            {
                broken(format!(
                    "step {first} truncates {} episodes, and the time limit is not reached: change the limit",
                    self.early.len()
                ))
            }
            _ => Ok(()),
        }
    }
}

/// Returns the step count of the `TimeLimit` that is reached first.
fn count(env: &BoxEnv) -> Option<StepCount> {
    env.layer::<StepCount>().copied()
}
