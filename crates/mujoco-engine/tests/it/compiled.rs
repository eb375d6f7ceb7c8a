//! What the compiler of MJCF computes from a text.

use mujoco_engine::{Data, Model, forward, step};

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

/// A body is simple if its inertia is at its frame, and its joints along its axes: positions and
/// orientations up to 1e-6, directions up to 1e-14. These are the answers of libmujoco 3.12 and 4.0.
#[test]
fn simple_bodies_may_be_off_by_rounding() {
    let simple = |joint: &str, inertial: &str| {
        let text = format!(
            "<mujoco><worldbody><body><joint {joint}/><inertial {inertial} mass=\"1\" diaginertia=\"1 1 1\"/></body></worldbody></mujoco>"
        );
        Model::from_xml(&text).unwrap().body_simple[1]
    };
    for (pos, quat, expected) in [
        ("1e-9 0 0", "1 0 0 0", 1),
        ("8e-7 8e-7 8e-7", "1 0 0 0", 1),
        ("2e-6 0 0", "1 0 0 0", 0),
        ("0 0 0", "-1 1e-8 0 0", 1),
        ("0 0 0", "1 1e-5 0 0", 0),
    ] {
        let inertial = format!("pos=\"{pos}\" quat=\"{quat}\"");
        assert_eq!(simple("type=\"free\"", &inertial), expected, "{inertial}");
    }
    for (axis, pos, expected) in [
        ("1 1e-9 0", "0 0 0", 0),
        ("1 0 0", "1e-7 0 0", 1),
        ("1 0 0", "1e-5 0 0", 0),
    ] {
        let joint = format!("axis=\"{axis}\" pos=\"{pos}\"");
        assert_eq!(simple(&joint, "pos=\"0 0 0\""), expected, "{joint}");
    }
}

#[test]
fn a_keyframe_is_a_whole_state() {
    let text = r#"<mujoco><worldbody><body mocap="true" name="m"/><body><joint name="j"/><geom size="0.1" pos="1 0 0"/></body>
        </worldbody><actuator><intvelocity joint="j" actrange="-1 1"/></actuator>
        <keyframe><key/><key name="k" time="2" qpos="0.3" qvel="0.4" act="0.5" ctrl="0.6" mpos="1 2 3" mquat="0 1 0 0"/></keyframe></mujoco>"#;
    let m = Model::from_xml(text).unwrap();
    let mut d = Data::new(&m);
    step(&m, &mut d);
    d.reset_keyframe(&m, m.key_id("k").unwrap()).unwrap();
    assert_eq!((d.time, d.qpos[0], d.qvel[0]), (2.0, 0.3, 0.4));
    assert_eq!((d.act[0], d.ctrl[0]), (0.5, 0.6));
    assert_eq!(
        (d.mocap_pos[0], d.mocap_quat[0]),
        ([1.0, 2.0, 3.0], [0.0, 1.0, 0.0, 0.0])
    );
    let error = d.reset_keyframe(&m, 2).unwrap_err().to_string();
    assert!(error.contains("no keyframe 2: the model has 2"), "{error}");
    d.reset_keyframe(&m, 0).unwrap();
    assert!(d.time == 0.0 && d.qpos == m.qpos0 && d.mocap_pos[0] == m.body_pos[1]);
}

/// A body that is aligned has its frame at its inertia, in the model and in the initial state; its parts stay in their place.
#[test]
fn an_aligned_body_moves_its_frame_and_not_its_parts() {
    let model = |align: &str| {
        let text = format!(
            r#"<mujoco><worldbody><body pos="1 2 3" euler="20 30 40"><freejoint align="{align}"/><site pos=".3 0 .1"/>
            <geom type="box" size=".1 .2 .3" pos=".4 .5 .6" euler="50 60 70"/><camera pos="0 .1 0"/></body></worldbody></mujoco>"#
        );
        let m = Model::from_xml(&text).unwrap();
        let mut d = Data::new(&m);
        forward(&m, &mut d);
        (m, d)
    };
    let ((plain, before), (aligned, after)) = (model("false"), model("true"));
    assert_eq!(plain.body_pos[1], [1.0, 2.0, 3.0]);
    let pose = [&aligned.body_pos[1][..], &aligned.body_quat[1]].concat();
    assert_eq!(aligned.qpos0, pose);
    assert_eq!(aligned.qpos_spring, pose);
    assert_eq!(
        (aligned.body_ipos[1], aligned.body_iquat[1]),
        ([0.0; 3], [1.0, 0.0, 0.0, 0.0])
    );
    let close = |a: [f64; 3], b: [f64; 3]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-12);
    assert!(close(aligned.body_pos[1], before.xipos[1]));
    assert!(close(after.geom_xpos[0], before.geom_xpos[0]));
    assert!(close(after.site_xpos[0], before.site_xpos[0]));
}

/// A body without joints becomes a part of its parent, with all that it has.
#[test]
fn a_fused_body_leaves_its_parts_to_its_parent() {
    let text = |fuses: bool| {
        format!(
            r#"<mujoco><compiler fusestatic="{fuses}"/><worldbody><body><joint/><geom size=".1"/><body pos="1 0 0"><geom size=".2" pos="0 1 0"/>
            <site name="s" pos="0 2 0"/><camera pos="0 3 0"/><light pos="0 4 0"/></body></body></worldbody></mujoco>"#
        )
    };
    let [whole, fused] = [false, true].map(|fuses| Model::from_xml(&text(fuses)).unwrap());
    assert_eq!((whole.nbody(), fused.nbody()), (3, 2));
    assert_eq!(
        (whole.cam_bodyid[0], whole.cam_pos[0]),
        (2, [0.0, 3.0, 0.0])
    );
    assert_eq!(fused.geom_bodyid, [1, 1]);
    assert_eq!((fused.site_bodyid[0], fused.cam_bodyid[0]), (1, 1));
    assert_eq!(
        (fused.geom_pos[1], fused.site_pos[0]),
        ([1.0, 1.0, 0.0], [1.0, 2.0, 0.0])
    );
    assert_eq!(
        (fused.cam_pos[0], fused.light_pos[0]),
        ([1.0, 3.0, 0.0], [1.0, 4.0, 0.0])
    );
    assert!((fused.body_mass[1] - whole.body_mass[1] - whole.body_mass[2]).abs() < 1e-12);
}

/// An exclude is a number of both bodies, the smaller one first, whichever is named first.
#[test]
fn excluded_bodies_are_numbered_as_a_pair() {
    let names = ["a", "b", "c", "d"];
    let bodies: String = names
        .iter()
        .map(|name| format!("<body name=\"{name}\"><freejoint/><geom size=\".1\"/></body>"))
        .collect();
    let exclude = |one: &str, other: &str| {
        let text = format!(
            r#"<mujoco><worldbody>{bodies}</worldbody><contact><exclude body1="{one}" body2="{other}"/></contact></mujoco>"#
        );
        let m = Model::from_xml(&text).unwrap();
        let mut d = Data::new(&m);
        forward(&m, &mut d);
        (m.exclude_signature[0], d.contact.len())
    };
    for (i, one) in names.iter().enumerate() {
        for (j, other) in names.iter().enumerate().filter(|(j, _)| *j != i) {
            let (first, second) = (i.min(j) + 1, i.max(j) + 1);
            // four balls at one place touch in six pairs
            assert_eq!(
                exclude(one, other),
                ((first as u32) << 16 | second as u32, 5)
            );
        }
    }
}

/// A range of actuator forces limits slides and hinges; other joints keep it without effect.
#[test]
fn actuator_forces_are_limited_at_slides_and_hinges() {
    for (kind, limited) in [
        ("free", false),
        ("ball", false),
        ("slide", true),
        ("hinge", true),
    ] {
        let text = format!(
            r#"<mujoco><worldbody><body><joint type="{kind}" actuatorfrcrange="-1 2"/><geom size=".1"/></body></worldbody></mujoco>"#
        );
        let m = Model::from_xml(&text).unwrap();
        assert_eq!(m.jnt_actfrclimited, [limited], "{kind}");
    }
}
