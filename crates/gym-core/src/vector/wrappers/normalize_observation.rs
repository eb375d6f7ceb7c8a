use super::Inner;
use crate::spaces::BoxSpace;
use crate::statistics::moments::Rows;
use crate::statistics::{RunningMeanStd, check_epsilon};
use crate::vector::{Columns, VectorEnv, VectorReset};
use crate::{Array, DType, Error, Result, Space, Value, wrappers};

/// Shifts and scales observations to mean 0 and variance 1, both estimated over all sub-environments as it
/// goes, as `float32`.
///
/// Each reset and step takes its observations into the estimate at once, to the bit as Gymnasium's does;
/// a reset with a mask takes in those of the sub-environments that it resets. Where final observations
/// are in a column of their own, they are normalized but not taken in. (Gymnasium's refuses masks and
/// every autoreset but that on the next step.)
#[derive(Clone, Debug)]
pub struct NormalizeObservation<V> {
    envs: V,
    space: Space,
    epsilon: f64,
    update_running_mean: bool,
    running: RunningMeanStd,
    inner: Inner,
    rows: Rows,
}

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
        Ok(Self {
            envs,
            running: RunningMeanStd::new(space.low().len()),
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

    /// The vector within.
    pub fn into_inner(self) -> V {
        self.envs
    }

    /// Takes in the observations of the selected rows and normalizes all.
    fn observe(&mut self, columns: &mut Columns, selects: impl Fn(usize) -> bool) -> Result<()> {
        let n = self.envs.num_envs();
        columns.prepare(&self.space, n)?;
        if let Value::Array(inner) = &self.inner.observations
            && self.update_running_mean
        {
            self.rows.collect(inner, n, selects);
            self.running.update_rows(inner.dtype(), &mut self.rows);
        }
        let Self { running, epsilon, inner, .. } = self;
        inner.map(columns, |inner, out| {
            if let (Value::Array(inner), Value::Array(out)) = (inner, out) {
                normalize(running, *epsilon, inner, out, n);
            }
            Ok(())
        })
    }
}

fn normalize(running: &RunningMeanStd, epsilon: f64, inner: &Array, out: &mut Array, n: usize) {
    let len = inner.len() / n;
    let out = out.as_mut_slice::<f32>().unwrap_or_default();
    for (i, out) in out.chunks_exact_mut(len.max(1)).enumerate() {
        let row = (i * len..(i + 1) * len).map(|j| inner.data().get_f64(j));
        running.normalize(inner.dtype(), row, epsilon, out);
    }
}

impl<V: VectorEnv> VectorEnv for NormalizeObservation<V> {
    fn single_observation_space(&self) -> Space {
        self.space.clone()
    }

    fn reset_into(&mut self, reset: &VectorReset, columns: &mut Columns) -> Result<()> {
        let Self { envs, inner, .. } = self;
        inner.fill(columns, |columns| envs.reset_into(reset, columns))?;
        self.observe(columns, |index| reset.selects(index))
    }

    fn step_into(&mut self, actions: &Value, columns: &mut Columns) -> Result<()> {
        let Self { envs, inner, .. } = self;
        inner.fill(columns, |columns| envs.step_into(actions, columns))?;
        self.observe(columns, |_| true)
    }

    crate::forward_vector!(
        envs: num_envs, single_action_space, autoreset, info, final_info, visit_envs, render, metadata, spec,
        describe, close
    );
}
