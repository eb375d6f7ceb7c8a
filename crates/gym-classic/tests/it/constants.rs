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
            "CartPole-v1",
            "length",
            -1e-7,
            "length is -1e-7: its absolute value must be at least 1e-6",
        ),
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
        let (kind, _) = id.split_once("-v").unwrap();
        // (arguments that do not exist are refused by the registry, which quotes the id)
        let kind = match name {
            "gravity" if kind == "Acrobot" => "`Acrobot-v1`",
            _ => kind,
        };
        let start = format!("invalid argument for {kind}: {reason}");
        assert!(error.starts_with(&start), "{id}: {error}");
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

/// The numbers of the environments of this crate, and the largest that each may be below 0; 0 for one that must not be below
/// it, and more for one that must not be 0 either.
const LEAST: [(&str, &[(&str, f64)]); 5] = [
    (
        "Acrobot-v1",
        &[
            ("dt", -1e6),
            ("LINK_LENGTH_1", 1e-6),
            ("LINK_LENGTH_2", 1e-6),
            ("LINK_MASS_1", 0.0),
            ("LINK_MASS_2", 0.0),
            ("LINK_COM_POS_1", -1e6),
            ("LINK_COM_POS_2", -1e6),
            ("LINK_MOI", 0.0),
            ("MAX_VEL_1", 0.0),
            ("MAX_VEL_2", 0.0),
            ("torque_noise_max", -1e6),
        ],
    ),
    (
        "CartPole-v1",
        &[
            ("gravity", -1e6),
            ("masscart", -1e6),
            ("masspole", -1e6),
            ("total_mass", -1e6),
            ("length", -1e6),
            ("polemass_length", -1e6),
            ("force_mag", -1e6),
            ("tau", -1e6),
            ("theta_threshold_radians", 0.0),
            ("x_threshold", 0.0),
        ],
    ),
    (
        "MountainCar-v0",
        &[
            ("min_position", -1e6),
            ("max_position", -1e6),
            ("max_speed", 0.0),
            ("goal_position", -1e6),
            ("force", -1e6),
            ("gravity", -1e6),
        ],
    ),
    (
        "MountainCarContinuous-v0",
        &[
            ("min_action", -1e6),
            ("max_action", -1e6),
            ("min_position", -1e6),
            ("max_position", -1e6),
            ("max_speed", 0.0),
            ("goal_position", -1e6),
            ("power", -1e6),
        ],
    ),
    (
        "Pendulum-v1",
        &[
            ("g", -1e6),
            ("m", -1e6),
            ("l", -1e6),
            ("max_speed", 0.0),
            ("max_torque", 0.0),
            ("dt", -1e6),
        ],
    ),
];

/// Each number is refused beyond its bounds, by its own name and with its own value: when the environment is made, and when
/// the number is set later.
#[test]
fn every_constant_is_refused_by_its_own_name() {
    for (id, numbers) in LEAST {
        let table = find(id).unwrap().arguments().unwrap();
        let names: Vec<_> = table
            .iter()
            .filter(|row| row.kind.starts_with("number") && row.name != "goal_velocity")
            .map(|row| row.name)
            .collect();
        assert_eq!(
            names,
            numbers.iter().map(|(name, _)| *name).collect::<Vec<_>>(),
            "{id}"
        );
        let mut env = builder(id).build().unwrap();
        for &(name, least) in numbers {
            let below = if least == 0.0 { -1e-9 } else { least - 1e-7 };
            for value in [1e6_f64.next_up(), 2e6, below, -2e6] {
                let told = format!("{name} is {value:?}: it must ");
                let made = builder(id).arg(name, value).build().unwrap_err();
                assert!(made.to_string().contains(&told), "{id}: {made}");
                let own = env.inspect_mut().unwrap();
                let set = own.set_argument(name, value.into()).unwrap_err();
                assert!(set.to_string().contains(&told), "{id}: {set}");
            }
        }
    }
    for (torque, i) in [
        ([2e6, 0.0, 1.0], 0),
        ([-1.0, 2e6, 1.0], 1),
        ([-1.0, 0.0, 2e6], 2),
    ] {
        let error = builder("Acrobot-v1")
            .arg("AVAIL_TORQUE", torque.to_vec())
            .build();
        let error = error.unwrap_err().to_string();
        assert!(
            error.contains(&format!("AVAIL_TORQUE[{i}] is 2000000.0: it")),
            "{error}"
        );
    }
}

/// Numbers by which the equations divide, or that follow from others, are refused by name where they would be 0.
#[test]
fn a_divisor_of_zero_is_refused_by_its_name() {
    for (id, arguments, told) in [
        ("CartPole-v1", &[("length", 0.0)][..], "length is 0.0"),
        ("CartPole-v1", &[("total_mass", 9e-7)], "total_mass is 9e-7"),
        (
            "CartPole-v1",
            &[("masscart", 2.0), ("masspole", -2.0)],
            "total_mass is 0.0",
        ),
        (
            "CartPole-v1",
            &[("masspole", 3e5), ("length", 9.0)],
            "polemass_length is 2700000.0",
        ),
        ("Pendulum-v1", &[("m", -9e-7)], "m is -9e-7"),
        ("Pendulum-v1", &[("l", 0.0)], "l is 0.0"),
        (
            "Acrobot-v1",
            &[("LINK_MOI", 0.0), ("LINK_MASS_1", 0.0)],
            "LINK_MASS_1 * LINK_COM_POS_1^2 + LINK_MOI is 0.0",
        ),
        (
            "Acrobot-v1",
            &[("LINK_MOI", 0.0), ("LINK_COM_POS_2", 0.0)],
            "LINK_MASS_2 * LINK_COM_POS_2^2 + LINK_MOI is 0.0",
        ),
    ] {
        let all = arguments.iter();
        let error = all
            .fold(builder(id), |builder, (name, x)| builder.arg(name, *x))
            .build();
        let error = error.unwrap_err().to_string();
        assert!(error.contains(&format!("{told}: it")), "{id}: {error}");
    }
}

/// JSON has no NaN: only who makes the environment in Rust can give one.
#[test]
fn a_speed_at_the_goal_is_a_number() {
    use gym_classic::{mountain_car as discrete, mountain_car_continuous as continuous};
    let config = discrete::Config {
        goal_velocity: f64::NAN,
        ..Default::default()
    };
    let errors = [
        discrete::MountainCar::new(config).unwrap_err(),
        continuous::MountainCarContinuous::new(continuous::Config {
            goal_velocity: f64::NAN,
            ..Default::default()
        })
        .unwrap_err(),
    ];
    for error in errors {
        assert!(
            error
                .to_string()
                .contains("goal_velocity is NaN: it must be a number"),
            "{error}"
        );
    }
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
        assert!(error.contains("expected a number"), "{error}");
        let error = own.set_argument("mass", 1.into()).unwrap_err().to_string();
        assert!(error.contains("unknown argument `mass`"), "{error}");
    }
}
