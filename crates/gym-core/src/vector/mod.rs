//! Many environments stepped as one: Gymnasium's `VectorEnv`.
//!
//! [`VectorEnv`] is object safe and works on batched `Value`s, so `Box<dyn VectorEnv>` goes through
//! the same wrappers as typed vectors. Calls write into columns that the caller owns. Sync and
//! async vectors have one slot per sub-environment, which alone handles the ends of episodes and
//! panics. `Columns::progress` tells wrappers what a call did with each sub-environment, so
//! wrappers need no record of due resets or failures.
//!
//! In a snapshot, sub-environments store themselves and the slot adds the vector's state. A native
//! vector stores columns: one object per environment would be ten times as large.

mod columns;
mod ext;
pub(crate) mod infos;
pub mod lockstep;
mod panic;
pub mod parts;
mod pool;
mod reset;
pub(crate) mod size;
pub(crate) mod slot;
mod sync;
pub(crate) mod wrapper;

use std::any::Any;
use std::fmt;

use serde::{Deserialize, Serialize};

use crate::drawing::render::{Metadata, Rendered};
use crate::env::Inspect;
use crate::spaces::Space;
use crate::value::{Error, Result, Snapshot, Value};

pub use crate::spaces::{ActionColumn, Actions};
#[doc(hidden)]
pub use crate::spaces::{block_of, indices};
pub use crate::spec::{Autoreset, VectorKind, VectorSpec};
pub use columns::{Columns, Progress};
pub use ext::VectorEnvExt;
pub use pool::AsyncVectorEnv;
pub use reset::{Seeds, VectorReset};
pub use sync::SyncVectorEnv;

/// Whether the observation spaces of sub-environments may differ: Gymnasium's `observation_mode`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum ObservationMode {
    /// The observation spaces are equal.
    #[default]
    Same,
    /// The bounds of the spaces may differ, but not the [form](Space::has_form_of).
    /// [`VectorEnv::single_observation_space`] is the space of the first sub-environment, and
    /// [`VectorEnv::observation_space`] [has a row](Space::batch_differing) for each
    /// sub-environment.
    Different,
}

/// A vector of any kind, as [`make_vec`](crate::make_vec) returns it.
pub type BoxVector = Box<dyn VectorEnv>;

/// `n` environments of one kind, stepped together: Gymnasium's `VectorEnv`.
///
/// Results go to the caller's [`Columns`], with a row for each sub-environment, so that a step
/// allocates nothing. The actions are one element of the batched
/// [`action_space`](Self::action_space).
///
/// ```no_run
/// use gym_core::vector::{VectorEnv, VectorEnvExt};
///
/// # fn main() -> gym_core::Result<()> {
/// let mut envs = gym_core::make_vec("CartPole-v1", 64, None)?;
/// let mut columns = envs.columns()?;
/// let mut actions = envs.action_sampler(0)?;
/// envs.reset_into(&42.into(), &mut columns)?; // seeds 42, 43, ...
/// for _ in 0..1000 {
///     envs.step_into(&actions.sample(), &mut columns)?;
///     let observations: Option<&[f32]> = columns.observations.as_slice(); // 64 rows of 4
/// }
/// # Ok(())
/// # }
/// ```
///
/// Wrappers of vectors implement `VectorEnv` through [`VectorWrapper`](crate::VectorWrapper), and
/// so does `Box<dyn VectorEnv>`.
pub trait VectorEnv: Any + Send {
    /// The number of sub-environments, at least one.
    fn num_envs(&self) -> usize;

    /// The space that each observation lies in.
    fn single_observation_space(&self) -> Space;

    /// The space of each sub-environment's actions.
    fn single_action_space(&self) -> Space;

    /// When sub-environments are reset after their episodes have ended.
    fn autoreset(&self) -> Autoreset;

    /// Starts episodes and writes their first observations to `columns`, with rewards of 0 and no
    /// flag set.
    ///
    /// A sub-environment that a mask leaves out is unchanged; its row holds its last observation.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] if the number of seeds or mask entries differs from the number of
    /// sub-environments, or the mask selects none; no sub-environment is then reset.
    /// [`Error::SubEnvironment`] if one cannot be reset; the others are reset.
    fn reset_into(&mut self, reset: &VectorReset, columns: &mut Columns) -> Result<()>;

    /// Steps every sub-environment and writes the results to `columns`. One with a pending reset
    /// starts an episode instead; see [`Autoreset`].
    ///
    /// # Errors
    /// [`Error::NotInSpace`] unless `actions` has the form of the batched action space, and
    /// [`Error::SubEnvironment`] if one must be reset first: then nothing has changed.
    /// [`Error::SubEnvironment`] also if a sub-environment refuses its action or panics; the others
    /// have then stepped, as [`Columns::progress`] shows. (A native vector checks all actions
    /// first, so none has stepped then.)
    fn step_into(&mut self, actions: &Value, columns: &mut Columns) -> Result<()>;

    /// Calls `visit` with each entry of the [`info`](crate::Env::info) of sub-environment `index`
    /// about the last call of `reset_into` or `step_into`; nothing if a mask left it out. With
    /// [`Autoreset::SameStep`], after the end of an episode this is about the reset.
    fn info(&self, index: usize, visit: &mut dyn FnMut(&str, Value)) {
        let _ = (index, visit);
    }

    /// Calls `visit` with each entry of the `info` of the step that ended an episode of
    /// sub-environment `index`, if that was the last step and [`Autoreset::SameStep`] has reset it:
    /// Gymnasium's `final_info`.
    fn final_info(&self, index: usize, visit: &mut dyn FnMut(&str, Value)) {
        let _ = (index, visit);
    }

    /// Shows `visit` the entries of [`infos`](crate::vector::VectorEnvExt::infos) that are columns
    /// already, each with its mask under the key with an underscore before it. They stand for the
    /// entries of [`info`](Self::info) under the same key.
    fn column_infos(&self, visit: &mut dyn FnMut(&str, Value)) {
        let _ = visit;
    }

    /// Calls `visit` with each sub-environment and its index, in order. `call` of `dyn VectorEnv`
    /// downcasts them.
    ///
    /// # Errors
    /// [`Error::Custom`] if the vector has no separate environments, as a native one.
    fn visit_envs(&mut self, visit: &mut dyn FnMut(usize, &mut dyn Any)) -> Result<()> {
        let _ = visit;
        Err(no_envs(&self.describe()))
    }

    /// Calls `visit` with the [`Inspect`] of sub-environment `index`, to read
    /// or to change.
    ///
    /// # Errors
    /// [`Error::Custom`] if there is no such sub-environment, or it cannot be inspected; then
    /// `visit` was not called.
    fn inspect(&mut self, index: usize, visit: &mut dyn FnMut(&mut dyn Inspect)) -> Result<()> {
        let _ = (index, visit);
        Err(Error::custom(format!(
            "the sub-environments of {} cannot be inspected",
            self.describe()
        )))
    }

    /// The frame or text of each sub-environment, in their render mode.
    ///
    /// # Errors
    /// [`Error::UnsupportedMode`] if they were made without a render mode, or cannot be drawn.
    fn render(&mut self) -> Result<Vec<Rendered>> {
        Err(Error::UnsupportedMode {
            target: self.describe(),
            mode: "anything".into(),
            reason: "it cannot render: make a sync or async vector".into(),
        })
    }

    /// Render modes, frames per second and frame size of the sub-environments.
    fn metadata(&self) -> Metadata {
        Metadata::default()
    }

    /// The spec from which [`VectorSpec::make`] rebuilds this vector, if it can.
    fn spec(&self) -> Option<VectorSpec> {
        None
    }

    /// The kind of vector, its environment and their number: `SyncVectorEnv(CartPole-v1,
    /// num_envs=3)`.
    fn describe(&self) -> String {
        let name = crate::env::short_type_name::<Self>();
        format!("{name}(num_envs={})", self.num_envs())
    }

    /// The whole state, generators and pending resets included, in a form that can be stored: a
    /// vector built with the same arguments that restores it continues bit for bit.
    ///
    /// The last [`info`](Self::info) is part of it if the sub-environments store it.
    /// [`final_info`](Self::final_info) and the wall-clock time of episodes are not.
    ///
    /// # Errors
    /// [`Error::Snapshot`] if this vector or a sub-environment has no stored form,
    /// [`Error::Custom`] while sub-environments are pending.
    fn snapshot(&self) -> Result<Snapshot> {
        Err(no_snapshots(&self.describe()))
    }

    /// Continues from a snapshot of a vector with the same environments, number, autoreset mode and
    /// wrappers. Snapshots of sync and async vectors are interchangeable.
    ///
    /// # Errors
    /// [`Error::Snapshot`] if the snapshot is of something else or damaged, [`Error::Closed`] after
    /// `close`, and [`Error::SubEnvironment`] if one refuses its part. The vector is then
    /// unchanged.
    fn restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        let _ = snapshot;
        Err(no_snapshots(&self.describe()))
    }

    /// The inner vector, for a wrapper. The method `layer` of `dyn VectorEnv` calls it.
    fn within(&self) -> Option<&dyn VectorEnv> {
        None
    }

    /// The inner vector, mutable, for a wrapper.
    fn within_mut(&mut self) -> Option<&mut dyn VectorEnv> {
        None
    }

    /// Closes all sub-environments: later steps are an `Err`.
    fn close(&mut self) {}

    /// The space of all observations together.
    ///
    /// # Errors
    /// [`Error::InvalidSpace`] as [`Space::batch`].
    fn observation_space(&self) -> Result<Space> {
        self.single_observation_space().batch(self.num_envs())
    }

    /// The space of all actions together.
    ///
    /// # Errors
    /// [`Error::InvalidSpace`] as [`Space::batch`].
    fn action_space(&self) -> Result<Space> {
        self.single_action_space().batch(self.num_envs())
    }
}

fn no_envs(vector: &str) -> Error {
    Error::custom(format!(
        "{vector} has no separate environments: make a sync or async vector"
    ))
}

fn no_snapshots(vector: &str) -> Error {
    Error::Snapshot(format!(
        "{vector} has no snapshots: implement `VectorEnv::snapshot` and `restore` for it"
    ))
}

impl fmt::Debug for dyn VectorEnv {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.describe())
    }
}
