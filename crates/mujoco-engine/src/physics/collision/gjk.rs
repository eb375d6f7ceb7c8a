//! The distance of two convex sets by the algorithm of Gilbert, Johnson and Keerthi, with the
//! distance sub-algorithm of signed volumes (Montanari, Petrinic, Barbieri: Improving the GJK
//! algorithm, ACM Transactions on Graphics 36, 2017).
//!
//! It repeats MuJoCo's `engine_collision_gjk` operation by operation: if sets touch, the number of
//! iterations depends on the last bit.

use crate::Revision;
use crate::math::spatial::{MINVAL, Vec3, add_scaled, cross, dot, norm, scale, sub};
use crate::model::CompiledModel;

/// The rules of a search: those of the release, and where the model's options end it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rules {
    pub(super) revision: Revision,
    /// MuJoCo's `ccd_tolerance`.
    pub(super) tolerance: f64,
    /// MuJoCo's `ccd_iterations`.
    pub(super) iterations: usize,
}

impl Rules {
    pub(super) fn of(m: &CompiledModel) -> Self {
        Self {
            revision: m.revision,
            tolerance: m.opt.ccd_tolerance,
            iterations: m.opt.ccd_iterations,
        }
    }
}

/// Squared lengths below this count as zero.
pub(super) const LEAST: f64 = MINVAL * MINVAL;

/// Points of the two sets, and their difference.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Vertex {
    pub(super) w1: Vec3,
    pub(super) w2: Vec3,
    pub(super) x: Vec3,
    /// The number of each set's corner or end at the point.
    pub(super) corners: [u32; 2],
}

impl Vertex {
    pub(super) fn new((w1, first): (Vec3, u32), (w2, second): (Vec3, u32)) -> Self {
        Self {
            w1,
            w2,
            x: sub(w1, w2),
            corners: [first, second],
        }
    }
}

/// The result of the algorithm.
pub(super) struct Found {
    /// The distance; 0 if the sets overlap, [`f64::MAX`] if it exceeds `reach`.
    pub(super) distance: f64,
    /// The nearest points, if `distance` is neither 0 nor [`f64::MAX`].
    pub(super) nearest: [Vec3; 2],
    pub(super) simplex: [Vertex; 4],
    /// The number of vertices in `simplex`.
    pub(super) number: usize,
    /// Whether a plane separates the sets.
    pub(super) separated: bool,
}

impl Found {
    fn beyond() -> Self {
        Self {
            distance: f64::MAX,
            nearest: [[0.0; 3]; 2],
            simplex: [Vertex::default(); 4],
            number: 0,
            separated: true,
        }
    }
}

/// Returns the distance of two sets. For a direction of length 1, `support` returns the furthest
/// point of the first set in this direction, and of the second set in the opposite direction.
///
/// `centers` has a point of each set. The algorithm stops once the distance is known to exceed
/// `reach`. With a `reach` of 0, the algorithm only decides whether the sets overlap. If both sets
/// have finitely many support points (`discrete`), it does not stop before the nearest ones.
pub(super) fn distance(
    centers: [Vec3; 2],
    reach: f64,
    (rules, discrete): (Rules, bool),
    support: &impl Fn(Vec3) -> Vertex,
) -> Found {
    if rules.revision.projects_origin() {
        distance_4_0(centers, reach, (rules, discrete), support)
    } else {
        distance_3_12(centers, reach, (rules, discrete), support)
    }
}

/// The furthest point of the difference in the direction from `x`, at distance `length`, to the
/// origin.
fn toward_origin(x: Vec3, length: f64, support: &impl Fn(Vec3) -> Vertex) -> Vertex {
    support(scale(scale(x, 1.0 / length), -1.0))
}

/// The least gain, in squared length, for which the search continues.
fn slack(tolerance: f64, discrete: bool) -> f64 {
    if discrete {
        0.0
    } else {
        0.5 * (tolerance * tolerance)
    }
}

/// Drops the vertices whose weight in `found` is zero, and returns how many are left.
fn drop_vertices(simplex: &mut [Vertex; 4], weights: &mut [f64; 4], found: [f64; 4]) -> usize {
    let mut number = 0;
    for i in 0..4 {
        if found[i] != 0.0 {
            (simplex[number], weights[number]) = (simplex[i], found[i]);
            number += 1;
        }
    }
    number
}

/// Before 4.0: the nearest point is the weighted sum of the simplex. If only the overlap matters,
/// [`contains_origin`] continues from a tetrahedron.
fn distance_3_12(
    centers: [Vec3; 2],
    reach: f64,
    (rules, discrete): (Rules, bool),
    support: &impl Fn(Vec3) -> Vertex,
) -> Found {
    let (mut simplex, mut weights, mut number) = ([Vertex::default(); 4], [0.0; 4], 0);
    let mut nearest = centers;
    let mut portal = reach == 0.0;
    let least = if discrete { MINVAL } else { rules.tolerance };
    let mut x = sub(centers[0], centers[1]);
    let (mut length, mut before) = (norm(x), 0.0);
    let mut iteration = 0;
    while iteration < rules.iterations {
        if length < least || f64::abs(before - length) < MINVAL {
            break;
        }
        let vertex = toward_origin(x, length, support);
        let s = vertex.x;
        if dot(x, sub(x, s)) < slack(rules.tolerance, discrete) {
            break;
        }
        let along = dot(x, s);
        if along > 0.0 && along * along >= reach * reach * (length * length) {
            return Found::beyond();
        }
        simplex[number] = vertex;
        if number == 3 && portal {
            match contains_origin(&mut simplex, &mut iteration, rules.iterations, support) {
                Some(true) => {
                    return Found {
                        distance: 0.0,
                        nearest,
                        simplex,
                        number: 4,
                        separated: false,
                    };
                }
                Some(false) => return Found::beyond(),
                None => portal = false,
            }
        }
        number += 1;
        let found = closest(&simplex.map(|v| v.x)[..number], rules.revision);
        number = drop_vertices(&mut simplex, &mut weights, found);
        if number == 0 {
            return Found::beyond();
        }
        x = combine(&simplex, &weights, number, |v| v.x);
        (before, length) = (length, norm(x));
        if number == 4 {
            break;
        }
        iteration += 1;
    }
    if number > 0 {
        nearest = [
            combine(&simplex, &weights, number, |v| v.w1),
            combine(&simplex, &weights, number, |v| v.w2),
        ];
    }
    let separated = dot(x, toward_origin(x, length, support).x) > 0.0;
    let distance = if number == 4 && !separated {
        0.0
    } else {
        length
    };
    Found {
        distance,
        nearest,
        simplex,
        number,
        separated,
    }
}

/// From 4.0 on: the nearest point of a segment or triangle is the origin's projection, the search
/// ends by comparison with the least distance so far, and a tetrahedron ends the search: the
/// expanding polytope continues from there.
fn distance_4_0(
    centers: [Vec3; 2],
    reach: f64,
    (rules, discrete): (Rules, bool),
    support: &impl Fn(Vec3) -> Vertex,
) -> Found {
    let (mut simplex, mut weights, mut number) = ([Vertex::default(); 4], [0.0; 4], 0);
    let exact = reach > 0.0 || discrete;
    let least = if exact { MINVAL } else { rules.tolerance };
    let mut x = sub(centers[0], centers[1]);
    let mut length = norm(x);
    if length < MINVAL {
        (x, length) = ([1.0, 0.0, 0.0], 1.0);
    }
    let mut separated = false;
    for iteration in 0..rules.iterations {
        let vertex = toward_origin(x, length, support);
        let along = dot(x, vertex.x);
        if along > 0.0 {
            separated = true;
            if reach == 0.0 || along >= reach * length {
                return Found::beyond();
            }
        }
        if iteration > 0 && dot(x, sub(x, vertex.x)) < slack(rules.tolerance, discrete) {
            break;
        }
        simplex[number] = vertex;
        let found = closest(&simplex.map(|v| v.x)[..=number], rules.revision);
        number = drop_vertices(&mut simplex, &mut weights, found);
        if number == 0 {
            return Found::beyond();
        }
        if number == 4 {
            if !separated {
                length = 0.0;
            }
            break;
        }
        let [a, b, c] = [0, 1, 2].map(|i| simplex[i].x);
        let projected = match number {
            2 => project_on_line(a, b),
            3 => project(a, b, c, rules.revision),
            _ => None,
        };
        x = projected.unwrap_or_else(|| combine(&simplex, &weights, number, |v| v.x));
        let before = length;
        length = norm(x);
        let near = if number == 1 { MINVAL } else { least };
        if length < near || (iteration > 0 && f64::abs(length - before) < MINVAL) {
            break;
        }
    }
    let nearest = [
        combine(&simplex, &weights, number, |v| v.w1),
        combine(&simplex, &weights, number, |v| v.w2),
    ];
    if number <= 3 && !separated && length >= MINVAL {
        separated = dot(x, toward_origin(x, length, support).x) > 0.0;
    }
    Found {
        distance: length,
        nearest,
        simplex,
        number,
        separated,
    }
}

/// The origin projected onto the line through two points; `None` if the points coincide.
fn project_on_line(a: Vec3, b: Vec3) -> Option<Vec3> {
    let along = sub(b, a);
    let square = dot(along, along);
    (square >= LEAST).then(|| add_scaled(b, along, -(dot(b, along) / square)))
}

fn combine(
    simplex: &[Vertex; 4],
    weights: &[f64; 4],
    number: usize,
    of: impl Fn(&Vertex) -> Vec3,
) -> Vec3 {
    let first = scale(of(&simplex[0]), weights[0]);
    (1..number).fold(first, |sum, i| add_scaled(sum, of(&simplex[i]), weights[i]))
}

/// Whether the difference of the sets contains the origin; `None` if the iteration does not
/// converge. Each iteration replaces the vertex opposite to the face with the greatest distance
/// from the origin. MuJoCo's `gjkIntersect`.
fn contains_origin(
    simplex: &mut [Vertex; 4],
    iteration: &mut usize,
    most: usize,
    support: &impl Fn(Vec3) -> Vertex,
) -> Option<bool> {
    let mut s = *simplex;
    while *iteration < most {
        let faces = [
            signed_distance(&s[2], &s[1], &s[3]),
            signed_distance(&s[0], &s[2], &s[3]),
            signed_distance(&s[1], &s[0], &s[3]),
            signed_distance(&s[0], &s[1], &s[2]),
        ];
        if faces.iter().any(|face| face.0 == 0.0) {
            return None;
        }
        let i = if faces[0].0 < faces[1].0 { 0 } else { 1 };
        let j = if faces[2].0 < faces[3].0 { 2 } else { 3 };
        let least = if faces[i].0 < faces[j].0 { i } else { j };
        let (distance, normal) = faces[least];
        if distance > 0.0 {
            *simplex = s;
            return Some(true);
        }
        s[least] = support(normal);
        if dot(normal, s[least].x) < 0.0 {
            return Some(false);
        }
        // swapping the next two vertices restores the tetrahedron's orientation
        s.swap((least + 1) % 4, (least + 2) % 4);
        *iteration += 1;
    }
    None
}

/// The signed distance of a face from the origin along its normal, and the normal; [`f64::MAX`] for
/// a face without a normal.
fn signed_distance(a: &Vertex, b: &Vertex, c: &Vertex) -> (f64, Vec3) {
    const MOST: f64 = crate::physics::MAXVAL * crate::physics::MAXVAL;
    let normal = cross(sub(c.x, a.x), sub(b.x, a.x));
    let square = dot(normal, normal);
    if square > LEAST && square < MOST {
        let normal = scale(normal, 1.0 / square.sqrt());
        (dot(normal, a.x), normal)
    } else {
        (f64::MAX, normal)
    }
}

/// Weights of the simplex's corners at its point nearest to the origin.
fn closest(s: &[Vec3], revision: Revision) -> [f64; 4] {
    match *s {
        [a, b] => spread(segment(a, b, revision), [0, 1]),
        [a, b, c] => spread(triangle(a, b, c, revision), [0, 1, 2]),
        [a, b, c, d] => tetrahedron([a, b, c, d], revision),
        _ => [1.0, 0.0, 0.0, 0.0],
    }
}

/// Expands the weights of `corners` to all four corners.
fn spread<const N: usize>(weights: [f64; N], corners: [usize; N]) -> [f64; 4] {
    let mut all = [0.0; 4];
    for (weight, corner) in weights.into_iter().zip(corners) {
        all[corner] = weight;
    }
    all
}

fn same_sign(a: f64, b: f64) -> bool {
    (a > 0.0 && b > 0.0) || (a < 0.0 && b < 0.0)
}

/// The weights of a segment's ends. If the projection is before the first end, the result is the
/// first end from 4.0 on, and the second end in earlier versions.
fn segment(a: Vec3, b: Vec3, revision: Revision) -> [f64; 2] {
    let along = sub(b, a);
    if revision.projects_origin() && dot(along, along) < LEAST {
        return [0.0, 1.0];
    }
    let nearest = add_scaled(b, along, -(dot(b, along) / dot(along, along)));
    // the axis on which the segment is longest
    let k = (0..3).fold(0, |best, k| {
        if (a[k] - b[k]).abs() >= (a[best] - b[best]).abs() {
            k
        } else {
            best
        }
    });
    let (whole, from_b, from_a) = (a[k] - b[k], nearest[k] - b[k], a[k] - nearest[k]);
    match [from_b, from_a].map(|part| same_sign(whole, part)) {
        [true, true] => [from_b / whole, from_a / whole],
        [true, false] if revision.projects_origin() => [1.0, 0.0],
        _ => [0.0, 1.0],
    }
}

/// The origin projected onto the plane of a triangle; `None` if its area is zero. The function
/// tries the normals at two corners, and uses the first corner whose position has a component along
/// its normal.
pub(super) fn project(a: Vec3, b: Vec3, c: Vec3, revision: Revision) -> Option<Vec3> {
    let (ba, ca, cb) = (sub(b, a), sub(c, a), sub(c, b));
    for (normal, corner) in [(cross(cb, ba), b), (cross(ba, ca), a)] {
        let (height, square) = (dot(normal, corner), dot(normal, normal));
        if square == 0.0 {
            return None;
        }
        if height != 0.0 && square > MINVAL {
            return Some(scale(normal, height / square));
        }
    }
    let normal = cross(ca, cb);
    let square = dot(normal, normal);
    let flat = revision.projects_origin() && square == 0.0;
    (!flat).then(|| scale(normal, dot(normal, c) / square))
}

/// Returns the weights of a triangle's corners at a point of its plane, and which weights have the
/// triangle's sign. The weights are the areas of the three parts about the point, projected on the
/// two axes where the triangle is largest, divided by the triangle's area.
///
/// From 4.0 on, areas are computed from the corners relative to the point, and weights are shares
/// of the sum of the parts instead of the triangle's area.
pub(super) fn weights_at(
    [a, b, c]: [Vec3; 3],
    p: Vec3,
    revision: Revision,
) -> ([f64; 3], [bool; 3]) {
    let (ab, ac) = (sub(b, a), sub(c, a));
    let minor = |x: usize, y: usize| {
        if revision.projects_origin() {
            ab[x] * ac[y] - ab[y] * ac[x]
        } else {
            b[x] * c[y] - b[y] * c[x] - a[x] * c[y] + a[y] * c[x] + a[x] * b[y] - a[y] * b[x]
        }
    };
    let minors = [minor(1, 2), minor(0, 2), minor(0, 1)];
    let [m0, m1, m2] = minors.map(f64::abs);
    let (whole, x, y) = if m0 >= m1 && m0 >= m2 {
        (minors[0], 1, 2)
    } else if m1 >= m2 {
        (minors[1], 0, 2)
    } else {
        (minors[2], 0, 1)
    };
    let part = |q: Vec3, r: Vec3| {
        if revision.projects_origin() {
            (q[x] - p[x]) * (r[y] - p[y]) - (q[y] - p[y]) * (r[x] - p[x])
        } else {
            p[x] * q[y] + p[y] * r[x] + q[x] * r[y] - p[x] * r[y] - p[y] * q[x] - r[x] * q[y]
        }
    };
    let parts = [part(b, c), part(c, a), part(a, b)];
    let sum = if revision.projects_origin() {
        parts[0] + parts[1] + parts[2]
    } else {
        whole
    };
    let signs = parts.map(|part| same_sign(whole, part));
    (parts.map(|part| part / sum), signs)
}

/// The weights of a triangle's corners. If the area is zero, versions before 4.0 use the first
/// edge, later ones all three edges.
fn triangle(a: Vec3, b: Vec3, c: Vec3, revision: Revision) -> [f64; 3] {
    let inside = match (project(a, b, c, revision), revision.projects_origin()) {
        (Some(origin), _) => {
            let (weights, inside) = weights_at([a, b, c], origin, revision);
            if inside == [true; 3] {
                return weights;
            }
            inside
        }
        (None, false) => [true, true, false],
        (None, true) => [false; 3],
    };
    let mut best = ([0.0; 3], f64::MAX);
    let edges = [([b, c], [1, 2]), ([a, c], [0, 2]), ([a, b], [0, 1])];
    let beyond = edges.into_iter().zip(inside).filter(|(_, inside)| !inside);
    for (([p, q], corners), _) in beyond {
        let weights = segment(p, q, revision);
        let nearest = add_scaled(scale(p, weights[0]), q, weights[1]);
        let square = dot(nearest, nearest);
        if square < best.1 {
            best = ([0.0; 3], square);
            (best.0[corners[0]], best.0[corners[1]]) = (weights[0], weights[1]);
        }
    }
    best.0
}

fn tetrahedron([a, b, c, d]: [Vec3; 4], revision: Revision) -> [f64; 4] {
    let volume = |p: Vec3, q: Vec3, r: Vec3| dot(p, cross(q, r));
    // the signed volumes of the origin with each face; if the origin is inside, all have the sign
    // of their sum
    let parts = [
        -volume(b, c, d),
        volume(a, c, d),
        -volume(a, b, d),
        volume(a, b, c),
    ];
    let whole = parts[0] + parts[1] + parts[2] + parts[3];
    let inside = parts.map(|part| same_sign(whole, part));
    if inside == [true; 4] {
        return parts.map(|part| part / whole);
    }
    let mut best = ([0.0; 4], f64::MAX);
    let faces = [
        ([b, c, d], [1, 2, 3]),
        ([a, c, d], [0, 2, 3]),
        ([a, b, d], [0, 1, 3]),
        ([a, b, c], [0, 1, 2]),
    ];
    let beyond = faces.into_iter().zip(inside).filter(|(_, inside)| !inside);
    for (([p, q, r], corners), _) in beyond {
        let weights = triangle(p, q, r, revision);
        let nearest = add_scaled(scale(p, weights[0]), q, weights[1]);
        let nearest = add_scaled(nearest, r, weights[2]);
        let square = dot(nearest, nearest);
        if square < best.1 {
            best = (spread(weights, corners), square);
        }
    }
    best.0
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The point of a simplex nearest to the origin, by trying many weights.
    fn nearest_of_many(s: &[Vec3]) -> f64 {
        const N: usize = 40;
        let mut best = f64::MAX;
        for i in 0..=N {
            for j in 0..=N - i {
                for k in 0..=N - i - j {
                    let w = [i, j, k, N - i - j - k].map(|n| n as f64 / N as f64);
                    if w[s.len()..].iter().all(|&w| w == 0.0) {
                        let p = s
                            .iter()
                            .zip(w)
                            .fold([0.0; 3], |sum, (&p, w)| add_scaled(sum, p, w));
                        best = best.min(norm(p));
                    }
                }
            }
        }
        best
    }

    /// Tests simplices in whose interior the point nearest to the origin lies, as in the last
    /// iterations.
    #[test]
    fn finds_the_nearest_point_of_simplices() {
        let mut seed = 1_u64;
        let mut number = move || {
            seed = seed
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (seed >> 33) as f64 / f64::from(1_u32 << 31) * 4.0 - 1.5
        };
        let mut found = [0; 5];
        for _ in 0..500 {
            let corners: [Vec3; 4] = std::array::from_fn(|_| std::array::from_fn(|_| number()));
            for (n, revision) in (1..=4).flat_map(|n| Revision::ALL.map(|revision| (n, revision))) {
                let weights = closest(&corners[..n], revision);
                assert!(weights.iter().all(|&w| w >= 0.0));
                assert!((weights.iter().sum::<f64>() - 1.0).abs() < 1e-9);
                if weights[..n].contains(&0.0) {
                    continue;
                }
                let p = corners
                    .iter()
                    .zip(weights)
                    .fold([0.0; 3], |sum, (&p, w)| add_scaled(sum, p, w));
                let many = nearest_of_many(&corners[..n]);
                assert!(
                    norm(p) <= many + 1e-12 && norm(p) > many - 0.15,
                    "{} {many} {n}",
                    norm(p)
                );
                found[n] += 1;
            }
        }
        assert!(found[1..].iter().all(|found| *found > 5), "{found:?}");
    }
}
