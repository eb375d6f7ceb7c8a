//! Tests of the state that an episode takes over from the previous episode, and of steps, with
//! programs of our own.

use gym_atari::ale::Settings;
use gym_atari::{
    Action, Ale, AtariAction, AtariEnv, AtariPreprocessing, Config, Frameskip, ObsType,
    Preprocessing, Rom, games,
};
use gym_core::{Env, EnvExt, Snapshot};
use serde_json::Value as Json;

use crate::rom::rom;

/// Returns a program that clears RAM except the lives of Breakout. In each frame, the program
/// increments `$80`, stores the stick at `$81` and the switches at `$82`, and changes the colour.
fn looks(game: &str) -> Rom {
    let lives = if game == "breakout" { 5 } else { 0 };
    let code = rom(&[
        0x78, 0xd8, 0xa2, 0xff, 0x9a, 0xa9, 0x00, 0xa2, 0x7f, 0x95, 0x80, 0xca, 0x10,
        0xfb, // clears RAM
        0xa9, lives, 0x85, 0xb9, // lda #lives; sta $b9
        0xa9, 0x02, 0x85, 0x00, 0x85, 0x02, 0x85, 0x02, 0xa9, 0x00, 0x85, 0x00, // VSYNC
        0xe6, 0x80, 0xa5, 0x80, 0x0a, 0x85, 0x09, // inc $80; lda $80; asl; sta COLUBK
        0xad, 0x80, 0x02, 0x85, 0x81, 0xad, 0x82, 0x02, 0x85, 0x82, // SWCHA and SWCHB
        0xa2, 0xff, 0x85, 0x02, 0xca, 0xd0, 0xfb, // 255 lines
        0x4c, 0x12, 0xf0,
    ]);
    Rom::homebrew(games::by_name(game).unwrap(), &code)
}

fn env(game: &str, config: Config) -> AtariEnv {
    AtariEnv::with_rom(config, &looks(game)).unwrap()
}

fn one_by_one() -> Config {
    Config {
        frameskip: Frameskip::Fixed(1),
        repeat_action_probability: 0.0,
        ..Config::default()
    }
}

fn state(ale: &Ale) -> Json {
    serde_json::to_value(ale.state()).unwrap()
}

/// Games with a stick, paddles on either side, lives, a delayed end, a mode and a menu.
const GAMES: [&str; 7] = [
    "seaquest",
    "breakout",
    "pong",
    "kaboom",
    "othello",
    "tennis",
    "space_invaders",
];

#[test]
fn an_episode_with_a_seed_depends_on_nothing_before() {
    for game in GAMES {
        let config = Config {
            repeat_action_probability: 0.25,
            ..one_by_one()
        };
        let mut new = env(game, config.clone());
        let first = new.reset(3).unwrap();
        for steps in [1, 40] {
            let mut used = env(game, config.clone());
            used.reset(1).unwrap();
            let n = used.actions().len();
            for step in 0..steps {
                used.step(&(step % n).into()).unwrap();
            }
            used.reset(()).unwrap();
            used.step(&(n - 1).into()).unwrap();
            assert_eq!(used.reset(3).unwrap(), first, "{game}");
            assert_eq!(
                used.snapshot().unwrap(),
                new.snapshot().unwrap(),
                "{game}, after {steps} steps"
            );
        }
    }
}

/// Without a seed, the generator and the count of frames continue; earlier actions have no effect.
#[test]
fn an_episode_without_a_seed_does_not_depend_on_actions_before() {
    for game in GAMES {
        for continuous in [false, true] {
            let play = |stick: [f32; 3]| {
                let mut env = env(
                    game,
                    Config {
                        continuous,
                        ..one_by_one()
                    },
                );
                env.reset(1).unwrap();
                for _ in 0..9 {
                    let index = if stick[0] > 0.0 {
                        env.actions().len() - 1
                    } else {
                        0
                    };
                    let action = if continuous {
                        AtariAction::Stick(stick)
                    } else {
                        AtariAction::Index(index)
                    };
                    env.step(&action).unwrap();
                }
                env.reset(()).unwrap();
                env.snapshot().unwrap()
            };
            assert_eq!(
                play([1.0, 0.0, 1.0]),
                play([0.0, 0.0, 0.0]),
                "{game}, {continuous}"
            );
        }
    }
}

#[test]
fn the_limit_of_frames_is_that_of_each_episode() {
    let config = Config {
        max_num_frames_per_episode: Some(12),
        frameskip: Frameskip::Fixed(4),
        ..one_by_one()
    };
    let mut env = env("seaquest", config);
    env.reset(0).unwrap();
    for episode in 0..3 {
        let truncated: Vec<bool> = (0..3)
            .map(|_| env.step(&0.into()).unwrap().truncated)
            .collect();
        assert_eq!(truncated, [false, false, true], "episode {episode}");
        env.reset(()).unwrap();
    }
}

/// As in ale-py, `info` has the seeds after a reset with a seed, until the next step or reset.
#[test]
fn seeds_are_told_once() {
    let mut env = env("seaquest", one_by_one());
    let told = |env: &AtariEnv| env.info_map().contains_key("seeds");
    env.reset(7).unwrap();
    assert!(told(&env));
    env.step(&0.into()).unwrap();
    assert!(!told(&env));
    env.reset(7).unwrap();
    env.reset(()).unwrap();
    assert!(!told(&env));
}

#[test]
fn a_step_takes_each_number_of_frames_of_its_range() {
    for range in [[1, 2], [2, 5], [3, 4]] {
        let mut env = env(
            "seaquest",
            Config {
                frameskip: Frameskip::Range(range),
                ..one_by_one()
            },
        );
        env.reset(1).unwrap();
        let mut seen = std::collections::BTreeSet::new();
        for _ in 0..60 {
            let before = env.ale().frame_number();
            env.step(&0.into()).unwrap();
            seen.insert(i64::from(env.ale().frame_number() - before));
        }
        assert_eq!(
            seen.into_iter().collect::<Vec<_>>(),
            (range[0]..range[1]).collect::<Vec<_>>()
        );
    }
}

/// A coordinate or the button counts above the threshold. With a paddle, the radius is its speed.
#[test]
fn sticks_count_beyond_their_threshold() {
    for threshold in [0.25, 0.75] {
        let config = Config {
            continuous: true,
            continuous_action_threshold: threshold,
            ..one_by_one()
        };
        let edge = threshold as f32;
        let pushed = |stick| {
            let mut env = env("seaquest", config.clone());
            env.reset(0).unwrap();
            env.step(&AtariAction::Stick(stick)).unwrap();
            state(env.ale())["progress"]["previous"]["action"].clone()
        };
        assert_eq!(pushed([edge, 0.0, edge]), pushed([0.0; 3]));
        assert_ne!(pushed([edge + 0.01, 0.0, 0.0]), pushed([0.0; 3]));
        assert_ne!(pushed([0.0, 0.0, edge + 0.01]), pushed([0.0; 3]));
    }
    let turned = |radius: f32| {
        let mut env = env(
            "breakout",
            Config {
                continuous: true,
                continuous_action_threshold: 0.1,
                ..one_by_one()
            },
        );
        env.reset(0).unwrap();
        env.step(&AtariAction::Stick([radius, 0.0, 0.0])).unwrap();
        state(env.ale())["progress"]["paddle"].as_i64().unwrap()
    };
    let (none, half, whole) = (turned(0.0), turned(0.5), turned(1.0));
    assert_eq!((none - half, none - whole), (11_500, 23_000));
}

/// A stick at an angle, with and without the button, is the action whose name says so.
#[test]
fn a_stick_has_nine_places() {
    let names = [
        "Right",
        "UpRight",
        "Up",
        "UpLeft",
        "Left",
        "DownLeft",
        "Down",
        "DownRight",
    ];
    let mut env = env(
        "seaquest",
        Config {
            continuous: true,
            ..one_by_one()
        },
    );
    env.reset(0).unwrap();
    let mut pushed = |radius: f32, eighths: f32, fire: f32| {
        let angle = std::f32::consts::FRAC_PI_4 * eighths;
        env.step(&AtariAction::Stick([radius, angle, fire]))
            .unwrap();
        let action = state(env.ale())["progress"]["previous"]["action"].clone();
        action.as_str().unwrap().to_owned()
    };
    for (k, name) in names.into_iter().enumerate() {
        let eighths = if k > 4 { k as f32 - 8.0 } else { k as f32 };
        assert_eq!(pushed(1.0, eighths, 0.0), name);
        assert_eq!(pushed(1.0, eighths, 1.0), format!("{name}Fire"));
        assert_eq!(pushed(0.4, eighths, 0.0), "Noop");
        assert_eq!(pushed(0.4, eighths, 1.0), "Fire");
    }
}

/// A paddle stops at the ends of the range that its game has.
#[test]
fn a_paddle_stops_at_the_end_of_its_game() {
    let mut moved = 0;
    for game in ["blackjack", "casino", "breakout", "pong", "kaboom"] {
        let game = games::by_name(game).unwrap();
        // fill RAM with a number with which no game is over
        let program = rom(&[
            0xa9, 0x10, 0xa2, 0x7f, 0x95, 0x80, 0xca, 0x10, 0xfb, // fills RAM
            0xa9, 0x02, 0x85, 0x00, 0x85, 0x02, 0x85, 0x02, 0xa9, 0x00, 0x85, 0x00, 0x4c, 0x09,
            0xf0, // VSYNC
        ]);
        let mut ale = Ale::new(game, &program, 0);
        let start = state(&ale)["progress"]["paddle"].clone();
        for _ in 0..60 {
            ale.act(Action::Left);
        }
        let end = state(&ale)["progress"]["paddle"].clone();
        assert!(
            end == start || end.as_u64() == Some(u64::from(game.paddle_end)),
            "{}: {end}",
            game.name
        );
        moved += u32::from(end != start);
    }
    assert!(moved >= 3, "{moved}");
}

/// Bit 6 of `SWCHB` is the left difficulty switch, bit 7 the right one.
#[test]
fn a_difficulty_sets_the_switches() {
    for game in ["seaquest", "breakout", "space_invaders", "pong"] {
        for &difficulty in games::by_name(game).unwrap().difficulties {
            let mut env = env(
                game,
                Config {
                    difficulty: Some(difficulty),
                    ..one_by_one()
                },
            );
            env.reset(0).unwrap();
            env.step(&0.into()).unwrap();
            assert_eq!(env.ale().ram().0[2] >> 6, difficulty, "{game}");
        }
    }
}

/// A step of two frames has the lives, rewards and end of two single frames, whichever frames are
/// drawn.
#[test]
fn lives_end_a_preprocessed_step_where_they_are_lost() {
    let settings = Preprocessing {
        terminal_on_life_loss: true,
        noop_max: 0,
        ..Preprocessing::default()
    };
    let mut small = AtariPreprocessing::new(env("seaquest", one_by_one()), settings).unwrap();
    small.reset(1).unwrap();
    let lives = |small: &mut AtariPreprocessing, lives: u8| {
        gym_core::Wrapper::inner_mut(small).ale_mut().ram_mut()[0x3b] = lives - 1;
    };
    let step = |small: &mut AtariPreprocessing| small.step(&0.into()).unwrap().terminated;
    assert!(!step(&mut small));
    lives(&mut small, 4);
    assert!(!step(&mut small), "a life gained");
    let snapshot = small.snapshot().unwrap();
    lives(&mut small, 3);
    assert!(step(&mut small), "a life lost");
    assert!(!step(&mut small), "once");
    // the number of lives is part of the state
    small.restore(&snapshot).unwrap();
    lives(&mut small, 3);
    assert!(step(&mut small));
    let mut other = AtariPreprocessing::new(env("seaquest", one_by_one()), settings).unwrap();
    other.restore(&snapshot).unwrap();
    lives(&mut other, 3);
    assert!(step(&mut other));
}

#[test]
fn a_preprocessed_episode_depends_on_nothing_before() {
    for frame_skip in [1, 2, 4] {
        let settings = Preprocessing {
            frame_skip,
            noop_max: 5,
            ..Preprocessing::default()
        };
        let make = || AtariPreprocessing::new(env("seaquest", one_by_one()), settings).unwrap();
        let (mut new, mut used) = (make(), make());
        used.reset(1).unwrap();
        for step in 0..5usize {
            used.step(&step.into()).unwrap();
        }
        assert_eq!(used.reset(4).unwrap(), new.reset(4).unwrap());
        assert_eq!(
            used.snapshot().unwrap(),
            new.snapshot().unwrap(),
            "{frame_skip}"
        );
        for step in 0..8usize {
            assert_eq!(
                used.step(&step.into()).unwrap(),
                new.step(&step.into()).unwrap()
            );
        }
    }
}

/// Every number of no-ops up to the largest occurs. If the game ends during the no-ops, the episode
/// restarts with the seed.
#[test]
fn an_episode_starts_after_some_no_ops() {
    let settings = |noop_max| Preprocessing {
        noop_max,
        ..Preprocessing::default()
    };
    for noop_max in [0, 1, 3] {
        let mut small =
            AtariPreprocessing::new(env("seaquest", one_by_one()), settings(noop_max)).unwrap();
        let mut seen = std::collections::BTreeSet::new();
        for seed in 0..30 {
            small.reset(seed).unwrap();
            seen.insert(small.get_ref().ale().episode_frame_number());
        }
        let expected: Vec<u32> = if noop_max == 0 {
            vec![0]
        } else {
            (1..=noop_max).collect()
        };
        assert_eq!(seen.into_iter().collect::<Vec<_>>(), expected);
    }
    // the third frame of an episode is its last
    let over = Config {
        max_num_frames_per_episode: Some(3),
        ..one_by_one()
    };
    let mut small = AtariPreprocessing::new(env("seaquest", over), settings(30)).unwrap();
    small.reset(9).unwrap();
    let again = small.snapshot().unwrap();
    small.reset(9).unwrap();
    assert_eq!(small.snapshot().unwrap(), again);
    // the console was switched on as often as for an episode with a seed
    let mut plain = env("seaquest", one_by_one());
    plain.reset(9).unwrap();
    let power_ons = |ale: &Ale| state(ale)["progress"]["power_ons"].clone();
    assert_eq!(power_ons(small.get_ref().ale()), power_ons(plain.ale()));
}

#[test]
fn a_snapshot_of_other_preprocessing_is_refused() {
    let settings = Preprocessing::default();
    let make = |settings| {
        let mut small = AtariPreprocessing::new(env("seaquest", one_by_one()), settings).unwrap();
        small.reset(2).unwrap();
        small
    };
    let snapshot = make(settings).snapshot().unwrap();
    for other in [
        Preprocessing {
            noop_max: 29,
            ..settings
        },
        Preprocessing {
            frame_skip: 3,
            ..settings
        },
        Preprocessing {
            screen_size: [84, 83],
            ..settings
        },
        Preprocessing {
            terminal_on_life_loss: true,
            ..settings
        },
    ] {
        let mut small = make(other);
        let before = small.snapshot().unwrap();
        assert!(small.restore(&snapshot).is_err(), "{other:?}");
        assert_eq!(small.snapshot().unwrap(), before);
    }
}

/// Like ale-py's `restoreState`, a restore keeps the last action (for sticky actions), and keeps
/// the generator unless `restore_rng` is set.
#[test]
fn a_state_is_restored_as_by_ale_py() {
    let mut ale = Ale::new(
        games::by_name("seaquest").unwrap(),
        &rom(&[0x4c, 0x00, 0xf0]),
        3,
    );
    ale.configure(Settings {
        repeat_action_probability: 0.5,
        ..Settings::default()
    });
    let stored = ale.state();
    for action in [Action::Left, Action::Right, Action::Up] {
        ale.act(action);
    }
    let now = state(&ale);
    for include_rng in [false, true] {
        let mut other = ale.clone();
        assert!(other.set_state_like_ale(&stored, include_rng));
        let then = state(&other);
        assert_eq!(then["progress"]["previous"], now["progress"]["previous"]);
        let first = serde_json::to_value(&stored).unwrap();
        let generator = if include_rng { &first } else { &now };
        assert_eq!(
            then["progress"]["generator"], generator["progress"]["generator"],
            "{include_rng}"
        );
        assert_eq!(then["console"], first["console"]);
    }
}

/// Pictures are part of an environment's state: a snapshot with missing rows is refused.
#[test]
fn a_snapshot_without_its_pictures_is_refused() {
    let mut env = env(
        "seaquest",
        Config {
            obs_type: ObsType::Grayscale,
            ..one_by_one()
        },
    );
    env.reset(1).unwrap();
    let before = env.snapshot().unwrap();
    let json: Json = before.get().unwrap();
    fn texts<'a>(json: &'a mut Json, found: &mut Vec<&'a mut Json>) {
        match json {
            Json::Object(entries) => {
                entries
                    .iter_mut()
                    .filter(|(key, _)| *key != "md5")
                    .for_each(|(_, json)| texts(json, found));
            }
            Json::Array(items) => items.iter_mut().for_each(|json| texts(json, found)),
            Json::String(text) if text.len() > 500 => found.push(json),
            _ => {}
        }
    }
    let count = {
        let mut json = json.clone();
        let mut found = Vec::new();
        texts(&mut json, &mut found);
        found.len()
    };
    assert!(count > 0);
    for i in 0..count {
        let mut json = json.clone();
        let mut found = Vec::new();
        texts(&mut json, &mut found);
        *found[i] = Json::String("AAAA".into());
        assert!(
            env.restore(&Snapshot::of(&json).unwrap()).is_err(),
            "text {i}"
        );
        assert_eq!(env.snapshot().unwrap(), before);
    }
}
