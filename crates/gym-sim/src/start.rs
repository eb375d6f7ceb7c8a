//! The start of an episode, and the random draws that tasks share.

use std::f64::consts::PI;

use gym_core::{Error, Kwargs, Result};
use mujoco_engine::model::JointType;
use mujoco_engine::{CompiledModel, Data, Model};

use crate::numpy::norm;
use crate::rng::Rng;
use crate::simulation::Simulation;

/// An episode that is about to start. `data` is in the model's initial configuration, or at the keyframe
/// of the argument `keyframe`.
#[derive(Debug)]
pub struct Start<'a> {
    pub(crate) simulation: &'a mut Simulation,
    /// The data.
    pub data: &'a mut Data,
    /// The random generator.
    pub rng: &'a mut Rng,
    /// Constants of the model that the task drew. They stay until the task draws others.
    pub constants: &'a mut Vec<f64>,
    /// Whether this reset seeded the generator.
    pub seeded: bool,
    /// The options of the reset, which the task has [checked](crate::SimTask::check_options).
    pub options: &'a Kwargs,
}

/// The largest number of states that [`draw_apart`](Start::draw_apart) draws.
const ATTEMPTS: usize = 10_000;

impl Start<'_> {
    /// The model.
    #[must_use]
    pub fn model(&self) -> &Model {
        &self.simulation.model
    }

    /// The model, the data and the generator, all at once.
    pub fn parts(&mut self) -> (&Model, &mut Data, &mut Rng) {
        (&self.simulation.model, self.data, self.rng)
    }

    /// Draws a number uniformly from `low` to `high`.
    pub fn uniform(&mut self, low: f64, high: f64) -> f64 {
        self.rng.uniform(low, high)
    }

    /// Changes the model by the drawn constants.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] if the model refuses the change.
    pub fn change(&mut self, change: impl FnOnce(&[f64], &mut CompiledModel)) -> Result<()> {
        let constants = &*self.constants;
        self.simulation.change(|model| change(constants, model))
    }

    /// Computes the derived arrays from the state.
    pub fn settle(&mut self) {
        self.simulation.settle(self.data);
    }

    /// Advances the state by some timesteps.
    pub fn step(&mut self, timesteps: usize) {
        self.simulation.advance(self.data, timesteps);
    }

    /// Draws states until one has no contacts.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] if ten thousand states have contacts.
    pub fn draw_apart(&mut self, mut draw: impl FnMut(&mut Self)) -> Result<()> {
        for _ in 0..ATTEMPTS {
            draw(self);
            self.settle();
            if self.data.contact.is_empty() {
                return Ok(());
            }
        }
        let reason = format!(
            "{ATTEMPTS} random states have contacts: change the model so that its bodies can be apart"
        );
        Err(Error::argument("model", reason))
    }

    /// Draws a quaternion: four numbers from `number`, divided by their `length`.
    pub fn quaternion(
        &mut self,
        number: fn(&mut Rng) -> f64,
        length: fn([f64; 4]) -> f64,
    ) -> [f64; 4] {
        let quat = [(); 4].map(|()| number(self.rng));
        let length = length(quat);
        quat.map(|x| x / length)
    }

    /// Draws the positions of limited joints within their limits, of other hinges over a full turn,
    /// and the orientations of free joints: dm_control's `randomize_limited_and_rotational_joints`.
    pub fn joints(&mut self) {
        for j in 0..self.model().njnt() {
            let (kind, p) = (self.model().jnt_type[j], self.model().jnt_qposadr[j]);
            let [low, high] = self.model().jnt_range[j];
            match kind {
                JointType::Free => {
                    let quat = self.quaternion(Rng::random, |quat| norm(5, &quat));
                    self.data.qpos[p + 3..p + 7].copy_from_slice(&quat);
                }
                JointType::Hinge | JointType::Slide if self.model().jnt_limited[j] => {
                    self.data.qpos[p] = self.uniform(low, high);
                }
                JointType::Hinge => self.data.qpos[p] = self.uniform(-PI, PI),
                _ => {}
            }
        }
    }
}
