//! The spec of a vector as data: its sub-environments, its kind and its options.

use std::collections::BTreeMap;
use std::fmt;
use std::ops::Range;
use std::str::FromStr;

use serde::{Deserialize, Serialize};
use serde_json::Value as Json;

use crate::spec::{EnvSpec, WrapperSpec};
use crate::value::error::quoted;
use crate::value::{Error, Result};

/// When the sub-environments of a vector are reset after their episodes have ended.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Autoreset {
    /// On the next step, which ignores its action and returns the first observation of the next
    /// episode, with a reward of 0 and no flag set. Do not train on this transition.
    #[default]
    NextStep,
    /// On the same step: the observation is the first of the next episode, and the last of the one
    /// that ended is in
    /// [`Columns::final_observations`](crate::vector::Columns::final_observations).
    SameStep,
    /// Never: the caller resets with a [mask](crate::vector::VectorReset::mask), and until then a
    /// step is an error.
    Disabled,
}

/// The kinds of vector: ways to step the sub-environments.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum VectorKind {
    /// One after the other: [`SyncVectorEnv`](crate::vector::SyncVectorEnv).
    Sync,
    /// On a pool of threads: [`AsyncVectorEnv`](crate::vector::AsyncVectorEnv).
    Async,
    /// All in one SIMD loop: Gymnasium's vector entry point.
    #[serde(alias = "vector_entry_point")]
    Native,
}

impl VectorKind {
    /// Every kind.
    pub const ALL: [Self; 3] = [Self::Sync, Self::Async, Self::Native];

    /// Its name, as in `sync`.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Sync => "sync",
            Self::Async => "async",
            Self::Native => "native",
        }
    }
}

impl fmt::Display for VectorKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl FromStr for VectorKind {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        Self::ALL
            .into_iter()
            .find(|kind| kind.name() == text)
            .ok_or_else(|| {
                let names = Self::ALL.map(Self::name).join(", ");
                Error::argument(
                    "kind",
                    format!(
                        "unknown kind of vector `{}`: the kinds are {names}",
                        quoted(text)
                    ),
                )
            })
    }
}

/// Everything needed to rebuild a vector: the spec of its sub-environments, its own options, and
/// the wrappers around it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct VectorSpec {
    /// The spec of each sub-environment.
    #[serde(flatten)]
    pub env: EnvSpec,
    /// The number of sub-environments.
    pub num_envs: usize,
    /// The kind of vector.
    pub vectorization_mode: VectorKind,
    /// When they are reset.
    #[serde(default)]
    pub autoreset_mode: Autoreset,
    /// The number of threads of an async vector; `None` for one per core.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub threads: Option<usize>,
    /// The core of an async vector's first thread, if its threads are bound to cores:
    /// [`AsyncVectorEnv::with_affinity`](crate::vector::AsyncVectorEnv::with_affinity).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub affinity: Option<usize>,
    /// Arguments that differ between the sub-environments.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub each: BTreeMap<String, Each>,
    /// Wrappers around the vector, innermost first.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub vector_wrappers: Vec<WrapperSpec>,
}

/// An argument of each sub-environment.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(
    untagged,
    expecting = "expected a list of a value for each environment, or the range {\"low\": ..., \"high\": ...}"
)]
pub enum Each {
    /// A value for each environment.
    Values(Vec<Json>),
    /// A new value at each reset: uniform in `[low, high)`, drawn by the sub-environment's
    /// generator before it starts.
    Range {
        /// The least value.
        low: f64,
        /// The greatest value.
        high: f64,
    },
}

impl Each {
    /// The bounds of a range.
    pub fn range(&self) -> Option<(f64, f64)> {
        if let Self::Range { low, high } = *self {
            Some((low, high))
        } else {
            None
        }
    }

    /// The value of a sub-environment, if it is a number in a list.
    pub fn number(&self, index: usize) -> Option<f64> {
        if let Self::Values(values) = self {
            values.get(index)?.as_f64()
        } else {
            None
        }
    }

    /// Refuses a list whose length is not `num_envs`, and an invalid range.
    pub fn check(&self, name: &str, num_envs: usize) -> Result<()> {
        match self {
            Self::Values(values) if values.len() != num_envs => {
                let reason = format!(
                    "there are {} values for {num_envs} environments",
                    values.len()
                );
                Err(Error::argument(name, reason))
            }
            Self::Range { low, high } if !(low.is_finite() && high.is_finite() && low <= high) => {
                let reason = format!(
                    "the range from {low:?} to {high:?} needs finite ends, the lower one first"
                );
                Err(Error::argument(name, reason))
            }
            _ => Ok(()),
        }
    }
}

impl<T: Into<Json>> From<Vec<T>> for Each {
    fn from(values: Vec<T>) -> Self {
        Self::Values(values.into_iter().map(Into::into).collect())
    }
}

impl<T: Into<Json>, const N: usize> From<[T; N]> for Each {
    fn from(values: [T; N]) -> Self {
        Self::Values(values.into_iter().map(Into::into).collect())
    }
}

impl From<Range<f64>> for Each {
    fn from(range: Range<f64>) -> Self {
        let (low, high) = (range.start, range.end);
        Self::Range { low, high }
    }
}

impl VectorSpec {
    /// A vector of `num_envs` environments without wrappers around it, reset on the next step.
    pub fn new(env: EnvSpec, num_envs: usize, kind: VectorKind) -> Self {
        Self {
            env,
            num_envs,
            vectorization_mode: kind,
            autoreset_mode: Autoreset::default(),
            threads: None,
            affinity: None,
            each: BTreeMap::new(),
            vector_wrappers: Vec::new(),
        }
    }

    /// The same with another autoreset mode.
    #[must_use]
    pub fn autoreset(self, autoreset: Autoreset) -> Self {
        Self {
            autoreset_mode: autoreset,
            ..self
        }
    }

    /// The spec of this vector in one more wrapper.
    #[must_use]
    pub fn wrapped(mut self, wrapper: WrapperSpec) -> Self {
        self.vector_wrappers.push(wrapper);
        self
    }

    /// Refuses arguments that separate sub-environments do not support.
    pub(crate) fn check_each(&self) -> Result<()> {
        for (name, each) in &self.each {
            each.check(name, self.num_envs)?;
            if each.range().is_some() {
                return Err(Error::argument(
                    name,
                    "ranges need a native vector of classic control: give a list of values",
                ));
            }
        }
        Ok(())
    }

    /// The spec of the sub-environment with an index, with the arguments that are its own.
    pub fn env_at(&self, index: usize) -> EnvSpec {
        let mut env = self.env.clone();
        for (name, each) in &self.each {
            if let Each::Values(values) = each {
                env.kwargs
                    .extend(values.get(index).map(|value| (name.clone(), value.clone())));
            }
        }
        env
    }
}
