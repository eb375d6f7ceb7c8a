//! Windows with a picture and a panel of buttons, sliders and lines beside it.
//!
//! All of it is drawn here, on the CPU: egui with winit and softbuffer brings 140 crates where minifb
//! brings 6, and would need a rasteriser of its own. What is shown is a function of [`Input`], so that
//! tests need no display.

mod input;
mod panel;

pub(crate) use input::Input;
pub(crate) use panel::{Panel, Rows, TEXT, short};

use gym::canvas::{Canvas, Point};
use gym::render::{Frame, Painter, Raster, Window};
use gym::{Error, Result};

/// A rectangle of pixels: the corner with the smallest coordinates, width and height.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Area {
    pub(crate) min: (u32, u32),
    pub(crate) size: (u32, u32),
}

impl Area {
    /// A point of the window, seen from the corner.
    pub(crate) fn local(&self, [x, y]: Point) -> Point {
        [x - f64::from(self.min.0), y - f64::from(self.min.1)]
    }

    pub(crate) fn contains(&self, at: Point) -> bool {
        let [x, y] = self.local(at);
        let within = |x: f64, side: u32| (0.0..f64::from(side)).contains(&x);
        within(x, self.size.0) && within(y, self.size.1)
    }

    /// The largest area within this one that has the aspect ratio of a size, in the middle.
    pub(crate) fn fit(&self, (width, height): (u32, u32)) -> Self {
        let [across, down] = [(self.size.0, width), (self.size.1, height)]
            .map(|(room, side)| f64::from(room) / f64::from(side.max(1)));
        let scale = across.min(down);
        let side = |side: u32, room: u32| ((f64::from(side) * scale) as u32).clamp(1, room.max(1));
        let size = (side(width, self.size.0), side(height, self.size.1));
        Self {
            min: (
                self.min.0 + (self.size.0 - size.0) / 2,
                self.min.1 + (self.size.1 - size.1) / 2,
            ),
            size,
        }
    }
}

/// The width of the panel beside a picture, and the width of a window from which on it is there. In
/// a narrower window the panel is below.
const BESIDE: u32 = 320;
const WIDE: u32 = 720;

/// The areas of the picture and of the panel in a window of a size.
pub(crate) fn areas((width, height): (u32, u32)) -> [Area; 2] {
    if width >= WIDE {
        let left = width - BESIDE;
        let picture = Area {
            min: (0, 0),
            size: (left, height),
        };
        let panel = Area {
            min: (left, 0),
            size: (BESIDE, height),
        };
        return [picture, panel];
    }
    let top = (height * 9 / 20).max(1);
    let picture = Area {
        min: (0, 0),
        size: (width, top),
    };
    let panel = Area {
        min: (0, top.min(height.saturating_sub(1))),
        size: (width, (height - top.min(height)).max(1)),
    };
    [picture, panel]
}

/// A part of a window that is drawn by itself.
#[derive(Default)]
pub(crate) struct Part {
    raster: Raster,
    frame: Frame,
}

impl Part {
    /// Draws a part of a window, in units of pixels.
    pub(crate) fn draw(
        &mut self,
        area: Area,
        window: &mut Frame,
        draw: impl FnMut(&mut dyn Canvas),
    ) -> Result<()> {
        self.draw_in(area, area.size, window, draw)
    }

    /// Draws a part of a window, whose width and height are so many units.
    pub(crate) fn draw_in(
        &mut self,
        area: Area,
        units: (u32, u32),
        window: &mut Frame,
        mut draw: impl FnMut(&mut dyn Canvas),
    ) -> Result<()> {
        if (self.frame.width(), self.frame.height()) != area.size {
            self.frame = Frame::new(area.size.0, area.size.1)?;
        }
        self.raster.paint(units, &mut draw, &mut self.frame);
        copy(&self.frame, area, window)
    }
}

/// Shows a window until a person closes it. `update` draws each frame, which has the window's size, and
/// returns the title; `None` closes the window.
pub(crate) fn run(
    title: &str,
    size: (u32, u32),
    mut update: impl FnMut(&Input, &mut Frame) -> Result<Option<String>>,
) -> Result<()> {
    let mut window = Window::open(title, size)?;
    let (mut input, mut frame) = (Input::default(), Frame::default());
    while window.is_open() {
        let size = window.fit();
        if (frame.width(), frame.height()) != size {
            frame = Frame::new(size.0, size.1)?;
        }
        input.next(&mut window);
        let Some(title) = update(&input, &mut frame)? else {
            break;
        };
        window.set_title(&title);
        window.show(&frame);
    }
    Ok(())
}

/// The number of a range that is nearest to zero.
pub(crate) fn rest([low, high]: [f64; 2]) -> f64 {
    0.0_f64.max(low).min(high)
}

/// Copies a frame to its area of a window.
fn copy(frame: &Frame, area: Area, window: &mut Frame) -> Result<()> {
    let (width, height) = (window.width(), window.height());
    let (right, bottom) = (area.min.0 + area.size.0, area.min.1 + area.size.1);
    if right > width || bottom > height || (frame.width(), frame.height()) != area.size {
        return Err(Error::custom("a part is larger than its window"));
    }
    let (row, whole) = (area.size.0 as usize * 3, width as usize * 3);
    let first = area.min.1 as usize * whole + area.min.0 as usize * 3;
    let rows = window.pixels_mut()[first..].chunks_mut(whole);
    for (to, from) in rows.zip(frame.pixels().chunks_exact(row.max(1))) {
        to[..row].copy_from_slice(from);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use gym::canvas::Color;

    #[test]
    fn areas_cover_the_window() {
        for size in [(1280, 720), (720, 10), (400, 800), (200, 1), (1, 1)] {
            let [picture, panel] = areas(size);
            let pixels = |area: Area| area.size.0 * area.size.1;
            assert!(pixels(picture) > 0 && pixels(panel) > 0, "{size:?}");
            if size.1 > 1 {
                assert_eq!(pixels(picture) + pixels(panel), size.0 * size.1);
            }
        }
        assert_eq!(areas((1280, 720))[1].min, (960, 0));
        assert_eq!(areas((400, 800))[1].min, (0, 360));
    }

    #[test]
    fn parts_are_drawn_in_their_areas() {
        let mut window = Frame::new(4, 3).unwrap();
        let area = Area {
            min: (1, 1),
            size: (2, 2),
        };
        let mut part = Part::default();
        let draw = |canvas: &mut dyn Canvas| canvas.clear(Color::rgb(9, 8, 7));
        part.draw(area, &mut window, draw).unwrap();
        let reds: Vec<u8> = window.pixels().iter().step_by(3).copied().collect();
        assert_eq!(reds, [0, 0, 0, 0, 0, 9, 9, 0, 0, 9, 9, 0]);
        let wide = Area {
            min: (10, 20),
            size: (200, 100),
        };
        let fit = wide.fit((480, 480));
        assert_eq!((fit.min, fit.size), ((60, 20), (100, 100)));
        assert_eq!(wide.fit((0, 1)).size.1, 100);
        assert!(area.contains([2.9, 1.0]) && !area.contains([3.0, 1.0]));
        let beyond = Area {
            min: (3, 1),
            size: (2, 2),
        };
        assert!(part.draw(beyond, &mut window, draw).is_err());
    }
}
