//! Steps of models with sparse Jacobians, compared with libmujoco's to the last bit.
//! `recorded/sparse.py` recorded the digests.

use gym_numerics::RandomState;
use mujoco_engine::{Data, Model, step};

use super::digest::Digest;

const TEXT: &str = r#"<mujoco>
  <option timestep=".004" jacobian="sparse" {options}/>
  <default><geom friction=".8 .01 .001"/><joint axis="0 1 0" damping=".2" armature=".01" range="-40 40"/></default>
  <worldbody>
    <geom type="plane" size="3 3 .1"/>
    <body name="torso" pos="0 0 .3"><freejoint/>
      <geom type="sphere" size=".1" condim="4"/>
      <body pos=".1 .07 0"><joint name="a0" frictionloss=".05"/><geom type="capsule" size=".02" fromto="0 0 0 .05 0 -.12"/>
        <body pos=".05 0 -.12"><joint name="a1"/><geom type="capsule" size=".015" fromto="0 0 0 0 0 -.12" condim="6"/></body></body>
      <body pos=".1 -.07 0"><joint name="b0"/><geom type="capsule" size=".02" fromto="0 0 0 .05 0 -.12"/>
        <body pos=".05 0 -.12"><joint name="b1"/><geom type="capsule" size=".015" fromto="0 0 0 0 0 -.12" condim="1"/></body></body>
      <body pos="-.1 .07 0"><joint name="c0" type="ball" range="0 50"/><geom type="capsule" size=".02" fromto="0 0 0 -.05 0 -.12"/>
        <body pos="-.05 0 -.12"><joint name="c1"/><geom type="capsule" size=".015" fromto="0 0 0 0 0 -.12"/></body></body>
      <body pos="-.1 -.07 0"><joint name="d0"/><geom type="capsule" size=".02" fromto="0 0 0 -.05 0 -.12"/>
        <body name="foot" pos="-.05 0 -.12"><joint name="d1"/><geom type="capsule" size=".015" fromto="0 0 0 0 0 -.12"/></body></body>
    </body>
    <body name="box" pos=".02 .01 .6" euler="20 30 40"><freejoint/><geom type="box" size=".05 .06 .04" density="300"/></body>
    <body pos=".6 0 .3" euler="0 70 0"><freejoint/><geom type="capsule" size=".03 .06"/></body>
    <body name="post" pos="-.5 0 .3"><joint type="slide" axis="0 0 1" range="-.1 .1"/><geom type="sphere" size=".05"/>
      <body pos="0 .1 0"><joint name="p" axis="1 0 0" stiffness="1"/><geom type="box" size=".03 .05 .03"/></body></body>
    <body name="load" pos="-.4 0 .15"><freejoint/><geom type="sphere" size=".05"/></body>
  </worldbody>
  <tendon>
    <fixed name="sum" limited="true" range="-.1 .1"><joint joint="a0" coef="1"/><joint joint="b0" coef="-.5"/></fixed>
    <fixed name="rub" frictionloss=".03"><joint joint="d0" coef="1"/><joint joint="p" coef=".3"/></fixed>
  </tendon>
  <equality>
    <joint joint1="a1" joint2="b1" polycoef="0 .8 .1 0 0"/>
    <connect body1="post" body2="load" anchor=".05 0 -.1"/>
    <weld body1="foot" body2="box" active="{weld}"/>
  </equality>
  <actuator><position joint="a0" kp="4"/><position joint="b0" kp="4"/><position joint="d0" kp="4"/><motor joint="p" gear=".3"/></actuator>
</mujoco>"#;

type Case = (&'static str, bool, &'static [(&'static str, u64)]);

/// Options, whether robot and box are welded, and for some versions the digest of 200 steps. From
/// 4.0 on, Newton's method may factor anew what cones change, which the engine does not repeat.
const CASES: [Case; 8] = [
    (
        "",
        false,
        &[
            ("3.12.0", 0xef42_6644_d27b_2b14),
            ("3.17.0", 0xef42_6644_d27b_2b14),
            ("4.0.0", 0x6756_bbdc_dacf_cc07),
            ("4.0.1", 0x6756_bbdc_dacf_cc07),
        ],
    ),
    (
        r#"cone="elliptic""#,
        true,
        &[
            ("3.12.0", 0x1307_af8c_095d_cf2a),
            ("3.17.0", 0x1307_af8c_095d_cf2a),
        ],
    ),
    (
        r#"solver="CG""#,
        false,
        &[
            ("3.12.0", 0x2c3a_b976_4614_3cb4),
            ("3.17.0", 0x2c3a_b976_4614_3cb4),
            ("4.0.0", 0x2a78_f9c2_ac27_0e5f),
        ],
    ),
    (
        r#"solver="CG" cone="elliptic""#,
        false,
        &[
            ("3.12.0", 0x7074_13e0_11b4_2ffc),
            ("3.17.0", 0x7074_13e0_11b4_2ffc),
            ("4.0.0", 0x816a_56c7_d128_2037),
        ],
    ),
    (
        r#"solver="PGS""#,
        true,
        &[
            ("3.12.0", 0xfeaf_c22d_dfda_7dbd),
            ("3.17.0", 0xef52_68c2_c777_d4c2),
            ("4.0.0", 0x0ddc_8e9c_78c0_6614),
        ],
    ),
    (
        r#"solver="PGS" cone="elliptic""#,
        false,
        &[
            ("3.12.0", 0x5eb5_0a3d_9adc_de15),
            ("3.17.0", 0x6975_737e_a96b_1eb0),
            ("4.0.0", 0x1294_2f85_03da_4b2f),
        ],
    ),
    (
        r#"noslip_iterations="4""#,
        false,
        &[
            ("3.12.0", 0xaaa1_90c6_ea17_7a83),
            ("3.17.0", 0x9853_75f5_d77d_b70e),
            ("4.0.0", 0x029b_d9ea_d305_138d),
            ("4.0.1", 0x029b_d9ea_d305_138d),
        ],
    ),
    (
        r#"noslip_iterations="4" cone="elliptic" impratio="5""#,
        false,
        &[
            ("3.12.0", 0x69a0_a759_3f78_477e),
            ("3.17.0", 0x29a4_dc05_f911_1c36),
        ],
    ),
];

#[test]
fn steps_with_sparse_jacobians_are_libmujocos() {
    let mut unlike = Vec::new();
    for (options, weld, expected) in CASES {
        let text = TEXT
            .replace("{options}", options)
            .replace("{weld}", &weld.to_string());
        for &(version, expected) in expected {
            let m = Model::from_xml_with(&text, version.parse().unwrap()).unwrap();
            let (mut d, mut random) = (Data::new(&m), RandomState::new(0));
            let mut digest = Digest::default();
            for _ in 0..200 {
                for control in &mut d.ctrl {
                    *control = random.uniform(-1.0, 1.0);
                }
                step(&m, &mut d);
                digest.numbers(d.qpos.iter().chain(&d.qvel));
            }
            if digest.0 != expected {
                let found = digest.0;
                unlike.push(format!("{version} {options}, weld {weld}: {found:016x}"));
            }
        }
    }
    assert!(unlike.is_empty(), "{}", unlike.join("\n"));
}
