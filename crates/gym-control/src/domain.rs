//! Domains, and how their environments are made and registered.

use std::borrow::Cow;
use std::marker::PhantomData;
use std::sync::Arc;

use gym_core::registry::{Build, Clip, Exceptions};
use gym_core::spaces::BoxSpace;
use gym_core::{Arguments, Error, Registration, Result};
use gym_sim::{Common as Camera, Settings, SimEnv, SimTask, Simulation, Stepper};
use mujoco_engine::Model;

use crate::arguments::Common;
use crate::look;

/// A domain: a model, and the constructor of its tasks. `Config` is a struct of
/// [`gym_core::arguments!`] that contains [`Common`].
pub trait Domain: SimTask + Sized {
    /// The arguments.
    type Config: Arguments + AsRef<Common>;

    /// The name of the domain.
    const NAME: &'static str;

    /// The number of timesteps per step.
    const TIMESTEPS: usize = 1;

    /// The model, in MJCF.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] for an argument out of range.
    fn text(config: &Self::Config) -> Result<Cow<'static, str>>;

    /// Builds the task for its model. Look up bodies and joints here, once per environment.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] for an argument out of range.
    fn new(config: &Self::Config, model: &Model) -> Result<Self>;
}

/// The bound of a control without a range, in the action space.
const UNBOUNDED: f64 = 1e10;

/// Makes the environment of a domain's task.
///
/// A reset with the seed `s` starts the first episode of a task that dm_control loads with
/// `RandomState(s)`; a reset without a seed starts its next episode. If the state diverges,
/// dm_control raises `PhysicsError`; the environment goes on from MuJoCo's reset of the simulation.
///
/// # Errors
/// [`Error::InvalidArgument`] for an argument out of range.
pub fn make<D: Domain>(config: &D::Config) -> Result<SimEnv> {
    let common = config.as_ref();
    let text = look::with_materials(&D::text(config)?);
    let model = Model::from_xml_with(&text, common.mujoco.0);
    let model = model.map_err(|error| Error::argument("model", error.to_string()))?;
    common.check(&model)?;
    let task = Arc::new(D::new(config, &model)?);
    of(
        D::NAME,
        task,
        model,
        (text, D::TIMESTEPS),
        (Settings::new(D::NAME, config), common),
    )
}

fn of(
    name: &'static str,
    task: Arc<dyn SimTask>,
    model: Model,
    (text, timesteps): (String, usize),
    (settings, common): (Settings, &Common),
) -> Result<SimEnv> {
    let bounds = |side: usize| -> Vec<f64> {
        let ranges = model.actuator_ctrlrange.iter();
        let ranges = ranges.zip(&model.actuator_ctrllimited);
        ranges
            .map(|(range, limited)| {
                if *limited {
                    range[side]
                } else {
                    [-UNBOUNDED, UNBOUNDED][side]
                }
            })
            .collect()
    };
    let action_space = BoxSpace::new(bounds(0), bounds(1))?.into();
    let step = model.opt.timestep * timesteps as f64;
    let limit = common.time_limit;
    let camera = Camera {
        xml_file: text,
        frame_skip: timesteps,
        camera_id: Some(common.camera_id),
        width: common.width,
        height: common.height,
        ..Camera::default()
    };
    let simulation = Simulation::new(|| Ok(Arc::new(model)), &camera, Stepper::Settled)?;
    let mut settings = settings;
    settings.name = name;
    settings.action_space = Some(action_space);
    settings.flat = common.flat;
    settings.dtype = common.dtype;
    settings.pixels = common.pixels;
    settings.size = (common.width, common.height);
    settings.depth = false;
    settings.limit = limit.map_or(f64::INFINITY, |limit| limit / step);
    settings.random_state = true;
    settings.start = [common.qpos.clone(), common.qvel.clone()];
    settings.coloured = common
        .visualize_reward
        .then_some(look::coloured as fn(&Model, f64) -> Model);
    SimEnv::new(task, simulation, settings)
}

/// The constructor of a domain's environments, for registrations.
#[derive(Debug)]
pub struct Entry<D>(PhantomData<fn() -> D>);

impl<D: Domain> Build for Entry<D> {
    type Config = D::Config;
    type Env = SimEnv;

    fn build(config: D::Config, _version: u32) -> Result<SimEnv> {
        make::<D>(&config)
    }
}

const LIMIT: (&str, &str) = (
    "arguments-matter.time_limit",
    "it ends episodes of a thousand steps",
);
const COLOURS: (&str, &str) = (
    "arguments-matter.visualize_reward",
    "a reward of 0 changes no colour",
);

/// The conformance exceptions of tasks with an argument `stand_height`.
pub(crate) const STANDING: Exceptions = &[
    LIMIT,
    COLOURS,
    (
        "arguments-matter.stand_height",
        "who lies is not rewarded at any height",
    ),
];

/// The conformance exceptions of tasks with an argument `target_size`.
pub(crate) const TARGET: Exceptions = &[
    LIMIT,
    COLOURS,
    (
        "arguments-matter.target_size",
        "a target is at most 0.2 m wide, which is less than what is tried for 0",
    ),
];

/// The conformance exceptions of tasks whose controls have no limits.
pub(crate) const UNLIMITED: Exceptions = &[
    LIMIT,
    COLOURS,
    (
        "reward-finite",
        "the cost of a huge action is infinite, as in dm_control",
    ),
];

/// Returns the clip on a domain's page: one episode, of which every `every`-th state is shown.
pub(crate) const fn clip(every: u32) -> Clip {
    Clip {
        seeds: 0..1,
        every,
        frames: 48,
        size: (160, 120),
    }
}

/// The registration that all tasks share.
pub const fn register<D: Domain>(id: &'static str, description: &'static str) -> Registration {
    gym_sim::register::<Entry<D>>(id)
        .description(description)
        .exceptions(&[LIMIT, COLOURS])
}

/// Returns the id of the body `name`.
pub(crate) fn body(m: &Model, name: &str) -> Result<usize> {
    named("body", name, m.body_id(name))
}

/// Returns the id of the geom `name`.
pub(crate) fn geom(m: &Model, name: &str) -> Result<usize> {
    named("geom", name, m.geom_id(name))
}

/// Returns the id of the site `name`.
pub(crate) fn site(m: &Model, name: &str) -> Result<usize> {
    named("site", name, m.site_id(name))
}

/// Returns the id of the joint `name`.
pub(crate) fn joint(m: &Model, name: &str) -> Result<usize> {
    named("joint", name, m.joint_id(name))
}

/// Returns the id `id` of the object `name`, or an error if the model has no such object.
///
/// # Errors
/// [`Error::InvalidArgument`] if there is none.
pub(crate) fn named(what: &str, name: &str, id: Option<usize>) -> Result<usize> {
    id.ok_or_else(|| Error::argument("model", format!("the model has no {what} {name:?}")))
}
