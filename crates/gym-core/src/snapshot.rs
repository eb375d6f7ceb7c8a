//! The stored state of an environment.

use serde::{Deserialize, Serialize, de::DeserializeOwned};
use serde_json::Value as Json;

use crate::{Error, Result};

/// The whole state of an environment and its wrappers, as JSON data.
///
/// A snapshot restored into an environment built with the same arguments continues identically.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Snapshot(Json);

impl Snapshot {
    /// The snapshot of some state.
    ///
    /// # Errors
    /// [`Error::Snapshot`] if the state holds a map whose keys are not strings. A number that is not finite has no
    /// form in JSON: it is stored as nothing, and such a snapshot is refused when it is restored.
    pub fn of<T: Serialize>(state: &T) -> Result<Self> {
        serde_json::to_value(state).map(Self).map_err(|error| Error::Snapshot(error.to_string()))
    }

    /// The snapshot of some state and of the arguments that its environment was built with.
    ///
    /// # Errors
    /// As [`of`](Self::of).
    pub fn with_config<C: Serialize, T: Serialize>(config: &C, state: &T) -> Result<Self> {
        Self::of(&(config, state))
    }

    /// The episode of a snapshot made by [`with_config`](Self::with_config), for the environment `env`
    /// built with `config`; none if it was taken before the first reset.
    ///
    /// # Errors
    /// [`Error::Snapshot`] if this is the snapshot of something else, of an environment with other
    /// arguments, or of an episode that is not valid.
    pub fn for_config<C, E>(
        &self,
        env: &str,
        config: &C,
        is_valid: impl FnOnce(&E) -> bool,
    ) -> Result<Option<E>>
    where
        C: DeserializeOwned + PartialEq,
        E: DeserializeOwned,
    {
        let (taken_with, episode): (C, Option<E>) = self.get()?;
        if taken_with != *config {
            return Err(Error::Snapshot(format!("it was taken from a {env} with other arguments")));
        }
        match episode {
            Some(episode) if !is_valid(&episode) => {
                Err(Error::Snapshot(format!("what it holds is not a state of this {env}")))
            }
            episode => Ok(episode),
        }
    }

    /// The state.
    ///
    /// # Errors
    /// [`Error::Snapshot`] if this is the snapshot of something else.
    pub fn get<T: DeserializeOwned>(&self) -> Result<T> {
        T::deserialize(&self.0).map_err(|error| Error::Snapshot(error.to_string()))
    }
}
