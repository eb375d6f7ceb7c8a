//! Recorded episodes: the calls of an environment and their results, as JSON.
//!
//! A trace records an environment to the last bit. It has the form of the references recorded
//! from Gymnasium:
//!
//! ```json
//! {"id": "CartPole-v1", "kwargs": {}, "events": [
//!   {"reset": {"seed": 0, "options": null}, "observation": [0.1, 0.2, 0.3, 0.4], "info": {}},
//!   {"step": 1, "observation": [0.1, 0.2, 0.3, 0.4], "reward": 1.0,
//!    "terminated": false, "truncated": false, "info": {}}
//! ]}
//! ```
//!
//! A frame may be recorded as its checksum, `{"crc32": "89abcdef", "shape": [210, 160, 3], "dtype":
//! "uint8"}`.
//!
//! With `"vector": {"num_envs": 3, "autoreset_mode": "NextStep"}` it is a trace of a vector: seeds
//! may be lists, options may contain a `reset_mask`, and each part of an answer has a value per
//! sub-environment.
//!
//! With `"render_mode": "rgb_array"` the environment is rendered once after each event. An event
//! then has the CRC-32 of the frame (`frame`) and of an observation that is an image
//! (`observation_crc32`), and the same with blackened rectangles (`frame_masked`,
//! `observation_masked`), which the trace names: `"frame_mask": [[6, 365, 65, 380]]`, as first
//! column and row, last column and row. A masked checksum replaces the other.

mod compare;
mod event;

use gym_core::registry::{EnvBuilder, find};
use gym_core::render::RenderMode;
use gym_core::vector::{Autoreset, VectorEnv, VectorEnvExt, VectorKind};
use gym_core::{BoxEnv, Env, Error, Kwargs, Result, WrapperSpec, builder, unique};
use serde::de::{Deserializer, Error as _};
use serde::{Deserialize, Serialize};

use compare::FACTS;
use event::remove_clock;
pub use event::{Event, ResetRequest};

/// The resets and steps of one environment, or of one vector.
///
/// An unknown key is an error, so that a misspelt one is not ignored. An environment with an
/// argument `mujoco` gets the recorded version of MuJoCo, unless `kwargs` has another.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Trace {
    /// The environment's id.
    pub id: String,
    /// Its constructor's arguments.
    #[serde(default, deserialize_with = "unique::object")]
    pub kwargs: Kwargs,
    /// The version of MuJoCo that was recorded.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mujoco: Option<String>,
    /// Wrappers around the environment of `make`, innermost first. Such traces leave out the
    /// wall-clock time of episode statistics.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub wrappers: Vec<WrapperSpec>,
    /// The vector around the environment, if the trace is of a vector.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub vector: Option<VectorRequest>,
    /// The render mode, if frames are compared: `rgb_array`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub render_mode: Option<RenderMode>,
    /// Rectangles of the frame to blacken for `frame_masked`: left, top, right, bottom, inclusive.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub frame_mask: Vec<[usize; 4]>,
    /// Rectangles of the observation to blacken for `observation_masked`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub observation_mask: Vec<[usize; 4]>,
    /// What the recorder notes besides. `observation_space`, `action_space`, `max_episode_steps`
    /// and `reward_threshold` are compared; notes such as `numpy` and `policy` are not.
    #[serde(flatten, deserialize_with = "notes")]
    pub about: Kwargs,
    /// The events, in order.
    pub events: Vec<Event>,
}

/// The notes of the recorders.
#[rustfmt::skip]
const NOTES: &[&str] = &[
    // versions of the programs that were recorded
    "ale_py", "backend", "backend_version", "gymnasium", "module", "numpy", "pygame_ce",
    // how the recorder called the environment
    "action_seed", "deep", "info_left_out", "md5", "note", "policy", "rom", "seed", "smoothscale",
    // the environment; see `FACTS`
    "action_space", "dt", "frame_skip", "max_episode_steps", "observation_space", "render_fps",
    "render_modes", "reward_threshold", "shape", "start", "types",
    // facts about the whole episode
    "emulated", "first_contact", "frame", "horizon", "horizons", "info_same_twice", "length",
    "return", "same_twice", "tolerance",
];

/// Reads the notes. A note that no recorder writes is an error, and a duplicate key is an error.
fn notes<'de, D: Deserializer<'de>>(deserializer: D) -> std::result::Result<Kwargs, D::Error> {
    let notes = unique::object(deserializer)?;
    match notes.keys().find(|name| !NOTES.contains(&name.as_str())) {
        Some(name) => Err(D::Error::unknown_field(name, NOTES)),
        None => Ok(notes),
    }
}

/// The vector of a trace.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(
    deny_unknown_fields,
    expecting = "an object with `num_envs`, the vector of a trace"
)]
pub struct VectorRequest {
    /// The number of sub-environments.
    pub num_envs: usize,
    /// When they are reset.
    #[serde(default)]
    pub autoreset_mode: Autoreset,
    /// The kind of vector; the default is sync.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub kind: Option<VectorKind>,
    /// Wrappers around the vector, innermost first.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub wrappers: Vec<WrapperSpec>,
}

impl Trace {
    /// Repeats the resets and steps, and records the answers.
    ///
    /// If the trace has a `state`, the answers have the environment's, which [`Env::inspect`]
    /// shows; such a trace may leave the observation out, and the answers then do so too.
    ///
    /// # Errors
    /// The environment's error, with its event.
    pub fn replay(&self) -> Result<Self> {
        let mut env = self.make()?;
        let (events, spaces) = if self.vector.is_some() {
            let mut envs = self.make_vector()?;
            let mut columns = envs.columns()?;
            let spaces = [envs.observation_space()?, envs.action_space()?];
            let replay = |event: &Event| event.replay_vector(&mut envs, &mut columns);
            (self.replay_events(replay)?, spaces)
        } else {
            let spaces = [env.observation_space(), env.action_space()];
            let replay = |event: &Event| event.replay(self, &mut env);
            (self.replay_events(replay)?, spaces)
        };
        let mut about = self.about.clone();
        let spaces = spaces.map(|space| space.to_string());
        let spec = env.spec();
        for (name, fact) in FACTS {
            if about.remove(name).is_some()
                && let Some(fact) = fact(&spaces, spec.as_ref())
            {
                about.insert(name.to_owned(), fact);
            }
        }
        Ok(Self {
            about,
            events,
            ..self.clone()
        })
    }

    fn replay_events(&self, mut replay: impl FnMut(&Event) -> Result<Event>) -> Result<Vec<Event>> {
        let has_clock = !self.wrappers.is_empty() || self.vector.is_some();
        let mut events = Vec::with_capacity(self.events.len());
        for (i, event) in self.events.iter().enumerate() {
            let mut answer =
                replay(event).map_err(|error| Error::custom(format!("event {i}: {error}")))?;
            if let Some(info) = answer.info.as_mut()
                && has_clock
            {
                remove_clock(info);
            }
            events.push(answer);
        }
        Ok(events)
    }

    /// The environment of the trace, in its wrappers.
    ///
    /// # Errors
    /// The errors of [`make`](gym_core::make), and one for an unknown wrapper.
    pub fn make(&self) -> Result<BoxEnv> {
        self.builder().build()
    }

    /// The vector of the trace, in its wrappers.
    ///
    /// # Errors
    /// The errors of [`make_vec`](gym_core::make_vec), and errors for an unknown wrapper and if
    /// this is the trace of a single environment.
    pub fn make_vector(&self) -> Result<Box<dyn VectorEnv>> {
        let Some(VectorRequest {
            num_envs,
            autoreset_mode,
            kind,
            wrappers,
        }) = &self.vector
        else {
            return Err(Error::custom(
                "this is the trace of one environment, not of a vector",
            ));
        };
        let vector = self.builder().vector(*num_envs).autoreset(*autoreset_mode);
        let envs = vector.kind(kind.unwrap_or(VectorKind::Sync)).build()?;
        wrappers
            .iter()
            .try_fold(envs, |envs, wrapper| wrapper.wrap_vector(envs))
    }

    fn builder(&self) -> EnvBuilder {
        let mut builder = builder(&self.id);
        if let Some(version) = &self.mujoco
            && self.takes("mujoco")
        {
            builder = builder.arg("mujoco", version.as_str());
        }
        builder = builder.args(self.kwargs.clone());
        if let Some(mode) = self.render_mode {
            builder = builder.render_mode(mode);
        }
        self.wrappers
            .iter()
            .cloned()
            .fold(builder, EnvBuilder::wrap)
    }

    /// Whether the environment has an argument.
    fn takes(&self, name: &str) -> bool {
        let taken = find(&self.id).and_then(|registration| registration.arguments());
        taken.is_ok_and(|all| all.iter().any(|argument| argument.name == name))
    }
}

/// The example of the README, compiled.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    /// Every key, with a value that is not its default, is written as it was read; without any of
    /// them a trace has the three that are always there.
    #[test]
    fn a_trace_is_written_as_it_was_read() {
        let of_reset = json!({ "reset": { "seed": 7, "options": { "low": 0.5 } },
            "observation": [1], "info": { "a": [2] }, "state": { "q": 3 }, "frame": 4,
            "frame_masked": 5, "frame_plain": 6, "observation_crc32": 7, "observation_masked": 8 });
        let of_step = json!({ "step": 1, "reward": -0.5, "terminated": true,
            "truncated": false });
        let wrapper = json!({ "name": "Mine", "kwargs": { "n": 3 } });
        let whole = json!({ "id": "None-v0", "kwargs": { "a": 1 }, "mujoco": "3.12",
            "wrappers": [wrapper], "render_mode": "rgb_array", "frame_mask": [[1, 2, 3, 4]],
            "observation_mask": [[5, 6, 7, 8]], "return": 2.5, "events": [of_reset, of_step],
            "vector": { "num_envs": 3, "autoreset_mode": "SameStep", "kind": "async",
                "wrappers": [wrapper] } });
        let again = |json: &serde_json::Value| {
            let trace: Trace = serde_json::from_value(json.clone()).unwrap();
            serde_json::to_value(trace).unwrap()
        };
        assert_eq!(again(&whole), whole);
        let short = json!({ "id": "None-v0", "events": [{ "step": 0 }] });
        let written = json!({ "id": "None-v0", "kwargs": {}, "events": [{ "step": 0 }] });
        assert_eq!(again(&short), written);
        let vector = json!({ "id": "None-v0", "vector": { "num_envs": 2 }, "events": [] });
        let expected = json!({ "num_envs": 2, "autoreset_mode": "NextStep" });
        assert_eq!(again(&vector)["vector"], expected);
    }

    #[test]
    fn a_misspelt_key_is_an_error() {
        for event in [
            json!({ "reset": { "seed": 1 }, "observaton": [0.5] }),
            json!({ "reset": { "sed": 1 }, "observation": [0.5] }),
        ] {
            assert!(serde_json::from_value::<Event>(event).is_err());
        }
        let read = |trace: &str| serde_json::from_str::<Trace>(trace);
        let trace = read(
            r#"{"id": "None-v0", "gymnasium": "1.4.0", "return": 2.5, "kwargs": {"a": 1}, "events": []}"#,
        );
        assert_eq!(trace.unwrap().kwargs["a"], 1);
        for misspelt in ["wrapers", "kwarg", "vectors", "frame_masks", "extra"] {
            let error = read(&format!(
                r#"{{"id": "None-v0", "{misspelt}": [], "events": []}}"#
            ))
            .unwrap_err();
            assert!(
                error
                    .to_string()
                    .contains(&format!("unknown field `{misspelt}`")),
                "{error}"
            );
        }
    }
}
