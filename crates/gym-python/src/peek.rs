//! Beyond Gymnasium's interface, in Python: an environment's state, and the table of its dynamics.

use gym::toytext::tabular::Table;
use gym::vector::VectorEnv;
use gym::vector::native::NativeVectorEnv;
use gym::{BoxEnv, EnvExt, Error, Result, Stateful, box2d, classic, toytext};
use pyo3::IntoPyObjectExt;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList, PyTuple};
use serde_json::Value as Json;

/// The state of an environment whose dynamics are pure functions, as JSON; `None` for others, and
/// before the first reset.
pub(crate) fn state(env: &BoxEnv) -> Option<Json> {
    macro_rules! first_of {
        ($($dynamics:ty),* $(,)?) => {$(
            if let Some(env) = env.unwrapped::<Stateful<$dynamics>>() {
                return serde_json::to_value(env.state()?).ok();
            }
        )*};
    }
    first_of!(
        classic::cartpole::CartPoleDynamics,
        classic::mountain_car::MountainCarDynamics,
        classic::mountain_car_continuous::MountainCarContinuousDynamics,
        classic::pendulum::PendulumDynamics,
        classic::acrobot::AcrobotDynamics,
        toytext::blackjack::BlackjackDynamics,
        toytext::frozen_lake::FrozenLakeDynamics,
        toytext::cliff_walking::CliffWalkingDynamics,
        toytext::taxi::TaxiDynamics,
    );
    None
}

/// The states of a vector's environments, as a JSON list; `None` where [`state`] has none.
pub(crate) fn states(envs: &mut (dyn VectorEnv + 'static)) -> Option<Json> {
    macro_rules! first_of {
        ($($dynamics:ty),* $(,)?) => {$(
            if let Some(envs) = envs.wrapper::<NativeVectorEnv<$dynamics>>() {
                let states = (0..envs.num_envs()).map(|index| serde_json::to_value(envs.state(index)?).ok());
                return states.collect::<Option<_>>().map(Json::Array);
            }
        )*};
    }
    first_of!(
        classic::cartpole::CartPoleDynamics,
        classic::mountain_car::MountainCarDynamics,
        classic::mountain_car_continuous::MountainCarContinuousDynamics,
        classic::pendulum::PendulumDynamics,
        classic::acrobot::AcrobotDynamics,
    );
    let states = envs.call(|_, env: &mut BoxEnv| state(env)).ok()?;
    states.into_iter().collect::<Option<_>>().map(Json::Array)
}

/// Calls `$f` with the environment as its own type, where arguments can be set.
macro_rules! where_settable {
    ($env:expr, $unwrapped:ident, |$own:ident| $f:expr) => {
        where_settable!($env, $unwrapped, |$own| $f,
            Stateful<classic::cartpole::CartPoleDynamics>,
            Stateful<classic::mountain_car::MountainCarDynamics>,
            Stateful<classic::mountain_car_continuous::MountainCarContinuousDynamics>,
            Stateful<classic::pendulum::PendulumDynamics>,
            Stateful<classic::acrobot::AcrobotDynamics>,
            box2d::LunarLander,
            box2d::BipedalWalker,
            box2d::CarRacing)
    };
    ($env:expr, $unwrapped:ident, |$own:ident| $f:expr, $($task:ty),*) => {$(
        if let Some($own) = $env.$unwrapped::<$task>() {
            return $f;
        }
    )*};
}

/// The arguments as they are, as JSON, where they can be set.
pub(crate) fn arguments(env: &BoxEnv) -> Option<Json> {
    where_settable!(env, unwrapped, |env| serde_json::to_value(env.config())
        .ok());
    None
}

/// Sets an argument, where that can be done.
pub(crate) fn set_argument(env: &mut BoxEnv, name: &str, value: Json) -> Result<()> {
    where_settable!(env, unwrapped_mut, |env| env.set_argument(name, value));
    Err(Error::custom(
        "the arguments of this environment cannot be changed",
    ))
}

/// Gymnasium's `P` and `initial_state_distrib`, for environments that have them.
pub(crate) fn table<'py>(py: Python<'py>, env: &BoxEnv) -> PyResult<Option<Bound<'py, PyTuple>>> {
    macro_rules! first_of {
        ($($dynamics:ty),* $(,)?) => {$(
            if let Some(env) = env.unwrapped::<Stateful<$dynamics>>() {
                let dynamics = env.dynamics();
                return both(py, dynamics.p(), dynamics.initial_state_distribution()).map(Some);
            }
        )*};
    }
    first_of!(
        toytext::frozen_lake::FrozenLakeDynamics,
        toytext::cliff_walking::CliffWalkingDynamics,
        toytext::taxi::TaxiDynamics,
    );
    Ok(None)
}

/// The rows of FrozenLake's map.
pub(crate) fn map(env: &BoxEnv) -> Option<Vec<String>> {
    let env = env.unwrapped::<Stateful<toytext::frozen_lake::FrozenLakeDynamics>>()?;
    Some(env.dynamics().desc().to_vec())
}

/// `{state: {action: [(probability, next state, reward, terminated), ...]}}`, and a list of
/// probabilities.
fn both<'py>(py: Python<'py>, p: &Table, initial: &[f64]) -> PyResult<Bound<'py, PyTuple>> {
    let states = PyDict::new(py);
    for state in 0..p.states() {
        let actions = PyDict::new(py);
        for action in 0..p.actions() {
            let outcomes = p.outcomes(state, action).iter();
            let outcomes = outcomes
                .map(|o| (o.probability, o.next, o.reward, o.terminated).into_bound_py_any(py));
            actions.set_item(
                action,
                PyList::new(py, outcomes.collect::<PyResult<Vec<_>>>()?)?,
            )?;
        }
        states.set_item(state, actions)?;
    }
    (states, initial.to_vec()).into_pyobject(py)
}
