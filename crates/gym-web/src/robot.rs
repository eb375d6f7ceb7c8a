//! A robot of the reader: a model of files in memory, and a viewer of it.

use std::collections::BTreeMap;
use std::sync::Arc;

use gym::render::{Frame, Painter as _, Raster};
use gym::{Error, Result};
#[cfg(feature = "compiled")]
use gym_sim::engine::CompiledModel;
use gym_sim::engine::model::{GeomType, ObjectType};
use gym_sim::engine::{Model, Revision};
use gym_sim::keyframes;
use gym_sim::viewer::{Viewer, name};
use serde::Deserialize;
use serde_json::{Value as Json, json};

use crate::describe;

/// The largest width and height of a picture.
const MOST: u32 = 4096;
/// The keyframe that holds the state with which a compiled model comes.
const NOW: &str = "now";
/// Samples of a pixel in a row, in a picture that stands still.
const FINE: usize = 3;

/// A request about the robot. Points are pixels of a picture of the size `size`; movements are in
/// heights of the picture, to the right and down.
#[derive(Deserialize)]
#[serde(tag = "do", rename_all = "snake_case", deny_unknown_fields)]
pub(crate) enum Request {
    /// Forgets all files and the model.
    Forget,
    /// Stores a file, whose bytes are attached.
    File { path: String },
    /// Opens the model in a file.
    Open { main: String },
    /// Opens a compiled model, whose JSON is attached, at its keyframe `now`.
    #[cfg(feature = "compiled")]
    Compiled,
    /// Advances by `seconds` at the current speed, but by at most `most` timesteps.
    Advance { seconds: f64, most: usize },
    /// Advances by a timestep.
    Step,
    /// Stops or starts the time.
    Pause { is: bool },
    /// Changes the speed.
    Speed { speed: f64 },
    /// Resets to the initial configuration or to a keyframe.
    Reset { keyframe: Option<String> },
    /// Sets the control of an actuator.
    Control { actuator: usize, value: f64 },
    /// Looks through a camera of the model, or the free one.
    Camera { camera: Option<usize> },
    /// Turns the free camera.
    Turn { by: [f64; 2] },
    /// Moves the free camera.
    Move { by: [f64; 2] },
    /// Moves the free camera away, or nearer.
    Zoom { by: f64 },
    /// Selects the body at a point, to be pulled.
    Select { at: [f64; 2], size: [u32; 2] },
    /// Pulls the selected body to a point.
    Pull { at: [f64; 2], size: [u32; 2] },
    /// Lets go.
    Release,
    /// Lets the free camera follow the selected body, if any.
    Follow,
    /// Shows contacts and their forces.
    Contacts { are: bool },
    /// Draws the state, attached as RGBA; edges of meshes are smooth if it is `fine`.
    Frame { size: [u32; 2], fine: bool },
    /// The last values of each number of a sensor.
    History { sensor: usize },
}

/// The files that the reader gave, and the model of one of them.
#[derive(Default)]
pub(crate) struct Robot {
    files: BTreeMap<String, Vec<u8>>,
    viewer: Option<Viewer>,
    raster: Raster,
    frame: Option<Frame>,
}

impl Robot {
    /// Answers a request; a picture goes to `attachment`.
    pub(crate) fn answer(
        &mut self,
        request: Request,
        bytes: &[u8],
        attachment: &mut Vec<u8>,
    ) -> Result<Json> {
        match request {
            Request::Forget => *self = Self::default(),
            Request::File { path } => {
                self.files.insert(path, bytes.to_vec());
            }
            Request::Open { main } => {
                self.viewer = None;
                let model = Model::from_files(&self.files, &main, Revision::default());
                return self.show(model.map_err(refused)?);
            }
            #[cfg(feature = "compiled")]
            Request::Compiled => {
                self.viewer = None;
                let model: CompiledModel = serde_json::from_slice(bytes)
                    .map_err(|error| Error::custom(format!("not a compiled model: {error}")))?;
                return self.show(Model::new(model).map_err(refused)?);
            }
            Request::Advance { seconds, most } => {
                let mut left = most;
                let taken = self.viewer()?.advance(seconds, || {
                    let goes_on = left > 0;
                    left = left.saturating_sub(1);
                    goes_on
                })?;
                return Ok(json!(taken));
            }
            Request::Step => self.viewer()?.step(1)?,
            Request::Pause { is } => self.viewer()?.is_paused = is,
            Request::Speed { speed } => self.viewer()?.set_speed(speed)?,
            Request::Reset { keyframe: None } => self.viewer()?.reset(),
            Request::Reset {
                keyframe: Some(name),
            } => self.viewer()?.reset_to(&name)?,
            Request::Control { actuator, value } => self.viewer()?.set_control(actuator, value)?,
            Request::Camera { camera } => self.viewer()?.use_camera(camera)?,
            Request::Turn { by } => self.viewer()?.turn_by(by),
            Request::Move { by } => self.viewer()?.move_by(by, false),
            Request::Zoom { by } => self.viewer()?.zoom_by(by),
            Request::Select { at, size } => {
                let viewer = self.viewer()?;
                let hit = viewer.select(at, size.into());
                let body = hit.map(|hit| name(viewer.model(), ObjectType::Body, hit.body));
                return Ok(json!({"body": body, "moves": viewer.is_pulling()}));
            }
            Request::Pull { at, size } => self.viewer()?.pull(at, size.into()),
            Request::Release => self.viewer()?.release(),
            Request::Follow => {
                let viewer = self.viewer()?;
                let body = viewer.selected().map(|hit| hit.body);
                viewer.follow(body);
            }
            Request::Contacts { are } => {
                let viewer = self.viewer()?;
                (viewer.shows_contacts, viewer.shows_forces) = (are, are);
            }
            Request::Frame { size, fine } => {
                self.viewer()?.samples = if fine { FINE } else { 1 };
                return self.draw(size, attachment);
            }
            Request::History { sensor } => {
                let viewer = self.viewer()?;
                let numbers = 0..viewer.sensor(sensor).len();
                let history = |number| viewer.history(sensor, number).collect::<Vec<_>>();
                return Ok(numbers.map(history).collect());
            }
        }
        Ok(Json::Null)
    }

    fn viewer(&mut self) -> Result<&mut Viewer> {
        let reason = "no robot is open";
        self.viewer.as_mut().ok_or_else(|| Error::custom(reason))
    }

    /// Makes a viewer of the model, and describes it.
    fn show(&mut self, model: Model) -> Result<Json> {
        let mut viewer = Viewer::new(Arc::new(model))?;
        if viewer.model().key_id(NOW).is_some() {
            viewer.reset_to(NOW)?;
        }
        let description = about(&viewer);
        self.viewer = Some(viewer);
        Ok(description)
    }

    fn draw(&mut self, [width, height]: [u32; 2], rgba: &mut Vec<u8>) -> Result<Json> {
        if !(1..=MOST).contains(&width) || !(1..=MOST).contains(&height) {
            let reason = format!("{width}x{height} is not from 1x1 to {MOST}x{MOST} pixels");
            return Err(Error::argument("size", reason));
        }
        let viewer = self.viewer.as_ref();
        let viewer = viewer.ok_or_else(|| Error::custom("no robot is open"))?;
        let is_fit = |frame: &Frame| (frame.width(), frame.height()) == (width, height);
        let frame = match self.frame.take().filter(is_fit) {
            Some(frame) => frame,
            None => Frame::new(width, height)?,
        };
        let frame = self.frame.insert(frame);
        let size = (width, height);
        let mut draw = |canvas: &mut dyn gym::canvas::Canvas| viewer.draw(size, canvas);
        self.raster.paint(size, &mut draw, frame);
        describe::to_rgba(frame.pixels(), 3, rgba);
        let data = viewer.data();
        Ok(json!({
            "width": width,
            "height": height,
            "time": data.time,
            "controls": data.ctrl,
            "contacts": data.contact.len(),
        }))
    }
}

/// Describes a model: what the page shows of it, and its controls.
fn about(viewer: &Viewer) -> Json {
    let m = viewer.model();
    let controls = viewer.controls().iter();
    let controls = controls.zip(&viewer.data().ctrl).map(
        |(control, value)| json!({"name": control.name, "range": control.range, "value": value}),
    );
    let sensors = viewer.sensors().iter().map(|sensor| {
        json!({"name": sensor.name, "kind": format!("{:?}", sensor.kind), "numbers": sensor.range().len()})
    });
    let cameras = 0..m.cam_mode.len();
    let cameras = cameras.map(|camera| name(m, ObjectType::Camera, camera));
    let meshes = m.geom_type.iter().filter(|kind| **kind == GeomType::Mesh);
    json!({
        "name": m.model,
        "mujoco": m.revision.to_string(),
        "timestep": m.opt.timestep,
        "bodies": m.nbody() - 1,
        "joints": m.njnt(),
        "freedom": m.nv(),
        "geoms": m.ngeom(),
        "meshes": meshes.count(),
        "mass": m.body_mass.iter().sum::<f64>(),
        "controls": controls.collect::<Vec<_>>(),
        "sensors": sensors.collect::<Vec<_>>(),
        "cameras": cameras.collect::<Vec<_>>(),
        "keyframes": keyframes(m),
    })
}

#[expect(
    clippy::needless_pass_by_value,
    reason = "`map_err` passes errors by value"
)]
fn refused(error: gym_sim::engine::Error) -> Error {
    Error::custom(error.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    const MESH: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
    const TEXT: &str = r#"<mujoco model="arm"><compiler meshdir="m"/>
        <asset><mesh file="tip.obj"/></asset>
        <worldbody><camera name="eye"/><body name="upper"><joint name="elbow" axis="0 1 0"/><geom type="mesh" mesh="tip"/></body></worldbody>
        <actuator><motor name="pull" joint="elbow" ctrlrange="-2 2"/></actuator>
        <sensor><jointpos name="angle" joint="elbow"/></sensor>
        <keyframe><key name="up" qpos="1" ctrl="0.5"/></keyframe></mujoco>"#;

    /// What the page does: a request in JSON, and bytes.
    fn ask(robot: &mut Robot, request: Json, bytes: &[u8]) -> Result<(Json, Vec<u8>)> {
        let mut attachment = Vec::new();
        let request = serde_json::from_value(request).unwrap();
        let answer = robot.answer(request, bytes, &mut attachment)?;
        Ok((answer, attachment))
    }

    fn opened() -> (Robot, Json) {
        let mut robot = Robot::default();
        for (path, text) in [("arm/arm.xml", TEXT), ("arm/m/tip.obj", MESH)] {
            ask(
                &mut robot,
                json!({"do": "file", "path": path}),
                text.as_bytes(),
            )
            .unwrap();
        }
        let (about, _) = ask(
            &mut robot,
            json!({"do": "open", "main": "arm/arm.xml"}),
            &[],
        )
        .unwrap();
        (robot, about)
    }

    #[test]
    fn a_robot_of_files_is_described_stepped_and_drawn() {
        let (mut robot, about) = opened();
        let expected = json!({
            "name": "arm", "bodies": 1, "joints": 1, "freedom": 1, "geoms": 1, "meshes": 1, "cameras": ["eye"], "keyframes": ["up"],
            "controls": [{"name": "pull", "range": [-2.0, 2.0], "value": 0.0}],
            "sensors": [{"name": "angle", "kind": "JointPos", "numbers": 1}],
        });
        for (name, value) in expected.as_object().unwrap() {
            assert_eq!(&about[name], value, "{name}");
        }
        let frame = json!({"do": "frame", "size": [40, 30], "fine": true});
        let (at_first, first) = ask(&mut robot, frame.clone(), &[]).unwrap();
        assert_eq!((&at_first["time"], first.len()), (&json!(0.0), 4 * 40 * 30));
        let (taken, _) = ask(
            &mut robot,
            json!({"do": "advance", "seconds": 0.2, "most": 50}),
            &[],
        )
        .unwrap();
        assert_eq!(taken, json!(50), "of 100 timesteps");
        let (later, second) = ask(&mut robot, frame.clone(), &[]).unwrap();
        let time = later["time"].as_f64().unwrap();
        assert!((time - 0.1).abs() < 1e-9 && first != second, "{later}");
        ask(
            &mut robot,
            json!({"do": "control", "actuator": 0, "value": -1.5}),
            &[],
        )
        .unwrap();
        ask(&mut robot, json!({"do": "step"}), &[]).unwrap();
        let (history, _) = ask(&mut robot, json!({"do": "history", "sensor": 0}), &[]).unwrap();
        assert_eq!(history[0].as_array().unwrap().len(), 6, "in 0.102 s");
        ask(&mut robot, json!({"do": "reset", "keyframe": "up"}), &[]).unwrap();
        let (reset, _) = ask(&mut robot, frame, &[]).unwrap();
        assert_eq!(
            (&reset["time"], &reset["controls"]),
            (&json!(0.0), &json!([0.5]))
        );
    }

    /// A notebook gives a compiled model, whose keyframe `now` is the state at first.
    #[cfg(feature = "compiled")]
    #[test]
    fn a_compiled_model_begins_now() {
        let mesh = "<mesh name=\"tip\" vertex=\"0 0 0 1 0 0 0 1 0 0 0 1\"/>";
        let text = TEXT.replace("<mesh file=\"tip.obj\"/>", mesh);
        let model = Model::from_xml(&text.replace("name=\"up\"", "name=\"now\" time=\"3\""));
        let model = serde_json::to_vec(&*model.unwrap()).unwrap();
        let mut robot = Robot::default();
        let (about, _) = ask(&mut robot, json!({"do": "compiled"}), &model).unwrap();
        assert_eq!(about["controls"][0]["value"], json!(0.5));
        let (frame, _) = ask(
            &mut robot,
            json!({"do": "frame", "size": [8, 8], "fine": false}),
            &[],
        )
        .unwrap();
        assert_eq!(frame["time"], json!(3.0));
        let error = ask(&mut robot, json!({"do": "compiled"}), b"{").unwrap_err();
        assert!(
            error.to_string().contains("not a compiled model"),
            "{error}"
        );
    }

    #[test]
    fn what_cannot_be_is_an_error() {
        let (mut robot, _) = opened();
        for (request, words) in [
            (
                json!({"do": "open", "main": "arm/none.xml"}),
                "arm/none.xml: there is no such file",
            ),
            (
                json!({"do": "frame", "size": [8, 8], "fine": false}),
                "no robot is open",
            ),
        ] {
            let error = ask(&mut robot, request, &[]).unwrap_err().to_string();
            assert!(error.contains(words), "{error}");
        }
        let (mut robot, _) = opened();
        for (request, words) in [
            (json!({"do": "frame", "size": [0, 8], "fine": true}), "0x8"),
            (
                json!({"do": "frame", "size": [8, 1_000_000], "fine": true}),
                "4096x4096",
            ),
            (
                json!({"do": "control", "actuator": 1, "value": 0}),
                "the model has 1",
            ),
            (json!({"do": "camera", "camera": 7}), "the model has 1"),
            (
                json!({"do": "reset", "keyframe": "down"}),
                "the model has up",
            ),
            (json!({"do": "speed", "speed": -1}), "-1"),
        ] {
            let error = ask(&mut robot, request, &[]).unwrap_err().to_string();
            assert!(error.contains(words), "{error}");
        }
        // a model that is missing a file says which
        let mut robot = Robot::default();
        ask(
            &mut robot,
            json!({"do": "file", "path": "arm.xml"}),
            TEXT.as_bytes(),
        )
        .unwrap();
        let error = ask(&mut robot, json!({"do": "open", "main": "arm.xml"}), &[]).unwrap_err();
        assert_eq!(
            error.to_string(),
            "arm.xml: line 2: <mesh> attribute \"file\": there is no file m/tip.obj"
        );
    }
}
