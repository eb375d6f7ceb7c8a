//! What data keeps and forgets: snapshots that are resumed, clones, resets and states that diverge have each array that
//! they should have.

use mujoco_engine::physics::{
    energy, inverse, rne_post_constraint, step1, step2, substep, substep2,
};
use mujoco_engine::{Data, Model, forward, step};

use super::parts;

/// The text of each field of data, with its name.
fn fields(m: &Model, d: &Data) -> Vec<(&'static str, String)> {
    macro_rules! fields {
        ($($field:ident)+; $($row:ident)+) => {
            vec![
                $((stringify!($field), format!("{:?}", d.$field)),)+
                $((concat!("efc.", stringify!($row)), format!("{:?}", d.efc.$row)),)+
                ("efc.j", format!("{:?}", d.efc.full_jacobian(m.nv()))),
            ]
        };
    }
    fields! {
        time qpos qvel ctrl act qfrc_applied xfrc_applied mocap_pos mocap_quat qacc_warmstart qacc tree_asleep userdata
        xpos xquat xmat xipos ximat xanchor xaxis geom_xpos geom_xmat site_xpos site_xmat subtree_com
        cinert cdof cvel cdof_dot act_dot sensordata energy subtree_linvel subtree_angmom cacc cfrc_int
        actuator_length actuator_velocity ten_j ten_length ten_velocity qfrc_passive qfrc_bias qfrc_actuator qfrc_smooth qacc_smooth qfrc_constraint qfrc_inverse cfrc_ext
        qld_diag_inv actuator_force contact solver_niter;
        pos margin r d kbip vel aref b force loss island nisland
    }
}

/// The names of the fields that differ.
pub(super) fn unlike(m: &Model, one: &Data, other: &Data) -> Vec<&'static str> {
    let pairs = fields(m, one).into_iter().zip(fields(m, other));
    pairs
        .filter(|(one, other)| one != other)
        .map(|((name, _), _)| name)
        .collect()
}

/// A state in motion, with numbers of a user, forces and controls.
fn moved(m: &Model) -> Data {
    let mut before = Data::new(m);
    let wave = |i: usize| (1.0 + 3.0 * i as f64).sin();
    let fill = |numbers: &mut [f64]| {
        for (i, x) in numbers.iter_mut().enumerate() {
            *x = wave(i);
        }
    };
    fill(&mut before.qvel);
    fill(&mut before.ctrl);
    (0..3).for_each(|_| step(m, &mut before));
    let mut d = Data::new(m);
    (d.time, d.qpos, d.qvel, d.act) = (before.time, before.qpos, before.qvel, before.act);
    d.qacc_warmstart = before.qacc_warmstart;
    d.userdata = vec![0.5, -0.0, 7.0];
    fill(&mut d.ctrl);
    fill(&mut d.qfrc_applied);
    fill(d.xfrc_applied.as_flattened_mut());
    d
}

type Call = fn(&Model, &mut Data);

/// Calls after which data can be stored.
const CALLS: [(&str, Call); 7] = [
    ("step", step),
    ("forward", forward),
    ("step1", step1),
    ("step1, step2", |m, d| {
        step1(m, d);
        d.ctrl.fill(0.25);
        d.qfrc_applied.fill(0.125);
        step2(m, d);
    }),
    ("inverse", |m, d| {
        d.qacc.fill(0.5);
        inverse(m, d);
    }),
    ("forward, contact forces", |m, d| {
        forward(m, d);
        rne_post_constraint(m, d);
    }),
    ("step, contact forces, no push", |m, d| {
        d.qfrc_applied.fill(0.0);
        d.xfrc_applied.fill([0.0; 6]);
        step(m, d);
        rne_post_constraint(m, d);
    }),
];

/// Calls `check` with each model that has one kind of part, and each call.
fn each(mut check: impl FnMut(&Model, &str, Call) -> Vec<&'static str>) {
    let mut wrong = Vec::new();
    for text in parts::models() {
        let Ok(m) = Model::from_xml(&text) else {
            continue;
        };
        for (name, call) in CALLS {
            let unlike = check(&m, name, call);
            if !unlike.is_empty() {
                wrong.push(format!(
                    "{}, {name}: {unlike:?}",
                    text.split('"').nth(1).unwrap_or_default()
                ));
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn data_that_is_resumed_has_each_array() {
    each(|m, _, call| {
        let mut d = moved(m);
        call(m, &mut d);
        let text = serde_json::to_string(&d).unwrap();
        let mut again: Data = serde_json::from_str(&text).unwrap();
        again.check(m).unwrap();
        assert!(again.is_computed());
        again.resume(m);
        unlike(m, &d, &again)
    });
}

#[test]
fn a_clone_goes_on_and_its_data_can_be_reset() {
    each(|m, _, call| {
        let mut d = moved(m);
        call(m, &mut d);
        let mut again = d.clone();
        let mut unlike = self::unlike(m, &d, &again);
        step(m, &mut d);
        step(m, &mut again);
        unlike.extend(self::unlike(m, &d, &again));
        energy(m, &mut d);
        d.reset(m);
        assert!(!d.is_computed() && !d.is_stepped() && d.start().is_none());
        unlike.extend(self::unlike(m, &d, &Data::new(m)));
        unlike
    });
}

/// A body that slides and turns, with contacts, an activation, energy, and sensors of each stage.
fn slider(integrator: &str) -> Model {
    let text = format!(
        r#"<mujoco><option integrator="{integrator}"><flag energy="enable"/></option><worldbody>
        <geom type="plane" size="5 5 1" condim="1"/><body pos="0 0 .09">
        <joint name="x" type="slide" axis="1 0 0"/><joint type="slide" axis="0 0 1"/>
        <geom size=".1" condim="1"/><site name="s"/></body></worldbody>
        <actuator><intvelocity joint="x" actrange="-9 9"/></actuator>
        <sensor><framepos objtype="site" objname="s"/><velocimeter site="s"/><accelerometer site="s"/></sensor>
        </mujoco>"#
    );
    Model::from_xml(&text).unwrap()
}

/// A number beyond 1e10, or none, in a position, a velocity or an acceleration is a divergence: the next call starts
/// from the initial state, with its controls and forces. The numbers up to 1e10 are none.
#[test]
fn a_state_that_diverged_is_the_initial_one() {
    let parts: [fn(&mut Data) -> &mut f64; 4] = [
        |d| &mut d.qpos[0],
        |d| &mut d.qpos[1],
        |d| &mut d.qvel[0],
        |d| &mut d.qvel[1],
    ];
    let halves: Call = |m, d| {
        step1(m, d);
        step2(m, d);
    };
    let other_halves: Call = |m, d| {
        step1(m, d);
        substep2(m, d);
    };
    let far = 1e10_f64;
    for integrator in ["Euler", "RK4", "implicitfast"] {
        let m = slider(integrator);
        for (name, call) in [
            ("step", step as Call),
            ("substep", substep),
            ("halves", halves),
            ("halves without sensors", other_halves),
        ] {
            let mut fresh = Data::new(&m);
            call(&m, &mut fresh);
            let used = || {
                let mut d = Data::new(&m);
                d.ctrl[0] = 3.0;
                d.qvel[0] = 2.0;
                (0..3).for_each(|_| step(&m, &mut d));
                d.qfrc_applied[1] = 0.5;
                d
            };
            for (i, part) in parts.iter().enumerate() {
                for bad in [far.next_up(), -far.next_up(), f64::NAN, f64::INFINITY] {
                    let mut d = used();
                    *part(&mut d) = bad;
                    call(&m, &mut d);
                    assert_eq!(d.time, m.opt.timestep, "{integrator} {name} {i} {bad}");
                    assert_eq!(
                        (d.qpos, d.qvel, d.act, d.ctrl, d.qfrc_applied),
                        (
                            fresh.qpos.clone(),
                            fresh.qvel.clone(),
                            fresh.act.clone(),
                            vec![0.0],
                            vec![0.0; 2]
                        ),
                        "{integrator} {name} {i} {bad}"
                    );
                }
                // (the floor, which the second joint leads to, answers with forces that are beyond)
                for good in [far, -far].into_iter().filter(|_| i % 2 == 0) {
                    let mut d = used();
                    let time = d.time + m.opt.timestep;
                    *part(&mut d) = good;
                    call(&m, &mut d);
                    assert_eq!(d.time, time, "{integrator} {name} {i} {good}");
                }
            }
            // a force that accelerates too much
            let mut d = used();
            d.qfrc_applied[0] = 1e300;
            call(&m, &mut d);
            assert_eq!(d.time, m.opt.timestep, "{integrator} {name}");
            if name == "halves" {
                assert_eq!(unlike(&m, &d, &fresh), [""; 0], "{integrator}");
            }
            assert_eq!(
                (d.qpos, d.act),
                (fresh.qpos, fresh.act),
                "{integrator} {name}"
            );
        }
    }
}

/// Each step computes the energy that the model asks for, also one that another follows.
#[test]
fn the_energy_is_that_of_each_step() {
    for integrator in ["Euler", "RK4"] {
        let m = slider(integrator);
        let (mut one, mut other) = (Data::new(&m), Data::new(&m));
        one.qvel[0] = 1.0;
        other.qvel[0] = 1.0;
        for i in 0..5 {
            step(&m, &mut one);
            substep(&m, &mut other);
            assert_eq!(one.energy, other.energy, "{integrator} {i}");
            assert!(one.energy[1] > 0.0);
        }
    }
}
