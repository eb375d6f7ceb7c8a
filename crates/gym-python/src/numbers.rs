//! The types of the numbers that Gymnasium's environments return: Python's, or numpy's.

use std::sync::OnceLock;

use gym::registry::find;
use gym::{BoxEnv, Env as _, Kwargs, Outcome, Value};
use numpy::{PyArrayDescrMethods, PyUntypedArray, PyUntypedArrayMethods, dtype};
use pyo3::IntoPyObjectExt;
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyDict, PyList, PyString};
use serde_json::Value as Json;

use crate::convert::{new_array, scalar, to_python};

/// FrozenLake's argument of rewards.
const REWARDS: &str = "reward_schedule";

/// The type of a number.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Number {
    /// Python's `float`; in a column numpy's `float64`.
    Float,
    /// Python's `int`, for a whole number; in a column `int64`.
    Int,
    /// numpy's `float64`.
    Float64,
    /// numpy's `float32` if the action is `float32`, else `float64`.
    OfAction,
}

/// The types of an id's rewards and infos.
#[derive(Debug)]
pub(crate) struct Numbers {
    /// The name of the id without namespace and version.
    task: String,
    is_mujoco: bool,
    /// Whether the environment is a task of the Control Suite.
    is_of_suite: bool,
    /// Whether the version is before 5.
    is_old: bool,
    reward: Number,
    /// The magnitude of the reward that is an `int` in the last step of an episode; 0 for none.
    last_reward: f64,
    /// The type of `reward_ctrl`.
    control: Number,
    /// Whether the direction in MiniGrid's observations is drawn; `None` for other families.
    draws_direction: Option<bool>,
    /// The keys of an environment's info after a step, in their order.
    keys: OnceLock<Vec<Key>>,
}

/// A key of an info.
#[derive(Debug)]
struct Key {
    name: String,
    python: Py<PyString>,
    kind: Number,
}

impl Numbers {
    /// Returns the types of the environment `id` with the arguments `kwargs`.
    pub(crate) fn of(id: &str, kwargs: &Kwargs) -> Self {
        let package = find(id).map_or("", |registration| registration.source.package);
        let name = id.rsplit_once('/').map_or(id, |(_, name)| name);
        let (task, version) = name.rsplit_once("-v").unwrap_or((name, ""));
        let is_old = version != "5";
        let rewards = kwargs.get(REWARDS).and_then(Json::as_array);
        let is_whole = rewards.is_none_or(|rewards| !rewards.iter().any(Json::is_f64));
        let (reward, last_reward) = match (package, task) {
            ("gym-toytext", "Blackjack") => (Number::Float, 0.0),
            ("gym-toytext", _) if is_whole => (Number::Int, 0.0),
            ("gym-classic", "Pendulum") => (Number::Float64, 0.0),
            ("gym-box2d", "LunarLander" | "LunarLanderContinuous") => (Number::Float64, 100.0),
            ("gym-box2d", "BipedalWalker" | "BipedalWalkerHardcore") => (Number::OfAction, 100.0),
            ("gym-mujoco", "InvertedPendulum") if is_old => (Number::Float, 0.0),
            ("gym-mujoco", "InvertedPendulum") => (Number::Int, 0.0),
            ("gym-mujoco", _) => (Number::Float64, 0.0),
            ("gym-robotics", task) if task.starts_with("Adroit") => {
                let is_sparse = kwargs
                    .get("reward_type")
                    .is_some_and(|kind| kind == "sparse");
                let is_sparse =
                    is_sparse || task.ends_with("Sparse") && !kwargs.contains_key("reward_type");
                (
                    if is_sparse {
                        Number::Float
                    } else {
                        Number::Float64
                    },
                    0.0,
                )
            }
            ("gym-robotics", _) => (Number::Float64, 0.0),
            ("gym-minigrid", _) => (Number::Int, 0.0),
            ("gym-control", "fish-swim" | "hopper-stand") => (Number::Float64, 0.0),
            ("gym-control", _) if of_numpy(task) => (Number::Float64, 0.0),
            _ => (Number::Float, 0.0),
        };
        // with contact forces, Gymnasium's old Ant reports their cost under this key
        let control = match kwargs.get("use_contact_forces").and_then(Json::as_bool) {
            Some(true) => Number::Float64,
            _ => Number::OfAction,
        };
        Self {
            task: task.to_owned(),
            // AntMaze has Ant's infos
            is_mujoco: package == "gym-mujoco" || task.starts_with("AntMaze"),
            is_of_suite: package == "gym-control",
            is_old,
            reward,
            last_reward,
            control,
            draws_direction: (package == "gym-minigrid").then(|| draws_direction(id, kwargs)),
            keys: OnceLock::new(),
        }
    }

    /// Converts an observation. MiniGrid's has minigrid's order of keys, and if the direction is
    /// drawn, numpy's integer.
    pub(crate) fn observation<'py>(
        &self,
        py: Python<'py>,
        observation: &Value,
    ) -> PyResult<Bound<'py, PyAny>> {
        let (Some(is_drawn), Value::Dict(entries)) = (self.draws_direction, observation) else {
            return to_python(py, observation);
        };
        let dict = PyDict::new(py);
        let add = |wanted: bool| -> PyResult<()> {
            for (key, value) in entries.iter().filter(|(key, _)| (key == "image") == wanted) {
                match value {
                    Value::Int(i) if is_drawn && key == "direction" => {
                        dict.set_item(key, scalar(py, *i)?)?;
                    }
                    value => dict.set_item(key, to_python(py, value)?)?,
                }
            }
            Ok(())
        };
        add(true)?;
        add(false)?;
        Ok(dict.into_any())
    }

    /// Whether the rewards are of the type `int`.
    pub(crate) fn has_whole_rewards(&self) -> bool {
        self.reward == Number::Int
    }

    /// Converts the arguments, which the environment has as `f64`, to the types from which
    /// [`of`](Self::of) makes equal types.
    #[expect(clippy::cast_possible_truncation, reason = "they were whole numbers")]
    pub(crate) fn restore(&self, arguments: &mut Kwargs) {
        let rewards = arguments.get_mut(REWARDS).and_then(Json::as_array_mut);
        for reward in rewards.into_iter().flatten() {
            if let Some(number) = reward.as_f64().filter(|_| self.has_whole_rewards()) {
                *reward = Json::from(number as i64);
            }
        }
    }

    fn info(&self, key: &str) -> Number {
        if !self.is_mujoco {
            return Number::Float;
        }
        match (self.task.as_str(), key) {
            ("InvertedPendulum", "reward_survive") => Number::Int,
            ("Hopper" | "InvertedDoublePendulum", "reward_survive") => Number::Float,
            (_, "reward_survive" | "reward_alive") if self.is_old => Number::Float,
            ("Humanoid" | "HumanoidStandup", _) => Number::Float64,
            (_, "reward_ctrl") => self.control,
            _ => Number::Float64,
        }
    }

    /// Whether an action or a batch of actions is an array of `float32`; false for environments
    /// whose numbers do not depend on this.
    pub(crate) fn is_single(&self, action: &Bound<'_, PyAny>) -> bool {
        if !self.is_mujoco && self.reward != Number::OfAction {
            return false;
        }
        let array = action.cast::<PyUntypedArray>();
        array.is_ok_and(|array| array.dtype().is_equiv_to(&dtype::<f32>(action.py())))
    }

    /// Returns the reward of a step with the action `action`.
    pub(crate) fn reward<'py>(
        &self,
        outcome: &Outcome,
        action: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let (py, reward) = (action.py(), outcome.reward);
        if self.is_of_suite && reward == 0.0 {
            return 0.into_bound_py_any(py); // shimmy's `reward or 0`
        }
        if self.reward == Number::Float {
            return reward.into_bound_py_any(py);
        }
        let is_last = outcome.terminated && self.last_reward > 0.0;
        if is_last && reward.abs() == self.last_reward {
            return number(py, Number::Int, reward, false);
        }
        number(py, self.reward, reward, self.is_single(action))
    }

    /// The info of an environment after a reset, or after a step: its action and outcome.
    pub(crate) fn single<'py>(
        &self,
        py: Python<'py>,
        env: &BoxEnv,
        step: Option<(&Bound<'py, PyAny>, &Outcome)>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let info = PyDict::new(py);
        if self.is_of_suite {
            return with_time_step(info, step.map(|(_, outcome)| outcome));
        }
        let action = step.map(|(action, _)| action);
        let is_single = action.is_some_and(|action| self.is_single(action));
        let keys = self.keys.get();
        let (mut at, mut result) = (0, Ok(()));
        env.info(&mut |name, value| {
            let key = keys
                .and_then(|keys| keys.get(at))
                .filter(|key| key.name == name);
            let kind = key.map_or_else(|| self.info(name), |key| key.kind);
            let set = match value {
                Value::Float(x) => number(py, kind, x, is_single),
                Value::Tuple(tasks) if self.task == "FrankaKitchen" => tasks
                    .iter()
                    .map(|task| to_python(py, task))
                    .collect::<PyResult<Vec<_>>>()
                    .and_then(|tasks| Ok(PyList::new(py, tasks)?.into_any())),
                value => to_python(py, &value),
            }
            .and_then(|value| match key {
                Some(key) => info.set_item(&key.python, value),
                None => info.set_item(name, value),
            });
            at += 1;
            result = std::mem::replace(&mut result, Ok(())).and(set);
        });
        result?;
        if keys.is_none() && action.is_some() {
            let key = |python: Bound<'py, PyAny>| -> PyResult<Key> {
                let name: String = python.extract()?;
                let kind = self.info(&name);
                let python = python.cast_into::<PyString>()?.unbind();
                Ok(Key { name, python, kind })
            };
            // another thread may have been first, with the same keys
            let _ = self
                .keys
                .set(info.keys().iter().map(key).collect::<PyResult<_>>()?);
        }
        Ok(info)
    }

    /// Converts a column of infos; `None` if its numbers are `float64`.
    #[expect(clippy::cast_possible_truncation, reason = "the type is Gymnasium's")]
    pub(crate) fn column<'py>(
        &self,
        py: Python<'py>,
        key: &str,
        column: &Value,
        is_single: bool,
    ) -> Option<Bound<'py, PyAny>> {
        let kind = self.info(key);
        if matches!(kind, Number::Float | Number::Float64) {
            return None;
        }
        let numbers = column.as_slice::<f64>()?;
        let n = [numbers.len()];
        match kind {
            Number::Int => {
                let numbers: Vec<i64> = numbers.iter().map(|x| *x as i64).collect();
                Some(new_array(py, &n, &numbers))
            }
            Number::OfAction if is_single => {
                let numbers: Vec<f32> = numbers.iter().map(|x| *x as f32).collect();
                Some(new_array(py, &n, &numbers))
            }
            _ => None,
        }
    }
}

/// Whether numpy computes the rewards of a task of the Control Suite.
fn of_numpy(task: &str) -> bool {
    let domain = task.split('-').next().unwrap_or(task);
    ["cartpole", "humanoid", "lqr", "point_mass", "walker"].contains(&domain)
}

/// Adds what shimmy's info has of dm_env's time step after a step, or after a reset.
fn with_time_step<'py>(
    info: Bound<'py, PyDict>,
    step: Option<&Outcome>,
) -> PyResult<Bound<'py, PyDict>> {
    static TYPES: PyOnceLock<[Py<PyAny>; 3]> = PyOnceLock::new();
    let py = info.py();
    let types = TYPES.get_or_try_init(py, || {
        let types = py.import("rustgym._step_type")?.getattr("StepType")?;
        let [first, mid, last] = ["FIRST", "MID", "LAST"].map(|name| types.getattr(name));
        PyResult::Ok([first?.unbind(), mid?.unbind(), last?.unbind()])
    })?;
    let discount = step.map(|outcome| if outcome.terminated { 0.0 } else { 1.0 });
    let kind = step.map_or(0, |outcome| {
        1 + usize::from(outcome.terminated || outcome.truncated)
    });
    info.set_item(intern!(py, "timestep.discount"), discount)?;
    info.set_item(intern!(py, "timestep.step_type"), &types[kind])?;
    Ok(info)
}

/// Whether minigrid draws the agent's direction at the start, and does not set it to a number.
fn draws_direction(id: &str, kwargs: &Kwargs) -> bool {
    let is_of = |names: &[&str]| {
        let name = id.strip_prefix("MiniGrid-").unwrap_or_default();
        names.iter().any(|start| name.starts_with(start))
    };
    if is_of(&["Empty-", "Dynamic-Obstacles-"]) {
        let start = kwargs.get("agent_start_pos");
        return start.map_or(id.contains("-Random-"), Json::is_null);
    }
    !is_of(&[
        "DistShift",
        "LavaCrossing",
        "LavaGap",
        "Memory",
        "SimpleCrossing",
    ])
}

#[expect(clippy::cast_possible_truncation, reason = "the type is Gymnasium's")]
fn number<'py>(
    py: Python<'py>,
    kind: Number,
    x: f64,
    is_single: bool,
) -> PyResult<Bound<'py, PyAny>> {
    match kind {
        Number::Int if x.fract() == 0.0 => (x as i64).into_bound_py_any(py),
        Number::Float | Number::Int => x.into_bound_py_any(py),
        Number::OfAction if is_single => scalar(py, x as f32),
        Number::Float64 | Number::OfAction => scalar(py, x),
    }
}
