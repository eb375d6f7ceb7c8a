//! The images of the pages: a GIF of the good policy, small and short.

use std::path::PathBuf;

use gym::registry::Clip;
use gym::render::{RenderMode, Video, VideoFormat};
use gym::{Env, EnvExt, Error, Result};

use super::Document;
use super::page::Page;
use crate::policy::Policy;

/// Returns the GIF of a page, if a registration has a clip.
pub(super) fn gif(page: &Page) -> Result<Option<Document>> {
    let Some(clip) = &page.shown().page.clip else {
        return Ok(None);
    };
    let Clip {
        seeds,
        every,
        frames,
        size: (width, height),
    } = clip;
    let mut env = gym::builder(page.shown().id())
        .render_mode(RenderMode::RgbArray)
        .render_size(*width, *height)
        .build()?;
    let fps = env.metadata().render_fps / every;
    let policy = if Policy::good(&env)?.is_some() {
        Policy::Good
    } else {
        Policy::Random
    };
    let mut gif = Video::in_memory(VideoFormat::Gif, fps)?;
    let mut states = 0;
    for seed in seeds.clone() {
        policy.play(&mut env, seed, |env| {
            if states % every == 0 && states / every < *frames {
                let frame = env.render()?.into_frame();
                let frame =
                    frame.ok_or_else(|| Error::Contract(format!("{env} renders no frame")))?;
                gif.write(&frame)?;
            }
            states += 1;
            Ok(())
        })?;
    }
    let path = PathBuf::from(format!("docs/environments/images/{}.gif", page.name));
    Ok(Some((path, gif.into_bytes()?)))
}
