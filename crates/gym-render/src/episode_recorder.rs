//! Decides which episodes to record and records them, for environments and vectors.

use std::fs;
use std::path::{Path, PathBuf};

use gym_core::render::Frame;
use gym_core::{Error, Result};

use crate::Video;

/// Decides by the number of an episode or step whether to record it.
pub(crate) type Trigger = Box<dyn FnMut(u64) -> bool + Send>;

gym_core::arguments! {
    /// The arguments of [`RecordVideo`](crate::RecordVideo).
    pub struct Config {
        /// The folder, which is created if it does not exist.
        pub video_folder: PathBuf,
        /// The number of frames of a recording; 0 records to the end of the episode.
        pub video_length: u64 = 0,
        /// The start of the file names.
        pub name_prefix: String = "rl-video".into(),
        /// Frames per second; by default the environment's own.
        pub fps: Option<u32>,
        /// The extension of the files, which selects the format: `gif`, `png`, `apng` or `mp4`.
        pub extension: String = "gif".into(),
    }
}

impl<P: AsRef<Path>> From<P> for Config {
    /// The default arguments, with this folder.
    fn from(folder: P) -> Self {
        Self {
            video_folder: folder.as_ref().to_owned(),
            ..Self::default()
        }
    }
}

/// The triggers, the counters, and the current recording.
pub(crate) struct EpisodeRecorder {
    pub(crate) config: Config,
    /// The environment's frames per second.
    fps: u32,
    is_clone: bool,
    pub(crate) episode_trigger: Option<Trigger>,
    pub(crate) step_trigger: Option<Trigger>,
    /// The numbers of episodes and steps so far.
    episodes: u64,
    steps: u64,
    running: Option<Running>,
    error: Option<Error>,
}

/// The current recording.
#[derive(Debug)]
struct Running {
    video: Video,
    frames: u64,
}

impl EpisodeRecorder {
    /// Creates the folder if it does not exist.
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
            running: None,
            error: None,
        })
    }

    /// Returns the arguments, if they can be stored. A trigger is a function, which cannot be
    /// stored; neither can a path that is not Unicode.
    pub(crate) fn stored(&self) -> Option<Config> {
        let stored = self.episode_trigger.is_none() && self.step_trigger.is_none();
        (stored && self.config.video_folder.to_str().is_some()).then(|| self.config.clone())
    }

    /// Begins an episode: starts a recording if the episode trigger accepts the episode.
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

    /// Counts a step: starts a recording if the step trigger accepts the step.
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

    /// Ends an episode.
    pub(crate) fn end_of_episode(&mut self) {
        if self.config.video_length == 0 {
            self.stop();
        }
    }

    /// Starts a recording; ends the current one.
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
        match Video::create(path, fps.unwrap_or(self.fps)) {
            Ok(video) => self.running = Some(Running { video, frames: 0 }),
            Err(error) => self.give_up(error),
        }
    }

    /// Records a frame.
    pub(crate) fn write(&mut self, frame: &Frame) {
        let Some(running) = &mut self.running else {
            return;
        };
        let written = running.video.write(frame);
        running.frames += 1;
        if let Err(error) = written {
            self.running = None;
            self.give_up(error);
        } else if running.frames == self.config.video_length {
            self.stop();
        }
    }

    /// Completes the file of the current recording.
    pub(crate) fn stop(&mut self) {
        if let Some(Running { video, frames: 1.. }) = self.running.take()
            && let Err(error) = video.finish()
        {
            self.give_up(error);
        }
    }

    /// Whether a recording is running.
    pub(crate) fn is_recording(&self) -> bool {
        self.running.is_some()
    }

    /// Takes the error that ended the last recording, if any.
    pub(crate) fn take_error(&mut self) -> Option<Error> {
        self.error.take()
    }

    fn give_up(&mut self, error: Error) {
        log::warn!("RecordVideo: a recording was given up: {error}");
        self.error = Some(error);
    }
}

/// A clone records nothing, because two recorders cannot write one file.
impl Clone for EpisodeRecorder {
    fn clone(&self) -> Self {
        Self {
            config: self.config.clone(),
            fps: self.fps,
            is_clone: true,
            episode_trigger: None,
            step_trigger: None,
            episodes: self.episodes,
            steps: self.steps,
            running: None,
            error: None,
        }
    }
}

/// Gymnasium's default choice of episodes to record: 0, 1, 8, 27 and further cubes up to 729, then
/// every 1000th.
pub fn capped_cubic(episode: u64) -> bool {
    if episode < 1000 {
        (0..10).any(|root: u64| root.pow(3) == episode)
    } else {
        episode.is_multiple_of(1000)
    }
}
