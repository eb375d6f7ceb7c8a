//! All that a forward call computes, and single functions, as with libmujoco: to the last bit, except for the signs of
//! zeros. `recorded/results/record.py` recorded the digests.

use gym_numerics::RandomState;
use mujoco_engine::physics::{
    contact_force, energy, full_m, integrate_pos, inverse, mul_m, ray, rne_post_constraint,
    solve_m, transmission, transmission_velocity,
};
use mujoco_engine::{Data, Model, forward, step};

use super::digest::Digest;
use super::parts;

/// The numbers of each group: frames, motion, inertia, forces, contacts, rows of constraints, what is computed on
/// demand, and inverse dynamics.
fn results(m: &Model, d: &mut Data, random: &mut RandomState) -> [Vec<f64>; 8] {
    let nv = m.nv();
    let mut drawn =
        |number: usize| -> Vec<f64> { (0..number).map(|_| random.uniform(-1.0, 1.0)).collect() };
    let frames = [
        d.xpos.as_flattened(),
        d.xquat.as_flattened(),
        d.xmat.as_flattened(),
        d.xipos.as_flattened(),
        d.ximat.as_flattened(),
        d.xanchor.as_flattened(),
        d.xaxis.as_flattened(),
        d.geom_xpos.as_flattened(),
        d.geom_xmat.as_flattened(),
        d.site_xpos.as_flattened(),
        d.site_xmat.as_flattened(),
    ]
    .concat();
    // most models do not need the lengths of all actuators
    transmission(m, d);
    transmission_velocity(m, d);
    let motion = [
        d.subtree_com.as_flattened(),
        d.cinert.as_flattened(),
        d.cdof.as_flattened(),
        d.cvel.as_flattened(),
        d.cdof_dot.as_flattened(),
        &d.ten_length,
        &d.ten_velocity,
        &d.actuator_length,
        &d.actuator_velocity,
    ]
    .concat();
    let (x, mut product) = (drawn(nv), vec![0.0; nv]);
    mul_m(m, d, &x, &mut product);
    let mut solution = x;
    solve_m(m, d, &mut solution);
    let inertia = [full_m(m, d), product, solution, d.qld_diag_inv.clone()].concat();
    let forces = [
        &d.act_dot[..],
        &d.actuator_force,
        &d.qfrc_actuator,
        &d.qfrc_passive,
        &d.qfrc_bias,
        &d.qfrc_smooth,
        &d.qacc_smooth,
    ]
    .concat();
    let of_contacts = |numbers: fn(&Model, &Data, usize) -> Vec<f64>| -> Vec<f64> {
        (0..d.contact.len())
            .flat_map(|i| numbers(m, d, i))
            .collect()
    };
    let contacts = [
        of_contacts(|_, d, i| vec![d.contact[i].dist]),
        of_contacts(|_, d, i| d.contact[i].pos.to_vec()),
        of_contacts(|_, d, i| d.contact[i].frame.to_vec()),
        of_contacts(|_, d, i| vec![d.contact[i].includemargin]),
        of_contacts(|_, d, i| d.contact[i].friction.to_vec()),
        of_contacts(|_, d, i| d.contact[i].solref.to_vec()),
        of_contacts(|_, d, i| d.contact[i].solimp.to_vec()),
        of_contacts(|_, d, i| vec![d.contact[i].mu]),
        of_contacts(|_, d, i| vec![d.contact[i].dim.into()]),
        of_contacts(|_, d, i| d.contact[i].geom.map(|geom| geom as f64).to_vec()),
        of_contacts(|_, d, i| vec![d.contact[i].efc_address.into()]),
        of_contacts(|m, d, i| contact_force(m, d, &d.contact[i]).to_vec()),
    ]
    .concat();
    let rows = [
        &d.efc.full_jacobian(nv)[..],
        &d.efc.pos,
        &d.efc.margin,
        &d.efc.diag_approx(),
        &d.efc.r,
        &d.efc.d,
        d.efc.kbip.as_flattened(),
        &d.efc.vel,
        &d.efc.aref,
        &d.efc.b,
        &d.efc.force,
        &d.qfrc_constraint,
        &d.qacc,
    ]
    .concat();
    rne_post_constraint(m, d);
    energy(m, d);
    let mut positions = d.qpos.clone();
    integrate_pos(m, &mut positions, &d.qvel, 0.1);
    let last = m.nbody() - 1;
    let rays = (0..8).flat_map(|_| {
        let numbers = drawn(6);
        let point = |first: usize| std::array::from_fn(|i| numbers[first + i]);
        let (from, along) = (point(0), point(3));
        let met = ray(m, d, from, along, None);
        met.map_or([-1.0; 2], |(distance, geom)| [distance, geom as f64])
    });
    let rays: Vec<f64> = rays.collect();
    let on_demand = [
        d.cfrc_ext.as_flattened(),
        &d.energy,
        &d.jac(m, last, d.xipos[last]).concat(),
        &positions,
        &rays,
    ]
    .concat();
    d.qacc = drawn(nv);
    inverse(m, d);
    let inverted = [&d.qfrc_constraint[..], &d.qfrc_inverse, &d.sensordata].concat();
    [
        frames, motion, inertia, forces, contacts, rows, on_demand, inverted,
    ]
}

/// The halves of the digests of all groups.
fn digest(text: &str, version: &str) -> String {
    let m = match Model::from_xml_with(text, version.parse().unwrap()) {
        Ok(m) => m,
        Err(error) => return error.to_string(),
    };
    let (mut d, mut random) = (Data::new(&m), RandomState::new(0));
    let mut draw = |numbers: &mut [f64]| numbers.fill_with(|| random.uniform(-1.0, 1.0));
    draw(&mut d.qvel);
    for _ in 0..3 {
        draw(&mut d.ctrl);
        step(&m, &mut d);
    }
    draw(&mut d.ctrl);
    draw(&mut d.qfrc_applied);
    draw(d.xfrc_applied.as_flattened_mut());
    forward(&m, &mut d);
    let words = results(&m, &mut d, &mut random).map(|numbers| {
        let mut digest = Digest::default();
        numbers
            .iter()
            .for_each(|x| digest.word((x + 0.0).to_bits()));
        format!("{:08x}", (digest.0 ^ (digest.0 >> 32)) as u32)
    });
    words.join(" ")
}

/// The models that each have one kind of part, and those that were drawn by lot.
pub(super) fn models() -> Vec<String> {
    let random = include_str!("../recorded/random/models.txt").lines();
    parts::models()
        .into_iter()
        .chain(random.map(str::to_owned))
        .collect()
}

#[test]
fn all_results_are_those_of_libmujoco() {
    let recordings = [
        ("3.12", include_str!("../recorded/results/3.12.txt")),
        ("3.17", include_str!("../recorded/results/3.17.txt")),
        ("4.0", include_str!("../recorded/results/4.0.txt")),
    ];
    parts::assert_alike(&models(), recordings, digest);
}
