use serde_json::Value as Json;

use crate::spaces::number::with_type;
use crate::{
    Array, BoxEnv, Element, Env, Error, Outcome, Reset, Result, Snapshot, Space, Value, WrapperSpec,
};

/// Takes each action for several steps, adds up the rewards, and observes the larger of each element
/// of the last two observations, so that what flickers from frame to frame is seen.
///
/// Where an episode ends before the last step of a series, the observation is still made of the two
/// that were last kept, as in Gymnasium.
#[derive(Clone, Debug)]
pub struct MaxAndSkipObservation<E = BoxEnv> {
    env: E,
    skip: u32,
    /// The observations of the last step but one and of the last.
    last: [Value; 2],
    inner: Value,
}

super::reach!(MaxAndSkipObservation<E>);

impl<E: Env> MaxAndSkipObservation<E> {
    /// Takes each action for `skip` steps.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] for a skip below 2, or observations that are no arrays or integers.
    pub fn new(env: E, skip: u32) -> Result<Self> {
        let refuse = |reason: String| Err(Error::argument("MaxAndSkipObservation", reason));
        if skip < 2 {
            return refuse(format!("skip is {skip}: it must be at least 2"));
        }
        let space = env.observation_space();
        let zero = match (&space, space.dtype(), space.shape()) {
            (Space::Discrete(_), ..) => Value::Int(0),
            (_, Some(dtype), Some(shape)) => Value::Array(Array::zeros(dtype, shape)),
            _ => return refuse(format!("it needs observations with a shape, and the space is {space}")),
        };
        Ok(Self { env, skip, last: [zero.clone(), zero], inner: Value::Null })
    }

    /// For how many steps each action is taken.
    pub fn skip(&self) -> u32 {
        self.skip
    }
}

impl<E: Env> crate::Wrapper for MaxAndSkipObservation<E> {
    type Observation = Value;
    type Action = E::Action;

    super::within!(E);

    fn reset_into(&mut self, reset: &Reset, observation: &mut Value) -> Result<()> {
        E::Observation::fill(observation, |observation| self.env.reset_into(reset, observation))
    }

    fn step_into(&mut self, action: &E::Action, observation: &mut Value) -> Result<Outcome> {
        let Self { env, skip, last, inner } = self;
        let mut total = Outcome::default();
        for left in (0..*skip).rev() {
            let outcome = E::Observation::fill(inner, |inner| env.step_into(action, inner))?;
            match left {
                0 => last[1].clone_from(inner),
                1 => last[0].clone_from(inner),
                _ => {}
            }
            total = Outcome { reward: total.reward + outcome.reward, ..outcome };
            if total.done() {
                break;
            }
        }
        let [earlier, later] = last;
        observation.clone_from(earlier);
        max_into(observation, later);
        Ok(total)
    }

    fn snapshot(&self) -> Result<Snapshot> {
        let space = self.env.observation_space();
        let [earlier, later] = &self.last;
        Snapshot::of(&(self.env.snapshot()?, space.to_json(earlier)?, space.to_json(later)?))
    }

    fn restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        let (env, earlier, later): (_, Json, Json) = snapshot.get()?;
        let space = self.env.observation_space();
        let last = [super::element(&space, &earlier)?, super::element(&space, &later)?];
        self.env.restore(&env)?;
        self.last = last;
        Ok(())
    }

    fn wrapper_spec(&self) -> Option<WrapperSpec> {
        Some(WrapperSpec::new("MaxAndSkipObservation").arg("skip", self.skip))
    }
}

/// numpy's `maximum`, in which NaN wins, into the first.
fn max_into(a: &mut Value, b: &Value) {
    match (a, b) {
        (Value::Int(a), Value::Int(b)) => *a = (*a).max(*b),
        (Value::Array(a), Value::Array(b)) => with_type!(a.dtype(), T => {
            let numbers = a.as_mut_slice::<T>().unwrap_or_default().iter_mut();
            for (a, b) in numbers.zip(b.as_slice::<T>().unwrap_or_default()) {
                #[expect(clippy::eq_op, reason = "only NaN differs from itself")]
                if b > a || b != b {
                    *a = *b;
                }
            }
        }),
        _ => {}
    }
}
