//! Rewards, flags and stored states at the ends of episodes.

use gym_classic::cartpole::{Action, CartPole, CartPoleDynamics, Config};
use gym_classic::{
    MountainCarContinuous, Pendulum, mountain_car, mountain_car_continuous, pendulum,
};
use gym_core::vector::{Autoreset, VectorEnv, VectorEnvExt, VectorReset};
use gym_core::{Continuous, Dynamics, Env, EnvExt, Generator, Reset, Task, Value, builder, make};
use gym_native::NativeVectorEnv;

/// Returns the rewards until the pole falls, and the reward of one further step.
fn rewards(config: Config) -> Vec<f64> {
    let mut env = CartPole::new(config).unwrap();
    env.reset(0).unwrap();
    let mut rewards = Vec::new();
    while !env.state().unwrap().fallen {
        rewards.push(env.step(&Action::Right).unwrap().reward);
    }
    rewards.push(env.step(&Action::Right).unwrap().reward);
    rewards.drain(..rewards.len() - 3);
    rewards
}

#[test]
fn steps_beyond_the_end_are_counted() {
    let mut env = CartPole::new(Config::default()).unwrap();
    env.reset(0).unwrap();
    while !env.step(&Action::Right).unwrap().terminated {}
    for steps in 0..3 {
        assert_eq!(env.state().unwrap().steps_beyond_terminated, steps);
        env.step(&Action::Right).unwrap();
    }
    env.reset(None).unwrap();
    assert_eq!(env.state().unwrap().steps_beyond_terminated, 0);
}

/// (Gymnasium's state is an array after a reset, and a tuple after a step; the precision differs.)
#[test]
fn a_mountain_car_knows_whether_it_has_moved() {
    let mut env = mountain_car::MountainCar::new(mountain_car::Config::default()).unwrap();
    env.reset(0).unwrap();
    assert!(env.state().unwrap().fresh);
    env.step(&mountain_car::Action::Coast).unwrap();
    assert!(!env.state().unwrap().fresh);
}

#[test]
fn only_what_an_episode_reaches_is_restored() {
    let mut env = CartPole::new(Config::default()).unwrap();
    env.reset(0).unwrap();
    env.step(&Action::Left).unwrap();
    let stored = serde_json::to_value(env.snapshot().unwrap()).unwrap();
    let mut with = |name: &str, value: f64| {
        let mut stored = stored.clone();
        stored["episode"]["state"][name] = value.into();
        env.restore(&serde_json::from_value(stored).unwrap())
    };
    with("theta", Config::default().theta_threshold_radians).unwrap();
    with("x", -2.4).unwrap();
    for (name, value) in [
        ("theta", 0.9),
        ("theta", -0.21),
        ("x", 2.41),
        ("x_dot", 300.0),
        ("theta_dot", -1000.0),
    ] {
        assert!(
            with(name, value)
                .unwrap_err()
                .to_string()
                .contains("not a state of this CartPole")
        );
    }
}

#[test]
fn what_starts_and_ends_beyond_the_thresholds_is_stored_and_restored() {
    let mut env = CartPole::new(Config::default()).unwrap();
    env.reset(Reset::seed(0).option("low", 0.8).option("high", 0.9))
        .unwrap();
    let start = env.snapshot().unwrap();
    assert!(env.step(&Action::Left).unwrap().terminated);
    let end = env.snapshot().unwrap();
    for snapshot in [start, end] {
        env.restore(&snapshot).unwrap();
        assert_eq!(env.snapshot().unwrap(), snapshot);
    }
}

/// With the longest steps and the largest force, the state becomes infinite, then NaN.
#[test]
fn a_state_that_is_not_finite_is_stored_and_restored() {
    let mut env = CartPole::new(Config {
        tau: 1e6,
        force_mag: 1e6,
        ..Config::default()
    })
    .unwrap();
    env.reset(0).unwrap();
    let mut observation = [0.0_f32; 4];
    for _ in 0..15 {
        observation = env.step(&Action::Left).unwrap().observation;
        let stored = serde_json::to_string(&env.snapshot().unwrap()).unwrap();
        env.restore(&serde_json::from_str(&stored).unwrap())
            .unwrap();
        assert_eq!(
            serde_json::to_string(&env.snapshot().unwrap()).unwrap(),
            stored
        );
    }
    assert!(observation.iter().any(|x| x.is_nan()), "{observation:?}");
}

#[test]
fn the_last_step_counts_and_none_beyond() {
    assert_eq!(rewards(Config::default()), [1.0, 1.0, 0.0]);
    assert_eq!(
        rewards(Config {
            sutton_barto_reward: true,
            ..Config::default()
        }),
        [0.0, -1.0, -1.0]
    );
}

/// The force is clipped; the reward uses the unclipped action.
#[test]
fn the_cost_is_that_of_the_action_as_given() {
    let step = |force: f32| {
        let mut env =
            MountainCarContinuous::new(mountain_car_continuous::Config::default()).unwrap();
        env.reset(0).unwrap();
        env.step(&[force].into()).unwrap()
    };
    assert!(
        (step(3.0).reward + 0.9).abs() < 1e-9,
        "{}",
        step(3.0).reward
    );
    assert!((step(1.0).reward + 0.1).abs() < 1e-9);
    assert!((step(3.0).observation[0] - step(1.0).observation[0]).abs() < 1e-6);
}

/// At the right end of the valley at full speed, position and velocity are clipped to exactly the
/// goal's values.
#[test]
fn the_goal_itself_counts() {
    let mut rng = Generator::from(0);
    let config = mountain_car::Config {
        goal_position: 0.6,
        goal_velocity: 0.07,
        ..Default::default()
    };
    let car = mountain_car::MountainCarDynamics::new(config).unwrap();
    let before = mountain_car::State {
        position: 0.55,
        velocity: 0.07,
        fresh: false,
    };
    let after = car
        .transition(&before, &mountain_car::Action::Right, &mut rng)
        .unwrap();
    assert_eq!((after.state.position, after.state.velocity), (0.6, 0.07));
    assert!(after.terminated);

    // the constants as `float32`, like the state
    let [goal_position, goal_velocity] = [0.6f32, 0.07].map(f64::from);
    let config = mountain_car_continuous::Config {
        goal_position,
        goal_velocity,
        ..Default::default()
    };
    let car = mountain_car_continuous::MountainCarContinuousDynamics::new(config).unwrap();
    let before = mountain_car_continuous::State {
        position: 0.55,
        velocity: 0.07,
        fresh: false,
    };
    let after = car.transition(&before, &[1.0f32].into(), &mut rng).unwrap();
    assert_eq!(
        (after.state.position, after.state.velocity),
        (goal_position, goal_velocity)
    );
    assert!(after.terminated);
}

/// With a `float64` force, all sums of a step are `float64` and rounded once, at the end. Before
/// the first step, the state is `float64` too.
#[test]
fn a_precise_force_moves_a_continuous_mountain_car_precisely() {
    use mountain_car_continuous::{Config, MountainCarContinuousDynamics, State};

    let task = MountainCarContinuousDynamics::new(Config::default()).unwrap();
    for i in 0..10_000 {
        let position = -0.6 + 2e-5 * f64::from(i);
        for fresh in [true, false] {
            let position = if fresh {
                position
            } else {
                f64::from(position as f32)
            };
            let thrice = if fresh {
                3.0 * position
            } else {
                f64::from((3.0 * position) as f32)
            };
            let state = State {
                position,
                velocity: 0.0,
                fresh,
            };
            let after = task
                .transition(&state, &[0.3].into(), &mut Generator::from(0))
                .unwrap()
                .state;
            let velocity = 0.3 * 0.0015 - 0.0025 * gym_core::math::cos(thrice);
            let expected = [(position + velocity) as f32, velocity as f32];
            assert_eq!(task.observe(&after), expected, "from {position}");
        }
    }
}

/// Upright and at rest, only the torque has a cost, in the torque's precision.
#[test]
fn a_torque_costs_in_its_own_precision() {
    use gym_classic::pendulum::{Config, PendulumDynamics, State};

    let task = PendulumDynamics::new(Config::default()).unwrap();
    let rest = State {
        theta: 0.0,
        theta_dot: 0.0,
        last_torque: None,
    };
    let reward = |action: Continuous<1>| {
        task.transition(&rest, &action, &mut Generator::from(0))
            .unwrap()
            .reward
    };
    for torque in [0.1, -0.7, 1.3, 2.0] {
        assert_eq!(reward([torque].into()), -(torque * torque * 0.001));
        let single = torque as f32;
        assert_eq!(reward([single].into()), -f64::from(single * single * 0.001));
    }
}

/// JSON has no NaN, but a `Config` may have one.
#[test]
fn constants_that_are_not_numbers_are_refused() {
    let goal_velocity = f64::NAN;
    let car = mountain_car::Config {
        goal_velocity,
        ..Default::default()
    };
    let continuous = mountain_car_continuous::Config {
        goal_velocity,
        ..Default::default()
    };
    for error in [
        mountain_car::MountainCar::new(car).unwrap_err(),
        MountainCarContinuous::new(continuous).unwrap_err(),
    ] {
        assert!(
            error.to_string().contains("goal_velocity is NaN"),
            "{error}"
        );
    }
    let pole = Config {
        theta_threshold_radians: f64::NAN,
        ..Config::default()
    };
    let error = CartPole::new(pole).unwrap_err().to_string();
    assert!(error.contains("theta_threshold_radians is NaN"), "{error}");
}

/// With equal bounds, the start is exactly this number.
#[test]
fn a_start_between_equal_bounds_is_that_number() {
    let mut pole = CartPole::new(Config::default()).unwrap();
    let at = |x: f64| Reset::seed(0).option("low", x).option("high", x);
    for x in [0.0, -0.03, 1e6] {
        assert_eq!(pole.reset(at(x)).unwrap(), [x as f32; 4]);
    }
    assert!(pole.reset(at(1e6_f64.next_up())).is_err());
    let mut pendulum = Pendulum::new(pendulum::Config::default()).unwrap();
    let rest = Reset::seed(0).option("x_init", 0.0).option("y_init", 0.0);
    assert_eq!(pendulum.reset(rest).unwrap(), [1.0, 0.0, 0.0]);
    let below = Reset::seed(0).option("x_init", -f64::MIN_POSITIVE);
    assert!(pendulum.reset(below).is_err());
}

/// (With the default constants, no episode has a state that is not finite.)
#[test]
fn a_state_that_is_no_number_is_refused() {
    let mut env = CartPole::new(Config::default()).unwrap();
    env.reset(0).unwrap();
    let before = env.snapshot().unwrap();
    for name in ["x", "x_dot", "theta", "theta_dot"] {
        for number in ["NaN", "inf", "-inf"] {
            let mut stored = serde_json::to_value(&before).unwrap();
            stored["episode"]["state"][name] = serde_json::json!({"$float": number});
            let stored = serde_json::from_value(stored).unwrap();
            assert!(env.restore(&stored).is_err(), "{name}: {number}");
            assert_eq!(env.snapshot().unwrap(), before);
        }
    }
}

/// An environment of a native vector that starts beyond the thresholds has not fallen yet: its
/// first step is its last, and is rewarded.
#[test]
fn a_native_start_beyond_the_thresholds_takes_one_step() {
    let dynamics = CartPoleDynamics::new(Config::default()).unwrap();
    let mut envs = NativeVectorEnv::new(dynamics, 3, None, Autoreset::Disabled).unwrap();
    let reset = VectorReset::from(0).option("low", 0.8).option("high", 0.9);
    let mut columns = envs.columns().unwrap();
    envs.reset_into(&reset, &mut columns).unwrap();
    let fallen = |envs: &NativeVectorEnv<CartPoleDynamics>| {
        [0, 1, 2].map(|i| {
            let state = envs.state(i).unwrap();
            (state.fresh, state.fallen)
        })
    };
    assert_eq!(fallen(&envs), [(true, false); 3]);
    let actions = Value::from([0_i64, 1, 0]);
    envs.step_into(&actions, &mut columns).unwrap();
    assert_eq!(
        (&columns.rewards, &columns.terminated),
        (&vec![1.0; 3], &vec![true; 3])
    );
    assert_eq!(fallen(&envs), [(false, true); 3]);
}

/// Lengths and masses may be negative, as in Gymnasium, but not close to 0.
#[test]
fn negative_divisors_are_taken() {
    for (length, fits) in [(-0.5, true), (-1e-6, true), (-9e-7, false), (0.0, false)] {
        let config = Config {
            length,
            ..Config::default()
        };
        assert_eq!(CartPole::new(config).is_ok(), fits, "{length}");
    }
}

/// `CartPole-v0` is `CartPole-v1` with another limit of steps, and so another environment.
#[test]
fn a_snapshot_of_another_version_is_refused() {
    let [mut env, mut other] = ["CartPole-v1", "CartPole-v0"].map(|id| make(id).unwrap());
    env.reset(0).unwrap();
    other.reset(1).unwrap();
    let before = other.snapshot().unwrap();
    let error = other.restore(&env.snapshot().unwrap()).unwrap_err();
    let error = error.to_string();
    assert!(
        error.contains("a limit of 500 steps, not of 200"),
        "{error}"
    );
    assert_eq!(other.snapshot().unwrap(), before);
}

/// Constants for which episodes would start outside of the observation space are errors of the
/// constructor.
#[test]
fn every_start_lies_in_the_space() {
    let made = |id: &str, name: &str, x: f64| builder(id).arg(name, x).build();
    let least = |name: &str, value: f64, least: f64| {
        format!(
            "{name} is {value:?}: it must be at least {least:?}, because observations at the start of an episode exceed a smaller one"
        )
    };
    let valley = |low: f64, high: f64| {
        format!(
            "min_position is {low:?} and max_position {high:?}: episodes start between -0.6 and -0.4, which must lie between the two"
        )
    };
    for (id, name, refused, accepted, reason) in [
        (
            "CartPole-v1",
            "x_threshold",
            0.0,
            0.025,
            least("x_threshold", 0.0, 0.025),
        ),
        (
            "CartPole-v1",
            "theta_threshold_radians",
            5e-324,
            0.025,
            least("theta_threshold_radians", 5e-324, 0.025),
        ),
        (
            "Pendulum-v1",
            "max_speed",
            0.99,
            1.0,
            least("max_speed", 0.99, 1.0),
        ),
        (
            "Acrobot-v1",
            "MAX_VEL_1",
            0.0,
            0.1,
            least("MAX_VEL_1", 0.0, 0.1),
        ),
        (
            "Acrobot-v1",
            "MAX_VEL_2",
            -0.0,
            0.1,
            least("MAX_VEL_2", -0.0, 0.1),
        ),
        (
            "MountainCar-v0",
            "min_position",
            -0.59,
            -0.6,
            valley(-0.59, 0.6),
        ),
        (
            "MountainCar-v0",
            "max_position",
            -0.41,
            -0.4,
            valley(-1.2, -0.41),
        ),
        (
            "MountainCarContinuous-v0",
            "min_position",
            -0.59,
            -0.6,
            valley(-0.59, 0.6),
        ),
        (
            "MountainCarContinuous-v0",
            "max_position",
            -0.41,
            -0.4,
            valley(-1.2, -0.41),
        ),
    ] {
        let error = made(id, name, refused).unwrap_err().to_string();
        let (kind, _) = id.split_once("-v").unwrap();
        assert_eq!(error, format!("invalid argument for {kind}: {reason}"));
        let mut env = made(id, name, accepted).unwrap();
        for seed in 0..50 {
            let observation = env.reset(seed).unwrap();
            env.observation_space().check(&observation).unwrap();
        }
    }
}
