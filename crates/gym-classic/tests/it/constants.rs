//! Constants of the equations as arguments. Episodes equal, bit for bit, the episodes of Gymnasium
//! 1.4.0 with the same attributes.

use gym_classic as _;
use gym_core::prelude::*;
use gym_core::registry::find;
use gym_core::vector::VectorKind;
use gym_core::{BoxEnv, Generator, Inspect, Kwargs, Value, builder};
use gym_testing::Sum;
use serde::Deserialize;

/// An episode of Gymnasium, recorded by `constants.py`.
#[derive(Deserialize)]
struct Recorded {
    id: String,
    seed: u64,
    arguments: Kwargs,
    /// The FNV-1a hash of observations, rewards and ends.
    sum: String,
}

const STEPS: usize = 300;

fn recordings() -> Vec<Recorded> {
    serde_json::from_str(include_str!("constants.json")).unwrap()
}

/// The actions of a recording. Some are random, most are in the direction of the motion.
struct Actions {
    rng: Generator,
    /// The number of actions; `None` if an action is a number.
    n: Option<i64>,
    /// The index of the velocity in an observation, for actions in its direction.
    pump: Option<usize>,
}

impl Actions {
    fn new(id: &str, seed: u64) -> Self {
        let (n, pump) = match id {
            "CartPole-v1" => (Some(2), None),
            "MountainCar-v0" => (Some(3), Some(1)),
            "Acrobot-v1" => (Some(3), Some(5)),
            "MountainCarContinuous-v0" => (None, Some(1)),
            _ => (None, None),
        };
        Self {
            rng: Generator::from(seed + 1000),
            n,
            pump,
        }
    }

    fn next(&mut self, observation: &[f32]) -> Value {
        let rng = &mut self.rng;
        let random = match self.n {
            Some(n) => rng.integers(0, n) as f64,
            None => rng.uniform(-4.0, 4.0),
        };
        let with_motion = rng.random() < 0.8;
        let action = match self.pump.filter(|_| with_motion) {
            Some(velocity) => {
                let forward = observation[velocity] >= 0.0;
                let most = self.n.map_or(1.0, |n| (n - 1) as f64);
                let least = if self.n.is_some() { 0.0 } else { -1.0 };
                if forward { most } else { least }
            }
            None => random,
        };
        match self.n {
            Some(_) => Value::Int(action as i64),
            None => Value::from([action as f32]),
        }
    }
}

fn sum_of(env: &mut BoxEnv, id: &str, seed: u64) -> String {
    let mut actions = Actions::new(id, seed);
    let mut observation = env.reset(seed).unwrap();
    let mut own = Sum::of(observation.as_slice().unwrap());
    let mut done = false;
    for _ in 0..STEPS {
        let action = actions.next(observation.as_slice().unwrap());
        let reward;
        if done {
            (observation, reward, done) = (env.reset(()).unwrap(), 0.0, false);
        } else {
            let step = env.step(&action).unwrap();
            (done, reward, observation) = (step.done(), step.reward, step.observation);
        }
        own.step(observation.as_slice().unwrap(), reward, done);
    }
    format!("{:016x}", own.finish())
}

#[test]
fn constants_of_single_environments_are_gymnasiums() {
    for Recorded {
        id,
        seed,
        arguments,
        sum,
    } in recordings()
    {
        let mut env = builder(&id)
            .args(arguments.clone())
            .max_episode_steps(None)
            .build()
            .unwrap();
        assert_eq!(sum_of(&mut env, &id, seed), sum, "{id}: {arguments:?}");
    }
}

#[test]
fn constants_of_native_vectors_are_gymnasiums() {
    const N: usize = 5;
    for Recorded {
        id,
        seed,
        arguments,
        sum,
    } in recordings()
    {
        let env = builder(&id).args(arguments.clone()).max_episode_steps(None);
        let mut envs = env.vector(N).kind(VectorKind::Native).build().unwrap();
        let mut columns = envs.columns().unwrap();
        envs.reset_into(&seed.into(), &mut columns).unwrap();
        let first = |columns: &gym_core::vector::Columns| -> Vec<f32> {
            let numbers = columns.observations.as_slice::<f32>().unwrap();
            numbers[..numbers.len() / N].to_vec()
        };
        let mut own = Sum::of(&first(&columns));
        let mut actions = Actions::new(&id, seed);
        for _ in 0..STEPS {
            let action = actions.next(&first(&columns));
            let batch = envs
                .single_action_space()
                .concatenate(&vec![action; N])
                .unwrap();
            envs.step_into(&batch, &mut columns).unwrap();
            own.step(&first(&columns), columns.rewards[0], columns.done(0));
        }
        assert_eq!(format!("{:016x}", own.finish()), sum, "{id}: {arguments:?}");
    }
}

#[test]
fn derived_constants_follow_unless_given() {
    use gym_classic::cartpole::{Action, CartPole, Config};
    let first = |config: Config| {
        let mut env = CartPole::new(config).unwrap();
        env.reset(0).unwrap();
        env.step(&Action::Right).unwrap().observation
    };
    let heavy = Config {
        masspole: 0.5,
        ..Config::default()
    };
    let stated = Config {
        total_mass: Some(1.5),
        polemass_length: Some(0.25),
        ..heavy
    };
    assert_eq!(first(heavy), first(stated));
    assert_ne!(
        first(heavy),
        first(Config {
            total_mass: Some(1.1),
            ..heavy
        })
    );
}

#[test]
fn spaces_follow_the_constants() {
    let space = |id: &str, name: &str, value: f64| {
        let env = builder(id).arg(name, value).build().unwrap();
        (
            env.observation_space().to_string(),
            env.action_space().to_string(),
        )
    };
    assert!(space("CartPole-v1", "x_threshold", 3.0).0.contains('6'));
    assert!(space("Pendulum-v1", "max_torque", 3.0).1.contains('3'));
    assert!(
        space("MountainCarContinuous-v0", "max_action", 1.5)
            .1
            .contains("1.5")
    );
}

#[test]
fn constants_that_cannot_be_are_refused() {
    for (id, name, value, reason) in [
        (
            "CartPole-v1",
            "gravity",
            1e7,
            "gravity is 10000000.0: it must lie between -1000000.0 and 1000000.0",
        ),
        (
            "CartPole-v1",
            "x_threshold",
            -1.0,
            "x_threshold is -1.0: it must lie between 0.0",
        ),
        (
            "MountainCar-v0",
            "min_position",
            0.7,
            "min_position is 0.7: it must be less than max_position, 0.6",
        ),
        (
            "MountainCar-v0",
            "min_position",
            0.6,
            "min_position is 0.6: it must be less than max_position, 0.6",
        ),
        (
            "MountainCarContinuous-v0",
            "max_position",
            -1.2,
            "min_position is -1.2: it must be less than max_position, -1.2",
        ),
        ("MountainCar-v0", "max_speed", -0.1, "max_speed is -0.1"),
        (
            "MountainCarContinuous-v0",
            "max_action",
            -2.0,
            "min_action is -1.0: it must not be above max_action, -2.0",
        ),
        ("Pendulum-v1", "max_torque", -1.0, "max_torque is -1.0"),
        ("Acrobot-v1", "MAX_VEL_1", -1.0, "MAX_VEL_1 is -1.0"),
        ("Acrobot-v1", "gravity", 9.8, "unknown argument `gravity`"),
        (
            "Acrobot-v1",
            "LINK_LENGTH_2",
            -0.2,
            "LINK_LENGTH_2 is -0.2: it must be at least 1e-6",
        ),
    ] {
        let error = builder(id)
            .arg(name, value)
            .build()
            .unwrap_err()
            .to_string();
        assert!(error.contains(reason), "{id}: {error}");
    }
    let error = builder("CartPole-v1")
        .arg("kinematics_integrator", "rk4")
        .build()
        .unwrap_err()
        .to_string();
    assert!(
        error.contains("`euler` or `semi-implicit euler`"),
        "{error}"
    );
}

/// For all constants that an environment accepts, the results of steps are finite. Constants that
/// would lead to NaN or infinity, such as a length near 0, are errors.
#[test]
fn numbers_that_are_accepted_give_finite_steps() {
    // not used in pairs, because the product of two huge numbers may overflow
    const OTHERS: [f64; 8] = [-1e-300, 1e-7, 1e-6, 3.0, 1e6, -1e6, 1e9, f64::MAX];
    const EXTREMES: [f64; 4] = [0.0, 5e-324, -1e-6, -0.2];
    let play = |id: &str, arguments: &[(&str, f64)]| {
        let plain = builder(id).disable_env_checker(true);
        let all = arguments.iter().copied();
        let Ok(mut env) = all
            .fold(plain, |builder, (name, x)| builder.arg(name, x))
            .build()
        else {
            return;
        };
        let mut seen = env.reset(0).unwrap();
        let mut sampler = env.action_space().sampler(0);
        for _ in 0..12 {
            assert!(seen.is_finite(), "{id} with {arguments:?}: {seen}");
            let step = env.step(&sampler.sample()).unwrap();
            assert!(step.reward.is_finite(), "{id} with {arguments:?}");
            let (is_over, last) = (step.done(), step.observation);
            assert!(last.is_finite(), "{id} with {arguments:?}: {last}");
            seen = if is_over {
                env.reset(()).unwrap()
            } else {
                last
            };
        }
    };
    for id in [
        "Acrobot-v1",
        "CartPole-v1",
        "MountainCar-v0",
        "MountainCarContinuous-v0",
        "Pendulum-v1",
    ] {
        let table = find(id).unwrap().arguments().unwrap();
        let names: Vec<_> = table
            .iter()
            .filter(|row| row.kind == "number")
            .map(|row| row.name)
            .collect();
        assert!(names.len() >= 4, "{id}: {names:?}");
        for (i, first) in names.iter().enumerate() {
            for x in OTHERS {
                play(id, &[(first, x)]);
            }
            for x in EXTREMES {
                play(id, &[(first, x)]);
                for second in &names[..i] {
                    for y in EXTREMES {
                        play(id, &[(first, x), (second, y)]);
                    }
                }
            }
        }
    }
    let singular = [
        ("LINK_MASS_1", 0.0),
        ("LINK_MASS_2", 0.0),
        ("LINK_MOI", 0.0),
    ];
    play("Acrobot-v1", &singular);
}

/// Setting an argument has the effect of setting Gymnasium's attribute: numbers that the
/// constructor computed from the argument do not change, and the spaces do not either.
#[test]
fn constants_set_later_take_effect() {
    for Recorded {
        id,
        seed,
        arguments,
        sum,
    } in recordings()
        .into_iter()
        .filter(|recorded| recorded.id == "CartPole-v1")
    {
        use gym_classic::CartPole;
        let mut env = builder(&id).max_episode_steps(None).build().unwrap();
        let space = env.observation_space();
        env.reset(0).unwrap();
        let own = env.layer_mut::<CartPole>().unwrap();
        let derived = ["total_mass", "polemass_length"];
        let given = |name: &str| {
            !derived.contains(&name) || !matches!(arguments[name].as_f64(), Some(1.1 | 0.05))
        };
        for (name, value) in arguments.iter().filter(|(name, _)| given(name)) {
            own.set_argument(name, value.clone()).unwrap();
        }
        assert_eq!(env.observation_space(), space);
        assert_eq!(sum_of(&mut env, &id, seed), sum, "{arguments:?}");
        let own = env.layer_mut::<CartPole>().unwrap();
        let error = own
            .set_argument("gravity", "much".into())
            .unwrap_err()
            .to_string();
        assert!(error.contains("expected f64"), "{error}");
        let error = own.set_argument("mass", 1.into()).unwrap_err().to_string();
        assert!(error.contains("unknown argument `mass`"), "{error}");
    }
}

/// A vector whose environments have different constants gives the results of single environments
/// with these constants.
#[test]
fn each_environment_of_a_vector_has_constants_of_its_own() {
    const N: usize = 70;
    let gravity: Vec<f64> = (0..N).map(|i| 1.0 + i as f64 / 7.0).collect();
    let length: Vec<f64> = (0..N).map(|i| 0.2 + i as f64 / 100.0).collect();
    let make = |kind| {
        let vector = builder("CartPole-v1")
            .arg("masspole", 0.2)
            .vector(N)
            .kind(kind);
        vector
            .arg_each("gravity", gravity.clone())
            .arg_each("length", length.clone())
            .build()
            .unwrap()
    };
    let [mut native, mut sync] = [VectorKind::Native, VectorKind::Sync].map(make);
    let [mut fast, mut exact] = [native.columns().unwrap(), sync.columns().unwrap()];
    let mut actions = native.action_space().unwrap().sampler(1);
    native.reset_into(&3.into(), &mut fast).unwrap();
    sync.reset_into(&3.into(), &mut exact).unwrap();
    for step in 0..300 {
        let actions = actions.sample();
        native.step_into(&actions, &mut fast).unwrap();
        sync.step_into(&actions, &mut exact).unwrap();
        assert_eq!(fast, exact, "step {step}");
    }
    let spec = serde_json::to_value(native.spec().unwrap()).unwrap();
    assert_eq!(spec["each"]["length"][1], length[1]);
    let again: gym_core::registry::VectorSpec = serde_json::from_value(spec).unwrap();
    assert_eq!(again, native.spec().unwrap());
    assert_eq!(
        again.make().unwrap().reset(3).unwrap().observations,
        make(VectorKind::Native).reset(3).unwrap().observations
    );
}

/// At each reset, the environment's generator draws the constants of a range for the episode.
#[test]
fn ranges_draw_constants_anew_at_each_reset() {
    use gym_classic::cartpole::{CartPoleDynamics, Config};
    use gym_core::{Dynamics, Reset, Task};
    use gym_native::NativeVectorEnv;
    const N: usize = 40;
    const RANGES: [(&str, f64, f64); 2] = [("gravity", 2.0, 20.0), ("length", 0.2, 2.0)];
    let make = || {
        let vector = builder("CartPole-v1")
            .vector(N)
            .arg_each("length", 0.2..2.0);
        vector.arg_each("gravity", 2.0..20.0).build().unwrap()
    };
    let mut envs = make();
    let mut columns = envs.columns().unwrap();
    envs.reset_into(&5.into(), &mut columns).unwrap();
    // the expected values, computed without the vector
    let start = |rng: &mut Generator| {
        let [gravity, length] = RANGES.map(|(_, low, high)| rng.uniform(low, high));
        let own = CartPoleDynamics::new(Config {
            gravity,
            length,
            ..Config::default()
        })
        .unwrap();
        let state = own.start(&Reset::default(), rng).unwrap();
        (own, state)
    };
    let mut rngs: Vec<Generator> = (0..N as u64).map(|i| Generator::from(5 + i)).collect();
    let mut own: Vec<_> = rngs.iter_mut().map(start).collect();
    let mut actions = envs.action_space().unwrap().sampler(2);
    let mut due = [false; N];
    let mut ends = 0;
    let mut middle = None;
    for step in 0..200 {
        if step == 100 {
            middle = Some((envs.snapshot().unwrap(), actions.clone()));
        }
        let batch = actions.sample();
        envs.step_into(&batch, &mut columns).unwrap();
        let items = batch.as_array().unwrap().as_slice::<i64>().unwrap();
        for i in 0..N {
            let (dynamics, state) = &mut own[i];
            let seen = if due[i] {
                (*dynamics, *state) = start(&mut rngs[i]);
                due[i] = false;
                dynamics.observe(state)
            } else {
                let action = gym_classic::cartpole::Action::ALL[items[i] as usize];
                let next = dynamics.transition(state, &action, &mut rngs[i]).unwrap();
                (*state, due[i]) = (next.state, next.terminated);
                ends += usize::from(next.terminated);
                dynamics.observe(&next.state)
            };
            let row = columns
                .observations
                .as_slice::<f32>()
                .unwrap()
                .as_chunks::<4>()
                .0[i];
            assert_eq!(row, seen, "step {step} of {i}");
        }
    }
    assert!(ends > 100);
    let native = envs.layer::<NativeVectorEnv<CartPoleDynamics>>().unwrap();
    let drawn: Vec<_> = (0..N).map(|i| native.arguments(i)).collect();
    for (i, (dynamics, _)) in own.iter().enumerate() {
        let Config {
            gravity, length, ..
        } = *dynamics.config();
        assert_eq!(
            drawn[i],
            [
                ("gravity".to_owned(), gravity),
                ("length".to_owned(), length)
            ]
        );
    }
    // a snapshot contains the drawn constants
    let (snapshot, mut actions) = middle.unwrap();
    let mut again = make();
    let mut replayed = again.columns().unwrap();
    again.restore(&snapshot).unwrap();
    for _ in 100..200 {
        again.step_into(&actions.sample(), &mut replayed).unwrap();
    }
    assert_eq!(replayed.observations, columns.observations);
    let mut other = builder("CartPole-v1")
        .vector(N)
        .arg_each("gravity", 2.0..3.0)
        .build()
        .unwrap();
    assert!(other.restore(&snapshot).is_err());
}

#[test]
fn what_cannot_differ_is_refused() {
    let error = |name: &str, each: gym_core::registry::Each| {
        let vector = builder("CartPole-v1").vector(2).kind(VectorKind::Native);
        vector.arg_each(name, each).build().unwrap_err().to_string()
    };
    assert!(error("gravity", [1.0].into()).contains("there are 1 values for 2 environments"));
    assert!(error("gravity", (3.0..1.0).into()).contains("the lower one first"));
    assert!(error("gravity", [1.0, 1e9].into()).contains("gravity is 1000000000.0"));
    // the upper and the lower end of a range
    assert!(error("gravity", (1.0..1e9).into()).contains("gravity is 1000000000.0"));
    assert!(error("gravity", (-1e9..1.0).into()).contains("gravity is -1000000000.0"));
    assert!(
        error("x_threshold", (2.4..3.0).into())
            .contains("must give all environments the same spaces")
    );
    assert!(error("mass", [1.0, 2.0].into()).contains("no argument of this name"));
    assert!(
        error("x_threshold", [1.0, 2.0].into())
            .contains("must give all environments the same spaces")
    );
    assert!(
        error("kinematics_integrator", ["euler", "euler"].into())
            .contains("only arguments that are numbers")
    );
    let vector = builder("CartPole-v1")
        .vector(2)
        .kind(VectorKind::Sync)
        .arg_each("gravity", 1.0..2.0);
    assert!(
        vector
            .build()
            .unwrap_err()
            .to_string()
            .contains("ranges need a native vector")
    );
    // a sync vector supports arguments that a native vector does not
    let envs = builder("CartPole-v1")
        .vector(2)
        .arg_each("kinematics_integrator", ["euler", "semi-implicit euler"]);
    assert_eq!(
        envs.build().unwrap().spec().unwrap().vectorization_mode,
        VectorKind::Sync
    );
}

/// A vector refuses a snapshot whose constants lie outside of the vector's ranges, and a snapshot
/// with another number of environments or other arguments. A refused snapshot changes nothing.
#[test]
fn numbers_drawn_outside_of_the_ranges_are_refused() {
    let make = |n: usize, ranges: &[(&str, f64, f64)]| {
        let vector = builder("CartPole-v1").vector(n).kind(VectorKind::Native);
        let vector = ranges.iter().fold(vector, |vector, (name, low, high)| {
            vector.arg_each(name, *low..*high)
        });
        vector.build().unwrap()
    };
    let stored = |n: usize, ranges: &[(&str, f64, f64)]| {
        let mut envs = make(n, ranges);
        envs.reset(7).unwrap();
        envs.snapshot().unwrap()
    };
    const N: usize = 40;
    let own = [("length", 0.5, 0.6)];
    let mut envs = make(N, &own);
    envs.reset(1).unwrap();
    let before = envs.snapshot().unwrap();
    for (n, ranges) in [
        (N, &[("length", 0.3, 0.8)][..]),
        (N, &[("length", 0.3, 0.45)]),
        (N, &[("length", 0.65, 0.8)]),
        (N, &[("length", 0.5, 0.6), ("gravity", 9.0, 10.0)]),
        (N, &[]),
        (N + 1, &own),
        (2 * N, &own),
    ] {
        let error = envs.restore(&stored(n, ranges)).unwrap_err().to_string();
        assert!(error.contains("cannot restore"), "{n}, {ranges:?}: {error}");
        assert_eq!(envs.snapshot().unwrap(), before, "{n}, {ranges:?}");
    }
    // a snapshot of narrower ranges fits
    envs.restore(&stored(N, &[("length", 0.52, 0.58)])).unwrap();
    // numbers that equal the ends of a range fit
    let native = envs
        .layer::<gym_native::NativeVectorEnv<gym_classic::cartpole::CartPoleDynamics>>()
        .unwrap();
    let drawn: Vec<f64> = (0..N).map(|i| native.arguments(i)[0].1).collect();
    let [low, high] = [f64::min, f64::max].map(|end| drawn.iter().copied().reduce(end).unwrap());
    let snapshot = envs.snapshot().unwrap();
    make(N, &[("length", low, high)])
        .restore(&snapshot)
        .unwrap();
    for (low, high) in [(low.next_up(), high), (low, high.next_down())] {
        assert!(
            make(N, &[("length", low, high)])
                .restore(&snapshot)
                .is_err()
        );
    }
}

/// Constants for which episodes would start outside of the observation space are errors of the
/// constructor.
#[test]
fn every_start_lies_in_the_space() {
    let made = |id: &str, name: &str, x: f64| builder(id).arg(name, x).build();
    for (id, name, refused, accepted) in [
        ("CartPole-v1", "x_threshold", 0.0, 0.03),
        ("CartPole-v1", "theta_threshold_radians", 5e-324, 0.03),
        ("Pendulum-v1", "max_speed", 0.5, 1.0),
        ("Acrobot-v1", "MAX_VEL_1", 0.0, 0.1),
        ("Acrobot-v1", "MAX_VEL_2", -0.0, 0.1),
        ("MountainCar-v0", "min_position", -0.2, -0.6),
        ("MountainCar-v0", "max_position", -0.5, 0.0),
        ("MountainCarContinuous-v0", "min_position", -0.59, -0.7),
    ] {
        let error = made(id, name, refused).unwrap_err().to_string();
        assert!(
            error.contains(&format!("{name} ")) && error.contains("start"),
            "{id}: {error}"
        );
        let mut env = made(id, name, accepted).unwrap();
        for seed in 0..50 {
            let observation = env.reset(seed).unwrap();
            env.observation_space().check(&observation).unwrap();
        }
    }
}
