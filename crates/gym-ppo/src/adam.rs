//! The Adam optimizer (Kingma and Ba, 2015). Its state can be stored; the state of candle's
//! optimizer is private.

use candle_core::{Tensor, Var, backprop::GradStore};
use serde::{Deserialize, Serialize};

use crate::numbers::{self, Numbers};

type Result<T> = candle_core::Result<T>;

const BETA_1: f64 = 0.9;
const BETA_2: f64 = 0.999;
/// The value of OpenAI Baselines' PPO.
const EPSILON: f64 = 1e-5;

/// Variables and the running moments of their gradients.
pub(crate) struct Adam {
    pub(crate) variables: Vec<Var>,
    first: Vec<Tensor>,
    second: Vec<Tensor>,
    steps: i32,
}

/// The stored form of [`Adam`], variables included.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct StoredAdam {
    pub(crate) variables: Vec<Numbers>,
    first: Vec<Numbers>,
    second: Vec<Numbers>,
    steps: i32,
}

impl Adam {
    pub(crate) fn new(variables: Vec<Var>) -> Result<Self> {
        let zeros = || {
            variables
                .iter()
                .map(|variable| variable.zeros_like())
                .collect::<Result<Vec<_>>>()
        };
        let (first, second) = (zeros()?, zeros()?);
        Ok(Self {
            variables,
            first,
            second,
            steps: 0,
        })
    }

    /// Moves the variables against `gradients`.
    pub(crate) fn step(&mut self, gradients: &GradStore, learning_rate: f64) -> Result<()> {
        self.steps += 1;
        let [scale_1, scale_2] = [BETA_1, BETA_2].map(|beta| 1.0 / (1.0 - beta.powi(self.steps)));
        let moments = self.first.iter_mut().zip(&mut self.second);
        for (variable, (first, second)) in self.variables.iter().zip(moments) {
            let Some(gradient) = gradients.get(variable) else {
                continue;
            };
            *first = ((&*first * BETA_1)? + (gradient * (1.0 - BETA_1))?)?.detach();
            *second = ((&*second * BETA_2)? + (gradient.sqr()? * (1.0 - BETA_2))?)?.detach();
            let deviation = ((&*second * scale_2)?.sqrt()? + EPSILON)?;
            let change = ((&*first * scale_1)? / deviation)?;
            variable.set(&(variable.as_tensor() - (change * learning_rate)?)?)?;
        }
        Ok(())
    }

    pub(crate) fn store(&self) -> Result<StoredAdam> {
        let numbers =
            |tensors: &[Tensor]| tensors.iter().map(numbers::of).collect::<Result<Vec<_>>>();
        let variables: Vec<Tensor> = self
            .variables
            .iter()
            .map(|variable| variable.as_tensor().clone())
            .collect();
        Ok(StoredAdam {
            variables: numbers(&variables)?,
            first: numbers(&self.first)?,
            second: numbers(&self.second)?,
            steps: self.steps,
        })
    }

    /// Continues from `stored`, the state of an agent with the same networks.
    pub(crate) fn restore(&mut self, stored: &StoredAdam) -> anyhow::Result<()> {
        let tensors = |all: &[Numbers]| -> anyhow::Result<Vec<Tensor>> {
            let fits = all.len() == self.variables.len();
            anyhow::ensure!(
                fits,
                "the checkpoint has {} variables, and the agent {}",
                all.len(),
                self.variables.len()
            );
            all.iter()
                .zip(&self.variables)
                .map(|(numbers, variable)| numbers::tensor(numbers, variable))
                .collect()
        };
        let (variables, first, second) = (
            tensors(&stored.variables)?,
            tensors(&stored.first)?,
            tensors(&stored.second)?,
        );
        for (variable, tensor) in self.variables.iter().zip(&variables) {
            variable.set(tensor)?;
        }
        (self.first, self.second, self.steps) = (first, second, stored.steps);
        Ok(())
    }
}
