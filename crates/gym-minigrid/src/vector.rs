//! Native vectors: environments of one type, without the cost of erased ones.

use gym_core::registry::{VectorKind, find};
use gym_core::vector::{BoxVector, SyncVectorEnv, VectorEnv, VectorSpec};
use gym_core::{Arguments, Error, Result, arguments};

use crate::{GridEnv, Level};

/// A vector of grids.
struct Grids {
    envs: SyncVectorEnv<GridEnv>,
    spec: VectorSpec,
}

impl gym_core::VectorWrapper for Grids {
    fn inner(&self) -> &dyn VectorEnv {
        &self.envs
    }

    fn inner_mut(&mut self) -> &mut dyn VectorEnv {
        &mut self.envs
    }

    fn on_spec(&self) -> Option<VectorSpec> {
        Some(self.spec.clone())
    }

    fn on_describe(&self) -> String {
        format!(
            "NativeVectorEnv({}, num_envs={})",
            self.spec.env.id, self.spec.num_envs
        )
    }
}

/// Makes a native vector from its spec.
///
/// # Errors
/// [`Error::InvalidArgument`] for arguments that the level does not take, and for what only sync
/// and async vectors have.
pub(crate) fn entry_point<L: Level + Arguments>(spec: &VectorSpec) -> Result<BoxVector> {
    let whose = format!("`{}`", spec.env.id);
    let version = find(&spec.env.id)?.rules();
    let level: L = arguments::read(&L::default(), version, &spec.env.kwargs, &whose)?;
    vector(GridEnv::new(level)?, spec)
}

fn vector(env: GridEnv, spec: &VectorSpec) -> Result<BoxVector> {
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
    let envs = SyncVectorEnv::new(vec![env; spec.num_envs])?.with_autoreset(spec.autoreset_mode);
    let mut spec = spec.clone();
    spec.vectorization_mode = VectorKind::Native;
    Ok(Box::new(Grids { envs, spec }))
}
