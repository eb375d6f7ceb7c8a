//! Arrays that a model may leave out: those of features that it does not use.

use serde::{Deserialize, Serialize};

use super::{
    BiasType, CompiledModel, DynamicsType, GainType, ObjectType, TransmissionType, WrapType,
};

/// Numbers of an actuator's dynamics, gain or bias: ten, of which the last may be left out where
/// they are read.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(from = "Vec<f64>")]
pub struct Parameters(pub [f64; 10]);

impl From<Vec<f64>> for Parameters {
    fn from(numbers: Vec<f64>) -> Self {
        let mut all = Self::default();
        for (to, from) in all.0.iter_mut().zip(numbers) {
            *to = from;
        }
        all
    }
}

/// How the medium acts on a geom: whether it does as on an ellipsoid, five coefficients, virtual
/// masses and virtual moments. What is left out where they are read is zero.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(from = "Numbers")]
pub struct Fluid(pub [f64; 12]);

/// A number, or several.
#[derive(Deserialize)]
#[serde(untagged)]
enum Numbers {
    One(f64),
    Several(Vec<f64>),
}

impl From<Numbers> for Fluid {
    fn from(numbers: Numbers) -> Self {
        let numbers = match numbers {
            Numbers::One(number) => vec![number],
            Numbers::Several(numbers) => numbers,
        };
        let mut all = Self::default();
        for (to, from) in all.0.iter_mut().zip(numbers) {
            *to = from;
        }
        all
    }
}

const SOLREF: [f64; 2] = [0.02, 1.0];
const SOLIMP: [f64; 5] = [0.9, 0.95, 0.001, 0.5, 2.0];

/// Fills an array that is empty.
fn fill<T: Clone>(array: &mut Vec<T>, length: usize, value: &T) {
    if array.is_empty() {
        array.resize(length, value.clone());
    }
}

/// Fills those that are empty with one value.
macro_rules! fill_all {
    ($m:ident, $length:expr, $value:expr => $($field:ident)+) => {
        let (length, value) = ($length, $value);
        $(fill(&mut $m.$field, length, &value);)+
    };
}

impl CompiledModel {
    /// Fills arrays of features that the model does not use: an empty one says that there is none.
    pub(super) fn complete(&mut self) {
        let (nbody, njnt, nv, ngeom) = (self.nbody(), self.njnt(), self.nv(), self.ngeom());
        let (nu, ntendon, nkey) = (self.nu(), self.ntendon(), self.key_time.len());
        fill_all!(self, nbody, -1 => body_mocapid);
        fill_all!(self, nbody, 0.0 => body_gravcomp);
        fill_all!(self, njnt, false => jnt_actfrclimited jnt_actgravcomp);
        fill_all!(self, njnt, [0.0; 2] => jnt_actfrcrange);
        fill_all!(self, nv, 0.0 => dof_frictionloss);
        fill_all!(self, nv, SOLREF => dof_solref);
        fill_all!(self, nv, SOLIMP => dof_solimp);
        fill_all!(self, ngeom, Fluid::default() => geom_fluid);
        fill_all!(self, nu, TransmissionType::Joint => actuator_trntype);
        fill_all!(self, nu, DynamicsType::None => actuator_dyntype);
        fill_all!(self, nu, GainType::Fixed => actuator_gaintype);
        fill_all!(self, nu, BiasType::None => actuator_biastype);
        let mut one = Parameters::default();
        one.0[0] = 1.0;
        fill_all!(self, nu, one => actuator_dynprm actuator_gainprm);
        fill_all!(self, nu, Parameters::default() => actuator_biasprm);
        fill_all!(self, nu, false => actuator_forcelimited actuator_actlimited actuator_actearly);
        fill_all!(self, nu, [0.0; 2] => actuator_forcerange actuator_actrange actuator_lengthrange);
        fill_all!(self, nu, -1 => actuator_actadr);
        fill_all!(self, nu, 0 => actuator_group);
        fill_all!(self, nu, 0.0 => actuator_length0 actuator_acc0);
        fill_all!(self, ntendon, false => tendon_limited tendon_actfrclimited);
        fill_all!(self, ntendon, [0.0; 2] => tendon_range tendon_actfrcrange tendon_lengthspring);
        fill_all!(self, ntendon, 0.0 => tendon_margin tendon_stiffness tendon_damping
            tendon_frictionloss tendon_length0 tendon_invweight0);
        fill_all!(self, ntendon, SOLREF => tendon_solref_lim tendon_solref_fri);
        fill_all!(self, ntendon, SOLIMP => tendon_solimp_lim tendon_solimp_fri);
        fill_all!(self, self.wrap_objid.len(), WrapType::Joint => wrap_type);
        fill_all!(self, self.neq(), ObjectType::Body => eq_objtype);
        fill_all!(self, nkey, Vec::new() => key_act key_mpos key_mquat);
    }
}
