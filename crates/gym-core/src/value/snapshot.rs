//! The stored state of an environment.
//!
//! A snapshot is data (JSON): [`restore`](crate::Env::restore) checks it, and it can be stored. A
//! clone is faster, for branching within a program.

use serde::{Deserialize, Serialize, de::DeserializeOwned};
use serde_json::Value as Json;

use crate::value::{Error, Result};
use gym_numerics::exact;

/// The whole state of an environment and its wrappers, as JSON data, NaN and infinite floats
/// included.
///
/// A snapshot restored into an environment built with the same arguments continues identically.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename = "$json")]
pub struct Snapshot(Json);

impl Snapshot {
    /// The snapshot of some state.
    ///
    /// # Errors
    /// [`Error::Snapshot`] if the state contains a map whose keys are not strings.
    pub fn of<T: Serialize>(state: &T) -> Result<Self> {
        exact::write(state)
            .map(Self)
            .map_err(|error| Error::Snapshot(error.to_string()))
    }

    /// The snapshot of an environment: its name, the arguments that it was built with, and its
    /// episode.
    ///
    /// # Errors
    /// The errors of [`of`](Self::of).
    pub fn with_config<C: Serialize, T: Serialize>(
        env: &str,
        config: &C,
        episode: &T,
    ) -> Result<Self> {
        /// The form that [`Snapshot::for_config`] reads.
        #[derive(Serialize)]
        struct Stored<'a, C, T> {
            env: &'a str,
            config: &'a C,
            episode: &'a T,
        }

        Self::of(&Stored {
            env,
            config,
            episode,
        })
    }

    /// The name of the environment inside all wrappers, if [`with_config`](Self::with_config) took
    /// the snapshot.
    fn env(&self) -> Option<&str> {
        // a wrapper's snapshot is a list that begins with the inner environment's snapshot
        let mut json = &self.0;
        while let Json::Array(items) = json {
            json = items.first()?;
        }
        json.get("env")?.as_str()
    }

    /// The episode of a snapshot made by [`with_config`](Self::with_config), for the environment
    /// `env` built with `config`; none if it was taken before the first reset.
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
        /// The content that [`Snapshot::with_config`] wrote.
        #[derive(Deserialize)]
        #[serde(
            deny_unknown_fields,
            bound = "C: DeserializeOwned, E: DeserializeOwned"
        )]
        struct Stored<C, E> {
            #[serde(rename = "env")]
            _env: String,
            config: C,
            // null before the first reset; a missing key is an error
            #[serde(deserialize_with = "Option::deserialize")]
            episode: Option<E>,
        }

        if let Some(other) = self.env()
            && other != env
        {
            return Err(Error::Snapshot(format!(
                "this is a snapshot of {other}, not of {env}"
            )));
        }
        let Stored::<C, E> {
            config: taken_with,
            episode,
            ..
        } = self.get()?;
        if taken_with != *config {
            return Err(Error::Snapshot(format!(
                "it was taken from a {env} with other arguments"
            )));
        }
        match episode {
            Some(episode) if !is_valid(&episode) => Err(Error::Snapshot(format!(
                "its content is not a state of this {env}"
            ))),
            episode => Ok(episode),
        }
    }

    /// The state.
    ///
    /// # Errors
    /// [`Error::Snapshot`] if this is the snapshot of something else.
    pub fn get<T: DeserializeOwned>(&self) -> Result<T> {
        exact::read(&self.0).map_err(|error| {
            Error::Snapshot(match self.env() {
                Some(env) => {
                    format!("this snapshot of {env} does not fit the environment and its wrappers: {error}")
                }
                None => error.to_string(),
            })
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn snapshots_within_snapshots_keep_every_float() {
        let inner = Snapshot::of(&[f64::INFINITY, 0.5]).unwrap();
        let outer = Snapshot::of(&(&inner, 7)).unwrap();
        let stored = serde_json::to_string(&outer).unwrap();
        let (read, count): (Snapshot, u32) = serde_json::from_str::<Snapshot>(&stored)
            .unwrap()
            .get()
            .unwrap();
        assert_eq!((&read, count), (&inner, 7));
        assert_eq!(read.get::<[f64; 2]>().unwrap(), [f64::INFINITY, 0.5]);
    }
}
