//! `Inspect` in every environment: state, arguments and table.

use gym::registry::{self, VectorKind};
use gym::vector::VectorEnvExt;
use gym::{Env, EnvExt, Inspect};
use serde_json::{Value as Json, json};

const IDS: [&str; 9] = [
    "CartPole-v1",
    "MountainCar-v0",
    "MountainCarContinuous-v0",
    "Pendulum-v1",
    "Acrobot-v1",
    "Blackjack-v1",
    "CliffWalking-v1",
    "FrozenLake-v1",
    "Taxi-v4",
];

/// `Inspect` shows the arguments of the id, and refuses unknown arguments, states and tables. Tests
/// every environment that needs no ROM and no Python.
#[test]
fn arguments_are_those_of_the_id() {
    let mut seen = 0;
    for registration in registry::self_contained() {
        let id = registration.id();
        let mut env = gym::make(id).unwrap();
        let Some(inspect) = env.inspect() else {
            // GymV26Environment runs in a worker process, and one environment exists only for tests
            continue;
        };
        seen += 1;
        let arguments = inspect.arguments();
        for argument in registration.arguments().unwrap() {
            // where the default is null, the environment draws the value
            assert!(
                arguments[argument.name] == argument.default || argument.default.is_null(),
                "{id}: {} is {} for {}",
                argument.name,
                arguments[argument.name],
                argument.default
            );
        }
        let inspect = env.inspect_mut().unwrap();
        assert!(inspect.set_argument("no_such_argument", json!(1)).is_err());
        assert!(inspect.set_state(json!("no state")).is_err(), "{id}");
        assert!(inspect.set_table(json!({"P": []})).is_err(), "{id}");
    }
    assert!(seen >= 40, "{seen} environments can be inspected");
}

/// An environment with the state and the generator of another environment steps as the other
/// environment.
#[test]
fn states_can_be_set() {
    let tasks = ["Hopper-v5", "Ant-v5", "Reacher-v5"];
    for id in IDS.into_iter().chain(tasks) {
        let [mut env, mut other] = [3, 4].map(|seed| {
            let mut env = gym::make(id).unwrap();
            assert!(env.inspect_mut().unwrap().set_state(json!({})).is_err());
            env.reset(seed).unwrap();
            env
        });
        let state = env.inspect().and_then(Inspect::state).unwrap();
        other
            .inspect_mut()
            .unwrap()
            .set_state(state.clone())
            .unwrap();
        assert_eq!(
            other.inspect().and_then(Inspect::state),
            Some(state),
            "{id}"
        );
        *other.generator().unwrap() = env.generator().unwrap().clone();
        let action = env.action_sampler(5).unwrap().sample();
        let [a, b] = [&mut env, &mut other].map(|env| env.step(&action).unwrap());
        assert_eq!(a, b, "{id}");
    }
}

#[test]
fn an_argument_that_is_set_counts_from_the_next_step() {
    let mut env = gym::make("CartPole-v1").unwrap();
    let mut made = gym::builder("CartPole-v1")
        .arg("gravity", 1.62)
        .build()
        .unwrap();
    let actions = [1, 0, 1, 1].map(gym::Value::Int);
    for env in [&mut env, &mut made] {
        env.reset(0).unwrap();
    }
    let inspect = env.inspect_mut().unwrap();
    inspect.set_argument("gravity", json!(1.62)).unwrap();
    assert_eq!(inspect.arguments()["gravity"], 1.62);
    for action in &actions {
        assert_eq!(env.step(action).unwrap(), made.step(action).unwrap());
    }
}

/// A table set to itself changes no step; another table takes effect; a faulty one is refused.
#[test]
fn tables_can_be_replaced() {
    for id in ["FrozenLake-v1", "CliffWalking-v1", "Taxi-v4"] {
        let [mut env, mut same] = [(); 2].map(|()| {
            let mut env = gym::make(id).unwrap();
            env.reset(1).unwrap();
            env
        });
        let inspect = same.inspect_mut().unwrap();
        let table = inspect.table().unwrap();
        inspect.set_table(table.clone()).unwrap();
        let mut actions = env.action_sampler(2).unwrap();
        for _ in 0..50 {
            let action = actions.sample();
            let [a, b] = [&mut env, &mut same].map(|env| env.step(&action).unwrap());
            assert_eq!(a, b, "{id}");
            if a.done() {
                assert_eq!(env.reset(()).unwrap(), same.reset(()).unwrap(), "{id}");
            }
        }

        // no row of Gymnasium's tables has four outcomes; every draw gives the third
        let inspect = same.inspect_mut().unwrap();
        let mut other = table.clone();
        let outcome = |p: f64, next: u64| json!([p, next, 2.5, false]);
        for row in other["P"].as_array_mut().unwrap() {
            for outcomes in row.as_array_mut().unwrap() {
                *outcomes = json!([
                    outcome(0.0, 1),
                    outcome(0.0, 2),
                    outcome(1.0, 3),
                    outcome(0.0, 4)
                ]);
            }
        }
        inspect.set_table(other).unwrap();
        let step = same.step(&actions.sample()).unwrap();
        assert_eq!(
            (step.observation.as_int(), step.reward),
            (Some(3), 2.5),
            "{id}"
        );

        let states = table["P"].as_array().unwrap().len();
        let mut elsewhere = table.clone();
        let starts = (0..states).map(|state| if state == 3 { 1.0 } else { 0.0 });
        elsewhere["initial_state_distrib"] = starts.collect();
        let inspect = same.inspect_mut().unwrap();
        inspect.set_table(elsewhere).unwrap();
        assert_eq!(same.reset(9).unwrap().as_int(), Some(3), "{id}");

        let refused: [(&str, Json); 6] = [
            ("/P/0/0", json!([])),
            ("/P/0/0", json!([[1.5, 0, 0.0, false]])),
            ("/P/0/0", json!([[1.0, states, 0.0, false]])),
            ("/P/0", json!([])),
            ("/initial_state_distrib", json!([1.0])),
            ("/P", json!([[]])),
        ];
        let before = same.inspect().unwrap().table();
        for (place, value) in refused {
            let mut wrong = table.clone();
            *wrong.pointer_mut(place).unwrap() = value;
            let error = same.inspect_mut().unwrap().set_table(wrong).unwrap_err();
            assert!(error.to_string().contains("table"), "{error}");
        }
        assert_eq!(
            same.inspect().unwrap().table(),
            before,
            "{id}: nothing has changed"
        );
    }
}

/// Every kind of vector shows the same states and arguments by index, and sets a state by index.
#[test]
fn vectors_are_inspected_by_index() {
    for id in IDS {
        let mut seen = Vec::new();
        for kind in VectorKind::ALL {
            let mut envs = gym::make_vec(id, 3, kind).unwrap();
            assert!(envs.inspect(3, &mut |_| ()).is_err(), "{id}, {kind}");
            envs.reset(7).unwrap();
            let mut shown = Vec::new();
            for index in 0..3 {
                envs.inspect(index, &mut |env| shown.push((env.state(), env.arguments())))
                    .unwrap();
            }
            // give sub-environment 0 the state of sub-environment 2
            let last = shown[2].0.clone().unwrap();
            envs.inspect(0, &mut |env| env.set_state(last.clone()).unwrap())
                .unwrap();
            envs.inspect(0, &mut |env| shown.push((env.state(), env.arguments())))
                .unwrap();
            assert!(
                envs.inspect(0, &mut |env| assert!(env.set_state(json!([])).is_err()))
                    .is_ok()
            );
            seen.push((kind, shown));
        }
        for (kind, shown) in &seen {
            assert_eq!(shown, &seen[0].1, "{id}, {kind}");
        }
    }
}
