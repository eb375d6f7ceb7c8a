//! Pictures of models with every kind of thing that is drawn, from every kind of camera, compared with `pictures.txt`.
//!
//! After an intended change, look at them, then store their digests with
//! `GYM_UPDATE_KEPT=1 cargo test --package gym-sim pictures`.

use std::fmt::Write;
use std::path::Path;
use std::sync::Arc;

use gym_render::DrawLog;
use gym_testing::{Digest, kept};
use mujoco_engine::Model;

use super::Viewer;
use crate::view::{CameraConfig, View};

const SIZE: (u32, u32) = (160, 120);

/// Shapes of every kind, alone and with materials, transparent, of hidden groups, below the floor; two planes that are
/// no floor, one seen from behind; sites, tendons of sites, pulleys and round shapes; bodies that touch the floor and
/// each other.
const SHAPES: &str = r#"
    <geom name="floor" type="plane" size="2 3 1" rgba=".4 .6 .5 1"/>
    <geom type="plane" size="0 0 1" pos="0 0 9" contype="0" conaffinity="0"/>
    <geom type="plane" size="1 .5 1" pos="-1.5 2 1" euler="90 0 0" material="clear" contype="0" conaffinity="0"/>
    <geom type="plane" size="1 .5 1" pos="-1.5 -2 1" euler="100 20 0" contype="0" conaffinity="0"/>
    <geom type="sphere" size=".2" pos="-1.2 .3 .6" rgba="1 .2 .1 1"/>
    <geom type="sphere" size=".2" pos="-1.2 .3 -.6" rgba="0 1 0 1"/>
    <geom type="capsule" size=".1 .3" pos="-.8 -.4 .5" euler="30 40 0" material="shiny"/>
    <geom type="cylinder" size=".15 .2" pos="-.5 .7 .4" euler="70 10 0" rgba="1 1 0 .3"/>
    <geom type="cylinder" size=".15 .2" pos="-1 .9 1" euler="170 10 0" material="cubed"/>
    <geom type="ellipsoid" size=".3 .1 .2" pos="0 .9 .7" euler="0 30 50" rgba=".2 .3 1 1"/>
    <geom type="box" size=".1 .2 .3" pos=".6 .9 .5" euler="10 20 30" material="clear"/>
    <geom type="box" size=".1 .2 .3" pos="1.4 .9 .5" euler="10 20 30" material="flat"/>
    <geom type="box" size=".2 .2 .2" pos="0 0 1.5" group="3"/>
    <geom type="box" size=".2 .2 .2" pos="0 0 1.7" rgba="1 1 1 0"/>
    <site name="a" pos="-.9 -.9 .9" size=".05" rgba="1 0 1 1"/>
    <site name="b" pos=".2 -.9 1.1" size=".03"/>
    <site name="c" pos=".5 -.9 .4" size=".1" group="4"/>
    <site name="d" pos=".7 -.5 .9" rgba="0 0 0 0"/>
    <geom name="round" type="sphere" size=".15" pos="-.3 -.9 1"/>
    <body name="lower" pos="1 0 .25"><freejoint/><geom type="sphere" size=".25" mass="2"/></body>
    <body name="upper" pos="1 .05 .72"><freejoint/><geom type="box" size=".2 .2 .22" mass="1" rgba=".9 .5 .2 1"/>
        <camera name="fixed" pos="-2 -1 .5" euler="80 -50 0"/>
        <camera name="track" mode="track" pos="0 -2 1" euler="60 0 0"/>
        <camera name="trackcom" mode="trackcom" pos=".5 -2 1" euler="60 0 0"/></body>
    <body name="arm" pos=".2 -.5 1.2"><joint axis="0 1 0"/><geom type="capsule" fromto="0 0 0 .3 0 -.1" size=".05"/>
        <body pos=".3 0 -.1"><joint axis="0 1 0"/><geom type="capsule" fromto="0 0 0 .4 .1 0" size=".04"/></body></body>
    <camera name="at a body" mode="targetbody" target="upper" pos="-1 -3 2"/>
    <camera name="at a mass" mode="targetbodycom" target="arm" pos="2 -3 1" fovy="30"/>
    <camera name="parallel" projection="orthographic" pos="-2 -3 2.5" euler="60 -30 10" fovy="2.5"/>
    <camera name="from above" pos=".1 0 4"/>
    <camera name="from below" pos=".1 -1 -2" euler="150 10 0"/>
    <camera name="within" pos=".9 0 .3" euler="80 0 0"/>"#;

/// What surfaces are drawn for: meshes with and without textures, heights, and textures of a plane and of a cube, with
/// and without `texuniform`.
const SURFACES: &str = r#"
    <geom type="mesh" mesh="tent" pos="-.2 -.6 .6" euler="20 0 40" material="flat"/>
    <geom type="mesh" mesh="bare" pos=".5 -.9 1.3" euler="0 30 0" material="tiled"/>
    <geom type="mesh" mesh="bare" pos="-1 -.9 .6" euler="0 30 70" material="cubed"/>
    <geom type="mesh" mesh="bare" pos="-1 -1.5 .6" euler="0 30 70" rgba=".8 .1 .1 .5"/>
    <geom type="hfield" hfield="hills" pos=".3 .2 .05" material="flat" contype="0" conaffinity="0"/>
    <geom type="ellipsoid" size=".3 .3 .2" pos="1.2 -.9 .9" material="tiled"/>
    <geom type="box" size=".2 .3 .2" pos="-1.6 0 .9" material="whole"/>
    <geom type="sphere" size=".2" pos=".2 1.6 .9" material="lamp"/>
    <geom type="capsule" size=".1 .3" pos="1.8 .3 .5" euler="60 0 0" material="faces"/>"#;

fn viewer(surfaces: &str) -> Viewer {
    let text = format!(
        r#"<mujoco><asset>
        <texture name="squares" type="2d" builtin="checker" rgb1="1 0 0" rgb2="0 1 1" width="16" height="32"/>
        <texture name="one" type="cube" builtin="gradient" rgb1=".1 .2 .3" rgb2="1 .8 .6" width="16" height="16"/>
        <texture name="six" type="cube" builtin="gradient" rgb1="1 .2 .3" rgb2="0 .8 .6" width="16" height="96"
            mark="cross" markrgb="1 1 1"/>
        <texture name="sky" type="skybox" builtin="flat" rgb1="0 0 1" width="8" height="8"/>
        <material name="shiny" rgba=".3 .7 .9 1" specular="1" shininess=".1"/>
        <material name="clear" rgba=".3 .9 .3 .4"/>
        <material name="flat" texture="squares" specular="0" shininess="1"/>
        <material name="tiled" texture="squares" texrepeat="3 2" texuniform="true"/>
        <material name="whole" texture="squares" texrepeat="2 -1" rgba=".9 .9 .4 1"/>
        <material name="cubed" texture="one"/>
        <material name="faces" texture="six"/>
        <material name="lamp" texture="sky" emission=".7" rgba="1 1 .2 1"/>
        <mesh name="tent" vertex="-.4 -.3 0 .4 -.3 0 .4 .3 0 -.4 .3 0 0 0 .5" face="0 2 1 0 3 2 0 1 4 1 2 4 2 3 4 3 0 4"
            texcoord="0 0 1 0 1 1 0 1 .5 .5"/>
        <mesh name="bare" vertex="-.2 -.3 -.1 .2 -.3 -.1 .2 .3 -.1 -.2 .3 -.1 -.2 -.3 .1 .2 -.3 .1 .2 .3 .1 -.2 .3 .1"/>
        <hfield name="hills" nrow="3" ncol="4" size=".8 .5 .3 .1" elevation="0 1 2 0 3 1 0 2 0 0 1 4"/></asset>
        <worldbody>{SHAPES}{surfaces}</worldbody>
        <tendon><spatial><site site="a"/><site site="b"/><pulley divisor="2"/><site site="b"/><site site="c"/>
            <site site="d"/></spatial><spatial><site site="a"/><geom geom="round"/><site site="d"/></spatial>
            <fixed><joint joint="j" coef="1"/></fixed></tendon></mujoco>"#
    );
    // (the joint of the fixed tendon)
    let text = text.replacen(
        r#"<joint axis="0 1 0"/>"#,
        r#"<joint name="j" axis="0 1 0"/>"#,
        1,
    );
    let mut viewer = Viewer::new(Arc::new(Model::from_xml(&text).unwrap())).unwrap();
    viewer.step(40).unwrap();
    let touching = viewer.data().contact.len();
    assert!(touching >= 2, "{touching} contacts");
    viewer
}

fn digest(text: &[u8]) -> String {
    let mut digest = Digest::default();
    digest.bytes(text);
    digest.finish()[..12].to_owned()
}

fn depths(depths: &[f32]) -> String {
    let bytes: Vec<u8> = depths
        .iter()
        .flat_map(|depth| depth.to_le_bytes())
        .collect();
    digest(&bytes)
}

#[test]
fn pictures_are_as_kept() {
    let mut found = String::new();
    for (scene, surfaces) in [("shapes", ""), ("surfaces", SURFACES)] {
        let mut viewer = viewer(surfaces);
        let model = Arc::clone(viewer.model());
        let mut line = |camera: &str, viewer: &Viewer| {
            let drawn = DrawLog::of(|canvas| viewer.draw(SIZE, canvas)).to_string();
            let depth = viewer.view().depth(viewer.model(), viewer.data(), SIZE);
            let (calls, drawn) = (drawn.lines().count(), digest(drawn.as_bytes()));
            let depth = depths(&depth);
            writeln!(
                found,
                "{scene} {camera}: {calls} calls {drawn}, depths {depth}"
            )
            .unwrap();
        };
        line("free", &viewer);
        viewer.follow(Some(2));
        viewer.turn_by([0.1, -0.05]);
        viewer.zoom_by(0.2);
        line("following", &viewer);
        for (id, name) in model.names.camera.iter().enumerate() {
            viewer.use_camera(Some(id)).unwrap();
            line(name.as_deref().unwrap(), &viewer);
        }
        viewer.use_camera(Some(0)).unwrap();
        viewer.shows_contacts = true;
        line("contacts", &viewer);
        viewer.shows_forces = true;
        line("forces", &viewer);
        let far = CameraConfig::at([0.0, 0.0, 1.0], 5.0, 40.0, -20.0);
        for samples in 0..5 {
            let view = View::new(&model, &far).unwrap().with_samples(samples);
            let draw = DrawLog::of(|canvas| view.draw(&model, viewer.data(), SIZE, canvas));
            let drawn = digest(draw.to_string().as_bytes());
            writeln!(found, "{scene} with {samples} samples: {drawn}").unwrap();
        }
        for geoms in [0, 1, 5, 20] {
            let view = View::new(&model, &far).unwrap().with_max_geom(geoms);
            let draw = DrawLog::of(|canvas| view.draw(&model, viewer.data(), SIZE, canvas));
            let drawn = digest(draw.to_string().as_bytes());
            let depth = depths(&view.depth(&model, viewer.data(), SIZE));
            writeln!(found, "{scene} of {geoms} geoms: {drawn}, depths {depth}").unwrap();
        }
    }
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/src/viewer/pictures.txt");
    kept(Path::new(path), &found);
}
