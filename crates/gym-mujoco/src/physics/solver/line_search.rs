//! Newton's line search: the exact minimum of a piecewise quadratic function.

/// A step length, and the cost there (relative to no step) with its first and second derivative.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Point {
    pub(super) alpha: f64,
    pub(super) cost: f64,
    pub(super) slope: f64,
    pub(super) curvature: f64,
}

impl Point {
    /// Where Newton's step leads from here.
    fn newton(&self) -> f64 {
        self.alpha - self.slope / self.curvature
    }
}

/// The length of the step along a search direction: MuJoCo's `PrimalSearch`. 0 if no step lowers the cost.
///
/// `evaluate` gives the point at a step length; `flat` is the slope that counts as zero.
pub(super) fn line_search(mut evaluate: impl FnMut(f64) -> Point, flat: f64, most: usize) -> f64 {
    let mut evaluations = 0;
    let mut at = |alpha: f64| {
        evaluations += 1;
        (evaluate(alpha), evaluations < most)
    };
    let (p0, _) = at(0.0);
    let (mut p1, mut more) = at(p0.newton());
    if p0.cost < p1.cost {
        p1 = p0;
    }
    if p1.slope.abs() < flat {
        return p1.alpha;
    }

    // Newton's steps in one direction, until the minimum is behind
    let direction = if p1.slope < 0.0 { 1.0 } else { -1.0 };
    let mut p2 = p1;
    let mut moved = false;
    while p1.slope * direction <= -flat && more {
        (p2, moved) = (p1, true);
        (p1, more) = at(p1.newton());
        if p1.slope.abs() < flat {
            return p1.alpha;
        }
    }
    if !more || !moved {
        return p1.alpha;
    }

    // the minimum is between p1 and p2
    let mut next2 = p1;
    let (mut next1, _) = at(p1.newton());
    loop {
        let (middle, more) = at(0.5 * (p1.alpha + p2.alpha));
        let candidates = [next1, next2, middle];
        let good = candidates.iter().filter(|p| p.slope.abs() < flat);
        if let Some(best) = good.fold(None, |best: Option<&Point>, p| match best {
            Some(best) if best.cost <= p.cost => Some(best),
            _ => Some(p),
        }) {
            return best.alpha;
        }
        let moved1 = narrow(&mut p1, &candidates);
        if moved1 {
            next1 = at(p1.newton()).0;
        }
        let moved2 = narrow(&mut p2, &candidates);
        if moved2 {
            next2 = at(p2.newton()).0;
        }
        if !moved1 && !moved2 {
            return middle.alpha;
        }
        if !more {
            break;
        }
    }
    match (p1.cost <= p2.cost && p1.cost < 0.0, p2.cost <= p1.cost && p2.cost < 0.0) {
        (true, _) => p1.alpha,
        (_, true) => p2.alpha,
        _ => 0.0,
    }
}

/// Moves an end of the bracket to the candidates on its side that are nearer to the minimum.
fn narrow(p: &mut Point, candidates: &[Point; 3]) -> bool {
    let mut moved = false;
    for c in candidates {
        if (p.slope < 0.0 && c.slope < 0.0 && p.slope < c.slope)
            || (p.slope > 0.0 && c.slope > 0.0 && p.slope > c.slope)
        {
            (*p, moved) = (*c, true);
        }
    }
    moved
}
