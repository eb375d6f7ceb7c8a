//! Elliptic friction cones: forces, second derivatives, and costs along a search direction, for one
//! world or for several.

use crate::math::number::Number;
use crate::math::spatial::MINVAL;
use crate::{Contact, Revision};

/// A symmetric matrix over the rows of a cone, or a factor of one: its lower triangle.
pub(in crate::physics) type Matrix<N> = [[N; 6]; 6];

/// What the cost of a contact's cone depends on, apart from the residuals.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::physics) struct Shape<T> {
    mu: T,
    friction: [T; 5],
    /// The stiffness of sliding.
    dm: T,
}

impl Shape<f64> {
    /// The cone of a contact; `d` is the stiffness of its first row.
    #[inline(always)]
    pub(in crate::physics) fn new(contact: &Contact, d: f64) -> Self {
        let mu = contact.mu;
        Self {
            mu,
            friction: contact.friction,
            dm: d / ((mu * mu) * (1.0 + mu * mu)),
        }
    }
}

impl<T: Copy> Shape<T> {
    #[inline(always)]
    pub(in crate::physics) fn map<U>(&self, f: impl Fn(&T) -> U) -> Shape<U> {
        Shape {
            mu: f(&self.mu),
            friction: self.friction.each_ref().map(&f),
            dm: f(&self.dm),
        }
    }

    /// Calls `f` with the numbers of this cone and of another.
    pub(in crate::physics) fn each<U>(&mut self, of: &Shape<U>, f: impl Fn(&mut T, &U)) {
        f(&mut self.mu, &of.mu);
        f(&mut self.dm, &of.dm);
        for (to, from) in self.friction.iter_mut().zip(&of.friction) {
            f(to, from);
        }
    }
}

/// The zone of a cone. In neither of these two, the contact slides: the force is on the cone.
#[derive(Clone, Copy, Debug)]
pub(in crate::physics) struct Zone<M> {
    /// The contact separates: no force.
    pub(in crate::physics) top: M,
    /// The contact sticks: the cost is quadratic. (`top` wins if both are set.)
    pub(in crate::physics) bottom: M,
}

/// Returns the zone, given the normal part `n` and the tangential length `t`.
#[inline(always)]
fn zone<N: Number>(mu: N, n: N, t: N) -> Zone<N::Mask> {
    Zone {
        top: (mu * t).is_at_most(n),
        bottom: (mu * n).is_at_most(-t),
    }
}

/// The residuals of a cone, scaled so that the dual cone is circular.
#[derive(Clone, Copy, Debug)]
pub(in crate::physics) struct Scaled<N: Number> {
    shape: Shape<N>,
    u: [N; 6],
    t: N,
    pub(in crate::physics) zone: Zone<N::Mask>,
}

impl<N: Number> Scaled<N> {
    /// Scales the residuals of a cone of `dim` rows.
    #[inline(always)]
    pub(in crate::physics) fn new(shape: Shape<N>, dim: usize, jar: impl Fn(usize) -> N) -> Self {
        let mut u = [jar(0) * shape.mu; 6];
        for j in 1..dim {
            u[j] = jar(j) * shape.friction[j - 1];
        }
        let t = dot(&u[1..dim], &u[1..dim]).sqrt();
        Self {
            shape,
            u,
            t,
            zone: zone(shape.mu, u[0], t),
        }
    }

    /// Returns the cost and the forces while the contact slides.
    #[inline(always)]
    pub(in crate::physics) fn slide(&self, dim: usize, revision: Revision) -> (N, [N; 6]) {
        let Self { shape, u, t, .. } = *self;
        let apart = u[0] - shape.mu * t;
        let normal = -shape.dm * apart * shape.mu;
        let mut force = [normal; 6];
        for j in 1..dim {
            force[j] = if revision.slopes_by_direction() {
                -normal * (u[j] / t) * shape.friction[j - 1]
            } else {
                -normal / t * u[j] * shape.friction[j - 1]
            };
        }
        (shape.dm * 0.5 * apart * apart, force)
    }

    /// Returns the second derivatives of the cost with respect to the residuals while the contact
    /// slides.
    #[inline(always)]
    pub(in crate::physics) fn bend(&self, dim: usize, revision: Revision) -> Matrix<N> {
        let Self {
            shape, mut u, t, ..
        } = *self;
        let (mu, n) = (shape.mu, u[0]);
        // the factor of the first row, of the products of elements of `u`, and the number that is
        // subtracted from `mu^2` on the diagonal
        let [first, bend, straight] = if revision.slopes_by_direction() {
            // the unit vector of the sliding direction
            for u in &mut u[1..dim] {
                *u = *u / t;
            }
            let bend = mu * (n / t);
            [mu, bend, bend]
        } else {
            [mu / t, mu * n / (t * t * t), mu * n / t]
        };
        let factor = mu * mu - straight;
        let (scale,) = (
            #[inline(always)]
            |k: usize| if k == 0 { mu } else { shape.friction[k - 1] },
        );
        let mut h = [[mu; 6]; 6];
        for k in 0..dim {
            let own = shape.dm * scale(k);
            for j in k..dim {
                let factors = own * scale(j);
                h[j][k] = match k {
                    0 if j == 0 => factors,
                    0 => -first * u[j] * factors,
                    _ if j == k => (bend * u[j] * u[k] + factor) * factors,
                    _ => bend * u[j] * u[k] * factors,
                };
            }
        }
        h
    }
}

/// Returns the scalar product of vectors of one to five elements, in the order of MuJoCo's
/// `mju_dot`.
#[inline(always)]
fn dot<N: Number>(a: &[N], b: &[N]) -> N {
    let (product,) = (
        #[inline(always)]
        |k: usize| a[k] * b[k],
    );
    let (mut sum, first) = if a.len() < 4 {
        (product(0), 1)
    } else {
        ((product(0) + product(2)) + (product(1) + product(3)), 4)
    };
    for k in first..a.len() {
        sum = sum + product(k);
    }
    sum
}

/// Replaces a matrix by its factor `L`: MuJoCo's `mju_cholFactor`.
#[inline(always)]
pub(in crate::physics) fn factor<N: Number>(place: N::At, dim: usize, l: &mut Matrix<N>) {
    for j in 0..dim {
        let (row, (one,)) = (l[j], (N::of(place, 1.0),));
        let (without,) = (
            #[inline(always)]
            |x: N, other: &[N; 6]| {
                if j == 0 {
                    x
                } else {
                    x - dot(&other[..j], &row[..j])
                }
            },
        );
        let pivot = without(row[j], &row);
        let small = pivot.is_below(MINVAL);
        let [pivot] = N::choose(
            small,
            #[inline(always)]
            || [N::of(place, MINVAL)],
            #[inline(always)]
            || [pivot],
        );
        let diagonal = pivot.sqrt();
        l[j][j] = diagonal;
        let inverse = one / diagonal;
        for i in j + 1..dim {
            let rest = without(l[i][j], &l[i]);
            [l[i][j]] = N::choose(
                small,
                #[inline(always)]
                || [N::of(place, 0.0)],
                #[inline(always)]
                || [rest * inverse],
            );
        }
    }
}

/// The cost of a cone along a search direction. As in MuJoCo, `u` and `v` are the normal residual
/// and its change; `uu`, `uv` and `vv` are products of the tangential residuals and their changes.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::physics) struct Cone<T> {
    /// The coefficients of the cost while the contact sticks, as a polynomial in the step length.
    quad: [T; 3],
    u: T,
    v: T,
    uu: T,
    uv: T,
    vv: T,
    dm: T,
    mu: T,
    /// The tangential length at step length 0.
    t: T,
    /// The tangential residuals, each with its change.
    parts: [[T; 2]; 5],
}

impl<T: Copy> Cone<T> {
    #[inline(always)]
    pub(in crate::physics) fn map<U>(&self, f: impl Fn(&T) -> U) -> Cone<U> {
        Cone {
            quad: self.quad.each_ref().map(&f),
            u: f(&self.u),
            v: f(&self.v),
            uu: f(&self.uu),
            uv: f(&self.uv),
            vv: f(&self.vv),
            dm: f(&self.dm),
            mu: f(&self.mu),
            t: f(&self.t),
            parts: self.parts.each_ref().map(
                #[inline(always)]
                |part| part.each_ref().map(&f),
            ),
        }
    }
}

/// Returns the number of [parts](Cone::parts) that are read. Before 4.0, MuJoCo uses the products
/// alone.
#[inline(always)]
pub(in crate::physics) fn parts(dim: usize, revision: Revision) -> usize {
    if revision.slopes_by_direction() {
        dim - 1
    } else {
        0
    }
}

/// Returns the root of a square that rounding may have made negative.
#[inline(always)]
fn length<N: Number>(place: N::At, square: N) -> N {
    let [length] = N::choose(
        square.is_below(0.0),
        #[inline(always)]
        || [N::of(place, 0.0)],
        #[inline(always)]
        || [square.sqrt()],
    );
    length
}

impl<N: Number> Cone<N> {
    /// `row` gives each of `dim` rows: its residual, the residual's change, and the stiffness.
    #[inline(always)]
    pub(in crate::physics) fn new(
        place: N::At,
        shape: &Shape<N>,
        dim: usize,
        row: impl Fn(usize) -> [N; 3],
    ) -> Self {
        let [x, y, d] = row(0);
        let force = d * x;
        let mut quad = [x * force, y * force, y * d * y];
        let zero = N::of(place, 0.0);
        let (mut uu, mut uv, mut vv) = (zero, zero, zero);
        let mut parts = [[zero; 2]; 5];
        let (u, v) = (x * shape.mu, y * shape.mu);
        for j in 1..dim {
            let [x, y, d] = row(j);
            let force = d * x;
            quad = [
                quad[0] + x * force,
                quad[1] + y * force,
                quad[2] + y * d * y,
            ];
            let (u, v) = (x * shape.friction[j - 1], y * shape.friction[j - 1]);
            (uu, uv, vv) = (uu + u * u, uv + u * v, vv + v * v);
            parts[j - 1] = [u, v];
        }
        Self {
            quad: [quad[0] * 0.5, quad[1], quad[2] * 0.5],
            u,
            v,
            uu,
            uv,
            vv,
            dm: shape.dm,
            mu: shape.mu,
            t: length(place, uu),
            parts,
        }
    }

    /// Returns the change of the cost from step length 0 to `alpha`, MuJoCo's `ellipticCostDif`,
    /// and the slope and curvature there. `number` is that of [`parts`].
    #[inline(always)]
    pub(in crate::physics) fn at(&self, place: N::At, alpha: N, number: usize) -> [N; 3] {
        let Self { quad, mu, dm, .. } = *self;
        let (parts, zero) = (&self.parts[..number], N::of(place, 0.0));
        let mut moved = [zero; 5];
        let n = self.u + alpha * self.v;
        let square = if number == 0 {
            self.uu + alpha * (self.uv * 2.0 + alpha * self.vv)
        } else {
            let mut square = zero;
            for (moved, [u, v]) in moved.iter_mut().zip(parts) {
                *moved = *u + alpha * *v;
                square = square + *moved * *moved;
            }
            square
        };
        let t = length(place, square);
        let (start, end) = (zone(mu, self.u, self.t), zone(mu, n, t));
        let (before, apart) = (self.u - mu * self.t, n - mu * t);
        N::choose(
            end.top,
            #[inline(always)]
            || {
                let cost = by_zone(
                    &start,
                    #[inline(always)]
                    || zero,
                    #[inline(always)]
                    || -quad[0],
                    #[inline(always)]
                    || dm * -0.5 * before * before,
                );
                [cost, zero, zero]
            },
            #[inline(always)]
            || {
                N::choose(
                    end.bottom,
                    #[inline(always)]
                    || {
                        let cost = by_zone(
                            &start,
                            #[inline(always)]
                            || alpha * alpha * quad[2] + alpha * quad[1] + quad[0],
                            #[inline(always)]
                            || alpha * alpha * quad[2] + alpha * quad[1],
                            #[inline(always)]
                            || {
                                let boundary = mu * self.u + self.t;
                                alpha * (alpha * quad[2] + quad[1]) + dm * 0.5 * boundary * boundary
                            },
                        );
                        [cost, alpha * 2.0 * quad[2] + quad[1], quad[2] * 2.0]
                    },
                    #[inline(always)]
                    || {
                        if N::all(end.top | end.bottom) {
                            return [zero; 3];
                        }
                        let cost = by_zone(
                            &start,
                            #[inline(always)]
                            || dm * 0.5 * apart * apart,
                            #[inline(always)]
                            || {
                                let boundary = mu * n + t;
                                alpha * (alpha * quad[2] + quad[1]) - dm * 0.5 * boundary * boundary
                            },
                            #[inline(always)]
                            || {
                                let growth = self.growth(place, alpha, number);
                                let moved = alpha * self.v - mu * (growth / (t + self.t));
                                dm * 0.5 * moved * (before * 2.0 + moved)
                            },
                        );
                        let [slope, curvature] =
                            self.slopes(place, alpha, &moved[..number], [n, t]);
                        [cost, slope, curvature]
                    },
                )
            },
        )
    }

    /// Returns slope and curvature while the contact slides. `moved` has the tangential residuals,
    /// if [`parts`] are read, and `t` is their length.
    #[inline(always)]
    fn slopes(&self, place: N::At, alpha: N, moved: &[N], [n, t]: [N; 2]) -> [N; 2] {
        let Self { mu, dm, .. } = *self;
        if moved.is_empty() {
            let t1 = (self.uv + alpha * self.vv) / t;
            let t2 = self.vv / t - (self.uv + alpha * self.vv) * t1 / (t * t);
            let (apart, slope) = (n - mu * t, self.v - mu * t1);
            return [
                dm * apart * slope,
                dm * (slope * slope + apart * (-mu * t2)),
            ];
        }
        let (along, across) = self.slide(place, moved, t);
        let slope = self.v - mu * (along / t);
        let bend = (n / t - mu) * (across * mu);
        [dm * (n - mu * t) * slope, dm * (slope * slope - bend)]
    }

    /// Returns the change of the square of the tangential length from step length 0 to `alpha`.
    #[inline(always)]
    fn growth(&self, place: N::At, alpha: N, number: usize) -> N {
        if number == 0 {
            return alpha * (self.uv * 2.0 + alpha * self.vv);
        }
        let mut sum = N::of(place, 0.0);
        for &[u, v] in &self.parts[..number] {
            sum = sum + alpha * v * (u + (u + alpha * v));
        }
        sum
    }

    /// Returns the scalar product of the tangential residuals and their changes, and the square of
    /// the part of the changes that is perpendicular to the residuals. `length` is the length of
    /// the residuals `moved`.
    #[inline(always)]
    fn slide(&self, place: N::At, moved: &[N], length: N) -> (N, N) {
        let parts = &self.parts[..moved.len()];
        let zero = N::of(place, 0.0);
        let (mut along, mut across) = (zero, zero);
        let mut directions = [zero; 5];
        for (k, (&moved, &[_, v])) in moved.iter().zip(parts).enumerate() {
            along = along + moved * v;
            directions[k] = moved / length;
        }
        for (j, &[_, first]) in parts.iter().enumerate() {
            for (k, &[_, second]) in parts.iter().enumerate().skip(j + 1) {
                let area = directions[j] * second - first * directions[k];
                across = across + area * area;
            }
        }
        (along, across)
    }
}

#[inline(always)]
fn by_zone<N: Number>(
    zone: &Zone<N::Mask>,
    top: impl FnOnce() -> N,
    bottom: impl FnOnce() -> N,
    middle: impl FnOnce() -> N,
) -> N {
    let [chosen] = N::choose(
        zone.top,
        #[inline(always)]
        || [top()],
        #[inline(always)]
        || {
            N::choose(
                zone.bottom,
                #[inline(always)]
                || [bottom()],
                #[inline(always)]
                || [middle()],
            )
        },
    );
    chosen
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A number from -1 to 1 by lot.
    fn lot(seed: &mut u64) -> f64 {
        *seed = seed
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (*seed >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    /// The cost of the residuals `x` of a contact, and the number of its zone; none if the contact
    /// slides so slowly that the slope bends fast. The stiffness of a row is `d`, that of the
    /// first, times the square of its friction over `mu`.
    fn cost(x: &[f64], shape: &Shape<f64>, d: f64) -> (f64, Option<usize>) {
        let mu = shape.mu;
        let n = mu * x[0];
        let square: f64 = (x[1..].iter().zip(shape.friction))
            .map(|(x, friction)| (x * friction).powi(2))
            .sum();
        let t = square.sqrt();
        if n >= mu * t {
            (0.0, Some(0))
        } else if mu * n <= -t {
            (0.5 * d * (n * n + square) / (mu * mu), Some(1))
        } else {
            (
                0.5 * shape.dm * (n - mu * t).powi(2),
                (t > 0.2).then_some(2),
            )
        }
    }

    /// The costs of 20,000 cones by lot, from each zone to each: the change, its slope, and the
    /// slope's change are those of the formula of Todorov (2014).
    #[test]
    fn costs_along_a_line_are_those_of_its_ends() {
        let (seed, mut seen) = (&mut 1, [[0; 3]; 3]);
        for round in 0..20_000 {
            let dim = 3 + round % 4;
            let mu = 1.0 + 0.8 * lot(seed);
            let friction = [(); 5].map(|()| 1.0 + 0.8 * lot(seed));
            let d = 3.0 + 2.0 * lot(seed);
            let dm = d / (mu * mu * (1.0 + mu * mu));
            let shape = Shape { mu, friction, dm };
            let rows: Vec<_> = (0..dim)
                .map(|j| {
                    let scale = if j == 0 { 1.0 } else { friction[j - 1] / mu };
                    [2.0 * lot(seed), 2.0 * lot(seed), d * scale * scale]
                })
                .collect();
            let at =
                |alpha: f64| -> Vec<f64> { rows.iter().map(|[x, y, _]| x + alpha * y).collect() };
            let alpha = 1.0 + lot(seed);
            let step = 1e-4;
            let (before, from) = cost(&at(0.0), &shape, d);
            let [(less, a), (end, to), (more, b)] =
                [alpha - step, alpha, alpha + step].map(|alpha| cost(&at(alpha), &shape, d));
            // between zones the slope's change jumps
            let (Some(from), Some(to), true) = (from, to, a == to && b == to) else {
                continue;
            };
            seen[from][to] += 1;
            let known = [
                end - before,
                (more - less) / (2.0 * step),
                (more - 2.0 * end + less) / (step * step),
            ];
            let line = Cone::new((), &shape, dim, |j| rows[j]);
            for number in [0, dim - 1] {
                let found = line.at((), alpha, number);
                for ((found, known), rest) in found.into_iter().zip(known).zip([1e-10, 1e-4, 1e-3])
                {
                    let most = rest * (1.0 + before.max(end).max(known.abs()));
                    assert!(
                        (found - known).abs() < most,
                        "{from} to {to}: {found}, not {known}"
                    );
                }
            }
        }
        assert!(
            seen.as_flattened().iter().all(|seen| *seen > 25),
            "{seen:?}"
        );
    }
}
