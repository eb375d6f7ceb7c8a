//! Refuses numbers that a model cannot have: those that MJCF refuses, in any compiled model.

use std::fmt::Display;

use super::inertia::MINVAL;
use crate::Result;
use crate::error::ensure;
use crate::math::spatial::norm;
use crate::model::{
    BiasType, CompiledModel, GainType, JointType, MAX_ITERATIONS, WrapType, most_iterations,
};

/// The part by which moments of inertia may miss the inequality of their sums, by rounding.
const ROUNDING: f64 = 1e-9;
/// The part by which the length of a quaternion or an axis may differ from 1, by rounding.
pub(super) const LENGTH: f64 = 1e-3;

/// Checks the numbers of a model whose arrays have the right lengths, and whose ids exist.
pub(super) fn check(m: &CompiledModel) -> Result<()> {
    options(m)?;
    all_finite(m)?;
    non_negative(m)?;
    masses(m)?;
    ranges(m)?;
    softness(m)?;
    turns(m)?;
    cameras(m)
}

fn options(m: &CompiledModel) -> Result<()> {
    let o = &m.opt;
    for (name, number) in [("timestep", o.timestep), ("impratio", o.impratio)] {
        ensure!(
            number > 0.0 && number.is_finite(),
            "opt.{name} is {number}, must be positive"
        );
    }
    for (name, number) in [
        ("opt.tolerance", o.tolerance),
        ("opt.ls_tolerance", o.ls_tolerance),
        ("opt.noslip_tolerance", o.noslip_tolerance),
        ("opt.ccd_tolerance", o.ccd_tolerance),
        ("opt.sleep_tolerance", o.sleep_tolerance),
        ("opt.density", o.density),
        ("opt.viscosity", o.viscosity),
        ("stat.meaninertia", m.stat.meaninertia),
        ("stat.meanmass", m.stat.meanmass),
        ("stat.meansize", m.stat.meansize),
        ("stat.extent", m.stat.extent),
    ] {
        let allowed = number >= 0.0;
        ensure!(
            allowed,
            "{name} is {number}: it must be a number that is not negative"
        );
    }
    for (name, number) in [
        ("iterations", o.iterations),
        ("ls_iterations", o.ls_iterations),
        ("noslip_iterations", o.noslip_iterations),
        ("ccd_iterations", o.ccd_iterations),
    ] {
        ensure!(
            number <= MAX_ITERATIONS,
            "opt.{name} is {number}, more than {}",
            most_iterations()
        );
    }
    ensure!(
        o.ccd_iterations > 0,
        "opt.ccd_iterations is 0, must be positive"
    );
    let [[gx, gy, gz], [wx, wy, wz]] = [o.gravity, o.wind];
    finite("opt", &[gx, gy, gz, wx, wy, wz, o.density, o.viscosity])?;
    finite("opt.magnetic", &o.magnetic)?;
    finite("stat", &[m.stat.meaninertia])
}

pub(super) fn finite(what: impl Display, numbers: &[f64]) -> Result<()> {
    let Some(i) = numbers.iter().position(|x| !x.is_finite()) else {
        return Ok(());
    };
    Err(crate::Error::Model(format!(
        "number {i} of {what} is not finite"
    )))
}

fn all_finite(m: &CompiledModel) -> Result<()> {
    macro_rules! all_finite {
        (flat: $($flat:ident)+; rows: $($rows:ident)+; lists: $($lists:ident)+;
         parameters: $($parameters:ident)+) => {
            let arrays = [
                $((stringify!($flat), &m.$flat[..]),)+
                $((stringify!($rows), m.$rows.as_flattened()),)+
            ];
            // by reference: a copy of the array would not fit on a small stack
            for &(name, numbers) in &arrays {
                finite(name, numbers)?;
            }
            $(for (i, list) in m.$lists.iter().enumerate() {
                finite(format_args!("{}[{i}]", stringify!($lists)), list)?;
            })+
            $(for (i, parameters) in m.$parameters.iter().enumerate() {
                finite(format_args!("{}[{i}]", stringify!($parameters)), &parameters.0)?;
            })+
        };
    }
    all_finite!(
        flat:
            body_gravcomp dof_frictionloss tendon_margin tendon_stiffness tendon_damping
            tendon_frictionloss tendon_armature actuator_cranklength tendon_length0 tendon_invweight0 actuator_length0 actuator_acc0
            sensor_cutoff sensor_noise pair_margin pair_gap qpos0 qpos_spring body_mass
            body_subtreemass jnt_margin jnt_stiffness dof_armature dof_damping dof_invweight0 dof_m0
            geom_rbound geom_solmix geom_margin geom_gap geom_adhesion pair_adhesion wrap_prm key_time cam_fovy;
        rows:
            jnt_stiffnesspoly dof_dampingpoly tendon_stiffnesspoly tendon_dampingpoly
            body_pos body_quat body_ipos body_iquat body_inertia body_invweight0 jnt_pos jnt_axis
            jnt_range jnt_solref jnt_solimp geom_size geom_pos geom_quat geom_friction geom_solref
            geom_solimp site_pos site_quat actuator_gear actuator_ctrlrange actuator_forcerange
            actuator_actrange actuator_lengthrange jnt_actfrcrange dof_solref dof_solimp
            tendon_range tendon_actfrcrange tendon_lengthspring tendon_solref_lim tendon_solimp_lim
            tendon_solref_fri tendon_solimp_fri eq_solref eq_solimp eq_data pair_solref
            pair_solreffriction pair_solimp pair_friction cam_pos cam_quat cam_sensorsize cam_intrinsic
            geom_aabb geom_surfacevel;
        lists: key_qpos key_qvel key_ctrl key_act key_mpos key_mquat;
        parameters: actuator_dynprm actuator_gainprm actuator_biasprm geom_fluid
    );
    Ok(())
}

fn non_negative(m: &CompiledModel) -> Result<()> {
    macro_rules! arrays {
        (flat: $($flat:ident)+; rows: $($rows:ident)+) => {
            [
                $((stringify!($flat), &m.$flat[..], 1),)+
                $((stringify!($rows), m.$rows.as_flattened(), 3),)+
            ]
        };
    }
    let arrays = arrays!(
        flat:
            body_mass jnt_margin jnt_stiffness dof_armature dof_damping dof_frictionloss
            geom_rbound geom_solmix tendon_stiffness tendon_damping tendon_frictionloss tendon_armature
            sensor_cutoff sensor_noise geom_adhesion pair_adhesion;
        rows: body_inertia geom_friction
    );
    for (name, numbers, width) in arrays {
        if let Some(i) = numbers.iter().position(|x| *x < 0.0) {
            let (row, number) = (i / width, numbers[i]);
            ensure!(
                false,
                "{name}[{row}] has the number {number}, and must not be negative"
            );
        }
    }
    let parts = m.wrap_type.iter().zip(&m.wrap_prm);
    for (w, (kind, divisor)) in parts.enumerate() {
        ensure!(
            *kind != WrapType::Pulley || *divisor >= 0.0,
            "wrap_prm[{w}] is {divisor}: the divisor of a pulley must not be negative"
        );
    }
    Ok(())
}

fn masses(m: &CompiledModel) -> Result<()> {
    if let Some(b) = weightless(m) {
        return Err(crate::Error::Model(format!(
            "body {b} has joints, and therefore needs positive body_mass and body_inertia"
        )));
    }
    for (b, moments) in m.body_inertia.iter().enumerate() {
        let [x, y, z] = *moments;
        let most = x.max(y).max(z);
        let possible = x + y + z - most >= most * (1.0 - ROUNDING);
        ensure!(
            possible,
            "body_inertia[{b}] is impossible: of {x}, {y}, {z}, two must sum to at least the third"
        );
    }
    Ok(())
}

/// A movable body without mass, whose acceleration would be infinite. Bodies that are fixed to it
/// count.
pub(super) fn weightless(m: &CompiledModel) -> Option<usize> {
    let weighs = |b: usize| {
        m.body_mass[b] >= MINVAL && m.body_inertia[b].iter().all(|moment| *moment >= MINVAL)
    };
    let mut heavy: Vec<bool> = (0..m.nbody()).map(weighs).collect();
    (1..m.nbody()).rev().find(|&b| {
        let fixed = m.body_jntnum[b] == 0;
        if fixed {
            heavy[m.body_parentid[b]] |= heavy[b];
        }
        !fixed && !heavy[b]
    })
}

fn ranges(m: &CompiledModel) -> Result<()> {
    let ordered = |what: &str, ranges: &[[f64; 2]]| {
        let wrong = ranges.iter().position(|[low, high]| low > high);
        match wrong {
            Some(i) => Err(crate::Error::Model(format!(
                "{what}[{i}] has its limits in the wrong order"
            ))),
            None => Ok(()),
        }
    };
    ordered("jnt_range", &m.jnt_range)?;
    ordered("actuator_ctrlrange", &m.actuator_ctrlrange)?;
    ordered("tendon_lengthspring", &m.tendon_lengthspring)?;
    // a ball joint may be limited to the angle 0
    let scalar = |j: usize| m.jnt_type[j].is_scalar();
    let limited: Vec<bool> = (0..m.njnt())
        .map(|j| m.jnt_limited[j] && scalar(j))
        .collect();
    let muscles: Vec<bool> = (0..m.nu())
        .map(|i| {
            m.actuator_gaintype[i] == GainType::Muscle || m.actuator_biastype[i] == BiasType::Muscle
        })
        .collect();
    for (name, ranges, limited) in [
        ("jnt_range", &m.jnt_range, &limited),
        ("jnt_actfrcrange", &m.jnt_actfrcrange, &m.jnt_actfrclimited),
        ("tendon_range", &m.tendon_range, &m.tendon_limited),
        (
            "tendon_actfrcrange",
            &m.tendon_actfrcrange,
            &m.tendon_actfrclimited,
        ),
        (
            "actuator_ctrlrange",
            &m.actuator_ctrlrange,
            &m.actuator_ctrllimited,
        ),
        (
            "actuator_forcerange",
            &m.actuator_forcerange,
            &m.actuator_forcelimited,
        ),
        (
            "actuator_actrange",
            &m.actuator_actrange,
            &m.actuator_actlimited,
        ),
        ("actuator_lengthrange", &m.actuator_lengthrange, &muscles),
    ] {
        for (i, ([low, high], limited)) in ranges.iter().zip(limited).enumerate() {
            ensure!(
                !limited || low < high,
                "{name}[{i}] is {low} to {high}: the lower limit must be less than the upper one"
            );
        }
    }
    Ok(())
}

fn softness(m: &CompiledModel) -> Result<()> {
    for (name, solrefs) in [
        ("jnt_solref", &m.jnt_solref),
        ("geom_solref", &m.geom_solref),
        ("dof_solref", &m.dof_solref),
        ("eq_solref", &m.eq_solref),
        ("pair_solref", &m.pair_solref),
        ("tendon_solref_lim", &m.tendon_solref_lim),
        ("tendon_solref_fri", &m.tendon_solref_fri),
    ] {
        for (i, [first, second]) in solrefs.iter().enumerate() {
            ensure!(
                (*first > 0.0) == (*second > 0.0),
                "{name}[{i}] has one positive number: both must be, or none"
            );
            ensure!(
                *first != 0.0,
                "{name}[{i}] begins with 0, which makes no force"
            );
        }
    }
    Ok(())
}

/// Checks the lengths of quaternions and axes.
fn turns(m: &CompiledModel) -> Result<()> {
    let one = |length: f64| (length - 1.0).abs() <= LENGTH;
    for (name, quats) in [
        ("body_quat", &m.body_quat),
        ("body_iquat", &m.body_iquat),
        ("geom_quat", &m.geom_quat),
        ("site_quat", &m.site_quat),
        ("cam_quat", &m.cam_quat),
    ] {
        let wrong = quats.iter().position(|quat| !one(length(quat)));
        ensure!(
            wrong.is_none(),
            "{name}[{}] is not of length 1: divide it by its length",
            wrong.unwrap_or_default()
        );
    }
    for j in 0..m.njnt() {
        let kind = m.jnt_type[j];
        ensure!(
            !kind.is_scalar() || one(norm(m.jnt_axis[j])),
            "jnt_axis[{j}] is not of length 1: divide it by its length"
        );
        let at = match kind {
            JointType::Free => m.jnt_qposadr[j] + 3,
            JointType::Ball => m.jnt_qposadr[j],
            _ => continue,
        };
        // the engine normalises these
        let states = [("qpos0", &m.qpos0), ("qpos_spring", &m.qpos_spring)];
        let keys = m.key_qpos.iter().map(|qpos| ("key_qpos", qpos));
        for (name, qpos) in states.into_iter().chain(keys) {
            let turned = length(&qpos[at..at + 4]) >= MINVAL;
            ensure!(
                turned,
                "{name} has at {at} a quaternion of length 0, for joint {j}"
            );
        }
    }
    Ok(())
}

pub(super) fn length(numbers: &[f64]) -> f64 {
    numbers.iter().map(|x| x * x).sum::<f64>().sqrt()
}

fn cameras(m: &CompiledModel) -> Result<()> {
    for (i, fovy) in m.cam_fovy.iter().enumerate() {
        ensure!(
            *fovy > 0.0 && *fovy < 180.1,
            "cam_fovy[{i}] is {fovy}, must lie between 0 and 180 degrees"
        );
    }
    Ok(())
}
