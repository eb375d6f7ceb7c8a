//! The cost of actions.

use super::numpy;

/// A weight times the sum of the squared actions, which are of single precision.
///
/// Since numpy 2 the product has single precision too; with numpy 1, on which versions 2 and 3 were recorded, the weight
/// made it double.
#[derive(Clone, Copy, Debug)]
pub(super) struct ControlCost {
    weight: f64,
    single: bool,
}

impl ControlCost {
    pub(super) fn new(weight: f64, version: u32) -> Self {
        Self { weight, single: version >= 4 }
    }

    pub(super) fn of(self, action: &[f32]) -> f64 {
        let sum = numpy::sum_of_squares_f32(action);
        if !sum.is_finite() {
            // beyond single precision Gymnasium's is infinite
            return self.weight * numpy::sum_of_squares(action.len(), |i| f64::from(action[i]));
        }
        if self.single { f64::from(self.weight as f32 * sum) } else { self.weight * f64::from(sum) }
    }
}
