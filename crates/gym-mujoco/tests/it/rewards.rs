//! Rewards, ends and infos with different arguments, compared with values that the test computes
//! from the state.

use gym_core::{BoxEnv, Env, EnvExt, Registration, Value, builder, make, registry};
use gym_sim::SimEnv;
use mujoco_engine::Data;
use serde_json::{Value as Json, json};

/// Returns the number `name` of the info.
fn told(env: &BoxEnv, name: &str) -> f64 {
    env.info_map()[name]
        .as_float()
        .unwrap_or_else(|| panic!("{name} is no number"))
}

fn data(env: &BoxEnv) -> &Data {
    env.layer::<SimEnv>()
        .and_then(|env| env.data())
        .expect("an episode")
}

fn with(id: &str, arguments: &[(&str, Json)]) -> BoxEnv {
    let named = arguments.iter().fold(builder(id), |env, (name, value)| {
        env.arg(name, value.clone())
    });
    named
        .build()
        .unwrap_or_else(|error| panic!("{id}: {error}"))
}

/// Returns the entries of the info that are parts of the reward.
fn parts(env: &BoxEnv) -> Vec<(String, f64)> {
    let is_part = |name: &str| name.starts_with("reward_") || name.ends_with("_penalty");
    let info = env.info_map().into_iter().filter(|(name, _)| is_part(name));
    info.map(|(name, value)| (name.to_string(), value.as_float().expect("a number")))
        .collect()
}

/// Returns the parts of the reward in each of `steps` random steps, always with the same seed.
fn history(env: &mut BoxEnv, steps: usize) -> Vec<Vec<(String, f64)>> {
    let mut actions = env.action_sampler(4).unwrap();
    env.reset(3).unwrap();
    (0..steps)
        .map(|_| {
            env.step(&actions.sample()).unwrap();
            parts(env)
        })
        .collect()
}

#[test]
fn the_reward_is_the_sum_of_its_parts() {
    for id in registry::all()
        .iter()
        .map(Registration::id)
        .filter(|id| id.ends_with("-v5"))
    {
        let mut env = make(id).unwrap();
        let mut actions = env.action_sampler(4).unwrap();
        env.reset(3).unwrap();
        // HumanoidStandup adds 1 in each step, which the info does not contain
        let always = if id.starts_with("HumanoidStandup") {
            1.0
        } else {
            0.0
        };
        for step in 0..30 {
            let reward = env.step(&actions.sample()).unwrap().reward;
            let sum = always + parts(&env).iter().map(|(_, part)| part).sum::<f64>();
            assert!(
                (reward - sum).abs() <= 1e-9 * reward.abs().max(1.0),
                "{id}, {step}: {reward} for {sum}"
            );
        }
    }
}

/// A weight scales only its own part of the reward.
#[test]
fn a_weight_scales_its_own_part() {
    for (id, name, weight, part) in [
        (
            "HalfCheetah-v5",
            "forward_reward_weight",
            1.0,
            "reward_forward",
        ),
        ("HalfCheetah-v5", "ctrl_cost_weight", 0.1, "reward_ctrl"),
        ("Swimmer-v5", "forward_reward_weight", 1.0, "reward_forward"),
        ("Swimmer-v5", "ctrl_cost_weight", 1e-4, "reward_ctrl"),
        ("Hopper-v5", "forward_reward_weight", 1.0, "reward_forward"),
        ("Hopper-v5", "ctrl_cost_weight", 1e-3, "reward_ctrl"),
        ("Hopper-v5", "healthy_reward", 1.0, "reward_survive"),
        (
            "Walker2d-v5",
            "forward_reward_weight",
            1.0,
            "reward_forward",
        ),
        ("Walker2d-v5", "ctrl_cost_weight", 1e-3, "reward_ctrl"),
        ("Walker2d-v5", "healthy_reward", 1.0, "reward_survive"),
        ("Ant-v5", "forward_reward_weight", 1.0, "reward_forward"),
        ("Ant-v5", "ctrl_cost_weight", 0.5, "reward_ctrl"),
        ("Ant-v5", "contact_cost_weight", 5e-4, "reward_contact"),
        ("Ant-v5", "healthy_reward", 1.0, "reward_survive"),
        (
            "Humanoid-v5",
            "forward_reward_weight",
            1.25,
            "reward_forward",
        ),
        ("Humanoid-v5", "ctrl_cost_weight", 0.1, "reward_ctrl"),
        // (so small that the cost of contact forces is not clipped)
        ("Humanoid-v5", "contact_cost_weight", 5e-9, "reward_contact"),
        ("Humanoid-v5", "healthy_reward", 5.0, "reward_survive"),
        (
            "HumanoidStandup-v5",
            "ctrl_cost_weight",
            0.1,
            "reward_quadctrl",
        ),
        (
            "HumanoidStandup-v5",
            "impact_cost_weight",
            5e-9,
            "reward_impact",
        ),
        (
            "InvertedDoublePendulum-v5",
            "healthy_reward",
            10.0,
            "reward_survive",
        ),
        ("Reacher-v5", "reward_dist_weight", 1.0, "reward_dist"),
        ("Reacher-v5", "reward_control_weight", 1.0, "reward_ctrl"),
        ("Pusher-v5", "reward_near_weight", 0.5, "reward_near"),
        ("Pusher-v5", "reward_dist_weight", 1.0, "reward_dist"),
        ("Pusher-v5", "reward_control_weight", 0.1, "reward_ctrl"),
    ] {
        let mut plain = history(&mut with(id, &[(name, json!(weight))]), 40);
        let scaled = history(&mut with(id, &[(name, json!(2.0 * weight))]), 40);
        let is_own = |(other, amount): &(String, f64)| other == part && *amount != 0.0;
        assert!(
            plain.iter().flatten().any(is_own),
            "{id}: there is no {part}"
        );
        for (_, amount) in plain
            .iter_mut()
            .flatten()
            .filter(|(other, _)| other == part)
        {
            *amount *= 2.0;
        }
        assert_eq!(scaled, plain, "{id}: {name}");
    }
}

/// A task, the name of a range, narrow bounds, and the function that returns the numbers that must
/// lie in the range.
type Range = (&'static str, &'static str, [f64; 2], fn(&Data) -> Vec<f64>);

const RANGES: [Range; 7] = [
    ("Hopper-v5", "healthy_z_range", [1.2, 1.3], |data| {
        vec![data.qpos[1]]
    }),
    ("Hopper-v5", "healthy_angle_range", [-0.01, 0.01], |data| {
        vec![data.qpos[2]]
    }),
    // all numbers except the position along the track
    ("Hopper-v5", "healthy_state_range", [-3.0, 3.0], |data| {
        [&data.qpos[2..], &data.qvel[..]].concat()
    }),
    ("Walker2d-v5", "healthy_z_range", [1.2, 1.3], |data| {
        vec![data.qpos[1]]
    }),
    (
        "Walker2d-v5",
        "healthy_angle_range",
        [-0.05, 0.05],
        |data| vec![data.qpos[2]],
    ),
    ("Ant-v5", "healthy_z_range", [0.6, 0.9], |data| {
        vec![data.qpos[2]]
    }),
    ("Humanoid-v5", "healthy_z_range", [1.35, 1.42], |data| {
        vec![data.qpos[2]]
    }),
];

/// A step that ends in a healthy state has the healthy reward. The first step that ends in an
/// unhealthy state terminates the episode, if `terminate_when_unhealthy` is true.
#[test]
fn health_is_what_its_ranges_say() {
    for (id, name, [low, high], reads) in RANGES {
        let wide = RANGES.iter().filter(|(other, ..)| *other == id);
        let mut arguments: Vec<(&str, Json)> = wide
            .map(|(_, name, ..)| (*name, json!([null, null])))
            .collect();
        arguments.retain(|(other, _)| *other != name);
        arguments.push((name, json!([low, high])));
        for ends in [false, true] {
            let mut env = with(
                id,
                &[&arguments[..], &[("terminate_when_unhealthy", json!(ends))]].concat(),
            );
            let healthy_reward = if id.starts_with("Humanoid") { 5.0 } else { 1.0 };
            let mut actions = env.action_sampler(4).unwrap();
            env.reset(3).unwrap();
            let mut seen = [0; 2];
            for step in 0..60 {
                let terminated = env.step(&actions.sample()).unwrap().terminated;
                let healthy = reads(data(&env)).iter().all(|x| low < *x && *x < high);
                let paid = told(&env, "reward_survive");
                let what = format!("{id}, {name}, step {step}");
                assert_eq!(paid, if healthy { healthy_reward } else { 0.0 }, "{what}");
                assert_eq!(terminated, ends && !healthy, "{what}");
                seen[usize::from(healthy)] += 1;
                if terminated {
                    break;
                }
            }
            assert!(
                !seen.contains(&0),
                "{id}, {name}: unhealthy and healthy steps are {seen:?}"
            );
        }
    }
}

/// The hopper's position and height are not part of its state range.
#[test]
fn a_place_is_not_unhealthy() {
    let ranges = [
        ("healthy_state_range", json!([-3, 3])),
        ("healthy_z_range", json!([0.7, null])),
    ];
    let mut env = with("Hopper-v5", &ranges);
    env.reset(3).unwrap();
    env.layer_mut::<SimEnv>()
        .expect("a task")
        .set_state(&[50.0, 50.0, 0.0, 0.0, 0.0, 0.0], &[0.0; 6])
        .unwrap();
    let action = env.action_space().zero().unwrap();
    assert!(!env.step(&action).unwrap().terminated);
    assert_eq!(told(&env, "reward_survive"), 1.0);
}

/// Before version 5, the step in which the pole falls has the survival reward; since version 5, it
/// has not.
#[test]
fn a_fall_is_not_paid_for_since_version_5() {
    for (id, upright, fallen) in [
        ("InvertedPendulum-v2", 1.0, 1.0),
        ("InvertedPendulum-v4", 1.0, 1.0),
        ("InvertedPendulum-v5", 1.0, 0.0),
        ("InvertedDoublePendulum-v2", 10.0, 10.0),
        ("InvertedDoublePendulum-v4", 10.0, 10.0),
        ("InvertedDoublePendulum-v5", 10.0, 0.0),
    ] {
        let mut env = make(id).unwrap();
        env.reset(3).unwrap();
        let push = Value::from([1.0_f32]);
        // the largest cost of distance and speed of a double pendulum
        let cost = if id.starts_with("InvertedDouble") {
            5.0
        } else {
            0.0
        };
        let (steps, last) = (1..1000)
            .map(|count| (count, env.step(&push).unwrap()))
            .inspect(|(_, step)| {
                let paid = if step.terminated { fallen } else { upright };
                assert!(
                    (-cost..=0.0).contains(&(step.reward - paid)),
                    "{id}: {} for {paid}",
                    step.reward
                );
            })
            .find(|(_, step)| step.terminated)
            .expect("it falls");
        assert!(steps > 1, "{id}: it stands at first: {last:?}");
    }
}

/// Ant clips each force, in its cost and in its observation.
#[test]
fn forces_of_an_ant_are_clipped_to_their_range() {
    const RANGE: [f64; 2] = [-0.05, 0.02];
    let mut env = with(
        "Ant-v5",
        &[
            ("contact_force_range", json!(RANGE)),
            ("contact_cost_weight", json!(3.0)),
        ],
    );
    let mut actions = env.action_sampler(4).unwrap();
    env.reset(3).unwrap();
    let mut beyond = [0; 2];
    for _ in 0..60 {
        let seen = env.step(&actions.sample()).unwrap().observation;
        let forces = data(&env).cfrc_ext.as_flattened();
        beyond[0] += forces.iter().filter(|force| **force < RANGE[0]).count();
        beyond[1] += forces.iter().filter(|force| **force > RANGE[1]).count();
        let clipped: Vec<f64> = forces
            .iter()
            .map(|force| force.clamp(RANGE[0], RANGE[1]))
            .collect();
        let seen = seen.as_slice::<f64>().unwrap();
        // (the observation does not contain the forces on the world body)
        assert_eq!(seen[seen.len() - clipped.len() + 6..], clipped[6..]);
        let cost = 3.0 * clipped.iter().map(|force| force * force).sum::<f64>();
        let told = told(&env, "reward_contact");
        assert!(
            (told + cost).abs() <= 1e-12 * cost,
            "{told} for a cost of {cost}"
        );
    }
    assert!(
        !beyond.contains(&0),
        "forces lie beyond both ends: {beyond:?}"
    );
}

/// The humanoid tasks clip the total cost of contact forces.
#[test]
fn costs_of_forces_are_clipped_to_their_range() {
    for (id, weight, range, part) in [
        (
            "Humanoid-v5",
            "contact_cost_weight",
            "contact_cost_range",
            "reward_contact",
        ),
        (
            "HumanoidStandup-v5",
            "impact_cost_weight",
            "impact_cost_range",
            "reward_impact",
        ),
    ] {
        let costs = |[low, high]: [Option<f64>; 2]| -> Vec<f64> {
            let env = &mut with(id, &[(weight, json!(1e-3)), (range, json!([low, high]))]);
            let history = history(env, 60);
            let cost = |parts: &Vec<(String, f64)>| {
                -parts.iter().find(|(name, _)| name == part).unwrap().1
            };
            history.iter().map(cost).collect()
        };
        let whole = costs([None, None]);
        let mut sorted: Vec<f64> = whole.iter().copied().filter(|cost| *cost > 0.0).collect();
        sorted.sort_by(f64::total_cmp);
        let [low, high] = [1, 2].map(|third| sorted[third * sorted.len() / 3]);
        assert!(
            sorted[0] < low && low < high && high < sorted[sorted.len() - 1],
            "{id}: {sorted:?}"
        );
        let clipped: Vec<f64> = whole.iter().map(|cost| cost.clamp(low, high)).collect();
        assert_eq!(costs([Some(low), Some(high)]), clipped, "{id}");
    }
}

/// Hopper and Walker2d clip the observed velocities to 10; HalfCheetah does not.
#[test]
fn speeds_are_observed_up_to_a_limit() {
    for (id, limit) in [
        ("Hopper-v5", 10.0),
        ("Walker2d-v5", 10.0),
        ("Hopper-v3", 10.0),
        ("HalfCheetah-v5", f64::INFINITY),
    ] {
        let mut env = make(id).unwrap();
        env.reset(3).unwrap();
        let (qpos, nv) = (data(&env).qpos.clone(), data(&env).qvel.len());
        let fast: Vec<f64> = (0..nv)
            .map(|i| if i % 2 == 0 { 25.0 } else { -25.0 })
            .collect();
        env.layer_mut::<SimEnv>()
            .expect("a task")
            .set_state(&qpos, &fast)
            .unwrap();
        let action = env.action_space().zero().unwrap();
        let seen = env.step(&action).unwrap().observation;
        let (seen, qvel) = (seen.as_slice::<f64>().unwrap(), &data(&env).qvel);
        assert!(
            qvel.iter().any(|v| *v > 10.0) && qvel.iter().any(|v| *v < -10.0),
            "{id}: {qvel:?}"
        );
        let expected: Vec<f64> = qvel.iter().map(|v| v.clamp(-limit, limit)).collect();
        assert_eq!(seen[seen.len() - nv..], expected, "{id}");
    }
}

/// After a reset, a used environment has the same info as a new environment, without rewards.
#[test]
fn a_used_task_tells_after_a_reset_what_a_new_one_does() {
    for entry in registry::all() {
        let id = entry.id();
        let mut new = make(id).unwrap();
        let mut used = new.clone();
        used.reset(1).unwrap();
        let action = used.action_sampler(0).unwrap().sample();
        used.step(&action).unwrap();
        let after_a_step = used.info_map();
        let [seen, expected] =
            [&mut used, &mut new].map(|env| (env.reset(3).unwrap(), env.info_map()));
        assert_eq!(seen, expected, "{id}");
        assert!(
            expected.1.keys().all(|name| !name.contains("reward")),
            "{id}: {:?}",
            expected.1
        );
        // the info describes the new state
        let position =
            |info: &gym_core::Info| info.get("x_position").cloned().unwrap_or(Value::Null);
        assert!(
            position(&after_a_step) != position(&seen.1) || position(&seen.1) == Value::Null,
            "{id}"
        );
    }
}

/// The target lies within the reach of the arm, and the object lies away from its goal.
#[test]
fn goals_lie_where_they_may() {
    for version in ["v2", "v4", "v5"] {
        let mut reacher = make(&format!("Reacher-{version}")).unwrap();
        let mut pusher = make(&format!("Pusher-{version}")).unwrap();
        let (mut farthest, mut nearest): (f64, f64) = (0.0, 1.0);
        for seed in 0..150 {
            reacher.reset(seed).unwrap();
            let Data { qpos, qvel, .. } = data(&reacher);
            assert_eq!(qvel[2..], [0.0; 2], "the target stands still");
            farthest = farthest.max(qpos[2].hypot(qpos[3]));
            pusher.reset(seed).unwrap();
            let Data { qpos, qvel, .. } = data(&pusher);
            assert_eq!((&qpos[9..], &qvel[7..]), (&[0.0; 2][..], &[0.0; 4][..]));
            nearest = nearest.min(qpos[7].hypot(qpos[8]));
        }
        // (targets lie within 0.2 m of the centre, objects at least 0.17 m from the goal)
        assert!((0.18..0.2).contains(&farthest), "{version}: {farthest}");
        assert!((0.17..0.18).contains(&nearest), "{version}: {nearest}");
    }
}
