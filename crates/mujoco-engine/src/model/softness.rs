//! The softness of constraints: MuJoCo's solver parameters `solref` and `solimp`.

use super::{Disable, Options};
use crate::math::spatial::MINVAL;

/// The default reference of constraints: time constant, damping ratio.
pub(crate) const SOLREF: [f64; 2] = [0.02, 1.0];
/// The default impedance of constraints: dmin, dmax, width, midpoint, power.
pub(crate) const SOLIMP: [f64; 5] = [0.9, 0.95, 0.001, 0.5, 2.0];

/// Impedances are clamped to this range: MuJoCo's `mjMINIMP` and `mjMAXIMP`.
const IMPEDANCE: [f64; 2] = [1e-4, 0.9999];

/// Impedance and reference acceleration of a constraint, as functions of its position.
#[derive(Clone, Debug)]
pub(crate) struct Softness {
    pub(crate) stiffness: f64,
    pub(crate) damping: f64,
    pub(crate) dmin: f64,
    pub(crate) dmax: f64,
    pub(crate) width: f64,
    pub(crate) midpoint: f64,
    pub(crate) power: f64,
}

impl Softness {
    /// MuJoCo's `getsolparam` and the stiffness and damping of `mj_makeImpedance`.
    pub(crate) fn new(solref: [f64; 2], solimp: [f64; 5], opt: &Options) -> Self {
        let [dmin, dmax, width, midpoint, power] = solimp;
        let [dmin, dmax, midpoint] =
            [dmin, dmax, midpoint].map(|x| x.clamp(IMPEDANCE[0], IMPEDANCE[1]));
        let [mut time, ratio] = solref;
        if time > 0.0 && !opt.disables(Disable::RefSafe) {
            time = time.max(2.0 * opt.timestep);
        }
        Self {
            stiffness: if time > 0.0 {
                1.0 / f64::max(MINVAL, dmax * dmax * time * time * ratio * ratio)
            } else {
                -time / f64::max(MINVAL, dmax * dmax)
            },
            damping: if ratio > 0.0 {
                2.0 / f64::max(MINVAL, dmax * time)
            } else {
                -ratio / f64::max(MINVAL, dmax)
            },
            dmin,
            dmax,
            width: width.max(0.0),
            midpoint,
            power: power.max(1.0),
        }
    }
}
