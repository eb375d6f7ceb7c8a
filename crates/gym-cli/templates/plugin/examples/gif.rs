//! Records an episode of random actions: `cargo run --example gif [ID] [FILE]`.

use gym_core::render::RenderMode;
use gym_core::{EnvExt, Error, Result, registry};
use gym_render::Recorder;
use plugin_name as _;

fn main() -> Result<()> {
    let mut arguments = std::env::args().skip(1);
    // without an id, the first id that this crate registers
    let own = registry::all().into_iter().find(|own| own.source.package == env!("CARGO_PKG_NAME"));
    let id = arguments.next().or(own.map(|own| own.id().to_owned()));
    let id = id.ok_or_else(|| Error::custom("this crate registers no environment"))?;
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
