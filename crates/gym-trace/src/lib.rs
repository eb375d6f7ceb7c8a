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

use serde::de::{Deserializer, Error as _};
use serde::{Deserialize, Serialize};
use serde_json::{Number, Value as Json, json, value::RawValue};

use gym_core::registry::{EnvBuilder, find};
use gym_core::render::{RenderMode, Rendered};
use gym_core::vector::{
    Autoreset, Columns, Seeds, VectorEnv, VectorEnvExt, VectorKind, VectorReset,
};
use gym_core::{
    BoxEnv, DType, Env, EnvExt, EnvSpec, Error, Info, Inspect, Kwargs, Reset, Result, Seed, Value,
    WrapperSpec, builder, unique,
};

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

/// A fact about the environment that a recording notes and the comparison checks: its name in
/// [`Trace::about`], and a function that computes the fact from the observation space, the action
/// space and the spec, if there is one.
type Fact = (
    &'static str,
    fn(&[String; 2], Option<&EnvSpec>) -> Option<Json>,
);

const FACTS: [Fact; 4] = [
    ("observation_space", |spaces, _| Some(json!(spaces[0]))),
    ("action_space", |spaces, _| Some(json!(spaces[1]))),
    ("max_episode_steps", |_, spec| {
        Some(json!(spec?.max_episode_steps))
    }),
    ("reward_threshold", |_, spec| {
        Some(json!(spec?.reward_threshold))
    }),
];

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

/// One reset or one step, and the result.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(
    deny_unknown_fields,
    expecting = "an event, which is an object with `reset` or `step`"
)]
pub struct Event {
    /// The request, if this is a reset.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reset: Option<ResetRequest>,
    /// The action, if this is a step.
    #[serde(
        default,
        deserialize_with = "unique::option",
        skip_serializing_if = "Option::is_none"
    )]
    pub step: Option<Json>,
    /// The observation.
    #[serde(
        default,
        deserialize_with = "unique::option",
        skip_serializing_if = "Option::is_none"
    )]
    pub observation: Option<Json>,
    /// The reward of a step.
    #[serde(
        default,
        deserialize_with = "unique::option",
        skip_serializing_if = "Option::is_none"
    )]
    pub reward: Option<Json>,
    /// Whether a step ended the task.
    #[serde(
        default,
        deserialize_with = "unique::option",
        skip_serializing_if = "Option::is_none"
    )]
    pub terminated: Option<Json>,
    /// Whether a step ended the episode for another reason, such as a time limit.
    #[serde(
        default,
        deserialize_with = "unique::option",
        skip_serializing_if = "Option::is_none"
    )]
    pub truncated: Option<Json>,
    /// The entries of `info`.
    #[serde(
        default,
        deserialize_with = "unique::option",
        skip_serializing_if = "Option::is_none"
    )]
    pub info: Option<Json>,
    /// State beyond the observation, if the trace has it: the bodies of a CarRacing, whose
    /// observation is an image.
    #[serde(
        default,
        deserialize_with = "unique::option",
        skip_serializing_if = "Option::is_none"
    )]
    pub state: Option<Json>,
    /// CRC-32 of the frame's bytes.
    #[serde(
        default,
        deserialize_with = "unique::option",
        skip_serializing_if = "Option::is_none"
    )]
    pub frame: Option<Json>,
    /// CRC-32 of the masked frame's bytes.
    #[serde(
        default,
        deserialize_with = "unique::option",
        skip_serializing_if = "Option::is_none"
    )]
    pub frame_masked: Option<Json>,
    /// The checksum of the frame without images that Gymnasium loads from a file. The comparison
    /// ignores the checksum.
    #[serde(
        default,
        deserialize_with = "unique::option",
        skip_serializing_if = "Option::is_none"
    )]
    pub frame_plain: Option<Json>,
    /// CRC-32 of an observation's bytes.
    #[serde(
        default,
        deserialize_with = "unique::option",
        skip_serializing_if = "Option::is_none"
    )]
    pub observation_crc32: Option<Json>,
    /// CRC-32 of the masked observation's bytes.
    #[serde(
        default,
        deserialize_with = "unique::option",
        skip_serializing_if = "Option::is_none"
    )]
    pub observation_masked: Option<Json>,
}

/// Seed and options of a reset.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ResetRequest {
    /// The seed, of any size, or a list of seeds. The digits are kept as written.
    seed: Option<Box<RawValue>>,
    /// The options.
    #[serde(default, deserialize_with = "options")]
    options: Option<Kwargs>,
}

/// Reads options, which may be `null`.
fn options<'de, D: Deserializer<'de>>(
    deserializer: D,
) -> std::result::Result<Option<Kwargs>, D::Error> {
    match unique::option(deserializer)? {
        Some(options) => unique::object(options).map(Some).map_err(D::Error::custom),
        None => Ok(None),
    }
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

    /// The first difference from another trace of the same calls: a fact about the environment, or
    /// the event, the part of it, the place in that part, and both answers. Numbers are compared to
    /// the last bit.
    ///
    /// What [`compared`](Self::compared) leaves out is not compared.
    pub fn first_difference(&self, other: &Self) -> Option<String> {
        let fact = FACTS.iter().find_map(|(name, _)| {
            let noted = self.about.get(*name)?;
            let Some(here) = other.about.get(*name) else {
                return Some(format!("{name}: nothing for {}", start_of(noted)));
            };
            difference(&one_line(noted), &one_line(here))
                .map(|difference| format!("{name}{difference}"))
        });
        if fact.is_some() {
            return fact;
        }
        if self.events.len() != other.events.len() {
            return Some(format!(
                "{} events for {}",
                other.events.len(),
                self.events.len()
            ));
        }
        let parts = self.parts();
        self.events
            .iter()
            .zip(&other.events)
            .enumerate()
            .find_map(|(i, (a, b))| {
                parts.iter().find_map(|(name, part)| {
                    let [a, b] = [a, b].map(|event| part(event).unwrap_or(&Json::Null));
                    difference(a, b).map(|difference| format!("event {i}, {name}{difference}"))
                })
            })
    }

    /// The names of what [`first_difference`](Self::first_difference) compares: parts of answers
    /// that some event of this trace records, and facts about the environment. Without a part of an
    /// answer, equality proves nothing.
    pub fn compared(&self) -> (Vec<&'static str>, Vec<&'static str>) {
        let parts = self.parts().into_iter().map(|(name, _)| name).collect();
        let facts = FACTS.iter().map(|(name, _)| *name);
        let facts = facts.filter(|name| self.about.contains_key(*name));
        (parts, facts.collect())
    }

    /// The names of what this trace records and nothing compares.
    pub fn not_compared(&self) -> Vec<&str> {
        let notes = self.about.keys().map(String::as_str);
        let notes = notes.filter(|name| FACTS.iter().all(|(fact, _)| fact != name));
        let (parts, _) = self.compared();
        let recorded = PARTS.iter().chain(&[FRAME_PLAIN]).filter(|(name, part)| {
            !parts.contains(name) && self.events.iter().any(|event| part(event).is_some())
        });
        let recorded = recorded.map(|(name, _)| *name);
        notes.chain(recorded).chain(self.unused()).collect()
    }

    /// Iterates over the names of settings on which no event depends: a version of MuJoCo for an
    /// environment without this argument, and settings of pictures if the trace has no checksum of
    /// a picture.
    fn unused(&self) -> impl Iterator<Item = &str> {
        let parts = self.parts();
        let has = |part: &str| parts.iter().any(|(name, _)| *name == part);
        let shows = PICTURES.iter().any(|name| has(name));
        let named = |name, is_unused: bool| is_unused.then_some(name);
        let mujoco =
            self.mujoco.is_some() && (!self.takes("mujoco") || self.kwargs.contains_key("mujoco"));
        [
            named("mujoco", mujoco),
            named("render_mode", self.render_mode.is_some() && !shows),
            named(
                "frame_mask",
                !self.frame_mask.is_empty() && !has("frame_masked"),
            ),
            named(
                "observation_mask",
                !self.observation_mask.is_empty() && !has("observation_masked"),
            ),
        ]
        .into_iter()
        .flatten()
    }

    /// Whether the environment has an argument.
    fn takes(&self, name: &str) -> bool {
        let taken = find(&self.id).and_then(|registration| registration.arguments());
        taken.is_ok_and(|all| all.iter().any(|argument| argument.name == name))
    }

    /// The parts of answers that are compared.
    fn parts(&self) -> Vec<Part> {
        let mut recorded = PARTS.to_vec();
        recorded.retain(|(_, part)| self.events.iter().any(|event| part(event).is_some()));
        // if a masked checksum is recorded, the checksum of the whole picture is not compared
        for (masked, plain) in [
            ("frame_masked", "frame"),
            ("observation_masked", "observation_crc32"),
        ] {
            if recorded.iter().any(|(name, _)| *name == masked) {
                recorded.retain(|(name, _)| *name != plain);
            }
        }
        recorded
    }
}

/// A text with single spaces, since numpy aligns numbers in columns and breaks lines; any other
/// JSON as it is.
fn one_line(json: &Json) -> Json {
    match json {
        Json::String(text) => text.split_whitespace().collect::<Vec<_>>().join(" ").into(),
        other => other.clone(),
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

/// The parts that need pictures.
const PICTURES: [&str; 4] = [
    "frame",
    "frame_masked",
    "observation_crc32",
    "observation_masked",
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

/// The checksum of an image of 3 bytes per pixel, in which `rectangles` are blackened.
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

/// The part of an event that is read, and not compared.
const FRAME_PLAIN: Part = ("frame_plain", |event| event.frame_plain.as_ref());

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

/// Describes the first difference of two JSON values, by its place and both values there: `[3]: 1
/// for 2`. Numbers are compared to the last bit; `1` and `1.0` are the same number, and `0.0` and
/// `-0.0` are not.
fn difference(a: &Json, b: &Json) -> Option<String> {
    let inside = |place: String, a: &Json, b: &Json| {
        difference(a, b).map(|difference| format!("{place}{difference}"))
    };
    match (a, b) {
        (Json::Number(x), Json::Number(y)) if same_number(x, y) => None,
        (Json::Array(x), Json::Array(y)) if x.len() == y.len() => {
            let mut pairs = x.iter().zip(y).enumerate();
            pairs.find_map(|(i, (x, y))| inside(format!("[{i}]"), x, y))
        }
        (Json::Object(x), Json::Object(y)) => {
            let of_both = x.iter().find_map(|(key, x)| match y.get(key) {
                Some(y) => inside(format!(".{key}"), x, y),
                None => Some(format!(".{key}: nothing for {}", start_of(x))),
            });
            let surplus = || y.iter().find(|(key, _)| !x.contains_key(*key));
            of_both.or_else(|| {
                surplus().map(|(key, y)| format!(".{key}: {} for nothing", start_of(y)))
            })
        }
        _ if a == b && !a.is_number() => None,
        _ => Some(format!(": {} for {}", start_of(b), start_of(a))),
    }
}

/// The start of a value as JSON.
fn start_of(json: &Json) -> String {
    const MAX_LENGTH: usize = 100;
    if let Json::Array(list) = json
        && list.len() > 20
    {
        return format!("a list of {}", list.len());
    }
    let text = json.to_string();
    match text.char_indices().nth(MAX_LENGTH) {
        Some((end, _)) => format!("{}...", &text[..end]),
        None => text,
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
        // an integer above 2^53 may differ from the real number that it rounds to
        (Some(i), None) => is_integer(real(y), i),
        (None, Some(i)) => is_integer(real(x), i),
    }
}

/// Whether a real number equals an integer exactly. `-0.0` equals no integer.
fn is_integer(x: f64, i: i128) -> bool {
    x.to_bits() == (i as f64).to_bits() && x as i128 == i
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_compared_to_the_last_bit() {
        let same = |a: &str, b: &str| {
            let [a, b] = [a, b].map(|text| serde_json::from_str(text).unwrap());
            difference(&a, &b).is_none()
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
            ("{}", "{\"surplus\": null}"),
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
            // the comparison ignores a field that one of the events lacks
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

    #[test]
    fn a_difference_has_a_place_and_no_more_numbers_than_it_needs() {
        let of = |a: Json, b: Json| difference(&a, &b).unwrap();
        let many: Vec<f64> = (0..1_000_000).map(f64::from).collect();
        let mut other = many.clone();
        other[654_321] = -1.0;
        assert_eq!(of(json!(many), json!(other)), "[654321]: -1.0 for 654321.0");
        assert_eq!(
            of(json!(many), json!([1, 2])),
            ": [1,2] for a list of 1000000"
        );
        assert_eq!(
            of(json!({"a": [1, {"b": 2}]}), json!({"a": [1, {"b": 3}]})),
            ".a[1].b: 3 for 2"
        );
        assert_eq!(of(json!({"a": null}), json!({})), ".a: nothing for null");
        assert_eq!(of(json!({}), json!({"a": 1})), ".a: 1 for nothing");
        let long = "x".repeat(1_000_000);
        assert!(of(json!(long), json!("y")).len() < 200);
    }

    /// Facts about the environment are compared, `null` too, and the other notes are named.
    #[test]
    fn facts_in_the_head_are_compared_and_notes_named() {
        let head = json!({ "id": "None-v0", "numpy": "2.4.6", "policy": "random", "return": 1.0,
            "observation_space": "Box([0.  1.],\n [1. 2.])", "action_space": "Discrete(2)",
            "max_episode_steps": null, "reward_threshold": 195.0,
            "events": [{ "step": 0, "reward": 1.0, "frame_plain": 3 }] });
        let read = |json: &Json| serde_json::from_value::<Trace>(json.clone()).unwrap();
        let recorded = read(&head);
        assert_eq!(recorded.first_difference(&recorded), None);
        assert_eq!(
            recorded.not_compared(),
            ["numpy", "policy", "return", "frame_plain"]
        );
        let mut unused = head.clone();
        unused["mujoco"] = json!("3.12");
        unused["render_mode"] = json!("rgb_array");
        for mask in ["frame_mask", "observation_mask"] {
            unused[mask] = json!([[0, 0, 1, 1]]);
        }
        let named = ["mujoco", "render_mode", "frame_mask", "observation_mask"];
        assert_eq!(read(&unused).not_compared()[4..], named);
        unused["events"] = json!([{ "step": 0, "frame_masked": 1, "observation_masked": 2 }]);
        assert_eq!(read(&unused).not_compared()[3..], ["mujoco"]);
        let facts = FACTS.map(|(name, _)| name);
        assert_eq!(recorded.compared(), (vec!["reward"], facts.to_vec()));
        for (name, value) in [
            ("observation_space", json!("Box([0. 1.], [1. 3.])")),
            ("action_space", json!("Discrete(3)")),
            ("max_episode_steps", json!(200)),
            ("reward_threshold", json!(null)),
        ] {
            let mut other = head.clone();
            other[name] = value;
            let difference = recorded.first_difference(&read(&other)).unwrap();
            assert!(difference.starts_with(name), "{difference}");
            other.as_object_mut().unwrap().remove(name);
            let difference = recorded.first_difference(&read(&other)).unwrap();
            assert!(difference.contains("nothing for"), "{difference}");
            assert_eq!(
                read(&other).first_difference(&recorded),
                None,
                "it is not recorded"
            );
        }
        // columns and lines of numpy's text
        let mut other = head.clone();
        other["observation_space"] = json!("Box([0. 1.], [1. 2.])");
        assert_eq!(recorded.first_difference(&read(&other)), None);
        // writing keeps the notes
        assert_eq!(serde_json::to_value(&recorded).unwrap()["numpy"], "2.4.6");
        assert_eq!(
            trace(json!([{ "step": 0 }])).compared(),
            (vec![], vec![]),
            "an event without answers proves nothing"
        );
    }

    /// A masked checksum, if present, replaces the checksum of the whole frame.
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

    /// A rectangle has its first and its last row and column, and may reach beyond the picture.
    #[test]
    fn masks_have_both_ends() {
        let pixels: Vec<u8> = (1..=36).collect();
        for (rectangles, places) in [
            (vec![[1, 1, 1, 1]], vec![4]),
            (vec![[0, 0, 2, 0]], vec![0, 1, 2]),
            (vec![[2, 1, 2, 3]], vec![5, 8, 11]),
            (vec![[0, 3, 9, 9], [0, 0, 0, 0]], vec![0, 9, 10, 11]),
        ] {
            let mut expected = pixels.clone();
            for place in places {
                expected[3 * place..][..3].fill(0);
            }
            let checksum = json!(crc32fast::hash(&expected));
            assert_eq!(masked(&pixels, 3, &rectangles), Some(checksum));
        }
        assert_eq!(masked(&pixels, 3, &[]), None);
    }

    #[test]
    fn the_clock_is_removed_from_final_infos_too() {
        let episode = json!({ "r": 1.0, "t": 0.5, "_t": [true] });
        let mut info = json!({ "t": 1, "episode": episode,
            "final_info": { "episode": episode, "final_info": { "episode": episode } } });
        remove_clock(&mut info);
        let rest = json!({ "r": 1.0 });
        let expected = json!({ "t": 1, "episode": rest,
            "final_info": { "episode": rest, "final_info": { "episode": rest } } });
        assert_eq!(info, expected);
    }

    /// A list has a seed or `null` for each sub-environment.
    #[test]
    fn seeds_keep_their_places() {
        let reset = |json: Json| {
            let request: ResetRequest = serde_json::from_value(json).unwrap();
            VectorReset::try_from(&request)
        };
        let seeds = reset(json!({ "seed": [5, null, 7] })).unwrap().seeds;
        let each = [Some(5_u64), None, Some(7)].map(|seed| seed.map(Seed::from));
        assert_eq!(seeds, Seeds::Each(each.to_vec()));
        let from = reset(json!({ "seed": 5 })).unwrap().seeds;
        assert_eq!(from, Seeds::From(5_u64.into()));
        assert_eq!(reset(json!({ "seed": null })).unwrap().seeds, Seeds::None);
        let masked = json!({ "options": { "reset_mask": [true, false], "low": 1 } });
        let masked = reset(masked).unwrap();
        assert_eq!(masked.mask, Some(vec![true, false]));
        assert_eq!(masked.options.len(), 1);
        for wrong in [json!([1, -1]), json!(["x"]), json!([1.5])] {
            assert!(reset(json!({ "seed": wrong })).is_err(), "{wrong}");
        }
    }
}
