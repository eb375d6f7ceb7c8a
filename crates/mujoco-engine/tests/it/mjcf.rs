//! Models that the reader of MJCF refuses. Each error names the line, the element and the
//! attribute.

use mujoco_engine::{Error, Model};

/// Returns a model with `line`, which has an error, as line 4.
fn in_the_world(line: &str) -> String {
    format!(
        "<mujoco>\n<worldbody>\n<geom type=\"plane\" size=\"1 1 1\"/>\n{line}\n</worldbody>\n</mujoco>"
    )
}

/// Returns a model with a section `line`, which has an error, as line 6.
fn section(line: &str) -> String {
    format!(
        "<mujoco>\n<worldbody>\n<body name=\"b\">\n<joint name=\"j\"/><geom size=\"0.1\"/></body><body name=\"f\"><freejoint name=\"free\"/><geom size=\"1\"/></body>\n</worldbody>\n{line}\n</mujoco>"
    )
}

/// The text of a model, and the line, element and attribute that its error must name.
pub(super) type Refused = (String, u32, &'static str, Option<&'static str>);

fn refused() -> Vec<Refused> {
    let world = |line: &str, element, attribute| (in_the_world(line), 4, element, attribute);
    let other = |line: &str, element, attribute| (section(line), 6, element, attribute);
    let body = |line: &str, element, attribute| {
        (
            in_the_world(&format!("<body>{line}<geom size=\"0.1\"/></body>")),
            4,
            element,
            attribute,
        )
    };
    vec![
        // features that are not supported
        world("<geom type=\"mesh\" mesh=\"m\"/>", "geom", Some("mesh")),
        world("<geom type=\"mesh\"/>", "geom", Some("mesh")),
        world("<geom size=\"1\" typo=\"3\"/>", "geom", Some("typo")),
        world("<nonsense/>", "nonsense", None),
        world("<joint/>", "joint", None),
        body(
            "<joint springdamper=\"1 -1\"/>",
            "joint",
            Some("springdamper"),
        ),
        body("<freejoint align=\"maybe\"/>", "freejoint", Some("align")),
        world(
            "<camera focal=\"1 1\" resolution=\"9 9\"/>",
            "camera",
            Some("sensorsize"),
        ),
        world(
            "<camera sensorsize=\"1 1\" fovy=\"40\"/>",
            "camera",
            Some("sensorsize"),
        ),
        world("<light target=\"none\"/>", "light", Some("target")),
        world(
            "<light type=\"point\" directional=\"true\"/>",
            "light",
            Some("type"),
        ),
        other(
            "<compiler coordinate=\"global\"/>",
            "compiler",
            Some("coordinate"),
        ),
        other("<include file=\"x.xml\"/>", "include", Some("file")),
        other("<asset><mesh/></asset>", "mesh", Some("name")),
        other("<tendon><spatial/></tendon>", "spatial", None),
        other(
            "<contact><pair geom1=\"a\" geom2=\"b\"/></contact>",
            "pair",
            Some("geom1"),
        ),
        other("<keyframe><key act=\"1\"/></keyframe>", "key", Some("act")),
        // invalid values
        world("<geom size=\"nan\"/>", "geom", Some("size")),
        world("<geom size=\"1e999\"/>", "geom", Some("size")),
        world("<geom size=\"1,2\"/>", "geom", Some("size")),
        world("<geom size=\"\"/>", "geom", Some("size")),
        world("<geom size=\"-1\"/>", "geom", Some("size")),
        world("<geom/>", "geom", Some("size")),
        world("<geom size=\"1\" pos=\"1 2\"/>", "geom", Some("pos")),
        world("<geom size=\"1\" pos=\"1 2 3 4\"/>", "geom", Some("pos")),
        world("<geom size=\"1\" quat=\"0 0 0 0\"/>", "geom", Some("quat")),
        world(
            "<geom size=\"1\" quat=\"1 0 0 0\" euler=\"1 0 0\"/>",
            "geom",
            Some("euler"),
        ),
        world(
            "<geom size=\"1\" fromto=\"0 0 0 1 0 0\"/>",
            "geom",
            Some("fromto"),
        ),
        world(
            "<geom size=\"1\" type=\"capsule\" fromto=\"1 0 0 1 0 0\"/>",
            "geom",
            Some("fromto"),
        ),
        world(
            "<geom size=\"1\" contype=\"1.5\"/>",
            "geom",
            Some("contype"),
        ),
        world("<geom size=\"1\" class=\"none\"/>", "geom", Some("class")),
        world(
            "<geom size=\"1\" material=\"none\"/>",
            "geom",
            Some("material"),
        ),
        world(
            "<geom size=\"1\" name=\"x\"/><geom size=\"1\" name=\"x\"/>",
            "geom",
            Some("name"),
        ),
        // numbers that follow from others and are infinite
        world("<body><geom size=\"1e150\"/></body>", "geom", None),
        body(
            "<joint/><geom size=\"1e3\" density=\"1e300\"/>",
            "geom",
            None,
        ),
        body(
            "<joint/><geom size=\"1\" mass=\"8e307\"/><geom size=\"1\" mass=\"8e307\"/><geom size=\"1\" mass=\"8e307\"/>",
            "body",
            None,
        ),
        body(
            "<inertial pos=\"0 0 0\" mass=\"1\" fullinertia=\"1e308 1e308 1e308 1e308 1e308 1e308\"/>",
            "inertial",
            None,
        ),
        world(
            "<geom type=\"box\" size=\"1e200 1e200 1e200\"/>",
            "geom",
            None,
        ),
        world(
            "<frame pos=\"1e308 0 0\"><geom size=\"1\" pos=\"1e308 0 0\"/></frame>",
            "geom",
            None,
        ),
        world("<body><joint/></body>", "body", None),
        world(
            "<body><freejoint/><geom type=\"plane\" size=\"1 1 1\"/></body>",
            "geom",
            Some("type"),
        ),
        world(
            "<body><body><freejoint/><geom size=\"1\"/></body></body>",
            "freejoint",
            Some("type"),
        ),
        body("<joint range=\"1 -1\"/>", "joint", Some("range")),
        body("<joint range=\"1 1\"/>", "joint", Some("range")),
        body("<joint axis=\"0 0 0\"/>", "joint", Some("axis")),
        body("<freejoint/><joint/>", "freejoint", Some("type")),
        body("<inertial mass=\"1\"/>", "inertial", Some("pos")),
        body(
            "<inertial pos=\"0 0 0\" mass=\"1\" diaginertia=\"1 1 5\"/>",
            "inertial",
            None,
        ),
        other(
            "<actuator><motor joint=\"none\"/></actuator>",
            "motor",
            Some("joint"),
        ),
        other(
            "<tendon><fixed><joint joint=\"free\" coef=\"1\"/></fixed></tendon>",
            "joint",
            Some("joint"),
        ),
        other("<actuator><motor/></actuator>", "motor", Some("joint")),
        other(
            "<actuator><motor joint=\"j\" ctrlrange=\"1 0\"/></actuator>",
            "motor",
            Some("ctrlrange"),
        ),
        other(
            "<contact><exclude body1=\"b\" body2=\"none\"/></contact>",
            "exclude",
            Some("body2"),
        ),
        other(
            "<keyframe><key qpos=\"1 2 3 4 5 6 7 8 9\"/></keyframe>",
            "key",
            Some("qpos"),
        ),
        body(
            "<inertial pos=\"0 0 0\" mass=\"1\" diaginertia=\"1 1 1\"/>\
             <inertial pos=\"0 0 0\" mass=\"1\" diaginertia=\"1 1 1\"/>",
            "inertial",
            None,
        ),
        other("<option timestep=\"0\"/>", "option", Some("timestep")),
        other("<option timestep=\"-0.01\"/>", "option", Some("timestep")),
        other("<statistic extent=\"0\"/>", "statistic", Some("extent")),
        other(
            "<statistic meaninertia=\"-1\"/>",
            "statistic",
            Some("meaninertia"),
        ),
        other("<size nkey=\"1001\"/>", "size", Some("nkey")),
        world(
            "<camera mode=\"targetbody\" target=\"none\"/>",
            "camera",
            Some("target"),
        ),
        // sensors and actuators
        other(
            "<sensor><contact data=\"force found\"/></sensor>",
            "contact",
            Some("data"),
        ),
        other(
            "<sensor><contact num=\"0\"/></sensor>",
            "contact",
            Some("num"),
        ),
        other(
            "<sensor><contact body1=\"b\" geom1=\"g\"/></sensor>",
            "contact",
            Some("geom1"),
        ),
        other(
            "<sensor><distance body1=\"b\"/></sensor>",
            "distance",
            Some("geom2"),
        ),
        other(
            "<sensor><rangefinder/></sensor>",
            "rangefinder",
            Some("site"),
        ),
        other(
            "<actuator><adhesion body=\"b\" ctrlrange=\"-1 1\"/></actuator>",
            "adhesion",
            Some("ctrlrange"),
        ),
        other(
            "<actuator><motor joint=\"j\" cranklength=\"1\"/></actuator>",
            "motor",
            Some("slidersite"),
        ),
        // damaged XML
        ("<mujoco>\n<worldbody>".into(), 1, "mujoco", None),
        ("".into(), 1, "mujoco", None),
        ("<mujoco>\n\n<a></b></mujoco>".into(), 3, "mujoco", None),
        (
            "<!DOCTYPE x [<!ENTITY a \"b\">]><mujoco>&a;</mujoco>".into(),
            1,
            "mujoco",
            None,
        ),
        ("<robot/>".into(), 1, "robot", None),
    ]
}

#[test]
fn errors_name_line_element_and_attribute() {
    let mut wrong = Vec::new();
    for (text, line, element, attribute) in refused() {
        let Err(error) = Model::from_xml(&text) else {
            wrong.push(format!("{text}\nis read"));
            continue;
        };
        let message = error.to_string();
        let Error::Mjcf {
            line: l,
            element: e,
            attribute: a,
            reason,
        } = error
        else {
            wrong.push(format!("{text}\n{message}"));
            continue;
        };
        if (l, &*e, a.as_deref()) != (line, element, attribute) {
            wrong.push(format!("{text}\nline {l}, {e}, {a:?}: {reason}"));
        }
        if !message.contains(&format!("line {line}")) || !message.contains(element) {
            wrong.push(format!("{text}\n{message}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n\n"));
}

/// MuJoCo makes an empty model of a file that is a part of another.
#[test]
fn a_part_of_a_model_is_a_model_without_it() {
    let part = Model::from_xml("<mujoco><body><geom size=\"1\"/></body><frame/></mujoco>").unwrap();
    assert_eq!((part.nbody(), part.ngeom()), (1, 0));
}

#[test]
fn a_sensor_gives_the_field_of_view() {
    let m = Model::from_xml(&in_the_world(
        "<camera resolution=\"64 48\" sensorsize=\".004 .003\" focal=\".002 .002\"/>\
         <camera projection=\"orthographic\" fovy=\"3\"/><light type=\"image\"/>",
    ))
    .unwrap();
    // as libmujoco, which computes in single precision
    assert_eq!(m.cam_fovy[0], 73.739_794_619_157_35);
    assert_eq!(m.cam_fovy[1], 3.0);
    assert_eq!(m.cam_projection, [0, 1]);
    assert_eq!(m.cam_intrinsic[0][0], f64::from(0.002_f32));
    assert_eq!(m.light_type, [3]);
}
