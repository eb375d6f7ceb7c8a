//! The cost of actions.

use gym_core::Array;

use gym_sim::numpy;

/// A weight times the sum of the squared actions, in the precision of the action.
///
/// With numpy 2, the product of the weight and a single-precision sum has single precision. With
/// numpy 1, with which versions 2 and 3 were recorded, the product has double precision.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ControlCost {
    weight: f64,
    single: bool,
}

impl ControlCost {
    pub(crate) fn new(weight: f64, version: u32) -> Self {
        Self {
            weight,
            single: version >= 4,
        }
    }

    pub(crate) fn of(self, action: &Array) -> f64 {
        let sum = action.as_slice().map(numpy::sum_of_squares_f32);
        // Gymnasium's sum in single precision may overflow to infinity; this sum is in double
        // precision
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
