//! Actions that try to break a simulation. No task may panic, hang, or return numbers that are not
//! finite.

use gym_core::{Array, BoxEnv, Env, EnvExt, Space, Value, builder, registry};
use gym_sim::SimEnv;

/// Returns the newest version of each task.
fn tasks() -> Vec<String> {
    let ids = registry::all()
        .into_iter()
        .map(|entry| entry.id().to_owned());
    let tasks: Vec<String> = ids.filter(|id| id.ends_with("-v5")).collect();
    assert_eq!(tasks.len(), 11, "{tasks:?}");
    tasks
}

/// Makes the task `id`, with episodes that continue after a fall if the task allows it.
fn unending(id: &str) -> BoxEnv {
    let plain = builder(id).max_episode_steps(500);
    plain
        .clone()
        .arg("terminate_when_unhealthy", false)
        .build()
        .or_else(|_| plain.build())
        .unwrap()
}

/// A generator of numbers from -1 to 1.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f32 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 40) as f32 / (1_u32 << 23) as f32 - 1.0
    }

    fn below(&mut self, n: u64) -> u64 {
        self.next();
        (self.0 >> 33) % n
    }
}

/// The kinds of controls, each applied for some time.
#[derive(Clone, Copy, Debug)]
enum Plan {
    /// Each actuator at one of its limits, which is drawn in every step.
    BangBang,
    /// All actuators at their limits, which alternate from step to step.
    Alternating,
    /// Successive actuators at opposite limits, for the whole duration.
    Twist,
    /// At the limit in the direction of motion: the energy grows without end.
    Pump,
    /// Controls far outside the limits.
    Beyond,
    /// The largest `float32` numbers.
    Utmost,
    /// Controls near 0.
    Rest,
}

const PLANS: [Plan; 7] = [
    Plan::BangBang,
    Plan::Alternating,
    Plan::Twist,
    Plan::Pump,
    Plan::Beyond,
    Plan::Utmost,
    Plan::Rest,
];

fn act(plan: Plan, env: &BoxEnv, most: f32, step: usize, random: &mut Random, action: &mut [f32]) {
    let velocities = env
        .layer::<SimEnv>()
        .and_then(|env| env.data())
        .map(|data| &data.qvel);
    let n = action.len();
    for (i, a) in action.iter_mut().enumerate() {
        let draw = random.next();
        *a = match plan {
            Plan::BangBang => most.copysign(draw),
            Plan::Alternating => [most, -most][step % 2],
            Plan::Twist => [most, -most][i % 2],
            Plan::Pump => {
                // in nearly all tasks, the last velocities are those of the joints with motors
                let speed =
                    velocities.and_then(|qvel| qvel.get((qvel.len() + i).saturating_sub(n)));
                most.copysign(speed.copied().unwrap_or_default() as f32)
            }
            Plan::Beyond => draw * 1e6,
            Plan::Utmost => f32::MAX.copysign(draw),
            Plan::Rest => draw * 1e-30,
        };
    }
}

/// `GYM_SOAK_STEPS` sets the number of steps of each task. (A million steps pass.)
#[test]
fn adversarial_actions_leave_every_number_finite() {
    let steps: usize = std::env::var("GYM_SOAK_STEPS").map_or(3_000, |n| n.parse().unwrap());
    for id in tasks() {
        let mut env = unending(&id);
        let Space::Box(space) = env.action_space() else {
            panic!("{id}")
        };
        let most = space.high().iter_f64().fold(0.0, f64::max) as f32;
        let mut action = vec![0.0f32; space.shape()[0]];
        let (mut random, mut plan, mut until) = (Random(11), Plan::Rest, 0);
        env.reset(7).unwrap();
        let (mut episodes, mut fastest) = (0, 0.0_f64);
        for step in 0..steps {
            if step >= until {
                plan = PLANS[random.below(PLANS.len() as u64) as usize];
                until = step + 1 + random.below(120) as usize;
            }
            act(plan, &env, most, step, &mut random, &mut action);
            let taken = env
                .step(&Value::Array(Array::from(action.clone())))
                .unwrap();
            let what = || format!("{id}, step {step}, {plan:?}");
            let seen = taken.observation.as_slice::<f64>().unwrap();
            assert!(seen.iter().all(|x| x.is_finite()), "{}: {seen:?}", what());
            // a sum of squares in float32 overflows, as Gymnasium's does
            let costly = matches!(plan, Plan::Utmost);
            assert!(
                taken.reward.is_finite() || (costly && taken.reward == f64::NEG_INFINITY),
                "{}",
                what()
            );
            let data = env.layer::<SimEnv>().and_then(|env| env.data()).unwrap();
            let numbers = data
                .qpos
                .iter()
                .chain(&data.qvel)
                .chain(&data.qacc)
                .chain(&data.qfrc_constraint);
            for x in numbers.chain(data.cfrc_ext.iter().flatten()) {
                assert!(x.is_finite(), "{}", what());
            }
            fastest = data.qvel.iter().fold(fastest, |most, v| most.max(v.abs()));
            // every state can be stored
            if step % 499 == 0 {
                let mut twin = unending(&id);
                twin.restore(&env.snapshot().unwrap())
                    .unwrap_or_else(|error| panic!("{}: {error}", what()));
            }
            if taken.done() {
                episodes += 1;
                env.reset(()).unwrap();
            }
        }
        println!("{id}: {steps} steps, {episodes} episodes, up to {fastest:.1} m/s or rad/s");
    }
}
