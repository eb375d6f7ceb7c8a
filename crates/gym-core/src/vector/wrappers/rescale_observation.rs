use super::{Inner, observation_methods, reach};
use crate::transform::affine::{Affine, Bound};
use crate::vector::{Columns, VectorEnv};
use crate::wrappers::expect_box;
use crate::{Error, Result, Space, Value, WrapperSpec};

/// Maps observations, also the final ones, linearly from the bounds of their `Box` to others.
#[derive(Clone, Debug)]
pub struct RescaleObservation<V = Box<dyn VectorEnv>> {
    envs: V,
    space: Space,
    bounds: [Bound; 2],
    map: Affine,
    inner: Inner,
}

reach!(RescaleObservation);

impl<V: VectorEnv> RescaleObservation<V> {
    /// Rescales the observations of `envs`; the bounds are those of one sub-environment.
    ///
    /// # Errors
    /// As [`wrappers::RescaleObservation::new`](crate::wrappers::RescaleObservation::new).
    pub fn new(envs: V, min_obs: impl Into<Bound>, max_obs: impl Into<Bound>) -> Result<Self> {
        let inner = envs.single_observation_space();
        let bounds = [min_obs.into(), max_obs.into()].map(|bound| bound.in_type_of(&inner));
        let inner = expect_box("RescaleObservation", "observation", &inner)?;
        let (map, space) = Affine::new(inner, &bounds[0], &bounds[1])
            .map_err(|error| Error::argument("RescaleObservation", error.to_string()))?;
        Ok(Self { envs, space: space.into(), bounds, map, inner: Inner::default() })
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

impl<V: VectorEnv> crate::VectorWrapper for RescaleObservation<V> {
    fn inner(&self) -> &dyn VectorEnv {
        &self.envs
    }

    fn inner_mut(&mut self) -> &mut dyn VectorEnv {
        &mut self.envs
    }

    fn wrapper_spec(&self) -> Option<WrapperSpec> {
        let [min, max] = self.bounds.each_ref().map(Bound::to_json);
        Some(WrapperSpec::new("RescaleObservation").arg("min_obs", min).arg("max_obs", max))
    }

    fn single_observation_space(&self) -> Space {
        self.space.clone()
    }

    observation_methods!();
}
