//! Limits of models: sizes, depths, copies, and files that are no regular files.

use mujoco_engine::{Data, Error, Model, step};

use super::mjcf::Refused;

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
    assert!(message.contains("more than 4000"), "{message}");
    // 667 bodies with a geom and six degrees of freedom each
    let free = "<body><freejoint/><geom size=\"1\"/></body>".repeat(667);
    let message = Model::from_xml(&format!("<mujoco><worldbody>{free}</worldbody></mujoco>"))
        .unwrap_err()
        .to_string();
    assert!(
        message.contains("more than 4000 bodies, geoms or degrees of freedom"),
        "{message}"
    );
    // two bodies with 1001 geoms each that slide: more than a million pairs
    let many = format!(
        "<body><joint type=\"slide\"/>{}</body>",
        "<geom size=\"1\"/>".repeat(1001)
    );
    let text = format!("<mujoco><worldbody>{many}{many}</worldbody></mujoco>");
    let message = Model::from_xml(&text).unwrap_err().to_string();
    assert!(message.contains("more than 1000000 pairs"), "{message}");
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

/// Each limit of a text at its number and one beyond. What is at a limit may be wrong otherwise.
#[test]
fn the_last_that_fits_is_read_and_the_next_is_refused() {
    let world = |part: String| format!("<mujoco><worldbody>{part}</worldbody></mujoco>");
    let section = |name: &str, part: String| format!("<mujoco><{name}>{part}</{name}></mujoco>");
    let nested = |n: usize| world("<body>".repeat(n) + &"</body>".repeat(n));
    let many = |element: &str, n: usize| format!("<{element}/>").repeat(n);
    type Make<'a> = &'a dyn Fn(usize) -> String;
    let cases: [(usize, &str, Make<'_>); 15] = [
        (
            8 << 20,
            "the text is too long: the limit is 8388608",
            &|n| format!("<mujoco>{}</mujoco>", " ".repeat(n - 17)),
        ),
        // the world has the first depth
        (200, "nested deeper than 200", &|n| nested(n - 1)),
        (1000, "more than 1000 attributes", &|n| {
            world(
                (0..n)
                    .map(|i| format!(" a{i}=\"\""))
                    .fold("<body".to_owned(), |a, b| a + &b)
                    + "/>",
            )
        }),
        (10, "more than 10 namespaces", &|n| {
            world(
                (0..n)
                    .map(|i| format!("<body xmlns:a{i}=\"{i}\"/>"))
                    .collect(),
            )
        }),
        (1000, "more than 1000 are not supported", &|n| {
            world(format!("<body name=\"{}\"/>", "n".repeat(n)))
        }),
        // the world is a body
        (4000, "more than 4000 bodies", &|n| {
            world(many("body", n - 1))
        }),
        (4000, "more than 4000 materials", &|n| {
            section(
                "asset",
                (0..n)
                    .map(|i| format!("<material name=\"{i}\"/>"))
                    .collect(),
            )
        }),
        (4000, "more than 4000 sensors", &|n| {
            section("sensor", many("clock", n))
        }),
        (4000, "more than 4000 excludes", &|n| {
            let exclude = "exclude body1=\"a\" body2=\"a\"";
            section("contact", many(exclude, n))
        }),
        (4000, "more than 4000 actuators", &|n| {
            section("actuator", many("motor", n))
        }),
        // the class of all is one
        (4000, "more than 4000 classes", &|n| {
            let class = |i| format!("<default class=\"{i}\"/>");
            section("default", (1..n).map(class).collect())
        }),
        (4000, "more than 4000 parts of tendons", &|n| {
            section(
                "tendon",
                format!("<fixed>{}</fixed>", many("joint joint=\"j\" coef=\"1\"", n)),
            )
        }),
        (1000, "more than 1000 keys", &|n| {
            section("keyframe", many("key", n))
        }),
        (1000, "nkey", &|n| {
            format!("<mujoco><size nkey=\"{n}\"/></mujoco>")
        }),
        (100_000, "iterations", &|n| {
            format!("<mujoco><option iterations=\"{n}\"/></mujoco>")
        }),
    ];
    for (limit, words, text) in cases {
        let error = |n: usize| {
            Model::from_xml(&text(n))
                .err()
                .map(|error| error.to_string())
        };
        let [fits, beyond] = [limit, limit + 1].map(error);
        let is_told = |error: &Option<String>| {
            let error = error.as_deref();
            error.is_some_and(|error| error.contains(words))
        };
        assert!(!is_told(&fits), "{limit}: {fits:?}");
        assert!(is_told(&beyond), "{}, {words}: {beyond:?}", limit + 1);
    }
}

/// Two sections of a name have no more elements than one.
#[test]
fn limits_hold_for_all_sections_of_a_name_together() {
    let tendon = "<fixed><joint joint=\"j\" coef=\"1\"/><joint joint=\"k\" coef=\"1\"/></fixed>";
    for (section, element, most, words) in [
        (
            "contact",
            "<exclude body1=\"a\" body2=\"a\"/>",
            4000,
            "more than 4000 excludes",
        ),
        ("actuator", "<motor/>", 4000, "more than 4000 actuators"),
        ("sensor", "<clock/>", 4000, "more than 4000 sensors"),
        (
            "asset",
            "<material name=\"m\"/>",
            4000,
            "more than 4000 materials",
        ),
        ("tendon", tendon, 2000, "more than 4000 parts of tendons"),
        ("keyframe", "<key/>", 1000, "more than 1000 keys"),
    ] {
        let is_told = |counts: [usize; 2]| {
            let parts = counts.map(|n| format!("<{section}>{}</{section}>", element.repeat(n)));
            let text = format!("<mujoco>{}</mujoco>", parts.concat());
            Model::from_xml(&text).is_err_and(|error| error.to_string().contains(words))
        };
        for counts in [[1, most], [most, 1]] {
            assert!(is_told(counts), "{words}: {counts:?}");
        }
        assert!(!is_told([most - 1, 1]), "{words}");
    }
}

/// Matrices are counted before they are allocated: joints that follow one another fill the inertia
/// matrix, and rows of constraints have a number for each degree of freedom.
#[test]
fn matrices_have_limits() {
    let world = |option: &str, bodies: &str| {
        format!("<mujoco>{option}<worldbody>{bodies}</worldbody></mujoco>")
    };
    let joints = "<joint type=\"slide\" range=\"0 1\"/>";
    let geom = "<geom size=\".1\" contype=\"0\"/>";
    let body = |joints: &str| format!("<body>{joints}{geom}</body>");
    let apart = world(
        "",
        &"<body><freejoint/><geom size=\".1\" contype=\"0\"/></body>".repeat(180),
    );
    let model = Model::from_xml(&apart).unwrap();
    let mut data = Data::new(&model);
    step(&model, &mut data);
    assert_eq!(data.qpos.len(), 180 * 7);
    assert!((data.qvel[1076] - data.qvel[2]).abs() == 0.0 && data.qvel[2] < 0.0);
    let behind = world("", &body(&joints.repeat(3900)));
    let implicit = "<option integrator=\"implicit\"/>";
    let many = world(implicit, &body(joints).repeat(3990));
    for (text, reason, limit) in [
        (
            behind,
            "7606950 elements, and would be solved for 3912 forces",
            ": more than 4000000000 products are not supported",
        ),
        (
            many,
            "3990 degrees of freedom need matrices of",
            " MiB: more than 2048 are not supported",
        ),
    ] {
        let error = Model::from_xml(&text).unwrap_err().to_string();
        assert!(error.contains(reason) && error.contains(limit), "{error}");
    }
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
        "more than 4000 bodies",
    );
    let attributes: String = (0..500_000).map(|i| format!(" a{i}=\"\"")).collect();
    refused(
        format!("<mujoco>\n<!-- <= \n --><body{attributes}/></mujoco>"),
        "line 3: <mujoco>: an element has more than 1000 attributes",
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
        "more than 4000 classes",
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
        ("actuator", "motor", "actuators"),
        ("asset", "material name=\"m\"", "materials"),
        ("sensor", "clock", "sensors"),
    ] {
        let elements = format!("<{element}/>").repeat(90_000);
        let text = format!("<mujoco><worldbody/><{section}>{elements}</{section}></mujoco>");
        refused(text, &format!("more than 4000 {kinds} are not supported"));
    }
    let text = format!(
        "<mujoco><keyframe>{}</keyframe></mujoco>",
        "<key/>".repeat(1001)
    );
    refused(text, "more than 1000 keys are not supported");
    let path = "<joint joint=\"j\" coef=\"1\"/>".repeat(2400);
    let tendons = format!("<fixed>{path}</fixed>").repeat(2);
    let text = format!("<mujoco><tendon>{tendons}</tendon></mujoco>");
    refused(text, "more than 4000 parts of tendons are not supported");
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

/// A message shows the start of a long name, and an exponent in place of 308 digits.
#[test]
fn messages_are_short() {
    let long = "x".repeat(100_000);
    let inertia = r#"<inertial pos="0 0 0" mass="1" diaginertia="1e300 1 1"/>"#;
    for text in [
        format!("<{long}/>"),
        format!("<mujoco></{long}>"),
        format!("<mujoco><worldbody><{long}/></worldbody></mujoco>"),
        format!("<mujoco><worldbody><geom {long}=\"1\" size=\"1\"/></worldbody></mujoco>"),
        format!("<mujoco><include file=\"{long}\"/></mujoco>"),
        format!("<mujoco><worldbody><body>{inertia}</body></worldbody></mujoco>"),
    ] {
        let error = Model::from_xml(&text).unwrap_err().to_string();
        assert!(
            error.len() < 700 && error.starts_with("line 1: <"),
            "{error}"
        );
    }
    let body =
        "<mujoco><worldbody><body><freejoint/><geom size=\"1\"/></body></worldbody></mujoco>";
    let mut model = Model::from_xml(body).unwrap();
    let error = model.change(|m| m.body_mass[1] = -1e308).unwrap_err();
    let error = error.to_string();
    assert!(error.contains("-1e308") && error.len() < 150, "{error}");
}
