//! dm_control's `tolerance`: a function of a number with the value 1 within bounds, falling to 0
//! outside. Most rewards are products of such values.
//!
//! Source: dm_control 1.0.45, `utils/rewards.py`.

use gym_core::math;

/// `sqrt(-2 ln 0.1)`: the scale at which the Gaussian is 0.1 at a distance of 1.
const GAUSSIAN: f64 = 2.145966026289347;

/// The decrease of the value outside the bounds, as a function of the distance in margins.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Sigmoid {
    /// A normal distribution, with the value 0.1 at the margin.
    Gaussian,
    /// A line to the given value at the margin, continued to 0.
    Linear(f64),
    /// A parabola to the given value at the margin, continued to 0.
    Quadratic(f64),
    /// `1 / (1 + (3 d)²)`: an inverse square, with the value 0.1 at the margin.
    LongTail,
    /// `1 / (1 + 9 d)`: a hyperbola, with the value 0.1 at the margin.
    Reciprocal,
}

/// A function that is 1 within bounds and decreases outside: dm_control's `tolerance`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerance {
    /// The lower bound.
    pub low: f64,
    /// The upper bound.
    pub high: f64,
    /// The distance from the bounds at which the sigmoid has its value at the margin. If it is 0,
    /// the value is 0 outside the bounds.
    pub margin: f64,
    /// The decrease outside the bounds.
    pub sigmoid: Sigmoid,
}

impl Tolerance {
    /// A tolerance between two bounds, with a margin of 0.
    #[must_use]
    pub const fn within(low: f64, high: f64) -> Self {
        Self {
            low,
            high,
            margin: 0.0,
            sigmoid: Sigmoid::Gaussian,
        }
    }

    /// A tolerance above a bound.
    #[must_use]
    pub const fn above(low: f64) -> Self {
        Self::within(low, f64::INFINITY)
    }

    /// The tolerance with a margin and the sigmoid outside the bounds.
    #[must_use]
    pub const fn margin(self, margin: f64, sigmoid: Sigmoid) -> Self {
        Self {
            margin,
            sigmoid,
            ..self
        }
    }

    /// Returns the value of a scalar, which numpy squares with `pow`.
    #[must_use]
    pub fn of(&self, x: f64) -> f64 {
        self.value(x, math::square)
    }

    /// Returns the value of an element of an array, which numpy squares by multiplication.
    #[must_use]
    pub fn of_element(&self, x: f64) -> f64 {
        self.value(x, |x| x * x)
    }

    fn value(&self, x: f64, square: impl Fn(f64) -> f64) -> f64 {
        if self.low <= x && x <= self.high {
            return 1.0;
        }
        if self.margin == 0.0 {
            return 0.0;
        }
        let outside = if x < self.low {
            self.low - x
        } else {
            x - self.high
        };
        let d = outside / self.margin;
        let falls = |scaled: f64, loss: f64| if scaled.abs() < 1.0 { 1.0 - loss } else { 0.0 };
        match self.sigmoid {
            Sigmoid::Gaussian => math::numpy_exp(-0.5 * square(d * GAUSSIAN)),
            Sigmoid::Linear(at_margin) => {
                let scaled = d * (1.0 - at_margin);
                falls(scaled, scaled)
            }
            Sigmoid::Quadratic(at_margin) => {
                let scaled = d * (1.0 - at_margin).sqrt();
                falls(scaled, square(scaled))
            }
            // sqrt(1 / 0.1 - 1) is 3
            Sigmoid::LongTail => 1.0 / (square(d * 3.0) + 1.0),
            // 1 / 0.1 - 1 is 9
            Sigmoid::Reciprocal => 1.0 / (d.abs() * 9.0 + 1.0),
        }
    }
}

/// Returns the mean of `1 - u²` over the controls `u`. A control with `|u|` of 1 or more counts as
/// 0.
#[must_use]
pub fn small_control(controls: &[f64]) -> f64 {
    const SMALL: Tolerance = Tolerance::within(0.0, 0.0).margin(1.0, Sigmoid::Quadratic(0.0));
    mean(controls, |u| SMALL.of_element(*u))
}

/// Returns the mean of `value` over `items`, summed in numpy's order.
pub(crate) fn mean<T>(items: &[T], value: impl Fn(&T) -> f64) -> f64 {
    gym_sim::numpy::sum_of(items.len(), |i| value(&items[i])) / items.len() as f64
}
