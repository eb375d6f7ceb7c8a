//! A correct walk with one wrong method.

use std::cell::Cell;
use std::fmt;
use std::marker::PhantomData;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

use gym_core::canvas::Canvas;
use gym_core::render::Metadata;
use gym_core::{
    Configure, Env, Error, Generator, Inspect, Outcome, Reset, Result, Snapshot, Space, Value,
};
use serde_json::Value as Json;

use crate::{Config, Fault, Walk};

/// A walk with a twist.
pub(crate) struct Twisted<T: Twist> {
    pub(crate) walk: Walk,
    pub(crate) mind: Mind,
    pub(crate) arguments: T::Arguments,
    twist: PhantomData<fn() -> T>,
}

/// The memory of a twist, which snapshots do not contain.
#[derive(Debug, Default)]
pub(crate) struct Mind {
    /// The steps since the last seed.
    pub(crate) age: u64,
    /// The number of reads since the last reset or step.
    pub(crate) looked: Cell<u64>,
    /// Whether a call that must not change anything has changed something.
    pub(crate) is_spoilt: Cell<bool>,
    /// Whether an episode has begun, and whether it has ended.
    pub(crate) is_begun: bool,
    pub(crate) is_over: bool,
    /// The state that clones share, if the twist makes clones share state.
    pub(crate) shared: Arc<AtomicU64>,
    pub(crate) own: u64,
    /// A generator other than the walk's.
    pub(crate) other: Option<Generator>,
    /// The time at which the episode began.
    pub(crate) begun: Option<Instant>,
    /// The walk's own observation, for twists that return another observation.
    pub(crate) seen: Value,
}

impl Clone for Mind {
    fn clone(&self) -> Self {
        let shared = Arc::new(self.shared.load(Ordering::Relaxed).into());
        let (looked, is_spoilt) = (self.looked.clone(), self.is_spoilt.clone());
        Self {
            looked,
            is_spoilt,
            shared,
            other: self.other.clone(),
            seen: self.seen.clone(),
            ..*self
        }
    }
}

/// The wrong methods. Each default calls the walk's method.
pub(crate) trait Twist: Sized + 'static {
    /// The constructor's arguments.
    type Arguments: Arguments;

    /// Returns the memory of a clone.
    fn copied(env: &Twisted<Self>) -> Mind {
        env.mind.clone()
    }

    /// Like [`Env::observation_space`].
    fn observation_space(env: &Twisted<Self>) -> Space {
        env.walk.observation_space()
    }

    /// Like [`Env::action_space`].
    fn action_space(env: &Twisted<Self>) -> Space {
        env.walk.action_space()
    }

    /// Like [`Env::reset_into`].
    fn reset(env: &mut Twisted<Self>, reset: &Reset, observation: &mut Value) -> Result<()> {
        env.walk.reset_into(reset, observation)
    }

    /// Like [`Env::step_into`]; if the walk is spoilt, the reward differs.
    fn step(env: &mut Twisted<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
        env.step_of_spoilt(action, observation)
    }

    /// Like [`Env::snapshot`].
    fn snapshot(env: &Twisted<Self>) -> Result<Snapshot> {
        env.stored()
    }

    /// Like [`Env::restore`].
    fn restore(env: &mut Twisted<Self>, snapshot: &Snapshot) -> Result<()> {
        env.restore_stored(snapshot)
    }

    /// Like [`Env::info`].
    fn info(env: &Twisted<Self>, visit: &mut dyn FnMut(&str, Value)) {
        env.walk.info(visit);
    }

    /// Like [`Env::metadata`].
    fn metadata(env: &Twisted<Self>) -> Metadata {
        env.walk.metadata()
    }

    /// Like [`Env::draw`].
    fn draw(env: &Twisted<Self>, canvas: &mut dyn Canvas) {
        env.walk.draw(canvas);
    }

    /// Like [`Env::ansi`].
    fn ansi(_: &Twisted<Self>) -> Option<String> {
        None
    }

    /// Like [`Env::generator`].
    fn generator(env: &mut Twisted<Self>) -> Option<&mut Generator> {
        env.walk.generator()
    }

    /// Whether the walk can be inspected.
    const INSPECTED: bool = false;

    /// Like [`Env::inspect`].
    fn inspect(env: &Twisted<Self>) -> Option<&dyn Inspect> {
        Self::INSPECTED.then_some(env as &dyn Inspect)
    }

    /// Like [`Inspect::state`].
    fn state(_: &Twisted<Self>) -> Option<Json> {
        None
    }

    /// Like [`Inspect::set_state`].
    fn set_state(_: &mut Twisted<Self>, _: Json) -> Result<()> {
        Err(Error::custom("its state is fixed"))
    }

    /// Like [`Inspect::arguments`].
    fn arguments(env: &Twisted<Self>) -> Json {
        env.own_arguments()
    }

    /// Like [`Inspect::set_argument`].
    fn set_argument(_: &mut Twisted<Self>, _: &str, _: Json) -> Result<()> {
        Err(Error::custom("its arguments are fixed"))
    }

    /// Like [`Env::close`].
    fn close(env: &mut Twisted<Self>) {
        env.walk.close();
    }
}

/// The arguments of a [`Twisted`] walk.
pub(crate) trait Arguments:
    gym_core::Arguments + Clone + fmt::Debug + Send + 'static
{
}

impl<T: gym_core::Arguments + Clone + fmt::Debug + Send + 'static> Arguments for T {}

impl<T: Twist> Twisted<T> {
    /// Takes a step of the walk; if the walk is spoilt, the reward differs.
    pub(crate) fn step_of_spoilt(
        &mut self,
        action: &Value,
        observation: &mut Value,
    ) -> Result<Outcome> {
        let outcome = self.walk.step_into(action, observation)?;
        let spoilt = if self.mind.is_spoilt.get() { 0.5 } else { 0.0 };
        Ok(Outcome {
            reward: outcome.reward + spoilt,
            ..outcome
        })
    }

    /// Returns the arguments as JSON; null or `{}` if the twist has none.
    pub(crate) fn own_arguments(&self) -> Json {
        serde_json::to_value(&self.arguments).unwrap_or_default()
    }

    /// Returns a snapshot of the walk, with the arguments if the twist has some.
    pub(crate) fn stored(&self) -> Result<Snapshot> {
        let walk = self.walk.snapshot()?;
        match self.own_arguments() {
            Json::Object(arguments) if !arguments.is_empty() => {
                Snapshot::of(&(walk.get::<Json>()?, arguments))
            }
            _ => Ok(walk),
        }
    }

    /// Restores the result of [`Self::stored`].
    pub(crate) fn restore_stored(&mut self, snapshot: &Snapshot) -> Result<()> {
        let own = self.own_arguments();
        if own.as_object().is_none_or(serde_json::Map::is_empty) {
            return self.walk.restore(snapshot);
        }
        let (walk, arguments) = snapshot.get::<(Json, Json)>()?;
        if arguments != own {
            return Err(Error::Snapshot("it was taken with other arguments".into()));
        }
        self.walk.restore(&Snapshot::of(&walk)?)
    }

    /// Returns a snapshot of [`Self::stored`] and the walk's age.
    pub(crate) fn snapshot_with_age(&self) -> Result<Snapshot> {
        Snapshot::of(&(self.stored()?.get::<Json>()?, self.mind.age))
    }

    /// Restores the result of [`Self::snapshot_with_age`].
    pub(crate) fn restore_with_age(&mut self, snapshot: &Snapshot) -> Result<()> {
        let (walk, age) = snapshot.get::<(Json, u64)>()?;
        self.restore_stored(&Snapshot::of(&walk)?)?;
        self.mind.age = age;
        Ok(())
    }

    /// Counts a read; returns the number of earlier reads since the last reset or step.
    pub(crate) fn look(&self) -> u64 {
        self.mind.looked.replace(self.mind.looked.get() + 1)
    }
}

impl<T: Twist> fmt::Debug for Twisted<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Twisted")
            .field("walk", &self.walk)
            .field("mind", &self.mind)
            .finish_non_exhaustive()
    }
}

impl<T: Twist> Clone for Twisted<T> {
    fn clone(&self) -> Self {
        let (walk, arguments) = (self.walk.clone(), self.arguments.clone());
        Self {
            walk,
            mind: T::copied(self),
            arguments,
            twist: PhantomData,
        }
    }
}

impl<T: Twist> Configure for Twisted<T> {
    type Config = T::Arguments;

    fn configure(arguments: T::Arguments, _: u32) -> Result<Self> {
        let walk = Walk::<Config>::new(Fault::None)?;
        Ok(Self {
            walk,
            mind: Mind::default(),
            arguments,
            twist: PhantomData,
        })
    }
}

impl<T: Twist> Env for Twisted<T> {
    type Observation = Value;
    type Action = Value;

    fn observation_space(&self) -> Space {
        T::observation_space(self)
    }

    fn action_space(&self) -> Space {
        T::action_space(self)
    }

    fn reset_into(&mut self, reset: &Reset, observation: &mut Value) -> Result<()> {
        if reset.seed.is_some() {
            self.mind.age = 0;
        }
        self.mind.looked.set(0);
        self.mind.begun = Some(Instant::now());
        T::reset(self, reset, observation)?;
        (self.mind.is_begun, self.mind.is_over) = (true, false);
        Ok(())
    }

    fn step_into(&mut self, action: &Value, observation: &mut Value) -> Result<Outcome> {
        self.mind.looked.set(0);
        let outcome = T::step(self, action, observation)?;
        self.mind.age = self.mind.age.saturating_add(1);
        self.mind.is_over = outcome.done();
        Ok(outcome)
    }

    fn snapshot(&self) -> Result<Snapshot> {
        T::snapshot(self)
    }

    fn restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        T::restore(self, snapshot)
    }

    fn info(&self, visit: &mut dyn FnMut(&str, Value)) {
        T::info(self, visit);
    }

    fn metadata(&self) -> Metadata {
        T::metadata(self)
    }

    fn draw(&self, canvas: &mut dyn Canvas) {
        T::draw(self, canvas);
    }

    fn ansi(&self) -> Option<String> {
        T::ansi(self)
    }

    fn generator(&mut self) -> Option<&mut Generator> {
        T::generator(self)
    }

    fn inspect(&self) -> Option<&dyn Inspect> {
        T::inspect(self)
    }

    fn inspect_mut(&mut self) -> Option<&mut dyn Inspect> {
        T::INSPECTED.then_some(self)
    }

    fn close(&mut self) {
        T::close(self);
    }
}

impl<T: Twist> Inspect for Twisted<T> {
    fn state(&self) -> Option<Json> {
        T::state(self)
    }

    fn set_state(&mut self, state: Json) -> Result<()> {
        T::set_state(self, state)
    }

    fn arguments(&self) -> Json {
        T::arguments(self)
    }

    fn set_argument(&mut self, name: &str, value: Json) -> Result<()> {
        T::set_argument(self, name, value)
    }
}
