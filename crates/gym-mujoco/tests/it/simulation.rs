//! Every simulation can be stored, has only finite numbers, and allocates nothing.

use std::path::Path;

use mujoco_engine::{CompiledModel, Data, Model, forward, physics, step};
use serde_json::{Value as Json, json};

const MODELS: [&str; 13] = [
    "inverted_pendulum",
    "inverted_double_pendulum",
    "reacher",
    "pusher",
    "pusher_v5",
    "swimmer",
    "half_cheetah",
    "hopper",
    "walker2d",
    "walker2d_v5",
    "ant",
    "humanoid",
    "humanoidstandup",
];

fn built_in(name: &str) -> Model {
    Model::from_path(
        Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("models")
            .join(name)
            .with_extension("xml"),
    )
    .unwrap()
}

/// A generator of numbers from -1 to 1.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 40) as f64 / f64::from(1_u32 << 23) - 1.0
    }

    /// Sets controls of the kind `kind`: small, at the limits, unchanged, or far beyond the limits.
    fn control(&mut self, m: &Model, d: &mut Data, kind: usize) {
        for i in 0..m.nu() {
            let most = m.actuator_ctrlrange[i][1];
            let draw = self.next();
            d.ctrl[i] = match kind % 4 {
                0 => draw * most,
                1 => draw.signum() * most,
                2 => {
                    if i % 2 == 0 {
                        most
                    } else {
                        -most
                    }
                }
                _ => draw * 1e6,
            };
        }
    }
}

/// Returns all public numbers of `d` as text.
fn everything(d: &Data) -> String {
    let state = (
        d.time,
        &d.qpos,
        &d.qvel,
        &d.ctrl,
        &d.qacc_warmstart,
        &d.qacc,
    );
    let frames = (
        &d.xpos,
        &d.xquat,
        &d.xmat,
        &d.xipos,
        &d.ximat,
        &d.xanchor,
        &d.xaxis,
        &d.geom_xpos,
        &d.geom_xmat,
    );
    let inertia = (
        &d.site_xpos,
        &d.site_xmat,
        &d.subtree_com,
        &d.cinert,
        &d.cdof,
        &d.qm,
        &d.qld,
        &d.qld_diag_inv,
    );
    let velocity = (
        &d.cvel,
        &d.cdof_dot,
        &d.ten_length,
        &d.ten_velocity,
        &d.actuator_force,
    );
    let forces = (
        &d.qfrc_passive,
        &d.qfrc_bias,
        &d.qfrc_actuator,
        &d.qfrc_smooth,
        &d.qacc_smooth,
        &d.qfrc_constraint,
    );
    let rows = (
        &d.efc.pos,
        &d.efc.d,
        &d.efc.vel,
        &d.efc.aref,
        &d.efc.b,
        &d.efc.force,
        &d.efc.island,
    );
    format!(
        "{state:?} {frames:?} {inertia:?} {velocity:?} {forces:?} {rows:?} {:?} {:?}",
        d.contact, d.cfrc_ext
    )
}

#[test]
fn stored_data_continues_bit_for_bit() {
    for name in MODELS {
        let m = built_in(name);
        let (mut d, mut random) = (Data::new(&m), Random(3));
        for i in 0..60 {
            random.control(&m, &mut d, i / 20);
            step(&m, &mut d);
        }
        physics::rne_post_constraint(&m, &mut d);
        let stored = serde_json::to_string(&d).unwrap();
        let mut restored: Data = serde_json::from_str(&stored).unwrap();
        assert_eq!(
            serde_json::to_string(&restored).unwrap(),
            stored,
            "{name}: it is stored again before it resumes"
        );
        restored.check(&m).unwrap();
        restored.resume(&m);
        assert_eq!(everything(&d), everything(&restored), "{name}");
        assert_eq!(serde_json::to_string(&restored).unwrap(), stored);
        let mut restored: Data = serde_json::from_str(&stored).unwrap();
        let mut cloned = d.clone();
        for _ in 0..40 {
            random.control(&m, &mut d, 0);
            restored.ctrl.clone_from(&d.ctrl);
            cloned.ctrl.clone_from(&d.ctrl);
            for data in [&mut d, &mut restored, &mut cloned] {
                step(&m, data);
                physics::rne_post_constraint(&m, data);
            }
            assert!(
                everything(&d) == everything(&restored) && everything(&d) == everything(&cloned),
                "{name}"
            );
        }
    }
}

#[test]
fn a_state_that_was_changed_is_stored_as_it_is() {
    let m = built_in("ant");
    let mut d = Data::new(&m);
    let again =
        |d: &Data| -> Data { serde_json::from_str(&serde_json::to_string(d).unwrap()).unwrap() };
    let mut fresh = again(&d);
    fresh.resume(&m);
    assert_eq!(
        everything(&d),
        everything(&fresh),
        "nothing was computed yet"
    );
    forward(&m, &mut d);
    d.qvel[3] = 0.5;
    d.ctrl.fill(0.25);
    let mut restored = again(&d);
    restored.resume(&m);
    assert_eq!(everything(&d), everything(&restored));
    step(&m, &mut d);
    step(&m, &mut restored);
    (d.qpos[2], d.time) = (0.6, 7.0);
    let mut restored = again(&restored);
    (restored.qpos[2], restored.time) = (0.6, 7.0);
    restored.resume(&m);
    assert_eq!(everything(&d), everything(&restored));
    let mut restored = again(&restored);
    for data in [&mut d, &mut restored] {
        step(&m, data);
    }
    assert_eq!(everything(&d), everything(&restored));
}

#[test]
fn what_is_stored_of_another_model_is_refused() {
    let (ant, hopper) = (built_in("ant"), built_in("hopper"));
    let mut d = Data::new(&ant);
    step(&ant, &mut d);
    let stored = serde_json::to_value(&d).unwrap();
    let refusal = |stored: &Json, m: &Model| {
        serde_json::from_value::<Data>(stored.clone())
            .unwrap()
            .check(m)
            .unwrap_err()
            .to_string()
    };
    assert!(refusal(&stored, &hopper).contains("qpos has 15 elements, the model needs 6"));
    let mut changed = stored.clone();
    changed["before"]["qvel"][4] = json!(1e30);
    let diverged: Data = serde_json::from_value(changed.clone()).unwrap();
    assert!(diverged.check(&ant).is_ok() && !diverged.is_bounded());
    changed["before"]["qvel"] = json!([0.0]);
    assert!(refusal(&changed, &ant).contains("qvel has 1 elements, the model needs 14"));
}

#[test]
fn data_is_reused_for_another_model_like_new() {
    let (ant, hopper) = (built_in("ant"), built_in("hopper"));
    let mut d = Data::new(&ant);
    step(&ant, &mut d);
    d.reset(&hopper);
    let mut fresh = Data::new(&hopper);
    for data in [&mut d, &mut fresh] {
        step(&hopper, data);
    }
    assert_eq!(everything(&d), everything(&fresh));
}

/// `GYM_SOAK_STEPS` sets the number of steps. (A million steps pass.)
#[test]
fn no_control_makes_numbers_that_are_not_finite() {
    let steps: usize = std::env::var("GYM_SOAK_STEPS").map_or(3_000, |n| n.parse().unwrap());
    for name in MODELS {
        let m = built_in(name);
        let (mut d, mut random) = (Data::new(&m), Random(7));
        for i in 0..steps {
            if i % 10 == 0 {
                random.control(&m, &mut d, i / 500);
            }
            step(&m, &mut d);
            let numbers = d
                .qpos
                .iter()
                .chain(&d.qvel)
                .chain(&d.qacc)
                .chain(&d.qfrc_constraint)
                .chain(d.efc.force.iter());
            assert!(numbers.copied().all(f64::is_finite), "{name}, step {i}");
        }
        physics::rne_post_constraint(&m, &mut d);
        assert!(d.cfrc_ext.iter().flatten().all(|x| x.is_finite()));
    }
}

#[test]
fn a_state_that_diverged_is_reset() {
    for name in ["hopper", "ant"] {
        let m = built_in(name);
        for bad in [f64::NAN, f64::INFINITY, 2e10] {
            let mut fresh = Data::new(&m);
            step(&m, &mut fresh);
            for spoil in [
                |d: &mut Data, bad| d.qpos[1] = bad,
                |d: &mut Data, bad| d.qvel[1] = bad,
            ] {
                let mut d = Data::new(&m);
                d.time = 3.0;
                spoil(&mut d, bad);
                step(&m, &mut d);
                assert_eq!(d.qpos, fresh.qpos, "{name} {bad}");
                assert_eq!(d.time, fresh.time);
            }
        }
    }
}

#[test]
fn bad_controls_count_as_none() {
    let m = built_in("half_cheetah");
    for bad in [f64::NAN, f64::INFINITY] {
        let mut d = Data::new(&m);
        d.ctrl.fill(0.5);
        d.ctrl[2] = bad;
        forward(&m, &mut d);
        // (infinity is clamped to the control's range, NaN is not)
        assert_eq!(d.qfrc_actuator.iter().all(|&f| f == 0.0), bad.is_nan());
    }
}

/// Returns copies of a stored model, each with one number changed: a little, a lot, or to an
/// impossible value. In each array, only the first, the middle and the last row are changed.
fn damaged(figures: &Json) -> Vec<Json> {
    let mut all = Vec::new();
    for (field, numbers) in figures.as_object().unwrap() {
        let rows = numbers.as_array().map_or(0, Vec::len);
        for row in [0, rows / 2, rows.saturating_sub(1)].into_iter().take(rows) {
            let pointer = if numbers[row].is_array() {
                format!("/{field}/{row}/0")
            } else {
                format!("/{field}/{row}")
            };
            let Some(number) = figures
                .pointer(&pointer)
                .filter(|number| number.is_number())
            else {
                continue;
            };
            for change in [1.0, -1.0, 1e3, -1e3, 1e300] {
                let changed = number.as_f64().unwrap() + change;
                let mut damaged = figures.clone();
                *damaged.pointer_mut(&pointer).unwrap() = if number.is_f64() {
                    json!(changed)
                } else {
                    json!(changed.clamp(-2e9, 2e9) as i64)
                };
                all.push(damaged);
            }
        }
    }
    all
}

/// A stored model may contain anything. A model that is accepted can be simulated.
#[test]
fn damaged_figures_are_refused_or_work() {
    let mut refused = 0;
    for name in ["ant", "pusher", "swimmer"] {
        for figures in damaged(&serde_json::to_value(built_in(name)).unwrap()) {
            let Ok(m) = serde_json::from_value::<Model>(figures) else {
                refused += 1;
                continue;
            };
            let mut d = Data::new(&m);
            d.ctrl.fill(0.5);
            // (a model with a negative inertia may diverge: the simulation is then reset)
            (0..3).for_each(|_| step(&m, &mut d));
        }
    }
    assert!(refused > 500, "{refused}");
}

/// The rows of the inertia matrix share the columns of common ancestors only if descendants follow
/// their ancestor.
#[test]
fn degrees_of_freedom_that_leave_the_order_of_the_tree_are_refused() {
    let body = |name: &str| format!("<body><joint name=\"{name}\"/><geom size=\".1\"/></body>");
    let bodies = ["a", "b", "c"].map(body).concat();
    let model =
        Model::from_xml(&format!("<mujoco><worldbody>{bodies}</worldbody></mujoco>")).unwrap();
    let mut compiled = CompiledModel::clone(&model);
    // the third body becomes a child of the first, behind the second
    (compiled.body_parentid[3], compiled.body_rootid[3]) = (1, 1);
    (compiled.dof_parentid[2], compiled.dof_treeid[2]) = (0, 0);
    compiled.body_treeid[3] = 0;
    let error = Model::new(compiled).unwrap_err().to_string();
    assert!(error.contains("must follow its parent"), "{error}");
}

/// Newton's method continues after a step that increases the cost, so a short line search finds the
/// same forces as a long line search.
#[test]
fn few_evaluations_find_the_same_accelerations() {
    let model = |name: &str, option: &str| {
        let path = Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("models")
            .join(name)
            .with_extension("xml");
        let text = std::fs::read_to_string(path).unwrap();
        Model::from_xml(&text.replace("</mujoco>", &format!("<option {option}/></mujoco>")))
            .unwrap()
    };
    for name in ["ant", "humanoid"] {
        let m = model(name, "iterations=\"200\"");
        let mut random = Random(7);
        let mut d = Data::new(&m);
        for i in 0..400 {
            random.control(&m, &mut d, i / 20);
            step(&m, &mut d);
            if i % 4 > 0 {
                continue;
            }
            let found = |ls_iterations: usize| {
                let m = model(
                    name,
                    &format!("iterations=\"200\" ls_iterations=\"{ls_iterations}\""),
                );
                let mut other = Data::new(&m);
                (other.qpos, other.qvel, other.ctrl) =
                    (d.qpos.clone(), d.qvel.clone(), d.ctrl.clone());
                forward(&m, &mut other);
                other.qacc
            };
            let (thorough, few) = (found(50), found(1));
            let size = thorough.iter().fold(1.0_f64, |most, x| most.max(x.abs()));
            for (a, b) in thorough.iter().zip(&few) {
                assert!(
                    (a - b).abs() < 1e-5 * size,
                    "{name}, step {i}: {few:?} for {thorough:?}"
                );
            }
        }
    }
}

/// Meshes that only frames show change only the geoms of a model.
#[test]
fn meshes_are_pictures() {
    const POINTS: &str = "vertex=\"0 0 0 1 0 0 0 1 0 0 0 1\"";
    let read = |mesh: &str, more: &str| {
        Model::from_xml(&format!(
            "<mujoco><default><default class=\"seen\"><geom type=\"mesh\" contype=\"0\" conaffinity=\"0\" group=\"2\"/></default>\
             </default><asset><mesh name=\"arm\" {POINTS} scale=\"2 2 2\"/><mesh name=\"m\" {POINTS}/></asset>\
             <worldbody><geom type=\"plane\" size=\"1 1 1\"/><body name=\"b\" pos=\"0 0 0.2\"><freejoint/>\
             <inertial pos=\"0.1 0 0\" mass=\"2\" diaginertia=\"1 1 1\"/>{mesh}<geom name=\"g\" size=\"0.1\"/><site name=\"s\"/>\
             </body></worldbody>{more}</mujoco>"
        ))
    };
    let arm = "<geom name=\"arm\" class=\"seen\" mesh=\"arm\" pos=\"1 0 0\"/>";
    let places = |m: &Model| {
        let mut d = Data::new(m);
        for _ in 0..300 {
            step(m, &mut d);
        }
        (d.qpos, d.contact.len())
    };
    let seen = read(&format!("{arm}<geom class=\"seen\" mesh=\"m\"/>"), "").unwrap();
    assert_eq!(seen.ngeom(), 4);
    let (qpos, contacts) = places(&seen);
    assert_eq!((qpos, contacts), places(&read("", "").unwrap()));
    assert!(contacts > 0);
}

/// A sensor of a mesh measures at its centre of mass.
#[test]
fn sensors_see_the_centre_of_a_mesh() {
    let text = "<mujoco><asset><mesh name=\"m\" vertex=\"0 0 0 1 0 0 0 1 0 0 0 1\"/></asset><worldbody>\
                <geom name=\"g\" type=\"mesh\" mesh=\"m\" pos=\"1 0 0\"/></worldbody>\
                <sensor><framepos objtype=\"geom\" objname=\"g\"/></sensor></mujoco>";
    let m = Model::from_xml(text).unwrap();
    let mut d = Data::new(&m);
    forward(&m, &mut d);
    assert_eq!(
        d.sensordata,
        [1.25, 0.249_999_999_999_999_94, 0.249_999_999_999_999_94]
    );
}

/// Substeps (timesteps that skip derived arrays) lead to the same state as steps. A snapshot
/// records that the derived arrays are out of date.
#[test]
fn substeps_are_steps() {
    for name in MODELS {
        let m = built_in(name);
        let (mut one, mut other) = (Data::new(&m), Data::new(&m));
        let mut random = Random(7);
        for i in 0..60 {
            random.control(&m, &mut one, 0);
            other.ctrl.clone_from(&one.ctrl);
            step(&m, &mut one);
            if i % 3 == 2 {
                step(&m, &mut other);
                assert_eq!(json!(one), json!(other), "{name}");
                let frames = |d: &Data| json!([d.geom_xpos, d.geom_xmat, d.site_xpos, d.site_xmat]);
                assert_eq!(frames(&one), frames(&other), "{name}");
            } else {
                physics::substep(&m, &mut other);
                assert!(!other.is_computed());
                let mut stored: Data = serde_json::from_value(json!(other)).unwrap();
                stored.check(&m).unwrap();
                stored.resume(&m);
                assert_eq!(stored.qpos, one.qpos, "{name}");
            }
        }
    }
}
