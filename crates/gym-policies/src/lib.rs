//! Trained policies for environments: networks, and a function that runs them.
//!
//! Linking this crate gives six MuJoCo tasks and three of the Control Suite a good policy. If your code names
//! nothing else of it, name it once: `use gym_policies as _;`. For an environment of your own, call
//! [`network`]:
//!
//! ```
//! use gym_core::Policy;
//!
//! const POLICY: Policy = Policy::trained("is a network", |env| {
//!     gym_policies::network("the text of the exported file", env)
//! });
//! ```
#![warn(clippy::disallowed_methods)]

use gym_core::policy::{Controller, LinkedPolicy};
use gym_core::{BoxEnv, DType, Env, Error, Policy, Result, Space, Value, inventory, math};
use serde_json::Value as Json;

/// The policy of an environment, by the network that `controller` reads.
const fn trained(id: &'static str, controller: fn(&BoxEnv) -> Result<Controller>) -> LinkedPolicy {
    let policy = Policy::trained("is a network that `gym-ppo` trained", controller);
    LinkedPolicy { id, policy }
}

inventory::submit! {
    trained("HalfCheetah-v5", |env| network(include_str!("../networks/half-cheetah.json"), env))
}
inventory::submit! {
    trained("Hopper-v5", |env| network(include_str!("../networks/hopper.json"), env))
}
inventory::submit! {
    trained("InvertedDoublePendulum-v5", |env| network(include_str!("../networks/inverted-double-pendulum.json"), env))
}
inventory::submit! {
    trained("InvertedPendulum-v5", |env| network(include_str!("../networks/inverted-pendulum.json"), env))
}
inventory::submit! {
    trained("Reacher-v5", |env| network(include_str!("../networks/reacher.json"), env))
}
inventory::submit! {
    trained("Swimmer-v5", |env| network(include_str!("../networks/swimmer.json"), env))
}
inventory::submit! {
    trained("dm_control/cartpole-swingup-v0", |env| {
        network_of_parts(include_str!("../networks/cartpole-swingup.json"), &["position", "velocity"], env)
    })
}
inventory::submit! {
    trained("dm_control/cheetah-run-v0", |env| {
        network_of_parts(include_str!("../networks/cheetah-run.json"), &["position", "velocity"], env)
    })
}
inventory::submit! {
    trained("dm_control/walker-walk-v0", |env| {
        let parts = &["orientations", "height", "velocity"];
        network_of_parts(include_str!("../networks/walker-walk.json"), parts, env)
    })
}

/// The number that the wrapper `NormalizeObservation` adds to the variance.
const EPSILON: f64 = 1e-8;

/// The controller of a network that `gym-ppo` trained and its command `export` wrote, in JSON.
///
/// # Errors
/// [`Error::InvalidArgument`] for a network that is damaged or does not fit the spaces of `env`.
pub fn network(json: &str, env: &BoxEnv) -> Result<Controller> {
    network_of_parts(json, &[], env)
}

/// As [`network`], for an environment that observes a dict. The network was trained on the dict's
/// entries as one vector, for instance on `dm_control/walker-walk-v0` with `flat=true`. `parts`
/// names the entries in the order of the vector.
///
/// # Errors
/// Those of [`network`].
pub fn network_of_parts(
    json: &str,
    parts: &'static [&'static str],
    env: &BoxEnv,
) -> Result<Controller> {
    let wrong = |reason: String| Error::argument(format!("the network of {env}"), reason);
    let stored: Json = serde_json::from_str(json).map_err(|error| wrong(error.to_string()))?;
    // weights, inputs by outputs, and bias of each layer
    let layers: Vec<Vec<f32>> = serde_json::from_value(stored["network"].clone())
        .map_err(|error| wrong(format!("`network`: {error}")))?;
    // `moments` has one entry, named by the dtype of the observations in training: F32 or F64
    let moments = (stored["normalization"]["moments"].as_object())
        .and_then(|moments| moments.values().next());
    let numbers = |moments: &Json, name: &str| -> Result<Vec<f64>> {
        serde_json::from_value(moments[name].clone())
            .map_err(|error| wrong(format!("`{name}`: {error}")))
    };
    let moments = moments
        .map(|moments| Ok::<_, Error>((numbers(moments, "mean")?, numbers(moments, "var")?)))
        .transpose()?;
    let Space::Box(space) = env.action_space() else {
        return Err(wrong("actions are not in a Box".into()));
    };
    let bounds: Vec<(f64, f64)> = space
        .low()
        .iter_f64()
        .zip(space.high().iter_f64())
        .collect();
    let mut width = match env.observation_space() {
        Space::Dict(dict) => {
            let missing = |part| wrong(format!("the observation has no part `{part}`"));
            let sizes = parts
                .iter()
                .map(|part| dict.get(part).map(size).ok_or_else(|| missing(part)));
            sizes.sum::<Result<usize>>()?
        }
        space => size(&space),
    };
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
    let dtype = space.dtype();
    Ok(Box::new(move |_, seen| {
        let seen = numbers_of(seen, parts)?;
        let x = match &moments {
            Some((mean, var)) => seen
                .into_iter()
                .zip(mean.iter().zip(var))
                .map(|(x, (m, v))| ((x - m) / (v + EPSILON).sqrt()) as f32)
                .collect(),
            None => seen.into_iter().map(|x| x as f32).collect(),
        };
        let action = forward(&layers, x).into_iter().zip(&bounds);
        let clipped: Vec<f32> = action
            .map(|(a, (low, high))| f64::from(a).clamp(*low, *high) as f32)
            .collect();
        Some(Value::Array(if dtype == DType::F64 {
            clipped
                .into_iter()
                .map(f64::from)
                .collect::<Vec<_>>()
                .into()
        } else {
            clipped.into()
        }))
    }))
}

/// How many numbers an observation of `space` has.
fn size(space: &Space) -> usize {
    space.shape().map_or(0, |shape| shape.iter().product())
}

/// Returns the numbers of an observation: of an array, or of the entries `parts` of a dict, in this
/// order.
fn numbers_of(seen: &Value, parts: &[&str]) -> Option<Vec<f64>> {
    if let Some(array) = seen.as_array() {
        return Some(array.iter_f64().collect());
    }
    let mut numbers = Vec::new();
    for part in parts {
        numbers.extend(seen.get(part)?.as_array()?.iter_f64());
    }
    Some(numbers)
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

/// The example of the README, compiled and run.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

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

    #[test]
    fn every_network_plays_its_environment() {
        use gym_control as _;
        use gym_core::{EnvExt, make, registry};
        use gym_mujoco as _;

        let mut played = 0;
        for registration in registry::all() {
            let policy = registration.page.policy;
            let Some(policy) = policy.filter(|policy| policy.description.contains("network"))
            else {
                continue;
            };
            let mut env = make(registration.id()).unwrap();
            let mut controller = policy.controller(&env).unwrap().unwrap();
            let observation = env.reset(0).unwrap();
            let action = controller(&env, &observation).unwrap();
            assert!(env.action_space().contains(&action), "{env}: {action}");
            env.step(&action).unwrap();
            played += 1;
        }
        assert_eq!(played, 9);
    }

    #[test]
    fn a_network_reads_a_dict_as_the_vector_that_it_was_trained_on() {
        use gym_control as _;
        use gym_core::{EnvExt, builder};

        // from 24 numbers to 6 actions
        let weights: Vec<f32> = (0..144).map(|i| (i % 7) as f32 * 0.02 - 0.06).collect();
        let bias = vec![0.0; 6];
        let means = vec![0.5_f32; 24];
        let normalization = serde_json::json!({"moments": {"F32": {"mean": means, "var": means}}});
        let plain = serde_json::json!({"network": [weights, bias]}).to_string();
        let json = serde_json::json!({"network": [weights, bias], "normalization": normalization});
        let json = json.to_string();
        let played = |json: &str, flat: bool, parts: &'static [&'static str]| {
            let id = "dm_control/walker-walk-v0";
            let mut env = builder(id).arg("flat", flat).build().unwrap();
            let mut controller = network_of_parts(json, parts, &env).unwrap();
            let observation = env.reset(3).unwrap();
            let action = controller(&env, &observation).unwrap();
            assert!(env.action_space().contains(&action), "{action}");
            action
        };
        let vector = played(&json, true, &[]);
        assert_eq!(
            vector,
            played(&json, false, &["orientations", "height", "velocity"])
        );
        assert_ne!(
            vector,
            played(&json, false, &["height", "orientations", "velocity"])
        );
        assert_ne!(
            vector,
            played(&plain, true, &[]),
            "observations are normalized"
        );
        let env = gym_core::make("dm_control/walker-walk-v0").unwrap();
        let error = network_of_parts(&json, &["height", "speed"], &env);
        let error = error.err().unwrap().to_string();
        assert!(error.contains("has no part `speed`"), "{error}");
    }

    #[test]
    fn a_network_of_other_spaces_is_refused() {
        use gym_mujoco as _;

        let env = gym_core::make("Ant-v5").unwrap();
        let error = network(include_str!("../networks/hopper.json"), &env);
        let error = error.err().unwrap().to_string();
        assert!(error.contains("does not fit observations of"), "{error}");
        let error = network("[", &env).err().unwrap().to_string();
        assert!(error.contains("the network of"), "{error}");
    }

    /// An observation less its mean, by its deviation; then a layer; then the bounds of the action.
    #[test]
    fn an_action_is_the_clipped_sum_of_normalized_numbers() {
        use gym_control as _;
        use gym_mujoco as _;

        let (seen, weights) = ([0.5, -2.0, 1.5, 3.0], [0.25, -0.5, 1.0, 0.125]);
        let (mean, var) = ([0.0, 1.0, 0.5, 2.0], [1.0, 4.0, 0.0, 0.25]);
        let moments = serde_json::json!({"F64": {"mean": mean, "var": var}});
        // of 64 bits, from -3 to 3; of the variance 0, the number that is added remains
        let env = gym_core::make("InvertedPendulum-v5").unwrap();
        let act = |bias: f64, divisor: f64| {
            let weights = weights.map(|weight| weight / divisor);
            let json = serde_json::json!({
                "network": [weights, [bias]], "normalization": {"moments": moments}
            });
            let mut controller = network(&json.to_string(), &env).unwrap();
            let action = controller(&env, &Value::from(seen)).unwrap();
            action.as_array().unwrap().iter_f64().next().unwrap()
        };
        let normal = |i: usize| (seen[i] - mean[i]) / (var[i] + 1e-8_f64).sqrt();
        let sum: f64 = (0..4).map(|i| normal(i) * weights[i]).sum();
        assert!((act(0.25, 1e4) - (sum / 1e4 + 0.25)).abs() < 1e-6);
        assert_eq!([act(0.0, 1.0), act(0.0, -1.0)], [3.0, -3.0]);
    }

    #[test]
    fn a_damaged_network_tells_the_damage() {
        use gym_mujoco as _;

        let env = gym_core::make("InvertedPendulum-v5").unwrap();
        let told = |json: Json| {
            let made = network(&json.to_string(), &env).map(drop);
            made.map_or_else(|error| error.to_string(), |()| "made".into())
        };
        let moments = |mean: Json, var: Json| {
            let moments = serde_json::json!({"F32": {"mean": mean, "var": var}});
            let layers = serde_json::json!([[1, 2, 3, 4], [5]]);
            told(serde_json::json!({"network": layers, "normalization": {"moments": moments}}))
        };
        let layers = |layers: Json| told(serde_json::json!({"network": layers}));
        let four = || serde_json::json!([1, 1, 1, 1]);
        let input = "its input does not fit observations of 4 numbers";
        assert_eq!(layers(serde_json::json!([[1, 2, 3, 4], [5]])), "made");
        assert_eq!(moments(four(), four()), "made");
        for (told, reason) in [
            (
                layers(serde_json::json!([[1, 2, 3, 4]])),
                "a layer has weights without a bias",
            ),
            (
                layers(serde_json::json!([[1, 2, 3], [5]])),
                "a layer from 4 to 1 numbers has 3 weights",
            ),
            (
                layers(serde_json::json!([
                    [1, 2, 3, 4, 5, 6, 7, 8],
                    [5, 6],
                    [1],
                    [2]
                ])),
                "a layer from 2 to 1 numbers has 1 weights",
            ),
            (
                layers(serde_json::json!([[1, 2, 3, 4, 5, 6, 7, 8], [5, 6]])),
                "its output has 2 numbers, and an action 1",
            ),
            (
                layers(serde_json::json!([])),
                "its output has 4 numbers, and an action 1",
            ),
            (moments(serde_json::json!([1, 1, 1]), four()), input),
            (moments(four(), serde_json::json!([1, 1, 1, 1, 1])), input),
        ] {
            assert_eq!(
                told,
                format!("invalid argument for the network of {env}: {reason}")
            );
        }
        for (told, part) in [
            (layers(serde_json::json!("x")), "`network`: "),
            (moments(serde_json::json!("x"), four()), "`mean`: "),
            (moments(four(), serde_json::json!("x")), "`var`: "),
        ] {
            let start = format!("invalid argument for the network of {env}: {part}");
            assert!(told.starts_with(&start), "{told}");
        }
    }
}
