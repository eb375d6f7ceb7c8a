//! Checks of what `step` takes and what it refuses.

use super::subject::{Subject, carry_on, same};
use super::{SEEDS, Trouble, Verdict, broken};
use crate::{Array, DType, Data, Env, Space, Value};

pub(super) fn accepted(subject: &Subject<'_>) -> Verdict {
    let mut env = subject.reset(0)?;
    let space = env.action_space();
    let mut samples = space.sampler(0);
    let corners = corners(&space);
    let samples = std::iter::repeat_with(|| samples.sample()).take(100);
    for action in corners.into_iter().chain(samples) {
        match env.step(&action) {
            Ok(step) if step.done() => drop(env.reset(0)?),
            Ok(_) => (),
            Err(error) => return broken(format!("`step` refuses {action}, an element of {space}: {error}")),
        }
    }
    Ok(())
}

/// The first and the last element of a space of numbers.
pub(super) fn corners(space: &Space) -> Vec<Value> {
    match space {
        Space::Discrete(space) => vec![Value::Int(space.start()), Value::Int(space.last())],
        Space::Box(space) if space.is_bounded() => {
            [space.low(), space.high()].map(|bound| Value::Array(bound.clone())).into()
        }
        _ => Vec::new(),
    }
}

pub(super) fn validated(subject: &Subject<'_>) -> Verdict {
    let mut env = subject.reset(0)?;
    let space = env.action_space();
    let valid = env.action_sampler(0)?.sample();
    for action in invalid(&space, &valid) {
        if env.step(&action).is_ok() {
            return broken(format!("`step` accepts {action:?}, which is not in {space}"));
        }
    }
    Ok(())
}

pub(super) fn refusal(subject: &Subject<'_>) -> Verdict {
    for seed in SEEDS {
        let (mut env, mut other) = (subject.midway(seed)?, subject.midway(seed)?);
        let space = env.action_space();
        let valid = env.action_sampler(0)?.sample();
        for action in invalid(&space, &valid) {
            if env.step(&action).is_ok() {
                return Err(Trouble::Error(crate::Error::custom("an invalid action is accepted")));
            }
        }
        let what = "after refused actions an episode";
        same(&carry_on(&mut other, seed, 50)?, &carry_on(&mut env, seed, 50)?, what)?;
    }
    Ok(())
}

/// Values of another kind or shape than the elements of a space, out of any discrete range, or not numbers.
pub(super) fn invalid(space: &Space, valid: &Value) -> Vec<Value> {
    let mut actions = vec![
        Value::Null,
        Value::Bool(true),
        Value::Int(i64::MIN),
        Value::Int(i64::MAX),
        Value::Float(0.5),
        Value::Float(f64::NAN),
        Value::Text("left".into()),
        Value::Array(Array::default()),
        Value::Array([0.5f64, 0.5].into()),
        Value::Tuple(vec![]),
        Value::Dict(vec![("a".into(), Value::Int(0))]),
        Value::OneOf(usize::MAX, Box::new(Value::Null)),
    ];
    if let Space::Discrete(space) = space {
        actions.extend(space.start().checked_sub(1).map(Value::Int));
        actions.extend(space.last().checked_add(1).map(Value::Int));
    }
    if let Value::Array(array) = valid {
        let (dtype, shape) = (array.dtype(), array.shape());
        if dtype.is_float() {
            let not_a_number = Data::from_f64(dtype, vec![f64::NAN; array.len()]);
            actions.extend(Array::new(shape, not_a_number).map(Value::Array));
        }
        actions.push(Value::Array(Array::zeros(dtype, [shape, &[2]].concat())));
        actions.push(Value::Array(Array::zeros(dtype, [array.len() + 1])));
        actions.push(Value::Array(Array::zeros(DType::F64, [array.len() + 1])));
    }
    // an element of the space is what it takes
    actions.retain(|action| !space.contains(action));
    actions
}
