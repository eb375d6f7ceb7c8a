use super::{Inner, observation_methods};
use crate::transform::affine::{Affine, Bound};
use crate::vector::{Columns, VectorEnv};
use crate::wrappers::expect_box;
use crate::{Error, Result, Space, Value};

/// Maps observations, also the final ones, linearly from the bounds of their `Box` to others.
#[derive(Clone, Debug)]
pub struct RescaleObservation<V> {
    envs: V,
    space: Space,
    map: Affine,
    inner: Inner,
}

impl<V: VectorEnv> RescaleObservation<V> {
    /// Rescales the observations of `envs`; the bounds are those of one sub-environment.
    ///
    /// # Errors
    /// As [`wrappers::RescaleObservation::new`](crate::wrappers::RescaleObservation::new).
    pub fn new(envs: V, min_obs: impl Into<Bound>, max_obs: impl Into<Bound>) -> Result<Self> {
        let inner = envs.single_observation_space();
        let inner = expect_box("RescaleObservation", "observation", &inner)?;
        let (map, space) = Affine::new(inner, &min_obs.into(), &max_obs.into())
            .map_err(|error| Error::argument("RescaleObservation", error.to_string()))?;
        Ok(Self { envs, space: space.into(), map, inner: Inner::default() })
    }

    /// The vector within.
    pub fn into_inner(self) -> V {
        self.envs
    }

    fn observe(&self, columns: &mut Columns) -> Result<()> {
        columns.prepare(&self.space, self.envs.num_envs())?;
        self.inner.map(columns, |inner, out| {
            if let (Value::Array(inner), Value::Array(out)) = (inner, out) {
                out.assign_cast(inner)?;
                self.map.forward(out);
            }
            Ok(())
        })
    }
}

impl<V: VectorEnv> VectorEnv for RescaleObservation<V> {
    fn single_observation_space(&self) -> Space {
        self.space.clone()
    }

    observation_methods!();

    crate::forward_vector!(
        envs: num_envs, single_action_space, autoreset, info, final_info, visit_envs, render, metadata, spec,
        describe, close
    );
}
