//! What decides when a video is recorded, and writes it: shared by the recorders of one environment and of
//! vectors.

use std::fs;
use std::path::{Path, PathBuf};

use gym_core::render::Frame;
use gym_core::{Error, Kwargs, Result, WrapperSpec};

use crate::VideoWriter;

/// Whether to record, by the number of the episode or of the step.
pub(crate) type Trigger = Box<dyn FnMut(u64) -> bool + Send>;

/// Triggers, counters, and the recording that is running.
pub(crate) struct Tape {
    pub(crate) folder: PathBuf,
    pub(crate) name_prefix: String,
    pub(crate) extension: String,
    pub(crate) fps: u32,
    pub(crate) video_length: u64,
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
    pub(crate) fn new(folder: &Path, fps: u32) -> Result<Self> {
        fs::create_dir_all(folder).map_err(|error| Error::io(folder, error))?;
        Ok(Self {
            folder: folder.to_owned(),
            name_prefix: "rl-video".into(),
            extension: "gif".into(),
            fps,
            video_length: 0,
            is_clone: false,
            episode_trigger: None,
            step_trigger: None,
            episodes: 0,
            steps: 0,
            recording: None,
            error: None,
        })
    }

    /// Takes the arguments of a spec, but for the folder.
    pub(crate) fn configure(&mut self, kwargs: &Kwargs) -> Result<()> {
        for (name, value) in kwargs {
            let number = value.as_u64();
            match (name.as_str(), value.as_str()) {
                ("video_folder", _) => {}
                ("name_prefix", Some(prefix)) => self.name_prefix = prefix.to_owned(),
                ("extension", Some(extension)) => self.extension = extension.to_owned(),
                ("video_length", _) if number.is_some() => self.video_length = number.unwrap_or_default(),
                ("fps", _) if value.is_null() => {}
                ("fps", _) if number.is_some_and(|fps| u32::try_from(fps).is_ok()) => {
                    self.fps = number.unwrap_or_default() as u32;
                }
                _ => {
                    let reason = format!(
                        "`{name}` cannot be {value}: its arguments are video_folder, video_length, name_prefix, fps \
                         and extension"
                    );
                    return Err(Error::argument("RecordVideo", reason));
                }
            }
        }
        Ok(())
    }

    /// The arguments as a spec holds them; `None` with a trigger, which is a function.
    pub(crate) fn wrapper_spec(&self, name: &str) -> Option<WrapperSpec> {
        if self.episode_trigger.is_some() || self.step_trigger.is_some() {
            return None;
        }
        // a path that is not Unicode is no JSON
        let wrapper = WrapperSpec::new(name)
            .arg("video_folder", self.folder.to_str()?)
            .arg("video_length", self.video_length)
            .arg("name_prefix", self.name_prefix.as_str())
            .arg("fps", self.fps)
            .arg("extension", self.extension.as_str());
        Some(wrapper)
    }

    /// An episode begins: starts a recording if it is wanted.
    pub(crate) fn episode(&mut self) {
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
    }

    /// A step was taken: starts a recording if it is wanted.
    pub(crate) fn step(&mut self) {
        let step = self.steps;
        self.steps += 1;
        if self.step_trigger.as_mut().is_some_and(|trigger| trigger(step)) {
            self.start("step", step);
        }
    }

    /// The episode has ended.
    pub(crate) fn end_of_episode(&mut self) {
        if self.video_length == 0 {
            self.stop();
        }
    }

    /// Starts a recording in place of one that is running.
    fn start(&mut self, kind: &str, number: u64) {
        self.stop();
        let name = format!("{}-{kind}-{number}.{}", self.name_prefix, self.extension);
        match VideoWriter::create(self.folder.join(name), self.fps) {
            Ok(video) => self.recording = Some(Recording { video, frames: 0 }),
            Err(error) => self.give_up(error),
        }
    }

    /// Records a frame.
    pub(crate) fn write(&mut self, frame: &Frame) {
        let Some(recording) = &mut self.recording else { return };
        let written = recording.video.write(frame);
        recording.frames += 1;
        if let Err(error) = written {
            self.recording = None;
            self.give_up(error);
        } else if recording.frames == self.video_length {
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
            error: None,
        }
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

/// The options of a recorder whose field `tape` is a [`Tape`].
macro_rules! tape_options {
    () => {
        /// Records the episodes that `trigger` accepts, by their number.
        #[must_use]
        pub fn episode_trigger(mut self, trigger: impl FnMut(u64) -> bool + Send + 'static) -> Self {
            self.tape.episode_trigger = Some(Box::new(trigger));
            self
        }

        /// Records from the steps that `trigger` accepts; and no episodes, unless there is a trigger for
        /// them too.
        #[must_use]
        pub fn step_trigger(mut self, trigger: impl FnMut(u64) -> bool + Send + 'static) -> Self {
            self.tape.step_trigger = Some(Box::new(trigger));
            self
        }

        /// Ends each recording after that many frames; 0, the default, is the end of its episode.
        #[must_use]
        pub fn video_length(mut self, frames: u64) -> Self {
            self.tape.video_length = frames;
            self
        }

        /// Starts the names of the files with this instead of `rl-video`.
        #[must_use]
        pub fn name_prefix(mut self, prefix: &str) -> Self {
            self.tape.name_prefix = prefix.to_owned();
            self
        }

        /// The format: `gif` by default, else one that [`VideoWriter`](crate::VideoWriter) knows.
        #[must_use]
        pub fn extension(mut self, extension: &str) -> Self {
            self.tape.extension = extension.to_owned();
            self
        }

        /// Plays at another speed than the environment's own.
        #[must_use]
        pub fn fps(mut self, fps: u32) -> Self {
            self.tape.fps = fps;
            self
        }

        /// Whether a recording is running.
        pub fn is_recording(&self) -> bool {
            self.tape.recording.is_some()
        }

        /// Why the last recording was given up, if one was; asked again, nothing.
        pub fn take_error(&mut self) -> Option<Error> {
            self.tape.error.take()
        }
    };
}
pub(crate) use tape_options;
