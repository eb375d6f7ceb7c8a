use crate::spaces::{BoxSpace, array_of};
use crate::transform::not_an_array;
use crate::{
    BoxEnv, DType, Element, Env, Error, Outcome, Reset, Result, Snapshot, Space, Value, WrapperSpec,
};

use crate::statistics::{RunningMeanStd, check_epsilon};

/// Shifts and scales observations to mean 0 and variance 1, both estimated as it goes, as `float32`.
///
/// The estimate is made of every observation since the wrapper was made; resets do not clear it.
#[derive(Clone, Debug)]
pub struct NormalizeObservation<E = BoxEnv> {
    env: E,
    space: Space,
    epsilon: f64,
    update_running_mean: bool,
    statistics: RunningMeanStd,
    inner: Value,
}

super::reach!(NormalizeObservation<E>);

impl<E: Env> NormalizeObservation<E> {
    /// Gymnasium's default for what is added to the variance.
    pub const EPSILON: f64 = 1e-8;

    /// Normalizes the observations of `env`.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] unless they are arrays or integers.
    pub fn new(env: E) -> Result<Self> {
        let inner = env.observation_space();
        let Some(shape) = inner.shape() else {
            let reason = format!("it needs observations with a shape, and the space is {inner}");
            return Err(Error::argument("NormalizeObservation", reason));
        };
        let space = BoxSpace::uniform(f64::NEG_INFINITY, f64::INFINITY, shape, DType::F32)?;
        let statistics = RunningMeanStd::new(space.low().len());
        let space = space.into();
        Ok(Self {
            env,
            space,
            epsilon: Self::EPSILON,
            update_running_mean: true,
            statistics,
            inner: Value::Null,
        })
    }

    /// Adds another number to the variance than 1e-8.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] unless it is above 0.
    pub fn with_epsilon(self, epsilon: f64) -> Result<Self> {
        check_epsilon("NormalizeObservation", epsilon)?;
        Ok(Self { epsilon, ..self })
    }

    /// Goes on estimating (as it does from the start), or keeps the estimate as it is, as for
    /// evaluation.
    pub fn update_running_mean(&mut self, update: bool) {
        self.update_running_mean = update;
    }

    /// Mean, variance and count of each number of an observation.
    pub fn statistics(&self) -> &RunningMeanStd {
        &self.statistics
    }

    /// Goes on from other statistics, such as those of a training.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] if they are of another number of numbers.
    pub fn set_statistics(&mut self, statistics: RunningMeanStd) -> Result<()> {
        statistics.expect_len(self.statistics.len())?;
        self.statistics = statistics;
        Ok(())
    }

    fn observe(&mut self, out: &mut Value) -> Result<()> {
        let shape = self.space.shape().unwrap_or_default();
        let out = array_of(out, DType::F32, shape).as_mut_slice::<f32>().unwrap_or_default();
        match &self.inner {
            Value::Array(array) if array.len() == out.len() => {
                if self.update_running_mean {
                    self.statistics.update_row(array.dtype(), array.iter_f64());
                }
                self.statistics.normalize(array.dtype(), array.iter_f64(), self.epsilon, out);
            }
            Value::Int(i) if out.len() == 1 => {
                let x = *i as f64;
                if self.update_running_mean {
                    self.statistics.update_row(DType::I64, std::iter::once(x));
                }
                self.statistics.normalize(DType::I64, std::iter::once(x), self.epsilon, out);
            }
            other => return Err(not_an_array(other)),
        }
        Ok(())
    }
}

impl<E: Env> crate::Wrapper for NormalizeObservation<E> {
    type Observation = Value;
    type Action = E::Action;

    super::within!(E);

    fn observation_space(&self) -> Space {
        self.space.clone()
    }

    fn reset_into(&mut self, reset: &Reset, observation: &mut Value) -> Result<()> {
        let Self { env, inner, .. } = self;
        E::Observation::fill(inner, |inner| env.reset_into(reset, inner))?;
        self.observe(observation)
    }

    fn step_into(&mut self, action: &E::Action, observation: &mut Value) -> Result<Outcome> {
        let Self { env, inner, .. } = self;
        let outcome = E::Observation::fill(inner, |inner| env.step_into(action, inner))?;
        self.observe(observation)?;
        Ok(outcome)
    }

    fn snapshot(&self) -> Result<Snapshot> {
        Snapshot::of(&(self.env.snapshot()?, &self.statistics, self.update_running_mean))
    }

    fn restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        let (env, statistics, update): (_, RunningMeanStd, bool) = snapshot.get()?;
        statistics.expect_len(self.statistics.len()).map_err(|error| Error::Snapshot(error.to_string()))?;
        self.env.restore(&env)?;
        (self.statistics, self.update_running_mean) = (statistics, update);
        Ok(())
    }

    fn wrapper_spec(&self) -> Option<WrapperSpec> {
        let wrapper = WrapperSpec::new("NormalizeObservation").arg("epsilon", self.epsilon);
        Some(match self.update_running_mean {
            true => wrapper,
            false => wrapper.arg("update_running_mean", false),
        })
    }
}
