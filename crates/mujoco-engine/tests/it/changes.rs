//! Changed models, and the functions other than `step`, compared with libmujoco to the last bit.

use mujoco_engine::model::Integrator;
use mujoco_engine::physics::{contact_force, energy, inverse, ray, step1, step2};
use mujoco_engine::{CompiledModel, Data, Model, Revision, forward, step};
use serde_json::{Value, json};

use crate::common::same;

/// Returns the recording of `tests/peers/mujoco_models.py`.
fn recording() -> Value {
    serde_json::from_str(include_str!("../recorded/changes.json")).unwrap()
}

/// Returns the model and the recording of libmujoco, for each version.
fn versions() -> Vec<(Model, Value)> {
    let file = recording();
    let versions = file["versions"].as_object().unwrap().iter();
    let text = file["xml"].as_str().unwrap();
    let all: Vec<_> = versions
        .map(|(version, expected)| {
            let revision: Revision = version.parse().unwrap();
            (
                Model::from_xml_with(text, revision).unwrap(),
                expected.clone(),
            )
        })
        .collect();
    assert_eq!(all.len(), 2);
    all
}

fn state(d: &Data) -> Value {
    json!({"qpos": d.qpos, "qvel": d.qvel, "sensordata": d.sensordata})
}

/// Returns the data after 50 steps, each taken by `take`.
fn steps(m: &Model, take: impl Fn(&Model, &mut Data)) -> Data {
    let mut d = Data::new(m);
    for i in 0..50 {
        for (k, ctrl) in d.ctrl.iter_mut().enumerate() {
            *ctrl = f64::from((7 * i + 3 * k as u32) % 11) / 5.0 - 1.0;
        }
        take(m, &mut d);
    }
    d
}

/// Applies a recorded change: replaces a number of the named field of a model, or the first numbers
/// of a row.
fn apply(m: &CompiledModel, change: &Value) -> CompiledModel {
    let mut figures = serde_json::to_value(m).unwrap();
    let mut place = &mut figures;
    for part in change[0].as_str().unwrap().split('.') {
        place = &mut place[part];
    }
    if let Some(index) = change[1].as_u64() {
        place = &mut place[index as usize];
    }
    match &change[2] {
        Value::Array(numbers) => {
            for (k, number) in numbers.iter().enumerate() {
                place[k] = number.clone();
            }
        }
        number => *place = number.clone(),
    }
    serde_json::from_value(figures).unwrap()
}

#[test]
fn changed_models_step_as_in_libmujoco() {
    for (m, expected) in versions() {
        for (i, change) in recording()["changes"]
            .as_array()
            .unwrap()
            .iter()
            .enumerate()
        {
            let written = Model::new(apply(&m, change)).unwrap();
            let found = state(&steps(&written, step));
            assert!(
                same(&expected["written"][i], &found),
                "{} {change}",
                m.revision
            );
            let mut set = m.clone();
            set.change(|figures| *figures = apply(figures, change))
                .unwrap();
            let found = state(&steps(&set, step));
            assert!(
                same(&expected["constants"][i], &found),
                "{} {change}, recomputed",
                m.revision
            );
        }
    }
}

#[test]
fn a_change_that_is_refused_leaves_the_model() {
    let (mut m, _) = versions().swap_remove(0);
    let before = CompiledModel::clone(&m);
    let error = m
        .change(|figures| figures.opt.timestep = -1.0)
        .unwrap_err()
        .to_string();
    assert!(error.contains("opt.timestep is -1"), "{error}");
    let error = m
        .change(|figures| figures.body_mass.push(1.0))
        .unwrap_err()
        .to_string();
    assert!(
        error.contains("body_mass has 6 elements, expected 5"),
        "{error}"
    );
    assert_eq!(before, *m);
    // an empty change keeps every field
    m.change(|_| ()).unwrap();
    assert_eq!(before, *m);
}

#[test]
fn what_is_set_by_compilers_follows_too() {
    let text = r#"<mujoco><worldbody><geom type="plane" size="1 1 1"/><body pos="0 0 .3"><freejoint/><geom size=".1"/></body></worldbody></mujoco>"#;
    let mut m = Model::from_xml(text).unwrap();
    assert_eq!((m.body_simple[1], m.geom_rbound[1]), (1, 0.1));
    m.change(|figures| {
        figures.geom_size[1][0] = 0.25;
        figures.body_ipos[1] = [0.0, 0.0, 0.05];
    })
    .unwrap();
    assert_eq!((m.body_simple[1], m.geom_rbound[1]), (0, 0.25));
    assert_eq!(m.dof_simplenum, [0; 6]);
}

#[test]
fn both_halves_of_a_step_are_as_in_libmujoco() {
    let halves = |m: &Model, d: &mut Data| {
        step1(m, d);
        step2(m, d);
    };
    for (mut m, expected) in versions() {
        let found = state(&steps(&m, halves));
        assert!(same(&expected["halves"], &found), "{}", m.revision);
        m.change(|figures| figures.opt.integrator = Integrator::RK4)
            .unwrap();
        let found = state(&steps(&m, halves));
        assert!(same(&expected["halves_rk4"], &found), "{} RK4", m.revision);
    }
}

#[test]
fn applied_forces_and_inverse_dynamics_are_as_in_libmujoco() {
    for (m, expected) in versions() {
        let pushed = steps(&m, |m, d| {
            d.qfrc_applied[0] = 0.3;
            d.xfrc_applied[3] = [0.1, 0.2, 0.3, 0.01, 0.02, 0.03];
            step(m, d);
        });
        assert!(
            same(&expected["applied"], &state(&pushed)),
            "{}",
            m.revision
        );
        let mut d = steps(&m, step);
        for (i, qacc) in d.qacc.iter_mut().enumerate() {
            *qacc = i as f64 / 8.0 - 0.5;
        }
        inverse(&m, &mut d);
        let mut found = state(&d);
        found["qfrc_inverse"] = json!(d.qfrc_inverse);
        assert!(same(&expected["inverse"], &found), "{} {found}", m.revision);
    }
}

#[test]
fn functions_of_a_state_are_as_in_libmujoco() {
    for (m, expected) in versions() {
        let mut d = steps(&m, step);
        forward(&m, &mut d);
        let jac = d.jac_site(&m, m.site_id("s1").unwrap());
        let forces: Vec<[f64; 6]> = d.contact.iter().map(|c| contact_force(&m, &d, c)).collect();
        let met = ray(&m, &d, [-0.45, 0.1, 2.0], [0.0, 0.01, -1.0], None);
        let found = json!({
            "energy": energy(&m, &mut d),
            "jac": jac.concat(),
            "contact_force": forces.concat(),
            "ray": met,
        });
        assert!(same(&expected["forward"], &found), "{} {found}", m.revision);
    }
}

#[test]
fn each_call_can_be_stored_and_goes_on() {
    let (m, _) = versions().swap_remove(1);
    let calls: [fn(&Model, &mut Data); 4] = [
        step1,
        |m, d| {
            step1(m, d);
            d.ctrl[0] = 0.25;
            step2(m, d);
        },
        |m, d| {
            d.qacc.fill(0.5);
            inverse(m, d);
        },
        |m, d| {
            d.xfrc_applied[3][2] = 1.5;
            step(m, d);
            d.xfrc_applied[3][2] = 0.5;
        },
    ];
    for (i, call) in calls.into_iter().enumerate() {
        let mut d = steps(&m, step);
        call(&m, &mut d);
        let text = serde_json::to_string(&d).unwrap();
        let mut again: Data = serde_json::from_str(&text).unwrap();
        again.check(&m).unwrap();
        again.resume(&m);
        assert_eq!(serde_json::to_string(&again).unwrap(), text, "{i}");
        assert_eq!(
            (&again.qfrc_inverse, &again.cvel),
            (&d.qfrc_inverse, &d.cvel),
            "{i}"
        );
        for data in [&mut d, &mut again] {
            step2(&m, data);
            step(&m, data);
        }
        assert_eq!(
            (again.qpos, again.sensordata),
            (d.qpos, d.sensordata),
            "{i}"
        );
    }
}

#[test]
fn names_lead_to_ids_and_back() {
    use mujoco_engine::model::ObjectType::{Actuator, Body, Geom, Joint, Site, Tendon};
    let (m, _) = versions().swap_remove(0);
    for (kind, name, id) in [
        (Body, "lower", 2),
        (Joint, "x", 3),
        (Geom, "g2", 3),
        (Site, "s1", 1),
        (Tendon, "u", 1),
    ] {
        assert_eq!((m.id(kind, name), m.name(kind, id)), (Some(id), Some(name)));
    }
    assert_eq!(m.joint_id("x"), Some(3));
    assert_eq!(
        (m.id(Actuator, "x"), m.name(Actuator, 0), m.name(Body, 9)),
        (None, None, None)
    );
}

/// A geom's frame that nearly equals the body's inertial frame is replaced by the inertial frame.
#[test]
fn frames_that_hardly_differ_are_one() {
    let text = r#"<mujoco><worldbody><body pos="0 0 1"><joint axis="0 1 0"/>
        <inertial pos="0.1 2e-7 0" quat="1 1.00005 0 0" mass="1" diaginertia="1 1.1 1.2"/>
        <geom size="0.1 0.1 0.1" pos="0.1 0 0" quat="1 1 0 0" type="box"/>
        <geom size="0.1" pos="5e-7 0 0" quat="1 4e-7 0 0"/></body></worldbody></mujoco>"#;
    let m = Model::from_xml(&text.replace("1.00005", "1.0000005")).unwrap();
    let mut d = Data::new(&m);
    d.qpos[0] = 0.3;
    forward(&m, &mut d);
    assert_eq!((d.geom_xpos[0], d.geom_xmat[0]), (d.xipos[1], d.ximat[1]));
    assert_eq!((d.geom_xpos[1], d.geom_xmat[1]), (d.xpos[1], d.xmat[1]));
    let m = Model::from_xml(text).unwrap();
    forward(&m, &mut d);
    assert_ne!(d.geom_xmat[0], d.ximat[1]);
}

/// Data whose numbers are not finite, as after a step that diverged, is stored as JSON whole, fits
/// its model, and goes on as the original. No number panics.
#[test]
fn data_that_diverged_can_be_stored_and_goes_on() {
    let parts: [fn(&mut Data) -> &mut f64; 7] = [
        |d| &mut d.qpos[0],
        |d| &mut d.qvel[0],
        |d| &mut d.qacc_warmstart[0],
        |d| &mut d.ctrl[0],
        |d| &mut d.qfrc_applied[0],
        |d| &mut d.xfrc_applied[3][2],
        |d| &mut d.time,
    ];
    for (m, _) in versions() {
        for bad in [f64::NAN, f64::INFINITY, -1e300] {
            for (i, part) in parts.iter().enumerate() {
                let mut d = steps(&m, step);
                assert!(d.is_bounded());
                *part(&mut d) = bad;
                step(&m, &mut d);
                *part(&mut d) = bad;
                assert_eq!(d.is_bounded(), i == 6 && bad == -1e300, "{i} {bad}");
                let text = serde_json::to_string(&d).unwrap();
                assert_eq!(text.contains("$float"), !bad.is_finite(), "{text}");
                let mut again: Data = serde_json::from_str(&text).unwrap();
                again.check(&m).unwrap();
                again.resume(&m);
                assert_eq!(serde_json::to_string(&again).unwrap(), text, "{i} {bad}");
                for _ in 0..3 {
                    for data in [&mut d, &mut again] {
                        step(&m, data);
                    }
                    let stored = |d| serde_json::to_string(d).unwrap();
                    assert_eq!(stored(&d), stored(&again), "{i} {bad}");
                }
            }
        }
    }
}

/// With a tolerance of 0 a step takes every iteration, so that 2^31 would never end.
#[test]
fn iterations_have_a_limit() {
    for solver in ["Newton", "CG", "PGS"] {
        let text = |options: &str| {
            format!(
                r#"<mujoco><option solver="{solver}" tolerance="0" {options}/><worldbody>
                <geom type="plane" size="1 1 1"/><body pos="0 0 .05"><freejoint/>
                <geom size=".1" friction="1"/></body></worldbody></mujoco>"#
            )
        };
        for option in [
            "iterations",
            "ls_iterations",
            "noslip_iterations",
            "ccd_iterations",
        ] {
            let most = text(&format!("{option}=\"100000\""));
            let m = Model::from_xml(&most).unwrap();
            step(&m, &mut Data::new(&m));
            let error = Model::from_xml(&text(&format!("{option}=\"2147483647\"")));
            let error = error.unwrap_err().to_string();
            assert!(
                error.contains(option) && error.contains("more than 100000"),
                "{error}"
            );
        }
        let mut m = Model::from_xml(&text("")).unwrap();
        let error = m.change(|c| c.opt.noslip_iterations = 1 << 31);
        assert!(error.unwrap_err().to_string().contains("noslip_iterations"));
        let error = m.change(|c| c.opt.ccd_iterations = 0);
        assert!(error.unwrap_err().to_string().contains("ccd_iterations"));
    }
}

/// An unknown class is told with a few that exist.
#[test]
fn not_every_class_is_named() {
    let classes: String = (0..500)
        .map(|i| format!("<default class=\"a rather long name {i}\"/>"))
        .collect();
    let text = format!(
        "<mujoco><default>{classes}</default><worldbody><geom class=\"b\" size=\"1\"/></worldbody></mujoco>"
    );
    let error = Model::from_xml(&text).unwrap_err().to_string();
    assert!(
        error.contains("a rather long name 1, ") && error.contains("more") && error.len() < 500,
        "{error}"
    );
}

/// `start` gives the state before the last call, whatever becomes of the data. Of the two halves of a step, the second has
/// controls, activations and forces of its own.
#[test]
fn data_tells_the_state_that_its_last_call_started_from() {
    let text = r#"<mujoco><worldbody><body name="hand" mocap="true"/><body><freejoint/><geom size=".1"/></body>
        <body><joint name="j"/><geom size=".1" pos=".3 0 0"/></body></worldbody>
        <actuator><intvelocity joint="j" actrange="-9 9"/><motor joint="j"/></actuator></mujoco>"#;
    let m = Model::from_xml(text).unwrap();
    let set = |d: &mut Data, number: f64| {
        d.time = number;
        d.qpos.fill(number + 0.1);
        d.qvel.fill(number + 0.2);
        d.ctrl.fill(number + 0.3);
        d.qacc_warmstart.fill(number + 0.4);
        d.act.fill(number + 0.5);
        d.mocap_pos.fill([number + 0.6; 3]);
        d.mocap_quat.fill([number + 0.7; 4]);
        d.qfrc_applied.fill(number + 0.8);
        d.xfrc_applied.fill([number + 0.9; 6]);
    };
    let names = [
        "time",
        "qpos",
        "qvel",
        "ctrl",
        "qacc_warmstart",
        "act",
        "mocap_pos",
        "mocap_quat",
        "qfrc_applied",
        "xfrc_applied",
    ];
    let later = [
        "ctrl",
        "qacc_warmstart",
        "act",
        "qfrc_applied",
        "xfrc_applied",
    ];
    let check = |d: &Data, first: f64, second: f64, what: &str| {
        let start = d.start().unwrap();
        assert_eq!(start.map(|(name, _)| name), names, "{what}");
        for (i, (name, numbers)) in start.into_iter().enumerate() {
            let from = if later.contains(&name) { second } else { first };
            let expected = vec![if i == 0 { from } else { from + i as f64 / 10.0 }; numbers.len()];
            assert!(!numbers.is_empty(), "{what}, {name}");
            assert_eq!(numbers, expected, "{what}, {name}");
        }
    };
    let mut d = Data::new(&m);
    assert!(d.start().is_none());
    let calls = [step, step1, step2, forward];
    let names = ["step", "step1", "step2", "forward"];
    for (number, (name, call)) in (1..).zip(names.into_iter().zip(calls)) {
        // after a step, a second half has no first half to go on from
        d.reset(&m);
        step(&m, &mut d);
        set(&mut d, f64::from(number));
        call(&m, &mut d);
        set(&mut d, 99.0);
        check(&d, f64::from(number), f64::from(number), name);
    }
    for first in [step1, forward] {
        d.reset(&m);
        set(&mut d, 1.0);
        first(&m, &mut d);
        set(&mut d, 2.0);
        step2(&m, &mut d);
        set(&mut d, 99.0);
        check(&d, 1.0, 2.0, "both halves");
    }
}
