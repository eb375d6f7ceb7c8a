//! Rows of contacts.

use super::{push_row, push_rows};
use crate::math::number::Number;
use crate::math::spatial::{Vec3, add, cross, dot, rotate, rotation, sub};
use crate::model::{Cone, Pair};
use crate::physics::constraint::{Constraints, Kind, Source, push_block};
use crate::{Contact, Data, Model};

/// Adds the rows of active contacts: MuJoCo's `mj_instantiateContact`.
#[inline(always)]
pub(super) fn contacts(m: &Model, d: &mut Data) {
    for index in 0..d.contact.len() {
        let contact = &mut d.contact[index];
        let pair = &m.plan().pairs[contact.pair];
        if contact.dist >= contact.includemargin {
            if pair.adhesion == 0.0 {
                continue;
            }
            // what sticks pulls within the gap, without friction
            contact.dim = 1;
        }
        let Some(tree) = pair.trees[0].or(pair.trees[1]) else {
            continue;
        };
        let efc = &mut d.efc;
        contact.efc_address = efc.nefc() as i32;
        let uneven = contact.friction[0] != contact.friction[1];
        if contact.dim > 3 || uneven || m.opt.cone == Cone::Elliptic || m.opt.impratio != 1.0 {
            let place = (index, pair, tree);
            elliptic_or_spinning(m, &d.cdof, &d.subtree_com, efc, contact, place);
            continue;
        }
        let rows = if contact.dim == 1 { 1 } else { 4 };
        let mu = if rows == 1 { 0.0 } else { contact.friction[0] };
        contact.mu = mu;
        let source = Source::Contact(index);
        let row = push_block(efc, source, Kind::OneSided, rows, pair.groups, tree);
        let stride = efc.stride();
        let width = 4 * stride;
        let jac = efc.jacobian_mut()[row * stride..].as_flattened_mut();
        let frames = (
            #[inline(always)]
            |dof: usize| d.cdof[dof],
            #[inline(always)]
            |body: usize| d.subtree_com[body],
        );
        contact_jacobian(
            pair,
            frames,
            (contact.pos, &contact.frame, mu),
            #[inline(always)]
            |dof, values| {
                if rows == 1 {
                    jac[dof] = values[0];
                } else {
                    for (row, value) in values.into_iter().enumerate() {
                        jac[row * width + dof] = value;
                    }
                }
            },
        );
        let (dist, margin) = (contact.dist, contact.includemargin);
        if rows == 1 {
            push_row(efc, (&pair.softness, pair.diag), dist, margin);
            continue;
        }
        let (diag, edge) = pyramid(pair.diag, mu);
        let softness = &pair.softness;
        push_rows(efc, softness, (dist, dist), margin, diag, 4);
        let r = edge(efc.r[row]);
        efc.r[row..].fill(r);
        efc.d[row..].fill(1.0 / r);
    }
}

/// Adds the rows of a contact with torsional or rolling friction, or with an elliptic cone.
#[inline(never)]
fn elliptic_or_spinning(
    m: &Model,
    cdof: &[[f64; 6]],
    com: &[Vec3],
    efc: &mut Constraints,
    contact: &mut Contact,
    (index, pair, tree): (usize, &Pair, usize),
) {
    let dim = usize::from(contact.dim);
    let rows = if dim == 1 { 1 } else { pair.rows };
    let elliptic = m.opt.cone == Cone::Elliptic && dim > 1;
    let kind = if elliptic { Kind::Cone } else { Kind::OneSided };
    let source = Source::Contact(index);
    let row = push_block(efc, source, kind, rows, pair.groups, tree);
    let width = 4 * efc.stride();
    let jac = efc.jacobian_mut()[row * width / 4..].as_flattened_mut();
    for column in &pair.columns {
        let c = &cdof[column.dof];
        let offset = sub(contact.pos, com[column.root]);
        let spin = rotation(c);
        let moves = add([c[3], c[4], c[5]], cross(spin, offset));
        let frame = &contact.frame;
        let along = if dim == 1 {
            [dot([frame[0], frame[1], frame[2]], moves), 0.0, 0.0]
        } else {
            rotate(frame, moves)
        };
        let about = if dim > 3 {
            rotate(frame, spin)
        } else {
            [0.0; 3]
        };
        let all: [f64; 6] =
            std::array::from_fn(|k| column.sign * if k < 3 { along[k] } else { about[k - 3] });
        let places = jac[column.dof..].iter_mut().step_by(width);
        if elliptic || dim == 1 {
            for (x, value) in places.zip(&all[..dim]) {
                *x = *value;
            }
        } else {
            for (k, x) in places.enumerate() {
                let slide = all[k / 2 + 1] * contact.friction[k / 2];
                *x = all[0] + if k % 2 == 0 { slide } else { -slide };
            }
        }
    }
    let (dist, margin) = (contact.dist, contact.includemargin);
    if dim == 1 {
        push_rows(efc, &pair.softness, (dist, dist), margin, pair.diag, 1);
        return;
    }
    let friction = &contact.friction;
    let tran = pair.diag;
    let first = if elliptic {
        tran
    } else {
        tran + friction[0] * friction[0] * tran
    };
    push_rows(efc, &pair.softness, (dist, dist), margin, first, pair.rows);
    let normal = efc.r[row];
    let slide = normal / f64::max(1e-15, m.opt.impratio);
    contact.mu = friction[0] * (slide / normal).sqrt();
    if elliptic {
        for k in 1..pair.rows {
            let r = if k == 1 {
                slide
            } else {
                slide * friction[0] * friction[0] / (friction[k - 1] * friction[k - 1])
            };
            (efc.r[row + k], efc.d[row + k]) = (r, 1.0 / r);
            (efc.pos[row + k], efc.margin[row + k]) = (0.0, 0.0);
            efc.kbip[row + k][0] = 0.0;
            efc.kbip[row + k][1] = pair.friction_damping;
        }
    } else {
        let r = 2.0 * contact.mu * contact.mu * normal;
        efc.r[row..].fill(r);
        efc.d[row..].fill(1.0 / r);
    }
}

/// The Jacobian of a contact: the velocity of the second body relative to the first, along the four
/// edges of the pyramid. A pair of one dimension has the normal four times. `axis` and `com` give
/// motion axes and centres of mass; `set` receives each degree of freedom with its four values.
#[inline(always)]
pub(in crate::physics) fn contact_jacobian<N: Number>(
    pair: &Pair,
    (axis, com): (impl Fn(usize) -> [N; 6], impl Fn(usize) -> [N; 3]),
    (pos, frame, mu): ([N; 3], &[N; 9], f64),
    mut set: impl FnMut(usize, [N; 4]),
) {
    for column in &pair.columns {
        let c = axis(column.dof);
        let offset = sub(pos, com(column.root));
        let moves = add([c[3], c[4], c[5]], cross([c[0], c[1], c[2]], offset));
        // libmujoco's sums start with 0, so no sum is -0
        if pair.dim == 1 {
            let along = dot([frame[0], frame[1], frame[2]], moves);
            set(column.dof, [along * column.sign + 0.0; 4]);
        } else {
            let [n, t1, t2] = rotate(frame, moves).map(
                #[inline(always)]
                |along| along * column.sign + 0.0,
            );
            let (t1, t2) = (t1 * mu, t2 * mu);
            set(column.dof, [n + t1, n - t1, n + t2, n - t2]);
        }
    }
}

/// Returns the diagonal of the rows of a friction pyramid with the coefficient `mu`, and the
/// function from the regularisation of the normal row to the regularisation of the pyramid's rows.
/// With these, the pyramid is as soft as an elliptic cone.
#[inline(always)]
pub(in crate::physics) fn pyramid(diag: f64, mu: f64) -> (f64, impl Fn(f64) -> f64) {
    (diag + mu * mu * diag, move |r: f64| 2.0 * mu * mu * r)
}
