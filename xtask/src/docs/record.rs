//! The GIF of a page: episodes of the good policy, small and short.

use std::path::PathBuf;

use gym::render::RenderMode;
use gym::rendering::GifWriter;
use gym::{Env, Error, Result};

use super::Document;
use super::pages::Page;
use crate::policy::Policy;

pub(super) fn gif(page: &Page) -> Result<Document> {
    let clip = &page.clip;
    let env = gym::builder(clip.id).render_mode(RenderMode::RgbArray);
    let mut env = match clip.size {
        Some((width, height)) => env.render_size(width, height).build()?,
        None => env.build()?,
    };
    let name = format!("{}.gif", page.name);
    let folder = super::root().join("target/docs");
    std::fs::create_dir_all(&folder).map_err(|error| Error::io(&folder, error))?;
    let path = folder.join(&name);
    let mut video = GifWriter::create(&path, env.metadata().render_fps / clip.every)?;
    let mut states = 0;
    for seed in clip.seeds.clone() {
        Policy::Heuristic.play(&mut env, seed, |env| {
            if states % clip.every == 0 && states / clip.every < clip.frames {
                let frame = env.render()?.into_frame();
                let frame = frame.ok_or_else(|| Error::Contract(format!("{env} renders no frame")))?;
                video.write(&frame)?;
            }
            states += 1;
            Ok(())
        })?;
    }
    video.finish()?;
    let bytes = std::fs::read(&path).map_err(|error| Error::io(&path, error))?;
    Ok((PathBuf::from("docs/environments/images").join(name), bytes))
}
