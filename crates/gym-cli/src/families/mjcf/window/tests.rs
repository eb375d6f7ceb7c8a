use std::path::Path;
use std::sync::Arc;

use gym::render::{DrawLog, Pointer};
use gym::sim::engine::Model;
use gym_testing::kept;

use super::*;

const SIZE: (u32, u32) = (1280, 720);
/// A frame of the window, in s: 8 timesteps.
const FRAME: f64 = 0.016;

const ROBOT: &str = r#"<mujoco model="arm"><compiler angle="radian"/><worldbody><geom name="floor" type="plane" size="2 2 1"/>
    <camera name="top" pos="0 0 3"/>
    <body name="ball" pos="0 0 0.25"><freejoint/><geom name="shell" size="0.25"/></body>
    <body name="arm" pos="0.8 0 0.6"><joint name="hinge" axis="0 1 0" damping="1"/><geom type="capsule" fromto="0 0 0 0 0 -0.4" size="0.05"/></body></worldbody>
    <actuator><motor name="pull" joint="hinge" ctrlrange="-2 2"/></actuator>
    <sensor><jointpos name="angle" joint="hinge"/></sensor>
    <keyframe><key name="high" qpos="0 0 1 1 0 0 0 0"/><key name="bent" qpos="0 0 0.25 1 0 0 0 1"/></keyframe></mujoco>"#;

/// A window without a display.
struct Desk {
    live: Live,
    input: Input,
    frame: Frame,
}

impl Desk {
    fn new() -> Self {
        Self::of(ROBOT, SIZE)
    }

    fn of(text: &str, size: (u32, u32)) -> Self {
        let model = Arc::new(Model::from_xml(text).unwrap());
        let mut desk = Self {
            live: Live::new("arm", Viewer::new(model).unwrap()),
            input: Input::default(),
            frame: Frame::new(size.0, size.1).unwrap(),
        };
        assert!(desk.pass(Pointer::default(), &[]));
        desk
    }

    /// A frame with the pointer and the keys that are down.
    fn pass(&mut self, pointer: Pointer, held: &[&str]) -> bool {
        let held = held.iter().map(|key| (*key).to_owned()).collect();
        self.input.follow(pointer, held);
        self.live
            .update(&self.input, FRAME, || true, &mut self.frame)
            .unwrap()
    }

    /// Presses a key and lets it go. Returns whether the window stays open.
    fn key(&mut self, name: &str) -> bool {
        let at = Pointer {
            left: false,
            right: false,
            middle: false,
            wheel: 0.0,
            ..self.input.pointer
        };
        self.pass(at, &[name]) && self.pass(at, &[])
    }

    /// Moves the pointer from one place to the next with buttons down, then lets go.
    fn drag(&mut self, button: Pointer, places: &[Point], held: &[&str]) {
        let [first, ..] = places else { return };
        self.pass(
            Pointer {
                at: *first,
                ..Pointer::default()
            },
            held,
        );
        for at in places {
            self.pass(Pointer { at: *at, ..button }, held);
        }
    }

    fn up(&mut self) {
        let at = self.input.pointer.at;
        self.pass(
            Pointer {
                at,
                ..Pointer::default()
            },
            &[],
        );
    }

    /// A point of a button or slider: a part of its width from the left.
    fn place(&self, name: &str, part: f64) -> Point {
        let places = &self.live.panel.places;
        let found = places.iter().find(|(other, ..)| other == name);
        let (_, min, size) = found.unwrap_or_else(|| panic!("{name} among {places:?}"));
        let [_, panel] = areas((self.frame.width(), self.frame.height()));
        [
            f64::from(panel.min.0) + min[0] + part * size[0],
            f64::from(panel.min.1) + min[1] + size[1] / 2.0,
        ]
    }

    fn click(&mut self, name: &str) {
        let at = self.place(name, 0.5);
        self.drag(LEFT, &[at], &[]);
        self.up();
    }

    fn time(&self) -> f64 {
        self.live.viewer.data().time
    }

    /// The middle of the ball in the window.
    fn ball(&self) -> Point {
        let viewer = &self.live.viewer;
        let [picture, _] = areas((self.frame.width(), self.frame.height()));
        let middle = picture.size;
        let mut best = ([0.0; 2], 0);
        // the middle of the columns and rows that show it
        for x in (0..middle.0).step_by(8) {
            for y in (0..middle.1).step_by(8) {
                let at = [f64::from(x), f64::from(y)];
                let hit = viewer.view().at(viewer.model(), viewer.data(), middle, at);
                if hit.is_some_and(|hit| hit.body == 1) {
                    best = ([best.0[0] + at[0], best.0[1] + at[1]], best.1 + 1);
                }
            }
        }
        assert!(best.1 > 0, "the ball is not seen");
        best.0.map(|sum| sum / f64::from(best.1))
    }
}

const LEFT: Pointer = Pointer {
    at: [0.0; 2],
    left: true,
    middle: false,
    right: false,
    wheel: 0.0,
};
const RIGHT: Pointer = Pointer {
    left: false,
    right: true,
    ..LEFT
};
const MIDDLE: Pointer = Pointer {
    left: false,
    middle: true,
    ..LEFT
};

#[test]
fn time_pauses_steps_and_starts_again() {
    let mut desk = Desk::new();
    let near = |a: f64, b: f64| (a - b).abs() < 1e-9;
    assert!(near(desk.time(), FRAME));
    assert_eq!(desk.live.name(), "arm");
    assert!(desk.key("Space"));
    assert_eq!(desk.live.name(), "arm (paused)");
    let paused = desk.time();
    desk.key("Right");
    assert!(near(desk.time(), paused + 0.002));
    desk.click("Step");
    assert!(near(desk.time(), paused + 0.004));
    desk.click("Run");
    assert!(desk.time() > paused + 0.004 && desk.live.name() == "arm");
    desk.click("Pause");
    desk.key("Backspace");
    assert_eq!(desk.time(), 0.0);
    desk.key("Period");
    desk.click("Reset");
    assert_eq!(desk.time(), 0.0);
    assert!(!desk.key("Escape"));
}

#[test]
fn the_speed_changes() {
    let mut desk = Desk::new();
    desk.key("Equal");
    assert_eq!(desk.live.viewer.speed(), 2.0);
    desk.click("-");
    desk.key("Minus");
    assert_eq!(desk.live.viewer.speed(), 0.5);
    desk.click("+");
    assert_eq!(desk.live.viewer.speed(), 1.0);
    for _ in 0..40 {
        desk.key("Minus");
    }
    assert_eq!(desk.live.viewer.speed(), SPEEDS[0]);
    assert_eq!(desk.live.error, None);
}

#[test]
fn keyframes_are_chosen_by_name() {
    let mut desk = Desk::new();
    desk.key("Space");
    let height = |desk: &Desk| desk.live.viewer.data().qpos[2];
    desk.click("high");
    assert_eq!((height(&desk), desk.time()), (1.0, 0.0));
    desk.key("K");
    assert_eq!(desk.live.viewer.data().qpos[7], 1.0, "bent");
    desk.key("K");
    assert_eq!(height(&desk), 1.0, "the first again");
}

#[test]
fn sliders_set_controls() {
    let mut desk = Desk::new();
    let at = desk.place("pull", 1.0);
    desk.drag(LEFT, &[at], &[]);
    assert_eq!(desk.live.viewer.data().ctrl, [2.0]);
    let low = desk.place("pull", 0.25);
    desk.pass(Pointer { at: low, ..LEFT }, &[]);
    assert!((desk.live.viewer.data().ctrl[0] + 1.0).abs() < 1e-9);
    desk.up();
    for _ in 0..60 {
        desk.up();
    }
    assert!(
        desk.live.viewer.data().qpos[7].abs() > 0.05,
        "the arm moves"
    );
    desk.drag(RIGHT, &[low], &[]);
    assert_eq!(desk.live.viewer.data().ctrl, [0.0]);
    desk.drag(LEFT, &[low], &[]);
    desk.up();
    desk.click("all to zero");
    assert_eq!(desk.live.viewer.data().ctrl, [0.0]);
    desk.drag(LEFT, &[low], &[]);
    desk.up();
    desk.key("0");
    assert_eq!(desk.live.viewer.data().ctrl, [0.0]);
}

#[test]
fn a_body_is_selected_named_and_pulled() {
    let mut desk = Desk::new();
    let ball = desk.ball();
    let plain = desk.frame.clone();
    desk.drag(LEFT, &[ball, [ball[0], ball[1] - 300.0]], &[]);
    let viewer = &desk.live.viewer;
    assert_eq!(viewer.selected().map(|hit| hit.body), Some(1));
    assert!(viewer.is_pulling());
    let held = Pointer {
        at: [ball[0], ball[1] - 300.0],
        ..LEFT
    };
    for _ in 0..60 {
        desk.pass(held, &[]);
    }
    let height = desk.live.viewer.data().xpos[1][2];
    assert!(height > 0.35, "{height}");
    assert!(desk.frame != plain);
    desk.up();
    assert!(!desk.live.viewer.is_pulling());
    assert_eq!(desk.live.viewer.data().xfrc_applied[1], [0.0; 6]);
    // the free camera follows it
    desk.key("T");
    assert_eq!(desk.live.viewer.followed(), Some(1));
    desk.click("follow");
    assert_eq!(desk.live.viewer.followed(), None);
}

#[test]
fn the_pointer_moves_the_camera() {
    let mut desk = Desk::new();
    desk.key("Space");
    let camera = |desk: &Desk| desk.live.viewer.view().free_camera().unwrap();
    let sky = [40.0, 20.0];
    let to = [112.0, 56.0];
    let first = camera(&desk);
    // a tenth of the height: 18 degrees
    desk.drag(LEFT, &[sky, to], &[]);
    desk.up();
    let turned = camera(&desk);
    let by = |a: Option<f64>, b: Option<f64>| b.unwrap() - a.unwrap();
    assert!((by(first.azimuth, turned.azimuth) + 18.0).abs() < 1e-9);
    assert!((by(first.elevation, turned.elevation) + 9.0).abs() < 1e-9);
    assert_eq!(first.lookat, turned.lookat);
    for (button, held) in [(RIGHT, &[][..]), (LEFT, &["LeftShift"]), (MIDDLE, &[])] {
        let before = camera(&desk);
        desk.drag(button, &[sky, to], held);
        desk.up();
        let after = camera(&desk);
        assert_ne!(before.lookat, after.lookat, "{button:?}");
        assert_eq!(before.azimuth, after.azimuth);
        let [_, _, z] = after.lookat.unwrap();
        assert_eq!(z == before.lookat.unwrap()[2], button.middle);
    }
    // on a body too
    let (ball, before) = (desk.ball(), camera(&desk));
    desk.drag(LEFT, &[ball, [ball[0] + 72.0, ball[1]]], &["LeftCtrl"]);
    desk.up();
    assert!((by(before.azimuth, camera(&desk).azimuth) + 18.0).abs() < 1e-9);
    let far = camera(&desk).distance.unwrap();
    desk.pass(
        Pointer {
            at: sky,
            wheel: 1.0,
            ..Pointer::default()
        },
        &[],
    );
    let near = camera(&desk).distance.unwrap();
    assert!(near < far && near > 0.7 * far, "{far} {near}");
    // the model's cameras
    desk.click("top");
    assert_eq!(desk.live.viewer.camera(), Some(0));
    desk.key("RightBracket");
    assert_eq!(desk.live.viewer.camera(), None);
    desk.key("LeftBracket");
    assert_eq!(desk.live.viewer.camera(), Some(0));
    desk.click("free");
    assert_eq!(desk.live.viewer.camera(), None);
}

#[test]
fn contacts_and_forces_are_shown_on_demand() {
    let mut desk = Desk::new();
    desk.key("Space");
    let mut pictures = vec![desk.frame.clone()];
    for action in ["C", "contacts", "F", "forces", "Slash", "?"] {
        if action.len() > 1 && action != "Slash" || action == "?" {
            desk.click(action);
        } else {
            desk.key(action);
        }
        // without the pointer's place
        desk.pass(Pointer::default(), &[]);
        pictures.push(desk.frame.clone());
    }
    for k in [0, 2, 4] {
        assert!(pictures[k] != pictures[k + 1], "{k} is seen");
        assert!(pictures[k] == pictures[k + 2], "{k} is not");
    }
}

#[test]
fn a_simulation_that_diverges_stops_with_an_error() {
    let text = r#"<mujoco><option timestep="0.01" gravity="0 0 0"/><worldbody><body><joint type="slide" stiffness="1e8"/>
        <geom size="0.1"/></body></worldbody><keyframe><key name="off" qpos="0.1"/></keyframe></mujoco>"#;
    let mut desk = Desk::of(text, SIZE);
    desk.click("off");
    for _ in 0..40 {
        desk.up();
    }
    let error = desk.live.error.clone().unwrap_or_default();
    assert!(error.contains("diverged"), "{error}");
    assert!(desk.live.viewer.is_paused);
    desk.click("Run");
    assert_eq!(desk.live.error, None);
}

/// A window is narrow, or so small that nothing fits.
#[test]
fn every_size_is_drawn() {
    for size in [(400, 800), (1280, 720), (90, 30), (1, 1), (721, 1)] {
        let mut desk = Desk::of(ROBOT, size);
        assert!(desk.key("Slash") && desk.key("C") && desk.key("F"));
    }
    let mut desk = Desk::of(ROBOT, (400, 800));
    let at = desk.place("pull", 1.0);
    desk.drag(LEFT, &[at], &[]);
    assert_eq!(desk.live.viewer.data().ctrl, [2.0]);
}

/// Pictures that take long have fewer samples, but not those that stand still.
#[test]
fn slow_pictures_are_rougher() {
    let mut desk = Desk::new();
    for (frames, samples) in [(1, 3), (8, 2), (8, 1), (8, 1)] {
        for _ in 0..frames {
            desk.live
                .update(&desk.input, 0.1, || false, &mut desk.frame)
                .unwrap();
        }
        assert_eq!(desk.live.viewer.samples, samples);
    }
    desk.key("Space");
    assert_eq!(desk.live.viewer.samples, 3);
    desk.key("Space");
    assert_eq!(desk.live.viewer.samples, 1);
}

/// The texts of the panel, of the picture's label and of the keys, with their places and colours: at
/// first, then those that each act changes. After an intended change, look at a live window, then store them with
/// `GYM_UPDATE_KEPT=1 cargo test --package gym-cli --features families --lib window`.
#[test]
fn what_a_window_says_is_as_kept() {
    let mut desk = Desk::new();
    let (mut told, mut before) = (String::new(), Vec::new());
    let mut tell = |desk: &mut Desk, act: &str| {
        let area = Area {
            min: (0, 0),
            size: (320, 2000),
        };
        let live = &mut desk.live;
        let log = DrawLog::of(|canvas| {
            Panel::default().rows(area, &Input::default(), canvas, |rows| live.panel(rows));
            label(&live.viewer, (960, 720), canvas);
            if live.helps {
                help((960, 720), canvas);
            }
        });
        let texts = log.to_string();
        let texts = texts
            .lines()
            .map(str::trim)
            .filter(|line| line.starts_with("text"));
        let texts: Vec<String> = texts.map(str::to_owned).collect();
        told += &format!("# {act}\n");
        for text in texts.iter().filter(|text| !before.contains(*text)) {
            told += &format!("{text}\n");
        }
        before = texts;
    };
    tell(&mut desk, "the first frame");
    desk.key("Minus");
    for _ in 0..40 {
        desk.up();
    }
    tell(&mut desk, "half the speed, for half a second");
    desk.key("Equal");
    desk.key("Equal");
    for _ in 0..20 {
        desk.live
            .update(&desk.input, 0.04, || false, &mut desk.frame)
            .unwrap();
    }
    tell(&mut desk, "twice the speed, for which there is no time");
    desk.key("Space");
    tell(&mut desk, "paused");
    let ball = desk.ball();
    desk.drag(LEFT, &[ball], &[]);
    desk.up();
    desk.key("T");
    desk.key("C");
    desk.key("F");
    tell(&mut desk, "a body is followed, with contacts and forces");
    desk.click("high");
    desk.click("top");
    let at = desk.place("pull", 0.75);
    desk.drag(LEFT, &[at], &[]);
    desk.up();
    tell(&mut desk, "a keyframe, a camera and a control");
    desk.key("K");
    desk.live.error = Some("it cannot go on".to_owned());
    tell(&mut desk, "the next keyframe, and an error");
    desk.key("Slash");
    tell(&mut desk, "the keys");
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    kept(&folder.join("src/families/mjcf/window.txt"), &told);
}
