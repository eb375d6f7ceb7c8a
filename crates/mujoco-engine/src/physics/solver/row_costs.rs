//! Costs and forces of rows in models with equality constraints, dry friction or elliptic cones.
//! (In all other models, rows only push: see [`cost_of_rows`](super::cost_of_rows).)

use super::cones::{Cone, Matrix, Scaled, Shape, parts};
use crate::math::number::Number;
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
    pub(super) matrix: Matrix<f64>,
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
        let (i, dim) = (block.row, block.rows);
        let scaled = Scaled::new(Shape::new(contact, self.d[i]), dim, |j| jar[i + j]);
        if scaled.zone.top {
            force[i..i + dim].fill(0.0);
            return (0.0, State::Satisfied);
        }
        if scaled.zone.bottom {
            return (0.0, State::Quadratic);
        }
        let (cost, forces) = scaled.slide(dim, self.revision);
        force[i..i + dim].copy_from_slice(&forces[..dim]);
        cones.push(ConeHessian {
            row: i,
            dim,
            matrix: scaled.bend(dim, self.revision),
        });
        (cost, State::Cone)
    }
}

/// The costs of all rows along a search direction.
#[derive(Clone, Debug, Default)]
pub(in crate::physics) struct Course {
    pieces: Vec<Piece>,
    cones: Vec<(Cone<f64>, usize)>,
}

impl Course {
    pub(in crate::physics) fn reserve(&mut self, rows: usize, cones: usize) {
        self.pieces.reserve(rows);
        self.cones.reserve(cones);
    }

    pub(in crate::physics) fn clear(&mut self) {
        self.pieces.clear();
        self.cones.clear();
    }

    /// Adds a row that is no row of a cone: residual, its change, stiffness, regularisation and
    /// friction loss.
    #[inline(always)]
    pub(in crate::physics) fn push(&mut self, kind: Kind, [jar, jv, d]: [f64; 3], rough: [f64; 2]) {
        let force = d * jar;
        let quad = [jar * force * 0.5, jv * force, jv * d * jv * 0.5];
        self.pieces.push(match kind {
            Kind::Equality => Piece::Equality([quad[1], quad[2]]),
            Kind::Friction => Piece::Friction([jar, jv, rough[1], rough[0] * rough[1], d]),
            Kind::OneSided | Kind::Cone => Piece::Limit {
                start: jar,
                along: jv,
                quad,
            },
        });
    }

    /// Adds a cone with its number of [`parts`].
    pub(in crate::physics) fn push_cone(&mut self, cone: Cone<f64>, parts: usize) {
        self.pieces.push(Piece::Cone(self.cones.len()));
        self.cones.push((cone, parts));
    }
}

/// The cost of a block of rows as a function of the step length along a search direction: MuJoCo's
/// `PrimalPrepare`.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Piece {
    /// The coefficients of the step length and of its square.
    Equality([f64; 2]),
    /// The arguments of [`friction_along`].
    Friction([f64; 5]),
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

impl RowCosts<'_> {
    pub(super) fn prepare(&self, jar: &[f64], jv: &[f64], course: &mut Course) {
        course.clear();
        for block in self.blocks {
            let (first, rows) = (block.row, block.rows);
            if block.kind == Kind::Cone {
                if let Some(contact) = self.contact(block) {
                    let shape = Shape::new(contact, self.d[first]);
                    let row = |k: usize| [jar[first + k], jv[first + k], self.d[first + k]];
                    let cone = Cone::new((), &shape, rows, row);
                    course.push_cone(cone, parts(rows, self.revision));
                }
                continue;
            }
            for i in first..first + rows {
                let rough = match block.kind {
                    Kind::Friction => [self.r[i], self.loss[i]],
                    _ => [0.0; 2],
                };
                course.push(block.kind, [jar[i], jv[i], self.d[i]], rough);
            }
        }
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
            Piece::Friction(row) => {
                let [more, tilt, bend] = friction_along((), *row, alpha);
                cost += more;
                slope += tilt;
                curvature += bend;
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
                let (cone, parts) = &course.cones[*number];
                let [more, tilt, bend] = match parts {
                    // most cones have three rows; the compiler unrolls loops
                    2 => cone.at((), alpha, 2),
                    parts => cone.at((), alpha, *parts),
                };
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

/// Returns the change of the cost of dry friction from step length 0 to `alpha`, and the slope and
/// curvature there: of a row with the residual `start` at step length 0, the residual's change, the
/// friction loss, the residual of largest force, and the stiffness.
#[inline(always)]
pub(in crate::physics) fn friction_along<N: Number>(
    place: N::At,
    [start, along, loss, bound, d]: [N; 5],
    alpha: N,
) -> [N; 3] {
    let (x, zero) = (start + alpha * along, N::of(place, 0.0));
    // the cost is quadratic between the bounds, and linear below and above
    let (inner,) = (
        #[inline(always)]
        |x: N| (-bound).is_less(x) & x.is_less(bound),
    );
    let (lower,) = (
        #[inline(always)]
        |x: N| x.is_at_most(-bound),
    );
    let (cost,) = (
        #[inline(always)]
        |x: N| {
            let [cost] = N::choose(
                inner(x),
                #[inline(always)]
                || [d * 0.5 * x * x],
                #[inline(always)]
                || {
                    N::choose(
                        lower(x),
                        #[inline(always)]
                        || [loss * (bound * -0.5 - x)],
                        #[inline(always)]
                        || [loss * (bound * -0.5 + x)],
                    )
                },
            );
            cost
        },
    );
    let [more] = N::choose(
        inner(start) & inner(x),
        #[inline(always)]
        || [d * 0.5 * (x - start) * (x + start)],
        #[inline(always)]
        || {
            N::choose(
                lower(start) & lower(x),
                #[inline(always)]
                || [loss * (start - x)],
                #[inline(always)]
                || {
                    N::choose(
                        inner(start) | lower(start) | inner(x) | lower(x),
                        #[inline(always)]
                        || [cost(x) - cost(start)],
                        #[inline(always)]
                        || [loss * (x - start)],
                    )
                },
            )
        },
    );
    let [slope, curvature] = N::choose(
        inner(x),
        #[inline(always)]
        || [d * x * along, d * along * along],
        #[inline(always)]
        || {
            N::choose(
                lower(x),
                #[inline(always)]
                || [-loss * along, zero],
                #[inline(always)]
                || [loss * along, zero],
            )
        },
    );
    [more, slope, curvature]
}
