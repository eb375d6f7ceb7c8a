//! Keyframes by their names or numbers.

use gym_core::{Error, Result};
use mujoco_engine::CompiledModel;

/// The names of the keyframes; the number of one without a name.
#[must_use]
pub fn keyframes(model: &CompiledModel) -> Vec<String> {
    let name = |key: usize| match model.names.key.get(key) {
        Some(Some(name)) => name.clone(),
        _ => key.to_string(),
    };
    (0..model.key_qpos.len()).map(name).collect()
}

/// The number of a keyframe that is given by its name or number.
///
/// # Errors
/// [`Error::InvalidArgument`] with the names that there are.
pub fn keyframe(model: &CompiledModel, name: &str) -> Result<usize> {
    let number = name.parse().ok().filter(|key| *key < model.key_qpos.len());
    model.key_id(name).or(number).ok_or_else(|| {
        let names = keyframes(model).join(", ");
        let reason = if names.is_empty() {
            format!("{name:?}: the model has no keyframe")
        } else {
            format!("there is no keyframe {name:?}: the model has {names}")
        };
        Error::argument("keyframe", reason)
    })
}
