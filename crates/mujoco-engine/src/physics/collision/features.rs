//! Faces and edges of boxes and cylinders, and the edge of a capsule, near a contact.

use super::Shape;
use super::convex::Solid;
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

/// The cosine above which a direction counts as the normal of a box's face.
const ALONG: f64 = 0.996;

/// A list of up to three items.
#[derive(Clone, Copy)]
pub(super) struct Few<T> {
    things: [T; 3],
    number: usize,
}

impl<T: Copy + Default> Few<T> {
    fn of(things: impl IntoIterator<Item = T>) -> Self {
        let (mut few, mut number) = ([T::default(); 3], 0);
        for thing in things {
            few[number] = thing;
            number += 1;
        }
        Self {
            things: few,
            number,
        }
    }

    pub(super) fn iter(&self) -> std::slice::Iter<'_, T> {
        self.things[..self.number].iter()
    }

    pub(super) fn is_empty(&self) -> bool {
        self.number == 0
    }
}

/// A face: of a cylinder 0 is the upper end and 1 the lower; of a box, 2k and 2k + 1 are the faces
/// at the upper and lower end of axis k.
#[derive(Clone, Copy, Default)]
pub(super) struct Face {
    pub(super) number: u8,
    pub(super) normal: Vec3,
}

/// An edge of a box, or the axis of a cylinder.
#[derive(Clone, Copy, Default)]
pub(super) struct Edge {
    pub(super) direction: Vec3,
    ends: [Vec3; 2],
}

impl Edge {
    /// Returns the ends of the edge. For a cylinder, the edge is the line on its curved surface
    /// that touches a face with the normal `normal`; `None` if `normal` is parallel to the axis.
    pub(super) fn ends(&self, solid: Solid<'_>, normal: Vec3) -> Option<[Vec3; 2]> {
        if solid.kind != GeomType::Cylinder {
            return Some(self.ends);
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
    corners: [u8; 3],
}

impl Dimension {
    pub(super) fn of([a, b, c]: [u8; 3]) -> Self {
        let (number, corners) = match () {
            () if a == b && a == c => (1, [a, b, c]),
            () if a == b => (2, [a, c, c]),
            () if c == a || c == b => (2, [a, b, c]),
            () => (3, [a, b, c]),
        };
        Self { number, corners }
    }
}

/// Returns the faces with all corners of `span`. If no face of a box has all corners, returns the
/// face whose normal is nearest to `outward`.
pub(super) fn faces(solid: Solid<'_>, span: &Dimension, outward: Vec3) -> Few<Face> {
    match solid.kind {
        GeomType::Cylinder if span.number == 1 => {
            let number = span.corners[0];
            let sign = if number == 0 { 1.0 } else { -1.0 };
            Few::of([Face {
                number,
                normal: rotate(solid.shape.mat, [0.0, 0.0, sign]),
            }])
        }
        GeomType::Box => box_faces(solid.shape.mat, span, outward),
        _ => Few::of([]),
    }
}

fn box_faces(mat: &Mat3, span: &Dimension, outward: Vec3) -> Few<Face> {
    let corners = &span.corners[..span.number];
    let face = |number: u8| {
        let mut normal = [0.0; 3];
        normal[usize::from(number / 2)] = if number.is_multiple_of(2) { 1.0 } else { -1.0 };
        Face {
            number,
            normal: rotate(mat, normal),
        }
    };
    let shared = (0..3).filter_map(|axis: u8| {
        let upper = |corner: &u8| corner >> axis & 1 == 1;
        match corners.iter().filter(|corner| upper(corner)).count() {
            0 => Some(face(2 * axis + 1)),
            count => (count == corners.len()).then(|| face(2 * axis)),
        }
    });
    let shared = Few::of(shared);
    let known = if span.number == 3 {
        shared.number == 1
    } else {
        !shared.is_empty()
    };
    if known {
        return shared;
    }
    let local = rotate_back(mat, outward);
    let local = scale(local, 1.0 / norm(local));
    let looks = |number: &u8| {
        let along = local[usize::from(number / 2)];
        (if number.is_multiple_of(2) {
            along
        } else {
            -along
        }) > ALONG
    };
    Few::of((0..6).find(looks).map(face))
}

/// The edges at the corners of a shape. `deepest` is the shape's deepest point in the other.
pub(super) fn edges(solid: Solid<'_>, span: &Dimension, deepest: Vec3) -> Few<Edge> {
    let shape = solid.shape;
    match solid.kind {
        GeomType::Capsule => {
            let (axis, half) = (shape.axis(), shape.size[1]);
            let place = dot(sub(deepest, shape.pos), axis);
            Few::of([Edge {
                direction: axis,
                ends: [-place - half, half - place].map(|along| add_scaled(deepest, axis, along)),
            }])
        }
        GeomType::Cylinder => Few::of([Edge {
            direction: shape.axis(),
            ends: [[0.0; 3]; 2],
        }]),
        GeomType::Box => {
            let [first, second, _] = span.corners;
            let edge = |to: u8| {
                let ends = [first, to].map(|corner| box_corner(shape, corner));
                Edge {
                    direction: normalize(sub(ends[1], ends[0])).0,
                    ends,
                }
            };
            if span.number == 2 {
                Few::of([edge(second)])
            } else {
                Few::of([1, 2, 4].map(|axis| edge(first ^ axis)))
            }
        }
        _ => Few::of([]),
    }
}

/// A corner of a box. Bit k of `corner`: whether the corner is at the upper end of axis k.
fn box_corner(shape: Shape<'_>, corner: u8) -> Vec3 {
    let local = std::array::from_fn(|k| match corner >> k & 1 {
        1 => shape.size[k],
        _ => -shape.size[k],
    });
    add(rotate(shape.mat, local), shape.pos)
}

/// Lists the corners of a face.
pub(super) fn outline(solid: Solid<'_>, face: u8, corners: &mut Vec<Vec3>) {
    /// The corners of each face of a box.
    const BOX: [[u8; 4]; 6] = [
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
        corners.extend(BOX[usize::from(face)].map(|corner| box_corner(shape, corner)));
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
