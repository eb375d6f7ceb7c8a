//! numpy's generators, from which tasks draw the starts of episodes.

use gym_core::{Generator, RandomState};
use serde::{Deserialize, Serialize};

/// The generator of an environment's episodes.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub enum Rng {
    /// numpy's `default_rng`, as in Gymnasium.
    Generator(Generator),
    /// numpy's `RandomState`, as in dm_control, and a generator for wrappers.
    RandomState(Box<(RandomState, Generator)>),
}

impl Rng {
    /// The generator that wrappers draw from.
    pub(crate) fn generator(&mut self) -> &mut Generator {
        match self {
            Self::Generator(generator) => generator,
            Self::RandomState(both) => &mut both.1,
        }
    }

    /// Draws uniformly from `[0, 1)`.
    pub fn random(&mut self) -> f64 {
        match self {
            Self::Generator(generator) => generator.random(),
            Self::RandomState(both) => both.0.random(),
        }
    }

    /// Draws uniformly from `low` to `high`.
    pub fn uniform(&mut self, low: f64, high: f64) -> f64 {
        match self {
            Self::Generator(generator) => generator.uniform(low, high),
            Self::RandomState(both) => both.0.uniform(low, high),
        }
    }

    /// Draws from the standard normal distribution.
    pub fn standard_normal(&mut self) -> f64 {
        match self {
            Self::Generator(generator) => generator.standard_normal(),
            Self::RandomState(both) => both.0.standard_normal(),
        }
    }

    /// Draws one of `0..n`; 0 for `n` of 0.
    pub fn integer(&mut self, n: u32) -> u32 {
        match self {
            Self::Generator(generator) if n > 0 => generator.integers(0, i64::from(n)) as u32,
            Self::Generator(_) => 0,
            Self::RandomState(both) => both.0.randint(n),
        }
    }

    /// Draws an index with the probabilities `p`, which add up to 1.
    pub fn choice(&mut self, p: &[f64]) -> usize {
        let total: f64 = p.iter().sum();
        let drawn = self.random();
        let mut sum = 0.0;
        let beyond = p.iter().position(|p| {
            sum += p;
            drawn < sum / total
        });
        beyond.unwrap_or(p.len().saturating_sub(1))
    }
}
