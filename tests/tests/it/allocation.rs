//! A step allocates nothing: with concrete types, through `make`, and in a vector.

use gym::vector::{Autoreset, VectorKind};
use gym::{
    Element, Env, EnvExt, Outcome, Registration, Value, VectorEnv, VectorEnvExt, VectorWrap,
    make_vec, registry,
};

use super::sample::one_per_module;

/// Returns the number of allocations in `steps` steps with one observation buffer. Resets at the
/// ends of episodes are not counted.
fn allocations<E: Env>(env: &mut E, steps: usize) -> u64 {
    let mut actions = env.action_sampler(0).unwrap();
    let actions: Vec<E::Action> = (0..steps).map(|_| actions.sample()).collect();
    let mut observation = E::Observation::empty();
    env.reset_into(&0.into(), &mut observation).unwrap();
    // one-time allocations, as of the passive checker, are not counted
    env.step_into(&actions[0], &mut observation).unwrap();
    env.reset_into(&0.into(), &mut observation).unwrap();
    let mut total = 0;
    for action in &actions {
        let mut outcome = Outcome::default();
        let count = allocation_counter::measure(|| {
            outcome = env.step_into(action, &mut observation).unwrap();
        });
        total += count.count_total;
        if outcome.done() {
            env.reset_into(&().into(), &mut observation).unwrap();
        }
    }
    total
}

#[test]
fn the_counter_counts() {
    assert!(
        allocation_counter::measure(|| drop(Value::from_value(&Value::Text("x".repeat(9)))))
            .count_total
            > 0
    );
}

#[test]
fn erased_steps_do_not_allocate() {
    // rapier2d allocates in its own step
    let allocates = |id: &str| id.starts_with("rapier/");
    for registration in one_per_module()
        .iter()
        .filter(|registration| !allocates(registration.id()))
    {
        let mut env = gym::make(registration.id()).unwrap();
        assert_eq!(allocations(&mut env, 1000), 0, "{}", registration.id());
    }
}

/// Returns the number of allocations in 500 steps, including automatic resets.
fn vector_allocations<V: VectorEnv>(mut envs: V) -> u64 {
    let mut sampler = envs.action_sampler(0).unwrap();
    let actions: Vec<Value> = (0..500).map(|_| sampler.sample()).collect();
    let mut columns = envs.reset(0).unwrap();
    // one-time allocations are not counted
    for action in &actions[..250] {
        envs.step_into(action, &mut columns).unwrap();
    }
    let count = allocation_counter::measure(|| {
        for action in &actions {
            envs.step_into(action, &mut columns).unwrap();
        }
    });
    count.count_total
}

#[test]
fn steps_of_sync_vectors_do_not_allocate() {
    for id in [
        "CartPole-v1",
        "Pendulum-v1",
        "MountainCar-v0",
        "Acrobot-v1",
        "CliffWalking-v1",
        "Blackjack-v1",
    ] {
        assert_eq!(
            vector_allocations(make_vec(id, 8, VectorKind::Sync).unwrap()),
            0,
            "{id}"
        );
    }
    let cartpoles = |autoreset| {
        let vector = gym::builder("CartPole-v1").vector(8).kind(VectorKind::Sync);
        vector.autoreset(autoreset).build().unwrap()
    };
    assert_eq!(vector_allocations(cartpoles(Autoreset::SameStep)), 0);
    let envs = cartpoles(Autoreset::NextStep)
        .record_episode_statistics()
        .normalize_observation()
        .unwrap();
    assert_eq!(
        vector_allocations(
            envs.normalize_reward(0.99)
                .unwrap()
                .clip_reward((-1.0, 1.0))
                .unwrap()
        ),
        0
    );
    // allocates only at an episode's end, where a reset builds a new world
    let lander = gym::builder("LunarLander-v3")
        .max_episode_steps(None)
        .vector(1)
        .kind(VectorKind::Sync);
    let mut lander = lander.build().unwrap();
    let idle = Value::Array([0i64].into());
    let mut columns = lander.reset(0).unwrap();
    lander.step_into(&idle, &mut columns).unwrap();
    while !columns.done(0) {
        let count = allocation_counter::measure(|| lander.step_into(&idle, &mut columns).unwrap());
        assert_eq!(count.count_total, 0);
    }
}

/// Vectors that solve their worlds together, up to the first end of an episode.
#[test]
fn steps_of_native_vectors_of_worlds_do_not_allocate() {
    for (id, least) in [
        ("LunarLander-v3", 30),
        ("LunarLanderContinuous-v3", 30),
        ("BipedalWalker-v3", 30),
        ("HalfCheetah-v5", 60),
        ("Ant-v5", 5),
        ("InvertedDoublePendulum-v5", 2),
    ] {
        let mut envs = gym::builder(id)
            .vector(20)
            .kind(VectorKind::Native)
            .build()
            .unwrap();
        let mut actions = envs.action_space().unwrap().sampler(1);
        let mut columns = envs.reset(0).unwrap();
        let mut steps = 0;
        while steps < 100 && !(0..20).any(|i| columns.done(i)) {
            let actions = actions.sample();
            let count =
                allocation_counter::measure(|| envs.step_into(&actions, &mut columns).unwrap());
            assert!(steps == 0 || count.count_total == 0, "{id}: step {steps}");
            steps += 1;
        }
        assert!(steps > least, "{id}: {steps}");
    }
}

#[test]
fn frames_of_pygame_do_not_allocate() {
    // the other environments do not draw with pygame's calls: `tiny-skia` draws them, or they
    // collect tiles for each frame
    let is_pygame = |registration: &&Registration| {
        let others = [
            "gym-control",
            "gym-mujoco",
            "gym-robotics",
            "gym-toytext",
            "gym-minigrid",
        ];
        !others.contains(&registration.source.package)
    };
    for registration in registry::self_contained().iter().filter(is_pygame) {
        let id = registration.id();
        let mut env = gym::make(id).unwrap();
        let mut painter = gym::render::painter().unwrap();
        let size = env.metadata().render_size;
        let mut frame = gym::render::Frame::new(size.0, size.1).unwrap();
        // the buffers grow in the first pass; the second draws the same frames
        for pass in 0..2 {
            let mut actions = env.action_sampler(0).unwrap();
            env.reset(0).unwrap();
            for step in 0..60 {
                let count = allocation_counter::measure(|| {
                    painter.paint(size, &mut |canvas| env.draw(canvas), &mut frame);
                });
                assert!(
                    pass == 0 || count.count_total == 0,
                    "{id}, step {step}: {}",
                    count.count_total
                );
                if env.step(&actions.sample()).unwrap().done() {
                    env.reset(()).unwrap();
                }
            }
        }
    }
}

#[test]
fn rendering_into_a_picture_does_not_allocate() {
    // LunarLander is missing: its exhaust creates bodies
    for id in ["CartPole-v1", "BipedalWalker-v3", "Pendulum-v1"] {
        let mut env = gym::builder(id)
            .render_mode(gym::render::RenderMode::RgbArray)
            .build()
            .unwrap();
        env.reset(0).unwrap();
        let mut rendered = env.render().unwrap();
        let mut total = 0;
        for pass in 0..2 {
            let mut actions = env.action_sampler(0).unwrap();
            env.reset(0).unwrap();
            for _ in 0..10 {
                env.step(&actions.sample()).unwrap();
                // state that changes per frame gives the same frame in a clone
                let expected = env.clone().render().unwrap();
                let count = allocation_counter::measure(|| env.render_into(&mut rendered).unwrap());
                total += if pass == 0 { 0 } else { count.count_total };
                assert_eq!(rendered, expected, "{id}");
            }
        }
        assert_eq!(total, 0, "{id}");
    }
}

#[test]
fn typed_steps_do_not_allocate() {
    use gym::wrappers::{RecordEpisodeStatistics, TimeLimit};
    let env = gym::classic::CartPole::new(gym::classic::cartpole::Config::default()).unwrap();
    assert_eq!(allocations(&mut env.clone(), 1000), 0);
    let mut wrapped = RecordEpisodeStatistics::new(TimeLimit::new(env, 500).unwrap());
    assert_eq!(allocations(&mut wrapped, 1000), 0);
    let mut taxi = gym::toytext::Taxi::new(gym::toytext::taxi::Config::default()).unwrap();
    assert_eq!(allocations(&mut taxi, 1000), 0);
}

/// The bounds of a batched space are as large as the observations, so the space is computed on
/// request.
#[test]
fn a_vector_holds_its_environments_and_two_observations_of_each() {
    const N: usize = 16;
    const PICTURE: usize = 96 * 96 * 3;
    let mut held = (Vec::new(), None);
    let make = || gym::make("CarRacing-v3").unwrap();
    let alone = allocation_counter::measure(|| held.0 = (0..N).map(|_| make()).collect());
    let vector = allocation_counter::measure(|| {
        held.1 = Some(make_vec("CarRacing-v3", N, VectorKind::Sync).unwrap());
    });
    // in addition, the space of one observation: two bounds, and a boundedness flag for each number
    let most = alone.bytes_current + (N * (2 * PICTURE + 4096) + 4 * PICTURE) as i64;
    assert!(
        vector.bytes_current < most,
        "{} bytes, {} for the environments",
        vector.bytes_current,
        alone.bytes_current
    );
    assert!(held.1.unwrap().observation_space().is_ok() && held.0.len() == N);
}
