//! Long runs: late states, repeated actions, and unusual actions.

use crate::calls::Calls;
use crate::inputs::{corners, huge, inner};
use crate::look::look;
use crate::verdict::{Verdict, broken};
use gym_core::{BoxEnv, Env, EnvExt, Result, Space, Step, Value};

/// The first fault of each kind.
pub(crate) struct LongRuns {
    space: Space,
    refused: Option<String>,
    in_space: Option<String>,
    finite: Option<String>,
    reward: Option<String>,
    drawing: Option<String>,
}

impl LongRuns {
    /// Plays `env`, which should have no time limit, so that it reaches more states.
    pub(crate) fn play(mut env: BoxEnv) -> Result<Self> {
        const RANDOM: usize = 1500;
        const HELD: usize = 200;
        const ODD: usize = 20;
        let space = env.action_space();
        let seen = env.observation_space();
        let mut runs = Self {
            space: seen,
            refused: None,
            in_space: None,
            finite: None,
            reward: None,
            drawing: None,
        };
        let mut samples = env.action_sampler(5)?;
        runs.run(&mut env, "a long run", RANDOM, || samples.sample())?;
        let mut held = corners(&space);
        held.extend((0..3).map(|_| samples.sample()));
        for action in held {
            runs.run(&mut env, &format!("{action} held"), HELD, || action.clone())?;
        }
        let within = inner(&space);
        let mut each = within.iter().cycle().cloned();
        let next = || each.next().unwrap_or_default();
        runs.run(&mut env, "each action in turn", within.len(), next)?;
        for action in huge(&space) {
            // the environment may refuse actions beyond the space
            if env.reset(1).is_ok() && env.step(&action).is_ok() {
                runs.run(
                    &mut env,
                    &format!("{action}, which is accepted, held"),
                    ODD,
                    || action.clone(),
                )?;
            }
        }
        Ok(runs)
    }

    /// Plays episodes until `steps` steps are taken or an action is refused.
    fn run(
        &mut self,
        env: &mut BoxEnv,
        what: &str,
        steps: usize,
        mut action: impl FnMut() -> Value,
    ) -> Result<()> {
        if steps == 0 {
            return Ok(());
        }
        self.see(&env.reset(1)?, || format!("{what}, reset"));
        for i in 1..=steps {
            let Step {
                observation,
                reward,
                terminated,
                truncated,
            } = match env.step(&action()) {
                Ok(step) => step,
                Err(error) => {
                    self.refused
                        .get_or_insert_with(|| format!("{what}: `step` number {i} fails: {error}"));
                    return Ok(());
                }
            };
            self.see(&observation, || format!("{what}, step {i}"));
            if !reward.is_finite() {
                self.reward
                    .get_or_insert_with(|| format!("{what}, step {i}: the reward is {reward}"));
            }
            if terminated || truncated {
                // wrappers and recorders read the last state of an episode too
                look(env);
                if let Some(fault) = Calls::of(env).fault {
                    self.drawing
                        .get_or_insert_with(|| format!("{what}, step {i}: {fault}"));
                }
                self.see(&env.reset(())?, || format!("{what}, reset after step {i}"));
            }
        }
        Ok(())
    }

    fn see(&mut self, observation: &Value, place: impl Fn() -> String) {
        if let Err(error) = self.space.check(observation) {
            self.in_space
                .get_or_insert_with(|| format!("{}: {error}", place()));
        }
        if !observation.is_finite() {
            self.finite
                .get_or_insert_with(|| format!("{}: the observation is {observation}", place()));
        }
    }

    pub(crate) fn refused(&self) -> Verdict {
        verdict(&self.refused)
    }

    pub(crate) fn in_space(&self) -> Verdict {
        verdict(&self.in_space)
    }

    pub(crate) fn finite(&self) -> Verdict {
        verdict(&self.finite)
    }

    pub(crate) fn drawing(&self) -> Verdict {
        verdict(&self.drawing)
    }

    pub(crate) fn reward_finite(&self) -> Verdict {
        verdict(&self.reward)
    }
}

fn verdict(fault: &Option<String>) -> Verdict {
    fault.as_ref().map_or(Ok(()), broken)
}
