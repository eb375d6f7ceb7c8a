//! Bodies, cameras and lights.

use std::rc::Rc;

use super::{Compiler, Frame, Geom, Joint, Site, replace};
use crate::Result;
use crate::math::spatial::EPS;
use crate::mjcf::orientation::{Orientation, norm};
use crate::mjcf::xml::{Element, Place};

/// A body and its parts.
#[derive(Debug, Default)]
pub(crate) struct Body {
    pub(crate) place: Place,
    /// Which element of all files it is.
    pub(crate) element: (usize, usize),
    pub(crate) name: Option<String>,
    /// The settings of the model that has the body.
    pub(crate) compiler: Rc<Compiler>,
    pub(crate) parent: usize,
    pub(crate) pos: [f64; 3],
    pub(crate) orientation: Orientation,
    pub(crate) frame: Option<Frame>,
    pub(crate) mocap: bool,
    pub(crate) gravcomp: f64,
    pub(crate) sleep: Sleep,
    pub(crate) inertial: Option<Inertial>,
    pub(crate) joints: Vec<Joint>,
    pub(crate) geoms: Vec<Geom>,
    pub(crate) sites: Vec<Site>,
    pub(crate) cameras: Vec<Camera>,
    pub(crate) lights: Vec<Light>,
}

/// Bodies that an element `attach` added.
#[derive(Debug)]
pub(crate) struct Attached {
    /// Which element of all files it is.
    pub(crate) element: (usize, usize),
    /// The number of the first body, and how many there are.
    pub(crate) first: usize,
    pub(crate) count: usize,
}

/// When the tree of a body falls asleep.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) enum Sleep {
    #[default]
    Auto,
    Never,
    Allowed,
    Init,
}

/// The mass and inertia of a body as the text gives them.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Inertial {
    pub(crate) place: Place,
    pub(crate) pos: [f64; 3],
    pub(crate) orientation: Orientation,
    pub(crate) mass: f64,
    pub(crate) moments: Moments,
}

/// Moments of inertia as the text gives them.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Moments {
    /// `diaginertia`: about the axes of the orientation.
    Principal([f64; 3]),
    /// `fullinertia`: xx, yy, zz, xy, xz, yz.
    Full([f64; 6]),
}

impl Inertial {
    pub(crate) fn read(mut element: Element<'_, '_>) -> Result<Self> {
        let place = element.place();
        let pos = element
            .numbers("pos")?
            .ok_or_else(|| element.missing("pos"))?;
        let mass = element
            .non_negative("mass")?
            .ok_or_else(|| element.missing("mass"))?;
        let mut orientation = Orientation::default();
        orientation.read(&mut element)?;
        let moments = match (
            element.numbers("diaginertia")?,
            element.numbers("fullinertia")?,
        ) {
            (Some(_), Some(_)) => {
                return Err(place.attribute("fullinertia", "only one of diaginertia, fullinertia"));
            }
            (_, Some(_)) if orientation != Orientation::default() => {
                let reason = "does not go with an orientation, which it implies";
                return Err(place.attribute("fullinertia", reason));
            }
            (_, Some(full)) => Moments::Full(full),
            (diagonal, None) => Moments::Principal(diagonal.unwrap_or_default()),
        };
        element.finish_without_children()?;
        Ok(Self {
            place,
            pos,
            orientation,
            mass,
            moments,
        })
    }
}

with_defaults! {
    /// A camera.
    struct Camera {
        place: Place = Place::default(),
        name: Option<String> = None,
        /// The settings of the model that has the element.
        compiler: Rc<Compiler> = Rc::default(),
        mode: u8 = 0,
        target: Option<String> = None,
        pos: [f64; 3] = [0.0; 3],
        orientation: Orientation = Orientation::default(),
        frame: Option<Frame> = None,
        orthographic: bool = false,
        fovy: f64 = 45.0,
        resolution: [i32; 2] = [1; 2],
        /// The size of the image on the sensor, which stands in the place of `fovy`.
        sensor_size: [f32; 2] = [0.0; 2],
        /// The focal length and the principal point, in the unit of the sensor and in pixels.
        focal: [f32; 2] = [0.0; 2],
        focal_pixel: [f32; 2] = [0.0; 2],
        principal: [f32; 2] = [0.0; 2],
        principal_pixel: [f32; 2] = [0.0; 2],
    }
}

const MODES: [(&str, u8); 5] = [
    ("fixed", 0),
    ("track", 1),
    ("trackcom", 2),
    ("targetbody", 3),
    ("targetbodycom", 4),
];

impl Camera {
    pub(crate) fn read(&mut self, element: &mut Element<'_, '_>) -> Result<()> {
        self.place = element.place();
        element.set_keyword("mode", &MODES, &mut self.mode)?;
        self.target = element.text("target")?.or(self.target.take());
        replace(&mut self.pos, element.numbers("pos")?);
        let fovy = element.number("fovy")?;
        replace(&mut self.fovy, fovy);
        if !(self.fovy > 0.0 && self.fovy < 180.0) {
            let reason = "must lie between 0 and 180 degrees";
            return Err(self.place.attribute("fovy", reason));
        }
        self.orientation.read(element)?;
        let projections = [("perspective", false), ("orthographic", true)];
        element.set_keyword("projection", &projections, &mut self.orthographic)?;
        if let Some([width, height]) = element.numbers("resolution")? {
            self.resolution = [width as i32, height as i32];
        }
        let size = element.numbers::<2>("sensorsize")?;
        if size.is_some() && fovy.is_some() {
            return Err(self.place.attribute("sensorsize", "does not go with fovy"));
        }
        for (name, value) in [
            ("focal", &mut self.focal),
            ("focalpixel", &mut self.focal_pixel),
            ("principal", &mut self.principal),
            ("principalpixel", &mut self.principal_pixel),
        ] {
            replace(value, element.numbers(name)?.map(single));
        }
        replace(&mut self.sensor_size, size.map(single));
        element.ignore("user ipd output");
        Ok(())
    }

    /// Whether the size of the sensor gives the field of view.
    pub(crate) fn has_sensor(&self) -> bool {
        self.sensor_size.iter().all(|size| *size > 0.0)
    }

    /// The focal lengths and the principal point on the sensor.
    ///
    /// # Errors
    /// For lengths without a sensor, and a sensor without a resolution.
    pub(crate) fn intrinsic(&self) -> Result<[f32; 4]> {
        let lengths = [self.focal, self.principal];
        let pixels = [self.focal_pixel, self.principal_pixel];
        if !self.has_sensor() {
            let any = lengths.iter().chain(&pixels).flatten().any(|x| *x != 0.0);
            let reason = "missing: focal lengths and principal points need it";
            return match any {
                true => Err(self.place.attribute("sensorsize", reason)),
                false => Ok([0.0; 4]),
            };
        }
        if self.resolution.iter().any(|pixels| *pixels <= 0) {
            return Err(self.place.attribute("resolution", "must be positive"));
        }
        Ok(std::array::from_fn(|i| {
            let (part, axis) = (i / 2, i % 2);
            let density = self.resolution[axis] as f32 / self.sensor_size[axis];
            match pixels[part][axis] {
                0.0 => lengths[part][axis],
                pixels => pixels / density,
            }
        }))
    }
}

fn single(numbers: [f64; 2]) -> [f32; 2] {
    numbers.map(|x| x as f32)
}

with_defaults! {
    /// A light. Its colours are ignored: the renderer has its own light.
    struct Light {
        place: Place = Place::default(),
        name: Option<String> = None,
        /// 0 spot, 1 directional, 2 point, 3 image.
        kind: u8 = 0,
        target: Option<String> = None,
        pos: [f64; 3] = [0.0; 3],
        dir: [f64; 3] = [0.0, 0.0, -1.0],
        frame: Option<Frame> = None,
    }
}

impl Light {
    pub(crate) fn read(&mut self, element: &mut Element<'_, '_>) -> Result<()> {
        self.place = element.place();
        let kinds = [("spot", 0), ("directional", 1), ("point", 2), ("image", 3)];
        let directional = element.flag("directional")?.map(u8::from);
        let kind = element.keyword("type", &kinds)?;
        if kind.is_some() && directional.is_some() {
            return Err(self.place.attribute("type", "does not go with directional"));
        }
        replace(&mut self.kind, kind.or(directional));
        self.target = element.text("target")?.or(self.target.take());
        element.set_keyword("mode", &MODES, &mut 0)?;
        replace(&mut self.pos, element.numbers("pos")?);
        if let Some(dir) = element.numbers::<3>("dir")? {
            let length = norm(&dir);
            if length < EPS {
                return Err(element.place().attribute("dir", "the direction is zero"));
            }
            self.dir = dir.map(|x| x / length);
        }
        element.ignore(
            "castshadow active ambient diffuse specular attenuation cutoff exponent \
             softness bulbradius intensity range texture",
        );
        Ok(())
    }
}
