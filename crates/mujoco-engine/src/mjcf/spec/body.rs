//! Bodies, cameras and lights.

use super::{Frame, Geom, Joint, Site, replace};
use crate::Result;
use crate::math::spatial::EPS;
use crate::mjcf::orientation::{Orientation, norm};
use crate::mjcf::xml::{Element, Place};

/// A body and its parts.
#[derive(Debug, Default)]
pub(crate) struct Body {
    pub(crate) place: Place,
    pub(crate) name: Option<String>,
    pub(crate) parent: usize,
    pub(crate) pos: [f64; 3],
    pub(crate) orientation: Orientation,
    pub(crate) frame: Option<Frame>,
    pub(crate) mocap: bool,
    pub(crate) gravcomp: f64,
    pub(crate) inertial: Option<Inertial>,
    pub(crate) joints: Vec<Joint>,
    pub(crate) geoms: Vec<Geom>,
    pub(crate) sites: Vec<Site>,
    pub(crate) cameras: Vec<Camera>,
    pub(crate) lights: Vec<Light>,
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
        mode: u8 = 0,
        target: Option<String> = None,
        pos: [f64; 3] = [0.0; 3],
        orientation: Orientation = Orientation::default(),
        frame: Option<Frame> = None,
        fovy: f64 = 45.0,
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
        replace(&mut self.fovy, element.number("fovy")?);
        if !(self.fovy > 0.0 && self.fovy < 180.0) {
            let reason = "must lie between 0 and 180 degrees";
            return Err(self.place.attribute("fovy", reason));
        }
        self.orientation.read(element)?;
        element.keyword("projection", &[("perspective", ())])?;
        element.ignore("user ipd resolution output");
        Ok(())
    }
}

with_defaults! {
    /// A light. Its colours are ignored: the renderer has its own light.
    struct Light {
        name: Option<String> = None,
        directional: bool = false,
        pos: [f64; 3] = [0.0; 3],
        dir: [f64; 3] = [0.0, 0.0, -1.0],
        frame: Option<Frame> = None,
    }
}

impl Light {
    pub(crate) fn read(&mut self, element: &mut Element<'_, '_>) -> Result<()> {
        let kind = element.keyword("type", &[("spot", false), ("directional", true)])?;
        let directional = element.flag("directional")?.or(kind);
        replace(&mut self.directional, directional);
        replace(&mut self.pos, element.numbers("pos")?);
        if let Some(dir) = element.numbers::<3>("dir")? {
            let length = norm(&dir);
            if length < EPS {
                return Err(element.place().attribute("dir", "the direction is zero"));
            }
            self.dir = dir.map(|x| x / length);
        }
        element.ignore(
            "mode target castshadow active ambient diffuse specular attenuation cutoff exponent \
             softness bulbradius intensity range texture",
        );
        Ok(())
    }
}
