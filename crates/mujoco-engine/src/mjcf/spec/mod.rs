//! The elements of a model as the text gives them, before anything is computed from them.
//!
//! Each kind of element is a struct whose `Default` has MuJoCo's defaults. `read` replaces the
//! values that the element gives. An element of a class starts from a clone of the class's struct,
//! so that defaults need no code of their own.

/// A struct whose fields are declared with MuJoCo's defaults.
macro_rules! with_defaults {
    ($(#[$about:meta])* struct $name:ident { $($(#[$doc:meta])* $field:ident: $type:ty = $value:expr,)+ }) => {
        $(#[$about])*
        #[derive(Clone, Debug, PartialEq)]
        pub(crate) struct $name { $($(#[$doc])* pub(crate) $field: $type,)+ }

        impl Default for $name {
            fn default() -> Self {
                Self { $($field: $value,)+ }
            }
        }
    };
}

mod actuator;
mod body;
mod contact;
mod equality;
mod hfield;
mod keyframe;
mod mesh;
mod parts;
mod sensor;
mod tendon;
mod texture;

pub(crate) use actuator::{Actuator, KINDS as ACTUATORS};
pub(crate) use body::{Attached, Body, Camera, Inertial, Light, Moments, Sleep};
pub(crate) use contact::{Exclude, Pair};
pub(crate) use equality::{EQUALITIES, Equality};
pub(crate) use hfield::Hfield;
pub(crate) use keyframe::{Key, Stored};
pub(crate) use mesh::Mesh;
pub use mesh::{Inertia, Options as MeshOptions};
pub(crate) use parts::{Frame, Geom, Joint, Site};
pub(crate) use sensor::{Sensor, Target};
pub(crate) use tendon::{Tendon, Wrap};
pub(crate) use texture::{Mark, Material, Pattern, Pixels, Texture};

use std::path::PathBuf;
use std::rc::Rc;

use super::xml::{Element, Place};
use crate::model::{Options, SOLIMP, SOLREF};
use crate::{Error, Result, Revision};

/// The name of an asset, and its file in `folder` beside the model. An asset without a name has that
/// of its file.
fn file_of(
    element: &mut Element<'_, '_>,
    folder: &str,
    strip: bool,
) -> Result<(String, Option<PathBuf>)> {
    let file = element.text("file")?;
    let bare = |file: &str| {
        let last = file.rsplit(['/', '\\']).next();
        last.unwrap_or_default().to_owned()
    };
    let name = match (element.text("name")?, &file) {
        (Some(name), _) => name,
        (None, Some(file)) => {
            let name = bare(file);
            let stem = name.rsplit_once('.').map(|(stem, _)| stem.to_owned());
            stem.unwrap_or(name)
        }
        (None, None) => return Err(element.missing("name")),
    };
    let path = match file {
        Some(file) if strip => Some(element.find("file", folder, &bare(&file))?),
        Some(file) => Some(element.find("file", folder, &file)?),
        None => None,
    };
    Ok((name, path))
}

/// A whole model.
#[derive(Debug, Default)]
pub(crate) struct Spec {
    pub(crate) name: String,
    pub(crate) revision: Revision,
    pub(crate) compiler: Rc<Compiler>,
    pub(crate) option: Options,
    /// The first element `option`.
    pub(crate) optional: Option<Place>,
    pub(crate) statistic: Statistic,
    pub(crate) nkey: usize,
    pub(crate) materials: Vec<Material>,
    pub(crate) textures: Vec<Texture>,
    pub(crate) meshes: Vec<Mesh>,
    pub(crate) hfields: Vec<Hfield>,
    /// The flag `sleep`, if it is enabled.
    pub(crate) sleep: Option<Place>,
    /// Whether there are elements `replicate` or `attach`.
    pub(crate) copies: bool,
    pub(crate) attached: Vec<Attached>,
    /// The world, then the others, each after its parent.
    pub(crate) bodies: Vec<Body>,
    pub(crate) excludes: Vec<Exclude>,
    pub(crate) pairs: Vec<Pair>,
    pub(crate) equalities: Vec<Equality>,
    pub(crate) tendons: Vec<Tendon>,
    pub(crate) actuators: Vec<Actuator>,
    pub(crate) sensors: Vec<Sensor>,
    pub(crate) keys: Vec<Key>,
    /// Those of attached models.
    pub(crate) attached_keys: Vec<Key>,
}

impl Spec {
    /// Adds a line and element of the XML to `error`, an error of the compiled model, if it has none.
    pub(crate) fn located(&self, error: Error) -> Error {
        match self.bodies.first() {
            Some(world) if !matches!(error, Error::Mjcf { .. }) => {
                world.place.error(error.to_string())
            }
            _ => error,
        }
    }
}

with_defaults! {
    /// Settings of the compiler.
    struct Compiler {
        degree: bool = true,
        autolimits: bool = true,
        /// `None` is MJCF's `auto`: geoms give the inertia of bodies without an element `inertial`.
        inertia_from_geom: Option<bool> = None,
        /// The groups of geoms that have mass.
        inertia_groups: [i32; 2] = [0, 5],
        total_mass: Option<f64> = None,
        bound_mass: f64 = 0.0,
        bound_inertia: f64 = 0.0,
        balance_inertia: bool = false,
        /// The folder of mesh files, beside the model.
        mesh_folder: String = String::new(),
        /// The folder of texture files, beside the model.
        texture_folder: String = String::new(),
        /// Whether names of files lose their folders.
        strip_path: bool = false,
        /// Whether shapes are fitted to the bounds of a mesh, not to its inertia.
        fit_bounds: bool = false,
        length_range: LengthRange = LengthRange::default(),
        fuse_static: bool = false,
        discard_visual: bool = false,
        align_free: bool = false,
        /// Whether options of attached models have no effect.
        keeps_options: bool = true,
        euler: Sequence = [(0, false), (1, false), (2, false)],
    }
}

with_defaults! {
    /// How the ranges of the lengths of actuators are measured.
    struct LengthRange {
        /// Whether those of muscles are, and those of other actuators.
        muscles: bool = true,
        others: bool = false,
        use_existing: bool = true,
        use_limit: bool = false,
        acceleration: f64 = 20.0,
        max_force: f64 = 0.0,
        time_constant: f64 = 1.0,
        timestep: f64 = 0.01,
        total: f64 = 10.0,
        interval: f64 = 2.0,
        tolerance: f64 = 0.05,
    }
}

impl LengthRange {
    /// The largest number of timesteps.
    const MOST_STEPS: f64 = 1e6;

    fn read(&mut self, mut element: Element<'_, '_>) -> Result<()> {
        let modes = [
            ("none", (false, false)),
            ("muscle", (true, false)),
            ("muscleuser", (true, false)),
            ("all", (true, true)),
        ];
        if let Some((muscles, others)) = element.keyword("mode", &modes)? {
            (self.muscles, self.others) = (muscles, others);
        }
        replace(&mut self.use_existing, element.flag("useexisting")?);
        replace(&mut self.use_limit, element.flag("uselimit")?);
        element.set_non_negative("accel", &mut self.acceleration)?;
        element.set_non_negative("maxforce", &mut self.max_force)?;
        element.set_non_negative("timeconst", &mut self.time_constant)?;
        replace(&mut self.timestep, element.positive("timestep")?);
        element.set_non_negative("inttotal", &mut self.total)?;
        element.set_non_negative("interval", &mut self.interval)?;
        element.set_non_negative("tolrange", &mut self.tolerance)?;
        if self.total / self.timestep > Self::MOST_STEPS {
            let most = Self::MOST_STEPS;
            let reason = format!("more than {most} timesteps are not supported");
            return Err(element.place().attribute("inttotal", reason));
        }
        element.finish_without_children()
    }

    /// Whether the range of an actuator is measured.
    pub(crate) fn wants(&self, muscle: bool) -> bool {
        if muscle { self.muscles } else { self.others }
    }
}

/// The axis of each Euler angle, and whether that axis is fixed.
pub(crate) type Sequence = [(usize, bool); 3];

impl Compiler {
    pub(crate) fn read(&mut self, mut element: Element<'_, '_>) -> Result<()> {
        let angles = [("degree", true), ("radian", false)];
        element.set_keyword("angle", &angles, &mut self.degree)?;
        element.keyword("coordinate", &[("local", ())])?;
        let choices = [("auto", None), ("false", Some(false)), ("true", Some(true))];
        element.set_keyword("inertiafromgeom", &choices, &mut self.inertia_from_geom)?;
        if let Some(mass) = element.number("settotalmass")? {
            self.total_mass = (mass > 0.0).then_some(mass);
        }
        replace(&mut self.autolimits, element.flag("autolimits")?);
        element.set_non_negative("boundmass", &mut self.bound_mass)?;
        element.set_non_negative("boundinertia", &mut self.bound_inertia)?;
        replace(&mut self.balance_inertia, element.flag("balanceinertia")?);
        if let Some([first, last]) = element.numbers("inertiagrouprange")? {
            self.inertia_groups = [first as i32, last as i32];
        }
        if let Some(text) = element.text("eulerseq")? {
            self.euler = sequence(&text).ok_or_else(|| {
                element
                    .place()
                    .attribute("eulerseq", "needs three of xyzXYZ")
            })?;
        }
        if let Some(folder) = element.text("assetdir")? {
            self.mesh_folder.clone_from(&folder);
            self.texture_folder = folder;
        }
        replace(&mut self.mesh_folder, element.text("meshdir")?);
        replace(&mut self.texture_folder, element.text("texturedir")?);
        replace(&mut self.strip_path, element.flag("strippath")?);
        replace(&mut self.fit_bounds, element.flag("fitaabb")?);
        // attributes of files that are not read, and attributes without effect on the compiled
        // model
        let policies = [("warning", true), ("merge", false), ("error", false)];
        element.set_keyword("conflict", &policies, &mut self.keeps_options)?;
        element.ignore("usethread saveinertial");
        replace(&mut self.fuse_static, element.flag("fusestatic")?);
        replace(&mut self.discard_visual, element.flag("discardvisual")?);
        replace(&mut self.align_free, element.flag("alignfree")?);
        for child in element.children()? {
            if child.name() != "lengthrange" {
                return Err(element.unsupported(&child, &["lengthrange"]));
            }
            self.length_range.read(child)?;
        }
        element.finish()
    }
}

/// Statistics that a model may give instead of having them computed.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Statistic {
    pub(crate) meaninertia: Option<f64>,
    pub(crate) meanmass: Option<f64>,
    pub(crate) meansize: Option<f64>,
    pub(crate) extent: Option<f64>,
    pub(crate) center: Option<[f64; 3]>,
}

/// Reads `condim`, the number of dimensions of a contact's force.
fn read_condim(element: &mut Element<'_, '_>) -> Result<Option<u8>> {
    match element.integer("condim")? {
        None => Ok(None),
        Some(condim) if matches!(condim, 1 | 3 | 4 | 6) => Ok(Some(condim)),
        Some(condim) => {
            let reason = format!("is {condim}: use 1, 3, 4 or 6");
            Err(element.place().attribute("condim", reason))
        }
    }
}

/// Reads `solref`: time constant and damping ratio, or MuJoCo's direct form, in which both are
/// negative.
fn read_solref(
    element: &mut Element<'_, '_>,
    name: &'static str,
    solref: &mut [f64; 2],
) -> Result<()> {
    element.up_to(name, solref)?;
    let [first, second] = *solref;
    if (first > 0.0) == (second > 0.0) && first != 0.0 {
        return Ok(());
    }
    let reason = "time constant and damping ratio must be positive, or stiffness and damping both \
                  not positive";
    Err(element.place().attribute(name, reason))
}

/// Reads `solimp`: dmin, dmax, width, midpoint, power. The engine clamps them, as MuJoCo does.
fn read_solimp(
    element: &mut Element<'_, '_>,
    name: &'static str,
    solimp: &mut [f64; 5],
) -> Result<()> {
    element.up_to(name, solimp).map(|_| ())
}

/// The axes in a text such as `xyz`. Capital letters name fixed axes.
fn sequence(text: &str) -> Option<Sequence> {
    let axis = |letter: char| {
        let small = letter.to_ascii_lowercase();
        Some(("xyz".find(small)?, letter.is_ascii_uppercase()))
    };
    let axes: Option<Vec<_>> = text.chars().map(axis).collect();
    axes?.try_into().ok()
}

/// The values of a `limited` attribute. `auto` means limited if there is a range.
const LIMITED: [(&str, Option<bool>); 3] =
    [("auto", None), ("false", Some(false)), ("true", Some(true))];

const GREY: [f64; 4] = [0.5, 0.5, 0.5, 1.0];

/// Replaces a value if a new value is given.
pub(crate) fn replace<T>(value: &mut T, given: Option<T>) {
    if let Some(given) = given {
        *value = given;
    }
}

fn replace_some<T>(value: &mut Option<T>, given: Option<T>) {
    if given.is_some() {
        *value = given;
    }
}
