//! A wrapper that records an environment.

use std::fmt;

use gym_core::registry::WrapperConfig;
use gym_core::render::{Frame, Rendered};
use gym_core::{BoxEnv, Env, Error, Outcome, Reset, Result, Snapshot, WrapperSpec};

use crate::episode_recorder::{Config, EpisodeRecorder};
use crate::mode::{not_frames, require_frames};

gym_core::register_wrapper!(
    "RecordVideo", "records some episodes to files", Config, env: RecordVideo::new
);

/// Records some episodes, or sequences of steps, to files in a folder: Gymnasium's `RecordVideo`.
///
/// The inner environment must have the render mode `rgb_array` or `rgb_array_list`. A recording
/// starts at the reset of each episode that the episode trigger accepts, and at each step that the
/// step trigger accepts; without a trigger, [`capped_cubic`](crate::capped_cubic) chooses the
/// episodes. Episodes are counted from the first reset, steps over all episodes, both from 0. A
/// recording ends with its episode or, with a
/// [`video_length`](crate::RecordVideoConfig::video_length), after this number of frames, which may
/// belong to several episodes.
///
/// Files are called `rl-video-episode-8.gif` or `rl-video-step-1000.gif`; an existing file is
/// replaced. Frames are written immediately. A file appears under its name when it is complete: at
/// the end of the recording, by `close`, or by a drop.
///
/// A file that cannot be written does not stop the training: the recording ends with a warning
/// through the `log` crate, and [`take_error`](Self::take_error) returns the error.
///
/// Snapshots do not contain recordings: after `restore` a recording continues with the new state. A
/// clone records nothing. With a trigger of your own, the environment has no spec, because a function
/// cannot be stored.
///
/// ```no_run
/// use gym_core::{Env, Result, builder, render::RenderMode};
/// use gym_render::RecordVideo;
///
/// # fn main() -> Result<()> {
/// let env = builder("CartPole-v1").render_mode(RenderMode::RgbArray).build()?;
/// let mut env = RecordVideo::new(env, "videos")?.episode_trigger(|episode| episode % 100 == 0);
/// # Ok(())
/// # }
/// ```
#[derive(Clone)]
pub struct RecordVideo<E: Env = BoxEnv> {
    env: E,
    recorder: EpisodeRecorder,
    /// The frames taken from the environment's list. The next `render` returns them.
    list: Vec<Frame>,
    /// The last frame; the next frame reuses its memory.
    rendered: Rendered,
}

impl<E: Env> RecordVideo<E> {
    /// Records `env`. `config` is the folder for the files, or a
    /// [`RecordVideoConfig`](crate::RecordVideoConfig) with all arguments.
    ///
    /// # Errors
    /// [`Error::Io`] if the folder cannot be created, [`Error::UnsupportedMode`] if the environment
    /// has no render mode, or one without frames.
    pub fn new(env: E, config: impl Into<Config>) -> Result<Self> {
        require_frames(env.describe(), env.render_mode())?;
        let recorder = EpisodeRecorder::new(config.into(), env.metadata().render_fps)?;
        Ok(Self {
            env,
            recorder,
            list: Vec::new(),
            rendered: Rendered::Shown,
        })
    }

    /// Records the episodes that `trigger` accepts, by their number.
    #[must_use]
    pub fn episode_trigger(mut self, trigger: impl FnMut(u64) -> bool + Send + 'static) -> Self {
        self.recorder.episode_trigger = Some(Box::new(trigger));
        self
    }

    /// Records from the steps that `trigger` accepts; records episodes only if there is also an
    /// episode trigger.
    #[must_use]
    pub fn step_trigger(mut self, trigger: impl FnMut(u64) -> bool + Send + 'static) -> Self {
        self.recorder.step_trigger = Some(Box::new(trigger));
        self
    }

    /// Whether a recording is running.
    pub fn is_recording(&self) -> bool {
        self.recorder.is_recording()
    }

    /// Takes the error that ended the last recording, if any.
    pub fn take_error(&mut self) -> Option<Error> {
        self.recorder.take_error()
    }

    /// Returns the inner environment.
    pub fn get_ref(&self) -> &E {
        &self.env
    }

    /// Returns the inner environment for changes.
    pub fn get_mut(&mut self) -> &mut E {
        &mut self.env
    }

    /// Ends a running recording and returns the inner environment.
    pub fn into_inner(mut self) -> E {
        self.recorder.stop();
        self.env
    }

    /// Records the newest frame.
    fn capture(&mut self) -> Result<()> {
        if !self.is_recording() {
            return Ok(());
        }
        self.env.render_into(&mut self.rendered)?;
        match &mut self.rendered {
            Rendered::Frame(frame) => self.recorder.write(frame),
            Rendered::Frames(frames) => {
                self.list.append(frames);
                if let Some(frame) = self.list.last() {
                    self.recorder.write(frame);
                }
            }
            other => return Err(not_frames(self.env.describe(), other)),
        }
        Ok(())
    }
}

impl<E: Env> gym_core::Wrapper for RecordVideo<E> {
    type Inner = E;
    type Observation = E::Observation;
    type Action = E::Action;

    fn inner(&self) -> &E {
        &self.env
    }

    fn inner_mut(&mut self) -> &mut E {
        &mut self.env
    }

    fn on_reset(&mut self, reset: &Reset, observation: &mut E::Observation) -> Result<()> {
        self.env.reset_into(reset, observation)?;
        self.list.clear();
        self.recorder.episode();
        self.capture()
    }

    fn on_step(&mut self, action: &E::Action, observation: &mut E::Observation) -> Result<Outcome> {
        let outcome = self.env.step_into(action, observation)?;
        self.recorder.step();
        self.capture()?;
        if outcome.done() {
            self.recorder.end_of_episode();
        }
        Ok(outcome)
    }

    fn on_render(&mut self, rendered: &mut Rendered) -> Result<()> {
        self.env.render_into(rendered)?;
        if let Rendered::Frames(frames) = rendered {
            self.list.append(frames);
            *frames = std::mem::take(&mut self.list);
        }
        Ok(())
    }

    fn on_restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        self.env.restore(snapshot)?;
        self.list.clear();
        Ok(())
    }

    fn wrapper_spec(&self) -> Option<WrapperSpec> {
        self.recorder.stored().map(|config| config.spec())
    }

    fn on_close(&mut self) {
        self.recorder.stop();
        self.env.close();
    }
}

impl<E: Env + fmt::Debug> fmt::Debug for RecordVideo<E> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("RecordVideo")
            .field("env", &self.env)
            .field("folder", &self.recorder.config.video_folder)
            .field("recording", &self.recorder.is_recording())
            .finish_non_exhaustive()
    }
}
