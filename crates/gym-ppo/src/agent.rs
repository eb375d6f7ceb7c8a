//! The agent: a policy and a value network, and how they learn.

use std::f64::consts::{E, PI};
use std::iter::zip;

use anyhow::{bail, ensure};
use candle_core::{D, DType, Device, Tensor, Var, backprop::GradStore};
use candle_nn::ops::log_softmax;
use gym::{Array, Generator, Space, Value};

use crate::adam::{Adam, StoredAdam};
use crate::numbers::{self, Numbers};
use crate::rollout::Batch;
use crate::settings::Settings;

type Result<T> = candle_core::Result<T>;

/// The variables of an agent that decide its best actions come first: weights and bias of each layer of the policy.
pub(crate) const POLICY_VARIABLES: usize = 6;

/// Units of each hidden layer.
const HIDDEN: usize = 64;
/// The value loss counts half, as in CleanRL.
const VALUE_COEFFICIENT: f64 = 0.5;
/// Gradients are scaled down to this norm.
const MAX_GRADIENT_NORM: f64 = 0.5;

/// Two networks of equal shape, one for the policy, one for the value.
pub(crate) struct Agent {
    policy: Network,
    head: Head,
    value: Network,
    optimizer: Adam,
}

/// What the outputs of the policy network mean.
enum Head {
    /// Preferences for each action.
    Discrete,
    /// The mean of a normal distribution; the logarithms of its standard deviations do not depend on the state.
    Gaussian { log_std: Var },
}

impl Agent {
    /// An agent for observations of so many numbers, and for one of the actions of a space.
    pub(crate) fn new(observation: usize, action: &Space, rng: &mut Generator) -> anyhow::Result<Self> {
        let (outputs, head) = match action {
            Space::Discrete(space) => (space.n() as usize, Head::Discrete),
            Space::Box(space) if space.dtype() == gym::DType::F32 && space.shape().len() == 1 => {
                let log_std = Var::zeros(space.shape()[0], DType::F32, &Device::Cpu)?;
                (space.shape()[0], Head::Gaussian { log_std })
            }
            other => {
                bail!("the actions are {other}: this example needs a Discrete or a row of float32 numbers")
            }
        };
        // a policy that begins without preferences explores
        let policy = Network::new([observation, HIDDEN, HIDDEN, outputs], 0.01, rng)?;
        let value = Network::new([observation, HIDDEN, HIDDEN, 1], 1.0, rng)?;
        let mut variables: Vec<Var> = policy.variables().chain(value.variables()).collect();
        if let Head::Gaussian { log_std } = &head {
            variables.push(log_std.clone());
        }
        Ok(Self { policy, head, value, optimizer: Adam::new(variables)? })
    }

    pub(crate) fn store(&self) -> Result<StoredAdam> {
        self.optimizer.store()
    }

    /// Continues from what was stored of an agent for the same spaces.
    pub(crate) fn restore(&mut self, stored: &StoredAdam) -> anyhow::Result<()> {
        self.optimizer.restore(stored)
    }

    /// Takes over the policy of an agent for the same spaces.
    pub(crate) fn set_policy(&mut self, network: &[Numbers]) -> anyhow::Result<()> {
        let given = network.len();
        ensure!(
            given == POLICY_VARIABLES,
            "the policy has {given} lists of numbers: there are {POLICY_VARIABLES}"
        );
        for (variable, numbers) in zip(self.policy.variables(), network) {
            variable.set(&numbers::tensor(numbers, &variable)?)?;
        }
        Ok(())
    }

    /// Draws an action for each observation, as a batch, and says how likely each was.
    pub(crate) fn sample(&self, observations: &Tensor, rng: &mut Generator) -> Result<(Value, Vec<f32>)> {
        let outputs = self.policy.forward(observations)?;
        let actions = match &self.head {
            Head::Discrete => {
                let rows = log_softmax(&outputs, D::Minus1)?.to_vec2::<f32>()?;
                let drawn: Vec<i64> = rows.iter().map(|row| choose(row, rng) as i64).collect();
                Value::Array(drawn.into())
            }
            Head::Gaussian { log_std } => {
                let std = log_std.exp()?.to_vec1::<f32>()?;
                let rows = outputs.to_vec2::<f32>()?;
                let drawn = rows.iter().flat_map(|row| zip(row, &std)).map(|(mean, std)| {
                    let noise = rng.standard_normal() as f32;
                    mean + std * noise
                });
                matrix_value(drawn.collect(), &[rows.len(), std.len()])
            }
        };
        let (log_probabilities, _) = self.judge(observations, &tensor(&actions)?)?;
        Ok((actions, log_probabilities.to_vec1()?))
    }

    /// The most likely action for each observation, as a batch.
    pub(crate) fn best(&self, observations: &Tensor) -> Result<Value> {
        let outputs = self.policy.forward(observations)?;
        Ok(match &self.head {
            Head::Discrete => {
                let best = outputs.argmax(D::Minus1)?.to_vec1::<u32>()?;
                Value::Array(best.into_iter().map(i64::from).collect::<Vec<_>>().into())
            }
            Head::Gaussian { .. } => {
                let (rows, width) = outputs.dims2()?;
                matrix_value(outputs.flatten_all()?.to_vec1()?, &[rows, width])
            }
        })
    }

    /// The log-probability of each action, and the mean entropy of the policy.
    fn judge(&self, observations: &Tensor, actions: &Tensor) -> Result<(Tensor, Tensor)> {
        let outputs = self.policy.forward(observations)?;
        match &self.head {
            Head::Discrete => {
                let all = log_softmax(&outputs, D::Minus1)?;
                let chosen = all.gather(&actions.unsqueeze(1)?, 1)?.squeeze(1)?;
                Ok((chosen, (all.exp()? * &all)?.sum(D::Minus1)?.mean_all()?.neg()?))
            }
            Head::Gaussian { log_std } => {
                let log_std = log_std.as_tensor();
                let distance = (actions - outputs)?.broadcast_div(&log_std.exp()?)?;
                let density = (distance.sqr()? * -0.5)?.broadcast_sub(log_std)?;
                let density = (density - 0.5 * (2.0 * PI).ln())?;
                let entropy = (log_std + 0.5 * (2.0 * PI * E).ln())?.sum_all()?;
                Ok((density.sum(D::Minus1)?, entropy))
            }
        }
    }

    /// The value of each observation.
    pub(crate) fn values(&self, observations: &Tensor) -> Result<Tensor> {
        self.value.forward(observations)?.squeeze(D::Minus1)
    }

    /// Learns from a batch, in several passes over shuffled minibatches; `progress` of the whole
    /// training, from 0 to 1, sets the pace.
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
                let mut gradients = self.loss(&batch.select(&indices)?, settings)?.backward()?;
                self.clip(&mut gradients)?;
                self.optimizer.step(&gradients, learning_rate)?;
            }
        }
        Ok(())
    }

    /// Schulman et al. (2017), equation 9, to be made small.
    fn loss(&self, batch: &Batch, settings: &Settings) -> Result<Tensor> {
        let (chosen, entropy) = self.judge(&batch.observations, &batch.actions)?;
        let ratio = (chosen - &batch.log_probabilities)?.exp()?;
        let advantages = normalized(&batch.advantages)?;
        let clipped = ratio.clamp(1.0 - settings.clip, 1.0 + settings.clip)?;
        let surrogate = (ratio * &advantages)?.minimum(&(clipped * &advantages)?)?.mean_all()?;
        let value_loss = (self.values(&batch.observations)? - &batch.returns)?.sqr()?.mean_all()?;
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

/// Rows of numbers, or a number for each row, as a tensor.
pub(crate) fn tensor(batch: &Value) -> Result<Tensor> {
    let refuse = || candle_core::Error::Msg(format!("{batch} is no batch of float32 or int64 numbers"));
    let array = batch.as_array().ok_or_else(refuse)?;
    match (array.as_slice::<f32>(), array.as_slice::<i64>()) {
        (Some(numbers), _) => Tensor::from_slice(numbers, array.shape(), &Device::Cpu),
        (_, Some(numbers)) => Tensor::from_slice(numbers, array.shape(), &Device::Cpu),
        _ => Err(refuse()),
    }
}

fn matrix_value(numbers: Vec<f32>, shape: &[usize; 2]) -> Value {
    // as many numbers as the shape has
    Value::Array(Array::from(numbers).reshape(shape.as_slice()).unwrap_or_default())
}

/// Draws an index by the logarithms of its probabilities.
fn choose(log_probabilities: &[f32], rng: &mut Generator) -> usize {
    let draw = rng.random() as f32;
    let mut sum = 0.0;
    let below = |log_probability: &&f32| {
        sum += log_probability.exp();
        sum <= draw
    };
    log_probabilities.iter().take_while(below).count().min(log_probabilities.len() - 1)
}

/// Mean 0 and deviation 1.
fn normalized(x: &Tensor) -> Result<Tensor> {
    let x = x.broadcast_sub(&x.mean_all()?)?;
    let deviation = (x.sqr()?.mean_all()?.sqrt()? + 1e-8)?;
    x.broadcast_div(&deviation)
}

/// Three linear layers with tanh between them.
struct Network {
    layers: [(Var, Var); 3],
}

impl Network {
    fn new(sizes: [usize; 4], last_gain: f64, rng: &mut Generator) -> Result<Self> {
        let mut layer = |i: usize, gain: f64| {
            let (inputs, outputs) = (sizes[i], sizes[i + 1]);
            let scale = gain / (inputs as f64).sqrt();
            let weights: Vec<f32> = (0..inputs * outputs).map(|_| rng.normal(0.0, scale) as f32).collect();
            let weights = Tensor::from_vec(weights, (inputs, outputs), &Device::Cpu)?;
            let bias = Tensor::zeros(outputs, DType::F32, &Device::Cpu)?;
            Ok::<_, candle_core::Error>((Var::from_tensor(&weights)?, Var::from_tensor(&bias)?))
        };
        let gain = 2f64.sqrt();
        Ok(Self { layers: [layer(0, gain)?, layer(1, gain)?, layer(2, last_gain)?] })
    }

    fn forward(&self, x: &Tensor) -> Result<Tensor> {
        let apply = |x: &Tensor, (weights, bias): &(Var, Var)| {
            x.matmul(weights.as_tensor())?.broadcast_add(bias.as_tensor())
        };
        let [first, second, last] = &self.layers;
        let x = apply(x, first)?.tanh()?;
        let x = apply(&x, second)?.tanh()?;
        apply(&x, last)
    }

    fn variables(&self) -> impl Iterator<Item = Var> + '_ {
        self.layers.iter().flat_map(|(weights, bias)| [weights.clone(), bias.clone()])
    }
}
