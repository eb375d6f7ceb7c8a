//! Pictures and films of a model.

use std::path::{Path, PathBuf};
#[cfg(feature = "human")]
use std::sync::Arc;

use gym::canvas::Canvas;
use gym::render::{Frame, Painter, Raster, Video, file, write_png};
use gym::sim::Common;
use gym::sim::engine::{Data, Model};
#[cfg(feature = "human")]
use gym::sim::view;
use gym::sim::view::{CameraConfig, View};
#[cfg(feature = "human")]
use gym::sim::viewer::Viewer;
use gym::{Error, Result};

#[derive(clap::Args)]
pub(super) struct Picture {
    /// Draws the model to a file: .png is a picture of the last state; .gif, .apng or .mp4 is a film
    /// of the steps, in the time of the model.
    #[arg(long, value_name = "FILE", group = "shown")]
    out: Option<PathBuf>,
    /// The size of the picture, by default 480x360, or of the window, by default 1100x640.
    #[arg(long, value_name = "WIDTHxHEIGHT", value_parser = parse_size, requires = "shown")]
    pub(super) size: Option<(u32, u32)>,
    /// A camera of the model, instead of a free one.
    #[arg(long, value_name = "NAME", requires = "shown")]
    camera: Option<String>,
    /// The direction of the free camera, in degrees.
    #[arg(
        long,
        default_value_t = 120.0,
        allow_negative_numbers = true,
        requires = "shown"
    )]
    azimuth: f64,
    /// The elevation of the free camera, in degrees: negative looks down.
    #[arg(long, default_value_t = -20.0, allow_negative_numbers = true, requires = "shown")]
    elevation: f64,
    /// The distance of the free camera from the model's centre, in m; by default 1.5 times its extent.
    #[arg(long, requires = "shown")]
    distance: Option<f64>,
}

impl Picture {
    fn free_camera(&self, model: &Model) -> CameraConfig {
        let distance = self.distance.unwrap_or(1.5 * model.stat.extent);
        CameraConfig::at(model.stat.center, distance, self.azimuth, self.elevation)
    }

    /// Aims the cameras of a live view.
    #[cfg(feature = "human")]
    pub(super) fn aim(&self, viewer: &mut Viewer) -> Result<()> {
        let model = Arc::clone(viewer.model());
        viewer.set_free_camera(&self.free_camera(&model))?;
        match &self.camera {
            Some(name) => viewer.use_camera(Some(view::camera(&model, name)?)),
            None => Ok(()),
        }
    }
}

/// The largest width and height of a picture.
const MOST: u32 = 8192;
/// Frames per second of a film.
const FPS: u32 = 25;

fn parse_size(text: &str) -> Result<(u32, u32), String> {
    let side = |side: &str| side.parse().ok().filter(|side| (1..=MOST).contains(side));
    let sides = text
        .split_once('x')
        .and_then(|(x, y)| Some((side(x)?, side(y)?)));
    sides.ok_or_else(|| format!("a size is such as 480x360, of at most {MOST}x{MOST} pixels"))
}

/// A picture or a film that is being made.
pub(super) struct Film<'a> {
    path: &'a Path,
    view: View,
    raster: Raster,
    frame: Frame,
    /// `None` for a picture.
    video: Option<Video>,
    /// The time of the first frame, and the number of frames so far.
    start: f64,
    frames: u32,
}

impl<'a> Film<'a> {
    /// The film that the arguments ask for, if any, from the state `data`; `moves`: whether there
    /// are steps.
    pub(super) fn open(
        arguments: &'a Picture,
        (model, data): (&Model, &Data),
        moves: bool,
    ) -> Result<Option<Self>> {
        let Some(path) = &arguments.out else {
            return Ok(None);
        };
        let still = path
            .extension()
            .is_some_and(|end| end.eq_ignore_ascii_case("png"));
        if !still && !moves {
            let reason = "a film needs steps: give --steps too, or the name of a .png";
            return Err(Error::argument("--out", reason));
        }
        let video = if still {
            drop(file::AtomicFile::create(path)?); // before the work starts
            None
        } else {
            Some(Video::create(path, FPS)?)
        };
        let options = Common {
            camera_name: arguments.camera.clone(),
            default_camera_config: arguments.free_camera(model),
            ..Common::default()
        };
        let view = options.view(model)?;
        let (width, height) = arguments.size.unwrap_or((480, 360));
        Ok(Some(Self {
            path,
            view,
            raster: Raster::new(),
            frame: Frame::new(width, height)?,
            video,
            start: data.time,
            frames: 0,
        }))
    }

    /// Draws a state of a film if it is time for a frame.
    pub(super) fn watch(&mut self, model: &Model, data: &Data) -> Result<()> {
        let due = self.start + f64::from(self.frames) / f64::from(FPS);
        // half a step early rather than half a step late
        if self.video.is_none() || data.time + model.opt.timestep / 2.0 < due {
            return Ok(());
        }
        self.frames += 1;
        self.draw(model, data);
        match &mut self.video {
            Some(video) => video.write(&self.frame),
            None => Ok(()),
        }
    }

    fn draw(&mut self, model: &Model, data: &Data) {
        let size = (self.frame.width(), self.frame.height());
        let mut draw = |canvas: &mut dyn Canvas| self.view.draw(model, data, size, canvas);
        self.raster.paint(size, &mut draw, &mut self.frame);
    }

    /// Draws the last state of a picture, and completes the file; returns what was written.
    pub(super) fn finish(mut self, model: &Model, data: &Data) -> Result<String> {
        let path = self.path.display();
        if let Some(video) = self.video.take() {
            video.finish()?;
            return Ok(format!("{path}: {} frames", self.frames));
        }
        self.draw(model, data);
        write_png(self.path, &self.frame)?;
        let (width, height) = (self.frame.width(), self.frame.height());
        Ok(format!("{path}: {width}x{height} pixels"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_size_is_two_numbers_up_to_the_largest() {
        for (text, size) in [
            ("1x8192", Some((1, 8192))),
            ("8192x1", Some((8192, 1))),
            ("0x9", None),
            ("9x0", None),
            ("8193x9", None),
            ("9x8193", None),
            ("9", None),
            ("9x", None),
            ("9x9x9", None),
            ("-9x9", None),
        ] {
            let refusal = "a size is such as 480x360, of at most 8192x8192 pixels";
            assert_eq!(parse_size(text), size.ok_or(refusal.to_owned()), "{text}");
        }
    }
}
