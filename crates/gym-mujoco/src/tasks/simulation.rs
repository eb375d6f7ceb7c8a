//! A model, and the settings with which an environment steps it.

use std::sync::Arc;

use gym_core::spaces::BoxSpace;
use gym_core::{Array, Error, Generator, Result, Space};

use super::arguments::Common;
use super::models::load;
use crate::lanes::{Derived, Stride};
use crate::view::View;
use crate::{Data, Model, forward, physics, step};

/// The constant parts of an environment.
#[derive(Clone, Debug)]
pub struct Simulation {
    /// The model; environments of a task share it.
    pub model: Arc<Model>,
    /// The source of the model: the name of a built-in one, or the path of a file; see [`load`].
    pub xml_file: String,
    /// The number of timesteps per step.
    pub frame_skip: usize,
    /// Length of a step in seconds.
    pub dt: f64,
    /// The camera of rendered pictures.
    pub(super) view: View,
    /// Whether a step computes contact forces. MuJoCo 2.0's Python interface did not.
    contact_forces: bool,
    /// The properties of a step; `None` if the task's worlds cannot step together.
    pub(super) stride: Option<Stride>,
}

impl Simulation {
    pub(super) fn new(arguments: &Common, version: u32) -> Result<Self> {
        arguments.check()?;
        let model = load(&arguments.xml_file, arguments.mujoco.0)?;
        let dt = model.opt.timestep * arguments.frame_skip as f64;
        let view = View::of_task(&model, arguments)?;
        let xml_file = arguments.xml_file.clone();
        Ok(Self {
            model,
            xml_file,
            frame_skip: arguments.frame_skip,
            dt,
            view,
            contact_forces: version >= 4,
            stride: None,
        })
    }

    /// Lets worlds step together, for a task that reads the derived arrays `reads` after a step.
    pub(super) fn read(&mut self, reads: &[Derived]) {
        let computed = |array: &Derived| {
            array.is_known(&self.model) && (self.contact_forces || *array != Derived::CfrcExt)
        };
        self.stride = Some(Stride {
            steps: self.frame_skip,
            settles: false,
            contact_forces: self.contact_forces,
            reads: reads.iter().copied().filter(computed).collect(),
        });
    }

    /// Whether a derived array is current after a step, even if several worlds took the step
    /// together.
    pub(super) fn has(&self, array: Derived) -> bool {
        let stride = self.stride.as_ref();
        stride.is_none_or(|stride| stride.reads.contains(&array))
    }

    /// Computes the state at the start of an episode from its positions and velocities.
    pub(super) fn start(&self, data: &mut Data) {
        forward(&self.model, data);
    }

    /// Sets the controls to `action`, and advances by the timesteps of a step.
    pub fn step(&self, data: &mut Data, action: &Array) {
        for (ctrl, a) in data.ctrl.iter_mut().zip(action.iter_f64()) {
            *ctrl = a;
        }
        if let Some(stride) = &self.stride
            && data.catch_up(&self.model, stride)
        {
            return;
        }
        for _ in 1..self.frame_skip {
            physics::substep(&self.model, data);
        }
        step(&self.model, data);
        if self.contact_forces {
            physics::rne_post_constraint(&self.model, data);
        }
    }

    /// The action space: the ranges of the controls.
    pub(super) fn action_space(&self) -> Result<Space> {
        let bounds = |k: usize| {
            let ranges = self.model.actuator_ctrlrange.iter();
            ranges.map(|range| range[k] as f32).collect::<Vec<_>>()
        };
        Ok(BoxSpace::new(bounds(0), bounds(1))?.into())
    }

    /// Frames per second in real time.
    pub(super) fn fps(&self) -> u32 {
        (1.0 / self.dt).round_ties_even().clamp(1.0, 1e6) as u32
    }

    /// The body `name`, which the task needs.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] if the model has none of that name.
    pub fn body(&self, name: &str) -> Result<usize> {
        self.known("body", name, self.model.body_id(name))
    }

    /// The site `name`, which the task needs.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] if the model has none of that name.
    pub fn site(&self, name: &str) -> Result<usize> {
        self.known("site", name, self.model.site_id(name))
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

/// Sets each of `numbers` to `initial + uniform(-scale, scale)`.
pub(super) fn uniform_noise(numbers: &mut [f64], initial: &[f64], scale: f64, rng: &mut Generator) {
    for (x, x0) in numbers.iter_mut().zip(initial) {
        *x = x0 + rng.uniform(-scale, scale);
    }
}

/// Sets each of `numbers` to `0.0 + scale * standard_normal()`. The sum turns the `-0.0` of a zero
/// `scale` into `0.0`.
pub(super) fn normal_noise(numbers: &mut [f64], scale: f64, rng: &mut Generator) {
    for x in numbers {
        *x = 0.0 + scale * rng.standard_normal();
    }
}

/// Sets each of `numbers` to `uniform(-scale, scale)`.
pub(super) fn uniform_velocities(numbers: &mut [f64], scale: f64, rng: &mut Generator) {
    for x in numbers {
        *x = rng.uniform(-scale, scale);
    }
}
