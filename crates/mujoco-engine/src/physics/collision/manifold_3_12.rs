//! Contacts of boxes and meshes before 4.0, without a margin: MuJoCo's `multicontact` of that time.
//! As in `manifold`, the incident face or edge is clipped by the sides of a face of the other
//! shape, but which ones are compared and how points are cut differs.

use super::convex::{Solid, Touch, one};
use super::epa::Polytope;
use super::features::{Edge, Face, Features, edges};
use super::gjk::Rules;
use super::manifold::{Incidence, Incident, MOST, PARALLEL, SLOPE, furthest_apart, keep, largest};
use super::{Push, Vec3};
use crate::Revision;
use crate::math::spatial::{add, add_scaled, cross, dot, norm, scale, sub};

/// Adds the contacts of two shapes, at most four.
pub(super) fn contacts(
    a: Solid<'_>,
    b: Solid<'_>,
    rules: Rules,
    polytope: &mut Polytope,
    push: Push<'_>,
) {
    let Some(mut touch) = one(a, b, [0.0; 2], rules, polytope) else {
        return;
    };
    let (features, revision) = (&mut polytope.features, rules.revision);
    let Some(incidence) = find_incidence([a, b], &touch, revision, features) else {
        push(touch.hit(0.0));
        return;
    };
    incidence.clip([a, b], 0.0, revision, features);
    let [side, polygon, _] = &mut features.polygons;
    let edge = matches!(incidence.incident, Incident::Edge(_));
    if polygon.len() > MOST {
        keep(polygon, largest(polygon, polygon.len(), area));
    } else if polygon.len() > 2 && edge {
        keep(polygon, furthest_apart(polygon));
    }
    // if the first shape has the edge, the points are exchanged, even if nothing is left of the
    // edge: the contact of the deepest points then has the opposite normal
    let exchanged = edge && incidence.shape == 1;
    if polygon.is_empty() {
        if exchanged {
            touch.points.reverse();
        }
        push(touch.hit(0.0));
        return;
    }
    let normal = incidence.face.normal;
    let height = |p: &Vec3| dot(sub(*p, side[0]), normal);
    if !polygon.iter().any(|p| height(p) < 0.0) {
        return;
    }
    let inward = match &incidence.incident {
        Incident::Face(face) => face.normal,
        Incident::Edge(_) => scale(normal, -1.0),
    };
    for p in polygon.iter() {
        let dist = height(p);
        let mut points = [add_scaled(*p, inward, -dist.abs()), *p];
        if exchanged {
            points.reverse();
        }
        let touch = Touch {
            dist,
            points,
            corners: [[0; 3]; 2],
            first: [[0.0; 3]; 2],
        };
        push(touch.hit(0.0));
    }
}

/// Finds a face and an incident face or edge: the first pair that is parallel.
fn find_incidence(
    solids: [Solid<'_>; 2],
    touch: &Touch,
    revision: Revision,
    features: &mut Features,
) -> Option<Incidence> {
    if solids
        .iter()
        .any(|solid| solid.mesh.is_some_and(|mesh| !mesh.has_polygons()))
    {
        return None;
    }
    let (spans, _) = features.list_faces(solids, touch, revision);
    let Features {
        faces: found,
        edges: list,
        ..
    } = features;
    for &first in &found[0] {
        let parallel = |second: &&Face| dot(first.normal, second.normal) < -PARALLEL;
        if let Some(second) = found[1].iter().find(parallel) {
            return Some(Incidence {
                shape: 0,
                face: first,
                incident: Incident::Face(*second),
            });
        }
    }
    let (d1, d2) = (spans[0].number, spans[1].number);
    let with_edge = match () {
        () if d1 < 3 && d1 <= d2 => 0,
        () if d2 < 3 => 1,
        () => return None,
    };
    edges(
        solids[with_edge],
        &spans[with_edge],
        (touch.points[with_edge], touch.first[with_edge]),
        (0.0, revision),
        list,
    );
    found[1 - with_edge].iter().find_map(|face| {
        let flat = |edge: &&Edge| dot(edge.direction, face.normal).abs() < SLOPE;
        let edge = list.iter().find(flat)?;
        Some(Incidence {
            shape: 1 - with_edge,
            face: *face,
            incident: Incident::Edge(edge.ends(solids[with_edge], face.normal)?),
        })
    })
}

/// The area of a quadrilateral.
fn area([a, b, c, d]: [Vec3; 4]) -> f64 {
    let first = cross(sub(d, a), sub(b, d));
    let second = cross(sub(c, b), sub(a, c));
    0.5 * norm(add(first, second))
}
