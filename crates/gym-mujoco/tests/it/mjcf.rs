//! Models that the reader of MJCF refuses. Each error names the line, the element and the
//! attribute.

use gym_mujoco::{Error, Model};

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

/// Returns a model whose line 4 has a geom with a mesh and `attributes`.
fn with_mesh(attributes: &str) -> String {
    in_the_world(&format!(
        "<body><geom mesh=\"m\" {attributes}/></body></worldbody>\
         <asset><mesh file=\"parts/m.stl\"/></asset><worldbody>"
    ))
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
        (with_mesh("type=\"mesh\""), 4, "geom", Some("type")),
        (
            with_mesh("type=\"mesh\" contype=\"0\" conaffinity=\"0\""),
            4,
            "geom",
            Some("type"),
        ),
        (with_mesh(""), 4, "geom", Some("mesh")),
        world("<geom size=\"1\" typo=\"3\"/>", "geom", Some("typo")),
        world("<nonsense/>", "nonsense", None),
        world("<joint/>", "joint", None),
        body(
            "<joint springdamper=\"1 -1\"/>",
            "joint",
            Some("springdamper"),
        ),
        body("<freejoint align=\"true\"/>", "freejoint", Some("align")),
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
        (
            in_the_world(
                "<geom size=\"1\" density=\"1e308\"/><body><joint/><geom size=\"1e150\"/></body>",
            ),
            1,
            "mujoco",
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
        world("<camera mode=\"targetbody\"/>", "camera", Some("target")),
        world("<camera mode=\"targetbodycom\"/>", "camera", Some("target")),
        world(
            "<camera mode=\"targetbody\" target=\"none\"/>",
            "camera",
            Some("target"),
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

/// A default class inherits from the enclosing class, even with other elements in between.
#[test]
fn classes_within_classes_start_from_them() {
    let model = Model::from_xml(
        "<mujoco><default><geom size=\"1\"/><default class=\"a\"><geom size=\"2\"/><default class=\"b\"><geom density=\"7\"/>\
         </default></default><default class=\"c\"><geom margin=\"3\"/></default></default><worldbody><geom class=\"a\"/>\
         <geom class=\"b\"/><geom class=\"c\"/></worldbody></mujoco>",
    )
    .unwrap();
    let sizes: Vec<_> = model.geom_size.iter().map(|size| size[0]).collect();
    assert_eq!(
        (sizes, &model.geom_margin[..]),
        (vec![2.0, 2.0, 1.0], &[0.0, 0.0, 3.0][..])
    );
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
    for (section, element) in [
        ("contact", "exclude body1=\"a\" body2=\"b\""),
        ("keyframe", "key"),
        ("actuator", "motor"),
    ] {
        let elements = format!("<{element}/>").repeat(90_000);
        let text = format!("<mujoco><worldbody/><{section}>{elements}</{section}></mujoco>");
        refused(text, "more than 1000 are not supported");
    }
}

/// (`/dev/zero` never ends.)
#[cfg(target_os = "linux")]
#[test]
fn endless_files_are_refused() {
    assert!(
        Model::from_path("/dev/zero")
            .unwrap_err()
            .to_string()
            .contains("the limit is")
    );
}

/// The sum of any two moments of inertia must not be below the third.
#[test]
fn moments_of_inertia_are_those_of_a_body() {
    let model = |moments: &str| {
        Model::from_xml(&format!(
            "<mujoco><worldbody><body><joint/><inertial pos=\"0 0 0\" mass=\"1\" diaginertia=\"{moments}\"/></body>\
             </worldbody></mujoco>"
        ))
    };
    for moments in ["3 1 1", "1 3 1", "1 1 3"] {
        let error = model(moments).unwrap_err().to_string();
        assert!(
            error.contains("two must sum to at least the third"),
            "{moments}: {error}"
        );
    }
    for moments in ["2 1 1", "1 2 1", "1 1 2"] {
        model(moments).unwrap();
    }
}

/// With several `size` elements, the largest `nkey` applies.
#[test]
fn keyframes_are_as_many_as_the_largest_size_says() {
    for sizes in [[3, 1], [1, 3]] {
        let [a, b] = sizes.map(|n| format!("<size nkey=\"{n}\"/>"));
        let text = format!("<mujoco>{a}{b}<worldbody><geom size=\"1\"/></worldbody></mujoco>");
        assert_eq!(
            Model::from_xml(&text).unwrap().key_time.len(),
            3,
            "{sizes:?}"
        );
    }
}

/// If a list of a keyframe is too short, the missing numbers at the end are those of the initial
/// state.
#[test]
fn keyframes_may_be_short() {
    let text = "<mujoco><worldbody><body><freejoint/><geom size=\"1\"/></body></worldbody>\
                <keyframe><key qpos=\"1 2 3\" qvel=\"4\"/></keyframe></mujoco>";
    let m = Model::from_xml(text).unwrap();
    assert_eq!(m.key_qpos[0], [1.0, 2.0, 3.0, 1.0, 0.0, 0.0, 0.0]);
    assert_eq!(m.key_qvel[0], [4.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
}

/// `settotalmass` scales all masses and moments by the same factor. The world body, and geoms
/// without volume, have no mass.
#[test]
fn a_total_mass_scales_masses_and_moments() {
    let model = |compiler: &str| {
        Model::from_xml(&format!(
            "<mujoco>{compiler}<worldbody><geom size=\"3\"/><body><joint/><geom size=\"0.1\"/><body pos=\"1 0 0\"><joint/>\
             <geom type=\"capsule\" size=\"0.1 0.3\"/></body></body></worldbody></mujoco>"
        ))
        .unwrap()
    };
    let (plain, scaled) = (model(""), model("<compiler settotalmass=\"5\"/>"));
    assert_eq!((plain.body_mass[0], scaled.body_mass[0]), (0.0, 0.0));
    let [before, after] = [&plain, &scaled].map(|model| model.body_mass.iter().sum::<f64>());
    assert!(
        (after - 5.0).abs() < 1e-12 && (before - 5.0).abs() > 1.0,
        "{before} and {after}"
    );
    let scale = after / before;
    for body in 1..3 {
        let of = |model: &Model| [&[model.body_mass[body]][..], &model.body_inertia[body]].concat();
        for (scaled, plain) in of(&scaled).iter().zip(of(&plain)) {
            assert!(
                (scaled - scale * plain).abs() < 1e-12 * scaled,
                "body {body}: {scaled} for {plain}"
            );
        }
    }
}

/// A moving body needs mass: its own mass, or the mass of bodies that are fixed to it.
#[test]
fn what_is_fixed_to_a_body_is_its_mass_as_well() {
    let model = |inner: &str| {
        let text = format!("<body><joint/><body>{inner}</body></body>");
        Model::from_xml(&format!("<mujoco><worldbody>{text}</worldbody></mujoco>"))
    };
    let heavy = "<geom size=\"0.1\"/>";
    model(heavy).unwrap();
    model(&format!("<body>{heavy}</body>")).unwrap();
    model("<geom size=\"1e-3\" mass=\"1\"/>").unwrap();
    // neither child bodies with joints nor tiny geoms give the body mass
    for inner in [
        "",
        "<site name=\"s\"/>",
        "<geom size=\"1e-6\" mass=\"1\"/>",
        &format!("<joint/>{heavy}"),
    ] {
        let error = model(inner).unwrap_err().to_string();
        assert!(error.contains("needs mass and inertia"), "{inner}: {error}");
    }
}

/// Returns the compiled model with `lines` before its worldbody.
fn with_lines(lines: &str) -> serde_json::Value {
    let text = format!(
        "<mujoco>{lines}<worldbody><body name=\"a\"><joint name=\"j\" range=\"-30 30\"/><geom size=\"0.1\"/>\
         <inertial pos=\"0 0 0\" mass=\"3\" diaginertia=\"1 1 1\"/></body></worldbody></mujoco>"
    );
    let model = Model::from_xml(&text).unwrap_or_else(|error| panic!("{lines}: {error}"));
    serde_json::to_value(model).unwrap()
}

/// Every attribute of a section has an effect. A later element of the same section changes only the
/// attributes that it has.
#[test]
fn attributes_of_sections_count_wherever_they_are() {
    let sections: [(&str, &[(&str, &str)]); 3] = [
        (
            "option",
            &[
                ("timestep", "0.01"),
                ("gravity", "1 2 3"),
                ("wind", "1 2 3"),
                ("density", "2"),
                ("viscosity", "2"),
                ("integrator", "RK4"),
                ("solver", "PGS"),
                ("iterations", "7"),
                ("ls_iterations", "7"),
                ("tolerance", "0.25"),
            ],
        ),
        (
            "statistic",
            &[
                ("meaninertia", "2"),
                ("meanmass", "2"),
                ("meansize", "2"),
                ("extent", "2"),
                ("center", "1 2 3"),
            ],
        ),
        (
            "compiler",
            &[
                ("angle", "radian"),
                ("inertiafromgeom", "true"),
                ("settotalmass", "9"),
            ],
        ),
    ];
    let plain = with_lines("");
    for (section, attributes) in sections {
        let element = |attributes: &[(&str, &str)]| {
            let text: Vec<_> = attributes
                .iter()
                .map(|(name, value)| format!(" {name}=\"{value}\""))
                .collect();
            format!("<{section}{}/>", text.concat())
        };
        let whole = with_lines(&element(attributes));
        for (i, attribute) in attributes.iter().enumerate() {
            assert_ne!(
                with_lines(&element(&[*attribute])),
                plain,
                "{section} {attribute:?} says nothing"
            );
            let others: Vec<_> = attributes
                .iter()
                .copied()
                .filter(|other| other != attribute)
                .collect();
            let (one, rest) = (element(&[*attribute]), element(&others));
            assert_eq!(
                with_lines(&format!("{one}{rest}")),
                whole,
                "{section}, {i} first"
            );
            assert_eq!(
                with_lines(&format!("{rest}{one}")),
                whole,
                "{section}, {i} last"
            );
        }
    }
}

/// A body has the inertia of its element `inertial`, unless `inertiafromgeom` is `true`.
#[test]
fn inertia_comes_from_where_it_is_said_to() {
    let mass = |lines: &str| with_lines(lines)["body_mass"][1].as_f64().unwrap();
    let sphere = 1000.0 * 4.0 / 3.0 * std::f64::consts::PI * 0.001;
    assert_eq!(mass(""), 3.0);
    assert_eq!(mass("<compiler inertiafromgeom=\"auto\"/>"), 3.0);
    assert_eq!(mass("<compiler inertiafromgeom=\"false\"/>"), 3.0);
    assert!((mass("<compiler inertiafromgeom=\"true\"/>") - sphere).abs() < 1e-9);
}

/// `body_simple` is 2 if a body has only slides along the axes, 1 if one hinge follows them, else
/// 0.
#[test]
fn bodies_of_the_world_are_simple_by_their_joints() {
    let slide = |axis: &str| format!("<joint type=\"slide\" axis=\"{axis}\"/>");
    let hinge = |axis: &str| format!("<joint axis=\"{axis}\"/>");
    for (joints, simple) in [
        (vec![slide("1 0 0")], 2),
        (vec![slide("1 0 0"), slide("0 0 1")], 2),
        (vec![hinge("0 1 0")], 1),
        (vec![slide("1 0 0"), slide("0 0 1"), hinge("0 1 0")], 1),
        (vec![hinge("0 1 0"), slide("1 0 0")], 0),
        (vec![hinge("0 1 0"), hinge("1 0 0")], 0),
        (vec![slide("1 1 0")], 0),
        (vec![hinge("0 1 1")], 0),
        (
            vec!["<joint axis=\"0 1 0\" pos=\"0 0 0.1\"/>".to_owned()],
            0,
        ),
    ] {
        let joints = joints.concat();
        let text = format!(
            "<mujoco><worldbody><body>{joints}<geom size=\"1\"/></body></worldbody></mujoco>"
        );
        assert_eq!(
            Model::from_xml(&text).unwrap().body_simple[1],
            simple,
            "{joints}"
        );
    }
}
