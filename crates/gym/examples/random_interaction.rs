//! The notebook's exercise: let random policies play some environments for some episodes, record
//! the frames, and plot returns and lengths. Run it with `cargo run --release --example
//! random_interaction`.

use gym::prelude::*;
use gym::render::{Plot, RenderMode, Rendered, Video};

/// Plays `episodes` episodes of random actions, gives each rendered frame to `recorder`, and
/// returns the return and the length of each episode. `env` may be a typed environment or an
/// environment from `make`.
fn random_interaction<E: Env>(
    env: &mut E,
    episodes: u64,
    recorder: &mut Video,
) -> Result<(Vec<f64>, Vec<f64>)> {
    let mut actions = env.action_sampler(0)?;
    (0..episodes)
        .map(|seed| {
            let (mut episode_return, mut length) = (0.0, 0.0);
            env.reset(seed)?;
            loop {
                if let Rendered::Frame(frame) = env.render()? {
                    recorder.write(&frame)?;
                }
                let step = env.step(&actions.sample())?;
                episode_return += step.reward;
                length += 1.0;
                if step.done() {
                    return Ok((episode_return, length));
                }
            }
        })
        .collect()
}

fn main() -> Result<()> {
    for id in [
        "CartPole-v1",
        "MountainCar-v0",
        "Blackjack-v1",
        "FrozenLake-v1",
    ] {
        let mut env = gym::builder(id).render_mode(RenderMode::RgbArray).build()?;
        let mut recorder = Video::create(format!("{id}.gif"), env.metadata().render_fps)?;
        let (returns, lengths) = random_interaction(&mut env, 10, &mut recorder)?;
        recorder.finish()?;
        Plot::episodes(id, 3, [("random", &returns[..], &lengths[..])])
            .write_png(format!("{id}.png"))?;
        println!(
            "{id:16} mean return {:.2}",
            returns.iter().sum::<f64>() / returns.len() as f64
        );
    }
    Ok(())
}
