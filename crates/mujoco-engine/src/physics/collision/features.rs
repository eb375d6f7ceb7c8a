//! Faces and edges of boxes, meshes and cylinders, and the edge of a capsule, near a contact.

use super::Shape;
use super::convex::{Solid, Touch};
use super::mesh::Mesh;
use crate::Revision;
use crate::math::spatial::{
    MINVAL, Mat3, Vec3, add, add_scaled, dot, norm, normalize, rotate, rotate_back, scale, sub,
};
use crate::model::GeomType;

/// The number of sides of the polygon that approximates an end of a cylinder.
const SIDES: usize = 16;

/// The cosines of the polygon's corners, with as many digits as libmujoco has.
#[expect(
    clippy::approx_constant,
    reason = "the last digits of the contacts depend on it"
)]
const COSINES: [f64; SIDES] = [
    1.0,
    0.923879532511287,
    0.707106781186548,
    0.38268343236509,
    0.0,
    -0.38268343236509,
    -0.707106781186547,
    -0.923879532511287,
    -1.0,
    -0.923879532511287,
    -0.707106781186548,
    -0.38268343236509,
    0.0,
    0.38268343236509,
    0.707106781186547,
    0.923879532511287,
];

/// The largest number of corners of a polygon that all sides of another face have clipped, without
/// the corners of meshes.
const CUTS: usize = 64;

/// The cosine above which a direction counts as the normal of a box's face.
const ALONG: f64 = 0.996;

/// Buffers for the features of two shapes near a contact.
#[derive(Clone, Debug, Default)]
pub(super) struct Features {
    pub(super) faces: [Vec<Face>; 2],
    pub(super) edges: Vec<Edge>,
    /// The corners of the reference face, and the incident polygon before and after it is clipped.
    pub(super) polygons: [Vec<Vec3>; 3],
}

impl Features {
    /// Allocates buffers for polygons of so many corners, and so many polygons at a vertex.
    pub(super) fn new(corners: usize, degree: usize) -> Self {
        Self {
            faces: std::array::from_fn(|_| Vec::with_capacity(degree.max(3))),
            edges: Vec::with_capacity(degree.max(3)),
            polygons: std::array::from_fn(|_| Vec::with_capacity(CUTS + 4 * corners)),
        }
    }

    /// Lists the faces of two shapes at a contact. Returns for each shape its corners there, and the
    /// direction from the other's point of the contact to its own.
    pub(super) fn list_faces(
        &mut self,
        solids: [Solid<'_>; 2],
        touch: &Touch,
        revision: Revision,
    ) -> ([Dimension; 2], [Vec3; 2]) {
        let [w1, w2] = touch.points;
        let outward = [sub(w1, w2), sub(w2, w1)];
        let spans = touch.corners.map(Dimension::of);
        for k in [0, 1] {
            let list = &mut self.faces[k];
            faces(solids[k], &spans[k], outward[k], revision, list);
        }
        (spans, outward)
    }
}

/// A face: of a cylinder 0 is the upper end and 1 the lower; of a box, 2k and 2k + 1 are the faces
/// at the upper and lower end of axis k; of a mesh, the number is the polygon's.
#[derive(Clone, Copy, Debug)]
pub(super) struct Face {
    pub(super) number: u32,
    pub(super) normal: Vec3,
}

/// An edge of a box or mesh, the axis of a capsule, or a line along the curved surface of a cylinder.
#[derive(Clone, Copy, Debug)]
pub(super) struct Edge {
    pub(super) direction: Vec3,
    /// `None` for a line of a cylinder that depends on the face.
    ends: Option<[Vec3; 2]>,
}

impl Edge {
    /// Returns the ends of the edge on a face with the normal `normal`. `None` for a cylinder whose
    /// axis is parallel to `normal`.
    pub(super) fn ends(&self, solid: Solid<'_>, normal: Vec3) -> Option<[Vec3; 2]> {
        if self.ends.is_some() {
            return self.ends;
        }
        let (axis, &[radius, half, _]) = (solid.shape.axis(), solid.shape.size);
        let across = add_scaled(normal, axis, -dot(axis, normal));
        let length = norm(across);
        let middle = add_scaled(solid.shape.pos, across, -radius / length);
        (length >= MINVAL).then(|| [-half, half].map(|along| add_scaled(middle, axis, along)))
    }
}

/// The corners of a shape at a contact, and the number of different corners.
pub(super) struct Dimension {
    pub(super) number: usize,
    corners: [u32; 3],
}

impl Dimension {
    pub(super) fn of([a, b, c]: [u32; 3]) -> Self {
        let (number, corners) = match () {
            () if a == b && a == c => (1, [a, b, c]),
            () if a == b => (2, [a, c, c]),
            () if c == a || c == b => (2, [a, b, c]),
            () => (3, [a, b, c]),
        };
        Self { number, corners }
    }
}

/// Lists the faces with all corners of `span`. If no face of a box has all corners, lists the face
/// whose normal is nearest to `outward`; before 4.0 also if an edge of a box has only one face.
fn faces(
    solid: Solid<'_>,
    span: &Dimension,
    outward: Vec3,
    revision: Revision,
    list: &mut Vec<Face>,
) {
    list.clear();
    let mat = solid.shape.mat;
    match (solid.kind, solid.mesh) {
        (GeomType::Cylinder, _) if span.number == 1 => {
            let number = span.corners[0];
            let sign = if number == 0 { 1.0 } else { -1.0 };
            let normal = rotate(mat, [0.0, 0.0, sign]);
            list.push(Face { number, normal });
        }
        (GeomType::Box, _) => box_faces(mat, span, outward, revision, list),
        (_, Some(mesh)) => {
            let face = |number: &u32| Face {
                number: *number,
                normal: rotate(mat, mesh.normal(*number)),
            };
            let [first, others @ ..] = &span.corners[..span.number] else {
                return;
            };
            // an edge has two faces, three vertices have one
            let has = |k: usize, polygon: &u32| {
                let other = others.get(k);
                other.is_none_or(|vertex| mesh.polygons_at(*vertex).contains(polygon))
            };
            let most = |number: usize, count: usize| match span.number {
                least if least >= number => count,
                _ => usize::MAX,
            };
            let first = mesh.polygons_at(*first).iter();
            let common = first.filter(|polygon| has(0, polygon)).take(most(2, 2));
            let common = common.filter(|polygon| has(1, polygon)).take(most(3, 1));
            list.extend(common.map(face));
        }
        _ => {}
    }
}

fn box_faces(
    mat: &Mat3,
    span: &Dimension,
    outward: Vec3,
    revision: Revision,
    list: &mut Vec<Face>,
) {
    let corners = &span.corners[..span.number];
    let face = |number: u32| {
        let mut normal = [0.0; 3];
        normal[number as usize / 2] = if number.is_multiple_of(2) { 1.0 } else { -1.0 };
        Face {
            number,
            normal: rotate(mat, normal),
        }
    };
    list.extend((0..3).filter_map(|axis: u32| {
        let upper = |corner: &u32| corner >> axis & 1 == 1;
        match corners.iter().filter(|corner| upper(corner)).count() {
            0 => Some(face(2 * axis + 1)),
            count => (count == corners.len()).then(|| face(2 * axis)),
        }
    }));
    let known = if span.number == 2 && revision.clips_faces() {
        !list.is_empty()
    } else {
        list.len() == 4 - span.number
    };
    if known {
        return;
    }
    let local = rotate_back(mat, outward);
    let local = scale(local, 1.0 / norm(local));
    let looks = |number: &u32| {
        let along = local[*number as usize / 2];
        (if number.is_multiple_of(2) {
            along
        } else {
            -along
        }) > ALONG
    };
    list.clear();
    list.extend((0..6).find(looks).map(face));
}

/// Lists the edges at the corners of a shape. `deepest` is the shape's deepest point in the other, and
/// `at_first` the point at the first corner, `grown` outside of the shape.
pub(super) fn edges(
    solid: Solid<'_>,
    span: &Dimension,
    (deepest, at_first): (Vec3, Vec3),
    (grown, revision): (f64, Revision),
    list: &mut Vec<Edge>,
) {
    list.clear();
    let shape = solid.shape;
    let [first, second, _] = span.corners;
    let corner = |number: u32| match solid.mesh {
        Some(mesh) => mesh_corner(shape, mesh, number),
        None => box_corner(shape, number),
    };
    let edge = |to: u32| {
        let ends = [first, to].map(corner);
        Edge {
            direction: normalize(sub(ends[1], ends[0])).0,
            ends: Some(ends),
        }
    };
    match (solid.kind, solid.mesh) {
        (GeomType::Capsule, _) => {
            let (axis, half) = (shape.axis(), shape.size[1]);
            let place = dot(sub(deepest, shape.pos), axis);
            list.push(Edge {
                direction: axis,
                ends: Some(
                    [-place - half, half - place].map(|along| add_scaled(deepest, axis, along)),
                ),
            });
        }
        (GeomType::Cylinder, _) => {
            let (axis, &[radius, half, _]) = (shape.axis(), shape.size);
            let end = if first == 0 { half } else { -half };
            let start = if grown > 0.0 {
                let [x, y, _] = rotate_back(shape.mat, sub(at_first, shape.pos));
                let shrink = radius / (x * x + y * y).sqrt();
                add(rotate(shape.mat, [x * shrink, y * shrink, end]), shape.pos)
            } else {
                at_first
            };
            let ends = [start, add_scaled(start, axis, -2.0 * end)];
            list.push(Edge {
                direction: axis,
                ends: (!revision.lays_cylinders_on_faces()).then_some(ends),
            });
        }
        (GeomType::Box | GeomType::Mesh, _) if span.number == 2 => list.push(edge(second)),
        (GeomType::Box, _) => list.extend([1, 2, 4].map(|axis| edge(first ^ axis))),
        (_, Some(mesh)) => {
            // in each polygon, the edge that ends at the vertex
            let before = |polygon: &u32| {
                let corners = mesh.outline(*polygon);
                let place = corners.iter().position(|corner| *corner == first)?;
                Some(corners[(place + corners.len() - 1) % corners.len()])
            };
            list.extend(mesh.polygons_at(first).iter().filter_map(before).map(edge));
        }
        _ => {}
    }
}

/// A vertex of a mesh in the world.
fn mesh_corner(shape: Shape<'_>, mesh: &Mesh<'_>, vertex: u32) -> Vec3 {
    add(rotate(shape.mat, mesh.vertex(vertex as usize)), shape.pos)
}

/// A corner of a box. Bit k of `corner`: whether the corner is at the upper end of axis k.
fn box_corner(shape: Shape<'_>, corner: u32) -> Vec3 {
    let local = std::array::from_fn(|k| match corner >> k & 1 {
        1 => shape.size[k],
        _ => -shape.size[k],
    });
    add(rotate(shape.mat, local), shape.pos)
}

/// Lists the corners of a face.
pub(super) fn outline(solid: Solid<'_>, face: u32, corners: &mut Vec<Vec3>) {
    /// The corners of each face of a box.
    const BOX: [[u32; 4]; 6] = [
        [7, 3, 1, 5],
        [2, 6, 4, 0],
        [2, 3, 7, 6],
        [4, 5, 1, 0],
        [6, 7, 5, 4],
        [3, 2, 0, 1],
    ];
    corners.clear();
    let shape = solid.shape;
    if solid.kind == GeomType::Box {
        corners.extend(BOX[face as usize].map(|corner| box_corner(shape, corner)));
        return;
    }
    if let Some(mesh) = solid.mesh {
        let numbers = mesh.outline(face).iter().rev();
        corners.extend(numbers.map(|vertex| mesh_corner(shape, mesh, *vertex)));
        return;
    }
    let sign = if face == 0 { 1.0 } else { -1.0 };
    corners.extend((0..SIDES).map(|k| {
        let &[radius, half, _] = shape.size;
        let (cos, sin) = (COSINES[k], COSINES[(k + 3 * SIDES / 4) % SIDES]);
        let point = [radius * cos, sign * (radius * -sin), sign * half];
        add(rotate(shape.mat, point), shape.pos)
    }));
}
