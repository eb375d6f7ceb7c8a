//! Environments: the trait, its methods for callers, wrappers, the erased environment, and
//! environments made of dynamics or equations.
//!
//! There is one trait. [`Env`] has associated types, and [`BoxEnv`] implements the same trait with
//! `Value` on both sides, so each wrapper exists once and generic code accepts both. The required
//! methods write the observation to the caller's buffer (`reset_into`, `step_into`), so a step
//! allocates nothing, even for erased environments and images. [`EnvExt`] has the methods of
//! callers, which return the observation.
//!
//! Actions are validated where they become typed: a typed action cannot be out of range, and a
//! `Value` of another kind, dtype, shape or range is refused before the step. Numbers beyond the
//! bounds of a `Box` pass, as in Gymnasium, where some environments clip them; NaN and infinities
//! do not.
//!
//! `info` is lazy: [`Env::info`] computes its entries when it is called, so a step pays nothing for
//! them.

mod boxed;
mod configure;
mod dynamics;
pub mod equations;
mod ext;
mod goals;
mod inspect;
pub(crate) mod wrapper;

use std::any::{Any, TypeId};

use gym_numerics::Generator;

use crate::drawing::canvas::Canvas;
use crate::drawing::render::{Metadata, RenderMode, Rendered};
use crate::spaces::Space;
use crate::spec::{EnvSpec, Reset};
use crate::value::{Element, Error, Result, Snapshot, Value};

pub use boxed::BoxEnv;
pub use configure::{Build, Configure, NoArguments};
pub use dynamics::{Dynamics, Stateful, Task, Transition, read_state};
pub use ext::EnvExt;
pub use goals::Goals;
pub use inspect::Inspect;
pub use wrapper::Wrapper;

/// A task for an agent: Gymnasium's `Env`.
///
/// An episode starts with [`reset`](crate::EnvExt::reset), which gives the first observation. Then
/// each [`step`](crate::EnvExt::step) takes an action and gives the next observation, a reward, and
/// whether the episode has ended: `terminated` if the task itself ended it, `truncated` if
/// something outside the task did, such as a time limit.
///
/// ```
/// use gym_core::{Env, EnvExt, Result};
///
/// /// The return of one episode of random actions.
/// fn random_return<E: Env>(env: &mut E, seed: u64) -> Result<f64> {
///     let mut actions = env.action_sampler(seed)?;
///     let mut total = 0.0;
///     env.reset(seed)?;
///     loop {
///         let step = env.step(&actions.sample())?;
///         total += step.reward;
///         if step.done() {
///             return Ok(total);
///         }
///     }
/// }
/// ```
///
/// The function accepts a typed environment (a CartPole that observes `[f32; 4]` and takes `Left`
/// or `Right`), and a [`BoxEnv`](crate::BoxEnv) from [`make`](crate::make), whose observations and
/// actions are [`Value`]s. Every wrapper is an `Env` as well.
///
/// # Implementing
///
/// Where the dynamics are a pure function of a plain state, implement
/// [`Dynamics`](crate::Dynamics) instead: [`Stateful`](crate::Stateful) makes an `Env` of it.
/// Otherwise six methods are needed:
///
/// ```
/// use gym_core::{Env, Outcome, Reset, Result, Snapshot, Space};
/// use serde::{Deserialize, Serialize};
///
/// /// Walk right from cell 0 to cell 4.
/// #[derive(Clone, Default, Serialize, Deserialize)]
/// struct Corridor {
///     cell: usize,
/// }
///
/// gym_core::discrete! {
///     /// One step along the corridor.
///     enum Move { /// towards cell 0
///         Left, /// towards cell 4
///         Right }
/// }
///
/// impl Env for Corridor {
///     type Observation = usize;
///     type Action = Move;
///
///     fn observation_space(&self) -> Space {
///         Space::discrete(5)
///     }
///
///     fn action_space(&self) -> Space {
///         Move::space()
///     }
///
///     fn reset_into(&mut self, _reset: &Reset, observation: &mut usize) -> Result<()> {
///         self.cell = 0;
///         *observation = self.cell;
///         Ok(())
///     }
///
///     fn step_into(&mut self, action: &Move, observation: &mut usize) -> Result<Outcome> {
///         self.cell = match action {
///             Move::Left => self.cell.saturating_sub(1),
///             Move::Right => (self.cell + 1).min(4),
///         };
///         *observation = self.cell;
///         let terminated = self.cell == 4;
///         Ok(Outcome { reward: f64::from(terminated), terminated, truncated: false })
///     }
///
///     fn snapshot(&self) -> Result<Snapshot> {
///         Snapshot::of(self)
///     }
///
///     fn restore(&mut self, snapshot: &Snapshot) -> Result<()> {
///         snapshot.get().map(|env| *self = env)
///     }
/// }
/// ```
///
/// Rules beyond the types:
/// - The same seed gives the same episode, on a fresh environment and on a used one, on any thread.
/// - All randomness comes from one [`Generator`](crate::Generator). `reset` seeds it, or continues
///   it without a seed.
/// - A step allocates nothing, reads no clock and draws nothing.
/// - Bad input gives an `Err`; nothing panics.
///
/// The crate gym-conform checks these.
pub trait Env: Clone + Send + 'static {
    /// The type of observations.
    type Observation: Element;
    /// The type of actions.
    type Action: Element;

    /// The space that every observation lies in.
    fn observation_space(&self) -> Space;

    /// The space of valid actions.
    fn action_space(&self) -> Space;

    /// Starts an episode and writes its first observation to `observation`.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] for a reset option with a bad value. The state is then unchanged.
    fn reset_into(&mut self, reset: &Reset, observation: &mut Self::Observation) -> Result<()>;

    /// Takes one step and writes the next observation to `observation`, without allocating.
    ///
    /// # Errors
    /// [`Error::ResetNeeded`] before the first reset, [`Error::InvalidAction`] for an action that
    /// cannot be executed. The state is then unchanged, except in wrappers that document otherwise.
    fn step_into(
        &mut self,
        action: &Self::Action,
        observation: &mut Self::Observation,
    ) -> Result<Outcome>;

    /// The whole state, generator included, in a form that can be stored.
    ///
    /// To branch within a program, `clone` is faster. The default is an error: the environment then
    /// cannot be saved and resumed, which gym-conform reports.
    ///
    /// # Errors
    /// [`Error::Snapshot`] if the state has no stored form.
    fn snapshot(&self) -> Result<Snapshot> {
        Err(no_snapshots(&self.describe()))
    }

    /// Continues from a snapshot of an environment built with the same arguments.
    ///
    /// # Errors
    /// [`Error::Snapshot`] if the snapshot is of something else or damaged; the environment is then
    /// unchanged.
    fn restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        let _ = snapshot;
        Err(no_snapshots(&self.describe()))
    }

    /// Calls `visit` with each entry of Gymnasium's `info` about the last reset or step. `info` is
    /// lazy: steps do not compute it.
    fn info(&self, visit: &mut dyn FnMut(&str, Value)) {
        let _ = visit;
    }

    /// Render modes, frames per second and frame size.
    fn metadata(&self) -> Metadata {
        Metadata::default()
    }

    /// Draws the current state. Pure: drawing twice gives the same picture and changes nothing.
    fn draw(&self, canvas: &mut dyn Canvas) {
        let _ = canvas;
    }

    /// Called after each frame with the number of frames drawn, and once before the first with 0.
    /// From then on the environment may keep state that only frames show, such as particles.
    /// Advance that state here; do not change the episode.
    fn frames_drawn(&mut self, count: u64) {
        let _ = count;
    }

    /// The depth of each pixel of a drawing of the width and height `size`, in metres, row by row
    /// from the top; for the modes `depth_array` and `rgbd_tuple`.
    fn depth(&self, size: (u32, u32)) -> Option<Vec<f32>> {
        let _ = size;
        None
    }

    /// The current state as text, for the mode `ansi`.
    fn ansi(&self) -> Option<String> {
        None
    }

    /// The mode of [`render`](crate::EnvExt::render); `None` if the environment was made without
    /// one.
    fn render_mode(&self) -> Option<RenderMode> {
        None
    }

    /// Writes the frame or text of the render mode to `rendered`. A frame of the same size is
    /// overwritten without allocating.
    ///
    /// # Errors
    /// [`Error::UnsupportedMode`] unless the environment was made with a render mode, or wrapped
    /// in [`Render`](crate::wrappers::Render). The contents of `rendered` are then unspecified.
    fn render_into(&mut self, rendered: &mut Rendered) -> Result<()> {
        let _ = rendered;
        Err(Error::UnsupportedMode {
            target: self.describe(),
            mode: "anything".into(),
            reason: "it was made without a render mode: add `.render_mode(RenderMode::RgbArray)`"
                .into(),
        })
    }

    /// The spec from which [`make`](crate::make) rebuilds this environment and its wrappers, if it
    /// can.
    fn spec(&self) -> Option<EnvSpec> {
        None
    }

    /// The stack of wrappers and the environment, outermost first: `<TimeLimit<CartPole>>`.
    fn describe(&self) -> String {
        short_type_name::<Self>().to_owned()
    }

    /// Calls `visit` with the name of each wrapper, outermost first, and of the environment.
    fn visit_layers(&self, visit: &mut dyn FnMut(&'static str)) {
        visit(short_type_name::<Self>());
    }

    /// The outermost layer of a type: a wrapper or the environment itself.
    /// [`layer`](crate::EnvExt::layer) calls it.
    fn any_layer(&self, layer: TypeId) -> Option<&dyn Any> {
        if layer == TypeId::of::<Self>() {
            Some(self)
        } else {
            None
        }
    }

    /// As [`any_layer`](Self::any_layer), mutable.
    fn any_layer_mut(&mut self, layer: TypeId) -> Option<&mut dyn Any> {
        if layer == TypeId::of::<Self>() {
            Some(self)
        } else {
            None
        }
    }

    /// The generator that the environment draws from, once it was reset: Gymnasium's `np_random`.
    ///
    /// Wrappers such as `StickyAction` draw from it as well, so that one seed determines an
    /// episode. They cannot wrap an environment that returns `None`.
    fn generator(&mut self) -> Option<&mut Generator> {
        None
    }

    /// The state, arguments and table of the environment; `None` if it shows none.
    fn inspect(&self) -> Option<&dyn Inspect> {
        None
    }

    /// Returns what [`inspect`](Self::inspect) returns, for changes.
    fn inspect_mut(&mut self) -> Option<&mut dyn Inspect> {
        None
    }

    /// Closes the environment: later steps are an `Err`.
    fn close(&mut self) {}
}

/// The error of an environment without [`Env::snapshot`] and [`Env::restore`].
fn no_snapshots(env: &str) -> Error {
    Error::Snapshot(format!(
        "{env} has no snapshots: implement `Env::snapshot` and `Env::restore`"
    ))
}

/// The result of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step<O> {
    /// The next observation.
    pub observation: O,
    /// The reward of this step.
    pub reward: f64,
    /// Whether the task has ended: the value of the next state is 0.
    pub terminated: bool,
    /// Whether something outside the task, such as a time limit, ended the episode. Both flags can
    /// be set.
    pub truncated: bool,
}

impl<O> Step<O> {
    /// Whether the episode is over and `reset` must come next.
    pub fn done(&self) -> bool {
        self.terminated || self.truncated
    }
}

/// A [`Step`] without its observation, which is in the caller's buffer.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Outcome {
    /// The reward of this step.
    pub reward: f64,
    /// Whether the task has ended: the value of the next state is 0.
    pub terminated: bool,
    /// Whether something outside the task, such as a time limit, ended the episode. Both flags can
    /// be set.
    pub truncated: bool,
}

impl Outcome {
    /// Whether the episode is over and `reset` must come next.
    pub fn done(&self) -> bool {
        self.terminated || self.truncated
    }
}

/// `TimeLimit` for `gym_core::wrappers::time_limit::TimeLimit<E>`.
pub(crate) fn short_type_name<T: ?Sized>() -> &'static str {
    let name = std::any::type_name::<T>();
    let name = name.split('<').next().unwrap_or(name);
    name.rsplit("::").next().unwrap_or(name)
}
