//! The agent: a policy and a value network, and how they learn.

use candle_core::{D, DType, Device, Tensor, Var, backprop::GradStore};
use candle_nn::{AdamW, Optimizer, ParamsAdamW, ops::log_softmax};
use gym::Generator;

use crate::Settings;
use crate::rollout::Batch;

type Result<T> = candle_core::Result<T>;

/// Units of each hidden layer.
const HIDDEN: usize = 64;
/// The value loss counts half, as in CleanRL.
const VALUE_COEFFICIENT: f64 = 0.5;
/// Gradients are scaled down to this norm.
const MAX_GRADIENT_NORM: f64 = 0.5;

/// Two networks of equal shape, one for the policy's preferences, one for the value.
pub(crate) struct Agent {
    policy: Network,
    value: Network,
    optimizer: AdamW,
}

impl Agent {
    /// An agent for so many numbers of observation and so many actions.
    pub(crate) fn new(observation: usize, actions: usize, rng: &mut Generator) -> Result<Self> {
        // a policy that begins without preferences explores
        let policy = Network::new([observation, HIDDEN, HIDDEN, actions], 0.01, rng)?;
        let value = Network::new([observation, HIDDEN, HIDDEN, 1], 1.0, rng)?;
        let variables = policy.variables().chain(value.variables()).collect();
        let adam = ParamsAdamW { weight_decay: 0.0, eps: 1e-5, ..ParamsAdamW::default() };
        Ok(Self { policy, value, optimizer: AdamW::new(variables, adam)? })
    }

    /// Log-probabilities of each action, a row per observation.
    pub(crate) fn log_probabilities(&self, observations: &Tensor) -> Result<Tensor> {
        log_softmax(&self.policy.forward(observations)?, D::Minus1)
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
        self.optimizer.set_learning_rate(settings.learning_rate * (1.0 - progress).max(0.05));
        let mut order: Vec<u32> = (0..batch.len() as u32).collect();
        for _ in 0..settings.epochs {
            rng.shuffle(&mut order);
            for indices in order.chunks(settings.minibatch) {
                let indices = Tensor::from_slice(indices, indices.len(), &Device::Cpu)?;
                let mut gradients = self.loss(&batch.select(&indices)?, settings)?.backward()?;
                self.clip(&mut gradients)?;
                self.optimizer.step(&gradients)?;
            }
        }
        Ok(())
    }

    /// Schulman et al. (2017), equation 9, to be made small.
    fn loss(&self, batch: &Batch, settings: &Settings) -> Result<Tensor> {
        let all = self.log_probabilities(&batch.observations)?;
        let chosen = all.gather(&batch.actions.unsqueeze(1)?, 1)?.squeeze(1)?;
        let ratio = (chosen - &batch.log_probabilities)?.exp()?;
        let advantages = normalized(&batch.advantages)?;
        let clipped = ratio.clamp(1.0 - settings.clip, 1.0 + settings.clip)?;
        let surrogate = (ratio * &advantages)?.minimum(&(clipped * &advantages)?)?.mean_all()?;
        let value_loss = (self.values(&batch.observations)? - &batch.returns)?.sqr()?.mean_all()?;
        let entropy = (all.exp()? * &all)?.sum(D::Minus1)?.mean_all()?.neg()?;
        (value_loss * VALUE_COEFFICIENT)? - surrogate - (entropy * settings.entropy_coefficient)?
    }

    fn clip(&self, gradients: &mut GradStore) -> Result<()> {
        let variables = || self.policy.variables().chain(self.value.variables());
        let mut sum = 0.0;
        for variable in variables() {
            if let Some(gradient) = gradients.get(&variable) {
                sum += f64::from(gradient.sqr()?.sum_all()?.to_scalar::<f32>()?);
            }
        }
        let scale = MAX_GRADIENT_NORM / (sum.sqrt() + 1e-6);
        if scale < 1.0 {
            for variable in variables() {
                if let Some(gradient) = gradients.remove(&variable) {
                    gradients.insert(&variable, (gradient * scale)?);
                }
            }
        }
        Ok(())
    }
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
