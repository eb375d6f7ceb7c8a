//! What the algorithm leaves open.

use serde::{Deserialize, Serialize};

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Settings {
    pub(crate) envs: usize,
    /// Steps of each environment between two rounds of learning.
    pub(crate) steps: usize,
    pub(crate) minibatch: usize,
    pub(crate) epochs: usize,
    pub(crate) learning_rate: f64,
    pub(crate) discount: f32,
    pub(crate) gae_lambda: f32,
    pub(crate) clip: f64,
    pub(crate) entropy_coefficient: f64,
    /// Whether observations and rewards are normalized.
    pub(crate) normalize: bool,
}

impl Settings {
    /// Settings found good for a task. Those of CartPole, LunarLander and Pendulum follow RL Baselines3 Zoo,
    /// those of other continuous actions CleanRL's `ppo_continuous_action.py`.
    pub(crate) fn of(id: &str, continuous: bool) -> Self {
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
        if !continuous {
            return lander;
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
            return Self { learning_rate: 1e-3, discount: 0.9, ..continuous };
        }
        continuous
    }
}
