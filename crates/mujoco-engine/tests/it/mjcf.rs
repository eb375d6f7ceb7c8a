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
type Refused = (String, u32, &'static str, Option<&'static str>);

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

#[test]
fn sizes_and_depths_have_limits() {
    let deep = format!(
        "<mujoco><worldbody>{}{}</worldbody></mujoco>",
        "<body>".repeat(5000),
        "</body>".repeat(5000)
    );
    let message = Model::from_xml(&deep).unwrap_err().to_string();
    assert!(message.contains("nested deeper"), "{message}");
    let many = format!(
        "<mujoco><worldbody>{}</worldbody></mujoco>",
        "<geom size=\"1\"/>".repeat(5000)
    );
    let message = Model::from_xml(&many).unwrap_err().to_string();
    assert!(message.contains("more than 1000"), "{message}");
    // 167 bodies with a geom and six degrees of freedom each
    let free = "<body><freejoint/><geom size=\"1\"/></body>".repeat(167);
    let message = Model::from_xml(&format!("<mujoco><worldbody>{free}</worldbody></mujoco>"))
        .unwrap_err()
        .to_string();
    assert!(
        message.contains("more than 1000 bodies, geoms or degrees of freedom"),
        "{message}"
    );
    let most = "<mujoco><size nkey=\"1000\"/><worldbody/></mujoco>";
    assert_eq!(Model::from_xml(most).unwrap().key_time.len(), 1000);
    let long = " ".repeat(9 << 20);
    assert!(
        Model::from_xml(&long)
            .unwrap_err()
            .to_string()
            .contains("the limit is")
    );
}

/// Runs `work` on a thread with a small stack. (An overflow aborts the process.)
fn in_a_small_stack(work: impl FnOnce() + Send + 'static) {
    std::thread::Builder::new()
        .stack_size(128 << 10)
        .spawn(work)
        .unwrap()
        .join()
        .unwrap();
}

/// The deepest allowed nesting fits a small stack, with and without optimisation.
#[test]
fn deep_nesting_needs_no_stack() {
    let bodies = format!(
        "<mujoco><worldbody>{}{}</worldbody></mujoco>",
        "<body><joint/><geom size=\"0.1\"/>".repeat(198),
        "</body>".repeat(198)
    );
    let classes: String = (0..198)
        .map(|i| format!("<default class=\"c{i}\">"))
        .collect();
    let classes = format!(
        "<mujoco><default>{classes}{}</default></mujoco>",
        "</default>".repeat(198)
    );
    in_a_small_stack(move || {
        let model = Model::from_xml(&bodies).unwrap();
        assert_eq!((model.nbody(), model.nv()), (199, 198));
        // each body is the child of the previous body, in the order of the text
        assert!((2..199).all(|id| model.body_parentid[id] == id - 1));
        Model::from_xml(&classes).unwrap();
        let deeper = format!(
            "<mujoco><worldbody>{}",
            "<body>".repeat(300) + &"</body>".repeat(300)
        );
        let error = Model::from_xml(&(deeper + "</worldbody></mujoco>"))
            .unwrap_err()
            .to_string();
        assert!(error.contains("nested deeper than 200"), "{error}");
    });
}

/// If the time of reading were quadratic, these texts would take minutes.
#[test]
fn large_texts_are_read_in_time_or_refused() {
    let refused = |text: String, message: &str| {
        let error = Model::from_xml(&text).unwrap_err().to_string();
        assert!(error.contains(message), "{message}: {error}");
    };
    let bodies = "<body><joint/><geom size=\"0.1\"/></body>\n".repeat(40_000);
    refused(
        format!("<mujoco><worldbody>{bodies}</worldbody></mujoco>"),
        "more than 1000 bodies",
    );
    let attributes: String = (0..500_000).map(|i| format!(" a{i}=\"\"")).collect();
    refused(
        format!("<mujoco>\n<!-- <= \n --><body{attributes}/></mujoco>"),
        "more than 1000 attributes",
    );
    let namespaces: String = (0..60_000)
        .map(|i| format!("<a xmlns:a{i}=\"{i}\">"))
        .collect();
    refused(format!("<mujoco>{namespaces}"), "more than 10 namespaces");
    let classes: String = (0..90_000)
        .map(|i| format!("<default class=\"c{i}\"/>"))
        .collect();
    refused(
        format!("<mujoco><default>{classes}</default></mujoco>"),
        "more than 1000 classes",
    );
    let body = |joints: usize, geoms: usize| {
        format!(
            "<body>{}{}</body>",
            "<joint/>".repeat(joints),
            "<geom size=\"0.1\"/>".repeat(geoms)
        )
    };
    let touching = format!(
        "<mujoco><worldbody>{}{}</worldbody></mujoco>",
        body(490, 490),
        body(490, 490)
    );
    refused(touching, "too many pairs of geoms can touch");
    for (section, element, kinds) in [
        ("contact", "exclude body1=\"a\" body2=\"b\"", "excludes"),
        ("keyframe", "key", "keys"),
        ("actuator", "motor", "actuators"),
        ("asset", "material name=\"m\"", "materials"),
        ("sensor", "clock", "sensors"),
    ] {
        let elements = format!("<{element}/>").repeat(90_000);
        let text = format!("<mujoco><worldbody/><{section}>{elements}</{section}></mujoco>");
        refused(text, &format!("more than 1000 {kinds} are not supported"));
    }
    let path = "<joint joint=\"j\" coef=\"1\"/>".repeat(600);
    let tendons = format!("<fixed>{path}</fixed>").repeat(2);
    let text = format!("<mujoco><tendon>{tendons}</tendon></mujoco>");
    refused(text, "more than 1000 parts of tendons are not supported");
}

/// Whatever copies a part of the text would take gigabytes, or minutes, here.
#[test]
fn copies_are_counted_before_they_are_made() {
    let squared = |part: &str| {
        format!(
            "<mujoco>\n<worldbody>\n<replicate count=\"440\"><replicate count=\"440\">\n{part}</replicate></replicate>\n</worldbody></mujoco>"
        )
    };
    let thousand = |attributes: &str, part: &str| {
        format!(
            "<mujoco>\n<worldbody>\n<replicate count=\"1000\" {attributes}>\n{part}</replicate>\n</worldbody></mujoco>"
        )
    };
    let (name, long, huge) = ("s".repeat(900), "s".repeat(40_000), "s".repeat(7 << 20));
    let nested = format!(
        "<mujoco>\n<worldbody>\n{}<site name=\"s\"/>{}</worldbody></mujoco>",
        format!("<replicate count=\"2\" sep=\"{name}\">").repeat(150),
        "</replicate>".repeat(150)
    );
    let class = |part: &str| {
        format!(
            "<mujoco>\n\n\n<default>{part}</default><worldbody><geom size=\"1\"/></worldbody></mujoco>"
        )
    };
    let comments = "<!---->".repeat(100_000);
    let cases: Vec<Refused> = vec![
        (
            squared(&format!("<site name=\"{name}\"/>")),
            4,
            "site",
            Some("name"),
        ),
        (
            squared(&format!("<site name=\"{long}\"/>")),
            4,
            "site",
            Some("name"),
        ),
        (
            thousand("", &format!("<site name=\"{huge}\"/>")),
            4,
            "site",
            Some("name"),
        ),
        (
            thousand(&format!("sep=\"{huge}\""), "<site/>"),
            3,
            "replicate",
            Some("sep"),
        ),
        (nested, 3, "replicate", Some("sep")),
        (
            squared(&format!("<camera mode=\"targetbody\" target=\"{name}\"/>")),
            4,
            "camera",
            Some("target"),
        ),
        (
            thousand("", &format!("<geom size=\"1\" material=\"{huge}\"/>")),
            4,
            "geom",
            Some("material"),
        ),
        (
            class(&format!("<geom mesh=\"{huge}\"/>")),
            4,
            "geom",
            Some("mesh"),
        ),
        (
            class(&format!("<motor joint=\"{huge}\"/>")),
            4,
            "motor",
            Some("joint"),
        ),
        (
            squared(&format!("<site size=\"1{}\"/>", " ".repeat(7 << 20))),
            4,
            "site",
            Some("size"),
        ),
        (
            squared(&format!("<site type=\"{huge}\"/>")),
            4,
            "site",
            Some("type"),
        ),
        (
            squared(&format!("<frame>{comments}</frame>")),
            4,
            "frame",
            None,
        ),
        (
            squared(&format!("<light>{comments}</light>")),
            4,
            "light",
            None,
        ),
        (squared("<geom size=\"1\"/>"), 4, "geom", None),
        (
            format!(
                "<mujoco>\n<worldbody>\n<body>\n{}</body></worldbody></mujoco>",
                "<joint/>".repeat(20_000)
            ),
            4,
            "joint",
            None,
        ),
        (squared("<site/><site/>"), 3, "replicate", None),
    ];
    for (text, line, element, attribute) in cases {
        let error = Model::from_xml(&text).unwrap_err();
        let Error::Mjcf {
            line: l,
            element: e,
            attribute: a,
            reason,
        } = &error
        else {
            panic!("{error}");
        };
        assert_eq!(
            (*l, &**e, a.as_deref()),
            (line, element, attribute),
            "{reason}"
        );
        assert!(
            reason.contains("more than") && reason.len() < 300,
            "{reason}"
        );
    }
    // what real models need stays
    let text = thousand("sep=\"_\"", &format!("<site name=\"{name}\"/>"));
    let m = Model::from_xml(&text).unwrap();
    assert_eq!(m.site_id(&format!("{name}_0999")), Some(999));
}

/// A pipe would wait for a writer, and a device such as `/dev/zero` never ends: as the model and as
/// an included file.
#[cfg(unix)]
#[test]
fn what_is_not_a_regular_file_is_refused() {
    let folder = std::env::temp_dir().join(format!("mjcf-pipes-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let pipe = folder.join("pipe");
    let made = std::process::Command::new("mkfifo").arg(&pipe).status();
    assert!(made.unwrap().success());
    let model = folder.join("model.xml");
    let text = "<mujoco><include file=\"pipe\"/></mujoco>";
    std::fs::write(&model, text).unwrap();
    for path in [&*pipe, &model, &folder, "/dev/zero".as_ref()] {
        // on a thread, so that the test fails if the call waits
        let (sender, receiver) = std::sync::mpsc::channel();
        let path = path.to_owned();
        std::thread::spawn(move || sender.send(Model::from_path(path).unwrap_err().to_string()));
        let error = receiver
            .recv_timeout(std::time::Duration::from_secs(20))
            .unwrap();
        let words = ["not a regular file", "there is no file"];
        assert!(words.iter().any(|words| error.contains(words)), "{error}");
    }
    std::fs::remove_dir_all(&folder).unwrap();
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
