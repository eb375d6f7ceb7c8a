//! Exclusions and contact pairs.

use super::{SOLIMP, SOLREF, read_condim, read_solimp, read_solref, replace, replace_some};
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
        element.ignore("name class");
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

with_defaults! {
    /// A pair of geoms that collide, and its contact parameters. Missing parameters have these
    /// defaults. MuJoCo's manual says that they are averages of the two geoms' parameters, but
    /// MuJoCo 3.12 to 4.0.1 never averages them for a model that it reads from XML.
    struct Pair {
        place: Place = Place::default(),
        name: Option<String> = None,
        geoms: [Option<String>; 2] = [None, None],
        condim: u8 = 3,
        friction: [f64; 5] = [1.0, 1.0, 0.005, 0.0001, 0.0001],
        solref: [f64; 2] = SOLREF,
        solref_friction: [f64; 2] = [0.0; 2],
        solimp: [f64; 5] = SOLIMP,
        margin: f64 = 0.0,
        gap: f64 = 0.0,
        adhesion: f64 = 0.0,
    }
}

impl Pair {
    pub(crate) fn read(&mut self, element: &mut Element<'_, '_>) -> Result<()> {
        self.place = element.place();
        for (name, geom) in ["geom1", "geom2"].into_iter().zip(&mut self.geoms) {
            replace_some(geom, element.text(name)?);
        }
        replace(&mut self.condim, read_condim(element)?);
        element.up_to("friction", &mut self.friction)?;
        read_solref(element, "solref", &mut self.solref)?;
        element.up_to("solreffriction", &mut self.solref_friction)?;
        read_solimp(element, "solimp", &mut self.solimp)?;
        replace(&mut self.margin, element.number("margin")?);
        replace(&mut self.gap, element.number("gap")?);
        element.set_non_negative("adhesion", &mut self.adhesion)?;
        Ok(())
    }
}
