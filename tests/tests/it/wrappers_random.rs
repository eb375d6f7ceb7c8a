//! Random stacks of wrappers are rebuilt from JSON, or refused.

use gym::render::RenderMode;
use gym::{BoxEnv, Env, EnvExt, EnvSpec, Result, Value};
use proptest::prelude::*;
use serde_json::{Value as Json, json};

use crate::wrappers_rebuild::{steps, wrap};

/// Random choices: the arguments of `make`, and the wrappers to add by hand.
type Choices = ((u8, bool, bool, Option<u32>, u8), Vec<(u8, u8)>);

/// Returns an environment of the registry, with small frames if it renders.
fn base((id, order, check, limit, mode): (u8, bool, bool, Option<u32>, u8)) -> BoxEnv {
    if id % 6 == 5 {
        return gym::builder("FrozenLake-v1")
            .arg("map_name", Json::Null)
            .max_episode_steps(limit)
            .build()
            .unwrap();
    }
    let ids = [
        "CartPole-v1",
        "Pendulum-v1",
        "Blackjack-v1",
        "Taxi-v4",
        "MountainCarContinuous-v0",
    ];
    let mut builder = gym::builder(ids[usize::from(id) % ids.len()])
        .order_enforce(order)
        .disable_env_checker(!check);
    if let Some(limit) = limit {
        builder = builder.max_episode_steps(limit);
    }
    let mode = [
        None,
        Some(RenderMode::RgbArray),
        Some(RenderMode::RgbArrayList),
    ][usize::from(mode) % 3];
    match mode {
        Some(mode) => builder
            .render_mode(mode)
            .render_size(12, 8)
            .build()
            .unwrap(),
        None => builder.build().unwrap(),
    }
}

/// Adds a wrapper. Returns an error if the wrapper does not support the environment. Also returns
/// whether the wrapper has a stored form.
fn around(env: BoxEnv, (kind, x): (u8, u8)) -> Result<(BoxEnv, bool)> {
    use gym::wrappers::*;
    let n = u32::from(x % 4) + 1;
    let env = match kind % 27 {
        0 => BoxEnv::new(TimeLimit::new(env, 3 * n)?),
        1 => BoxEnv::new(Autoreset::new(env)),
        2 => BoxEnv::new(OrderEnforcing::new(env)),
        3 => BoxEnv::new(PassiveEnvChecker::new(env)),
        4 => BoxEnv::new(RecordEpisodeStatistics::with_config(
            env,
            record_episode_statistics::Config {
                buffer_length: n as usize,
                ..Default::default()
            },
        )?),
        5 => BoxEnv::new(FlattenObservation::new(
            env,
            flatten_observation::Config::default(),
        )?),
        6 => BoxEnv::new(DtypeObservation::new(
            env,
            [gym::DType::F64, gym::DType::I32][usize::from(x % 2)],
        )?),
        7 => BoxEnv::new(DelayObservation::new(env, n as usize)?),
        8 => BoxEnv::new(TimeAwareObservation::new(
            env,
            time_aware_observation::Config::default(),
        )?),
        9 => BoxEnv::new(TimeAwareObservation::new(
            env,
            time_aware_observation::Config {
                max_timesteps: Some(7 * n),
                normalize_time: x % 2 == 0,
                ..Default::default()
            },
        )?),
        10 => BoxEnv::new(FrameStackObservation::new(
            env,
            frame_stack_observation::Config {
                stack_size: n as usize,
                padding_type: "zero".into(),
            },
        )?),
        11 => {
            let (epsilon, update_running_mean) = (0.1 * f64::from(n), x % 2 == 0);
            BoxEnv::new(NormalizeObservation::new(
                env,
                normalize_observation::Config {
                    epsilon,
                    update_running_mean,
                },
            )?)
        }
        12 => {
            let mut env = NormalizeReward::new(env, 0.9)?;
            env.update_running_mean(x % 2 == 0);
            BoxEnv::new(env)
        }
        13 => BoxEnv::new(MaxAndSkipObservation::new(env, n + 1)?),
        14 => BoxEnv::new(ClipAction::new(env, clip_action::Config::default())?),
        15 => BoxEnv::new(RescaleAction::new(env, (-f64::from(n), 2.0))?),
        16 => BoxEnv::new(DiscretizeAction::new(
            env,
            (u32::from(x % 5) + 1, x % 2 == 0),
        )?),
        17 => BoxEnv::new(StickyAction::new(env, (0.5, 1..=n))?),
        18 => BoxEnv::new(RepeatAction::new(env, n)?),
        19 => BoxEnv::new(ClipReward::new(
            env,
            ((x % 2 == 0).then_some(-0.5), 0.25 * f64::from(n)),
        )?),
        20 => BoxEnv::new(AddWhiteNoise::new(env, (0.3, x % 2 == 0))?),
        21 => BoxEnv::new(ObstructView::new(env, (0.3, n, x % 2 == 0))?),
        22 => BoxEnv::new(AddRenderObservation::new(
            env,
            add_render_observation::Config::default(),
        )?),
        23 => BoxEnv::new(AddRenderObservation::new(
            env,
            add_render_observation::Config {
                render_only: false,
                render_key: "picture".into(),
                ..Default::default()
            },
        )?),
        24 => return Ok((BoxEnv::new(RenderCollection::new(env)), false)),
        25 => {
            return Ok((
                BoxEnv::new(Render::new(env, RenderMode::RgbArray)?.with_size(10, 6)?),
                false,
            ));
        }
        _ => {
            return Ok((
                BoxEnv::new(env.transform_reward(|reward| 2.0 * reward)),
                false,
            ));
        }
    };
    Ok((env, true))
}

/// Returns everything that an environment returns, including errors.
fn answers(env: &mut BoxEnv) -> Vec<String> {
    let mut answers = Vec::new();
    let mut actions = env.action_sampler(3).unwrap();
    let early = env.step(&actions.sample()).map(|step| step.observation);
    answers.push(early.is_err().to_string());
    for seed in [1, 2] {
        answers.push(format!("{:?}", env.reset(seed)));
        for i in 0..12 {
            answers.push(format!("{:?}", env.step(&actions.sample())));
            if i % 4 == 0 {
                answers.push(format!("{:?}", env.render()));
            }
            let mut info = env.info_map();
            // the seconds of episode statistics
            info.remove("episode");
            answers.push(format!("{info:?}"));
        }
    }
    answers
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..ProptestConfig::default() })]

    /// A stack that is rebuilt from its spec gives the same results, in any order of wrappers. A
    /// stack without a spec contains a wrapper without a stored form.
    #[test]
    fn specs_tell_the_truth((of_make, wrappers) in any::<Choices>()) {
        let of_make = (of_make.0, of_make.1, of_make.2, of_make.3.map(|limit| limit % 20 + 1), of_make.4);
        let (mut env, mut is_stored) = (base(of_make), true);
        for wrapper in wrappers.into_iter().take(5) {
            if let Ok((wrapped, stored)) = around(env.clone(), wrapper) {
                (env, is_stored) = (wrapped, is_stored && stored);
            }
        }
        let spec = env.spec();
        prop_assert!(spec.is_some() || !is_stored, "{env} has no spec");
        if let Some(spec) = spec {
            let json = serde_json::to_string(&spec).unwrap();
            let mut rebuilt = serde_json::from_str::<EnvSpec>(&json).unwrap().make().unwrap();
            prop_assert_eq!(rebuilt.spec(), Some(spec), "{}", json);
            prop_assert_eq!(rebuilt.observation_space(), env.observation_space(), "{}", json);
            prop_assert_eq!(rebuilt.action_space(), env.action_space(), "{}", json);
            prop_assert_eq!(rebuilt.render_mode(), env.render_mode(), "{}", json);
            prop_assert_eq!(answers(&mut rebuilt), answers(&mut env), "{} of {}", json, env);
        }
    }
}

/// Bounds of another dtype than the box's are converted to the box's dtype, before and after
/// storing.
#[test]
fn bounds_of_any_type_are_rebuilt_to_the_last_bit() {
    use gym::Array;
    use gym::wrappers::{Bound, RescaleAction, RescaleObservation};

    let bounds: [[Bound; 2]; 4] = [
        [(-0.1).into(), 0.3.into()],
        [[-0.1f64].into(), [0.3f64].into()],
        [[-0.1f32].into(), [0.3f32].into()],
        [Array::from([-1i64]).into(), Array::from([7u8]).into()],
    ];
    let thrice = |bound: &Bound| match bound {
        Bound::Scalar(x) => Bound::Scalar(*x),
        Bound::Array(array) => {
            let x = array.iter_f64().next().expect("a number");
            [x; 3].into()
        }
    };
    for [min, max] in bounds {
        let pendulum = || gym::make("Pendulum-v1").unwrap();
        let action =
            BoxEnv::new(RescaleAction::new(pendulum(), (min.clone(), max.clone())).unwrap());
        let observation =
            RescaleObservation::new(pendulum(), (thrice(&min), thrice(&max))).unwrap();
        for mut env in [action, BoxEnv::new(observation)] {
            let spec = env.spec().unwrap();
            let text = serde_json::to_string(&spec).unwrap();
            let mut rebuilt = serde_json::from_str::<EnvSpec>(&text)
                .unwrap()
                .make()
                .unwrap();
            assert_eq!(rebuilt.spec().unwrap(), spec, "{text}");
            assert_eq!(rebuilt.action_space(), env.action_space(), "{text}");
            assert_eq!(
                rebuilt.observation_space(),
                env.observation_space(),
                "{text}"
            );
            assert_eq!(rebuilt.reset(3).unwrap(), env.reset(3).unwrap(), "{text}");
            assert_eq!(steps(&mut rebuilt, 50), steps(&mut env, 50), "{text}");
        }
    }
}

/// Restoring inconsistent repeats is an error and has no effect.
#[test]
fn repeats_that_cannot_be_are_refused() {
    let wrappers =
        json!([["StickyAction", {"repeat_action_probability": 0.5, "repeat_action_duration": 3}]]);
    let mut env = wrap("Taxi-v4", &wrappers);
    env.reset(1).unwrap();
    for _ in 0..4 {
        env.step(&Value::Int(0)).unwrap();
    }
    let before = env.snapshot().unwrap();
    let text = serde_json::to_string(&before).unwrap();
    for (field, old) in [
        ("is_stuck", ["true", "false"]),
        ("is_stuck", ["false", "true"]),
    ] {
        let [old, new] = old.map(|value| format!("\"{field}\":{value}"));
        if text.contains(&old) {
            let damaged = serde_json::from_str(&text.replace(&old, &new)).unwrap();
            let error = env.restore(&damaged).unwrap_err().to_string();
            assert!(error.contains("do not add up"), "{error}");
        }
    }
    assert!(text.contains("is_stuck"));
    assert_eq!(env.snapshot().unwrap(), before);
}
