//! Policies that `gym-ppo` trained and `export` wrote, one file for an environment in `docs/policies`.

use std::path::PathBuf;

use gym::wrappers::{RunningMeanStd, normalize_observation};
use gym::{Array, BoxEnv, Env, EnvSpec, Error, Result, Space, Value};
use serde::Deserialize;

use crate::policy::Controller;

/// Where they are, from the root of the workspace.
const FOLDER: &str = "docs/policies";

#[derive(Deserialize)]
struct Stored {
    env: EnvSpec,
    normalization: Option<RunningMeanStd>,
    /// Weights, inputs by outputs, and bias of each layer.
    network: Vec<Vec<f32>>,
}

/// The name of an environment's file: `half-cheetah` for `HalfCheetah-v5`.
fn file_name(id: &str) -> String {
    let name = id.rsplit_once("-v").map_or(id, |(name, _)| name);
    let mut file = String::new();
    for c in name.chars() {
        if c.is_ascii_uppercase() && !file.is_empty() {
            file.push('-');
        }
        file.push(c.to_ascii_lowercase());
    }
    file
}

fn path(id: &str) -> PathBuf {
    crate::root().join(FOLDER).join(file_name(id)).with_extension("json")
}

/// Whether there is a file for an id.
#[cfg(feature = "families")]
pub(crate) fn is_stored(id: &str) -> bool {
    path(id).exists()
}

/// What plays an environment; `None` if no policy for it is stored.
pub(crate) fn controller(env: &BoxEnv) -> Result<Option<Controller>> {
    let Some(spec) = env.spec() else { return Ok(None) };
    let path = path(&spec.id);
    let Ok(text) = std::fs::read_to_string(&path) else { return Ok(None) };
    let wrong = |reason: String| Error::custom(format!("{}: {reason}", path.display()));
    let Stored { env: trained, normalization, network } =
        serde_json::from_str(&text).map_err(|error| wrong(error.to_string()))?;
    if trained.id != spec.id {
        return Ok(None);
    }
    let Space::Box(space) = env.action_space() else {
        return Err(wrong(format!("the actions of {} are no numbers", spec.id)));
    };
    let bounds: Vec<(f64, f64)> = space.low().iter_f64().zip(space.high().iter_f64()).collect();
    let moments = normalization.map(|statistics| {
        let numbers = |array: Array| array.iter_f64().collect::<Vec<f64>>();
        (numbers(statistics.mean()), numbers(statistics.variance()))
    });
    let mut width = env.observation_space().shape().map_or(0, |shape| shape.iter().product::<usize>());
    if moments.as_ref().is_some_and(|(mean, _)| mean.len() != width) {
        return Err(wrong(format!("observations of {} have {width} numbers", spec.id)));
    }
    for layer in network.chunks(2) {
        let [weights, bias] = layer else { return Err(wrong("a layer has weights without a bias".into())) };
        if weights.len() != width * bias.len() {
            let [given, outputs] = [weights.len(), bias.len()];
            return Err(wrong(format!("{given} weights do not lead from {width} numbers to {outputs}")));
        }
        width = bias.len();
    }
    if width != bounds.len() {
        return Err(wrong(format!("{width} numbers are no action of {}", spec.id)));
    }
    Ok(Some(Box::new(move |_, seen| {
        let seen = seen.as_array()?;
        let x = match &moments {
            Some((mean, variance)) => {
                let moments = mean.iter().zip(variance);
                let normalized = seen.iter_f64().zip(moments).map(|(x, (m, v))| {
                    (x - m) / (v + normalize_observation::Config::default().epsilon).sqrt()
                });
                normalized.map(|x| x as f32).collect()
            }
            None => seen.iter_f64().map(|x| x as f32).collect(),
        };
        let action = forward(&network, x).into_iter().zip(&bounds);
        let clipped: Vec<f32> =
            action.map(|(a, (low, high))| f64::from(a).clamp(*low, *high) as f32).collect();
        Some(Value::Array(clipped.into()))
    })))
}

/// Linear layers with tanh between them.
fn forward(network: &[Vec<f32>], mut x: Vec<f32>) -> Vec<f32> {
    for (i, layer) in network.chunks(2).enumerate() {
        let [weights, bias] = layer else { return x };
        let outputs = bias.len();
        let sum =
            |j: usize| bias[j] + x.iter().enumerate().map(|(i, x)| x * weights[i * outputs + j]).sum::<f32>();
        let last = 2 * (i + 1) == network.len();
        x = (0..outputs).map(sum).map(|y| if last { y } else { y.tanh() }).collect();
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_named_like_pages() {
        assert_eq!(file_name("HalfCheetah-v5"), "half-cheetah");
        assert_eq!(file_name("Walker2d-v5"), "walker2d");
        assert_eq!(file_name("InvertedDoublePendulum-v5"), "inverted-double-pendulum");
    }

    #[test]
    fn a_network_is_layers_with_tanh_between() {
        // two numbers in, two hidden, one out
        let network = [vec![1.0, 0.0, 0.0, 2.0], vec![0.0, 0.5], vec![3.0, 1.0], vec![-1.0]];
        let y = forward(&network, vec![0.5, 0.25]);
        assert!((y[0] - (3.0 * 0.5f32.tanh() + 1.0f32.tanh() - 1.0)).abs() < 1e-6, "{y:?}");
    }

    #[test]
    fn the_stored_cheetah_runs() {
        let mut env = gym::make("HalfCheetah-v5").expect("it is registered");
        let episode = crate::policy::Policy::Trained.play(&mut env, 0, |_| Ok(())).expect("an episode");
        assert!(episode.episode_return > 4000.0, "{}", episode.episode_return);
    }
}
