//! The arguments that all tasks share.

use gym_core::{Arguments, Error, Result};
use serde_json::{Map, Value as Json};

use crate::version::Version;
use crate::view::{self, CameraConfig, View};
use mujoco_engine::math::MAXVAL;
use mujoco_engine::{Model, Revision};

/// The largest `reset_noise_scale`. Normal noise of this scale stays within MuJoCo's limit of 1e10.
const LARGEST_NOISE: f64 = 1e9;

/// The largest number of any argument: with MuJoCo's largest number, products and sums are finite.
const LARGEST: f64 = 1e100;

/// The largest frame skip. A step with more timesteps would seem to hang.
const LONGEST_SKIP: usize = 1000;

/// The arguments of a task: a struct of [`gym_core::arguments!`] with [`Common`] flattened.
pub trait TaskArguments:
    Arguments + AsRef<Common> + AsMut<Common> + std::fmt::Debug + Send + Sync + 'static
{
    /// The default values in a version. Versions that Gymnasium can no longer run default to the
    /// version of MuJoCo that their recordings have.
    fn defaults(version: u32) -> Self {
        let mut config = Self::default();
        if version < 4 {
            config.as_mut().mujoco = Revision::V3_12.into();
        }
        config
    }

    /// Checks the sizes of numbers.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] for a `reset_noise_scale` whose normal numbers may exceed MuJoCo's
    /// limit, and for a number, such as a weight, that makes rewards infinite.
    fn check_sizes(&self) -> Result<()> {
        let arguments = serde_json::to_value(self).unwrap_or_default();
        // JSON has null for infinity and NaN
        let scale = arguments.get("reset_noise_scale");
        let scale = scale.map(|scale| scale.as_f64().unwrap_or(f64::INFINITY));
        if let Some(scale) = scale.filter(|scale| scale.abs() > LARGEST_NOISE) {
            let reason = format!(
                "{scale:e} is not within ±{LARGEST_NOISE:e}: MuJoCo's numbers lie within ±{MAXVAL:e}"
            );
            return Err(Error::argument("reset_noise_scale", reason));
        }
        let numbers = arguments.as_object().into_iter().flatten();
        for (name, number) in numbers.filter_map(|(name, x)| Some((name, x.as_f64()?))) {
            if number.abs() > LARGEST {
                let reason =
                    format!("{number:e} is not within ±{LARGEST:e}: rewards would not be finite");
                return Err(Error::argument(name.as_str(), reason));
            }
        }
        Ok(())
    }
}

gym_core::arguments! {
    /// The arguments that all tasks share. `xml_file`, `frame_skip` and `default_camera_config`
    /// have other values in each task.
    pub struct Common {
        /// The version of MuJoCo whose numbers the episodes have, to the last bit: `"4.0"`,
        /// `"4.0.1"`, `"3.17"`, or `"3.12"`, which 3.11 and 3.13 equal.
        pub mujoco: Version = Version(Revision::V4_0),
        /// The model: the name of a built-in one, such as `"ant.xml"`, or a path that begins with
        /// `.`, `/` or `~`.
        #[versions = 5..]
        pub xml_file: String,
        /// The keyframe of the model that episodes start from, by its name or number, instead of
        /// the initial configuration.
        #[versions = 5..]
        pub keyframe: Option<String>,
        /// The number of the model's timesteps per step.
        #[versions = 5..]
        pub frame_skip: usize = 1,
        /// The camera's position, if not that of the task.
        #[versions = 5..]
        pub default_camera_config: CameraConfig,
        /// Width of the picture.
        #[unit = "px"]
        #[versions = 4..]
        pub width: u32 = 480,
        /// Height of the picture.
        #[unit = "px"]
        #[versions = 4..]
        pub height: u32 = 480,
        /// The model's camera to use, by number; -1 is the free camera.
        #[versions = 4..]
        pub camera_id: Option<i32>,
        /// The model's camera to use, by name.
        #[versions = 4..]
        pub camera_name: Option<String>,
        /// The largest number of geoms that are drawn.
        #[versions = 4..]
        pub max_geom: usize = 1000,
        /// Flags of MuJoCo's viewer, by number. They have no effect.
        #[versions = 4..]
        pub visual_options: Option<Map<String, Json>>,
    }
}

impl Common {
    /// The default values of a task's model, frame skip and camera.
    #[must_use]
    pub fn new(xml_file: &str, frame_skip: usize, camera: CameraConfig) -> Self {
        Self {
            xml_file: xml_file.to_owned(),
            frame_skip,
            default_camera_config: camera,
            ..Self::default()
        }
    }

    /// The view of a model that the arguments describe.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] for a camera that the model does not have.
    pub fn view(&self, model: &Model) -> Result<View> {
        let own = match (&self.camera_name, self.camera_id) {
            (Some(name), _) => Some(view::camera(model, name)?),
            (None, None | Some(-1)) => None,
            (None, Some(id)) => {
                let number = model.cam_mode.len();
                let valid = usize::try_from(id).ok().filter(|id| *id < number);
                Some(valid.ok_or_else(|| {
                    Error::argument(
                        "camera_id",
                        format!("{id}: the model has {number} cameras; -1 is the free one"),
                    )
                })?)
            }
        };
        let view = match own {
            Some(id) => View::of_camera(model, id),
            None => View::new(model, &self.default_camera_config)?,
        };
        Ok(view.with_max_geom(self.max_geom))
    }

    pub(crate) fn check(&self) -> Result<()> {
        if !(1..=LONGEST_SKIP).contains(&self.frame_skip) {
            let reason = format!("{} is not from 1 to {LONGEST_SKIP}", self.frame_skip);
            return Err(Error::argument("frame_skip", reason));
        }
        if self.width == 0 || self.height == 0 || self.width > 16_384 || self.height > 16_384 {
            let reason = "must lie between 1 and 16384 pixels";
            return Err(Error::argument("width and height", reason));
        }
        if self.camera_id.is_some() && self.camera_name.is_some() {
            let reason = "does not go with camera_name: give one of them";
            return Err(Error::argument("camera_id", reason));
        }
        if let Some(options) = &self.visual_options
            && let Some((flag, value)) = options
                .iter()
                .find(|(flag, value)| flag.parse::<u32>().is_err() || !value.is_boolean())
        {
            let reason = format!("{flag}: {value} is not a flag's number with true or false");
            return Err(Error::argument("visual_options", reason));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    /// The last value that is taken, and the next.
    #[test]
    fn arguments_are_checked_up_to_their_limits() {
        let skip = |frame_skip| Common {
            frame_skip,
            ..Common::default()
        };
        let sides = |width, height| Common {
            width,
            height,
            ..Common::default()
        };
        let cameras = |camera_id, name: Option<&str>| Common {
            camera_id,
            camera_name: name.map(str::to_owned),
            ..Common::default()
        };
        let flags = |flags: Json| Common {
            visual_options: flags.as_object().cloned(),
            ..Common::default()
        };
        for fits in [
            skip(1),
            skip(1000),
            sides(1, 1),
            sides(16_384, 16_384),
            cameras(Some(0), None),
            cameras(None, Some("a")),
            flags(json!({})),
            flags(json!({"0": true, "31": false})),
        ] {
            fits.check().unwrap();
        }
        for (common, words) in [
            (skip(0), "frame_skip: 0 is not from 1 to 1000"),
            (skip(1001), "frame_skip: 1001 is not from 1 to 1000"),
            (sides(0, 1), "must lie between 1 and 16384 pixels"),
            (sides(1, 0), "must lie between 1 and 16384 pixels"),
            (sides(16_385, 1), "must lie between 1 and 16384 pixels"),
            (sides(1, 16_385), "must lie between 1 and 16384 pixels"),
            (
                cameras(Some(-1), Some("a")),
                "camera_id: does not go with camera_name",
            ),
            (
                flags(json!({"0": 3})),
                "visual_options: 0: 3 is not a flag's number with true or false",
            ),
            (flags(json!({"a": true})), "visual_options: a: true is not"),
            (flags(json!({"1": true, "-1": true})), "-1: true is not"),
        ] {
            let error = common.check().unwrap_err().to_string();
            let error = error.replace('`', "");
            assert!(error.contains(words), "{error} has not {words}");
        }
    }

    #[test]
    fn cameras_have_numbers_and_names_and_the_free_one_has_neither() {
        let text = "<mujoco><worldbody><camera name=\"a\"/><camera name=\"b\" pos=\"1 0 0\"/><geom size=\"1\"/></worldbody></mujoco>";
        let model = Model::from_xml(text).unwrap();
        let view = |id: Option<i32>, name: Option<&str>| {
            let common = Common {
                camera_id: id,
                camera_name: name.map(str::to_owned),
                ..Common::default()
            };
            format!("{:?}", common.view(&model).unwrap())
        };
        let views = [(0, "a"), (1, "b")].map(|(id, name)| {
            let view = [view(Some(id), None), view(None, Some(name))];
            assert_eq!(view[0], view[1], "{name}");
            view[0].clone()
        });
        let free = view(None, None);
        assert_eq!(view(Some(-1), None), free);
        assert!(views[0] != views[1] && !views.contains(&free));
    }
}
