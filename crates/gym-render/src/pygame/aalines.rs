//! `pygame.draw.aaline` and `aalines`.

use gym_core::canvas::{Color, Point};

use super::Pixels;

/// Draws antialiased lines between `points`; if `closed`, also from the last point to the first.
pub(super) fn aalines(pixels: &mut impl Pixels, points: &[Point], closed: bool, color: Color) {
    let point = |i: usize| points[i].map(|x| x as f32);
    let count = points.len();
    if count < 2 {
        return;
    }
    if count == 2 && !closed {
        return line(pixels, point(0), point(1), Join::default(), color);
    }
    let is_steep = |p: [f32; 2], q: [f32; 2]| (q[0] - p[0]).abs() < (q[1] - p[1]).abs();
    let segments = if closed { count } else { count - 1 };
    let mut steep_before = None;
    for i in 0..segments {
        let (from, to) = (point(i), point((i + 1) % count));
        let steep = is_steep(from, to);
        let turns = match steep_before {
            Some(before) => steep != before,
            None => {
                // (`from[1]` is pygame's mistake for `to[1]`)
                let after = point(2 % count);
                steep && (after[0] - to[0]).abs() >= (after[1] - from[1]).abs()
            }
        };
        let off = to[0].fract() != 0.0 || to[1].fract() != 0.0;
        let join = Join {
            off,
            turns,
            is_first: !closed && i == 0,
            is_last: !closed && i + 1 == segments,
        };
        line(pixels, from, to, join, color);
        steep_before = Some(steep);
    }
}

/// How a line of a chain meets the lines before and after it.
#[derive(Clone, Copy, Default)]
struct Join {
    /// Whether an end of the line is off the pixel grid. The adjacent lines then draw the ends.
    off: bool,
    /// Whether exactly one of this line and the previous line is steep. The line then draws its
    /// ends even if `off`.
    turns: bool,
    /// Whether an open chain begins with this line.
    is_first: bool,
    /// Whether an open chain ends with this line.
    is_last: bool,
}

fn line(pixels: &mut impl Pixels, mut from: [f32; 2], mut to: [f32; 2], join: Join, color: Color) {
    const LOW: f32 = -1.0;
    let mut high = [pixels.width() as f32, pixels.height() as f32];
    let d = [to[0] - from[0], to[1] - from[1]];
    let steep = d[0].abs() < d[1].abs();
    let mut mix = |x: i32, y: i32, f: f32| {
        let [x, y] = if steep { [y, x] } else { [x, y] };
        if pixels.keeps(x, y) {
            pixels.change(x, y, color, |d, s| {
                (f * f32::from(s) + (1.0 - f) * f32::from(d)) as i32 as u8
            });
        }
    };
    if d.iter().all(|d| d.abs() < 0.0001) {
        let [x, y] = from.map(|x| (f64::from(x) + 0.5).floor() as i32);
        return if steep {
            mix(y, x, 1.0);
        } else {
            mix(x, y, 1.0);
        };
    }
    // from here on, the line is longer along x than along y
    if steep {
        from.swap(0, 1);
        to.swap(0, 1);
        high.swap(0, 1);
    }
    if to[0] < from[0] {
        std::mem::swap(&mut from, &mut to);
    }
    if to[0] <= LOW || from[0] >= high[0] {
        return;
    }
    let gradient = (to[1] - from[1]) / (to[0] - from[0]);
    if from[0] < LOW {
        from = [LOW, from[1] + gradient * (LOW - from[0])];
    }
    if to[0] > high[0] {
        to = [high[0], to[1] + gradient * (high[0] - to[0])];
    }
    let (upper, lower) = if gradient > 0.0 {
        (&mut from, &mut to)
    } else {
        (&mut to, &mut from)
    };
    if lower[1] <= LOW || upper[1] >= high[1] {
        return;
    }
    if upper[1] < LOW {
        *upper = [upper[0] + (LOW - upper[1]) / gradient, LOW];
    }
    if lower[1] > high[1] {
        *lower = [lower[0] + (high[1] - lower[1]) / gradient, high[1]];
    }
    from[1] += 1.0;
    to[1] += 1.0;

    let mut pair = |x: i32, y: f32, share: f32| {
        let row = y as i32;
        let f = y - row as f32;
        if (row as f32) < y {
            mix(x, row, f * share);
        }
        mix(x, row - 1, (1.0 - f) * share);
    };
    let mut x = from[0] as i32;
    let mut y = from[1] + gradient * (x as f32 - from[0]);
    if (!join.off || join.turns || join.is_first) && to[0] > 0.0 {
        pair(x, y, (1 + x) as f32 - from[0]);
        y += gradient;
        x += 1;
    }
    if join.off && !join.is_first {
        x = from[0].ceil() as i32;
        y = from[1] + gradient * (x as f32 - from[0]);
    }
    let end = to[0].ceil() as i32;
    if (!join.off || join.turns || join.is_last) && from[0] < high[0] - 1.0 {
        pair(
            end,
            to[1] + gradient * (end as f32 - to[0]),
            (1 - end) as f32 + to[0],
        );
    }
    while x < end {
        let row = y as i32;
        let f = 1.0 - y + row as f32;
        mix(x, row - 1, f);
        if (row as f32) < y {
            mix(x, row, 1.0 - f);
        }
        y += gradient;
        x += 1;
    }
}
