//! Joints, geoms and sites.

use std::rc::Rc;

use super::{
    Compiler, GREY, LIMITED, SOLIMP, SOLREF, read_condim, read_solimp, read_solref, replace,
    replace_some,
};
use crate::Result;
use crate::math::spatial::EPS;
use crate::mjcf::orientation::{Orientation, norm};
use crate::mjcf::xml::{Element, Place};
use crate::model::{GeomType, JointType};

/// The position and the quaternion of an element `frame`, relative to its body.
pub(crate) type Frame = ([f64; 3], [f64; 4]);

with_defaults! {
    /// A joint.
    struct Joint {
        place: Place = Place::default(),
        name: Option<String> = None,
        /// The settings of the model that has the element.
        compiler: Rc<Compiler> = Rc::default(),
        kind: JointType = JointType::Hinge,
        pos: [f64; 3] = [0.0; 3],
        axis: [f64; 3] = [0.0, 0.0, 1.0],
        range: [f64; 2] = [0.0; 2],
        limited: Option<bool> = None,
        reference: f64 = 0.0,
        spring_reference: f64 = 0.0,
        /// The factors of the displacement, its square and its cube.
        stiffness: [f64; 3] = [0.0; 3],
        damping: [f64; 3] = [0.0; 3],
        /// The time constant and the damping ratio that determine stiffness and damping.
        spring_damper: [f64; 2] = [0.0; 2],
        armature: f64 = 0.0,
        friction_loss: f64 = 0.0,
        margin: f64 = 0.0,
        solref: [f64; 2] = SOLREF,
        solimp: [f64; 5] = SOLIMP,
        solref_friction: [f64; 2] = SOLREF,
        solimp_friction: [f64; 5] = SOLIMP,
        /// The range of the actuators' force, and whether it applies.
        force_range: [f64; 2] = [0.0; 2],
        force_limited: Option<bool> = None,
        actuator_gravcomp: bool = false,
        /// `align` of a free joint; `None` is `auto`.
        align: Option<bool> = None,
        frame: Option<Frame> = None,
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
        element.set_keyword("type", &kinds, &mut self.kind)?;
        replace(&mut self.pos, element.numbers("pos")?);
        if let Some(axis) = element.numbers::<3>("axis")? {
            if norm(&axis) < EPS {
                return Err(self.place.attribute("axis", "the axis is zero"));
            }
            self.axis = axis;
        }
        replace(&mut self.range, element.numbers("range")?);
        element.set_keyword("limited", &LIMITED, &mut self.limited)?;
        replace(&mut self.reference, element.number("ref")?);
        replace(&mut self.spring_reference, element.number("springref")?);
        element.polynomial("stiffness", &mut self.stiffness)?;
        element.polynomial("damping", &mut self.damping)?;
        element.set_non_negative("armature", &mut self.armature)?;
        element.set_non_negative("margin", &mut self.margin)?;
        if let Some(numbers) = element.numbers::<2>("springdamper")? {
            if numbers != [0.0; 2] && numbers.iter().any(|x| *x <= 0.0) {
                let reason = "time constant and damping ratio must be positive";
                return Err(self.place.attribute("springdamper", reason));
            }
            self.spring_damper = numbers;
        }
        element.set_non_negative("frictionloss", &mut self.friction_loss)?;
        read_solref(element, "solreflimit", &mut self.solref)?;
        read_solimp(element, "solimplimit", &mut self.solimp)?;
        read_solref(element, "solreffriction", &mut self.solref_friction)?;
        read_solimp(element, "solimpfriction", &mut self.solimp_friction)?;
        replace(&mut self.force_range, element.numbers("actuatorfrcrange")?);
        element.set_keyword("actuatorfrclimited", &LIMITED, &mut self.force_limited)?;
        replace(
            &mut self.actuator_gravcomp,
            element.flag("actuatorgravcomp")?,
        );
        element.ignore("user group");
        Ok(())
    }

    /// A `freejoint`, which has no defaults.
    pub(crate) fn read_free(mut element: Element<'_, '_>) -> Result<Self> {
        let mut joint = Self {
            place: element.place(),
            kind: JointType::Free,
            ..Self::default()
        };
        element.set_keyword("align", &LIMITED, &mut joint.align)?;
        element.ignore("group");
        element.finish_without_children()?;
        Ok(joint)
    }
}

with_defaults! {
    /// A geom.
    struct Geom {
        place: Place = Place::default(),
        name: Option<String> = None,
        /// The settings of the model that has the element.
        compiler: Rc<Compiler> = Rc::default(),
        shape: GeomType = GeomType::Sphere,
        size: [f64; 3] = [0.0; 3],
        pos: Option<[f64; 3]> = None,
        orientation: Orientation = Orientation::default(),
        fromto: Option<[f64; 6]> = None,
        density: f64 = 1000.0,
        mass: Option<f64> = None,
        friction: [f64; 3] = [1.0, 0.005, 0.0001],
        condim: u8 = 3,
        contype: u32 = 1,
        conaffinity: u32 = 1,
        margin: f64 = 0.0,
        gap: f64 = 0.0,
        adhesion: f64 = 0.0,
        priority: i32 = 0,
        solmix: f64 = 1.0,
        solref: [f64; 2] = SOLREF,
        solimp: [f64; 5] = SOLIMP,
        rgba: [f64; 4] = GREY,
        material: Option<String> = None,
        mesh: Option<String> = None,
        hfield: Option<String> = None,
        /// The factor of a size that is fitted to a mesh.
        fit_scale: f64 = 1.0,
        group: i32 = 0,
        /// Whether the mass lies on the surface.
        shell: bool = false,
        /// Whether fluid forces use the ellipsoid model, and its coefficients.
        fluid_ellipsoid: bool = false,
        fluid: [f64; 5] = [0.5, 0.25, 1.5, 1.0, 1.0],
        surface_velocity: [f64; 6] = [0.0; 6],
        frame: Option<Frame> = None,
    }
}

impl Geom {
    pub(crate) fn read(&mut self, element: &mut Element<'_, '_>) -> Result<()> {
        self.place = element.place();
        let shapes = [
            ("plane", GeomType::Plane),
            ("hfield", GeomType::Hfield),
            ("sphere", GeomType::Sphere),
            ("capsule", GeomType::Capsule),
            ("ellipsoid", GeomType::Ellipsoid),
            ("cylinder", GeomType::Cylinder),
            ("box", GeomType::Box),
            ("mesh", GeomType::Mesh),
        ];
        element.set_keyword("type", &shapes, &mut self.shape)?;
        element.up_to("size", &mut self.size)?;
        replace_some(&mut self.pos, element.numbers("pos")?);
        self.orientation.read(element)?;
        replace_some(&mut self.fromto, element.numbers("fromto")?);
        element.set_non_negative("density", &mut self.density)?;
        replace_some(&mut self.mass, element.non_negative("mass")?);
        element.up_to("friction", &mut self.friction)?;
        if self.friction.iter().any(|x| *x < 0.0) {
            return Err(self.place.attribute("friction", "must not be negative"));
        }
        replace(&mut self.condim, read_condim(element)?);
        // bit masks, which may be given as negative numbers
        for (name, bits) in [
            ("contype", &mut self.contype),
            ("conaffinity", &mut self.conaffinity),
        ] {
            let given = element.integer::<i32>(name)?;
            replace(bits, given.map(|bits| bits as u32));
        }
        replace(&mut self.margin, element.number("margin")?);
        replace(&mut self.gap, element.number("gap")?);
        element.set_non_negative("adhesion", &mut self.adhesion)?;
        replace(&mut self.priority, element.integer("priority")?);
        element.set_non_negative("solmix", &mut self.solmix)?;
        read_solref(element, "solref", &mut self.solref)?;
        read_solimp(element, "solimp", &mut self.solimp)?;
        replace(&mut self.rgba, element.numbers("rgba")?);
        replace_some(&mut self.material, element.text("material")?);
        replace_some(&mut self.mesh, element.text("mesh")?);
        replace_some(&mut self.hfield, element.text("hfield")?);
        replace(&mut self.fit_scale, element.number("fitscale")?);
        replace(&mut self.group, element.integer("group")?);
        replace(&mut self.shell, element.flag("shellinertia")?);
        let shapes = [("none", false), ("ellipsoid", true)];
        element.set_keyword("fluidshape", &shapes, &mut self.fluid_ellipsoid)?;
        element.up_to("fluidcoef", &mut self.fluid)?;
        element.up_to("surfacevel", &mut self.surface_velocity)?;
        element.ignore("user");
        Ok(())
    }
}

with_defaults! {
    /// A site: a visible point to which sensors, tendons and actuators refer.
    struct Site {
        place: Place = Place::default(),
        name: Option<String> = None,
        /// The settings of the model that has the element.
        compiler: Rc<Compiler> = Rc::default(),
        shape: u8 = GeomType::Sphere.into(),
        size: [f64; 3] = [0.005; 3],
        pos: [f64; 3] = [0.0; 3],
        orientation: Orientation = Orientation::default(),
        fromto: Option<[f64; 6]> = None,
        rgba: [f64; 4] = GREY,
        group: i32 = 0,
        frame: Option<Frame> = None,
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
        element.set_keyword("type", &shapes, &mut self.shape)?;
        element.up_to("size", &mut self.size)?;
        replace(&mut self.pos, element.numbers("pos")?);
        self.orientation.read(element)?;
        replace_some(&mut self.fromto, element.numbers("fromto")?);
        replace(&mut self.rgba, element.numbers("rgba")?);
        replace(&mut self.group, element.integer("group")?);
        element.ignore("user material");
        Ok(())
    }
}
