//! The line search, for several worlds.

use fearless_simd::Simd;
use gym_numerics::math::{Lanes, Real};

use super::costs::with_dim;
use super::{Control, Found, Mask, Newton, Part};
use crate::Model;
use crate::math::spatial::MINVAL;
use crate::physics::constraint::Kind;
use crate::physics::lanes::rows::{Rows, worlds};
use crate::physics::lanes::tree::dot;
use crate::physics::lanes::{Arrays, At, PerWorld, load, same, store};
use crate::physics::solver::cones::{Cone, parts};
use crate::physics::solver::line_search;
use crate::physics::solver::row_costs::friction_along;

impl Newton {
    /// Searches in all worlds together until each minimum is found or bracketed, and writes step
    /// lengths and improvements. Returns a bit for each world whose search must continue within the
    /// bracket, and the arguments of [`finish_search`](Self::finish_search): linear term, quadratic
    /// term, and the slope that counts as zero.
    #[inline(always)]
    pub(super) fn search<S: Simd>(
        &mut self,
        m: &Model,
        at: At<S>,
        a: &Arrays,
        (rows, part): (&Rows, &Part),
        control: &Control,
        found: &mut Found,
    ) -> (u64, [PerWorld; 3]) {
        let (n, zero) = (part.n, same::<S>(at, 0.0));
        let direction = &self.search[..n];
        let active: Mask<S> = load::<S>(at, &control.active).gt(zero);
        let length = dot(at, direction, direction).sqrt();
        let active = Lanes::<S>::but_not(active, length.lt(zero.same(MINVAL)));
        part.multiply(m, at, &a.qm, direction, &mut self.mv);
        rows.multiply(n, at, direction, None, &mut self.jv);
        for row in 0..rows.one_sided().end {
            let (jar, jv) = (load::<S>(at, &self.jar[row]), load(at, &self.jv[row]));
            let d = load::<S>(at, &rows.d[row]);
            let force = d * jar;
            let quad = [jar * force * 0.5, jv * force, jv * d * jv * 0.5];
            let cost = Lanes::select(jar.lt(zero), quad[0], zero);
            let costs = &mut self.costs[row];
            for (to, x) in costs.iter_mut().zip([quad[0], quad[1], quad[2], cost]) {
                store(at, to, x);
            }
        }
        self.along.clear();
        for index in 0..rows.cones.len() {
            self.along.push(self.along_cone(at, rows, index));
        }
        let direction = &self.search[..n];
        let smooth = dot(at, &self.smooth[..n], direction);
        let linear = dot::<S>(at, direction, &self.ma[..n]) - smooth;
        let quadratic = dot::<S>(at, direction, &self.mv[..n]) * 0.5;
        let opt = &m.opt;
        let scale = load(at, &control.scale);
        let flat = length * (opt.tolerance * opt.ls_tolerance) / scale;
        let least = zero.same(MINVAL);
        let number = parts(rows.dim.max(1), m.revision);
        // returns cost, slope and curvature at a step length
        let (point,) = (
            #[inline(always)]
            |alpha: Lanes<S>| {
                let (mut cost, mut quad) = (zero, [zero, linear, quadratic]);
                let (mut tilt, mut bend) = (zero, zero);
                for [_, q1, q2, _] in &self.costs[..rows.pulls[0]] {
                    quad[1] = quad[1] + load::<S>(at, q1);
                    quad[2] = quad[2] + load::<S>(at, q2);
                }
                for row in rows.pulls[0]..rows.pulls[1] {
                    let [jar, jv, loss, r, d] = [
                        &self.jar[row],
                        &self.jv[row],
                        &rows.loss[row],
                        &rows.r[row],
                        &rows.d[row],
                    ]
                    .map(
                        #[inline(always)]
                        |x| load::<S>(at, x),
                    );
                    let row = [jar, jv, loss, r * loss, d];
                    let more = friction_along(at, row, alpha);
                    (cost, tilt, bend) = (cost + more[0], tilt + more[1], bend + more[2]);
                }
                for row in rows.one_sided() {
                    let [q0, q1, q2, start] = self.costs[row].each_ref().map(
                        #[inline(always)]
                        |x| load::<S>(at, x),
                    );
                    let (jar, jv) = (load::<S>(at, &self.jar[row]), load(at, &self.jv[row]));
                    let pushes = (jar + alpha * jv).lt(zero);
                    quad[0] = quad[0] + Lanes::select(pushes, q0 - start, zero);
                    quad[1] = quad[1] + Lanes::select(pushes, q1, zero);
                    quad[2] = quad[2] + Lanes::select(pushes, q2, zero);
                    cost = cost - Lanes::select(pushes, zero, start);
                }
                for cone in &self.along {
                    let cone = cone.map(
                        #[inline(always)]
                        |x| load::<S>(at, x),
                    );
                    let more = match number {
                        2 => cone.at(at, alpha, 2),
                        number => cone.at(at, alpha, number),
                    };
                    (cost, tilt, bend) = (cost + more[0], tilt + more[1], bend + more[2]);
                }
                cost = cost + (alpha * alpha * quad[2] + alpha * quad[1] + quad[0]);
                let curvature = bend + quad[2] * 2.0;
                let slope = tilt + (alpha * 2.0 * quad[2] + quad[1]);
                let curvature = Lanes::select(curvature.le(zero), least, curvature);
                (cost, slope, curvature)
            },
        );
        let (_, slope, curvature) = point(zero);
        let mut alpha = zero - slope / curvature;
        let (mut cost, mut slope, mut curvature) = point(alpha);
        let mut evaluations = 2;
        let still = alpha.abs().le(zero);
        let done = slope.abs().lt(flat) & (still | cost.lt(zero));
        let open = Lanes::<S>::but_not(active, done);
        let one = zero.same(1.0);
        let ahead = Lanes::select(slope.lt(zero), one, -one);
        let mut walks = open & (slope * ahead).le(-flat);
        let mut stuck = Lanes::<S>::but_not(open, walks);
        // take Newton steps in one direction until a step passes the minimum
        while Lanes::<S>::any(walks) && evaluations < opt.ls_iterations {
            let next = alpha - slope / curvature;
            let (c, s, k) = point(next);
            evaluations += 1;
            alpha = Lanes::select(walks, next, alpha);
            cost = Lanes::select(walks, c, cost);
            slope = Lanes::select(walks, s, slope);
            curvature = Lanes::select(walks, k, curvature);
            let done = slope.abs().lt(flat) & cost.lt(zero);
            let open = Lanes::<S>::but_not(walks, done);
            walks = open & (slope * ahead).le(-flat);
            stuck |= Lanes::<S>::but_not(open, walks);
        }
        store(at, &mut found[0], Lanes::select(active, alpha, zero));
        store(at, &mut found[1], -cost);
        let mut along = [PerWorld::ZERO; 3];
        for (to, x) in along.iter_mut().zip([linear, quadratic, flat]) {
            store(at, to, x);
        }
        (Lanes::<S>::bits(stuck), along)
    }

    /// Returns the cost of a cone along the search direction.
    #[inline(always)]
    fn along_cone<S: Simd>(&self, at: At<S>, rows: &Rows, index: usize) -> Cone<PerWorld> {
        let first = rows.cone(index);
        let shape = rows.cones[index].map(
            #[inline(always)]
            |x| load::<S>(at, x),
        );
        let cone = with_dim!(rows.dim, dim => Cone::new(
            at,
            &shape,
            dim,
            #[inline(always)]
            |k| {
                [&self.jar[first + k], &self.jv[first + k], &rows.d[first + k]].map(
                    #[inline(always)]
                    |x| load::<S>(at, x),
                )
            },
        ));
        cone.map(
            #[inline(always)]
            |x| {
                let mut cell = PerWorld::ZERO;
                store(at, &mut cell, *x);
                cell
            },
        )
    }

    /// Finishes the search of the worlds `stuck` within their brackets, world by world, because few
    /// worlds need this.
    pub(super) fn finish_search(
        &mut self,
        m: &Model,
        rows: &Rows,
        (stuck, along): (u64, [PerWorld; 3]),
        found: &mut Found,
        first: usize,
    ) {
        for world in worlds(stuck, first) {
            self.line.clear();
            self.course.clear();
            let plain = rows.pulls[1] == 0 && rows.cones.is_empty();
            let number = if plain {
                rows.count[world]
            } else {
                rows.one_sided().end
            };
            for row in 0..number {
                let of = |vector: &[PerWorld]| vector[row].0[world];
                let own = [of(&self.jar), of(&self.jv), of(&rows.d)];
                if plain {
                    let [jar, jv, d] = own;
                    self.line.push(line_search::Row::new(jar, jv, d));
                    continue;
                }
                let kind = match row {
                    row if row < rows.pulls[0] => Kind::Equality,
                    row if row < rows.pulls[1] => Kind::Friction,
                    _ => Kind::OneSided,
                };
                self.course.push(kind, own, [of(&rows.r), of(&rows.loss)]);
            }
            for cone in &self.along {
                let cone = cone.map(|x| x.0[world]);
                self.course.push_cone(cone, parts(rows.dim, m.revision));
            }
            let [linear, quadratic, flat] = along.each_ref().map(|row| row.0[world]);
            let along = line_search::Along {
                rows: &self.line,
                course: (!plain).then_some(&self.course),
                linear,
                quadratic,
                evaluations: 0,
            };
            let (alpha, gain) = line_search::line_search(along, flat, m.opt.ls_iterations);
            (found[0].0[world], found[1].0[world]) = (alpha, gain);
        }
    }
}
