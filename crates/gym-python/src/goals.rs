//! The rewards of goals.

use gym::{BoxEnv, EnvExt as _, Error, Goals};
use numpy::{PyArray1, PyArrayMethods};
use pyo3::prelude::*;

use crate::error::OrRaise;

/// The task's rewards.
fn goals(env: &BoxEnv) -> PyResult<&dyn Goals> {
    let goals = env.goals();
    goals
        .ok_or_else(|| Error::custom("this environment has no goals"))
        .or_raise()
}

/// The rewards of `count` goals, whose numbers lie one after the other.
pub(crate) fn rewards<'py>(
    env: &BoxEnv,
    achieved: &Bound<'py, PyArray1<f64>>,
    desired: &Bound<'py, PyArray1<f64>>,
    count: usize,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let (achieved, desired) = (achieved.readonly(), desired.readonly());
    let goals = goals(env)?;
    let (given, length) = (achieved.as_slice()?.len(), goals.goal_len());
    // before memory for so many is taken
    if given != count.saturating_mul(length) {
        let reason = format!("{given} numbers for {count} goals: a goal has {length}");
        return Err(Error::argument("achieved_goal", reason)).or_raise();
    }
    let mut rewards = vec![0.0; count];
    goals
        .compute_rewards(achieved.as_slice()?, desired.as_slice()?, &mut rewards)
        .or_raise()?;
    Ok(PyArray1::from_vec(achieved.py(), rewards))
}

/// Whether a step that achieved a goal is terminated, and whether it is truncated.
pub(crate) fn flags<'py>(
    env: &BoxEnv,
    achieved: &Bound<'py, PyArray1<f64>>,
    desired: &Bound<'py, PyArray1<f64>>,
) -> PyResult<(bool, bool)> {
    let (achieved, desired) = (achieved.readonly(), desired.readonly());
    let (goals, achieved, desired) = (goals(env)?, achieved.as_slice()?, desired.as_slice()?);
    // (checks the lengths)
    goals
        .compute_rewards(achieved, desired, &mut [0.0])
        .or_raise()?;
    Ok((
        goals.compute_terminated(achieved, desired),
        goals.compute_truncated(achieved, desired),
    ))
}
