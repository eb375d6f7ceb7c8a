//! Policies that play an environment well: rules, or a trained network.

use gym_numerics::math;
use serde_json::Value as Json;

use crate::env::{BoxEnv, Env};
use crate::spaces::Space;
use crate::value::{Element, Error, Result, Value};

/// Chooses the action for an observation; `None` if the value is not an observation of the
/// environment.
pub type Controller = Box<dyn FnMut(&BoxEnv, &Value) -> Option<Value>>;

/// A policy that plays an environment well, for
/// [`Registration::policy`](crate::Registration::policy).
#[derive(Clone, Copy, Debug)]
pub struct Policy {
    /// A phrase that continues "the good policy", such as "drives right".
    pub description: &'static str,
    source: Source,
}

#[derive(Clone, Copy, Debug)]
enum Source {
    Rules(fn(&BoxEnv) -> Option<Controller>),
    Network(&'static str),
}

impl Policy {
    /// Rules: `start` returns the controller of one episode, or `None` if the rules do not fit the
    /// arguments.
    pub const fn rules(
        description: &'static str,
        start: fn(&BoxEnv) -> Option<Controller>,
    ) -> Self {
        Self {
            description,
            source: Source::Rules(start),
        }
    }

    /// A network that `gym-ppo` trained and its command `export` wrote, in JSON.
    pub const fn network(json: &'static str) -> Self {
        Self {
            description: "is a network that `gym-ppo` trained",
            source: Source::Network(json),
        }
    }

    /// The controller of one episode; `None` if the policy does not fit the environment's
    /// arguments.
    ///
    /// # Errors
    /// A network that is damaged, or does not fit the environment's spaces.
    pub fn controller(&self, env: &BoxEnv) -> Result<Option<Controller>> {
        match self.source {
            Source::Rules(start) => Ok(start(env)),
            Source::Network(json) => network(json, env).map(Some),
        }
    }
}

/// A controller that depends only on the observation.
pub fn reflex<O: Element, A: Element>(
    mut act: impl FnMut(&O) -> A + 'static,
) -> Option<Controller> {
    Some(Box::new(move |_, seen| {
        O::with(seen, |seen| act(seen).to_value())
    }))
}

/// Added to the variance, as by the wrapper `NormalizeObservation`.
const EPSILON: f64 = 1e-8;

fn network(json: &str, env: &BoxEnv) -> Result<Controller> {
    let wrong = |reason: String| Error::argument(format!("the network of {env}"), reason);
    let stored: Json = serde_json::from_str(json).map_err(|error| wrong(error.to_string()))?;
    // weights, inputs by outputs, and bias of each layer
    let layers: Vec<Vec<f32>> = serde_json::from_value(stored["network"].clone())
        .map_err(|error| wrong(format!("`network`: {error}")))?;
    let numbers = |name: &str| -> Result<Option<Vec<f64>>> {
        let numbers = stored.pointer(&format!("/normalization/moments/F64/{name}"));
        let numbers = numbers
            .map(|numbers| serde_json::from_value(numbers.clone()))
            .transpose();
        numbers.map_err(|error| wrong(format!("`{name}`: {error}")))
    };
    let moments = numbers("mean")?.zip(numbers("var")?);
    let Space::Box(space) = env.action_space() else {
        return Err(wrong("actions are not in a Box".into()));
    };
    let bounds: Vec<(f64, f64)> = space
        .low()
        .iter_f64()
        .zip(space.high().iter_f64())
        .collect();
    let mut width = env
        .observation_space()
        .shape()
        .map_or(0, |shape| shape.iter().product::<usize>());
    if moments
        .as_ref()
        .is_some_and(|(mean, var)| mean.len() != width || var.len() != width)
    {
        return Err(wrong(format!(
            "its input does not fit observations of {width} numbers"
        )));
    }
    for layer in layers.chunks(2) {
        let [weights, bias] = layer else {
            return Err(wrong("a layer has weights without a bias".into()));
        };
        if weights.len() != width * bias.len() {
            let [given, outputs] = [weights.len(), bias.len()];
            return Err(wrong(format!(
                "a layer from {width} to {outputs} numbers has {given} weights"
            )));
        }
        width = bias.len();
    }
    if width != bounds.len() {
        return Err(wrong(format!(
            "its output has {width} numbers, and an action {}",
            bounds.len()
        )));
    }
    Ok(Box::new(move |_, seen| {
        let seen = seen.as_array()?.iter_f64();
        let x = match &moments {
            Some((mean, var)) => seen
                .zip(mean.iter().zip(var))
                .map(|(x, (m, v))| ((x - m) / (v + EPSILON).sqrt()) as f32)
                .collect(),
            None => seen.map(|x| x as f32).collect(),
        };
        let action = forward(&layers, x).into_iter().zip(&bounds);
        let clipped: Vec<f32> = action
            .map(|(a, (low, high))| f64::from(a).clamp(*low, *high) as f32)
            .collect();
        Some(Value::Array(clipped.into()))
    }))
}

/// Linear layers with tanh between them.
fn forward(layers: &[Vec<f32>], mut x: Vec<f32>) -> Vec<f32> {
    for (i, layer) in layers.chunks(2).enumerate() {
        let [weights, bias] = layer else { return x };
        let outputs = bias.len();
        let sum = |j: usize| {
            bias[j]
                + x.iter()
                    .enumerate()
                    .map(|(i, x)| x * weights[i * outputs + j])
                    .sum::<f32>()
        };
        let last = 2 * (i + 1) == layers.len();
        x = (0..outputs)
            .map(sum)
            .map(|y| if last { y } else { math::tanh(y.into()) as f32 })
            .collect();
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_network_is_layers_with_tanh_between() {
        // two numbers in, two hidden, one out
        let layers = [
            vec![1.0, 0.0, 0.0, 2.0],
            vec![0.0, 0.5],
            vec![3.0, 1.0],
            vec![-1.0],
        ];
        let y = forward(&layers, vec![0.5, 0.25]);
        assert!(
            (y[0] - (3.0 * math::tanh(0.5) + math::tanh(1.0) - 1.0) as f32).abs() < 1e-6,
            "{y:?}"
        );
    }
}
