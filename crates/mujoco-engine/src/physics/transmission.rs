//! Lengths and moment arms of actuators.

use std::ops::Range;

use super::jacobian::{moves_apart, moves_at, sum_along};
use crate::math::dense::dot_sparse;
use crate::math::spatial::{
    InTurn, Order, Pairwise, Quat, Vec3, add, column, cross, dot, quat_to_velocity, rotate,
    rotate_back, rotate_quat, rotation, scale, sub,
};
use crate::model::{Cone, Disable, JointType, TransmissionType};
use crate::{Contact, Data, Model};

/// The moment arms of the actuators: each actuator has a sparse row over the degrees of freedom
/// that the actuator moves.
#[derive(Clone, Debug, Default)]
pub(crate) struct Moments {
    pub(crate) rows: Vec<Range<usize>>,
    pub(crate) columns: Vec<usize>,
    pub(crate) values: Vec<f64>,
}

impl Moments {
    /// Empty rows of all actuators, with room for the degrees of freedom.
    pub(crate) fn new(m: &Model) -> Self {
        let mut moments = Self {
            rows: vec![0..0; m.nu()],
            ..Self::default()
        };
        if m.plan().transmits {
            moments.columns.reserve(m.nu() * m.nv());
            // the row of an actuator on a body needs twice as many while it is computed
            moments.values.reserve((m.nu() + 1) * m.nv());
        }
        moments
    }

    /// Empties the rows.
    pub(crate) fn reset(&mut self) {
        self.rows.fill(0..0);
    }

    fn clear(&mut self) {
        self.rows.clear();
        self.columns.clear();
        self.values.clear();
    }

    fn push(&mut self, column: usize, value: f64) {
        self.columns.push(column);
        self.values.push(value);
    }

    /// The degrees of freedom of an actuator, and their moment arms.
    pub(crate) fn row(&self, actuator: usize) -> (&[usize], &[f64]) {
        let row = self.rows[actuator].clone();
        (&self.columns[row.clone()], &self.values[row])
    }
}

/// Computes `actuator_length` and the moment arms: MuJoCo's `mj_transmission`.
pub fn transmission(m: &Model, d: &mut Data) {
    let mut moments = std::mem::take(&mut d.work.moments);
    moments.clear();
    for i in 0..m.nu() {
        let first = moments.values.len();
        d.actuator_length[i] = if m.revision.adds_in_pairs() {
            length::<Pairwise>(m, d, i, &mut moments)
        } else {
            length::<InTurn>(m, d, i, &mut moments)
        };
        moments.rows.push(first..moments.values.len());
    }
    d.work.moments = moments;
}

/// The moment arms of an actuator, dense.
pub(crate) fn moment(d: &Data, actuator: usize, nv: usize) -> Vec<f64> {
    let mut moment = vec![0.0; nv];
    let (columns, values) = d.work.moments.row(actuator);
    for (&dof, value) in columns.iter().zip(values) {
        moment[dof] = *value;
    }
    moment
}

/// Computes `actuator_velocity`, which is 0 without actuation.
pub fn transmission_velocity(m: &Model, d: &mut Data) {
    if d.work.unactuated || m.opt.disables(Disable::Actuation) {
        d.actuator_velocity.fill(0.0);
        return;
    }
    for i in 0..m.nu() {
        let (columns, values) = d.work.moments.row(i);
        d.actuator_velocity[i] = dot_sparse(values, columns, &d.qvel);
    }
}

fn length<O: Order>(m: &Model, d: &Data, i: usize, moments: &mut Moments) -> f64 {
    let [id, reference] = m.actuator_trnid[i];
    let (id, gear) = (id as usize, m.actuator_gear[i]);
    match m.actuator_trntype[i] {
        TransmissionType::Joint => joint::<O>(m, d, id, &gear, false, moments),
        TransmissionType::JointInParent => joint::<O>(m, d, id, &gear, true, moments),
        TransmissionType::Tendon => {
            let paths = &m.plan().paths;
            let row = paths.rows[id].clone();
            for (&column, value) in paths.columns[row.clone()].iter().zip(&d.ten_j[row]) {
                moments.push(column, value * gear[0]);
            }
            d.ten_length[id] * gear[0]
        }
        TransmissionType::Site => match usize::try_from(reference) {
            Ok(reference) => between_sites::<O>(m, d, [id, reference], &gear, moments),
            Err(_) => {
                let (push, turn) = halves(&gear);
                let mat = &d.site_xmat[id];
                at_site(m, d, id, rotate(mat, push), rotate(mat, turn), moments);
                0.0
            }
        },
        TransmissionType::SliderCrank => {
            let rod = m.actuator_cranklength[i];
            slider_crank(m, d, [id, reference as usize], rod, gear[0], moments)
        }
        TransmissionType::Body => {
            adhesion(m, d, id, moments);
            0.0
        }
    }
}

fn halves(gear: &[f64; 6]) -> (Vec3, Vec3) {
    ([gear[0], gear[1], gear[2]], [gear[3], gear[4], gear[5]])
}

fn joint<O: Order>(
    m: &Model,
    d: &Data,
    joint: usize,
    gear: &[f64; 6],
    in_parent: bool,
    moments: &mut Moments,
) -> f64 {
    let (p, v) = (m.jnt_qposadr[joint], m.jnt_dofadr[joint]);
    let quat = |p: usize| O::normalize_quat((), [0, 1, 2, 3].map(|k| d.qpos[p + k]));
    // transforms an axis from the parent's frame to the body's
    let turned = |axis: Vec3, q: Quat| {
        if in_parent {
            rotate_quat(axis, [q[0], -q[1], -q[2], -q[3]])
        } else {
            axis
        }
    };
    let (first, second) = halves(gear);
    match m.jnt_type[joint] {
        JointType::Slide | JointType::Hinge => {
            moments.push(v, gear[0]);
            d.qpos[p] * gear[0]
        }
        JointType::Ball => {
            let quat = quat(p);
            let axis = turned(first, quat);
            for k in 0..3 {
                moments.push(v + k, axis[k]);
            }
            dot(quat_to_velocity(quat), axis)
        }
        JointType::Free => {
            let axis = turned(second, quat(p + 3));
            for (k, x) in first.into_iter().chain(axis).enumerate() {
                moments.push(v + k, x);
            }
            0.0
        }
    }
}

fn push_nonzero(moments: &mut Moments, dof: usize, value: f64) {
    if value != 0.0 {
        moments.push(dof, value);
    }
}

/// Adds the moment arms of a force and a torque at a site, in the world's axes.
fn at_site(m: &Model, d: &Data, site: usize, force: Vec3, torque: Vec3, moments: &mut Moments) {
    let (body, point) = (m.site_bodyid[site], d.site_xpos[site]);
    for &dof in m.plan().chain(body) {
        let moves = moves_at(m, &d.cdof, &d.subtree_com, dof, body, point);
        let value = sum_along(moves, force) + sum_along(rotation(&d.cdof[dof]), torque);
        push_nonzero(moments, dof, value);
    }
}

/// The length and the moment arms of a slider-crank: the position of the slider, which a rod of
/// length `rod` joins to the pin, along the z axis of its site.
fn slider_crank(
    m: &Model,
    d: &Data,
    [pin, slider]: [usize; 2],
    rod: f64,
    gear: f64,
    moments: &mut Moments,
) -> f64 {
    let axis = column(&d.site_xmat[slider], 2);
    let between = sub(d.site_xpos[pin], d.site_xpos[slider]);
    let along = dot(between, axis);
    let det = along * along + rod * rod - dot(between, between);
    // the derivatives of the length by the axis and by the vector between the sites
    let (length, by_axis, by_between) = if det <= 0.0 {
        (along, between, axis)
    } else {
        let root = det.sqrt();
        let share = 1.0 - along / root;
        let by_between = add(scale(axis, share), scale(between, 1.0 / root));
        (along - root, scale(between, share), by_between)
    };
    let bodies = [pin, slider].map(|site| m.site_bodyid[site]);
    let chains = bodies.map(|body| m.plan().chain(body));
    for dof in 0..m.nv() {
        let moves = |at: usize, site: usize| {
            if chains[at].contains(&dof) {
                moves_at(
                    m,
                    &d.cdof,
                    &d.subtree_com,
                    dof,
                    bodies[at],
                    d.site_xpos[site],
                )
            } else {
                [0.0; 3]
            }
        };
        let turns = if chains[1].contains(&dof) {
            cross(rotation(&d.cdof[dof]), axis)
        } else {
            [0.0; 3]
        };
        let apart = sub(moves(0, pin), moves(1, slider));
        let mut value = 0.0;
        for k in 0..3 {
            value += by_axis[k] * turns[k] + by_between[k] * apart[k];
        }
        if value != 0.0 {
            moments.push(dof, value * gear);
        }
    }
    length * gear
}

/// The moment arms of adhesion: the mean of the directions of the normals of a body's contacts,
/// inwards.
fn adhesion(m: &Model, d: &Data, body: usize, moments: &mut Moments) {
    let nv = m.nv();
    let first = moments.values.len();
    // dense rows, in which values are summed: of contacts that push, and of those in the gap
    moments.columns.extend(0..nv);
    moments.values.resize(first + 2 * nv, 0.0);
    let (sums, within) = moments.values[first..].split_at_mut(nv);
    let elliptic = m.opt.cone == Cone::Elliptic;
    let own = |contact: &&Contact| contact.geom.map(|g| m.geom_bodyid[g]).contains(&body);
    let mut count = 0_u32;
    for contact in d.contact.iter().filter(own) {
        let Ok(row) = usize::try_from(contact.efc_address) else {
            continue;
        };
        count += 1;
        let (rows, weight) = if contact.dim == 1 || elliptic {
            (1, 1.0)
        } else {
            let directions = usize::from(contact.dim) - 1;
            (2 * directions, 0.5 / directions as f64)
        };
        for row in row..row + rows {
            for (sum, value) in sums.iter_mut().zip(d.efc.row(row)) {
                *sum += value * weight;
            }
        }
    }
    let gap = |contact: &&Contact| contact.dist >= contact.includemargin && contact.efc_address < 0;
    for contact in d.contact.iter().filter(own).filter(gap) {
        count += 1;
        let frame = &contact.frame;
        let bodies = contact.geom.map(|g| m.geom_bodyid[g]);
        let chains = bodies.map(|body| m.plan().chain(body));
        for (dof, sum) in within.iter_mut().enumerate() {
            let points = [1, 0].map(|k| (chains[k].contains(&dof), bodies[k], contact.pos));
            let apart = moves_apart(m, &d.cdof, &d.subtree_com, dof, points);
            *sum += frame[0] * apart[0] + frame[1] * apart[1] + frame[2] * apart[2];
        }
    }
    for (sum, within) in sums.iter_mut().zip(within) {
        *sum += *within;
    }
    let mut kept = first;
    for dof in 0..nv {
        let value = moments.values[first + dof] * (-1.0 / f64::from(count.max(1_u32)));
        if value != 0.0 {
            (moments.columns[kept], moments.values[kept]) = (dof, value);
            kept += 1;
        }
    }
    moments.columns.truncate(kept);
    moments.values.truncate(kept);
}

/// Computes the length and the moment arms of an actuator with a reference site: the length is the
/// product of the gear and the site's pose relative to the reference site.
fn between_sites<O: Order>(
    m: &Model,
    d: &Data,
    [site, reference]: [usize; 2],
    gear: &[f64; 6],
    moments: &mut Moments,
) -> f64 {
    let (push, turn) = halves(gear);
    let mut length = 0.0;
    let mat = &d.site_xmat[reference];
    let used = |v: Vec3| v != [0.0; 3];
    if used(push) {
        let apart = sub(d.site_xpos[site], d.site_xpos[reference]);
        length += dot(rotate_back(mat, apart), push);
    }
    if used(turn) {
        let quat = |s: usize| {
            let (own, body) = (m.site_quat[s], d.xquat[m.site_bodyid[s]]);
            if m.revision.refers_to_world() {
                O::mul_quat(body, own)
            } else {
                // 3.12 multiplies in the wrong order
                O::mul_quat(own, body)
            }
        };
        length += dot(O::sub_quat(quat(site), quat(reference)), turn);
    }
    let (force, torque) = (rotate(mat, push), rotate(mat, turn));
    let bodies = [site, reference].map(|s| m.site_bodyid[s]);
    let chains = bodies.map(|b| m.plan().chain(b));
    for dof in 0..m.nv() {
        let [own, other] = chains.map(|chain| chain.contains(&dof));
        // degrees of freedom that move both sites do not change their distance
        if own == other {
            continue;
        }
        let moves = |at: usize, s: usize| {
            moves_at(m, &d.cdof, &d.subtree_com, dof, bodies[at], d.site_xpos[s])
        };
        let (shift, spin) = if own {
            (moves(0, site), rotation(&d.cdof[dof]))
        } else {
            let negative = |v: Vec3| sub([0.0; 3], v);
            let spin = negative(rotation(&d.cdof[dof]));
            (negative(moves(1, reference)), spin)
        };
        let mut value = 0.0;
        if used(push) {
            value = sum_along(shift, force);
        }
        if used(turn) {
            value += sum_along(spin, torque);
        }
        push_nonzero(moments, dof, value);
    }
    length
}
