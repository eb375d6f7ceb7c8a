//! Worlds step together where the stages for several worlds have all that their model has.

use fearless_simd::Level;
use mujoco_engine::lanes::{Derived, Group};

use super::worlds::{compare_reading, steps_together};

/// A model whose worlds step together, with places for a part of which they do not: an arm that reaches for the floor, and a
/// box on it.
const PLAIN: &str = r#"<mujoco>
  <option {option}><flag {flag}/></option><size memory="4M"/>
  <worldbody>
    <geom type="plane" size="5 5 1" {floor}/><site name="low" pos="0 0 .1"/>
    <body name="arm" pos="0 0 .3" {body}><joint name="a" axis="0 1 0" {joint}/>
      <geom name="arm" type="capsule" size=".04" fromto="0 0 0 .3 0 0"/><site name="s" pos=".1 0 .1"/>
      <geom name="knob" size=".06" pos=".15 0 .05"/>
      <body pos=".3 0 0"><joint name="b" axis="0 1 0" range="-60 60"/>
        <geom name="hand" type="capsule" size=".05" fromto="0 0 0 .3 0 -.1"/><site name="high" pos=".2 .1 0" size=".1"/></body></body>
    <body name="box" pos="1 0 .09"><joint type="free" {free}/><geom type="box" size=".1 .1 .1" {box}/></body>
    {world}
  </worldbody>
  <tendon><fixed name="t" {tendon}><joint joint="a" coef="1"/><joint joint="b" coef=".5"/></fixed>{tendons}</tendon>
  <equality>{equality}</equality>
  <actuator><motor joint="a" gear="3"/><motor tendon="t"/>{actuator}</actuator>
  <contact>{contact}</contact>
  <sensor>{sensor}</sensor>
</mujoco>"#;

/// [`PLAIN`] with these parts in their places.
fn with(parts: &[(&str, &str)]) -> String {
    let mut text = PLAIN.to_owned();
    for (place, part) in parts {
        let place = format!("{{{place}}}");
        assert!(text.contains(&place), "{place}");
        text = text.replace(&place, part);
    }
    let places = "option flag floor body joint free box world tendon tendons equality actuator contact sensor";
    for place in places.split(' ') {
        text = text.replace(&format!("{{{place}}}"), "");
    }
    text
}

/// What stands against stepping together does so alone: such worlds step one by one. Beside it is what is like it, and
/// steps together. In either case the bits are those of one world.
#[test]
fn worlds_with_a_part_that_does_not_fit_step_one_by_one() {
    type Parts<'a> = &'a [(&'a str, &'a str)];
    const CASES: &[(bool, Parts<'_>)] = &[
        (true, &[]),
        // joints
        (true, &[("joint", r#"stiffness="3""#)]),
        (true, &[("free", r#"damping=".1""#)]),
        (false, &[("free", r#"stiffness="3""#)]),
        (false, &[("joint", r#"stiffness="3 1 2""#)]),
        (false, &[("joint", r#"damping=".3 .1 .2""#)]),
        (
            false,
            &[(
                "world",
                r#"<body pos="2 0 1"><joint type="ball"/><geom size=".1"/></body>"#,
            )],
        ),
        // options
        (true, &[("option", r#"integrator="RK4""#)]),
        (false, &[("option", r#"integrator="implicit""#)]),
        (false, &[("option", r#"integrator="implicitfast""#)]),
        (true, &[("option", r#"jacobian="dense""#)]),
        (false, &[("option", r#"jacobian="sparse""#)]),
        (false, &[("flag", r#"sleep="enable""#)]),
        (false, &[("flag", r#"energy="enable""#)]),
        // how rows are made and solved is not the same for all
        (true, &[("option", r#"impratio="3""#)]),
        (true, &[("option", r#"noslip_iterations="3""#)]),
        (true, &[("option", r#"cone="elliptic""#)]),
        (
            true,
            &[("option", r#"cone="elliptic" noslip_iterations="3""#)],
        ),
        (
            true,
            &[("option", r#"cone="elliptic""#), ("box", r#"condim="4""#)],
        ),
        (true, &[("option", r#"solver="CG""#)]),
        (true, &[("option", r#"solver="PGS""#)]),
        (true, &[("box", r#"condim="4""#)]),
        (
            true,
            &[("box", r#"condim="1""#), ("floor", r#"condim="1""#)],
        ),
        (
            true,
            &[(
                "contact",
                r#"<pair geom1="hand" geom2="arm" friction="1 .2"/>"#,
            )],
        ),
        (true, &[("joint", r#"frictionloss=".2""#)]),
        // bodies
        (false, &[("body", r#"gravcomp=".5""#)]),
        (
            true,
            &[
                ("body", r#"gravcomp=".5""#),
                ("flag", r#"gravity="disable""#),
            ],
        ),
        (true, &[("option", r#"density="9""#)]),
        (
            false,
            &[
                ("option", r#"density="9""#),
                ("box", r#"fluidshape="ellipsoid""#),
            ],
        ),
        (true, &[("box", r#"fluidshape="ellipsoid""#)]),
        // equalities
        (
            true,
            &[("equality", r#"<joint joint1="b" polycoef=".1 0 0 0 0"/>"#)],
        ),
        (true, &[("equality", r#"<tendon tendon1="t"/>"#)]),
        (
            false,
            &[("equality", r#"<connect body1="box" anchor=".1 0 0"/>"#)],
        ),
        (false, &[("equality", r#"<weld body1="box"/>"#)]),
        // fixed tendons
        (true, &[("tendon", r#"range="-.2 .1""#)]),
        (true, &[("tendon", r#"frictionloss=".2""#)]),
        (true, &[("tendon", r#"stiffness="3" springlength=".1""#)]),
        (
            true,
            &[("tendon", r#"stiffness="3" springlength="-.1 .1""#)],
        ),
        (false, &[("tendon", r#"damping=".3""#)]),
        (false, &[("tendon", r#"stiffness="3" damping=".3""#)]),
        (false, &[("tendon", r#"stiffness="3 1 2""#)]),
        (false, &[("tendon", r#"armature=".1""#)]),
        (
            false,
            &[
                ("tendon", r#"stiffness="3""#),
                ("joint", r#"stiffness="2""#),
            ],
        ),
        (
            false,
            &[(
                "tendons",
                r#"<fixed stiffness="3"><joint joint="a" coef="1"/><joint joint="a" coef=".3"/></fixed>"#,
            )],
        ),
        (
            true,
            &[(
                "tendons",
                r#"<fixed><joint joint="a" coef="1"/><joint joint="a" coef=".3"/></fixed>"#,
            )],
        ),
        // actuators
        (
            true,
            &[(
                "actuator",
                r#"<motor joint="b" ctrlrange="-.1 .2" forcerange="-.1 .1"/>"#,
            )],
        ),
        (false, &[("actuator", r#"<position joint="b" kp="3"/>"#)]),
        (false, &[("actuator", r#"<velocity joint="b" kv="3"/>"#)]),
        (false, &[("actuator", r#"<motor site="high"/>"#)]),
        (
            false,
            &[
                ("actuator", r#"<motor jointinparent="b"/>"#),
                ("joint", r#"actuatorgravcomp="true""#),
            ],
        ),
        (
            false,
            &[(
                "actuator",
                r#"<general joint="b" dyntype="filter" dynprm=".1"/>"#,
            )],
        ),
        (
            false,
            &[("actuator", r#"<muscle joint="b" lengthrange="-1 1"/>"#)],
        ),
        (
            false,
            &[(
                "actuator",
                r#"<adhesion body="box" ctrlrange="0 1" gain="9"/>"#,
            )],
        ),
        // sensors
        (false, &[("sensor", r#"<gyro site="s"/>"#)]),
    ];
    let mut wrong = Vec::new();
    for (together, parts) in CASES {
        let text = with(parts);
        let expected = *together && Group::can_step(Level::new());
        if steps_together(&text, false, &[Derived::Xpos, Derived::CfrcExt]) != expected {
            wrong.push(*parts);
        }
        compare_reading(&text, 5, &[Derived::Xpos, Derived::CfrcExt]);
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

/// Tendons between sites step together unless they push bodies whose forces are read, are springs, or run around geoms.
#[test]
fn worlds_with_a_tendon_in_space_step_together_where_they_can() {
    let spatial = |attributes: &str, path: &str| {
        let path = format!(r#"<site site="low"/>{path}<site site="high"/>"#);
        format!("<spatial {attributes}>{path}</spatial>")
    };
    let around = r#"<geom geom="knob"/><site site="s"/>"#;
    let forces: &[Derived] = &[Derived::Xpos, Derived::CfrcExt];
    for (together, reads, attributes, path) in [
        (true, &[Derived::Xpos][..], r#"range="0 .45""#, ""),
        (true, &[Derived::Xpos], "", ""),
        (true, &[Derived::Xpos], "", around),
        (false, forces, r#"range="0 .45""#, ""),
        (false, &[Derived::Xpos], r#"range="0 .45""#, around),
        (false, &[Derived::Xpos], r#"stiffness="3""#, ""),
        (false, &[Derived::Xpos], r#"damping="3""#, ""),
    ] {
        let text = with(&[("tendons", &spatial(attributes, path))]);
        let expected = together && Group::can_step(Level::new());
        assert_eq!(
            steps_together(&text, false, reads),
            expected,
            "{attributes} {path}"
        );
        compare_reading(&text, 5, reads);
    }
}

/// Sensors step together if they are of some kinds, without cutoffs, and no more are read than there are.
#[test]
fn worlds_with_sensors_step_together_where_they_can() {
    let touch = r#"<touch site="high"/>"#;
    for (together, numbers, option, sensors) in [
        (true, 3, "", r#"<gyro site="s"/>"#),
        (true, 3, "", r#"<velocimeter site="s"/>"#),
        (true, 3, "", r#"<subtreelinvel body="arm"/>"#),
        (true, 1, "", touch),
        (false, 1, r#"integrator="RK4""#, touch),
        (true, 3, r#"integrator="RK4""#, r#"<gyro site="s"/>"#),
        (false, 3, "", r#"<gyro site="s" cutoff=".5"/>"#),
        (false, 1, "", r#"<touch site="high" cutoff="5"/>"#),
        (false, 3, "", r#"<accelerometer site="s"/>"#),
        (false, 1, "", r#"<jointpos joint="a"/>"#),
        (false, 4, "", r#"<gyro site="s"/>"#),
        // those that are not read do not matter
        (true, 3, "", r#"<gyro site="s"/><jointpos joint="a"/>"#),
        (false, 4, "", r#"<gyro site="s"/><jointpos joint="a"/>"#),
    ] {
        let text = with(&[("option", option), ("sensor", sensors)]);
        let expected = together && Group::can_step(Level::new());
        let reads = [Derived::Sensors(numbers)];
        assert_eq!(
            steps_together(&text, true, &reads),
            expected,
            "{option} {sensors} {numbers}"
        );
    }
}
