//! Spatial inertias and motion axes about the centres of mass of the trees.

use super::spatial::{MINVAL, add, column, cross, inertia_at, join, scale, sub};
use crate::model::JointType;
use crate::{Data, Model};

/// `subtree_com`, `cinert` and `cdof`: MuJoCo's `mj_comPos`.
#[inline(always)]
pub fn com_pos(m: &Model, d: &mut Data) {
    // slices of one length: an index is checked once for all of them
    let n = m.nbody();
    let (parents, roots, masses) = (
        &m.body_parentid[..n],
        &m.body_rootid[..n],
        &m.body_mass[..n],
    );
    let (xipos, ximat, com, cinert) = (
        &d.xipos[..n],
        &d.ximat[..n],
        &mut d.subtree_com[..n],
        &mut d.cinert[..n],
    );
    for b in 0..n {
        com[b] = scale(xipos[b], masses[b]);
    }
    for b in (1..n).rev() {
        com[parents[b]] = add(com[parents[b]], com[b]);
    }
    for b in 0..n {
        let mass = m.body_subtreemass[b];
        com[b] = if mass < MINVAL {
            xipos[b]
        } else {
            scale(com[b], 1.0 / mass)
        };
    }

    for b in 1..n {
        let offset = sub(xipos[b], com[roots[b]]);
        cinert[b] = inertia_at(m.body_inertia[b], &ximat[b], offset, masses[b]);
    }

    for j in 0..m.njnt() {
        let (b, i) = (m.jnt_bodyid[j], m.jnt_dofadr[j]);
        let offset = sub(d.subtree_com[m.body_rootid[b]], d.xanchor[j]);
        match m.jnt_type[j] {
            JointType::Free => {
                for k in 0..3 {
                    d.cdof[i + k] = [0.0; 6];
                    d.cdof[i + k][3 + k] = 1.0;
                    let axis = column(&d.xmat[b], k);
                    d.cdof[i + 3 + k] = join(axis, cross(axis, offset));
                }
            }
            JointType::Ball => {
                for k in 0..3 {
                    let axis = column(&d.xmat[b], k);
                    d.cdof[i + k] = join(axis, cross(axis, offset));
                }
            }
            JointType::Slide => d.cdof[i] = join([0.0; 3], d.xaxis[j]),
            JointType::Hinge => d.cdof[i] = join(d.xaxis[j], cross(d.xaxis[j], offset)),
        }
    }
}
