//! Playing robots in a window: a slider for each number of an action.

use std::time::Instant;

use gym::canvas::Canvas;
use gym::render::Frame;
use gym::sim::SimEnv;
use gym::sim::engine::model::ObjectType;
use gym::sim::viewer;

use super::*;
use crate::live::{self, Area, Input, Panel, Part, Rows, areas, rest, short};

/// The most numbers of an action that have sliders.
const MOST: usize = 64;
/// The grey around a picture that has another shape than its area.
const AROUND: u8 = 232;
/// The most steps in a frame, if steps are slower than real time.
const BEHIND: u32 = 4;

/// A number of an action: its name, its range, and its value.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Slider {
    name: String,
    range: [f64; 2],
    value: f64,
}

/// The sliders of the environment `id` on a MuJoCo model, by the names of its registration; `None` for
/// others, and for actions that are not some numbers in ranges.
pub(super) fn sliders(id: &str, env: &BoxEnv) -> Option<Vec<Slider>> {
    let model = &env.layer::<SimEnv>()?.simulation().model;
    let gym::Space::Box(space) = env.action_space() else {
        return None;
    };
    let count = space.low().len();
    if space.shape().len() != 1 || !(1..=MOST).contains(&count) {
        return None;
    }
    let names = gym::registry::find(id).ok()?.page.names;
    let names = names.map_or_else(Vec::new, |names| names(env).action);
    let ranges = space.low().iter_f64().zip(space.high().iter_f64());
    let slider = |(i, (low, high)): (usize, (f64, f64))| {
        let is_bounded = low.is_finite() && high.is_finite();
        is_bounded.then(|| Slider {
            name: match names.get(i) {
                Some(name) => name.clone(),
                None if count == model.nu() => viewer::name(model, ObjectType::Actuator, i),
                // an action that is not the controls has numbers of its own
                None => format!("action {i}"),
            },
            range: [low, high],
            value: rest([low, high]),
        })
    };
    ranges.enumerate().map(slider).collect()
}

/// A window's content: a function of what a person does, and of the steps that are due.
struct Stage<'a> {
    session: &'a mut Session,
    keys: &'a Keys,
    sliders: Vec<Slider>,
    picture: Part,
    side: Part,
    panel: Panel,
    is_paused: bool,
    /// Whether the pointer turns the camera.
    turns: bool,
    /// Whether the episode is over.
    is_over: bool,
}

impl<'a> Stage<'a> {
    fn new(session: &'a mut Session, keys: &'a Keys, sliders: Vec<Slider>) -> Self {
        Self {
            session,
            keys,
            sliders,
            picture: Part::default(),
            side: Part::default(),
            panel: Panel::default(),
            is_paused: false,
            turns: false,
            is_over: false,
        }
    }

    /// Lets a person act, takes the steps that are due, and draws the result. Returns false once the
    /// person quits.
    fn update(&mut self, input: &Input, due: u32, window: &mut Frame) -> Result<bool> {
        let [left, panel] = areas((window.width(), window.height()));
        for key in &input.keys {
            match key.as_str() {
                "Escape" => return Ok(false),
                "Space" => self.is_paused ^= true,
                "Period" => self.step(input)?,
                "R" if keys::action(self.keys, std::slice::from_ref(key)).is_none() => {
                    self.reset()?;
                }
                "0" => self.clear(),
                _ => {}
            }
        }
        self.turn(input, left);
        for _ in 0..due {
            if !self.is_paused && !self.is_over {
                self.advance(input)?;
            }
        }
        let env = &self.session.env;
        let units = env.metadata().render_size;
        let area = left.fit(units);
        window.pixels_mut().fill(AROUND);
        self.picture
            .draw_in(area, units, window, |canvas| env.draw(canvas))?;
        let mut side = std::mem::take(&mut self.side);
        let mut column = std::mem::take(&mut self.panel);
        let mut result = Ok(());
        let drawn = side.draw(panel, window, |canvas: &mut dyn Canvas| {
            column.rows(panel, input, canvas, |rows| result = self.rows(rows, input));
        });
        (self.side, self.panel) = (side, column);
        drawn.and(result).map(|()| true)
    }

    /// The action of the keys that are down, or else that of the sliders.
    fn action(&self, input: &Input) -> Json {
        keys::action(self.keys, &input.held).unwrap_or_else(|| {
            let values: Vec<f64> = self.sliders.iter().map(|slider| slider.value).collect();
            json!(values)
        })
    }

    fn advance(&mut self, input: &Input) -> Result<()> {
        let action = self.action(input);
        self.is_over = self.session.step(&action)?;
        Ok(())
    }

    /// Takes a single step, and pauses.
    fn step(&mut self, input: &Input) -> Result<()> {
        self.is_paused = true;
        if self.is_over {
            Ok(())
        } else {
            self.advance(input)
        }
    }

    fn reset(&mut self) -> Result<()> {
        self.is_over = false;
        self.session.reset(Reset::default())
    }

    fn clear(&mut self) {
        for Slider { range, value, .. } in &mut self.sliders {
            *value = rest(*range);
        }
    }

    /// Lets the pointer turn the free camera: half a turn for a height of the picture.
    fn turn(&mut self, input: &Input, area: Area) {
        let is_over = area.contains(input.pointer.at);
        if is_over && input.presses(|pointer| pointer.left) {
            self.turns = true;
        }
        self.turns &= input.pointer.left;
        let Some(env) = self.session.env.layer_mut::<SimEnv>() else {
            return;
        };
        let height = f64::from(area.size.1.max(1));
        let [x, y] = input.moved().map(|x| -180.0 * x / height);
        if self.turns {
            env.turn_camera(x, y, 1.0);
        }
        if is_over && input.pointer.wheel != 0.0 {
            env.turn_camera(0.0, 0.0, 1.0 - 0.1 * input.pointer.wheel.clamp(-5.0, 5.0));
        }
    }

    /// Draws the panel, and lets its buttons and sliders act.
    fn rows(&mut self, rows: &mut Rows<'_>, input: &Input) -> Result<()> {
        let session = &self.session;
        rows.text(&session.trace.id);
        rows.text(&format!(
            "episode {}, step {}",
            session.episode, session.steps
        ));
        rows.text(&format!("reward {}", short(session.reward)));
        rows.text(&format!("return {}", short(session.score)));
        rows.note("Space pauses, . steps, R restarts");
        rows.note("0 clears, Escape quits");
        rows.note("drag turns the camera, the wheel moves it");
        let run = if self.is_paused { "Run" } else { "Pause" };
        match rows.buttons(&[run, "Step", "Reset", "all to zero"], |_| false) {
            Some(0) => self.is_paused ^= true,
            Some(1) => self.step(input)?,
            Some(2) => self.reset()?,
            Some(3) => self.clear(),
            _ => {}
        }
        rows.heading("Action");
        for slider in &mut self.sliders {
            let new = rows.slider(&slider.name, slider.value, slider.range);
            slider.value = new.unwrap_or(slider.value);
        }
        Ok(())
    }
}

/// Plays until the window is closed.
pub(super) fn play(
    session: &mut Session,
    keys: &Keys,
    arguments: &Arguments,
    sliders: Vec<Slider>,
) -> Result<()> {
    let period = session.period(arguments);
    let size = (session.frame.width() + 320, session.frame.height().max(480));
    let title = session.status();
    let mut stage = Stage::new(session, keys, sliders);
    let mut next = Instant::now() + period;
    let mut end = None;
    live::run(&title, size, |input, frame| {
        let now = Instant::now();
        let mut due = 0;
        while next <= now && due < BEHIND {
            next += period;
            due += 1;
        }
        // what is further behind is dropped
        next = next.max(now);
        if !stage.update(input, due, frame)? {
            return Ok(None);
        }
        let title = stage.session.status();
        if !stage.is_over {
            end = None;
        } else if now >= *end.get_or_insert(now + PAUSE) {
            if stage.session.is_last() {
                return Ok(None);
            }
            stage.reset()?;
        }
        Ok(Some(title))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use gym::render::{DrawLog, Pointer};

    #[test]
    fn actions_of_robots_have_sliders_with_the_names_of_the_registration() {
        let of = |id: &str| sliders(id, &gym::make(id).unwrap());
        let humanoid = of("Humanoid-v5").unwrap();
        assert_eq!(humanoid.len(), 17);
        assert_eq!(humanoid[0].name, "torque of abdomen_y (100 N m)");
        assert_eq!(humanoid[0].range.map(|x| (x * 10.0).round()), [-4.0, 4.0]);
        assert_eq!(of("dm_control/walker-walk-v0").unwrap().len(), 6);
        assert!(of("AdroitHandDoor-v1").unwrap().len() > 20);
        assert_eq!((of("CartPole-v1"), of("Pendulum-v1")), (None, None));
    }

    #[test]
    fn sliders_and_keys_are_the_action() {
        let arguments: Arguments = inputs::parsed("InvertedPendulum-v5 --seed 1");
        let mut session = Session::start(&arguments).unwrap();
        let keys = Keys::new(json!({"A": [2.0]}));
        let sliders = sliders(&session.trace.id, &session.env).unwrap();
        let mut stage = Stage::new(&mut session, &keys, sliders);
        let mut frame = Frame::new(900, 480).unwrap();
        let mut input = Input::default();
        let mut pass = |stage: &mut Stage<'_>, pointer: Pointer, held: &[&str], due| {
            let held = held.iter().map(|key| (*key).to_owned()).collect();
            input.follow(pointer, held);
            assert!(stage.update(&input, due, &mut frame).unwrap());
            frame.clone()
        };
        let idle = Pointer::default();
        let first = pass(&mut stage, idle, &[], 0);
        let place = |stage: &Stage<'_>, name: &str, part: f64| {
            let places = &stage.panel.places;
            let (_, min, size) = places.iter().find(|(other, ..)| other == name).unwrap();
            Pointer {
                at: [580.0 + min[0] + part * size[0], min[1] + size[1] / 2.0],
                left: true,
                ..idle
            }
        };
        let name = stage.sliders[0].name.clone();
        let at = place(&stage, &name, 0.6);
        pass(&mut stage, at, &[], 0);
        pass(&mut stage, idle, &[], 3);
        let taken = |stage: &Stage<'_>| stage.session.trace.events.last().unwrap().step.clone();
        let force = taken(&stage).unwrap()[0].as_f64().unwrap();
        assert!((force - 0.6).abs() < 1e-9, "{force}");
        assert_eq!((stage.session.steps, stage.session.score), (3, 3.0));
        assert!(pass(&mut stage, idle, &[], 0) != first);
        pass(&mut stage, idle, &["A"], 1);
        assert_eq!(taken(&stage), Some(json!([2.0])));
        pass(&mut stage, idle, &["Space"], 1);
        assert_eq!(stage.session.steps, 4, "it is paused");
        pass(&mut stage, idle, &["Period"], 1);
        assert_eq!(stage.session.steps, 5);
        pass(&mut stage, idle, &["0"], 0);
        assert_eq!(stage.sliders[0].value, 0.0);
        let press =
            |stage: &mut Stage<'_>, pass: &mut dyn FnMut(&mut Stage<'_>, Pointer), name: &str| {
                let at = place(stage, name, 0.5);
                pass(stage, at);
                pass(stage, idle);
            };
        let mut click = |stage: &mut Stage<'_>, at: Pointer| drop(pass(stage, at, &[], 0));
        // what keys do, buttons do too
        stage.reset().unwrap();
        press(&mut stage, &mut click, "Run");
        assert!(!stage.is_paused);
        press(&mut stage, &mut click, "Step");
        assert_eq!((stage.session.steps, stage.is_paused), (1, true));
        stage.sliders[0].value = 0.5;
        press(&mut stage, &mut click, "all to zero");
        assert_eq!(stage.sliders[0].value, 0.0);
        press(&mut stage, &mut click, "Run");
        press(&mut stage, &mut click, "Pause");
        assert!(stage.is_paused);
        let at = place(&stage, "Reset", 0.5);
        pass(&mut stage, at, &[], 0);
        assert_eq!((stage.session.steps, stage.session.episode), (0, 3));
        // the camera turns and comes nearer
        let drag = |x: f64| Pointer {
            at: [x, 100.0],
            left: true,
            ..idle
        };
        let before = pass(&mut stage, idle, &[], 0);
        pass(&mut stage, drag(100.0), &[], 0);
        pass(&mut stage, drag(200.0), &[], 0);
        let turned = pass(&mut stage, idle, &[], 0);
        assert!(before != turned);
        let wheel = Pointer {
            at: [100.0; 2],
            wheel: 2.0,
            ..idle
        };
        assert!(pass(&mut stage, wheel, &[], 0) != turned);
        input.follow(idle, vec!["Escape".to_owned()]);
        assert!(!stage.update(&input, 0, &mut frame).unwrap());
    }

    /// The texts of the panel.
    fn texts(stage: &mut Stage<'_>) -> String {
        let area = Area {
            min: (0, 0),
            size: (320, 900),
        };
        let log = DrawLog::of(|canvas| {
            let input = Input::default();
            Panel::default().rows(area, &input, canvas, |rows| {
                stage.rows(rows, &input).unwrap();
            });
        });
        let log = log.to_string();
        let quoted = log.lines().filter_map(|line| line.split('"').nth(1));
        quoted.collect::<Vec<_>>().join(" | ")
    }

    #[test]
    fn the_panel_says_where_the_game_is() {
        let arguments: Arguments = inputs::parsed("InvertedPendulum-v5 --seed 1");
        let mut session = Session::start(&arguments).unwrap();
        let keys = Keys::new(json!({}));
        let sliders = sliders(&session.trace.id, &session.env).unwrap();
        let mut stage = Stage::new(&mut session, &keys, sliders);
        let (mut frame, mut input) = (Frame::new(900, 480).unwrap(), Input::default());
        let [keys, drag] = [
            "Space pauses, . steps, R restarts | 0 clears, Escape quits",
            "drag turns the camera, the wheel moves it",
        ];
        let panel = |place: &str, gained: [f64; 2], run: &str, value: &str| {
            let [reward, score] = gained.map(short);
            format!(
                "InvertedPendulum-v5 | {place} | reward {reward} | return {score} | {keys} | {drag} | {run} | Step | \
                 Reset | all to zero | Action | force of slide (100 N) | {value}"
            )
        };
        let expected = panel("episode 1, step 0", [0.0, 0.0], "Pause", "0");
        assert_eq!(texts(&mut stage), expected);
        stage.sliders[0].value = 0.25;
        assert!(stage.update(&input, 2, &mut frame).unwrap());
        let expected = panel("episode 1, step 2", [1.0, 2.0], "Pause", "0.250");
        assert_eq!(texts(&mut stage), expected);
        input.follow(Pointer::default(), vec!["Space".to_owned()]);
        assert!(stage.update(&input, 2, &mut frame).unwrap());
        let expected = panel("episode 1, step 2", [1.0, 2.0], "Run", "0.250");
        assert_eq!(texts(&mut stage), expected);
        stage.reset().unwrap();
        let expected = panel("episode 2, step 0", [0.0, 0.0], "Run", "0.250");
        assert_eq!(texts(&mut stage), expected);
    }

    /// A square picture and a wide one, in the middle of an area of another shape.
    #[test]
    fn the_picture_is_that_of_the_environment() {
        for id in ["InvertedPendulum-v5", "dm_control/cartpole-balance-v0"] {
            let arguments: Arguments = inputs::parsed(&format!("{id} --seed 1"));
            let mut session = Session::start(&arguments).unwrap();
            let keys = Keys::new(json!({}));
            let sliders = sliders(&session.trace.id, &session.env).unwrap();
            let mut stage = Stage::new(&mut session, &keys, sliders);
            let mut window = Frame::new(760, 300).unwrap();
            assert!(stage.update(&Input::default(), 0, &mut window).unwrap());
            let (width, height) = stage.session.env.metadata().render_size;
            let wide = (300 * width / height).min(440);
            let high = wide * height / width;
            let builder = gym::builder(id).render_mode(gym::render::RenderMode::RgbArray);
            let mut env = builder.render_size(wide, high).build().unwrap();
            env.reset(1).unwrap();
            let picture = env.render().unwrap().into_frame().unwrap();
            let [left, top] = [(440 - wide) / 2, (300 - high) / 2].map(|side| side as usize);
            for (y, row) in picture.pixels().chunks(3 * wide as usize).enumerate() {
                let start = 3 * (760 * (top + y) + left);
                assert!(
                    window.pixels()[start..start + row.len()] == *row,
                    "{id}, row {y}"
                );
            }
        }
    }
}
