//! The elements of a model as written, before anything is computed from them.
//!
//! Each kind of element is a struct whose `Default` has MuJoCo's defaults; `read` replaces what an
//! element gives. An element of a class starts from a clone of the class's struct, so that defaults
//! need no code of their own.

use super::orientation::{EPS, Orientation, norm};
use super::xml::{Element, Place};
use crate::model::{GeomType, JointType, Options};
use crate::{Error, Result, Revision};

/// A whole model.
#[derive(Debug, Default)]
pub(super) struct Spec {
    pub(super) name: String,
    pub(super) revision: Revision,
    pub(super) compiler: Compiler,
    pub(super) option: Options,
    pub(super) statistic: Statistic,
    pub(super) nkey: usize,
    pub(super) materials: Vec<Material>,
    /// The world, then the others, each after its parent.
    pub(super) bodies: Vec<Body>,
    pub(super) excludes: Vec<Exclude>,
    pub(super) tendons: Vec<Tendon>,
    pub(super) motors: Vec<Motor>,
    pub(super) keys: Vec<Key>,
}

impl Spec {
    /// Says where in the text the cause of an error is that was found in the figures.
    pub(super) fn located(&self, error: Error) -> Error {
        let geom = match error {
            Error::Pair { second, .. } => {
                self.bodies.iter().flat_map(|body| &body.geoms).nth(second)
            }
            _ => None,
        };
        match (geom, self.bodies.first()) {
            (Some(geom), _) => geom.place.attribute("type", error.to_string()),
            (None, Some(world)) => world.place.error(error.to_string()),
            (None, None) => error,
        }
    }
}

/// Settings of the compiler.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Compiler {
    pub(super) degree: bool,
    pub(super) autolimits: bool,
    /// `None`: where a body has no `inertial`.
    pub(super) inertia_from_geom: Option<bool>,
    pub(super) total_mass: Option<f64>,
}

impl Default for Compiler {
    fn default() -> Self {
        Self {
            degree: true,
            autolimits: true,
            inertia_from_geom: None,
            total_mass: None,
        }
    }
}

impl Compiler {
    pub(super) fn read(&mut self, mut element: Element<'_, '_>) -> Result<()> {
        replace(
            &mut self.degree,
            element.keyword("angle", &[("degree", true), ("radian", false)])?,
        );
        element.keyword("coordinate", &[("local", ())])?;
        let choices = [("auto", None), ("false", Some(false)), ("true", Some(true))];
        replace(
            &mut self.inertia_from_geom,
            element.keyword("inertiafromgeom", &choices)?,
        );
        if let Some(mass) = element.number("settotalmass")? {
            self.total_mass = (mass > 0.0).then_some(mass);
        }
        replace(&mut self.autolimits, element.flag("autolimits")?);
        element.finish_without_children()
    }
}

/// Figures that a model may state instead of having them computed.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Statistic {
    pub(super) meaninertia: Option<f64>,
    pub(super) meanmass: Option<f64>,
    pub(super) meansize: Option<f64>,
    pub(super) extent: Option<f64>,
    pub(super) center: Option<[f64; 3]>,
}

/// A colour that geoms can refer to.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Material {
    pub(super) name: String,
    pub(super) rgba: [f64; 4],
}

/// A body and what belongs to it.
#[derive(Debug, Default)]
pub(super) struct Body {
    pub(super) place: Place,
    pub(super) name: Option<String>,
    pub(super) parent: usize,
    pub(super) pos: [f64; 3],
    pub(super) orientation: Orientation,
    pub(super) inertial: Option<Inertial>,
    pub(super) joints: Vec<Joint>,
    pub(super) geoms: Vec<Geom>,
    pub(super) sites: Vec<Site>,
    pub(super) cameras: Vec<Camera>,
    pub(super) lights: Vec<Light>,
}

/// The mass of a body as it is written.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Inertial {
    pub(super) place: Place,
    pub(super) pos: [f64; 3],
    pub(super) orientation: Orientation,
    pub(super) mass: f64,
    pub(super) moments: Moments,
}

/// Moments of inertia as they are written.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Moments {
    /// About the axes of the orientation.
    Principal([f64; 3]),
    /// xx, yy, zz, xy, xz, yz.
    Full([f64; 6]),
}

impl Inertial {
    pub(super) fn read(mut element: Element<'_, '_>) -> Result<Self> {
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
                return Err(place.attribute(
                    "fullinertia",
                    "does not go with an orientation, which it implies",
                ));
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

/// A joint.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Joint {
    pub(super) place: Place,
    pub(super) name: Option<String>,
    pub(super) kind: JointType,
    pub(super) pos: [f64; 3],
    pub(super) axis: [f64; 3],
    pub(super) range: [f64; 2],
    pub(super) limited: Option<bool>,
    pub(super) reference: f64,
    pub(super) spring_reference: f64,
    pub(super) stiffness: f64,
    pub(super) damping: f64,
    pub(super) armature: f64,
    pub(super) margin: f64,
    pub(super) solref: [f64; 2],
    pub(super) solimp: [f64; 5],
}

const SOLREF: [f64; 2] = [0.02, 1.0];
const SOLIMP: [f64; 5] = [0.9, 0.95, 0.001, 0.5, 2.0];
const LIMITED: [(&str, Option<bool>); 3] =
    [("auto", None), ("false", Some(false)), ("true", Some(true))];

impl Default for Joint {
    fn default() -> Self {
        Self {
            place: Place::default(),
            name: None,
            kind: JointType::Hinge,
            pos: [0.0; 3],
            axis: [0.0, 0.0, 1.0],
            range: [0.0; 2],
            limited: None,
            reference: 0.0,
            spring_reference: 0.0,
            stiffness: 0.0,
            damping: 0.0,
            armature: 0.0,
            margin: 0.0,
            solref: SOLREF,
            solimp: SOLIMP,
        }
    }
}

impl Joint {
    pub(super) fn read(&mut self, element: &mut Element<'_, '_>) -> Result<()> {
        self.place = element.place();
        let kinds = [
            ("free", JointType::Free),
            ("slide", JointType::Slide),
            ("hinge", JointType::Hinge),
        ];
        replace(&mut self.kind, element.keyword("type", &kinds)?);
        replace(&mut self.pos, element.numbers("pos")?);
        if let Some(axis) = element.numbers::<3>("axis")? {
            if norm(&axis) < EPS {
                return Err(self.place.attribute("axis", "the axis is zero"));
            }
            self.axis = axis;
        }
        replace(&mut self.range, element.numbers("range")?);
        replace(&mut self.limited, element.keyword("limited", &LIMITED)?);
        replace(&mut self.reference, element.number("ref")?);
        replace(&mut self.spring_reference, element.number("springref")?);
        replace(&mut self.stiffness, element.non_negative("stiffness")?);
        replace(&mut self.damping, element.non_negative("damping")?);
        replace(&mut self.armature, element.non_negative("armature")?);
        replace(&mut self.margin, element.non_negative("margin")?);
        only_zero(element, "frictionloss", "friction loss")?;
        read_solref(element, "solreflimit", &mut self.solref)?;
        element.up_to("solimplimit", &mut self.solimp)?;
        element.ignore(&["user", "group"]);
        Ok(())
    }

    /// A `freejoint`, which has no defaults.
    pub(super) fn read_free(mut element: Element<'_, '_>) -> Result<Self> {
        let joint = Self {
            place: element.place(),
            name: element.text("name"),
            kind: JointType::Free,
            ..Self::default()
        };
        element.ignore(&["group"]);
        element.finish_without_children()?;
        Ok(joint)
    }
}

/// A geom.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Geom {
    pub(super) place: Place,
    pub(super) name: Option<String>,
    pub(super) shape: GeomType,
    pub(super) size: [f64; 3],
    pub(super) pos: Option<[f64; 3]>,
    pub(super) orientation: Orientation,
    pub(super) fromto: Option<[f64; 6]>,
    pub(super) density: f64,
    pub(super) mass: Option<f64>,
    pub(super) friction: [f64; 3],
    pub(super) condim: u8,
    pub(super) contype: u32,
    pub(super) conaffinity: u32,
    pub(super) margin: f64,
    pub(super) gap: f64,
    pub(super) priority: i32,
    pub(super) solmix: f64,
    pub(super) solref: [f64; 2],
    pub(super) solimp: [f64; 5],
    pub(super) rgba: [f64; 4],
    pub(super) material: Option<String>,
}

const GREY: [f64; 4] = [0.5, 0.5, 0.5, 1.0];

impl Default for Geom {
    fn default() -> Self {
        Self {
            place: Place::default(),
            name: None,
            shape: GeomType::Sphere,
            size: [0.0; 3],
            pos: None,
            orientation: Orientation::default(),
            fromto: None,
            density: 1000.0,
            mass: None,
            friction: [1.0, 0.005, 0.0001],
            condim: 3,
            contype: 1,
            conaffinity: 1,
            margin: 0.0,
            gap: 0.0,
            priority: 0,
            solmix: 1.0,
            solref: SOLREF,
            solimp: SOLIMP,
            rgba: GREY,
            material: None,
        }
    }
}

impl Geom {
    pub(super) fn read(&mut self, element: &mut Element<'_, '_>) -> Result<()> {
        self.place = element.place();
        let shapes = [
            ("plane", GeomType::Plane),
            ("sphere", GeomType::Sphere),
            ("capsule", GeomType::Capsule),
            ("cylinder", GeomType::Cylinder),
        ];
        replace(&mut self.shape, element.keyword("type", &shapes)?);
        element.up_to("size", &mut self.size)?;
        replace_some(&mut self.pos, element.numbers("pos")?);
        self.orientation.read(element)?;
        replace_some(&mut self.fromto, element.numbers("fromto")?);
        replace(&mut self.density, element.non_negative("density")?);
        replace_some(&mut self.mass, element.non_negative("mass")?);
        element.up_to("friction", &mut self.friction)?;
        if self.friction.iter().any(|x| *x < 0.0) {
            return Err(self.place.attribute("friction", "must not be negative"));
        }
        if let Some(condim) = element.integer("condim")? {
            if condim != 1 && condim != 3 {
                return Err(self
                    .place
                    .attribute("condim", format!("{condim} is not supported: use 1 or 3")));
            }
            self.condim = condim;
        }
        // bits, which may be written as a negative number
        replace(
            &mut self.contype,
            element.integer::<i32>("contype")?.map(|bits| bits as u32),
        );
        replace(
            &mut self.conaffinity,
            element
                .integer::<i32>("conaffinity")?
                .map(|bits| bits as u32),
        );
        replace(&mut self.margin, element.number("margin")?);
        replace(&mut self.gap, element.number("gap")?);
        replace(&mut self.priority, element.integer("priority")?);
        replace(&mut self.solmix, element.non_negative("solmix")?);
        read_solref(element, "solref", &mut self.solref)?;
        element.up_to("solimp", &mut self.solimp)?;
        replace(&mut self.rgba, element.numbers("rgba")?);
        replace_some(&mut self.material, element.text("material"));
        element.ignore(&["user", "group"]);
        Ok(())
    }
}

/// A site, which is drawn and has a place.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Site {
    pub(super) place: Place,
    pub(super) name: Option<String>,
    pub(super) shape: u8,
    pub(super) size: [f64; 3],
    pub(super) pos: [f64; 3],
    pub(super) orientation: Orientation,
    pub(super) rgba: [f64; 4],
}

impl Default for Site {
    fn default() -> Self {
        let shape = GeomType::Sphere.into();
        Self {
            place: Place::default(),
            name: None,
            shape,
            size: [0.005; 3],
            pos: [0.0; 3],
            orientation: Orientation::default(),
            rgba: GREY,
        }
    }
}

impl Site {
    pub(super) fn read(&mut self, element: &mut Element<'_, '_>) -> Result<()> {
        self.place = element.place();
        let shapes = [
            ("sphere", 2),
            ("capsule", 3),
            ("ellipsoid", 4),
            ("cylinder", 5),
            ("box", 6),
        ];
        replace(&mut self.shape, element.keyword("type", &shapes)?);
        element.up_to("size", &mut self.size)?;
        replace(&mut self.pos, element.numbers("pos")?);
        self.orientation.read(element)?;
        replace(&mut self.rgba, element.numbers("rgba")?);
        element.ignore(&["user", "group", "material"]);
        Ok(())
    }
}

/// A camera.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Camera {
    pub(super) place: Place,
    pub(super) name: Option<String>,
    pub(super) mode: u8,
    pub(super) target: Option<String>,
    pub(super) pos: [f64; 3],
    pub(super) orientation: Orientation,
    pub(super) fovy: f64,
}

impl Camera {
    pub(super) fn read(mut element: Element<'_, '_>) -> Result<Self> {
        let modes = [
            ("fixed", 0),
            ("track", 1),
            ("trackcom", 2),
            ("targetbody", 3),
            ("targetbodycom", 4),
        ];
        let mut camera = Self {
            place: element.place(),
            name: element.text("name"),
            mode: element.keyword("mode", &modes)?.unwrap_or(0),
            target: element.text("target"),
            pos: element.numbers("pos")?.unwrap_or_default(),
            orientation: Orientation::default(),
            fovy: element.number("fovy")?.unwrap_or(45.0),
        };
        if !(camera.fovy > 0.0 && camera.fovy < 180.0) {
            return Err(camera
                .place
                .attribute("fovy", "must lie between 0 and 180 degrees"));
        }
        camera.orientation.read_of_camera(&mut element)?;
        element.ignore(&["user"]);
        element.finish_without_children()?;
        Ok(camera)
    }
}

/// A light. Its colours are ignored: pictures have a light of their own.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Light {
    pub(super) directional: bool,
    pub(super) pos: [f64; 3],
    pub(super) dir: [f64; 3],
}

impl Light {
    pub(super) fn read(mut element: Element<'_, '_>) -> Result<Self> {
        let kind = element.keyword("type", &[("spot", false), ("directional", true)])?;
        let mut light = Self {
            directional: element.flag("directional")?.or(kind).unwrap_or(false),
            pos: element.numbers("pos")?.unwrap_or_default(),
            dir: element.numbers("dir")?.unwrap_or([0.0, 0.0, -1.0]),
        };
        let length = norm(&light.dir);
        if length < EPS {
            return Err(element.place().attribute("dir", "the direction is zero"));
        }
        light.dir = light.dir.map(|x| x / length);
        element.ignore(&[
            "name",
            "class",
            "mode",
            "target",
            "castshadow",
            "active",
            "ambient",
            "diffuse",
            "specular",
            "attenuation",
            "cutoff",
            "exponent",
            "bulbradius",
            "intensity",
            "range",
        ]);
        element.finish_without_children()?;
        Ok(light)
    }
}

/// A pair of bodies that do not collide.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Exclude {
    pub(super) place: Place,
    pub(super) bodies: [String; 2],
}

impl Exclude {
    pub(super) fn read(mut element: Element<'_, '_>) -> Result<Self> {
        element.ignore(&["name"]);
        let bodies = [
            element.required_text("body1")?,
            element.required_text("body2")?,
        ];
        let exclude = Self {
            place: element.place(),
            bodies,
        };
        element.finish_without_children()?;
        Ok(exclude)
    }
}

/// A fixed tendon: a sum of joint positions.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Tendon {
    pub(super) place: Place,
    pub(super) name: Option<String>,
    pub(super) terms: Vec<Term>,
}

/// A joint of a tendon and its coefficient.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Term {
    pub(super) place: Place,
    pub(super) joint: String,
    pub(super) coefficient: f64,
}

impl Tendon {
    pub(super) fn read(mut element: Element<'_, '_>) -> Result<Self> {
        let (place, name) = (element.place(), element.text("name"));
        for force in ["stiffness", "damping", "frictionloss", "armature"] {
            only_zero(&mut element, force, "a tendon with force")?;
        }
        element.keyword("limited", &[("false", ()), ("auto", ())])?;
        element.ignore(&["user", "group", "rgba", "width", "material"]);
        let mut terms = Vec::new();
        for mut child in element.children()? {
            if child.name() != "joint" {
                return Err(element.unsupported(&child, &["joint"]));
            }
            let coefficient = child.number("coef")?.ok_or_else(|| child.missing("coef"))?;
            terms.push(Term {
                place: child.place(),
                joint: child.required_text("joint")?,
                coefficient,
            });
            child.finish_without_children()?;
        }
        if terms.is_empty() {
            return Err(element.error("a tendon needs at least one <joint>"));
        }
        element.finish()?;
        Ok(Self { place, name, terms })
    }
}

/// An actuator that applies a force along a joint.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Motor {
    pub(super) place: Place,
    pub(super) name: Option<String>,
    pub(super) joint: Option<String>,
    pub(super) gear: [f64; 6],
    pub(super) ctrl_range: [f64; 2],
    pub(super) ctrl_limited: Option<bool>,
}

impl Default for Motor {
    fn default() -> Self {
        Self {
            place: Place::default(),
            name: None,
            joint: None,
            gear: [1.0, 0.0, 0.0, 0.0, 0.0, 0.0],
            ctrl_range: [0.0; 2],
            ctrl_limited: None,
        }
    }
}

impl Motor {
    pub(super) fn read(&mut self, element: &mut Element<'_, '_>) -> Result<()> {
        self.place = element.place();
        replace_some(&mut self.joint, element.text("joint"));
        element.up_to("gear", &mut self.gear)?;
        replace(&mut self.ctrl_range, element.numbers("ctrlrange")?);
        replace(
            &mut self.ctrl_limited,
            element.keyword("ctrllimited", &LIMITED)?,
        );
        element.ignore(&["user", "group"]);
        Ok(())
    }
}

/// A stored state; what is not given is that of the initial configuration.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Key {
    pub(super) place: Place,
    pub(super) time: f64,
    pub(super) qpos: Option<Vec<f64>>,
    pub(super) qvel: Option<Vec<f64>>,
    pub(super) ctrl: Option<Vec<f64>>,
}

impl Key {
    pub(super) fn read(mut element: Element<'_, '_>) -> Result<Self> {
        element.ignore(&["name"]);
        let key = Self {
            place: element.place(),
            time: element.number("time")?.unwrap_or(0.0),
            qpos: element.list("qpos")?,
            qvel: element.list("qvel")?,
            ctrl: element.list("ctrl")?,
        };
        element.finish_without_children()?;
        Ok(key)
    }
}

/// Reads the softness of a constraint. MuJoCo's direct form, which is negative, is not supported.
fn read_solref(
    element: &mut Element<'_, '_>,
    name: &'static str,
    solref: &mut [f64; 2],
) -> Result<()> {
    element.up_to(name, solref)?;
    if solref.iter().any(|x| *x <= 0.0) {
        let reason = "time constant and damping ratio must be positive: the direct form, with negative numbers, is not supported";
        return Err(element.place().attribute(name, reason));
    }
    Ok(())
}

/// Reads an attribute that may be there, but only to say that there is none of what it is about.
fn only_zero(element: &mut Element<'_, '_>, name: &'static str, what: &str) -> Result<()> {
    match element.number(name)? {
        Some(x) if x != 0.0 => Err(element
            .place()
            .attribute(name, format!("{what} is not supported: use 0"))),
        _ => Ok(()),
    }
}

fn replace<T>(value: &mut T, given: Option<T>) {
    if let Some(given) = given {
        *value = given;
    }
}

fn replace_some<T>(value: &mut Option<T>, given: Option<T>) {
    if given.is_some() {
        *value = given;
    }
}
