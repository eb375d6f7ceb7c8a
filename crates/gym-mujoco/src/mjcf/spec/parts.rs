//! Joints, geoms and sites.

use super::{GREY, LIMITED, SOLIMP, SOLREF, read_solref, replace, replace_some};
use crate::Result;
use crate::mjcf::orientation::{EPS, Orientation, norm};
use crate::mjcf::xml::{Element, Place};
use crate::model::{GeomType, JointType};

/// A frame within a body, in which parts are given: position and quaternion.
pub(crate) type Frame = ([f64; 3], [f64; 4]);

/// A joint.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Joint {
    pub(crate) place: Place,
    pub(crate) name: Option<String>,
    pub(crate) kind: JointType,
    pub(crate) pos: [f64; 3],
    pub(crate) axis: [f64; 3],
    pub(crate) range: [f64; 2],
    pub(crate) limited: Option<bool>,
    pub(crate) reference: f64,
    pub(crate) spring_reference: f64,
    pub(crate) stiffness: f64,
    pub(crate) damping: f64,
    /// Time constant and damping ratio that stiffness and damping follow from.
    pub(crate) spring_damper: [f64; 2],
    pub(crate) armature: f64,
    pub(crate) friction_loss: f64,
    pub(crate) margin: f64,
    pub(crate) solref: [f64; 2],
    pub(crate) solimp: [f64; 5],
    pub(crate) solref_friction: [f64; 2],
    pub(crate) solimp_friction: [f64; 5],
    /// The range of the actuators' force, and whether it holds.
    pub(crate) force_range: [f64; 2],
    pub(crate) force_limited: Option<bool>,
    pub(crate) actuator_gravcomp: bool,
    pub(crate) frame: Option<Frame>,
}

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
            spring_damper: [0.0; 2],
            armature: 0.0,
            friction_loss: 0.0,
            margin: 0.0,
            solref: SOLREF,
            solimp: SOLIMP,
            solref_friction: SOLREF,
            solimp_friction: SOLIMP,
            force_range: [0.0; 2],
            force_limited: None,
            actuator_gravcomp: false,
            frame: None,
        }
    }
}

impl Joint {
    pub(crate) fn read(&mut self, element: &mut Element<'_, '_>) -> Result<()> {
        self.place = element.place();
        let kinds = [
            ("free", JointType::Free),
            ("ball", JointType::Ball),
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
        if let Some(numbers) = element.numbers::<2>("springdamper")? {
            if numbers != [0.0; 2] && numbers.iter().any(|x| *x <= 0.0) {
                let reason = "time constant and damping ratio must be positive";
                return Err(self.place.attribute("springdamper", reason));
            }
            self.spring_damper = numbers;
        }
        replace(
            &mut self.friction_loss,
            element.non_negative("frictionloss")?,
        );
        read_solref(element, "solreflimit", &mut self.solref)?;
        element.up_to("solimplimit", &mut self.solimp)?;
        read_solref(element, "solreffriction", &mut self.solref_friction)?;
        element.up_to("solimpfriction", &mut self.solimp_friction)?;
        replace(&mut self.force_range, element.numbers("actuatorfrcrange")?);
        replace(
            &mut self.force_limited,
            element.keyword("actuatorfrclimited", &LIMITED)?,
        );
        replace(
            &mut self.actuator_gravcomp,
            element.flag("actuatorgravcomp")?,
        );
        element.ignore(&["user", "group"]);
        Ok(())
    }

    /// A `freejoint`, which has no defaults.
    pub(crate) fn read_free(mut element: Element<'_, '_>) -> Result<Self> {
        let joint = Self {
            place: element.place(),
            kind: JointType::Free,
            ..Self::default()
        };
        element.keyword("align", &[("false", ()), ("auto", ())])?;
        element.ignore(&["group"]);
        element.finish_without_children()?;
        Ok(joint)
    }
}

/// A geom.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Geom {
    pub(crate) place: Place,
    pub(crate) name: Option<String>,
    pub(crate) shape: GeomType,
    pub(crate) size: [f64; 3],
    pub(crate) pos: Option<[f64; 3]>,
    pub(crate) orientation: Orientation,
    pub(crate) fromto: Option<[f64; 6]>,
    pub(crate) density: f64,
    pub(crate) mass: Option<f64>,
    pub(crate) friction: [f64; 3],
    pub(crate) condim: u8,
    pub(crate) contype: u32,
    pub(crate) conaffinity: u32,
    pub(crate) margin: f64,
    pub(crate) gap: f64,
    pub(crate) priority: i32,
    pub(crate) solmix: f64,
    pub(crate) solref: [f64; 2],
    pub(crate) solimp: [f64; 5],
    pub(crate) rgba: [f64; 4],
    pub(crate) material: Option<String>,
    pub(crate) group: i32,
    /// Whether the mass is on the surface.
    pub(crate) shell: bool,
    /// Whether the medium acts on the shape as an ellipsoid, and how strongly.
    pub(crate) fluid_ellipsoid: bool,
    pub(crate) fluid: [f64; 5],
    pub(crate) frame: Option<Frame>,
}

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
            group: 0,
            shell: false,
            fluid_ellipsoid: false,
            fluid: [0.5, 0.25, 1.5, 1.0, 1.0],
            frame: None,
        }
    }
}

impl Geom {
    pub(crate) fn read(&mut self, element: &mut Element<'_, '_>) -> Result<()> {
        self.place = element.place();
        let shapes = [
            ("plane", GeomType::Plane),
            ("sphere", GeomType::Sphere),
            ("capsule", GeomType::Capsule),
            ("ellipsoid", GeomType::Ellipsoid),
            ("cylinder", GeomType::Cylinder),
            ("box", GeomType::Box),
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
            if !matches!(condim, 1 | 3 | 4 | 6) {
                return Err(self
                    .place
                    .attribute("condim", format!("is {condim}: use 1, 3, 4 or 6")));
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
        replace(&mut self.group, element.integer("group")?);
        replace(&mut self.shell, element.flag("shellinertia")?);
        let shapes = [("none", false), ("ellipsoid", true)];
        replace(
            &mut self.fluid_ellipsoid,
            element.keyword("fluidshape", &shapes)?,
        );
        element.up_to("fluidcoef", &mut self.fluid)?;
        element.ignore(&["user"]);
        Ok(())
    }
}

/// A site: a place that is drawn, and where sensors, tendons and actuators act.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Site {
    pub(crate) place: Place,
    pub(crate) name: Option<String>,
    pub(crate) shape: u8,
    pub(crate) size: [f64; 3],
    pub(crate) pos: [f64; 3],
    pub(crate) orientation: Orientation,
    pub(crate) fromto: Option<[f64; 6]>,
    pub(crate) rgba: [f64; 4],
    pub(crate) frame: Option<Frame>,
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
            fromto: None,
            rgba: GREY,
            frame: None,
        }
    }
}

impl Site {
    pub(crate) fn read(&mut self, element: &mut Element<'_, '_>) -> Result<()> {
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
        replace_some(&mut self.fromto, element.numbers("fromto")?);
        replace(&mut self.rgba, element.numbers("rgba")?);
        element.ignore(&["user", "group", "material"]);
        Ok(())
    }
}
