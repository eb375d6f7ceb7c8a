//! Sensors.

use crate::Result;
use crate::mjcf::xml::{Element, Place};
use crate::model::{About, ObjectType, SensorType};

/// A sensor.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Sensor {
    pub(crate) place: Place,
    pub(crate) name: Option<String>,
    pub(crate) kind: SensorType,
    pub(crate) object: Option<Target>,
    pub(crate) reference: Option<Target>,
    pub(crate) cutoff: f64,
    pub(crate) noise: f64,
}

/// The name of a sensor's object, and the attribute that gives the name.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Target {
    pub(crate) kind: ObjectType,
    pub(crate) name: String,
    pub(crate) attribute: &'static str,
}

const FRAMES: [(&str, ObjectType); 5] = [
    ("body", ObjectType::Body),
    ("xbody", ObjectType::XBody),
    ("geom", ObjectType::Geom),
    ("site", ObjectType::Site),
    ("camera", ObjectType::Camera),
];

impl Sensor {
    pub(crate) fn read(mut element: Element<'_, '_>, kind: SensorType) -> Result<Self> {
        let mut sensor = Self {
            place: element.place(),
            name: element.text("name")?,
            kind,
            object: None,
            reference: None,
            cutoff: 0.0,
            noise: 0.0,
        };
        if let Some(cutoff) = element.non_negative("cutoff")? {
            if cutoff > 0.0 && !kind.has_cutoff() {
                let reason = "axes and quaternions have no cutoff";
                return Err(sensor.place.attribute("cutoff", reason));
            }
            sensor.cutoff = cutoff;
        }
        element.set_non_negative("noise", &mut sensor.noise)?;
        let target = |element: &mut Element<'_, '_>, kind, attribute| {
            let name = element.required_text(attribute)?;
            Ok::<_, crate::Error>(Some(Target {
                kind,
                name,
                attribute,
            }))
        };
        sensor.object = match kind.about() {
            About::Nothing => None,
            About::Site => target(&mut element, ObjectType::Site, "site")?,
            About::Joint | About::Ball => target(&mut element, ObjectType::Joint, "joint")?,
            About::Tendon => target(&mut element, ObjectType::Tendon, "tendon")?,
            About::Actuator => target(&mut element, ObjectType::Actuator, "actuator")?,
            About::Body => target(&mut element, ObjectType::Body, "body")?,
            About::Frame | About::Relative => {
                let kind = element
                    .keyword("objtype", &FRAMES)?
                    .ok_or_else(|| element.missing("objtype"))?;
                target(&mut element, kind, "objname")?
            }
        };
        if kind.about() == About::Relative
            && let Some(reference) = element.keyword("reftype", &FRAMES)?
        {
            sensor.reference = target(&mut element, reference, "refname")?;
        }
        element.ignore("user");
        element.finish_without_children()?;
        Ok(sensor)
    }
}
