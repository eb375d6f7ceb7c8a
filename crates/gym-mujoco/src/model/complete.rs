//! Fills arrays that a serialised model may leave out because it does not use their feature.

use serde::{Deserialize, Serialize};

use super::{
    BiasType, CompiledModel, DynamicsType, GainType, ObjectType, TransmissionType, WrapType,
};

/// Parameters of an actuator's dynamics, gain or bias: ten numbers. A serialised list may be
/// shorter; the missing numbers are zero.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(from = "Vec<f64>")]
pub struct Parameters(pub [f64; 10]);

impl From<Vec<f64>> for Parameters {
    fn from(numbers: Vec<f64>) -> Self {
        Self(padded(&numbers))
    }
}

/// The first `N` numbers of a list; zeros after its end.
fn padded<const N: usize>(numbers: &[f64]) -> [f64; N] {
    std::array::from_fn(|k| numbers.get(k).copied().unwrap_or(0.0))
}

/// Fluid coefficients of a geom: 1 for the ellipsoid model (else 0), five coefficients, virtual
/// masses and virtual moments. A serialised list may be shorter; the missing numbers are zero.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(from = "Numbers")]
pub struct Fluid(pub [f64; 12]);

/// A number or a list of numbers.
#[derive(Deserialize)]
#[serde(untagged)]
enum Numbers {
    One(f64),
    Several(Vec<f64>),
}

impl From<Numbers> for Fluid {
    fn from(numbers: Numbers) -> Self {
        Self(match numbers {
            Numbers::One(number) => padded(&[number]),
            Numbers::Several(numbers) => padded(&numbers),
        })
    }
}

/// The default reference of constraints: time constant, damping ratio.
pub(crate) const SOLREF: [f64; 2] = [0.02, 1.0];
/// The default impedance of constraints: dmin, dmax, width, midpoint, power.
pub(crate) const SOLIMP: [f64; 5] = [0.9, 0.95, 0.001, 0.5, 2.0];

/// Fills an empty array with `length` copies of `value`.
fn fill<T: Clone>(length: usize, value: T, array: &mut Vec<T>) {
    if array.is_empty() {
        *array = vec![value; length];
    }
}

impl CompiledModel {
    /// Fills arrays of features that the model does not use: an empty array means that the feature
    /// is unused.
    pub(super) fn complete(&mut self) {
        let (nbody, njnt, nv, ngeom) = (self.nbody(), self.njnt(), self.nv(), self.ngeom());
        let (nu, ntendon, nkey) = (self.nu(), self.ntendon(), self.key_time.len());
        let (nwrap, neq) = (self.wrap_objid.len(), self.neq());
        fill(nbody, -1, &mut self.body_mocapid);
        fill(nbody, 0.0, &mut self.body_gravcomp);
        fill(njnt, false, &mut self.jnt_actfrclimited);
        fill(njnt, false, &mut self.jnt_actgravcomp);
        fill(njnt, [0.0; 2], &mut self.jnt_actfrcrange);
        fill(nv, 0.0, &mut self.dof_frictionloss);
        fill(nv, SOLREF, &mut self.dof_solref);
        fill(nv, SOLIMP, &mut self.dof_solimp);
        fill(ngeom, Fluid::default(), &mut self.geom_fluid);
        fill(nu, TransmissionType::Joint, &mut self.actuator_trntype);
        fill(nu, DynamicsType::None, &mut self.actuator_dyntype);
        fill(nu, GainType::Fixed, &mut self.actuator_gaintype);
        fill(nu, BiasType::None, &mut self.actuator_biastype);
        let mut one = Parameters::default();
        one.0[0] = 1.0;
        fill(nu, one, &mut self.actuator_dynprm);
        fill(nu, one, &mut self.actuator_gainprm);
        fill(nu, Parameters::default(), &mut self.actuator_biasprm);
        fill(nu, false, &mut self.actuator_forcelimited);
        fill(nu, false, &mut self.actuator_actlimited);
        fill(nu, false, &mut self.actuator_actearly);
        fill(nu, [0.0; 2], &mut self.actuator_forcerange);
        fill(nu, [0.0; 2], &mut self.actuator_actrange);
        fill(nu, [0.0; 2], &mut self.actuator_lengthrange);
        fill(nu, -1, &mut self.actuator_actadr);
        fill(nu, 0, &mut self.actuator_group);
        fill(nu, 0.0, &mut self.actuator_length0);
        fill(nu, 0.0, &mut self.actuator_acc0);
        fill(ntendon, false, &mut self.tendon_limited);
        fill(ntendon, false, &mut self.tendon_actfrclimited);
        fill(ntendon, [0.0; 2], &mut self.tendon_range);
        fill(ntendon, [0.0; 2], &mut self.tendon_actfrcrange);
        fill(ntendon, [0.0; 2], &mut self.tendon_lengthspring);
        fill(ntendon, 0.0, &mut self.tendon_margin);
        fill(ntendon, 0.0, &mut self.tendon_stiffness);
        fill(ntendon, 0.0, &mut self.tendon_damping);
        fill(ntendon, 0.0, &mut self.tendon_frictionloss);
        fill(ntendon, 0.0, &mut self.tendon_length0);
        fill(ntendon, 0.0, &mut self.tendon_invweight0);
        fill(ntendon, SOLREF, &mut self.tendon_solref_lim);
        fill(ntendon, SOLREF, &mut self.tendon_solref_fri);
        fill(ntendon, SOLIMP, &mut self.tendon_solimp_lim);
        fill(ntendon, SOLIMP, &mut self.tendon_solimp_fri);
        fill(nwrap, WrapType::Joint, &mut self.wrap_type);
        fill(neq, ObjectType::Body, &mut self.eq_objtype);
        fill(nkey, Vec::new(), &mut self.key_act);
        fill(nkey, Vec::new(), &mut self.key_mpos);
        fill(nkey, Vec::new(), &mut self.key_mquat);
    }
}
