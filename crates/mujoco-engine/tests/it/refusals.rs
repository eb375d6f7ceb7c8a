//! Each model that is refused is refused with its whole message: the line, the element, the attribute, and the reason.
//! `recorded/refusals.txt` has a model on one line and its message on the next.

use std::collections::BTreeMap;

use mujoco_engine::{Model, Revision};

use crate::hfields;
use crate::reasons::WORLD;

const VERTICES: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n";
const BODY: &str =
    r#"<body name="b"><geom name="g" size=".1"/><frame name="f"><joint name="e"/></frame></body>"#;

/// The files that models name.
fn files() -> BTreeMap<String, Vec<u8>> {
    let model =
        |more: &str| format!("<mujoco><worldbody>{BODY}</worldbody>{more}</mujoco>").into_bytes();
    let shape = |face: &str| format!("{VERTICES}f {face}\n").into_bytes();
    let stl = |count: [u8; 4], rest: &str| [&[b' '; 80][..], &count, rest.as_bytes()].concat();
    let msh = |counts: [i32; 4]| counts.map(i32::to_le_bytes).concat();
    let nested = r#"<mujoco><asset><model name="k" file="keys.xml"/></asset><worldbody><body name="b"><attach model="k" body="b" prefix="k"/></body></worldbody></mujoco>"#;
    let ring = r#"<mujoco><asset><model name="ring" file="ring.xml"/></asset></mujoco>"#;
    let all = [
        ("good.obj", shape("1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4")),
        ("odd.obj", b"f 0 1 2\n".to_vec()),
        ("zero.obj", shape("1 2 x")),
        ("corner.obj", shape("1/9 2/9 3/9")),
        ("before.obj", shape("-9 2 3")),
        ("normal.obj", shape("1//1 2 3\nvn 0 0 1\nvn 1 0 0")),
        ("texture.obj", shape("1/1 2 3\nvt 0 0\nvt 1 0")),
        ("empty.obj", Vec::new()),
        ("short.stl", b"solid".to_vec()),
        ("many.stl", stl([1; 4], "")),
        ("long.stl", stl([1, 0, 0, 0], "x")),
        ("short.msh", b"x".to_vec()),
        ("few.msh", msh([3, 0, 0, 0])),
        ("faces.msh", msh([4, 0, 0, -1])),
        ("normals.msh", msh([4, 1, 0, 0])),
        ("texture.msh", msh([4, 0, 1, 0])),
        ("long.msh", msh([4, 0, 0, 0])),
        ("grey.png", hfields::bytes(hfields::GREY)),
        ("text.txt", b"v 0 0 0".to_vec()),
        ("part.xml", b"<mujoco/>".to_vec()),
        ("kid.xml", model("")),
        ("keys.xml", model(r#"<keyframe><key qpos="1"/></keyframe>"#)),
        (
            "badkeys.xml",
            model(r#"<keyframe><key qpos="1 2 3"/></keyframe>"#),
        ),
        ("nested.xml", nested.into()),
        ("broken.xml", b"<mujoco/>".to_vec()),
        ("ring.xml", ring.into()),
    ];
    all.into_iter()
        .map(|(name, bytes)| (name.to_owned(), bytes))
        .collect()
}

#[test]
fn refusals_are_told_in_the_recorded_words() {
    let mut files = files();
    let lines: Vec<_> = include_str!("../recorded/refusals.txt").lines().collect();
    assert!(lines.len() > 800, "{}", lines.len());
    let mut wrong = Vec::new();
    for pair in lines.chunks(2) {
        let [part, expected] = pair else {
            panic!("{pair:?}")
        };
        // the part that is wrong is on the second line, unless it is the whole model
        let text = if part.starts_with("<mujoco") || part.starts_with("<robot") {
            (*part).to_owned()
        } else {
            format!("<mujoco><worldbody>{WORLD}</worldbody>\n{part}\n</mujoco>")
        };
        files.insert("main.xml".to_owned(), text.into_bytes());
        let told = match Model::from_files(&files, "main.xml", Revision::default()) {
            Ok(_) => "it is read".to_owned(),
            Err(error) => error.to_string(),
        };
        let told = told.strip_prefix("main.xml: ").unwrap_or(&told);
        if told != *expected {
            wrong.push(format!("{part}\n{expected}\n{told}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n\n"));
}
