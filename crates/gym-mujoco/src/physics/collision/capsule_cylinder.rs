//! Contacts of a capsule and a cylinder, from 4.0 on.

use super::convex::{Solid, one};
use super::epa::Polytope;
use super::{Hit, on_end};
use crate::Revision;

/// The contact of the two shapes. If the capsule lies on an end of the cylinder: the two contacts
/// that are furthest apart along the capsule's axis.
pub(super) fn contacts(
    capsule: Solid<'_>,
    cylinder: Solid<'_>,
    margin: f64,
    polytope: &mut Polytope,
    push: &mut impl FnMut(Hit),
) {
    let Some(touch) = one(capsule, cylinder, margin, Revision::V4_0, polytope) else {
        return;
    };
    let line = on_end::line(
        capsule.shape,
        cylinder.shape,
        0.5 * margin,
        &touch,
        polytope,
    );
    let first = line.is_none().then_some(touch);
    for touch in first.into_iter().chain(line.into_iter().flatten()) {
        push(touch.hit(margin));
    }
}
