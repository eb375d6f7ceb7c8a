//! Jacobians of points of bodies.

use crate::math::spatial::{Vec3, add, cross, rotation, sub, translation};
use crate::{Data, Model};

/// The velocity of `point` per unit velocity of `dof`, which moves `body`.
#[inline]
pub(super) fn moves_at(
    m: &Model,
    cdof: &[[f64; 6]],
    com: &[Vec3],
    dof: usize,
    body: usize,
    point: Vec3,
) -> Vec3 {
    let offset = sub(point, com[m.body_rootid[body]]);
    let axis = &cdof[dof];
    add(translation(axis), cross(rotation(axis), offset))
}

/// The velocity of the first point relative to the second per unit velocity of `dof`. Each point has
/// its body, and whether `dof` moves that body.
#[inline(always)] // calls take a third of a step of lqr, which has a tendon for each mass
pub(super) fn moves_apart(
    m: &Model,
    cdof: &[[f64; 6]],
    com: &[Vec3],
    dof: usize,
    points: [(bool, usize, Vec3); 2],
) -> Vec3 {
    let [first, second] = points;
    let moves = |(moved, body, point)| {
        if moved {
            moves_at(m, cdof, com, dof, body, point)
        } else {
            [0.0; 3]
        }
    };
    sub(moves(first), moves(second))
}

/// Returns the dot product of `moves` and `force`. The sum skips components of `force` that are
/// zero.
pub(super) fn sum_along(moves: Vec3, force: Vec3) -> f64 {
    let mut sum = 0.0;
    for k in 0..3 {
        if force[k] != 0.0 {
            sum += moves[k] * force[k];
        }
    }
    sum
}

/// Adds a force and a torque at a point of a body to the joint forces: MuJoCo's `mj_applyFT`.
pub(super) fn apply(
    m: &Model,
    d: &Data,
    force: Vec3,
    torque: Vec3,
    (body, point): (usize, Vec3),
    out: &mut [f64],
) {
    for &dof in m.plan().chain(body) {
        let moves = moves_at(m, &d.cdof, &d.subtree_com, dof, body, point);
        out[dof] += sum_along(moves, force);
        out[dof] += sum_along(rotation(&d.cdof[dof]), torque);
    }
}

impl Data {
    /// The Jacobian of a point of a body: translation and rotation for each degree of freedom
    /// (3 rows of nv numbers each): MuJoCo's `mj_jac`.
    #[must_use]
    pub fn jac(&self, m: &Model, body: usize, point: [f64; 3]) -> [Vec<f64>; 2] {
        let nv = m.nv();
        let mut both = [vec![0.0; 3 * nv], vec![0.0; 3 * nv]];
        for &dof in m.plan().chain(body) {
            let moves = moves_at(m, &self.cdof, &self.subtree_com, dof, body, point);
            for k in 0..3 {
                both[0][k * nv + dof] = moves[k];
                both[1][k * nv + dof] = self.cdof[dof][k];
            }
        }
        both
    }

    /// The Jacobian of a site: MuJoCo's `mj_jacSite`.
    #[must_use]
    pub fn jac_site(&self, m: &Model, site: usize) -> [Vec<f64>; 2] {
        self.jac(m, m.site_bodyid[site], self.site_xpos[site])
    }
}
