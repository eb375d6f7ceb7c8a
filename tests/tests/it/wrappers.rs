//! The common wrappers, with concrete types and with `BoxEnv`.

use gym::classic::cartpole::{Action, Config};
use gym::classic::{CartPole, Pendulum};
use gym::wrappers::{
    OrderEnforcing, PassiveEnvChecker, RecordEpisodeStatistics, RenderCollection, TimeLimit,
    record_episode_statistics,
};
use gym::{BoxEnv, Env, EnvExt, EnvSpec, Error, Outcome, Reset, Result, Snapshot, Space, Value};

fn pendulum() -> Pendulum {
    Pendulum::new(gym::classic::pendulum::Config::default()).unwrap()
}

fn cartpole() -> CartPole {
    CartPole::new(Config::default()).unwrap()
}

/// Plays to the end of an episode; returns its length and the flags of the last step.
fn play<E: Env>(env: &mut E) -> (u32, bool, bool) {
    let mut actions = env.action_sampler(0).unwrap();
    env.reset(0).unwrap();
    for length in 1.. {
        let step = env.step(&actions.sample()).unwrap();
        if step.done() {
            return (length, step.terminated, step.truncated);
        }
    }
    unreachable!()
}

#[test]
fn time_limit_truncates_typed_and_erased() {
    assert_eq!(
        play(&mut TimeLimit::new(pendulum(), 7).unwrap()),
        (7, false, true)
    );
    assert_eq!(
        play(&mut TimeLimit::new(BoxEnv::new(pendulum()), 7).unwrap()),
        (7, false, true)
    );
}

#[test]
fn a_step_can_terminate_and_truncate() {
    let (length, terminated, truncated) = play(&mut cartpole_with_limit(u32::MAX));
    assert!(terminated && !truncated);
    assert_eq!(play(&mut cartpole_with_limit(length)), (length, true, true));
}

fn cartpole_with_limit(limit: u32) -> TimeLimit<CartPole> {
    TimeLimit::new(cartpole(), limit).unwrap()
}

#[test]
fn time_limit_of_zero_is_refused() {
    let error = TimeLimit::new(pendulum(), 0).unwrap_err();
    assert!(error.to_string().contains("at least 1"), "{error}");
}

#[test]
fn order_is_enforced() {
    let mut env = OrderEnforcing::new(cartpole());
    assert!(matches!(
        env.step(&Action::Left),
        Err(Error::ResetNeeded("step"))
    ));
    assert!(matches!(env.render(), Err(Error::ResetNeeded("render"))));
    env.reset(0).unwrap();
    env.step(&Action::Left).unwrap();
    env.close();
    assert!(matches!(
        env.step(&Action::Left),
        Err(Error::Closed("step"))
    ));
    assert!(matches!(env.reset(0), Err(Error::Closed("reset"))));
}

fn config(buffer_length: usize, stats_key: &str) -> record_episode_statistics::Config {
    record_episode_statistics::Config {
        buffer_length,
        stats_key: stats_key.into(),
    }
}

#[test]
fn statistics_of_episodes() {
    let mut env = RecordEpisodeStatistics::new(TimeLimit::new(cartpole(), 500).unwrap());
    let (length, ..) = play(&mut env);
    let episode = env
        .info_map()
        .remove("episode")
        .expect("an entry after the last step");
    assert_eq!(episode.get("r"), Some(&Value::Float(f64::from(length))));
    assert_eq!(episode.get("l"), Some(&Value::Int(length.into())));
    assert!(episode.get("t").and_then(Value::as_float).unwrap() >= 0.0);
    assert_eq!(env.episode_count(), 1);
    env.reset(()).unwrap();
    assert!(
        !env.info_map().contains_key("episode"),
        "the entry belongs to the last step alone"
    );
    assert_eq!(
        env.episodes()
            .map(|episode| episode.length)
            .collect::<Vec<_>>(),
        [u64::from(length)]
    );
}

#[test]
fn statistics_keep_the_last_episodes() {
    let mut env = RecordEpisodeStatistics::with_config(cartpole(), config(3, "episode")).unwrap();
    let mut lengths = Vec::new();
    for _ in 0..5 {
        lengths.push(u64::from(play(&mut env).0));
    }
    assert_eq!(
        env.episodes()
            .map(|episode| episode.length)
            .collect::<Vec<_>>(),
        lengths[2..]
    );
    assert_eq!(env.episode_count(), 5);
    assert!(RecordEpisodeStatistics::with_config(cartpole(), config(0, "episode")).is_err());
}

#[test]
fn statistics_in_one_stack_have_a_key_each() {
    let within = RecordEpisodeStatistics::with_config(cartpole(), config(100, "whole")).unwrap();
    let mut env = RecordEpisodeStatistics::new(TimeLimit::new(within, 2).unwrap());
    play(&mut env);
    let info = env.info_map();
    assert!(
        info.contains_key("episode") && !info.contains_key("whole"),
        "the limit ends the outer one alone"
    );
}

#[test]
fn a_stack_continues_from_a_snapshot() {
    let stack = || RecordEpisodeStatistics::new(OrderEnforcing::new(cartpole_with_limit(500)));
    let mut env = stack();
    env.reset(3).unwrap();
    env.step(&Action::Left).unwrap();
    let json = serde_json::to_string(&env.snapshot().unwrap()).unwrap();
    let mut other = stack();
    other
        .restore(&serde_json::from_str(&json).unwrap())
        .unwrap();
    for _ in 0..5 {
        assert_eq!(
            env.step(&Action::Right).unwrap(),
            other.step(&Action::Right).unwrap()
        );
    }
    assert!(
        pendulum().restore(&env.snapshot().unwrap()).is_err(),
        "a snapshot of something else"
    );
}

/// An environment whose observation is outside of its space.
#[derive(Clone)]
struct Liar;

impl Env for Liar {
    type Observation = i64;
    type Action = i64;

    fn observation_space(&self) -> Space {
        Space::discrete(2)
    }

    fn action_space(&self) -> Space {
        Space::discrete(2)
    }

    fn reset_into(&mut self, _reset: &Reset, observation: &mut i64) -> Result<()> {
        *observation = 0;
        Ok(())
    }

    fn step_into(&mut self, _action: &i64, observation: &mut i64) -> Result<Outcome> {
        *observation = 2;
        Ok(Outcome::default())
    }

    fn snapshot(&self) -> Result<Snapshot> {
        Snapshot::of(&())
    }

    fn restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        snapshot.get::<()>()
    }
}

#[test]
fn the_passive_checker_sees_the_first_step() {
    let mut env = PassiveEnvChecker::new(Liar);
    env.reset(0).unwrap();
    let error = env.step(&0).unwrap_err();
    assert!(matches!(error, Error::Contract(_)), "{error}");
    assert!(error.to_string().contains("Discrete(2)"), "{error}");
}

#[test]
fn options_may_ask_for_states_beyond_the_space() {
    let mut env = gym::make("CartPole-v1").unwrap();
    let observation = env
        .reset(Reset::seed(0).option("low", 20.0).option("high", 30.0))
        .unwrap();
    assert!(!env.observation_space().contains(&observation));
    env.step(&Value::Int(0)).unwrap();
}

#[test]
fn stacks_read_as_gymnasiums() {
    let env = gym::make("CartPole-v1").unwrap();
    assert_eq!(
        env.to_string(),
        "<TimeLimit<OrderEnforcing<PassiveEnvChecker<CartPole<CartPole-v1>>>>>"
    );
    let env = gym::make("Blackjack-v1").unwrap();
    assert_eq!(
        env.to_string(),
        "<OrderEnforcing<PassiveEnvChecker<Blackjack<Blackjack-v1>>>>"
    );
    assert_eq!(
        OrderEnforcing::new(cartpole()).describe(),
        "<OrderEnforcing<CartPole>>"
    );
}

#[test]
fn a_stack_is_rebuilt_from_its_spec() {
    let env = gym::builder("FrozenLake-v1")
        .arg("map_name", "8x8")
        .max_episode_steps(11)
        .render_mode(gym::render::RenderMode::AnsiList)
        .build()
        .unwrap();
    let env = RecordEpisodeStatistics::with_config(env, config(5, "episode")).unwrap();
    let spec = env.spec().unwrap();
    assert_eq!(spec.max_episode_steps, Some(11));
    let json = serde_json::to_string(&spec).unwrap();
    let parsed: EnvSpec = serde_json::from_str(&json).unwrap();
    assert_eq!(parsed, spec);
    let rebuilt = parsed.make().unwrap();
    assert_eq!(rebuilt.spec(), Some(spec));
    assert_eq!(rebuilt.observation_space().to_string(), "Discrete(64)");
}

#[test]
fn frames_are_gathered_and_handed_over_once() {
    use gym::render::{RenderMode, Rendered};
    use gym::wrappers::Render;
    let typed = Render::new(cartpole(), RenderMode::RgbArray)
        .unwrap()
        .with_size(60, 40)
        .unwrap();
    let mut typed = RenderCollection::new(typed);
    let mut erased = gym::builder("CartPole-v1")
        .render_mode(RenderMode::RgbArrayList)
        .render_size(60, 40)
        .build()
        .unwrap();
    let (length, ..) = play(&mut typed);
    play(&mut erased);
    let frames = typed.render().unwrap().into_frames().unwrap();
    assert_eq!(frames.len() as u32, length + 1);
    assert_eq!(erased.render().unwrap().into_frames().unwrap(), frames);
    assert_eq!(typed.render().unwrap(), Rendered::Frames(vec![]));
    assert!(
        frames.windows(2).any(|pair| pair[0] != pair[1]),
        "nothing moves"
    );
}

/// Snapshots contain no wall-clock time: equal episodes give equal bytes.
#[test]
fn snapshots_of_statistics_do_not_tell_the_time() {
    let stored = |pause: u64| {
        let mut env = RecordEpisodeStatistics::new(cartpole());
        for _ in 0..3 {
            env.reset(0).unwrap();
            std::thread::sleep(std::time::Duration::from_millis(pause));
            while !env.step(&Action::Left).unwrap().done() {}
        }
        assert!(env.episodes().all(|episode| episode.length > 5));
        serde_json::to_string(&env.snapshot().unwrap()).unwrap()
    };
    assert_eq!(stored(0), stored(3));
}
