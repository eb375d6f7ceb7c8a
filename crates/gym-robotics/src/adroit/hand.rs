//! The Adroit hand: a Shadow hand of 24 joints on a forearm, in MJCF.

use std::fmt::Write as _;

/// What all tasks share.
const TABLE: &str = include_str!("../../models/adroit_table.xml");

/// A joint of the arm: its name, and its range in m or rad. The letters after `AR` say how it moves
/// (T: slide, R: turn) and along or about which axis.
pub(crate) type ArmJoint = (&'static str, [f64; 2]);

/// The fingers: name, and the positions of the knuckle and of the centre of mass of the middle
/// phalanx, in m. The little finger's knuckle is on a metacarpal.
const FINGERS: [(&str, &str, f64); 4] = [
    ("ff", "0.033 0 0.095", 0.011),
    ("mf", "0.011 0 0.099", 0.012),
    ("rf", "-0.011 0 0.095", 0.012),
    ("lf", "-0.017 0 0.044", 0.012),
];

/// The pairs of parts that touch without friction; other parts of the hand pass through each other.
/// The last pair of `rfdistal` and `lfdistal` is there twice, as in the original.
const TOUCHING: [[&str; 2]; 19] = [
    ["palm0", "thdistal"],
    ["ffproximal", "mfproximal"],
    ["ffproximal", "thdistal"],
    ["ffmiddle", "thdistal"],
    ["ffdistal", "mfdistal"],
    ["ffdistal", "thdistal"],
    ["mfproximal", "rfproximal"],
    ["mfproximal", "thdistal"],
    ["mfdistal", "rfdistal"],
    ["mfdistal", "lfdistal"],
    ["mfdistal", "thdistal"],
    ["rfproximal", "lfproximal"],
    ["rfmiddle", "lfmiddle"],
    ["rfmiddle", "lfdistal"],
    ["rfdistal", "lfmiddle"],
    ["rfdistal", "lfdistal"],
    ["rfdistal", "lfdistal"],
    ["rfdistal", "thdistal"],
    ["lfdistal", "thdistal"],
];

/// The actuators of the hand with the ranges of their controls, in rad.
const ACTUATORS: [(&str, [f64; 2]); 24] = [
    ("WRJ1", [-0.524, 0.175]),
    ("WRJ0", [-0.79, 0.61]),
    ("FFJ3", [-0.44, 0.44]),
    ("FFJ2", [0.0, 1.6]),
    ("FFJ1", [0.0, 1.6]),
    ("FFJ0", [0.0, 1.6]),
    ("MFJ3", [-0.44, 0.44]),
    ("MFJ2", [0.0, 1.6]),
    ("MFJ1", [0.0, 1.6]),
    ("MFJ0", [0.0, 1.6]),
    ("RFJ3", [-0.44, 0.44]),
    ("RFJ2", [0.0, 1.6]),
    ("RFJ1", [0.0, 1.6]),
    ("RFJ0", [0.0, 1.6]),
    ("LFJ4", [0.0, 0.7]),
    ("LFJ3", [-0.44, 0.44]),
    ("LFJ2", [0.0, 1.6]),
    ("LFJ1", [0.0, 1.6]),
    ("LFJ0", [0.0, 1.6]),
    ("THJ4", [-1.0, 1.0]),
    ("THJ3", [0.0, 1.3]),
    ("THJ2", [-0.26, 0.26]),
    ("THJ1", [-0.52, 0.52]),
    ("THJ0", [-1.571, 0.0]),
];

/// The ranges of tendons, in m.
const EVEN: [f64; 2] = [-0.018, 0.018];
const UP: [f64; 2] = [-0.007, 0.03];
const DOWN: [f64; 2] = [-0.03, 0.007];

/// The model of a task: the table, the hand with an arm, and the sections of `task`.
pub(crate) fn model(arm: &[ArmJoint], turned: &str, task: &str) -> String {
    let text = [
        sections(TABLE),
        &body(arm, turned),
        &contacts(),
        &tendons(),
        &actuators(arm),
        sections(task),
    ];
    format!("<mujoco model=\"adroit\">{}</mujoco>", text.concat())
}

/// What is between the outermost tags of a model.
fn sections(text: &str) -> &str {
    let inner = text
        .split_once("<mujoco")
        .and_then(|(_, text)| text.split_once('>'));
    let inner = inner.and_then(|(_, text)| text.rsplit_once("</mujoco>"));
    inner.map_or("", |(text, _)| text)
}

/// The end of a finger, from its knuckle.
fn finger((name, knuckle, middle): (&str, &str, f64)) -> String {
    let joint = name.to_uppercase();
    format!(
        r#"<body name="{name}knuckle" pos="{knuckle}">
  <inertial mass="0.008" pos="0 0 0" quat="0.520062 0.854102 0.00600072 -0.00300036" diaginertia="1e-5 1e-5 1e-5"/>
  <joint name="{joint}J3" axis="0 1 0" range="-0.436 0.436"/>
  <body name="{name}proximal">
    <inertial mass="0.014" pos="0 0 0.023" quat="0.707095 -0.00400054 0.00400054 0.707095" diaginertia="1e-5 1e-5 1e-5"/>
    <joint name="{joint}J2" axis="1 0 0" range="0 1.571"/>
    <geom name="{name}proximal" size="0.01 0.0225" pos="0 0 0.0225"/>
    <body name="{name}middle" pos="0 0 0.045">
      <inertial mass="0.012" pos="0 0 {middle}" quat="0.707107 0 0 0.707107" diaginertia="1e-5 1e-5 1e-5"/>
      <joint name="{joint}J1" axis="1 0 0" range="0 1.571"/>
      <geom name="{name}middle" size="0.00805 0.0125" pos="0 0 0.0125"/>
      <body name="{name}distal" pos="0 0 0.025">
        <inertial mass="0.01" pos="0 0 0.015" quat="0.7071 -0.00300043 0.00300043 0.7071" diaginertia="1e-5 1e-5 1e-5"/>
        <joint name="{joint}J0" axis="1 0 0" range="0 1.571"/>
        <geom name="{name}distal" size="0.00705 0.012" pos="0 0 0.012" condim="4"/>
      </body></body></body></body>"#
    )
}

/// The forearm with the joints of an arm, turned about the vertical by `turned` rad, and the hand.
fn body(arm: &[ArmJoint], turned: &str) -> String {
    let joint = |(name, [low, high]): &ArmJoint| {
        let kind = if name.starts_with("ART") {
            "slide"
        } else {
            "hinge"
        };
        let axis = ["x", "y", "z"].map(|axis| if name.ends_with(axis) { "1" } else { "0" });
        let axis = axis.join(" ");
        format!(
            r#"<joint name="{name}" type="{kind}" axis="{axis}" range="{low} {high}" damping="20"/>"#
        )
    };
    let joints: String = arm.iter().map(joint).collect();
    let [first, middle, ring, little] = FINGERS.map(finger);
    format!(
        r#"<worldbody><body name="forearm" childclass="hand" pos="0 -0.7 0.2" euler="-1.57 0 {turned}">
<inertial mass="4" pos="0.001 -0.002 0.29" quat="0.982037 -0.0160006 0 -0.188007" diaginertia="0.01 0.01 0.0075"/>
{joints}
<geom size="0.05 0.033" pos="0 0 0.29"/>
<body name="wrist" pos="0 0 0.396">
  <inertial mass="0.3" pos="0.003 0 0.016" quat="0.504234 0.49623 0.49523 0.504234" diaginertia="0.001 0.001 0.001"/>
  <joint name="WRJ1" axis="0 1 0" range="-0.524 0.175" armature="0.005" damping="0.5"/>
  <geom size="0.015 0.01" quat="0.707107 0.707107 0 0"/>
  <body name="palm" pos="0 0 0.034">
    <inertial mass="0.3" pos="0.006 0 0.036" quat="0.715833 0.0439898 0.0749825 0.692839" diaginertia="0.001 0.001 0.001"/>
    <joint name="WRJ0" axis="1 0 0" range="-0.785 0.611" armature="0.005" damping="0.5"/>
    <geom name="palm0" type="box" size="0.032 0.0111 0.049" pos="0.011 0 0.038"/>
    <geom type="box" size="0.011 0.0111 0.025" pos="-0.032 0 0.014"/>
    <site name="S_grasp" pos="0.007 -0.05 0.07" rgba="0 0 0 0"/>
    {first}{middle}{ring}
    <body name="lfmetacarpal" pos="-0.017 0 0.044">
      <inertial mass="0.075" pos="-0.014 0.001 0.014" quat="0.709167 -0.0920216 -0.0630148 0.696164" diaginertia="1e-5 1e-5 1e-5"/>
      <joint name="LFJ4" axis="0.570977 0 0.820966" range="0 0.698"/>
      <geom type="box" size="0.0095 0.0111 0.025" pos="-0.0165 0 0.01"/>
      {little}
    </body>
    <body name="thbase" pos="0.034 -0.009 0.029" quat="0.923956 0 0.382499 0">
      <inertial mass="0.01" pos="0 0 0" diaginertia="1e-5 1e-5 1e-5"/>
      <joint name="THJ4" axis="0 0 -1" range="-1.047 1.047"/>
      <geom class="main" type="box" size="0.001 0.001 0.001"/>
      <body name="thproximal">
        <inertial mass="0.016" pos="0 0 0.017" quat="0.981604 0 0.000999597 0.190923" diaginertia="1e-5 1e-5 1e-5"/>
        <joint name="THJ3" axis="1 0 0" range="0 1.309"/>
        <geom name="thproximal" size="0.013 0.019" pos="0 0 0.019"/>
        <body name="thhub" pos="0 0 0.038">
          <inertial mass="0.002" pos="0 0 0" diaginertia="1e-5 1e-5 1e-5"/>
          <joint name="THJ2" axis="1 0 0" range="-0.262 0.262"/>
          <geom class="main" type="box" size="0.001 0.001 0.001"/>
          <body name="thmiddle">
            <inertial mass="0.016" pos="0 0 0.016" quat="0.999971 -0.000999971 -0.00699979 0.00299991" diaginertia="1e-5 1e-5 1e-5"/>
            <joint name="THJ1" axis="0 1 0" range="-0.524 0.524"/>
            <geom name="thmiddle" size="0.011 0.016" pos="0 0 0.016"/>
            <body name="thdistal" pos="0 0 0.032">
              <inertial mass="0.016" pos="0 0 0.016" quat="0.99887 -0.00499935 -0.0469939 0.00499935" diaginertia="1e-5 1e-5 1e-5"/>
              <joint name="THJ0" axis="0 1 0" range="-1.571 0"/>
              <geom name="thdistal" size="0.00918 0.013" pos="0 0 0.013" condim="4"/>
            </body></body></body></body></body>
  </body></body></body></worldbody>"#
    )
}

fn contacts() -> String {
    let pair = |[a, b]: [&str; 2]| format!(r#"<pair geom1="{a}" geom2="{b}" condim="1"/>"#);
    format!("<contact>{}</contact>", TOUCHING.map(pair).concat())
}

fn tendon(text: &mut String, name: &str, [low, high]: [f64; 2], joints: &[(&str, f64)]) {
    let _ = write!(text, r#"<fixed name="T_{name}" range="{low} {high}">"#);
    for (joint, coef) in joints {
        let _ = write!(text, r#"<joint joint="{joint}" coef="{coef}"/>"#);
    }
    *text += "</fixed>";
}

/// A tendon on either side of a joint.
fn pair(text: &mut String, joint: &str, sides: [&str; 2], ranges: [[f64; 2]; 2], arm: f64) {
    for ((side, range), arm) in sides.into_iter().zip(ranges).zip([arm, -arm]) {
        tendon(text, &format!("{joint}{side}"), range, &[(joint, arm)]);
    }
}

/// Tendons, whose ranges limit single joints, and the two outer joints of a finger together.
fn tendons() -> String {
    let mut text = "<tendon>".to_owned();
    pair(&mut text, "WRJ1", ["r", "l"], [[-0.032, 0.032]; 2], 0.018);
    pair(&mut text, "WRJ0", ["u", "d"], [[-0.032, 0.032]; 2], 0.018);
    for finger in ["FF", "MF", "RF", "LF"] {
        let [j0, j1, j2, j3, j4] = [0, 1, 2, 3, 4].map(|k| format!("{finger}J{k}"));
        if finger == "LF" {
            pair(&mut text, &j4, ["u", "d"], [UP, DOWN], 0.01);
        }
        pair(&mut text, &j3, ["r", "l"], [EVEN; 2], 0.01);
        pair(&mut text, &j2, ["u", "d"], [UP, DOWN], 0.01);
        for (side, range, outer, inner) in [
            ("c", [-0.001, 0.001], 0.00705, -0.00805),
            ("u", UP, 0.00705, 0.00805),
            ("d", DOWN, -0.00705, -0.00805),
        ] {
            let joints = [(&*j0, outer), (&*j1, inner)];
            tendon(&mut text, &format!("{j1}{side}"), range, &joints);
        }
    }
    pair(&mut text, "THJ4", ["a", "c"], [EVEN; 2], 0.01636);
    pair(&mut text, "THJ3", ["u", "d"], [UP, DOWN], 0.01);
    pair(&mut text, "THJ2", ["u", "d"], [EVEN; 2], 0.011);
    pair(&mut text, "THJ1", ["r", "l"], [EVEN; 2], 0.011);
    pair(&mut text, "THJ0", ["r", "l"], [DOWN, UP], 0.009);
    text + "</tendon>"
}

fn actuators(arm: &[ArmJoint]) -> String {
    let mut text = "<actuator>".to_owned();
    let mut actuator = |(name, [low, high]): &(&str, [f64; 2]), gain: f64, stiffness: f64| {
        let _ = write!(
            text,
            r#"<general name="A_{name}" joint="{name}" ctrlrange="{low} {high}" gainprm="{gain}" biasprm="0 -{stiffness} 0"/>"#
        );
    };
    arm.iter().for_each(|joint| actuator(joint, 500.0, 200.0));
    ACTUATORS[..2]
        .iter()
        .for_each(|joint| actuator(joint, 10.0, 10.0));
    ACTUATORS[2..]
        .iter()
        .for_each(|joint| actuator(joint, 1.0, 1.0));
    text + "</actuator>"
}
