//! Arguments by version: which there are, and what they default to.

use gym_core::{Error, Result};
use serde::de::{DeserializeOwned, Error as _};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use serde_json::{Map, Value as Json};

use crate::view::CameraConfig;

/// More timesteps in one step would seem to hang.
const LONGEST_SKIP: usize = 1000;

/// The arguments of a task, in all its versions.
pub trait TaskArguments:
    Clone + PartialEq + Serialize + DeserializeOwned + std::fmt::Debug + Send + Sync + 'static
{
    /// Their default values in a version.
    fn defaults(version: u8) -> Self;

    /// Those that only this task has and that a version takes.
    fn names(version: u8) -> &'static [&'static str];

    /// Those that every task has.
    fn common(&self) -> &Common;
}

/// Arguments that every task has.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Common {
    /// The model: the name of a built-in one, such as `"ant.xml"`, or a path that begins with `.`, `/` or `~`.
    pub xml_file: String,
    /// How many timesteps of the model a step takes.
    pub frame_skip: usize,
    /// The camera's place, where it is not that of the task.
    pub default_camera_config: CameraConfig,
    /// Width of the picture in pixels.
    pub width: u32,
    /// Height of the picture in pixels.
    pub height: u32,
    /// The model's camera that is looked through; -1 is the free one.
    pub camera_id: Option<i32>,
    /// The same by name.
    pub camera_name: Option<String>,
    /// The most geoms that are drawn.
    pub max_geom: usize,
    /// Flags of MuJoCo's viewer by number. They are accepted, and change nothing.
    pub visual_options: Option<Map<String, Json>>,
}

impl Common {
    /// The default values: a model, a frame skip, a camera.
    pub(super) fn new(xml_file: &str, frame_skip: usize, camera: CameraConfig) -> Self {
        Self {
            xml_file: xml_file.to_owned(),
            frame_skip,
            default_camera_config: camera,
            width: 480,
            height: 480,
            camera_id: None,
            camera_name: None,
            max_geom: 1000,
            visual_options: None,
        }
    }

    /// Those that a version takes. Before version 5 the model is an argument of some tasks alone, which name it themselves.
    fn names(version: u8) -> &'static [&'static str] {
        const ALL: [&str; 9] = [
            "width",
            "height",
            "camera_id",
            "camera_name",
            "max_geom",
            "visual_options",
            "xml_file",
            "frame_skip",
            "default_camera_config",
        ];
        match version {
            5.. => &ALL,
            4 => &ALL[..6],
            _ => &[],
        }
    }

    pub(super) fn check(&self) -> Result<()> {
        if !(1..=LONGEST_SKIP).contains(&self.frame_skip) {
            let reason = format!("{} is not from 1 to {LONGEST_SKIP}", self.frame_skip);
            return Err(Error::argument("frame_skip", reason));
        }
        if self.width == 0 || self.height == 0 || self.width > 16_384 || self.height > 16_384 {
            return Err(Error::argument("width and height", "must lie between 1 and 16384 pixels"));
        }
        if self.camera_id.is_some() && self.camera_name.is_some() {
            return Err(Error::argument("camera_id", "does not go with camera_name: give one of them"));
        }
        if let Some(options) = &self.visual_options
            && let Some((flag, value)) =
                options.iter().find(|(flag, value)| flag.parse::<u32>().is_err() || !value.is_boolean())
        {
            return Err(Error::argument(
                "visual_options",
                format!("{flag}: {value} is not a number and true or false"),
            ));
        }
        Ok(())
    }
}

/// The arguments of a task in one version: others are refused, and those not given have that version's values.
#[derive(Clone, Debug, PartialEq)]
pub struct Arguments<C, const VERSION: u8>(pub C);

impl<C: TaskArguments, const VERSION: u8> Arguments<C, VERSION> {
    fn takes(name: &str) -> bool {
        Common::names(VERSION).contains(&name) || C::names(VERSION).contains(&name)
    }
}

impl<C: TaskArguments, const VERSION: u8> Default for Arguments<C, VERSION> {
    fn default() -> Self {
        Self(C::defaults(VERSION))
    }
}

impl<C: TaskArguments, const VERSION: u8> Serialize for Arguments<C, VERSION> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let all = serde_json::to_value(&self.0).map_err(serde::ser::Error::custom)?;
        let taken = all.as_object().into_iter().flatten().filter(|(name, _)| Self::takes(name));
        serializer.collect_map(taken)
    }
}

impl<'de, C: TaskArguments, const VERSION: u8> Deserialize<'de> for Arguments<C, VERSION> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let given: Map<String, Json> = Deserialize::deserialize(deserializer)?;
        let mut all = serde_json::to_value(C::defaults(VERSION)).map_err(D::Error::custom)?;
        let mut arguments = C::defaults(VERSION);
        for (name, value) in given {
            if !Self::takes(&name) {
                let taken: Vec<&str> =
                    all.as_object().into_iter().flatten().map(|(name, _)| &**name).collect();
                let taken: Vec<&str> = taken.into_iter().filter(|name| Self::takes(name)).collect();
                return Err(D::Error::custom(format!(
                    "unknown argument `{name}`: there are {}",
                    taken.join(", ")
                )));
            }
            all[&name] = value;
            // one at a time, so that the message can name the one that is wrong
            arguments = C::deserialize(&all)
                .map_err(|error| D::Error::custom(format!("argument `{name}`: {error}")))?;
        }
        Ok(Self(arguments))
    }
}
