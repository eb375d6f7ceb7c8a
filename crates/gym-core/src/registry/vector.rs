//! From an id to a vector of environments.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

use super::{EnvBuilder, EnvSpec, builder, find};
use crate::vector::{AsyncVectorEnv, Autoreset, SyncVectorEnv, VectorEnv};
use crate::{BoxEnv, Error, Result};

/// Makes a vector of `num_envs` environments, as Gymnasium's `make_vec`.
///
/// Without a kind it is native where the id has a native vector, and sync otherwise; see
/// [`VectorBuilder::kind`]. Each sub-environment has the stack of [`make`](crate::make), time limit
/// included.
///
/// # Errors
/// As [`make`](crate::make); [`Error::InvalidArgument`] for no environments or a kind that the id does
/// not have.
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

/// How a vector steps its sub-environments.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum VectorKind {
    /// One after the other: [`SyncVectorEnv`].
    Sync,
    /// On a pool of threads: [`AsyncVectorEnv`].
    Async,
    /// All in one, by a kernel of the environment's own: what Gymnasium calls a vector entry point.
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
        Self::ALL.into_iter().find(|kind| kind.name() == text).ok_or_else(|| {
            let names = Self::ALL.map(Self::name).join(", ");
            Error::argument("kind", format!("unknown kind of vector `{text}`: the kinds are {names}"))
        })
    }
}

/// Everything needed to make a vector again: that of its sub-environments, and its own options.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct VectorSpec {
    /// How each sub-environment is made.
    #[serde(flatten)]
    pub env: EnvSpec,
    /// How many there are.
    pub num_envs: usize,
    /// How they are stepped.
    pub vectorization_mode: VectorKind,
    /// When they are reset.
    #[serde(default)]
    pub autoreset_mode: Autoreset,
    /// On how many threads, where async; `None` for one per core.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub threads: Option<usize>,
}

impl VectorSpec {
    /// Makes the vector.
    ///
    /// # Errors
    /// As [`make_vec`].
    pub fn make(&self) -> Result<Box<dyn VectorEnv>> {
        let Self { env, num_envs, autoreset_mode, threads, .. } = self.clone();
        match self.vectorization_mode {
            VectorKind::Sync => {
                let vector = SyncVectorEnv::new(envs(&env, num_envs)?)?;
                Ok(Box::new(vector.with_autoreset(autoreset_mode).with_spec(self.clone())))
            }
            VectorKind::Async => {
                let vector = AsyncVectorEnv::new(envs(&env, num_envs)?)?;
                let vector = match threads {
                    Some(threads) => vector.with_threads(threads)?,
                    None => vector,
                };
                Ok(Box::new(vector.with_autoreset(autoreset_mode).with_spec(self.clone())))
            }
            VectorKind::Native => {
                let refuse =
                    |reason: &str| Err(Error::argument(format!("a native vector of `{}`", env.id), reason));
                let Some(entry_point) = find(&env.id)?.native_vector() else {
                    return refuse("this id has none: its kinds are sync and async");
                };
                match native_obstacle(&env) {
                    Some(reason) => refuse(reason),
                    None if num_envs == 0 => refuse("there are no sub-environments: at least one is needed"),
                    None => entry_point(&env, num_envs, autoreset_mode),
                }
            }
        }
    }
}

fn envs(spec: &EnvSpec, n: usize) -> Result<Vec<BoxEnv>> {
    (0..n).map(|_| spec.make()).collect()
}

/// What a spec asks for that only environments can give.
fn native_obstacle(spec: &EnvSpec) -> Option<&'static str> {
    if !spec.additional_wrappers.is_empty() {
        Some("it has no single environments to wrap: wrap the vector, or make a sync or async one")
    } else if spec.render_mode.is_some() {
        Some("it draws nothing: make a sync or async one")
    } else {
        None
    }
}

impl EnvBuilder {
    /// Goes on to a vector of `num_envs` environments, each made with these options.
    ///
    /// ```text
    /// let envs = gym::builder("FrozenLake-v1").arg("map_name", "8x8").vector(64).build()?;
    /// ```
    pub fn vector(self, num_envs: usize) -> VectorBuilder {
        VectorBuilder { env: self, num_envs, kind: None, autoreset: Autoreset::default(), threads: None }
    }
}

/// Options for making a vector; see [`EnvBuilder::vector`].
#[derive(Clone, Debug)]
pub struct VectorBuilder {
    env: EnvBuilder,
    num_envs: usize,
    kind: Option<VectorKind>,
    autoreset: Autoreset,
    threads: Option<usize>,
}

impl VectorBuilder {
    /// How the sub-environments are stepped. Where this is not said, the vector is native if the id has a
    /// native vector and neither wrappers nor a render mode are wanted, and else sync.
    #[must_use]
    pub fn kind(self, kind: VectorKind) -> Self {
        Self { kind: Some(kind), ..self }
    }

    /// When sub-environments are reset; on the next step where this is not said.
    #[must_use]
    pub fn autoreset(self, autoreset: Autoreset) -> Self {
        Self { autoreset, ..self }
    }

    /// The number of threads of an async vector, instead of one per core.
    #[must_use]
    pub fn threads(self, threads: usize) -> Self {
        Self { threads: Some(threads), ..self }
    }

    /// The spec that all options together make.
    ///
    /// # Errors
    /// As [`EnvBuilder::spec`].
    pub fn spec(self) -> Result<VectorSpec> {
        let Self { env, num_envs, kind, autoreset, threads } = self;
        let env = env.spec()?;
        let has_native = || Ok::<_, Error>(find(&env.id)?.native_vector().is_some());
        let vectorization_mode = match kind {
            Some(kind) => kind,
            None if native_obstacle(&env).is_none() && has_native()? => VectorKind::Native,
            None => VectorKind::Sync,
        };
        Ok(VectorSpec { env, num_envs, vectorization_mode, autoreset_mode: autoreset, threads })
    }

    /// Makes the vector.
    ///
    /// # Errors
    /// As [`make_vec`].
    pub fn build(self) -> Result<Box<dyn VectorEnv>> {
        self.spec()?.make()
    }
}
