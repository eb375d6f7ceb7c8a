use super::{Inner, reach};
use crate::spaces::BoxSpace;
use crate::statistics::moments::Rows;
use crate::statistics::{RunningMeanStd, check_epsilon};
use crate::vector::{Columns, Progress, VectorEnv, VectorReset};
use crate::{Array, DType, Error, Result, Snapshot, Space, Value, WrapperSpec, stored, wrappers};

/// Shifts and scales observations to mean 0 and variance 1, both estimated over all sub-environments as it
/// goes, as `float32`.
///
/// Each reset and step takes its observations into the estimate at once, to the bit as Gymnasium's does;
/// a reset with a mask takes in those of the sub-environments that it resets. Where final observations
/// are in a column of their own, they are normalized but not taken in. (Gymnasium's refuses masks and
/// every autoreset but that on the next step.)
#[derive(Clone, Debug)]
pub struct NormalizeObservation<V = Box<dyn VectorEnv>> {
    envs: V,
    space: Space,
    epsilon: f64,
    update_running_mean: bool,
    statistics: RunningMeanStd,
    inner: Inner,
    rows: Rows,
    /// The last observation of each sub-environment as it was shown: a reset with a mask shows those that
    /// it leaves out again, whatever the estimate is by then.
    shown: Vec<f32>,
}

reach!(NormalizeObservation);

impl<V: VectorEnv> NormalizeObservation<V> {
    /// Normalizes the observations of `envs`.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] unless they are arrays or integers.
    pub fn new(envs: V) -> Result<Self> {
        let inner = envs.single_observation_space();
        let Some(shape) = inner.shape() else {
            let reason = format!("it needs observations with a shape, and the space is {inner}");
            return Err(Error::argument("NormalizeObservation", reason));
        };
        let space = BoxSpace::uniform(f64::NEG_INFINITY, f64::INFINITY, shape, DType::F32)?;
        let shown = vec![0.0; envs.num_envs() * space.low().len()];
        Ok(Self {
            envs,
            shown,
            statistics: RunningMeanStd::new(space.low().len()),
            space: space.into(),
            epsilon: wrappers::NormalizeObservation::<crate::BoxEnv>::EPSILON,
            update_running_mean: true,
            inner: Inner::default(),
            rows: Rows::default(),
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

    /// Takes in the observations of the sub-environments that went on and normalizes them.
    fn observe(&mut self, columns: &mut Columns) -> Result<()> {
        let n = self.envs.num_envs();
        columns.prepare(&self.space, n)?;
        let Self { statistics, epsilon, inner, rows, shown, .. } = self;
        let goes_on = |index: usize| columns.progress[index] != Progress::Unchanged;
        let Value::Array(observations) = &inner.observations else { return Ok(()) };
        if self.update_running_mean {
            rows.collect(observations, n, goes_on);
            statistics.update_rows(observations.dtype(), rows);
        }
        normalize(statistics, *epsilon, observations, shown, n, goes_on);
        if let Value::Array(out) = &mut columns.observations {
            out.as_mut_slice().unwrap_or_default().copy_from_slice(shown);
        }
        if let (Value::Array(finals), Value::Array(out)) =
            (&inner.final_observations, &mut columns.final_observations)
        {
            let out = out.as_mut_slice().unwrap_or_default();
            normalize(statistics, *epsilon, finals, out, n, |index| columns.has_final[index]);
        }
        Ok(())
    }
}

/// Normalizes the selected rows.
fn normalize(
    statistics: &RunningMeanStd,
    epsilon: f64,
    inner: &Array,
    out: &mut [f32],
    n: usize,
    selects: impl Fn(usize) -> bool,
) {
    let len = inner.len() / n;
    for (i, out) in out.chunks_exact_mut(len.max(1)).enumerate().filter(|(i, _)| selects(*i)) {
        let row = (i * len..(i + 1) * len).map(|j| inner.data().get_f64(j));
        statistics.normalize(inner.dtype(), row, epsilon, out);
    }
}

impl<V: VectorEnv> crate::VectorWrapper for NormalizeObservation<V> {
    fn inner(&self) -> &dyn VectorEnv {
        &self.envs
    }

    fn inner_mut(&mut self) -> &mut dyn VectorEnv {
        &mut self.envs
    }

    fn wrapper_spec(&self) -> Option<WrapperSpec> {
        let wrapper = WrapperSpec::new("NormalizeObservation").arg("epsilon", self.epsilon);
        Some(if self.update_running_mean { wrapper } else { wrapper.arg("update_running_mean", false) })
    }

    fn single_observation_space(&self) -> Space {
        self.space.clone()
    }

    fn reset_into(&mut self, reset: &VectorReset, columns: &mut Columns) -> Result<()> {
        let Self { envs, inner, .. } = self;
        let (result, goes_on) = inner.fill(columns, |columns| envs.reset_into(reset, columns));
        if goes_on { result.and(self.observe(columns)) } else { result }
    }

    fn step_into(&mut self, actions: &Value, columns: &mut Columns) -> Result<()> {
        let Self { envs, inner, .. } = self;
        let (result, goes_on) = inner.fill(columns, |columns| envs.step_into(actions, columns));
        if goes_on { result.and(self.observe(columns)) } else { result }
    }

    fn snapshot(&self) -> Result<Snapshot> {
        let Self { envs, statistics, update_running_mean, shown, .. } = self;
        Snapshot::of(&(envs.snapshot()?, statistics, update_running_mean, Array::from(shown.clone())))
    }

    fn restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        let (envs, statistics, update, shown): (_, RunningMeanStd, bool, Array) = snapshot.get()?;
        let shown: Vec<f32> = stored::numbers(&shown, self.shown.len())?;
        statistics.expect_len(self.statistics.len()).map_err(|error| Error::Snapshot(error.to_string()))?;
        self.envs.restore(&envs)?;
        (self.statistics, self.update_running_mean, self.shown) = (statistics, update, shown);
        Ok(())
    }
}
