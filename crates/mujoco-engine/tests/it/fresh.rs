//! Functions called on data for which nothing was computed yet, or in another order than usual: none panics, and a half
//! step does what it does with libmujoco's zeros.

use mujoco_engine::model::Integrator;
use mujoco_engine::physics::{
    collision, com_pos, com_vel, contact_force, crb, energy, euler, factor_m,
    forward_without_actuators, full_m, fwd_actuation, fwd_constraint, inverse, kinematics,
    make_constraint, mul_m, passive, ray, reference_constraint, rne, rne_post_constraint,
    runge_kutta, solve_m, step1, step2, substep, substep2, tendon, tendon_velocity, transmission,
    transmission_velocity,
};
use mujoco_engine::{Data, Model, forward, step};

use super::results::models;

/// Draws rays, and reads what is computed on demand.
fn read(m: &Model, d: &mut Data) {
    let (x, mut y) = (vec![1.0; m.nv()], vec![0.0; m.nv()]);
    mul_m(m, d, &x, &mut y);
    solve_m(m, d, &mut y);
    assert_eq!(full_m(m, d).len(), m.nv() * m.nv());
    for body in 0..m.nbody() {
        assert_eq!(d.jac(m, body, [0.1, 0.2, 0.3])[0].len(), 3 * m.nv());
    }
    for site in 0..m.nsite() {
        assert_eq!(d.jac_site(m, site)[1].len(), 3 * m.nv());
    }
    for sensor in 0..m.nsensor() {
        assert_eq!(d.sensor(m, sensor).len(), m.sensor_dim[sensor]);
    }
    for along in [[1.0, 0.2, 0.1], [0.0, 0.0, -1.0], [0.0; 3]] {
        let _ = ray(m, d, [0.1, 0.2, 0.3], along, Some(0));
    }
    for contact in &d.contact {
        assert_eq!(contact_force(m, d, contact).len(), 6);
    }
    d.check(m).unwrap();
    let _ = (d.start(), d.is_bounded(), d.efc.full_jacobian(m.nv()));
}

type Function = fn(&Model, &mut Data);

/// What follows a function: nothing, half a step, or all that can be computed.
const AFTER: [Option<Function>; 3] = [None, Some(step2), Some(forward)];

/// The number of functions that begin from a state alone; the others are stages, which read what was computed before.
const CALLS: usize = 10;

/// Each function that takes a model and its data.
const FUNCTIONS: [(&str, Function); 31] = [
    ("step", step),
    ("substep", substep),
    ("step1", step1),
    ("step2", step2),
    ("substep2", substep2),
    ("forward", forward),
    ("forward_without_actuators", forward_without_actuators),
    ("inverse", inverse),
    ("rne_post_constraint", rne_post_constraint),
    ("read", read),
    ("energy", |m, d| {
        energy(m, d);
    }),
    ("kinematics", kinematics),
    ("com_pos", com_pos),
    ("tendon", tendon),
    ("crb", crb),
    ("factor_m", factor_m),
    ("collision", collision),
    ("make_constraint", make_constraint),
    ("transmission", transmission),
    ("com_vel", com_vel),
    ("tendon_velocity", tendon_velocity),
    ("transmission_velocity", transmission_velocity),
    ("passive", passive),
    ("reference_constraint", reference_constraint),
    ("rne", rne),
    ("fwd_actuation", fwd_actuation),
    ("fwd_constraint", fwd_constraint),
    ("euler", euler),
    ("runge_kutta", runge_kutta),
    ("resume", |m, d| d.resume(m)),
    ("reset", |m, d| d.reset(m)),
];

/// Sets velocities, controls and forces that are not zero.
fn disturb(d: &mut Data) {
    let inputs = [
        &mut d.qvel[..],
        &mut d.ctrl,
        &mut d.act,
        &mut d.qfrc_applied,
        &mut d.qacc,
        d.xfrc_applied.as_flattened_mut(),
    ];
    for (i, x) in inputs.into_iter().flatten().enumerate() {
        *x = (0.7 * i as f64 + 0.3).sin();
    }
}

/// One model in five of those that each have one kind of part: neighbours differ little.
fn each_kind() -> impl Iterator<Item = Model> {
    let texts = models().into_iter().step_by(5);
    texts.filter_map(|text| Model::from_xml(&text).ok())
}

#[test]
fn no_function_panics_on_new_data() {
    for m in each_kind() {
        for (name, function) in FUNCTIONS {
            for after in AFTER {
                let mut d = Data::new(&m);
                disturb(&mut d);
                let called = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| {
                    function(&m, &mut d);
                    if let Some(after) = after {
                        after(&m, &mut d);
                    }
                    read(&m, &mut d);
                }));
                assert!(called.is_ok(), "{name}, {} actuators", m.nu());
            }
        }
    }
}

/// Data that was reset, or is a snapshot, has nothing computed either.
#[test]
fn functions_take_reset_and_read_data_as_new_data() {
    for m in each_kind() {
        for (name, function) in FUNCTIONS.into_iter().take(CALLS) {
            let mut new = Data::new(&m);
            let mut used = Data::new(&m);
            disturb(&mut used);
            (0..3).for_each(|_| step(&m, &mut used));
            used.reset(&m);
            let text = serde_json::to_string(&new).unwrap();
            let mut read: Data = serde_json::from_str(&text).unwrap();
            read.resume(&m);
            let states = [&mut new, &mut used, &mut read].map(|d| {
                disturb(d);
                function(&m, d);
                // NaN equals nothing, so the bits are compared
                let numbers = d.qpos.iter().chain(&d.qvel).chain(&d.act).chain(&d.qacc);
                numbers.map(|x| x.to_bits()).collect::<Vec<_>>()
            });
            assert_eq!(states[0], states[1], "{name}, reset");
            assert_eq!(states[0], states[2], "{name}, read");
        }
    }
}

/// With libmujoco all inertia is zero before the first half of a step, and so are accelerations.
#[test]
fn half_a_step_of_new_data_keeps_its_velocities() {
    let mut undamped = 0;
    for m in each_kind() {
        let explicit = matches!(m.opt.integrator, Integrator::Euler | Integrator::RK4);
        if !explicit || m.dof_damping.iter().any(|damping| *damping != 0.0) {
            continue;
        }
        let mut d = Data::new(&m);
        disturb(&mut d);
        let (positions, velocities) = (d.qpos.clone(), d.qvel.clone());
        step2(&m, &mut d);
        assert_eq!(d.time, m.opt.timestep);
        assert_eq!(d.qvel, velocities);
        assert_eq!(d.qacc, vec![0.0; m.nv()]);
        assert!(m.nv() == 0 || d.qpos != positions);
        assert!(d.contact.is_empty() && d.efc.nefc() == 0);
        undamped += 1;
    }
    assert!(undamped > 20, "{undamped}");
}
