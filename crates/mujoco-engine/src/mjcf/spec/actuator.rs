//! Actuators. Each kind is a `general` actuator whose other parameters are implied.

use std::rc::Rc;

use super::{Compiler, LIMITED, replace, replace_some};
use crate::Result;
use crate::mjcf::xml::{Element, Place};
use crate::model::{BiasType, DynamicsType, GainType};

/// One number, and zeros.
const ONE: [f64; 10] = [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];

with_defaults! {
    /// An actuator.
    struct Actuator {
        place: Place = Place::default(),
        /// The element that set the parameters, one of the [`KINDS`].
        kind: &'static str = "general",
        name: Option<String> = None,
        /// The settings of the model that has the element.
        compiler: Rc<Compiler> = Rc::default(),
        /// The attribute that names the target, and the target's name.
        target: Option<(&'static str, String)> = None,
        reference_site: Option<String> = None,
        slider_site: Option<String> = None,
        crank_length: f64 = 0.0,
        gear: [f64; 6] = [1.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        ctrl_range: [f64; 2] = [0.0; 2],
        ctrl_limited: Option<bool> = None,
        force_range: [f64; 2] = [0.0; 2],
        force_limited: Option<bool> = None,
        act_range: [f64; 2] = [0.0; 2],
        act_limited: Option<bool> = None,
        length_range: [f64; 2] = [0.0; 2],
        /// `inheritrange`: the range of the control or of the activation, as a share of the
        /// target's range.
        inherit_range: f64 = 0.0,
        dynamics: DynamicsType = DynamicsType::None,
        gain: GainType = GainType::Fixed,
        bias: BiasType = BiasType::None,
        dynprm: [f64; 10] = ONE,
        gainprm: [f64; 10] = ONE,
        biasprm: [f64; 10] = [0.0; 10],
        act_early: bool = false,
        group: i32 = 0,
        /// The number of the attachment that added it, and its own in that model, if that model's
        /// keyframes hold for it.
        stored: Option<(usize, usize)> = None,
    }
}

/// The names of the elements.
pub(crate) const KINDS: [&str; 9] = [
    "general",
    "motor",
    "position",
    "velocity",
    "intvelocity",
    "damper",
    "cylinder",
    "muscle",
    "adhesion",
];

const TARGETS: [&str; 6] = [
    "joint",
    "jointinparent",
    "tendon",
    "cranksite",
    "site",
    "body",
];

impl Actuator {
    /// Whether an element `kind` can take parameters from these defaults, in 4.0.
    pub(crate) fn fits(&self, kind: &str) -> bool {
        let gain = match kind {
            "damper" => GainType::Affine,
            "muscle" => GainType::Muscle,
            _ => GainType::Fixed,
        };
        self.kind == kind || self.kind == "general" && self.gain == gain
    }

    /// Takes from `defaults` the parameters that an element `kind` has, and the initial values of
    /// all others, as 4.0 does.
    pub(crate) fn take(&mut self, kind: &str, defaults: &Self) {
        let initial = Self::default();
        let servo = matches!(kind, "position" | "intvelocity");
        let filtered = servo && defaults.dynamics == DynamicsType::FilterExact;
        let (gain, bias, dynamics) = match kind {
            "motor" => (0..0, 0..0, 0..0),
            "position" | "intvelocity" => (0..1, 2..3, 0..usize::from(filtered)),
            "velocity" | "adhesion" => (0..1, 0..0, 0..0),
            "damper" => (2..3, 0..0, 0..0),
            "cylinder" => (0..1, 0..3, 0..1),
            _ => (0..9, 0..0, 0..3),
        };
        self.gain = defaults.gain;
        self.dynamics = if filtered {
            DynamicsType::FilterExact
        } else {
            DynamicsType::None
        };
        self.inherit_range = if servo { defaults.inherit_range } else { 0.0 };
        for (own, kept, initial, defaults) in [
            (&mut self.gainprm, gain, initial.gainprm, &defaults.gainprm),
            (&mut self.biasprm, bias, initial.biasprm, &defaults.biasprm),
            (&mut self.dynprm, dynamics, initial.dynprm, &defaults.dynprm),
        ] {
            *own = initial;
            own[kept.clone()].copy_from_slice(&defaults[kept]);
        }
    }

    /// Reads an element of one of the [`KINDS`].
    pub(crate) fn read(&mut self, element: &mut Element<'_, '_>) -> Result<()> {
        self.place = element.place();
        let kind = KINDS.into_iter().find(|kind| *kind == element.name());
        self.kind = kind.unwrap_or(self.kind);
        for target in TARGETS {
            if let Some(name) = element.text(target)? {
                self.target = Some((target, name));
            }
        }
        replace_some(&mut self.reference_site, element.text("refsite")?);
        replace_some(&mut self.slider_site, element.text("slidersite")?);
        replace(&mut self.crank_length, element.number("cranklength")?);
        element.up_to("gear", &mut self.gear)?;
        for (name, range) in [
            ("ctrlrange", &mut self.ctrl_range),
            ("forcerange", &mut self.force_range),
            ("actrange", &mut self.act_range),
            ("lengthrange", &mut self.length_range),
        ] {
            replace(range, element.numbers(name)?);
        }
        for (name, limited) in [
            ("ctrllimited", &mut self.ctrl_limited),
            ("forcelimited", &mut self.force_limited),
            ("actlimited", &mut self.act_limited),
        ] {
            element.set_keyword(name, &LIMITED, limited)?;
        }
        replace(&mut self.act_early, element.flag("actearly")?);
        replace(&mut self.group, element.integer("group")?);
        element.ignore("user");
        match element.name() {
            "general" => self.read_general(element),
            "motor" => {
                self.gainprm[0] = 1.0;
                self.imply(DynamicsType::None, GainType::Fixed, BiasType::None);
                Ok(())
            }
            "position" | "intvelocity" => self.read_servo(element),
            "velocity" => {
                let kv = element.number("kv")?.unwrap_or(self.gainprm[0]);
                self.biasprm = [0.0; 10];
                (self.gainprm[0], self.biasprm[2]) = (kv, -kv);
                self.imply(DynamicsType::None, GainType::Fixed, BiasType::Affine);
                Ok(())
            }
            "damper" => self.read_damper(element),
            "cylinder" => self.read_cylinder(element),
            "adhesion" => {
                element.set_non_negative("gain", &mut self.gainprm[0])?;
                self.ctrl_limited = Some(true);
                // the dynamics of a class of another kind remain, as in libmujoco
                self.imply(self.dynamics, GainType::Fixed, BiasType::None);
                if self.ctrl_range.iter().any(|x| *x < 0.0) {
                    let reason = "must not be negative here";
                    return Err(self.place.attribute("ctrlrange", reason));
                }
                Ok(())
            }
            _ => self.read_muscle(element),
        }
    }

    fn imply(&mut self, dynamics: DynamicsType, gain: GainType, bias: BiasType) {
        (self.dynamics, self.gain, self.bias) = (dynamics, gain, bias);
    }

    fn read_general(&mut self, element: &mut Element<'_, '_>) -> Result<()> {
        let dynamics = [
            ("none", DynamicsType::None),
            ("integrator", DynamicsType::Integrator),
            ("filter", DynamicsType::Filter),
            ("filterexact", DynamicsType::FilterExact),
            ("muscle", DynamicsType::Muscle),
        ];
        // the meaning of the control in files that MuJoCo 4.0 saves, which has no effect
        element.keyword("input", &[("pos", ()), ("vel", ()), ("pressure", ())])?;
        element.set_keyword("dyntype", &dynamics, &mut self.dynamics)?;
        let gains = [
            ("fixed", GainType::Fixed),
            ("affine", GainType::Affine),
            ("muscle", GainType::Muscle),
        ];
        element.set_keyword("gaintype", &gains, &mut self.gain)?;
        let biases = [
            ("none", BiasType::None),
            ("affine", BiasType::Affine),
            ("muscle", BiasType::Muscle),
        ];
        element.set_keyword("biastype", &biases, &mut self.bias)?;
        element.up_to("dynprm", &mut self.dynprm)?;
        element.up_to("gainprm", &mut self.gainprm)?;
        element.up_to("biasprm", &mut self.biasprm)?;
        Ok(())
    }

    /// Reads a servo: `position`, or `intvelocity`, which integrates its control to a position.
    fn read_servo(&mut self, element: &mut Element<'_, '_>) -> Result<()> {
        let kp = element.number("kp")?.unwrap_or(self.gainprm[0]);
        (self.gainprm[0], self.biasprm[1]) = (kp, -kp);
        let (kv, ratio) = (
            element.non_negative("kv")?,
            element.non_negative("dampratio")?,
        );
        match (kv, ratio) {
            (Some(_), Some(_)) => {
                return Err(self.place.attribute("dampratio", "does not go with kv"));
            }
            (Some(kv), None) => self.biasprm[2] = -kv,
            (None, Some(ratio)) => self.biasprm[2] = ratio,
            (None, None) => {}
        }
        self.imply(self.dynamics, GainType::Fixed, BiasType::Affine);
        if let Some(time) = element.non_negative("timeconst")? {
            self.dynprm[0] = time;
            self.dynamics = if time == 0.0 {
                DynamicsType::None
            } else {
                DynamicsType::FilterExact
            };
        }
        element.set_non_negative("inheritrange", &mut self.inherit_range)?;
        let integrates = element.name() == "intvelocity";
        let range = if integrates {
            self.dynamics = DynamicsType::Integrator;
            ("actrange", self.act_range)
        } else {
            ("ctrlrange", self.ctrl_range)
        };
        if self.inherit_range > 0.0 && range.1 != [0.0; 2] {
            let reason = format!("does not go with {}", range.0);
            return Err(self.place.attribute("inheritrange", reason));
        }
        Ok(())
    }

    fn read_damper(&mut self, element: &mut Element<'_, '_>) -> Result<()> {
        let inherited = if self.gain == GainType::Affine {
            -self.gainprm[2]
        } else {
            0.0
        };
        let kv = element.non_negative("kv")?.unwrap_or(inherited);
        self.gainprm = [0.0; 10];
        self.gainprm[2] = -kv;
        self.ctrl_limited = Some(true);
        self.imply(DynamicsType::None, GainType::Affine, BiasType::None);
        if self.ctrl_range.iter().any(|x| *x < 0.0) {
            let reason = "must not be negative here";
            return Err(self.place.attribute("ctrlrange", reason));
        }
        Ok(())
    }

    fn read_cylinder(&mut self, element: &mut Element<'_, '_>) -> Result<()> {
        replace(&mut self.dynprm[0], element.number("timeconst")?);
        element.up_to("bias", &mut self.biasprm[..3])?;
        replace(&mut self.gainprm[0], element.number("area")?);
        if let Some(diameter) = element.non_negative("diameter")? {
            self.gainprm[0] = std::f64::consts::PI / 4.0 * diameter * diameter;
        }
        self.imply(DynamicsType::Filter, GainType::Fixed, BiasType::Affine);
        Ok(())
    }

    fn read_muscle(&mut self, element: &mut Element<'_, '_>) -> Result<()> {
        // for a muscle, the defaults of `general` are replaced by the muscle's own
        for (k, general, own) in [(0, 1.0, 0.01), (1, 0.0, 0.04)] {
            if self.dynprm[k] == general {
                self.dynprm[k] = own;
            }
        }
        let defaults = [0.75, 1.05, -1.0, 200.0, 0.5, 1.6, 1.5, 1.3, 1.2];
        for (k, (value, own)) in self.gainprm.iter_mut().zip(defaults).enumerate() {
            let general = if k == 0 { 1.0 } else { 0.0 };
            if *value == general {
                *value = own;
            }
        }
        element.up_to("timeconst", &mut self.dynprm[..2])?;
        element.set_non_negative("tausmooth", &mut self.dynprm[2])?;
        element.up_to("range", &mut self.gainprm[..2])?;
        let names = ["force", "scale", "lmin", "lmax", "vmax", "fpmax", "fvmax"];
        for (name, value) in names.into_iter().zip(&mut self.gainprm[2..]) {
            element.set_non_negative(name, value)?;
        }
        let p = &self.gainprm;
        if p[0] >= p[1] {
            return Err(self.place.attribute("range", "must rise"));
        }
        if p[4] >= 1.0 || p[5] <= 1.0 {
            let reason = "must be less than 1, and lmax greater";
            return Err(self.place.attribute("lmin", reason));
        }
        if [p[3], p[6], p[7], p[8]].iter().any(|x| *x <= 0.0) {
            let reason = "scale, vmax, fpmax and fvmax must be positive";
            return Err(self.place.error(reason));
        }
        self.biasprm = self.gainprm;
        self.imply(DynamicsType::Muscle, GainType::Muscle, BiasType::Muscle);
        Ok(())
    }
}
