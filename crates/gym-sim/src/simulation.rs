//! A model, and how an environment steps it.

use std::sync::Arc;

use gym_core::{Array, Error, Result};
use mujoco_engine::lanes::{Derived, Stride, differ_in_stiffness};
use mujoco_engine::model::{Integrator, SensorType};
use mujoco_engine::physics::{
    forward, forward_without_actuators, rne_post_constraint, step, step1, step2, substep, substep2,
};
use mujoco_engine::{CompiledModel, Data, Model};

use crate::arguments::Common;
use crate::keyframe::keyframe;
use crate::view::View;

/// The constant parts of an environment: a model, and how it is stepped and seen.
#[derive(Clone, Debug)]
pub struct Simulation {
    /// The model; environments of a task share it.
    pub model: Arc<Model>,
    /// The model that environments share, if `model` differs from it in the stiffness of joints alone.
    pub(crate) shared: Option<Arc<Model>>,
    /// The source of the model: the name of a built-in one, the path of a file, or a text in MJCF.
    pub xml_file: String,
    /// The keyframe that episodes start from, by number.
    pub(crate) keyframe: Option<usize>,
    /// The number of timesteps per step.
    pub frame_skip: usize,
    /// Length of a step in seconds.
    pub dt: f64,
    /// The camera of rendered pictures.
    pub(crate) view: View,
    /// When derived arrays are computed.
    pub stepper: Stepper,
    /// The properties of a step; `None` if the task's worlds cannot step together.
    pub(crate) stride: Option<Stride>,
}

/// When the derived arrays of the data are computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stepper {
    /// At the start of the last timestep, as by `mj_step` in Gymnasium: frames are a timestep older
    /// than positions.
    Behind {
        /// Whether a step computes contact forces (`cfrc_ext`) too.
        contact_forces: bool,
    },
    /// For the new state, as dm_control does by calling `mj_step2` before `mj_step1`.
    Settled,
}

impl Simulation {
    /// The model that `load` gives, stepped by `stepper`, with the frame skip and the camera of
    /// `arguments`.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] for an argument out of range, and a camera or keyframe that the
    /// model lacks; those of `load`.
    pub fn new(
        load: impl FnOnce() -> Result<Arc<Model>>,
        arguments: &Common,
        stepper: Stepper,
    ) -> Result<Self> {
        arguments.check()?;
        let model = load()?;
        let view = arguments.view(&model)?;
        let named = arguments.keyframe.as_deref();
        Ok(Self {
            xml_file: arguments.xml_file.clone(),
            keyframe: named.map(|name| keyframe(&model, name)).transpose()?,
            frame_skip: arguments.frame_skip,
            dt: model.opt.timestep * arguments.frame_skip as f64,
            model,
            shared: None,
            view,
            stepper,
            stride: None,
        })
    }

    /// Lets worlds step together, for a task that reads the derived arrays `reads` after a step.
    pub(crate) fn read(&mut self, reads: &[Derived]) {
        let (settles, contact_forces) = match self.stepper {
            Stepper::Behind { contact_forces } => (false, contact_forces),
            Stepper::Settled => (true, true),
        };
        let computed = |array: &Derived| {
            settles || array.is_known(&self.model) && (contact_forces || *array != Derived::CfrcExt)
        };
        self.stride = Some(Stride {
            steps: self.frame_skip,
            settles,
            contact_forces: contact_forces && !settles,
            reads: reads.iter().copied().filter(computed).collect(),
        });
    }

    /// Whether a derived array is current after a step, even if several worlds took the step
    /// together.
    pub(crate) fn has(&self, array: Derived) -> bool {
        let stride = self.stride.as_ref();
        stride.is_none_or(|stride| stride.reads.contains(&array))
    }

    /// Whether pictures are seen from a free camera, which
    /// [`turn_camera`](crate::SimEnv::turn_camera) turns.
    #[must_use]
    pub fn has_free_camera(&self) -> bool {
        self.view.is_free()
    }

    /// The model whose worlds step together with those of `model`.
    pub(crate) fn shared(&self) -> &Arc<Model> {
        self.shared.as_ref().unwrap_or(&self.model)
    }

    /// Changes fields of the model.
    pub(crate) fn change(&mut self, change: impl FnOnce(&mut CompiledModel)) -> Result<()> {
        let mut compiled = CompiledModel::clone(&self.model);
        change(&mut compiled);
        let wrong = |error: mujoco_engine::Error| Error::argument("model", error.to_string());
        let model = Model::new(compiled).map(Arc::new).map_err(wrong)?;
        let shared = self.shared();
        self.shared = differ_in_stiffness(shared, &model).then(|| Arc::clone(shared));
        self.model = model;
        Ok(())
    }

    /// The positions that episodes start from: those of the keyframe, or of the initial
    /// configuration.
    #[must_use]
    pub fn initial_qpos(&self) -> &[f64] {
        match self.keyframe {
            Some(key) => &self.model.key_qpos[key],
            None => &self.model.qpos0,
        }
    }

    /// The velocities that episodes start from.
    #[must_use]
    pub fn initial_qvel(&self) -> Vec<f64> {
        match self.keyframe {
            Some(key) => self.model.key_qvel[key].clone(),
            None => vec![0.0; self.model.nv()],
        }
    }

    /// Resets to the state that episodes start from.
    pub(crate) fn reset(&self, data: &mut Data) {
        match self.keyframe {
            // (the model has the keyframe)
            Some(key) => drop(data.reset_keyframe(&self.model, key)),
            None => data.reset(&self.model),
        }
    }

    /// Computes the derived arrays of a state that was set. (dm_control does so without the
    /// actuators.)
    pub(crate) fn settle(&self, data: &mut Data) {
        match self.stepper {
            Stepper::Behind { .. } => forward(&self.model, data),
            Stepper::Settled => forward_without_actuators(&self.model, data),
        }
    }

    /// Sets the controls to `action`, and advances by the timesteps of a step.
    pub fn step(&self, data: &mut Data, action: &Array) {
        self.drive(data, action.iter_f64());
    }

    /// Sets the controls, and advances by the timesteps of a step. Worlds whose controls are not the
    /// action must not step together: their task [reads](crate::SimTask::reads) `None`.
    pub fn drive(&self, data: &mut Data, controls: impl Iterator<Item = f64>) {
        for (ctrl, a) in data.ctrl.iter_mut().zip(controls) {
            *ctrl = a;
        }
        let stride = self.stride.as_ref();
        if !stride.is_some_and(|stride| data.catch_up(&self.model, stride)) {
            self.advance(data, self.frame_skip);
        }
    }

    /// Advances the state by some timesteps, at least one.
    pub(crate) fn advance(&self, data: &mut Data, timesteps: usize) {
        let model = &*self.model;
        match self.stepper {
            Stepper::Behind { contact_forces } => {
                for _ in 1..timesteps {
                    substep(model, data);
                }
                step(model, data);
                if contact_forces {
                    rne_post_constraint(model, data);
                }
            }
            Stepper::Settled => settled(model, data, timesteps),
        }
    }

    /// Frames per second in real time.
    pub(crate) fn fps(&self) -> u32 {
        (1.0 / self.dt).round_ties_even().clamp(1.0, 1e6) as u32
    }

    /// The body `name`, which the task needs.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] if the model has none of that name.
    pub fn body(&self, name: &str) -> Result<usize> {
        self.known("body", name, self.model.body_id(name))
    }

    /// The geom `name`, which the task needs.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] if the model has none of that name.
    pub fn geom(&self, name: &str) -> Result<usize> {
        self.known("geom", name, self.model.geom_id(name))
    }

    /// The site `name`, which the task needs.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] if the model has none of that name.
    pub fn site(&self, name: &str) -> Result<usize> {
        self.known("site", name, self.model.site_id(name))
    }

    /// The joint `name`, which the task needs.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] if the model has none of that name.
    pub fn joint(&self, name: &str) -> Result<usize> {
        self.known("joint", name, self.model.joint_id(name))
    }

    /// The sensor `name`, which the task needs.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] if the model has none of that name.
    pub fn sensor(&self, name: &str) -> Result<usize> {
        self.known("sensor", name, self.model.sensor_id(name))
    }

    fn known(&self, kind: &str, name: &str, id: Option<usize>) -> Result<usize> {
        let missing = || format!("the model has no {kind} {name:?}");
        id.ok_or_else(|| Error::argument("xml_file", missing()))
    }

    /// Refuses a model with fewer than `at_least` objects of the kind `what`.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] with the numbers.
    pub fn needs(&self, what: &str, there_are: usize, at_least: usize) -> Result<()> {
        if there_are >= at_least {
            return Ok(());
        }
        let reason = format!("the model has {there_are} {what}, the task needs {at_least}");
        Err(Error::argument("xml_file", reason))
    }
}

/// Advances the state by some timesteps, and computes the derived arrays of the new state.
fn settled(m: &Model, data: &mut Data, timesteps: usize) {
    use SensorType::{Accelerometer, Force, Torque, Touch};
    // the last timestep measures forces and accelerations, which `step1` does not
    let late = [Touch, Force, Torque, Accelerometer];
    let measures = m.sensor_type.iter().any(|kind| late.contains(kind));
    // `step1` of the first timestep is already done, except after a step that was taken together
    // with other worlds
    let is_begun = m.opt.integrator != Integrator::RK4 && !data.has_stale_arrays();
    for timestep in 1..=timesteps {
        let part = match (timestep == 1 && is_begun, timestep == timesteps && measures) {
            (true, true) => step2,
            (true, false) => substep2,
            (false, true) => step,
            (false, false) => substep,
        };
        part(m, data);
    }
    step1(m, data);
}
