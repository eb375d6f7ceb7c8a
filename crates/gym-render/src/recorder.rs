//! Recording an environment, frame by frame.

use std::path::Path;

use gym_core::render::{Frame, Rendered};
use gym_core::{Env, Result};

use crate::Video;
use crate::mode::{not_frames, require_frames};

/// Records the frames of an environment, of one or many episodes, to one file.
///
/// With the render mode `rgb_array`, call [`capture`](Self::capture) after each reset and step;
/// with `rgb_array_list`, before each further reset and at the end. The file's extension selects
/// the format, as for [`Video`]. Each frame is written immediately: a recording of any length takes
/// the memory of a few frames.
///
/// Dropping the recorder finishes the file, but cannot report errors.
///
/// ```
/// use gym_core::{Env, EnvExt, Result};
/// use gym_render::Recorder;
///
/// /// Records an episode of random actions; the environment has the mode `rgb_array`.
/// fn record<E: Env>(env: &mut E, path: &str) -> Result<u64> {
///     let mut recorder = Recorder::new(path, env)?;
///     let mut actions = env.action_sampler(0)?;
///     env.reset(0)?;
///     recorder.capture(env)?;
///     loop {
///         let done = env.step(&actions.sample())?.done();
///         recorder.capture(env)?;
///         if done {
///             return recorder.finish();
///         }
///     }
/// }
/// ```
#[derive(Debug)]
pub struct Recorder {
    video: Video,
    /// The last frame; the next frame reuses its memory.
    rendered: Rendered,
    frames: u64,
    max_frames: u64,
}

impl Recorder {
    /// Starts a file with the frames per second of the environment's metadata.
    ///
    /// # Errors
    /// [`Error::UnsupportedMode`](gym_core::Error::UnsupportedMode) if the environment has no render
    /// mode, or one without frames, and the errors of [`Video::create`].
    pub fn new<E: Env>(path: impl AsRef<Path>, env: &E) -> Result<Self> {
        require_frames(env.describe(), env.render_mode())?;
        Self::with_fps(path, env.metadata().render_fps)
    }

    /// Starts a file with `fps` frames per second.
    ///
    /// # Errors
    /// The errors of [`Video::create`].
    pub fn with_fps(path: impl AsRef<Path>, fps: u32) -> Result<Self> {
        let video = Video::create(path, fps)?;
        Ok(Self {
            video,
            rendered: Rendered::Shown,
            frames: 0,
            max_frames: u64::MAX,
        })
    }

    /// Records at most `max_frames` frames and ignores the rest.
    #[must_use]
    pub fn max_frames(self, max_frames: u64) -> Self {
        Self { max_frames, ..self }
    }

    /// Returns the number of recorded frames.
    pub fn frames(&self) -> u64 {
        self.frames
    }

    /// Records the current frame, or the list of frames that the environment collected. Once
    /// [`max_frames`](Self::max_frames) are recorded, it renders nothing.
    ///
    /// # Errors
    /// [`Error::UnsupportedMode`](gym_core::Error::UnsupportedMode) if the environment renders no
    /// frames, and the errors of [`EnvExt::render`](gym_core::EnvExt::render) and
    /// [`Video::write`].
    pub fn capture<E: Env>(&mut self, env: &mut E) -> Result<()> {
        if self.frames >= self.max_frames {
            return Ok(());
        }
        env.render_into(&mut self.rendered)?;
        let mut write = |frame: &Frame| {
            if self.frames < self.max_frames {
                self.video.write(frame)?;
                self.frames += 1;
            }
            Ok(())
        };
        match &mut self.rendered {
            Rendered::Frame(frame) => write(frame),
            Rendered::Frames(frames) => std::mem::take(frames).iter().try_for_each(write),
            other => Err(not_frames(env.describe(), other)),
        }
    }

    /// Completes the file; returns its number of frames.
    ///
    /// # Errors
    /// The errors of [`Video::finish`].
    pub fn finish(self) -> Result<u64> {
        self.video.finish()?;
        Ok(self.frames)
    }
}
