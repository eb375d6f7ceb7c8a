//! The course notebook's own loop: make, reset, step with random actions, see the spaces, and write
//! every frame to a GIF. Run it with `cargo run --release --example notebook`.

use gym::prelude::*;
use gym::render::{RenderMode, write_video};

fn main() -> gym::Result<()> {
    let mut env = gym::builder("CartPole-v1")
        .render_mode(RenderMode::RgbArrayList)
        .build()?;
    println!("observations: {}", env.observation_space());
    println!("actions:      {}", env.action_space());

    let mut actions = env.action_sampler(42)?;
    let observation = env.reset(42)?;
    println!("first observation: {observation}");
    let mut episode_return = 0.0;
    loop {
        let step = env.step(&actions.sample())?;
        episode_return += step.reward;
        if step.done() {
            break;
        }
    }
    let frames = env.render()?.into_frames().unwrap_or_default();
    write_video("cartpole.gif", env.metadata().render_fps, &frames)?;
    println!(
        "return {episode_return}, {} frames in cartpole.gif",
        frames.len()
    );
    Ok(())
}
