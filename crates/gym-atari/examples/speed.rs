//! Measures the speed of games: `speed frames|steps [NUMBER] [GAME...]`. `frames` plays and draws
//! frame by frame; `steps` plays the usual preprocessing: four frames per step, 84x84 in gray, a
//! stack of four.

use std::time::Instant;

use gym_atari::games::{self, Game};
use gym_atari::{Ale, AtariEnv, AtariPreprocessing, Config, Frameskip, Rom, RomDir};
use gym_core::{Env, EnvExt, Result};
use gym_wrappers::Wrap;

fn main() -> Result<()> {
    let mut arguments = std::env::args().skip(1).peekable();
    let what = arguments.next().unwrap_or_default();
    let play = match what.as_str() {
        "frames" => play_frames,
        "steps" => play_steps,
        _ => {
            println!("speed frames|steps [NUMBER] [GAME...]");
            return Ok(());
        }
    };
    let number = arguments
        .next_if(|n| n.parse::<usize>().is_ok())
        .and_then(|n| n.parse().ok())
        .unwrap_or(10_000);
    let names: Vec<String> = arguments.collect();
    let Some(roms) = RomDir::find() else {
        println!("there are no ROMs: `pip install ale-py`, or set ALE_ROMS_DIR");
        return Ok(());
    };
    for game in games::GAMES
        .iter()
        .filter(|game| names.is_empty() || names.iter().any(|name| name == game.name))
    {
        let mut random = 1u32;
        let actions = (0..number).map(|_| {
            random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (random >> 16) as usize % game.minimal.len()
        });
        let actions: Vec<usize> = actions.collect();
        let seconds = play(game, &roms.rom(game)?, &actions)?;
        println!(
            "{:20} {:8.0} {what} a second",
            game.name,
            number as f64 / seconds
        );
    }
    Ok(())
}

/// Returns the seconds that one frame per action takes.
fn play_frames(game: &'static Game, rom: &Rom, actions: &[usize]) -> Result<f64> {
    let mut ale = Ale::new(game, rom.bytes(), 0);
    let start = Instant::now();
    for &action in actions {
        if ale.game_over() {
            ale.reset();
        }
        ale.act(game.minimal[action]);
    }
    Ok(start.elapsed().as_secs_f64())
}

/// Returns the seconds that one step per action takes.
fn play_steps(_game: &'static Game, rom: &Rom, actions: &[usize]) -> Result<f64> {
    let config = Config {
        frameskip: Frameskip::Fixed(1),
        repeat_action_probability: 0.0,
        ..Config::default()
    };
    let env = AtariPreprocessing::new(AtariEnv::with_rom(config, rom)?, Default::default())?;
    let mut env = env.frame_stack(4)?;
    let mut observation = env.reset(1)?;
    let start = Instant::now();
    for &action in actions {
        if env.step_into(&action.into(), &mut observation)?.done() {
            env.reset_into(&Default::default(), &mut observation)?;
        }
    }
    Ok(start.elapsed().as_secs_f64())
}
