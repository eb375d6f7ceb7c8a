//! Steps of made models, compared with libmujoco's to the last bit. `recorded/steps.py` recorded the
//! digests.

use gym_numerics::RandomState;
use mujoco_engine::{Data, Model, step};

use super::digest::Digest;

/// A robot of meshes on a height field, with loose meshes.
const ROBOT: &str = r#"<mujoco>
  <option timestep=".004"/>
  <default><geom condim="3" friction=".8 .01 .001"/><joint axis="0 1 0" damping=".2" armature=".01"/></default>
  <asset>
    <mesh name="block" vertex="-.1 -.05 -.03 -.1 -.05 .03 -.1 .05 -.03 -.1 .05 .03 .1 -.05 -.03 .1 -.05 .03 .1 .05 -.03 .1 .05 .03"/>
    <mesh name="leg" vertex=".02 0 0 -.01 .017 0 -.01 -.017 0 .02 0 -.15 -.01 .017 -.15 -.01 -.017 -.15"/>
    <mesh name="foot" vertex=".03 0 0 0 .03 0 -.03 0 0 0 -.03 0 0 0 .03 0 0 -.03 .02 .02 .01 -.02 .02 .01 -.02 -.02 .01 .02 -.02 .01 .01 .01 -.025"/>
    <hfield name="field" nrow="7" ncol="8" size="1 .8 .06 .05"
      elevation="0 3 1 4 1 5 9 2 6 5 3 5 8 9 7 9 3 2 3 8 4 6 2 6 4 3 3 8 3 2 7 9 5 0 2 8 8 4 1 9 7 1 6 9 3 9 9 3 7 5 1 0 5 8 2 0"/>
  </asset>
  <worldbody>
    <geom type="plane" size="3 3 .1" pos="0 0 -.2"/>
    <geom type="hfield" hfield="field"/>
    <body name="torso" pos="0 0 .35"><freejoint/>
      <geom type="mesh" mesh="block"/>
      <body pos=".08 .06 0"><joint name="a"/><geom type="mesh" mesh="leg"/><geom type="mesh" mesh="foot" pos="0 0 -.15"/></body>
      <body pos=".08 -.06 0"><joint name="b"/><geom type="mesh" mesh="leg"/><geom type="mesh" mesh="foot" pos="0 0 -.15"/></body>
      <body pos="-.08 .06 0"><joint name="c"/><geom type="mesh" mesh="leg"/><geom type="mesh" mesh="foot" pos="0 0 -.15"/></body>
      <body pos="-.08 -.06 0"><joint name="d"/><geom type="mesh" mesh="leg"/><geom type="mesh" mesh="foot" pos="0 0 -.15"/></body>
    </body>
    <body pos=".02 .01 .5" euler="20 30 40"><freejoint/><geom type="mesh" mesh="block"/></body>
    <body pos="0 .02 .7" euler="10 0 80"><freejoint/><geom type="mesh" mesh="foot" condim="4"/></body>
    <body pos=".3 .1 .3"><freejoint/><geom type="capsule" size=".04 .06" density="500"/></body>
    <body pos="-.3 .1 .3" euler="0 80 10"><freejoint/><geom type="box" size=".04 .06 .05" density="500"/></body>
    <body pos="1.3 .1 0" euler="0 70 10"><freejoint/><geom type="mesh" mesh="block"/></body>
  </worldbody>
  <actuator><position joint="a" kp="4"/><position joint="b" kp="4"/><position joint="c" kp="4"/><position joint="d" kp="4"/></actuator>
</mujoco>"#;

/// A pair in a fluid, of which one is lifted against gravity.
const LIFTED: &str = r#"<mujoco><option timestep=".003" density="1.2" viscosity=".5"/>
  <worldbody><body pos="0 0 1" euler="20 30 40" gravcomp=".4"><freejoint/><geom type="box" size=".2 .1 .05" density="9"/>
    <body pos=".2 0 0"><joint axis="0 1 0" damping=".01"/><geom type="capsule" size=".03 .1" density="9"/></body></body></worldbody></mujoco>"#;

/// Tendons whose forces on sites follow from an equality, after another kind of equality.
const COUPLED: &str = r#"<mujoco><option timestep=".003"/>
  <worldbody>
    <body name="a"><joint name="a" axis="0 1 0"/><geom type="capsule" fromto="0 0 0 .3 0 0" size=".03"/><site name="a" pos=".3 0 0"/></body>
    <body name="b" pos="0 .3 0"><joint name="b" axis="0 1 0"/><geom type="capsule" fromto="0 0 0 .3 0 0" size=".03"/><site name="b" pos=".3 0 0"/></body>
    <body name="c" pos="0 .6 0"><joint name="c" axis="0 1 0"/><geom type="capsule" fromto="0 0 0 .3 0 0" size=".03"/><site name="c" pos=".3 0 0"/></body>
  </worldbody>
  <tendon><spatial name="ab"><site site="a"/><site site="b"/></spatial><spatial name="bc"><site site="b"/><site site="c"/></spatial></tendon>
  <equality><joint joint1="a" joint2="c"/><tendon tendon1="ab" tendon2="bc" polycoef="0 .9 0 0 0"/></equality>
  <actuator><motor joint="b" gear=".5"/></actuator>
  <sensor><torque site="a"/><force site="b"/></sensor>
</mujoco>"#;

/// A digest of the positions, velocities and sensors over 300 steps of random controls.
fn digest(text: &str, version: &str) -> u64 {
    let m = Model::from_xml_with(text, version.parse().unwrap()).unwrap();
    let (mut d, mut random) = (Data::new(&m), RandomState::new(0));
    let mut digest = Digest::default();
    for _ in 0..300 {
        for control in &mut d.ctrl {
            *control = random.uniform(-1.0, 1.0);
        }
        step(&m, &mut d);
        digest.numbers(d.qpos.iter().chain(&d.qvel).chain(&d.sensordata));
    }
    digest.0
}

#[test]
fn steps_are_libmujocos() {
    let digests = [ROBOT, LIFTED, COUPLED]
        .map(|text| ["3.12.0", "4.0.0"].map(|version| digest(text, version)));
    let expected = [
        [0x02b2_88b2_7523_2b4b, 0x6081_ebba_ac35_5039],
        [0x73d4_439d_8f84_d0f6, 0x98ab_aee2_5cfc_48c1],
        [0xd14b_c14f_6fac_7548, 0x0b54_c0f7_dfd4_c389],
    ];
    assert_eq!(digests, expected, "{digests:x?}");
}

/// Its derivatives are those of libmujoco up to rounding. The limits of small divisors do not count
/// for a leaf of 1 mm: the positions after 20 steps, recorded from 4.0.0, differ by 1e-3 in 3.12.
#[test]
fn a_small_leaf_falls_as_in_libmujoco() {
    let text = r#"<mujoco><option timestep=".003" density="1.225" viscosity="1.8e-5" integrator="implicitfast"/>
      <worldbody><body pos="0 0 1" euler="20 30 40"><freejoint/>
        <geom type="ellipsoid" size=".025 .01 0.001" mass="1e-4" fluidshape="ellipsoid"/></body></worldbody></mujoco>"#;
    let expected = [
        0.0003685185657620227,
        -0.00017722369222455037,
        0.9821142687887376,
        0.9033170327272466,
        0.13586215410155947,
        0.12987412570526213,
        0.385606697218837,
    ];
    let m = Model::from_xml_with(text, "4.0".parse().unwrap()).unwrap();
    let mut d = Data::new(&m);
    (0..20).for_each(|_| step(&m, &mut d));
    for (found, expected) in d.qpos.iter().zip(expected) {
        assert!((found - expected).abs() < 1e-13, "{found} for {expected}");
    }
}
