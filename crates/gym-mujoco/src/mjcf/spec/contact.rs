//! Exclusions and contact pairs.

use super::{SOLIMP, SOLREF, read_solref, replace_some};
use crate::Result;
use crate::mjcf::xml::{Element, Place};

/// A pair of bodies that do not collide.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Exclude {
    pub(crate) place: Place,
    pub(crate) bodies: [String; 2],
}

impl Exclude {
    pub(crate) fn read(mut element: Element<'_, '_>) -> Result<Self> {
        element.ignore(&["name", "class"]);
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

/// A pair of geoms that collide, and its contact parameters.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Pair {
    pub(crate) place: Place,
    pub(crate) name: Option<String>,
    pub(crate) geoms: [Option<String>; 2],
    pub(crate) condim: Option<u8>,
    pub(crate) friction: Option<[f64; 5]>,
    pub(crate) solref: Option<[f64; 2]>,
    pub(crate) solref_friction: [f64; 2],
    pub(crate) solimp: Option<[f64; 5]>,
    pub(crate) margin: Option<f64>,
    pub(crate) gap: Option<f64>,
}

impl Pair {
    pub(crate) fn read(&mut self, element: &mut Element<'_, '_>) -> Result<()> {
        self.place = element.place();
        for (name, geom) in ["geom1", "geom2"].into_iter().zip(&mut self.geoms) {
            replace_some(geom, element.text(name));
        }
        if let Some(condim) = element.integer("condim")? {
            if !matches!(condim, 1 | 3 | 4 | 6) {
                return Err(self
                    .place
                    .attribute("condim", format!("is {condim}: use 1, 3, 4 or 6")));
            }
            self.condim = Some(condim);
        }
        let mut friction = self.friction.unwrap_or([1.0, 1.0, 0.005, 0.0001, 0.0001]);
        if element.up_to("friction", &mut friction)? > 0 {
            self.friction = Some(friction);
        }
        let mut solref = self.solref.unwrap_or(SOLREF);
        if element.has("solref") {
            read_solref(element, "solref", &mut solref)?;
            self.solref = Some(solref);
        }
        element.up_to("solreffriction", &mut self.solref_friction)?;
        let mut solimp = self.solimp.unwrap_or(SOLIMP);
        if element.up_to("solimp", &mut solimp)? > 0 {
            self.solimp = Some(solimp);
        }
        replace_some(&mut self.margin, element.number("margin")?);
        replace_some(&mut self.gap, element.number("gap")?);
        Ok(())
    }
}
