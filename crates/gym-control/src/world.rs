//! A model, and its variants for different timesteps.

use std::sync::Arc;

use gym_core::{Error, Result};
use gym_mujoco::model::{Disable, Integrator, SensorType};
use gym_mujoco::{CompiledModel, Data, Model, Revision, physics};

/// The materials that the models use: for the agent, tools, goals, fixtures and the ground.
const LOOK: &str = r#"<mujoco><asset>
  <material name="agent" rgba="0.36 0.55 0.78 1"/><material name="tool" rgba="0.93 0.62 0.22 1"/>
  <material name="goal" rgba="0.82 0.27 0.25 0.7"/><material name="fixture" rgba="0.5 0.53 0.58 1"/>
  <material name="ground" rgba="0.78 0.8 0.83 1"/></asset></mujoco>"#;

/// The colours of the first three materials at a reward of 1.
const LOOK_AT_ONE: [[f64; 4]; 3] = [
    [0.25, 0.72, 0.36, 1.0],
    [0.25, 0.72, 0.36, 1.0],
    [0.82, 0.27, 0.25, 0.35],
];

/// A model, and its variants for different timesteps.
#[derive(Clone, Debug)]
pub(crate) struct World {
    pub(crate) model: Arc<Model>,
    /// The model without actuators, for computing initial states.
    without_actuators: Arc<Model>,
    /// The model without sensors, for timesteps whose sensors are not observed.
    without_sensors: Arc<Model>,
    /// Whether a sensor measures forces or accelerations. If so, the last timestep of a step must
    /// compute the sensors.
    senses_forces: bool,
}

impl World {
    /// Compiles a text in MJCF that names materials without defining them.
    pub(crate) fn new(text: &str, revision: Revision) -> Result<Self> {
        let assets = LOOK.trim_end_matches("</mujoco>");
        let body = text.split_once('>').map_or(text, |(_, body)| body);
        let model = Model::from_xml_with(&format!("{assets}{body}"), revision).map_err(wrong)?;
        Self::of(model.into_compiled())
    }

    fn of(compiled: CompiledModel) -> Result<Self> {
        let without = |part: Disable| {
            let mut compiled = compiled.clone();
            compiled.opt.disableflags |= part as u32;
            Model::new(compiled).map(Arc::new).map_err(wrong)
        };
        let late = [SensorType::Touch];
        Ok(Self {
            without_actuators: without(Disable::Actuation)?,
            without_sensors: without(Disable::Sensor)?,
            senses_forces: compiled.sensor_type.iter().any(|kind| late.contains(kind)),
            model: Model::new(compiled).map(Arc::new).map_err(wrong)?,
        })
    }

    /// Changes fields of the model and its variants.
    pub(crate) fn change(&mut self, change: impl FnOnce(&mut CompiledModel)) -> Result<()> {
        let mut compiled = Model::clone(&self.model).into_compiled();
        change(&mut compiled);
        *self = Self::of(compiled)?;
        Ok(())
    }

    /// Returns a copy of the model whose colours show `reward`: dm_control's `_set_reward_colors`.
    pub(crate) fn coloured(&self, reward: f64) -> Model {
        let mut compiled = Model::clone(&self.model).into_compiled();
        let square = reward.clamp(0.0, 1.0) * reward.clamp(0.0, 1.0);
        let part = square * square;
        for (colour, at_one) in compiled.mat_rgba.iter_mut().zip(LOOK_AT_ONE) {
            *colour = std::array::from_fn(|k| part * at_one[k] + (1.0 - part) * colour[k]);
        }
        Model::new(compiled).unwrap_or_else(|_| Model::clone(&self.model))
    }

    /// Computes the derived arrays of an initial state: dm_control's `after_reset`.
    pub(crate) fn settle(&self, data: &mut Data) {
        physics::forward(&self.without_actuators, data);
    }

    /// Repeats the last timestep of a step that was taken together with other worlds. This computes
    /// the derived arrays that such a step skips.
    pub(crate) fn resume(&self, data: &mut Data) {
        data.rewind();
        let last = if self.senses_forces {
            &self.model
        } else {
            &self.without_sensors
        };
        physics::step(last, data);
        physics::step1(&self.model, data);
    }

    /// Advances the state by some timesteps, then computes the arrays that depend on positions and
    /// velocities: dm_control's `step`.
    pub(crate) fn step(&self, data: &mut Data, timesteps: usize) {
        let last = if self.senses_forces {
            &self.model
        } else {
            &self.without_sensors
        };
        let mut steps = 0..timesteps;
        // `step1` of this timestep is already done, except after a step that was taken together
        // with other worlds
        if self.model.opt.integrator != Integrator::RK4 && !data.is_behind() {
            steps.next();
            let model = if timesteps == 1 {
                last
            } else {
                &self.without_sensors
            };
            physics::step2(model, data);
        }
        for i in steps {
            let model = if i + 1 == timesteps {
                last
            } else {
                &self.without_sensors
            };
            physics::substep(model, data);
        }
        physics::step1(&self.model, data);
    }
}

/// Converts an error of gym-mujoco. The models are this crate's own, so only drawn constants can
/// cause an error.
#[expect(clippy::needless_pass_by_value, reason = "`map_err` gives it")]
fn wrong(error: gym_mujoco::Error) -> Error {
    Error::argument("model", error.to_string())
}
