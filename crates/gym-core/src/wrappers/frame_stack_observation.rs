use serde_json::Value as Json;

use crate::spaces::number::{Number, Numeric, with_type};
use crate::transform::not_an_array;
use crate::{
    Array, BoxEnv, Element, Env, Error, Outcome, Reset, Result, Snapshot, Space, Value, WrapperSpec,
};

/// Observes the last few observations at once, the newest last, along a new first axis.
#[derive(Clone, Debug)]
pub struct FrameStackObservation<E = BoxEnv> {
    env: E,
    space: Space,
    inner_space: Space,
    stack_size: usize,
    padding: Padding,
    zero: Value,
    stack: Value,
    inner: Value,
}

/// What stands for the observations before the first.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Padding {
    /// The first observation.
    #[default]
    Reset,
    /// Zeros, or what the space has nearest to zero.
    Zero,
    /// This element of the space.
    Custom(Value),
}

super::reach!(FrameStackObservation<E>);

impl<E: Env> FrameStackObservation<E> {
    /// Stacks the last `stack_size` observations of `env`; the first fills the stack.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] for a size of 0; [`Error::InvalidSpace`] if the space does not batch.
    pub fn new(env: E, stack_size: usize) -> Result<Self> {
        if stack_size == 0 {
            return Err(Error::argument("FrameStackObservation", "stack_size is 0: it must be at least 1"));
        }
        let inner_space = env.observation_space();
        let (space, zero) = (inner_space.batch(stack_size)?, inner_space.zero()?);
        let stack = empty(&inner_space, stack_size)?;
        let (padding, inner) = (Padding::Reset, Value::Null);
        Ok(Self { env, space, inner_space, stack_size, padding, zero, stack, inner })
    }

    /// Fills the stack with something else before the first observation.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] if it is not an element of the observation space.
    pub fn with_padding(self, padding: Padding) -> Result<Self> {
        if let Padding::Custom(value) = &padding {
            let refuse = |error: Error| Error::argument("FrameStackObservation", format!("padding: {error}"));
            self.inner_space.check(value).map_err(refuse)?;
        }
        Ok(Self { padding, ..self })
    }

    /// How many observations are stacked.
    pub fn stack_size(&self) -> usize {
        self.stack_size
    }

    /// What stands for the observations before the first.
    pub fn padding(&self) -> &Padding {
        &self.padding
    }
}

impl<E: Env> crate::Wrapper for FrameStackObservation<E> {
    type Observation = Value;
    type Action = E::Action;

    super::within!(E);

    fn observation_space(&self) -> Space {
        self.space.clone()
    }

    fn reset_into(&mut self, reset: &Reset, observation: &mut Value) -> Result<()> {
        let Self { env, inner, inner_space, stack, .. } = self;
        E::Observation::fill(inner, |inner| env.reset_into(reset, inner))?;
        let padding = match &self.padding {
            Padding::Reset => &*inner,
            Padding::Zero => &self.zero,
            Padding::Custom(value) => value,
        };
        for _ in 1..self.stack_size {
            push(inner_space, stack, padding)?;
        }
        push(inner_space, stack, inner)?;
        observation.clone_from(stack);
        Ok(())
    }

    fn step_into(&mut self, action: &E::Action, observation: &mut Value) -> Result<Outcome> {
        let Self { env, inner, inner_space, stack, .. } = self;
        let outcome = E::Observation::fill(inner, |inner| env.step_into(action, inner))?;
        push(inner_space, stack, inner)?;
        observation.clone_from(stack);
        Ok(outcome)
    }

    fn snapshot(&self) -> Result<Snapshot> {
        Snapshot::of(&(self.env.snapshot()?, self.space.to_json(&self.stack)?))
    }

    fn restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        let (env, stack): (_, Json) = snapshot.get()?;
        let stack = super::element(&self.space, &stack)?;
        self.env.restore(&env)?;
        self.stack = stack;
        Ok(())
    }

    fn wrapper_spec(&self) -> Option<WrapperSpec> {
        let padding = match &self.padding {
            Padding::Reset => Json::from("reset"),
            Padding::Zero => Json::from("zero"),
            Padding::Custom(value) => match self.inner_space.to_json(value).ok()? {
                // this text would be read as one of the other two
                text if text == "reset" || text == "zero" => return None,
                json => json,
            },
        };
        Some(
            WrapperSpec::new("FrameStackObservation")
                .arg("stack_size", self.stack_size)
                .arg("padding_type", padding),
        )
    }
}

/// A stack of `n` zeros.
fn empty(space: &Space, n: usize) -> Result<Value> {
    Ok(match space {
        Space::Tuple(space) => {
            Value::Tuple(space.spaces().iter().map(|space| empty(space, n)).collect::<Result<_>>()?)
        }
        Space::Dict(space) => {
            let entries = space.spaces().iter().map(|(key, space)| Ok((key.clone(), empty(space, n)?)));
            Value::Dict(entries.collect::<Result<_>>()?)
        }
        _ => match (space.dtype(), space.shape()) {
            (Some(dtype), Some(shape)) => Value::Array(Array::zeros(dtype, [&[n], shape].concat())),
            _ => Value::Tuple(vec![space.zero()?; n]),
        },
    })
}

/// Drops the oldest element of a stack and puts a new one behind the rest.
fn push(space: &Space, stack: &mut Value, item: &Value) -> Result<()> {
    match (space, stack, item) {
        (Space::Tuple(space), Value::Tuple(stacks), Value::Tuple(items)) => {
            for ((space, stack), item) in space.spaces().iter().zip(stacks).zip(items) {
                push(space, stack, item)?;
            }
        }
        (Space::Dict(space), Value::Dict(stacks), Value::Dict(_)) => {
            for ((key, space), (_, stack)) in space.spaces().iter().zip(stacks) {
                let lacking = || Error::Contract(format!("the observation lacks the key {key:?}"));
                push(space, stack, item.get(key).ok_or_else(lacking)?)?;
            }
        }
        (_, Value::Array(stack), Value::Array(item)) => with_type!(stack.dtype(), T => {
            match (stack.as_mut_slice::<T>(), item.as_slice::<T>()) {
                (Some(stack), Some(item)) if item.len() <= stack.len() => {
                    stack.copy_within(item.len().., 0);
                    let last = stack.len() - item.len();
                    stack[last..].copy_from_slice(item);
                }
                _ => return Err(not_an_array(&Value::Array(item.clone()))),
            }
        }),
        (_, Value::Array(stack), Value::Int(i)) => with_type!(stack.dtype(), T => {
            let stack = stack.as_mut_slice::<T>().unwrap_or_default();
            stack.rotate_left(1);
            if let Some(last) = stack.last_mut() {
                *last = T::cast(Number::Int((*i).into()));
            }
        }),
        (_, Value::Tuple(stack), item) => {
            stack.rotate_left(1);
            if let Some(last) = stack.last_mut() {
                last.clone_from(item);
            }
        }
        (_, _, item) => return Err(Error::Contract(format!("{item} is not an element of {space}"))),
    }
    Ok(())
}
