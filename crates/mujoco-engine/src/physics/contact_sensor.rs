//! Sensors of contacts.

use super::contact_force::contact_force;
use super::sensor::inside;
use crate::math::spatial::{
    MINVAL, Vec3, add, add_scaled, cross, dot, norm, rotate_back, scale, sub,
};
use crate::model::{CONTACT, ObjectType};
use crate::{Contact, Data, Model};

/// Writes the values of a sensor of contacts.
pub(super) fn read(m: &Model, d: &Data, i: usize, out: &mut [f64]) {
    out.fill(0.0);
    let [bits, reduction, number] = m.sensor_intprm[i];
    let number = usize::try_from(number).unwrap_or(0).max(1);
    let size = out.len() / number;
    let matching = || {
        let all = d.contact.iter().enumerate();
        all.filter_map(|(id, contact)| Some((id, contact, side(m, d, i, contact)?)))
    };
    let count = matching().count();
    if reduction == 3 && !(count == 0 && m.revision.sums_no_contacts_to_zero()) {
        write(bits, &mut out[..size], sum(m, d, count, matching));
        return;
    }
    let mut last = None;
    for (slot, place) in out.chunks_mut(size.max(1)).take(count).enumerate() {
        // the next contact in the order of the reduction
        let key = |id: usize, contact: &Contact| match reduction {
            1 => contact.dist,
            2 => {
                let [x, y, z, ..] = contact_force(m, d, contact);
                -dot([x, y, z], [x, y, z])
            }
            _ => id as f64,
        };
        let next = if reduction == 0 {
            matching().nth(slot)
        } else {
            let keyed = matching().map(|found| ((key(found.0, found.1), found.0), found));
            let rest = keyed.filter(|(own, _)| last.is_none_or(|last| *own > last));
            let first = rest.min_by(|(a, _), (b, _)| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            last = first.as_ref().map(|(own, _)| *own);
            first.map(|(_, found)| found)
        };
        let Some((_, contact, flip)) = next else {
            break;
        };
        let [fx, fy, fz, tx, ty, tz] = contact_force(m, d, contact);
        let sign = if flip { -1.0 } else { 1.0 };
        let axis = |k: usize| {
            let axis = [0, 1, 2].map(|j| contact.frame[k + j]);
            if flip { scale(axis, -1.0) } else { axis }
        };
        let values = [
            [count as f64, 0.0, 0.0],
            [fx, fy, fz * sign],
            [tx, ty, tz * sign],
            [contact.dist, 0.0, 0.0],
            contact.pos,
            axis(0),
            axis(3),
        ];
        write(bits, place, values);
    }
}

/// Writes the values of a contact that are asked for.
fn write(bits: i32, mut place: &mut [f64], values: [Vec3; 7]) {
    for (k, ((_, size), value)) in CONTACT.iter().zip(values).enumerate() {
        if bits & (1 << k) != 0 {
            let (own, rest) = place.split_at_mut(*size);
            own.copy_from_slice(&value[..*size]);
            place = rest;
        }
    }
}

/// The force and torque of all contacts, in the world's axes, about the mean of their positions,
/// weighted by their forces.
fn sum<'a, I>(m: &Model, d: &Data, count: usize, matching: impl Fn() -> I) -> [Vec3; 7]
where
    I: Iterator<Item = (usize, &'a Contact, bool)>,
{
    let wrench = |contact: &Contact, flip: bool| {
        let wrench = contact_force(m, d, contact);
        let [fx, fy, fz, tx, ty, tz] = if flip { wrench.map(|x| -x) } else { wrench };
        ([fx, fy, fz], [tx, ty, tz])
    };
    let (mut point, mut total) = ([0.0; 3], 0.0);
    for (_, contact, flip) in matching() {
        let weight = norm(wrench(contact, flip).0);
        point = add_scaled(point, contact.pos, weight);
        total += weight;
    }
    point = scale(point, 1.0 / f64::max(total, MINVAL));
    let (mut force, mut torque) = ([0.0; 3], [0.0; 3]);
    for (_, contact, flip) in matching() {
        let (own_force, own_torque) = wrench(contact, flip);
        let own_force = rotate_back(&contact.frame, own_force);
        force = add(force, own_force);
        torque = add(torque, rotate_back(&contact.frame, own_torque));
        torque = add(torque, cross(sub(contact.pos, point), own_force));
    }
    let found = [count as f64, 0.0, 0.0];
    [
        found,
        force,
        torque,
        [0.0; 3],
        point,
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
    ]
}

/// Whether a contact is one of a sensor's; if so, whether its objects are in the other order:
/// MuJoCo's `matchContact`.
fn side(m: &Model, d: &Data, i: usize, contact: &Contact) -> Option<bool> {
    let objects = [
        (m.sensor_objtype[i], m.sensor_objid[i]),
        (m.sensor_reftype[i], m.sensor_refid[i]),
    ];
    let [first, second] = objects;
    let named = objects.map(|(kind, _)| kind != ObjectType::Unknown);
    if named == [false; 2] {
        return Some(false);
    }
    if first.0 == ObjectType::Site && !inside(m, d, first.1 as usize, contact.pos) {
        return None;
    }
    let is = |geom: usize, (kind, id): (ObjectType, i32)| {
        let (id, mut body) = (id as usize, m.geom_bodyid[geom]);
        match kind {
            ObjectType::Unknown | ObjectType::Site => true,
            ObjectType::Geom => id == geom,
            ObjectType::Body => id == body,
            _ => {
                while body > id {
                    body = m.body_parentid[body];
                }
                body == id
            }
        }
    };
    let [g1, g2] = contact.geom;
    let (of_first, of_second) = (
        [is(g1, first), is(g2, first)],
        [is(g1, second), is(g2, second)],
    );
    if of_first == [false; 2] || of_second == [false; 2] {
        return None;
    }
    match named {
        [true, true] => {
            let regular = of_first[0] && of_second[1];
            let reverse = of_first[1] && of_second[0];
            (regular || reverse).then_some(!regular)
        }
        [true, false] => Some(!of_first[0]),
        _ => Some(!of_second[1]),
    }
}
