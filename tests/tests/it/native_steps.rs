//! Steps and starts of native vectors equal those of scalar environments, from any state, in any lane
//! and at any level of the CPU.

use gym::classic::acrobot::AcrobotDynamics;
use gym::classic::cartpole::CartPoleDynamics;
use gym::classic::mountain_car::MountainCarDynamics;
use gym::classic::mountain_car_continuous::MountainCarContinuousDynamics;
use gym::classic::pendulum::PendulumDynamics;
use gym::vector::native::{ActionColumn, Native, NativeVectorEnv};
use gym::vector::{Autoreset, Columns, VectorEnv, VectorEnvExt, VectorReset};
use gym::{Generator, Task, Value};
use serde_json::json;

use crate::native::{CLASSIC, by_hand, native, spec, starts};

/// Returns the number of steps to compare per environment: 200,000, or `NATIVE_STEPS`.
fn steps_to_compare() -> usize {
    std::env::var("NATIVE_STEPS")
        .ok()
        .and_then(|text| text.parse().ok())
        .unwrap_or(200_000)
}

/// Compares each step, bit by bit, with a step of the scalar dynamics from the same state.
/// `options` allow a start anywhere; episodes after an autoreset begin as usual.
fn compare_steps<D, const K: usize, const O: usize>(config: D::Config, options: [(&str, f64); 2])
where
    D: Native<Packed = [f64; K]> + Task<Observation = [f32; O]>,
{
    const N: usize = 1000;
    let dynamics = D::new(config).unwrap();
    let mut envs =
        NativeVectorEnv::new(dynamics.clone(), N, Some(150), Autoreset::NextStep).unwrap();
    let mut columns = envs.columns().unwrap();
    let mut actions = envs.action_sampler(3).unwrap();
    let mut rng = Generator::from(0);
    let (mut compared, mut ends) = (0, 0);
    for step in 0.. {
        if compared >= steps_to_compare() {
            break;
        }
        if step % 100 == 0 {
            let reset = VectorReset::from(step).option(options[0].0, options[0].1);
            envs.reset_into(&reset.option(options[1].0, options[1].1), &mut columns)
                .unwrap();
        }
        let before: Vec<D::State> = (0..N).map(|i| envs.state(i).unwrap()).collect();
        let due: Vec<bool> = (0..N).map(|i| columns.done(i)).collect();
        let batch = actions.sample();
        envs.step_into(&batch, &mut columns).unwrap();
        let items = D::Action::items(&batch, N).unwrap();
        let observations = columns
            .observations
            .as_slice::<f32>()
            .unwrap()
            .as_chunks::<O>()
            .0;
        for i in (0..N).filter(|i| !due[*i]) {
            let action = D::Action::from_item(D::Action::item(items, i));
            let one = dynamics.transition(&before[i], &action, &mut rng).unwrap();
            let place = || format!("{}: step {step} of {i}, from {:?}", D::NAME, before[i]);
            let bits = |state: &D::State| dynamics.pack(state).map(f64::to_bits);
            assert_eq!(
                bits(&envs.state(i).unwrap()),
                bits(&one.state),
                "{}",
                place()
            );
            let seen = dynamics.observe(&one.state).map(f32::to_bits);
            assert_eq!(observations[i].map(f32::to_bits), seen, "{}", place());
            assert_eq!(
                columns.rewards[i].to_bits(),
                one.reward.to_bits(),
                "{}",
                place()
            );
            assert_eq!(columns.terminated[i], one.terminated, "{}", place());
            ends += usize::from(one.terminated);
            compared += 1;
        }
    }
    println!("{}: {compared} steps, {ends} ends", D::NAME);
    assert!(
        ends > 0 || D::NAME == "Pendulum",
        "{}: no episode came to an end of its own",
        D::NAME
    );
}

#[test]
fn steps_from_anywhere_equal_those_of_scalar_environments() {
    use gym::classic::{cartpole, mountain_car, mountain_car_continuous, pendulum};
    let bounds = |low, high| [("low", low), ("high", high)];
    compare_steps::<CartPoleDynamics, 4, 4>(cartpole::Config::default(), bounds(-0.25, 0.25));
    compare_steps::<MountainCarDynamics, 2, 2>(mountain_car::Config::default(), bounds(-1.2, 0.55));
    let config = mountain_car_continuous::Config::default();
    compare_steps::<MountainCarContinuousDynamics, 3, 2>(config, bounds(-1.2, 0.55));
    compare_steps::<PendulumDynamics, 3, 3>(
        pendulum::Config::default(),
        [("x_init", 100.0), ("y_init", 8.0)],
    );
    compare_steps::<AcrobotDynamics, 4, 6>(
        gym::classic::acrobot::Config::default(),
        bounds(-3.0, 3.0),
    );
}

/// Steps from angles and positions far from any episode are equal, too.
#[test]
fn steps_from_extremes_equal_those_of_scalar_environments() {
    use gym::classic::{cartpole, mountain_car, mountain_car_continuous, pendulum};
    let bounds = [("low", -1e6), ("high", 1e6)];
    compare_steps::<CartPoleDynamics, 4, 4>(cartpole::Config::default(), bounds);
    compare_steps::<MountainCarDynamics, 2, 2>(
        mountain_car::Config {
            goal_velocity: -1.0,
            ..Default::default()
        },
        bounds,
    );
    let config = mountain_car_continuous::Config {
        goal_velocity: -1.0,
        ..Default::default()
    };
    compare_steps::<MountainCarContinuousDynamics, 3, 2>(config, bounds);
    compare_steps::<PendulumDynamics, 3, 3>(
        pendulum::Config {
            g: -3e5,
            ..Default::default()
        },
        [("x_init", 1e6), ("y_init", 1e6)],
    );
    compare_steps::<AcrobotDynamics, 4, 6>(gym::classic::acrobot::Config::default(), bounds);
}

#[test]
fn starts_equal_those_of_scalar_environments() {
    for id in CLASSIC {
        let spec = spec(id, json!({}));
        let mut envs = native(&spec, 40, Autoreset::NextStep).unwrap();
        let mut hands = by_hand(&spec, 40);
        let mut columns = envs.columns().unwrap();
        let options = if id == "Pendulum-v1" {
            ["x_init", "y_init"]
        } else {
            ["low", "high"]
        };
        let mask: Vec<bool> = (0..40).map(|i| i % 3 == 0).collect();
        for reset in [
            VectorReset::from(7),
            VectorReset::default(),
            VectorReset::seeds((0..40u64).map(|i| i * i)),
            VectorReset::default().mask(mask.clone()),
            VectorReset::from(1)
                .option(options[0], 0.01)
                .option(options[1], 0.02)
                .mask(mask),
        ] {
            envs.reset_into(&reset, &mut columns).unwrap();
            let shown = envs
                .single_observation_space()
                .iterate(&columns.observations)
                .unwrap();
            let mut shown: Vec<Value> = shown.collect();
            for (i, start) in starts(&mut hands, &reset).into_iter().enumerate() {
                if let Some(start) = start {
                    assert_eq!(shown[i], start, "{id}: {reset:?} of {i}");
                }
            }
            // environments outside of the mask keep their rows
            let left_out =
                VectorReset::default().mask((0..40).map(|i| i == 39).collect::<Vec<_>>());
            let mut other = Columns::default();
            envs.reset_into(&left_out, &mut other).unwrap();
            starts(&mut hands, &left_out);
            let again = envs
                .single_observation_space()
                .iterate(&other.observations)
                .unwrap();
            shown.truncate(39);
            assert!(again.take(39).eq(shown), "{id}");
        }
    }
}

/// Returns the columns of several steps, as bits.
fn bits<D: Native>(
    envs: &mut NativeVectorEnv<D>,
    seed: u64,
    actions: &[Value],
    row: usize,
) -> Vec<Value> {
    let mut columns = envs.reset(seed).unwrap();
    let space = envs.single_observation_space();
    let mut seen = Vec::new();
    for actions in actions {
        envs.step_into(actions, &mut columns).unwrap();
        let observation = space
            .iterate(&columns.observations)
            .unwrap()
            .nth(row)
            .unwrap();
        seen.extend([observation, Value::Float(columns.rewards[row])]);
    }
    seen
}

fn same_bits<D: Native>(dynamics: &D) {
    const N: usize = 1000;
    let vector =
        |n| NativeVectorEnv::new(dynamics.clone(), n, Some(60), Autoreset::SameStep).unwrap();
    let mut actions = vector(N).action_sampler(8).unwrap();
    let actions: Vec<Value> = (0..200).map(|_| actions.sample()).collect();
    for i in [0, 31, 32, 517, 999] {
        let many = bits(&mut vector(N), 50, &actions, i);
        assert_eq!(
            many,
            bits(&mut vector(N).baseline(), 50, &actions, i),
            "{}: without SIMD",
            D::NAME
        );
        let space = dynamics.action_space();
        let single = |batch: &Value| {
            let action = space.iterate(batch).unwrap().nth(i).unwrap();
            space.concatenate(&[action]).unwrap()
        };
        let actions: Vec<Value> = actions.iter().map(single).collect();
        let one = bits(&mut vector(1), 50 + i as u64, &actions, 0);
        assert_eq!(many, one, "{}: {i} alone", D::NAME);
    }
}

#[test]
fn bits_depend_on_neither_place_nor_cpu() {
    same_bits(&CartPoleDynamics::new(Default::default()).unwrap());
    same_bits(&MountainCarDynamics::new(Default::default()).unwrap());
    same_bits(&MountainCarContinuousDynamics::new(Default::default()).unwrap());
    same_bits(&PendulumDynamics::new(Default::default()).unwrap());
    same_bits(&AcrobotDynamics::new(Default::default()).unwrap());
    same_bits(&gym::toytext::frozen_lake::FrozenLakeDynamics::new(Default::default()).unwrap());
}
