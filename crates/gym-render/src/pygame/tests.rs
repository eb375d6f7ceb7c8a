//! Comparison with recordings of pygame-ce 2.5.8 in `tests/pygame`.

use gym_core::canvas::{Canvas, Color, Point, Primitive};
use gym_core::pygame::flipped;
use gym_core::render::{Frame, Painter};
use serde::Deserialize;
use serde_json::Value as Json;

use super::smoothscale::phases;
use super::{RgbPixels, paint};

/// Reads the file of cases `name`.
fn cases<T: for<'a> Deserialize<'a>>(name: &str) -> Vec<T> {
    #[derive(Deserialize)]
    struct File<T> {
        cases: Vec<T>,
    }
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/pygame");
    let text = std::fs::read_to_string(format!("{folder}/{name}.json")).unwrap();
    serde_json::from_str::<File<T>>(&text).unwrap().cases
}

/// Returns pseudorandom bytes.
fn noise(seed: u32) -> impl Iterator<Item = u8> {
    let next = |x: &u32| Some(x.wrapping_mul(1_664_525).wrapping_add(1_013_904_223));
    std::iter::successors(next(&seed), next).map(|x| (x >> 16) as u8)
}

/// The arguments of a call, with pygame's names.
#[derive(Deserialize)]
struct Case {
    size: (u32, u32),
    background: Json,
    color: [u8; 3],
    #[serde(default)]
    points: Vec<Point>,
    #[serde(default)]
    center: Point,
    #[serde(default)]
    radius: f64,
    #[serde(default)]
    x: f64,
    #[serde(default)]
    x1: f64,
    #[serde(default)]
    x2: f64,
    #[serde(default)]
    y: f64,
    #[serde(default)]
    y1: f64,
    #[serde(default)]
    y2: f64,
    crc32: u32,
}

impl Case {
    fn picture(&self) -> Frame {
        let mut frame = Frame::new(self.size.0, self.size.1).unwrap();
        match &self.background {
            Json::String(name) => {
                let seed = name.strip_prefix("noise:").unwrap().parse().unwrap();
                frame
                    .pixels_mut()
                    .iter_mut()
                    .zip(noise(seed))
                    .for_each(|(pixel, byte)| *pixel = byte);
            }
            color => {
                let color: [u8; 3] = serde_json::from_value(color.clone()).unwrap();
                frame
                    .pixels_mut()
                    .chunks_exact_mut(3)
                    .for_each(|pixel| pixel.copy_from_slice(&color));
            }
        }
        frame
    }

    fn color(&self) -> Color {
        let [r, g, b] = self.color;
        Color::rgb(r, g, b)
    }
}

/// Draws every case and counts the differing ones.
fn check(name: &str, cases: &[Case], primitive: impl Fn(&Case) -> Primitive<'_>) {
    assert!(!cases.is_empty());
    let differ = cases.iter().enumerate().filter(|(_, case)| {
        let mut frame = case.picture();
        let mut pixels = RgbPixels::new(&mut frame, 0, false);
        paint(&mut pixels, &primitive(case), case.color());
        crc32fast::hash(frame.pixels()) != case.crc32
    });
    let differ: Vec<usize> = differ.map(|(i, _)| i).collect();
    assert!(
        differ.is_empty(),
        "{name}: {} of {} cases differ: {differ:?}",
        differ.len(),
        cases.len()
    );
}

#[test]
fn gfxdraw_draws_what_pygame_drew() {
    let polygons: Vec<Case> = cases("gfxdraw.aapolygon");
    check("aapolygon", &polygons, |case| {
        Primitive::AaPolygon(&case.points)
    });
    let polygons: Vec<Case> = cases("gfxdraw.filled_polygon");
    check("filled_polygon", &polygons, |case| {
        Primitive::FilledPolygon(&case.points)
    });
    let circles: Vec<Case> = cases("gfxdraw.aacircle");
    check("aacircle", &circles, |&Case { center, radius, .. }| {
        Primitive::AaCircle { center, radius }
    });
    let circles: Vec<Case> = cases("gfxdraw.filled_circle");
    check(
        "filled_circle",
        &circles,
        |&Case { center, radius, .. }| Primitive::FilledCircle { center, radius },
    );
    let lines: Vec<Case> = cases("gfxdraw.hline");
    check("hline", &lines, |&Case { x1, x2, y, .. }| {
        Primitive::HLine { x1, x2, y }
    });
    let lines: Vec<Case> = cases("gfxdraw.vline");
    check("vline", &lines, |&Case { x, y1, y2, .. }| {
        Primitive::VLine { x, y1, y2 }
    });
}

#[test]
fn draw_draws_what_pygame_drew() {
    let polygons: Vec<Case> = cases("draw.polygon");
    check("polygon", &polygons, |case| {
        Primitive::Polygon(&case.points)
    });
    for (name, width, closed, cases) in [
        ("polygon of width 1", 1, true, cases("draw.polygon_width1")),
        ("line", 1, false, cases("draw.line_width1")),
        ("lines of width 2", 2, false, cases("draw.lines_width2")),
    ] {
        check(name, &cases, |case| Primitive::Lines {
            points: &case.points,
            closed,
            width,
        });
    }
    let circles: Vec<Case> = cases("draw.circle");
    check("circle", &circles, |&Case { center, radius, .. }| {
        Primitive::Circle { center, radius }
    });
    for (name, closed, cases) in [
        ("aaline", false, cases("draw.aaline")),
        ("aalines, open", false, cases("draw.aalines_open")),
        ("aalines, closed", true, cases("draw.aalines_closed")),
    ] {
        check(name, &cases, |case| Primitive::AaLines {
            points: &case.points,
            closed,
        });
    }
}

/// A polygon of height 0 is a row of pixels, from the leftmost point to the rightmost.
#[test]
fn a_flat_polygon_is_a_line() {
    for points in [
        &[[5.0, 2.0], [1.0, 2.0], [3.0, 2.0], [4.0, 2.0]][..],
        &[[1.0, 2.0]; 5],
        &[[2.0, 2.0], [6.0, 2.0]],
    ] {
        let mut frame = Frame::new(8, 4).unwrap();
        paint(
            &mut RgbPixels::new(&mut frame, 0, false),
            &Primitive::Polygon(points),
            Color::rgb(255, 255, 255),
        );
        let drawn = |i: &usize| frame.pixels()[3 * i] != 0;
        let drawn: Vec<usize> = (0..32).filter(drawn).collect();
        let xs = || points.iter().map(|[x, _]| *x as usize);
        let expected: Vec<usize> = (16 + xs().min().unwrap()..=16 + xs().max().unwrap()).collect();
        assert_eq!(drawn, expected, "{points:?}");
    }
}

#[test]
fn rotate_rad_turns_as_pygame_did() {
    #[derive(Deserialize)]
    struct Turn {
        from: Point,
        angle: f64,
        to: Point,
    }
    for Turn { from, angle, to } in cases("vector2.rotate_rad") {
        let turned = gym_core::pygame::rotate_rad(from, angle);
        assert_eq!(turned, to, "{from:?} {angle}");
    }
}

/// Reduces one row or column.
fn shrink(samples: impl Fn(usize) -> u8, from: usize, to: usize) -> Vec<u8> {
    if from == to {
        return (0..to).map(samples).collect();
    }
    let at = |i: usize| u16::from(samples(i));
    let mean = |phase: super::Phase| {
        let whole = (phase.begin..phase.last).fold(0, |sum: u16, i| sum.wrapping_add(at(i)));
        phase.mean(at(phase.first), whole, at(phase.last))
    };
    phases(from, to).into_iter().map(mean).collect()
}

#[test]
fn smoothscale_shrinks_as_pygame_did() {
    #[derive(Deserialize)]
    struct Case {
        from: [usize; 2],
        to: [usize; 2],
        seed: u32,
        blocks: bool,
        #[serde(rename = "crc32_SSE2")]
        crc32: u32,
    }
    for Case {
        from: [w, h],
        to: [w2, h2],
        seed,
        blocks,
        crc32,
    } in cases("transform.smoothscale")
    {
        let bytes: Vec<u8> = noise(seed).take(w * h * 4).collect();
        let source = |x: usize, y: usize, channel: usize| {
            let (x, y, w) = if blocks {
                (x / 8, y / 8, w.div_ceil(8))
            } else {
                (x, y, w)
            };
            bytes[(y * w + x) * 4 + channel]
        };
        let mut scaled = vec![0; w2 * h2 * 4];
        for channel in 0..4 {
            let narrow: Vec<Vec<u8>> = (0..h)
                .map(|y| shrink(|x| source(x, y, channel), w, w2))
                .collect();
            for x in 0..w2 {
                for (y, value) in shrink(|y| narrow[y][x], h, h2).into_iter().enumerate() {
                    scaled[(y * w2 + x) * 4 + channel] = value;
                }
            }
        }
        assert_eq!(
            crc32fast::hash(&scaled),
            crc32,
            "{w}x{h} to {w2}x{h2}, seed {seed}, blocks {blocks}"
        );
    }
}

/// Reduces a whole image.
fn smoothscale(frame: &Frame, (width, height): (u32, u32)) -> Frame {
    let [w, h, w2, h2] = [frame.width(), frame.height(), width, height].map(|side| side as usize);
    let mut scaled = Frame::new(width, height).unwrap();
    for channel in 0..3 {
        let at = |x: usize, y: usize| frame.pixels()[(y * w + x) * 3 + channel];
        let narrow: Vec<Vec<u8>> = (0..h).map(|y| shrink(|x| at(x, y), w, w2)).collect();
        let columns = (0..w2).map(|x| shrink(|y| narrow[y][x], h, h2));
        for (x, column) in columns.enumerate() {
            for (y, value) in column.into_iter().enumerate() {
                scaled.pixels_mut()[(y * w2 + x) * 3 + channel] = value;
            }
        }
    }
    scaled
}

/// A function that draws on a surface.
type Paint<'a> = dyn FnMut(Primitive<'_>, Color) + 'a;

/// Whether a surface drawn and reduced in bands gives the same frame as a surface drawn whole.
fn shrinks_as_whole(
    raster: &mut crate::Raster,
    from: (u32, u32),
    to: (u32, u32),
    draw: &dyn Fn(&mut Paint<'_>),
) -> bool {
    let mut whole = Frame::new(from.0, from.1).unwrap();
    draw(&mut |primitive, color| {
        paint(&mut RgbPixels::new(&mut whole, 0, true), &primitive, color);
    });
    let mut frame = Frame::new(to.0, to.1).unwrap();
    let mut draw_in = |canvas: &mut dyn Canvas| {
        canvas.push_smoothscaled(from, to);
        canvas.push(flipped(f64::from(from.1)));
        draw(&mut |primitive, color| canvas.pygame(primitive, color));
        canvas.pop();
        canvas.pop();
    };
    raster.paint(to, &mut draw_in, &mut frame);
    frame == smoothscale(&whole, to)
}

#[test]
fn a_surface_that_is_never_whole_is_shrunk_as_one_that_is() {
    let mut raster = crate::Raster::new();
    for (seed, (from, to)) in (0..).zip([
        ((250, 200), (150, 100)),
        ((250, 200), (24, 24)),
        ((64, 200), (63, 20)),
        ((90, 90), (30, 30)),
    ]) {
        for picture in 0..12 {
            let mut bytes = noise(97 * seed + picture);
            let mut next = |range: f64| f64::from(bytes.next().unwrap_or_default()) / 255.0 * range;
            let shapes: Vec<_> = (0..3 * picture)
                .map(|_| {
                    let points = [(); 4].map(|()| [next(2.0) - 0.5, next(2.0) - 0.5]);
                    let scale = |[x, y]: Point| [x * f64::from(from.0), y * f64::from(from.1)];
                    // few colours, so that adjacent shapes often have the same colour
                    let color = [next(255.0), next(255.0), next(255.0)].map(|x| x as u8 & 0x80);
                    (points.map(scale), color, next(17.0) as usize)
                })
                .collect();
            let draw = |paint: &mut Paint<'_>| {
                for (points, [r, g, b], kind) in &shapes {
                    let color = Color::rgb(*r, *g, *b);
                    let [[x1, y1], [x2, y2], ..] = *points;
                    let (center, radius) = ([x1, y1], (x2 - x1).abs() / 4.0);
                    // also too few points for a line or an area
                    let few = &points[..kind % 3];
                    match kind {
                        0 => paint(Primitive::Polygon(points), color),
                        1 => paint(
                            Primitive::Lines {
                                points,
                                closed: false,
                                width: 2,
                            },
                            color,
                        ),
                        2 => paint(Primitive::HLine { x1, x2, y: y1 }, color),
                        3 => paint(Primitive::VLine { x: x1, y1, y2 }, color),
                        4 => paint(Primitive::AaCircle { center, radius }, color),
                        5 => paint(Primitive::FilledCircle { center, radius }, color),
                        6 => paint(Primitive::Circle { center, radius }, color),
                        7 => paint(
                            Primitive::AaLines {
                                points,
                                closed: true,
                            },
                            color,
                        ),
                        8 => paint(
                            Primitive::AaLines {
                                points,
                                closed: false,
                            },
                            color,
                        ),
                        9..12 => {
                            paint(
                                Primitive::AaLines {
                                    points: few,
                                    closed: true,
                                },
                                color,
                            );
                            paint(
                                Primitive::AaLines {
                                    points: few,
                                    closed: false,
                                },
                                color,
                            );
                            paint(
                                Primitive::Lines {
                                    points: few,
                                    closed: true,
                                    width: 1,
                                },
                                color,
                            );
                            paint(Primitive::Polygon(few), color);
                            paint(Primitive::AaPolygon(few), color);
                            paint(Primitive::FilledPolygon(few), color);
                        }
                        _ => {
                            paint(Primitive::AaPolygon(points), color);
                            paint(Primitive::FilledPolygon(points), color);
                        }
                    }
                }
            };
            assert!(
                shrinks_as_whole(&mut raster, from, to, &draw),
                "{from:?} to {to:?}, picture {picture}"
            );
        }
    }
}

/// A drawn rectangle fills whole rows of the surface; a shape with one moved corner does not.
#[test]
fn a_slanting_side_covers_no_row() {
    let (from, to) = ((64, 64), (16, 16));
    let rectangle = [[-1.0, 10.0], [65.0, 10.0], [65.0, 50.0], [-1.0, 50.0]];
    let mut raster = crate::Raster::new();
    for corner in 0..4 {
        for turn in 0..4 {
            for axis in 0..2 {
                let mut points = rectangle;
                points[corner][axis] = if points[corner][axis] > 40.0 {
                    35.0
                } else {
                    20.0
                };
                points.rotate_left(turn);
                let draw = |paint: &mut Paint<'_>| {
                    paint(Primitive::FilledPolygon(&rectangle), Color::rgb(0, 200, 0));
                    paint(Primitive::FilledPolygon(&points), Color::rgb(200, 0, 0));
                };
                assert!(shrinks_as_whole(&mut raster, from, to, &draw), "{points:?}");
            }
        }
    }
}

#[test]
fn places_of_edges_are_quotients() {
    for length in (1..300).chain([1021, 4096, 29_999, 32_767, 60_000]) {
        let edge = super::Edge::new([0, -30_000], [0, length - 30_000]);
        for along in (0..=length).step_by(1 + length as usize / 300) {
            let expected = 65536_i32.wrapping_mul(along) / length;
            assert_eq!(edge.share(along - 30_000), expected, "{along} of {length}");
        }
    }
}
