//! Models with each kind of sensor, actuator, tendon, equality, joint, mesh and option take steps as with libmujoco, to the
//! last bit. `recorded/parts/record.py` recorded the digests.

use mujoco_engine::model::Integrator;
use mujoco_engine::physics::{step1, step2, substep};
use mujoco_engine::{Data, Model, step};
use serde_json::{Value, json};

use super::digest;

/// Versions and models whose states differ from libmujoco's in their last bits, by 2e-14 at most.
pub(super) const UNLIKE: [(&str, &str); 9] = [
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
    // the C library of the recording (glibc 2.36) does not take the number nearest to `asin(0.9635086561675488)`
    ("3.12", "wrap within cylinder 0.1"),
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

pub(super) fn models() -> Vec<String> {
    let world = include_str!("../recorded/parts/world.txt").trim_end();
    let low = world.replace(r#"pos="0 0 .5""#, r#"pos="0 0 .05""#);
    let models = include_str!("../recorded/parts/models.txt").lines();
    models
        .map(|text| text.replace("@low", &low).replace('@', world))
        .collect()
}

/// Compares digests with recordings, except for those of `UNLIKE`.
pub(super) fn assert_alike(
    models: &[String],
    recordings: [(&'static str, &str); 3],
    digest: impl Fn(&str, &str) -> String,
) {
    let mut unlike = digest::unlike(models, recordings, digest);
    unlike.retain(|one| !UNLIKE.contains(&(one.version, &one.name)));
    assert!(unlike.is_empty(), "{unlike:#?}");
}

#[test]
fn models_with_each_part_step_as_in_libmujoco() {
    let recordings = [
        ("3.12", include_str!("../recorded/parts/3.12.txt")),
        ("3.17", include_str!("../recorded/parts/3.17.txt")),
        ("4.0", include_str!("../recorded/parts/4.0.txt")),
    ];
    assert_alike(&models(), recordings, digest);
}

/// The state and what a step computes.
pub(super) fn seen(d: &Data) -> Value {
    json!([
        d.time,
        d.qpos,
        d.qvel,
        d.act,
        d.qacc,
        d.qacc_warmstart,
        d.sensordata,
        d.energy,
        d.xpos,
        d.xmat,
        d.xipos,
        d.geom_xpos,
        d.site_xpos,
        d.cinert,
        d.cvel,
        d.qfrc_bias,
        d.qfrc_passive,
        d.qfrc_actuator,
        d.qfrc_constraint,
        d.actuator_length,
        d.actuator_force,
        d.ten_length,
        d.contact.len()
    ])
}

/// Steps of which only the last computes everything, two halves, a snapshot that goes on, and data that was reset lead to
/// the bits of whole steps.
#[test]
fn models_with_each_part_take_the_same_steps_in_each_way() {
    const STEPS: usize = 8;
    let mut unlike = Vec::new();
    for text in models() {
        let Ok(m) = Model::from_xml(&text) else {
            continue;
        };
        let start = |d: &mut Data| {
            d.reset(&m);
            for (i, x) in d.qvel.iter_mut().enumerate() {
                *x = (1.0 + 3.0 * i as f64).sin();
            }
        };
        let control = |d: &mut Data, number: usize| {
            for (i, ctrl) in d.ctrl.iter_mut().enumerate() {
                *ctrl = (0.7 * (number + 3 * i) as f64).sin();
            }
        };
        let run =
            |d: &mut Data, numbers: std::ops::Range<usize>, take: &dyn Fn(&mut Data, usize)| {
                for number in numbers {
                    control(d, number);
                    take(d, number);
                }
            };
        let whole = |d: &mut Data, _: usize| step(&m, d);
        let mut d = Data::new(&m);
        start(&mut d);
        run(&mut d, 0..STEPS / 2, &whole);
        let snapshot = serde_json::to_string(&d).unwrap();
        run(&mut d, STEPS / 2..STEPS, &whole);
        let expected = seen(&d);
        let mut compare = |d: &Data, way: &str| {
            if seen(d) != expected {
                unlike.push(format!("{way}: {}", text.split('"').nth(1).unwrap()));
            }
        };
        let mut read: Data = serde_json::from_str(&snapshot).unwrap();
        read.check(&m).unwrap();
        run(&mut read, STEPS / 2..STEPS, &whole);
        compare(&read, "snapshot");
        start(&mut d);
        run(&mut d, 0..STEPS, &whole);
        compare(&d, "reset");
        start(&mut d);
        run(&mut d, 0..STEPS, &|d, number| {
            if number % 4 == 3 {
                step(&m, d);
            } else {
                substep(&m, d);
            }
        });
        compare(&d, "substeps");
        if m.opt.integrator != Integrator::RK4 {
            start(&mut d);
            run(&mut d, 0..STEPS, &|d, _| {
                step1(&m, d);
                step2(&m, d);
            });
            compare(&d, "halves");
        }
    }
    assert!(unlike.is_empty(), "{unlike:#?}");
}
