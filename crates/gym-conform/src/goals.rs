//! The check of environments with goals.

use crate::subject::{Shown, Subject, each_event};
use crate::verdict::{Verdict, broken};
use gym_core::{Env, EnvExt, Goals, Outcome, Space, Step, Value};

/// The goals of an observation.
const GOALS: [&str; 2] = ["achieved_goal", "desired_goal"];

/// Checks that a step has the reward and the flags of the goals that it observes, one by one and in
/// columns.
pub(crate) fn agree(subject: &Subject<'_>) -> Verdict {
    let env = subject.make()?;
    let Some(goals) = env.goals() else {
        return Ok(());
    };
    let Space::Dict(space) = env.observation_space() else {
        return broken("it has goals, and its observation is no dict");
    };
    for key in ["observation", GOALS[0], GOALS[1]] {
        if space.spaces().iter().all(|(name, _)| name != key) {
            return broken(format!("it has goals, and its observation has no `{key}`"));
        }
    }
    let mut columns = [Vec::new(), Vec::new()];
    let mut rewards = Vec::new();
    each_event(subject, |shown, place| {
        let pair = GOALS.map(|key| numbers(shown.observation().get(key)));
        let length = goals.goal_len();
        for (key, goal) in GOALS.iter().zip(&pair) {
            if goal.len() != length {
                let found = goal.len();
                return broken(format!(
                    "{place}: `{key}` has {found} numbers, and `goal_len` is {length}"
                ));
            }
        }
        if let Shown::Step(step, _) = shown {
            of_step(goals, &pair, step, place)?;
        }
        rewards.push(goals.compute_reward(&pair[0], &pair[1]));
        for (column, goal) in columns.iter_mut().zip(pair) {
            column.extend(goal);
        }
        Ok(())
    })?;
    let mut computed = vec![0.0; rewards.len()];
    goals.compute_rewards(&columns[0], &columns[1], &mut computed)?;
    match rewards
        .iter()
        .zip(&computed)
        .find(|(one, column)| one.to_bits() != column.to_bits())
    {
        Some((one, column)) => broken(format!(
            "`compute_rewards` gives {column} where `compute_reward` gives {one}"
        )),
        None => Ok(()),
    }
}

/// Checks one step.
fn of_step(
    goals: &dyn Goals,
    [achieved, desired]: &[Vec<f64>; 2],
    step: &Step<Value>,
    place: &str,
) -> Verdict {
    let of_goals = Outcome {
        reward: goals.compute_reward(achieved, desired),
        terminated: goals.compute_terminated(achieved, desired),
        truncated: goals.compute_truncated(achieved, desired),
    };
    if of_goals.reward.to_bits() != step.reward.to_bits() {
        return broken(format!(
            "{place}: the reward is {}, and that of its goals {}",
            step.reward, of_goals.reward
        ));
    }
    // a limit of time can truncate too
    if of_goals.terminated != step.terminated || (of_goals.truncated && !step.truncated) {
        return broken(format!(
            "{place}: the step is terminated: {}, truncated: {}, and by its goals {}, {}",
            step.terminated, step.truncated, of_goals.terminated, of_goals.truncated
        ));
    }
    Ok(())
}

/// The numbers of a goal: of an array, or of the parts of a dict.
fn numbers(goal: Option<&Value>) -> Vec<f64> {
    match goal {
        Some(Value::Dict(entries)) => entries
            .iter()
            .flat_map(|(_, part)| numbers(Some(part)))
            .collect(),
        Some(Value::Array(array)) => array.iter_f64().collect(),
        _ => Vec::new(),
    }
}
