//! Domains, and how their environments are made and registered.

use std::borrow::Cow;
use std::marker::PhantomData;
use std::sync::Arc;

use gym_core::registry::{Build, Clip, Exceptions};
use gym_core::spaces::BoxSpace;
use gym_core::{Arguments, Registration, Result};
use gym_sim::{Common as Camera, Settings, SimEnv, SimTask, Simulation, Stepper};

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
    /// [`Error::InvalidArgument`](gym_core::Error::InvalidArgument) for an argument out of range.
    fn text(config: &Self::Config) -> Result<Cow<'static, str>>;

    /// Builds the task for its model. Look up bodies and joints here, once per environment.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`](gym_core::Error::InvalidArgument) for an argument out of range.
    fn new(config: &Self::Config, simulation: &Simulation) -> Result<Self>;
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
/// [`Error::InvalidArgument`](gym_core::Error::InvalidArgument) for an argument out of range.
pub fn make<D: Domain>(config: &D::Config) -> Result<SimEnv> {
    let settings = Settings::new(D::NAME, config);
    let text = look::with_materials(&D::text(config)?);
    let (simulation, settings) = parts(text, D::TIMESTEPS, config.as_ref(), settings)?;
    let task = Arc::new(D::new(config, &simulation)?);
    SimEnv::new(task, simulation, settings)
}

/// Makes the model, and completes the settings by the shared arguments.
fn parts(
    text: String,
    timesteps: usize,
    common: &Common,
    mut settings: Settings,
) -> Result<(Simulation, Settings)> {
    let model = gym_sim::compile(&text, common.mujoco.0)?;
    common.check(&model)?;
    let camera = Camera {
        xml_file: text,
        frame_skip: timesteps,
        camera_id: Some(common.camera_id),
        width: common.width,
        height: common.height,
        ..Camera::default()
    };
    let simulation = Simulation::new(|| Ok(model), &camera, Stepper::Settled)?;
    let m = &simulation.model;
    let ranges = m.actuator_ctrlrange.iter().zip(&m.actuator_ctrllimited);
    let bounds = |side: usize| -> Vec<f64> {
        let bound = |(range, limited): (&[f64; 2], &bool)| {
            let range = if *limited {
                *range
            } else {
                [-UNBOUNDED, UNBOUNDED]
            };
            range[side]
        };
        ranges.clone().map(bound).collect()
    };
    settings.action_space = Some(BoxSpace::new(bounds(0), bounds(1))?.into());
    settings.flat = common.flat;
    settings.dtype = common.dtype;
    settings.pixels = common.pixels;
    settings.size = (common.width, common.height);
    settings.depth = false;
    let limit = common.time_limit.map(|limit| limit / simulation.dt);
    settings.limit = limit.unwrap_or(f64::INFINITY);
    settings.random_state = true;
    settings.start = [common.qpos.clone(), common.qvel.clone()];
    settings.coloured = match common.visualize_reward {
        true => Some(look::coloured),
        false => None,
    };
    Ok((simulation, settings))
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

const HEIGHT: (&str, &str) = (
    "arguments-matter.stand_height",
    "who lies is not rewarded at any height",
);
const GROWS: (&str, &str) = (
    "no-allocation",
    "buffers of contacts grow in the first steps",
);
const SPEED: (&str, &str) = (
    "arguments-matter.speed",
    "a task with another goal rewards no speed",
);

/// The conformance exceptions of tasks with an argument `stand_height`.
pub(crate) const STANDING: Exceptions = &[LIMIT, COLOURS, HEIGHT];

/// The conformance exceptions of tasks with bodies of many shapes.
pub(crate) const SHAPELY: Exceptions = &[LIMIT, COLOURS, GROWS];

/// The conformance exceptions of tasks with bodies of many shapes and an argument `stand_height`.
pub(crate) const SHAPELY_STANDING: Exceptions = &[LIMIT, COLOURS, GROWS, HEIGHT];

/// The conformance exceptions of tasks with bodies of many shapes and an argument `speed` for
/// others.
pub(crate) const SHAPELY_STILL: Exceptions = &[LIMIT, COLOURS, GROWS, SPEED];

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
