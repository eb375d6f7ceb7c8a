//! The names of the numbers that are observed: each family's, and those that follow from models.

use std::collections::BTreeMap;
use std::sync::Arc;

use gym::names::parts;
use gym::sim::engine::{Data, Model};
use gym::sim::{Naming, Observation, Settings, SimEnv, SimTask, Start};
use gym::{BoxEnv, Env, EnvExt, Names, Registration, Result, Value, builder, registry};

/// The registrations whose environments can be made here.
fn registrations() -> impl Iterator<Item = Registration> {
    let all = registry::all().into_iter();
    all.filter(|entry| entry.needs.is_none_or(|need| need.is_met()))
}

fn names_of(id: &str, env: &BoxEnv) -> Names {
    let names = registry::find(id).unwrap().page.names;
    names.map(|names| names(env)).unwrap_or_default()
}

/// Every number of an observation by its part and name.
fn numbers(env: &BoxEnv, names: &[String], observation: &Value) -> Vec<(String, f64)> {
    let space = env.observation_space();
    let mut found = Vec::new();
    for part in parts(&space, names).unwrap() {
        let keys = part.path.split('/').filter(|key| !key.is_empty());
        let value = keys.fold(observation, |value, key| match value {
            Value::Tuple(parts) => &parts[key.parse::<usize>().unwrap()],
            value => value.get(key).unwrap(),
        });
        let values: Vec<f64> = match value {
            Value::Array(array) => array.iter_f64().collect(),
            Value::Int(x) => vec![*x as f64],
            other => panic!("{other} has the names {:?}", part.names),
        };
        assert_eq!(values.len(), part.names.len(), "{}", part.path);
        found.extend(part.names.iter().cloned().zip(values));
    }
    found
}

#[test]
fn every_number_has_a_name() {
    let mut pictures = 0;
    for entry in registrations() {
        let (id, spec) = (entry.id(), entry.spec());
        let Ok(env) = spec.and_then(|spec| spec.make()) else {
            continue; // a ROM of another game
        };
        let names = names_of(id, &env);
        let (observation, action) = (env.observation_space(), env.action_space());
        parts(&observation, &names.observation).unwrap();
        parts(&action, &names.action).unwrap();
        let is_picture = observation.shape().is_some_and(|shape| shape.len() > 1);
        pictures += usize::from(is_picture);
        let is_foreign = entry.source.package == "gym-bridge";
        let is_tests_own = !entry.source.package.starts_with("gym-");
        if !is_picture && !is_foreign && !is_tests_own {
            assert!(!names.observation.is_empty(), "{id} names no number");
            let is_box = action.shape().is_some_and(|shape| !shape.is_empty());
            assert_eq!(names.action.is_empty(), !is_box, "{id}: {action}");
        }
    }
    assert!(pictures > 0, "CarRacing observes a picture");
}

#[test]
fn names_are_those_of_the_numbers() {
    for (id, at, expected) in [
        ("CartPole-v1", 3, "pole angular velocity (rad/s)"),
        ("Blackjack-v1", 1, "the dealer's open card"),
        ("LunarLander-v3", 5, "angular velocity (2.5 rad/s)"),
        (
            "BipedalWalker-v3",
            13,
            "whether the second leg touches the ground",
        ),
        (
            "MiniGrid-Empty-5x5-v0",
            0,
            "direction: 0 right, 1 down, 2 left, 3 up",
        ),
        ("HalfCheetah-v5", 0, "position of torso along z (m)"),
        ("HalfCheetah-v5", 1, "angle of torso about y (rad)"),
        ("HalfCheetah-v5", 2, "angle of bthigh (rad)"),
        ("HalfCheetah-v5", 16, "angular velocity of ffoot (rad/s)"),
        ("Ant-v5", 27, "contact torque about x on torso (N m)"),
        ("Ant-v4", 26, "angular velocity of ankle_4 (rad/s)"),
        ("Humanoid-v5", 45, "inertia xx of torso (kg m²)"),
        ("Humanoid-v4", 45, "inertia xx of world (kg m²)"),
        ("Reacher-v5", 8, "x from target to fingertip (m)"),
        ("dm_control/walker-walk-v0", 0, "height of torso (m)"),
        (
            "dm_control/fish-swim-v0",
            7,
            "x from mouth to target in the mouth's frame (m)",
        ),
        ("PointMaze_UMaze-v3", 3, "y of the goal (m)"),
        ("AdroitHandDoor-v1", 38, "1 if the door is open, else -1"),
    ] {
        let env = gym::make(id).unwrap();
        assert_eq!(names_of(id, &env).observation[at], expected, "{id}, {at}");
    }
    let action = |id: &str| names_of(id, &gym::make(id).unwrap()).action;
    assert_eq!(action("Hopper-v5")[0], "torque of thigh_joint (200 N m)");
    assert_eq!(
        action("dm_control/fish-swim-v0")[0],
        "target angle of tail (rad)"
    );
    assert_eq!(action("Pendulum-v1"), ["torque (N m)"]);
    assert!(action("CartPole-v1").is_empty());
}

#[test]
fn names_follow_the_arguments() {
    let first = |id: &str, name: &str, value: serde_json::Value| {
        let env = builder(id).arg(name, value).build().unwrap();
        names_of(id, &env).observation[0].clone()
    };
    let not_excluded = first(
        "HalfCheetah-v5",
        "exclude_current_positions_from_observation",
        false.into(),
    );
    assert_eq!(not_excluded, "position of torso along x (m)");
    // in the package's order, not in that of the parts' names
    let flat = first("dm_control/walker-walk-v0", "flat", true.into());
    assert_eq!(flat, "cosine of angle of torso");

    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("own.xml");
    let (_, text) = gym::mujoco::models()
        .find(|(name, _)| *name == "half_cheetah.xml")
        .unwrap();
    std::fs::write(&file, text.replace("\"bthigh\"", "\"hip of mine\"")).unwrap();
    let env = builder("HalfCheetah-v5")
        .arg("xml_file", file.to_str().unwrap())
        .build()
        .unwrap();
    let names = names_of("HalfCheetah-v5", &env);
    assert_eq!(names.observation[2], "angle of hip of mine (rad)");
    assert_eq!(names.action[0], "torque of hip of mine (120 N m)");

    let env = builder("dm_control/walker-walk-v0")
        .arg("pixels", 64)
        .build()
        .unwrap();
    assert!(
        names_of("dm_control/walker-walk-v0", &env)
            .observation
            .is_empty()
    );
}

/// A task that observes all positions, velocities and sensors.
#[derive(Debug)]
struct Everything;

impl SimTask for Everything {
    fn start(&self, _: &mut Start<'_>) -> Result<()> {
        Ok(())
    }

    fn observe(&self, _: &Model, d: &Data, out: &mut Observation) {
        out.extend(all(d));
    }

    fn names(&self, names: &mut Naming<'_>) {
        names.positions(..).velocities(..).sensors(..);
    }
}

/// All positions, velocities and values of sensors.
fn all(d: &Data) -> impl Iterator<Item = f64> {
    let state = d.qpos.iter().chain(&d.qvel);
    state.chain(&d.sensordata).copied()
}

/// A number that has the name of a position, of a velocity or of a sensor has its value.
#[test]
fn names_of_models_belong_to_their_numbers() {
    let mut compared = BTreeMap::new();
    for entry in registrations() {
        let id = entry.id();
        let Ok(mut env) = entry.spec().and_then(|spec| spec.make()) else {
            continue;
        };
        let names = names_of(id, &env).observation;
        // mazes differ in their walls alone
        let is_like_another = id.contains("Maze") && !id.contains("UMaze-");
        if env.layer::<SimEnv>().is_none() || is_like_another {
            continue;
        }
        let mut observation = env.reset(3).unwrap();
        let mut actions = env.action_sampler(3).unwrap();
        for _ in 0..2 {
            observation = env.step(&actions.sample()).unwrap().observation;
        }
        let sim = env.layer::<SimEnv>().unwrap();
        let settings = Settings::new("Everything", &());
        let probe = SimEnv::new(Arc::new(Everything), sim.simulation().clone(), settings).unwrap();
        let values: BTreeMap<_, _> = probe
            .names()
            .observation
            .into_iter()
            .zip(all(sim.data().unwrap()))
            .collect();
        let mut found = 0;
        for (name, x) in numbers(&env, &names, &observation) {
            let Some(expected) = values.get(&name) else {
                continue;
            };
            // runners clip velocities to 10, and the hammer's hand to 1
            let clipped = [10.0, 1.0].map(|most: f64| expected.clamp(-most, most));
            assert!(
                x == *expected || clipped.contains(&x),
                "{id}: {name} is {x}, not {expected}"
            );
            found += 1;
        }
        compared.insert(id.to_owned(), found);
    }
    assert!(compared.len() > 80, "{compared:?}");
    // lqr's masses have numbers, and no names
    let mut none = compared.iter().filter(|(_, found)| **found == 0);
    assert!(none.all(|(id, _)| id.contains("/lqr-")), "{compared:?}");
    assert_eq!(compared["HalfCheetah-v5"], 17);
    assert_eq!(compared["Humanoid-v5"], 45);
    assert_eq!(compared["dm_control/cheetah-run-v0"], 17);
}
