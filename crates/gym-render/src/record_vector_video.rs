//! A wrapper that records a vector.

use std::fmt;

use gym_core::registry::WrapperConfig;
use gym_core::render::{Frame, Rendered};
use gym_core::vector::{Autoreset, Columns, Progress, VectorReset};
use gym_core::{Error, Result, Value, VectorEnv, WrapperSpec};

use crate::episode_recorder::EpisodeRecorder;
use crate::mode::{not_frames, require_frames};
use crate::png::tile;
use arguments::Config;

/// Records all sub-environments of a vector side by side, in a grid: Gymnasium's
/// `vector.RecordVideo`.
///
/// The sub-environments must have the render mode `rgb_array`. Episodes are those of the first
/// sub-environment. Everything else is as in [`RecordVideo`](crate::RecordVideo). With
/// [`Autoreset::SameStep`](gym_core::vector::Autoreset::SameStep) the video lacks the last state of
/// an episode.
///
/// ```no_run
/// use gym_core::{Result, builder, render::RenderMode};
/// use gym_render::{RecordVectorVideo, RecordVectorVideoConfig};
///
/// # fn main() -> Result<()> {
/// let envs = builder("CartPole-v1").render_mode(RenderMode::RgbArray).vector(9).build()?;
/// let config = RecordVectorVideoConfig { video_aspect_ratio: 16.0 / 9.0, ..From::from("videos") };
/// let mut envs = RecordVectorVideo::new(envs, config)?;
/// # Ok(())
/// # }
/// ```
pub struct RecordVectorVideo<V = Box<dyn VectorEnv>> {
    envs: V,
    recorder: EpisodeRecorder,
    aspect_ratio: f64,
    first_only: bool,
}

/// The arguments of [`RecordVectorVideo`].
pub(crate) mod arguments {
    use std::path::Path;

    use crate::RecordVectorVideo;
    use crate::episode_recorder::Config as Common;

    gym_core::arguments! {
        /// The arguments of [`RecordVectorVideo`].
        pub struct Config {
            /// The arguments that a single environment has, too.
            #[flatten]
            pub common: Common,
            /// The ratio of the grid's width to its height, approximately.
            pub video_aspect_ratio: f64 = 1.0,
            /// Whether to record only the first sub-environment.
            pub record_first_only: bool = false,
        }
    }

    impl<P: AsRef<Path>> From<P> for Config {
        /// The default arguments, with this folder.
        fn from(folder: P) -> Self {
            Self {
                common: folder.into(),
                ..Self::default()
            }
        }
    }

    gym_core::register_wrapper!(
        "RecordVideo", "records all sub-environments in a grid", Config, vector: RecordVectorVideo::new
    );
}

impl<V: VectorEnv> RecordVectorVideo<V> {
    /// Records `envs`. `config` is the folder for the files, or a
    /// [`RecordVectorVideoConfig`](crate::RecordVectorVideoConfig) with all arguments.
    ///
    /// # Errors
    /// [`Error::Io`] if the folder cannot be created, [`Error::UnsupportedMode`] if the spec of the
    /// sub-environments has no render mode, or one without frames.
    pub fn new(envs: V, config: impl Into<Config>) -> Result<Self> {
        if let Some(spec) = envs.spec() {
            require_frames(envs.describe(), spec.env.render_mode)?;
        }
        let Config {
            common,
            video_aspect_ratio: aspect_ratio,
            record_first_only: first_only,
        } = config.into();
        let recorder = EpisodeRecorder::new(common, envs.metadata().render_fps)?;
        Ok(Self {
            envs,
            recorder,
            aspect_ratio,
            first_only,
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

    /// Returns the inner vector.
    pub fn get_ref(&self) -> &V {
        &self.envs
    }

    /// Returns the inner vector for changes. The wrapper does not notice resets and steps of it.
    pub fn get_mut(&mut self) -> &mut V {
        &mut self.envs
    }

    /// Ends a running recording and returns the inner vector.
    pub fn into_inner(mut self) -> V {
        self.recorder.stop();
        self.envs
    }

    /// Records the newest frame of each sub-environment.
    fn capture(&mut self) -> Result<()> {
        if !self.is_recording() {
            return Ok(());
        }
        let mut rendered = self.envs.render()?;
        let frame = |rendered| match rendered {
            Rendered::Frame(frame) => Ok(frame),
            other => Err(not_frames(self.envs.describe(), &other)),
        };
        rendered.truncate(if self.first_only { 1 } else { usize::MAX });
        let frames = rendered
            .into_iter()
            .map(frame)
            .collect::<Result<Vec<Frame>>>()?;
        self.recorder
            .write(&tile(&frames, columns(&frames, self.aspect_ratio), 0)?);
        Ok(())
    }
}

/// Returns the number of columns of the grid without empty cells whose aspect ratio is nearest to
/// `aspect_ratio`. As in Gymnasium's `_get_concat_frame_shape`, the grid has no more rows than
/// columns.
fn columns(frames: &[Frame], aspect_ratio: f64) -> usize {
    let n = frames.len();
    let Some(first) = frames.first() else {
        return 1;
    };
    let [width, height] = [first.width(), first.height()].map(f64::from);
    let distance = |columns: usize| {
        let rows = (n / columns) as f64;
        (columns as f64 * width / (rows * height) - aspect_ratio).abs()
    };
    let grids = (1..=n)
        .filter(|rows| n.is_multiple_of(*rows) && rows * rows <= n)
        .map(|rows| n / rows);
    grids
        .min_by(|a, b| distance(*a).total_cmp(&distance(*b)))
        .unwrap_or(n)
}

impl<V: VectorEnv> gym_core::VectorWrapper for RecordVectorVideo<V> {
    fn inner(&self) -> &dyn VectorEnv {
        &self.envs
    }

    fn inner_mut(&mut self) -> &mut dyn VectorEnv {
        &mut self.envs
    }

    fn name(&self) -> &'static str {
        Config::NAME
    }

    fn wrapper_spec(&self) -> Option<WrapperSpec> {
        let (video_aspect_ratio, record_first_only) = (self.aspect_ratio, self.first_only);
        Some(
            Config {
                common: self.recorder.stored()?,
                video_aspect_ratio,
                record_first_only,
            }
            .spec(),
        )
    }

    fn on_reset(&mut self, reset: &VectorReset, columns: &mut Columns) -> Result<()> {
        columns.begin();
        let result = self.envs.reset_into(reset, columns);
        if columns.progress.first() == Some(&Progress::Started) {
            self.recorder.episode();
        }
        if columns.any_progress() {
            result.and(self.capture())
        } else {
            result
        }
    }

    fn on_step(&mut self, actions: &Value, columns: &mut Columns) -> Result<()> {
        columns.begin();
        let result = self.envs.step_into(actions, columns);
        if !columns.any_progress() {
            return result;
        }
        let done = columns.done(0);
        let same_step = self.envs.autoreset() == Autoreset::SameStep;
        let began = columns.progress[0] == Progress::Started || done && same_step;
        if began {
            self.recorder.episode();
        }
        self.recorder.step();
        let captured = self.capture();
        if done && !began {
            self.recorder.end_of_episode();
        }
        result.and(captured)
    }

    fn on_close(&mut self) {
        self.recorder.stop();
        self.envs.close();
    }
}

impl<V: fmt::Debug> fmt::Debug for RecordVectorVideo<V> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("RecordVectorVideo")
            .field("envs", &self.envs)
            .field("folder", &self.recorder.config.video_folder)
            .field("recording", &self.recorder.is_recording())
            .finish_non_exhaustive()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn grids_are_gymnasiums() {
        // `_get_concat_frame_shape` of Gymnasium 1.4.0
        let cases = [
            (1, 600, 400, 1.0, 1),
            (4, 400, 400, 1.0, 2),
            (9, 400, 400, 1.0, 3),
            (9, 400, 400, 8.0, 9),
            (6, 600, 400, 1.0, 3),
            (6, 256, 256, 16.0 / 9.0, 3),
            (8, 600, 400, 1.0, 4),
        ];
        for (n, width, height, aspect_ratio, expected) in cases {
            assert_eq!(
                columns(&vec![Frame::new(width, height).unwrap(); n], aspect_ratio),
                expected,
                "{n}"
            );
        }
        assert_eq!(columns(&vec![Frame::new(10, 10).unwrap(); 7], 1.0), 7);
    }
}
