//! How many steps a second games make as the field plays them, 84x84 in gray, four stacked: `preprocessed [STEPS] [GAME...]`.

use std::time::Instant;

use gym_atari::{AtariEnv, AtariPreprocessing, Config, Frameskip, RomDir, games};
use gym_core::{Env, Wrap};

fn main() -> gym_core::Result<()> {
    let mut arguments = std::env::args().skip(1);
    let steps: usize = arguments.next().and_then(|n| n.parse().ok()).unwrap_or(10_000);
    let names: Vec<String> = arguments.collect();
    let Some(roms) = RomDir::find() else {
        println!("there are no ROMs: `pip install ale-py`, or set ALE_ROMS_DIR");
        return Ok(());
    };
    for game in
        games::GAMES.iter().filter(|game| names.is_empty() || names.iter().any(|name| name == game.name))
    {
        let config =
            Config { frameskip: Frameskip::Fixed(1), repeat_action_probability: 0.0, ..Config::default() };
        let env = AtariPreprocessing::new(AtariEnv::with_rom(config, &roms.rom(game)?)?, Default::default())?;
        let mut env = env.frame_stack(4)?;
        let mut observation = env.reset(1)?;
        let mut random = 1u32;
        let start = Instant::now();
        for _ in 0..steps {
            random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let action = (random >> 16) as usize % game.minimal.len();
            if env.step_into(&action.into(), &mut observation)?.done() {
                env.reset_into(&Default::default(), &mut observation)?;
            }
        }
        println!("{:20} {:8.0} steps a second", game.name, steps as f64 / start.elapsed().as_secs_f64());
    }
    Ok(())
}
