//! A wrapper that records an environment.

use std::fmt;
use std::path::Path;

use gym_core::registry::WrapperConfig;
use gym_core::render::{Frame, Rendered};
use gym_core::{BoxEnv, Env, Error, Outcome, Reset, Result, Snapshot, WrapperSpec};

use crate::recorder::{check_mode, not_frames};
use crate::tape::{Config, Tape, tape_options};

gym_core::register_wrapper!(
    "RecordVideo", "records some episodes to files", Config, env: RecordVideo::with_config
);

/// Records some episodes, or stretches of steps, to files in a folder: Gymnasium's `RecordVideo`.
///
/// The inner environment must have the render mode `rgb_array` or `rgb_array_list`. A recording
/// starts at the reset of each episode that the episode trigger accepts, and at each step that the
/// step trigger accepts; without a trigger, [`capped_cubic`](crate::capped_cubic) chooses the
/// episodes. Episodes are counted from the first reset, steps over all episodes, both from 0. A
/// recording ends with its episode, or after [`video_length`](Self::video_length) frames if set,
/// over any number of episodes.
///
/// Files are called `rl-video-episode-8.gif` or `rl-video-step-1000.gif`; one that exists is
/// replaced. Frames go to the file at once, and it appears under its name when it is complete: by
/// the end of the recording, `close`, or a drop.
///
/// A file that cannot be written does not stop the training: the recording ends with a warning
/// through the `log` crate, and [`take_error`](Self::take_error) returns the error.
///
/// Snapshots do not contain recordings: after `restore` a recording continues with the new state. A
/// clone does not record. With your own trigger there is no spec, because functions cannot be
/// stored.
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
    tape: Tape,
    /// Frames taken from the environment's list, until `render` returns them.
    list: Vec<Frame>,
    /// The last frame, which the next one overwrites.
    rendered: Rendered,
}

impl<E: Env> RecordVideo<E> {
    /// Records `env` to a folder, which is made if it does not exist.
    ///
    /// # Errors
    /// [`Error::Io`] if the folder cannot be made, [`Error::UnsupportedMode`] if the environment
    /// was made without a render mode, or with one without frames.
    pub fn new(env: E, folder: impl AsRef<Path>) -> Result<Self> {
        Self::with_config(
            env,
            Config {
                video_folder: folder.as_ref().to_owned(),
                ..Config::default()
            },
        )
    }

    /// Records `env` with all arguments at once.
    ///
    /// # Errors
    /// The errors of [`new`](Self::new).
    pub fn with_config(env: E, config: Config) -> Result<Self> {
        check_mode(&env)?;
        let tape = Tape::new(config, env.metadata().render_fps)?;
        Ok(Self {
            env,
            tape,
            list: Vec::new(),
            rendered: Rendered::Shown,
        })
    }

    tape_options!();

    /// The inner environment.
    pub fn get_ref(&self) -> &E {
        &self.env
    }

    /// The environment within, to change it.
    pub fn get_mut(&mut self) -> &mut E {
        &mut self.env
    }

    /// The inner environment; a running recording ends.
    pub fn into_inner(mut self) -> E {
        self.tape.stop();
        self.env
    }

    /// Records the newest frame.
    fn capture(&mut self) -> Result<()> {
        if !self.is_recording() {
            return Ok(());
        }
        self.env.render_into(&mut self.rendered)?;
        match &mut self.rendered {
            Rendered::Frame(frame) => self.tape.write(frame),
            Rendered::Frames(frames) => {
                self.list.append(frames);
                if let Some(frame) = self.list.last() {
                    self.tape.write(frame);
                }
            }
            other => return Err(not_frames(&self.env.describe(), other)),
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

    fn reset_into(&mut self, reset: &Reset, observation: &mut E::Observation) -> Result<()> {
        self.env.reset_into(reset, observation)?;
        self.list.clear();
        self.tape.episode();
        self.capture()
    }

    fn step_into(
        &mut self,
        action: &E::Action,
        observation: &mut E::Observation,
    ) -> Result<Outcome> {
        let outcome = self.env.step_into(action, observation)?;
        self.tape.step();
        self.capture()?;
        if outcome.done() {
            self.tape.end_of_episode();
        }
        Ok(outcome)
    }

    fn render_into(&mut self, rendered: &mut Rendered) -> Result<()> {
        self.env.render_into(rendered)?;
        if let Rendered::Frames(frames) = rendered {
            self.list.append(frames);
            *frames = std::mem::take(&mut self.list);
        }
        Ok(())
    }

    fn restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        self.env.restore(snapshot)?;
        self.list.clear();
        Ok(())
    }

    fn wrapper_spec(&self) -> Option<WrapperSpec> {
        self.tape.stored().map(|config| config.spec())
    }

    fn close(&mut self) {
        self.tape.stop();
        self.env.close();
    }
}

impl<E: Env + fmt::Debug> fmt::Debug for RecordVideo<E> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("RecordVideo")
            .field("env", &self.env)
            .field("folder", &self.tape.config.video_folder)
            .field("recording", &self.tape.recording)
            .finish_non_exhaustive()
    }
}
