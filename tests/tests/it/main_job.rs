//! The notebook's task for an environment of each module: make, reset, step until the episode ends,
//! render.

use gym::render::{RenderMode, Rendered};
use gym::{Env, EnvExt};

use super::sample::one_per_module;

#[test]
fn environments_are_played_and_seen() {
    for registration in one_per_module() {
        let id = registration.id();
        let mut env = gym::builder(id)
            .render_mode(RenderMode::RgbArrayList)
            .max_episode_steps(25)
            .build()
            .unwrap();
        let metadata = env.metadata();
        let space = env.observation_space();
        let mut actions = env.action_sampler(1).unwrap();
        assert!(space.contains(&env.reset(1).unwrap()), "{id}");
        let mut steps = 0;
        loop {
            let step = env.step(&actions.sample()).unwrap();
            assert!(space.contains(&step.observation), "{id}");
            steps += 1;
            if step.done() {
                break;
            }
        }
        let Rendered::Frames(frames) = env.render().unwrap() else {
            panic!("{id} renders no frames")
        };
        assert_eq!(frames.len(), steps + 1, "{id}");
        assert_eq!(
            env.render().unwrap(),
            Rendered::Frames(vec![]),
            "{id} hands over twice"
        );
        for frame in frames {
            assert_eq!(
                (frame.width(), frame.height()),
                metadata.render_size,
                "{id}"
            );
            let first = &frame.pixels()[..3];
            assert!(
                frame.pixels().chunks(3).any(|pixel| pixel != first),
                "{id} draws nothing"
            );
        }
    }
}

#[test]
fn texts_are_gathered() {
    for id in ["FrozenLake-v1", "CliffWalking-v1", "Taxi-v4"] {
        let mut env = gym::builder(id)
            .render_mode(RenderMode::AnsiList)
            .build()
            .unwrap();
        let mut actions = env.action_sampler(0).unwrap();
        env.reset(0).unwrap();
        env.step(&actions.sample()).unwrap();
        let Rendered::Texts(texts) = env.render().unwrap() else {
            panic!("{id} renders no texts")
        };
        assert_eq!(texts.len(), 2, "{id}");
        assert_eq!(
            env.render().unwrap(),
            Rendered::Texts(Vec::new()),
            "{id}: an empty list of texts"
        );
        assert!(texts[0] != texts[1] || id == "CliffWalking-v1", "{id}");
    }
}

#[test]
fn drawing_changes_nothing() {
    for registration in one_per_module() {
        let mut env = gym::builder(registration.id())
            .render_mode(RenderMode::RgbArray)
            .build()
            .unwrap();
        env.reset(0).unwrap();
        let before = env.snapshot().unwrap();
        // some state changes with each frame
        assert_eq!(
            env.clone().render().unwrap(),
            env.clone().render().unwrap(),
            "{}",
            registration.id()
        );
        assert_eq!(env.snapshot().unwrap(), before, "{}", registration.id());
        let mut seen = env.clone();
        seen.render().unwrap();
        seen.render().unwrap();
        let action = env.action_sampler(0).unwrap().sample();
        assert_eq!(
            seen.step(&action).unwrap(),
            env.step(&action).unwrap(),
            "{}",
            registration.id()
        );
    }
}

#[test]
fn seeds_decide_whatever_the_thread() {
    let play = |id: &str| {
        let mut env = gym::make(id).unwrap();
        let mut actions = env.action_sampler(5).unwrap();
        env.reset(5).unwrap();
        (0..20)
            .map(|_| env.step(&actions.sample()).unwrap())
            .collect::<Vec<_>>()
    };
    for id in ["CartPole-v1", "Taxi-v4", "Acrobot-v1"] {
        let here = play(id);
        let there = std::thread::spawn(move || play(id)).join().unwrap();
        assert_eq!(here, there);
    }
}
