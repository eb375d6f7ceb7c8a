//! What a crate says about an environment to have it made by id.

use std::borrow::Cow;
use std::fmt;

use serde::{Deserialize, Serialize, de::DeserializeOwned};
use serde_json::Value as Json;

use super::options::ResetOptions;
use super::stack::{Renders, stack};
use crate::registry::VectorSpec;
use crate::render::RenderMode;
use crate::vector::VectorEnv;
use crate::{BoxEnv, Dynamics, Env, EnvSpec, Error, Kwargs, Result, Stateful};

/// An environment that can be built from arguments: what [`register!`](crate::register!) needs.
/// [`Stateful`] implements it for every [`Dynamics`].
pub trait Configure: Env {
    /// The constructor's arguments. Derive `Deserialize` with
    /// `#[serde(default, deny_unknown_fields)]`, so that a misspelt one is an error that lists the
    /// valid ones.
    type Config: Default + Serialize + DeserializeOwned;

    /// The environment with these arguments.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] for an argument out of range.
    fn configure(config: Self::Config) -> Result<Self>;

    /// The environment that renders by itself in a mode, where [`render_into`](Env::render_into) is its own: `make`
    /// then puts no [`Render`](crate::wrappers::Render) around it. `None`, by default, for those that are drawn.
    ///
    /// # Errors
    /// As [`configure`](Self::configure), and [`Error::UnsupportedMode`](crate::Error::UnsupportedMode).
    fn configure_to_render(config: Self::Config, mode: RenderMode) -> Result<Option<Self>> {
        let _ = (config, mode);
        Ok(None)
    }

    /// The arguments with what was left to chance decided, such as a map that the constructor drew: the
    /// spec then rebuilds this environment and no other. `None` where nothing is left to chance.
    fn config(&self) -> Option<&Self::Config> {
        None
    }
}

/// The [`Configure::Config`] or [`Dynamics::Config`] of an environment that takes no arguments.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NoArguments {}

impl<D: Dynamics> Configure for Stateful<D> {
    type Config = D::Config;

    fn configure(config: D::Config) -> Result<Self> {
        Self::new(config)
    }

    fn config(&self) -> Option<&D::Config> {
        Some(self.dynamics().config())
    }
}

/// Makes a native vector from its spec.
///
/// It fails for what it cannot do, such as a render mode or wrappers in the spec. It respects
/// `max_episode_steps`.
pub type VectorEntryPoint = fn(&VectorSpec) -> Result<Box<dyn VectorEnv>>;

/// What an environment needs that no crate brings.
#[derive(Clone, Copy)]
struct Need {
    what: &'static str,
    is_there: fn() -> bool,
}

/// An entry of the registry. Submit it at link time with [`register!`](crate::register!), or at
/// run time with [`registry::register`](crate::registry::register).
#[derive(Clone)]
pub struct Registration {
    pub(super) id: Cow<'static, str>,
    pub(super) crate_name: &'static str,
    description: &'static str,
    kwargs: &'static str,
    reward_threshold: Option<f64>,
    max_episode_steps: Option<u32>,
    nondeterministic: bool,
    without_arguments: bool,
    pub(crate) reset_options: ResetOptions,
    exceptions: &'static [(&'static str, &'static str)],
    needs: Option<Need>,
    defaults: fn() -> Json,
    construct: fn(&EnvSpec, ResetOptions) -> Result<BoxEnv>,
    vector_entry_point: Option<VectorEntryPoint>,
}

impl Registration {
    /// The environment `E` under an id that is known when the program is compiled.
    pub const fn new<E: Configure>(id: &'static str) -> Self {
        Self::with_id::<E>(Cow::Borrowed(id))
    }

    /// The environment `E` under an id that is made while the program runs.
    pub fn dynamic<E: Configure>(id: impl Into<String>) -> Self {
        Self::with_id::<E>(Cow::Owned(id.into()))
    }

    const fn with_id<E: Configure>(id: Cow<'static, str>) -> Self {
        Self {
            id,
            crate_name: "",
            description: "",
            kwargs: "{}",
            reward_threshold: None,
            max_episode_steps: None,
            nondeterministic: false,
            without_arguments: false,
            reset_options: ResetOptions(&[]),
            exceptions: &[],
            needs: None,
            defaults: defaults::<E>,
            construct: construct::<E>,
            vector_entry_point: None,
        }
    }

    /// The crate it comes from; [`register!`](crate::register!) fills it in.
    #[must_use]
    pub const fn from_crate(mut self, name: &'static str) -> Self {
        self.crate_name = name;
        self
    }

    /// What the agent has to do, in a sentence, for lists of environments.
    #[must_use]
    pub const fn description(mut self, sentence: &'static str) -> Self {
        self.description = sentence;
        self
    }

    /// Arguments of this id, as a JSON object: they go before those of
    /// [`make`](crate::make).
    #[must_use]
    pub const fn kwargs(mut self, json: &'static str) -> Self {
        self.kwargs = json;
        self
    }

    /// Takes no arguments under this id: an older version, from before there were any.
    #[must_use]
    pub const fn without_arguments(mut self) -> Self {
        self.without_arguments = true;
        self
    }

    /// The mean return at which the task counts as solved.
    #[must_use]
    pub const fn reward_threshold(mut self, threshold: f64) -> Self {
        self.reward_threshold = Some(threshold);
        self
    }

    /// The steps after which an episode is truncated; without it there is no limit.
    #[must_use]
    pub const fn max_episode_steps(mut self, steps: u32) -> Self {
        self.max_episode_steps = Some(steps);
        self
    }

    /// The [reset options](field@crate::Reset::options) that the environment knows, each with an example as JSON, such as
    /// `&[("low", "-0.1"), ("high", "0.1")]`. Any other option is then an error that names these; an environment
    /// that names none is handed every option.
    #[must_use]
    pub const fn reset_options(mut self, options: &'static [(&'static str, &'static str)]) -> Self {
        self.reset_options = ResetOptions(options);
        self
    }

    /// Checks of the crate gym-conform that this id may fail, each with the reason.
    #[must_use]
    pub const fn exceptions(mut self, exceptions: &'static [(&'static str, &'static str)]) -> Self {
        self.exceptions = exceptions;
        self
    }

    /// Says what the environment needs that no crate brings, as in `ROMs`, and how to see whether it is there. Whatever goes
    /// through the whole registry passes over such environments, or says what they need.
    #[must_use]
    pub const fn needs(mut self, what: &'static str, is_there: fn() -> bool) -> Self {
        self.needs = Some(Need { what, is_there });
        self
    }

    /// Says that the same seed can give different episodes.
    #[must_use]
    pub const fn nondeterministic(mut self) -> Self {
        self.nondeterministic = true;
        self
    }

    /// Has a native vector, which [`make_vec`](crate::make_vec) then prefers.
    #[must_use]
    pub const fn vector_entry_point(mut self, entry_point: VectorEntryPoint) -> Self {
        self.vector_entry_point = Some(entry_point);
        self
    }

    /// The id.
    pub fn id(&self) -> &str {
        &self.id
    }

    /// What the agent has to do, in a sentence; empty where [`description`](Self::description) did not say.
    pub fn about(&self) -> &'static str {
        self.description
    }

    /// The reset options that the environment knows, each with an example as JSON; empty where
    /// [`reset_options`](Self::reset_options) did not say.
    pub fn known_reset_options(&self) -> &'static [(&'static str, &'static str)] {
        self.reset_options.0
    }

    /// The checks of the crate gym-conform that this id may fail, each with the reason.
    pub fn all_exceptions(&self) -> &'static [(&'static str, &'static str)] {
        self.exceptions
    }

    /// What it needs that no crate brings, if it needs something.
    pub fn requirement(&self) -> Option<&'static str> {
        self.needs.map(|need| need.what)
    }

    /// What it needs and is not there.
    pub fn missing(&self) -> Option<&'static str> {
        self.needs.filter(|need| !(need.is_there)()).map(|need| need.what)
    }

    /// Why this id may fail a check of the crate gym-conform, if it may.
    pub fn exception(&self, check: &str) -> Option<&'static str> {
        self.exceptions.iter().find_map(|(name, reason)| (*name == check).then_some(*reason))
    }

    /// The crate it comes from.
    pub fn crate_name(&self) -> &str {
        self.crate_name
    }

    /// What makes its native vector, if it has one.
    pub fn native_vector(&self) -> Option<VectorEntryPoint> {
        self.vector_entry_point
    }

    /// How [`make`](crate::make) builds it.
    ///
    /// # Errors
    /// [`Error::Registration`] if its arguments are not a JSON object.
    pub fn spec(&self) -> Result<EnvSpec> {
        let kwargs: Kwargs = serde_json::from_str(self.kwargs).map_err(|error| Error::Registration {
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

    /// The constructor's arguments with their default values.
    pub fn default_kwargs(&self) -> Kwargs {
        match (self.defaults)() {
            Json::Object(map) if !self.without_arguments => map,
            _ => Kwargs::new(),
        }
    }

    /// The environment of a spec in the stack of `make`, without its additional wrappers.
    pub(super) fn construct(&self, spec: &EnvSpec) -> Result<BoxEnv> {
        if self.without_arguments && !spec.kwargs.is_empty() {
            return Err(Error::argument(format!("`{}`", spec.id), "this version takes no arguments"));
        }
        (self.construct)(spec, self.reset_options)
    }
}

impl fmt::Debug for Registration {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Registration({} of {})", self.id, self.crate_name)
    }
}

inventory::collect!(Registration);

fn defaults<E: Configure>() -> Json {
    serde_json::to_value(E::Config::default()).unwrap_or_default()
}

fn construct<E: Configure>(spec: &EnvSpec, options: ResetOptions) -> Result<BoxEnv> {
    let invalid = |error: serde_json::Error| {
        let mut reason = error.to_string();
        if reason.contains("invalid type: null") {
            reason += " (null is also what becomes of a number that is NaN or infinite: give a finite one)";
        }
        Error::argument(format!("`{}`", spec.id), reason)
    };
    let config = || -> Result<E::Config> {
        serde_json::from_value(Json::Object(spec.kwargs.clone())).map_err(invalid)
    };
    if let Some(mode) = spec.render_mode
        && let Some(env) = E::configure_to_render(config()?, mode.single())?
    {
        return stack(env, Renders::Itself, spec, options);
    }
    let config = config()?;
    let asked = serde_json::to_value(&config).map_err(invalid)?;
    let env = E::configure(config)?;
    let mut spec = spec.clone();
    if let Some(Json::Object(decided)) =
        env.config().map(serde_json::to_value).transpose().map_err(invalid)?
    {
        let by_chance = decided.into_iter().filter(|(name, value)| asked.get(name) != Some(value));
        spec.kwargs.extend(by_chance);
    }
    stack(env, Renders::Drawings, &spec, options)
}

/// Registers an environment when its crate is linked.
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
/// #     fn configure(_: NoArguments) -> Result<Self> { Ok(Self) }
/// # }
///
/// register!(Registration::new::<Corridor>("my_envs/Corridor-v0").max_episode_steps(500).reward_threshold(0.9));
/// # fn main() {
/// assert!(gym_core::make("my_envs/Corridor-v0").is_ok());
/// # }
/// ```
///
/// A crate that is a dependency but is never named is not linked, and its environments are then
/// missing: name it with `use my_envs as _;`.
#[macro_export]
macro_rules! register {
    ($registration:expr) => {
        $crate::inventory::submit! { $registration.from_crate(env!("CARGO_PKG_NAME")) }
    };
}
