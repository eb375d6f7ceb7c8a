//! The agent: its networks, the action distribution that their outputs describe, and the update.

use std::f64::consts::{E, PI};
use std::iter::zip;
use std::num::NonZero;
use std::thread::available_parallelism;

use anyhow::bail;
use candle_core::{D, DType, Device, Tensor, Var, backprop::GradStore};
use candle_nn::ops::log_softmax;
use gym::{Array, Generator, Space, Value};
use rayon::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::adam::{Adam, StoredAdam};
use crate::batch::Batch;
use crate::network::Network;
use crate::numbers::Numbers;
use crate::settings::Settings;

type Result<T> = candle_core::Result<T>;

/// The coefficient of the value loss, as in CleanRL.
const VALUE_COEFFICIENT: f64 = 0.5;
/// The largest norm of the gradients; larger gradients are scaled down to it.
const MAX_GRADIENT_NORM: f64 = 0.5;

/// The networks and the optimizer's state.
pub(crate) struct Agent {
    network: Network,
    head: Head,
    optimizer: Adam,
    /// The threads that compute the gradients of a batch, each for a part of the batch.
    threads: ThreadPool,
}

/// A batch of actions, their log-probabilities, and the values of the observations.
pub(crate) struct Sample {
    pub(crate) actions: Value,
    pub(crate) log_probabilities: Vec<f32>,
    pub(crate) values: Vec<f32>,
}

/// The distribution that the policy network's outputs describe.
enum Head {
    /// The outputs are the logits of the actions.
    Discrete,
    /// The outputs are the mean of a normal distribution. The logarithm of its standard deviation,
    /// `log_std`, does not depend on the state. The environments take actions of `dtype`.
    Gaussian { log_std: Var, dtype: gym::DType },
}

impl Agent {
    /// Returns an agent for environments with the spaces `observation` and `action`.
    pub(crate) fn new(
        observation: &Space,
        action: &Space,
        rng: &mut Generator,
    ) -> anyhow::Result<Self> {
        let (outputs, head) = match action {
            Space::Discrete(space) => (space.n() as usize, Head::Discrete),
            Space::Box(space) if is_float(space.dtype()) && space.shape().len() == 1 => {
                let log_std = Var::zeros(space.shape()[0], DType::F32, &Device::Cpu)?;
                let dtype = space.dtype();
                (space.shape()[0], Head::Gaussian { log_std, dtype })
            }
            other => {
                bail!(
                    "the actions are {other}: this example needs a Discrete or a row of float32 or float64 numbers"
                )
            }
        };
        let network = Network::new(observation, outputs, rng)?;
        let mut variables: Vec<Var> = network.variables().cloned().collect();
        if let Head::Gaussian { log_std, .. } = &head {
            variables.push(log_std.clone());
        }
        // one thread for each core: candle's own thread count is for a single matrix product
        let cores = available_parallelism().map_or(1, NonZero::get);
        let threads = ThreadPoolBuilder::new().num_threads(if network.portion().is_some() {
            cores
        } else {
            1
        });
        Ok(Self {
            network,
            head,
            optimizer: Adam::new(variables)?,
            threads: threads.build()?,
        })
    }

    pub(crate) fn store(&self) -> Result<StoredAdam> {
        self.optimizer.store()
    }

    /// Continues from `stored`, the state of an agent for the same spaces.
    pub(crate) fn restore(&mut self, stored: &StoredAdam) -> anyhow::Result<()> {
        self.optimizer.restore(stored)
    }

    /// Returns the number of variables that belong to the policy. These are the first variables of
    /// the optimizer.
    pub(crate) fn policy_variables(&self) -> usize {
        self.network.policy_variables().count()
    }

    /// Replaces the policy by `network`, the policy of an agent for the same spaces.
    pub(crate) fn set_policy(&mut self, network: &[Numbers]) -> anyhow::Result<()> {
        self.network.set_policy(network)
    }

    /// Draws an action for each observation. The sample also has the log-probabilities of the
    /// actions and the values of the observations.
    pub(crate) fn sample(&self, observations: &Tensor, rng: &mut Generator) -> Result<Sample> {
        let (outputs, values) = self.network.forward(observations)?;
        let actions = match &self.head {
            Head::Discrete => {
                let rows = log_softmax(&outputs, D::Minus1)?.to_vec2::<f32>()?;
                let drawn: Vec<i64> = rows.iter().map(|row| choose(row, rng) as i64).collect();
                Value::Array(drawn.into())
            }
            Head::Gaussian { log_std, dtype } => {
                let std = log_std.exp()?.to_vec1::<f32>()?;
                let rows = outputs.to_vec2::<f32>()?;
                let drawn = rows
                    .iter()
                    .flat_map(|row| zip(row, &std))
                    .map(|(mean, std)| {
                        let noise = rng.standard_normal() as f32;
                        mean + std * noise
                    });
                matrix_value(drawn.collect(), &[rows.len(), std.len()], *dtype)
            }
        };
        let (log_probabilities, _) = self.judge(&outputs, &tensor(&actions)?)?;
        Ok(Sample {
            actions,
            log_probabilities: log_probabilities.to_vec1()?,
            values: values.to_vec1()?,
        })
    }

    /// Returns a batch with the most likely action for each observation.
    pub(crate) fn best(&self, observations: &Tensor) -> Result<Value> {
        let outputs = self.network.policy(observations)?;
        Ok(match &self.head {
            Head::Discrete => {
                let best = outputs.argmax(D::Minus1)?.to_vec1::<u32>()?;
                Value::Array(best.into_iter().map(i64::from).collect::<Vec<_>>().into())
            }
            Head::Gaussian { dtype, .. } => {
                let (rows, width) = outputs.dims2()?;
                matrix_value(outputs.flatten_all()?.to_vec1()?, &[rows, width], *dtype)
            }
        })
    }

    /// Returns the log-probability of each action of `actions` and the mean entropy of the policy
    /// with the outputs `outputs`.
    fn judge(&self, outputs: &Tensor, actions: &Tensor) -> Result<(Tensor, Tensor)> {
        match &self.head {
            Head::Discrete => {
                let all = log_softmax(outputs, D::Minus1)?;
                let chosen = all.gather(&actions.unsqueeze(1)?, 1)?.squeeze(1)?;
                Ok((
                    chosen,
                    (all.exp()? * &all)?.sum(D::Minus1)?.mean_all()?.neg()?,
                ))
            }
            Head::Gaussian { log_std, .. } => {
                let log_std = log_std.as_tensor();
                let distance = (actions - outputs)?.broadcast_div(&log_std.exp()?)?;
                let density = (distance.sqr()? * -0.5)?.broadcast_sub(log_std)?;
                let density = (density - 0.5 * (2.0 * PI).ln())?;
                let entropy = (log_std + 0.5 * (2.0 * PI * E).ln())?.sum_all()?;
                Ok((density.sum(D::Minus1)?, entropy))
            }
        }
    }

    /// Returns the value of each observation.
    pub(crate) fn values(&self, observations: &Tensor) -> Result<Tensor> {
        self.network.values(observations)
    }

    /// Learns from `batch`, in several epochs over shuffled minibatches. The learning rate falls
    /// linearly with `progress`, the trained fraction of the whole training.
    pub(crate) fn learn(
        &mut self,
        batch: &Batch,
        settings: &Settings,
        progress: f64,
        rng: &mut Generator,
    ) -> Result<()> {
        let learning_rate = settings.learning_rate * (1.0 - progress).max(0.05);
        let mut order: Vec<u32> = (0..batch.len() as u32).collect();
        for _ in 0..settings.epochs {
            rng.shuffle(&mut order);
            for indices in order.chunks(settings.minibatch) {
                let indices = Tensor::from_slice(indices, indices.len(), &Device::Cpu)?;
                let minibatch = batch.select(&indices)?;
                let minibatch = Batch {
                    advantages: normalized(&minibatch.advantages)?,
                    ..minibatch
                };
                let mut gradients = self.gradients(&minibatch, settings)?;
                self.clip(&mut gradients)?;
                self.optimizer.step(&gradients, learning_rate)?;
            }
        }
        Ok(())
    }

    /// Returns the gradients of the loss, summed over portions of `batch` that the threads share.
    /// Portions and the order of the sum do not depend on the number of threads.
    fn gradients(&self, batch: &Batch, settings: &Settings) -> Result<GradStore> {
        let len = batch.len();
        let portion = self.network.portion().unwrap_or(len);
        if len <= portion {
            return self
                .network
                .gradients(&batch.observations, |outputs, values| {
                    self.loss(batch, outputs, values, settings)
                });
        }
        let starts: Vec<usize> = (0..len).step_by(portion).collect();
        let portion_gradients = |start| {
            let batch = batch.narrow(start, portion.min(len - start))?;
            let share = batch.len() as f64 / len as f64;
            self.network
                .gradients(&batch.observations, |outputs, values| {
                    self.loss(&batch, outputs, values, settings)? * share
                })
        };
        let portions = || {
            starts
                .into_par_iter()
                .map(portion_gradients)
                .collect::<Result<Vec<_>>>()
        };
        let mut portions = self.threads.install(portions)?.into_iter();
        let mut sum = portions.next().expect("a batch is not empty");
        for gradients in portions {
            for variable in &self.optimizer.variables {
                if let (Some(one), Some(other)) = (sum.remove(variable), gradients.get(variable)) {
                    sum.insert(variable, (one + other)?);
                }
            }
        }
        Ok(sum)
    }

    /// Returns the loss of PPO: the negative of equation 9 of Schulman et al. (2017), with the
    /// advantages normalized over the batch.
    fn loss(
        &self,
        batch: &Batch,
        outputs: &Tensor,
        values: &Tensor,
        settings: &Settings,
    ) -> Result<Tensor> {
        let (chosen, entropy) = self.judge(outputs, &batch.actions)?;
        let ratio = (chosen - &batch.log_probabilities)?.exp()?;
        let clipped = ratio.clamp(1.0 - settings.clip, 1.0 + settings.clip)?;
        let surrogate = (ratio * &batch.advantages)?
            .minimum(&(clipped * &batch.advantages)?)?
            .mean_all()?;
        let value_loss = (values - &batch.returns)?.sqr()?.mean_all()?;
        (value_loss * VALUE_COEFFICIENT)? - surrogate - (entropy * settings.entropy_coefficient)?
    }

    fn clip(&self, gradients: &mut GradStore) -> Result<()> {
        let variables = &self.optimizer.variables;
        let mut sum = 0.0;
        for variable in variables {
            if let Some(gradient) = gradients.get(variable) {
                sum += f64::from(gradient.sqr()?.sum_all()?.to_scalar::<f32>()?);
            }
        }
        let scale = MAX_GRADIENT_NORM / (sum.sqrt() + 1e-6);
        if scale < 1.0 {
            for variable in variables {
                if let Some(gradient) = gradients.remove(variable) {
                    gradients.insert(variable, (gradient * scale)?);
                }
            }
        }
        Ok(())
    }
}

/// Returns a tensor with the shape and numbers of `value`. Converts float64 to float32, in which
/// the networks compute.
pub(crate) fn tensor(value: &Value) -> Result<Tensor> {
    let refuse = || {
        candle_core::Error::Msg(format!(
            "{value} is not an array of float32, float64, int64 or uint8 numbers"
        ))
    };
    let array = value.as_array().ok_or_else(refuse)?;
    let shape = array.shape();
    if let Some(numbers) = array.as_slice::<f32>() {
        Tensor::from_slice(numbers, shape, &Device::Cpu)
    } else if let Some(numbers) = array.as_slice::<f64>() {
        Tensor::from_slice(numbers, shape, &Device::Cpu)?.to_dtype(DType::F32)
    } else if let Some(numbers) = array.as_slice::<i64>() {
        Tensor::from_slice(numbers, shape, &Device::Cpu)
    } else {
        Tensor::from_slice(
            array.as_slice::<u8>().ok_or_else(refuse)?,
            shape,
            &Device::Cpu,
        )
    }
}

fn is_float(dtype: gym::DType) -> bool {
    matches!(dtype, gym::DType::F32 | gym::DType::F64)
}

fn matrix_value(numbers: Vec<f32>, shape: &[usize; 2], dtype: gym::DType) -> Value {
    let array = if dtype == gym::DType::F64 {
        Array::from(numbers.into_iter().map(f64::from).collect::<Vec<_>>())
    } else {
        Array::from(numbers)
    };
    Value::Array(array.reshape(shape.as_slice()).unwrap_or_default())
}

/// Draws an index from the distribution with these log-probabilities.
fn choose(log_probabilities: &[f32], rng: &mut Generator) -> usize {
    let draw = rng.random() as f32;
    let mut sum = 0.0;
    let below = |log_probability: &&f32| {
        sum += log_probability.exp();
        sum <= draw
    };
    log_probabilities
        .iter()
        .take_while(below)
        .count()
        .min(log_probabilities.len() - 1)
}

/// Returns `x`, shifted and scaled to mean 0 and standard deviation 1.
fn normalized(x: &Tensor) -> Result<Tensor> {
    let x = x.broadcast_sub(&x.mean_all()?)?;
    let deviation = (x.sqr()?.mean_all()?.sqrt()? + 1e-8)?;
    x.broadcast_div(&deviation)
}
