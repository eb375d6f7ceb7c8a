//! Environments as pure functions of a plain state, Gymnasium's `FuncEnv`, and the stateful
//! environment made of them.

use std::fmt;

use gym_numerics::Generator;
use serde::{Deserialize, Serialize, de::DeserializeOwned};
use serde_json::Value as Json;

use crate::drawing::canvas::Canvas;
use crate::drawing::render::Metadata;
use crate::env::{Env, Inspect, Outcome};
use crate::spaces::Space;
use crate::spec::{Arguments, Reset, arguments};
use crate::value::error::shortened;
use crate::value::{Element, Error, Result, Snapshot, Value};

/// A task without its dynamics: arguments, spaces, starts and drawing.
///
/// The dynamics are in [`Dynamics`], or in [`Equations`](crate::equations::Equations) if one
/// formula serves scalar environments and native vectors.
pub trait Task: Clone + fmt::Debug + Send + 'static {
    /// The constructor's arguments; [`make`](crate::make) uses their `Default`.
    type Config: Arguments + PartialEq;
    /// The state.
    type State: Clone + fmt::Debug + PartialEq + Send + Serialize + DeserializeOwned + 'static;
    /// The type of observations.
    type Observation: Element;
    /// The type of actions.
    type Action: Element;

    /// The name of the environment, without version.
    const NAME: &'static str;

    /// Whether [`info`](Self::info) has entries. Native vectors call it only then.
    const INFO: bool = false;

    /// The dynamics with these arguments.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] for an argument out of range.
    fn new(config: Self::Config) -> Result<Self>;

    /// Refuses arguments with which no episode can start. Environments and vectors call it when
    /// they are made. [`assign`](Self::assign) does not call it: a running episode continues with
    /// such arguments.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] for an argument with which no episode can start.
    fn check_start(&self) -> Result<()> {
        Ok(())
    }

    /// The arguments, with every random choice filled in.
    fn config(&self) -> &Self::Config;

    /// Changes the arguments of a task in use, as setting an attribute does in Gymnasium: spaces
    /// and derived constants stay as the constructor made them.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] for an argument out of range, or if arguments are fixed (the
    /// default); then nothing has changed.
    fn assign(&mut self, config: Self::Config) -> Result<()> {
        let _ = config;
        Err(Error::argument(
            Self::NAME,
            "its arguments are fixed: make a new environment",
        ))
    }

    /// See [`Inspect::table`].
    fn table(&self) -> Option<Json> {
        None
    }

    /// See [`Inspect::set_table`].
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] for a table that does not fit, and if the task has none.
    fn set_table(&mut self, table: Json) -> Result<()> {
        let _ = table;
        Err(Error::argument(
            Self::NAME,
            "its dynamics are not a table that can be replaced",
        ))
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

    /// Whether a state from a snapshot is valid; `restore` refuses others.
    fn is_valid(&self, state: &Self::State) -> bool;

    /// Calls `visit` with each entry of `info` about the transition into `state`.
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

/// The dynamics of a [`Task`], as pure functions of a plain state.
///
/// | function | Gymnasium's `FuncEnv` | result |
/// |---|---|---|
/// | [`start`](Task::start)`(reset, rng)` | `initial` | a state |
/// | [`transition`](Self::transition)`(state, action, rng)` | `transition`, `reward`, `terminal` | the next state, the reward, whether it is the last |
/// | [`observe`](Self::observe)`(state)` | `observation` | the observation |
///
/// Results depend only on the arguments and the generator. [`Stateful`] makes an [`Env`] of them; a
/// planner calls them directly, from any state:
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
/// The same generator state gives the same outcome. The example `monte_carlo_tree_search` of the
/// crate `gym` plans with clones of environments.
pub trait Dynamics: Task {
    /// The next state, the reward, and whether the next state is terminal.
    ///
    /// # Errors
    /// [`Error::InvalidAction`] for an action that cannot be executed.
    fn transition(
        &self,
        state: &Self::State,
        action: &Self::Action,
        rng: &mut Generator,
    ) -> Result<Transition<Self::State>>;

    /// The observation of a state.
    fn observe(&self, state: &Self::State) -> Self::Observation;

    /// Writes the observation of a state to `observation`. Override it for an
    /// [`Array`](crate::Array) or a [`Value`], to fill the existing buffer without allocating.
    fn observe_into(&self, state: &Self::State, observation: &mut Self::Observation) {
        *observation = self.observe(state);
    }

    /// Whether something outside the task, such as a spent budget, ends the episode in a state;
    /// called after each transition. (The registration has the limit of steps.)
    fn truncates(&self, state: &Self::State) -> bool {
        let _ = state;
        false
    }

    /// [`transition`](Self::transition), [`truncates`](Self::truncates) and
    /// [`observe_into`](Self::observe_into) in place: a step of [`Stateful`]. A task of
    /// [`Equations`](crate::equations::Equations) overrides it with one function that is compiled
    /// for the CPU's features.
    ///
    /// # Errors
    /// The errors of `transition`; the state is then unchanged.
    #[inline]
    fn step(
        &self,
        state: &mut Self::State,
        action: &Self::Action,
        rng: &mut Generator,
        observation: &mut Self::Observation,
    ) -> Result<Outcome> {
        let Transition {
            state: next,
            reward,
            terminated,
        } = self.transition(state, action, rng)?;
        self.observe_into(&next, observation);
        let truncated = self.truncates(&next);
        *state = next;
        Ok(Outcome {
            reward,
            terminated,
            truncated,
        })
    }
}

/// The result of [`Dynamics::transition`].
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
    /// No change: the same state, without a reward.
    #[inline(always)]
    pub fn stay(state: S) -> Self {
        Self {
            state,
            reward: 0.0,
            terminated: false,
        }
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
        let dynamics = D::new(config)?;
        dynamics.check_start()?;
        Ok(Self {
            dynamics,
            episode: None,
        })
    }

    /// The pure functions, for planning.
    pub fn dynamics(&self) -> &D {
        &self.dynamics
    }

    /// The arguments.
    pub fn config(&self) -> &D::Config {
        self.dynamics.config()
    }

    /// The current state; `None` before the first reset.
    pub fn state(&self) -> Option<&D::State> {
        self.episode.as_ref().map(|episode| &episode.state)
    }
}

/// A state of a task from JSON.
///
/// # Errors
/// [`Error::InvalidArgument`] for JSON of another form, and for a state that the task does not
/// have.
pub fn read_state<T: Task>(task: &T, state: &Json) -> Result<T::State> {
    let refuse = |reason: String| Error::argument(format!("the state of {}", T::NAME), reason);
    let read = T::State::deserialize(state).map_err(|error| refuse(error.to_string()))?;
    if task.is_valid(&read) {
        Ok(read)
    } else {
        let state = state.to_string();
        Err(refuse(format!("{} does not occur", shortened(&state))))
    }
}

/// A new value of an argument applies from the next step on.
impl<D: Dynamics> Inspect for Stateful<D> {
    fn state(&self) -> Option<Json> {
        serde_json::to_value(self.state()?).ok()
    }

    fn set_state(&mut self, state: Json) -> Result<()> {
        let Some(episode) = &mut self.episode else {
            return Err(Error::ResetNeeded("set_state"));
        };
        episode.state = read_state(&self.dynamics, &state)?;
        Ok(())
    }

    fn arguments(&self) -> Json {
        serde_json::to_value(self.config()).unwrap_or_default()
    }

    fn set_argument(&mut self, name: &str, value: Json) -> Result<()> {
        let given = [(name.to_owned(), value)].into_iter().collect();
        self.dynamics.assign(arguments::read(
            self.dynamics.config(),
            u32::MAX,
            &given,
            D::NAME,
        )?)
    }

    fn table(&self) -> Option<Json> {
        self.dynamics.table()
    }

    fn set_table(&mut self, table: Json) -> Result<()> {
        self.dynamics.set_table(table)
    }
}

impl<D: Dynamics> fmt::Debug for Stateful<D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct(D::NAME)
            .field("dynamics", &self.dynamics)
            .field("state", &self.state())
            .finish()
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
    fn step_into(
        &mut self,
        action: &D::Action,
        observation: &mut D::Observation,
    ) -> Result<Outcome> {
        let Some(Episode { state, rng }) = &mut self.episode else {
            return Err(Error::ResetNeeded("step"));
        };
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

    fn inspect(&self) -> Option<&dyn Inspect> {
        Some(self)
    }

    fn inspect_mut(&mut self) -> Option<&mut dyn Inspect> {
        Some(self)
    }

    fn close(&mut self) {
        self.episode = None;
    }
}
