//! The result of a training: a policy in a small file that can be played without this crate.

use std::path::Path;

use anyhow::{Context, Result};
use gym::render::file;
use gym::wrappers::{NormalizeObservation, RunningMeanStd};
use gym::{BoxVector, EnvSpec, Generator};
use serde::{Deserialize, Serialize};

use crate::agent::Agent;
use crate::numbers::Numbers;
use crate::store::Checkpoint;

/// A trained policy, without the state for further training.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Policy {
    /// The environment of the training.
    pub(crate) env: EnvSpec,
    /// The statistics of the observations, if the training normalized them.
    pub(crate) normalization: Option<RunningMeanStd>,
    /// Weights, `[inputs, outputs]`, and bias of each layer of the policy network.
    pub(crate) network: Vec<Numbers>,
}

impl Policy {
    /// Extracts the policy of `checkpoint`.
    pub(crate) fn of(checkpoint: &Checkpoint) -> Result<Self> {
        let mut vector = checkpoint.spec.make()?;
        vector.restore(&checkpoint.envs)?;
        let normalization = vector
            .layer::<NormalizeObservation<BoxVector>>()
            .map(|wrapper| wrapper.statistics().clone());
        let (observation, action) = (
            vector.single_observation_space(),
            vector.single_action_space(),
        );
        let count = Agent::new(&observation, &action, &mut Generator::from(0))?.policy_variables();
        let network = checkpoint
            .agent
            .variables
            .iter()
            .take(count)
            .cloned()
            .collect();
        Ok(Self {
            env: checkpoint.spec.env.clone(),
            normalization,
            network,
        })
    }

    /// Reads the policy of the checkpoint in the folder `path`, or the policy file `path`.
    pub(crate) fn find(path: &Path) -> Result<Self> {
        if path.is_dir() || !path.exists() {
            let checkpoint = Checkpoint::find(path)?;
            return Self::of(
                &checkpoint.with_context(|| format!("{}: no checkpoint", path.display()))?,
            );
        }
        let text =
            gym::file::read_text(path, usize::MAX).with_context(|| path.display().to_string())?;
        serde_json::from_str(&text).with_context(|| path.display().to_string())
    }

    /// Writes the policy to `path`, one line per layer.
    pub(crate) fn write(&self, path: &Path) -> Result<()> {
        let lines: Vec<String> = self
            .network
            .iter()
            .map(serde_json::to_string)
            .collect::<Result<_, _>>()?;
        let text = format!(
            "{{\"env\": {},\n\"normalization\": {},\n\"network\": [\n{}\n]}}\n",
            serde_json::to_string(&self.env)?,
            serde_json::to_string(&self.normalization)?,
            lines.join(",\n")
        );
        file::write(path, text.as_bytes())?;
        Ok(())
    }
}
