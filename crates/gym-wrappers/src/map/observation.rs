use std::fmt;

use gym_core::registry::WrapperConfig;
use gym_core::spaces::array_of;
use gym_core::vector::Columns;
use gym_core::{Env, Result, Space, Value};

use super::Within;
use crate::observing::{Observer, Observing, Seen, VectorObserver};

/// A change of observations, without state.
pub trait ObservationMap: Clone + fmt::Debug + Send + 'static {
    /// The arguments.
    type Config: WrapperConfig + Clone + fmt::Debug + Send + 'static;

    /// Whether [`map`](Self::map) also maps batches of observations. Otherwise a vector maps row by
    /// row.
    const TAKES_BATCHES: bool = false;

    /// The map of observations of a space, and the space that it maps to.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`](gym_core::Error::InvalidArgument) for arguments or a space that
    /// it cannot map.
    fn new(config: &Self::Config, inner: &Space) -> Result<(Self, Space)>;

    /// Writes the mapped observation to `out`. If elements of the space are arrays, `out` is an
    /// array of their type and shape; otherwise its content is arbitrary.
    ///
    /// # Errors
    /// [`Error::Contract`](gym_core::Error::Contract) for an observation that is not in the inner
    /// space.
    fn map(&self, inner: &Value, out: &mut Value) -> Result<()>;
}

/// Maps the observations of an environment, or of each sub-environment of a vector, final ones
/// included.
pub type MapObservation<T, M> = Observing<T, Mapped<M>>;

/// The observer of an [`ObservationMap`].
#[derive(Clone, Debug)]
pub struct Mapped<M: ObservationMap> {
    config: M::Config,
    map: M,
    inner_space: Space,
    /// Buffers for a row of a batch: the inner observation, and the mapped one.
    row: [Value; 2],
}

impl<T, M: ObservationMap> MapObservation<T, M> {
    /// Maps the observations of `inner`.
    ///
    /// # Errors
    /// The errors of [`ObservationMap::new`].
    pub fn new<Kind>(inner: T, config: impl Into<M::Config>) -> Result<Self>
    where
        T: Within<Kind>,
    {
        let (config, inner_space) = (config.into(), inner.observations());
        let (map, space) = M::new(&config, &inner_space)?;
        let mapped = Mapped {
            config,
            map,
            inner_space,
            row: Default::default(),
        };
        Ok(Self::with_observer(inner, mapped, space))
    }

    /// The arguments.
    pub fn config(&self) -> &M::Config {
        &self.observer.config
    }

    /// The map.
    pub fn map(&self) -> &M {
        &self.observer.map
    }
}

impl<M: ObservationMap> Observer for Mapped<M> {
    type Config = M::Config;

    fn arguments(&self) -> M::Config {
        self.config.clone()
    }

    fn observe<E: Env>(
        &mut self,
        _env: &mut E,
        space: &Space,
        seen: &mut Value,
        _is_reset: bool,
        out: &mut Value,
    ) -> Result<()> {
        prepare(space, out);
        self.map.map(seen, out)
    }
}

impl<M: ObservationMap> VectorObserver for Mapped<M> {
    fn observe_columns(
        &mut self,
        space: &Space,
        num_envs: usize,
        seen: &Seen,
        columns: &mut Columns,
    ) -> Result<()> {
        columns.prepare(space, num_envs)?;
        let Self {
            map,
            inner_space,
            row: [before, after],
            ..
        } = self;
        if M::TAKES_BATCHES {
            return seen.map(columns, |inner, out| map.map(inner, out));
        }
        prepare(space, after);
        let mut map_row = |index: usize, inner: &Value, out: &mut Value| {
            inner_space.read_row(inner, index, before)?;
            map.map(before, after)?;
            space.write_row(out, index, after)
        };
        for index in 0..num_envs {
            map_row(index, &seen.observations, &mut columns.observations)?;
            if columns.has_final[index] {
                map_row(
                    index,
                    &seen.final_observations,
                    &mut columns.final_observations,
                )?;
            }
        }
        Ok(())
    }
}

/// Makes `out` an array of the space's type and shape, if the space's elements are arrays.
fn prepare(space: &Space, out: &mut Value) {
    if let (false, Some(dtype), Some(shape)) = (
        matches!(space, Space::Discrete(_)),
        space.dtype(),
        space.shape(),
    ) {
        array_of(out, dtype, shape);
    }
}
