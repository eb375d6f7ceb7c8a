//! The cross-entropy method over linear policies: a population of weights, of which the best few
//! make the next generation.
//!
//! Szita and Lőrincz, *Learning Tetris Using the Noisy Cross-Entropy Method*, Neural Computation 18
//! (2006), with decreasing noise.

use gym::{BoxEnv, Env, EnvExt, Error, Generator, Reset, Result, Seed, Space, Value};
use serde::Deserialize;

use crate::episode::Episode;

/// The parameters, which may change while the learner learns.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Parameters {
    /// The number of policies in a generation.
    population: usize,
    /// The share of them that makes the next generation.
    elite: f64,
    /// The standard deviation of the first generation's weights.
    spread: f64,
    /// The number added to later standard deviations, so that they do not vanish too soon.
    noise: f64,
    /// Episodes that each policy plays; its mean return counts.
    episodes: u32,
}

/// A linear policy, and the search for a better one.
#[derive(Debug)]
pub(crate) struct CrossEntropy {
    parameters: Parameters,
    env: BoxEnv,
    rng: Generator,
    seed: Option<Seed>,
    outputs: Outputs,
    inputs: usize,
    mean: Vec<f64>,
    deviation: Vec<f64>,
    generation: u32,
    /// The policies of this generation that were tried, with their mean returns.
    tried: Vec<(f64, Vec<f64>)>,
    /// The policy that is being tried.
    trial: Option<Trial>,
}

/// The meaning of a policy's outputs.
#[derive(Debug)]
enum Outputs {
    /// One for each action; the greatest is chosen.
    Choice { first: i64, count: usize },
    /// Numbers, clipped to these bounds.
    Numbers(Vec<(f64, f64)>),
}

#[derive(Debug)]
struct Trial {
    weights: Vec<f64>,
    total: f64,
    played: u32,
    /// The episode that the last slice of training ended in, with its last observation.
    running: Option<(Episode, Value)>,
}

impl CrossEntropy {
    pub(crate) fn new(env: BoxEnv, seed: Seed, parameters: Parameters) -> Result<Self> {
        let unfit = |what| Error::custom(format!("a linear policy does not fit {env}: {what}"));
        let inputs = match env.observation_space() {
            Space::Box(space) if space.low().len() <= 64 => space.low().len(),
            space => return Err(unfit(format!("it observes {space}"))),
        };
        let outputs = match env.action_space() {
            Space::Discrete(space) => Outputs::Choice {
                first: space.start(),
                count: usize::try_from(space.n()).unwrap_or_default(),
            },
            Space::Box(space) => Outputs::Numbers(
                space
                    .low()
                    .iter_f64()
                    .zip(space.high().iter_f64())
                    .collect(),
            ),
            space => return Err(unfit(format!("its actions are {space}"))),
        };
        let mut learner = Self {
            rng: Generator::new(&seed.plus(1)),
            seed: Some(seed),
            mean: Vec::new(),
            deviation: Vec::new(),
            generation: 0,
            tried: Vec::new(),
            trial: None,
            parameters,
            env,
            outputs,
            inputs,
        };
        let count = (learner.inputs + 1) * learner.outputs();
        (learner.mean, learner.deviation) = (vec![0.0; count], vec![parameters.spread; count]);
        Ok(learner)
    }

    pub(crate) fn tune(&mut self, parameters: Parameters) {
        self.parameters = parameters;
    }

    pub(crate) fn inputs(&self) -> usize {
        self.inputs
    }

    pub(crate) fn outputs(&self) -> usize {
        match &self.outputs {
            Outputs::Choice { count, .. } => *count,
            Outputs::Numbers(bounds) => bounds.len(),
        }
    }

    pub(crate) fn generation(&self) -> u32 {
        self.generation
    }

    /// The mean standard deviation of the weights.
    pub(crate) fn spread(&self) -> f64 {
        self.deviation.iter().sum::<f64>() / self.deviation.len().max(1) as f64
    }

    /// The mean weights: for each output, those of the inputs, then the bias.
    pub(crate) fn weights(&self) -> &[f64] {
        &self.mean
    }

    pub(crate) fn act(&self, observation: &Value) -> Result<Value> {
        self.action(&self.mean, observation)
    }

    fn action(&self, weights: &[f64], observation: &Value) -> Result<Value> {
        let seen = observation.as_array().ok_or_else(|| {
            Error::Contract(format!(
                "{observation} is not an observation of {}",
                self.env
            ))
        })?;
        let rows = weights.chunks_exact(self.inputs + 1);
        let output = |row: &[f64]| {
            seen.iter_f64().zip(row).map(|(x, w)| x * w).sum::<f64>() + row[self.inputs]
        };
        let outputs: Vec<f64> = rows.map(output).collect();
        Ok(match &self.outputs {
            Outputs::Choice { first, .. } => {
                let greater = |best: usize, other: usize| {
                    if outputs[other] > outputs[best] {
                        other
                    } else {
                        best
                    }
                };
                Value::Int(first + (0..outputs.len()).reduce(greater).unwrap_or_default() as i64)
            }
            Outputs::Numbers(bounds) => {
                let clipped = outputs
                    .iter()
                    .zip(bounds)
                    .map(|(x, (low, high))| x.clamp(*low, *high) as f32);
                Value::Array(clipped.collect::<Vec<_>>().into())
            }
        })
    }

    pub(crate) fn train(&mut self, episodes: u32, steps: u32) -> Result<Vec<Episode>> {
        let mut ended = Vec::new();
        for _ in 0..steps {
            if ended.len() >= episodes as usize {
                break;
            }
            let mut trial = match self.trial.take() {
                Some(trial) => trial,
                None => {
                    let (rng, pairs) = (&mut self.rng, self.mean.iter().zip(&self.deviation));
                    let weights = pairs
                        .map(|(mean, deviation)| rng.normal(*mean, *deviation))
                        .collect();
                    Trial {
                        weights,
                        total: 0.0,
                        played: 0,
                        running: None,
                    }
                }
            };
            let (mut episode, mut observation) = match trial.running.take() {
                Some(running) => running,
                None => {
                    let reset = Reset {
                        seed: self.seed.take(),
                        ..Reset::default()
                    };
                    (
                        Episode {
                            episode_return: 0.0,
                            length: 0,
                        },
                        self.env.reset(reset)?,
                    )
                }
            };
            let action = self.action(&trial.weights, &observation)?;
            let outcome = self.env.step_into(&action, &mut observation)?;
            episode.episode_return += outcome.reward;
            episode.length += 1;
            if !outcome.done() {
                trial.running = Some((episode, observation));
                self.trial = Some(trial);
                continue;
            }
            ended.push(episode);
            trial.total += episode.episode_return;
            trial.played += 1;
            if trial.played < self.parameters.episodes {
                self.trial = Some(trial);
                continue;
            }
            self.tried
                .push((trial.total / f64::from(trial.played), trial.weights));
            if self.tried.len() >= self.parameters.population {
                self.next_generation();
            }
        }
        Ok(ended)
    }

    /// Mean and standard deviation of the best policies are those of the next generation.
    fn next_generation(&mut self) {
        self.tried.sort_by(|(a, _), (b, _)| b.total_cmp(a));
        let Parameters { elite, noise, .. } = self.parameters;
        let count = ((self.tried.len() as f64 * elite) as usize).clamp(1, self.tried.len());
        let best = &self.tried[..count];
        self.generation += 1;
        let extra = noise / f64::from(self.generation);
        for i in 0..self.mean.len() {
            let mean = best.iter().map(|(_, weights)| weights[i]).sum::<f64>() / count as f64;
            let variance = best
                .iter()
                .map(|(_, weights)| (weights[i] - mean).powi(2))
                .sum::<f64>()
                / count as f64;
            (self.mean[i], self.deviation[i]) = (mean, variance.sqrt() + extra);
        }
        self.tried.clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_linear_policy_learns_to_balance() {
        let parameters =
            r#"{"population": 20, "elite": 0.2, "spread": 1.0, "noise": 0.2, "episodes": 1}"#;
        let parameters = serde_json::from_str(parameters).unwrap();
        let mut learner =
            CrossEntropy::new(gym::make("CartPole-v1").unwrap(), Seed::from(0), parameters)
                .unwrap();
        let mut last = Vec::new();
        while learner.generation() < 15 {
            last.extend(learner.train(3, 50).unwrap());
        }
        let tail = &last[last.len() - 20..];
        let mean = tail
            .iter()
            .map(|episode| episode.episode_return)
            .sum::<f64>()
            / 20.0;
        assert!(mean > 400.0, "{mean}");
    }
}
