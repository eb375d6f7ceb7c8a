//! Recording an environment while somebody else steps it.

use std::fmt;
use std::fs;
use std::path::{Path, PathBuf};

use gym_core::registry::WrapperRegistration;
use gym_core::render::{Frame, Rendered};
use gym_core::{
    BoxEnv, Env, EnvSpec, Error, Kwargs, Outcome, Reset, Result, Snapshot, WrapperSpec, inventory,
};

use crate::VideoWriter;
use crate::recorder::not_frames;

/// Whether to record, by the number of the episode or of the step.
type Trigger = Box<dyn FnMut(u64) -> bool + Send>;

/// Gymnasium's name of the wrapper.
const NAME: &str = "RecordVideo";

inventory::submit! {
    WrapperRegistration { name: NAME, wrap: |env, kwargs| Ok(BoxEnv::new(RecordVideo::from_kwargs(env, kwargs)?)) }
}

/// Records some episodes, or stretches of steps, to files in a folder: Gymnasium's `RecordVideo`.
///
/// The environment within has the render mode `rgb_array` or `rgb_array_list`. A recording starts at
/// the reset of each episode that the episode trigger accepts, and at each step that the step trigger
/// accepts; without a trigger, [`capped_cubic`] chooses the episodes. Episodes are counted from the
/// first reset, steps over all episodes, both from 0. A recording ends with its episode, or after
/// [`video_length`](Self::video_length) frames where that is set, over as many episodes as they take.
///
/// Files are called `rl-video-episode-8.gif` or `rl-video-step-1000.gif`; one that exists is replaced.
/// Frames go to the file at once, and it appears under its name when it is complete: by the end of
/// the recording, `close`, or a drop.
///
/// A file that cannot be written does not stop the training: the recording is given up with a
/// warning through the `log` crate, and [`take_error`](Self::take_error) hands out the reason.
///
/// Recording is no part of a snapshot: after `restore` it continues with what happens then. A clone
/// does not record. With a trigger of your own there is no spec, since functions cannot be rebuilt.
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
pub struct RecordVideo<E: Env> {
    env: E,
    folder: PathBuf,
    name_prefix: String,
    extension: String,
    fps: u32,
    video_length: u64,
    is_clone: bool,
    episode_trigger: Option<Trigger>,
    step_trigger: Option<Trigger>,
    /// Resets and steps so far.
    episodes: u64,
    steps: u64,
    recording: Option<Recording>,
    /// Frames taken out of the environment's list, until `render` hands them over.
    list: Vec<Frame>,
    error: Option<Error>,
}

#[derive(Debug)]
struct Recording {
    video: VideoWriter,
    frames: u64,
}

impl<E: Env> RecordVideo<E> {
    /// Records `env` to a folder, which is made if it does not exist.
    ///
    /// # Errors
    /// [`Error::Io`] if the folder cannot be made, [`Error::UnsupportedMode`] if the spec of the
    /// environment has another render mode.
    pub fn new(env: E, folder: impl AsRef<Path>) -> Result<Self> {
        let mode = env.spec().and_then(|spec| spec.render_mode);
        if let Some(mode) = mode
            && mode.single() != gym_core::render::RenderMode::RgbArray
        {
            return Err(Error::UnsupportedMode {
                target: env.describe(),
                mode: "frames to record".into(),
                reason: format!(
                    "its render mode is {mode}: make it with `.render_mode(RenderMode::RgbArray)`"
                ),
            });
        }
        let folder = folder.as_ref();
        fs::create_dir_all(folder).map_err(|error| Error::io(folder, error))?;
        Ok(Self {
            fps: env.metadata().render_fps,
            env,
            folder: folder.to_owned(),
            name_prefix: "rl-video".into(),
            extension: "gif".into(),
            video_length: 0,
            is_clone: false,
            episode_trigger: None,
            step_trigger: None,
            episodes: 0,
            steps: 0,
            recording: None,
            list: Vec::new(),
            error: None,
        })
    }

    /// Records the episodes that `trigger` accepts, by their number.
    #[must_use]
    pub fn episode_trigger(mut self, trigger: impl FnMut(u64) -> bool + Send + 'static) -> Self {
        self.episode_trigger = Some(Box::new(trigger));
        self
    }

    /// Records from the steps that `trigger` accepts; and no episodes, unless there is a trigger for
    /// them too.
    #[must_use]
    pub fn step_trigger(mut self, trigger: impl FnMut(u64) -> bool + Send + 'static) -> Self {
        self.step_trigger = Some(Box::new(trigger));
        self
    }

    /// Ends each recording after that many frames; 0, the default, is the end of its episode.
    #[must_use]
    pub fn video_length(self, frames: u64) -> Self {
        Self { video_length: frames, ..self }
    }

    /// Starts the names of the files with this instead of `rl-video`.
    #[must_use]
    pub fn name_prefix(self, prefix: &str) -> Self {
        Self { name_prefix: prefix.to_owned(), ..self }
    }

    /// The format: `gif` by default, else one that [`VideoWriter`] knows.
    #[must_use]
    pub fn extension(self, extension: &str) -> Self {
        Self { extension: extension.to_owned(), ..self }
    }

    /// Plays at another speed than the environment's own.
    #[must_use]
    pub fn fps(self, fps: u32) -> Self {
        Self { fps, ..self }
    }

    /// Whether a recording is running.
    pub fn is_recording(&self) -> bool {
        self.recording.is_some()
    }

    /// Why the last recording was given up, if one was; asked again, nothing.
    pub fn take_error(&mut self) -> Option<Error> {
        self.error.take()
    }

    /// The environment within; a running recording ends.
    pub fn into_inner(mut self) -> E {
        self.stop();
        self.env
    }

    /// Records `env` as a spec says.
    fn from_kwargs(env: E, kwargs: &Kwargs) -> Result<Self> {
        let folder = kwargs.get("video_folder").and_then(|folder| folder.as_str());
        let folder = folder.ok_or_else(|| Error::argument(NAME, "it needs `video_folder`, a path"))?;
        let mut video = Self::new(env, folder)?;
        for (name, value) in kwargs {
            let number = value.as_u64();
            match (name.as_str(), value.as_str()) {
                ("video_folder", _) => {}
                ("name_prefix", Some(prefix)) => video.name_prefix = prefix.to_owned(),
                ("extension", Some(extension)) => video.extension = extension.to_owned(),
                ("video_length", _) if number.is_some() => video.video_length = number.unwrap_or_default(),
                ("fps", _) if value.is_null() => {}
                ("fps", _) if number.is_some_and(|fps| u32::try_from(fps).is_ok()) => {
                    video.fps = number.unwrap_or_default() as u32;
                }
                _ => {
                    let reason = format!(
                        "`{name}` cannot be {value}: its arguments are video_folder, video_length, name_prefix, fps \
                         and extension"
                    );
                    return Err(Error::argument(NAME, reason));
                }
            }
        }
        Ok(video)
    }

    /// Starts a recording where a trigger says so, in place of one that is running.
    fn start(&mut self, kind: &str, number: u64) {
        self.stop();
        let name = format!("{}-{kind}-{number}.{}", self.name_prefix, self.extension);
        match VideoWriter::create(self.folder.join(name), self.fps) {
            Ok(video) => self.recording = Some(Recording { video, frames: 0 }),
            Err(error) => self.give_up(error),
        }
    }

    /// Records the newest frame.
    fn capture(&mut self) -> Result<()> {
        let Some(recording) = &mut self.recording else { return Ok(()) };
        let (single, frame) = match self.env.render()? {
            Rendered::Frame(frame) => (Some(frame), None),
            Rendered::Frames(frames) => {
                self.list.extend(frames);
                (None, self.list.last())
            }
            other => return Err(not_frames(&self.env, &other)),
        };
        let Some(frame) = single.as_ref().or(frame) else { return Ok(()) };
        let written = recording.video.write(frame);
        recording.frames += 1;
        if let Err(error) = written {
            self.recording = None;
            self.give_up(error);
        } else if recording.frames == self.video_length {
            self.stop();
        }
        Ok(())
    }

    /// Completes the file of a running recording.
    fn stop(&mut self) {
        if let Some(Recording { video, frames: 1.. }) = self.recording.take()
            && let Err(error) = video.finish()
        {
            self.give_up(error);
        }
    }

    fn give_up(&mut self, error: Error) {
        log::warn!("RecordVideo: a recording was given up: {error}");
        self.error = Some(error);
    }
}

impl<E: Env> Env for RecordVideo<E> {
    type Observation = E::Observation;
    type Action = E::Action;

    fn reset_into(&mut self, reset: &Reset, observation: &mut E::Observation) -> Result<()> {
        self.env.reset_into(reset, observation)?;
        self.list.clear();
        if self.video_length == 0 {
            self.stop();
        }
        let episode = self.episodes;
        self.episodes += 1;
        let wanted = match (&mut self.episode_trigger, &self.step_trigger) {
            (Some(trigger), _) => trigger(episode),
            (None, Some(_)) => false,
            (None, None) => !self.is_clone && capped_cubic(episode),
        };
        if wanted {
            self.start("episode", episode);
        }
        self.capture()
    }

    fn step_into(&mut self, action: &E::Action, observation: &mut E::Observation) -> Result<Outcome> {
        let outcome = self.env.step_into(action, observation)?;
        let step = self.steps;
        self.steps += 1;
        if self.step_trigger.as_mut().is_some_and(|trigger| trigger(step)) {
            self.start("step", step);
        }
        self.capture()?;
        if outcome.done() && self.video_length == 0 {
            self.stop();
        }
        Ok(outcome)
    }

    fn render(&mut self) -> Result<Rendered> {
        Ok(match self.env.render()? {
            Rendered::Frames(frames) => {
                let mut list = std::mem::take(&mut self.list);
                list.extend(frames);
                Rendered::Frames(list)
            }
            other => other,
        })
    }

    fn restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        self.env.restore(snapshot)?;
        self.list.clear();
        Ok(())
    }

    fn spec(&self) -> Option<EnvSpec> {
        if self.episode_trigger.is_some() || self.step_trigger.is_some() {
            return None;
        }
        // a path that is not Unicode is no JSON
        let wrapper = WrapperSpec::new(NAME)
            .arg("video_folder", self.folder.to_str()?)
            .arg("video_length", self.video_length)
            .arg("name_prefix", self.name_prefix.as_str())
            .arg("fps", self.fps)
            .arg("extension", self.extension.as_str());
        self.env.spec().map(|spec| spec.wrapped(wrapper))
    }

    fn close(&mut self) {
        self.stop();
        self.env.close();
    }

    gym_core::forward!(
        env: observation_space, action_space, snapshot, info, metadata, draw, ansi, base, generator, describe
    );
}

impl<E: Env> Clone for RecordVideo<E> {
    fn clone(&self) -> Self {
        Self {
            env: self.env.clone(),
            folder: self.folder.clone(),
            name_prefix: self.name_prefix.clone(),
            extension: self.extension.clone(),
            fps: self.fps,
            video_length: self.video_length,
            is_clone: true,
            episode_trigger: None,
            step_trigger: None,
            episodes: self.episodes,
            steps: self.steps,
            recording: None,
            list: self.list.clone(),
            error: None,
        }
    }
}

impl<E: Env + fmt::Debug> fmt::Debug for RecordVideo<E> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("RecordVideo")
            .field("env", &self.env)
            .field("folder", &self.folder)
            .field("recording", &self.recording)
            .finish_non_exhaustive()
    }
}

/// Gymnasium's choice of episodes to record: 0, 1, 8, 27, and so on by cubes to 729, then each 1000th.
pub fn capped_cubic(episode: u64) -> bool {
    if episode < 1000 {
        (0..10).any(|root: u64| root.pow(3) == episode)
    } else {
        episode.is_multiple_of(1000)
    }
}
