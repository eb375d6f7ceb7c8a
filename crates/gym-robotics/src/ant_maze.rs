//! AntMaze: walk through a maze to a goal, on the four legs of Gymnasium's Ant.
//!
//! | | |
//! |---|---|
//! | observation | `observation`: what Ant observes, in m, rad and seconds (105 numbers; versions 3 and 4 without contact forces: 27); `achieved_goal`: the place of the torso; `desired_goal`: the goal's place, in m |
//! | action | torques of the hips and ankles, as Ant's; `Box(-1, 1, (8,), float32)` |
//! | reward | 1 within 0.45 m of the goal, else 0; ids with `Dense`: the exponential of minus the distance to the goal in m |
//! | start | goal and torso in the middle of different cells, disturbed uniformly by up to 1 m along x and y |
//! | end | terminated at the goal, unless `continuing_task` is true, as by default |
//! | limit | 700 steps of 0.05 s; 1000 in `Medium` and `Large` mazes |
//!
//! A cell of the maze is 4 m wide. `info` has the entries of Ant's, and `success`, whether the torso
//! is within 0.45 m of the goal. The reset options `goal_cell` and `reset_cell` name the cells of
//! goal and ant by row and column.
//!
//! Versions: 5 is on Ant-v5, and 3 and 4 are on Ant-v4. 3 lacks `success` and `reset_target`: in a
//! continuing task the goal always changes when it is reached, before the reward of the step is
//! computed; and the start may be as near to the goal as 0.5 m.
//!
//! Differences from Gymnasium-Robotics: all numbers are Gymnasium-Robotics' with the version of
//! MuJoCo that `mujoco` names, for Linux on x86-64. A map on which an episode cannot start is an
//! error, where the package waits for ever.
//!
//! Actions in the picture are random: no policy was trained for this task, and none is scripted.
//!
//! Source: Gymnasium-Robotics 1.4.2, `envs/maze/ant_maze_v3.py`, `ant_maze_v4.py`, `ant_maze_v5.py`,
//! `maze.py` and `maze_v4.py`.

use gym_core::registry::{Build, Clip, Exceptions};
use gym_core::{Argument, Arguments, Kwargs, Registration, Result};
use gym_mujoco::ant;
use gym_sim::view::CameraConfig;
use gym_sim::{Common, FromArguments, SimEnv, TaskArguments, register};
use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize};

use crate::maze::{AT_THE_GOAL, Agent, Maze, MazeArguments, make, mazes};

/// Arguments: those of the maze and those of Ant, without `reset_noise_scale` and
/// `exclude_current_positions_from_observation`.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Config {
    /// The arguments of the maze.
    #[serde(flatten)]
    pub maze: MazeArguments,
    /// The arguments of Ant.
    #[serde(flatten)]
    pub ant: ant::Config,
}

// by hand: serde cannot flatten a struct that flattens another
impl<'de> Deserialize<'de> for Config {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> std::result::Result<Self, D::Error> {
        let mut ant = Kwargs::deserialize(deserializer)?;
        let names = MazeArguments::table().into_iter().map(|row| row.name);
        let maze: Kwargs = names.filter_map(|name| ant.remove_entry(name)).collect();
        Ok(Self {
            maze: serde_json::from_value(maze.into()).map_err(D::Error::custom)?,
            ant: serde_json::from_value(ant.into()).map_err(D::Error::custom)?,
        })
    }
}

impl Arguments for Config {
    fn table() -> Vec<Argument> {
        let mut table = MazeArguments::table();
        let of_ant = ant::Config::table().into_iter();
        table.extend(of_ant.filter_map(|row| match row.name {
            "reset_noise_scale" | "exclude_current_positions_from_observation" => None,
            "xml_file" => Some(row.versions("5..", |version| version >= 5)),
            "use_contact_forces" => Some(row.versions("3..=4", |version| version <= 4)),
            // all versions have what Ant-v4 has
            _ if row.is_taken(4) => Some(row.versions("", |_| true)),
            _ => Some(row),
        }));
        table
    }

    fn set_number(&mut self, name: &str, x: f64) -> bool {
        self.maze.set_number(name, x) || self.ant.set_number(name, x)
    }
}

/// The constructor of the environments.
#[derive(Clone, Copy, Debug)]
pub struct AntMaze;

impl Build for AntMaze {
    type Config = Config;
    type Env = SimEnv;

    fn defaults(_version: u32) -> Config {
        let mut config = Config::default();
        config.ant.common.default_camera_config = CameraConfig::default();
        config
    }

    fn build(config: Config, version: u32) -> Result<SimEnv> {
        let Config { maze, ant } = &config;
        ant.check_sizes()?;
        let map = Maze::new(&maze.maze_map, 4.0, 0.5, version < 4)?;
        let mut common = Common {
            xml_file: text(&ant.common.xml_file)?,
            ..ant.common.clone()
        };
        if common.default_camera_config == CameraConfig::default() {
            common.default_camera_config =
                CameraConfig::at([0.0; 3], 1.35 * map.extent(), 90.0, -60.0);
        }
        let agent = Agent {
            name: "AntMazeEnv",
            config: &config,
            version,
            common,
        };
        make(agent, maze, map, |simulation| {
            ant::Task::new(ant, version.max(4), simulation)
        })
    }
}

/// The text of the ant's model: a built-in one, or what `xml_file` names.
fn text(xml_file: &str) -> Result<String> {
    match gym_mujoco::models().find(|(name, _)| *name == xml_file) {
        Some((_, text)) => Ok(text.to_owned()),
        None => gym_sim::text(xml_file),
    }
}

/// The registration that all ids share.
const NEW: Exceptions = &[
    AT_THE_GOAL[0],
    AT_THE_GOAL[1],
    (
        "arguments-matter.terminate_when_unhealthy",
        "a maze ends at its goal alone, as in the package",
    ),
];

/// The exceptions of version 3.
const OLD: Exceptions = &[
    AT_THE_GOAL[0],
    (
        "goals-agree",
        "a goal that is reached changes before the reward is computed, as in the package",
    ),
];

const fn ant(id: &'static str, kwargs: &'static str, steps: u32) -> Registration {
    register::<AntMaze>(id)
        .description("Walk through a maze to a goal on four legs.")
        .kwargs(kwargs)
        .max_episode_steps(steps)
        .reset_options(&[("goal_cell", "[3, 3]"), ("reset_cell", "[1, 2]")])
        .exceptions(match id.as_bytes() {
            [.., b'3'] => OLD,
            _ => NEW,
        })
        .clip(Clip {
            seeds: 0..2,
            every: 2,
            frames: 60,
            size: (240, 240),
        })
}

macro_rules! ids {
    ($($maze:literal, $_:literal, $steps:literal, $map:expr;)+) => {
        gym_core::register!($(
            ids!(@one $maze, "-v3", $steps, $map),
            ids!(@one $maze, "-v4", $steps, $map),
            ids!(@one $maze, "-v5", $steps, $map),
            ids!(@one $maze, "Dense-v3", $steps, $map),
            ids!(@one $maze, "Dense-v4", $steps, $map),
            ids!(@one $maze, "Dense-v5", $steps, $map),
        )+);
    };
    (@one $maze:literal, $suffix:tt, $steps:literal, $map:expr) => {
        ant(
            concat!("AntMaze_", $maze, $suffix),
            concat!("{\"reward_type\":\"", ids!(@reward $suffix), "\",\"maze_map\":", $map, "}"),
            $steps,
        )
    };
    (@reward "-v3") => { "sparse" };
    (@reward "-v4") => { "sparse" };
    (@reward "-v5") => { "sparse" };
    (@reward $dense:tt) => { "dense" };
}
mazes!(ids);
