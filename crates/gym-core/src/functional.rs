//! Environments as pure functions of a plain state, Gymnasium's `FuncEnv`, and the stateful
//! environment made of them.

use std::fmt;

use serde::{Deserialize, Serialize, de::DeserializeOwned};
use serde_json::Value as Json;

use crate::arguments;
use crate::canvas::Canvas;
use crate::render::Metadata;
use crate::{Arguments, Element, Env, Error, Generator, Outcome, Reset, Result, Snapshot, Space, Value};

/// What is to be done, written once: the arguments of a task, its spaces, its starts and its pictures.
///
/// How a state follows from another is [`Dynamics`], or [`Equations`](crate::vector::native::Equations) where one function
/// serves one environment and many.
pub trait Task: Clone + fmt::Debug + Send + 'static {
    /// The constructor's arguments; its `Default` is what a plain [`make`](crate::make) uses.
    type Config: Arguments + PartialEq;
    /// All that changes from step to step.
    type State: Clone + fmt::Debug + PartialEq + Send + Serialize + DeserializeOwned + 'static;
    /// What the agent sees.
    type Observation: Element;
    /// What the agent does.
    type Action: Element;

    /// The name of the environment, without version.
    const NAME: &'static str;

    /// The dynamics with these arguments.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] for an argument out of range.
    fn new(config: Self::Config) -> Result<Self>;

    /// The arguments, with what was left to chance decided.
    fn config(&self) -> &Self::Config;

    /// Changes the arguments of a task in use. Spaces stay those of the constructor, and so does what it computed of
    /// several arguments: an attribute of Gymnasium's environments that is set works so.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] for an argument out of range, and where arguments cannot be changed, as by default;
    /// then nothing has changed.
    fn assign(&mut self, config: Self::Config) -> Result<()> {
        let _ = config;
        Err(Error::argument(Self::NAME, "its arguments are fixed: make a new environment"))
    }

    /// The space that every observation lies in.
    fn observation_space(&self) -> Space;

    /// The space of valid actions.
    fn action_space(&self) -> Space;

    /// Draws an initial state.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] for a reset option with a bad value.
    fn start(&self, reset: &Reset, rng: &mut Generator) -> Result<Self::State>;

    /// Whether a state read from outside can be worked with; a snapshot of one that cannot is
    /// refused.
    fn is_valid(&self, state: &Self::State) -> bool;

    /// Shows `visit` each entry of `info` about the transition into `state`.
    fn info(&self, state: &Self::State, visit: &mut dyn FnMut(&str, Value)) {
        let _ = (state, visit);
    }

    /// Render modes, frames per second and frame size.
    fn metadata(&self) -> Metadata {
        Metadata::default()
    }

    /// Draws a state.
    fn draw(&self, state: &Self::State, canvas: &mut dyn Canvas) {
        let _ = (state, canvas);
    }

    /// A state as text, for the mode `ansi`.
    fn ansi(&self, state: &Self::State) -> Option<String> {
        let _ = state;
        None
    }
}

/// How the state of a [`Task`] changes, as functions of a plain state.
///
/// | function | Gymnasium's `FuncEnv` | what it gives |
/// |---|---|---|
/// | [`start`](Task::start)`(reset, rng)` | `initial` | a state |
/// | [`transition`](Self::transition)`(state, action, rng)` | `transition`, `reward`, `terminal` | the next state, the reward, whether it is the last |
/// | [`observe`](Self::observe)`(state)` | `observation` | what the agent sees |
///
/// Nothing but the arguments and the generator decides a result. [`Stateful`] turns them into an [`Env`]; a planner calls
/// them directly, from any state and as often as it likes:
///
/// ```
/// use gym_core::{Dynamics, Generator, NoArguments, Reset, Result, Space, Stateful, Task, Transition};
///
/// gym_core::discrete! {
///     /// One step along the corridor.
///     enum Move { /// towards cell 0
///         Left, /// towards cell 4
///         Right }
/// }
///
/// /// Walk right from cell 0 to cell 4.
/// #[derive(Clone, Debug)]
/// struct Corridor;
///
/// impl Task for Corridor {
///     type Config = NoArguments;
///     type State = i64;
///     type Observation = i64;
///     type Action = Move;
///     const NAME: &'static str = "Corridor";
///
///     fn new(_: NoArguments) -> Result<Self> {
///         Ok(Self)
///     }
///     fn config(&self) -> &NoArguments {
///         &NoArguments {}
///     }
///     fn observation_space(&self) -> Space {
///         Space::discrete(5)
///     }
///     fn action_space(&self) -> Space {
///         Move::space()
///     }
///     fn start(&self, _reset: &Reset, _rng: &mut Generator) -> Result<i64> {
///         Ok(0)
///     }
///     fn is_valid(&self, cell: &i64) -> bool {
///         (0..5).contains(cell)
///     }
/// }
///
/// impl Dynamics for Corridor {
///     fn transition(&self, cell: &i64, action: &Move, _rng: &mut Generator) -> Result<Transition<i64>> {
///         let cell = match action {
///             Move::Left => (cell - 1).max(0),
///             Move::Right => cell + 1,
///         };
///         Ok(Transition { state: cell, reward: -1.0, terminated: cell == 4 })
///     }
///     fn observe(&self, cell: &i64) -> i64 {
///         *cell
///     }
/// }
///
/// /// The best return from a state within some steps, by trying everything.
/// fn best_return(corridor: &Corridor, state: i64, steps: u32) -> Result<f64> {
///     let mut best = f64::NEG_INFINITY;
///     for action in Move::ALL {
///         let next = corridor.transition(&state, &action, &mut Generator::from(0))?;
///         let rest = if next.terminated || steps == 1 { 0.0 } else { best_return(corridor, next.state, steps - 1)? };
///         best = best.max(next.reward + rest);
///     }
///     Ok(best)
/// }
///
/// let env = Stateful::<Corridor>::new(NoArguments {})?;
/// let start = env.dynamics().start(&Reset::seed(0), &mut Generator::from(0))?;
/// assert_eq!(best_return(env.dynamics(), start, 8)?, -4.0);
/// # Ok::<(), gym_core::Error>(())
/// ```
///
/// Where randomness matters, each call gets a generator of its own: the same generator state gives the same outcome. The
/// example `monte_carlo_tree_search` of the crate `gym` plans with clones of whole environments.
pub trait Dynamics: Task {
    /// The state that follows, the reward of getting there, and whether the episode ends in it.
    ///
    /// # Errors
    /// [`Error::InvalidAction`] for an action that cannot be executed.
    fn transition(
        &self,
        state: &Self::State,
        action: &Self::Action,
        rng: &mut Generator,
    ) -> Result<Transition<Self::State>>;

    /// What the agent sees of a state.
    fn observe(&self, state: &Self::State) -> Self::Observation;

    /// Leaves what the agent sees of a state in `observation`. An environment that observes an
    /// [`Array`](crate::Array) or a [`Value`] fills the buffer that is there, so that a step allocates nothing.
    fn observe_into(&self, state: &Self::State, observation: &mut Self::Observation) {
        *observation = self.observe(state);
    }

    /// Whether the episode is cut off in a state for a reason outside of the task, such as a budget that
    /// is spent; asked after each transition. (A limit of steps is part of the registration.)
    fn truncates(&self, state: &Self::State) -> bool {
        let _ = state;
        false
    }

    /// [`transition`](Self::transition) and all that is asked after it, in place: what a step of
    /// [`Stateful`] does. A task of [`Equations`](crate::vector::native::Equations) has one function for both,
    /// compiled for the CPU as a whole.
    ///
    /// # Errors
    /// Those of `transition`; then nothing has changed.
    #[inline]
    fn step(
        &self,
        state: &mut Self::State,
        action: &Self::Action,
        rng: &mut Generator,
        observation: &mut Self::Observation,
    ) -> Result<Outcome> {
        let Transition { state: next, reward, terminated } = self.transition(state, action, rng)?;
        self.observe_into(&next, observation);
        let truncated = self.truncates(&next);
        *state = next;
        Ok(Outcome { reward, terminated, truncated })
    }
}

/// What [`Dynamics::transition`] gives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transition<S> {
    /// The next state.
    pub state: S,
    /// The reward of this step.
    pub reward: f64,
    /// Whether the episode ends in the next state.
    pub terminated: bool,
}

impl<S> Transition<S> {
    /// Nothing happens: the state stays, without a reward.
    #[inline(always)]
    pub fn stay(state: S) -> Self {
        Self { state, reward: 0.0, terminated: false }
    }
}

/// An [`Env`] that holds the state of its [`Dynamics`] and the generator.
#[derive(Clone)]
pub struct Stateful<D: Dynamics> {
    dynamics: D,
    episode: Option<Episode<D::State>>,
}

#[derive(Clone, Serialize, Deserialize)]
struct Episode<S> {
    state: S,
    rng: Generator,
}

impl<D: Dynamics> Stateful<D> {
    /// The environment with these arguments.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] for an argument out of range.
    pub fn new(config: D::Config) -> Result<Self> {
        D::new(config).map(|dynamics| Self { dynamics, episode: None })
    }

    /// The pure functions, for planning.
    pub fn dynamics(&self) -> &D {
        &self.dynamics
    }

    /// Sets one argument to a value in JSON. The episode goes on with it.
    ///
    /// # Errors
    /// As [`Task::assign`], and [`Error::InvalidArgument`] for a name or a value that does not fit.
    pub fn set_argument(&mut self, name: &str, value: Json) -> Result<()> {
        let given = [(name.to_owned(), value)].into_iter().collect();
        self.dynamics.assign(arguments::read(self.dynamics.config(), u32::MAX, &given, D::NAME)?)
    }

    /// The current state; `None` before the first reset.
    pub fn state(&self) -> Option<&D::State> {
        self.episode.as_ref().map(|episode| &episode.state)
    }
}

impl<D: Dynamics> fmt::Debug for Stateful<D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct(D::NAME).field("dynamics", &self.dynamics).field("state", &self.state()).finish()
    }
}

impl<D: Dynamics> Env for Stateful<D> {
    type Observation = D::Observation;
    type Action = D::Action;

    fn observation_space(&self) -> Space {
        self.dynamics.observation_space()
    }

    fn action_space(&self) -> Space {
        self.dynamics.action_space()
    }

    fn reset_into(&mut self, reset: &Reset, observation: &mut D::Observation) -> Result<()> {
        let mut rng = reset.generator(self.episode.as_ref().map(|episode| &episode.rng))?;
        let state = self.dynamics.start(reset, &mut rng)?;
        self.dynamics.observe_into(&state, observation);
        self.episode = Some(Episode { state, rng });
        Ok(())
    }

    #[inline]
    fn step_into(&mut self, action: &D::Action, observation: &mut D::Observation) -> Result<Outcome> {
        let Some(Episode { state, rng }) = &mut self.episode else { return Err(Error::ResetNeeded("step")) };
        self.dynamics.step(state, action, rng, observation)
    }

    fn snapshot(&self) -> Result<Snapshot> {
        Snapshot::with_config(D::NAME, self.dynamics.config(), &self.episode)
    }

    fn restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        let Self { dynamics, .. } = self;
        let is_valid = |episode: &Episode<D::State>| dynamics.is_valid(&episode.state);
        self.episode = snapshot.for_config(D::NAME, dynamics.config(), is_valid)?;
        Ok(())
    }

    fn info(&self, visit: &mut dyn FnMut(&str, Value)) {
        if let Some(state) = self.state() {
            self.dynamics.info(state, visit);
        }
    }

    fn metadata(&self) -> Metadata {
        self.dynamics.metadata()
    }

    fn draw(&self, canvas: &mut dyn Canvas) {
        if let Some(state) = self.state() {
            self.dynamics.draw(state, canvas);
        }
    }

    fn ansi(&self) -> Option<String> {
        self.state().and_then(|state| self.dynamics.ansi(state))
    }

    fn describe(&self) -> String {
        D::NAME.to_owned()
    }

    fn generator(&mut self) -> Option<&mut Generator> {
        self.episode.as_mut().map(|episode| &mut episode.rng)
    }

    fn close(&mut self) {
        self.episode = None;
    }
}
