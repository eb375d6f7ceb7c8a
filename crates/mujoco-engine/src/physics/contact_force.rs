//! Contact forces from the forces of their rows.

use crate::model::Cone;
use crate::{Contact, Data, Model};

/// Force and torque of a contact in the contact frame (normal, two tangents): MuJoCo's
/// `mj_contactForce`. Zero for a contact without rows.
#[must_use]
pub fn contact_force(m: &Model, d: &Data, contact: &Contact) -> [f64; 6] {
    let Ok(row) = usize::try_from(contact.efc_address) else {
        return [0.0; 6];
    };
    force_of(m, contact, |k| d.efc.force.get(row + k).copied())
}

/// Force and torque of a contact, where `edge(k)` is the force of its row `k`; zero if it has no
/// rows.
pub(super) fn force_of(
    m: &Model,
    contact: &Contact,
    edge: impl Fn(usize) -> Option<f64>,
) -> [f64; 6] {
    let mut force = [0.0; 6];
    let dim = usize::from(contact.dim);
    let elliptic = m.opt.cone == Cone::Elliptic;
    let rows = if dim == 1 || elliptic {
        dim
    } else {
        2 * (dim - 1)
    };
    let mut edges = [0.0; 10];
    for (k, to) in edges[..rows].iter_mut().enumerate() {
        let Some(from) = edge(k) else {
            return force;
        };
        *to = from;
    }
    let edges = &edges[..rows];
    let pull = m.plan().pairs[contact.pair].adhesion;
    if dim == 1 || elliptic {
        force[..dim].copy_from_slice(edges);
        force[0] -= pull;
        return force;
    }
    for edge in edges {
        force[0] += edge;
    }
    force[0] -= pull;
    for k in 0..dim - 1 {
        force[k + 1] = (edges[2 * k] - edges[2 * k + 1]) * contact.friction[k];
    }
    force
}
