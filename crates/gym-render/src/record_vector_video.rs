//! A wrapper that records a vector.

use std::fmt;
use std::path::Path;

use gym_core::registry::WrapperConfig;
use gym_core::render::{Frame, Rendered};
use gym_core::vector::{Autoreset, Columns, Progress, VectorReset};
use gym_core::{Error, Result, Value, VectorEnv, WrapperSpec};

use crate::png::tile;
use crate::recorder::{check_known_mode, not_frames};
use crate::tape::{Config as Common, Tape, tape_options};
use arguments::Config;

/// Records all sub-environments of a vector side by side, in a grid: Gymnasium's
/// `vector.RecordVideo`.
///
/// The sub-environments must have the render mode `rgb_array`. The episodes are those of the first
/// one; otherwise it is as [`RecordVideo`](crate::RecordVideo). With
/// [`Autoreset::SameStep`](gym_core::vector::Autoreset::SameStep) the video lacks the last state of
/// an episode.
///
/// ```no_run
/// use gym_core::{Result, builder, render::RenderMode};
/// use gym_render::RecordVectorVideo;
///
/// # fn main() -> Result<()> {
/// let envs = builder("CartPole-v1").render_mode(RenderMode::RgbArray).vector(9).build()?;
/// let mut envs = RecordVectorVideo::new(envs, "videos")?.aspect_ratio(16.0 / 9.0);
/// # Ok(())
/// # }
/// ```
pub struct RecordVectorVideo<V = Box<dyn VectorEnv>> {
    envs: V,
    tape: Tape,
    aspect_ratio: f64,
    first_only: bool,
}

/// The arguments of [`RecordVectorVideo`].
pub(crate) mod arguments {
    use crate::RecordVectorVideo;
    use crate::tape::Config as Common;

    gym_core::arguments! {
        /// The arguments of [`RecordVectorVideo`].
        pub struct Config {
            /// The arguments of a single environment.
            #[flatten]
            pub common: Common,
            /// The ratio of the grid's width to its height, approximately.
            pub video_aspect_ratio: f64 = 1.0,
            /// Whether only the first sub-environment is recorded.
            pub record_first_only: bool = false,
        }
    }

    gym_core::register_wrapper!(
        "RecordVideo", "records all sub-environments in a grid", Config, vector: RecordVectorVideo::with_config
    );
}

impl<V: VectorEnv> RecordVectorVideo<V> {
    /// Records `envs` to a folder, which is made if it does not exist.
    ///
    /// # Errors
    /// [`Error::Io`] if the folder cannot be made, [`Error::UnsupportedMode`] if the spec of the
    /// sub-environments has no render mode, or one without frames.
    pub fn new(envs: V, folder: impl AsRef<Path>) -> Result<Self> {
        let common = Common {
            video_folder: folder.as_ref().to_owned(),
            ..Common::default()
        };
        Self::with_config(
            envs,
            Config {
                common,
                ..Config::default()
            },
        )
    }

    /// Records `envs` with all arguments at once.
    ///
    /// # Errors
    /// The errors of [`new`](Self::new).
    pub fn with_config(envs: V, config: Config) -> Result<Self> {
        if let Some(spec) = envs.spec() {
            check_known_mode(envs.describe(), spec.env.render_mode)?;
        }
        let Config {
            common,
            video_aspect_ratio: aspect_ratio,
            record_first_only: first_only,
        } = config;
        let tape = Tape::new(common, envs.metadata().render_fps)?;
        Ok(Self {
            envs,
            tape,
            aspect_ratio,
            first_only,
        })
    }

    tape_options!();

    /// Sets the ratio of the grid's width to its height, approximately; the default is 1.
    #[must_use]
    pub fn aspect_ratio(self, aspect_ratio: f64) -> Self {
        Self {
            aspect_ratio,
            ..self
        }
    }

    /// Records only the first sub-environment.
    #[must_use]
    pub fn first_only(self) -> Self {
        Self {
            first_only: true,
            ..self
        }
    }

    /// The inner vector.
    pub fn get_ref(&self) -> &V {
        &self.envs
    }

    /// The inner vector, mutable. The wrapper does not see resets and steps made through it.
    pub fn get_mut(&mut self) -> &mut V {
        &mut self.envs
    }

    /// The inner vector; a running recording ends.
    pub fn into_inner(mut self) -> V {
        self.tape.stop();
        self.envs
    }

    /// Records the newest frame of each.
    fn capture(&mut self) -> Result<()> {
        if !self.is_recording() {
            return Ok(());
        }
        let mut rendered = self.envs.render()?;
        let frame = |rendered| match rendered {
            Rendered::Frame(frame) => Ok(frame),
            other => Err(not_frames(&self.envs.describe(), &other)),
        };
        rendered.truncate(if self.first_only { 1 } else { usize::MAX });
        let frames = rendered
            .into_iter()
            .map(frame)
            .collect::<Result<Vec<Frame>>>()?;
        self.tape
            .write(&tile(&frames, columns(&frames, self.aspect_ratio), 0)?);
        Ok(())
    }
}

/// The number of columns that gives a full grid the aspect ratio nearest to one: Gymnasium's
/// `_get_concat_frame_shape`, which has no more rows than columns.
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
                common: self.tape.stored()?,
                video_aspect_ratio,
                record_first_only,
            }
            .spec(),
        )
    }

    fn reset_into(&mut self, reset: &VectorReset, columns: &mut Columns) -> Result<()> {
        columns.begin();
        let result = self.envs.reset_into(reset, columns);
        if columns.progress.first() == Some(&Progress::Started) {
            self.tape.episode();
        }
        if columns.any_progress() {
            result.and(self.capture())
        } else {
            result
        }
    }

    fn step_into(&mut self, actions: &Value, columns: &mut Columns) -> Result<()> {
        columns.begin();
        let result = self.envs.step_into(actions, columns);
        if !columns.any_progress() {
            return result;
        }
        let done = columns.done(0);
        let same_step = self.envs.autoreset() == Autoreset::SameStep;
        let began = columns.progress[0] == Progress::Started || done && same_step;
        if began {
            self.tape.episode();
        }
        self.tape.step();
        let captured = self.capture();
        if done && !began {
            self.tape.end_of_episode();
        }
        result.and(captured)
    }

    fn close(&mut self) {
        self.tape.stop();
        self.envs.close();
    }
}

impl<V: fmt::Debug> fmt::Debug for RecordVectorVideo<V> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("RecordVectorVideo")
            .field("envs", &self.envs)
            .field("folder", &self.tape.config.video_folder)
            .field("recording", &self.tape.recording)
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
