//! What Gauss-Seidel does to a row, and between two sweeps over all rows.

/// The quantities that the update of a row needs whose force only pushes.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::physics) struct Step {
    /// The residual of zero forces.
    pub(in crate::physics) b: f64,
    diag_inv: f64,
    /// `1 / diag_inv`.
    diag: f64,
}

impl Step {
    /// `diagonal` is the row's element of `J M^-1 J' + R`.
    #[inline(always)]
    pub(in crate::physics) fn new(b: f64, diagonal: f64) -> Self {
        let diag_inv = 1.0 / diagonal;
        Self {
            b,
            diag_inv,
            diag: 1.0 / diag_inv,
        }
    }

    /// Returns the force instead of `old`, and the change of the cost; `None` if the cost would rise.
    /// `product` is that of the row of the matrix with all forces.
    #[inline(always)]
    pub(in crate::physics) fn update(&self, product: f64, old: f64) -> Option<(f64, f64)> {
        let residual = self.b + product;
        let new = pushing(old - residual * self.diag_inv);
        let delta = new - old;
        let change = 0.5 * delta * delta * self.diag + delta * residual;
        (change <= 1e-10).then_some((new, change))
    }
}

/// Returns the nearest force that only pushes.
#[inline(always)]
pub(in crate::physics) fn pushing(force: f64) -> f64 {
    if force < 0.0 { 0.0 } else { force }
}

/// The momentum by which forces go on in the direction of their last change. It starts again when a
/// sweep turns against it.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::physics) struct Momentum {
    /// The number of sweeps since the momentum started.
    k: f64,
}

impl Momentum {
    /// The share of the last change by which forces go on; nothing if it is not above 0.
    #[inline(always)]
    pub(in crate::physics) fn beta(self) -> f64 {
        (self.k - 1.0) / (self.k + 2.0)
    }

    /// Ends a sweep. `turned` is the product of its changes with those that the momentum made.
    #[inline(always)]
    pub(in crate::physics) fn end_sweep(&mut self, turned: f64) {
        self.k = if turned < 0.0 { 0.0 } else { self.k + 1.0 };
    }
}
