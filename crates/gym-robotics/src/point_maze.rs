//! PointMaze: push a ball through a maze to a goal.
//!
//! | | |
//! |---|---|
//! | observation | `observation`: place and velocity of the ball; `achieved_goal`: its place; `desired_goal`: the goal's place, in m |
//! | action | forces along x and y, as a share of 100 N; `Box(-1, 1, (2,), float32)` |
//! | reward | 1 within 0.45 m of the goal, else 0; ids with `Dense`: the exponential of minus the distance to the goal in m |
//! | start | goal and ball in the middle of different cells, disturbed uniformly by up to 0.25 m along x and y |
//! | end | terminated at the goal, unless `continuing_task` is true, as by default |
//! | limit | 300 steps of 0.01 s; 600 in `Medium` and 800 in `Large` mazes |
//!
//! A cell of the maze is 1 m wide, and the ball has a radius of 0.1 m. Its velocity is limited to
//! 5 m/s along x and y before each step. `info` has `success`, whether the ball is within 0.45 m of
//! the goal. The reset options `goal_cell` and `reset_cell` name the cells of goal and ball by row
//! and column.
//!
//! Differences from Gymnasium-Robotics: all numbers are Gymnasium-Robotics' with the version of
//! MuJoCo that `mujoco` names, for Linux on x86-64. A map on which an episode cannot start is an
//! error, where the package waits for ever.
//!
//! A scripted policy steers the ball along a shortest way, in the picture too: `cargo xtask run
//! PointMaze_UMaze-v3 --policy good`.
//!
//! Source: Gymnasium-Robotics 1.4.2, `envs/maze/point_maze.py`, `point.py` and `maze_v4.py`.

use gym_core::keys::{Keys, json};
use gym_core::registry::{Build, Clip};
use gym_core::{Array, Env as _, Policy, Registration, Result, Value};
use gym_sim::view::CameraConfig;
use gym_sim::{
    Common, Measured, Naming, Observation, SimEnv, SimTask, Simulation, Start, register,
};
use mujoco_engine::lanes::Derived;
use mujoco_engine::{Data, Model};
use serde::Deserialize;

use crate::maze::{AT_THE_GOAL, Agent, Map, Maze, MazeArguments, Way, make, mazes};

const FASTEST: f64 = 5.0; // m/s, along x and along y

gym_core::arguments! {
    /// Arguments.
    pub struct Config {
        /// The arguments of the maze.
        #[flatten(reset_target = 3..)]
        pub maze: MazeArguments,
        /// The arguments that all tasks share.
        #[flatten(
            xml_file = 0, keyframe = 0, frame_skip = 0, default_camera_config = 0, width = 3.., height = 3.., camera_id = 3..,
            camera_name = 3.., max_geom = 3.., visual_options = 3..
        )]
        pub common: Common,
    }
}

/// The constructor of the environments.
#[derive(Clone, Copy, Debug)]
pub struct PointMaze;

impl Build for PointMaze {
    type Config = Config;
    type Env = SimEnv;

    fn build(config: Config, version: u32) -> Result<SimEnv> {
        let maze = maze(&config.maze.maze_map)?;
        let camera = CameraConfig::at([0.0; 3], 1.35 * maze.extent(), 90.0, -60.0);
        let common = Common {
            xml_file: include_str!("../models/point.xml").to_owned(),
            default_camera_config: camera,
            ..config.common.clone()
        };
        let agent = Agent {
            name: "PointMazeEnv",
            config: &config,
            version,
            common,
        };
        make(agent, &config.maze, maze, |_| Ok(Ball))
    }
}

fn maze(map: &Map) -> Result<Maze> {
    Maze::new(map, 1.0, 0.4, false)
}

/// The ball.
#[derive(Debug)]
struct Ball;

impl SimTask for Ball {
    fn start(&self, _: &mut Start<'_>) -> Result<()> {
        Ok(())
    }

    fn prepare(&self, d: &mut Data) {
        for velocity in &mut d.qvel {
            *velocity = velocity.clamp(-FASTEST, FASTEST);
        }
    }

    fn step(&self, simulation: &Simulation, d: &mut Data, action: &Array) -> Measured {
        simulation.step(d, action);
        Measured::new(0.0, false)
    }

    fn observe(&self, _: &Model, d: &Data, out: &mut Observation) {
        out.extend(d.qpos.iter().chain(&d.qvel).copied());
    }

    fn names(&self, names: &mut Naming<'_>) {
        names.positions(..).velocities(..);
    }

    fn reads(&self, _: &Model) -> Option<Vec<Derived>> {
        Some(Vec::new())
    }
}

/// Steers the ball from cell to cell, against its velocity.
const STEERED: Policy = Policy::rules(
    "steers the ball along a shortest way, from the middle of a cell to the middle of the next",
    |env| {
        let map = Map::deserialize(env.inspect()?.arguments().get("maze_map")?).ok()?;
        let (maze, mut way) = (maze(&map).ok()?, Way::default());
        Some(Box::new(move |_, seen| {
            let numbers = |key: &str| seen.get(key)?.as_slice::<f64>();
            let [goal, state] = ["desired_goal", "observation"].map(numbers);
            let (&[x, y], &[own_x, own_y, v_x, v_y]) = (goal?, state?) else {
                return None;
            };
            let [to_x, to_y] = way.next(&maze, [own_x, own_y], [x, y]);
            let force = |way: f64, v: f64| (10.0 * way - v).clamp(-1.0, 1.0) as f32;
            let forces = vec![force(to_x - own_x, v_x), force(to_y - own_y, v_y)];
            Some(Value::Array(forces.into()))
        }))
    },
);

/// The registration that all ids share.
const fn point(id: &'static str, kwargs: &'static str, steps: u32) -> Registration {
    register::<PointMaze>(id)
        .description("Push a ball through a maze to a goal.")
        .kwargs(kwargs)
        .max_episode_steps(steps)
        .reset_options(&[("goal_cell", "[3, 3]"), ("reset_cell", "[1, 2]")])
        .keys(|_| {
            let keys = json!({"Right": [1, 0], "Up": [0, 1], "Left": [-1, 0], "Down": [0, -1]});
            Keys::new(keys).idle(json!([0, 0]))
        })
        .exceptions(AT_THE_GOAL)
        .policy(STEERED)
        .clip(Clip {
            seeds: 0..2,
            every: 6,
            frames: 60,
            size: (240, 240),
        })
}

macro_rules! ids {
    ($($maze:literal, $steps:literal, $_:literal, $map:expr;)+) => {
        gym_core::register!($(
            point(
                concat!("PointMaze_", $maze, "-v3"),
                concat!("{\"reward_type\":\"sparse\",\"maze_map\":", $map, "}"),
                $steps,
            ),
            point(
                concat!("PointMaze_", $maze, "Dense-v3"),
                concat!("{\"reward_type\":\"dense\",\"maze_map\":", $map, "}"),
                $steps,
            ),
        )+);
    };
}
mazes!(ids);
