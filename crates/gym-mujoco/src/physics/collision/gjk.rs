//! The distance of two convex sets by the algorithm of Gilbert, Johnson and Keerthi, with the distance sub-algorithm of signed
//! volumes (Montanari, Petrinic, Barbieri: Improving the GJK algorithm, ACM Transactions on Graphics 36, 2017).

use super::super::spatial::{Vec3, add_scaled, cross, dot, norm, scale, sub};

/// MuJoCo's `ccd_tolerance`.
pub(super) const TOLERANCE: f64 = 1e-6;
/// MuJoCo's `ccd_iterations`.
const ITERATIONS: usize = 35;

/// How two sets lie.
pub(super) enum Distance {
    /// No nearer than the distance asked about.
    Beyond,
    /// The nearest points.
    Apart(Vec3, Vec3),
    /// They overlap, or nearly.
    Within,
}

/// Points of the two sets, and their difference.
#[derive(Clone, Copy, Default)]
struct Vertex {
    w1: Vec3,
    w2: Vec3,
    x: Vec3,
}

/// The distance of two sets given by their furthest points in a direction.
///
/// `start` is the difference of any two points. `reach` is the distance from which on it does not matter.
pub(super) fn distance(
    start: Vec3,
    reach: f64,
    support1: impl Fn(Vec3) -> Vec3,
    support2: impl Fn(Vec3) -> Vec3,
) -> Distance {
    let mut simplex = [Vertex::default(); 4];
    let mut weights = [0.0; 4];
    let mut number = 0;
    let mut x = start;
    let mut length = norm(x);
    let mut before = f64::MAX;
    for _ in 0..ITERATIONS {
        if length < TOLERANCE || (before - length).abs() < 1e-15 {
            break;
        }
        let direction = scale(x, -1.0 / length);
        let (w1, w2) = (support1(direction), support2(scale(direction, -1.0)));
        let s = sub(w1, w2);
        if dot(x, sub(x, s)) < 0.5 * TOLERANCE * TOLERANCE {
            break;
        }
        let along = dot(x, s);
        if along > 0.0 && along * along >= reach * reach * length * length {
            return Distance::Beyond;
        }
        simplex[number] = Vertex { w1, w2, x: s };
        number += 1;
        let found = closest(&simplex.map(|v| v.x)[..number]);
        // vertices without weight are dropped
        let mut kept = 0;
        for i in 0..number {
            if found[i] != 0.0 {
                (simplex[kept], weights[kept]) = (simplex[i], found[i]);
                kept += 1;
            }
        }
        number = kept;
        if number == 4 {
            return Distance::Within;
        }
        x = combine(&simplex, &weights, number, |v| v.x);
        before = length;
        length = norm(x);
    }
    if length <= TOLERANCE {
        Distance::Within
    } else {
        Distance::Apart(
            combine(&simplex, &weights, number, |v| v.w1),
            combine(&simplex, &weights, number, |v| v.w2),
        )
    }
}

fn combine(simplex: &[Vertex; 4], weights: &[f64; 4], number: usize, of: impl Fn(&Vertex) -> Vec3) -> Vec3 {
    (0..number).fold([0.0; 3], |sum, i| add_scaled(sum, of(&simplex[i]), weights[i]))
}

/// Weights of the simplex's corners at its point nearest to the origin.
fn closest(s: &[Vec3]) -> [f64; 4] {
    match *s {
        [_] => [1.0, 0.0, 0.0, 0.0],
        [a, b] => spread(segment(a, b), [0, 1]),
        [a, b, c] => spread(triangle(a, b, c), [0, 1, 2]),
        [a, b, c, d] => tetrahedron([a, b, c, d]),
        _ => [0.0; 4],
    }
}

/// Weights of some corners among all four.
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

fn segment(a: Vec3, b: Vec3) -> [f64; 2] {
    let along = sub(b, a);
    let nearest = add_scaled(b, along, -dot(b, along) / dot(along, along));
    // the axis on which the segment is longest
    let k = (0..3).fold(0, |best, k| if (a[k] - b[k]).abs() >= (a[best] - b[best]).abs() { k } else { best });
    let (whole, from_b, from_a) = (a[k] - b[k], nearest[k] - b[k], a[k] - nearest[k]);
    if same_sign(whole, from_b) && same_sign(whole, from_a) {
        [from_b / whole, from_a / whole]
    } else if dot(a, a) < dot(b, b) {
        [1.0, 0.0]
    } else {
        [0.0, 1.0]
    }
}

fn triangle(a: Vec3, b: Vec3, c: Vec3) -> [f64; 3] {
    let normal = cross(sub(b, a), sub(c, a));
    let square = dot(normal, normal);
    let corners = [a, b, c];
    let mut outside = [true; 3];
    if square > 0.0 {
        let nearest = scale(normal, dot(normal, a) / square);
        // the plane of two axes on which the triangle is largest
        let k = (0..3).fold(0, |best, k| if normal[k].abs() >= normal[best].abs() { k } else { best });
        let (u, v) = ((k + 1) % 3, (k + 2) % 3);
        let area = |p: Vec3, q: Vec3, r: Vec3| (q[u] - p[u]) * (r[v] - p[v]) - (q[v] - p[v]) * (r[u] - p[u]);
        let parts = [area(nearest, b, c), area(a, nearest, c), area(a, b, nearest)];
        outside = parts.map(|part| !same_sign(normal[k], part));
        if outside == [false; 3] {
            return parts.map(|part| part / normal[k]);
        }
    }
    let mut best = ([0.0, 0.0, 1.0], f64::MAX);
    for i in (0..3).filter(|&i| outside[i]) {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        let weights = segment(corners[j], corners[k]);
        let point = add_scaled(scale(corners[j], weights[0]), corners[k], weights[1]);
        let square = dot(point, point);
        if square < best.1 {
            best = ([0.0; 3], square);
            (best.0[j], best.0[k]) = (weights[0], weights[1]);
        }
    }
    best.0
}

fn tetrahedron(s: [Vec3; 4]) -> [f64; 4] {
    let volume = |p: Vec3, q: Vec3, r: Vec3| dot(p, cross(q, r));
    // the volumes of the origin with each face, with the sign of the whole for the inside
    let [a, b, c, d] = s;
    let parts = [volume(b, c, d), -volume(a, c, d), volume(a, b, d), -volume(a, b, c)];
    let whole: f64 = parts.iter().sum();
    let outside = parts.map(|part| !same_sign(whole, part));
    if outside == [false; 4] {
        return parts.map(|part| part / whole);
    }
    let mut best = ([0.0, 0.0, 0.0, 1.0], f64::MAX);
    for i in (0..4).filter(|&i| outside[i]) {
        let [j, k, l] = [1, 2, 3].map(|step| (i + step) % 4);
        let weights = triangle(s[j], s[k], s[l]);
        let point = add_scaled(add_scaled(scale(s[j], weights[0]), s[k], weights[1]), s[l], weights[2]);
        let square = dot(point, point);
        if square < best.1 {
            best = (spread(weights, [j, k, l]), square);
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
                        let p = s.iter().zip(w).fold([0.0; 3], |sum, (&p, w)| add_scaled(sum, p, w));
                        best = best.min(norm(p));
                    }
                }
            }
        }
        best
    }

    #[test]
    fn finds_the_nearest_point_of_simplices() {
        let mut seed = 1_u64;
        let mut number = move || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 33) as f64 / f64::from(1_u32 << 31) * 4.0 - 1.5
        };
        for _ in 0..200 {
            let corners: [Vec3; 4] = std::array::from_fn(|_| std::array::from_fn(|_| number()));
            for n in 1..=4 {
                let weights = closest(&corners[..n]);
                assert!(
                    weights.iter().all(|&w| w >= 0.0) && (weights.iter().sum::<f64>() - 1.0).abs() < 1e-9
                );
                let p = corners.iter().zip(weights).fold([0.0; 3], |sum, (&p, w)| add_scaled(sum, p, w));
                let many = nearest_of_many(&corners[..n]);
                assert!(norm(p) <= many + 1e-12 && norm(p) > many - 0.15, "{} {many} {n}", norm(p));
            }
        }
    }
}
