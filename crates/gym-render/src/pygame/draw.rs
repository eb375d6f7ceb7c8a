//! The primitives of `pygame.draw` without antialiasing.

use gym_core::canvas::{Color, Point};

use super::{Edge, Edges, FEW, MANY, Pixels, whole};

/// Draws lines of `width` pixels between `points`; if `closed`, also from the last point to the
/// first.
pub(super) fn lines(
    pixels: &mut impl Pixels,
    points: &[Point],
    closed: bool,
    width: u32,
    color: Color,
) {
    for pair in points.windows(2) {
        line(pixels, whole(pair[0]), whole(pair[1]), width as i32, color);
    }
    if let [first, .., last] = points
        && closed
    {
        line(pixels, whole(*last), whole(*first), width as i32, color);
    }
}

fn line(
    pixels: &mut impl Pixels,
    [mut x, mut y]: [i32; 2],
    end: [i32; 2],
    width: i32,
    color: Color,
) {
    let sign = |d: i32| if d > 0 { 1 } else { -1 };
    let (dx, dy) = ((end[0] - x).abs(), (end[1] - y).abs());
    let (sx, sy) = (sign(end[0] - x), sign(end[1] - y));
    let mut error = (if dx > dy { dx } else { -dy }) / 2;
    let (half, even) = (width / 2, 1 - width % 2);
    loop {
        if dx > dy {
            pixels.vline(x, y - half + even, y + half, color);
        } else {
            pixels.hline(x - half + even, x + half, y, color);
        }
        if [x, y] == end {
            return;
        }
        let before = error;
        if before > -dx {
            error -= dy;
            x += sx;
        }
        if before < dy {
            error += dx;
            y += sy;
        }
    }
}

/// Draws a filled polygon with its outline.
pub(super) fn polygon(pixels: &mut impl Pixels, points: &[Point], color: Color) {
    if let [a, b, c] = *points {
        return triangle(pixels, [a, b, c].map(whole), color);
    }
    if points.len() <= FEW {
        fill::<FEW>(pixels, points, color);
    } else {
        fill::<MANY>(pixels, points, color);
    }
}

fn fill<const MOST: usize>(pixels: &mut impl Pixels, points: &[Point], color: Color) {
    let edges = Edges::<MOST>::new(points);
    let (min, max) = (edges.min, edges.max);
    if min == max {
        let xs = || points.iter().map(|point| whole(*point)[0]);
        if let (Some(left), Some(right)) = (xs().min(), xs().max()) {
            pixels.hline(left, right, min, color);
        }
        return;
    }
    let cut = |&Edge { x1, y1, x2, y2, .. }: &Edge, y: i32, before: usize| {
        if x1 == x2 {
            return x1; // BipedalWalker's ground has many vertical edges
        }
        let q = (y - y1).wrapping_mul(x2 - x1) as f32 / (y2 - y1) as f32;
        // pygame rounds every second intersection down, the others up
        x1 + if before.is_multiple_of(2) {
            q.floor()
        } else {
            q.ceil()
        } as i32
    };
    edges.scan(pixels.rows(), cut, |a, b, y| pixels.hline(a, b, y, color));
    // horizontal edges inside the polygon
    let mut p = points.last().copied().map_or([0; 2], whole);
    for q in points.iter().map(|point| whole(*point)) {
        if p[1] == q[1] && min < p[1] && p[1] < max {
            pixels.hline(p[0], q[0], p[1], color);
        }
        p = q;
    }
}

fn triangle(pixels: &mut impl Pixels, [mut a, mut b, mut c]: [[i32; 2]; 3], color: Color) {
    if b[1] < a[1] {
        std::mem::swap(&mut a, &mut b);
    }
    if c[1] < b[1] {
        std::mem::swap(&mut b, &mut c);
        if b[1] < a[1] {
            std::mem::swap(&mut a, &mut b);
        }
    }
    if a[1] == b[1] && b[1] == c[1] && a[0] == b[0] && b[0] != c[0] {
        std::mem::swap(&mut b, &mut c);
    }
    let slope = |p: [i32; 2], q: [i32; 2]| {
        (f64::from(q[0] - p[0]) / (f64::from(q[1] - p[1]) + 1e-17)) as f32
    };
    let (ac, ab, bc) = (slope(a, c), slope(a, b), slope(b, c));
    let at = |p: [i32; 2], slope: f32, y: i32| p[0] + ((y - p[1]) as f32 * slope) as i32;
    let rows = pixels.rows();
    for y in a[1].max(rows.start)..(c[1] + 1).min(rows.end) {
        let other = if y < b[1] { at(a, ab, y) } else { at(b, bc, y) };
        pixels.hline(at(a, ac, y), other, y, color);
    }
}

/// Draws a filled circle whose centre is the common corner of four pixels.
pub(super) fn circle(pixels: &mut impl Pixels, [cx, cy]: [i32; 2], radius: i32, color: Color) {
    if radius < 1 {
        return;
    }
    let (mut f, mut x, mut y) = (1 - radius, 0, radius);
    while x < y {
        if f >= 0 {
            y -= 1;
            f -= 2 * y;
        }
        x += 1;
        f += 2 * x + 1;
        if f >= 0 {
            pixels.hline(cx - x, cx + x - 1, cy + y - 1, color);
            pixels.hline(cx - x, cx + x - 1, cy - y, color);
        }
        pixels.hline(cx - y, cx + y - 1, cy + x - 1, color);
        pixels.hline(cx - y, cx + y - 1, cy - x, color);
    }
}
