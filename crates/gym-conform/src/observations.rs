//! Checks of the results of steps: observations and rewards.

use crate::subject::{SEEDS, Shown, Subject, alike, each_event, roll_out_into};
use crate::verdict::{Verdict, broken};
use gym_core::{Array, DType, Data, Env, Space, Step, Value};

pub(crate) fn in_space(subject: &Subject<'_>) -> Verdict {
    let space = subject.make()?.observation_space();
    each_event(subject, |shown, place| {
        match space.check(shown.observation()) {
            Ok(()) => Ok(()),
            Err(error) => broken(format!("{place}: {error}")),
        }
    })?;
    subject.long_runs()?.in_space()?;
    subject.variants().in_space()
}

pub(crate) fn dtype(subject: &Subject<'_>) -> Verdict {
    let space = subject.make()?.observation_space();
    let check = |shown: &Shown, place: &str| match other_dtype(&space, shown.observation()) {
        Some((expected, actual)) => broken(format!(
            "{place}: the observation has {actual} where {space} has {expected}"
        )),
        None => Ok(()),
    };
    each_event(subject, check)?;
    let late = subject.first_run()?.iter().enumerate();
    late.into_iter()
        .try_for_each(|(i, shown)| check(shown, &format!("a long run, event {i}")))
}

/// Returns the dtype of a space and the dtype of an array in `value`, if the two differ.
fn other_dtype(space: &Space, value: &Value) -> Option<(DType, DType)> {
    match (space, value) {
        (Space::Tuple(space), Value::Tuple(items)) => space
            .spaces()
            .iter()
            .zip(items)
            .find_map(|(space, item)| other_dtype(space, item)),
        (Space::Dict(space), value) => space
            .spaces()
            .iter()
            .find_map(|(key, space)| other_dtype(space, value.get(key)?)),
        (_, Value::Array(array)) => {
            let (expected, actual) = (space.dtype()?, Array::dtype(array));
            (expected != actual).then_some((expected, actual))
        }
        _ => None,
    }
}

pub(crate) fn finite(subject: &Subject<'_>) -> Verdict {
    each_event(subject, |shown, place| match shown.observation() {
        observation if observation.is_finite() => Ok(()),
        observation => broken(format!("{place}: the observation is {observation}")),
    })?;
    subject.long_runs()?.finite()
}

pub(crate) fn reward_finite(subject: &Subject<'_>) -> Verdict {
    each_event(subject, |shown, place| match shown {
        Shown::Step(Step { reward, .. }, _) if !reward.is_finite() => {
            broken(format!("{place}: the reward is {reward}"))
        }
        _ => Ok(()),
    })?;
    subject.long_runs()?.reward_finite()?;
    subject.variants().reward_finite()
}

pub(crate) fn whole(subject: &Subject<'_>) -> Verdict {
    let mut env = subject.make()?;
    for seed in SEEDS {
        let fresh = roll_out_into(&mut env, seed, |_| Value::Null)?;
        for (what, dirty) in [
            ("kept", roll_out_into(&mut env, seed, |last| last)?),
            (
                "full",
                roll_out_into(&mut env, seed, |last| filled(last, OTHER))?,
            ),
            (
                "full of numbers that are not finite",
                roll_out_into(&mut env, seed, |last| filled(last, f64::NAN))?,
            ),
            ("of another form", roll_out_into(&mut env, seed, misfit)?),
        ] {
            let Some(i) = fresh.iter().zip(&dirty).position(|(a, b)| !alike(a, b)) else {
                continue;
            };
            let [a, b] = [&fresh[i], &dirty[i]].map(Shown::observation);
            return broken(if alike(a, b) {
                format!(
                    "seed {seed}, event {i}: with an empty buffer the result is {:?}, and {:?} with one that was {what}",
                    fresh[i], dirty[i]
                )
            } else {
                format!(
                    "seed {seed}, event {i}: into an empty buffer {a} is written, and {b} into one that was {what}"
                )
            });
        }
    }
    Ok(())
}

/// A number that few observations contain.
const OTHER: f64 = 77.0;

/// Replaces all numbers by `number`. In arrays of integers, NaN becomes 0.
fn filled(value: Value, number: f64) -> Value {
    match value {
        Value::Int(_) => Value::Int(number as i64),
        Value::Float(_) => Value::Float(number),
        Value::Text(_) => Value::Text("old".into()),
        Value::Array(array) => {
            let data = Data::from_f64(array.dtype(), vec![number; array.len()]);
            Value::Array(Array::new(array.shape(), data).unwrap_or(array))
        }
        Value::Tuple(items) => {
            Value::Tuple(items.into_iter().map(|item| filled(item, number)).collect())
        }
        Value::Dict(entries) => Value::Dict(
            entries
                .into_iter()
                .map(|(key, value)| (key, filled(value, number)))
                .collect(),
        ),
        other => other,
    }
}

/// Returns a buffer of another shape or type, like a buffer that was used for another space.
fn misfit(value: Value) -> Value {
    match value {
        Value::Array(array) if array.len() % 2 == 1 => Value::Text("old".into()),
        Value::Array(array) => {
            let (dtype, shape) = (array.dtype(), [array.shape(), &[3]].concat());
            Value::Array(Array::zeros(dtype, shape).unwrap_or(array))
        }
        Value::Tuple(mut items) => {
            items.push(Value::Null);
            Value::Tuple(items)
        }
        Value::Dict(mut entries) => {
            entries.reverse();
            entries.push(("old".into(), Value::Null));
            Value::Dict(entries)
        }
        _ => Value::Array([0.5, 0.5].into()),
    }
}
