//! How many frames a second each game plays: `raw_frames [FRAMES] [GAME...]`.

use std::time::Instant;

use gym_atari::{Ale, RomDir, games};

fn main() -> gym_core::Result<()> {
    let mut arguments = std::env::args().skip(1);
    let frames: usize = arguments.next().and_then(|n| n.parse().ok()).unwrap_or(10_000);
    let names: Vec<String> = arguments.collect();
    let Some(roms) = RomDir::find() else {
        println!("there are no ROMs: `pip install ale-py`, or set ALE_ROMS_DIR");
        return Ok(());
    };
    for game in
        games::GAMES.iter().filter(|game| names.is_empty() || names.iter().any(|name| name == game.name))
    {
        let mut ale = Ale::new(game, roms.rom(game)?.bytes(), 0);
        let mut random = 1u32;
        let start = Instant::now();
        for _ in 0..frames {
            if ale.game_over() {
                ale.reset();
            }
            random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            ale.act(game.minimal[(random >> 16) as usize % game.minimal.len()], 0.0);
        }
        println!("{:20} {:8.0} frames a second", game.name, frames as f64 / start.elapsed().as_secs_f64());
    }
    Ok(())
}
