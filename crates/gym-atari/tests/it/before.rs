//! After a reset with a seed, and after a restore, nothing depends on what was before.

use gym_atari::{
    AtariAction, AtariEnv, AtariPreprocessing, Config, Frameskip, ObsType, Preprocessing,
};
use gym_core::{Array, Env, EnvExt, Snapshot};

use crate::environment::{homebrew, stutter};

/// The bits of an episode: observations, rewards, infos, and the state at the end.
fn shown<E>(env: &mut E, first: Option<Array>) -> (Vec<Array>, String)
where
    E: Env<Observation = Array, Action = AtariAction>,
{
    let mut observations: Vec<Array> = first.into_iter().collect();
    let mut infos = String::new();
    for step in 0..24usize {
        let step = env.step(&(step * 7 % 18).into()).unwrap();
        infos += &format!("{} {} {:?}\n", step.reward, step.done(), env.info_map());
        observations.push(step.observation);
    }
    let state = serde_json::to_string(&env.snapshot().unwrap()).unwrap();
    (observations, infos + &state)
}

/// `spoil` changes the game of an environment.
fn forgets<E>(make: impl Fn() -> E, spoil: impl Fn(&mut E))
where
    E: Env<Observation = Array, Action = AtariAction>,
{
    let used = || {
        let mut env = make();
        env.reset(8).unwrap();
        shown(&mut env, None);
        spoil(&mut env);
        env
    };
    let mut fresh = make();
    let first = fresh.reset(5).unwrap();
    let snapshot: Snapshot = fresh.snapshot().unwrap();
    let expected = shown(&mut fresh, Some(first));
    let mut reset = used();
    let first = reset.reset(5).unwrap();
    assert!(shown(&mut reset, Some(first)) == expected, "after a reset");
    let mut restored = used();
    restored.restore(&snapshot).unwrap();
    let (observations, rest) = shown(&mut restored, None);
    assert!(observations == expected.0[1..], "after a restore");
    assert!(rest == expected.1, "after a restore");
}

fn spoil(env: &mut AtariEnv) {
    let ale = env.ale_mut();
    for value in 0..9 {
        ale.ram_mut().fill(0x55 ^ value);
        ale.act(gym_atari::Action::Fire);
    }
    ale.ram_mut().fill(0xee);
}

#[test]
fn no_byte_passes_from_one_episode_to_the_next() {
    for short in [0, 3, 7] {
        let rom = if short == 0 {
            homebrew()
        } else {
            stutter(short)
        };
        for obs_type in [ObsType::Rgb, ObsType::Grayscale, ObsType::Ram] {
            for frameskip in [
                Frameskip::Range([1, 4]),
                Frameskip::Fixed(1),
                Frameskip::Fixed(4),
            ] {
                let config = Config {
                    obs_type,
                    frameskip,
                    repeat_action_probability: 0.25,
                    ..Config::default()
                };
                forgets(|| AtariEnv::with_rom(config.clone(), &rom).unwrap(), spoil);
            }
        }
        let config = Config {
            obs_type: ObsType::Grayscale,
            frameskip: Frameskip::Fixed(1),
            ..Config::default()
        };
        for screen_size in [[84, 84], [210, 160]] {
            let settings = Preprocessing {
                screen_size,
                ..Preprocessing::default()
            };
            let make = || {
                let env = AtariEnv::with_rom(config.clone(), &rom).unwrap();
                AtariPreprocessing::new(env, settings).unwrap()
            };
            forgets(make, |env| {
                if let Some(inner) = env.layer_mut::<AtariEnv>() {
                    spoil(inner);
                }
            });
        }
    }
}
