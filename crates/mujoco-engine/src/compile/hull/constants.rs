// Derived from Qhull (http://www.qhull.org), Copyright (c) 1993-2020 C.B. Barber and The Geometry
// Center; rewritten in Rust, November 2026, for three dimensions and the options that MuJoCo asks
// for. Its licence is in COPYING.txt beside this file.

//! How far from a plane rounding can put a point, from the size of the set: every tolerance of the
//! algorithm. After `qh_maxmin`, `qh_detroundoff` and `qh_detmaxoutside` (`geom2_r.c`), with their
//! order of operations.

use super::Builder;

const EPSILON: f64 = f64::EPSILON;
/// `qh_RATIOnearinside`
const NEAR_INSIDE: f64 = 5.0;
/// `qh_WIDEcoplanar`
const WIDE_COPLANAR: f64 = 6.0;
/// `qh_USEfindbestnew`: from so many merges on, searches are wider.
const MANY_MERGES: u32 = 50;

/// `fmax_` of Qhull: `a` if they are equal.
#[inline]
pub(super) fn fmax(a: f64, b: f64) -> f64 {
    if a < b { b } else { a }
}

/// `fmin_` of Qhull: `a` if they are equal.
#[inline]
pub(super) fn fmin(a: f64, b: f64) -> f64 {
    if a > b { b } else { a }
}

/// The tolerances, by Qhull's names.
#[derive(Clone, Debug, Default)]
pub(super) struct Constants {
    pub(super) max_width: f64,
    /// Below it, a pivot in column `k` counts as zero.
    pub(super) near_zero: [f64; 3],
    pub(super) min_denominator: f64,
    pub(super) min_denominator_1_2: f64,
    pub(super) min_denominator_2: f64,
    pub(super) centrum_radius: f64,
    pub(super) one_merge: f64,
    pub(super) near_inside: f64,
    pub(super) min_visible: f64,
    pub(super) max_coplanar: f64,
    pub(super) min_outside: f64,
    pub(super) wide_facet: f64,
}

impl Builder<'_> {
    /// The tolerances, and the points of least and greatest x, y and z, in this order.
    pub(super) fn measure(&mut self) -> [u32; 6] {
        let c = &mut self.constants;
        let mut extremes = [0; 6];
        let (mut max_abs, mut sum) = (0.0, 0.0);
        c.max_width = -f64::MAX;
        for k in 0..3 {
            let (mut least, mut greatest) = (0, 0);
            for (i, point) in self.points.iter().enumerate() {
                if self.points[greatest][k] < point[k] {
                    greatest = i;
                } else if self.points[least][k] > point[k] {
                    least = i;
                }
            }
            let (low, high) = (self.points[least][k], self.points[greatest][k]);
            let max_coordinate = fmax(high, -low);
            c.max_width = fmax(c.max_width, high - low);
            max_abs = fmax(max_abs, max_coordinate);
            sum += max_coordinate;
            c.near_zero[k] = 80.0 * sum * EPSILON;
            extremes[2 * k] = least as u32;
            extremes[2 * k + 1] = greatest as u32;
        }

        let distance_sum = fmin(3f64.sqrt() * max_abs, sum);
        self.dist_round = EPSILON * (3.0 * distance_sum * 1.01 + max_abs);
        let least_denominator = f64::MIN_POSITIVE;
        c.min_denominator = least_denominator * max_abs;
        c.min_denominator_1_2 = (least_denominator * 3.0).sqrt();
        c.min_denominator_2 = c.min_denominator_1_2 * max_abs;
        c.centrum_radius = 2.0 * self.dist_round;
        c.one_merge = 3.0 * c.centrum_radius + self.dist_round;
        c.near_inside = c.one_merge * NEAR_INSIDE;
        c.min_visible = c.centrum_radius;
        c.max_coplanar = c.min_visible;
        c.min_outside = 2.0 * c.min_visible;
        c.wide_facet = fmax(
            fmax(c.min_outside, WIDE_COPLANAR * c.max_coplanar),
            WIDE_COPLANAR * c.min_visible,
        );
        self.max_outside = 0.0;
        self.min_vertex = -self.dist_round;
        self.determine_target();
        extremes
    }

    /// How far outside a point may be before its facet is questioned.
    pub(super) fn determine_target(&mut self) {
        self.target = fmax(
            fmax(self.max_outside, self.constants.one_merge + self.dist_round),
            self.constants.min_outside,
        );
    }

    pub(super) fn many_merges(&self) -> bool {
        self.total_merges > MANY_MERGES
    }

    /// `qh_DISToutside`: a point is clearly outside.
    pub(super) fn clearly_outside(&self) -> f64 {
        let factor = if self.many_merges() { 2.0 } else { 1.0 };
        factor * fmax(2.0 * self.constants.min_outside, self.max_outside)
    }

    /// `qh_SEARCHdist`: facets within it of the best one are searched too.
    pub(super) fn search_distance(&self) -> f64 {
        let factor = if self.many_merges() { 2.0 } else { 1.0 };
        let c = &self.constants;
        factor * (self.max_outside + 2.0 * self.dist_round + fmax(c.min_visible, c.max_coplanar))
    }
}
