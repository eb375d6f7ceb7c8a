//! Hopper: hop forward on one leg, in a vertical plane.
//!
//! | | |
//! |---|---|
//! | observation | height and angle of the torso and angles of thigh, leg and foot, then velocities of x and these, clipped to 10; `Box(11, float64)` |
//! | action | torques of thigh, leg and foot, as a share of 200 N m; `Box(-1, 1, (3,), float32)` |
//! | reward | velocity forward in m/s, plus 1 while it stands, less 0.001 times the sum of the squared actions |
//! | start | standing, positions and velocities disturbed uniformly by up to 0.005 |
//! | end | terminated when the torso is at 0.7 m or below or leans by 0.2 rad or more, or a number of the state reaches 100 |
//! | limit | 1000 steps of 0.008 s |
//!
//! Versions: before 5, the step of a fall is rewarded as well. 4 lacks `xml_file` and `frame_skip`;
//! 3 also lacks the camera's arguments; 2 takes only `mujoco`, and has no entries in `info`.
//!
//! Differences from Gymnasium: all numbers equal Gymnasium's with the version of MuJoCo that
//! `mujoco` names, for Linux on x86-64. By default that is 4.0; versions 2 and 3, and Pusher-v4,
//! which Gymnasium 1.4.0 refuses to make, keep 3.12. The default camera follows the torso.
//!
//! Source: Gymnasium 1.4.0, `envs/mujoco/hopper_v5.py` and `_v4.py`; 0.29.1 for versions 2 and 3.

use gym_core::Registration;

use crate::range::Range;
use crate::runner::{Runner, RunnerArguments, Settings};
use crate::{Hopper, clip};
use gym_sim::view::CameraConfig;
use gym_sim::{Common, TaskArguments, register};

/// The task.
pub type Task = Runner<Config>;

gym_core::arguments! {
    /// Arguments.
    pub struct Config {
        /// The arguments that all tasks share.
        #[flatten(xml_file = 3 | 5..)]
        pub common: Common = Common::new("hopper.xml", 4, CameraConfig::following(1, 3.4, 90.0, -10.0, 0.8)),
        /// Reward for a velocity of 1 m/s.
        #[versions = 3..]
        pub forward_reward_weight: f64 = 1.0,
        /// Cost of the squared actions.
        #[versions = 3..]
        pub ctrl_cost_weight: f64 = 1e-3,
        /// Reward for a step after which the hopper is healthy.
        #[versions = 3..]
        pub healthy_reward: f64 = 1.0,
        /// Whether a fall ends the episode.
        #[versions = 3..]
        pub terminate_when_unhealthy: bool = true,
        /// The range of every position except x and height, and of every velocity, in which the hopper is healthy.
        #[versions = 3..]
        pub healthy_state_range: Range = Range::new(-100.0, 100.0),
        /// The range of heights at which the hopper is healthy.
        #[unit = "m"]
        #[versions = 3..]
        pub healthy_z_range: Range = Range::new(0.7, f64::INFINITY),
        /// The range of the torso's angle in which the hopper is healthy.
        #[unit = "rad"]
        #[versions = 3..]
        pub healthy_angle_range: Range = Range::new(-0.2, 0.2),
        /// Size of the disturbance at the start.
        #[versions = 3..]
        pub reset_noise_scale: f64 = 5e-3,
        /// Whether the position along x is not observed.
        #[versions = 3..]
        pub exclude_current_positions_from_observation: bool = true,
    }
}

impl TaskArguments for Config {}

impl RunnerArguments for Config {
    fn settings(&self) -> Settings {
        Settings {
            forward_reward_weight: self.forward_reward_weight,
            ctrl_cost_weight: self.ctrl_cost_weight,
            healthy_reward: self.healthy_reward,
            terminate_when_unhealthy: self.terminate_when_unhealthy,
            healthy_state_range: self.healthy_state_range,
            healthy_z_range: self.healthy_z_range,
            healthy_angle_range: self.healthy_angle_range,
            reset_noise_scale: self.reset_noise_scale,
            exclude_positions: self.exclude_current_positions_from_observation,
        }
    }
}

/// The registration that all versions share.
const fn hopper(id: &'static str) -> Registration {
    register::<Hopper>(id)
        .description("Hop forward on one leg, in a plane.")
        .max_episode_steps(1000)
        .reward_threshold(3800.0)
}

gym_core::register!(
    hopper("Hopper-v2"),
    hopper("Hopper-v3"),
    hopper("Hopper-v4"),
    hopper("Hopper-v5").clip(clip(3, 40, 240)),
);
