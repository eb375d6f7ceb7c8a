//! The task of an agent in a maze: reach the goal.

use std::sync::Arc;

use gym_core::math::numpy_exp;
use gym_core::{Array, Goals, Kwargs, Result};
use gym_sim::numpy::norm;
use gym_sim::{
    Common, Measured, Measures, Naming, Observation, Rng, Settings, SimEnv, SimTask, Simulation,
    Start, Stepper, Visit,
};
use mujoco_engine::lanes::Derived;
use mujoco_engine::{Data, Model};
use serde::Serialize;

use super::{Maze, MazeArguments, NOISE};
use crate::RewardType;

/// The distance from the goal at which it is reached, in m.
const RADIUS: f64 = 0.45;

/// What an environment is made of beside its maze.
pub(crate) struct Agent<'a, C> {
    /// The name of the environment.
    pub(crate) name: &'static str,
    pub(crate) config: &'a C,
    pub(crate) version: u32,
    /// The arguments of the simulation, with the agent's model as `xml_file`.
    pub(crate) common: Common,
}

/// Makes the environment of an agent in a maze. The agent's task has the step, the observation
/// without the place, and the `info`.
pub(crate) fn make<A: SimTask>(
    agent: Agent<'_, impl Serialize>,
    arguments: &MazeArguments,
    maze: Maze,
    task: impl FnOnce(&Simulation) -> Result<A>,
) -> Result<SimEnv> {
    let Agent {
        name,
        config,
        version,
        mut common,
    } = agent;
    common.xml_file = maze.model(&common.xml_file)?;
    let load = || gym_sim::load(&common.xml_file, common.mujoco.0);
    let stepper = Stepper::Behind {
        contact_forces: true,
    };
    let simulation = Simulation::new(load, &common, stepper)?;
    simulation.needs("positions", simulation.model.nq(), 2)?;
    let task = MazeTask {
        agent: task(&simulation)?,
        target: simulation.site("target")?,
        reach: Reach {
            dense: arguments.reward_type == RewardType::Dense,
            ends: !arguments.continuing_task,
        },
        renews: arguments.continuing_task && maze.goals.len() > 1,
        reset_target: arguments.reset_target,
        maze,
    };
    let mut settings = Settings::new(name, config);
    settings.version = Some(version);
    settings.size = (common.width, common.height);
    settings.flat = false;
    SimEnv::new(Arc::new(task), simulation, settings)
}

/// The reward for reaching a goal.
#[derive(Clone, Copy, Debug)]
struct Reach {
    dense: bool,
    /// Whether the episode ends at the goal.
    ends: bool,
}

impl Goals for Reach {
    fn goal_len(&self) -> usize {
        2
    }

    fn compute_reward(&self, achieved: &[f64], desired: &[f64]) -> f64 {
        // numpy does not fuse the sum of `norm` along an axis
        let squares = achieved.iter().zip(desired).map(|(a, d)| (a - d) * (a - d));
        let distance = squares.sum::<f64>().sqrt();
        if self.dense {
            numpy_exp(-distance)
        } else {
            f64::from(distance <= RADIUS)
        }
    }

    fn compute_terminated(&self, achieved: &[f64], desired: &[f64]) -> bool {
        self.ends && is_reached(achieved, desired)
    }
}

/// The distance of two places, `np.linalg.norm`.
fn apart(a: &[f64], b: &[f64]) -> f64 {
    let difference = |k: usize| a.get(k).unwrap_or(&0.0) - b.get(k).unwrap_or(&0.0);
    norm(4, &[difference(0), difference(1)])
}

fn is_reached(achieved: &[f64], goal: &[f64]) -> bool {
    apart(achieved, goal) <= RADIUS
}

/// The task. `userdata` has the goal of the next step, and that of the last observation.
#[derive(Debug)]
struct MazeTask<A> {
    agent: A,
    maze: Maze,
    reach: Reach,
    target: usize,
    /// Whether the goal can change when it is reached.
    renews: bool,
    reset_target: bool,
}

impl<A> MazeTask<A> {
    fn goal(d: &Data) -> &[f64] {
        &d.userdata[..2]
    }

    /// The goal of the last observation.
    fn observed(d: &Data) -> &[f64] {
        &d.userdata[2..4]
    }

    fn achieved(d: &Data) -> &[f64] {
        &d.qpos[..2]
    }

    /// Adds noise to the centre of a cell.
    fn noisy(&self, mut place: [f64; 2], rng: &mut Rng) -> [f64; 2] {
        for x in &mut place {
            *x += rng.uniform(-NOISE, NOISE) * self.maze.scale;
        }
        place
    }

    fn draw_goal(&self, rng: &mut Rng) -> [f64; 2] {
        let goals = &self.maze.goals;
        self.noisy(goals[rng.integer(goals.len() as u32) as usize], rng)
    }

    fn draw_start(&self, goal: &[f64; 2], rng: &mut Rng) -> [f64; 2] {
        let width = if self.maze.old { 1.0 } else { self.maze.scale };
        let starts = &self.maze.starts;
        loop {
            let start = starts[rng.integer(starts.len() as u32) as usize];
            if apart(&start, goal) > 0.5 * width {
                return start;
            }
        }
    }
}

impl<A: SimTask> SimTask for MazeTask<A> {
    fn check_options(&self, options: &Kwargs) -> Result<()> {
        self.maze.places(options).map(|_| ())
    }

    fn remembers(&self) -> usize {
        4
    }

    fn start(&self, start: &mut Start<'_>) -> Result<()> {
        let [goal, place] = self.maze.places(start.options)?;
        let (_, data, rng) = start.parts();
        let goal = match goal {
            Some(goal) => self.noisy(goal, rng),
            None => self.draw_goal(rng),
        };
        let place = place.unwrap_or_else(|| self.draw_start(&goal, rng));
        let place = self.noisy(place, rng);
        data.qpos[..2].copy_from_slice(&place);
        data.userdata[..2].copy_from_slice(&goal);
        data.userdata[2..].copy_from_slice(&goal);
        Ok(())
    }

    fn prepare(&self, d: &mut Data) {
        self.agent.prepare(d);
    }

    fn step(&self, simulation: &Simulation, d: &mut Data, action: &Array) -> Measured {
        d.userdata.copy_within(..2, 2);
        let mut measured = self.agent.step(simulation, d, action);
        let (achieved, goal) = (Self::achieved(d), Self::observed(d));
        measured.reward = self.reach.compute_reward(achieved, goal);
        measured.terminated = self.reach.compute_terminated(achieved, goal);
        measured
    }

    fn follow(&self, d: &mut Data, rng: &mut Rng, measured: &mut Measured) {
        let is_reached = |d: &Data| is_reached(Self::achieved(d), Self::goal(d));
        if !self.renews || !is_reached(d) {
            return;
        }
        if self.maze.old {
            d.userdata[..2].copy_from_slice(&self.draw_goal(rng));
            measured.reward = self.reach.compute_reward(Self::achieved(d), Self::goal(d));
            return;
        }
        while self.reset_target && is_reached(d) {
            d.userdata[..2].copy_from_slice(&self.draw_goal(rng));
        }
    }

    fn observe(&self, m: &Model, d: &Data, out: &mut Observation) {
        out.vector("achieved_goal", Self::achieved(d).iter().copied());
        out.vector("desired_goal", Self::observed(d).iter().copied());
        self.agent.observe(m, d, out);
    }

    fn names(&self, names: &mut Naming<'_>) {
        names.part("achieved_goal").positions(..2);
        names.part("desired_goal");
        names.each(&["x", "y"], "{} of the goal (m)");
        self.agent.names(names.part("observation"));
    }

    fn show(&self, d: &mut Data) {
        let [x, y] = [d.userdata[0], d.userdata[1]];
        d.site_xpos[self.target] = [x, y, self.maze.middle()];
    }

    fn info(
        &self,
        simulation: &Simulation,
        d: &Data,
        measured: Option<&Measured>,
        visit: Visit<'_>,
    ) {
        self.agent.info(simulation, d, measured, visit);
    }

    fn success(&self, d: &Data, _: Option<&Measured>) -> Option<bool> {
        (!self.maze.old).then(|| is_reached(Self::achieved(d), Self::observed(d)))
    }

    fn measures(&self) -> Measures {
        self.agent.measures()
    }

    fn reads(&self, m: &Model) -> Option<Vec<Derived>> {
        self.agent.reads(m)
    }

    fn goals(&self) -> Option<&dyn Goals> {
        Some(&self.reach)
    }
}
