//! The cross-entropy method over linear policies: a population of weights, of which the best few
//! make the next generation.
//!
//! Szita and Lőrincz, *Learning Tetris Using the Noisy Cross-Entropy Method*, Neural Computation 18
//! (2006): noise in the variance, which decreases over the generations, keeps the search from
//! collapsing before it has found anything. The best policy of a generation is tried again in the
//! next one. Some noise relative to the weights always remains, so that no search is stuck for good.

use gym::{BoxEnv, Env, EnvExt, Error, Generator, Reset, Result, Seed, Space, Value};
use serde::Deserialize;

use crate::episode::Episode;

/// The parameters, which may change while the learner learns.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Parameters {
    /// The number of policies in a generation.
    population: usize,
    /// The share of the policies from which the next generation is made.
    elite: f64,
    /// The standard deviation of the first generation's weights.
    spread: f64,
    /// The number added to the variance of the first generation; the noise decreases to 0 within
    /// [`NOISY`] generations.
    noise: f64,
    /// Episodes that each policy plays; its mean return counts.
    episodes: u32,
}

/// The number of generations with added noise.
const NOISY: f64 = 12.0;
/// The deviation that always remains, relative to the root mean square of the mean weights.
const REMAINING: f64 = 0.03;

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
    /// The best policy of the last generation, until its evaluation in this generation.
    best: Option<Vec<f64>>,
    /// The policies of this generation that were tried, with their mean returns.
    tried: Vec<(f64, Vec<f64>)>,
    /// The policy that is being tried.
    trial: Option<Trial>,
}

/// The meaning of a policy's outputs.
#[derive(Debug)]
enum Outputs {
    /// One output for each action: the action with the greatest output is taken.
    Choice { first: i64, count: usize },
    /// The numbers of the action, clipped to these bounds.
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
            best: None,
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

    /// Returns the mean standard deviation of the weights.
    pub(crate) fn spread(&self) -> f64 {
        self.deviation.iter().sum::<f64>() / self.deviation.len().max(1) as f64
    }

    /// Returns the mean weights: for each output, those of the inputs, then the bias.
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
                    let draw = || {
                        pairs
                            .map(|(mean, deviation)| rng.normal(*mean, *deviation))
                            .collect()
                    };
                    let weights = self.best.take().unwrap_or_else(draw);
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

    /// Sets the mean and the variance to those of the best policies, and adds noise to the
    /// variance.
    fn next_generation(&mut self) {
        self.tried.sort_by(|(a, _), (b, _)| b.total_cmp(a));
        let Parameters { elite, noise, .. } = self.parameters;
        let count = ((self.tried.len() as f64 * elite) as usize).clamp(1, self.tried.len());
        let best = &self.tried[..count];
        self.generation += 1;
        let added = noise * (1.0 - f64::from(self.generation) / NOISY).max(0.0);
        for i in 0..self.mean.len() {
            let mean = best.iter().map(|(_, weights)| weights[i]).sum::<f64>() / count as f64;
            let variance = best
                .iter()
                .map(|(_, weights)| (weights[i] - mean).powi(2))
                .sum::<f64>()
                / count as f64;
            (self.mean[i], self.deviation[i]) = (mean, variance + added);
        }
        let square = self.mean.iter().map(|x| x * x).sum::<f64>() / self.mean.len().max(1) as f64;
        for deviation in &mut self.deviation {
            *deviation = (*deviation + square * REMAINING * REMAINING).sqrt();
        }
        self.best = best.first().map(|(_, weights)| weights.clone());
        self.tried.clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn learner(seed: u64, parameters: &str) -> CrossEntropy {
        let parameters = serde_json::from_str(parameters).unwrap();
        let env = gym::make("CartPole-v1").unwrap();
        CrossEntropy::new(env, Seed::from(seed), parameters).unwrap()
    }

    /// With the page's parameters, every search learns to balance. (The page's own test tries 200
    /// seeds.)
    #[test]
    fn linear_policies_learn_to_balance() {
        const POPULATION: usize = 40;
        let parameters =
            r#"{"population": 40, "elite": 0.2, "spread": 1.0, "noise": 0.5, "episodes": 1}"#;
        for seed in 0..20 {
            let mut learner = learner(seed, parameters);
            let mut returns = Vec::new();
            let learned = loop {
                let ended = learner.train(POPULATION as u32, 50_000).unwrap();
                returns.extend(ended.iter().map(|episode| episode.episode_return));
                let last = &returns[returns.len().saturating_sub(POPULATION)..];
                let mean = last.iter().sum::<f64>() / last.len() as f64;
                if mean > 400.0 || learner.generation() >= 60 {
                    break mean > 400.0;
                }
            };
            assert!(learned, "seed {seed}");
        }
    }

    /// Although all policies are equal, the variance of the search stays positive, and the noise
    /// decreases.
    #[test]
    fn noise_keeps_the_variance_of_equal_policies() {
        let parameters =
            r#"{"population": 4, "elite": 0.5, "spread": 0.0, "noise": 0.25, "episodes": 1}"#;
        let mut learner = learner(0, parameters);
        let mut spreads = Vec::new();
        while learner.generation() < 14 {
            let generation = learner.generation();
            learner.train(1, 1).unwrap();
            if learner.generation() > generation {
                spreads.push(learner.spread());
            }
        }
        // the variance of equal policies is 0, so that only the noise is left
        let first = (0.25_f64 * (1.0 - 1.0 / NOISY)).sqrt();
        assert!((spreads[0] - first).abs() < 1e-9, "{spreads:?}");
        let square = learner.mean.iter().map(|x| x * x).sum::<f64>() / learner.mean.len() as f64;
        assert!(learner.spread() >= REMAINING * square.sqrt());
    }

    /// The best policy of a generation is the first policy of the next generation.
    #[test]
    fn the_best_policy_is_tried_again() {
        let parameters =
            r#"{"population": 6, "elite": 0.5, "spread": 1.0, "noise": 0.1, "episodes": 1}"#;
        let mut learner = learner(3, parameters);
        while learner.generation() == 0 {
            learner.train(1, 1).unwrap();
        }
        let best = learner.best.clone().unwrap();
        learner.train(1, 1).unwrap();
        let tried = learner.trial.as_ref().map(|trial| trial.weights.clone());
        let tried = tried.or_else(|| learner.tried.first().map(|(_, weights)| weights.clone()));
        assert_eq!(tried.unwrap(), best);
        assert!(learner.best.is_none());
    }
}
