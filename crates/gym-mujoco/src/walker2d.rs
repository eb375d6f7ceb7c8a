//! Walker2d: walk forward on two legs, in a vertical plane.
//!
//! | | |
//! |---|---|
//! | observation | height and angle of the torso and angles of thigh, leg and foot of both legs, then velocities of x and these, clipped to 10; `Box(17, float64)` |
//! | action | torques of thigh, leg and foot of the right leg and of the left, as a share of 100 N m; `Box(-1, 1, (6,), float32)` |
//! | reward | velocity forward in m/s, plus 1 while it stands, less 0.001 times the sum of the squared actions |
//! | start | standing, positions and velocities disturbed uniformly by up to 0.005 |
//! | end | terminated when the height of the torso leaves 0.8 to 2 m, or it leans by 1 rad or more |
//! | limit | 1000 steps of 0.008 s |
//!
//! Versions: before 5, the step of a fall is rewarded as well, and the right foot has less grip
//! than the left one. 4 lacks `xml_file` and `frame_skip`; 3 also lacks the camera's arguments; 2
//! takes only `mujoco`, and has no entries in `info`.
//!
//! Differences from Gymnasium: all numbers equal Gymnasium's with the version of MuJoCo that
//! `mujoco` names, for Linux on x86-64. By default that is 4.0; versions 2 and 3, and Pusher-v4,
//! which Gymnasium 1.4.0 refuses to make, keep 3.12. The default camera follows the torso.
//!
//! Source: Gymnasium 1.4.0, `envs/mujoco/walker2d_v5.py` and `_v4.py`; 0.29.1 for versions 2 and 3.

use gym_core::Registration;

use crate::range::Range;
use crate::runner::{Runner, RunnerArguments, Settings};
use crate::{Walker2d, clip};
use gym_sim::view::CameraConfig;
use gym_sim::{Common, TaskArguments, register};
use mujoco_engine::Revision;

/// The task.
pub type Task = Runner<Config>;

gym_core::arguments! {
    /// Arguments.
    pub struct Config {
        /// The arguments that all tasks share.
        #[flatten(xml_file = 3 | 5..)]
        pub common: Common = Common::new("walker2d_v5.xml", 4, CameraConfig::following(1, 3.4, 90.0, -10.0, 0.8)),
        /// Reward for a velocity of 1 m/s.
        #[versions = 3..]
        pub forward_reward_weight: f64 = 1.0,
        /// Cost of the squared actions.
        #[versions = 3..]
        pub ctrl_cost_weight: f64 = 1e-3,
        /// Reward for a step after which the walker is healthy.
        #[versions = 3..]
        pub healthy_reward: f64 = 1.0,
        /// Whether a fall ends the episode.
        #[versions = 3..]
        pub terminate_when_unhealthy: bool = true,
        /// The range of heights at which the walker is healthy.
        #[unit = "m"]
        #[versions = 3..]
        pub healthy_z_range: Range = Range::new(0.8, 2.0),
        /// The range of the torso's angle in which the walker is healthy.
        #[unit = "rad"]
        #[versions = 3..]
        pub healthy_angle_range: Range = Range::new(-1.0, 1.0),
        /// Size of the disturbance at the start.
        #[versions = 3..]
        pub reset_noise_scale: f64 = 5e-3,
        /// Whether the position along x is not observed.
        #[versions = 3..]
        pub exclude_current_positions_from_observation: bool = true,
    }
}

impl TaskArguments for Config {
    fn defaults(version: u32) -> Self {
        let mut config = Self::default();
        if version < 5 {
            config.common.xml_file = "walker2d.xml".to_owned();
        }
        if version < 4 {
            config.common.mujoco = Revision::V3_12.into();
        }
        config
    }
}

impl RunnerArguments for Config {
    fn settings(&self) -> Settings {
        Settings {
            forward_reward_weight: self.forward_reward_weight,
            ctrl_cost_weight: self.ctrl_cost_weight,
            healthy_reward: self.healthy_reward,
            terminate_when_unhealthy: self.terminate_when_unhealthy,
            healthy_state_range: Range::new(f64::NEG_INFINITY, f64::INFINITY),
            healthy_z_range: self.healthy_z_range,
            healthy_angle_range: self.healthy_angle_range,
            reset_noise_scale: self.reset_noise_scale,
            exclude_positions: self.exclude_current_positions_from_observation,
        }
    }
}

/// The registration that all versions share.
const fn walker2d(id: &'static str) -> Registration {
    register::<Walker2d>(id)
        .description("Walk forward on two legs, in a plane.")
        .max_episode_steps(1000)
}

gym_core::register!(
    walker2d("Walker2d-v2"),
    walker2d("Walker2d-v3"),
    walker2d("Walker2d-v4"),
    walker2d("Walker2d-v5").clip(clip(3, 40, 240)),
);
