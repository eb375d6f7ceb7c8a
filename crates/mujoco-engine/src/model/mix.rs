//! Contact parameters mixed from the two geoms.

use super::CompiledModel;
use crate::math::spatial::MINVAL;

/// The parameters of a contact.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Mixed {
    pub(crate) dim: u8,
    pub(crate) friction: [f64; 3],
    pub(crate) solref: [f64; 2],
    pub(crate) solimp: [f64; 5],
}

impl CompiledModel {
    /// The parameters of the geom with higher priority. For equal priority, the greater `condim`,
    /// the greater friction, and solref and solimp averaged by weight: MuJoCo's `mj_contactParam`.
    pub(crate) fn mixed(&self, g1: usize, g2: usize) -> Mixed {
        let (priority1, priority2) = (self.geom_priority[g1], self.geom_priority[g2]);
        if priority1 != priority2 {
            let g = if priority1 > priority2 { g1 } else { g2 };
            return Mixed {
                dim: self.geom_condim[g],
                friction: self.geom_friction[g],
                solref: self.geom_solref[g],
                solimp: self.geom_solimp[g],
            };
        }
        let weight = weight(self.geom_solmix[g1], self.geom_solmix[g2]);
        let blend = |a: f64, b: f64| weight * a + (1.0 - weight) * b;
        let (solref1, solref2) = (self.geom_solref[g1], self.geom_solref[g2]);
        let direct = solref1[0] <= 0.0 || solref2[0] <= 0.0;
        Mixed {
            dim: self.geom_condim[g1].max(self.geom_condim[g2]),
            friction: std::array::from_fn(|k| {
                self.geom_friction[g1][k].max(self.geom_friction[g2][k])
            }),
            solref: std::array::from_fn(|k| {
                if direct {
                    solref1[k].min(solref2[k])
                } else {
                    blend(solref1[k], solref2[k])
                }
            }),
            solimp: std::array::from_fn(|k| {
                blend(self.geom_solimp[g1][k], self.geom_solimp[g2][k])
            }),
        }
    }
}

/// The weight of the first geom in the average.
fn weight(s1: f64, s2: f64) -> f64 {
    match (s1 >= MINVAL, s2 >= MINVAL) {
        (true, true) => s1 / (s1 + s2),
        (false, false) => 0.5,
        (first, _) => f64::from(u8::from(first)),
    }
}
