//! The common parts of Hopper and Walker2d, whose agents move in a vertical plane.

use std::marker::PhantomData;

use crate::cost::ControlCost;
use crate::noise::uniform_noise;
use crate::range::Range;
use gym_core::{Array, Result};
use gym_sim::{
    FromArguments, Measured, Measures, Naming, Observation, SimTask, Simulation, Start,
    TaskArguments, Visit,
};
use mujoco_engine::lanes::Derived;
use mujoco_engine::{Data, Model};

const VELOCITY_LIMIT: f64 = 10.0; // of observed velocities

/// The arguments of a runner task.
pub trait RunnerArguments: TaskArguments {
    /// The rewards and the conditions of a fall.
    fn settings(&self) -> Settings;
}

/// The rewards, and the conditions of a fall.
#[derive(Clone, Copy, Debug)]
pub struct Settings {
    pub(crate) forward_reward_weight: f64,
    pub(crate) ctrl_cost_weight: f64,
    pub(crate) healthy_reward: f64,
    pub(crate) terminate_when_unhealthy: bool,
    /// The range of every position except x and height, and of every velocity.
    pub(crate) healthy_state_range: Range,
    pub(crate) healthy_z_range: Range,
    pub(crate) healthy_angle_range: Range,
    pub(crate) reset_noise_scale: f64,
    pub(crate) exclude_positions: bool,
}

/// The task.
#[derive(Clone, Debug)]
pub struct Runner<C> {
    settings: Settings,
    cost: ControlCost,
    version: u32,
    arguments: PhantomData<C>,
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

impl<C: RunnerArguments> FromArguments for Runner<C> {
    type Config = C;

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
}

impl<C: RunnerArguments> SimTask for Runner<C> {
    fn measures(&self) -> Measures {
        &[
            ("x_velocity", 1),
            ("forward", 1),
            ("ctrl", 1),
            ("survive", 1),
        ]
    }

    fn reads(&self, _: &Model) -> Option<Vec<Derived>> {
        Some(Vec::new())
    }

    fn start(&self, start: &mut Start<'_>) -> Result<()> {
        let (_, data, rng) = start.parts();
        let scale = self.settings.reset_noise_scale;
        uniform_noise(&mut data.qpos, scale, rng);
        uniform_noise(&mut data.qvel, scale, rng);
        Ok(())
    }

    fn step(&self, simulation: &Simulation, data: &mut Data, action: &Array) -> Measured {
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
        Measured::new(forward + survive - ctrl, terminated)
            .with([x_velocity, forward, ctrl, survive])
    }

    fn observe(&self, _: &Model, data: &Data, out: &mut Observation) {
        let skip = usize::from(self.settings.exclude_positions);
        let velocities = data.qvel.iter();
        let velocities = velocities.map(|v| v.clamp(-VELOCITY_LIMIT, VELOCITY_LIMIT));
        out.extend(data.qpos.iter().skip(skip).copied().chain(velocities));
    }

    fn names(&self, names: &mut Naming<'_>) {
        let skip = usize::from(self.settings.exclude_positions);
        names.positions(skip..).velocities(..);
    }

    fn info(
        &self,
        simulation: &Simulation,
        data: &Data,
        measured: Option<&Measured>,
        visit: Visit<'_>,
    ) {
        if self.version >= 5 {
            visit("x_position", data.qpos[0]);
            let height = data.qpos[1] - simulation.initial_qpos()[1];
            visit("z_distance_from_origin", height);
        }
        let Some([x_velocity, forward, ctrl, survive]) = measured.map(Measured::numbers) else {
            return;
        };
        if matches!(self.version, 3 | 4) {
            visit("x_position", data.qpos[0]);
        }
        if self.version >= 3 {
            visit("x_velocity", x_velocity);
        }
        if self.version >= 5 {
            visit("reward_forward", forward);
            visit("reward_ctrl", -ctrl);
            visit("reward_survive", survive);
        }
    }
}
