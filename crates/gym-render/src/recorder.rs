//! Recording an environment by hand.

use std::path::Path;

use gym_core::render::{Frame, RenderMode, Rendered};
use gym_core::{Env, Error, Result};

use crate::VideoWriter;

/// Records the frames of an environment, over one episode or many, to one file.
///
/// With the render mode `rgb_array`, call [`capture`](Self::capture) after each reset and step;
/// with `rgb_array_list`, before each further reset and at the end. The file's extension selects
/// the format, as for [`VideoWriter`]. Each frame is written at once: a recording of any length
/// takes the memory of a few frames.
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
    video: VideoWriter,
    /// The last frame, which the next one overwrites.
    rendered: Rendered,
    frames: u64,
    max_frames: u64,
}

impl Recorder {
    /// Starts a file that plays at the environment's own speed.
    ///
    /// # Errors
    /// [`Error::UnsupportedMode`] if the environment was made without a render mode, or with one
    /// without frames, and as [`VideoWriter::create`].
    pub fn new<E: Env>(path: impl AsRef<Path>, env: &E) -> Result<Self> {
        check_mode(env)?;
        Self::with_fps(path, env.metadata().render_fps)
    }

    /// Starts a file that plays at another speed.
    ///
    /// # Errors
    /// The errors of [`VideoWriter::create`].
    pub fn with_fps(path: impl AsRef<Path>, fps: u32) -> Result<Self> {
        let video = VideoWriter::create(path, fps)?;
        Ok(Self {
            video,
            rendered: Rendered::Shown,
            frames: 0,
            max_frames: u64::MAX,
        })
    }

    /// Records that many frames and ignores the rest.
    #[must_use]
    pub fn max_frames(self, max_frames: u64) -> Self {
        Self { max_frames, ..self }
    }

    /// The frames recorded.
    pub fn frames(&self) -> u64 {
        self.frames
    }

    /// Records the current frame, or the list of frames collected by the environment. Once enough
    /// frames are recorded, it renders nothing.
    ///
    /// # Errors
    /// [`Error::UnsupportedMode`] if it has another render mode, the errors of
    /// [`EnvExt::render`](gym_core::EnvExt::render), and as [`VideoWriter::write`].
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
            other => Err(not_frames(&env.describe(), other)),
        }
    }

    /// Completes the file; returns its number of frames.
    ///
    /// # Errors
    /// The errors of [`VideoWriter::finish`].
    pub fn finish(self) -> Result<u64> {
        self.video.finish()?;
        Ok(self.frames)
    }
}

/// The error for an environment that renders something else than frames.
pub(crate) fn not_frames(target: &str, rendered: &Rendered) -> Error {
    let mode = match rendered {
        Rendered::Shown => "human",
        Rendered::Text(_) => "ansi",
        Rendered::Texts(_) => "ansi_list",
        Rendered::Frame(_) | Rendered::Frames(_) => "rgb_array",
    };
    Error::UnsupportedMode {
        target: target.to_owned(),
        mode: "frames to record".into(),
        reason: format!(
            "its render mode is {mode}: make it with `.render_mode(RenderMode::RgbArray)`"
        ),
    }
}

/// Fails for an environment that will render no frames.
pub(crate) fn check_mode<E: Env>(env: &E) -> Result<()> {
    check_known_mode(env.describe(), env.render_mode())
}

/// Fails unless the render mode has frames.
pub(crate) fn check_known_mode(target: String, mode: Option<RenderMode>) -> Result<()> {
    let was = match mode {
        Some(mode) if mode.single() == RenderMode::RgbArray => return Ok(()),
        Some(mode) => format!("its render mode is {mode}"),
        None => "it has no render mode".into(),
    };
    Err(Error::UnsupportedMode {
        target,
        mode: "frames to record".into(),
        reason: format!("{was}: make it with `.render_mode(RenderMode::RgbArray)`"),
    })
}
