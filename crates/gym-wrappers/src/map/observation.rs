use std::fmt;

use gym_core::registry::WrapperConfig;
use gym_core::spaces::array_of;
use gym_core::vector::Columns;
use gym_core::{Element, Env, Result, Space, Value, VectorEnv};

use super::Within;

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
#[derive(Clone, Debug)]
pub struct MapObservation<T, M: ObservationMap> {
    inner: T,
    config: M::Config,
    map: M,
    space: Space,
    inner_space: Space,
    /// The inner observations: only `observations`, for an environment.
    seen: Seen,
    /// A row of a batch, before and after.
    row: [Value; 2],
}

reach!(MapObservation<T, M: ObservationMap>);

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
        Ok(Self {
            inner,
            config,
            map,
            space,
            inner_space,
            seen: Seen::default(),
            row: Default::default(),
        })
    }

    /// The arguments.
    pub fn config(&self) -> &M::Config {
        &self.config
    }

    /// The map.
    pub fn map(&self) -> &M {
        &self.map
    }

    fn observe(&self, _is_reset: bool, out: &mut Value) -> Result<()> {
        prepare(&self.space, out);
        self.map.map(&self.seen.observations, out)
    }

    fn observe_columns(&mut self, n: usize, columns: &mut Columns) -> Result<()> {
        columns.prepare(&self.space, n)?;
        let Self {
            map,
            space,
            inner_space,
            seen,
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
        for index in 0..n {
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

/// Makes `out` an array of the type and shape of the space, if its elements are arrays.
fn prepare(space: &Space, out: &mut Value) {
    if let (false, Some(dtype), Some(shape)) = (
        matches!(space, Space::Discrete(_)),
        space.dtype(),
        space.shape(),
    ) {
        array_of(out, dtype, shape);
    }
}

impl<E: Env, M: ObservationMap> gym_core::Wrapper for MapObservation<E, M> {
    observes!(E, seen.observations);

    named_by!(config: M::Config);
}

impl<V: VectorEnv, M: ObservationMap> gym_core::VectorWrapper for MapObservation<V, M> {
    observes_columns!();

    fn single_observation_space(&self) -> Space {
        self.space.clone()
    }

    named_by!(config: M::Config);
}

/// The inner observations of a vector, for a wrapper that changes them.
#[derive(Clone, Debug, Default)]
pub struct Seen {
    pub(crate) observations: Value,
    pub(crate) final_observations: Value,
}

impl Seen {
    /// The inner vector fills the columns, with its observations stored here; then, if any
    /// sub-environment changed, the wrapper fills them.
    pub(crate) fn fill(
        &mut self,
        columns: &mut Columns,
        fill: impl FnOnce(&mut Columns) -> Result<()>,
    ) -> (Result<()>, bool) {
        columns.begin();
        self.swap(columns);
        let result = fill(columns);
        self.swap(columns);
        let goes_on = columns.any_progress();
        (result, goes_on)
    }

    fn swap(&mut self, columns: &mut Columns) {
        std::mem::swap(&mut self.observations, &mut columns.observations);
        std::mem::swap(
            &mut self.final_observations,
            &mut columns.final_observations,
        );
    }

    /// Maps each column that counts.
    pub(crate) fn map(
        &self,
        columns: &mut Columns,
        map: impl Fn(&Value, &mut Value) -> Result<()>,
    ) -> Result<()> {
        map(&self.observations, &mut columns.observations)?;
        if columns.has_final.contains(&true) {
            map(&self.final_observations, &mut columns.final_observations)?;
        }
        Ok(())
    }
}
