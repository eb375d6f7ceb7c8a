//! From an id to a vector of environments.

use std::collections::BTreeMap;
use std::fmt;
use std::ops::Range;
use std::str::FromStr;

use serde::{Deserialize, Serialize};
use serde_json::Value as Json;

use super::{EnvBuilder, EnvSpec, builder, find};
use crate::vector::{AsyncVectorEnv, Autoreset, SyncVectorEnv, VectorEnv, size, slot};
use crate::{BoxEnv, Env, Error, Result, WrapperSpec};

/// Makes a vector of `num_envs` environments, as Gymnasium's `make_vec`.
///
/// Without a kind, the vector is native if the id has a native vector that supports the options,
/// else sync; see [`VectorBuilder::kind`]. Each sub-environment has the stack of
/// [`make`](crate::make), time limit included.
///
/// # Errors
/// The errors of [`make`](crate::make); [`Error::InvalidArgument`] for no environments, more than
/// memory holds, or a kind that the id does not have.
pub fn make_vec(
    id: &str,
    num_envs: usize,
    kind: impl Into<Option<VectorKind>>,
) -> Result<Box<dyn VectorEnv>> {
    let vector = builder(id).vector(num_envs);
    match kind.into() {
        Some(kind) => vector.kind(kind).build(),
        None => vector.build(),
    }
}

/// The kinds of vector: ways to step the sub-environments.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum VectorKind {
    /// One after the other: [`SyncVectorEnv`].
    Sync,
    /// On a pool of threads: [`AsyncVectorEnv`].
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
                    format!("unknown kind of vector `{text}`: the kinds are {names}"),
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
    /// Arguments that differ between the sub-environments.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub each: BTreeMap<String, Each>,
    /// Wrappers around the vector, innermost first.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub vector_wrappers: Vec<WrapperSpec>,
}

/// An argument of each sub-environment.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
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
    fn from(
        Range {
            start: low,
            end: high,
        }: Range<f64>,
    ) -> Self {
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

    /// The spec of a sub-environment.
    pub(crate) fn env_at(&self, index: usize) -> EnvSpec {
        let mut env = self.env.clone();
        for (name, each) in &self.each {
            if let Each::Values(values) = each {
                env.kwargs
                    .extend(values.get(index).map(|value| (name.clone(), value.clone())));
            }
        }
        env
    }

    /// Makes the sub-environments, for your own kind of vector.
    ///
    /// # Errors
    /// The errors of [`EnvSpec::make`]; [`Error::InvalidArgument`] if the environments do not fit
    /// in memory, estimated from the first one.
    pub fn envs(&self) -> Result<Vec<BoxEnv>> {
        self.check_each()?;
        let make = |index| self.env_at(index).make();
        let first = make(0)?;
        let observation = first.observation_space();
        let bytes = slot::slot_bytes::<BoxEnv>(&observation) + ENV_BYTES;
        size::check(self.num_envs, &observation, &first.action_space(), bytes)?;
        std::iter::once(Ok(first))
            .chain((1..self.num_envs).map(make))
            .collect()
    }

    /// Makes the vector in its wrappers.
    ///
    /// # Errors
    /// The errors of [`make_vec`], and one for an unknown wrapper.
    pub fn make(&self) -> Result<Box<dyn VectorEnv>> {
        self.vector_wrappers
            .iter()
            .try_fold(self.make_bare()?, |envs, wrapper| wrapper.wrap_vector(envs))
    }

    /// Makes the vector without wrappers around it.
    fn make_bare(&self) -> Result<Box<dyn VectorEnv>> {
        let spec = Self {
            vector_wrappers: Vec::new(),
            ..self.clone()
        };
        match self.vectorization_mode {
            VectorKind::Sync => {
                let vector = SyncVectorEnv::new(self.envs()?)?;
                Ok(Box::new(
                    vector.with_autoreset(self.autoreset_mode).with_spec(spec),
                ))
            }
            VectorKind::Async => Ok(Box::new(self.make_async()?)),
            VectorKind::Native => {
                let id = &self.env.id;
                let refuse = |reason: &str| {
                    Err(Error::argument(
                        format!("a native vector of `{id}`"),
                        reason,
                    ))
                };
                let Some(entry_point) = find(id)?.vector_entry_point else {
                    return refuse("there is none for this id: use kind sync or async");
                };
                match native_obstacle(&self.env) {
                    Some(reason) => refuse(reason),
                    None => entry_point(&spec),
                }
            }
        }
    }

    /// Makes a vector on threads, whatever the kind, by its own type, which can
    /// [`send`](AsyncVectorEnv::send). It has no wrappers around it.
    ///
    /// # Errors
    /// The errors of [`make_vec`].
    pub fn make_async(&self) -> Result<AsyncVectorEnv> {
        let mut vector = AsyncVectorEnv::new(self.envs()?)?;
        // (a wrapper may change the action that a step is begun with)
        let ahead = find(&self.env.id)?
            .ahead()
            .filter(|_| self.env.additional_wrappers.is_empty());
        if let Some(ahead) = ahead {
            vector = vector.with_ahead(ahead)?;
        }
        if let Some(threads) = self.threads {
            vector = vector.with_threads(threads)?;
        }
        let spec = Self {
            vectorization_mode: VectorKind::Async,
            vector_wrappers: Vec::new(),
            ..self.clone()
        };
        Ok(vector.with_autoreset(self.autoreset_mode).with_spec(spec))
    }
}

/// The smallest memory of an environment from `make`, without its observations: its state, its
/// spec, and the boxes of its wrappers.
const ENV_BYTES: usize = 1024;

/// The option of a spec that native vectors do not support.
fn native_obstacle(spec: &EnvSpec) -> Option<&'static str> {
    if !spec.additional_wrappers.is_empty() {
        Some("its environments cannot be wrapped: wrap the vector, or make a sync or async one")
    } else if spec.render_mode.is_some() {
        Some("it cannot render: make a sync or async one")
    } else {
        None
    }
}

impl EnvBuilder {
    /// Starts a vector of `num_envs` environments, each made with these options.
    ///
    /// ```no_run
    /// # fn main() -> gym_core::Result<()> {
    /// let envs = gym_core::builder("FrozenLake-v1").arg("map_name", "8x8").vector(64).build()?;
    /// # Ok(())
    /// # }
    /// ```
    pub fn vector(self, num_envs: usize) -> VectorBuilder {
        // a placeholder until a kind is chosen
        let spec = self
            .spec()
            .map(|env| VectorSpec::new(env, num_envs, VectorKind::Native));
        VectorBuilder {
            spec,
            has_kind: false,
        }
    }
}

/// A [`VectorSpec`] to change, and then make; see [`EnvBuilder::vector`]. Errors appear when it is
/// made.
#[derive(Clone, Debug)]
pub struct VectorBuilder {
    spec: Result<VectorSpec>,
    has_kind: bool,
}

impl VectorBuilder {
    /// Sets an argument of each sub-environment: a list has one value for each; from a range, each
    /// draws a new value at each reset. Native vectors support both, for arguments that are
    /// numbers; sync and async vectors support lists.
    ///
    /// ```no_run
    /// # fn main() -> gym_core::Result<()> {
    /// let envs = gym_core::builder("CartPole-v1").vector(64).arg_each("gravity", 3.7..11.2).build()?;
    /// # Ok(())
    /// # }
    /// ```
    #[must_use]
    pub fn arg_each(mut self, name: &str, each: impl Into<Each>) -> Self {
        if let Ok(spec) = &mut self.spec {
            spec.each.insert(name.to_owned(), each.into());
        }
        self
    }

    /// The kind of vector. The default is native if the id has a native vector that supports the
    /// options, else sync. Native vectors do not support wrappers of environments, a render mode, a
    /// time limit above 65534 steps, or arguments that only scalar environments have.
    #[must_use]
    pub fn kind(self, kind: VectorKind) -> Self {
        let spec = self.spec.map(|spec| VectorSpec {
            vectorization_mode: kind,
            ..spec
        });
        Self {
            spec,
            has_kind: true,
        }
    }

    /// When sub-environments are reset; the default is the next step.
    #[must_use]
    pub fn autoreset(self, autoreset: Autoreset) -> Self {
        Self {
            spec: self.spec.map(|spec| spec.autoreset(autoreset)),
            ..self
        }
    }

    /// The number of threads of an async vector; the default is one per core.
    #[must_use]
    pub fn threads(self, threads: usize) -> Self {
        Self {
            spec: self.spec.map(|spec| VectorSpec {
                threads: Some(threads),
                ..spec
            }),
            ..self
        }
    }

    /// The spec with all options.
    ///
    /// # Errors
    /// The errors of [`EnvBuilder::spec`].
    pub fn spec(self) -> Result<VectorSpec> {
        self.resolve().map(|(spec, _)| spec)
    }

    /// Makes the vector.
    ///
    /// # Errors
    /// The errors of [`make_vec`].
    pub fn build(self) -> Result<Box<dyn VectorEnv>> {
        match self.resolve()? {
            (_, Some(vector)) => Ok(vector),
            (spec, None) => spec.make(),
        }
    }

    /// The spec, and the vector if it had to be made to know the kind.
    fn resolve(self) -> Result<(VectorSpec, Option<Box<dyn VectorEnv>>)> {
        let spec = self.spec?;
        if self.has_kind {
            return Ok((spec, None));
        }
        // a native vector refuses unsupported options; a sync vector reports those it does not
        // support either
        match spec.make() {
            Ok(vector) => Ok((spec, Some(vector))),
            Err(_) => Ok((
                VectorSpec {
                    vectorization_mode: VectorKind::Sync,
                    ..spec
                },
                None,
            )),
        }
    }
}
