//! Compares the drawing calls of each environment with `tests/drawings`.
//!
//! After an intended change, look at the images (`cargo xtask gif ID`), then store the new calls
//! with `GYM_UPDATE_KEPT=1 cargo test --package gym-tests --test it drawings`.

use std::path::Path;

use gym::canvas::{Align, Canvas, Color, Image, Point, Primitive, Segment, Shape, Transform};
use gym::render::{DrawLog, Frame, Painter, Plot, Raster};
use gym::{Env, EnvExt, Registration, registry};
use gym_testing::{Digest, kept};

#[test]
fn drawings_are_as_kept() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("drawings");
    // another engine uses the same drawing code with slightly different numbers
    let is_other_engine = |id: &str| id.starts_with("rapier/");
    // versions of a MuJoCo task look alike
    let all = registry::self_contained();
    let is_older = |registration: &Registration| {
        registration.source.package == "gym-mujoco" && !registration.id().ends_with("-v5")
    };
    // gym-minigrid compares its pictures with checksums of minigrid's, and gym-control and
    // gym-robotics draw as gym-mujoco does
    let is_grid = |registration: &gym::Registration| {
        ["gym-control", "gym-minigrid", "gym-robotics"].contains(&registration.source.package)
    };
    for registration in all
        .iter()
        .filter(|entry| !is_other_engine(entry.id()) && !is_older(entry) && !is_grid(entry))
    {
        let id = registration.id();
        let mut env = registration.spec().unwrap().make().unwrap();
        let mut actions = env.action_sampler(0).unwrap();
        env.reset(0).unwrap();
        let mut drawn = String::new();
        // at first, CarRacing's whole field is visible
        let steps = if id.starts_with("CarRacing") { 1 } else { 3 };
        for step in 0..steps {
            let log = DrawLog::of(|canvas| env.draw(canvas));
            drawn += &format!("# step {step}\n{log}\n");
            if env.step(&actions.sample()).unwrap().done() {
                env.reset(()).unwrap();
            }
        }
        // the last frame of an episode, if the episode is short
        if (0..200).any(|_| env.step(&actions.sample()).unwrap().done()) {
            drawn += &format!("# the end\n{}\n", DrawLog::of(|canvas| env.draw(canvas)));
        }
        let path = folder.join(format!("{}.txt", id.replace('/', "_")));
        kept(&path, &drawn);
    }
}

/// Pictures and texts of whole episodes, which show more states than the first steps do.
#[test]
fn whole_episodes_are_drawn_as_kept() {
    let all = registry::self_contained().into_iter();
    let is_world = |entry: &Registration| {
        entry.id().starts_with("LunarLander") || entry.id().starts_with("BipedalWalker")
    };
    let few = all.filter(|entry| {
        is_world(entry) || ["gym-classic", "gym-toytext"].contains(&entry.source.package)
    });
    let mut sums = String::new();
    for registration in few {
        let id = registration.id();
        let mut env = registration.spec().unwrap().make().unwrap();
        let mut actions = env.action_sampler(0).unwrap();
        let mut digest = Digest::default();
        // (the lander's exhaust is there for who draws; it falls for a hundred steps)
        env.frames_drawn(0);
        let (seeds, steps) = if is_world(&registration) {
            (1, 200)
        } else {
            (6, 50)
        };
        for seed in 0..seeds {
            env.reset(seed).unwrap();
            for _ in 0..steps {
                digest.bytes(
                    DrawLog::of(|canvas| env.draw(canvas))
                        .to_string()
                        .as_bytes(),
                );
                digest.bytes(env.ansi().unwrap_or_default().as_bytes());
                if env.step(&actions.sample()).unwrap().done() {
                    break;
                }
            }
        }
        sums += &format!("{id} {}\n", &digest.finish()[..16]);
    }
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("drawings");
    kept(&folder.join("episodes.txt"), &sums);
}

/// The calls of plots with every option: series in their order with their colours, averages, labels,
/// a legend of several rows, numbers of each size.
#[test]
fn plots_are_drawn_as_kept() {
    let waves = |n: usize| {
        (0..n)
            .map(|i| ((i * i) % 7) as f64 - 1.5)
            .collect::<Vec<_>>()
    };
    let few = Plot::new("few")
        .series("first", &[1.0, 4.0, 2.0, f64::NAN, 3.0])
        .series("", &[2.5])
        .series("third", &[0.5, f64::INFINITY, 0.75]);
    let averaged = Plot::new("")
        .x_label("update")
        .y_label("loss")
        .series("one", &waves(30))
        .series("two", &waves(12))
        .moving_average(5);
    let many = (0..14).fold(Plot::new("many"), |plot, seed| {
        plot.series(
            format!("a run with the seed {seed}"),
            &[f64::from(seed), 2.0],
        )
    });
    let sizes =
        [-2e5, 1e-7, 3e12, 0.0].map(|x| Plot::new("").y_label("y").series("x", &[x, 2.0 * x, x]));
    let both = Plot::episodes(
        "both",
        2,
        [
            ("run", &waves(4)[..], &[9.0, 8.0, 7.0, 1e3][..]),
            ("", &[1.0], &[]),
        ],
    );
    let all = [few, averaged, many, both].into_iter().chain(sizes);
    let drawn: String = all
        .map(|plot| {
            format!(
                "# {:?}\n{}\n",
                plot.size(),
                DrawLog::of(|canvas| plot.draw(canvas))
            )
        })
        .collect();
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("drawings");
    kept(&folder.join("plots.txt"), &drawn);
}

/// The strokes of each character, a line each, and a box for those that the font lacks.
#[test]
fn characters_are_drawn_as_kept() {
    let characters = (' '..='\u{80}').map(|character| {
        let drawn = gym::render::svg((20, 20), |canvas| {
            canvas.text(
                &character.to_string(),
                [0.0, 20.0],
                16.0,
                Align::Left,
                Color::BLACK,
            );
        });
        let strokes = drawn
            .lines()
            .find_map(|line| line.split_once(" d=\""))
            .unwrap_or_default();
        let strokes = strokes.1.split('"').next().unwrap_or_default();
        format!("{character:?} {strokes}\n")
    });
    let characters: String = characters.collect();
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("drawings");
    kept(&folder.join("characters.txt"), &characters);
}

type Draw = Box<dyn Fn(&mut dyn Canvas)>;

const INK: Color = Color::rgb(200, 30, 90);
const TRIANGLE: [Point; 3] = [[4.0, 3.0], [31.5, 8.25], [12.0, 26.0]];
const CURVES: [Segment; 5] = [
    Segment::Move([3.0, 4.0]),
    Segment::Line([30.0, 5.5]),
    Segment::Quad([38.0, 14.0], [28.0, 22.0]),
    Segment::Cubic([20.0, 29.0], [9.0, 12.0], [5.0, 21.0]),
    Segment::Close,
];
const CIRCLE: Shape<'static> = Shape::Circle {
    center: [18.25, 14.0],
    radius: 9.5,
};

/// A shape filled, stroked, and both under two transforms.
fn of_shape(shape: Shape<'static>) -> [Draw; 3] {
    let turned = Transform {
        x: [0.5, 0.25],
        y: [-0.75, 1.5],
        origin: [17.0, 1.125],
    };
    [
        Box::new(move |canvas| canvas.fill(shape, INK)),
        Box::new(move |canvas| canvas.stroke(shape, 2.3456, INK.alpha(128))),
        Box::new(move |canvas| {
            canvas.push(turned);
            canvas.push(Transform::scale(0.5, 0.75));
            canvas.fill(shape, INK);
            canvas.pop();
            canvas.stroke(shape, 1.5, INK);
            canvas.pop();
        }),
    ]
}

/// A call of pygame, and the same on a surface that is made smaller and drawn over.
fn of_primitive(primitive: Primitive<'static>) -> [Draw; 2] {
    [
        Box::new(move |canvas| canvas.pygame(primitive, INK)),
        Box::new(move |canvas| {
            canvas.push_smoothscaled((160, 90), (40, 30));
            canvas.clear(Color::WHITE);
            canvas.pygame(primitive, INK);
            canvas.pop();
            canvas.stroke(CIRCLE, 1.0, Color::BLACK);
        }),
    ]
}

fn calls() -> Vec<Draw> {
    let rect = |corner| Shape::Rect {
        min: [5.5, 4.0],
        size: [27.0, 17.25],
        corner,
    };
    let shapes = [
        Shape::Polygon(&TRIANGLE),
        Shape::Polyline(&TRIANGLE),
        CIRCLE,
        rect(0.0),
        rect(3.5),
        rect(30.0),
        Shape::Path(&CURVES),
    ];
    let (center, radius) = ([18.25, 14.0], 9.0);
    let (x1, x2, y1, y2) = (3.0, 33.0, 3.0, 24.0);
    let points: &[Point] = &TRIANGLE;
    let primitives = [
        Primitive::HLine { x1, x2, y: 7.0 },
        Primitive::VLine { x: 9.0, y1, y2 },
        Primitive::AaPolygon(points),
        Primitive::FilledPolygon(points),
        Primitive::AaCircle { center, radius },
        Primitive::FilledCircle { center, radius },
        Primitive::Polygon(points),
        Primitive::Lines {
            points,
            closed: false,
            width: 1,
        },
        Primitive::Lines {
            points,
            closed: true,
            width: 3,
        },
        Primitive::Circle { center, radius },
        Primitive::AaLines {
            points,
            closed: false,
        },
        Primitive::AaLines {
            points,
            closed: true,
        },
    ];
    let image = |canvas: &mut dyn Canvas| {
        let pixels = [0, 40, 80, 120, 160, 200];
        let pixels = pixels.map(|x| Color::rgb(x, 255 - x, 7).alpha(55 + x));
        canvas.image(Image {
            min: [6.0, 2.5],
            size: [20.0, 24.0],
            width: 2,
            pixels: &pixels,
        });
    };
    let mut calls: Vec<Draw> = vec![
        Box::new(|canvas| canvas.clear(INK)),
        Box::new(|canvas| canvas.clear(INK.alpha(77))),
        Box::new(image),
    ];
    calls.extend(shapes.into_iter().flat_map(of_shape));
    for align in [Align::Left, Align::Center, Align::Right] {
        calls.push(Box::new(move |canvas| {
            canvas.text("qi", [19.5, 20.0], 11.0, align, INK);
        }));
    }
    calls.extend(primitives.into_iter().flat_map(of_primitive));
    calls
}

/// Each call of a canvas as lines of the log, as elements of a document, and as checksums of pixels in
/// three sizes.
#[test]
fn each_call_is_drawn_as_kept() {
    let mut told = String::new();
    for call in calls() {
        let mut draw = |canvas: &mut dyn Canvas| {
            canvas.clear(Color::rgb(240, 244, 248));
            call(canvas);
        };
        let document = gym::render::svg((40, 30), draw);
        let elements = document.lines().filter(|line| line.starts_with("  "));
        told += &DrawLog::of(draw).to_string();
        told.extend(elements.map(|line| format!("{}\n", line.trim())));
        let sums = [1, 2, 3].map(|scale| {
            let mut frame = Frame::new(40 * scale, 30 * scale).unwrap();
            Raster::new().paint((40, 30), &mut draw, &mut frame);
            let mut digest = Digest::default();
            digest.bytes(frame.pixels());
            digest.finish()[..8].to_owned()
        });
        told += &format!("{}\n\n", sums.join(" "));
    }
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("drawings");
    kept(&folder.join("calls.txt"), &told);
}
