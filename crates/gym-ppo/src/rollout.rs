//! Rollouts: several steps of every environment under one policy, and their advantages.

use std::time::{Duration, Instant};

use candle_core::{Device, Tensor};
use gym::vector::{Columns, VectorEnv, VectorEnvExt};
use gym::{Array, DType, Generator, Value};

use crate::agent::{Agent, Sample, tensor};
use crate::batch::Batch;
use crate::numbers::Numbers;
use crate::settings::Settings;

/// The columns of consecutive steps, into which the environments write. Row 0 holds the
/// observations before the first actions; row `t + 1` holds the results of the actions of row
/// `t`.
pub(crate) struct Rollout {
    columns: Vec<Columns>,
    actions: Vec<Value>,
    values: Vec<Vec<f32>>,
    log_probabilities: Vec<Vec<f32>>,
    /// Time spent in the environments.
    pub(crate) env_time: Duration,
}

impl Rollout {
    /// Allocates columns for `steps` steps of `envs`.
    pub(crate) fn new(envs: &dyn VectorEnv, steps: usize) -> gym::Result<Self> {
        Ok(Self {
            columns: (0..=steps)
                .map(|_| envs.columns())
                .collect::<gym::Result<_>>()?,
            actions: vec![Value::Null; steps],
            values: vec![Vec::new(); steps + 1],
            log_probabilities: vec![Vec::new(); steps],
            env_time: Duration::ZERO,
        })
    }

    /// Resets the environments.
    pub(crate) fn reset(&mut self, envs: &mut dyn VectorEnv, seed: u64) -> gym::Result<()> {
        envs.reset_into(&seed.into(), self.last_columns())
    }

    /// Returns the columns that the next rollout begins with.
    fn last_columns(&mut self) -> &mut Columns {
        let last = self.actions.len();
        &mut self.columns[last]
    }

    /// Returns the observations that the next actions are computed from.
    pub(crate) fn observations(&mut self) -> Numbers {
        let numbers = self
            .last_columns()
            .observations
            .as_array()
            .map(Array::iter_f64);
        numbers.into_iter().flatten().map(|x| x as f32).collect()
    }

    /// Replaces the current observations by the observations of a checkpoint.
    pub(crate) fn set_observations(&mut self, numbers: &[f32]) -> anyhow::Result<()> {
        let Value::Array(array) = &mut self.last_columns().observations else {
            anyhow::bail!("this example needs arrays for observations");
        };
        *array = match array.dtype() {
            DType::U8 => Array::from(numbers.iter().map(|x| *x as u8).collect::<Vec<_>>()),
            _ => Array::from(numbers.to_vec()),
        }
        .reshape(array.shape())?;
        Ok(())
    }

    /// Steps `envs` with actions sampled from the agent's policy, and calls `each` with the columns
    /// of each step.
    pub(crate) fn collect(
        &mut self,
        envs: &mut dyn VectorEnv,
        agent: &Agent,
        rng: &mut Generator,
        mut each: impl FnMut(&dyn VectorEnv),
    ) -> anyhow::Result<()> {
        let steps = self.actions.len();
        // the last row of the last rollout becomes row 0
        self.columns.swap(0, steps);
        for t in 0..steps {
            let Sample {
                actions,
                log_probabilities,
                values,
            } = agent.sample(&tensor(&self.columns[t].observations)?, rng)?;
            (self.actions[t], self.log_probabilities[t], self.values[t]) =
                (actions, log_probabilities, values);

            let started = Instant::now();
            envs.step_into(&self.actions[t], &mut self.columns[t + 1])?;
            self.env_time += started.elapsed();
            each(envs);
        }
        self.values[steps] = agent
            .values(&tensor(&self.columns[steps].observations)?)?
            .to_vec1()?;
        Ok(())
    }

    /// Returns the transitions with their advantages: generalized advantage estimation, equation 16
    /// of Schulman et al. (2016).
    ///
    /// The estimate bootstraps a truncated episode with the value of its last observation, and does
    /// not bootstrap a terminated episode.
    pub(crate) fn batch(&self, agent: &Agent, settings: &Settings) -> anyhow::Result<Batch> {
        let (steps, n) = (self.actions.len(), self.values[0].len());
        let mut advantages = vec![vec![0f32; n]; steps];
        let mut carried = vec![0f32; n];
        for t in (0..steps).rev() {
            let Columns {
                rewards,
                terminated,
                truncated,
                final_observations,
                ..
            } = &self.columns[t + 1];
            let cut_off = (0..n).any(|i| truncated[i] && !terminated[i]);
            let last = if cut_off {
                agent.values(&tensor(final_observations)?)?.to_vec1()?
            } else {
                vec![]
            };
            for i in 0..n {
                let next = match (terminated[i], truncated[i]) {
                    (true, _) => 0.0,
                    (false, true) => last[i],
                    (false, false) => self.values[t + 1][i],
                };
                let error = rewards[i] as f32 + settings.discount * next - self.values[t][i];
                let ended = terminated[i] || truncated[i];
                let rest = if ended {
                    0.0
                } else {
                    settings.discount * settings.gae_lambda * carried[i]
                };
                carried[i] = error + rest;
                advantages[t][i] = carried[i];
            }
        }
        let rows = |rows: &[Vec<f32>]| Tensor::new(rows.concat(), &Device::Cpu);
        let advantages = rows(&advantages)?;
        let returns = (&advantages + rows(&self.values[..steps])?)?;
        let observations = self.columns[..steps]
            .iter()
            .map(|columns| tensor(&columns.observations));
        let observations = observations.collect::<candle_core::Result<Vec<_>>>()?;
        let actions = self
            .actions
            .iter()
            .map(tensor)
            .collect::<candle_core::Result<Vec<_>>>()?;
        Ok(Batch {
            observations: Tensor::cat(&observations, 0)?,
            actions: Tensor::cat(&actions, 0)?,
            log_probabilities: rows(&self.log_probabilities)?,
            advantages,
            returns,
        })
    }
}
