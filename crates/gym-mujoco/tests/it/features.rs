//! Recordings of models with single features of MuJoCo, compared with libmujoco to the last bit.

use std::path::{Path, PathBuf};

use gym_mujoco::recording;
use mujoco_engine::{Data, Model, Revision, step};
use serde_json::{Map, Value, json};

use crate::common::same;

/// The recordings that are not equal to the last bit, or not supported: name and version.
const UNLIKE: [(&str, &str); 5] = [
    // an actuator on a free body with `implicitfast` differs by 1e-17
    ("fast_free", "4.0.0"),
    // libmujoco sums over more than 60 degrees of freedom in another order
    ("humanoid_CMU-stand", "3.12.0"),
    ("humanoid_CMU-stand", "4.0.0"),
    // not supported
    ("quadruped-escape", "3.12.0"),
    ("quadruped-escape", "4.0.0"),
];

/// Returns the recordings of this crate, and further recordings in the folder `GYM_REFERENCE`.
fn recordings() -> Vec<Map<String, Value>> {
    let own = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/recorded/features");
    let more = std::env::var_os("GYM_REFERENCE").map(PathBuf::from);
    let more = more
        .iter()
        .flat_map(|folder| ["features", "features_suite"].map(|name| folder.join(name)));
    let folders = std::iter::once(own).chain(more.filter(|folder| folder.is_dir()));
    let entries = folders.flat_map(|folder| std::fs::read_dir(folder).unwrap());
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    let texts = paths
        .iter()
        .map(|path| std::fs::read_to_string(path).unwrap());
    texts
        .map(|text| serde_json::from_str(&text).unwrap())
        .collect()
}

/// Returns the first key of `expected` whose value differs in `found`.
fn first<'a>(expected: &'a Value, found: &Value) -> Option<&'a str> {
    let expected = expected.as_object().into_iter().flatten();
    let mut unlike = expected.filter(|(key, value)| {
        let found = &found[key.as_str()];
        // a scalar may be a list with one element
        !same(value, found) && !same(&Value::Array(vec![(*value).clone()]), found)
    });
    unlike.next().map(|(key, _)| key.as_str())
}

#[test]
fn features_are_as_in_libmujoco() {
    let mut compared = 0;
    for file in recordings() {
        let name = file["name"].as_str().unwrap();
        let answer = recording::answer(&file, Path::new("")).unwrap();
        for (version, expected) in file["versions"].as_object().unwrap() {
            if UNLIKE.contains(&(name, version)) {
                continue;
            }
            let error = answer.get("error");
            assert_eq!(error, None, "{name}, {version}");
            let found = &answer["versions"][version];
            let mut unlike = Vec::new();
            let steps = expected["steps"].as_array().into_iter().flatten();
            for (i, step) in steps.enumerate() {
                let fault = first(&step["after"], &found["steps"][i]["after"]);
                unlike.extend(fault.map(|key| format!("step {i}: {key}")));
            }
            for (mark, state) in expected["episode"].as_object().into_iter().flatten() {
                let fault = first(state, &found["episode"][mark]);
                unlike.extend(fault.map(|key| format!("after {mark} steps: {key}")));
            }
            assert!(unlike.is_empty(), "{name}, {version}: {unlike:?}");
            compared += 1;
        }
    }
    assert!(compared >= 88, "{compared} compared");
}

#[test]
fn a_step_of_no_feature_allocates() {
    let mut models = 0;
    for file in recordings() {
        let xml = file["xml"].as_str().unwrap();
        for revision in Revision::ALL {
            let Ok(m) = Model::from_xml_with(xml, revision) else {
                continue;
            };
            models += 1;
            let mut d = Data::new(&m);
            for i in 0..100 {
                let push = f64::from(i % 7) - 3.0;
                d.ctrl.fill(push);
                d.qfrc_applied.fill(0.1 * push);
                let count = allocation_counter::measure(|| step(&m, &mut d)).count_total;
                // the first step allocates the buffers of the model's solver and integrator
                assert!(
                    count == 0 || i == 0,
                    "{}, {revision}, step {i}",
                    file["name"]
                );
            }
        }
    }
    assert!(models >= 80, "{models} models");
}

/// A folder with a model in several files. A drop removes the folder.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str, files: &[(&str, &str)]) -> Self {
        let name = format!("gym-mujoco-{name}-{}", std::process::id());
        let folder = Self(std::env::temp_dir().join(name));
        for (file, text) in files {
            let path = folder.0.join(file);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, text).unwrap();
        }
        folder
    }

    fn model(&self, file: &str) -> Result<Model, String> {
        Model::from_path(self.0.join(file)).map_err(|error| error.to_string())
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

#[test]
fn models_include_files() {
    let folder = Folder::new(
        "include",
        &[
            (
                "model.xml",
                "<mujoco><include file=\"parts/options.xml\"/><worldbody><include file=\"parts/body.xml\"/></worldbody></mujoco>",
            ),
            (
                "parts/options.xml",
                "<mujoco><option timestep=\"0.01\"/></mujoco>",
            ),
            (
                "parts/body.xml",
                "<any><body name=\"b\"><joint/><geom size=\"0.1\"/></body></any>",
            ),
            (
                "missing.xml",
                "<mujoco>\n<include file=\"none.xml\"/></mujoco>",
            ),
            (
                "circle.xml",
                "<mujoco>\n<include file=\"circle.xml\"/></mujoco>",
            ),
            (
                "wrong.xml",
                "<mujoco><worldbody><include file=\"parts/wrong.xml\"/></worldbody></mujoco>",
            ),
            ("parts/wrong.xml", "<any>\n<geom size=\"nan\"/></any>"),
        ],
    );
    let model = folder.model("model.xml").unwrap();
    assert_eq!((model.opt.timestep, model.nbody()), (0.01, 2));
    let missing = folder.model("missing.xml").unwrap_err();
    assert!(missing.contains("none.xml"), "{missing}");
    let circle = folder.model("circle.xml").unwrap_err();
    assert!(circle.contains("circle.xml"), "{circle}");
    // an error names the file with the fault
    let wrong = folder.model("wrong.xml").unwrap_err();
    assert!(
        wrong.contains("wrong.xml") && wrong.contains("line 2"),
        "{wrong}"
    );
}

#[test]
fn texts_include_nothing() {
    let text = "<mujoco>\n<include file=\"x.xml\"/></mujoco>";
    let error = Model::from_xml(text).unwrap_err().to_string();
    assert!(
        error.contains("include") && error.contains("line 2"),
        "{error}"
    );
}

/// A recording names the file of a model instead of its text, so that the model can include others.
#[test]
fn a_recording_may_name_the_file_of_its_model() {
    let body = r#"<mujoco><body name="b"><joint axis="0 1 0"/><geom size="0.1" pos="0.2 0 0"/></body></mujoco>"#;
    let folder = Folder::new(
        "named",
        &[
            (
                "robot/model.xml",
                r#"<mujoco><worldbody><include file="body.xml"/></worldbody></mujoco>"#,
            ),
            ("robot/body.xml", body),
            (
                "robot/wrong.xml",
                "<mujoco>\n<asset><sound/></asset></mujoco>",
            ),
        ],
    );
    let answer = |model: Value| {
        let Value::Object(mut recording) = model else {
            panic!("{model}")
        };
        recording.insert("kind".into(), "features".into());
        recording.insert(
            "versions".into(),
            json!({"4.0.0": {"steps": [], "episode": {"3": {}}}}),
        );
        recording::answer(&recording, &folder.0).map_err(|error| error.to_string())
    };
    let inner = body.replace("<mujoco>", "").replace("</mujoco>", "");
    let whole = format!("<mujoco><worldbody>{inner}</worldbody></mujoco>");
    let expected = answer(json!({"xml": whole})).unwrap();
    let fell = &expected["versions"]["4.0.0"]["episode"]["3"]["qpos"][0];
    assert!(fell.as_f64().unwrap() > 0.0, "{fell}");
    assert_eq!(
        answer(json!({"file": "robot/model.xml"})).unwrap(),
        expected
    );
    let absolute = folder.0.canonicalize().unwrap().join("robot/model.xml");
    assert_eq!(answer(json!({"file": absolute})).unwrap(), expected);

    // the answer names the file and the line of a model that is refused
    let refused = answer(json!({"file": "robot/wrong.xml"})).unwrap();
    let error = refused["error"].as_str().unwrap();
    assert!(error.contains("wrong.xml: line 2: <sound>"), "{error}");
    let missing = answer(json!({"file": "none.xml"})).unwrap();
    let error = missing["error"].as_str().unwrap();
    assert!(error.contains("none.xml"), "{error}");
    for model in [json!({}), json!({"xml": whole, "file": "robot/model.xml"})] {
        let error = answer(model).unwrap_err();
        assert!(
            error.contains("`xml`") && error.contains("`file`"),
            "{error}"
        );
    }
}
