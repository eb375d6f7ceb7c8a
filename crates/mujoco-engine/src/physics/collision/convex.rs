//! Contacts of two convex shapes: MuJoCo's `mjc_Convex`. First, the cores of the shapes are
//! compared: the centre of a sphere, the axis of a capsule, and from 4.0 on every shape without its
//! margin. The distance of the cores gives the contact. If the cores overlap, the whole shapes are
//! compared.

use super::epa::Polytope;
use super::gjk::{self, Rules, Vertex};
use super::mesh::Mesh;
use super::{Hit, Push, Shape, frame, hfield};
use crate::Revision;
use crate::math::spatial::{
    InTurn, MINVAL, Mat3, Order, Vec3, add, add_scaled, axis_angle, column, dot, norm, normalize,
    rotate, rotate_back, scale, sub,
};
use crate::model::GeomType;

/// The angle by which shapes are turned to find further contacts, in radians.
const TURN: f64 = 1e-3;

/// Most contacts of two shapes.
const MOST: usize = 5;

/// A shape and its kind.
#[derive(Clone, Copy)]
pub(super) struct Solid<'a> {
    pub(super) kind: GeomType,
    pub(super) shape: Shape<'a>,
    /// The mesh, if the shape is one.
    pub(super) mesh: Option<&'a Mesh<'a>>,
    /// The corners of a prism of a height field, which has no other frame.
    pub(super) prism: Option<&'a [Vec3; 6]>,
}

impl<'a> Solid<'a> {
    /// The solid in another place.
    pub(super) fn at(self, pos: Vec3, mat: &'a Mat3) -> Self {
        let shape = Shape {
            pos,
            mat,
            ..self.shape
        };
        Self { shape, ..self }
    }

    /// The radius of a sphere or capsule around its centre or axis; `None` for other shapes.
    fn radius(&self) -> Option<f64> {
        matches!(self.kind, GeomType::Sphere | GeomType::Capsule).then_some(self.shape.size[0])
    }

    /// Whether the shape has finitely many support points.
    pub(super) fn is_discrete(&self) -> bool {
        matches!(self.kind, GeomType::Box | GeomType::Mesh | GeomType::Hfield)
    }

    /// Whether the shape has flat or straight parts, where more than one contact is possible.
    fn is_flat(&self) -> bool {
        !matches!(self.kind, GeomType::Sphere | GeomType::Ellipsoid)
    }

    /// The point furthest in a direction, and the number of the corner of a box, of the vertex of a
    /// mesh, or of the end of a cylinder: 1 for the lower one.
    pub(super) fn support(&self, direction: Vec3) -> (Vec3, u32) {
        let shape = self.shape;
        if let Some(prism) = self.prism {
            return (hfield::support(prism, direction), 0);
        }
        if let Some(mesh) = self.mesh {
            let vertex = mesh.support(rotate_back(shape.mat, direction));
            let point = add(rotate(shape.mat, mesh.vertex(vertex)), shape.pos);
            return (point, vertex as u32);
        }
        match self.kind {
            GeomType::Sphere => {
                let reach = scale(direction, shape.size[0]);
                (add(reach, shape.pos), 0)
            }
            GeomType::Capsule => (capsule_support(shape, direction), 0),
            GeomType::Ellipsoid => (ellipsoid_support(shape, direction), 0),
            GeomType::Cylinder => cylinder_support(shape, direction),
            _ => {
                let local = rotate_back(shape.mat, direction);
                let corner: Vec3 = std::array::from_fn(|k| {
                    if local[k] >= 0.0 {
                        shape.size[k]
                    } else {
                        -shape.size[k]
                    }
                });
                let number = (0..3).fold(0, |number, k| number | u32::from(corner[k] > 0.0) << k);
                (add(rotate(shape.mat, corner), shape.pos), number)
            }
        }
    }

    fn centre(&self) -> Vec3 {
        self.prism.map_or(self.shape.pos, hfield::centre)
    }

    /// [`support`](Self::support) of the centre or axis, for shapes with a radius around it.
    fn core(&self, direction: Vec3) -> (Vec3, u32) {
        match self.kind {
            GeomType::Sphere => (self.shape.pos, 0),
            GeomType::Capsule => (line_support(self.shape, direction), 0),
            _ => self.support(direction),
        }
    }
}

/// Finds the contacts of two shapes before [`Revision::clips_faces`]: a first contact, and up to
/// four more. For each further contact, the function rotates both shapes by a small angle
/// about the first contact. A contact counts if its distance to all others is at least `apart`.
pub(super) fn contacts(
    a: Solid<'_>,
    b: Solid<'_>,
    (margin, apart): (f64, f64),
    rules: Rules,
    polytope: &mut Polytope,
    push: Push<'_>,
) {
    let mut one = |a: Solid<'_>, b: Solid<'_>| {
        let grown = [0.5 * margin; 2];
        one(a, b, grown, rules, polytope).map(|touch| touch.hit(margin))
    };
    let Some(first) = one(a, b) else {
        return;
    };
    push(first);
    if !a.is_flat() || !b.is_flat() {
        return;
    }
    let mut kept = [first.pos; MOST];
    let mut number = 1;
    let frame = frame((), first.normal, [0.0; 3]);
    for tangent in [3, 6].map(|k| [frame[k], frame[k + 1], frame[k + 2]]) {
        for angle in [-TURN, TURN] {
            let turn = InTurn::quat_to_mat(axis_angle((), tangent, angle));
            let back = std::array::from_fn(|k| turn[3 * (k % 3) + k / 3]);
            let (a_pos, a_mat) = turned(a.shape, first.pos, &turn);
            let (b_pos, b_mat) = turned(b.shape, first.pos, &back);
            let turned = one(a.at(a_pos, &a_mat), b.at(b_pos, &b_mat));
            let far = |hit: &Hit| {
                let mut kept = kept[..number].iter();
                kept.all(|&pos| norm(sub(pos, hit.pos)) > apart)
            };
            if let Some(hit) = turned.filter(far) {
                push(Hit::new(first.dist, hit.pos, hit.normal));
                kept[number] = hit.pos;
                number += 1;
            }
        }
    }
}

/// Position and orientation of a shape turned about a point.
fn turned(shape: Shape<'_>, about: Vec3, turn: &Mat3) -> (Vec3, Mat3) {
    let columns = [0, 1, 2].map(|k| rotate(turn, column(shape.mat, k)));
    let offset = sub(about, shape.pos);
    let moved = sub(rotate(turn, offset), offset);
    let mat = std::array::from_fn(|k| columns[k % 3][k / 3]);
    (sub(shape.pos, moved), mat)
}

/// Returns the deepest points of two shapes; `None` without a contact. Each shape is grown by a part
/// of the margin.
pub(super) fn one(
    a: Solid<'_>,
    b: Solid<'_>,
    grown: [f64; 2],
    rules: Rules,
    polytope: &mut Polytope,
) -> Option<Touch> {
    within(a, b, (grown, 0.0), rules, polytope)
}

/// Returns the deepest points of two shapes that overlap where each is grown by a part of the margin,
/// or the nearest points of shapes no further apart than `most`.
pub(super) fn within(
    a: Solid<'_>,
    b: Solid<'_>,
    (grown, most): ([f64; 2], f64),
    rules: Rules,
    polytope: &mut Polytope,
) -> Option<Touch> {
    let revision = rules.revision;
    let near = |dist: f64| dist < 0.0 || (most > 0.0 && dist <= most);
    let grow = |(point, corner): (Vec3, u32), grown: f64, direction: Vec3| {
        if grown > 0.0 {
            (add_scaled(point, direction, grown), corner)
        } else {
            (point, corner)
        }
    };
    let centers = [a.centre(), b.centre()];
    let without_margin = revision.shrinks_to_cores() && grown != [0.0; 2];
    if a.radius().is_some() || b.radius().is_some() || without_margin {
        // the distance from each support point to the shape's surface; before 4.0, the support
        // point of a shape without a radius includes the margin
        let reach =
            |solid: Solid<'_>, grown: f64| match (solid.radius(), revision.shrinks_to_cores()) {
                (Some(radius), false) => radius + grown,
                (Some(radius), true) => grown + radius,
                (None, false) => 0.0,
                (None, true) => grown,
            };
        let reaches = [reach(a, grown[0]), reach(b, grown[1])];
        let core = |solid: Solid<'_>, grown: f64, direction: Vec3| {
            let point = solid.core(direction);
            if solid.radius().is_none() && !revision.shrinks_to_cores() {
                grow(point, grown, direction)
            } else {
                point
            }
        };
        let cores = |direction: Vec3| {
            let first = core(a, grown[0], direction);
            Vertex::new(first, core(b, grown[1], scale(direction, -1.0)))
        };
        let finite = |solid: Solid<'_>| solid.is_discrete() || solid.radius().is_some();
        let discrete = revision.shrinks_to_cores() && finite(a) && finite(b);
        let reach = reaches[0] + reaches[1];
        let found = gjk::distance(centers, reach + most, (rules, discrete), &cores);
        if found.distance > rules.tolerance {
            let [w1, w2] = found.nearest;
            let dist = found.distance - reach;
            let normal = normalize(sub(w2, w1)).0;
            let moved = |point: Vec3, by: f64| {
                if by == 0.0 {
                    point
                } else {
                    add_scaled(point, normal, by)
                }
            };
            return near(dist).then(|| Touch {
                dist,
                points: [moved(w1, reaches[0]), moved(w2, -reaches[1])],
                corners: corners(&found.simplex[..found.number]),
                first: [found.simplex[0].w1, found.simplex[0].w2],
            });
        }
    }

    let whole = |direction: Vec3| {
        let back = scale(direction, -1.0);
        let first = grow(a.support(direction), grown[0], direction);
        Vertex::new(first, grow(b.support(back), grown[1], back))
    };
    let discrete = grown == [0.0; 2] && a.is_discrete() && b.is_discrete();
    let found = gjk::distance(centers, most, (rules, discrete), &whole);
    if found.distance > rules.tolerance || found.separated {
        return near(found.distance).then(|| Touch {
            dist: found.distance,
            points: found.nearest,
            corners: corners(&found.simplex[..found.number]),
            first: [found.simplex[0].w1, found.simplex[0].w2],
        });
    }
    let overlap = polytope.overlap(&found, (rules, discrete), &whole)?;
    (overlap.depth > 0.0).then(|| Touch {
        dist: -overlap.depth,
        points: overlap.nearest,
        corners: corners(&overlap.corners),
        first: [overlap.corners[0].w1, overlap.corners[0].w2],
    })
}

/// Returns for each shape the corners at the first three vertices. The first vertex stands in for
/// missing vertices.
fn corners(simplex: &[Vertex]) -> [[u32; 3]; 2] {
    let last = simplex.len() - 1;
    [0, 1].map(|k| [0, 1, 2].map(|i: usize| simplex[if i <= last { i } else { 0 }].corners[k]))
}

/// The deepest points of two shapes.
#[derive(Clone, Copy)]
pub(super) struct Touch {
    /// The distance of the shapes, without the margin.
    pub(super) dist: f64,
    pub(super) points: [Vec3; 2],
    /// For each shape, the corners at the contact.
    pub(super) corners: [[u32; 3]; 2],
    /// For each shape, the point at the first corner, perhaps with the margin.
    pub(super) first: [Vec3; 2],
}

impl Touch {
    pub(super) fn hit(&self, margin: f64) -> Hit {
        let [w1, w2] = self.points;
        let (middle, normal) = (scale(add(w1, w2), 0.5), normalize(sub(w1, w2)).0);
        Hit::new(margin + self.dist, middle, normal)
    }
}

/// The point of a capsule's axis furthest in a direction.
fn line_support(capsule: Shape<'_>, direction: Vec3) -> Vec3 {
    let (axis, half) = (capsule.axis(), capsule.size[1]);
    let ahead = dot(axis, direction) >= 0.0;
    add_scaled(capsule.pos, axis, if ahead { half } else { -half })
}

/// The point of a capsule furthest in a direction.
fn capsule_support(capsule: Shape<'_>, direction: Vec3) -> Vec3 {
    let &[radius, half, _] = capsule.size;
    let local = rotate_back(capsule.mat, direction);
    let mut point = scale(local, radius);
    point[2] += if local[2] >= 0.0 { half } else { -half };
    add(rotate(capsule.mat, point), capsule.pos)
}

/// The point of a cylinder furthest in a direction, and 1 if it is on the lower end.
fn cylinder_support(cylinder: Shape<'_>, direction: Vec3) -> (Vec3, u32) {
    let &[radius, half, _] = cylinder.size;
    let local = rotate_back(cylinder.mat, direction);
    let square = local[0] * local[0] + local[1] * local[1];
    let s = if square >= MINVAL * MINVAL {
        radius / square.sqrt()
    } else {
        0.0
    };
    let point = [
        s * local[0],
        s * local[1],
        if local[2] >= 0.0 { half } else { -half },
    ];
    let place = add(rotate(cylinder.mat, point), cylinder.pos);
    (place, u32::from(point[2] < 0.0))
}

/// The point of an ellipsoid furthest in a direction.
fn ellipsoid_support(ellipsoid: Shape<'_>, direction: Vec3) -> Vec3 {
    let &Shape { pos, mat, size } = &ellipsoid;
    let local = rotate_back(mat, direction);
    let point: Vec3 = std::array::from_fn(|k| local[k] * size[k]);
    let square = dot(point, point);
    if square < MINVAL * MINVAL {
        return add_scaled(pos, column(mat, 0), size[0]);
    }
    let inverse = 1.0 / square.sqrt();
    let point = std::array::from_fn(|k| point[k] * (inverse * size[k]));
    add(rotate(mat, point), pos)
}

/// The lowest point of an ellipsoid above a plane: MuJoCo's `mjc_PlaneConvex`.
pub(super) fn plane_ellipsoid(
    plane: Shape<'_>,
    ellipsoid: Shape<'_>,
    margin: f64,
    revision: Revision,
    push: Push<'_>,
) {
    let normal = plane.axis();
    let down = scale(normal, -1.0);
    let lowest = if revision.supports_ellipsoids() {
        ellipsoid_support(ellipsoid, down)
    } else {
        let &Shape { pos, mat, size } = &ellipsoid;
        let local = rotate_back(mat, down);
        let on_sphere = normalize(std::array::from_fn(|k| local[k] * size[k])).0;
        let point = std::array::from_fn(|k| on_sphere[k] * size[k]);
        add(rotate(mat, point), pos)
    };
    let dist = dot(normal, sub(lowest, plane.pos));
    if dist <= margin {
        let pos = add_scaled(lowest, normal, -0.5 * dist);
        push(Hit::new(dist, pos, normal));
    }
}
