//! A model that was checked.

use std::ops::Deref;

use serde::{Deserialize, Serialize};

use super::{CompiledModel, Plan};
use crate::Result;

/// A checked [`CompiledModel`], with the engine's precomputed data.
///
/// It dereferences to [`CompiledModel`] for reading. To change fields, call
/// [`change`](Self::change), which checks them and recomputes the fields that depend on them.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(try_from = "CompiledModel", into = "CompiledModel")]
pub struct Model {
    compiled: CompiledModel,
    plan: Plan,
}

impl Model {
    /// Precomputes what the engine needs of a model that was checked.
    pub(crate) fn planned(compiled: CompiledModel) -> Result<Self> {
        let plan = Plan::new(&compiled)?;
        Ok(Self { compiled, plan })
    }

    /// Returns the compiled model. Change its fields, and pass it to [`new`](Self::new).
    #[must_use]
    pub fn into_compiled(self) -> CompiledModel {
        self.compiled
    }

    pub(crate) fn plan(&self) -> &Plan {
        &self.plan
    }
}

impl Deref for Model {
    type Target = CompiledModel;

    fn deref(&self) -> &CompiledModel {
        &self.compiled
    }
}

impl From<Model> for CompiledModel {
    fn from(model: Model) -> Self {
        model.into_compiled()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The compiled model of a reference file, if `GYM_REFERENCE` points to the recordings.
    fn reference(name: &str) -> Option<Model> {
        let root = std::env::var_os("GYM_REFERENCE")?;
        let path = std::path::Path::new(&root)
            .join("models_mujoco")
            .join(name)
            .with_extension("json");
        let text =
            std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
        Some(serde_json::from_str(&text).unwrap_or_else(|e| panic!("{}: {e}", path.display())))
    }

    #[test]
    fn reads_recorded_figures() {
        for name in "inverted_pendulum inverted_double_pendulum reacher pusher pusher_v5 swimmer half_cheetah hopper walker2d \
                     walker2d_v5 ant humanoid humanoidstandup".split_whitespace() {
            let Some(m) = reference(name) else { return };
            assert!(m.nv() > 0, "{name}");
        }
        let Some(m) = reference("humanoid") else {
            return;
        };
        assert_eq!(
            (m.nq(), m.nv(), m.nu(), m.nbody(), m.ntendon()),
            (24, 23, 17, 14, 2)
        );
        assert_eq!(m.body_id("torso"), Some(1));
    }
}
