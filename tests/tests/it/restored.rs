//! What `restore` accepts: no number that is not finite, and of other ids only what continues as
//! the original.

use std::collections::BTreeMap;
use std::ops::Range;

use gym::registry;
use gym::{BoxEnv, Env, EnvExt, Snapshot};
use serde_json::{Value as Json, json};

use super::sample::one_per_module;

/// The environment some steps into an episode, where bodies touch each other.
pub(crate) fn played(id: &str) -> BoxEnv {
    let mut env = gym::make(id).unwrap_or_else(|error| panic!("{id}: {error}"));
    env.reset(3).unwrap();
    let mut actions = env.action_sampler(3).unwrap();
    for _ in 0..60 {
        let before = env.clone();
        if env.step(&actions.sample()).unwrap().done() {
            return before;
        }
    }
    env
}

/// The pointers to floats of a state. Of lists with more than 30 elements, those of the first two
/// and the last.
pub(crate) fn floats(json: &Json, pointer: &str, found: &mut Vec<String>) {
    match json {
        Json::Number(number) if number.is_f64() => found.push(pointer.to_owned()),
        Json::Array(items) => {
            for (i, item) in items.iter().enumerate() {
                if items.len() <= 30 || i < 2 || i == items.len() - 1 {
                    floats(item, &format!("{pointer}/{i}"), found);
                }
            }
        }
        Json::Object(map) => {
            for (key, part) in map {
                let key = key.replace('~', "~0").replace('/', "~1");
                floats(part, &format!("{pointer}/{key}"), found);
            }
        }
        _ => {}
    }
}

#[test]
fn no_number_that_is_not_finite_is_restored() {
    /// The most numbers of a state that are tried.
    const MOST: usize = 120;
    let mut accepted = Vec::new();
    for registration in one_per_module() {
        let id = registration.id();
        let mut env = played(id);
        let whole = env.snapshot().unwrap();
        let mut stored = serde_json::to_value(&whole).unwrap();
        let mut places = Vec::new();
        floats(&stored, "", &mut places);
        // large states take long to read: of these, some numbers evenly
        for place in places.iter().step_by(places.len().div_ceil(MOST).max(1)) {
            for bad in [json!({"$float": "NaN"}), json!(1e300)] {
                // a number of 64 bits may be large
                let is_large = bad.is_number();
                let part = stored.pointer_mut(place).unwrap();
                let good = std::mem::replace(part, bad);
                let damaged: Snapshot = serde_json::from_value(stored.clone()).unwrap();
                *stored.pointer_mut(place).unwrap() = good;
                if env.restore(&damaged).is_ok() {
                    let text = serde_json::to_string(&env.snapshot().unwrap()).unwrap();
                    if !is_large || text.contains("$float") {
                        accepted.push(format!("{id}: {place}"));
                    }
                    env.restore(&whole).unwrap();
                }
            }
        }
    }
    assert!(accepted.is_empty(), "{}", accepted.join("\n"));
}

/// Where a text has numbers with a point, also in the texts that it quotes.
fn numbers(text: &str) -> Vec<Range<usize>> {
    let mut found = Vec::new();
    let mut start = 0;
    for word in text.split_inclusive(|c: char| !"0123456789.eE+-".contains(c)) {
        let number = word.trim_end_matches(|c: char| !c.is_ascii_digit());
        if number.contains('.') && number.parse::<f64>().is_ok() {
            found.push(start..start + number.len());
        }
        start += word.len();
    }
    found
}

/// Worlds of bodies.
const WORLDS: [&str; 6] = [
    "LunarLander-v3",
    "BipedalWalkerHardcore-v3",
    "CarRacing-v3",
    "rapier/LunarLander-v3",
    "rapier/BipedalWalker-v3",
    "rapier/CarRacing-v3",
];

#[test]
fn every_state_of_an_episode_is_restored() {
    for id in WORLDS {
        let mut env = gym::make(id).unwrap();
        let mut actions = env.action_sampler(2).unwrap();
        for seed in 0..2 {
            env.reset(seed).unwrap();
            for step in 0..200 {
                if step % 4 == 0 {
                    let snapshot = env.snapshot().unwrap();
                    env.restore(&snapshot)
                        .unwrap_or_else(|error| panic!("{id}, step {step}: {error}"));
                }
                if env.step(&actions.sample()).unwrap().done() {
                    break;
                }
            }
        }
    }
}

/// Steps of a world multiply masses, lengths and speeds in `f32`.
#[test]
fn no_number_is_restored_of_which_a_step_makes_nan() {
    for id in WORLDS {
        let mut env = played(id);
        let stored = serde_json::to_string(&env.snapshot().unwrap()).unwrap();
        let action = env.action_space().zero().unwrap();
        let places = numbers(&stored);
        assert!(places.len() > 100, "{id}");
        for place in places.iter().step_by(places.len().div_ceil(150)) {
            for large in ["9.2e18", "9.9e4", "99.0"] {
                let mut text = stored.clone();
                text.replace_range(place.clone(), large);
                let damaged: Snapshot = serde_json::from_str(&text).unwrap();
                if env.restore(&damaged).is_err() {
                    continue;
                }
                for _ in 0..3 {
                    let step = env.step(&action).unwrap();
                    let mut numbers = step.observation.as_array().unwrap().iter_f64();
                    let before = &stored[place.start.saturating_sub(60)..place.end];
                    assert!(numbers.all(|x| !x.is_nan()), "{id}: {large} at {before}");
                    if step.done() {
                        break;
                    }
                }
            }
        }
    }
}

/// Ids whose environments are equal read each other's snapshots, and continue identically. All
/// others refuse them.
#[test]
fn a_snapshot_of_another_id_is_refused_or_continues_as_the_original() {
    let mut by_name: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for registration in registry::self_contained() {
        let id = registration.id();
        let name = id.rsplit_once("-v").map_or(id, |(name, _)| name);
        by_name
            .entry(name.to_owned())
            .or_default()
            .push(id.to_owned());
    }
    by_name.retain(|_, ids| ids.len() > 1);
    assert!(by_name.len() > 10, "{by_name:?}");
    let mut equal = Vec::new();
    for ids in by_name.values() {
        let envs: Vec<_> = ids.iter().map(|id| played(id)).collect();
        for (from, original) in ids.iter().zip(&envs) {
            let snapshot = original.snapshot().unwrap();
            for to in ids.iter().filter(|to| *to != from) {
                let mut other = gym::make(to).unwrap();
                if let Err(error) = other.restore(&snapshot) {
                    assert!(error.to_string().contains("cannot restore"), "{error}");
                    continue;
                }
                let mut original = original.clone();
                let mut actions = original.action_sampler(1).unwrap();
                for _ in 0..1200 {
                    let action = actions.sample();
                    let (ours, theirs) = (original.step(&action), other.step(&action));
                    let ours = ours.unwrap();
                    assert_eq!(theirs.unwrap(), ours, "{from} in {to}");
                    if ours.done() {
                        assert_eq!(original.reset(()).unwrap(), other.reset(()).unwrap());
                    }
                }
                assert_eq!(original.snapshot().unwrap(), other.snapshot().unwrap());
                equal.push(format!("{from} in {to}"));
            }
        }
    }
    assert!(equal.iter().all(|pair| !pair.starts_with("CartPole")));
    println!("{}", equal.join("\n"));
}
