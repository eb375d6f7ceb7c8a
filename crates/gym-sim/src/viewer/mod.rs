//! A model that a person looks at: stepped live, driven by sliders, pulled by the pointer.
//!
//! [`Viewer`] is what a window and a page share. It has no clock and no pixels: they give it the
//! time that passed and the places of the pointer, and it [draws](Viewer::draw) on a canvas.
//!
//! ```
//! use std::sync::Arc;
//! use gym_sim::engine::Model;
//! use gym_sim::viewer::Viewer;
//!
//! let text = r#"<mujoco>
//!   <worldbody>
//!     <body><joint name="hinge" axis="0 1 0"/><geom type="capsule" fromto="0 0 0 0 0 -.5" size=".05"/></body>
//!   </worldbody>
//!   <actuator><motor name="motor" joint="hinge" ctrlrange="-3 3"/></actuator>
//! </mujoco>"#;
//! let mut viewer = Viewer::new(Arc::new(Model::from_xml(text).unwrap()))?;
//! assert_eq!(viewer.controls()[0].range, [-3.0, 3.0]);
//! viewer.set_control(0, 3.0)?;
//! // a sixtieth of a second passed: 8 timesteps of 2 ms
//! assert_eq!(viewer.advance(1.0 / 60.0, || true)?, 8);
//! # Ok::<(), gym_core::Error>(())
//! ```

mod controls;
mod history;
mod pull;

pub use controls::Control;
pub use history::{HISTORY, SAMPLE, Sensor};

use std::sync::Arc;

use gym_core::canvas::{Canvas, Point};
use gym_core::{Error, Result};

use crate::keyframe::keyframe;
use crate::view::{CameraConfig, Hit, View};
use history::Samples;
use mujoco_engine::math::MAXVAL;
use mujoco_engine::model::ObjectType;
use mujoco_engine::physics::energy;
use mujoco_engine::{CompiledModel, Data, Model, forward, step};
use pull::Pull;

/// The least and the greatest speed, in model seconds for a second.
pub const SPEEDS: [f64; 2] = [1.0 / 1024.0, 1024.0];
/// The longest time that [`Viewer::advance`] makes up for, in s.
const LONGEST: f64 = 0.25;

/// A model with its state, a camera, and what a person does with them.
///
/// Its steps are those of [`mujoco_engine::step`], and allocate nothing.
#[derive(Clone, Debug)]
pub struct Viewer {
    model: Arc<Model>,
    data: Data,
    controls: Vec<Control>,
    free: View,
    /// The camera of the model through which it is seen, and its number.
    own: Option<(usize, View)>,
    /// Whether time stands still in [`advance`](Self::advance).
    pub is_paused: bool,
    /// Whether pictures show contacts.
    pub shows_contacts: bool,
    /// Whether pictures show the forces of contacts.
    pub shows_forces: bool,
    /// The most samples of a pixel in a row: see [`View::with_samples`].
    pub samples: usize,
    speed: f64,
    /// The model's time that is due, in s: less than a timestep after [`advance`](Self::advance).
    due: f64,
    selected: Option<Hit>,
    pull: Option<Pull>,
    sensors: Vec<Sensor>,
    recorded: Samples,
}

impl Viewer {
    /// A model in its initial configuration, seen by a free camera at 1.5 times the model's extent from
    /// its centre.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] for a model whose statistics are not finite.
    pub fn new(model: Arc<Model>) -> Result<Self> {
        let extent = model.stat.extent;
        let distance = if extent > 0.0 { 1.5 * extent } else { 1.0 };
        let camera = CameraConfig::at(model.stat.center, distance, 120.0, -20.0);
        let free = View::new(&model, &camera)?;
        let mut data = Data::new(&model);
        forward(&model, &mut data);
        Ok(Self {
            controls: controls::of(&model),
            sensors: history::of(&model),
            recorded: Samples::new(&model),
            free,
            own: None,
            is_paused: false,
            shows_contacts: false,
            shows_forces: false,
            samples: usize::MAX,
            speed: 1.0,
            due: 0.0,
            selected: None,
            pull: None,
            data,
            model,
        })
    }

    /// The model.
    #[must_use]
    pub fn model(&self) -> &Arc<Model> {
        &self.model
    }

    /// The state.
    #[must_use]
    pub fn data(&self) -> &Data {
        &self.data
    }

    /// Advances by some timesteps, also while time stands still.
    ///
    /// # Errors
    /// [`Error::Custom`] if the simulation diverges; it is then reset, as MuJoCo does.
    pub fn step(&mut self, timesteps: usize) -> Result<()> {
        for _ in 0..timesteps {
            self.timestep()?;
        }
        Ok(())
    }

    /// Advances by the timesteps that fall into `seconds` of real time at the current speed, as long
    /// as `goes_on` returns true. What is not taken then is dropped, as is what exceeds a quarter of
    /// a second: a model that is slower than real time runs slower. Returns the number of timesteps.
    ///
    /// # Errors
    /// Those of [`step`](Self::step).
    pub fn advance(&mut self, seconds: f64, mut goes_on: impl FnMut() -> bool) -> Result<usize> {
        if self.is_paused || !seconds.is_finite() {
            return Ok(0);
        }
        self.due += seconds.clamp(0.0, LONGEST) * self.speed;
        let mut taken = 0;
        while self.due >= self.model.opt.timestep {
            if !goes_on() {
                self.due = 0.0;
                break;
            }
            self.timestep()?;
            self.due -= self.model.opt.timestep;
            taken += 1;
        }
        Ok(taken)
    }

    fn timestep(&mut self) -> Result<()> {
        let before = self.data.time;
        if let Some(pull) = &self.pull {
            pull.apply(&self.model, &mut self.data);
        }
        let is_near = |numbers: &[f64]| numbers.iter().all(|x| x.abs() <= MAXVAL);
        let is_state_near = |data: &Data| is_near(&data.qpos) && is_near(&data.qvel);
        // The engine resets a state that diverges: then time starts again. In the first timestep, which
        // time does not tell from one after a reset, the accelerations do.
        let mut goes_on = true;
        if before < self.model.opt.timestep {
            forward(&self.model, &mut self.data);
            goes_on = is_state_near(&self.data) && is_near(&self.data.qacc);
        }
        step(&self.model, &mut self.data);
        if !(goes_on && self.data.time > before && is_state_near(&self.data)) {
            self.reset();
            return Err(Error::custom(format!(
                "the simulation diverged at {before:.4} s, and was reset: try a smaller timestep than {} s, or smaller \
                 controls and forces",
                self.model.opt.timestep
            )));
        }
        self.recorded.take(&self.data);
        Ok(())
    }

    /// The speed: how many seconds of the model pass in a second.
    #[must_use]
    pub fn speed(&self) -> f64 {
        self.speed
    }

    /// Changes the speed, within [`SPEEDS`].
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] for a speed beyond.
    pub fn set_speed(&mut self, speed: f64) -> Result<()> {
        let [least, most] = SPEEDS;
        if !(least..=most).contains(&speed) {
            let reason = format!("{speed} is not from {least} to {most}");
            return Err(Error::argument("speed", reason));
        }
        self.speed = speed;
        Ok(())
    }

    /// Resets to the initial configuration, with all controls zero.
    pub fn reset(&mut self) {
        self.data.reset(&self.model);
        self.start();
    }

    /// Resets to a keyframe, given by its name or number: see [`keyframe`](crate::keyframe).
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] if the model has no such keyframe; nothing changes.
    pub fn reset_to(&mut self, name: &str) -> Result<()> {
        let key = keyframe(&self.model, name)?;
        let reset = self.data.reset_keyframe(&self.model, key);
        reset.map_err(|error| Error::argument("keyframe", error.to_string()))?;
        self.start();
        Ok(())
    }

    fn start(&mut self) {
        self.pull = None;
        self.due = 0.0;
        self.recorded.clear();
        forward(&self.model, &mut self.data);
    }

    /// The controls of the actuators, in their order.
    #[must_use]
    pub fn controls(&self) -> &[Control] {
        &self.controls
    }

    /// Sets the control of an actuator. The engine clamps it to the actuator's range, if it has one.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] for an actuator that the model does not have, and for a number
    /// that is not finite.
    pub fn set_control(&mut self, actuator: usize, value: f64) -> Result<()> {
        let count = self.data.ctrl.len();
        let Some(control) = self.data.ctrl.get_mut(actuator) else {
            let reason = format!("{actuator}: the model has {count}");
            return Err(Error::argument("actuator", reason));
        };
        if !value.is_finite() {
            let reason = format!("{value} is not finite");
            return Err(Error::argument("control", reason));
        }
        *control = value;
        Ok(())
    }

    /// The view of the current camera.
    #[must_use]
    pub fn view(&self) -> &View {
        self.own.as_ref().map_or(&self.free, |(_, view)| view)
    }

    /// Turns the free camera: [`View::turn_by`].
    pub fn turn_by(&mut self, moved: Point) {
        self.free.turn_by(moved);
    }

    /// Moves the free camera: [`View::move_by`].
    pub fn move_by(&mut self, moved: Point, level: bool) {
        self.free.move_by(moved, level);
    }

    /// Moves the free camera nearer or further: [`View::zoom_by`].
    pub fn zoom_by(&mut self, heights: f64) {
        self.free.zoom_by(heights, &self.model);
    }

    /// The body that the free camera follows.
    #[must_use]
    pub fn followed(&self) -> Option<usize> {
        let camera = self.free.free_camera()?;
        usize::try_from(camera.trackbodyid?).ok()
    }

    /// Lets the free camera follow a body in x and y, or stand still.
    pub fn follow(&mut self, body: Option<usize>) {
        self.free.follow(body, &self.data);
    }

    /// Replaces the free camera.
    ///
    /// # Errors
    /// Those of [`View::new`].
    pub fn set_free_camera(&mut self, camera: &CameraConfig) -> Result<()> {
        self.free = View::new(&self.model, camera)?;
        Ok(())
    }

    /// The number of the model's camera that is the current one; `None` for the free camera.
    #[must_use]
    pub fn camera(&self) -> Option<usize> {
        self.own.as_ref().map(|(id, _)| *id)
    }

    /// Looks through a camera of the model, or through the free one.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] for a camera that the model does not have.
    pub fn use_camera(&mut self, camera: Option<usize>) -> Result<()> {
        self.own = match camera {
            None => None,
            Some(id) if id < self.model.cam_mode.len() => {
                Some((id, View::of_camera(&self.model, id)))
            }
            Some(id) => {
                let count = self.model.cam_mode.len();
                let reason = format!("{id}: the model has {count}");
                return Err(Error::argument("camera", reason));
            }
        };
        Ok(())
    }

    /// Selects what a point of the picture shows, and takes hold of it, if it can move.
    /// [`pull`](Self::pull) then pulls it. Returns what was selected: `None` for the sky.
    pub fn select(&mut self, at: Point, size: (u32, u32)) -> Option<Hit> {
        self.release();
        self.selected = self.view().at(&self.model, &self.data, size, at);
        self.pull = self.selected.and_then(|hit| {
            let depth = self.view().depth_at(&self.data, hit.point);
            Pull::new(&self.model, &self.data, &hit, depth)
        });
        self.selected
    }

    /// What was selected last.
    #[must_use]
    pub fn selected(&self) -> Option<Hit> {
        self.selected
    }

    /// Whether a body is pulled: the selected one.
    #[must_use]
    pub fn is_pulling(&self) -> bool {
        self.pull.is_some()
    }

    /// Pulls the body that was taken hold of towards a point of the picture, by a spring, in the plane
    /// that faces the camera. A mocap body goes there; while time stands still, so does a tree of
    /// bodies that floats.
    pub fn pull(&mut self, at: Point, size: (u32, u32)) {
        let Some(pull) = &mut self.pull else { return };
        let view = self.own.as_ref().map_or(&self.free, |(_, view)| view);
        pull.aim(view.ray(&self.data, size, at));
        if pull.place(&self.model, &mut self.data, self.is_paused) && self.is_paused {
            forward(&self.model, &mut self.data);
        }
    }

    /// Lets go of the body that is pulled.
    pub fn release(&mut self) {
        if let Some(pull) = self.pull.take() {
            pull.end(&mut self.data);
        }
    }

    /// The sensors, in their order.
    #[must_use]
    pub fn sensors(&self) -> &[Sensor] {
        &self.sensors
    }

    /// The current values of a sensor; empty if the model does not have it.
    #[must_use]
    pub fn sensor(&self, sensor: usize) -> &[f64] {
        let range = self.sensors.get(sensor).map(Sensor::range);
        let values = range.and_then(|range| self.data.sensordata.get(range));
        values.unwrap_or_default()
    }

    /// The last values of a number of a sensor, the oldest first: at most [`HISTORY`], one for
    /// every [`SAMPLE`] seconds of the model. Empty for a number that is not recorded.
    pub fn history(&self, sensor: usize, number: usize) -> impl ExactSizeIterator<Item = f64> {
        let range = self.sensors.get(sensor).map(Sensor::range);
        let column = range.and_then(|mut range| range.nth(number));
        self.recorded.column(column)
    }

    /// The potential and the kinetic energy, in J.
    pub fn energy(&mut self) -> [f64; 2] {
        energy(&self.model, &mut self.data)
    }

    /// Draws the state.
    pub fn draw(&self, size: (u32, u32), canvas: &mut dyn Canvas) {
        let view = self.view().clone().with_samples(self.samples);
        let (model, data) = (&self.model, &self.data);
        view.draw(model, data, size, canvas);
        if self.shows_contacts || self.shows_forces {
            view.draw_contacts(model, data, size, self.shows_forces, canvas);
        }
        if let Some(ends) = self.pull.as_ref().and_then(|pull| pull.ends(data)) {
            view.draw_pull(model, data, size, ends, canvas);
        }
    }
}

/// The name of an object, or its kind and number.
#[must_use]
pub fn name(model: &CompiledModel, kind: ObjectType, id: usize) -> String {
    match model.name(kind, id) {
        Some(name) => name.to_owned(),
        None => format!("{} {id}", format!("{kind:?}").to_lowercase()),
    }
}

#[cfg(test)]
mod pictures;
#[cfg(test)]
mod tests;
