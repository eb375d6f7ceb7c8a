//! One environment.

mod core;

use std::sync::{Mutex, MutexGuard, PoisonError, TryLockError};

use gym::atari::AtariEnv;
use gym::box2d::{CarRacing, ScoreGlyphs};
use gym::registry::find;
use gym::render::{RenderMode, Rendered};
use gym::sim::SimEnv;
use gym::{
    BoxEnv, Env as _, EnvExt as _, EnvSpec, Error, Generator, Inspect, Kwargs, Names, Outcome,
    Reset, Result, Snapshot, Space, Value,
};
use numpy::{PyArray1, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::sync::MutexExt;
use pyo3::types::{PyBytes, PyDict, PyTuple};
use serde::de::DeserializeOwned;
use serde_json::{Value as Json, json};

use crate::action::Check;
use crate::convert::rendered;
use crate::error::{OrRaise, guard};
use crate::fork::{IN_USE, Origin};
use crate::json::{from_json, reset_of};
use crate::numbers::Numbers;
use crate::{goals, mujoco, peek, registry, robot};
use core::Core;

/// An environment without wrappers. Calls of several threads run one after the other.
///
/// A call releases the GIL, unless the steps of the environment take less time than the release.
#[pyclass(frozen, module = "rustgym._native")]
#[derive(Debug)]
pub(crate) struct Env {
    core: Mutex<Core>,
    /// The constructor's arguments: id, arguments as JSON, render mode.
    id: String,
    kwargs: String,
    render_mode: Option<String>,
    /// The wrappers of the Rust side, as JSON.
    wrappers: String,
    action_space: Space,
    check: Check,
    /// The types of rewards and infos.
    numbers: Numbers,
    /// Whether a step takes longer than releasing the GIL.
    is_slow: bool,
    origin: Origin,
}

impl Env {
    fn make(id: &str, kwargs: &str, render_mode: Option<&str>, wrappers: &str) -> PyResult<Self> {
        let map: Kwargs = from_json(id, kwargs)?;
        let env =
            guard(|| registry::bare(id, map, render_mode, from_json(id, wrappers)?).or_raise())?;
        Ok(Self::holding(
            env,
            id,
            kwargs,
            render_mode,
            wrappers,
            false,
            Value::Null,
        ))
    }

    fn holding(
        env: BoxEnv,
        id: &str,
        kwargs: &str,
        render_mode: Option<&str>,
        wrappers: &str,
        is_running: bool,
        observation: Value,
    ) -> Self {
        let is_slow = find(id).is_ok_and(|registration| !registration.light_step);
        Self {
            id: id.to_owned(),
            kwargs: kwargs.to_owned(),
            render_mode: render_mode.map(str::to_owned),
            wrappers: wrappers.to_owned(),
            action_space: env.action_space(),
            check: Check::of(id),
            numbers: Numbers::of(id, &serde_json::from_str(kwargs).unwrap_or_default()),
            is_slow: is_slow || render_mode == Some("human"),
            core: Mutex::new(Core {
                env,
                observation,
                frame: Rendered::Shown,
                is_running,
                history: None,
            }),
            origin: Origin::here(),
        }
    }

    /// Makes an `Env` from the copy of a vector's environment, which includes its wrappers.
    pub(crate) fn of_vector(env: BoxEnv, spec: &EnvSpec) -> Self {
        let kwargs = Json::Object(spec.kwargs.clone()).to_string();
        let render_mode = spec.render_mode.map(RenderMode::name);
        let wrappers = json!(spec.additional_wrappers).to_string();
        Self::holding(
            env,
            &spec.id,
            &kwargs,
            render_mode,
            &wrappers,
            true,
            Value::Null,
        )
    }

    /// Calls `f` with the environment if the environment is an Atari game.
    pub(crate) fn with_atari<T>(
        &self,
        py: Python<'_>,
        f: impl FnOnce(&mut AtariEnv) -> PyResult<T>,
    ) -> PyResult<T> {
        let mut core = self.lock(py)?;
        core.history = None;
        match core.env.layer_mut::<AtariEnv>() {
            Some(env) => guard(|| f(env)),
            None => Err(Error::custom(format!("{} is not an Atari game", self.id))).or_raise(),
        }
    }

    /// A copy of the environment.
    pub(crate) fn inner(&self, py: Python<'_>) -> PyResult<BoxEnv> {
        Ok(self.lock(py)?.env.clone())
    }

    /// The info after a reset, or after a step: its action and outcome.
    fn info<'py>(
        &self,
        py: Python<'py>,
        core: &Core,
        step: Option<(&Bound<'py, PyAny>, &Outcome)>,
    ) -> PyResult<Bound<'py, PyDict>> {
        guard(|| self.numbers.single(py, &core.env, step))
    }

    /// Waits until no other thread uses the environment.
    fn lock(&self, py: Python<'_>) -> PyResult<MutexGuard<'_, Core>> {
        match self.core.try_lock() {
            Ok(core) => Ok(core),
            Err(TryLockError::Poisoned(poisoned)) => Ok(poisoned.into_inner()),
            Err(TryLockError::WouldBlock) => {
                self.origin.check("environment", IN_USE)?;
                Ok(self
                    .core
                    .lock_py_attached(py)
                    .unwrap_or_else(PoisonError::into_inner))
            }
        }
    }

    /// Runs a long computation without the GIL.
    fn run<T: Send>(
        &self,
        py: Python<'_>,
        core: &mut Core,
        f: impl FnOnce(&mut Core) -> T + Send,
    ) -> T {
        if self.is_slow {
            py.detach(|| f(core))
        } else {
            f(core)
        }
    }

    /// Changes a part of the environment that can be set, to the value `json`.
    fn inspect<T: DeserializeOwned>(
        &self,
        py: Python<'_>,
        what: &str,
        json: &str,
        change: impl FnOnce(&mut dyn Inspect, T) -> Result<()>,
    ) -> PyResult<()> {
        let value = from_json(&self.id, json)?;
        let mut core = self.lock(py)?;
        let Some(inspect) = core.env.inspect_mut() else {
            return Err(Error::argument(
                what,
                format!("{} cannot be changed", self.id),
            ))
            .or_raise();
        };
        guard(|| change(inspect, value).or_raise())?;
        core.history = None;
        Ok(())
    }
}

#[pymethods]
impl Env {
    /// The environment `id` with these arguments, a JSON object.
    #[new]
    #[pyo3(signature = (id, kwargs, render_mode, wrappers = "[]"))]
    fn new(id: &str, kwargs: &str, render_mode: Option<&str>, wrappers: &str) -> PyResult<Self> {
        Self::make(id, kwargs, render_mode, wrappers)
    }

    /// Starts an episode; `seed` in decimal digits, `options` as a JSON object.
    #[pyo3(signature = (seed, options))]
    fn reset<'py>(
        &self,
        py: Python<'py>,
        seed: Option<&str>,
        options: Option<&str>,
    ) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyDict>)> {
        let reset = reset_of(seed, options).or_raise()?;
        let mut core = self.lock(py)?;
        self.run(py, &mut core, |core| core.reset(&reset))?;
        Ok((
            self.numbers.observation(py, &core.observation)?,
            self.info(py, &core, None)?,
        ))
    }

    /// Takes a step: observation, reward, terminated, truncated, info.
    fn step<'py>(
        &self,
        py: Python<'py>,
        action: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyTuple>> {
        let taken = self.check.action(&self.action_space, action)?;
        let mut core = self.lock(py)?;
        let outcome = self.run(py, &mut core, |core| core.step(&taken))?;
        (
            self.numbers.observation(py, &core.observation)?,
            self.numbers.reward(&outcome, action)?,
            outcome.terminated,
            outcome.truncated,
            self.info(py, &core, Some((action, &outcome)))?,
        )
            .into_pyobject(py)
    }

    /// The picture or text of the render mode.
    fn render<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let mut core = self.lock(py)?;
        let Core { env, frame, .. } = &mut *core;
        py.detach(|| guard(|| env.render_into(frame).or_raise()))?;
        rendered(py, &core.frame)
    }

    /// The last observation.
    fn observation<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.numbers.observation(py, &self.lock(py)?.observation)
    }

    /// Spaces and metadata, as JSON.
    fn describe(&self, py: Python<'_>) -> PyResult<String> {
        let core = self.lock(py)?;
        guard(|| Ok(registry::description(&core.env).to_string()))
    }

    /// The whole state, as JSON.
    fn snapshot(&self, py: Python<'_>) -> PyResult<String> {
        self.lock(py)?.snapshot()
    }

    /// Restores a snapshot. `is_running`: whether the snapshot was taken within an episode.
    fn restore(&self, py: Python<'_>, snapshot: &str, is_running: bool) -> PyResult<()> {
        let snapshot = serde_json::from_str(snapshot)
            .and_then(serde_json::from_value::<Snapshot>)
            .map_err(|error| Error::Snapshot(error.to_string()))
            .or_raise()?;
        let mut core = self.lock(py)?;
        guard(|| core.env.restore(&snapshot).or_raise())?;
        core.is_running = is_running;
        core.history = None;
        Ok(())
    }

    /// Whether an episode was started.
    fn is_running(&self, py: Python<'_>) -> PyResult<bool> {
        Ok(self.lock(py)?.is_running)
    }

    /// The state of the generator as JSON; `None` before the first reset, and for environments
    /// without a generator.
    fn generator(&self, py: Python<'_>) -> PyResult<Option<String>> {
        let mut core = self.lock(py)?;
        Ok(core
            .env
            .generator()
            .and_then(|generator| serde_json::to_string(generator).ok()))
    }

    /// Sets the state of the generator.
    fn set_generator(&self, py: Python<'_>, state: &str) -> PyResult<()> {
        let state: Generator = serde_json::from_str(state)
            .map_err(|error| Error::Snapshot(error.to_string()))
            .or_raise()?;
        let mut core = self.lock(py)?;
        if core.env.generator().is_none() {
            // an environment has a generator after the first reset; a later reset without a seed
            // continues with the same generator
            let is_running = core.is_running;
            core.reset(&Reset::seed(0))?;
            core.is_running = is_running;
        }
        let Core { env, history, .. } = &mut *core;
        match env.generator() {
            Some(generator) if *generator == state => {}
            Some(generator) => {
                if let Some(history) = history {
                    history.replace(state.clone());
                }
                *generator = state;
            }
            None => {
                return Err(Error::custom(
                    "this environment has no random number generator",
                ))
                .or_raise();
            }
        }
        Ok(())
    }

    /// The episode's reset and actions as JSON, from which another program can repeat it; `None` if
    /// they do not lead to the current state.
    fn history(&self, py: Python<'_>) -> PyResult<Option<String>> {
        let core = self.lock(py)?;
        let history = core.history.as_ref().filter(|_| core.is_running);
        Ok(history.and_then(|history| serde_json::to_string(history).ok()))
    }

    /// The names of the numbers in an observation, and in an action.
    fn names(&self, py: Python<'_>) -> PyResult<(Vec<String>, Vec<String>)> {
        let core = self.lock(py)?;
        let names = find(&self.id).or_raise()?.page.names;
        let Names {
            observation,
            action,
        } = names.map(|names| names(&core.env)).unwrap_or_default();
        Ok((observation, action))
    }

    /// The state as JSON, for environments whose dynamics are pure functions of the state.
    fn state(&self, py: Python<'_>) -> PyResult<Option<String>> {
        let core = self.lock(py)?;
        let state = core.env.inspect().and_then(Inspect::state);
        Ok(state.map(|state| state.to_string()))
    }

    /// Continues from another state, of the form of [`state`](Self::state).
    fn set_state(&self, py: Python<'_>, state: &str) -> PyResult<()> {
        self.inspect(py, "state", state, |inspect, state| {
            inspect.set_state(state)
        })
    }

    /// Replaces the table: a JSON object of `P`, lists of outcomes by state and action, and
    /// `initial_state_distrib`.
    fn set_table(&self, py: Python<'_>, table: &str) -> PyResult<()> {
        self.inspect(py, "table", table, |inspect, table| {
            inspect.set_table(table)
        })
    }

    /// The current arguments as JSON. If an environment's arguments cannot be set: the arguments
    /// that it was made with.
    fn arguments(&self, py: Python<'_>) -> PyResult<String> {
        let core = self.lock(py)?;
        let Some(Json::Object(mut arguments)) = core.env.inspect().map(Inspect::arguments) else {
            return Ok(self.kwargs.clone());
        };
        // the version of an id may lack some arguments
        if let Ok(known) = find(&self.id).and_then(|registration| registration.arguments()) {
            arguments.retain(|name, _| known.iter().any(|argument| argument.name == name));
        }
        self.numbers.restore(&mut arguments);
        Ok(Json::Object(arguments).to_string())
    }

    /// Sets an argument: a JSON object of its name and value.
    fn set_argument(&self, py: Python<'_>, argument: &str) -> PyResult<()> {
        self.inspect(py, "arguments", argument, |inspect, argument: Kwargs| {
            argument
                .into_iter()
                .try_for_each(|(name, value)| inspect.set_argument(&name, value))
        })
    }

    /// `P` and `initial_state_distrib`, for environments that have them.
    fn table<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyTuple>>> {
        let core = self.lock(py)?;
        peek::table(py, &core.env, self.numbers.has_whole_rewards())
    }

    /// The rows of the map, for FrozenLake.
    fn map(&self, py: Python<'_>) -> PyResult<Option<Vec<String>>> {
        let core = self.lock(py)?;
        let table = core.env.inspect().and_then(Inspect::table);
        Ok(table.and_then(|table| serde_json::from_value(table["desc"].clone()).ok()))
    }

    /// The rewards of `count` goals, whose numbers lie one after the other.
    fn compute_reward<'py>(
        &self,
        py: Python<'py>,
        achieved: &Bound<'py, PyArray1<f64>>,
        desired: &Bound<'py, PyArray1<f64>>,
        count: usize,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        goals::rewards(&self.lock(py)?.env, achieved, desired, count)
    }

    /// Whether a step that achieved a goal is terminated, and whether it is truncated.
    fn compute_flags<'py>(
        &self,
        py: Python<'py>,
        achieved: &Bound<'py, PyArray1<f64>>,
        desired: &Bound<'py, PyArray1<f64>>,
    ) -> PyResult<(bool, bool)> {
        goals::flags(&self.lock(py)?.env, achieved, desired)
    }

    /// The state of a MuJoCo task, array by array.
    fn mujoco_data<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyDict>>> {
        mujoco::data(py, &self.lock(py)?.env)
    }

    /// The last call of a MuJoCo task's engine: whether the call was a step, the state before the
    /// call, and the state after the call.
    fn mujoco_before<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyTuple>>> {
        mujoco::before(py, &self.lock(py)?.env)
    }

    /// The parts of a MuJoCo task's model.
    fn mujoco_model<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyDict>>> {
        mujoco::model(py, &self.lock(py)?.env)
    }

    /// The compiled model of a MuJoCo task as JSON, with the state as a keyframe.
    fn compiled_model<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyBytes>>> {
        robot::of_env(py, &self.lock(py)?.env)
    }

    /// Sets positions and velocities of a MuJoCo task.
    fn set_mujoco_state(
        &self,
        py: Python<'_>,
        qpos: &Bound<'_, PyArray1<f64>>,
        qvel: &Bound<'_, PyArray1<f64>>,
    ) -> PyResult<()> {
        let (qpos, qvel) = (qpos.readonly(), qvel.readonly());
        let mut core = self.lock(py)?;
        match core.env.layer_mut::<SimEnv>() {
            Some(env) => guard(|| env.set_state(qpos.as_slice()?, qvel.as_slice()?).or_raise())?,
            None => return Err(Error::custom("this is not a MuJoCo environment")).or_raise(),
        }
        core.history = None;
        Ok(())
    }

    /// Writes the score of CarRacing with these digits: the text of a file of `ScoreGlyphs`.
    fn set_score_glyphs(&self, py: Python<'_>, glyphs: &str) -> PyResult<()> {
        let glyphs = ScoreGlyphs::parse(glyphs).or_raise()?;
        match self.lock(py)?.env.layer_mut::<CarRacing>() {
            Some(env) => env.set_score_glyphs(glyphs),
            None => {
                return Err(Error::custom(format!("{} does not draw a score", self.id))).or_raise();
            }
        }
        Ok(())
    }

    /// Closes the window, if there is one, and changes nothing else.
    fn close(&self, py: Python<'_>) -> PyResult<()> {
        if self.render_mode.as_deref() != Some("human") {
            return Ok(());
        }
        let mut core = self.lock(py)?;
        guard(|| {
            // a copy has no window
            core.env = core.env.clone();
            Ok(())
        })
    }

    /// An independent copy.
    fn __copy__(&self, py: Python<'_>) -> PyResult<Self> {
        let core = guard(|| Ok(self.lock(py)?.clone()))?;
        let Self {
            id,
            kwargs,
            render_mode,
            wrappers,
            ..
        } = self;
        let render_mode = render_mode.as_deref();
        let twin = Self::holding(
            core.env,
            id,
            kwargs,
            render_mode,
            wrappers,
            core.is_running,
            core.observation,
        );
        twin.lock(py)?.history = core.history;
        Ok(twin)
    }

    /// An independent copy.
    fn __deepcopy__(&self, py: Python<'_>, _memo: &Bound<'_, PyAny>) -> PyResult<Self> {
        self.__copy__(py)
    }

    /// The constructor's arguments, and a snapshot to continue from.
    fn __reduce__<'py>(
        slf: &Bound<'py, Self>,
    ) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyTuple>)> {
        let (py, env) = (slf.py(), slf.get());
        let (snapshot, is_running, observation, history) = {
            let core = env.lock(py)?;
            let space = core.env.observation_space();
            let observation = space
                .to_json(&core.observation)
                .map(|json| json.to_string())
                .ok();
            let history = serde_json::to_string(&core.history).ok();
            (core.snapshot()?, core.is_running, observation, history)
        };
        let arguments = env.arguments(py)?;
        let made_of = (
            &env.id,
            arguments,
            &env.render_mode,
            &env.wrappers,
            snapshot,
            is_running,
            observation,
            history,
        );
        Ok((
            slf.get_type().getattr("rebuild")?,
            made_of.into_pyobject(py)?,
        ))
    }

    /// Rebuilds an environment from the parts that `__reduce__` returned.
    #[staticmethod]
    #[pyo3(signature = (id, kwargs, render_mode, wrappers, snapshot, is_running, observation, history = None))]
    #[expect(
        clippy::too_many_arguments,
        reason = "they are what `__reduce__` gives"
    )]
    fn rebuild(
        py: Python<'_>,
        id: &str,
        kwargs: &str,
        render_mode: Option<&str>,
        wrappers: &str,
        snapshot: &str,
        is_running: bool,
        observation: Option<&str>,
        history: Option<&str>,
    ) -> PyResult<Self> {
        let env = Self::make(id, kwargs, render_mode, wrappers)?;
        env.restore(py, snapshot, is_running)?;
        let mut core = env.lock(py)?;
        core.history = history
            .and_then(|text| serde_json::from_str(text).ok())
            .flatten();
        if let Some(json) = observation.and_then(|text| serde_json::from_str::<Json>(text).ok()) {
            core.observation = core.env.observation_space().from_json(&json).or_raise()?;
        }
        drop(core);
        Ok(env)
    }

    /// The stack of the environment.
    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        Ok(self.lock(py)?.env.describe())
    }
}
