//! Many environments stepped as one: Gymnasium's `VectorEnv`.

mod columns;
mod ext;
pub(crate) mod infos;
pub mod lockstep;
pub mod native;
mod pool;
mod reset;
pub(crate) mod size;
pub(crate) mod slot;
mod sync;
pub(crate) mod wrapper;

use std::any::Any;
use std::fmt;

use serde::{Deserialize, Serialize};

use crate::render::{Metadata, Rendered};
use crate::{Error, Result, Snapshot, Space, Value};

pub use crate::registry::{VectorKind, VectorSpec};
pub use columns::{Columns, Progress};
pub use ext::VectorEnvExt;
pub use pool::AsyncVectorEnv;
pub use reset::{Seeds, VectorReset};
pub use sync::SyncVectorEnv;

/// When the sub-environments of a vector are reset after their episodes have ended.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Autoreset {
    /// On the next step: that step ignores the action, starts the next episode and gives its first
    /// observation, with a reward of 0 and no flag set. Do not train on this transition.
    #[default]
    NextStep,
    /// On the same step: the observation is the first of the next episode, and the last of the one
    /// that ended is in [`Columns::final_observations`].
    SameStep,
    /// Never: the caller resets with a [mask](VectorReset::mask), and until then a step is an
    /// error.
    Disabled,
}

/// How far the observation spaces of a vector's sub-environments may differ: Gymnasium's `observation_mode`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum ObservationMode {
    /// They are equal.
    #[default]
    Same,
    /// They may have other bounds, but are of [one form](Space::has_form_of).
    /// [`VectorEnv::single_observation_space`] is that of the first, and
    /// [`VectorEnv::observation_space`] [has a row](Space::batch_differing) for each.
    Different,
}

/// A vector of any kind: what [`make_vec`](crate::make_vec) returns.
pub type BoxVector = Box<dyn VectorEnv>;

/// `n` environments of one kind, stepped together: Gymnasium's `VectorEnv`.
///
/// Results go to the caller's [`Columns`], which have a row for each sub-environment, so that a
/// step allocates nothing. Actions come as one element of the batched
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
/// Wrappers of vectors implement `VectorEnv` through [`VectorWrapper`](crate::VectorWrapper), and so does
/// `Box<dyn VectorEnv>`.
pub trait VectorEnv: Any + Send {
    /// How many sub-environments there are: at least one.
    fn num_envs(&self) -> usize;

    /// The space that each observation lies in.
    fn single_observation_space(&self) -> Space;

    /// The space of each sub-environment's actions.
    fn single_action_space(&self) -> Space;

    /// When sub-environments are reset after their episodes have ended.
    fn autoreset(&self) -> Autoreset;

    /// Starts episodes and leaves their first observations in `columns`, with rewards of 0 and no flag
    /// set.
    ///
    /// Where a mask leaves a sub-environment out, that one is not touched: its row holds the
    /// observation it had before.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] for seeds or a mask of another number than there are
    /// sub-environments, or a mask that selects none: then nothing was reset.
    /// [`Error::SubEnvironment`] if one cannot be reset; the others then are.
    fn reset_into(&mut self, reset: &VectorReset, columns: &mut Columns) -> Result<()>;

    /// Takes a step in every sub-environment (one whose reset is due starts an episode instead, see
    /// [`Autoreset`]) and leaves the results in `columns`.
    ///
    /// # Errors
    /// [`Error::NotInSpace`] unless `actions` has the form of the batched action space, and
    /// [`Error::SubEnvironment`] if one cannot step because it must be reset first: then nothing has
    /// changed. [`Error::SubEnvironment`] also if a sub-environment refuses its action or panics; the
    /// others have then taken their step, as [`Columns::progress`] tells. (A native vector checks all
    /// actions first, so none has stepped then.)
    fn step_into(&mut self, actions: &Value, columns: &mut Columns) -> Result<()>;

    /// Shows `visit` each entry of the [`info`](crate::Env::info) of sub-environment `index` about the last
    /// call of `reset_into` or `step_into`; nothing if a mask left it out. With
    /// [`Autoreset::SameStep`], where an episode has ended this is about the reset.
    fn info(&self, index: usize, visit: &mut dyn FnMut(&str, Value)) {
        let _ = (index, visit);
    }

    /// Shows `visit` each entry of the `info` of the step that ended an episode of sub-environment
    /// `index`, where the last step did so and [`Autoreset::SameStep`] has reset it since:
    /// Gymnasium's `final_info`.
    fn final_info(&self, index: usize, visit: &mut dyn FnMut(&str, Value)) {
        let _ = (index, visit);
    }

    /// Shows `visit` the entries of [`infos`](crate::vector::VectorEnvExt::infos) that are columns already, each with its mask
    /// under the key with an underscore before it. They stand for the entries of
    /// [`info`](Self::info) under the same key.
    fn column_infos(&self, visit: &mut dyn FnMut(&str, Value)) {
        let _ = visit;
    }

    /// Shows `visit` each sub-environment, in order, with its index, to downcast to its type: `call` of
    /// `dyn VectorEnv` does so.
    ///
    /// # Errors
    /// [`Error::Custom`] if there are no environments to show, as in a native vector.
    fn visit_envs(&mut self, visit: &mut dyn FnMut(usize, &mut dyn Any)) -> Result<()> {
        let _ = visit;
        Err(no_envs(&self.describe()))
    }

    /// The picture or text of each sub-environment, by the render mode they were made with.
    ///
    /// # Errors
    /// [`Error::UnsupportedMode`] if they were made without a render mode, or cannot be drawn.
    fn render(&mut self) -> Result<Vec<Rendered>> {
        Err(Error::UnsupportedMode {
            target: self.describe(),
            mode: "anything".into(),
            reason: "it draws nothing: make a sync or an async vector for this".into(),
        })
    }

    /// Render modes, frames per second and frame size of the sub-environments.
    fn metadata(&self) -> Metadata {
        Metadata::default()
    }

    /// How [`VectorSpec::make`] would build this vector again, if it can.
    fn spec(&self) -> Option<VectorSpec> {
        None
    }

    /// The kind of vector, its environment and their number: `SyncVectorEnv(CartPole-v1, num_envs=3)`.
    fn describe(&self) -> String {
        let name = crate::env::short_type_name::<Self>();
        format!("{name}(num_envs={})", self.num_envs())
    }

    /// The whole state, generators and resets that are due included, in a form that can be stored: a
    /// vector built alike that restores it continues identically, bit for bit.
    ///
    /// What [`info`](Self::info) tells of the last step is part of it where the sub-environments keep
    /// it. [`final_info`](Self::final_info) and the wall-clock time of episodes are not.
    ///
    /// # Errors
    /// [`Error::Snapshot`] if this vector or a sub-environment has no stored form, [`Error::Custom`] while
    /// sub-environments are pending.
    fn snapshot(&self) -> Result<Snapshot> {
        Err(no_snapshots(&self.describe()))
    }

    /// Continues from a snapshot of a vector built alike: the same environments, number, autoreset mode
    /// and wrappers. Snapshots of sync and of async vectors are interchangeable.
    ///
    /// # Errors
    /// [`Error::Snapshot`] if the snapshot is of something else or was damaged, [`Error::Closed`] after
    /// `close`, and [`Error::SubEnvironment`] if one refuses its part. The vector is then as it was
    /// before.
    fn restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        let _ = snapshot;
        Err(no_snapshots(&self.describe()))
    }

    /// The vector within, of a wrapper. The method `wrapper` of `dyn VectorEnv` finds one by its type.
    fn within(&self) -> Option<&dyn VectorEnv> {
        None
    }

    /// The vector within, of a wrapper, to be changed.
    fn within_mut(&mut self) -> Option<&mut dyn VectorEnv> {
        None
    }

    /// Ends the use of all sub-environments: later steps are an `Err`.
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
    Error::custom(format!("{vector} is not made of environments: make a sync or an async vector for this"))
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
