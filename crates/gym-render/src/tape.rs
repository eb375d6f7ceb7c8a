//! Triggers and writing of videos, shared by the recorders of environments and vectors.

use std::fs;
use std::path::PathBuf;

use gym_core::render::Frame;
use gym_core::{Error, Result};

use crate::VideoWriter;

/// Whether to record, by the number of the episode or of the step.
pub(crate) type Trigger = Box<dyn FnMut(u64) -> bool + Send>;

gym_core::arguments! {
    /// The arguments of [`RecordVideo`](crate::RecordVideo).
    pub struct Config {
        /// The folder, which is made if it does not exist.
        pub video_folder: PathBuf,
        /// The number of frames after which a recording ends; 0 for the end of its episode.
        pub video_length: u64 = 0,
        /// The start of the file names.
        pub name_prefix: String = "rl-video".into(),
        /// Frames per second, if not the environment's own.
        pub fps: Option<u32>,
        /// The format: an extension of [`VideoWriter`](crate::VideoWriter).
        pub extension: String = "gif".into(),
    }
}

/// Triggers, counters, and the recording that is running.
pub(crate) struct Tape {
    pub(crate) config: Config,
    /// The environment's frames per second.
    fps: u32,
    pub(crate) is_clone: bool,
    pub(crate) episode_trigger: Option<Trigger>,
    pub(crate) step_trigger: Option<Trigger>,
    /// Episodes and steps so far.
    episodes: u64,
    steps: u64,
    pub(crate) recording: Option<Recording>,
    pub(crate) error: Option<Error>,
}

#[derive(Debug)]
pub(crate) struct Recording {
    video: VideoWriter,
    frames: u64,
}

impl Tape {
    /// Makes the folder if it does not exist.
    pub(crate) fn new(config: Config, fps: u32) -> Result<Self> {
        fs::create_dir_all(&config.video_folder)
            .map_err(|error| Error::io(&config.video_folder, error))?;
        Ok(Self {
            config,
            fps,
            is_clone: false,
            episode_trigger: None,
            step_trigger: None,
            episodes: 0,
            steps: 0,
            recording: None,
            error: None,
        })
    }

    /// The arguments, if they have a stored form: a trigger, which is a function, and a path that
    /// is not Unicode have none.
    pub(crate) fn stored(&self) -> Option<Config> {
        let stored = self.episode_trigger.is_none() && self.step_trigger.is_none();
        (stored && self.config.video_folder.to_str().is_some()).then(|| self.config.clone())
    }

    /// An episode begins: starts a recording if it is wanted.
    pub(crate) fn episode(&mut self) {
        if self.config.video_length == 0 {
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
    }

    /// A step was taken: starts a recording if it is wanted.
    pub(crate) fn step(&mut self) {
        let step = self.steps;
        self.steps += 1;
        if self
            .step_trigger
            .as_mut()
            .is_some_and(|trigger| trigger(step))
        {
            self.start("step", step);
        }
    }

    /// The episode has ended.
    pub(crate) fn end_of_episode(&mut self) {
        if self.config.video_length == 0 {
            self.stop();
        }
    }

    /// Starts a recording in place of one that is running.
    fn start(&mut self, kind: &str, number: u64) {
        self.stop();
        let Config {
            video_folder,
            name_prefix,
            fps,
            extension,
            ..
        } = &self.config;
        let path = video_folder.join(format!("{name_prefix}-{kind}-{number}.{extension}"));
        match VideoWriter::create(path, fps.unwrap_or(self.fps)) {
            Ok(video) => self.recording = Some(Recording { video, frames: 0 }),
            Err(error) => self.give_up(error),
        }
    }

    /// Records a frame.
    pub(crate) fn write(&mut self, frame: &Frame) {
        let Some(recording) = &mut self.recording else {
            return;
        };
        let written = recording.video.write(frame);
        recording.frames += 1;
        if let Err(error) = written {
            self.recording = None;
            self.give_up(error);
        } else if recording.frames == self.config.video_length {
            self.stop();
        }
    }

    /// Completes the file of a running recording.
    pub(crate) fn stop(&mut self) {
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

/// A clone does not record.
impl Clone for Tape {
    fn clone(&self) -> Self {
        Self {
            config: self.config.clone(),
            fps: self.fps,
            is_clone: true,
            episode_trigger: None,
            step_trigger: None,
            episodes: self.episodes,
            steps: self.steps,
            recording: None,
            error: None,
        }
    }
}

/// Gymnasium's choice of episodes to record: 0, 1, 8, 27, and so on by cubes to 729, then each
/// 1000th.
pub fn capped_cubic(episode: u64) -> bool {
    if episode < 1000 {
        (0..10).any(|root: u64| root.pow(3) == episode)
    } else {
        episode.is_multiple_of(1000)
    }
}

/// The options of a recorder whose field `tape` is a [`Tape`].
macro_rules! tape_options {
    () => {
        /// Records the episodes that `trigger` accepts, by their number.
        #[must_use]
        pub fn episode_trigger(
            mut self,
            trigger: impl FnMut(u64) -> bool + Send + 'static,
        ) -> Self {
            self.tape.episode_trigger = Some(Box::new(trigger));
            self
        }

        /// Records from the steps that `trigger` accepts; and no episodes, unless there is an
        /// episode trigger too.
        #[must_use]
        pub fn step_trigger(mut self, trigger: impl FnMut(u64) -> bool + Send + 'static) -> Self {
            self.tape.step_trigger = Some(Box::new(trigger));
            self
        }

        /// Ends each recording after that many frames; 0, the default, is the end of its episode.
        #[must_use]
        pub fn video_length(mut self, frames: u64) -> Self {
            self.tape.config.video_length = frames;
            self
        }

        /// Starts the names of the files with this instead of `rl-video`.
        #[must_use]
        pub fn name_prefix(mut self, prefix: &str) -> Self {
            self.tape.config.name_prefix = prefix.to_owned();
            self
        }

        /// The format: `gif` by default, or another extension of
        /// [`VideoWriter`](crate::VideoWriter).
        #[must_use]
        pub fn extension(mut self, extension: &str) -> Self {
            self.tape.config.extension = extension.to_owned();
            self
        }

        /// Plays at another speed than the environment's own.
        #[must_use]
        pub fn fps(mut self, fps: u32) -> Self {
            self.tape.config.fps = Some(fps);
            self
        }

        /// Whether a recording is running.
        pub fn is_recording(&self) -> bool {
            self.tape.recording.is_some()
        }

        /// Takes the error that ended the last recording, if any.
        pub fn take_error(&mut self) -> Option<Error> {
            self.tape.error.take()
        }
    };
}
pub(crate) use tape_options;
