//! Checkpoints: the complete state that a training needs to continue exactly.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use gym::vector::VectorSpec;
use gym::{Generator, Snapshot};
use serde::{Deserialize, Serialize};

use crate::adam::StoredAdam;
use crate::numbers::Numbers;
use crate::settings::Settings;

/// The state of a training between two updates.
#[derive(Serialize, Deserialize)]
pub(crate) struct Checkpoint {
    pub(crate) seed: u64,
    pub(crate) settings: Settings,
    /// The spec of the vector, wrappers included.
    pub(crate) spec: VectorSpec,
    /// The snapshot of the vector.
    pub(crate) envs: Snapshot,
    /// The observations that the next actions are computed from, one row per environment.
    pub(crate) observations: Numbers,
    pub(crate) agent: StoredAdam,
    pub(crate) rng: Generator,
    pub(crate) steps: u64,
    /// The returns of all episodes so far.
    pub(crate) returns: Vec<f64>,
}

impl Checkpoint {
    fn path(folder: &Path) -> PathBuf {
        folder.join("checkpoint.json")
    }

    /// Reads the checkpoint in `folder`, if there is one.
    pub(crate) fn find(folder: &Path) -> Result<Option<Self>> {
        let path = Self::path(folder);
        if !path.exists() {
            return Ok(None);
        }
        let text =
            gym::file::read_text(&path, usize::MAX).with_context(|| path.display().to_string())?;
        serde_json::from_str(&text)
            .map(Some)
            .with_context(|| path.display().to_string())
    }

    /// Replaces the checkpoint in `folder` atomically.
    pub(crate) fn write(&self, folder: &Path) -> Result<()> {
        std::fs::create_dir_all(folder).with_context(|| folder.display().to_string())?;
        gym::render::file::write(Self::path(folder), &serde_json::to_vec(self)?)?;
        Ok(())
    }
}
