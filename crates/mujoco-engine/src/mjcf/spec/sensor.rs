//! Sensors.

use crate::Result;
use crate::mjcf::MOST;
use crate::mjcf::xml::{Element, Place};
use crate::model::{About, CONTACT, ObjectType, RAY, SensorType};

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
    pub(crate) parameters: [i32; 3],
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
            parameters: [0; 3],
        };
        if let Some(cutoff) = element.non_negative("cutoff")? {
            if cutoff > 0.0 && !kind.has_cutoff() && kind.about() != About::Pair {
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
            About::Projection => {
                sensor.reference = target(&mut element, ObjectType::Camera, "camera")?;
                target(&mut element, ObjectType::Site, "site")?
            }
            About::Ray => {
                sensor.parameters[0] = read_bits(&mut element, &RAY)?;
                let places = [("site", ObjectType::Site), ("camera", ObjectType::Camera)];
                let place = one_of(&mut element, &places)?;
                if place.is_none() {
                    return Err(element.missing("site"));
                }
                place
            }
            About::Contact => {
                sensor.read_contact(&mut element)?;
                sensor.reference = one_of(&mut element, &SECOND)?;
                one_of(&mut element, &FIRST)?
            }
            About::Pair => {
                sensor.reference = one_of(&mut element, &[SECOND[0], SECOND[2]])?;
                let first = one_of(&mut element, &[FIRST[1], FIRST[3]])?;
                for (given, name) in [(&first, "geom1"), (&sensor.reference, "geom2")] {
                    if given.is_none() {
                        return Err(element.missing(name));
                    }
                }
                first
            }
            About::Frame | About::Relative | About::Inside => {
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
        if kind.about() == About::Inside {
            sensor.reference = target(&mut element, ObjectType::Site, "site")?;
        }
        element.ignore("user");
        element.finish_without_children()?;
        Ok(sensor)
    }

    /// Reads which values of which contacts a sensor has.
    fn read_contact(&mut self, element: &mut Element<'_, '_>) -> Result<()> {
        let bits = read_bits(element, &CONTACT)?;
        let reductions = [
            ("none", 0),
            ("mindist", 1),
            ("maxforce", 2),
            ("netforce", 3),
        ];
        let mut reduction = 0;
        element.set_keyword("reduce", &reductions, &mut reduction)?;
        let number: i32 = element.integer("num")?.unwrap_or(1);
        if !(1..=MOST as i32).contains(&number) {
            let reason = format!("must be from 1 to {MOST}");
            return Err(self.place.attribute("num", reason));
        }
        self.parameters = [bits, reduction, number];
        Ok(())
    }
}

/// Reads the attribute `data`, which selects some of `values`, as bits.
fn read_bits(element: &mut Element<'_, '_>, values: &[(&str, usize)]) -> Result<i32> {
    let first = values.first().map_or("", |(name, _)| name);
    let data = element.text("data")?;
    let mut bits = 0;
    for word in data.as_deref().unwrap_or(first).split_ascii_whitespace() {
        let place = values.iter().position(|(name, _)| *name == word);
        let bit = place.map_or(0, |place| 1 << place);
        if bit <= bits {
            let names: Vec<&str> = values.iter().map(|(name, _)| *name).collect();
            let reason = format!("{word:?}: use some of {}, in this order", names.join(", "));
            return Err(element.place().attribute("data", reason));
        }
        bits |= bit;
    }
    Ok(bits)
}

/// The attributes that name the objects of contacts and pairs.
const FIRST: [(&str, ObjectType); 4] = [
    ("site", ObjectType::Site),
    ("body1", ObjectType::Body),
    ("subtree1", ObjectType::XBody),
    ("geom1", ObjectType::Geom),
];
const SECOND: [(&str, ObjectType); 3] = [
    ("body2", ObjectType::Body),
    ("subtree2", ObjectType::XBody),
    ("geom2", ObjectType::Geom),
];

/// Reads the only one of some attributes that an element has, if any.
fn one_of(
    element: &mut Element<'_, '_>,
    attributes: &[(&'static str, ObjectType)],
) -> Result<Option<Target>> {
    let mut found = None;
    for &(attribute, kind) in attributes {
        let Some(name) = element.text(attribute)? else {
            continue;
        };
        if found.is_some() {
            let names: Vec<&str> = attributes.iter().map(|(name, _)| *name).collect();
            let reason = format!("only one of {}", names.join(", "));
            return Err(element.place().attribute(attribute, reason));
        }
        found = Some(Target {
            kind,
            name,
            attribute,
        });
    }
    Ok(found)
}
