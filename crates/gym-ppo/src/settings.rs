//! The hyperparameters.

use anyhow::{Context, Result, ensure};
use gym::atari::AtariEnv;
use gym::minigrid::GridEnv;
use gym::sim::{SimEnv, Stepper};
use gym::{BoxEnv, Env, EnvExt, Space};
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// The kind of an environment's task, which decides the default settings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Task {
    /// Observations of numbers, discrete actions.
    Discrete,
    /// Observations of numbers, continuous actions.
    Continuous,
    /// A task of the DeepMind Control Suite: continuous actions.
    Control,
    /// A game of the Atari 2600.
    Atari,
    /// A grid of MiniGrid or BabyAI.
    Grid,
}

impl Task {
    pub(crate) fn of(env: &BoxEnv) -> Self {
        if env.layer::<AtariEnv>().is_some() {
            return Self::Atari;
        }
        if env.layer::<GridEnv>().is_some() {
            return Self::Grid;
        }
        if env
            .layer::<SimEnv>()
            .is_some_and(|env| env.simulation().stepper == Stepper::Settled)
        {
            return Self::Control;
        }
        match env.action_space() {
            Space::Box(_) => Self::Continuous,
            _ => Self::Discrete,
        }
    }
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Settings {
    pub(crate) envs: usize,
    /// Steps of each environment between two updates.
    pub(crate) steps: usize,
    pub(crate) minibatch: usize,
    pub(crate) epochs: usize,
    pub(crate) learning_rate: f64,
    pub(crate) discount: f32,
    pub(crate) gae_lambda: f32,
    pub(crate) clip: f64,
    pub(crate) entropy_coefficient: f64,
    /// Whether to normalize observations and rewards.
    pub(crate) normalize: bool,
}

impl Settings {
    /// Returns settings that are known to solve the task. Sources: RL Baselines3 Zoo for CartPole,
    /// LunarLander, Pendulum and grids; CleanRL's `ppo_continuous_action.py` for other continuous
    /// actions; CleanRL's `ppo_atari.py` for Atari.
    pub(crate) fn of(id: &str, task: Task) -> Self {
        let lander = Self {
            envs: 16,
            steps: 1024,
            minibatch: 256,
            epochs: 4,
            learning_rate: 5e-4,
            discount: 0.999,
            gae_lambda: 0.98,
            clip: 0.2,
            entropy_coefficient: 0.01,
            normalize: false,
        };
        if id.starts_with("CartPole") {
            return Self {
                envs: 8,
                steps: 32,
                epochs: 20,
                learning_rate: 1e-3,
                discount: 0.98,
                gae_lambda: 0.8,
                entropy_coefficient: 0.0,
                ..lander
            };
        }
        match task {
            Task::Discrete => return lander,
            Task::Atari => {
                return Self {
                    envs: 8,
                    steps: 128,
                    minibatch: 256,
                    epochs: 4,
                    learning_rate: 2.5e-4,
                    discount: 0.99,
                    gae_lambda: 0.95,
                    clip: 0.1,
                    entropy_coefficient: 0.01,
                    normalize: false,
                };
            }
            Task::Grid => {
                return Self {
                    envs: 8,
                    steps: 128,
                    minibatch: 64,
                    epochs: 10,
                    learning_rate: 2.5e-4,
                    discount: 0.99,
                    gae_lambda: 0.95,
                    entropy_coefficient: 0.0,
                    ..lander
                };
            }
            Task::Continuous | Task::Control => {}
        }
        let continuous = Self {
            envs: 8,
            steps: 256,
            minibatch: 64,
            epochs: 10,
            learning_rate: 3e-4,
            discount: 0.99,
            gae_lambda: 0.95,
            entropy_coefficient: 0.0,
            normalize: true,
            ..lander
        };
        if id.starts_with("Pendulum") {
            return Self {
                learning_rate: 1e-3,
                discount: 0.9,
                ..continuous
            };
        }
        if id.starts_with("Hopper") {
            // without an entropy bonus the agent learns to stand still
            return Self {
                entropy_coefficient: 0.002,
                ..continuous
            };
        }
        if id.starts_with("Swimmer") {
            // the reward for a swimming stroke comes many steps later
            return Self {
                discount: 0.9999,
                ..continuous
            };
        }
        continuous
    }

    /// Returns these settings with the overrides `given`, each `NAME=NUMBER`.
    pub(crate) fn with(&self, given: &[String]) -> Result<Self> {
        let mut all = serde_json::to_value(self)?;
        for text in given {
            let (name, value) = text
                .split_once('=')
                .with_context(|| format!("{text} is not NAME=NUMBER"))?;
            let known: Vec<&str> = all
                .as_object()
                .into_iter()
                .flat_map(|all| all.keys())
                .map(String::as_str)
                .collect();
            let known = known.join(", ");
            let setting = all
                .get_mut(name)
                .with_context(|| format!("unknown setting {name}: known are {known}"))?;
            *setting =
                serde_json::from_str::<Value>(value).with_context(|| format!("{name}: {value}"))?;
        }
        let settings: Self = serde_json::from_value(all).context("a setting is out of range")?;
        let Self {
            envs,
            steps,
            minibatch,
            epochs,
            ..
        } = settings;
        ensure!(
            [envs, steps, minibatch, epochs].iter().all(|n| *n > 0),
            "a setting that counts must be at least 1"
        );
        Ok(settings)
    }
}
