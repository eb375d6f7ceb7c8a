//! Drawing and recording of environments, without window, C or system fonts.
//!
//! Linking this crate gives every environment the render mode `rgb_array`, and with the feature
//! `human` the mode of that name: it submits [`Raster`] as the
//! [`Painter`](gym_core::render::Painter) of `gym_core`. The rest writes frames and drawings to
//! files:
//!
//! | to get | use |
//! |---|---|
//! | one frame of a drawing | [`frame`] |
//! | frames as GIF, PNG or MP4, in a file or in memory | [`Video`], [`write_video`] |
//! | an environment, frame by frame | [`Recorder`] |
//! | episodes of an environment, or of a vector as a grid | [`RecordVideo`], [`RecordVectorVideo`] |
//! | images | [`write_png`], [`write_png_sequence`], [`contact_sheet`] |
//! | vector graphics | [`svg`], [`write_svg`] |
//! | returns and lengths of training runs | [`Plot`] |
//! | images in a notebook | [`Inline`], [`Plot`] |
//! | the calls of a drawing as text, to compare in tests | [`DrawLog`] |
//!
//! Every file is written under a temporary name and renamed when it is complete.
//!
//! ```
//! use gym_core::canvas::{Canvas, Color};
//!
//! let frame = gym_render::frame((4, 4), |canvas| {
//!     canvas.clear(Color::WHITE);
//!     canvas.rect([1.0, 1.0], [2.0, 2.0], Color::rgb(255, 0, 0));
//! })?;
//! assert_eq!(frame.pixels()[..3], [255, 255, 255]);
//! assert_eq!(frame.pixels()[(4 + 1) * 3..][..3], [255, 0, 0]);
//! # Ok::<(), gym_core::Error>(())
//! ```

mod apng;
mod changes;
mod downscale;
mod draw_log;
mod episode_recorder;
pub mod file;
mod font;
mod gif;
mod inline;
mod mode;
mod mp4;
mod number;
mod outline;
mod palette;
mod pixels;
mod plot;
mod png;
mod pygame;
mod raster;
mod record_vector_video;
mod record_video;
mod recorder;
mod skia;
mod svg;
#[cfg(test)]
mod testing;
mod transforms;
mod video;
#[cfg(feature = "human")]
mod window;

pub use draw_log::DrawLog;
pub use episode_recorder::{Config as RecordVideoConfig, capped_cubic};
pub use font::text_width;
pub use inline::Inline;
pub use plot::Plot;
pub use png::{contact_sheet, write_png, write_png_sequence};
pub use raster::{Raster, frame};
pub use record_vector_video::RecordVectorVideo;
pub use record_vector_video::arguments::Config as RecordVectorVideoConfig;
pub use record_video::RecordVideo;
pub use recorder::Recorder;
pub use svg::{Svg, svg, write_svg};
pub use video::{Video, VideoFormat, write_video};
#[cfg(feature = "human")]
pub use window::{Pointer, Window};

/// Compiles and runs the example of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
