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

use serde::de::IgnoredAny;
use serde::{Deserialize, Serialize};
use serde_json::{Number, Value as Json, json, value::RawValue};

use gym_core::registry::{EnvBuilder, find};
use gym_core::render::{RenderMode, Rendered};
use gym_core::vector::{
    Autoreset, Columns, Seeds, VectorEnv, VectorEnvExt, VectorKind, VectorReset,
};
use gym_core::{
    BoxEnv, DType, Env, EnvExt, Error, Info, Inspect, Kwargs, Reset, Result, Seed, Value,
    WrapperSpec, builder,
};

/// The resets and steps of one environment, or of one vector.
///
/// An unknown key is an error, so that a misspelt one is not ignored. Facts about the recorder,
/// such as `gymnasium` and `numpy`, are accepted and dropped, but for the version of MuJoCo: an
/// environment with an argument `mujoco` gets it, unless `kwargs` has another.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(from = "Recorded")]
pub struct Trace {
    /// The environment's id.
    pub id: String,
    /// Its constructor's arguments.
    pub kwargs: Kwargs,
    /// The version of MuJoCo that was recorded.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mujoco: Option<String>,
    /// Wrappers around the environment of `make`, innermost first. Such traces leave out the
    /// wall-clock time of episode statistics.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub wrappers: Vec<WrapperSpec>,
    /// The vector that it is a sub-environment of, if it is one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub vector: Option<VectorRequest>,
    /// The render mode, if frames are compared: `rgb_array`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub render_mode: Option<RenderMode>,
    /// Rectangles of the frame to blacken for `frame_masked`: left, top, right, bottom, inclusive.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub frame_mask: Vec<[usize; 4]>,
    /// The same for `observation_masked`.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub observation_mask: Vec<[usize; 4]>,
    /// The events, in order.
    pub events: Vec<Event>,
}

/// Declares the keys of a trace: its own, and the recorders'.
macro_rules! recorded {
    ($($about:ident)*) => {
        #[derive(Deserialize)]
        #[serde(deny_unknown_fields)]
        #[expect(dead_code, reason = "a recorder's notes are read and not used")]
        struct Recorded {
            id: String,
            #[serde(default)]
            kwargs: Kwargs,
            mujoco: Option<String>,
            #[serde(default)]
            wrappers: Vec<WrapperSpec>,
            vector: Option<VectorRequest>,
            render_mode: Option<RenderMode>,
            #[serde(default)]
            frame_mask: Vec<[usize; 4]>,
            #[serde(default)]
            observation_mask: Vec<[usize; 4]>,
            events: Vec<Event>,
            $(
                #[serde(default)]
                $about: IgnoredAny,
            )*
        }
    };
}

recorded! {
    // the programs that answered
    ale_py backend backend_version gymnasium module numpy pygame_ce
    // how they were asked
    action_seed deep info_left_out max_episode_steps md5 note policy rom seed smoothscale
    // the environment
    action_space dt frame_skip observation_space render_fps render_modes reward_threshold shape start types
    // facts about the whole episode
    emulated first_contact frame horizon horizons info_same_twice length r#return same_twice tolerance
}

impl From<Recorded> for Trace {
    fn from(recorded: Recorded) -> Self {
        let Recorded {
            id,
            kwargs,
            mujoco,
            wrappers,
            vector,
            render_mode,
            frame_mask,
            observation_mask,
            events,
            ..
        } = recorded;
        Self {
            id,
            kwargs,
            mujoco,
            wrappers,
            vector,
            render_mode,
            frame_mask,
            observation_mask,
            events,
        }
    }
}

/// The vector of a trace.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
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

/// One reset or one step, and the answer to it.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Event {
    /// The request, if this is a reset.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reset: Option<ResetRequest>,
    /// The action, if this is a step.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub step: Option<Json>,
    /// The observation.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub observation: Option<Json>,
    /// The reward of a step.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reward: Option<Json>,
    /// Whether a step ended the task.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub terminated: Option<Json>,
    /// Whether a step was the last for another reason.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub truncated: Option<Json>,
    /// The entries of `info`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub info: Option<Json>,
    /// State beyond the observation, if the trace has it: the bodies of a CarRacing, whose
    /// observation is an image.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub state: Option<Json>,
    /// CRC-32 of the frame's bytes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub frame: Option<Json>,
    /// The same of the masked frame.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub frame_masked: Option<Json>,
    /// The checksum of the frame without images that Gymnasium loads from a file. It is read, and
    /// not compared.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub frame_plain: Option<Json>,
    /// CRC-32 of an observation's bytes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub observation_crc32: Option<Json>,
    /// The same of the masked observation.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub observation_masked: Option<Json>,
}

/// Seed and options of a reset.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ResetRequest {
    /// The seed, of any size, or a list of them; its digits are kept as they are written.
    seed: Option<Box<RawValue>>,
    /// The options.
    options: Option<Kwargs>,
}

impl From<&Reset> for ResetRequest {
    fn from(reset: &Reset) -> Self {
        let seed = reset
            .seed
            .as_ref()
            .and_then(|seed| RawValue::from_string(seed.to_string()).ok());
        Self {
            seed,
            options: (!reset.options.is_empty()).then(|| reset.options.clone()),
        }
    }
}

impl TryFrom<&ResetRequest> for Reset {
    type Error = Error;

    fn try_from(request: &ResetRequest) -> Result<Self> {
        let seed = request
            .seed
            .as_ref()
            .map(|digits| digits.get().parse::<Seed>())
            .transpose()?;
        Ok(Self {
            seed,
            options: request.options.clone().unwrap_or_default(),
        })
    }
}

impl TryFrom<&ResetRequest> for VectorReset {
    type Error = Error;

    fn try_from(request: &ResetRequest) -> Result<Self> {
        let invalid =
            |error: serde_json::Error| Error::custom(format!("the reset of a vector: {error}"));
        let seeds = match &request.seed {
            None => Seeds::None,
            Some(list) if list.get().starts_with('[') => {
                let list: Vec<Option<&RawValue>> =
                    serde_json::from_str(list.get()).map_err(invalid)?;
                let seeds = list
                    .into_iter()
                    .map(|seed| seed.map(|digits| digits.get().parse()).transpose());
                Seeds::Each(seeds.collect::<Result<_, _>>()?)
            }
            Some(digits) => Seeds::From(digits.get().parse()?),
        };
        let mut options = request.options.clone().unwrap_or_default();
        let mask = options
            .remove("reset_mask")
            .map(serde_json::from_value)
            .transpose()
            .map_err(invalid)?;
        Ok(Self {
            seeds,
            options,
            mask,
        })
    }
}

impl Trace {
    /// Repeats the resets and steps, and records the answers.
    ///
    /// If the trace has a `state`, the answers have the environment's, which
    /// [`Env::inspect`] shows; such a trace may leave the observation out, and the answers then do so
    /// too.
    ///
    /// # Errors
    /// The environment's error, with its event.
    pub fn replay(&self) -> Result<Self> {
        let events = if self.vector.is_some() {
            let mut envs = self.make_vector()?;
            let mut columns = envs.columns()?;
            self.replay_events(|event| event.replay_vector(&mut envs, &mut columns))
        } else {
            let mut env = self.make()?;
            self.replay_events(|event| event.replay(self, &mut env))
        };
        Ok(Self {
            events: events?,
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
        let taken = find(&self.id).and_then(|registration| registration.arguments());
        let takes = |name| taken.is_ok_and(|all| all.iter().any(|argument| argument.name == name));
        if let Some(version) = &self.mujoco
            && takes("mujoco")
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

    /// The first difference from another trace of the same calls: the event, the part of it, and
    /// both answers. Numbers are compared to the last bit.
    ///
    /// A part of the answers that no event of this trace records, such as `info`, is not compared.
    pub fn first_difference(&self, other: &Self) -> Option<String> {
        if self.events.len() != other.events.len() {
            return Some(format!(
                "{} events for {}",
                other.events.len(),
                self.events.len()
            ));
        }
        let mut recorded = PARTS.to_vec();
        recorded.retain(|(_, part)| self.events.iter().any(|event| part(event).is_some()));
        // a masked checksum counts instead of the other
        for (masked, plain) in [
            ("frame_masked", "frame"),
            ("observation_masked", "observation_crc32"),
        ] {
            if recorded.iter().any(|(name, _)| *name == masked) {
                recorded.retain(|(name, _)| *name != plain);
            }
        }
        self.events
            .iter()
            .zip(&other.events)
            .enumerate()
            .find_map(|(i, (a, b))| {
                recorded.iter().find_map(|(name, part)| {
                    let [a, b] = [a, b].map(|event| part(event).unwrap_or(&Json::Null));
                    (!same(a, b)).then(|| format!("event {i}, {name}: {b} for {a}"))
                })
            })
    }
}

/// A part of an answer: its name and its value.
type Part = (&'static str, fn(&Event) -> Option<&Json>);

/// The compared parts.
const PARTS: [Part; 10] = [
    ("observation", |event| event.observation.as_ref()),
    ("reward", |event| event.reward.as_ref()),
    ("terminated", |event| event.terminated.as_ref()),
    ("truncated", |event| event.truncated.as_ref()),
    ("info", |event| event.info.as_ref()),
    ("state", |event| event.state.as_ref()),
    ("frame", |event| event.frame.as_ref()),
    ("frame_masked", |event| event.frame_masked.as_ref()),
    ("observation_crc32", |event| {
        event.observation_crc32.as_ref()
    }),
    ("observation_masked", |event| {
        event.observation_masked.as_ref()
    }),
];

impl Event {
    fn replay(&self, trace: &Trace, env: &mut BoxEnv) -> Result<Self> {
        let mut observed = Value::Null;
        let mut answer = match (&self.reset, &self.step) {
            (Some(request), None) => {
                env.reset_into(&Reset::try_from(request)?, &mut observed)?;
                Self::default()
            }
            (None, Some(action)) => {
                let step = env.step_into(&env.action_space().from_json(action)?, &mut observed)?;
                Self {
                    reward: Some(json!(step.reward)),
                    terminated: Some(json!(step.terminated)),
                    truncated: Some(json!(step.truncated)),
                    ..Self::default()
                }
            }
            _ => return Err(not_an_event()),
        };
        answer.reset.clone_from(&self.reset);
        answer.step.clone_from(&self.step);
        answer.info = Some(plain(env.info_map()));
        if self.state.is_some() {
            answer.state = env.inspect().and_then(Inspect::state);
        }
        // frames are compared by checksums
        if self.observation.is_some() || (self.state.is_none() && trace.render_mode.is_none()) {
            answer.observation = Some(self.recorded(&observed));
        }
        if trace.render_mode.is_some()
            && let Rendered::Frame(frame) = env.render()?
        {
            let width = frame.width() as usize;
            answer.frame = Some(json!(crc32fast::hash(frame.pixels())));
            answer.frame_masked = masked(frame.pixels(), width, &trace.frame_mask);
            if let Value::Array(picture) = &observed
                && let (Some(pixels), &[_, width, 3]) = (picture.as_slice::<u8>(), picture.shape())
            {
                answer.observation_crc32 = Some(json!(crc32fast::hash(pixels)));
                answer.observation_masked = masked(pixels, width, &trace.observation_mask);
            }
        }
        Ok(answer)
    }

    /// An observation in the form of this event's: its numbers, or their checksum.
    fn recorded(&self, observation: &Value) -> Json {
        let as_checksum = self
            .observation
            .as_ref()
            .is_some_and(|recorded| recorded.get("crc32").is_some());
        match observation {
            Value::Array(array) if as_checksum && array.dtype() == DType::U8 => {
                let bytes = array.as_slice::<u8>().unwrap_or_default();
                let crc32 = format!("{:08x}", crc32fast::hash(bytes));
                json!({"crc32": crc32, "shape": array.shape(), "dtype": array.dtype().name()})
            }
            _ => observation.to_json(),
        }
    }

    fn replay_vector(&self, envs: &mut dyn VectorEnv, columns: &mut Columns) -> Result<Self> {
        let mut answer = Self {
            reset: self.reset.clone(),
            step: self.step.clone(),
            ..Self::default()
        };
        match (&self.reset, &self.step) {
            (Some(request), None) => envs.reset_into(&request.try_into()?, columns)?,
            (None, Some(actions)) => {
                envs.step_into(&envs.action_space()?.from_json(actions)?, columns)?;
                answer.reward = Some(json!(columns.rewards));
                answer.terminated = Some(json!(columns.terminated));
                answer.truncated = Some(json!(columns.truncated));
            }
            _ => return Err(not_an_event()),
        }
        answer.observation = Some(columns.observations.to_json());
        answer.info = Some(plain(envs.infos(columns)));
        Ok(answer)
    }
}

fn plain(info: Info) -> Json {
    info.into_iter()
        .map(|(key, value)| (key, value.to_json()))
        .collect()
}

/// The checksum of an image of 3 bytes per pixel, with the rectangles blackened.
fn masked(pixels: &[u8], width: usize, rectangles: &[[usize; 4]]) -> Option<Json> {
    let mut pixels = pixels.to_vec();
    for (y, row) in pixels.chunks_exact_mut((3 * width).max(3)).enumerate() {
        for (x, pixel) in row.chunks_exact_mut(3).enumerate() {
            if rectangles
                .iter()
                .any(|[l, t, r, b]| (l..=r).contains(&&x) && (t..=b).contains(&&y))
            {
                pixel.fill(0);
            }
        }
    }
    (!rectangles.is_empty()).then(|| json!(crc32fast::hash(&pixels)))
}

fn not_an_event() -> Error {
    Error::custom("an event is either a `reset` or a `step`")
}

/// Removes the wall-clock time of episode statistics, which no two runs share.
fn remove_clock(info: &mut Json) {
    if let Json::Object(info) = info {
        if let Some(Json::Object(episode)) = info.get_mut("episode") {
            episode.remove("t");
            episode.remove("_t");
        }
        if let Some(final_info) = info.get_mut("final_info") {
            remove_clock(final_info);
        }
    }
}

/// Equality of JSON data to the last bit, where `1` and `1.0` are the same number, and `0.0` and
/// `-0.0` are not.
fn same(a: &Json, b: &Json) -> bool {
    match (a, b) {
        (Json::Number(x), Json::Number(y)) => same_number(x, y),
        (Json::Array(x), Json::Array(y)) => {
            x.len() == y.len() && x.iter().zip(y).all(|(x, y)| same(x, y))
        }
        (Json::Object(x), Json::Object(y)) => {
            x.len() == y.len()
                && x.iter()
                    .all(|(key, x)| y.get(key).is_some_and(|y| same(x, y)))
        }
        _ => a == b,
    }
}

fn same_number(x: &Number, y: &Number) -> bool {
    let integer = |n: &Number| {
        n.as_i64()
            .map(i128::from)
            .or_else(|| n.as_u64().map(i128::from))
    };
    let real = |n: &Number| n.as_f64().unwrap_or(f64::NAN);
    match (integer(x), integer(y)) {
        (Some(x), Some(y)) => x == y,
        (None, None) => real(x).to_bits() == real(y).to_bits(),
        // an integer beyond 2^53 need not be the number that it rounds to
        (Some(i), None) => is_integer(real(y), i),
        (None, Some(i)) => is_integer(real(x), i),
    }
}

/// Whether a real number is just this integer. `-0.0` is none.
fn is_integer(x: f64, i: i128) -> bool {
    x.to_bits() == (i as f64).to_bits() && x as i128 == i
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_compared_to_the_last_bit() {
        let same = |a: &str, b: &str| {
            same(
                &serde_json::from_str(a).unwrap(),
                &serde_json::from_str(b).unwrap(),
            )
        };
        for (a, b) in [
            ("1", "1.0"),
            ("0", "0.0"),
            ("-0.0", "-0.0"),
            ("9007199254740992", "9007199254740992.0"),
            ("[1, {\"a\": 2}]", "[1.0, {\"a\": 2.0}]"),
        ] {
            assert!(same(a, b) && same(b, a), "{a} {b}");
        }
        for (a, b) in [
            ("0.0", "-0.0"),
            ("0", "-0.0"),
            ("9007199254740993", "9007199254740992"),
            ("9007199254740993", "9007199254740992.0"),
            ("18446744073709551615", "18446744073709551614"),
            ("0.1", "0.10000000000000002"),
            ("{}", "{\"surplus\": 1}"),
            ("[1]", "[1, 1]"),
            ("true", "1"),
        ] {
            assert!(!same(a, b) && !same(b, a), "{a} {b}");
        }
    }

    fn trace(events: impl Into<Json>) -> Trace {
        let events: Json = events.into();
        serde_json::from_value(json!({ "id": "None-v0", "events": events })).unwrap()
    }

    #[test]
    fn every_recorded_part_is_compared() {
        let reset = json!({ "reset": { "seed": 1, "options": null }, "observation": [0.5], "info": { "a": 1 } });
        let step = json!({ "step": 0, "observation": [0.5], "reward": 1.0, "terminated": false, "truncated": false,
            "info": {}, "state": [1] });
        let recorded = trace(json!([reset, step]));
        assert_eq!(recorded.first_difference(&recorded), None);
        for part in [
            "observation",
            "reward",
            "terminated",
            "truncated",
            "info",
            "state",
        ] {
            let mut other = step.clone();
            other[part] = json!("another");
            let difference = recorded
                .first_difference(&trace(json!([reset, other])))
                .unwrap();
            assert!(
                difference.starts_with(&format!("event 1, {part}")),
                "{difference}"
            );
            // a part that one event leaves out is not compared
            let mut lacking = step.clone();
            lacking.as_object_mut().unwrap().remove(part);
            assert!(
                recorded
                    .first_difference(&trace(json!([reset, lacking])))
                    .is_some(),
                "{part}"
            );
            let mut both = json!([reset, lacking, step]);
            let recorded = trace(both.clone());
            both[1][part] = json!("surplus");
            assert!(recorded.first_difference(&trace(both)).is_some(), "{part}");
        }
    }

    /// The masked checksum, if present, replaces the whole frame's.
    #[test]
    fn a_masked_checksum_stands_for_the_other() {
        let event = |frame: u32, masked: Option<u32>| {
            let mut event = json!({ "step": 0, "reward": 1.0, "frame": frame });
            if let Some(masked) = masked {
                event["frame_masked"] = masked.into();
            }
            trace(json!([event]))
        };
        let masked = event(1, Some(5));
        assert_eq!(masked.first_difference(&event(2, Some(5))), None);
        assert!(
            masked
                .first_difference(&event(1, Some(6)))
                .unwrap()
                .starts_with("event 0, frame_masked")
        );
        assert!(
            event(1, None)
                .first_difference(&event(2, None))
                .unwrap()
                .starts_with("event 0, frame:")
        );
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
