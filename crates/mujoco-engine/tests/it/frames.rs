//! Frames of geoms and sites that equal a frame of their body in part, compared with libmujoco's to
//! the last bit. `recorded/frames.py` recorded the digests.

use gym_numerics::RandomState;
use mujoco_engine::physics::kinematics;
use mujoco_engine::{Data, Model};

use super::digest::Digest;

/// Geoms and sites for each value of MuJoCo's `mjtSameFrame`; some are equal up to 1e-7.
const TEXT: &str = r#"<mujoco>
  <worldbody>
    <body>
      <freejoint/>
      <inertial pos=".01 .02 .03" quat=".9 .1 -.3 .2" mass="1" diaginertia=".1 .2 .25"/>
      <geom size=".1"/>
      <geom size=".1" pos=".1 -.2 .3"/>
      <geom type="box" size=".1 .2 .3" pos=".1 -.2 .3" quat=".9 .1 -.3 .2"/>
      <geom type="box" size=".1 .2 .3" pos="-.3 .1 0" quat="-.9000001 -.1 .3 -.2"/>
      <geom type="box" size=".1 .2 .3" pos=".01 .02 .03" quat=".9000001 .1 -.3 .2"/>
      <geom type="box" size=".1 .2 .3" pos="-.3 .1 0" quat=".5 .3 .2 .1"/>
      <site pos=".1 -.2 .3"/>
      <site pos=".1 -.2 .3" quat=".9 .1 -.3 .2"/>
      <site pos=".0100001 .02 .03" quat=".9 .1 -.3 .2"/>
      <site pos=".1 -.2 .3" quat=".3 .1 -.3 .2"/>
      <body pos=".2 .3 .4" quat=".2 .5 .3 .7">
        <joint axis="1 2 3"/>
        <inertial pos=".01 .02 .03" quat=".3 .1 -.3 .9" mass="1" diaginertia=".1 .2 .25"/>
        <geom type="capsule" size=".1 .2" pos=".1 -.2 .3" quat=".3 .1 -.3 .9"/>
        <site pos=".1 -.2 .3" quat=".3 .1 -.3 .9"/>
      </body>
    </body>
  </worldbody>
</mujoco>"#;

#[test]
fn frames_are_libmujocos() {
    for (version, expected) in [
        ("3.12.0", 0xcfbb_86e5_f58c_aee0),
        ("4.0.0", 0xa723_36d9_2aaf_7ef4),
    ] {
        let m = Model::from_xml_with(TEXT, version.parse().unwrap()).unwrap();
        let (mut d, mut random) = (Data::new(&m), RandomState::new(0));
        let mut digest = Digest::default();
        for _ in 0..50 {
            for q in &mut d.qpos {
                *q = random.uniform(-1.0, 1.0);
            }
            kinematics(&m, &mut d);
            let geoms = d
                .geom_xpos
                .iter()
                .flatten()
                .chain(d.geom_xmat.iter().flatten());
            let sites = d
                .site_xpos
                .iter()
                .flatten()
                .chain(d.site_xmat.iter().flatten());
            digest.numbers(geoms.chain(sites));
        }
        assert_eq!(digest.0, expected, "{version}: {:016x}", digest.0);
    }
}
