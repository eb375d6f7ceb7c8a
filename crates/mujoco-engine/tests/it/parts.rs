//! Models with each kind of sensor, actuator, tendon, equality, joint, mesh and option take steps as with libmujoco, to the
//! last bit. `recorded/parts/record.py` recorded the digests.

use gym_numerics::RandomState;
use mujoco_engine::{Data, Model, step};

/// Versions and models whose states differ from libmujoco's in their last bits, by 2e-14 at most.
const UNLIKE: [(&str, &str); 8] = [
    // the range of a muscle's length is measured in steps with the limit of a ball joint, whose angle is
    // `atan2` of the C library
    ("3.12", "actuator length all accel92"),
    ("3.17", "actuator length all accel92"),
    ("4.0", "actuator muscle timec"),
    ("4.0", "actuator muscle tausm"),
    ("4.0", "actuator muscle force"),
    ("4.0", "actuator muscle lmin="),
    ("4.0", "actuator length all10"),
    ("4.0", "actuator length muscleuser37"),
];

/// The digest of 20 steps from random velocities, under random controls.
fn digest(text: &str, version: &str) -> String {
    let m = match Model::from_xml_with(text, version.parse().unwrap()) {
        Ok(m) => m,
        Err(error) => return error.to_string(),
    };
    let (mut d, mut random) = (Data::new(&m), RandomState::new(0));
    let mut digest: u64 = 0xcbf2_9ce4_8422_2325;
    d.qvel.fill_with(|| random.uniform(-1.0, 1.0));
    for _ in 0..20 {
        d.ctrl.fill_with(|| random.uniform(-1.0, 1.0));
        step(&m, &mut d);
        let numbers = d.qpos.iter().chain(&d.qvel).chain(&d.act);
        for number in numbers.chain(&d.sensordata) {
            digest = (digest ^ number.to_bits()).wrapping_mul(0x100_0000_01b3);
        }
    }
    format!("{digest:016x}")
}

#[test]
fn models_with_each_part_step_as_in_libmujoco() {
    let world = include_str!("../recorded/parts/world.txt").trim_end();
    let low = world.replace(r#"pos="0 0 .5""#, r#"pos="0 0 .05""#);
    let models: Vec<_> = include_str!("../recorded/parts/models.txt")
        .lines()
        .map(|text| text.replace("@low", &low).replace('@', world))
        .collect();
    let mut unlike = Vec::new();
    for (version, digests) in [
        ("3.12", include_str!("../recorded/parts/3.12.txt")),
        ("3.17", include_str!("../recorded/parts/3.17.txt")),
        ("4.0", include_str!("../recorded/parts/4.0.txt")),
    ] {
        assert_eq!(models.len(), digests.lines().count());
        for (text, expected) in models.iter().zip(digests.lines()) {
            let (found, name) = (digest(text, version), text.split('"').nth(1).unwrap());
            if expected != "-" && found != expected && !UNLIKE.contains(&(version, name)) {
                unlike.push(format!("{version}, {name}: {found}"));
            }
        }
    }
    assert!(unlike.is_empty(), "{unlike:#?}");
}
