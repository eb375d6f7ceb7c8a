//! Costs and forces of rows in models with equality constraints, dry friction or elliptic cones.
//! (In all other models, rows only push: see [`cost_of_rows`](super::cost_of_rows).)

use crate::physics::constraint::{Block, Kind, Source};
use crate::{Contact, Revision};

/// The properties of an island's rows on which costs and forces depend.
#[derive(Clone, Copy)]
pub(super) struct RowCosts<'a> {
    pub(super) blocks: &'a [Block],
    pub(super) d: &'a [f64],
    pub(super) r: &'a [f64],
    /// The friction losses, up to the last row of dry friction.
    pub(super) loss: &'a [f64],
    pub(super) contacts: &'a [Contact],
    pub(super) revision: Revision,
}

/// The piece of the cost function to which a row's residual belongs: MuJoCo's `mjtConstraintState`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum State {
    #[default]
    Satisfied,
    Quadratic,
    LinearNegative,
    LinearPositive,
    Cone,
}

/// The second derivatives of a cone's cost with respect to the residuals, and the index of the
/// cone's first row.
#[derive(Clone, Copy, Debug)]
pub(super) struct ConeHessian {
    pub(super) row: usize,
    pub(super) dim: usize,
    pub(super) matrix: [[f64; 6]; 6],
}

impl RowCosts<'_> {
    fn contact(&self, block: &Block) -> Option<&Contact> {
        match block.source {
            Source::Contact(index) => self.contacts.get(index),
            _ => None,
        }
    }

    /// Computes forces and states of all rows, and returns their cost: MuJoCo's
    /// `mj_constraintUpdate`.
    pub(super) fn update(
        &self,
        jar: &[f64],
        force: &mut [f64],
        states: &mut [State],
        cones: &mut Vec<ConeHessian>,
    ) -> f64 {
        cones.clear();
        let mut cost = 0.0;
        for block in self.blocks {
            let rows = block.row..block.row + block.rows;
            for i in rows.clone() {
                force[i] = -self.d[i] * jar[i];
            }
            match block.kind {
                Kind::Equality => {
                    for i in rows {
                        cost += 0.5 * self.d[i] * jar[i] * jar[i];
                        states[i] = State::Quadratic;
                    }
                }
                Kind::Friction => {
                    let i = block.row;
                    let (x, r, f) = (jar[i], self.r[i], self.loss[i]);
                    if x <= -r * f {
                        cost += -0.5 * r * f * f - f * x;
                        (force[i], states[i]) = (f, State::LinearNegative);
                    } else if x >= r * f {
                        cost += -0.5 * r * f * f + f * x;
                        (force[i], states[i]) = (-f, State::LinearPositive);
                    } else {
                        cost += 0.5 * self.d[i] * x * x;
                        states[i] = State::Quadratic;
                    }
                }
                Kind::OneSided => {
                    for i in rows {
                        if jar[i] >= 0.0 {
                            (force[i], states[i]) = (0.0, State::Satisfied);
                        } else {
                            cost += 0.5 * self.d[i] * jar[i] * jar[i];
                            states[i] = State::Quadratic;
                        }
                    }
                }
                Kind::Cone => {
                    let (more, state) = self.cone(block, jar, force, cones);
                    cost = if state == State::Quadratic {
                        let terms = rows.clone().map(|i| 0.5 * self.d[i] * jar[i] * jar[i]);
                        terms.fold(cost, |sum, term| sum + term)
                    } else {
                        cost + more
                    };
                    states[rows].fill(state);
                }
            }
        }
        cost
    }

    fn cone(
        &self,
        block: &Block,
        jar: &[f64],
        force: &mut [f64],
        cones: &mut Vec<ConeHessian>,
    ) -> (f64, State) {
        let Some(contact) = self.contact(block) else {
            return (0.0, State::Satisfied);
        };
        let (i, dim, mu) = (block.row, block.rows, contact.mu);
        let friction = &contact.friction;
        // the residuals, scaled so that the dual cone is circular
        let mut u = [0.0; 6];
        u[0] = jar[i] * mu;
        for j in 1..dim {
            u[j] = jar[i + j] * friction[j - 1];
        }
        let (n, t) = (u[0], norm(&u[1..dim]));
        if n >= mu * t || (t <= 0.0 && n >= 0.0) {
            force[i..i + dim].fill(0.0);
            return (0.0, State::Satisfied);
        }
        if mu * n + t <= 0.0 || (t <= 0.0 && n < 0.0) {
            return (0.0, State::Quadratic);
        }
        let dm = self.d[i] / (mu * mu * (1.0 + mu * mu));
        let apart = n - mu * t;
        force[i] = -dm * apart * mu;
        let matrix = if self.revision.slopes_by_direction() {
            // the unit vector of the sliding direction
            let u = u.map(|u| u / t);
            for j in 1..dim {
                force[i + j] = -force[i] * u[j] * friction[j - 1];
            }
            let bend = mu * (n / t);
            cone_hessian(&u, mu, (bend, bend), dim, mu, friction, dm)
        } else {
            for j in 1..dim {
                force[i + j] = -force[i] / t * u[j] * friction[j - 1];
            }
            let bends = (mu * n / (t * t * t), mu * n / t);
            cone_hessian(&u, mu / t, bends, dim, mu, friction, dm)
        };
        cones.push(ConeHessian {
            row: i,
            dim,
            matrix,
        });
        (0.5 * dm * apart * apart, State::Cone)
    }
}

/// Returns the length of a vector, in the order of MuJoCo's `mju_norm`.
fn norm(v: &[f64]) -> f64 {
    crate::math::dense::dot_slices(v, v).sqrt()
}

/// Returns the second derivatives of a cone's cost. `u` is the direction of sliding, whose length
/// may differ from 1. `first`, `bend` and `straight` depend on this length: `first` is the factor
/// of the first row, `bend` the factor of the products of elements of `u`, and `straight` is
/// subtracted from `mu^2` on the diagonal.
fn cone_hessian(
    u: &[f64; 6],
    first: f64,
    (bend, straight): (f64, f64),
    dim: usize,
    mu: f64,
    friction: &[f64; 5],
    dm: f64,
) -> [[f64; 6]; 6] {
    let mut h = [[0.0; 6]; 6];
    h[0][0] = 1.0;
    for j in 1..dim {
        h[0][j] = -first * u[j];
    }
    for k in 1..dim {
        for j in k..dim {
            h[k][j] = bend * u[j] * u[k];
        }
    }
    let factor = mu * mu - straight;
    for j in 1..dim {
        h[j][j] += factor;
    }
    let scale = |k: usize| if k == 0 { mu } else { friction[k - 1] };
    for k in 0..dim {
        let factor = dm * scale(k);
        for j in k..dim {
            h[k][j] *= factor * scale(j);
        }
    }
    for k in 0..dim {
        for j in k + 1..dim {
            h[j][k] = h[k][j];
        }
    }
    h
}

/// The costs of all rows along a search direction.
#[derive(Clone, Debug, Default)]
pub(in crate::physics) struct Course {
    pieces: Vec<Piece>,
    cones: Vec<Cone>,
}

impl Course {
    pub(super) fn reserve(&mut self, rows: usize, cones: usize) {
        self.pieces.reserve(rows);
        self.cones.reserve(cones);
    }
}

/// The cost of a block of rows as a function of the step length along a search direction: MuJoCo's
/// `PrimalPrepare`.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Piece {
    /// The coefficients of the step length and of its square.
    Equality([f64; 2]),
    Friction {
        start: f64,
        along: f64,
        loss: f64,
        bound: f64,
        d: f64,
    },
    /// The residual at step length 0, its change per unit of the step length, and the coefficients
    /// of the cost.
    Limit {
        start: f64,
        along: f64,
        quad: [f64; 3],
    },
    /// The number of the cone.
    Cone(usize),
}

/// The cost of an elliptic cone along a search direction. As in MuJoCo, `u` and `v` are the normal
/// residual and its change; `uu`, `uv` and `vv` are products of the tangential residuals and their
/// changes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cone {
    quad: [f64; 3],
    u: f64,
    v: f64,
    uu: f64,
    uv: f64,
    vv: f64,
    dm: f64,
    mu: f64,
    /// The zone and the tangential length at step length 0.
    start: (Zone, f64),
    /// From 4.0 on: the tangential residuals, each with its change, and their number; before, 0.
    parts: [[f64; 2]; 5],
    number: usize,
}

impl RowCosts<'_> {
    pub(super) fn prepare(&self, jar: &[f64], jv: &[f64], course: &mut Course) {
        let Course { pieces, cones } = course;
        pieces.clear();
        cones.clear();
        for block in self.blocks {
            for i in block.row..block.row + block.rows {
                let force = self.d[i] * jar[i];
                let quad = [
                    jar[i] * force * 0.5,
                    jv[i] * force,
                    jv[i] * self.d[i] * jv[i] * 0.5,
                ];
                pieces.push(match block.kind {
                    Kind::Equality => Piece::Equality([quad[1], quad[2]]),
                    Kind::Friction => Piece::Friction {
                        start: jar[i],
                        along: jv[i],
                        loss: self.loss[i],
                        bound: self.r[i] * self.loss[i],
                        d: self.d[i],
                    },
                    Kind::OneSided => Piece::Limit {
                        start: jar[i],
                        along: jv[i],
                        quad,
                    },
                    Kind::Cone => {
                        cones.extend(self.along_cone(block, jar, jv));
                        pieces.push(Piece::Cone(cones.len().saturating_sub(1)));
                        break;
                    }
                });
            }
        }
    }

    fn along_cone(&self, block: &Block, jar: &[f64], jv: &[f64]) -> Option<Cone> {
        let contact = self.contact(block)?;
        let (i, mu) = (block.row, contact.mu);
        let force = self.d[i] * jar[i];
        let mut quad = [jar[i] * force, jv[i] * force, jv[i] * self.d[i] * jv[i]];
        let (mut uu, mut uv, mut vv) = (0.0, 0.0, 0.0);
        let mut parts = [[0.0; 2]; 5];
        for j in 1..block.rows {
            let (x, y, d) = (jar[i + j], jv[i + j], self.d[i + j]);
            let force = d * x;
            quad = [
                quad[0] + x * force,
                quad[1] + y * force,
                quad[2] + y * d * y,
            ];
            let (u, v) = (x * contact.friction[j - 1], y * contact.friction[j - 1]);
            (uu, uv, vv) = (uu + u * u, uv + u * v, vv + v * v);
            parts[j - 1] = [u, v];
        }
        let (u, by_direction) = (jar[i] * mu, self.revision.slopes_by_direction());
        Some(Cone {
            quad: [quad[0] * 0.5, quad[1], quad[2] * 0.5],
            u,
            v: jv[i] * mu,
            uu,
            uv,
            vv,
            dm: self.d[i] / ((mu * mu) * (1.0 + mu * mu)),
            mu,
            start: zone_of_cone(mu, u, uu),
            parts,
            number: if by_direction { block.rows - 1 } else { 0 },
        })
    }
}

/// Returns the cost at the step length `alpha` relative to step length 0, its slope and its
/// curvature: MuJoCo's `PrimalEval`. `quad` has the coefficients of the smooth part of the cost.
pub(super) fn evaluate(course: &Course, alpha: f64, mut quad: [f64; 3]) -> [f64; 3] {
    let (mut cost, mut slope, mut curvature) = (0.0, 0.0, 0.0);
    for piece in &course.pieces {
        match piece {
            Piece::Equality([linear, square]) => {
                quad[1] += linear;
                quad[2] += square;
            }
            &Piece::Friction {
                start,
                along,
                loss,
                bound,
                d,
            } => {
                let x = start + alpha * along;
                cost += friction_difference(start, x, loss, bound, d);
                if -bound < x && x < bound {
                    slope += d * x * along;
                    curvature += d * along * along;
                } else if x <= -bound {
                    slope += -loss * along;
                } else {
                    slope += loss * along;
                }
            }
            Piece::Limit {
                start,
                along,
                quad: own,
            } => {
                let before = if *start < 0.0 { own[0] } else { 0.0 };
                if start + alpha * along < 0.0 {
                    quad[0] += own[0] - before;
                    quad[1] += own[1];
                    quad[2] += own[2];
                } else {
                    cost -= before;
                }
            }
            Piece::Cone(number) => {
                let [more, tilt, bend] = course.cones[*number].at(alpha);
                cost += more;
                slope += tilt;
                curvature += bend;
            }
        }
    }
    cost += alpha * alpha * quad[2] + alpha * quad[1] + quad[0];
    slope += 2.0 * alpha * quad[2] + quad[1];
    curvature += 2.0 * quad[2];
    [cost, slope, curvature]
}

/// Returns the piece of the cost of dry friction: -1 and 1 are linear, 0 is quadratic.
fn zone(x: f64, bound: f64) -> i8 {
    if -bound < x && x < bound {
        0
    } else if x <= -bound {
        -1
    } else {
        1
    }
}

fn friction_cost(x: f64, loss: f64, bound: f64, d: f64) -> f64 {
    match zone(x, bound) {
        0 => 0.5 * d * x * x,
        -1 => loss * (-0.5 * bound - x),
        _ => loss * (-0.5 * bound + x),
    }
}

fn friction_difference(start: f64, x: f64, loss: f64, bound: f64, d: f64) -> f64 {
    match (zone(start, bound), zone(x, bound)) {
        (0, 0) => 0.5 * d * (x - start) * (x + start),
        (-1, -1) => loss * (start - x),
        (1, 1) => loss * (x - start),
        _ => friction_cost(x, loss, bound, d) - friction_cost(start, loss, bound, d),
    }
}

/// The zones of a contact's elliptic cone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Zone {
    /// The contact separates: no force.
    Top,
    /// The contact sticks: the cost is quadratic.
    Bottom,
    /// The contact slides: the force is on the cone.
    Middle,
}

/// Returns the zone and the tangential length, given the normal part `n` and the square of the
/// tangential length.
fn zone_of_cone(mu: f64, n: f64, square: f64) -> (Zone, f64) {
    if square <= 0.0 {
        let zone = if n < 0.0 { Zone::Bottom } else { Zone::Top };
        return (zone, 0.0);
    }
    let t = square.sqrt();
    let zone = if n >= mu * t {
        Zone::Top
    } else if mu * n + t <= 0.0 {
        Zone::Bottom
    } else {
        Zone::Middle
    };
    (zone, t)
}

impl Cone {
    /// Returns the change of the cost from step length 0 to `alpha`, MuJoCo's `ellipticCostDif`,
    /// and the slope and curvature there.
    fn at(&self, alpha: f64) -> [f64; 3] {
        let Self { quad, mu, dm, .. } = *self;
        let parts = &self.parts[..self.number];
        let mut moved = [0.0; 5];
        let n = self.u + alpha * self.v;
        let square = if parts.is_empty() {
            self.uu + alpha * (2.0 * self.uv + alpha * self.vv)
        } else {
            let mut square = 0.0;
            for (moved, [u, v]) in moved.iter_mut().zip(parts) {
                *moved = u + alpha * v;
                square += *moved * *moved;
            }
            square
        };
        let ((start, t0), (end, t)) = (self.start, zone_of_cone(mu, n, square));
        let cost = match (start, end) {
            (Zone::Top, Zone::Top) => 0.0,
            (Zone::Bottom, Zone::Bottom) => alpha * alpha * quad[2] + alpha * quad[1],
            (Zone::Middle, Zone::Middle) => {
                let moved = alpha * self.v - mu * (self.growth(alpha) / (t + t0));
                let before = self.u - mu * t0;
                0.5 * dm * moved * (2.0 * before + moved)
            }
            (Zone::Middle, Zone::Bottom) => {
                let boundary = mu * self.u + t0;
                alpha * (alpha * quad[2] + quad[1]) + 0.5 * dm * boundary * boundary
            }
            (Zone::Bottom, Zone::Middle) => {
                let boundary = mu * n + t;
                alpha * (alpha * quad[2] + quad[1]) - 0.5 * dm * boundary * boundary
            }
            (Zone::Top, Zone::Bottom) => alpha * alpha * quad[2] + alpha * quad[1] + quad[0],
            (Zone::Top, Zone::Middle) => {
                let apart = n - mu * t;
                0.5 * dm * apart * apart
            }
            (Zone::Middle, Zone::Top) => {
                let before = self.u - mu * t0;
                -0.5 * dm * before * before
            }
            (Zone::Bottom, Zone::Top) => -quad[0],
        };
        let [slope, curvature] = match end {
            Zone::Top => [0.0; 2],
            Zone::Bottom => [2.0 * alpha * quad[2] + quad[1], 2.0 * quad[2]],
            Zone::Middle if self.number > 0 => {
                let (along, across) = self.slide(&moved, t);
                let slope = self.v - mu * (along / t);
                let bend = (n / t - mu) * (across * mu);
                [dm * (n - mu * t) * slope, dm * (slope * slope - bend)]
            }
            Zone::Middle => {
                let n1 = self.v;
                let t1 = (self.uv + alpha * self.vv) / t;
                let t2 = self.vv / t - (self.uv + alpha * self.vv) * t1 / (t * t);
                [
                    dm * (n - mu * t) * (n1 - mu * t1),
                    dm * ((n1 - mu * t1) * (n1 - mu * t1) + (n - mu * t) * (-mu * t2)),
                ]
            }
        };
        [cost, slope, curvature]
    }

    /// Returns the change of the square of the tangential length from step length 0 to `alpha`.
    fn growth(&self, alpha: f64) -> f64 {
        if self.number == 0 {
            return alpha * (2.0 * self.uv + alpha * self.vv);
        }
        let parts = self.parts[..self.number].iter();
        parts.fold(0.0, |sum, [u, v]| sum + alpha * v * (u + (u + alpha * v)))
    }

    /// Returns the scalar product of the tangential residuals and their changes, and the square of
    /// the part of the changes that is perpendicular to the residuals. `length` is the length of
    /// the residuals `moved`.
    fn slide(&self, moved: &[f64; 5], length: f64) -> (f64, f64) {
        let parts = &self.parts[..self.number];
        let products = parts.iter().zip(moved).map(|([_, v], moved)| moved * v);
        let along = products.fold(0.0, |sum, product| sum + product);
        let directions = moved.map(|moved| moved / length);
        let mut across = 0.0;
        for (j, [_, first]) in parts.iter().enumerate() {
            for (k, [_, second]) in parts.iter().enumerate().skip(j + 1) {
                let area = directions[j] * second - first * directions[k];
                across += area * area;
            }
        }
        (along, across)
    }
}
