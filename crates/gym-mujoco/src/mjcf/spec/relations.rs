//! Exclusions, contact pairs, equality constraints and keyframes.

use super::{SOLIMP, SOLREF, read_solref, replace, replace_some};
use crate::Result;
use crate::mjcf::xml::{Element, Place};
use crate::model::EqualityType;

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
    }
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
            self.condim = condim;
        }
        element.up_to("friction", &mut self.friction)?;
        read_solref(element, "solref", &mut self.solref)?;
        element.up_to("solreffriction", &mut self.solref_friction)?;
        element.up_to("solimp", &mut self.solimp)?;
        replace(&mut self.margin, element.number("margin")?);
        replace(&mut self.gap, element.number("gap")?);
        Ok(())
    }
}

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
    /// Reads the attributes that all kinds share.
    pub(crate) fn read_common(&mut self, element: &mut Element<'_, '_>) -> Result<()> {
        self.place = element.place();
        replace(&mut self.active, element.flag("active")?);
        read_solref(element, "solref", &mut self.solref)?;
        element.up_to("solimp", &mut self.solimp)?;
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
        self.names = [element.text(first), element.text(second)];
        match kind {
            EqualityType::Connect | EqualityType::Weld => {
                let sites = [element.text("site1"), element.text("site2")];
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

/// A keyframe. Missing parts have the values of the initial configuration.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Key {
    pub(crate) place: Place,
    pub(crate) name: Option<String>,
    pub(crate) time: f64,
    pub(crate) qpos: Option<Vec<f64>>,
    pub(crate) qvel: Option<Vec<f64>>,
    pub(crate) act: Option<Vec<f64>>,
    pub(crate) ctrl: Option<Vec<f64>>,
    pub(crate) mpos: Option<Vec<f64>>,
    pub(crate) mquat: Option<Vec<f64>>,
}

impl Key {
    pub(crate) fn read(mut element: Element<'_, '_>) -> Result<Self> {
        let key = Self {
            place: element.place(),
            name: element.text("name"),
            time: element.number("time")?.unwrap_or(0.0),
            qpos: element.list("qpos")?,
            qvel: element.list("qvel")?,
            act: element.list("act")?,
            ctrl: element.list("ctrl")?,
            mpos: element.list("mpos")?,
            mquat: element.list("mquat")?,
        };
        element.finish_without_children()?;
        Ok(key)
    }
}
