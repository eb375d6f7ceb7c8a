//! Short GIFs of an environment.

use gym::registry::Clip;
use gym::render::{RenderMode, Video, VideoFormat};
use gym::{BoxEnv, Env, EnvExt, EnvSpec, Error, Result};

/// A GIF that is recorded while an environment is played.
pub(crate) struct Film {
    gif: Video,
    /// Records every n-th state.
    every: u64,
    /// The number of frames that are still to be recorded.
    left: u64,
    /// The number of states so far.
    states: u64,
}

impl Film {
    /// Makes the environment of a spec with pictures of the clip's size, and its empty film.
    pub(crate) fn open(spec: EnvSpec, clip: &Clip) -> Result<(BoxEnv, Self)> {
        let env = EnvSpec {
            render_mode: Some(RenderMode::RgbArray),
            render_size: Some(clip.size),
            ..spec
        }
        .make()?;
        let fps = env.metadata().render_fps / clip.every.max(1);
        let film = Self {
            gif: Video::in_memory(VideoFormat::Gif, fps.max(1))?,
            every: clip.every.max(1).into(),
            left: clip.frames.into(),
            states: 0,
        };
        Ok((env, film))
    }

    /// Records the state of `env`, if it is its turn. Call it after each reset and step.
    pub(crate) fn watch(&mut self, env: &mut BoxEnv) -> Result<()> {
        if self.left > 0 && self.states.is_multiple_of(self.every) {
            let frame = env.render()?.into_frame();
            let frame = frame.ok_or_else(|| Error::Contract(format!("{env} renders no frame")))?;
            self.gif.write(&frame)?;
            self.left -= 1;
        }
        self.states += 1;
        Ok(())
    }

    /// Returns the bytes of the GIF.
    pub(crate) fn finish(self) -> Result<Vec<u8>> {
        self.gif.into_bytes()
    }
}
