//! PPO in one file: learns CartPole in seconds, with no dependency but `gym`.
//! Run it with `cargo run --release --example ppo`.
//!
//! Proximal policy optimisation (Schulman et al., 2017, <https://arxiv.org/abs/1707.06347>), with
//! the settings and details of CleanRL's `ppo.py`. The crate `gym-ppo` has more: continuous
//! actions, images, checkpoints, several threads.

use gym::prelude::*;
use gym::vector::{Columns, Progress};
use gym::{Generator, math};

const ENVS: usize = 8;
/// Steps of each environment between two updates of the networks.
const STEPS: usize = 128;
const EPOCHS: usize = 4;
const MINIBATCH: usize = 256;
const MOST_STEPS: usize = 500_000;
/// The initial learning rate, which decreases to 0 over `MOST_STEPS`.
const LEARNING_RATE: f64 = 1e-3;
const DISCOUNT: f64 = 0.99;
/// Lambda of generalised advantage estimation (Schulman et al., 2015).
const GAE_LAMBDA: f64 = 0.95;
/// How far the probability of an action may move in an update, as a ratio.
const CLIP: f64 = 0.2;
const ENTROPY_BONUS: f64 = 0.01;
const MAX_GRADIENT_NORM: f64 = 0.5;
/// CartPole counts as solved at this mean return of 100 episodes.
const SOLVED: f64 = 475.0;

/// Layers with tanh between them. Parameters and gradient are flat: for each layer weights (outputs
/// by inputs), then biases.
struct Network {
    sizes: Vec<usize>,
    parameters: Vec<f64>,
    gradient: Vec<f64>,
    /// Adam's running means of the gradient and of its square.
    moments: Vec<[f64; 2]>,
    updates: i32,
}

impl Network {
    /// Draws random weights of variance 2 / inputs, and scales the weights of the last layer by
    /// `last_scale`.
    fn new(sizes: &[usize], last_scale: f64, rng: &mut Generator) -> Self {
        let mut parameters = Vec::new();
        for (layer, pair) in sizes.windows(2).enumerate() {
            let scale = if layer + 2 == sizes.len() {
                last_scale
            } else {
                1.0
            };
            let deviation = scale * (2.0 / pair[0] as f64).sqrt();
            parameters.extend((0..pair[0] * pair[1]).map(|_| deviation * rng.standard_normal()));
            parameters.extend(std::iter::repeat_n(0.0, pair[1]));
        }
        let n = parameters.len();
        Self {
            sizes: sizes.to_vec(),
            parameters,
            gradient: vec![0.0; n],
            moments: vec![[0.0; 2]; n],
            updates: 0,
        }
    }

    /// Leaves the input and the outputs of each layer in `layers`.
    fn forward(&self, input: &[f64], layers: &mut Vec<Vec<f64>>) {
        layers.resize(self.sizes.len(), Vec::new());
        layers[0].clear();
        layers[0].extend(input);
        let mut rest = &self.parameters[..];
        for i in 1..layers.len() {
            let (before, after) = layers.split_at_mut(i);
            let (x, y) = (&before[i - 1], &mut after[0]);
            let (weights, others) = rest.split_at(x.len() * self.sizes[i]);
            let (bias, others) = others.split_at(self.sizes[i]);
            rest = others;
            let is_last = i + 1 == self.sizes.len();
            y.clear();
            y.extend(weights.chunks_exact(x.len()).zip(bias).map(|(row, bias)| {
                let sum = bias + row.iter().zip(x).map(|(w, x)| w * x).sum::<f64>();
                if is_last { sum } else { math::tanh(sum) }
            }));
        }
    }

    /// Adds the gradient of a loss to `self.gradient`: `output` is the loss's derivative by each
    /// output.
    fn backward(&mut self, layers: &[Vec<f64>], output: &[f64]) {
        let mut end = self.parameters.len();
        let mut delta = output.to_vec();
        for i in (1..layers.len()).rev() {
            let x = &layers[i - 1];
            let bias = end - delta.len();
            let weights = bias - x.len() * delta.len();
            end = weights;
            let mut delta_before = vec![0.0; x.len()];
            for (j, d) in delta.iter().enumerate() {
                self.gradient[bias + j] += d;
                let row = weights + j * x.len()..weights + (j + 1) * x.len();
                for (k, at) in row.enumerate() {
                    self.gradient[at] += d * x[k];
                    delta_before[k] += d * self.parameters[at];
                }
            }
            // tanh' = 1 - tanh^2
            delta = delta_before
                .iter()
                .zip(x)
                .map(|(d, x)| d * (1.0 - x * x))
                .collect();
        }
    }

    /// A step of Adam (Kingma and Ba, 2015) down the gradient, whose norm is limited; then the
    /// gradient is zero.
    fn update(&mut self, learning_rate: f64) {
        self.updates += 1;
        let norm = self.gradient.iter().map(|g| g * g).sum::<f64>().sqrt();
        let scale = (MAX_GRADIENT_NORM / (norm + 1e-6)).min(1.0);
        let [unbias_first, unbias_second] =
            [0.9f64, 0.999].map(|beta| 1.0 - beta.powi(self.updates));
        for ((parameter, gradient), [first, second]) in self
            .parameters
            .iter_mut()
            .zip(&mut self.gradient)
            .zip(&mut self.moments)
        {
            let g = scale * std::mem::take(gradient);
            *first += 0.1 * (g - *first);
            *second += 0.001 * (g * g - *second);
            *parameter -=
                learning_rate * (*first / unbias_first) / ((*second / unbias_second).sqrt() + 1e-5);
        }
    }
}

/// Probabilities in proportion to exp(logit).
fn softmax(logits: &[f64]) -> Vec<f64> {
    let most = logits.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let powers: Vec<f64> = logits.iter().map(|x| math::exp(x - most)).collect();
    let sum: f64 = powers.iter().sum();
    powers.iter().map(|p| p / sum).collect()
}

/// One step of one environment, with its advantage.
#[derive(Clone, Default)]
struct Transition {
    observation: Vec<f64>,
    action: usize,
    log_probability: f64,
    value: f64,
    advantage: f64,
    /// The step leads from the end of an episode to the start of the next, so the agent does not
    /// learn from the step.
    is_reset: bool,
}

struct Agent {
    actor: Network,
    critic: Network,
    layers: Vec<Vec<f64>>,
    rng: Generator,
}

impl Agent {
    fn value(&mut self, observation: &[f64]) -> f64 {
        self.critic.forward(observation, &mut self.layers);
        self.layers[self.layers.len() - 1][0]
    }

    /// Draws an action from the policy.
    fn act(&mut self, observation: Vec<f64>) -> Transition {
        self.actor.forward(&observation, &mut self.layers);
        let probabilities = softmax(&self.layers[self.layers.len() - 1]);
        let action = self.rng.choice_p(&probabilities);
        let log_probability = math::ln(probabilities[action]);
        let value = self.value(&observation);
        Transition {
            observation,
            action,
            log_probability,
            value,
            ..Transition::default()
        }
    }

    /// Adds the gradients of both losses for one transition, a share of a minibatch. `advantage` is
    /// normalised.
    fn learn(&mut self, transition: &Transition, advantage: f64, share: f64) {
        let Transition {
            observation,
            action,
            log_probability,
            value,
            ..
        } = transition;
        self.actor.forward(observation, &mut self.layers);
        let probabilities = softmax(&self.layers[self.layers.len() - 1]);
        let ratio = math::exp(math::ln(probabilities[*action]) - log_probability);
        // the objective min(ratio A, clip(ratio) A) is flat where the clipped term is the smaller
        let is_clipped = if advantage > 0.0 {
            ratio > 1.0 + CLIP
        } else {
            ratio < 1.0 - CLIP
        };
        let by_log_probability = if is_clipped { 0.0 } else { -ratio * advantage };
        let entropy: f64 = probabilities.iter().map(|p| -p * math::ln(*p)).sum();
        let by_logits: Vec<f64> = (0..probabilities.len())
            .map(|i| {
                let p = probabilities[i];
                let chosen = if i == *action { 1.0 } else { 0.0 };
                // d log p(action) / d logit, and d entropy / d logit
                share
                    * (by_log_probability * (chosen - p)
                        + ENTROPY_BONUS * p * (math::ln(p) + entropy))
            })
            .collect();
        self.actor.backward(&self.layers, &by_logits);

        let target = transition.advantage + value;
        let error = self.value(observation) - target;
        self.critic.backward(&self.layers, &[share * error]);
    }
}

/// The observation of an environment.
fn row(columns: &Columns, index: usize) -> Vec<f64> {
    let all = columns
        .observations
        .as_array()
        .map(|array| array.as_slice::<f32>().unwrap_or_default());
    let all = all.unwrap_or_default();
    let width = all.len() / ENVS;
    all[index * width..(index + 1) * width]
        .iter()
        .map(|x| f64::from(*x))
        .collect()
}

/// Learns until the task is solved or `MOST_STEPS` are over. Returns the number of steps and the
/// last mean return.
fn train(seed: u64) -> gym::Result<(usize, f64)> {
    let mut envs = gym::make_vec("CartPole-v1", ENVS, None)?;
    let mut rng = Generator::from(seed);
    let mut agent = Agent {
        actor: Network::new(&[4, 64, 64, 2], 0.01, &mut rng),
        critic: Network::new(&[4, 64, 64, 1], 1.0, &mut rng),
        layers: Vec::new(),
        rng,
    };
    let mut columns = envs.columns()?;
    envs.reset_into(&seed.into(), &mut columns)?;
    let mut running = [0.0; ENVS];
    let mut returns: Vec<f64> = Vec::new();
    let mut steps = 0;
    let mut mean = 0.0;
    while steps < MOST_STEPS && mean < SOLVED {
        // experience: STEPS steps of each environment
        let mut rollout: Vec<Vec<Transition>> = Vec::with_capacity(STEPS);
        let mut outcomes: Vec<Columns> = Vec::with_capacity(STEPS);
        for _ in 0..STEPS {
            let mut transitions: Vec<Transition> =
                (0..ENVS).map(|i| agent.act(row(&columns, i))).collect();
            let actions: Vec<i64> = transitions
                .iter()
                .map(|transition| transition.action as i64)
                .collect();
            envs.step_into(&Value::Array(actions.into()), &mut columns)?;
            for (i, transition) in transitions.iter_mut().enumerate() {
                transition.is_reset = columns.progress[i] == Progress::Started;
                running[i] += columns.rewards[i];
                if columns.done(i) {
                    returns.push(std::mem::take(&mut running[i]));
                }
            }
            rollout.push(transitions);
            outcomes.push(columns.clone());
            steps += ENVS;
        }

        // advantages, from the last step back
        for i in 0..ENVS {
            let mut next_value = agent.value(&row(&columns, i));
            let mut next_advantage = 0.0;
            for (transitions, outcome) in rollout.iter_mut().zip(&outcomes).rev() {
                let transition = &mut transitions[i];
                // a truncated episode has not terminated: bootstrap from its last observation
                let value_after = if outcome.terminated[i] {
                    0.0
                } else {
                    next_value
                };
                let advantage_after = if outcome.done(i) { 0.0 } else { next_advantage };
                let delta = outcome.rewards[i] + DISCOUNT * value_after - transition.value;
                transition.advantage = delta + DISCOUNT * GAE_LAMBDA * advantage_after;
                (next_value, next_advantage) = (transition.value, transition.advantage);
            }
        }

        // several epochs over the rollout, in minibatches
        let mut batch: Vec<Transition> = rollout
            .into_iter()
            .flatten()
            .filter(|one| !one.is_reset)
            .collect();
        let learning_rate = LEARNING_RATE * (1.0 - steps as f64 / MOST_STEPS as f64);
        for _ in 0..EPOCHS {
            agent.rng.shuffle(&mut batch);
            for minibatch in batch.chunks(MINIBATCH) {
                let n = minibatch.len() as f64;
                let center = minibatch.iter().map(|one| one.advantage).sum::<f64>() / n;
                let variance = minibatch
                    .iter()
                    .map(|one| (one.advantage - center).powi(2))
                    .sum::<f64>()
                    / n;
                for one in minibatch {
                    agent.learn(
                        one,
                        (one.advantage - center) / (variance.sqrt() + 1e-8),
                        1.0 / n,
                    );
                }
                agent.actor.update(learning_rate);
                agent.critic.update(learning_rate);
            }
        }

        let recent = &returns[returns.len().saturating_sub(100)..];
        mean = recent.iter().sum::<f64>() / 100.0f64.max(recent.len() as f64);
        if steps % (20 * STEPS * ENVS) == 0 {
            println!(
                "{steps:>7} steps, {:>4} episodes, mean return of the last 100: {mean:>5.1}",
                returns.len()
            );
        }
    }
    Ok((steps, mean))
}

fn main() -> gym::Result<()> {
    let (steps, mean) = train(1)?;
    let verdict = if mean >= SOLVED {
        "solved"
    } else {
        "not solved"
    };
    println!("{verdict} after {steps} steps: mean return of 100 episodes {mean:.1}");
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Compares the gradient of a weighted sum of the outputs with finite differences.
    #[test]
    fn backward_is_the_derivative_of_forward() {
        let mut network = Network::new(&[3, 5, 2], 1.0, &mut Generator::from(0));
        let input = [0.3, -0.7, 1.1];
        let mut layers = Vec::new();
        let mut loss = |network: &Network| {
            network.forward(&input, &mut layers);
            2.0 * layers[2][0] - layers[2][1]
        };
        let differences: Vec<f64> = (0..network.parameters.len())
            .map(|i| {
                let mut at = |offset: f64| {
                    network.parameters[i] += offset;
                    let loss = loss(&network);
                    network.parameters[i] -= offset;
                    loss
                };
                (at(1e-6) - at(-1e-6)) / 2e-6
            })
            .collect();
        let mut layers = Vec::new();
        network.forward(&input, &mut layers);
        network.backward(&layers, &[2.0, -1.0]);
        for (gradient, difference) in network.gradient.iter().zip(differences) {
            assert!(
                (gradient - difference).abs() < 1e-8,
                "{gradient} {difference}"
            );
        }
    }

    #[test]
    fn cartpole_is_solved() {
        let (steps, mean) = train(1).expect("CartPole is registered");
        assert!(mean >= SOLVED, "{mean} after {steps} steps");
    }
}
