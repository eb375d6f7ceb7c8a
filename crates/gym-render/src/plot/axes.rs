//! Axes with round ticks, and the area between them.

use gym_core::canvas::{Align, Canvas, Color, Point, Shape};

use super::series::is_drawn;
use super::{AXIS, GRID, INK, PNG_SCALE, TICK_GAP, TICK_SIZE, TICKS};
use crate::number::Decimal;

/// A range of values with round ticks.
#[derive(Clone, Copy, Debug)]
pub(super) struct Axis {
    min: f64,
    max: f64,
    step: f64,
}

impl Axis {
    /// Makes an axis whose ticks are at least `smallest` apart: 1, 2 or 5 times a power of ten.
    pub(super) fn new(min: f64, max: f64, smallest: f64) -> Self {
        let wanted = (max - min) / TICKS;
        let power = 10_f64.powf(wanted.log10().floor());
        let factor = [1.0, 2.0, 5.0]
            .into_iter()
            .find(|factor| factor * power >= wanted)
            .unwrap_or(10.0);
        Self {
            min,
            max,
            step: (factor * power).max(smallest),
        }
    }

    pub(super) fn ticks(self) -> impl Iterator<Item = f64> {
        let (first, last) = (
            (self.min / self.step).ceil() as i64,
            (self.max / self.step).floor() as i64,
        );
        (first..=last).map(move |index| index as f64 * self.step)
    }

    /// Returns the position of `value` on the axis: 0 at `min`, 1 at `max`.
    fn part(self, value: f64) -> f64 {
        (value - self.min) / (self.max - self.min)
    }

    /// Returns the label of a tick, with as many digits as the step requires.
    pub(super) fn label(self, tick: f64) -> String {
        let (order, step_order) = (tick.abs().log10().floor(), self.step.log10().floor());
        if order >= 7.0 || (tick != 0.0 && step_order < -4.0) {
            let digits = (order - step_order).max(0.0) as usize;
            return format!("{tick:.digits$e}");
        }
        Decimal::<5>(tick).to_string()
    }
}

/// The rectangle between the axes.
pub(super) struct Area {
    pub(super) min: Point,
    pub(super) max: Point,
    pub(super) x: Axis,
    pub(super) y: Axis,
}

impl Area {
    fn place(&self, [x, y]: Point) -> Point {
        let between =
            |axis: usize, part: f64| self.min[axis] + part * (self.max[axis] - self.min[axis]);
        [between(0, self.x.part(x)), between(1, 1.0 - self.y.part(y))]
    }

    pub(super) fn draw_axes(&self, canvas: &mut dyn Canvas) {
        let (min, max) = (self.min, self.max);
        for tick in self.y.ticks() {
            let y = self.place([self.x.min, tick])[1].round();
            canvas.line([min[0], y], [max[0], y], 1.0, GRID);
            let position = [min[0] - TICK_GAP, y + TICK_SIZE / 2.0];
            canvas.text(&self.y.label(tick), position, TICK_SIZE, Align::Right, INK);
        }
        let later = self.x.ticks().filter(|&tick| tick > 1.0);
        for tick in std::iter::once(1.0).chain(later) {
            let x = self.place([tick, self.y.min])[0].round();
            canvas.line([x, max[1]], [x, max[1] + 4.0], 1.0, AXIS);
            let position = [x, max[1] + TICK_GAP + TICK_SIZE];
            canvas.text(&self.x.label(tick), position, TICK_SIZE, Align::Center, INK);
        }
        canvas.stroke(Shape::Polyline(&[min, [min[0], max[1]], max]), 1.0, AXIS);
    }

    /// Draws a line through `values`, interrupted at non-finite values.
    pub(super) fn draw_line(
        &self,
        canvas: &mut dyn Canvas,
        values: &[f64],
        width: f64,
        color: Color,
    ) {
        let points: Vec<Point> = (1_u32..)
            .zip(values)
            .map(|(x, &y)| [f64::from(x), y])
            .collect();
        for run in points.split(|&[_, y]| !is_drawn(y)) {
            let run: Vec<Point> = self
                .thin(run)
                .into_iter()
                .map(|point| self.place(point))
                .collect();
            match run[..] {
                [] => {}
                [only] => canvas.circle(only, width, color),
                _ => canvas.stroke(Shape::Polyline(&run), width, color),
            }
        }
    }

    /// If points are much denser than pixels, returns only the lowest and the highest point of each
    /// group.
    fn thin(&self, points: &[Point]) -> Vec<Point> {
        let columns = ((self.max[0] - self.min[0]) * f64::from(PNG_SCALE)) as usize;
        let group = points.len() / columns;
        if group <= 2 {
            return points.to_vec();
        }
        let extremes = |group: &[Point]| {
            let (mut low, mut high) = (group[0], group[0]);
            for &point in group {
                low = if point[1] < low[1] { point } else { low };
                high = if point[1] > high[1] { point } else { high };
            }
            if low[0] < high[0] {
                [low, high]
            } else {
                [high, low]
            }
        };
        points.chunks(group).flat_map(extremes).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ticks(min: f64, max: f64) -> Vec<String> {
        let axis = Axis::new(min, max, 0.0);
        axis.ticks().map(|tick| axis.label(tick)).collect()
    }

    #[test]
    fn ticks_are_round() {
        assert_eq!(ticks(-5.0, 525.0), ["0", "100", "200", "300", "400", "500"]);
        assert_eq!(ticks(0.0, 1.0), ["0", "0.2", "0.4", "0.6", "0.8", "1"]);
        assert_eq!(
            ticks(-0.02, 0.03),
            ["-0.02", "-0.01", "0", "0.01", "0.02", "0.03"]
        );
        assert_eq!(
            ticks(1e7, 1.5e7),
            ["1.0e7", "1.1e7", "1.2e7", "1.3e7", "1.4e7", "1.5e7"]
        );
        assert_eq!(
            ticks(0.0, 3e-6),
            [
                "0", "5e-7", "1.0e-6", "1.5e-6", "2.0e-6", "2.5e-6", "3.0e-6"
            ]
        );
        assert_eq!(
            Axis::new(1.0, 3.0, 1.0).ticks().collect::<Vec<_>>(),
            [1.0, 2.0, 3.0]
        );
    }

    /// A dense line keeps its lowest and highest points, in order.
    #[test]
    fn a_dense_line_keeps_its_extremes() {
        let area = Area {
            x: Axis::new(1.0, 1000.0, 0.0),
            y: Axis::new(0.0, 1.0, 0.0),
            min: [0.0, 0.0],
            max: [5.0, 5.0],
        };
        let columns = 5.0 * f64::from(PNG_SCALE);
        let points: Vec<Point> = (0..1000)
            .map(|i| [f64::from(i), f64::from(i * 7919 % 1009) - 1000.0])
            .collect();
        let thin = area.thin(&points);
        let group = (1000.0 / columns) as usize;
        let expected: Vec<Point> = points
            .chunks(group)
            .flat_map(|group| {
                let by_height = |a: &&Point, b: &&Point| a[1].total_cmp(&b[1]);
                let ends = [
                    group.iter().min_by(by_height),
                    group.iter().max_by(by_height),
                ];
                let mut ends = ends.map(|end| *end.unwrap());
                ends.sort_by(|a, b| a[0].total_cmp(&b[0]));
                ends
            })
            .collect();
        assert_eq!(thin, expected);
    }

    #[test]
    fn long_runs_are_thinned_but_keep_their_extremes() {
        let area = Area {
            min: [0.0; 2],
            max: [10.0; 2],
            x: Axis::new(0.0, 1.0, 0.0),
            y: Axis::new(0.0, 1.0, 0.0),
        };
        let points: Vec<Point> = (0..1000)
            .map(|i| [f64::from(i), if i == 537 { 9.0 } else { f64::from(i % 2) }])
            .collect();
        let thin = area.thin(&points);
        assert_eq!(thin.len(), 40);
        assert!(thin.contains(&[537.0, 9.0]) && thin.is_sorted_by(|a, b| a[0] < b[0]));
        assert_eq!(area.thin(&points[..50]), points[..50]);
    }
}
