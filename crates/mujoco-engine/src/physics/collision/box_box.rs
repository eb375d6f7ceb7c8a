//! Boxes against boxes: the axis of greatest separation among the normals of the faces and the
//! products of the edges, then the part of one face above the other, or the nearest points of two
//! edges: MuJoCo's `mjc_BoxBox`.

use super::{Hit, Push, Shape};
use crate::math::spatial::{
    MINVAL, Mat3, Vec3, add, add_scaled, dot, normalize, rotate, rotate_back, scale, sub,
};

/// Added to the margin in the separation test, beside a slack that grows with the boxes.
const SEPARATION: f64 = 1e-13;
/// The square of a sine below which edges are parallel.
const PARALLEL: f64 = 1e-16;
/// The magnitude below which a component of an axis counts as zero.
const NO_SIGN: f64 = 1e-9;
/// The square of the relative distance below which two points count as the same.
const SAME: f64 = 1e-14;
/// The amount by which an edge axis must separate more than a face axis.
const EDGE_BIAS: f64 = 1e-6;
/// The most corners of a clipped face.
const CORNERS: usize = 12;

/// The separating axis with the least overlap: a face normal of the first box, a face normal of the
/// second box, or the cross product of two edges.
#[derive(Clone, Copy)]
enum Axis {
    First(usize),
    Second(usize),
    Edges(usize, usize),
}

/// Two boxes, and the frame of each relative to the other.
struct Boxes<'a> {
    a: Shape<'a>,
    b: Shape<'a>,
    /// The axes of the second box in the first's frame, as columns.
    rot: Mat3,
    pos21: Vec3,
    pos12: Vec3,
    margin: f64,
    slack: f64,
}

pub(super) fn box_box(a: Shape<'_>, b: Shape<'_>, margin: f64, push: Push<'_>) {
    let rot: Mat3 = std::array::from_fn(|n| {
        let (i, j) = (n / 3, n % 3);
        a.mat[i] * b.mat[j] + a.mat[3 + i] * b.mat[3 + j] + a.mat[6 + i] * b.mat[6 + j]
    });
    let ([x, y, z], [u, v, w]) = (*a.size, *b.size);
    let boxes = Boxes {
        a,
        b,
        rot,
        pos21: rotate_back(a.mat, sub(b.pos, a.pos)),
        pos12: rotate_back(b.mat, sub(a.pos, b.pos)),
        margin,
        slack: margin + SEPARATION * (x + y + z + u + v + w),
    };
    match boxes.separate() {
        None => {}
        Some(Axis::Edges(i, j)) => boxes.edges(i, j, push),
        Some(Axis::First(axis)) => boxes.faces(axis, true, push),
        Some(Axis::Second(axis)) => boxes.faces(axis, false, push),
    }
}

impl Boxes<'_> {
    /// The axis of greatest separation; `None` if the boxes are apart.
    fn separate(&self) -> Option<Axis> {
        let (s1, s2, rot) = (self.a.size, self.b.size, &self.rot);
        let size = rot.map(f64::abs);
        let (mut best, mut axis) = (-1e10, None);
        let of_first = (0..3).map(|i| {
            let radius = size[3 * i] * s2[0] + size[3 * i + 1] * s2[1] + size[3 * i + 2] * s2[2];
            (self.pos21[i].abs() - s1[i] - radius, Axis::First(i))
        });
        let of_second = (0..3).map(|j| {
            let radius = size[j] * s1[0] + size[3 + j] * s1[1] + size[6 + j] * s1[2];
            (self.pos12[j].abs() - s2[j] - radius, Axis::Second(j))
        });
        for (apart, own) in of_first.chain(of_second) {
            if apart > self.slack {
                return None;
            }
            if apart > best {
                (best, axis) = (apart, Some(own));
            }
        }
        let (face, face_axis) = (best, axis?);
        let mut winner = face_axis;
        for i in 0..3 {
            for j in 0..3 {
                let Some(apart) = self.edge_separation(i, j) else {
                    continue;
                };
                if apart > self.slack {
                    return None;
                }
                if apart - EDGE_BIAS * apart.abs() > best && apart > face {
                    (best, winner) = (apart, Axis::Edges(i, j));
                }
            }
        }
        if let Axis::Edges(i, j) = winner {
            // an edge axis almost parallel to the face axis must separate clearly better
            let axis = self.edge_axis(i, j);
            let along = match face_axis {
                Axis::First(f) => axis[f].abs(),
                Axis::Second(f) | Axis::Edges(_, f) => {
                    (axis[0] * rot[f] + axis[1] * rot[3 + f] + axis[2] * rot[6 + f]).abs()
                }
            };
            if along > 0.99 && best < face + 0.05 * face.abs() + MINVAL {
                winner = face_axis;
            }
        }
        Some(winner)
    }

    /// The separation along the cross product of two edges; `None` if they are parallel.
    fn edge_separation(&self, i: usize, j: usize) -> Option<f64> {
        let (s1, s2, rot) = (self.a.size, self.b.size, &self.rot);
        let (i1, i2) = ((i + 1) % 3, (i + 2) % 3);
        let (mut x, mut y) = (-rot[3 * i2 + j], rot[3 * i1 + j]);
        let square = x * x + y * y;
        if square < PARALLEL {
            return None;
        }
        let inverse = 1.0 / square.sqrt();
        (x, y) = (x * inverse, y * inverse);
        let radius1 = s1[i1] * x.abs() + s1[i2] * y.abs();
        let (j1, j2) = ((j + 1) % 3, (j + 2) % 3);
        let u = x * rot[3 * i1 + j1] + y * rot[3 * i2 + j1];
        let v = x * rot[3 * i1 + j2] + y * rot[3 * i2 + j2];
        let radius2 = s2[j1] * u.abs() + s2[j2] * v.abs();
        Some((x * self.pos21[i1] + y * self.pos21[i2]).abs() - radius1 - radius2)
    }

    /// The cross product of two edges in the first box's frame, scaled to length 1.
    fn edge_axis(&self, i: usize, j: usize) -> Vec3 {
        let (i1, i2) = ((i + 1) % 3, (i + 2) % 3);
        let mut axis = [0.0; 3];
        axis[i1] = -self.rot[3 * i2 + j];
        axis[i2] = self.rot[3 * i1 + j];
        normalize(axis).0
    }

    /// Adds a contact in the middle between the nearest points of two edges.
    fn edges(&self, i: usize, j: usize, push: Push<'_>) {
        let (s1, s2, rot) = (self.a.size, self.b.size, &self.rot);
        let [[i1, i2], [j1, j2]] = [i, j].map(|k| [(k + 1) % 3, (k + 2) % 3]);
        let mut axis = self.edge_axis(i, j);
        if dot(axis, self.pos21) < 0.0 {
            axis = axis.map(|x| -x);
        }
        let axis2 = rotate_back(rot, axis);
        // if the sign of a component is unclear, both signs are tried
        let unclear =
            |v: &Vec3, [k, l]: [usize; 2]| [k, l].into_iter().find(|&k| v[k].abs() < NO_SIGN);
        let (unclear1, unclear2) = (unclear(&axis, [i1, i2]), unclear(&axis2, [j1, j2]));
        let along2 = [rot[j], rot[3 + j], rot[6 + j]];
        let b = along2[i];
        let denominator = 1.0 - b * b;
        let (mut least, mut nearest) = (1e10, [[0.0; 3]; 2]);
        for flip1 in 0..=usize::from(unclear1.is_some()) {
            for flip2 in 0..=usize::from(unclear2.is_some()) {
                let c1 = corner(&axis, s1, [i1, i2], unclear1.filter(|_| flip1 == 1));
                let flipped = unclear2.filter(|_| flip2 == 1);
                let c2 = corner(&axis2, &s2.map(|x| -x), [j1, j2], flipped);
                let c2 = add(rotate(rot, c2), self.pos21);
                let e = sub(c2, c1);
                let (d1e, d2e) = (e[i], dot(along2, e));
                let clip = |x: f64, most: f64| x.max(-most).min(most);
                let s = if denominator < MINVAL {
                    0.0
                } else {
                    (d1e - b * d2e) / denominator
                };
                let s = clip(s, s1[i]);
                let t = clip(b * s - d2e, s2[j]);
                let s = clip(d1e + b * t, s1[i]);
                let mut p1 = c1;
                p1[i] += s;
                let p2 = add_scaled(c2, along2, t);
                let gap = sub(p2, p1);
                let square = dot(gap, gap);
                if square < least {
                    (least, nearest) = (square, [p1, p2]);
                }
            }
        }
        let [w1, w2] = nearest;
        let dist = dot(sub(w2, w1), axis);
        if dist > self.slack {
            return;
        }
        let middle = std::array::from_fn(|k| 0.5 * (w1[k] + w2[k]));
        let pos = add(rotate(self.a.mat, middle), self.a.pos);
        push(Hit::new(dist, pos, rotate(self.a.mat, axis)));
    }

    /// Clips the incident face of one box against the reference face of the other box, and adds a
    /// contact at each corner of the result.
    fn faces(&self, a: usize, first: bool, push: Push<'_>) {
        let (reference, incident, at) = if first {
            (&self.a, &self.b, self.pos21)
        } else {
            (&self.b, &self.a, self.pos12)
        };
        let axes: Mat3 = if first {
            self.rot
        } else {
            std::array::from_fn(|n| self.rot[3 * (n % 3) + n / 3])
        };
        let (size, other) = (reference.size, incident.size);
        let sign = if at[a] >= 0.0 { 1.0 } else { -1.0 };
        let mut face = 0;
        for k in 1..3 {
            if axes[3 * a + k].abs() > axes[3 * a + face].abs() {
                face = k;
            }
        }
        let opposed = if sign * axes[3 * a + face] > 0.0 {
            -1.0
        } else {
            1.0
        };
        let (ax, ay) = ((a + 1) % 3, (a + 2) % 3);
        let (bu, bv) = ((face + 1) % 3, (face + 2) % 3);
        let (mut centre, mut du, mut dv) = ([0.0; 3], [0.0; 3], [0.0; 3]);
        for (r, c) in [ax, ay, a].into_iter().enumerate() {
            centre[r] = at[c] + opposed * other[face] * axes[3 * c + face];
            du[r] = other[bu] * axes[3 * c + bu];
            dv[r] = other[bv] * axes[3 * c + bv];
        }
        centre[2] = sign * centre[2] - size[a];
        du[2] *= sign;
        dv[2] *= sign;
        let mut polygon = Polygon::default();
        for (su, sv) in [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)] {
            polygon.push(std::array::from_fn(|k| centre[k] + su * du[k] + sv * dv[k]));
        }
        for (k, most) in [(0, size[ax]), (1, size[ay])] {
            polygon = polygon.clip(k, 1.0, most).clip(k, -1.0, most);
        }
        let same = SAME * (size[ax] * size[ax] + size[ay] * size[ay]);
        let mut accepted = Polygon::default();
        for corner in polygon.corners() {
            let near = |other: &Vec3| {
                let (dx, dy) = (other[0] - corner[0], other[1] - corner[1]);
                dx * dx + dy * dy < same
            };
            if corner[2] <= self.margin && !accepted.corners().iter().any(near) {
                accepted.push(*corner);
            }
        }
        let outwards = if first { sign } else { -sign };
        let mat = reference.mat;
        let normal = scale([mat[a], mat[3 + a], mat[6 + a]], outwards);
        for corner in accepted.corners() {
            let mut local = [0.0; 3];
            (local[ax], local[ay]) = (corner[0], corner[1]);
            local[a] = sign * (size[a] + 0.5 * corner[2]);
            let pos = add(rotate(mat, local), reference.pos);
            push(Hit::new(corner[2], pos, normal));
        }
    }
}

/// The middle of the edge of a box that is furthest along `axis`, where `flipped` is the coordinate
/// whose sign is the other one.
fn corner(axis: &Vec3, size: &Vec3, across: [usize; 2], flipped: Option<usize>) -> Vec3 {
    let mut corner = [0.0; 3];
    for k in across {
        let upper = (axis[k] >= 0.0) != (flipped == Some(k));
        corner[k] = if upper { size[k] } else { -size[k] };
    }
    corner
}

/// A polygon with at most [`CORNERS`] corners: positions in the plane of a face, and heights above
/// it.
#[derive(Default)]
struct Polygon {
    corners: [Vec3; CORNERS],
    count: usize,
}

impl Polygon {
    fn corners(&self) -> &[Vec3] {
        &self.corners[..self.count]
    }

    fn push(&mut self, corner: Vec3) {
        if self.count < CORNERS {
            self.corners[self.count] = corner;
            self.count += 1;
        }
    }

    /// The part of the polygon where `sign` times coordinate `k` is at most `limit`.
    fn clip(self, k: usize, sign: f64, limit: f64) -> Self {
        let beyond = |corner: &Vec3| sign * corner[k] - limit;
        if self.corners().iter().all(|corner| beyond(corner) <= 0.0) {
            return self;
        }
        let mut out = Self::default();
        for (n, p) in self.corners().iter().enumerate() {
            let q = &self.corners[if n + 1 == self.count { 0 } else { n + 1 }];
            let (dp, dq) = (beyond(p), beyond(q));
            if dp <= 0.0 {
                out.push(*p);
            }
            if (dp < 0.0 && dq > 0.0) || (dp > 0.0 && dq < 0.0) {
                let t = dp / (dp - dq);
                out.push(std::array::from_fn(|k| p[k] + t * (q[k] - p[k])));
            }
        }
        out
    }
}
