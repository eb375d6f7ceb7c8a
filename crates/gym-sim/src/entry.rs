//! Tasks with arguments, and their registration.

use std::marker::PhantomData;
use std::sync::Arc;

use gym_core::registry::{Build, build, find};
use gym_core::vector::{BoxVector, VectorSpec, lockstep};
use gym_core::wrappers::TimeLimit;
use gym_core::{BoxEnv, EnvExt, EnvSpec, Names, Registration, Result};

use crate::arguments::{Common, TaskArguments};
use crate::env::SimEnv;
use crate::settings::Settings;
use crate::simulation::{Simulation, Stepper};
use crate::task::SimTask;

/// A task that is made from arguments: a struct of [`gym_core::arguments!`] with [`Common`].
pub trait FromArguments: SimTask + Sized {
    /// The task's arguments.
    type Config: TaskArguments;

    /// Makes the task for a version. Look up bodies and joints here, once per environment.
    ///
    /// # Errors
    /// If an argument is out of range, or the model lacks a part that the task needs.
    fn new(config: &Self::Config, version: u32, simulation: &Simulation) -> Result<Self>;
}

/// What the tasks of a family share.
pub trait Family: 'static {
    /// The name of their environments, in snapshots and in the names of wrappers around them.
    const NAME: &'static str;

    /// The newest version; later ones have its rules.
    const NEWEST: u32 = u32::MAX;

    /// Loads the model, and says how it is stepped.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`](gym_core::Error::InvalidArgument) for an argument out of range,
    /// and a model that cannot be read.
    fn simulation(arguments: &Common, version: u32) -> Result<Simulation>;
}

/// Tasks on models of their own.
#[derive(Clone, Copy, Debug)]
pub struct Own;

impl Family for Own {
    const NAME: &'static str = "SimEnv";

    fn simulation(arguments: &Common, _version: u32) -> Result<Simulation> {
        let load = || crate::load(&arguments.xml_file, arguments.mujoco.0);
        let stepper = Stepper::Behind {
            contact_forces: true,
        };
        Simulation::new(load, arguments, stepper)
    }
}

/// The constructor of a task's environments, for [`register`].
#[derive(Clone, Copy, Debug)]
pub struct Entry<T, F = Own>(PhantomData<fn() -> (T, F)>);

impl<T: FromArguments, F: Family> Entry<T, F> {
    /// Makes the environment in the newest version.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`](gym_core::Error::InvalidArgument) for an argument out of range, a
    /// model that cannot be read, and one that lacks a part that the task needs.
    #[expect(clippy::new_ret_no_self, reason = "it makes the one environment")]
    pub fn new(config: T::Config) -> Result<SimEnv> {
        Self::with_version(config, F::NEWEST)
    }

    /// Makes the environment in a version.
    ///
    /// # Errors
    /// The errors of `new`.
    #[expect(clippy::needless_pass_by_value, reason = "like `new`")]
    pub fn with_version(config: T::Config, version: u32) -> Result<SimEnv> {
        let version = version.min(F::NEWEST);
        if config != T::Config::defaults(version) {
            config.check_sizes()?;
        }
        let common: &Common = config.as_ref();
        let simulation = F::simulation(common, version)?;
        let task = Arc::new(T::new(&config, version, &simulation)?);
        let settings = Settings {
            version: Some(version),
            size: (common.width, common.height),
            ..Settings::new(F::NAME, &config)
        };
        SimEnv::new(task, simulation, settings)
    }
}

impl<T: FromArguments, F: Family> Build for Entry<T, F> {
    type Config = T::Config;
    type Env = SimEnv;

    fn build(config: T::Config, version: u32) -> Result<SimEnv> {
        Self::with_version(config, version)
    }

    fn defaults(version: u32) -> T::Config {
        T::Config::defaults(version)
    }
}

/// The names of the numbers of an environment that is, or contains, a [`SimEnv`]: for
/// [`Registration::names`], which [`register`] sets.
#[must_use]
pub fn names(env: &BoxEnv) -> Names {
    env.layer::<SimEnv>().map(SimEnv::names).unwrap_or_default()
}

/// A registration of environments whose vectors step several worlds together.
pub const fn register<B: Build<Env = SimEnv>>(id: &'static str) -> Registration {
    Registration::new::<B>(id)
        .names(names)
        .lockstep_by::<SimEnv>(vector::<B>)
}

/// Makes a native vector. Its environments share one model, so that their worlds can step together,
/// unless the start of an episode changes the model.
fn vector<B: Build<Env = SimEnv>>(spec: &VectorSpec) -> Result<BoxVector> {
    vector_of(spec, build::<B>)
}

fn vector_of(spec: &VectorSpec, make: fn(&EnvSpec) -> Result<SimEnv>) -> Result<BoxVector> {
    let options = find(&spec.env.id)?.reset_options;
    let first = make(&spec.env)?;
    let make = |index| {
        if spec.each.is_empty() {
            return Ok(first.clone());
        }
        make(&spec.env_at(index))
    };
    match spec.env.max_episode_steps {
        Some(limit) => {
            let limited = |index| TimeLimit::new(make(index)?, limit);
            lockstep::native::<SimEnv, _>(spec, options, limited)
        }
        None => lockstep::native::<SimEnv, _>(spec, options, make),
    }
}
