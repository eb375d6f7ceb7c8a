//! Models of several files, and shapes and surfaces without files, are libmujoco's.
//! `recorded/language.py` recorded them.

use std::sync::atomic::{AtomicUsize, Ordering};

use mujoco_engine::{Data, Model, Revision, step};
use serde_json::{Value, json};

use crate::assets::Folder;
use crate::common::same;

#[test]
fn attached_models_and_what_needs_no_file_are_as_in_libmujoco() {
    let recorded: Value = serde_json::from_str(include_str!("../recorded/language.json")).unwrap();
    let files = recorded["files"].as_object().unwrap().iter();
    let files: Vec<_> = files
        .map(|(name, text)| (&**name, text.as_str().unwrap()))
        .collect();
    let folder = Folder::new("recorded", &files);
    let mut models = 0;
    for (version, of_version) in recorded["versions"].as_object().unwrap() {
        let revision: Revision = version.parse().unwrap();
        for (name, expected) in of_version.as_object().unwrap() {
            let m =
                Model::from_path_with(folder.path().join(format!("{name}.xml")), revision).unwrap();
            let place = format!("{version} {name}");
            let own = names(&m);
            assert!(
                same(&own, &expected["names"]),
                "{place}: {own} for {}",
                expected["names"]
            );
            if let Some(keys) = expected["keys"].as_object() {
                let own = json!({
                    "time": m.key_time, "qpos": m.key_qpos, "qvel": m.key_qvel, "act": m.key_act,
                    "ctrl": m.key_ctrl, "mpos": m.key_mpos
                });
                for (list, expected) in keys {
                    assert!(
                        same(&own[list], expected),
                        "{place}, {list}: {} for {expected}",
                        own[list]
                    );
                }
            }
            let mut d = Data::new(&m);
            for _ in 0..expected["steps"].as_u64().unwrap() {
                for (k, control) in d.ctrl.iter_mut().enumerate() {
                    *control = 0.1 * (k + 1) as f64;
                }
                step(&m, &mut d);
            }
            let own = json!({"qpos": d.qpos, "sensordata": d.sensordata});
            for list in ["qpos", "sensordata"] {
                let expected = &expected[list];
                assert!(
                    same(&own[list], expected),
                    "{place}, {list}: {} for {expected}",
                    own[list]
                );
            }
            models += 1;
        }
    }
    assert_eq!(models, 18);
}

fn names(m: &Model) -> Value {
    let names = &m.names;
    json!({
        "body": names.body, "joint": names.joint, "geom": names.geom, "site": names.site, "tendon": names.tendon,
        "actuator": names.actuator, "sensor": names.sensor, "equality": names.equality, "key": names.key
    })
}

/// The message about an element of `parent.xml`, beside `kid.xml` and a model that attaches itself.
fn refused(assets: &str, world: &str) -> String {
    let parent =
        format!("<mujoco>\n<asset>{assets}</asset>\n<worldbody>\n{world}\n</worldbody></mujoco>");
    let kid = r#"<mujoco model="kid"><worldbody><body name="b"><geom name="g" size="1"/></body></worldbody></mujoco>"#;
    let ring = r#"<mujoco><asset><model name="ring" file="ring.xml"/></asset></mujoco>"#;
    let broken = "<mujoco>\n<worldbody><geom size=\"-1\" typo=\"2\"/></worldbody></mujoco>";
    static NUMBER: AtomicUsize = AtomicUsize::new(0);
    let number = NUMBER.fetch_add(1, Ordering::Relaxed);
    let folder = Folder::new(
        &format!("refused-{number}"),
        &[
            ("parent.xml", &parent),
            ("kid.xml", kid),
            ("ring.xml", ring),
            ("broken.xml", broken),
        ],
    );
    folder.model("parent.xml").unwrap_err().to_string()
}

#[test]
fn what_cannot_be_attached_is_an_error_at_its_place() {
    let kid = r#"<model name="kid" file="kid.xml"/>"#;
    for (assets, world, told) in [
        (
            r#"<model file="none.xml"/>"#,
            "",
            "line 2: <model> attribute \"file\": there is no file",
        ),
        (
            r#"<model file="ring.xml"/>"#,
            "",
            "would be a part of itself",
        ),
        (
            r#"<model file="parent.xml"/>"#,
            "",
            "would be a part of itself",
        ),
        (
            r#"<model file="broken.xml"/>"#,
            "",
            "broken.xml: line 2: <geom> attribute \"typo\"",
        ),
        (
            r#"<model file="kid.xml" content_type="text/xml"/>"#,
            "",
            "only file and name is",
        ),
        (
            kid,
            r#"<attach model="kit" body="b" prefix="p"/>"#,
            "line 4: <attach> attribute \"model\": there is no model \"kit\"",
        ),
        (
            kid,
            r#"<attach model="kid" body="c" prefix="p"/>"#,
            "attribute \"body\": the model has no body \"c\"",
        ),
        (
            kid,
            r#"<attach model="kid" frame="b" prefix="p"/>"#,
            "attribute \"frame\": the model has no frame \"b\"",
        ),
        (
            kid,
            r#"<attach model="kid" body="b"/>"#,
            "attribute \"prefix\": missing",
        ),
        (
            kid,
            r#"<attach model="kid" body="b" frame="b" prefix="p"/>"#,
            "attribute \"frame\": does not go with body",
        ),
        (
            "",
            r#"<attach prefix="p"/>"#,
            "attribute \"body\": missing: without model",
        ),
        (
            "",
            r#"<attach body="a" prefix="p"/><body name="a"/>"#,
            "there is no body \"a\" before this element",
        ),
        (
            "",
            r#"<body name="a"><attach body="a" prefix="p"/></body>"#,
            "\"a\" would be a part of itself",
        ),
        (
            kid,
            r#"<attach model="kid" body="b" prefix="p"/><attach model="kid" body="b" prefix="p"/>"#,
            "there is a body \"pb\" already",
        ),
    ] {
        let error = refused(assets, world);
        assert!(error.contains(told), "{assets}{world}: {error}");
    }
}

/// A short text of models within models cannot ask for much memory.
#[test]
fn models_within_models_are_counted() {
    let double = |of: &str| {
        format!(
            "<mujoco model=\"m\"><asset><model name=\"of\" file=\"{of}\"/></asset><worldbody>\
             <attach model=\"of\" prefix=\"{0}a\"/><attach model=\"of\" prefix=\"{0}b\"/></worldbody></mujoco>",
            "long".repeat(200)
        )
    };
    let mut files = vec![(
        "0.xml".to_owned(),
        "<mujoco><worldbody><geom name=\"g\" size=\"1\"/></worldbody></mujoco>".to_owned(),
    )];
    for level in 1..12 {
        files.push((
            format!("{level}.xml"),
            double(&format!("{}.xml", level - 1)),
        ));
    }
    let files: Vec<_> = files
        .iter()
        .map(|(name, text)| (&**name, &**text))
        .collect();
    let folder = Folder::new("counted", &files);
    let names = folder.model("9.xml").unwrap_err().to_string();
    assert!(names.contains("bytes"), "{names}");
    let models = folder.model("11.xml").unwrap_err().to_string();
    assert!(
        models.contains("more than 10 models within each other"),
        "{models}"
    );
}

#[test]
fn parameters_of_shapes_are_checked() {
    for (shape, params) in [
        ("sphere", "5"),
        ("sphere", "1 2"),
        ("hemisphere", "-1"),
        ("supersphere", "2 1 1"),
        ("supersphere", "1e9 1 1"),
        ("supertorus", "9 2 1 1"),
        ("supertorus", "9 .5 0 1"),
        ("cone", "2 1"),
    ] {
        let text = format!(
            "<mujoco>\n<asset><mesh name=\"m\" builtin=\"{shape}\" params=\"{params}\"/></asset></mujoco>"
        );
        let error = Model::from_xml(&text).unwrap_err().to_string();
        assert!(
            error.contains("line 2: <mesh>: params must be"),
            "{shape} {params}: {error}"
        );
    }
}
