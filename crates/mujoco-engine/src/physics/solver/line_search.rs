//! Newton's line search: the exact minimum of a piecewise quadratic function.

use super::row_costs::{Course, evaluate};
use crate::math::spatial::MINVAL;

/// The quantities of a row that a line search reads.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::physics) struct Row {
    /// The residual at step length 0, and its change per unit of the step length.
    jar: f64,
    jv: f64,
    /// The coefficients of the cost while the row pushes, as a polynomial in the step length.
    quad: [f64; 3],
    /// The cost at step length 0.
    cost: f64,
}

impl Row {
    #[inline]
    pub(in crate::physics) fn new(jar: f64, jv: f64, stiffness: f64) -> Self {
        let force = stiffness * jar;
        let quad = [jar * force * 0.5, jv * force, jv * stiffness * jv * 0.5];
        Self {
            jar,
            jv,
            quad,
            cost: if jar < 0.0 { quad[0] } else { 0.0 },
        }
    }
}

/// The cost along a search direction, relative to the cost at step length 0.
pub(in crate::physics) struct Along<'a> {
    pub(in crate::physics) rows: &'a [Row],
    /// The rows' costs, for models with equality constraints, dry friction or elliptic cones.
    pub(in crate::physics) course: Option<&'a Course>,
    /// The coefficients of the step length and of its square in the smooth part of the cost.
    pub(in crate::physics) linear: f64,
    pub(in crate::physics) quadratic: f64,
    pub(in crate::physics) evaluations: usize,
}

/// A step length, and the cost at this step length (relative to step length 0) with its first and
/// second derivative.
#[derive(Clone, Copy, Debug, Default)]
struct Point {
    alpha: f64,
    cost: f64,
    slope: f64,
    curvature: f64,
}

impl Point {
    /// Returns the step length after a Newton step from this point.
    fn newton(&self) -> f64 {
        self.alpha - self.slope / self.curvature
    }
}

impl Along<'_> {
    /// Returns the cost at the step length `alpha`: MuJoCo's `PrimalEval`.
    #[inline(always)]
    fn at(&mut self, alpha: f64) -> Point {
        self.evaluations += 1;
        if let Some(course) = self.course {
            let quad = [0.0, self.linear, self.quadratic];
            let [cost, slope, curvature] = evaluate(course, alpha, quad);
            return Point {
                alpha,
                cost,
                slope,
                curvature: if curvature <= 0.0 { MINVAL } else { curvature },
            };
        }
        let (mut cost, mut quad) = (0.0, [0.0, self.linear, self.quadratic]);
        for row in self.rows {
            if row.jar + alpha * row.jv < 0.0 {
                quad[0] += row.quad[0] - row.cost;
                quad[1] += row.quad[1];
                quad[2] += row.quad[2];
            } else {
                cost -= row.cost;
            }
        }
        cost += alpha * alpha * quad[2] + alpha * quad[1] + quad[0];
        let curvature = 2.0 * quad[2];
        Point {
            alpha,
            cost,
            slope: 2.0 * alpha * quad[2] + quad[1],
            curvature: if curvature <= 0.0 { MINVAL } else { curvature },
        }
    }
}

/// Returns the step length that minimises the cost along a direction, and the improvement: MuJoCo's
/// `PrimalSearch`. The step length is zero if no step lowers the cost.
///
/// Slopes below `flat` count as zero; `most` is the largest number of evaluations.
#[inline(always)]
pub(in crate::physics) fn line_search(mut along: Along<'_>, flat: f64, most: usize) -> (f64, f64) {
    let found = |p: &Point| (p.alpha, -p.cost);
    let p0 = along.at(0.0);
    let mut p1 = along.at(p0.newton());
    if p1.slope.abs() < flat && (p1.alpha == 0.0 || p1.cost < 0.0) {
        return found(&p1);
    }

    // take Newton steps in one direction until a step passes the minimum
    let direction = if p1.slope < 0.0 { 1.0 } else { -1.0 };
    let mut p2 = p0;
    while p1.slope * direction <= -flat && along.evaluations < most {
        p2 = p1;
        p1 = along.at(p1.newton());
        if p1.slope.abs() < flat && p1.cost < 0.0 {
            return found(&p1);
        }
    }
    if along.evaluations >= most {
        return found(&p1);
    }

    // the minimum is between p1 and p2
    let mut next2 = p1;
    let mut next1 = along.at(p1.newton());
    while along.evaluations < most {
        let middle = along.at(0.5 * (p1.alpha + p2.alpha));
        let candidates = [next1, next2, middle];
        let flat_ones = candidates.iter().filter(|p| p.slope.abs() < flat);
        if let Some(best) = flat_ones.reduce(|best, p| if p.cost < best.cost { p } else { best }) {
            return found(best);
        }
        let moved1 = narrow(&mut along, &mut p1, &candidates, &mut next1);
        let moved2 = narrow(&mut along, &mut p2, &candidates, &mut next2);
        if !moved1 && !moved2 {
            return found(&middle);
        }
    }
    if p1.cost <= p2.cost && p1.cost < 0.0 {
        found(&p1)
    } else if p2.cost <= p1.cost && p2.cost < 0.0 {
        found(&p2)
    } else {
        (0.0, 0.0)
    }
}

/// Moves `p`, an end of the bracket, to the candidate on the same side of the minimum that is
/// nearest to the minimum, and `next` to a Newton step from there: MuJoCo's `updateBracket`.
#[inline(always)]
fn narrow(along: &mut Along<'_>, p: &mut Point, candidates: &[Point; 3], next: &mut Point) -> bool {
    let mut moved = false;
    for c in candidates {
        if (p.slope < 0.0 && c.slope < 0.0 && p.slope < c.slope)
            || (p.slope > 0.0 && c.slope > 0.0 && p.slope > c.slope)
        {
            (*p, moved) = (*c, true);
        }
    }
    if moved {
        *next = along.at(p.newton());
    }
    moved
}
