//! Equality constraints.

use super::{SOLIMP, SOLREF, read_solimp, read_solref, replace};
use crate::Result;
use crate::mjcf::xml::{Element, Place};
use crate::model::EqualityType;

with_defaults! {
    /// An equality constraint.
    struct Equality {
        place: Place = Place::default(),
        name: Option<String> = None,
        kind: EqualityType = EqualityType::Connect,
        /// Whether the names are of sites, not of bodies.
        sites: bool = false,
        names: [Option<String>; 2] = [None, None],
        active: bool = true,
        solref: [f64; 2] = SOLREF,
        solimp: [f64; 5] = SOLIMP,
        data: [f64; 11] = [0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0],
    }
}

/// The kinds, and the attributes that name their objects.
pub(crate) const EQUALITIES: [(&str, EqualityType, [&str; 2]); 4] = [
    ("connect", EqualityType::Connect, ["body1", "body2"]),
    ("weld", EqualityType::Weld, ["body1", "body2"]),
    ("joint", EqualityType::Joint, ["joint1", "joint2"]),
    ("tendon", EqualityType::Tendon, ["tendon1", "tendon2"]),
];

impl Equality {
    /// Whether the names are of bodies.
    pub(crate) fn relates_bodies(&self) -> bool {
        matches!(self.kind, EqualityType::Connect | EqualityType::Weld) && !self.sites
    }

    /// Reads the attributes that all kinds share.
    pub(crate) fn read_common(&mut self, element: &mut Element<'_, '_>) -> Result<()> {
        self.place = element.place();
        replace(&mut self.active, element.flag("active")?);
        read_solref(element, "solref", &mut self.solref)?;
        read_solimp(element, "solimp", &mut self.solimp)?;
        Ok(())
    }

    /// Reads an element of one of the kinds.
    pub(crate) fn read(
        &mut self,
        element: &mut Element<'_, '_>,
        kind: EqualityType,
        [first, second]: [&'static str; 2],
    ) -> Result<()> {
        self.read_common(element)?;
        self.kind = kind;
        self.names = [element.text(first)?, element.text(second)?];
        match kind {
            EqualityType::Connect | EqualityType::Weld => {
                let sites = [element.text("site1")?, element.text("site2")?];
                let anchor = element.numbers::<3>("anchor")?;
                self.data[1] = 0.0;
                if kind == EqualityType::Weld {
                    if let Some(pose) = element.numbers::<7>("relpose")? {
                        self.data[3..10].copy_from_slice(&pose);
                    }
                    replace(&mut self.data[10], element.number("torquescale")?);
                }
                if self.names[0].is_none() {
                    (self.sites, self.names) = (true, sites);
                    let named = self.names.iter().all(Option::is_some);
                    if !named {
                        return Err(element.error("needs body1, or site1 and site2"));
                    }
                    return Ok(());
                }
                if kind == EqualityType::Connect && anchor.is_none() {
                    return Err(element.missing("anchor"));
                }
                self.data[..3].copy_from_slice(&anchor.unwrap_or_default());
            }
            EqualityType::Joint | EqualityType::Tendon => {
                if self.names[0].is_none() {
                    return Err(element.missing(first));
                }
                element.up_to("polycoef", &mut self.data[..5])?;
            }
        }
        Ok(())
    }
}
