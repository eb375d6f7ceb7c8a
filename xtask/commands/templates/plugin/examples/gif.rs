//! Records an episode of random actions: `cargo run --example gif [ID] [FILE]`.

use gym_core::render::RenderMode;
use gym_core::{Env, Result};
use gym_render::Recorder;
use plugin_name as _;

fn main() -> Result<()> {
    let mut arguments = std::env::args().skip(1);
    let id = arguments.next().unwrap_or_else(|| "plugin_name/Corridor-v0".into());
    let file = arguments.next().unwrap_or_else(|| "episode.gif".into());
    let mut env = gym_core::builder(&id).render_mode(RenderMode::RgbArray).build()?;
    let mut actions = env.action_sampler(4)?;
    let mut recorder = Recorder::new(&file, &env)?;
    env.reset(4)?;
    recorder.capture(&mut env)?;
    loop {
        let step = env.step(&actions.sample())?;
        recorder.capture(&mut env)?;
        if step.done() {
            break;
        }
    }
    println!("{file}: {} frames", recorder.finish()?);
    Ok(())
}
