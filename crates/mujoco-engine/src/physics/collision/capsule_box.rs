//! Capsules against boxes: a sphere at the point of the segment nearest to the box, and a second
//! one if the capsule lies along a face or an edge: MuJoCo's `mjc_CapsuleBox`.

use super::boxes::sphere_box;
use super::{Push, Shape};
use crate::math::spatial::{MINVAL, Vec3, add, add_scaled, dot, rotate, rotate_back, scale, sub};

/// The part of the box that is nearest to the segment.
#[derive(Clone, Copy)]
enum Nearest {
    /// A face, by its axis (`None` if the point is inside the box), and the end of the segment.
    Face { axis: Option<usize>, end: f64 },
    /// An edge: its axis, its lower corner, the position on it (-1 to 1), and the nearest part of
    /// it: 0 the lower corner, 1 the middle, 2 the upper corner.
    Edge {
        axis: usize,
        corner: usize,
        place: f64,
        part: usize,
    },
}

/// The capsule in the frame of the box.
struct Segment {
    pos: Vec3,
    axis: Vec3,
    half: Vec3,
    size: Vec3,
    /// The signs of the direction, as bits.
    signs: usize,
}

pub(super) fn capsule_box(capsule: Shape<'_>, cuboid: Shape<'_>, margin: f64, push: Push<'_>) {
    let &[radius, length, _] = capsule.size;
    let axis = rotate_back(cuboid.mat, capsule.axis());
    let half = scale(axis, length);
    let signs = (0..3).filter(|&k| half[k] > 0.0).map(|k| 1 << k).sum();
    let segment = Segment {
        pos: rotate_back(cuboid.mat, sub(capsule.pos, cuboid.pos)),
        axis,
        half,
        size: *cuboid.size,
        signs,
    };
    let size = &segment.size;
    let most = margin + 2.0 * (radius + length + size[0] + size[1] + size[2]);
    if segment.is_apart(radius + margin + APART * most) {
        return;
    }
    let Some((nearest, at)) = segment.nearest(most, length) else {
        return;
    };
    let mut point = |at: f64| {
        let local = add_scaled(segment.pos, segment.half, at);
        let centre = add(rotate(cuboid.mat, local), cuboid.pos);
        sphere_box((centre, radius), cuboid, margin, push);
    };
    point(at);
    if let Some(further) = segment.second(nearest, at) {
        point(further + at);
    }
}

/// More than rounding can move a point, in sizes of the geoms.
const APART: f64 = 1e-6;

impl Segment {
    /// Whether a face of the box keeps all points of the segment further away than `distance`: then
    /// no sphere of that radius touches the box, which is cheaper to know than the nearest part.
    fn is_apart(&self, distance: f64) -> bool {
        (0..3).any(|k| self.pos[k].abs() - self.half[k].abs() - self.size[k] > distance)
    }

    /// The part of the box nearest to the segment, and the nearest position on the segment (-1 to
    /// 1).
    fn nearest(&self, most: f64, length: f64) -> Option<(Nearest, f64)> {
        let mut best = most;
        let mut found = None;
        for end in [-1.0, 1.0] {
            let tip = add_scaled(self.pos, self.half, end);
            let (mut clamped, mut outside, mut axis) = (tip, 0, None);
            for k in 0..3 {
                if tip[k] < -self.size[k] {
                    (clamped[k], axis) = (-self.size[k], Some(k));
                    outside += 1;
                } else if tip[k] > self.size[k] {
                    (clamped[k], axis) = (self.size[k], Some(k));
                    outside += 1;
                }
            }
            if outside > 1 {
                continue;
            }
            let apart = sub(clamped, tip);
            let square = dot(apart, apart);
            if square < best {
                best = square;
                found = Some((Nearest::Face { axis, end }, end));
            }
        }
        for axis in 0..3 {
            for corner in (0..8).filter(|corner| corner & (1 << axis) == 0) {
                let Some((square, at, place, part)) = self.edge(axis, corner, length) else {
                    continue;
                };
                if square < best - MINVAL {
                    best = square;
                    // the upper corner for `part` 2, else the lower one
                    let corner = corner + (1 << axis) * (part / 2);
                    let nearest = Nearest::Edge {
                        axis,
                        corner,
                        place,
                        part,
                    };
                    found = Some((nearest, at));
                }
            }
        }
        found
    }

    /// The squared distance to an edge, the nearest positions on the segment and on the edge, and
    /// the nearest part of the edge.
    fn edge(&self, axis: usize, corner: usize, length: f64) -> Option<(f64, f64, f64, usize)> {
        let mut start: Vec3 = std::array::from_fn(|k| {
            let sign = if corner & (1 << k) == 0 { -1.0 } else { 1.0 };
            sign * self.size[k]
        });
        start[axis] = 0.0;
        let dif = sub(start, self.pos);
        let size = self.size[axis];
        let (ma, mb, mc) = (size * size, -size * self.half[axis], length * length);
        let (u, v) = (-size * dif[axis], dot(self.half, dif));
        let det = ma * mc - mb * mb;
        if det.abs() < MINVAL {
            return None;
        }
        let inverse = 1.0 / det;
        let mut x1 = (mc * u - mb * v) * inverse;
        let mut x2 = (ma * v - mb * u) * inverse;
        let mut part = 1;
        if x1 > 1.0 {
            (x1, part) = (1.0, 2);
            x2 = (v - mb) * (1.0 / mc);
        } else if x1 < -1.0 {
            (x1, part) = (-1.0, 0);
            x2 = (v + mb) * (1.0 / mc);
        }
        if !(-1.0..=1.0).contains(&x2) {
            if x2 > 1.0 {
                x2 = 1.0;
                x1 = (u - mb) * (1.0 / ma);
            } else {
                x2 = -1.0;
                x1 = (u + mb) * (1.0 / ma);
            }
            if x1 > 1.0 {
                (x1, part) = (1.0, 2);
            } else if x1 < -1.0 {
                (x1, part) = (-1.0, 0);
            }
        }
        let mut apart = add_scaled(dif, self.half, -x2);
        apart[axis] += size * x1;
        Some((dot(apart, apart), x2, x1, part))
    }

    /// The distance along the segment from the nearest point to the second contact, if there is
    /// one.
    fn second(&self, nearest: Nearest, at: f64) -> Option<f64> {
        match nearest {
            Nearest::Edge {
                axis,
                corner,
                place,
                part: 1,
            } => self.along_edge(axis, corner, place, at),
            Nearest::Edge { corner, .. } => self.away_from_corner(corner, at),
            Nearest::Face { axis, end } => self.along_face(axis?, end),
        }
    }

    /// The length of the part of the segment between the two faces of the box along `axis`, in half
    /// lengths of the segment.
    fn covered(&self, axis: usize) -> f64 {
        2.0 * self.size[axis] / self.half[axis].abs()
    }

    fn away_from_corner(&self, corner: usize, at: f64) -> Option<f64> {
        let apart = self.signs ^ corner;
        let (sign, other, towards, away) = match apart {
            1 | 2 | 4 => (1.0, apart, 1.0 - at, 1.0 + at),
            3 | 5 | 6 => (-1.0, 7 - apart, 1.0 + at, 1.0 - at),
            // along the diagonal, there is no second contact
            _ => return None,
        };
        let axis = other.trailing_zeros() as usize;
        let (next, last) = ((axis + 1) % 3, (axis + 2) % 3);
        if self.axis[axis] * self.axis[axis] > 0.5 {
            // along the edge
            return Some(least(towards, self.covered(axis)) * sign);
        }
        let length = least(least(away, self.covered(next)), self.covered(last));
        Some(length * -sign)
    }

    fn along_edge(&self, axis: usize, corner: usize, place: f64, at: f64) -> Option<f64> {
        let across = (self.signs ^ corner) & (7 - (1 << axis));
        if ![1, 2, 4].contains(&across) {
            return None;
        }
        let (mut first, second) = ((axis + 1) % 3, (axis + 2) % 3);
        if self.axis[first].abs() > self.axis[second].abs() {
            first = second;
        }
        let second = 3 - axis - first;
        let ahead = across & (1 << second) != 0;
        let (sign, end) = if ahead {
            (1.0, 1.0 - at)
        } else {
            (-1.0, 1.0 + at)
        };
        let length = least(end, self.covered(second));
        let same = (self.signs & (1 << axis) != 0) == ahead;
        let rest = if same { 1.0 - place } else { 1.0 + place };
        let edge = self.size[axis] * rest / self.half[axis].abs();
        Some(least(length, edge) * sign)
    }

    fn along_face(&self, face: usize, end: f64) -> Option<f64> {
        let sign = if end < 0.0 { 1.0 } else { -1.0 };
        let tip = add_scaled(self.pos, self.half, -sign);
        let mut length = 2.0;
        for k in (0..3).filter(|&k| k != face) {
            for size in [self.size[k], -self.size[k]] {
                let way = (size - tip[k]) / self.half[k] * sign;
                if way > 0.0 {
                    length = least(length, way);
                }
            }
        }
        Some(length * sign)
    }
}

/// `b` if it is less than `a`, else `a`.
fn least(a: f64, b: f64) -> f64 {
    if b < a { b } else { a }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::collision::Hit;
    use crate::physics::lanes::tests::random;

    /// A sphere at each of many points of a capsule that is said to be apart: none touches the box.
    #[test]
    fn what_is_apart_does_not_touch() {
        let mut random = random(1);
        let mut random = |most: f64| most * random();
        let (mut apart, mut close) = (0, 0);
        let mat = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
        for _ in 0..20_000 {
            let (radius, margin) = (random(0.3).abs(), random(0.2));
            let segment = Segment {
                pos: [0; 3].map(|_| random(2.0)),
                axis: [0.0; 3],
                half: [0; 3].map(|_| random(1.0)),
                size: [0; 3].map(|_| random(1.0).abs()),
                signs: 0,
            };
            let cuboid = Shape {
                pos: [0.0; 3],
                mat: &mat,
                size: &segment.size,
            };
            let mut touches = 0;
            for step in -20..=20 {
                let centre = add_scaled(segment.pos, segment.half, f64::from(step) / 20.0);
                sphere_box((centre, radius), cuboid, margin, &mut |_: Hit| touches += 1);
            }
            if segment.is_apart(radius + margin) {
                assert_eq!(touches, 0);
                apart += 1;
            } else {
                close += 1;
            }
        }
        assert!(apart > 1_000 && close > 1_000, "{apart} {close}");
    }
}
