//! One event of a trace: a reset or a step, and its answer; how it is read, and how it is repeated.

use gym_core::render::Rendered;
use gym_core::vector::{Columns, Seeds, VectorEnv, VectorEnvExt, VectorReset};
use gym_core::{
    BoxEnv, DType, Env, EnvExt, Error, Info, Inspect, Kwargs, Reset, Result, Seed, Value, unique,
};
use serde::de::{Deserializer, Error as _};
use serde::{Deserialize, Serialize};
use serde_json::{Value as Json, json, value::RawValue};

use crate::Trace;

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

impl Event {
    pub(crate) fn replay(&self, trace: &Trace, env: &mut BoxEnv) -> Result<Self> {
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

    pub(crate) fn replay_vector(
        &self,
        envs: &mut dyn VectorEnv,
        columns: &mut Columns,
    ) -> Result<Self> {
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

fn not_an_event() -> Error {
    Error::custom("an event is either a `reset` or a `step`")
}

/// Removes the wall-clock time of episode statistics, which no two runs share.
pub(crate) fn remove_clock(info: &mut Json) {
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

#[cfg(test)]
mod tests {
    use super::*;

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
