//! Spatial inertias and motion axes about the centres of mass of the trees.

use super::sleep;
use crate::math::number::{self, Number, get, put};
use crate::math::spatial::{add, column, cross, inertia_at, join, scale, sub};
use crate::model::JointType;
use crate::{Data, Model};

/// The arrays that this stage reads and writes, of one world or of several.
pub(crate) struct Inertias<'a, C> {
    pub(crate) xmat: &'a [[C; 9]],
    pub(crate) xipos: &'a [[C; 3]],
    pub(crate) ximat: &'a [[C; 9]],
    pub(crate) xanchor: &'a [[C; 3]],
    pub(crate) xaxis: &'a [[C; 3]],
    pub(crate) subtree_com: &'a mut [[C; 3]],
    pub(crate) cinert: &'a mut [[C; 10]],
    pub(crate) cdof: &'a mut [[C; 6]],
}

/// Computes `subtree_com`, `cinert` and `cdof`: MuJoCo's `mj_comPos`.
#[inline(always)]
pub fn com_pos(m: &Model, d: &mut Data) {
    let inertias = Inertias {
        xmat: &d.xmat,
        xipos: &d.xipos,
        ximat: &d.ximat,
        xanchor: &d.xanchor,
        xaxis: &d.xaxis,
        subtree_com: &mut d.subtree_com,
        cinert: &mut d.cinert,
        cdof: &mut d.cdof,
    };
    if m.plan().sleeps {
        let awake = &d.work.tree_awake;
        com_pos_of::<f64>(m, (), inertias, |b| sleep::body_sleeps(m, awake, b));
    } else {
        com_pos_of::<f64>(m, (), inertias, |_| false);
    }
}

/// [`com_pos`] for one world or several. `asleep` tells whether a body sleeps.
#[inline(always)]
pub(crate) fn com_pos_of<N: Number>(
    m: &Model,
    at: N::At,
    numbers: Inertias<'_, N::Cell>,
    asleep: impl Fn(usize) -> bool,
) {
    // slices of equal length let the compiler check an index once for all of them
    let n = m.nbody();
    let bodies = &m.plan().bodies[..n];
    let (xipos, ximat) = (&numbers.xipos[..n], &numbers.ximat[..n]);
    let (com, cinert) = (&mut numbers.subtree_com[..n], &mut numbers.cinert[..n]);
    for b in 0..n {
        let part = scale(get::<N, 3>(at, &xipos[b]), bodies[b].mass);
        put(at, part, &mut com[b]);
    }
    for b in (1..n).rev() {
        let parent = bodies[b].parent;
        let (sum, mut part) = (get::<N, 3>(at, &com[parent]), get::<N, 3>(at, &com[b]));
        if asleep(b) && !asleep(parent) {
            // of what sleeps, MuJoCo keeps the centre, not the moment
            let centre = centre::<N>(bodies[b].inverse_mass, at, &xipos[b], part);
            part = scale(centre, m.body_subtreemass[b]);
        }
        put(at, add(sum, part), &mut com[parent]);
    }
    for b in 0..n {
        let body = &bodies[b];
        let centre = centre::<N>(body.inverse_mass, at, &xipos[b], get(at, &com[b]));
        put(at, centre, &mut com[b]);
        if b > 0 {
            let offset = sub(get::<N, 3>(at, &xipos[b]), get(at, &com[body.root]));
            let mat = get(at, &ximat[b]);
            let inertia = inertia_at(at, body.moments, &mat, offset, body.mass);
            put(at, inertia, &mut cinert[b]);
        }
    }

    let cdof = numbers.cdof;
    for (j, joint) in m.plan().joints.iter().enumerate() {
        let (b, i) = (joint.body, joint.dof);
        let centre = get::<N, 3>(at, &com[joint.root]);
        let offset = sub(centre, get(at, &numbers.xanchor[j]));
        let axis = get::<N, 3>(at, &numbers.xaxis[j]);
        match joint.kind {
            JointType::Free => {
                let mat = get(at, &numbers.xmat[b]);
                for k in 0..3 {
                    let mut slide = [0.0; 6];
                    slide[3 + k] = 1.0;
                    put(at, number::of::<N, 6>(at, slide), &mut cdof[i + k]);
                    let axis = column(&mat, k);
                    put(at, join(axis, cross(axis, offset)), &mut cdof[i + 3 + k]);
                }
            }
            JointType::Ball => {
                let mat = get(at, &numbers.xmat[b]);
                for k in 0..3 {
                    let axis = column(&mat, k);
                    put(at, join(axis, cross(axis, offset)), &mut cdof[i + k]);
                }
            }
            JointType::Slide => {
                put(at, join(number::of(at, [0.0; 3]), axis), &mut cdof[i]);
            }
            JointType::Hinge => {
                put(at, join(axis, cross(axis, offset)), &mut cdof[i]);
            }
        }
    }
}

/// The centre of mass of a subtree with `moment`, or of its body, at `xipos`, where the subtree has no mass.
#[inline(always)] // out of line, a part of a stage has no vector instructions
fn centre<N: Number>(
    inverse_mass: Option<f64>,
    at: N::At,
    xipos: &[N::Cell; 3],
    moment: [N; 3],
) -> [N; 3] {
    match inverse_mass {
        Some(inverse) => scale(moment, inverse),
        None => get(at, xipos),
    }
}
