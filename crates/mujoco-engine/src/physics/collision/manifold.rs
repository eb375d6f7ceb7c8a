//! Contacts of two convex shapes from 3.17 on: MuJoCo's `mjc_multicontact`. If a face or an edge
//! lies on a face of the other shape, the function clips the incident face or edge by the sides of
//! the other face. Up to four points of the result are the contacts.

use super::Push;
use super::convex::{Solid, Touch, one};
use super::epa::Polytope;
use super::features::{Edge, Face, Features, edges, outline};
use super::gjk::Rules;
use crate::Revision;
use crate::math::spatial::{
    MINVAL, Vec3, add, add_scaled, cross, dot, norm, normalize, scale, sub,
};
use crate::model::GeomType;

/// The greatest sine of the angle between two directions that count as parallel.
pub(super) const SLOPE: f64 = 0.0888;

/// The cosine above which two faces count as parallel.
pub(super) const PARALLEL: f64 = 0.996;

/// Most contacts of two shapes.
pub(super) const MOST: usize = 4;

/// A reference face, and the incident face or edge of the other shape.
pub(super) struct Incidence {
    /// Which of the two shapes has the face.
    pub(super) shape: usize,
    pub(super) face: Face,
    pub(super) incident: Incident,
}

/// The feature of the other shape that is clipped against the reference face.
pub(super) enum Incident {
    Face(Face),
    Edge([Vec3; 2]),
}

/// Adds the contacts of two shapes, at most four.
pub(super) fn contacts(
    a: Solid<'_>,
    b: Solid<'_>,
    margin: f64,
    rules: Rules,
    polytope: &mut Polytope,
    push: Push<'_>,
) {
    let Some(touch) = one(a, b, [0.5 * margin; 2], rules, polytope) else {
        return;
    };
    let (features, revision) = (&mut polytope.features, rules.revision);
    let Some(incidence) = find_incidence([a, b], &touch, (0.5 * margin, revision), features) else {
        push(touch.hit(margin));
        return;
    };
    let grown = [a, b].map(|solid| match solid.kind {
        GeomType::Capsule => 0.0, // the collision of capsules adds the radius
        _ => 0.5 * margin,
    });
    incidence.clip([a, b], grown[0] + grown[1], revision, features);
    let [side, polygon, _] = &mut features.polygons;
    if polygon.len() > MOST {
        keep(polygon, largest(polygon, polygon.len(), area));
    } else if polygon.len() > 2 && matches!(incidence.incident, Incident::Edge(_)) {
        keep(polygon, furthest_apart(polygon));
    }
    let touch_at = |p: &Vec3| incidence.touch(*p, side[0], grown);
    if polygon.is_empty() {
        push(touch.hit(margin));
    } else if polygon.iter().any(|p| touch_at(p).dist < 0.0) {
        for p in polygon.iter() {
            push(touch_at(p).hit(margin));
        }
    }
}

impl Incidence {
    /// Lists the corners of the face, and clips the incident feature by its sides. Drops points
    /// that are above the face by more than `most`.
    pub(super) fn clip(
        &self,
        solids: [Solid<'_>; 2],
        most: f64,
        revision: Revision,
        features: &mut Features,
    ) {
        let [side, polygon, cut] = &mut features.polygons;
        polygon.clear();
        outline(solids[self.shape], self.face.number, side);
        match &self.incident {
            Incident::Face(face) => outline(solids[1 - self.shape], face.number, polygon),
            Incident::Edge(ends) => polygon.extend(ends),
        }
        cut_by_sides(polygon, side, self.face.normal, revision, cut);
        polygon.retain(|p| dot(sub(*p, side[0]), self.face.normal) <= most);
    }

    /// Returns the contact at the point `p` of the incident feature. `corner` is a corner of the
    /// reference face; `grown` is half the margin for each shape, and 0 for a capsule.
    fn touch(&self, p: Vec3, corner: Vec3, grown: [f64; 2]) -> Touch {
        let normal = self.face.normal;
        let outward = match &self.incident {
            Incident::Face(face) => face.normal,
            Incident::Edge(_) => scale(normal, -1.0),
        };
        let on_face = add_scaled(p, normal, -dot(sub(p, corner), normal));
        let mut dist = dot(sub(on_face, p), outward);
        let mut points = [add_scaled(on_face, outward, -dist); 2];
        points[self.shape] = on_face;
        let between = match (&self.incident, self.shape) {
            (Incident::Edge(_), 0) => normal,
            _ => scale(if self.shape == 0 { outward } else { normal }, -1.0),
        };
        for (point, by) in points.iter_mut().zip([grown[0], -grown[1]]) {
            if by != 0.0 {
                *point = add_scaled(*point, between, by);
            }
        }
        dist -= grown[0] + grown[1];
        Touch {
            dist,
            points,
            corners: [[0; 3]; 2],
            first: [[0.0; 3]; 2],
        }
    }
}

/// Finds a reference face and an incident face or edge; `None` if none are parallel.
fn find_incidence(
    solids: [Solid<'_>; 2],
    touch: &Touch,
    (grown, revision): (f64, Revision),
    features: &mut Features,
) -> Option<Incidence> {
    let (spans, outward) = features.list_faces(solids, touch, revision);
    let Features {
        faces: found,
        edges: list,
        ..
    } = features;
    if let Some([first, second]) = parallel(found, outward) {
        return Some(Incidence {
            shape: 0,
            face: first,
            incident: Incident::Face(second),
        });
    }
    let (d1, d2) = (spans[0].number, spans[1].number);
    let second_first = (d2 < d1 || found[1].is_empty()) && d2 != 3 && !found[0].is_empty();
    let order = if second_first { [1, 0] } else { [0, 1] };
    for with_edge in order {
        let with_face = 1 - with_edge;
        if spans[with_edge].number == 3 || found[with_face].is_empty() {
            continue;
        }
        let point = (touch.points[with_edge], touch.first[with_edge]);
        let rules = (grown, revision);
        edges(solids[with_edge], &spans[with_edge], point, rules, list);
        for face in &found[with_face] {
            if dot(face.normal, outward[with_face]) <= MINVAL {
                continue;
            }
            let flat = |edge: &&Edge| dot(edge.direction, face.normal).abs() < SLOPE;
            if let Some(edge) = list.iter().find(flat) {
                return edge
                    .ends(solids[with_edge], face.normal)
                    .map(|ends| Incidence {
                        shape: with_face,
                        face: *face,
                        incident: Incident::Edge(ends),
                    });
            }
        }
        if !revision.tries_both_edges() {
            return None;
        }
    }
    None
}

/// Returns the most parallel pair among the faces whose normals point along the contact normal.
fn parallel(found: &[Vec<Face>; 2], outward: [Vec3; 2]) -> Option<[Face; 2]> {
    let least = norm(outward[1]) * SLOPE;
    let facing = |k: usize| {
        let faces = found[k].iter();
        faces.filter(move |face| dot(face.normal, outward[k]) > least)
    };
    let (mut best, mut pair) = (-PARALLEL, None);
    for a in facing(0) {
        for b in facing(1) {
            let cosine = dot(a.normal, b.normal);
            if cosine < best {
                (best, pair) = (cosine, Some([*a, *b]));
            }
        }
    }
    pair
}

/// Clips a polygon by the planes through the sides `side` of a face that are parallel to the face's
/// normal.
fn cut_by_sides(
    polygon: &mut Vec<Vec3>,
    side: &[Vec3],
    normal: Vec3,
    revision: Revision,
    cut: &mut Vec<Vec3>,
) {
    for (k, &corner) in side.iter().enumerate() {
        let along = sub(side[(k + 1) % side.len()], corner);
        let outward = normalize(cross(along, sub(add(corner, normal), corner))).0;
        cut_by_side(polygon, corner, outward, revision, cut);
        std::mem::swap(polygon, cut);
    }
}

/// Clips the polygon `line` by a plane. `kept` is the part on the side to which the plane's normal
/// points.
fn cut_by_side(
    line: &[Vec3],
    corner: Vec3,
    normal: Vec3,
    revision: Revision,
    kept: &mut Vec<Vec3>,
) {
    kept.clear();
    for (i, &p) in line.iter().enumerate() {
        let q = line[(i + 1) % line.len()];
        let height = |point| dot(sub(point, corner), normal);
        let (from, to) = (height(p), height(q));
        let (starts, stays) = (from > -MINVAL, to > -MINVAL);
        if starts != stays {
            let share = if revision.cuts_by_heights() {
                from / (from - to)
            } else {
                (dot(normal, corner) - dot(normal, p)) / dot(normal, sub(q, p))
            };
            if (0.0..=1.0).contains(&share) {
                kept.push(add_scaled(p, sub(q, p), share));
            }
        }
        if stays {
            kept.push(q);
        }
    }
}

pub(super) fn keep<const N: usize>(points: &mut Vec<Vec3>, kept: [usize; N]) {
    let kept = kept.map(|i| points[i]);
    points.clear();
    points.extend(kept);
}

/// The two points that are furthest apart.
pub(super) fn furthest_apart(points: &[Vec3]) -> [usize; 2] {
    let (mut best, mut most) = ([0, 1], 0.0);
    for (i, &p) in points.iter().enumerate() {
        for (j, &q) in points.iter().enumerate().skip(i + 1) {
            let between = sub(q, p);
            let square = dot(between, between);
            if square > most {
                (best, most) = ([i, j], square);
            }
        }
    }
    best
}

/// Four corners of a convex polygon with the largest area, by rotating calipers. The first is one
/// of the first `starts` corners of the polygon.
pub(super) fn largest(
    polygon: &[Vec3],
    starts: usize,
    area: impl Fn([Vec3; 4]) -> f64,
) -> [usize; 4] {
    let next = |i: usize| (i + 1) % polygon.len();
    let area = |a: usize, b: usize, c: usize, d: usize| area([a, b, c, d].map(|i| polygon[i]));
    let (mut b, mut c, mut d) = (1, 2, 3);
    let (mut best, mut most) = ([0, 1, 2, 3], area(0, 1, 2, 3));
    for a in 0..starts {
        while area(a, b, c, next(d)) > most {
            d = next(d);
            most = area(a, b, c, d);
            while area(a, b, next(c), d) > most {
                c = next(c);
                most = area(a, b, c, d);
            }
            while area(a, next(b), c, d) > most {
                b = next(b);
                most = area(a, b, c, d);
            }
            best = [a, b, c, d];
        }
        if b == a {
            b = next(b);
            if c == b {
                c = next(c);
                if d == c {
                    d = next(d);
                }
            }
        }
    }
    best
}

/// The area of a quadrilateral, by its diagonals.
pub(super) fn area([a, b, c, d]: [Vec3; 4]) -> f64 {
    0.5 * norm(cross(sub(a, c), sub(b, d)))
}
