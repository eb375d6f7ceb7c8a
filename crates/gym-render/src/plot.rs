//! Line plots of training runs, as SVG and PNG.
//!
//! Plots are drawn on this project's [`Canvas`], so that one drawing gives both formats. (The usual
//! library, `plotters`, needs a font file to draw text as pixels.)

mod axes;
mod series;

use std::path::Path;

use gym_core::Result;
use gym_core::canvas::{Align, Canvas, Color, Transform};
use gym_core::render::{Frame, Painter};

use crate::{Raster, font, png, write_svg};
use axes::{Area, Axis};
use series::{moving_average, padded};

/// The width of a plot.
const WIDTH: u32 = 800;
/// The height of the area between the axes.
const AREA_HEIGHT: u32 = 310;
/// Pixels of a PNG per unit of the drawing.
const PNG_SCALE: u32 = 2;
/// Margins around the axes, and the heights of title and legend.
const TOP: u32 = 20;
const TITLE_HEIGHT: u32 = 34;
const LEGEND_HEIGHT: u32 = 22;
const RIGHT: f64 = 30.0;
const BOTTOM: u32 = 60;
const LEFT: f64 = 40.0;
/// Heights of capital letters.
const TITLE_SIZE: f64 = 14.0;
const LABEL_SIZE: f64 = 10.0;
const TICK_SIZE: f64 = 8.5;
/// The distance between a tick's label and its axis.
const TICK_GAP: f64 = 10.0;
/// The length of a line in the legend, and the gap beside it.
const LEGEND_SAMPLE: f64 = 22.0;
const LEGEND_GAP: f64 = 8.0;
/// The approximate number of ticks along each axis.
const TICKS: f64 = 6.0;
/// The unused fractions of the axes: on the left and right, and above and below.
const PADDING: [f64; 2] = [0.015, 0.05];
/// Larger values are skipped, like NaN.
const LARGEST: f64 = 1e300;

const INK: Color = Color::rgb(50, 50, 50);
const AXIS: Color = Color::rgb(130, 130, 130);
const GRID: Color = Color::rgb(232, 232, 232);
/// The colours of Okabe and Ito, "Color Universal Design" (2008). Colour-blind people can
/// distinguish these colours.
const COLORS: [Color; 6] = [
    Color::rgb(0, 114, 178),
    Color::rgb(213, 94, 0),
    Color::rgb(0, 158, 115),
    Color::rgb(204, 121, 167),
    Color::rgb(230, 159, 0),
    Color::rgb(86, 180, 233),
];
/// The alpha of the values if their average is drawn too.
const FAINT: u8 = 70;

/// A line plot of one value per episode (such as its return or its length) for one or more runs.
///
/// ```
/// use gym_render::Plot;
///
/// # let path = std::env::temp_dir().join(format!("gym-render-doc-{}.svg", std::process::id()));
/// let plot = Plot::new("CartPole-v1")
///     .y_label("return")
///     .series("seed 1", &[12.0, 30.0, 25.0, 60.0])
///     .series("seed 2", &[9.0, 14.0, 41.0, 38.0])
///     .moving_average(2);
/// plot.write_svg(&path)?;
/// # std::fs::remove_file(path).unwrap();
/// # Ok::<(), gym_core::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Plot {
    title: String,
    x_label: String,
    y_label: String,
    series: Vec<(String, Vec<f64>)>,
    window: usize,
    /// The plots below this one; their own `below` is empty.
    below: Vec<Plot>,
}

impl Plot {
    /// Makes a plot without series.
    pub fn new(title: impl Into<String>) -> Self {
        Self {
            title: title.into(),
            x_label: "episode".into(),
            y_label: String::new(),
            series: Vec::new(),
            window: 1,
            below: Vec::new(),
        }
    }

    /// Makes a plot of returns and, below it, a plot of lengths for one or more runs (name,
    /// returns, lengths), with moving averages over `window` episodes.
    pub fn episodes<'a>(
        title: impl Into<String>,
        window: usize,
        runs: impl IntoIterator<Item = (&'a str, &'a [f64], &'a [f64])>,
    ) -> Self {
        let plots = [
            Self::new(title).y_label("return"),
            Self::new("").y_label("length"),
        ];
        let [returns, lengths] = plots.map(|plot| plot.moving_average(window));
        let both = runs.into_iter().fold(
            (returns, lengths),
            |(above, below), (name, returns, lengths)| {
                // an empty name has no entry in the legend: only the upper plot has a legend
                (above.series(name, returns), below.series("", lengths))
            },
        );
        both.0.below(both.1)
    }

    /// Sets the unit that is counted from 1 along the horizontal axis; the default is `episode`.
    #[must_use]
    pub fn x_label(self, label: impl Into<String>) -> Self {
        Self {
            x_label: label.into(),
            ..self
        }
    }

    /// Sets the meaning of the values.
    #[must_use]
    pub fn y_label(self, label: impl Into<String>) -> Self {
        Self {
            y_label: label.into(),
            ..self
        }
    }

    /// Adds a run: its name for the legend (may be empty) and its values in order. Non-finite
    /// values are skipped.
    #[must_use]
    pub fn series(mut self, name: impl Into<String>, values: &[f64]) -> Self {
        self.series.push((name.into(), values.to_vec()));
        self
    }

    /// Also draws the mean of the last `window` values, with the values themselves faint; 1 or 0
    /// draws only the values.
    #[must_use]
    pub fn moving_average(self, window: usize) -> Self {
        Self { window, ..self }
    }

    /// Puts another plot below this one and the plots already below it, in the same image.
    #[must_use]
    pub fn below(mut self, mut plot: Self) -> Self {
        let further = std::mem::take(&mut plot.below);
        self.below.push(plot);
        self.below.extend(further);
        self
    }

    /// Iterates over this plot and the plots below it.
    fn all(&self) -> impl Iterator<Item = &Self> {
        std::iter::once(self).chain(&self.below)
    }

    /// Returns width and height of the drawing.
    pub fn size(&self) -> (u32, u32) {
        (
            WIDTH,
            self.all().map(Self::height).fold(0, u32::saturating_add),
        )
    }

    /// Draws all plots.
    pub fn draw(&self, canvas: &mut dyn Canvas) {
        canvas.clear(Color::WHITE);
        let mut top = 0.0;
        for plot in self.all() {
            canvas.push(Transform::translate(0.0, top));
            plot.draw_one(canvas);
            canvas.pop();
            top += f64::from(plot.height());
        }
    }

    /// Writes the plot to an SVG file.
    ///
    /// # Errors
    /// [`Error::Io`](gym_core::Error::Io) if the file cannot be written.
    pub fn write_svg(&self, path: impl AsRef<Path>) -> Result<()> {
        write_svg(path, self.size(), |canvas| self.draw(canvas))
    }

    /// Writes the plot to a PNG file, at twice its [`size`](Plot::size) in pixels.
    ///
    /// # Errors
    /// [`Error::Io`](gym_core::Error::Io) if the file cannot be written,
    /// [`Error::InvalidArgument`](gym_core::Error::InvalidArgument) if there are too many plots for
    /// a PNG.
    pub fn write_png(&self, path: impl AsRef<Path>) -> Result<()> {
        let height = self.size().1.saturating_mul(PNG_SCALE);
        // one frame per plot: a shape takes longer to draw in a larger frame, and a frame of all
        // plots may not fit in memory
        let frames = self.all().map(Self::frame);
        png::write_stack(path.as_ref(), (WIDTH * PNG_SCALE, height), frames)
    }

    /// Draws this plot alone, at the size of a PNG.
    fn frame(&self) -> Result<Frame> {
        let mut frame = Frame::new(WIDTH * PNG_SCALE, self.height().saturating_mul(PNG_SCALE))?;
        let mut draw = |canvas: &mut dyn Canvas| {
            canvas.clear(Color::WHITE);
            self.draw_one(canvas);
        };
        Raster::new().paint((WIDTH, self.height()), &mut draw, &mut frame);
        Ok(frame)
    }

    /// Returns the height of this plot alone.
    fn height(&self) -> u32 {
        self.area_top() + AREA_HEIGHT + BOTTOM
    }

    fn area_top(&self) -> u32 {
        let title = if self.title.is_empty() {
            0
        } else {
            TITLE_HEIGHT
        };
        TOP + title + LEGEND_HEIGHT * self.legend().len() as u32
    }

    fn draw_one(&self, canvas: &mut dyn Canvas) {
        let (top, bottom) = (f64::from(self.area_top()), f64::from(self.height()));
        let area = self.area(top);
        area.draw_axes(canvas);
        let series = || self.series.iter().map(|(_, values)| values).zip(colors());
        if self.window > 1 {
            series().for_each(|(values, color)| {
                area.draw_line(canvas, values, 1.0, color.alpha(FAINT));
            });
            for (values, color) in series() {
                area.draw_line(canvas, &moving_average(values, self.window), 2.0, color);
            }
        } else {
            series().for_each(|(values, color)| area.draw_line(canvas, values, 1.5, color));
        }
        let middle = |axis: usize| f64::midpoint(area.min[axis], area.max[axis]);
        let title_line = f64::from(TOP) + TITLE_SIZE;
        canvas.text(
            &self.title,
            [middle(0), title_line],
            TITLE_SIZE,
            Align::Center,
            INK,
        );
        canvas.text(
            &self.x_label,
            [middle(0), bottom - 16.0],
            LABEL_SIZE,
            Align::Center,
            INK,
        );
        // turned by 90°: the text runs upwards
        canvas.push(Transform {
            x: [0.0, -1.0],
            y: [1.0, 0.0],
            origin: [25.0, middle(1)],
        });
        canvas.text(&self.y_label, [0.0, 0.0], LABEL_SIZE, Align::Center, INK);
        canvas.pop();
        for (row, line) in self.legend().iter().rev().zip(1_u32..) {
            draw_legend_row(
                canvas,
                row,
                middle(0),
                top - f64::from(line * LEGEND_HEIGHT),
            );
        }
    }

    /// Returns the ranges of both axes, and the area between them.
    fn area(&self, top: f64) -> Area {
        let count = self
            .series
            .iter()
            .map(|(_, values)| values.len())
            .max()
            .unwrap_or(0)
            .max(2) as f64;
        let space = PADDING[0] * (count - 1.0);
        let x = Axis::new(1.0 - space, count + space, 1.0);
        let (min, max) = padded(self.series.iter().flat_map(|(_, values)| values).copied());
        let y = Axis::new(min, max, 0.0);
        let labels = y
            .ticks()
            .map(|tick| font::text_width(&y.label(tick), TICK_SIZE))
            .fold(0.0, f64::max);
        // with an integer `left`, grid lines are sharp
        let left = (LEFT + labels + TICK_GAP).ceil();
        Area {
            min: [left, top],
            max: [f64::from(WIDTH) - RIGHT, top + f64::from(AREA_HEIGHT)],
            x,
            y,
        }
    }

    /// Returns the names and colours of the series, in rows that fit into the plot's width.
    fn legend(&self) -> Vec<Vec<(&str, Color)>> {
        let mut rows: Vec<Vec<_>> = Vec::new();
        let mut free = 0.0;
        for ((name, _), color) in self
            .series
            .iter()
            .zip(colors())
            .filter(|((name, _), _)| !name.is_empty())
        {
            free -= legend_width(name);
            match rows.last_mut() {
                Some(row) if free >= 0.0 => row.push((name.as_str(), color)),
                _ => {
                    free = f64::from(WIDTH) - LEFT - RIGHT - legend_width(name);
                    rows.push(vec![(name.as_str(), color)]);
                }
            }
        }
        rows
    }
}

fn colors() -> impl Iterator<Item = Color> {
    COLORS.into_iter().cycle()
}

/// Returns the width of a legend entry: line, name and gaps.
fn legend_width(name: &str) -> f64 {
    LEGEND_SAMPLE + 3.0 * LEGEND_GAP + font::text_width(name, TICK_SIZE)
}

/// Draws a centred row of the legend.
fn draw_legend_row(canvas: &mut dyn Canvas, row: &[(&str, Color)], middle: f64, top: f64) {
    let total: f64 = row.iter().map(|(name, _)| legend_width(name)).sum();
    let mut left = middle - total / 2.0 + LEGEND_GAP;
    for &(name, color) in row {
        let height = top + TICK_SIZE / 2.0;
        canvas.line([left, height], [left + LEGEND_SAMPLE, height], 3.0, color);
        let position = [left + LEGEND_SAMPLE + LEGEND_GAP, top + TICK_SIZE];
        canvas.text(name, position, TICK_SIZE, Align::Left, INK);
        left += legend_width(name);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::DrawLog;
    use crate::number::Decimal;

    const AXES: &str = r#"clear #ffffff
push x=1,0 y=0,1 origin=0,0
  stroke polyline 67,372 770,372 width=1 #e8e8e8
  text "0" 57,376.25 size=8.5 right #323232
  stroke polyline 67,301 770,301 width=1 #e8e8e8
  text "0.5" 57,305.25 size=8.5 right #323232
  stroke polyline 67,231 770,231 width=1 #e8e8e8
  text "1" 57,235.25 size=8.5 right #323232
  stroke polyline 67,161 770,161 width=1 #e8e8e8
  text "1.5" 57,165.25 size=8.5 right #323232
  stroke polyline 67,90 770,90 width=1 #e8e8e8
  text "2" 57,94.25 size=8.5 right #323232
  stroke polyline 77,386 77,390 width=1 #828282
  text "1" 77,404.5 size=8.5 center #323232
  stroke polyline 419,386 419,390 width=1 #828282
  text "2" 419,404.5 size=8.5 center #323232
  stroke polyline 760,386 760,390 width=1 #828282
  text "3" 760,404.5 size=8.5 center #323232
  stroke polyline 67,76 67,386 770,386 width=1 #828282
  stroke polyline 77.238,371.909 418.5,231 759.762,90.091 width=1.5 #0072b2
  text "title" 418.5,34 size=14 center #323232
  text "across" 418.5,430 size=10 center #323232
  push x=0,-1 y=1,0 origin=25,231
    text "up" 0,0 size=10 center #323232
  pop
  stroke polyline 400.844,58.25 422.844,58.25 width=3 #0072b2
  text "a" 430.844,62.5 size=8.5 left #323232
pop
"#;

    #[test]
    fn plots_draw_their_series_in_their_places() {
        let plot = Plot::new("t")
            .series("a", &[0.0, 10.0, 5.0])
            .series("", &[1.0, f64::NAN, 2.0, 3.0]);
        let text = DrawLog::of(|canvas| plot.draw(canvas)).to_string();
        // the area between the axes starts at 20 + 34 + 22 and is 310 high, from 10.5 to -0.5
        let y = Decimal::<3>(76.0 + 310.0 * 0.5 / 11.0);
        assert!(text.contains(&format!(",{y} ")), "{text}");
        assert_eq!(text.matches("#0072b2").count(), 2, "line and legend");
        assert_eq!(
            text.matches("#d55e00").count(),
            2,
            "a dot and the rest of the line"
        );
        assert_eq!(text.matches("fill circle").count(), 1);
        assert!(
            text.contains("text \"episode\"")
                && text.contains("text \"a\"")
                && !text.contains("text \"\" 0,0 size=8.5")
        );
    }

    /// The drawing calls of a plot: after an intended change, look at a plot before you change the
    /// expected calls.
    #[test]
    fn axes_have_their_lines_and_labels() {
        let plot = Plot::new("title")
            .x_label("across")
            .y_label("up")
            .series("a", &[0.0, 1.0, 2.0]);
        let text = DrawLog::of(|canvas| plot.draw(canvas)).to_string();
        assert_eq!(text, AXES);
    }

    #[test]
    fn plots_stack() {
        let plot = || Plot::new("").series("a", &[1.0]);
        let (width, height) = plot().size();
        assert_eq!(
            plot().below(plot()).below(plot()).size(),
            (width, 3 * height)
        );
        let text = DrawLog::of(|canvas| plot().below(plot()).draw(canvas)).to_string();
        assert!(text.contains(&format!("origin=0,{height}")) && text.matches("clear").count() == 1);
    }

    /// An image of many plots contains each plot's own pixels, below each other.
    #[test]
    fn a_picture_of_many_plots_is_one_of_each() {
        let folder = tempfile::TempDir::new().unwrap();
        let plot =
            |seed: i32| Plot::new(format!("{seed}")).series("a", &[f64::from(seed), 3.0, 1.0]);
        let pixels = |name: &str, plot: &Plot| {
            let path = folder.path().join(name);
            plot.write_png(&path).unwrap();
            let decoder =
                ::png::Decoder::new(std::io::BufReader::new(std::fs::File::open(path).unwrap()));
            let mut reader = decoder.read_info().unwrap();
            let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
            reader.next_frame(&mut pixels).unwrap();
            pixels
        };
        let three = plot(1).below(plot(2).below(plot(4)));
        let one_by_one = [1, 2, 4].map(|seed| pixels("one.png", &plot(seed)));
        assert_eq!(pixels("three.png", &three), one_by_one.concat());
        // the whole drawing on one frame, as in an SVG
        let whole = crate::frame(three.size(), |canvas| three.draw(canvas)).unwrap();
        assert_eq!(three.size().1 * WIDTH * 3, whole.pixels().len() as u32);
        // many plots do not overflow the stack
        let many = (0..100_000).fold(Plot::new(""), |plot, _| plot.below(Plot::new("")));
        assert_eq!(many.size().1, 100_001 * Plot::new("").size().1);
    }

    #[test]
    fn episodes_show_returns_above_lengths() {
        let runs = [
            ("one", &[1.0, 2.0][..], &[10.0, 20.0][..]),
            ("two", &[3.0, 4.0], &[30.0, 40.0]),
        ];
        let plot = Plot::episodes("t", 2, runs);
        let text = DrawLog::of(|canvas| plot.draw(canvas)).to_string();
        let place = |what: &str| text.find(what).unwrap_or_else(|| panic!("{what}: {text}"));
        assert!(place("\"return\"") < place("\"length\""));
        assert_eq!(
            (
                text.matches("\"one\"").count(),
                text.matches("\"two\"").count()
            ),
            (1, 1)
        );
        // above: legend, faint line and average; below: line and average
        assert_eq!(text.matches("#0072b2").count(), 5);
    }

    #[test]
    fn the_legend_wraps_and_leaves_out_the_nameless() {
        let plot = (0..30).fold(Plot::new(""), |plot, i| {
            plot.series(format!("seed {i}"), &[1.0])
        });
        let rows = plot
            .series("", &[1.0])
            .legend()
            .iter()
            .map(Vec::len)
            .collect::<Vec<_>>();
        assert_eq!(rows.iter().sum::<usize>(), 30);
        assert!(rows.len() > 2 && rows[0] > 5, "{rows:?}");
        assert_eq!(Plot::new("").series("", &[1.0]).legend().len(), 0);
    }

    #[test]
    fn odd_plots_do_not_fail() {
        for values in [
            &[][..],
            &[f64::NAN],
            &[f64::MAX, f64::MIN],
            &[1e300, -1e300],
            &[1e17, 1e17 + 16.0],
            &[5e-324],
        ] {
            let plot = Plot::new("").series("x", values).moving_average(0);
            assert!(
                DrawLog::of(|canvas| plot.draw(canvas)).to_string().len() < 20_000,
                "{values:?}"
            );
        }
        DrawLog::of(|canvas| Plot::new("").draw(canvas));
    }
}
