//! The registered ids, their arguments and their metadata.

use gym::registry::{EnvBuilder, all, find};
use gym::toytext::frozen_lake;
use gym::{BoxEnv, Env, EnvSpec, Kwargs, Result, WrapperSpec, builder};
use pyo3::prelude::*;
use serde_json::{Value as Json, json};

use crate::error::{OrRaise, guard};

/// The specs of all ids that this build can make, as a JSON list.
#[pyfunction]
pub(crate) fn specs() -> PyResult<String> {
    let row = |registration: gym::Registration| -> Result<Json> {
        let EnvSpec {
            id,
            kwargs,
            reward_threshold,
            max_episode_steps,
            nondeterministic,
            ..
        } = registration.spec()?;
        let table = registration.arguments()?;
        let defaults: Kwargs = table
            .iter()
            .map(|argument| (argument.name.to_owned(), argument.default.clone()))
            .collect();
        let documented = table.iter().map(|argument| {
            json!({"name": argument.name, "type": argument.kind, "unit": argument.unit, "meaning": argument.meaning})
        });
        Ok(json!({
            "id": id,
            "crate": registration.source.package,
            "description": registration.description,
            "kwargs": kwargs,
            "defaults": defaults,
            "arguments": documented.collect::<Vec<_>>(),
            "reward_threshold": reward_threshold,
            "max_episode_steps": max_episode_steps,
            "nondeterministic": nondeterministic,
            "reset_options": registration.reset_options.0.iter().map(|(name, _)| *name).collect::<Vec<_>>(),
            "native_vector": registration.vector_entry_point.is_some(),
        }))
    };
    let is_built =
        |row: &gym::Registration| cfg!(feature = "rapier") || !row.id().starts_with("rapier/");
    guard(|| {
        let rows = all()
            .into_iter()
            .filter(is_built)
            .map(row)
            .collect::<Result<Vec<_>>>()
            .or_raise()?;
        Ok(Json::Array(rows).to_string())
    })
}

/// Spaces and metadata of an id with its default arguments, as JSON.
#[pyfunction]
pub(crate) fn describe(id: &str) -> PyResult<String> {
    guard(|| Ok(description(&bare(id, Kwargs::new(), None, Vec::new()).or_raise()?).to_string()))
}

/// A random map for FrozenLake; see [`frozen_lake::generate_random_map`].
#[pyfunction]
#[pyo3(signature = (size, p, seed))]
pub(crate) fn generate_random_map(size: usize, p: f64, seed: Option<u64>) -> PyResult<Vec<String>> {
    guard(|| frozen_lake::generate_random_map(size, p, seed).or_raise())
}

/// Makes an environment with only the Rust wrappers `wrappers`; Gymnasium adds its own.
pub(crate) fn bare(
    id: &str,
    kwargs: Kwargs,
    render_mode: Option<&str>,
    wrappers: Vec<WrapperSpec>,
) -> Result<BoxEnv> {
    let mut builder = builder(&find(id)?.spec()?.id)
        .args(kwargs)
        .disable_env_checker(true)
        .order_enforce(false)
        .max_episode_steps(None);
    if let Some(mode) = render_mode {
        builder = builder.render_mode(mode.parse()?);
    }
    wrappers.into_iter().fold(builder, EnvBuilder::wrap).build()
}

/// Spaces and metadata, as JSON.
pub(crate) fn description(env: &BoxEnv) -> Json {
    let metadata = env.metadata();
    json!({
        "observation_space": env.observation_space(),
        "action_space": env.action_space(),
        "render_modes": metadata.render_modes,
        "render_fps": metadata.render_fps,
        "render_size": metadata.render_size,
    })
}
