//! Vector wrappers, beyond the traces of Gymnasium in parity.rs.

use gym::vector::{Autoreset, SyncVectorEnv, VectorKind, VectorReset};
use gym::wrappers::NormalizeReward;
use gym::wrappers::{
    Bound, NormalizeObservation, RecordEpisodeStatistics, TransformAction, TransformObservation,
    normalize_observation, record_episode_statistics,
};
use gym::{DType, Error, Space, Value, VectorEnv, VectorEnvExt, VectorWrap, builder, make_vec};

fn pendulums(n: usize, autoreset: Autoreset) -> Box<dyn VectorEnv> {
    let vector = builder("Pendulum-v1").max_episode_steps(5).vector(n);
    vector
        .kind(VectorKind::Sync)
        .autoreset(autoreset)
        .build()
        .unwrap()
}

#[test]
fn a_partial_reset_keeps_the_statistics_of_the_others() {
    for autoreset in [
        Autoreset::NextStep,
        Autoreset::SameStep,
        Autoreset::Disabled,
    ] {
        let mut envs = pendulums(2, autoreset).record_episode_statistics();
        let actions = envs.action_sampler(0).unwrap().sample();
        let mut columns = envs.reset(0).unwrap();
        let mut total = 0.0;
        for step in 0..5 {
            if step == 2 {
                envs.reset_into(&VectorReset::default().mask([true, false]), &mut columns)
                    .unwrap();
            }
            envs.step_into(&actions, &mut columns).unwrap();
            total += columns.rewards[1];
        }
        let [first, second] = [0, 1].map(|index| envs.ended(index).copied());
        assert_eq!(first, None, "{autoreset:?}");
        let second = second.unwrap();
        assert_eq!(
            (second.episode_return, second.length),
            (total, 5),
            "{autoreset:?}"
        );
        assert_eq!((envs.episode_count(), envs.episodes().len()), (1, 1));
    }
}

#[test]
fn statistics_are_those_of_each_environment_alone() {
    for autoreset in [Autoreset::NextStep, Autoreset::SameStep] {
        let vector = builder("CartPole-v1")
            .vector(3)
            .kind(VectorKind::Sync)
            .autoreset(autoreset);
        let mut outside = RecordEpisodeStatistics::new(vector.build().unwrap());
        let within = builder("CartPole-v1").wrap(gym::WrapperSpec::new("RecordEpisodeStatistics"));
        let mut within = within
            .vector(3)
            .kind(VectorKind::Sync)
            .autoreset(autoreset)
            .build()
            .unwrap();
        let mut actions = outside.action_sampler(5).unwrap();
        let mut columns = outside.reset(0).unwrap();
        within.reset(0).unwrap();
        for _ in 0..200 {
            let batch = actions.sample();
            outside.step_into(&batch, &mut columns).unwrap();
            within.step_into(&batch, &mut columns).unwrap();
            for index in 0..3 {
                let mut info = within.info_map(index);
                within.final_info(index, &mut |key, value| {
                    drop(info.insert(key.to_owned(), value));
                });
                let alone = info.get("episode").map(|episode| {
                    (
                        episode.get("r").unwrap().as_float().unwrap(),
                        episode.get("l").unwrap().as_int().unwrap(),
                    )
                });
                let ended = outside
                    .ended(index)
                    .map(|ended| (ended.episode_return, ended.length as i64));
                assert_eq!(ended, alone, "{autoreset:?}");
            }
        }
        assert!(outside.episode_count() > 10);
    }
}

#[test]
fn observation_wrappers_reach_the_final_observations() {
    let mut plain = pendulums(2, Autoreset::SameStep);
    let double = |batch: &Value| {
        let doubled: Vec<f32> = batch
            .as_slice::<f32>()
            .unwrap()
            .iter()
            .map(|x| 2.0 * x)
            .collect();
        Value::Array(gym::Array::from(doubled).reshape([2, 3]).unwrap())
    };
    let inner = pendulums(2, Autoreset::SameStep);
    let mut doubled = TransformObservation::new(
        inner,
        double,
        Space::boxed([-2.0, -2.0, -16.0], [2.0, 2.0, 16.0]),
    );
    let (mut a, mut b) = (plain.reset(0).unwrap(), doubled.reset(0).unwrap());
    let mut actions = plain.action_sampler(0).unwrap();
    for _ in 0..12 {
        let batch = actions.sample();
        plain.step_into(&batch, &mut a).unwrap();
        doubled.step_into(&batch, &mut b).unwrap();
        assert_eq!(b.observations, double(&a.observations));
        if a.has_final[0] {
            assert_eq!(b.final_observations, double(&a.final_observations));
        }
        assert_eq!(b.has_final, a.has_final);
    }
    let wrong = |_: &Value| Value::Int(3);
    assert!(matches!(
        TransformObservation::new(pendulums(2, Autoreset::SameStep), wrong, None).reset(0),
        Err(Error::Contract(_))
    ));
}

#[test]
fn actions_are_clipped_rescaled_and_transformed() {
    let step = |mut envs: Box<dyn VectorEnv>, actions: [f32; 2]| {
        let actions = Value::Array(gym::Array::from(actions).reshape([2, 1]).unwrap());
        envs.reset(0).unwrap();
        envs.step(&actions).unwrap()
    };
    let envs = || pendulums(2, Autoreset::NextStep);
    let expected = step(envs(), [2.0, -1.0]);
    assert_eq!(
        step(Box::new(envs().clip_action().unwrap()), [7.0, -1.0]),
        expected
    );
    assert_eq!(
        step(
            Box::new(envs().rescale_action((-1.0, 1.0)).unwrap()),
            [1.0, -0.5]
        ),
        expected
    );
    assert_eq!(
        step(
            Box::new(envs().rescale_action(([-4.0f32], [4.0f32])).unwrap()),
            [4.0, -2.0]
        ),
        expected
    );
    let push = |batch: &Value| {
        let torques: Vec<f32> = batch
            .as_slice::<i64>()
            .unwrap()
            .iter()
            .map(|i| *i as f32 - 1.0)
            .collect();
        Value::Array(gym::Array::from(torques).reshape([2, 1]).unwrap())
    };
    let mut discrete = TransformAction::new(envs(), push, Space::discrete(4));
    discrete.reset(0).unwrap();
    assert_eq!(
        discrete.action_space().unwrap().to_string(),
        "MultiDiscrete([4 4])"
    );
    assert_eq!(
        discrete.step(&Value::Array([3i64, 0].into())).unwrap(),
        expected
    );
    assert!(discrete.step(&Value::Array([3i64].into())).is_err());
    assert!(envs().rescale_action((1.0, 1.0)).is_err());
    let discrete = make_vec("CartPole-v1", 2, VectorKind::Sync).unwrap();
    assert!(matches!(
        discrete.clip_action(),
        Err(Error::InvalidArgument { .. })
    ));
}

#[test]
fn wrappers_chain_on_typed_and_on_boxed_vectors() {
    let typed = SyncVectorEnv::new((0..2).map(|_| gym::make("Pendulum-v1").unwrap())).unwrap();
    let boxed: Box<dyn VectorEnv> = Box::new(pendulums(2, Autoreset::NextStep));
    let a = typed
        .record_episode_statistics()
        .normalize_observation()
        .unwrap()
        .clip_reward((-1.0, None))
        .unwrap();
    let b = boxed
        .transform_reward(|reward| reward * 2.0)
        .normalize_reward(0.9)
        .unwrap();
    assert_eq!(
        a.describe(),
        "<ClipReward, <NormalizeObservation, <RecordEpisodeStatistics, SyncVectorEnv(Pendulum-v1, num_envs=2)>>>"
    );
    assert_eq!(a.single_observation_space().dtype(), Some(DType::F32));
    assert!(
        b.describe()
            .starts_with("<NormalizeReward, <TransformReward, ")
    );
    for error in [
        pendulums(1, Autoreset::NextStep)
            .clip_reward((1.0, 0.0))
            .err(),
        pendulums(1, Autoreset::NextStep)
            .normalize_reward(f64::NAN)
            .err(),
    ] {
        assert!(matches!(error, Some(Error::InvalidArgument { .. })));
    }
    assert!({
        let config = normalize_observation::Config {
            epsilon: 0.0,
            ..Default::default()
        };
        NormalizeObservation::new(pendulums(1, Autoreset::NextStep), config).is_err()
    });
}

#[test]
fn statistics_of_a_vector_are_named_by_their_key() {
    let vector = builder("CartPole-v1")
        .max_episode_steps(3)
        .vector(2)
        .kind(VectorKind::Sync)
        .build()
        .unwrap();
    let mut envs = RecordEpisodeStatistics::with_config(
        vector,
        record_episode_statistics::Config {
            stats_key: "stats".into(),
            ..Default::default()
        },
    )
    .unwrap();
    let mut actions = envs.action_sampler(0).unwrap();
    let mut columns = envs.reset(0).unwrap();
    for _ in 0..3 {
        envs.step_into(&actions.sample(), &mut columns).unwrap();
    }
    let infos = envs.infos(&columns);
    assert_eq!(
        infos["stats"].get("l"),
        Some(&Value::Array([3i64, 3].into()))
    );
    assert!(infos.contains_key("_stats") && !infos.contains_key("episode"));
}

#[test]
fn the_estimate_can_be_held() {
    let mut envs = pendulums(2, Autoreset::Disabled)
        .normalize_observation()
        .unwrap();
    let masked = || VectorReset::seeds([9u64, 9]).mask([true, false]);
    envs.reset(0).unwrap();
    envs.update_running_mean(false);
    let held = envs.reset(masked()).unwrap();
    assert_eq!(envs.reset(masked()).unwrap(), held);
    envs.update_running_mean(true);
    assert_ne!(envs.reset(masked()).unwrap(), held);
}

#[test]
fn the_estimate_of_rewards_can_be_held() {
    let mut envs = pendulums(2, Autoreset::Disabled)
        .normalize_reward(0.9)
        .unwrap();
    let actions = envs.action_sampler(0).unwrap().sample();
    envs.reset(0).unwrap();
    envs.step(&actions).unwrap();
    let known = envs.statistics().clone();
    envs.update_running_mean(false);
    envs.step(&actions).unwrap();
    assert_eq!(*envs.statistics(), known);
    envs.update_running_mean(true);
    envs.step(&actions).unwrap();
    assert_ne!(*envs.statistics(), known);
}

#[test]
fn bounds_are_for_one_sub_environment() {
    let bound: Bound = [-1.0f32, -1.0].into();
    let mut envs = make_vec("MountainCar-v0", 3, VectorKind::Sync)
        .unwrap()
        .rescale_observation((bound, [1.0f32, 1.0]))
        .unwrap();
    let columns = envs.reset(0).unwrap();
    assert_eq!(
        envs.observation_space().unwrap().to_string(),
        "Box(-1.0, 1.0, (3, 2), float32)"
    );
    envs.observation_space()
        .unwrap()
        .check(&columns.observations)
        .unwrap();
}

/// A step that ends an episode, by truncation too, and begins the next one restarts the discounted
/// return.
#[test]
fn a_truncated_episode_ends_the_discounted_return() {
    let returns = |envs: &NormalizeReward<Box<dyn VectorEnv>>| -> Vec<f64> {
        let (_, (_, _, returns)): (serde_json::Value, (serde_json::Value, bool, gym::Array)) =
            envs.snapshot().unwrap().get().unwrap();
        returns.iter_f64().collect()
    };
    let mut envs = NormalizeReward::new(pendulums(2, Autoreset::SameStep), 0.9).unwrap();
    let actions = envs.action_sampler(0).unwrap().sample();
    let mut columns = envs.reset(0).unwrap();
    for step in 1..=10 {
        envs.step_into(&actions, &mut columns).unwrap();
        let ends = step % 5 == 0;
        assert_eq!(&columns.truncated[..], &[ends; 2], "step {step}");
        assert!(
            returns(&envs).iter().all(|sum| (*sum == 0.0) == ends),
            "step {step}: {:?}",
            returns(&envs)
        );
    }
}
