//! Native vectors of registered environments that step in lockstep.

use super::{Configure, find};
use crate::spec::{EnvSpec, VectorSpec, arguments};
use crate::value::Result;
use crate::vector::VectorEnv;
use crate::vector::lockstep::{self, Lockstep};
use crate::wrappers::TimeLimit;

/// Makes a native vector of a registered environment that is [`Lockstep`], for
/// [`Registration::vector_entry_point`](crate::Registration::vector_entry_point). It is a sync
/// vector whose sub-environments step together.
///
/// # Errors
/// [`Error::InvalidArgument`](crate::Error) for arguments that the environment does not take, and
/// as [`SyncVectorEnv::new`].
pub(super) fn entry_point<E: Lockstep + Configure>(
    spec: &VectorSpec,
) -> Result<Box<dyn VectorEnv>> {
    let version = find(&spec.env.id)?.rules();
    let make = |index| -> Result<E> {
        let EnvSpec { id, kwargs, .. } = spec.env_at(index);
        E::configure(
            arguments::read(&E::defaults(version), version, &kwargs, &format!("`{id}`"))?,
            version,
        )
    };
    match spec.env.max_episode_steps {
        Some(limit) => lockstep::native::<E, _>(spec, |index| TimeLimit::new(make(index)?, limit)),
        None => lockstep::native::<E, _>(spec, make),
    }
}
