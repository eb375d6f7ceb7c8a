//! The registration of an environment.
//!
//! It states the facts about an environment that its code does not. Commands, the book's pages and
//! the Python package read them here, so they support plugins.

use std::borrow::Cow;
use std::fmt;
use std::ops::Range;

use serde_json::Value as Json;

use super::family::Family;
use super::native::entry_point;
use super::stack::{Renders, stack};
use crate::env::{BoxEnv, Build, Configure};
use crate::play::keys::Keys;
use crate::play::names::Names;
use crate::play::policy::Policy;
use crate::spec::arguments::{self, Argument};
use crate::spec::{EnvId, EnvSpec, Kwargs, ResetOptions, VectorSpec};
use crate::value::{Error, Result};
use crate::vector::VectorEnv;
use crate::vector::lockstep::{self, Lockstep, SlotGroup};

/// Whether native vectors are linked. Code that is generic and that nothing names is not compiled.
/// A module for a browser has none: a page steps one environment, and everybody who opens the page
/// downloads the module.
pub(super) const NATIVE_VECTORS: bool =
    cfg!(feature = "native-vectors") && !cfg!(all(target_arch = "wasm32", target_os = "unknown"));

/// Makes a native vector from its spec.
///
/// It returns an error for anything that it does not support, such as a render mode or wrappers in
/// the spec. It respects `max_episode_steps`.
pub type VectorEntryPoint = fn(&VectorSpec) -> Result<Box<dyn VectorEnv>>;

/// Makes an empty group, in which several environments step together.
type MakeSlotGroup = fn() -> Box<dyn SlotGroup<BoxEnv>>;

/// An external requirement of an environment, such as ROMs.
#[derive(Clone, Copy, Debug)]
pub struct Need {
    /// The requirement, in words.
    pub what: &'static str,
    is_met: fn() -> bool,
}

impl Need {
    pub(super) const fn new(what: &'static str, is_met: fn() -> bool) -> Self {
        Self { what, is_met }
    }

    /// Whether the requirement is met.
    pub fn is_met(&self) -> bool {
        (self.is_met)()
    }
}

/// The GIF on an environment's page of a book.
#[derive(Clone, Debug)]
pub struct Clip {
    /// Seeds of its episodes.
    pub seeds: Range<u64>,
    /// Draws every n-th state.
    pub every: u32,
    /// The largest number of frames.
    pub frames: u32,
    /// Width and height in pixels.
    pub size: (u32, u32),
}

/// What books, galleries and players show of an environment.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Page {
    /// The content of its GIF.
    pub clip: Option<Clip>,
    /// Names and meanings of discrete actions.
    pub actions: &'static [(&'static str, &'static str)],
    /// The names of the numbers in its observations and actions.
    pub names: Option<fn(&BoxEnv) -> Names>,
    /// The keys with which a person plays it.
    pub keys: Option<fn(&BoxEnv) -> Keys>,
    /// A policy that plays it well.
    pub policy: Option<Policy>,
}

/// Checks of the crate gym-conform that an id may fail, each with the reason.
pub type Exceptions = &'static [(&'static str, &'static str)];

/// An entry of the registry: the facts about the environment of one id. Submit it at link time with
/// [`register!`](crate::register!), or at run time with
/// [`registry::register`](crate::registry::register).
///
/// Each method sets the field of its name, here or in its [page](Page).
#[derive(Clone)]
#[non_exhaustive]
pub struct Registration {
    pub(super) id: Cow<'static, str>,
    /// The crate, module and source file; empty if registered at run time.
    pub source: Source,
    /// The agent's task, in a sentence.
    pub description: &'static str,
    /// The environment's [reset options](field@crate::Reset::options), each with an example as
    /// JSON.
    pub reset_options: ResetOptions,
    /// Checks of the crate gym-conform that this id may fail, each with the reason.
    pub exceptions: Exceptions,
    /// A requirement outside the crates, such as ROMs.
    pub needs: Option<Need>,
    /// The constructor of its native vector.
    pub vector_entry_point: Option<VectorEntryPoint>,
    /// Whether a step takes about as long as a call between threads.
    pub light_step: bool,
    /// Its clip, actions, names, keys and good policy.
    pub page: Page,
    version: Option<u32>,
    kwargs: &'static str,
    reward_threshold: Option<f64>,
    max_episode_steps: Option<u32>,
    nondeterministic: bool,
    lockstep: Option<MakeSlotGroup>,
    table: fn(u32) -> Vec<Argument>,
    construct: fn(&Registration, &EnvSpec) -> Result<BoxEnv>,
}

/// The source of a registration; [`register!`](crate::register!) fills it in.
#[derive(Clone, Copy, Debug, Default)]
pub struct Source {
    /// The name of the package.
    pub package: &'static str,
    /// The path of the module.
    pub module: &'static str,
    /// The path of the file, from the root of its workspace.
    pub file: &'static str,
}

impl Registration {
    /// The environment `E`, or what `E` builds, under a constant id.
    pub const fn new<E: Build>(id: &'static str) -> Self {
        Self::with_id::<E>(Cow::Borrowed(id))
    }

    /// The environment `E`, or what `E` builds, under an id built at run time.
    pub fn dynamic<E: Build>(id: impl Into<String>) -> Self {
        Self::with_id::<E>(Cow::Owned(id.into()))
    }

    const fn with_id<E: Build>(id: Cow<'static, str>) -> Self {
        Self {
            id,
            source: Source {
                package: "",
                module: "",
                file: "",
            },
            description: "",
            reset_options: ResetOptions(&[]),
            exceptions: &[],
            needs: None,
            vector_entry_point: None,
            light_step: false,
            page: Page {
                clip: None,
                actions: &[],
                names: None,
                keys: None,
                policy: None,
            },
            version: None,
            kwargs: "{}",
            reward_threshold: None,
            max_episode_steps: None,
            nondeterministic: false,
            lockstep: None,
            table: |version| arguments::table(&E::defaults(version), version),
            construct: construct::<E>,
        }
    }

    /// The package, module and file; [`register!`](crate::register!) fills them in.
    #[must_use]
    pub const fn source(
        mut self,
        package: &'static str,
        module: &'static str,
        file: &'static str,
    ) -> Self {
        self.source = Source {
            package,
            module,
            file,
        };
        self
    }

    /// The agent's task in a sentence, for lists of environments.
    #[must_use]
    pub const fn description(mut self, sentence: &'static str) -> Self {
        self.description = sentence;
        self
    }

    /// The version whose rules and arguments apply, if it differs from the id's.
    #[must_use]
    pub const fn version(mut self, version: u32) -> Self {
        self.version = Some(version);
        self
    }

    /// Arguments that this id sets, as a JSON object; arguments given to [`make`](crate::make)
    /// override them.
    #[must_use]
    pub const fn kwargs(mut self, json: &'static str) -> Self {
        self.kwargs = json;
        self
    }

    /// The mean return at which the task counts as solved.
    #[must_use]
    pub const fn reward_threshold(mut self, threshold: f64) -> Self {
        self.reward_threshold = Some(threshold);
        self
    }

    /// The steps after which an episode is truncated; the default is no limit.
    #[must_use]
    pub const fn max_episode_steps(mut self, steps: u32) -> Self {
        self.max_episode_steps = Some(steps);
        self
    }

    /// The environment's [reset options](field@crate::Reset::options), each with an example as
    /// JSON, such as `&[("low", "-0.1"), ("high", "0.1")]`. Other options are then an error; if
    /// none are named, the environment receives every option.
    #[must_use]
    pub const fn reset_options(mut self, options: &'static [(&'static str, &'static str)]) -> Self {
        self.reset_options = ResetOptions(options);
        self
    }

    /// Checks of the crate gym-conform that this id may fail, each with the reason.
    /// `arguments-matter.verbose` excuses the argument `verbose` from the check `arguments-matter`.
    #[must_use]
    pub const fn exceptions(mut self, exceptions: Exceptions) -> Self {
        self.exceptions = exceptions;
        self
    }

    /// Declares an external requirement, as in `ROMs`, and how to test for it. Commands over the
    /// whole registry skip these.
    #[must_use]
    pub const fn needs(mut self, what: &'static str, is_met: fn() -> bool) -> Self {
        self.needs = Some(Need::new(what, is_met));
        self
    }

    /// Declares that the same seed can give different episodes.
    #[must_use]
    pub const fn nondeterministic(mut self) -> Self {
        self.nondeterministic = true;
        self
    }

    /// Declares a native vector, which [`make_vec`](crate::make_vec) then prefers.
    #[must_use]
    pub const fn vector_entry_point(mut self, entry_point: VectorEntryPoint) -> Self {
        if NATIVE_VECTORS {
            self.vector_entry_point = Some(entry_point);
        }
        self
    }

    /// Declares a native vector of environments that step in [`lockstep`](crate::vector::lockstep);
    /// the threads of async vectors then do the same.
    #[must_use]
    pub const fn lockstep<E: Lockstep + Configure>(self) -> Self {
        self.lockstep_by::<E>(entry_point::<E>)
    }

    /// The same for environments that are not [`Configure`], whose native vector is made by
    /// `entry_point`: see [`native`](crate::vector::lockstep::native).
    #[must_use]
    pub const fn lockstep_by<E: Lockstep>(mut self, entry_point: VectorEntryPoint) -> Self {
        if NATIVE_VECTORS {
            self.vector_entry_point = Some(entry_point);
            self.lockstep = Some(lockstep::slot_group::<E>);
        }
        self
    }

    /// The names of the numbers in observations and actions, which may depend on the arguments.
    /// Pages, the gallery and Python show them.
    #[must_use]
    pub const fn names(mut self, names: fn(&BoxEnv) -> Names) -> Self {
        self.page.names = Some(names);
        self
    }

    /// The keys of `cargo xtask play`, which may depend on the arguments. By default the digits are
    /// the actions of a `Discrete` space.
    #[must_use]
    pub const fn keys(mut self, keys: fn(&BoxEnv) -> Keys) -> Self {
        self.page.keys = Some(keys);
        self
    }

    /// A policy that plays it well.
    #[must_use]
    pub const fn policy(mut self, policy: Policy) -> Self {
        self.page.policy = Some(policy);
        self
    }

    /// Declares that a step takes less than about a microsecond: Python then keeps the GIL during a
    /// step.
    #[must_use]
    pub const fn light_step(mut self) -> Self {
        self.light_step = true;
        self
    }

    /// Names and meanings of discrete actions, for the page: `VARIANTS` of an enum of
    /// [`discrete!`](crate::discrete!).
    #[must_use]
    pub const fn actions(mut self, variants: &'static [(&'static str, &'static str)]) -> Self {
        self.page.actions = variants;
        self
    }

    /// The clip in the GIF on its page. Ids registered in one module share the page.
    #[must_use]
    pub const fn clip(mut self, clip: Clip) -> Self {
        self.page.clip = Some(clip);
        self
    }

    /// The id.
    pub fn id(&self) -> &str {
        &self.id
    }

    /// The id without version.
    pub(super) fn unversioned(&self) -> String {
        let id = self.id.parse::<EnvId>();
        id.map_or_else(|_| self.id.to_string(), |id| id.unversioned())
    }

    /// The family that its crate declares; without a declaration, a family with the name of the
    /// crate.
    pub fn family(&self) -> Family {
        Family::of(self.source.package)
    }

    /// The version whose rules apply; the highest number if neither the id nor
    /// [`version`](Self::version) gives one.
    pub fn rules(&self) -> u32 {
        let of_id = || self.id.parse::<EnvId>().ok().and_then(|id| id.version);
        self.version.or_else(of_id).unwrap_or(u32::MAX)
    }

    /// The constructor's arguments for this id, with the default values that the id
    /// [sets](Self::kwargs) and those of its version.
    ///
    /// # Errors
    /// The errors of [`spec`](Self::spec).
    pub fn arguments(&self) -> Result<Vec<Argument>> {
        let mut table = (self.table)(self.rules());
        for (name, value) in self.spec()?.kwargs {
            if let Some(argument) = table.iter_mut().find(|argument| argument.name == name) {
                argument.default = value;
            }
        }
        Ok(table)
    }

    /// Returns an empty group, in which environments of this id step together; `None` if the
    /// environments do not support this.
    pub(super) fn slot_group(&self) -> Option<Box<dyn SlotGroup<BoxEnv>>> {
        self.lockstep.map(|lockstep| lockstep())
    }

    /// The spec from which [`make`](crate::make) builds it.
    ///
    /// # Errors
    /// [`Error::Registration`] if its arguments are not a JSON object.
    pub fn spec(&self) -> Result<EnvSpec> {
        let kwargs: Kwargs =
            serde_json::from_str(self.kwargs).map_err(|error| Error::Registration {
                id: self.id.to_string(),
                reason: format!("its arguments are not a JSON object: {error}"),
            })?;
        Ok(EnvSpec {
            id: self.id.to_string(),
            reward_threshold: self.reward_threshold,
            nondeterministic: self.nondeterministic,
            max_episode_steps: self.max_episode_steps,
            order_enforce: true,
            disable_env_checker: false,
            kwargs,
            render_mode: None,
            render_size: None,
            additional_wrappers: Vec::new(),
        })
    }

    /// The environment of a spec in the stack of `make`, without its additional wrappers.
    pub(super) fn construct(&self, spec: &EnvSpec) -> Result<BoxEnv> {
        (self.construct)(self, spec)
    }
}

impl fmt::Debug for Registration {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Registration({} of {})", self.id, self.source.package)
    }
}

inventory::collect!(Registration);

fn construct<E: Build>(registration: &Registration, spec: &EnvSpec) -> Result<BoxEnv> {
    let (version, whose) = (registration.rules(), format!("`{}`", spec.id));
    let config = || arguments::read(&E::defaults(version), version, &spec.kwargs, &whose);
    let options = registration.reset_options;
    if let Some(mode) = spec.render_mode
        && let Some(env) = E::build_to_render(config()?, mode.single())?
    {
        return stack(env, Renders::Itself, spec, options);
    }
    let config = config()?;
    let env = E::build(config.clone(), version)?;
    let mut spec = spec.clone();
    if let Some(decided) = E::config(&env).filter(|decided| **decided != config) {
        let json = |config: &E::Config| {
            serde_json::to_value(config)
                .map_err(|error| Error::argument(whose.clone(), error.to_string()))
        };
        let asked = json(&config)?;
        if let Json::Object(decided) = json(decided)? {
            let by_chance = decided
                .into_iter()
                .filter(|(name, value)| asked.get(name) != Some(value));
            spec.kwargs.extend(by_chance);
        }
    }
    stack(env, Renders::Drawings, &spec, options)
}

/// Registers an environment, or several, when its crate is linked.
///
/// ```
/// use gym_core::{Registration, register};
/// # use gym_core::{Configure, Env, NoArguments, Outcome, Reset, Result, Space};
/// # #[derive(Clone)]
/// # struct Corridor;
/// # impl Env for Corridor {
/// #     type Observation = i64;
/// #     type Action = i64;
/// #     fn observation_space(&self) -> Space { Space::discrete(5) }
/// #     fn action_space(&self) -> Space { Space::discrete(2) }
/// #     fn reset_into(&mut self, _: &Reset, observation: &mut i64) -> Result<()> { *observation = 0; Ok(()) }
/// #     fn step_into(&mut self, _: &i64, _: &mut i64) -> Result<Outcome> { Ok(Outcome::default()) }
/// # }
/// # impl Configure for Corridor {
/// #     type Config = NoArguments;
/// #     fn configure(_: NoArguments, _version: u32) -> Result<Self> { Ok(Self) }
/// # }
///
/// register!(Registration::new::<Corridor>("my_envs/Corridor-v0").max_episode_steps(500).reward_threshold(0.9));
/// # fn main() {
/// assert!(gym_core::make("my_envs/Corridor-v0").is_ok());
/// # }
/// ```
///
/// Cargo does not link a dependency that the code never names: name it with `use my_envs as _;`.
#[macro_export]
macro_rules! register {
    ($($registration:expr),+ $(,)?) => {
        $($crate::inventory::submit! { $registration.source(env!("CARGO_PKG_NAME"), module_path!(), file!()) })+
    };
}

/// Declares the [family](crate::registry::Family) of the environments that this crate registers.
///
/// ```
/// gym_core::family!(gym_core::registry::Family::new("Grid worlds", 100).page("grid-worlds.md"));
/// # fn main() {}
/// ```
#[macro_export]
macro_rules! family {
    ($family:expr) => {
        $crate::inventory::submit! { $family.package(env!("CARGO_PKG_NAME")) }
    };
}
