//! The environment of a task.

use std::sync::{Arc, OnceLock};

use gym_core::canvas::Canvas;
use gym_core::render::Metadata;
use gym_core::spaces::BoxSpace;
use gym_core::vector::lockstep::Lockstep;
use gym_core::{
    Array, Env, Error, Generator, Goals, Inspect, Names, Outcome, RandomState, Reset, Result, Seed,
    Snapshot, Space, Value,
};
use mujoco_engine::Data;
use mujoco_engine::lanes::Derived;
use mujoco_engine::math::MAXVAL;
use serde_json::{Value as Json, json};

use crate::episode::Episode;
use crate::naming::Naming;
use crate::observation::{Layout, Observation};
use crate::pixels::Pixels;
use crate::rng::Rng;
use crate::settings::Settings;
use crate::simulation::{Simulation, Stepper};
use crate::start::Start;
use crate::task::SimTask;
use crate::together::{Groups, Member};

/// The environment of a task.
///
/// A state that diverges goes on from MuJoCo's reset of the simulation, as in Gymnasium.
#[derive(Clone, Debug)]
pub struct SimEnv {
    settings: Arc<Settings>,
    task: Arc<dyn SimTask>,
    simulation: Simulation,
    observation_space: Space,
    action_space: Space,
    /// The shape of an action.
    action_shape: Vec<usize>,
    layout: Layout,
    seen: Observation,
    pixels: Option<Pixels>,
    episode: Option<Box<Episode>>,
    /// A copy of the data with current derived arrays, computed on request if the episode's arrays
    /// are older than its state.
    resumed: OnceLock<Box<Data>>,
    /// The step of this environment in a group, while several environments step together.
    member: Option<Member>,
}

impl SimEnv {
    /// Makes the environment of a task.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] for settings out of range, and for ranges of controls that no
    /// space can have.
    pub fn new(
        task: Arc<dyn SimTask>,
        mut simulation: Simulation,
        settings: Settings,
    ) -> Result<Self> {
        let model = Arc::clone(&simulation.model);
        let reads = task.reads(&model);
        // an image needs all frames
        if let Some(reads) = reads.filter(|_| settings.pixels.is_none()) {
            simulation.read(&reads);
        }
        let mut data = Data::new(&model);
        data.userdata.resize(task.remembers(), 0.0);
        simulation.settle(&mut data);
        let mut seen = Observation::default();
        task.observe(&model, &data, &mut seen);
        let layout = seen.layout();
        let pixels = settings.pixels.map(Pixels::new).transpose()?;
        let observation_space = match &pixels {
            Some(pixels) => pixels.space()?,
            None => layout.space(settings.flat, settings.dtype)?,
        };
        let action_space = match &settings.action_space {
            Some(space) => space.clone(),
            None => {
                let bounds = |side: usize| -> Vec<f32> {
                    let ranges = model.actuator_ctrlrange.iter();
                    ranges.map(|range| range[side] as f32).collect()
                };
                BoxSpace::new(bounds(0), bounds(1))?.into()
            }
        };
        let action_shape = match &action_space {
            Space::Box(space) => space.shape().to_vec(),
            _ => vec![model.nu()],
        };
        Ok(Self {
            settings: Arc::new(settings),
            task,
            simulation,
            observation_space,
            action_space,
            action_shape,
            layout,
            seen,
            pixels,
            episode: None,
            resumed: OnceLock::new(),
            member: None,
        })
    }

    /// The name of the environment: [`Settings::name`].
    #[must_use]
    pub fn name(&self) -> &'static str {
        self.settings.name
    }

    /// The names of the numbers in observations and actions.
    #[must_use]
    pub fn names(&self) -> Names {
        let mut names = Naming::new(&self.simulation.model);
        if self.pixels.is_none() {
            self.task.names(&mut names);
        }
        names.finish(self.settings.flat, self.action_shape.iter().product())
    }

    /// The model, and how it is stepped.
    #[must_use]
    pub fn simulation(&self) -> &Simulation {
        &self.simulation
    }

    /// The state of the model, with current derived arrays; `None` before the first reset.
    pub fn data(&self) -> Option<&Data> {
        let data = &self.episode.as_ref()?.data;
        if !data.has_stale_arrays() {
            return Some(data);
        }
        Some(self.resumed.get_or_init(|| {
            let mut data = data.clone();
            data.resume(&self.simulation.model);
            self.task.show(&mut data);
            Box::new(data)
        }))
    }

    /// Whether the last step was taken together with other worlds: see [`Data::has_stale_arrays`].
    pub fn has_stale_arrays(&self) -> bool {
        let episode = self.episode.as_ref();
        episode.is_some_and(|episode| episode.data.has_stale_arrays())
    }

    /// The `RandomState` from which the next start is drawn, for tasks that have one, after the first
    /// reset.
    #[must_use]
    pub fn random_state(&self) -> Option<&RandomState> {
        match &self.episode.as_ref()?.rng {
            Rng::RandomState(both) => Some(&both.0),
            Rng::Generator(_) => None,
        }
    }

    /// Continues the episode from other positions and velocities (nq and nv numbers): Gymnasium's
    /// `MujocoEnv.set_state`.
    ///
    /// # Errors
    /// [`Error::ResetNeeded`] before the first reset; [`Error::InvalidArgument`] for another number
    /// of positions or velocities than the model has, and for one outside ±1e10, where MuJoCo
    /// resets a simulation. On error, nothing changes.
    pub fn set_state(&mut self, qpos: &[f64], qvel: &[f64]) -> Result<()> {
        let Some(episode) = &mut self.episode else {
            return Err(Error::ResetNeeded("set_state"));
        };
        let model = &self.simulation.model;
        for (name, numbers, needed) in [("qpos", qpos, model.nq()), ("qvel", qvel, model.nv())] {
            if numbers.len() != needed {
                let reason = format!("the model has {needed} numbers, not {}", numbers.len());
                return Err(Error::argument(name, reason));
            }
            if let Some(x) = numbers.iter().find(|x| x.is_nan() || x.abs() > MAXVAL) {
                let reason = format!("{x} is not within ±{MAXVAL:e}");
                return Err(Error::argument(name, reason));
            }
        }
        self.resumed.take();
        episode.data.qpos.copy_from_slice(qpos);
        episode.data.qvel.copy_from_slice(qvel);
        self.simulation.settle(&mut episode.data);
        self.task.show(&mut episode.data);
        Ok(())
    }

    /// Turns the free camera around the point that it looks at, by degrees, and multiplies its
    /// distance by `zoom`, within bounds. Only frames change. Cameras of the model are unchanged.
    pub fn turn_camera(&mut self, azimuth: f64, elevation: f64, zoom: f64) {
        self.simulation.view.turn(azimuth, elevation, zoom);
    }

    /// Whether derived arrays are those of the new state after a step.
    fn settles(&self) -> bool {
        self.simulation.stepper == Stepper::Settled
    }

    /// Returns the generator of a new episode, and whether the reset seeded it.
    fn seeded(&self, reset: &Reset) -> Result<(Option<Rng>, bool)> {
        let last = self.episode.as_ref().map(|episode| &episode.rng);
        if !self.settings.random_state {
            let last = match last {
                Some(Rng::Generator(generator)) => Some(generator),
                _ => None,
            };
            let generator = reset.generator(last)?;
            return Ok((Some(Rng::Generator(generator)), reset.seed.is_some()));
        }
        let seed = match (&reset.seed, last) {
            (None, None) => Some(Seed::from_os()?),
            (seed, _) => seed.clone(),
        };
        let rng = seed.as_ref().map(|seed| {
            let both = (RandomState::from_seed(seed), Generator::new(seed));
            Rng::RandomState(Box::new(both))
        });
        let seeded = rng.is_some();
        Ok((rng, seeded))
    }

    fn start(&mut self, reset: &Reset) -> Result<Box<Episode>> {
        self.task.check_options(&reset.options)?;
        let (rng, seeded) = self.seeded(reset)?;
        // the old data is reused, not cloned: a clone would allocate its contacts again
        let mut episode = match (self.episode.take(), rng) {
            (Some(mut episode), Some(rng)) => {
                episode.rng = rng;
                episode
            }
            (Some(episode), None) => episode,
            (None, rng) => Box::new(Episode {
                rng: rng.unwrap_or_else(|| Rng::Generator(Generator::from(0))),
                constants: Vec::new(),
                steps: 0,
                data: Data::new(&self.simulation.model),
                measures: self.task.measures(),
                measured: None,
            }),
        };
        (episode.steps, episode.measured) = (0, None);
        let Episode {
            rng,
            constants,
            data,
            ..
        } = &mut *episode;
        if seeded || !self.task.goes_on() || !data.is_computed() {
            self.simulation.reset(data);
        }
        data.userdata.resize(self.task.remembers(), 0.0);
        if self.settles() {
            self.simulation.settle(data);
        }
        self.task.start(&mut Start {
            simulation: &mut self.simulation,
            data,
            rng,
            constants,
            seeded,
            options: &reset.options,
        })?;
        let [qpos, qvel] = &self.settings.start;
        for (given, numbers) in [(qpos, &mut data.qpos), (qvel, &mut data.qvel)] {
            if let Some(given) = given {
                numbers.copy_from_slice(given);
            }
        }
        self.simulation.settle(data);
        self.task.sense(data, rng);
        self.task.show(data);
        Ok(episode)
    }

    /// Draws the state `data` on a canvas of the size `size`.
    fn picture(&self, data: &Data, size: (u32, u32), canvas: &mut dyn Canvas) {
        let Simulation { model, view, .. } = &self.simulation;
        if let Some(coloured) = self.settings.coloured {
            let model = coloured(model, self.task.reward(model, data));
            return view.draw(&model, data, size, canvas);
        }
        view.draw(model, data, size, canvas);
    }

    fn observe(&mut self, observation: &mut Value) {
        let Some(episode) = &self.episode else { return };
        if let Some(mut pixels) = self.pixels.take() {
            let draw = |size, canvas: &mut dyn Canvas| self.picture(&episode.data, size, canvas);
            pixels.write(draw, observation);
            self.pixels = Some(pixels);
            return;
        }
        let settings = &*self.settings;
        self.seen.clear();
        let model = &self.simulation.model;
        self.task.observe(model, &episode.data, &mut self.seen);
        self.seen
            .write(&self.layout, settings.flat, settings.dtype, observation);
    }
}

impl Env for SimEnv {
    type Observation = Value;
    type Action = Array;

    fn observation_space(&self) -> Space {
        self.observation_space.clone()
    }

    fn action_space(&self) -> Space {
        self.action_space.clone()
    }

    fn reset_into(&mut self, reset: &Reset, observation: &mut Value) -> Result<()> {
        self.resumed.take();
        self.episode = Some(self.start(reset)?);
        self.observe(observation);
        Ok(())
    }

    fn step_into(&mut self, action: &Array, observation: &mut Value) -> Result<Outcome> {
        let Some(episode) = &mut self.episode else {
            return Err(Error::ResetNeeded("step"));
        };
        if !action.has_shape(&self.action_shape) || !action.is_finite() {
            return Err(self.action_space.refuse_action(action));
        }
        self.resumed.take();
        let Episode { data, rng, .. } = &mut **episode;
        self.task.prepare(data);
        let mut measured = self.task.step(&self.simulation, data, action);
        self.task.sense(data, rng);
        if !data.has_stale_arrays() {
            self.task.show(data);
        }
        episode.steps += 1;
        let truncated = episode.steps as f64 >= self.settings.limit;
        self.observe(observation);
        if let Some(episode) = self.episode.as_deref_mut() {
            let Episode { data, rng, .. } = episode;
            self.task.follow(data, rng, &mut measured);
            episode.measured = Some(measured);
        }
        Ok(Outcome {
            reward: measured.reward,
            terminated: measured.terminated && !truncated,
            truncated,
        })
    }

    fn snapshot(&self) -> Result<Snapshot> {
        let settings = &*self.settings;
        Snapshot::with_config(settings.name, &settings.config(), &self.episode)
    }

    fn restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        let settings = &*self.settings;
        let config = settings.config();
        let (of, measures) = ((settings.name, &config), self.task.measures());
        let found = Episode::read(snapshot, of, measures, settings.random_state);
        let mut episode = found.map_err(|error| settings.explain_refusal(snapshot, error))?;
        if let Some(Episode {
            constants,
            steps,
            data,
            ..
        }) = &mut episode
        {
            let valid = data.check(&self.simulation.model).is_ok()
                && data.is_bounded()
                && (!self.settles() || data.is_computed())
                && *steps as f64 <= settings.limit.min(1e15)
                && self.task.has(constants)
                && data.userdata.len() == self.task.remembers()
                && data.userdata.iter().all(|x| x.abs() <= MAXVAL);
            if !valid {
                let env = settings.name;
                let reason = format!("its content is not a state of this {env}");
                return Err(Error::Snapshot(reason));
            }
            if !constants.is_empty() {
                let task = &*self.task;
                self.simulation
                    .change(|model| task.apply(constants, model))?;
            }
            data.resume(&self.simulation.model);
            self.task.show(data);
        }
        self.episode = episode.map(Box::new);
        self.resumed.take();
        Ok(())
    }

    fn info(&self, visit: &mut dyn FnMut(&str, Value)) {
        let Some(episode) = &self.episode else { return };
        let Episode { data, measured, .. } = &**episode;
        let tendons_follow = self.task.tendons_follow();
        let there = self.simulation.has(Derived::TenVelocity);
        self.task
            .info(&self.simulation, data, measured.as_ref(), &mut |name, x| {
                visit(name, Value::Float(x));
                if tendons_follow == Some(name)
                    && let Some(data) = if there { Some(data) } else { self.data() }
                {
                    let array = |numbers: &[f64]| Value::Array(numbers.to_vec().into());
                    visit("tendon_length", array(&data.ten_length));
                    visit("tendon_velocity", array(&data.ten_velocity));
                }
            });
        self.task.lists(data, measured.as_ref(), visit);
        if let Some(success) = self.task.success(data, measured.as_ref()) {
            visit("success", Value::Bool(success));
        }
    }

    fn metadata(&self) -> Metadata {
        let (fps, size) = (self.simulation.fps(), self.settings.size);
        if self.settings.depth {
            Metadata::drawn_and_depth(fps, size)
        } else {
            Metadata::drawn(fps, size)
        }
    }

    fn draw(&self, canvas: &mut dyn Canvas) {
        if let Some(data) = self.data() {
            self.picture(data, self.settings.size, canvas);
        }
    }

    fn depth(&self, size: (u32, u32)) -> Option<Vec<f32>> {
        let data = self.data().filter(|_| self.settings.depth)?;
        let Simulation { model, view, .. } = &self.simulation;
        Some(view.depth_of(model, data, self.settings.size, size))
    }

    fn describe(&self) -> String {
        self.settings.name.to_owned()
    }

    fn generator(&mut self) -> Option<&mut Generator> {
        self.episode.as_mut().map(|episode| episode.rng.generator())
    }

    fn inspect(&self) -> Option<&dyn Inspect> {
        Some(self)
    }

    fn inspect_mut(&mut self) -> Option<&mut dyn Inspect> {
        Some(self)
    }

    fn close(&mut self) {
        self.episode = None;
        self.resumed.take();
    }
}

impl Lockstep for SimEnv {
    type Group = Groups;

    fn begin_reset(&mut self, _: &Reset, _: &mut Groups) {
        self.member = None;
    }

    fn begin_step(&mut self, action: &Array, worlds: &mut Groups) {
        let fits = action.has_shape(&self.action_shape) && action.is_finite();
        if let Some(episode) = self.episode.as_mut().filter(|_| fits) {
            self.task.prepare(&mut episode.data);
        }
        let episode = self.episode.as_deref().filter(|_| fits);
        self.member =
            episode.and_then(|episode| worlds.begin(&self.simulation, &episode.data, action));
    }

    fn collect(&mut self, worlds: &mut Groups) {
        if let (Some(member), Some(episode)) = (self.member.take(), &mut self.episode) {
            worlds.collect(member, &mut episode.data);
        }
    }
}

/// The state is `qpos` and `qvel`, as in Gymnasium's `set_state`.
impl Inspect for SimEnv {
    fn state(&self) -> Option<Json> {
        let Data { qpos, qvel, .. } = &self.episode.as_ref()?.data;
        Some(json!({"qpos": qpos, "qvel": qvel}))
    }

    fn set_state(&mut self, state: Json) -> Result<()> {
        let numbers = |name: &str| -> Result<Vec<f64>> {
            serde_json::from_value(state[name].clone())
                .map_err(|error| Error::argument(name, format!("a list of numbers: {error}")))
        };
        Self::set_state(self, &numbers("qpos")?, &numbers("qvel")?)
    }

    fn arguments(&self) -> Json {
        self.settings.arguments.clone()
    }

    fn goals(&self) -> Option<&dyn Goals> {
        self.task.goals()
    }
}

#[cfg(test)]
mod states;
#[cfg(test)]
mod tests {
    use gym_core::EnvExt;
    use mujoco_engine::Model;

    use super::*;
    use crate::Common;

    /// A pendulum that shows its state, and is never over.
    #[derive(Debug)]
    struct Swing;

    impl SimTask for Swing {
        fn start(&self, _: &mut Start<'_>) -> Result<()> {
            Ok(())
        }

        fn observe(&self, _: &Model, data: &Data, out: &mut Observation) {
            out.extend(data.qpos.iter().copied());
        }
    }

    #[test]
    fn an_episode_ends_at_the_limit_of_its_settings() {
        const PENDULUM: &str = r#"<mujoco><worldbody><body><joint axis="0 1 0"/>
            <geom type="capsule" fromto="0 0 0 0 0 -.5" size=".04"/></body></worldbody></mujoco>"#;
        for (limit, last) in [
            (None, None),
            (Some(f64::INFINITY), None),
            (Some(1.0), Some(1)),
            (Some(2.5), Some(3)),
            (Some(1000.0), Some(1000)),
        ] {
            let simulation = || {
                let behind = Stepper::Behind {
                    contact_forces: false,
                };
                Simulation::new(
                    || Ok(Arc::new(Model::from_xml(PENDULUM).unwrap())),
                    &Common::default(),
                    behind,
                )
            };
            let mut settings = Settings::new("Swing", &());
            settings.limit = limit.unwrap_or(settings.limit);
            let mut env = SimEnv::new(Arc::new(Swing), simulation().unwrap(), settings).unwrap();
            for _ in 0..2 {
                env.reset(0).unwrap();
                let ends = (1..=2100).find(|_| {
                    let step = env.step(&Array::from(Vec::<f32>::new())).unwrap();
                    assert!(!step.terminated);
                    step.truncated
                });
                assert_eq!(ends, last, "{limit:?}");
            }
        }
    }
}
