//! The cost of actions.

use gym_core::Array;

use super::numpy;

/// A weight times the sum of the squared actions, in the precision in which these come.
///
/// Since numpy 2 the product of single precision has it too; with numpy 1, on which versions 2 and
/// 3 were recorded, the weight made it double.
#[derive(Clone, Copy, Debug)]
pub(super) struct ControlCost {
    weight: f64,
    single: bool,
}

impl ControlCost {
    pub(super) fn new(weight: f64, version: u32) -> Self {
        Self {
            weight,
            single: version >= 4,
        }
    }

    pub(super) fn of(self, action: &Array) -> f64 {
        let sum = action.as_slice().map(numpy::sum_of_squares_f32);
        // beyond single precision Gymnasium's is infinite
        let Some(sum) = sum.filter(|sum| sum.is_finite()) else {
            return self.weight * numpy::sum_of_squares(action.len(), |i| action.data().get_f64(i));
        };
        if self.single {
            f64::from(self.weight as f32 * sum)
        } else {
            self.weight * f64::from(sum)
        }
    }
}
