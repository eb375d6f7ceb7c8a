//! Render modes, frames, and the painter that a rendering crate provides at link time.
//!
//! `gym-render` submits its painter as a [`PainterProvider`]. Without it, `make` with a render mode
//! is an error that says to link it.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

use crate::drawing::canvas::Canvas;
use crate::value::error::quoted;
use crate::value::{DType, Data, Error, Result};

/// Render modes, under Gymnasium's names.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum RenderMode {
    /// A live window; `render` returns nothing.
    Human,
    /// `render` returns the current frame.
    RgbArray,
    /// Each reset and step collects a frame; `render` returns them all.
    RgbArrayList,
    /// `render` returns the current state as text with terminal colours.
    Ansi,
    /// Each reset and step collects a text; `render` returns them all.
    AnsiList,
    /// `render` returns how far the surfaces of the current frame are.
    DepthArray,
    /// `render` returns the current frame and its depths.
    RgbdTuple,
}

impl RenderMode {
    /// Every mode.
    pub const ALL: [Self; 7] = [
        Self::Human,
        Self::RgbArray,
        Self::RgbArrayList,
        Self::Ansi,
        Self::AnsiList,
        Self::DepthArray,
        Self::RgbdTuple,
    ];

    /// Gymnasium's name, as in `rgb_array`.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Human => "human",
            Self::RgbArray => "rgb_array",
            Self::RgbArrayList => "rgb_array_list",
            Self::Ansi => "ansi",
            Self::AnsiList => "ansi_list",
            Self::DepthArray => "depth_array",
            Self::RgbdTuple => "rgbd_tuple",
        }
    }

    /// The mode of a single item, for a list mode; otherwise the mode itself.
    pub const fn single(self) -> Self {
        match self {
            Self::RgbArrayList => Self::RgbArray,
            Self::AnsiList => Self::Ansi,
            other => other,
        }
    }

    /// Whether this is a list mode.
    pub fn is_list(self) -> bool {
        self.single() != self
    }
}

impl fmt::Display for RenderMode {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl FromStr for RenderMode {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        Self::ALL
            .into_iter()
            .find(|mode| mode.name() == text)
            .ok_or_else(|| {
                let names = Self::ALL.map(Self::name).join(", ");
                Error::argument(
                    "render_mode",
                    format!("unknown mode `{}`: the modes are {names}", quoted(text)),
                )
            })
    }
}

/// An environment's render modes, frame rate and frame size.
#[derive(Clone, Debug, PartialEq)]
pub struct Metadata {
    /// The modes of [`render`](crate::EnvExt::render); empty if there are none. Their `_list` forms
    /// are implied.
    pub render_modes: &'static [RenderMode],
    /// Frames per second at which the motion has its natural speed.
    pub render_fps: u32,
    /// Width and height of the frame of [`draw`](crate::Env::draw), in pixels.
    pub render_size: (u32, u32),
}

impl Metadata {
    /// Drawn, without a text form.
    pub const fn drawn(render_fps: u32, render_size: (u32, u32)) -> Self {
        Self {
            render_modes: &[RenderMode::Human, RenderMode::RgbArray],
            render_fps,
            render_size,
        }
    }

    /// Drawn, and with depths.
    pub const fn drawn_and_depth(render_fps: u32, render_size: (u32, u32)) -> Self {
        Self {
            render_modes: &[
                RenderMode::Human,
                RenderMode::RgbArray,
                RenderMode::DepthArray,
                RenderMode::RgbdTuple,
            ],
            render_fps,
            render_size,
        }
    }

    /// Drawn, and with a text form.
    pub const fn drawn_and_text(render_fps: u32, render_size: (u32, u32)) -> Self {
        Self {
            render_modes: &[RenderMode::Human, RenderMode::Ansi, RenderMode::RgbArray],
            render_fps,
            render_size,
        }
    }
}

impl Default for Metadata {
    /// No render modes.
    fn default() -> Self {
        Self {
            render_modes: &[],
            render_fps: 30,
            render_size: (600, 400),
        }
    }
}

/// An image: 8-bit red, green, blue.
#[derive(Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "StoredFrame")]
pub struct Frame {
    width: u32,
    height: u32,
    pixels: Vec<u8>,
}

/// A [`Frame`] read from outside, whose pixels need not fit its size.
#[derive(Deserialize)]
struct StoredFrame {
    width: u32,
    height: u32,
    pixels: Vec<u8>,
}

impl TryFrom<StoredFrame> for Frame {
    type Error = Error;

    fn try_from(stored: StoredFrame) -> Result<Self> {
        let StoredFrame {
            width,
            height,
            pixels,
        } = stored;
        let bytes = u128::from(width) * u128::from(height) * 3;
        if pixels.len() as u128 != bytes {
            return Err(Error::custom(format!(
                "a frame of {width}x{height} has {} bytes of pixels: it needs {bytes}, 3 for each pixel",
                pixels.len()
            )));
        }
        Ok(Self {
            width,
            height,
            pixels,
        })
    }
}

impl Frame {
    /// A black picture.
    ///
    /// # Errors
    /// [`Error::Custom`] if the pixels do not fit in memory.
    pub fn new(width: u32, height: u32) -> Result<Self> {
        let bytes = usize::try_from(u128::from(width) * u128::from(height) * 3).ok();
        match bytes.and_then(|bytes| Data::zeros(DType::U8, bytes)) {
            Some(Data::U8(pixels)) => Ok(Self {
                width,
                height,
                pixels,
            }),
            _ => Err(Error::custom(format!(
                "a frame of {width}x{height} does not fit in memory"
            ))),
        }
    }

    /// Width in pixels.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Height in pixels.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// Red, green and blue of each pixel, row by row from the top: Gymnasium's array of shape
    /// `(height, width, 3)`.
    pub fn pixels(&self) -> &[u8] {
        &self.pixels
    }

    /// The pixels, to change them.
    pub fn pixels_mut(&mut self) -> &mut [u8] {
        &mut self.pixels
    }
}

impl fmt::Debug for Frame {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Frame({}x{})", self.width, self.height)
    }
}

/// How far the surfaces of a picture are from its camera, in metres.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Depth {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// A number for each pixel, row by row from the top: Gymnasium's array of shape `(height,
    /// width)`.
    pub metres: Vec<f32>,
}

/// The result of [`render`](crate::EnvExt::render), by render mode.
#[derive(Clone, Debug, PartialEq)]
pub enum Rendered {
    /// `human`: the window shows the frame.
    Shown,
    /// `rgb_array`.
    Frame(Frame),
    /// `rgb_array_list`: every frame since the last call.
    Frames(Vec<Frame>),
    /// `ansi`.
    Text(String),
    /// `ansi_list`: every text since the last call.
    Texts(Vec<String>),
    /// `depth_array`.
    Depth(Depth),
    /// `rgbd_tuple`.
    Rgbd(Frame, Depth),
}

impl Rendered {
    /// The frame of the mode `rgb_array`.
    pub fn into_frame(self) -> Option<Frame> {
        if let Self::Frame(frame) = self {
            Some(frame)
        } else {
            None
        }
    }

    /// The frames of the mode `rgb_array_list`.
    pub fn into_frames(self) -> Option<Vec<Frame>> {
        if let Self::Frames(frames) = self {
            Some(frames)
        } else {
            None
        }
    }

    /// The depths of the modes `depth_array` and `rgbd_tuple`.
    pub fn into_depth(self) -> Option<Depth> {
        match self {
            Self::Depth(depth) | Self::Rgbd(_, depth) => Some(depth),
            _ => None,
        }
    }

    /// The text of the mode `ansi`.
    pub fn into_text(self) -> Option<String> {
        if let Self::Text(text) = self {
            Some(text)
        } else {
            None
        }
    }
}

/// Turns drawings into pixels. A rendering crate such as `gym-render` submits a
/// [`PainterProvider`], which makes the [`Painter`]s of wrappers.
pub trait Painter: Send {
    /// Draws on a canvas whose coordinates are `size`, scaled to fill `frame`. The canvas starts
    /// black.
    fn paint(&mut self, size: (u32, u32), draw: &mut dyn FnMut(&mut dyn Canvas), frame: &mut Frame);
}

/// Link-time registration of a [`Painter`].
#[derive(Debug)]
pub struct PainterProvider {
    /// Makes one.
    pub new: fn() -> Box<dyn Painter>,
}

inventory::collect!(PainterProvider);

/// A painter of the linked rendering crate; `None` if none is linked.
pub fn painter() -> Option<Box<dyn Painter>> {
    inventory::iter::<PainterProvider>
        .into_iter()
        .next()
        .map(|provider| (provider.new)())
}

/// A live window. A rendering crate submits a [`ScreenProvider`].
pub trait Screen: Send {
    /// Waits until the previous frame has been visible for its duration, then shows `frame`.
    /// Returns whether the window is open; if it is closed, returns false at once.
    fn show(&mut self, frame: &Frame) -> bool;
}

/// Opens a window: title, size of the frames, frames per second.
pub type OpenScreen = fn(&str, (u32, u32), u32) -> Result<Box<dyn Screen>>;

/// Link-time registration of a [`Screen`].
#[derive(Debug)]
pub struct ScreenProvider {
    /// Opens a window; an error without a display.
    pub open: OpenScreen,
}

inventory::collect!(ScreenProvider);

/// The provider of windows; `None` if no crate that opens windows is linked.
pub fn open_screen() -> Option<OpenScreen> {
    inventory::iter::<ScreenProvider>
        .into_iter()
        .next()
        .map(|provider| provider.open)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stored_frame_has_the_pixels_of_its_size() {
        for (width, height) in [
            (u32::MAX, u32::MAX),
            (1 << 31, 1 << 31),
            (u32::MAX, 1 << 20),
        ] {
            let error = Frame::new(width, height).unwrap_err().to_string();
            assert!(error.ends_with("does not fit in memory"), "{error}");
        }
        let frame = Frame::new(2, 1).unwrap();
        let json = serde_json::to_string(&frame).unwrap();
        assert_eq!(serde_json::from_str::<Frame>(&json).unwrap(), frame);
        for (width, height, pixels) in [
            (2, 1, "0,0,0"),
            (2, 1, ""),
            (0, 0, "0"),
            (u32::MAX, u32::MAX, "0,0,0"),
            (1, 1, "0,0,0,0"),
        ] {
            let json = format!(r#"{{"width": {width}, "height": {height}, "pixels": [{pixels}]}}"#);
            let error = serde_json::from_str::<Frame>(&json)
                .unwrap_err()
                .to_string();
            assert!(
                error.contains(&format!("a frame of {width}x{height} has")),
                "{error}"
            );
        }
    }
}
