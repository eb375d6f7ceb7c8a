//! Walks with a goal, one end of the line, and faults in its rewards.

use gym_core::spaces::DictSpace;
use gym_core::{Env, Goals, Inspect, Outcome, Registration, Reset, Result, Space, Value};
use serde_json::Value as Json;

use crate::twisted::{Twist, Twisted as Of};
use crate::twists::twists;

/// The place of the goal.
const GOAL: f64 = 1.0;

/// Minus the distance from the goal.
struct Near;

impl Goals for Near {
    fn goal_len(&self) -> usize {
        1
    }

    fn compute_reward(&self, achieved: &[f64], desired: &[f64]) -> f64 {
        -(achieved[0] - desired[0]).abs()
    }

    fn compute_terminated(&self, achieved: &[f64], _: &[f64]) -> bool {
        achieved[0].abs() >= 1.0
    }
}

/// Rewards in columns that are not those of single goals.
struct OtherColumns;

impl Goals for OtherColumns {
    fn goal_len(&self) -> usize {
        1
    }

    fn compute_reward(&self, achieved: &[f64], desired: &[f64]) -> f64 {
        Near.compute_reward(achieved, desired)
    }

    fn compute_terminated(&self, achieved: &[f64], desired: &[f64]) -> bool {
        Near.compute_terminated(achieved, desired)
    }

    fn compute_rewards(&self, _: &[f64], _: &[f64], rewards: &mut [f64]) -> Result<()> {
        rewards.fill(0.0);
        Ok(())
    }
}

/// Goals that never end an episode.
struct Endless;

impl Goals for Endless {
    fn goal_len(&self) -> usize {
        1
    }

    fn compute_reward(&self, achieved: &[f64], desired: &[f64]) -> f64 {
        Near.compute_reward(achieved, desired)
    }
}

/// Goals of two numbers.
struct Two;

impl Goals for Two {
    fn goal_len(&self) -> usize {
        2
    }

    fn compute_reward(&self, achieved: &[f64], desired: &[f64]) -> f64 {
        Near.compute_reward(achieved, desired)
    }

    fn compute_terminated(&self, achieved: &[f64], desired: &[f64]) -> bool {
        Near.compute_terminated(achieved, desired)
    }
}

macro_rules! inspect {
    ($($Goals:ident)+) => {$(
        impl Inspect for $Goals {
            fn arguments(&self) -> Json {
                Json::Null
            }

            fn goals(&self) -> Option<&dyn Goals> {
                Some(self)
            }
        }
    )+};
}
inspect!(Near OtherColumns Endless Two);

fn space(desired: &str) -> Space {
    let place = || Space::boxed([-1.0], [1.0]);
    let parts = [
        ("observation", Space::boxed([-1.0; 2], [1.0; 2])),
        ("achieved_goal", place()),
        (desired, place()),
    ];
    DictSpace::new(parts).map_or_else(|_| place(), Space::from)
}

/// Writes the observation of the walk as a dict; returns the reward of its goals.
fn observe(seen: &Value, desired: &str, observation: &mut Value) -> f64 {
    let place = seen.as_slice::<f32>().map_or(0.0, |seen| seen[0]);
    let parts = [
        ("achieved_goal", vec![place].into()),
        (desired, vec![GOAL as f32].into()),
        ("observation", seen.clone()),
    ];
    let mut parts = parts.map(|(name, part)| (name.to_owned(), part)).to_vec();
    parts.sort_by(|(a, _), (b, _)| a.cmp(b));
    *observation = Value::Dict(parts);
    Near.compute_reward(&[f64::from(place)], &[GOAL])
}

fn reset_of<T: Twist>(
    env: &mut Of<T>,
    reset: &Reset,
    desired: &str,
    observation: &mut Value,
) -> Result<()> {
    let mut seen = std::mem::take(&mut env.mind.seen);
    let result = env.walk.reset_into(reset, &mut seen);
    if result.is_ok() {
        observe(&seen, desired, observation);
    }
    env.mind.seen = seen;
    result
}

fn step_of<T: Twist>(
    env: &mut Of<T>,
    action: &Value,
    desired: &str,
    observation: &mut Value,
) -> Result<Outcome> {
    let mut seen = std::mem::take(&mut env.mind.seen);
    let result = env.walk.step_into(action, &mut seen);
    let result = result.map(|outcome| Outcome {
        reward: observe(&seen, desired, observation),
        ..outcome
    });
    env.mind.seen = seen;
    result
}

/// The exceptions of these walks, which make their observations anew.
const ANEW: gym_core::registry::Exceptions = &[("no-allocation", "the observation is made anew")];

twists! {
    "goals-agree" PaysMoreNearTheGoal, exceptions(ANEW) {
        fn observation_space(_: &Of<Self>) -> Space {
            space("desired_goal")
        }

        fn reset(env: &mut Of<Self>, reset: &Reset, observation: &mut Value) -> Result<()> {
            reset_of(env, reset, "desired_goal", observation)
        }

        fn inspect(_: &Of<Self>) -> Option<&dyn Inspect> {
            Some(&Near)
        }

        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            let outcome = step_of(env, action, "desired_goal", observation)?;
            let bonus = if outcome.reward > -0.5 { 1.0 } else { 0.0 };
            Ok(Outcome { reward: outcome.reward + bonus, ..outcome })
        }
    }

    "goals-agree.end" GoesOnAtTheGoal, exceptions(ANEW) {
        fn observation_space(_: &Of<Self>) -> Space {
            space("desired_goal")
        }

        fn reset(env: &mut Of<Self>, reset: &Reset, observation: &mut Value) -> Result<()> {
            reset_of(env, reset, "desired_goal", observation)
        }

        fn inspect(_: &Of<Self>) -> Option<&dyn Inspect> {
            Some(&Endless)
        }

        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            step_of(env, action, "desired_goal", observation)
        }
    }

    "goals-agree.name" NamesTheGoalOtherwise, exceptions(ANEW) {
        fn observation_space(_: &Of<Self>) -> Space {
            space("goal")
        }

        fn reset(env: &mut Of<Self>, reset: &Reset, observation: &mut Value) -> Result<()> {
            reset_of(env, reset, "goal", observation)
        }

        fn inspect(_: &Of<Self>) -> Option<&dyn Inspect> {
            Some(&Near)
        }

        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            step_of(env, action, "goal", observation)
        }
    }

    "goals-agree.columns" HasOtherColumns, exceptions(ANEW) {
        fn observation_space(_: &Of<Self>) -> Space {
            space("desired_goal")
        }

        fn reset(env: &mut Of<Self>, reset: &Reset, observation: &mut Value) -> Result<()> {
            reset_of(env, reset, "desired_goal", observation)
        }

        fn inspect(_: &Of<Self>) -> Option<&dyn Inspect> {
            Some(&OtherColumns)
        }

        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            step_of(env, action, "desired_goal", observation)
        }
    }

    "goals-agree.length" HasShorterGoals, exceptions(ANEW) {
        fn observation_space(_: &Of<Self>) -> Space {
            space("desired_goal")
        }

        fn reset(env: &mut Of<Self>, reset: &Reset, observation: &mut Value) -> Result<()> {
            reset_of(env, reset, "desired_goal", observation)
        }

        fn inspect(_: &Of<Self>) -> Option<&dyn Inspect> {
            Some(&Two)
        }

        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            step_of(env, action, "desired_goal", observation)
        }
    }

    "goals-agree.no-dict" ShowsNoGoals {
        fn inspect(_: &Of<Self>) -> Option<&dyn Inspect> {
            Some(&Near)
        }
    }
}
