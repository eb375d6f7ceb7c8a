//! Native vectors of environments of one type, without the cost of erased environments.

use gym_core::registry::{build, find};
use gym_core::vector::{BoxVector, SyncVectorEnv, VectorSpec};
use gym_core::{Arguments, Error, Result};

use crate::{Entry, GridEnv, Level};

/// Makes a native vector from its spec.
///
/// # Errors
/// [`Error::InvalidArgument`] for arguments that the level does not have, and for features that
/// only sync and async vectors have.
pub(crate) fn entry_point<L: Level + Arguments + Clone>(spec: &VectorSpec) -> Result<BoxVector> {
    vector(&build::<Entry<L>>(&spec.env)?, spec)
}

fn vector(env: &GridEnv, spec: &VectorSpec) -> Result<BoxVector> {
    let only = |what: &str| {
        let reason = format!("{what} in a native vector: make a sync or async one");
        Err(Error::argument(format!("`{}`", spec.env.id), reason))
    };
    if !spec.each.is_empty() {
        return only("its arguments cannot differ between environments");
    }
    if spec.env.max_episode_steps.is_some() {
        return only("`max_steps` is the limit of steps, and there is no other");
    }
    let options = find(&spec.env.id)?.reset_options;
    let vector = SyncVectorEnv::native(spec, options, |_| Ok(env.clone()))?;
    Ok(Box::new(vector))
}
