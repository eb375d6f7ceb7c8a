use std::fmt;

use gym_core::registry::WrapperConfig;
use gym_core::spaces::array_of;
use gym_core::vector::Columns;
use gym_core::{
    Element, Env, Error, Outcome, Reset, Result, Space, Value, VectorEnv, VectorWrapper, Wrapper,
    WrapperSpec,
};

use super::Within;
use crate::within::act;

/// A change of actions, without state.
pub trait ActionMap: Clone + fmt::Debug + Send + 'static {
    /// The arguments.
    type Config: WrapperConfig + Clone + fmt::Debug + Send + 'static;

    /// The wrapper's action type, around an environment whose actions have the type `A`.
    type Action<A: Element>: Element;

    /// Whether [`map`](Self::map) also maps batches. Otherwise a vector maps row by row.
    const TAKES_BATCHES: bool = false;

    /// The map to actions of a space, and the space of the actions that it maps.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] for arguments or a space that it cannot map to.
    fn new(config: &Self::Config, inner: &Space) -> Result<(Self, Space)>;

    /// The inner action: `action` changed in place, or `buffer`, which holds the result of an
    /// earlier call. Real numbers in `action` have the type of the space or `float64`.
    fn map<'a>(&self, action: &'a mut Value, buffer: &'a mut Value) -> &'a Value;
}

/// Maps the actions for an environment, or for each sub-environment of a vector.
#[derive(Clone, Debug)]
pub struct MapAction<T, M: ActionMap> {
    inner: T,
    config: M::Config,
    map: M,
    space: Space,
    inner_space: Space,
    action: Value,
    buffer: Value,
    /// A buffer for the inner actions of a vector, if they are mapped row by row.
    rows: Value,
}

gym_core::inner!(impl MapAction<T, M: ActionMap>);

impl<T, M: ActionMap> MapAction<T, M> {
    /// Maps the actions for `inner`.
    ///
    /// # Errors
    /// The errors of [`ActionMap::new`].
    pub fn new<Kind>(inner: T, config: impl Into<M::Config>) -> Result<Self>
    where
        T: Within<Kind>,
    {
        let (config, inner_space) = (config.into(), inner.actions());
        let (map, space) = M::new(&config, &inner_space)?;
        let [action, buffer, rows] = Default::default();
        Ok(Self {
            inner,
            config,
            map,
            space,
            inner_space,
            action,
            buffer,
            rows,
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

    /// Checks `action`, and converts the real numbers of a `Box` to an array in their own
    /// precision. Bounds of real numbers are not checked.
    fn take(space: &Space, action: &mut Value, buffer: &mut Value) -> Result<()> {
        match (space, &*action) {
            (Space::Box(inner), Value::Array(array))
                if array.dtype() == inner.dtype() && array.shape() == inner.shape() => {}
            (Space::Box(inner), _) if inner.dtype().is_float() => {
                space.real_action(action, None, buffer)?;
                std::mem::swap(action, buffer);
            }
            (Space::Box(_), _) => return Err(space.refuse_action(action)),
            _ if space.contains(action) => {}
            _ => return Err(space.refuse_action(action)),
        }
        Ok(())
    }
}

impl<E: Env, M: ActionMap> Wrapper for MapAction<E, M> {
    type Observation = E::Observation;
    type Action = M::Action<E::Action>;

    gym_core::inner!(E);

    fn on_reset(&mut self, reset: &Reset, observation: &mut E::Observation) -> Result<()> {
        self.inner.reset_into(reset, observation)
    }

    fn on_action_space(&self) -> Space {
        self.space.clone()
    }

    fn on_step(
        &mut self,
        outer: &Self::Action,
        observation: &mut E::Observation,
    ) -> Result<Outcome> {
        let Self {
            inner,
            map,
            space,
            action,
            buffer,
            ..
        } = self;
        outer.write(action);
        Self::take(space, action, buffer)?;
        act(inner, map.map(action, buffer), observation)
    }

    fn name(&self) -> &'static str {
        <M::Config>::NAME
    }

    fn wrapper_spec(&self) -> Option<WrapperSpec> {
        Some(self.config.spec())
    }
}

impl<V: VectorEnv, M: ActionMap> VectorWrapper for MapAction<V, M> {
    gym_core::inner!(dyn);

    fn on_single_action_space(&self) -> Space {
        self.space.clone()
    }

    fn on_step(&mut self, actions: &Value, columns: &mut Columns) -> Result<()> {
        let n = self.inner.num_envs();
        let Self {
            inner,
            map,
            space,
            inner_space,
            action,
            buffer,
            rows,
            ..
        } = self;
        space.check_actions(actions, n)?;
        if M::TAKES_BATCHES {
            let real = matches!(space, Space::Box(space) if space.dtype().is_float());
            match (actions.as_array(), space.dtype()) {
                _ if real => space.real_action(actions, Some(n), action)?,
                (Some(batch), Some(dtype)) => {
                    array_of(action, dtype, batch.shape()).assign_cast(batch)?;
                }
                _ => {
                    return Err(Error::Contract(format!(
                        "{space} does not batch into an array"
                    )));
                }
            }
            return inner.step_into(map.map(action, buffer), columns);
        }
        if !inner_space.is_batch(rows, n) {
            *rows = inner_space.empty_batch(n)?;
        }
        for index in 0..n {
            space.read_row(actions, index, action)?;
            Self::take(space, action, buffer)?;
            inner_space.write_row(rows, index, map.map(action, buffer))?;
        }
        inner.step_into(rows, columns)
    }

    fn name(&self) -> &'static str {
        <M::Config>::NAME
    }

    fn wrapper_spec(&self) -> Option<WrapperSpec> {
        Some(self.config.spec())
    }
}
