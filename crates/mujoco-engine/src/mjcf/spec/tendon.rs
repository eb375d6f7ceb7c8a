//! Tendons.

use std::rc::Rc;

use super::{Compiler, LIMITED, SOLIMP, SOLREF, read_solimp, read_solref, replace, replace_some};
use crate::Result;
use crate::mjcf::xml::{Element, Place};

with_defaults! {
    /// A tendon: a sum of joint positions, or a path through sites and around geoms.
    struct Tendon {
        place: Place = Place::default(),
        name: Option<String> = None,
        /// The settings of the model that has the element.
        compiler: Rc<Compiler> = Rc::default(),
        limited: Option<bool> = None,
        range: [f64; 2] = [0.0; 2],
        /// `actuatorfrclimited`; `None` if the attribute is missing, `Some(None)` for `auto`.
        force_limited: Option<Option<bool>> = None,
        force_range: [f64; 2] = [0.0; 2],
        margin: f64 = 0.0,
        solref: [f64; 2] = SOLREF,
        solimp: [f64; 5] = SOLIMP,
        solref_friction: [f64; 2] = SOLREF,
        solimp_friction: [f64; 5] = SOLIMP,
        friction_loss: f64 = 0.0,
        /// The factors of the displacement, its square and its cube.
        stiffness: [f64; 3] = [0.0; 3],
        damping: [f64; 3] = [0.0; 3],
        armature: f64 = 0.0,
        /// The lengths between which the spring is slack; -1 for the length in the initial
        /// configuration.
        spring_length: [f64; 2] = [-1.0; 2],
        wraps: Vec<(Place, Wrap)> = Vec::new(),
    }
}

/// A part of a tendon.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Wrap {
    /// A joint and its coefficient.
    Joint(String, f64),
    Site(String),
    /// A geom that the tendon wraps around, and its side site.
    Geom(String, Option<String>),
    Pulley(f64),
}

impl Tendon {
    /// Reads the attributes, which both kinds of tendon share.
    pub(crate) fn read(&mut self, element: &mut Element<'_, '_>) -> Result<()> {
        self.place = element.place();
        element.set_keyword("limited", &LIMITED, &mut self.limited)?;
        replace(&mut self.range, element.numbers("range")?);
        let limited = element.keyword("actuatorfrclimited", &LIMITED)?;
        replace_some(&mut self.force_limited, limited);
        replace(&mut self.force_range, element.numbers("actuatorfrcrange")?);
        replace(&mut self.margin, element.number("margin")?);
        read_solref(element, "solreflimit", &mut self.solref)?;
        read_solimp(element, "solimplimit", &mut self.solimp)?;
        read_solref(element, "solreffriction", &mut self.solref_friction)?;
        read_solimp(element, "solimpfriction", &mut self.solimp_friction)?;
        element.set_non_negative("frictionloss", &mut self.friction_loss)?;
        element.polynomial("stiffness", &mut self.stiffness)?;
        element.polynomial("damping", &mut self.damping)?;
        element.set_non_negative("armature", &mut self.armature)?;
        if element.up_to("springlength", &mut self.spring_length)? == 1 {
            self.spring_length[1] = self.spring_length[0];
        }
        element.ignore("user group rgba width material");
        Ok(())
    }

    /// Reads the path.
    pub(crate) fn read_path(&mut self, element: &Element<'_, '_>) -> Result<()> {
        let parts: &[&str] = match element.name() {
            "fixed" => &["joint"],
            _ => &["site", "geom", "pulley"],
        };
        for mut child in element.children()? {
            let place = child.place();
            if !parts.contains(&child.name()) {
                return Err(element.unsupported(&child, parts));
            }
            let wrap = match child.name() {
                "joint" => {
                    let coef = child.number("coef")?.ok_or_else(|| child.missing("coef"))?;
                    Wrap::Joint(child.required_text("joint")?, coef)
                }
                "site" => Wrap::Site(child.required_text("site")?),
                "geom" => Wrap::Geom(child.required_text("geom")?, child.text("sidesite")?),
                _ => Wrap::Pulley(
                    child
                        .non_negative("divisor")?
                        .ok_or_else(|| child.missing("divisor"))?,
                ),
            };
            child.finish_without_children()?;
            self.wraps.push((place, wrap));
        }
        if self.wraps.is_empty() {
            return Err(element.error(format!("needs elements within: {}", parts.join(", "))));
        }
        Ok(())
    }
}
