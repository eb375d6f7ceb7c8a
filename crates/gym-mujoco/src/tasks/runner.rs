//! The common parts of Hopper and Walker2d, whose agents move in a vertical plane.

use std::marker::PhantomData;

use gym_core::{Array, Generator, Result};
use serde::{Deserialize, Serialize};

use super::arguments::TaskArguments;
use super::cost::ControlCost;
use super::env::{self, Visit};
use super::range::Range;
use super::simulation::{Simulation, uniform_noise, uniform_velocities};
use crate::Data;
use crate::lanes::Derived;

const VELOCITY_LIMIT: f64 = 10.0; // of observed velocities

/// The arguments of a runner task.
pub trait RunnerArguments: TaskArguments {
    /// The rewards and the conditions of a fall.
    fn settings(&self) -> Settings;
}

/// The rewards, and the conditions of a fall.
#[derive(Clone, Copy, Debug)]
pub struct Settings {
    pub(super) forward_reward_weight: f64,
    pub(super) ctrl_cost_weight: f64,
    pub(super) healthy_reward: f64,
    pub(super) terminate_when_unhealthy: bool,
    /// The range of every position except x and height, and of every velocity.
    pub(super) healthy_state_range: Range,
    pub(super) healthy_z_range: Range,
    pub(super) healthy_angle_range: Range,
    pub(super) reset_noise_scale: f64,
    pub(super) exclude_positions: bool,
}

/// The task.
#[derive(Clone, Debug)]
pub struct Runner<C> {
    settings: Settings,
    cost: ControlCost,
    version: u32,
    arguments: PhantomData<C>,
}

/// Quantities measured in a step.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Step {
    x_velocity: f64,
    forward: f64,
    ctrl: f64,
    survive: f64,
}

impl<C> Runner<C> {
    fn is_healthy(&self, data: &Data) -> bool {
        let settings = &self.settings;
        let mut state = data.qpos[2..].iter().chain(&data.qvel);
        state.all(|x| settings.healthy_state_range.contains_strictly(*x))
            && settings.healthy_z_range.contains_strictly(data.qpos[1])
            && settings.healthy_angle_range.contains_strictly(data.qpos[2])
    }
}

impl<C: RunnerArguments> env::Task for Runner<C> {
    const READS: Option<&'static [Derived]> = Some(&[]);

    type Config = C;
    type Step = Step;

    fn new(config: &C, version: u32, simulation: &Simulation) -> Result<Self> {
        simulation.needs("positions", simulation.model.nq(), 3)?;
        let settings = config.settings();
        let cost = ControlCost::new(settings.ctrl_cost_weight, version);
        Ok(Self {
            settings,
            cost,
            version,
            arguments: PhantomData,
        })
    }

    fn start(&self, simulation: &Simulation, data: &mut Data, rng: &mut Generator) {
        let scale = self.settings.reset_noise_scale;
        uniform_noise(&mut data.qpos, &simulation.model.qpos0, scale, rng);
        uniform_velocities(&mut data.qvel, scale, rng);
    }

    fn step(&self, simulation: &Simulation, data: &mut Data, action: &Array) -> (Step, f64, bool) {
        let settings = &self.settings;
        let before = data.qpos[0];
        simulation.step(data, action);
        let x_velocity = (data.qpos[0] - before) / simulation.dt;
        let forward = settings.forward_reward_weight * x_velocity;
        let healthy = self.is_healthy(data);
        // before version 5, the step that ends the episode gives the healthy reward too
        let paid = healthy || (self.version < 5 && settings.terminate_when_unhealthy);
        let survive = f64::from(paid) * settings.healthy_reward;
        let ctrl = self.cost.of(action);
        let terminated = !healthy && settings.terminate_when_unhealthy;
        (
            Step {
                x_velocity,
                forward,
                ctrl,
                survive,
            },
            forward + survive - ctrl,
            terminated,
        )
    }

    fn observe(&self, _simulation: &Simulation, data: &Data) -> impl Iterator<Item = f64> {
        let skip = usize::from(self.settings.exclude_positions);
        let velocities = data.qvel.iter();
        let velocities = velocities.map(|v| v.clamp(-VELOCITY_LIMIT, VELOCITY_LIMIT));
        data.qpos.iter().skip(skip).copied().chain(velocities)
    }

    fn info(&self, simulation: &Simulation, data: &Data, step: Option<&Step>, visit: Visit<'_>) {
        if self.version >= 5 {
            visit("x_position", data.qpos[0]);
            let height = data.qpos[1] - simulation.model.qpos0[1];
            visit("z_distance_from_origin", height);
        }
        let Some(step) = step else { return };
        if matches!(self.version, 3 | 4) {
            visit("x_position", data.qpos[0]);
        }
        if self.version >= 3 {
            visit("x_velocity", step.x_velocity);
        }
        if self.version >= 5 {
            visit("reward_forward", step.forward);
            visit("reward_ctrl", -step.ctrl);
            visit("reward_survive", step.survive);
        }
    }
}
