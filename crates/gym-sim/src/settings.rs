//! What an environment has beside its task and its simulation.

use gym_core::{DType, Error, Snapshot, Space};
use mujoco_engine::Model;
use serde::Serialize;
use serde_json::{Value as Json, json};

/// What an environment has beside its task and its simulation.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Settings {
    /// The environment's name, in snapshots and in the names of wrappers around it.
    pub name: &'static str,
    /// The arguments, as JSON. A snapshot must have the same.
    pub arguments: Json,
    /// The version of the rules, which a snapshot must have too; `None` for tasks of one version.
    pub version: Option<u32>,
    /// The action space. By default, the ranges of the controls, in single precision.
    pub action_space: Option<Space>,
    /// Whether the observation is one vector, with the parts one after the other, instead of a
    /// dict.
    pub flat: bool,
    /// The type of the observation's numbers: double or single precision.
    pub dtype: DType,
    /// Width and height of a picture that is observed instead of numbers.
    pub pixels: Option<u32>,
    /// Width and height of rendered pictures.
    pub size: (u32, u32),
    /// Whether pictures have depths.
    pub depth: bool,
    /// The number of steps of an episode, which can be fractional or infinite.
    pub limit: f64,
    /// Whether starts are drawn from numpy's `RandomState`, as in dm_control.
    pub random_state: bool,
    /// Positions and velocities at the start, instead of those that the task sets.
    pub start: [Option<Vec<f64>>; 2],
    /// A model for pictures whose colours show a reward.
    pub coloured: Option<fn(&Model, f64) -> Model>,
}

impl Settings {
    /// Settings of Gymnasium's kind: a flat observation of doubles, no limit.
    #[must_use]
    pub fn new(name: &'static str, arguments: &impl Serialize) -> Self {
        Self {
            name,
            arguments: serde_json::to_value(arguments).unwrap_or_default(),
            version: None,
            action_space: None,
            flat: true,
            dtype: DType::F64,
            pixels: None,
            size: (480, 480),
            depth: true,
            limit: f64::INFINITY,
            random_state: false,
            start: [None, None],
            coloured: None,
        }
    }

    /// What a snapshot must have.
    pub(crate) fn config(&self) -> Json {
        match self.version {
            Some(version) => json!([version, self.arguments]),
            None => self.arguments.clone(),
        }
    }

    /// The name of the version of MuJoCo in what a snapshot has.
    fn mujoco(&self, config: &Json) -> Option<String> {
        let arguments = match self.version {
            Some(_) => &config[1],
            None => config,
        };
        arguments["mujoco"].as_str().map(str::to_owned)
    }

    /// Improves the error of a snapshot that the environment refuses. If the snapshot is of
    /// another version of MuJoCo, the message names that version.
    pub(crate) fn explain_refusal(&self, snapshot: &Snapshot, error: Error) -> Error {
        /// The part of a snapshot that this function reads.
        #[derive(serde::Deserialize)]
        struct Taken {
            env: String,
            config: Json,
        }
        let Ok(taken) = snapshot.get::<Taken>() else {
            return error;
        };
        match (self.mujoco(&taken.config), self.mujoco(&self.config())) {
            (Some(other), Some(own)) if taken.env == self.name && other != own => {
                let env = self.name;
                Error::Snapshot(format!(
                    "it was taken from a {env} of MuJoCo {other}, and this one is of MuJoCo {own}: restore it into an \
                     environment made with mujoco=\"{other}\""
                ))
            }
            _ => error,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settings_are_of_gymnasiums_kind_unless_given() {
        let Settings {
            name,
            arguments,
            version,
            action_space,
            flat,
            dtype,
            pixels,
            size,
            depth,
            limit,
            random_state,
            start,
            coloured,
        } = Settings::new("Own", &[1, 2]);
        assert_eq!((name, arguments, version), ("Own", json!([1, 2]), None));
        assert_eq!((action_space, flat, dtype), (None, true, DType::F64));
        assert_eq!((pixels, size, depth), (None, (480, 480), true));
        assert_eq!((limit, random_state), (f64::INFINITY, false));
        assert!(start == [None, None] && coloured.is_none());
    }
}
