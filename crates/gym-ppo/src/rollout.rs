//! Experience: some steps of every environment under one policy, and what they were worth.

use std::iter::zip;
use std::time::{Duration, Instant};

use candle_core::{Device, Tensor};
use gym::vector::{Columns, VectorEnv};
use gym::{Array, Generator, Value};

use crate::Settings;
use crate::agent::Agent;

/// The columns of consecutive steps. The environments write straight into them: row 0 holds the
/// observations that the first actions answer, row `t + 1` what came of the actions `t`.
pub(crate) struct Rollout {
    columns: Vec<Columns>,
    actions: Vec<Value>,
    values: Vec<Vec<f32>>,
    log_probabilities: Vec<Vec<f32>>,
    /// Time spent in the environments.
    pub(crate) env_time: Duration,
}

/// Transitions in rows, shuffled or not.
pub(crate) struct Batch {
    pub(crate) observations: Tensor,
    pub(crate) actions: Tensor,
    pub(crate) log_probabilities: Tensor,
    pub(crate) advantages: Tensor,
    /// Advantage and value: what the value network should have said.
    pub(crate) returns: Tensor,
}

impl Batch {
    pub(crate) fn len(&self) -> usize {
        self.actions.elem_count()
    }

    pub(crate) fn select(&self, indices: &Tensor) -> candle_core::Result<Self> {
        let select = |tensor: &Tensor| tensor.index_select(indices, 0);
        Ok(Self {
            observations: select(&self.observations)?,
            actions: select(&self.actions)?,
            log_probabilities: select(&self.log_probabilities)?,
            advantages: select(&self.advantages)?,
            returns: select(&self.returns)?,
        })
    }
}

impl Rollout {
    /// Resets the environments and makes room for `steps` steps.
    pub(crate) fn new(envs: &mut impl VectorEnv, steps: usize, seed: u64) -> gym::Result<Self> {
        let mut columns: Vec<Columns> = (0..=steps).map(|_| envs.columns()).collect::<gym::Result<_>>()?;
        envs.reset_into(&seed.into(), &mut columns[0])?;
        Ok(Self {
            columns,
            actions: vec![Value::Null; steps],
            values: vec![Vec::new(); steps + 1],
            log_probabilities: vec![Vec::new(); steps],
            env_time: Duration::ZERO,
        })
    }

    /// Steps the environments on, with actions drawn from the agent's policy, and shows `each` the
    /// columns after each step.
    pub(crate) fn collect(
        &mut self,
        envs: &mut impl VectorEnv,
        agent: &Agent,
        rng: &mut Generator,
        mut each: impl FnMut(&Columns),
    ) -> anyhow::Result<()> {
        let steps = self.actions.len();
        if self.values[0].len() == envs.num_envs() {
            // go on from where the last rollout ended
            self.columns.swap(0, steps);
        }
        for t in 0..steps {
            let observations = matrix(&self.columns[t].observations)?;
            let log_probabilities = agent.log_probabilities(&observations)?.to_vec2::<f32>()?;
            let drawn: Vec<usize> = log_probabilities.iter().map(|row| sample(row, rng)).collect();
            self.log_probabilities[t] =
                zip(&log_probabilities, &drawn).map(|(row, action)| row[*action]).collect();
            let drawn: Vec<i64> = drawn.iter().map(|action| *action as i64).collect();
            self.actions[t] = Value::Array(Array::from(drawn));
            self.values[t] = agent.values(&observations)?.to_vec1()?;

            let started = Instant::now();
            envs.step_into(&self.actions[t], &mut self.columns[t + 1])?;
            self.env_time += started.elapsed();
            each(&self.columns[t + 1]);
        }
        self.values[steps] = agent.values(&matrix(&self.columns[steps].observations)?)?.to_vec1()?;
        Ok(())
    }

    /// The transitions with their advantages: generalized advantage estimation, Schulman et al.
    /// (2016), equation 16.
    ///
    /// An episode that was cut off goes on in the estimate with the value of its last observation; one
    /// that the task ended does not.
    pub(crate) fn batch(&self, agent: &Agent, settings: &Settings) -> anyhow::Result<Batch> {
        let (steps, n) = (self.actions.len(), self.values[0].len());
        let mut advantages = vec![vec![0f32; n]; steps];
        let mut carried = vec![0f32; n];
        for t in (0..steps).rev() {
            let Columns { rewards, terminated, truncated, final_observations, .. } = &self.columns[t + 1];
            let cut_off = (0..n).any(|i| truncated[i] && !terminated[i]);
            let last = if cut_off { agent.values(&matrix(final_observations)?)?.to_vec1()? } else { vec![] };
            for i in 0..n {
                let next = match (terminated[i], truncated[i]) {
                    (true, _) => 0.0,
                    (false, true) => last[i],
                    (false, false) => self.values[t + 1][i],
                };
                let error = rewards[i] as f32 + settings.discount * next - self.values[t][i];
                let ended = terminated[i] || truncated[i];
                let rest = if ended { 0.0 } else { settings.discount * settings.gae_lambda * carried[i] };
                carried[i] = error + rest;
                advantages[t][i] = carried[i];
            }
        }
        let rows = |rows: &[Vec<f32>]| Tensor::new(rows.concat(), &Device::Cpu);
        let advantages = rows(&advantages)?;
        let returns = (&advantages + rows(&self.values[..steps])?)?;
        let observations = self.columns[..steps].iter().map(|columns| matrix(&columns.observations));
        let actions = self.actions.iter().filter_map(Value::as_slice::<i64>).collect::<Vec<_>>().concat();
        Ok(Batch {
            observations: Tensor::cat(&observations.collect::<anyhow::Result<Vec<_>>>()?, 0)?,
            actions: Tensor::new(actions, &Device::Cpu)?,
            log_probabilities: rows(&self.log_probabilities)?,
            advantages,
            returns,
        })
    }
}

/// A column of observations as a matrix, a row per environment.
fn matrix(observations: &Value) -> anyhow::Result<Tensor> {
    let array = observations.as_array().and_then(|array| Some((array.as_slice::<f32>()?, array.shape())));
    match array {
        Some((numbers, &[n, width])) => Ok(Tensor::from_slice(numbers, (n, width), &Device::Cpu)?),
        _ => anyhow::bail!("this example needs rows of float32 numbers for observations"),
    }
}

/// Draws an index by the logarithms of its probabilities.
fn sample(log_probabilities: &[f32], rng: &mut Generator) -> usize {
    let draw = rng.random() as f32;
    let mut sum = 0.0;
    let below = |log_probability: &&f32| {
        sum += log_probability.exp();
        sum <= draw
    };
    log_probabilities.iter().take_while(below).count().min(log_probabilities.len() - 1)
}
