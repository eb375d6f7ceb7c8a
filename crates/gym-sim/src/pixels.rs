//! Observations that are images.

use std::fmt;

use gym_core::canvas::Canvas;
use gym_core::render::{Frame, Painter, painter};
use gym_core::spaces::{BoxSpace, array_of};
use gym_core::{DType, Error, Result, Space, Value};

/// A painter, and the last frame that it painted.
pub(crate) struct Pixels {
    painter: Box<dyn Painter>,
    frame: Frame,
}

impl Pixels {
    /// Makes a painter of frames of `side` by `side` pixels.
    pub(crate) fn new(side: u32) -> Result<Self> {
        let reason = "no crate that draws is linked: turn on the feature `render` of rust-gym, or \
                      add gym-render and `use gym_render as _;`";
        let painter = painter().ok_or_else(|| Error::argument("pixels", reason))?;
        let frame = Frame::new(side, side)?;
        Ok(Self { painter, frame })
    }

    fn shape(&self) -> [usize; 3] {
        [self.frame.height() as usize, self.frame.width() as usize, 3]
    }

    pub(crate) fn space(&self) -> Result<Space> {
        Ok(BoxSpace::uniform(0.0, 255.0, self.shape(), DType::U8)?.into())
    }

    /// Paints a frame with `draw`, and writes it to `out`.
    pub(crate) fn write(&mut self, draw: impl Fn((u32, u32), &mut dyn Canvas), out: &mut Value) {
        let size = (self.frame.width(), self.frame.height());
        let mut draw = |canvas: &mut dyn Canvas| draw(size, canvas);
        self.painter.paint(size, &mut draw, &mut self.frame);
        if let Some(bytes) = array_of(out, DType::U8, &self.shape()).as_mut_slice() {
            bytes.copy_from_slice(self.frame.pixels());
        }
    }
}

impl Clone for Pixels {
    fn clone(&self) -> Self {
        Self {
            painter: painter().unwrap_or_else(|| Box::new(Blank)),
            frame: self.frame.clone(),
        }
    }
}

impl fmt::Debug for Pixels {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("Pixels").field(&self.frame).finish()
    }
}

/// Paints nothing. `clone` cannot fail, so `clone` needs a painter even if no linked crate provides
/// a painter. (In practice a linked crate does, because `new` found a painter.)
struct Blank;

impl Painter for Blank {
    fn paint(&mut self, _: (u32, u32), _: &mut dyn FnMut(&mut dyn Canvas), _: &mut Frame) {}
}
