//! The Shadow hand: twenty controls of 24 joints, with tasks in each module.
//!
//! Models and meshes are those of the Python package, which the user has installed: see
//! [`assets`].

pub mod manipulate;
mod pose;
pub mod reach;

use std::path::PathBuf;
use std::sync::Arc;

use gym_core::registry::Clip;
use gym_core::spaces::BoxSpace;
use gym_core::{Array, Registration, Result};
use gym_sim::view::CameraConfig;
use gym_sim::{Common, Naming, Settings, SimEnv, SimTask, Simulation, Stepper};
use mujoco_engine::{Data, Model};
use serde::Serialize;

use crate::assets;

/// Timesteps of a step.
const FRAME_SKIP: usize = 20;

/// The camera of pictures.
fn camera() -> CameraConfig {
    CameraConfig::at([1.0, 0.96, 0.14], 0.5, 55.0, -25.0)
}

/// Makes the environment of a task on one of the hand's models.
///
/// `arguments` are those of the environment without `assets`, because another computer has the
/// models elsewhere.
fn make<T: SimTask>(
    (name, version): (&'static str, u32),
    (model, folder): (&str, Option<PathBuf>),
    arguments: &impl Serialize,
    common: &Common,
    task: impl FnOnce(&Simulation) -> Result<T>,
) -> Result<SimEnv> {
    let common = Common {
        frame_skip: FRAME_SKIP,
        ..common.clone()
    };
    let load = || {
        let folder = folder.as_deref();
        assets::load(&assets::HAND, model, folder, common.mujoco.0).map(Arc::new)
    };
    let stepper = Stepper::Behind {
        contact_forces: false,
    };
    let simulation = Simulation::new(load, &common, stepper)?;
    let task = task(&simulation)?;
    let mut settings = Settings::new(name, arguments);
    settings.version = Some(version);
    settings.size = (common.width, common.height);
    settings.flat = false;
    settings.depth = false;
    let controls = simulation.model.nu();
    settings.action_space =
        Some(BoxSpace::new(vec![-1.0_f32; controls], vec![1.0; controls])?.into());
    SimEnv::new(Arc::new(task), simulation, settings)
}

/// The joints and the controls of the hand.
#[derive(Debug)]
struct Hand {
    /// The position and the velocity of each joint.
    joints: Vec<[usize; 2]>,
    /// The range of each control.
    controls: Vec<[f64; 2]>,
}

impl Hand {
    fn new(m: &Model) -> Self {
        let names = m.names.joint.iter().enumerate();
        let own = names.filter(|(_, name)| name.as_ref().is_some_and(|n| n.starts_with("robot")));
        Self {
            joints: own
                .map(|(joint, _)| [m.jnt_qposadr[joint], m.jnt_dofadr[joint]])
                .collect(),
            controls: m.actuator_ctrlrange.clone(),
        }
    }

    /// The controls of an action, whose numbers are shares of half the ranges.
    fn controls(&self, action: impl Iterator<Item = f64>) -> impl Iterator<Item = f64> {
        self.controls.iter().zip(action).map(|([low, high], a)| {
            let control = (high + low) / 2.0 + a.clamp(-1.0, 1.0) * ((high - low) / 2.0);
            control.clamp(*low, *high)
        })
    }

    fn step(&self, simulation: &Simulation, d: &mut Data, action: &Array) {
        simulation.drive(d, self.controls(action.iter_f64()));
    }

    /// The positions of the joints, and then their velocities.
    fn state<'a>(&'a self, d: &'a Data) -> impl Iterator<Item = f64> + 'a {
        let positions = self.joints.iter().map(|[position, _]| d.qpos[*position]);
        positions.chain(self.joints.iter().map(|[_, dof]| d.qvel[*dof]))
    }

    /// Adds the names of [`state`](Self::state), and of the numbers of an action.
    fn names(&self, names: &mut Naming<'_>) {
        for [position, _] in &self.joints {
            names.add(names.position(*position));
        }
        for [_, dof] in &self.joints {
            names.add(names.velocity(*dof));
        }
        for actuator in 0..self.controls.len() {
            let of = names.actuator(actuator);
            names.action(format!("target of {of} as a share of its range"));
        }
    }
}

/// What the registrations of all ids share.
const fn registered(registration: Registration, steps: u32) -> Registration {
    registration
        .names(gym_sim::names)
        .max_episode_steps(steps)
        .needs(assets::NEED, assets::available)
        .clip(Clip {
            seeds: 0..2,
            every: 2,
            frames: 50,
            size: (240, 240),
        })
}

/// What conformance cannot see of the hand.
const ALLOCATES: (&str, &str) = (
    "no-allocation",
    "buffers of contacts grow in the first steps",
);
