//! The terrain: a bowl, times random numbers on a coarse grid between which a cubic spline
//! interpolates.
//!
//! Sources: dm_control 1.0.45, `suite/quadruped.py`; SciPy 1.18, `ndimage.zoom` (BSD 3-clause).

use std::f64::consts::PI;

use gym_core::math;
use gym_sim::Rng;

/// The points of the terrain along an edge.
pub(super) const POINTS: usize = 201;
/// The random numbers along an edge: one for each two metres.
pub(super) const BUMPS: usize = 30;
/// The least of them, the greatest is 1.
const SMOOTHNESS: f64 = 0.15;
/// The pole of the filter that finds the coefficients of a cubic spline: the root of 3, less 2.
const POLE: f64 = -0.267_949_192_431_122_7;

pub(super) fn draw_bumps(rng: &mut Rng) -> Vec<f64> {
    let mut draw = || rng.uniform(SMOOTHNESS, 1.0);
    (0..BUMPS * BUMPS).map(|_| draw()).collect()
}

/// Computes the elevations of the terrain with these bumps.
pub(super) fn shape(bumps: &[f64], elevations: &mut [f32]) {
    let mut coefficients = bumps.to_vec();
    filter(&mut coefficients);
    let along: Vec<_> = (0..POINTS).map(place).collect();
    for (row, elevations) in elevations.chunks_mut(POINTS).enumerate() {
        for (column, elevation) in elevations.iter_mut().enumerate() {
            let bump = interpolate(&coefficients, &along[row], &along[column]);
            *elevation = (bowl(row, column) * bump) as f32;
        }
    }
}

/// The bowl: 0 in the middle and at the edge, 1 half way.
fn bowl(row: usize, column: usize) -> f64 {
    let [x, y] = [column, row].map(|k| k as f64 * 0.01 - 1.0);
    let radius = (x * x + y * y).sqrt().clamp(0.04, 1.0);
    0.5 - math::cos(2.0 * PI * radius) / 2.0
}

/// Replaces samples on a square grid by the coefficients of the spline through them, whose mirror
/// images continue it: SciPy's `spline_filter`.
fn filter(c: &mut [f64]) {
    let mut line = [0.0; BUMPS];
    for stride in [BUMPS, 1] {
        for k in 0..BUMPS {
            let first = k * (BUMPS + 1 - stride);
            for (i, x) in line.iter_mut().enumerate() {
                *x = c[first + i * stride];
            }
            filter_line(&mut line);
            for (i, x) in line.iter().enumerate() {
                c[first + i * stride] = *x;
            }
        }
    }
}

fn filter_line(c: &mut [f64; BUMPS]) {
    let (z, n) = (POLE, BUMPS);
    let gain = (1.0 - z) * (1.0 - 1.0 / z);
    c.iter_mut().for_each(|x| *x *= gain);
    let last = math::pow(z, (n - 1) as f64);
    let mut power = z;
    c[0] += last * c[n - 1];
    for i in 1..n - 1 {
        c[0] += power * (c[i] + last * c[n - 1 - i]);
        power *= z;
    }
    c[0] /= 1.0 - last * last;
    for i in 1..n {
        c[i] += z * c[i - 1];
    }
    c[n - 1] = (z * c[n - 2] + c[n - 1]) * z / (z * z - 1.0);
    for i in (0..n - 1).rev() {
        c[i] = z * (c[i + 1] - c[i]);
    }
}

/// The four coefficients around a point of the terrain along an axis, and their weights; `None`
/// beyond the last of them.
type Place = Option<([usize; 4], [f64; 4])>;

fn place(point: usize) -> Place {
    let at = point as f64 * ((BUMPS - 1) as f64 / (POINTS - 1) as f64);
    if at > (BUMPS - 1) as f64 {
        return None;
    }
    let first = at.floor() as isize - 1;
    let end = BUMPS as isize;
    let mirrored = |k: isize| if k >= end { 2 * end - 2 - k } else { k.abs() } as usize;
    let y = at - at.floor();
    let z = 1.0 - y;
    let middle = |y: f64| (y * y * (y - 2.0) * 3.0 + 4.0) / 6.0;
    let [a, b, c] = [z * z * z / 6.0, middle(y), middle(z)];
    let weights = [a, b, c, 1.0 - a - b - c];
    Some(([0, 1, 2, 3].map(|k| mirrored(first + k)), weights))
}

fn interpolate(coefficients: &[f64], row: &Place, column: &Place) -> f64 {
    let (Some((rows, row_weights)), Some((columns, column_weights))) = (row, column) else {
        return 0.0;
    };
    let mut sum = 0.0;
    for (i, row) in rows.iter().enumerate() {
        for (j, column) in columns.iter().enumerate() {
            sum += coefficients[row * BUMPS + column] * row_weights[i] * column_weights[j];
        }
    }
    sum
}
