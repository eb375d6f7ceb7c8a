//! Native vectors of registered environments: from a spec to an environment of its own type, and to
//! vectors that step in lockstep.

use super::{Build, Configure, find};
use crate::spec::{EnvSpec, VectorSpec, arguments};
use crate::value::Result;
use crate::vector::VectorEnv;
use crate::vector::lockstep::{self, Lockstep};
use crate::wrappers::TimeLimit;

/// Builds the environment of a spec by its own type, without the wrappers of [`make`](super::make):
/// for the entry point of a native vector.
///
/// # Errors
/// If the id is not registered, and [`Error::InvalidArgument`](crate::Error) for arguments that the
/// environment does not take.
pub fn build<B: Build>(spec: &EnvSpec) -> Result<B::Env> {
    let EnvSpec { id, kwargs, .. } = spec;
    let version = find(id)?.rules();
    let config = arguments::read(&B::defaults(version), version, kwargs, &format!("`{id}`"))?;
    B::build(config, version)
}

/// Makes a native vector of a registered environment that is [`Lockstep`], for
/// [`Registration::vector_entry_point`](crate::Registration::vector_entry_point). The result is a
/// sync vector whose sub-environments step together.
///
/// # Errors
/// [`Error::InvalidArgument`](crate::Error) for arguments that the environment does not take, and
/// as [`SyncVectorEnv::new`](crate::vector::SyncVectorEnv::new).
pub(super) fn entry_point<E: Lockstep + Configure>(
    spec: &VectorSpec,
) -> Result<Box<dyn VectorEnv>> {
    let options = find(&spec.env.id)?.reset_options;
    let make = |index| build::<E>(&spec.env_at(index));
    match spec.env.max_episode_steps {
        Some(limit) => {
            lockstep::native::<E, _>(spec, options, |index| TimeLimit::new(make(index)?, limit))
        }
        None => lockstep::native::<E, _>(spec, options, make),
    }
}
