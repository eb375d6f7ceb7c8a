//! The images of the book: for each page a GIF of the good policy, small and short; and a sheet of
//! many environments.

use std::path::{Path, PathBuf};

use gym::registry::Clip;
use gym::render::{RenderMode, Video, contact_sheet, write_png};
use gym::{BoxEnv, Env, EnvExt, Error, Result, render::Frame};

use super::Document;
use super::page::Page;
use crate::policy::Policy;

/// The sheet: environments, the sizes of their frames, and the number of random steps before.
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

/// The GIF of a page, if a registration has a clip.
pub(super) fn gif(page: &Page) -> Result<Option<Document>> {
    let Some(Clip {
        seeds,
        every,
        frames,
        size,
    }) = &page.shown().clip
    else {
        return Ok(None);
    };
    let mut env = make(page.shown().id(), *size)?;
    drawn(
        &format!("docs/environments/images/{}.gif", page.name),
        |path| {
            let mut video = Video::create(path, env.metadata().render_fps / every)?;
            let mut states = 0;
            let policy = if Policy::good(&env)?.is_some() {
                Policy::Good
            } else {
                Policy::Random
            };
            for seed in seeds.clone() {
                policy.play(&mut env, seed, |env| {
                    if states % every == 0 && states / every < *frames {
                        video.write(&frame(env)?)?;
                    }
                    states += 1;
                    Ok(())
                })?;
            }
            video.finish()
        },
    )
    .map(Some)
}

pub(super) fn sheet() -> Result<Document> {
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
    drawn("docs/images/environments.png", |path| {
        write_png(path, &contact_sheet(&frames, 3)?)
    })
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

/// The content that `write` writes to a file, for the document at `path`.
fn drawn(path: &str, write: impl FnOnce(&Path) -> Result<()>) -> Result<Document> {
    let path = PathBuf::from(path);
    let folder = crate::root().join("target/docs");
    std::fs::create_dir_all(&folder).map_err(|error| Error::io(&folder, error))?;
    let file = folder.join(path.file_name().unwrap_or_default());
    write(&file)?;
    let bytes = std::fs::read(&file).map_err(|error| Error::io(&file, error))?;
    Ok((path, bytes))
}
