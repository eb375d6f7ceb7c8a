//! `cargo xtask pictures`: draws the pictures of the documents.

use std::path::PathBuf;

use gym::render::RenderMode;
use gym::rendering::{contact_sheet, write_png};
use gym::{Env, Error, Result};

#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Where they go.
    #[arg(long, default_value = "docs/images")]
    out: PathBuf,
}

/// The environments of the README's picture, their frame size there, and how many random steps in.
const SHEET: [(&str, (u32, u32), usize); 9] = [
    ("LunarLander-v3", (360, 240), 40),
    ("BipedalWalker-v3", (360, 240), 30),
    ("CarRacing-v3", (360, 240), 60),
    ("CartPole-v1", (360, 240), 12),
    ("MountainCar-v0", (360, 240), 30),
    ("Taxi-v4", (282, 240), 20),
    ("CliffWalking-v1", (360, 120), 6),
    ("Blackjack-v1", (245, 240), 0),
    ("FrozenLake-v1", (240, 240), 3),
];

pub(crate) fn pictures(arguments: &Arguments) -> Result<()> {
    std::fs::create_dir_all(&arguments.out).map_err(|error| Error::io(&arguments.out, error))?;
    let frames = SHEET.iter().map(|(id, (width, height), steps)| {
        let mut env =
            gym::builder(id).render_mode(RenderMode::RgbArray).render_size(*width, *height).build()?;
        let mut actions = env.action_sampler(3)?;
        env.reset(3)?;
        for _ in 0..*steps {
            env.step(&actions.sample())?;
        }
        env.render()?.into_frame().ok_or_else(|| Error::Contract(format!("`{id}` renders no frame")))
    });
    let frames = frames.collect::<Result<Vec<_>>>()?;
    write_png(arguments.out.join("environments.png"), &contact_sheet(&frames, 3))
}
