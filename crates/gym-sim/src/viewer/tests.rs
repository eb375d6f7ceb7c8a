use gym_render::DrawLog;

use super::*;
use crate::view::tests::Colors;

const SIZE: (u32, u32) = (640, 480);

fn viewer(text: &str) -> Viewer {
    Viewer::new(Arc::new(Model::from_xml(text).unwrap())).unwrap()
}

/// An arm of two links and a box, as in the recordings of the pull.
const ARM: &str = r#"<mujoco><compiler angle="radian"/><worldbody><geom type="plane" size="2 2 1"/>
    <body name="upper" pos="0.1 0 1"><joint axis="0 1 0"/><joint axis="1 0 0"/>
    <geom type="capsule" fromto="0 0 0 0.3 0.1 -0.4" size="0.05"/>
    <body name="lower" pos="0.3 0.1 -0.4"><joint name="elbow" axis="0 1 0"/><geom type="capsule" fromto="0 0 0 0 0 -0.4" size="0.04"/></body></body>
    <body name="box" pos="-0.6 0.2 0.5"><freejoint/><geom type="box" size="0.1 0.15 0.2" euler="0.1 0.2 0.3"/></body></worldbody>
    <actuator><motor name="motor" joint="elbow"/></actuator>
    <sensor><jointpos name="angle" joint="elbow"/><framepos objtype="body" objname="box"/></sensor>
    <keyframe><key name="bent" time="3" qpos="0 0 1 0 0 2 1 0 0 0" ctrl="0.25"/><key qpos="0 0 -1 0 0 2 1 0 0 0"/></keyframe></mujoco>"#;

/// A ball that falls on a floor.
const BALL: &str = r#"<mujoco><worldbody><geom type="plane" size="2 2 1"/>
    <body name="ball" pos="0 0 0.5"><freejoint/><geom size="0.2"/></body></worldbody></mujoco>"#;

#[test]
fn steps_are_those_of_the_engine() {
    let mut viewer = viewer(ARM);
    viewer.set_control(0, 0.5).unwrap();
    let model = Arc::clone(viewer.model());
    let mut data = Data::new(&model);
    forward(&model, &mut data);
    data.ctrl[0] = 0.5;
    for _ in 0..100 {
        step(&model, &mut data);
    }
    viewer.step(40).unwrap();
    let mut taken = 40;
    while taken < 100 {
        taken += viewer.advance(0.01, || true).unwrap();
    }
    assert_eq!(taken, 100);
    let bits = |x: &[f64]| x.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
    assert_eq!(bits(&viewer.data().qpos), bits(&data.qpos));
    assert_eq!(bits(&viewer.data().qvel), bits(&data.qvel));
}

/// 2 ms are a timestep.
#[test]
fn time_passes_at_a_speed() {
    let mut viewer = viewer(ARM);
    let steps = |viewer: &mut Viewer, seconds: f64| viewer.advance(seconds, || true).unwrap();
    // what is left of a timestep is not lost
    let taken: usize = (0..60).map(|_| steps(&mut viewer, 1.0 / 60.0)).sum();
    assert!((499..=500).contains(&taken), "{taken}");
    viewer.set_speed(0.5).unwrap();
    assert!((24..=26).contains(&steps(&mut viewer, 0.1)));
    viewer.is_paused = true;
    assert_eq!(steps(&mut viewer, 0.1), 0);
    viewer.step(1).unwrap();
    viewer.is_paused = false;
    viewer.set_speed(1.0).unwrap();
    assert_eq!(steps(&mut viewer, f64::NAN), 0);
    // no more than a quarter of a second at once
    assert!((124..=126).contains(&steps(&mut viewer, 1e9)));
    // and what the caller has no time for is dropped
    let mut left = 3;
    let goes_on = || {
        left -= 1;
        left >= 0
    };
    assert_eq!(viewer.advance(0.2, goes_on).unwrap(), 3);
    assert_eq!(steps(&mut viewer, 0.001), 0);
    for speed in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(viewer.set_speed(speed).is_err(), "{speed}");
    }
}

#[test]
fn both_ends_of_the_speeds_are_taken_and_none_beyond() {
    let mut viewer = viewer(BALL);
    let [least, most] = [1.0_f64 / 1024.0, 1024.0];
    for (speed, is_taken) in [
        (least, true),
        (least.next_down(), false),
        (most, true),
        (most.next_up(), false),
        (1.0, true),
        (-least, false),
    ] {
        let before = viewer.speed();
        let told = viewer.set_speed(speed).map_err(|error| error.to_string());
        assert_eq!(viewer.speed(), if is_taken { speed } else { before });
        let expected = format!("{speed} is not from 0.0009765625 to 1024");
        assert!(
            told.map_or_else(|told| told.contains(&expected), |()| is_taken),
            "{speed}"
        );
    }
}

#[test]
fn keyframes_have_names_and_numbers() {
    let mut viewer = viewer(ARM);
    assert_eq!(crate::keyframes(viewer.model()), ["bent", "1"]);
    viewer.step(3).unwrap();
    for (name, elbow, time) in [("bent", 1.0, 3.0), ("1", -1.0, 0.0), ("0", 1.0, 3.0)] {
        viewer.reset_to(name).unwrap();
        assert_eq!((viewer.data().qpos[2], viewer.data().time), (elbow, time));
        assert_eq!(viewer.sensor(0), [elbow], "it is computed");
    }
    assert_eq!(viewer.data().ctrl, [0.25]);
    let error = viewer.reset_to("up").unwrap_err().to_string();
    assert!(
        error.contains("\"up\"") && error.contains("bent, 1"),
        "{error}"
    );
    assert_eq!(viewer.data().qpos[2], 1.0, "nothing changed");
    viewer.reset();
    assert_eq!((viewer.data().qpos[2], viewer.data().ctrl[0]), (0.0, 0.0));
    let none = super::keyframe(&Model::from_xml(BALL).unwrap(), "0").unwrap_err();
    assert!(none.to_string().contains("has no keyframe"), "{none}");
}

#[test]
fn each_actuator_has_a_range() {
    let viewer = viewer(
        r#"<mujoco><compiler angle="radian"/><worldbody><body><joint name="a" range="-1 2"/><geom size="1"/>
        <body><joint name="b"/><geom size="1"/></body></body>
        <body><joint name="slide" type="slide"/><joint name="short" type="slide" range="0 .5"/><geom size="1"/></body>
        <body><joint name="ball" type="ball" range="0 1"/><geom size="1"/><site name="s"/></body></worldbody>
        <actuator><motor name="limited" joint="a" ctrlrange="-3 5"/><motor joint="a"/><position joint="a"/>
        <position joint="a" gear="-2"/><position joint="b"/><velocity joint="b"/><position jointinparent="a" kp="7" kv="3"/>
        <position joint="slide"/><position joint="short" gear="4"/><position joint="ball"/><position site="s"/>
        <position joint="a" gear="0"/><intvelocity joint="a" kp="2"/>
        <general joint="a" gainprm="2" biastype="affine" biasprm="0 -3"/>
        <general joint="a" gainprm="2" biastype="affine" biasprm="1 -2 -1"/>
        <general joint="a" gainprm="-2" biastype="affine" biasprm="0 2"/>
        <general joint="a" gainprm="2" biasprm="0 -2"/></actuator></mujoco>"#,
    );
    let pi = std::f64::consts::PI;
    let expected = [
        ("limited", [-3.0, 5.0], true),
        ("actuator 1", [-1.0, 1.0], false),
        ("actuator 2", [-1.0, 2.0], false),
        ("actuator 3", [-4.0, 2.0], false),
        ("actuator 4", [-pi, pi], false),
        ("actuator 5", [-1.0, 1.0], false),
        ("actuator 6", [-1.0, 2.0], false),
        // of a slide without a range, of a ball and of a site, no position is known
        ("actuator 7", [-1.0, 1.0], false),
        ("actuator 8", [0.0, 2.0], false),
        ("actuator 9", [-1.0, 1.0], false),
        ("actuator 10", [-1.0, 1.0], false),
        ("actuator 11", [-1.0, 1.0], false),
        // the control of an integrated velocity is no position
        ("actuator 12", [-1.0, 1.0], false),
        // only what pulls to its control is a servo
        ("actuator 13", [-1.0, 1.0], false),
        ("actuator 14", [-1.0, 2.0], false),
        ("actuator 15", [-1.0, 1.0], false),
        ("actuator 16", [-1.0, 1.0], false),
    ];
    assert_eq!(viewer.controls().len(), expected.len());
    for (control, (name, range, is_limited)) in viewer.controls().iter().zip(expected) {
        assert_eq!((&*control.name, control.range), (name, range));
        assert_eq!(control.is_limited, is_limited);
    }
}

#[test]
fn wrong_numbers_are_refused() {
    let mut viewer = viewer(ARM);
    for (actuator, value, part) in [(1, 0.0, "the model has 1"), (0, f64::NAN, "not finite")] {
        let error = viewer.set_control(actuator, value).unwrap_err().to_string();
        assert!(error.contains(part), "{error}");
    }
    let error = viewer.use_camera(Some(0)).unwrap_err().to_string();
    assert!(error.contains("the model has 0"), "{error}");
    assert_eq!(viewer.data().ctrl, [0.0]);
}

type PullCase = (usize, [[f64; 3]; 2], f64, [f64; 6]);

/// The forces that `mjv_initPerturb` and `mjv_applyPerturbForce` of libmujoco 3.12.0 give: the body,
/// the point in its frame and the target, the mass at the point, force and torque.
const PULLS: [PullCase; 3] = [
    (
        1,
        [[0.1, 0.02, -0.1], [0.5, 0.1, 1.2]],
        95.209_860_839_438_11,
        [
            3_246.172_961_482_119_7,
            993.465_420_138_608_6,
            3_144.181_433_411_317,
            -141.652_659_039_557_02,
            424.474_413_433_945_64,
            15.663_920_011_165_443,
        ],
    ),
    (
        2,
        [[0.01, 0.03, -0.35], [0.6, -0.3, 0.4]],
        1.837_180_812_535_171_4,
        [
            114.491_715_581_258_38,
            -47.393_907_482_287_16,
            22.266_819_836_855_294,
            -1.796_190_444_022_985_7,
            -12.652_415_709_360_403,
            5.376_431_806_034_474,
        ],
    ),
    (
        3,
        [[0.1, 0.05, 0.12], [-0.4, 0.5, 0.9]],
        11.412_396_355_431_571,
        [
            132.954_417_540_777_8,
            316.123_379_045_464_56,
            256.778_917_997_210_4,
            -23.711_005_619_263_116,
            -6.261_226_779_000_406,
            28.842_208_133_233_125,
        ],
    ),
];

#[test]
fn a_pull_is_that_of_mujocos_viewer() {
    let model = Model::from_xml_with(ARM, mujoco_engine::Revision::V3_12).unwrap();
    let mut data = Data::new(&model);
    data.qpos[..3].copy_from_slice(&[0.3, -0.2, 0.5]);
    let qvel = [0.5, -0.4, 0.3, 0.1, -0.2, 0.3, 1.0, -2.0, 0.5];
    data.qvel.copy_from_slice(&qvel);
    forward(&model, &mut data);
    for (body, [local, target], mass, expected) in PULLS {
        use mujoco_engine::math::{add, rotate};
        let hit = Hit {
            geom: 0,
            body,
            point: add(data.xpos[body], rotate(&data.xmat[body], local)),
        };
        let mut pull = Pull::new(&model, &data, &hit, 1.0).unwrap();
        assert!((pull.mass / mass - 1.0).abs() < 1e-12, "{}", pull.mass);
        pull.apply(&model, &mut data);
        assert_eq!(data.xfrc_applied[body], [0.0; 6], "it is only selected");
        pull.aim([[0.0; 3], target]);
        pull.apply(&model, &mut data);
        for (found, expected) in data.xfrc_applied[body].into_iter().zip(expected) {
            assert!(
                (found - expected).abs() < 1e-9 * mass.max(1.0) * 100.0,
                "{found} for {expected}"
            );
        }
        pull.end(&mut data);
        assert_eq!(data.xfrc_applied[body], [0.0; 6]);
    }
}

/// The place of a point in the picture.
fn pixel(viewer: &Viewer, point: [f64; 3]) -> Point {
    use mujoco_engine::math::{cross, dot, norm, sub};
    let at = |at| viewer.view().ray(viewer.data(), SIZE, at)[1];
    let [from, middle] = viewer.view().ray(viewer.data(), SIZE, [320.0, 240.0]);
    let right = sub(at([321.0, 240.0]), middle);
    let up = cross(right, middle);
    let to = sub(point, from);
    let depth = dot(to, middle);
    let x = dot(to, right) / depth / dot(right, right);
    let y = dot(to, up) / depth / norm(right) / norm(up);
    [320.0 + x, 240.0 - y]
}

#[test]
fn the_pointer_selects_and_pulls() {
    let mut viewer = viewer(BALL);
    assert_eq!(viewer.select([5.0, 5.0], SIZE), None);
    let at = pixel(&viewer, [0.0, 0.0, 0.5]);
    let hit = viewer.select(at, SIZE).unwrap();
    assert_eq!(name(viewer.model(), ObjectType::Body, hit.body), "ball");
    assert!(viewer.is_pulling());
    // it is held where it is, and not pulled before the pointer moves
    viewer.step(10).unwrap();
    assert_eq!(viewer.data().xfrc_applied[1], [0.0; 6]);
    let up = pixel(&viewer, [0.0, 0.0, 1.5]);
    viewer.pull(up, SIZE);
    viewer.step(1500).unwrap();
    let [x, y, z] = viewer.data().xpos[1];
    assert!(z > 1.1 && x.abs() < 0.2 && y.abs() < 0.2, "{x} {y} {z}");
    viewer.release();
    assert!(!viewer.is_pulling() && viewer.data().xfrc_applied[1] == [0.0; 6]);
    viewer.step(2000).unwrap();
    assert!((viewer.data().xpos[1][2] - 0.2).abs() < 1e-2, "it fell");
    // the floor is selected, and cannot be pulled
    let hit = viewer
        .select(pixel(&viewer, [1.0, 1.0, 0.0]), SIZE)
        .unwrap();
    assert_eq!((hit.body, viewer.is_pulling()), (0, false));
    viewer.pull([0.0; 2], SIZE);
    viewer.step(1).unwrap();
    assert_eq!(viewer.data().xfrc_applied, [[0.0; 6]; 2]);
}

/// Whoever resets lets go: what was pulled is not pulled in the next run.
#[test]
fn a_reset_lets_go_of_what_is_pulled() {
    let mut viewer = viewer(ARM);
    let at = pixel(&viewer, viewer.data().geom_xpos[1]);
    let resets: [fn(&mut Viewer); 3] = [
        Viewer::reset,
        |viewer| viewer.reset_to("1").unwrap(),
        |viewer| {
            viewer.set_control(0, 1e10).unwrap();
            viewer.step(100).unwrap_err();
        },
    ];
    for reset in resets {
        viewer.reset();
        assert!(viewer.select(at, SIZE).is_some() && viewer.is_pulling());
        viewer.pull([at[0] + 90.0, at[1] - 90.0], SIZE);
        viewer.step(5).unwrap();
        let is_pulled = |viewer: &Viewer| viewer.data().xfrc_applied.iter().any(|f| *f != [0.0; 6]);
        assert!(is_pulled(&viewer));
        reset(&mut viewer);
        assert!(!viewer.is_pulling() && !is_pulled(&viewer));
        viewer.step(5).unwrap();
        assert!(!is_pulled(&viewer));
    }
}

#[test]
fn a_mocap_body_goes_where_it_is_pulled() {
    let mut viewer = viewer(
        r#"<mujoco><worldbody><body name="hand" mocap="true" pos="0 0 0.5" quat="0 1 0 0"><geom type="box" size="0.1 0.1 0.1"/></body>
        </worldbody></mujoco>"#,
    );
    viewer.is_paused = true;
    let at = pixel(&viewer, [0.0, 0.0, 0.5]);
    assert!(viewer.select(at, SIZE).is_some() && viewer.is_pulling());
    viewer.pull([at[0] + 100.0, at[1]], SIZE);
    let moved = pixel(&viewer, viewer.data().xpos[1]);
    // (the point that was taken hold of is nearer than the centre)
    assert!(
        (60.0..105.0).contains(&(moved[0] - at[0])),
        "{at:?} {moved:?}"
    );
    assert!((moved[1] - at[1]).abs() < 5.0, "{at:?} {moved:?}");
}

/// While time stands still, what floats is carried.
#[test]
fn a_body_that_floats_is_carried_while_time_stands_still() {
    let mut viewer = viewer(BALL);
    viewer.is_paused = true;
    let at = pixel(&viewer, [0.0, 0.0, 0.5]);
    viewer.select(at, SIZE).unwrap();
    viewer.pull([at[0], at[1] - 120.0], SIZE);
    let after = pixel(&viewer, viewer.data().xpos[1]);
    assert!((at[1] - after[1] - 120.0).abs() < 25.0, "{at:?} {after:?}");
    assert_eq!(viewer.data().time, 0.0);
    // an arm is not
    let mut viewer = self::viewer(ARM);
    viewer.is_paused = true;
    let at = pixel(&viewer, viewer.data().geom_xpos[1]);
    assert_eq!(viewer.select(at, SIZE).unwrap().body, 1);
    let before = viewer.data().qpos.clone();
    viewer.pull([0.0; 2], SIZE);
    assert_eq!(viewer.data().qpos, before);
}

#[test]
fn sensors_are_recorded() {
    let mut viewer = viewer(ARM);
    let names: Vec<&str> = viewer
        .sensors()
        .iter()
        .map(|sensor| &*sensor.name)
        .collect();
    assert_eq!(names, ["angle", "sensor 1"]);
    assert_eq!((viewer.sensor(0).len(), viewer.sensor(1).len()), (1, 3));
    assert_eq!((viewer.sensor(2).len(), viewer.history(0, 0).len()), (0, 0));
    let mut heights = Vec::new();
    for step in 0..10 * HISTORY + 5 {
        viewer.step(1).unwrap();
        if step % 10 == 0 {
            heights.push(viewer.sensor(1)[2]);
        }
    }
    let found: Vec<f64> = viewer.history(1, 2).collect();
    assert_eq!(found, heights[heights.len() - HISTORY..]);
    assert_eq!(viewer.history(1, 3).len() + viewer.history(7, 0).len(), 0);
    viewer.reset();
    assert_eq!(viewer.history(0, 0).len(), 0);
}

/// Whatever happened before a reset, what follows is what follows in a new viewer.
#[test]
fn a_used_viewer_goes_on_as_a_new_one_after_a_reset() {
    let told = |viewer: &mut Viewer| {
        let history: Vec<f64> = viewer.history(1, 2).collect();
        let drawn = DrawLog::of(|canvas| viewer.draw(SIZE, canvas)).to_string();
        let (data, controls) = (viewer.data(), viewer.controls().to_vec());
        let state = (
            data.time,
            data.qpos.clone(),
            data.qvel.clone(),
            data.ctrl.clone(),
        );
        format!(
            "{state:?} {history:?} {controls:?} {:?} {drawn}",
            viewer.energy()
        )
    };
    let mut used = viewer(ARM);
    for keyframe in [None, Some("bent"), Some("1")] {
        // part of a timestep and part of the time between two records are left
        used.set_control(0, 0.7).unwrap();
        used.step(23).unwrap();
        used.advance(0.0213, || true).unwrap();
        let mut new = viewer(ARM);
        for viewer in [&mut used, &mut new] {
            match keyframe {
                None => viewer.reset(),
                Some(name) => viewer.reset_to(name).unwrap(),
            }
        }
        for seconds in [0.0, 0.0011, 0.0108, 0.02, 0.05] {
            let taken =
                [&mut used, &mut new].map(|viewer| viewer.advance(seconds, || true).unwrap());
            assert_eq!(taken[0], taken[1], "{keyframe:?}");
            assert_eq!(told(&mut used), told(&mut new), "{keyframe:?}");
        }
    }
}

#[test]
fn a_simulation_that_diverges_says_so() {
    let mut viewer = viewer(
        r#"<mujoco><option timestep="0.1" gravity="0 0 0"/><worldbody><body><joint type="slide" stiffness="1e6" damping="0"/>
        <geom size="0.1"/></body></worldbody><keyframe><key qpos="0.1"/></keyframe></mujoco>"#,
    );
    viewer.reset_to("0").unwrap();
    let error = viewer.step(1000).unwrap_err().to_string();
    assert!(
        error.contains("diverged at") && error.contains("0.1 s"),
        "{error}"
    );
    assert_eq!((viewer.data().time, viewer.data().qpos[0]), (0.0, 0.0));
    viewer.step(10).unwrap();
}

#[test]
fn a_simulation_that_diverges_at_once_says_so() {
    let mut viewer = viewer(ARM);
    viewer.set_control(0, 1e10).unwrap();
    let error = viewer.step(1).unwrap_err().to_string();
    assert!(error.contains("diverged at 0.0000 s"), "{error}");
    assert_eq!((viewer.data().time, viewer.data().ctrl[0]), (0.0, 0.0));
    viewer.step(10).unwrap();
}

#[test]
fn a_step_allocates_nothing() {
    let mut viewer = viewer(ARM);
    viewer.step(100).unwrap();
    let at = pixel(&viewer, viewer.data().geom_xpos[2]);
    assert!(viewer.select(at, SIZE).is_some() && viewer.is_pulling());
    viewer.pull([0.0, 0.0], SIZE);
    // the first step with a force makes room to store it
    viewer.step(1).unwrap();
    let counted = allocation_counter::measure(|| {
        viewer.step(50).unwrap();
        viewer.advance(0.1, || true).unwrap();
    });
    assert_eq!(counted.count_total, 0);
}

#[test]
fn contacts_forces_and_strings_are_drawn_on_demand() {
    let mut viewer = viewer(BALL);
    viewer.step(1500).unwrap();
    assert_eq!(viewer.data().contact.len(), 1);
    let drawn = |viewer: &Viewer| {
        let mut colors = Colors::default();
        viewer.draw(SIZE, &mut colors);
        colors.0.len()
    };
    let plain = drawn(&viewer);
    viewer.shows_contacts = true;
    assert_eq!(drawn(&viewer), plain + 2, "a disc and its middle");
    viewer.shows_forces = true;
    assert_eq!(drawn(&viewer), plain + 4, "an arrow's shaft and head");
    let at = pixel(&viewer, viewer.data().xpos[1]);
    viewer.select(at, SIZE).unwrap();
    assert_eq!(drawn(&viewer), plain + 4);
    viewer.pull([at[0], 0.0], SIZE);
    assert_eq!(drawn(&viewer), plain + 7, "a string and its ends");
}

#[test]
fn the_models_cameras_are_used() {
    let mut viewer = viewer(
        r#"<mujoco><worldbody><camera name="above" pos="0 0 5"/><body name="ball" pos="0 0 1"><freejoint/>
        <geom size="0.3"/></body></worldbody></mujoco>"#,
    );
    assert_eq!(viewer.camera(), None);
    viewer.use_camera(Some(0)).unwrap();
    let [from, along] = viewer.view().ray(viewer.data(), SIZE, [320.0, 240.0]);
    assert_eq!((from[2], along[2]), (5.0, -1.0));
    let hit = viewer.select([320.0, 240.0], SIZE).unwrap();
    assert!((hit.point[2] - 1.3).abs() < 1e-9);
    viewer.use_camera(None).unwrap();
    viewer.follow(Some(hit.body));
    assert_eq!(viewer.followed(), Some(1));
    let camera = viewer.view().free_camera().unwrap();
    assert_eq!(camera.trackbodyid, Some(1));
    viewer.set_free_camera(&camera).unwrap();
    assert_eq!(viewer.view().free_camera().unwrap(), camera);
    let before = viewer.view().free_camera().unwrap().azimuth;
    viewer.turn_by([0.25, 0.0]);
    assert_ne!(viewer.view().free_camera().unwrap().azimuth, before);
}
