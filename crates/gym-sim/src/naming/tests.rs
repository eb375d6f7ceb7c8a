//! Every form that a name has, on a model with every kind of joint, actuator and sensor that has one.

use std::ops::Bound::{self, Excluded, Included, Unbounded};

use super::*;

const MODEL: &str = r#"<mujoco><compiler angle="radian"/><worldbody>
    <body name="cart"><joint name="slide" type="slide" axis="1 0 0"/><joint type="slide" axis="0 0 1"/>
        <joint name="pitch" axis="0 1 0"/><joint name="skew" type="slide" axis="1 1 0"/><geom size="1"/><site name="s"/>
        <body name="pole"><joint name="hinge" axis="0 1 0"/><joint type="slide" axis="1 0 0"/><geom size="1"/></body></body>
    <body name="tilted" quat="0 1 0 0"><joint name="tilt" type="slide" axis="1 0 0"/><geom size="1"/></body>
    <body name="wheel"><joint name="spin" axis="0 1 0"/><geom size="1"/></body>
    <body name="eye"><joint name="socket" type="ball"/><geom size="1"/></body>
    <body name="box" pos="9 9 9"><freejoint/><geom size="1"/></body></worldbody>
    <actuator><motor name="push" joint="slide"/><motor joint="hinge" gear="20"/><motor jointinparent="hinge"/>
        <motor joint="slide" gear="-3"/><position joint="hinge" kp="5"/><position joint="slide" kp="5"/>
        <position joint="hinge" kp="5" gear="2"/><velocity name="servo" joint="hinge" kv="3"/><motor site="s"/>
        <motor joint="socket"/><general joint="spin" biastype="affine" gainprm="2" biasprm="0 -3 0"/>
        <intvelocity joint="spin" kp="2"/><intvelocity name="late" joint="slide" kp="2"/>
        <damper joint="spin" kv="2" ctrlrange="0 1"/></actuator>
    <sensor><touch site="s"/><accelerometer site="s"/><velocimeter site="s"/><gyro site="s"/><force site="s"/>
        <torque site="s"/><rangefinder site="s"/><subtreelinvel body="cart"/><jointpos name="reading" joint="hinge"/>
        <framepos name="place" objtype="body" objname="box"/><jointvel joint="hinge"/>
        <framequat objtype="body" objname="box"/></sensor></mujoco>"#;

fn names(name: impl FnOnce(&mut Naming<'_>)) -> Vec<String> {
    let model = Model::from_xml(MODEL).unwrap();
    let mut naming = Naming::new(&model);
    name(&mut naming);
    naming.finish(true, 0).observation
}

const POSITIONS: [&str; 19] = [
    "position of cart along x (m)",
    "position of cart along z (m)",
    "angle of cart about y (rad)",
    "position of skew (m)",
    "angle of hinge (rad)",
    "position of joint 5 (m)",
    "position of tilt (m)",
    "angle of spin (rad)",
    "quaternion w of socket",
    "quaternion x of socket",
    "quaternion y of socket",
    "quaternion z of socket",
    "position of box along x (m)",
    "position of box along y (m)",
    "position of box along z (m)",
    "quaternion w of box",
    "quaternion x of box",
    "quaternion y of box",
    "quaternion z of box",
];

#[test]
fn positions_are_named_by_joints_and_bodies() {
    assert_eq!(
        names(|naming| {
            naming.positions(..);
        }),
        POSITIONS
    );
}

#[test]
fn velocities_and_forces_are_named_by_joints_and_bodies() {
    let found = names(|naming| {
        naming.velocities(..);
    });
    let (linear, angular) = ("velocity of", "angular velocity of");
    let expected = [
        format!("{linear} cart along x (m/s)"),
        format!("{linear} cart along z (m/s)"),
        format!("{angular} cart about y (rad/s)"),
        format!("{linear} skew (m/s)"),
        format!("{angular} hinge (rad/s)"),
        format!("{linear} joint 5 (m/s)"),
        format!("{linear} tilt (m/s)"),
        format!("{angular} spin (rad/s)"),
        format!("{angular} socket about its x (rad/s)"),
        format!("{angular} socket about its y (rad/s)"),
        format!("{angular} socket about its z (rad/s)"),
        format!("{linear} box along x (m/s)"),
        format!("{linear} box along y (m/s)"),
        format!("{linear} box along z (m/s)"),
        format!("{angular} box about its x (rad/s)"),
        format!("{angular} box about its y (rad/s)"),
        format!("{angular} box about its z (rad/s)"),
    ];
    assert_eq!(found, expected);
    let forces: Vec<String> = expected
        .iter()
        .map(|name| match name.strip_prefix(angular) {
            Some(rest) => format!("applied torque on{}", rest.replace("rad/s", "N m")),
            None => format!(
                "applied force on{}",
                name[linear.len()..].replace("m/s", "N")
            ),
        })
        .collect();
    assert_eq!(
        names(|naming| {
            naming.forces("applied", ..);
        }),
        forces
    );
}

#[test]
fn sensors_are_named_by_their_kinds_and_places() {
    let xyz = |text: &str| ["x", "y", "z"].map(|axis| text.replace("{}", axis));
    let expected = [
        vec!["force on s (N)".to_owned()],
        xyz("acceleration of s along its {} (m/s²)").to_vec(),
        xyz("velocity of s along its {} (m/s)").to_vec(),
        xyz("angular velocity of s about its {} (rad/s)").to_vec(),
        xyz("force on s along its {} (N)").to_vec(),
        xyz("torque on s about its {} (N m)").to_vec(),
        vec!["distance from s (m)".to_owned()],
        xyz("velocity of the centre of mass of cart along {} (m/s)").to_vec(),
        vec!["reading".to_owned()],
        (0..3).map(|k| format!("place, number {k}")).collect(),
        vec!["sensor 10, number 0".to_owned()],
        (0..4).map(|k| format!("sensor 11, number {k}")).collect(),
    ];
    assert_eq!(
        names(|naming| {
            naming.sensors(..);
        }),
        expected.concat()
    );
    let model = Model::from_xml(MODEL).unwrap();
    assert_eq!(Naming::new(&model).sensor(99), "sensor number 99");
}

#[test]
fn actuators_are_named_by_what_they_do() {
    let model = Model::from_xml(MODEL).unwrap();
    let names = Naming::new(&model).finish(true, model.nu());
    assert!(names.observation.is_empty());
    let expected = [
        "force of push (N)",
        "torque of hinge (20 N m)",
        "torque of hinge (N m)",
        "force of slide (-3 N)",
        "target angle of hinge (rad)",
        "target position of slide (m)",
        "target of hinge",
        "target velocity of servo",
        "control of actuator 8",
        "control of socket",
        "control of spin",
        "target velocity of spin",
        "target velocity of late",
        "control of spin",
    ];
    assert_eq!(names.action, expected);
    let found = self::names(|naming| {
        naming.activations();
    });
    assert_eq!(found, ["activation of spin", "activation of late"]);
    // other actions have names of their own, or none
    assert!(Naming::new(&model).finish(true, 2).action.is_empty());
    let mut naming = Naming::new(&model);
    naming.action("first").action("second");
    assert_eq!(naming.finish(true, 2).action, ["first", "second"]);
}

#[test]
fn a_range_names_what_is_within() {
    let within = |range: (Bound<usize>, Bound<usize>)| {
        names(|naming| {
            naming.positions(range);
        })
    };
    for (range, expected) in [
        ((Included(2), Unbounded), &POSITIONS[2..]),
        ((Excluded(2), Unbounded), &POSITIONS[3..]),
        ((Unbounded, Excluded(2)), &POSITIONS[..2]),
        ((Unbounded, Included(2)), &POSITIONS[..3]),
        ((Included(17), Excluded(90)), &POSITIONS[17..]),
        ((Included(90), Unbounded), &POSITIONS[..0]),
    ] {
        assert_eq!(within(range), expected, "{range:?}");
    }
}

#[test]
fn parts_of_a_dict_are_sorted_and_those_of_a_vector_are_not() {
    let model = Model::from_xml("<mujoco/>").unwrap();
    for (is_flat, order) in [(true, [0, 1, 2, 3, 4]), (false, [4, 0, 1, 2, 3])] {
        let mut naming = Naming::new(&model);
        naming
            .part("second")
            .each(&["left", "right"], "{} of it")
            .of("sine of", "a hinge (rad)");
        naming.of("cosine of", "a (b) c").part("first").add("last");
        let given = [
            "left of it",
            "right of it",
            "sine of a hinge",
            "cosine of a",
            "last",
        ];
        assert_eq!(
            naming.finish(is_flat, 0).observation,
            order.map(|k| given[k])
        );
    }
    let pose = names(|naming| {
        naming.pose("it");
    });
    let expected = ["x of it (m)", "y of it (m)", "z of it (m)"];
    assert_eq!(pose[..3], expected);
    assert_eq!(
        pose[3..],
        ["w", "x", "y", "z"].map(|q| format!("quaternion {q} of it"))
    );
}
