//! Wrappers that make observations and have state.
//!
//! [`Observing`] is the wrapper, an [`Observer`] makes the observations. An observer without state
//! is an [`ObservationMap`](crate::map::ObservationMap).

use std::fmt;

use gym_core::registry::WrapperConfig;
use gym_core::vector::{Columns, VectorReset};
use gym_core::{
    Element, Env, Outcome, Reset, Result, Snapshot, Space, Value, VectorEnv, VectorWrapper,
    Wrapper, WrapperSpec,
};

/// An environment or a vector with the observations that an [`Observer`] makes.
#[derive(Clone, Debug)]
pub struct Observing<T, M> {
    inner: T,
    pub(crate) observer: M,
    space: Space,
    /// The inner observations: only `observations`, for an environment.
    seen: Seen,
}

gym_core::inner!(impl Observing<T, M>);

impl<T, M> Observing<T, M> {
    /// Wraps `inner` with an observer whose observations are elements of `space`.
    pub fn with_observer(inner: T, observer: M, space: Space) -> Self {
        Self {
            inner,
            observer,
            space,
            seen: Seen::default(),
        }
    }
}

/// Makes the observations of an environment.
pub trait Observer: Clone + fmt::Debug + Send + 'static {
    /// The arguments of the wrapper.
    type Config: WrapperConfig;

    /// The current arguments.
    fn arguments(&self) -> Self::Config;

    /// Writes an element of `space` to `out`. `seen` is the inner observation of a step, or of a
    /// reset if `is_reset`; the observer may change it.
    ///
    /// # Errors
    /// [`Error::Contract`](gym_core::Error::Contract) for an observation that is not in the inner
    /// space.
    fn observe<E: Env>(
        &mut self,
        env: &mut E,
        space: &Space,
        seen: &mut Value,
        is_reset: bool,
        out: &mut Value,
    ) -> Result<()>;

    /// A snapshot of `env` and of the observer's state.
    ///
    /// # Errors
    /// The errors of [`Env::snapshot`].
    fn snapshot<E: Env>(&self, env: &E) -> Result<Snapshot> {
        env.snapshot()
    }

    /// Restores `env` and the observer's state.
    ///
    /// # Errors
    /// The errors of [`Env::restore`]; nothing is changed on error.
    fn restore<E: Env>(&mut self, env: &mut E, snapshot: &Snapshot) -> Result<()> {
        env.restore(snapshot)
    }
}

/// Makes the observations of a vector.
pub trait VectorObserver: Observer {
    /// Writes observations, elements of `space`, to the columns. `seen` has the inner observations.
    ///
    /// # Errors
    /// The errors of [`Observer::observe`].
    fn observe_columns(
        &mut self,
        space: &Space,
        num_envs: usize,
        seen: &Seen,
        columns: &mut Columns,
    ) -> Result<()>;

    /// A snapshot of `envs` and of the observer's state.
    ///
    /// # Errors
    /// The errors of [`VectorEnv::snapshot`].
    fn vector_snapshot(&self, envs: &dyn VectorEnv) -> Result<Snapshot> {
        envs.snapshot()
    }

    /// Restores `envs` and the observer's state.
    ///
    /// # Errors
    /// The errors of [`VectorEnv::restore`]; nothing is changed on error.
    fn restore_vector(&mut self, envs: &mut dyn VectorEnv, snapshot: &Snapshot) -> Result<()> {
        envs.restore(snapshot)
    }
}

impl<E: Env, M: Observer> Wrapper for Observing<E, M> {
    type Observation = Value;
    type Action = E::Action;

    gym_core::inner!(E);

    fn on_observation_space(&self) -> Space {
        self.space.clone()
    }

    fn on_reset(&mut self, reset: &Reset, observation: &mut Value) -> Result<()> {
        let Self {
            inner,
            observer,
            space,
            seen: Seen { observations, .. },
        } = self;
        E::Observation::fill(observations, |seen| inner.reset_into(reset, seen))?;
        observer.observe(inner, space, observations, true, observation)
    }

    fn on_step(&mut self, action: &E::Action, observation: &mut Value) -> Result<Outcome> {
        let Self {
            inner,
            observer,
            space,
            seen: Seen { observations, .. },
        } = self;
        let outcome = E::Observation::fill(observations, |seen| inner.step_into(action, seen))?;
        observer.observe(inner, space, observations, false, observation)?;
        Ok(outcome)
    }

    fn on_snapshot(&self) -> Result<Snapshot> {
        self.observer.snapshot(&self.inner)
    }

    fn on_restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        self.observer.restore(&mut self.inner, snapshot)
    }

    fn name(&self) -> &'static str {
        <M::Config>::NAME
    }

    fn wrapper_spec(&self) -> Option<WrapperSpec> {
        Some(self.observer.arguments().spec())
    }
}

impl<V: VectorEnv, M: VectorObserver> Observing<V, M> {
    /// Resets or steps the inner vector by `call`, and observes.
    fn observe(
        &mut self,
        columns: &mut Columns,
        call: impl FnOnce(&mut V, &mut Columns) -> Result<()>,
    ) -> Result<()> {
        let Self {
            inner,
            observer,
            space,
            seen,
        } = self;
        let (result, goes_on) = seen.fill(columns, |columns| call(inner, columns));
        if goes_on {
            result.and(observer.observe_columns(space, inner.num_envs(), seen, columns))
        } else {
            result
        }
    }
}

impl<V: VectorEnv, M: VectorObserver> VectorWrapper for Observing<V, M> {
    gym_core::inner!(dyn);

    fn on_single_observation_space(&self) -> Space {
        self.space.clone()
    }

    fn on_reset(&mut self, reset: &VectorReset, columns: &mut Columns) -> Result<()> {
        self.observe(columns, |inner, columns| inner.reset_into(reset, columns))
    }

    fn on_step(&mut self, actions: &Value, columns: &mut Columns) -> Result<()> {
        self.observe(columns, |inner, columns| inner.step_into(actions, columns))
    }

    fn on_snapshot(&self) -> Result<Snapshot> {
        self.observer.vector_snapshot(&self.inner)
    }

    fn on_restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        self.observer.restore_vector(&mut self.inner, snapshot)
    }

    fn name(&self) -> &'static str {
        <M::Config>::NAME
    }

    fn wrapper_spec(&self) -> Option<WrapperSpec> {
        Some(self.observer.arguments().spec())
    }
}

/// The inner observations of a vector, for a wrapper that changes them.
#[derive(Clone, Debug, Default)]
pub struct Seen {
    pub(crate) observations: Value,
    pub(crate) final_observations: Value,
}

impl Seen {
    /// Lets `call` fill the columns, and stores the observations of the inner vector here. Returns
    /// the result of `call`, and whether any sub-environment was reset or stepped; if so, the
    /// wrapper must observe.
    pub(crate) fn fill(
        &mut self,
        columns: &mut Columns,
        call: impl FnOnce(&mut Columns) -> Result<()>,
    ) -> (Result<()>, bool) {
        columns.begin();
        self.swap(columns);
        let result = call(columns);
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

    /// Maps the column of observations, and the column of final observations if there is one.
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
