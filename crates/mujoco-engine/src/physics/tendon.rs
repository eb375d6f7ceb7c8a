//! Lengths, Jacobians and velocities of tendons.

use super::jacobian::{moves_apart, sum_along};
use super::wrap::{Obstacle, wrap};
use crate::math::dense::{Lanes, dot_sparse, total};
use crate::math::spatial::{
    MINVAL, Vec3, add, add_scaled, cross, cross_motion, dot, norm, normalize, rotation, scale, sub,
    transform_motion, translation,
};
use crate::model::{JointType, TransmissionType, WrapType};
use crate::{Data, Model};

/// Computes lengths and Jacobians of the tendons: MuJoCo's `mj_tendon`.
#[inline]
pub fn tendon(m: &Model, d: &mut Data) {
    if m.ntendon() > 0 {
        tendons(m, d);
    }
}

fn tendons(m: &Model, d: &mut Data) {
    d.ten_j.fill(0.0);
    for t in 0..m.ntendon() {
        if m.plan().paths.fixed[t] {
            fixed(m, d, t);
        } else {
            d.ten_length[t] = along_path(m, d, t, |d, segment| straight(m, d, t, &segment));
        }
    }
}

/// Computes the velocities of the tendons.
pub fn tendon_velocity(m: &Model, d: &mut Data) {
    if m.ntendon() > 0 {
        velocities(m, d);
    }
}

fn velocities(m: &Model, d: &mut Data) {
    let paths = &m.plan().paths;
    for (velocity, row) in d.ten_velocity.iter_mut().zip(&paths.rows) {
        let columns = &paths.columns[row.clone()];
        *velocity = dot_sparse(&d.ten_j[row.clone()], columns, &d.qvel);
    }
}

/// Adds the forces that keep the inertia of tendons from changing their speed as their Jacobians
/// change: MuJoCo's `mj_tendonBias`.
#[cold]
pub(super) fn add_bias(m: &Model, d: &mut Data, forces: &mut [f64]) {
    for t in 0..m.ntendon() {
        let armature = m.tendon_armature[t];
        if armature == 0.0 || m.plan().paths.fixed[t] {
            continue;
        }
        let factor = armature * change(m, d, t);
        if factor != 0.0 {
            let paths = &m.plan().paths;
            let row = paths.rows[t].clone();
            for (&dof, arm) in paths.columns[row.clone()].iter().zip(&d.ten_j[row]) {
                forces[dof] += factor * arm;
            }
        }
    }
}

/// The change of a spatial tendon's Jacobian per second, times the velocity: MuJoCo's `mj_tendonDot`.
pub(super) fn change(m: &Model, d: &mut Data, t: usize) -> f64 {
    let mut change = 0.0;
    along_path(m, d, t, |d, segment| {
        add_change(m, d, &segment, &mut change);
    });
    change
}

/// Adds the change of a segment's Jacobian per second, times the velocity.
fn add_change(m: &Model, d: &Data, segment: &Segment, sum: &mut f64) {
    let [(first, start), (second, end)] = segment.ends;
    let velocity = |body: usize, point: Vec3| {
        let com = d.subtree_com[m.body_rootid[body]];
        translation(&transform_motion(&d.cvel[body], point, com))
    };
    let [begins, ends] = segment.ends.map(|(body, point)| velocity(body, point));
    let (along, length) = normalize(sub(end, start));
    let apart = sub(ends, begins);
    let across = add_scaled(apart, along, -dot(along, apart));
    let turning = scale(across, if length > MINVAL { 1.0 / length } else { 0.0 });
    let chains = [first, second].map(|body| m.plan().chain(body));
    let mut terms = Terms::new(m, segment.divisor, *sum);
    let moved = |dof: usize| chains.map(|chain| chain.contains(&dof));
    for dof in 0..m.nv() {
        let (moved, joint) = (moved(dof), m.dof_jntid[dof]);
        let turns = match m.jnt_type[joint] {
            JointType::Ball => true,
            JointType::Free => dof >= m.jnt_dofadr[joint] + 3,
            _ => false,
        };
        let axis = d.cdof[dof];
        let rate = if turns {
            cross_motion(&d.cvel[m.dof_bodyid[dof]], &axis)
        } else {
            d.cdof_dot[dof]
        };
        let rate_of = |k: usize, velocity: Vec3| {
            if !moved[k] {
                return [0.0; 3];
            }
            let (body, point) = segment.ends[k];
            let offset = sub(point, d.subtree_com[m.body_rootid[body]]);
            let by_rate = cross(rotation(&rate), offset);
            let by_motion = cross(rotation(&axis), velocity);
            add(add(translation(&rate), by_rate), by_motion)
        };
        if moved != [false; 2] {
            let rate = sub(rate_of(1, ends), rate_of(0, begins));
            terms.add(dof, sum_along(rate, along), d.qvel[dof]);
        }
    }
    terms.finish();
    for dof in 0..m.nv() {
        let moved = moved(dof);
        if moved != [false; 2] {
            let points = [1, 0].map(|k| (moved[k], segment.ends[k].0, segment.ends[k].1));
            let moves = moves_apart(m, &d.cdof, &d.subtree_com, dof, points);
            terms.add(dof, sum_along(moves, turning), d.qvel[dof]);
        }
    }
    terms.finish();
    *sum = terms.sum;
}

/// A sum over degrees of freedom in MuJoCo's order: with sparse Jacobians one after the other, with
/// dense ones as `mju_dot`.
struct Terms {
    dense: bool,
    nv: usize,
    divisor: f64,
    lanes: Lanes,
    rest: f64,
    sum: f64,
}

impl Terms {
    fn new(m: &Model, divisor: f64, sum: f64) -> Self {
        Self {
            dense: match m.opt.jacobian {
                0 => true,
                1 => false,
                _ => m.nv() < 60,
            },
            nv: m.nv(),
            divisor,
            lanes: [0.0; 4],
            rest: 0.0,
            sum,
        }
    }

    fn add(&mut self, dof: usize, slope: f64, velocity: f64) {
        if !self.dense {
            self.sum += slope / self.divisor * velocity;
        } else if dof < self.nv - self.nv % 4 {
            self.lanes[dof % 4] += slope * velocity;
        } else {
            self.rest += slope * velocity;
        }
    }

    /// Adds the terms so far to the sum.
    fn finish(&mut self) {
        if self.dense {
            self.sum += (total(&self.lanes) + self.rest) / self.divisor;
            (self.lanes, self.rest) = ([0.0; 4], 0.0);
        }
    }
}

/// Computes a fixed tendon: a sum of joint positions, each times its coefficient.
fn fixed(m: &Model, d: &mut Data, t: usize) {
    let paths = &m.plan().paths;
    let row = paths.rows[t].clone();
    let columns = &paths.columns[row.clone()];
    let mut length = 0.0;
    for w in m.tendon_adr[t]..m.tendon_adr[t] + m.tendon_num[t] {
        let (joint, coefficient) = (m.wrap_objid[w] as usize, m.wrap_prm[w]);
        length += coefficient * d.qpos[m.jnt_qposadr[joint]];
        if let Ok(place) = columns.binary_search(&m.jnt_dofadr[joint]) {
            d.ten_j[row.start + place] += coefficient;
        }
    }
    d.ten_length[t] = length;
}

/// A straight part of a spatial tendon, from a point on one body to a point on the next. Lengths
/// after a pulley are divided by its divisor.
pub(super) struct Segment {
    /// Each end's body and point.
    pub(super) ends: [(usize, Vec3); 2],
    pub(super) divisor: f64,
}

impl Segment {
    /// The direction from the first point to the second.
    pub(super) fn direction(&self) -> Vec3 {
        normalize(sub(self.ends[1].1, self.ends[0].1)).0
    }
}

/// Follows a spatial tendon through sites and around geoms. Calls `visit` for each straight part
/// between two bodies. Returns the tendon's length.
pub(super) fn along_path(
    m: &Model,
    d: &mut Data,
    t: usize,
    mut visit: impl FnMut(&mut Data, Segment),
) -> f64 {
    let (first, number) = (m.tendon_adr[t], m.tendon_num[t]);
    let part = |j: usize| (m.wrap_type[first + j], m.wrap_objid[first + j]);
    let (mut divisor, mut length, mut j) = (1.0, 0.0, 0);
    while j + 1 < number {
        let ((kind, id), (next_kind, next)) = (part(j), part(j + 1));
        if kind == WrapType::Pulley || next_kind == WrapType::Pulley {
            if kind == WrapType::Pulley {
                divisor = m.wrap_prm[first + j];
            }
            j += 1;
            continue;
        }
        let start = id as usize;
        let begin = (m.site_bodyid[start], d.site_xpos[start]);
        let geom = next as usize;
        let around = match next_kind {
            WrapType::Sphere | WrapType::Cylinder => {
                let end = d.site_xpos[part(j + 2).1 as usize];
                let side = m.wrap_prm[first + j + 1].round();
                let obstacle = Obstacle {
                    cylinder: next_kind == WrapType::Cylinder,
                    pos: d.geom_xpos[geom],
                    mat: &d.geom_xmat[geom],
                    radius: m.geom_size[geom][0],
                    side: (side >= 0.0).then(|| d.site_xpos[side as usize]),
                };
                j += 2;
                wrap(begin.1, end, &obstacle, m.revision)
            }
            _ => {
                j += 1;
                None
            }
        };
        let end = part(j).1 as usize;
        let end = (m.site_bodyid[end], d.site_xpos[end]);
        let mut part = |ends: [(usize, Vec3); 2]| {
            if ends[0].0 != ends[1].0 {
                visit(d, Segment { ends, divisor });
            }
        };
        match around {
            None => {
                length += distance(begin.1, end.1) / divisor;
                part([begin, end]);
            }
            Some((arc, [enter, leave])) => {
                let sum = distance(begin.1, enter) + arc + distance(leave, end.1);
                length += sum / divisor;
                let body = m.geom_bodyid[geom];
                part([begin, (body, enter)]);
                part([(body, leave), end]);
            }
        }
    }
    length
}

/// The actuators that pull a tendon.
pub(super) fn pulling(m: &Model, tendon: usize) -> impl Iterator<Item = usize> {
    (0..m.nu()).filter(move |&i| {
        m.actuator_trntype[i] == TransmissionType::Tendon
            && m.actuator_trnid[i][0] as usize == tendon
    })
}

fn distance(a: Vec3, b: Vec3) -> f64 {
    norm(sub(a, b))
}

/// Adds the Jacobian of a straight part.
fn straight(m: &Model, d: &mut Data, t: usize, segment: &Segment) {
    let [(b1, p1), (b2, p2)] = segment.ends;
    let direction = segment.direction();
    let paths = &m.plan().paths;
    let row = paths.rows[t].clone();
    let (chain1, chain2) = (m.plan().chain(b1), m.plan().chain(b2));
    for (&dof, value) in paths.columns[row.clone()].iter().zip(&mut d.ten_j[row]) {
        let (first, second) = (chain1.contains(&dof), chain2.contains(&dof));
        if !first && !second {
            continue;
        }
        let ends = [(second, b2, p2), (first, b1, p1)];
        let apart = moves_apart(m, &d.cdof, &d.subtree_com, dof, ends);
        let along = sum_along(apart, direction);
        *value += 1.0 / segment.divisor * along;
    }
}
