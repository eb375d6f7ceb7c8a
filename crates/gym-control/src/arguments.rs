//! The arguments that all tasks share.

use gym_core::{DType, Error, Result};
use gym_sim::Version;
use mujoco_engine::{Model, Revision};

/// The largest width and height of a picture.
const LARGEST: u32 = 16_384;
/// The largest width of a picture that is observed.
const LARGEST_OBSERVED: u32 = 1024;

gym_core::arguments! {
    /// The arguments that all tasks share. `time_limit` has other values in some.
    pub struct Common {
        /// The version of MuJoCo whose numbers the episodes have, to the last bit: `"4.0"`,
        /// `"4.0.1"`, `"3.17"`, or `"3.12"`, for which dm_control 1.0.45 is made.
        pub mujoco: Version = Version(Revision::V4_0),
        /// Length of an episode; null for no limit.
        #[unit = "s"]
        pub time_limit: Option<f64> = Some(20.0),
        /// Whether the observation is one vector, with the parts in the package's order, instead of
        /// a dict.
        pub flat: bool = false,
        /// The type of the observation's numbers: `"float64"` or `"float32"`.
        pub dtype: DType = DType::F64,
        /// Width and height of a picture that is observed instead of numbers.
        #[unit = "px"]
        pub pixels: Option<u32>,
        /// Positions at the start, instead of random ones.
        pub qpos: Option<Vec<f64>>,
        /// Velocities at the start.
        pub qvel: Option<Vec<f64>>,
        /// Whether the colours of pictures show the reward.
        pub visualize_reward: bool = false,
        /// The model's camera to use, by number; -1 is the free camera.
        pub camera_id: i32 = 0,
        /// Width of the picture.
        #[unit = "px"]
        pub width: u32 = 320,
        /// Height of the picture.
        #[unit = "px"]
        pub height: u32 = 240,
    }
}

impl Common {
    /// Returns the default values, with episodes of `seconds` seconds.
    pub(crate) fn lasting(seconds: impl Into<Option<f64>>) -> Self {
        Self {
            time_limit: seconds.into(),
            ..Self::default()
        }
    }

    /// Returns an error for a value out of range.
    pub(crate) fn check(&self, model: &Model) -> Result<()> {
        let refuse = |name: &str, reason: String| Err(Error::argument(name.to_owned(), reason));
        if let Some(limit) = self
            .time_limit
            .filter(|limit| !(*limit > 0.0 && limit.is_finite()))
        {
            return refuse("time_limit", format!("{limit} s: it is positive, or null"));
        }
        if !self.dtype.is_float() {
            let reason = format!("{}: it is \"float64\" or \"float32\"", self.dtype);
            return refuse("dtype", reason);
        }
        if let Some(pixels) = self.pixels.filter(|n| !(1..=LARGEST_OBSERVED).contains(n)) {
            let reason = format!("{pixels}: it is from 1 to {LARGEST_OBSERVED}, or null");
            return refuse("pixels", reason);
        }
        for (name, side) in [("width", self.width), ("height", self.height)] {
            if !(1..=LARGEST).contains(&side) {
                return refuse(name, format!("{side}: it is from 1 to {LARGEST}"));
            }
        }
        for (name, given, number) in [
            ("qpos", &self.qpos, model.nq()),
            ("qvel", &self.qvel, model.nv()),
        ] {
            let Some(given) = given else { continue };
            if given.len() != number {
                let reason = format!("{} numbers: the model has {number}", given.len());
                return refuse(name, reason);
            }
            if let Some(x) = given.iter().find(|x| x.is_nan() || x.abs() > 1e10) {
                return refuse(name, format!("{x} is not within ±1e10"));
            }
        }
        Ok(())
    }
}
