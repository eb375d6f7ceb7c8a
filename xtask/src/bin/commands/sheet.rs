//! The contact sheet: images of several environments in one image.

use gym::render::{Frame, RenderMode};
use gym::render::{contact_sheet, write_png};
use gym::{BoxEnv, EnvExt, Error, Result};
use gym_cli::Document;

/// The frames of the contact sheet: the environment, the size, and the number of random steps
/// before the frame.
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

pub(crate) fn document() -> Result<Document> {
    let frames = SHEET.iter().map(|(id, size, steps)| {
        let mut env = make(id, *size)?;
        let mut actions = env.action_sampler(3)?;
        env.reset(3)?;
        for _ in 0..*steps {
            env.step(&actions.sample())?;
        }
        frame(&mut env)
    });
    let frames = frames.collect::<Result<Vec<_>>>()?;
    let file = std::env::temp_dir().join(format!("gym-sheet-{}.png", std::process::id()));
    write_png(&file, &contact_sheet(&frames, 3)?)?;
    let bytes = std::fs::read(&file).map_err(|error| Error::io(&file, error))?;
    std::fs::remove_file(&file).map_err(|error| Error::io(&file, error))?;
    Ok(("docs/images/environments.png".into(), bytes))
}

fn make(id: &str, (width, height): (u32, u32)) -> Result<BoxEnv> {
    gym::builder(id)
        .render_mode(RenderMode::RgbArray)
        .render_size(width, height)
        .build()
}

fn frame(env: &mut BoxEnv) -> Result<Frame> {
    env.render()?
        .into_frame()
        .ok_or_else(|| Error::Contract(format!("{env} renders no frame")))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `cargo xtask docs --draw` redraws it.
    #[test]
    fn the_sheet_is_as_kept() {
        let (path, drawn) = document().unwrap();
        let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
        let kept = std::fs::read(root.join(&path)).unwrap();
        assert!(drawn == kept, "{} is another picture", path.display());
    }
}
