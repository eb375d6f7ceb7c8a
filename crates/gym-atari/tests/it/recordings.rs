//! Recordings of ale-py 0.12.1. These tests need ROMs and a folder of recordings, named by
//! `GYM_REFERENCE`; without them they pass.

use gym_atari::cartridge::Cartridge;
use gym_atari::check::Sums;
use gym_atari::console::{Console, Input, switch};
use gym_atari::games::by_md5;
use gym_atari::recording::Recording;
use gym_atari::{AtariAction, AtariEnv, Config, ObsType, RomDir, games};
use gym_core::{EnvExt, Reset};

#[test]
fn games_are_ale_pys() {
    let (Some(reference), Some(roms)) = (std::env::var_os("GYM_REFERENCE"), RomDir::find()) else {
        println!("no games were compared: that needs GYM_REFERENCE and ROMs");
        return;
    };
    let mut compared = 0;
    for entry in std::fs::read_dir(reference).unwrap() {
        let path = entry.unwrap().path();
        let Ok(text) = std::fs::read_to_string(&path) else {
            continue;
        };
        let Ok(recorded) = serde_json::from_str::<Recording>(&text) else {
            continue;
        };
        let Some(game) = by_md5(&recorded.md5) else {
            continue;
        };
        let answers = recorded.replay(&roms.rom(game).unwrap()).unwrap();
        assert_eq!(
            recorded.first_difference(&answers),
            None,
            "{}",
            path.display()
        );
        compared += 1;
    }
    println!("{compared} recordings of games were compared");
}

/// A console that draws only some frames has the same state as a console that draws all frames.
#[test]
fn unseen_frames_of_games_play_the_same() {
    let Some(roms) = RomDir::find() else {
        println!("no frames were compared: that needs ROMs");
        return;
    };
    let mut random = 1u32;
    let mut below = move |n: u32| {
        random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (random >> 16) % n
    };
    for game in games::GAMES {
        let Ok(rom) = roms.rom(game) else { continue };
        let mut seen = Console::new(
            Cartridge::new(rom.bytes(), game.scheme),
            game.display,
            [0; 128],
            74,
        );
        let mut mixed = seen.clone();
        let mut input = Input {
            charge: [Some(23_000); 4],
            ..Input::default()
        };
        // whether each of the last two frames was completely drawn
        let mut whole = [false; 2];
        for frame in 0..500 {
            if frame % 8 == 0 {
                let pressed = if (60..68).contains(&frame) {
                    switch::RESET
                } else {
                    0
                };
                input.port_b = switch::IDLE & !pressed;
                input.port_a = !(1 << below(8));
                input.fire = [below(2) == 0; 2];
            }
            seen.frame(&input);
            if below(3) == 0 {
                mixed.frame(&input);
                whole = [whole[1], !mixed.is_short()];
            } else {
                mixed.frame_unseen(&input);
                whole = [whole[1], false];
            }
            assert_eq!(seen.ram(), mixed.ram(), "{}, frame {frame}", game.name);
            if whole == [true; 2] {
                assert!(
                    seen.picture() == mixed.picture(),
                    "{}, picture {frame}",
                    game.name
                );
            }
            if frame % 16 == 0 {
                let [seen, mixed] =
                    [&seen, &mixed].map(|console| serde_json::to_value(console.state()).unwrap());
                assert_eq!(seen, mixed, "{}, frame {frame}", game.name);
            }
        }
    }
}

/// Returns a checksum of RAM after the resets and steps of three episodes, the first with a seed.
fn summary(config: Config, steps: usize, action: impl Fn(usize, &AtariEnv) -> AtariAction) -> u32 {
    let mut env = AtariEnv::new(Config {
        obs_type: ObsType::Ram,
        ..config
    })
    .unwrap();
    let mut sum = crc32fast::Hasher::new();
    for reset in [Reset::seed(5), Reset::default(), Reset::default()] {
        sum.update(env.reset(reset).unwrap().as_slice().unwrap());
        for step in 0..steps {
            let action = action(step, &env);
            sum.update(env.step(&action).unwrap().observation.as_slice().unwrap());
        }
    }
    sum.finalize()
}

fn in_mode(game: &str, mode: u16, difficulty: u8) -> Config {
    Config {
        game: game.to_owned(),
        mode: Some(mode),
        difficulty: Some(difficulty),
        ..Config::default()
    }
}

/// Compares every game, in every mode with every difficulty and over several resets, with ale-py's
/// checksums.
#[test]
fn games_come_out_as_recorded() {
    let Some(roms) = RomDir::find() else {
        println!("no games were compared: that needs ROMs");
        return;
    };
    for game in games::GAMES {
        let recorded = Sums::recorded(game.name);
        assert!(recorded.is_some(), "{} was not recorded", game.name);
        match roms.rom(game) {
            Ok(rom) => assert_eq!(recorded, Some(Sums::of(&rom)), "{}", game.name),
            Err(error) => println!("not compared: {error}"),
        }
    }
}

/// Compares modes over three episodes of an environment, and Ice Hockey's noise, which survives a
/// reset.
#[test]
fn modes_outlast_resets_as_in_ale_py() {
    if RomDir::find().is_none() {
        println!("no modes were compared: that needs ROMs");
        return;
    }
    for (game, mode, difficulty, expected) in [
        ("pong", 1, 2, 0x0ac0_2a50),
        ("bowling", 4, 0, 0xb300_8bd5),
        ("crazy_climber", 1, 0, 0xb779_1218),
        ("kangaroo", 1, 0, 0x4a59_20ef),
        ("jamesbond", 1, 0, 0xcc64_2185),
        ("ms_pacman", 3, 0, 0x8a87_e94e),
        ("private_eye", 4, 3, 0x2769_4c58),
        ("space_invaders", 7, 0, 0x8e40_8c89),
        ("bank_heist", 20, 1, 0x6947_7c01),
        ("ice_hockey", 0, 0, 0xec82_f24f),
    ] {
        let sum = summary(in_mode(game, mode, difficulty), 40, |step, env| {
            (step / 4 % env.actions().len()).into()
        });
        assert_eq!(
            sum, expected,
            "{game}, mode {mode}, difficulty {difficulty}"
        );
    }
}

/// A half-moved stick turns a paddle at half speed.
#[test]
fn paddles_turn_by_degrees_as_ale_pys() {
    if RomDir::find().is_none() {
        println!("no paddles were compared: that needs ROMs");
        return;
    }
    let config = Config {
        game: "breakout".to_owned(),
        continuous: true,
        continuous_action_threshold: 0.1,
        ..Config::default()
    };
    let sum = summary(config, 60, |step, _| {
        let radius = (step * 7 % 11) as f32 / 10.0;
        [
            radius,
            [0.0, 3.0, 1.0, -2.5][step / 5 % 4],
            (step % 3) as f32 / 2.0,
        ]
        .into()
    });
    assert_eq!(sum, 0xe3cb_0beb);
}
