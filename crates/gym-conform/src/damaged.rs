//! The faults of an environment with damaged snapshots. Each snapshot is tried once, for all
//! checks.

use std::panic::{AssertUnwindSafe, catch_unwind};

use serde_json::Value as Json;

use crate::damage::{damages, gaps};
use crate::look::{glance, look};
use crate::subject::{SEEDS, alike, roll_out};
use crate::verdict::{Verdict, broken, message};
use gym_core::{BoxEnv, Env, EnvExt, Result, Snapshot, Space, Step, Value};

/// The first fault of each kind.
#[derive(Default)]
pub(crate) struct Damaged {
    changed: Option<String>,
    illegal: Option<String>,
    filled: Option<String>,
    panicked: Option<String>,
}

impl Damaged {
    /// Restores `env` from each damaged version of its snapshot. After each version that `restore`
    /// accepts, takes at most `steps` steps.
    pub(crate) fn try_all(env: &BoxEnv, steps: usize) -> Result<Self> {
        let space = env.observation_space();
        let good = env.snapshot()?.get::<Json>()?;
        // in another state: a part that is restored before the rest is refused must show
        let mut elsewhere = env.clone();
        roll_out(&mut elsewhere, SEEDS[1], ELSEWHERE)?;
        let untouched = elsewhere.snapshot()?;
        let mut stored = good.clone();
        let mut faults = Self::default();
        // other checks report faults that need no damage
        let steps = sound_steps(env.clone(), &space, steps)?;
        // look at the state once for each place: the replacement does not decide whether a refused
        // `restore` changes the state
        let mut looked_at = String::new();
        for damage in damages(&good) {
            let snapshot = damage.done_to(&mut stored, Snapshot::of)?;
            let is_first = looked_at != damage.place();
            let attempt = catch_unwind(AssertUnwindSafe(|| -> Result<bool> {
                let mut tried = env.clone();
                if tried.restore(&snapshot).is_err() {
                    let is_changed = is_first && {
                        let mut other = elsewhere.clone();
                        // (another check finds what is refused only in some states)
                        other.restore(&snapshot).is_err() && other.snapshot()? != untouched
                    };
                    if is_changed {
                        faults
                            .changed
                            .get_or_insert_with(|| damage.difference(&good));
                    }
                    return Ok(true);
                }
                faults.go_on(&mut tried, &space, steps, &|| damage.difference(&good))?;
                Ok(false)
            }));
            match attempt {
                Ok(is_refused) => {
                    if is_refused? && is_first {
                        damage.place().clone_into(&mut looked_at);
                    }
                }
                Err(payload) => {
                    let message = || {
                        format!(
                            "on a snapshot with {} {}",
                            damage.difference(&good),
                            message(&*payload)
                        )
                    };
                    faults.panicked.get_or_insert_with(message);
                }
            }
        }
        for gap in gaps(&good) {
            let snapshot = gap.done_to(&mut stored, Snapshot::of)?;
            let differs = catch_unwind(AssertUnwindSafe(|| goes_on_otherwise(env, &snapshot)));
            // another check reports a panic
            if differs.is_ok_and(|differs| differs.unwrap_or(false)) {
                let without = || gap.difference(&good);
                faults.filled.get_or_insert_with(without);
            }
        }
        Ok(faults)
    }

    /// Takes some steps after `restore` accepted a damaged snapshot.
    fn go_on(
        &mut self,
        env: &mut BoxEnv,
        space: &Space,
        steps: usize,
        damage: &dyn Fn() -> String,
    ) -> Result<()> {
        glance(env);
        let mut actions = env.action_sampler(0)?;
        for _ in 0..steps {
            // a state in which `step` fails is no fault
            let Ok(step) = env.step(&actions.sample()) else {
                break;
            };
            if let Some(fault) = fault(&step, space) {
                self.illegal.get_or_insert_with(|| {
                    format!(
                        "after `restore` accepts a snapshot with {}: {fault}",
                        damage()
                    )
                });
                break;
            }
            if step.done() {
                break;
            }
        }
        look(env);
        Ok(())
    }

    pub(crate) fn changed(&self) -> Verdict {
        self.changed.as_ref().map_or(Ok(()), |what| {
            broken(format!(
                "`restore` refuses {what}, and changes the environment all the same"
            ))
        })
    }

    pub(crate) fn illegal(&self) -> Verdict {
        self.illegal.as_ref().map_or(Ok(()), broken)
    }

    pub(crate) fn filled(&self) -> Verdict {
        self.filled.as_ref().map_or(Ok(()), |what| {
            broken(format!(
                "`restore` accepts {what}, where a key is missing, and goes on otherwise"
            ))
        })
    }

    pub(crate) fn panicked(&self) -> Verdict {
        self.panicked.as_ref().map_or(Ok(()), broken)
    }
}

/// The steps to another state.
const ELSEWHERE: usize = 5;

/// Returns whether a clone of `env`, in another state, accepts `snapshot` and then continues
/// otherwise than `env`.
fn goes_on_otherwise(env: &BoxEnv, snapshot: &Snapshot) -> Result<bool> {
    const STEPS: usize = 5;
    let (mut own, mut other) = (env.clone(), env.clone());
    // what is missing must not be kept from before either
    roll_out(&mut other, SEEDS[1], ELSEWHERE)?;
    if other.restore(snapshot).is_err() {
        return Ok(false);
    }
    let mut actions = own.action_sampler(0)?;
    for _ in 0..STEPS {
        let action = actions.sample();
        let step = own.step(&action)?;
        let again = other.step(&action);
        if !again.is_ok_and(|again| alike(&step, &again)) {
            return Ok(true);
        }
        if step.done() {
            break;
        }
    }
    Ok(false)
}

/// Returns the number of steps without a fault, at most `limit`.
fn sound_steps(mut env: BoxEnv, space: &Space, limit: usize) -> Result<usize> {
    let mut actions = env.action_sampler(0)?;
    for steps in 0..limit {
        let is_sound = env
            .step(&actions.sample())
            .is_ok_and(|step| fault(&step, space).is_none());
        if !is_sound {
            return Ok(steps);
        }
    }
    Ok(limit)
}

/// Describes the fault of a step from an invalid state; `None` if the step has no fault.
fn fault(step: &Step<Value>, space: &Space) -> Option<String> {
    match space.check(&step.observation) {
        Err(error) => Some(error.to_string()),
        Ok(()) if !step.reward.is_finite() => Some(format!("the reward is {}", step.reward)),
        Ok(()) => None,
    }
}
