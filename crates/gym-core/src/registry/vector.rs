//! From an id to a vector of environments.

use super::registration::NATIVE_VECTORS;
use super::{EnvBuilder, builder, find};
use crate::env::BoxEnv;
use crate::spec::{Autoreset, Each, EnvSpec, VectorKind, VectorSpec};
use crate::value::{Error, Result};
use crate::vector::{AsyncVectorEnv, SyncVectorEnv, VectorEnv, slot};

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

impl VectorSpec {
    /// Makes the sub-environments, for your own kind of vector.
    ///
    /// # Errors
    /// The errors of [`EnvSpec::make`]; [`Error::InvalidArgument`] if the environments do not fit
    /// in memory, estimated from the first one.
    pub fn envs(&self) -> Result<Vec<BoxEnv>> {
        slot::make_envs(self, ENV_BYTES, |index| self.env_at(index).make())
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
        if self.affinity.is_some() && self.vectorization_mode != VectorKind::Async {
            let reason =
                "affinity binds threads, which only an async vector has: choose kind async";
            return Err(Error::argument("a vector", reason));
        }
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
                    let reason = if NATIVE_VECTORS {
                        "there is none for this id: use kind sync or async"
                    } else {
                        "this program was built without the feature `native-vectors`: use kind sync or async"
                    };
                    return refuse(reason);
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
        // (a wrapper may change an action after the group has begun the step with it)
        let lockstep = find(&self.env.id)?
            .slot_group()
            .filter(|_| self.env.additional_wrappers.is_empty());
        if let Some(lockstep) = lockstep {
            vector = vector.in_lockstep(lockstep)?;
        }
        if let Some(threads) = self.threads {
            vector = vector.with_threads(threads)?;
        }
        if let Some(first) = self.affinity {
            vector = vector.with_affinity(first)?;
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

/// Returns an option of the spec that native vectors do not support, if there is one.
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
    fn change(mut self, change: impl FnOnce(&mut VectorSpec)) -> Self {
        if let Ok(spec) = &mut self.spec {
            change(spec);
        }
        self
    }

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
    pub fn arg_each(self, name: &str, each: impl Into<Each>) -> Self {
        self.change(|spec| {
            spec.each.insert(name.to_owned(), each.into());
        })
    }

    /// The kind of vector. The default is native if the id has a native vector that supports the
    /// options, else sync. Native vectors do not support wrappers of environments, a render mode, a
    /// time limit above 65534 steps, or arguments that only scalar environments have.
    #[must_use]
    pub fn kind(mut self, kind: VectorKind) -> Self {
        self.has_kind = true;
        self.change(|spec| spec.vectorization_mode = kind)
    }

    /// When sub-environments are reset; the default is the next step.
    #[must_use]
    pub fn autoreset(self, autoreset: Autoreset) -> Self {
        self.change(|spec| spec.autoreset_mode = autoreset)
    }

    /// The number of threads of an async vector; the default is one per core.
    #[must_use]
    pub fn threads(self, threads: usize) -> Self {
        self.change(|spec| spec.threads = Some(threads))
    }

    /// Binds the threads of an async vector to cores: the first one to core `first` of those that
    /// the program may use, the second one to the next, and so on, around the end. The default lets
    /// the operating system choose. Other kinds refuse it.
    #[must_use]
    pub fn affinity(self, first: usize) -> Self {
        self.change(|spec| spec.affinity = Some(first))
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
    ///
    /// # Errors
    /// The errors of [`EnvBuilder::spec`].
    pub fn resolve(self) -> Result<(VectorSpec, Option<Box<dyn VectorEnv>>)> {
        let spec = self.spec?;
        if self.has_kind {
            return Ok((spec, None));
        }
        // a native vector returns an error for unsupported options; a sync vector may support these
        // options, or returns its own error
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
