//! Elements that refer to parts of a `replicate` are copied with them, as in MuJoCo.

use mujoco_engine::{CompiledModel, Model};

const BODY: &str =
    r#"<body name="b"><joint name="j"/><geom name="g" size=".1"/><site name="s"/></body>"#;

/// A model with two copies of a body, something before and after them, and sections.
fn copied(sections: &str) -> Result<Model, String> {
    let text = format!(
        "<mujoco>\n<worldbody><site name=\"w\"/><geom name=\"f\" size=\".1\"/><body name=\"e\"><joint name=\"i\"/><geom size=\".1\"/></body>\
         <replicate count=\"2\">{BODY}</replicate><site name=\"later\"/></worldbody>\n{sections}\n</mujoco>"
    );
    Model::from_xml(&text).map_err(|error| error.to_string())
}

fn names(names: &[Option<String>]) -> Vec<&str> {
    names.iter().flatten().map(String::as_str).collect()
}

#[test]
fn what_refers_to_a_copied_part_is_copied() {
    let m = copied(
        r#"<contact><pair geom1="f" geom2="g"/><exclude body1="world" body2="b"/></contact>
           <tendon><fixed name="t"><joint joint="j" coef="1"/></fixed>
           <spatial name="u"><site site="w"/><site site="s"/></spatial></tendon>
           <equality><joint name="q" joint1="j"/></equality>
           <actuator><motor name="m" tendon="t"/><motor name="n" joint="i"/></actuator>
           <sensor><clock name="c"/><tendonpos name="p" tendon="t"/><jointpos name="o" joint="i"/></sensor>"#,
    )
    .unwrap();
    let CompiledModel { names: own, .. } = &*m;
    assert_eq!(names(&own.tendon), ["t0", "u0", "t1", "u1"]);
    assert_eq!(names(&own.actuator), ["n", "m0", "m1"]);
    assert_eq!(names(&own.equality), ["q0", "q1"]);
    // MuJoCo copies sensors of nothing too, and their copies
    assert_eq!(
        names(&own.sensor),
        ["c", "o", "c0", "p0", "c1", "p1", "c01"]
    );
    assert_eq!((m.pair_dim.len(), m.exclude_signature.len()), (2, 2));
}

#[test]
fn what_also_refers_to_a_later_part_is_an_error() {
    let tendon = r#"<tendon><spatial><site site="s"/><site site="later"/></spatial></tendon>"#;
    let error = copied(tendon).unwrap_err();
    assert!(
        error.contains("line 3: <site> attribute \"site\": there is no site \"s\""),
        "{error}"
    );
    let actuator = r#"<actuator><motor site="s" refsite="w"/></actuator>"#;
    assert!(copied(actuator).is_ok_and(|m| m.nu() == 0));
}

#[test]
fn copies_of_references_are_counted() {
    let many = "<clock/>".repeat(2400);
    let error = copied(&format!("<sensor>{many}</sensor>")).unwrap_err();
    assert!(error.contains("more than 4000"), "{error}");
}

#[test]
fn missing_lengths_of_muscles_are_measured_or_refused() {
    let arm = |compiler: &str, range: &str| {
        Model::from_xml(&format!(
            "<mujoco>\n<compiler>{compiler}</compiler><worldbody><body><joint name=\"j\" {range}/><geom size=\".1\" pos=\".2 0 0\"/></body></worldbody>\n<actuator><muscle joint=\"j\"/></actuator>\n</mujoco>"
        ))
        .map_err(|error| error.to_string())
    };
    let m = arm("", "range=\"-60 60\" damping=\".1\"").unwrap();
    let [low, high] = m.actuator_lengthrange[0];
    assert!(
        (low + 1.047).abs() < 0.1 && (high - 1.047).abs() < 0.1,
        "{low} {high}"
    );
    for (compiler, reason) in [
        ("<lengthrange mode=\"none\"/>", "does not measure"),
        ("<lengthrange inttotal=\"1e9\"/>", "timesteps"),
        (
            "<lengthrange timestep=\"1\" inttotal=\"1000001\"/>",
            "line 2: <lengthrange> attribute \"inttotal\": more than 1000000 timesteps are not supported",
        ),
        ("", "converge"),
    ] {
        let error = arm(compiler, "").unwrap_err();
        assert!(error.contains(reason), "{error}");
    }
}

/// The time that measuring takes is bounded by the timesteps of both ends, times degrees of freedom. What diverges at once
/// takes no time.
#[test]
fn the_longest_measurement_of_lengths_is_tried_and_a_longer_one_refused() {
    let arms = |bodies: usize| {
        let options =
            "<lengthrange accel=\"1e12\" timestep=\"1\" interval=\"5\" inttotal=\"1e6\"/>";
        let arm =
            |i| format!("<body><joint name=\"j{i}\"/><geom size=\".1\" pos=\".2 0 0\"/></body>");
        let arms: String = (0..bodies).map(arm).collect();
        let text = format!(
            "<mujoco><compiler>{options}</compiler><worldbody>{arms}</worldbody><actuator><muscle joint=\"j0\"/></actuator></mujoco>"
        );
        Model::from_xml(&text).unwrap_err().to_string()
    };
    for (bodies, reason) in [
        (
            10,
            "it cannot be measured, because the simulation is unstable",
        ),
        (
            11,
            "it would take more than 20000000 timesteps times degrees of freedom to measure: give it, or a smaller inttotal",
        ),
    ] {
        let expected = format!("line 1: <muscle> attribute \"lengthrange\": missing: {reason}");
        assert_eq!(arms(bodies), expected);
    }
}
