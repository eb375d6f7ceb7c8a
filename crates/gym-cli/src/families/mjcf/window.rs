//! The live window of a model.

use std::time::{Duration, Instant};

use gym::Result;
use gym::canvas::{Align, Canvas, Color, Point};
use gym::render::{Frame, text_width};
use gym::sim::engine::model::ObjectType;
use gym::sim::keyframes;
use gym::sim::viewer::{SPEEDS, Viewer, name};

use crate::live::{self, Area, Input, Panel, Part, Rows, TEXT, areas, rest, short};

/// The longest time in a frame for which steps are taken: with that of drawing, 30 frames a second.
const STEPPING: Duration = Duration::from_millis(20);
/// The part of the height of a picture by which a step of the wheel moves the camera.
const WHEEL: f64 = 0.05;
/// The most samples of a pixel in a row, and the time of a frame from which on there are fewer.
const SAMPLES: usize = 3;
const SLOW: f64 = 1.0 / 28.0;
/// The numbers of a sensor that are drawn.
const MOST_LINES: usize = 6;

const HELP: [(&str, &str); 18] = [
    ("Space", "pause, run"),
    ("Right", "a timestep"),
    ("Backspace", "reset"),
    ("K", "next keyframe"),
    ("- and =", "half and double speed"),
    ("0", "all controls to zero"),
    ("[ and ]", "previous and next camera"),
    ("C", "contacts"),
    ("F", "forces of contacts"),
    ("T", "follow the selected body, or not"),
    ("drag a body", "pull it"),
    ("drag", "turn the camera"),
    ("Ctrl and drag", "turn, also on a body"),
    ("right or Shift, drag", "move the camera"),
    ("middle drag", "move along the ground"),
    ("wheel", "nearer, further"),
    ("right on a slider", "to zero"),
    ("Escape", "quit"),
];

/// What the pointer does while a button is down.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Drag {
    Pull,
    Turn,
    Move { level: bool },
}

/// A window's content: a function of what a person does, and of the time that passed.
pub(super) struct Live {
    viewer: Viewer,
    title: String,
    keyframes: Vec<String>,
    cameras: Vec<String>,
    /// The keyframe that was used last.
    keyframe: Option<usize>,
    picture: Part,
    side: Part,
    panel: Panel,
    drag: Option<Drag>,
    error: Option<String>,
    helps: bool,
    rate: Rate,
    fine: Fine,
}

impl Live {
    pub(super) fn new(title: &str, viewer: Viewer) -> Self {
        let model = viewer.model();
        let cameras = (0..model.cam_mode.len()).map(|id| name(model, ObjectType::Camera, id));
        let cameras = std::iter::once("free".to_owned()).chain(cameras).collect();
        Self {
            title: title.to_owned(),
            keyframes: keyframes(model),
            cameras,
            viewer,
            keyframe: None,
            picture: Part::default(),
            side: Part::default(),
            panel: Panel::default(),
            drag: None,
            error: None,
            helps: false,
            rate: Rate::default(),
            fine: Fine::default(),
        }
    }

    /// The title of the window.
    fn name(&self) -> String {
        let paused = if self.viewer.is_paused {
            " (paused)"
        } else {
            ""
        };
        format!("{}{paused}", self.title)
    }

    /// Lets a person act, the time pass and draws the result. `goes_on` says whether there is time for
    /// another step. Returns false once the person quits.
    pub(super) fn update(
        &mut self,
        input: &Input,
        seconds: f64,
        goes_on: impl FnMut() -> bool,
        window: &mut Frame,
    ) -> Result<bool> {
        if input.keys.iter().any(|key| key == "Escape") {
            return Ok(false);
        }
        let [picture, panel] = areas((window.width(), window.height()));
        for key in &input.keys {
            self.key(key);
        }
        self.point(input, picture);
        let time = self.viewer.data().time;
        let advanced = self.viewer.advance(seconds, goes_on);
        self.check(advanced.map(|_| ()));
        self.rate
            .add(seconds, (self.viewer.data().time - time).max(0.0));
        let samples = self.fine.samples(seconds);
        let Self {
            viewer,
            helps,
            picture: part,
            ..
        } = self;
        viewer.samples = if viewer.is_paused { SAMPLES } else { samples };
        let draw = |canvas: &mut dyn Canvas| {
            viewer.draw(picture.size, canvas);
            label(viewer, picture.size, canvas);
            if *helps {
                help(picture.size, canvas);
            }
        };
        part.draw(picture, window, draw)?;
        let mut side = std::mem::take(&mut self.side);
        let mut column = std::mem::take(&mut self.panel);
        let drawn = side.draw(panel, window, |canvas| {
            column.rows(panel, input, canvas, |rows| self.panel(rows));
        });
        (self.side, self.panel) = (side, column);
        drawn.map(|()| true)
    }

    /// Shows an error, and stops.
    fn check(&mut self, result: Result<()>) {
        if let Err(error) = result {
            self.error = Some(error.to_string());
            self.viewer.is_paused = true;
        }
    }

    fn key(&mut self, key: &str) {
        let cameras = self.cameras.len();
        let camera = self.viewer.camera().map_or(0, |id| id + 1);
        match key {
            "Space" => self.pause(),
            "Right" | "Period" => self.step(),
            "Backspace" => self.reset(None),
            "K" if !self.keyframes.is_empty() => {
                let next = self.keyframe.map_or(0, |key| key + 1);
                self.reset(Some(next % self.keyframes.len()));
            }
            "Minus" => self.speed(0.5),
            "Equal" => self.speed(2.0),
            "0" => self.clear_controls(),
            "LeftBracket" => self.camera((camera + cameras - 1) % cameras),
            "RightBracket" => self.camera((camera + 1) % cameras),
            "C" => self.viewer.shows_contacts ^= true,
            "F" => self.viewer.shows_forces ^= true,
            "T" => self.follow(),
            "Slash" | "H" | "F1" => self.helps ^= true,
            _ => {}
        }
    }

    fn pause(&mut self) {
        self.viewer.is_paused ^= true;
        self.error = None;
    }

    /// Takes a single step, and pauses.
    fn step(&mut self) {
        self.viewer.is_paused = true;
        let stepped = self.viewer.step(1);
        self.check(stepped);
    }

    fn reset(&mut self, keyframe: Option<usize>) {
        (self.drag, self.error, self.keyframe) = (None, None, keyframe);
        match keyframe {
            None => self.viewer.reset(),
            Some(key) => {
                let reset = self.viewer.reset_to(&self.keyframes[key]);
                self.check(reset);
            }
        }
    }

    fn speed(&mut self, factor: f64) {
        let speed = (self.viewer.speed() * factor).clamp(SPEEDS[0], SPEEDS[1]);
        let set = self.viewer.set_speed(speed);
        self.check(set);
    }

    fn camera(&mut self, number: usize) {
        let used = self.viewer.use_camera(number.checked_sub(1));
        self.check(used);
    }

    /// Follows the selected body, or stops to follow.
    fn follow(&mut self) {
        let body = match self.viewer.followed() {
            None => self.viewer.selected().map(|hit| hit.body),
            Some(_) => None,
        };
        self.viewer.follow(body);
    }

    fn clear_controls(&mut self) {
        for i in 0..self.viewer.controls().len() {
            let value = rest(self.viewer.controls()[i].range);
            let set = self.viewer.set_control(i, value);
            self.check(set);
        }
    }

    /// Lets the pointer act on the picture.
    fn point(&mut self, input: &Input, area: Area) {
        let at = area.local(input.pointer.at);
        let is_over = area.contains(input.pointer.at);
        if is_over && input.presses(|pointer| pointer.left) {
            self.drag = Some(if input.holds("Ctrl") {
                Drag::Turn
            } else if input.holds("Shift") {
                Drag::Move { level: false }
            } else {
                self.viewer.select(at, area.size);
                match self.viewer.is_pulling() {
                    true => Drag::Pull,
                    false => Drag::Turn,
                }
            });
        } else if is_over && input.presses(|pointer| pointer.right) {
            self.drag = Some(Drag::Move { level: false });
        } else if is_over && input.presses(|pointer| pointer.middle) {
            self.drag = Some(Drag::Move { level: true });
        }
        let pointer = &input.pointer;
        if !(pointer.left || pointer.right || pointer.middle) {
            self.drag = None;
            self.viewer.release();
        }
        let height = f64::from(area.size.1.max(1));
        let moved = input.moved().map(|x| x / height);
        match self.drag {
            Some(Drag::Pull) if moved != [0.0; 2] => self.viewer.pull(at, area.size),
            Some(Drag::Turn) => self.viewer.turn_by(moved),
            Some(Drag::Move { level }) => self.viewer.move_by(moved, level),
            _ => {}
        }
        if is_over && pointer.wheel != 0.0 {
            self.viewer.zoom_by(-WHEEL * pointer.wheel);
        }
    }

    /// Draws the panel, and lets its buttons and sliders act.
    fn panel(&mut self, rows: &mut Rows<'_>) {
        let (viewer, rate) = (&mut self.viewer, &self.rate);
        rows.text(&self.title);
        let [potential, kinetic] = viewer.energy();
        let (data, speed) = (viewer.data(), viewer.speed());
        rows.text(&format!("time {:.3} s", data.time));
        let slow = match rate.speed() {
            Some(real) if real < 0.95 * speed && !viewer.is_paused => {
                format!(", here {real:.2}")
            }
            _ => String::new(),
        };
        rows.note(&format!(
            "speed {}{slow}, {:.0} pictures per second",
            short(speed),
            rate.pictures()
        ));
        rows.note(&format!(
            "energy {} J kinetic, {} J potential",
            short(kinetic),
            short(potential)
        ));
        rows.note(&format!("contacts: {}", data.contact.len()));
        if let Some(error) = &self.error {
            rows.error(error);
        }
        let run = if viewer.is_paused { "Run" } else { "Pause" };
        match rows.buttons(&[run, "Step", "Reset", "-", "+", "?"], |i| {
            i == 5 && self.helps
        }) {
            Some(0) => self.pause(),
            Some(1) => self.step(),
            Some(2) => self.reset(None),
            Some(3) => self.speed(0.5),
            Some(4) => self.speed(2.0),
            Some(5) => self.helps ^= true,
            _ => {}
        }
        let lit = [self.viewer.shows_contacts, self.viewer.shows_forces];
        let follows = self.viewer.followed().is_some();
        match rows.buttons(&["contacts", "forces", "follow"], |i| {
            [lit[0], lit[1], follows][i]
        }) {
            Some(0) => self.viewer.shows_contacts ^= true,
            Some(1) => self.viewer.shows_forces ^= true,
            Some(2) => self.follow(),
            _ => {}
        }
        if !self.keyframes.is_empty() {
            rows.heading("Keyframes");
            if let Some(key) = rows.buttons(&self.keyframes, |i| self.keyframe == Some(i)) {
                self.reset(Some(key));
            }
        }
        if self.cameras.len() > 1 {
            rows.heading("Cameras");
            let camera = self.viewer.camera().map_or(0, |id| id + 1);
            if let Some(number) = rows.buttons(&self.cameras, |i| i == camera) {
                self.camera(number);
            }
        }
        self.sliders(rows);
        self.sensors(rows);
    }

    fn sliders(&mut self, rows: &mut Rows<'_>) {
        if self.viewer.controls().is_empty() {
            return;
        }
        rows.heading("Actuators");
        if rows.buttons(&["all to zero"], |_| false).is_some() {
            self.clear_controls();
        }
        for i in 0..self.viewer.controls().len() {
            let control = &self.viewer.controls()[i];
            let value = self.viewer.data().ctrl[i];
            if let Some(value) = rows.slider(&control.name, value, control.range) {
                let set = self.viewer.set_control(i, value);
                self.check(set);
            }
        }
    }

    fn sensors(&self, rows: &mut Rows<'_>) {
        let viewer = &self.viewer;
        if viewer.sensors().is_empty() {
            return;
        }
        rows.heading("Sensors, the last 5 s");
        for (i, sensor) in viewer.sensors().iter().enumerate() {
            let values = viewer.sensor(i);
            let shown: Vec<String> = values.iter().take(MOST_LINES).map(|x| short(*x)).collect();
            let more = if values.len() > MOST_LINES { " .." } else { "" };
            let shown = format!("{}{more}", shown.join("  "));
            rows.lines(&sensor.name, &shown, |k, line| {
                line.extend(viewer.history(i, k));
                k < MOST_LINES && !line.is_empty()
            });
        }
    }
}

/// Writes what is selected.
fn label(viewer: &Viewer, (_, height): (u32, u32), canvas: &mut dyn Canvas) {
    let Some(hit) = viewer.selected() else { return };
    let model = viewer.model();
    let body = name(model, ObjectType::Body, hit.body);
    let geom = name(model, ObjectType::Geom, hit.geom);
    let text = match hit.body {
        0 => format!("world, {geom}"),
        body_id => format!("{body}, {} kg, {geom}", short(model.body_mass[body_id])),
    };
    let at = [14.0, f64::from(height) - 14.0];
    let size = [text_width(&text, TEXT) + 16.0, TEXT + 14.0];
    let min = [at[0] - 8.0, at[1] - TEXT - 7.0];
    canvas.round_rect(min, size, 5.0, Color::WHITE.alpha(215));
    canvas.text(&text, at, TEXT, Align::Left, Color::rgb(28, 34, 44));
}

/// Lists the keys.
fn help((width, height): (u32, u32), canvas: &mut dyn Canvas) {
    let (line, left, column) = (TEXT + 9.0, 16.0, 162.0);
    let size = [372.0, line * HELP.len() as f64 + 20.0];
    // smaller, if the picture is smaller
    let scale = (f64::from(width) / (size[0] + 16.0))
        .min(f64::from(height) / (size[1] + 16.0))
        .min(1.0);
    canvas.push(gym::canvas::Transform::scale(scale, scale));
    canvas.round_rect([8.0, 8.0], size, 8.0, Color::WHITE.alpha(228));
    let ink = Color::rgb(28, 34, 44);
    for (i, (key, does)) in HELP.iter().enumerate() {
        let y = 16.0 + line * (i as f64 + 0.75);
        let at = |x: f64| -> Point { [8.0 + x, y] };
        canvas.text(key, at(left), TEXT, Align::Left, Color::rgb(38, 98, 190));
        canvas.text(does, at(column), TEXT, Align::Left, ink);
    }
    canvas.pop();
}

/// How many samples of a pixel there is time for.
#[derive(Debug)]
struct Fine {
    samples: usize,
    /// The frames in a row that took too long.
    slow: u32,
}

impl Default for Fine {
    fn default() -> Self {
        let samples = SAMPLES;
        Self { samples, slow: 0 }
    }
}

impl Fine {
    /// The samples for the next picture, if the last frame took `seconds`.
    fn samples(&mut self, seconds: f64) -> usize {
        self.slow = if seconds > SLOW { self.slow + 1 } else { 0 };
        if self.slow > 6 {
            self.samples = (self.samples - 1).max(1);
            self.slow = 0;
        }
        self.samples
    }
}

/// How fast pictures and the model's time pass, as means of the last half second.
#[derive(Debug, Default)]
struct Rate {
    seconds: f64,
    model: f64,
    frames: f64,
    last: Option<[f64; 2]>,
}

impl Rate {
    fn add(&mut self, seconds: f64, model: f64) {
        self.seconds += seconds;
        self.model += model;
        self.frames += 1.0;
        if self.seconds > 0.5 {
            self.last = Some([self.model, self.frames].map(|x| x / self.seconds));
            (self.seconds, self.model, self.frames) = (0.0, 0.0, 0.0);
        }
    }

    /// The seconds of the model in a second.
    fn speed(&self) -> Option<f64> {
        self.last.map(|[speed, _]| speed)
    }

    fn pictures(&self) -> f64 {
        self.last.map_or(0.0, |[_, frames]| frames)
    }
}

/// Shows a model until the window is closed.
pub(super) fn open(mut live: Live, size: (u32, u32)) -> Result<()> {
    let mut last = Instant::now();
    live::run(&live.name(), size, |input, frame| {
        let now = Instant::now();
        let seconds = (now - std::mem::replace(&mut last, now)).as_secs_f64();
        let has_time = || now.elapsed() < STEPPING;
        let goes_on = live.update(input, seconds, has_time, frame)?;
        Ok(goes_on.then(|| live.name()))
    })
}

#[cfg(test)]
mod tests;
