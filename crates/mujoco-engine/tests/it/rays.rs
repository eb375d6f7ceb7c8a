//! Rays to meshes and height fields, compared with libmujoco's to the last bit. `recorded/rays.py`
//! recorded the digests.

use gym_numerics::RandomState;
use mujoco_engine::physics::{ray, ray_among};
use mujoco_engine::{Data, Model, forward};

use super::digest::Digest;

const TEXT: &str = r#"<mujoco>
  <asset>
    <mesh name="block" inertia="shell" vertex="-.1 -.125 -.2 -.1 -.125 .2 -.1 .125 -.2 -.1 .125 .2 .1 -.125 -.2 .1 -.125 .2 .1 .125 -.2 .1 .125 .2"/>
    <mesh name="tetrahedron" inertia="shell" scale="2 2 2" vertex="0 0 0 .2 0 0 0 .2 0 0 0 .2"/>
    <hfield name="field" nrow="5" ncol="6" size=".9 .7 .3 .2"
      elevation="0 3 1 4 1 5 9 2 6 5 3 5 8 9 7 9 3 2 3 8 4 6 2 6 4 3 3 8 3 2"/>
  </asset>
  <worldbody>
    <geom type="hfield" hfield="field" pos=".1 0 -.7" euler="5 10 20"/>
    <geom type="hfield" hfield="field" pos="-1.2 0 .7"/>
    <geom type="mesh" mesh="block" pos=".1 .2 .3"/>
    <geom type="mesh" mesh="block" pos="-.4 .2 .3" euler="30 20 10"/>
    <geom type="mesh" mesh="tetrahedron" pos=".4 -.2 .3" euler="30 120 10"/>
    <geom type="mesh" mesh="tetrahedron" pos=".4 -.8 .3"/>
    <body pos="0 0 .2">
      <site name="eye" pos=".4 0 .6" euler="170 0 0"/>
      <site name="other" pos="-.4 .2 .7" euler="180 0 0"/>
    </body>
  </worldbody>
  <sensor><rangefinder site="eye"/><rangefinder site="other"/></sensor>
</mujoco>"#;

#[test]
fn rays_are_libmujocos() {
    for (version, expected, sensed) in [
        (
            "3.12.0",
            0xd4f5_415c_61b4_fc02,
            [0.43471719891434024, 0.06693121148716831],
        ),
        (
            "4.0.0",
            0x1aa4_fb43_f1bc_0801,
            [0.43471719891434, 0.06693121148716831],
        ),
    ] {
        let m = Model::from_xml_with(TEXT, version.parse().unwrap()).unwrap();
        let (mut d, mut random) = (Data::new(&m), RandomState::new(0));
        forward(&m, &mut d);
        assert_eq!(d.sensordata[..], sensed, "{version}");
        let mut digest = Digest::default();
        for _ in 0..2000 {
            let point = std::array::from_fn(|_| random.uniform(-1.5, 1.5));
            let mut along: [f64; 3] = std::array::from_fn(|_| random.uniform(-1.0, 1.0));
            if random.uniform(0.0, 1.0) < 0.3 {
                along[random.uniform(0.0, 3.0) as usize] = 0.0;
            }
            let met = ray(&m, &d, point, along, None);
            let distance = met.map_or(-1.0, |(distance, _)| distance).to_bits();
            let geom = met.map_or(u64::MAX, |(_, geom)| geom as u64);
            digest.word(distance);
            digest.word(geom);
        }
        assert_eq!(digest.0, expected, "{version}: {:016x}", digest.0);
    }
}

/// A geom is seen by its own opacity, or by its material's if it has one; whatever its other colours are.
#[test]
fn rays_pass_through_what_is_invisible() {
    let text = r#"<mujoco><asset><material name="clear" rgba="1 1 1 0"/><material name="solid" rgba="0 0 0 .1"/></asset><worldbody>
        <geom name="clear" size=".1" pos="1 0 0" rgba="1 1 1 0"/><geom name="covered" size=".1" pos="2 0 0" material="clear" rgba="1 1 1 1"/>
        <body name="b" pos="3 0 0"><geom name="black" size=".1" rgba="0 0 0 .1"/></body>
        <geom name="painted" size=".1" pos="4 0 0" material="solid" rgba="1 1 1 0"/></worldbody></mujoco>"#;
    let m = Model::from_xml(text).unwrap();
    let mut d = Data::new(&m);
    forward(&m, &mut d);
    let (from, along) = ([0.0; 3], [1.0, 0.0, 0.0]);
    let name = |met: Option<(f64, usize)>| met.and_then(|(_, geom)| m.names.geom[geom].as_deref());
    assert_eq!(name(ray(&m, &d, from, along, None)), Some("black"));
    let except = ray(&m, &d, from, along, m.body_id("b"));
    assert_eq!(name(except), Some("painted"));
    assert!((except.unwrap().0 - 3.9).abs() < 1e-12);
    assert_eq!(name(ray(&m, &d, from, along, Some(0))), Some("black"));
    assert_eq!(name(ray(&m, &d, from, [-1.0, 0.0, 0.0], None)), None);
    assert_eq!(
        name(ray_among(&m, &d, from, along, |_| true)),
        Some("clear")
    );
    assert_eq!(
        name(ray_among(&m, &d, from, along, |geom| geom == 1)),
        Some("covered")
    );
}
