//! Shapes in the unit square, defined by tests of points. Sums and products have the precision of
//! minigrid's numpy arrays.

use gym_core::math;

/// A set of points of the unit square.
#[derive(Clone, Copy, Debug)]
pub(super) enum Shape {
    /// A rectangle, edges included: left, right, top, bottom.
    Rect([f64; 4]),
    /// A circle: centre and radius.
    Circle([f64; 3]),
    /// The points within a distance of a straight line through two points.
    Line([f64; 4], f64),
    /// The triangle of the agent, which faces a direction.
    Agent(u8),
}

impl Shape {
    /// Whether the point `x`, `y` lies in the shape.
    pub(super) fn has(&self, x: f64, y: f64) -> bool {
        match *self {
            Self::Rect([left, right, top, bottom]) => {
                x >= left && x <= right && y >= top && y <= bottom
            }
            Self::Circle([cx, cy, r]) => (x - cx) * (x - cx) + (y - cy) * (y - cy) <= r * r,
            Self::Line(ends, r) => is_near_line(ends, r, x, y),
            Self::Agent(direction) => is_in_agent(direction, x, y),
        }
    }
}

/// Returns the `float32` dot product of two vectors. The sum is computed in `float64` and rounded
/// once.
fn dot32([a, b]: [f32; 2], [c, d]: [f32; 2]) -> f32 {
    (f64::from(a) * f64::from(c) + f64::from(b) * f64::from(d)) as f32
}

/// Returns the `float64` dot product of a `float32` vector and a `float64` vector.
fn dot64([a, b]: [f32; 2], [c, d]: [f64; 2]) -> f64 {
    f64::from(a) * c + f64::from(b) * d
}

fn is_near_line([x0, y0, x1, y1]: [f64; 4], r: f64, x: f64, y: f64) -> bool {
    if x < x0.min(x1) - r || x > x0.max(x1) + r || y < y0.min(y1) - r || y > y0.max(y1) + r {
        return false;
    }
    let start = [x0 as f32, y0 as f32];
    let line = [x1 as f32 - start[0], y1 as f32 - start[1]];
    let length = dot32(line, line).sqrt();
    let unit = line.map(|x| x / length);
    let from_start = [x - f64::from(start[0]), y - f64::from(start[1])];
    let along = dot64(unit, from_start).clamp(0.0, f64::from(length));
    let [dx, dy] = [0, 1].map(|i| {
        let nearest = f64::from(start[i]) + along * f64::from(unit[i]);
        [x, y][i] - nearest
    });
    (dx * dx + dy * dy).sqrt() <= r
}

/// Whether the point `x`, `y` is in the agent's triangle, which points right and is rotated about
/// the centre to `direction`.
fn is_in_agent(direction: u8, x: f64, y: f64) -> bool {
    let angle = -(0.5 * std::f64::consts::PI * f64::from(direction));
    let (sin, cos) = (math::sin(angle), math::cos(angle));
    let (x, y) = (x - 0.5, y - 0.5);
    let (x, y) = (0.5 + x * cos - y * sin, 0.5 + y * cos + x * sin);

    let [a, b, c]: [[f32; 2]; 3] = [[0.12, 0.19], [0.87, 0.5], [0.12, 0.81]];
    let minus = |p: [f32; 2]| [p[0] - a[0], p[1] - a[1]];
    let (v0, v1) = (minus(c), minus(b));
    let v2 = [x - f64::from(a[0]), y - f64::from(a[1])];
    let (dot00, dot01, dot11) = (dot32(v0, v0), dot32(v0, v1), dot32(v1, v1));
    let (dot02, dot12) = (dot64(v0, v2), dot64(v1, v2));
    let inv_denom = f64::from(1.0 / (dot00 * dot11 - dot01 * dot01));
    let u = (f64::from(dot11) * dot02 - f64::from(dot01) * dot12) * inv_denom;
    let v = (f64::from(dot00) * dot12 - f64::from(dot01) * dot02) * inv_denom;
    u >= 0.0 && v >= 0.0 && u + v < 1.0
}
