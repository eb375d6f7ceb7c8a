//! Models with each kind of sensor, actuator, tendon, equality, joint, mesh and option take steps as with libmujoco, to the
//! last bit. `recorded/parts/record.py` recorded the digests.

use super::digest;

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
    digest::of_steps(
        (text, version),
        20,
        |d, random| d.qvel.fill_with(|| random.uniform(-1.0, 1.0)),
        |_, d, random| d.ctrl.fill_with(|| random.uniform(-1.0, 1.0)),
    )
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
