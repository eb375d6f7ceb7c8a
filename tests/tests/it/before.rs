//! After a reset with a seed, and after a restore, nothing depends on what was before: not even on
//! absurd states, which leave NaN and huge numbers in every buffer that an engine works with.

use gym::vector::{Autoreset, Columns, VectorEnv, VectorEnvExt, VectorReset};
use gym::{Array, BoxEnv, Data, Env, EnvExt, Snapshot, Space, Value};
use serde_json::{Value as Json, json};

use super::native::native;
use super::restored::{floats, played};
use super::sample::one_per_module;

/// The most numbers of a state that are replaced.
const MOST: usize = 12;
/// Numbers that no episode reaches, but a state may have.
const FAR: [f64; 3] = [1e300, -1e30, 5e-324];

/// A digest of some steps, and the state after them.
fn episode(env: &mut BoxEnv, first: Option<&Value>) -> Vec<String> {
    let mut shown = vec![format!("{first:?}")];
    let mut actions = env.action_sampler(1).unwrap();
    for _ in 0..20 {
        let step = env.step(&actions.sample()).unwrap();
        let infos = env.info_map();
        shown.push(format!("{:?} {} {infos:?}", step.observation, step.reward));
        if step.done() {
            break;
        }
    }
    shown.push(serde_json::to_string(&env.snapshot().unwrap()).unwrap());
    shown
}

/// Actions at the ends of the numbers of a box, which some environments take; else a sample.
fn far_actions(space: &Space) -> Vec<Value> {
    let Space::Box(numbers) = space else {
        return vec![space.sampler(2).sample()];
    };
    let (low, high) = numbers.dtype().finite_range();
    let all = |x: f64| {
        let data = Data::from_f64(numbers.dtype(), vec![x; numbers.low().len()]);
        Value::Array(Array::new(numbers.shape(), data).unwrap())
    };
    [low, high, 0.0].map(all).to_vec()
}

/// The snapshots with a number replaced.
fn absurd(whole: &Snapshot, most: usize) -> Vec<Snapshot> {
    let mut stored = serde_json::to_value(whole).unwrap();
    let mut places = Vec::new();
    floats(&stored, "", &mut places);
    let every = places.len().div_ceil(most).max(1);
    let mut snapshots = Vec::new();
    for place in places.iter().step_by(every) {
        for far in FAR {
            let part = stored.pointer_mut(place).unwrap();
            let good = std::mem::replace(part, json!(far));
            snapshots.push(serde_json::from_value(stored.clone()).unwrap());
            *stored.pointer_mut(place).unwrap() = good;
        }
    }
    snapshots
}

/// Replaces each number of a state.
fn replaced(state: &Json, far: f64) -> Json {
    match state {
        Json::Number(_) => json!(far),
        Json::Array(items) => items.iter().map(|item| replaced(item, far)).collect(),
        Json::Object(map) => {
            let parts = map.iter();
            let parts = parts.map(|(key, part)| (key.clone(), replaced(part, far)));
            Json::Object(parts.collect())
        }
        other => other.clone(),
    }
}

/// Brings an environment into absurd states, as far as it takes them, and steps from each.
fn spoil(env: &mut BoxEnv, absurd: &[Snapshot]) -> usize {
    let far = far_actions(&env.action_space());
    let steps = |env: &mut BoxEnv| {
        for action in &far {
            // an absurd state may be an error of the step
            if env.step(action).map_or(true, |step| step.done()) {
                break;
            }
        }
    };
    let mut taken = 0;
    for snapshot in absurd {
        if env.restore(snapshot).is_ok() {
            taken += 1;
            steps(env);
        }
    }
    for far in FAR {
        let inspect = env.inspect_mut();
        let state = inspect.and_then(|inspect| inspect.state().map(|state| (inspect, state)));
        if let Some((inspect, state)) = state
            && inspect.set_state(replaced(&state, far)).is_ok()
        {
            taken += 1;
            steps(env);
        }
    }
    taken
}

#[test]
fn no_number_passes_from_one_episode_to_the_next() {
    let (mut wrong, mut taken) = (Vec::new(), 0);
    for registration in one_per_module() {
        let id = registration.id();
        let make = || gym::make(id).unwrap();
        let mut fresh = make();
        let first = fresh.reset(5).unwrap();
        let snapshot = fresh.snapshot().unwrap();
        let expected = episode(&mut fresh, Some(&first));
        let whole = played(id).snapshot().unwrap();
        let absurd = absurd(&whole, MOST);
        let mut used = make();
        used.reset(8).unwrap();
        taken += spoil(&mut used, &absurd);
        let first = used.reset(5).unwrap();
        if episode(&mut used, Some(&first)) != expected {
            wrong.push(format!("{id} after a reset"));
        }
        spoil(&mut used, &absurd);
        used.restore(&snapshot).unwrap();
        if episode(&mut used, None)[1..] != expected[1..] {
            wrong.push(format!("{id} after a restore"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(taken > 100, "only {taken} absurd states were taken");
}

/// A digest of a reset and some steps of a vector, and its state after them.
fn episodes(envs: &mut dyn VectorEnv, columns: &mut Columns) -> Vec<String> {
    let mut shown = Vec::new();
    let show = |envs: &dyn VectorEnv, columns: &Columns| {
        let Columns {
            observations,
            rewards,
            terminated,
            truncated,
            ..
        } = columns;
        let infos = envs.infos(columns);
        format!("{observations:?} {rewards:?} {terminated:?} {truncated:?} {infos:?}")
    };
    envs.reset_into(&VectorReset::from(5), columns).unwrap();
    shown.push(show(envs, columns));
    let mut actions = envs.action_sampler(1).unwrap();
    for _ in 0..12 {
        envs.step_into(&actions.sample(), columns).unwrap();
        shown.push(show(envs, columns));
    }
    shown.push(serde_json::to_string(&envs.snapshot().unwrap()).unwrap());
    shown
}

#[test]
fn no_number_passes_from_one_episode_of_a_native_vector_to_the_next() {
    /// No multiple of the number of lanes.
    const N: usize = 11;
    let (mut wrong, mut taken) = (Vec::new(), 0);
    for registration in one_per_module() {
        let spec = registration.spec().unwrap();
        let make = || native(&spec, N, Autoreset::NextStep);
        let Ok(mut fresh) = make() else { continue };
        let mut columns = fresh.columns().unwrap();
        let expected = episodes(&mut *fresh, &mut columns);
        let absurd = absurd(&fresh.snapshot().unwrap(), MOST);
        let mut used = make().unwrap();
        let mut columns = used.columns().unwrap();
        let mut actions = used.action_sampler(2).unwrap();
        for snapshot in &absurd {
            if used.restore(snapshot).is_ok() {
                taken += 1;
                for _ in 0..3 {
                    // an absurd state may be an error of the step
                    let _ = used.step_into(&actions.sample(), &mut columns);
                }
            }
        }
        if episodes(&mut *used, &mut columns) != expected {
            wrong.push(spec.id.clone());
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(taken > 20, "only {taken} absurd states were taken");
}
