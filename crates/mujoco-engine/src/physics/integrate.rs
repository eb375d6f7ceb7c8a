//! Velocities and positions from accelerations.

use std::f64::consts::PI;

use super::actuation::advance;
use super::inertia::{add_damping, factor_damped, solve};
use super::{evaluate, implicit, sleep};
use crate::math::libm::{self, wide};
use crate::math::number::Number;
use crate::math::spatial::{InTurn, Order, Pairwise, Vec3, add_scaled, cross, dot, scale};
use crate::model::{Integrator, JointType};
use crate::{Data, Model};

/// Advances positions by the velocities times `dt`: MuJoCo's `mj_integratePos`.
pub fn integrate_pos(m: &Model, qpos: &mut [f64], qvel: &[f64], dt: f64) {
    integrate_pos_of::<f64>(m, (), qpos, qvel, dt);
}

/// [`integrate_pos`] for one world or several.
#[inline(always)]
pub(super) fn integrate_pos_of<N: Number>(
    m: &Model,
    at: N::At,
    qpos: &mut [N::Cell],
    qvel: &[N::Cell],
    dt: f64,
) {
    let (moved,) = (
        #[inline(always)]
        |q: &N::Cell, v: &N::Cell| N::get(at, q) + N::get(at, v) * dt,
    );
    for joint in &m.plan().joints {
        let (mut p, mut v) = (joint.qpos, joint.dof);
        let free = joint.kind == JointType::Free;
        if free {
            for k in 0..3 {
                moved(&qpos[p + k], &qvel[v + k]).put(at, &mut qpos[p + k]);
            }
            (p, v) = (p + 3, v + 3);
        }
        if free || joint.kind == JointType::Ball {
            let quat: [N; 4] = std::array::from_fn(
                #[inline(always)]
                |k| N::get(at, &qpos[p + k]),
            );
            let velocity = std::array::from_fn(
                #[inline(always)]
                |k| N::get(at, &qvel[v + k]),
            );
            let turned = if m.revision.adds_in_pairs() {
                Pairwise::quat_integrate(at, quat, velocity, dt)
            } else {
                InTurn::quat_integrate(at, quat, velocity, dt)
            };
            for (x, q) in turned.into_iter().zip(&mut qpos[p..p + 4]) {
                x.put(at, q);
            }
        } else {
            moved(&qpos[p], &qvel[v]).put(at, &mut qpos[p]);
        }
    }
}

/// Semi-implicit Euler, implicit in joint damping: MuJoCo's `mj_Euler`. Call it for models whose
/// integrator is Euler.
pub fn euler(m: &Model, d: &mut Data) {
    wide(
        (m, d),
        #[inline(always)]
        |(m, d)| semi_implicit(m, d),
        #[inline(always)]
        |(m, d)| semi_implicit(m, d),
    );
}

#[inline(always)]
fn semi_implicit(m: &Model, d: &mut Data) {
    let dt = m.opt.timestep;
    let fast = m.opt.integrator == Integrator::ImplicitFast;
    // `step2` uses Euler's method for models with the RK4 integrator, whose damped matrix is not
    // factored before
    let late = m.opt.integrator == Integrator::RK4 && m.plan().damped;
    if fast {
        implicit::factor(m, d);
    }
    if late {
        add_damping(m, d);
        factor_damped(m, d);
    }
    let whole = m.opt.integrator == Integrator::Implicit;
    let sleeps = m.plan().sleeps;
    let damped = m.plan().implicit && !(sleeps && sleep::is_undamped(m, d));
    if fast || late || whole || damped {
        let forces = d.qfrc_smooth.iter().zip(&d.qfrc_constraint);
        for (sum, (smooth, constraint)) in d.work.acc_sum.iter_mut().zip(forces) {
            *sum = smooth + constraint;
        }
        if whole {
            let mut sum = std::mem::take(&mut d.work.acc_sum);
            let mut buffers = std::mem::take(&mut d.work.implicit);
            implicit::solve(m, d, &mut buffers, &mut sum);
            (d.work.acc_sum, d.work.implicit) = (sum, buffers);
        } else if fast {
            implicit::solve_fast(m, d);
        } else {
            let work = &mut d.work;
            let (inverses, way) = (&work.qh_diag_inv, &mut work.way);
            solve(m, &work.qh, inverses, way, &mut work.acc_sum);
        }
    } else {
        d.work.acc_sum.copy_from_slice(&d.qacc);
    }
    if m.na() > 0 {
        let rates = std::mem::take(&mut d.act_dot);
        advance(m, d, &rates);
        d.act_dot = rates;
    }
    if sleeps {
        sleep::fall_asleep(m, d);
    }
    for (velocity, acceleration) in d.qvel.iter_mut().zip(&d.work.acc_sum) {
        *velocity += dt * acceleration;
    }
    integrate_pos(m, &mut d.qpos, &d.qvel, dt);
    if sleeps {
        sleep::stay(m, d);
    }
    d.time += dt;
    d.qacc_warmstart.copy_from_slice(&d.qacc);
}

/// The weights of the Runge-Kutta stages.
pub(super) const WEIGHTS: [f64; 4] = [1.0 / 6.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0];
/// For each stage, the fraction of the timestep from the start to the next stage.
pub(super) const PARTS: [f64; 4] = [0.5, 0.5, 1.0, 0.0];

/// Runge-Kutta of fourth order: MuJoCo's `mj_RungeKutta`. The caller has already run `forward` at
/// the start.
///
/// From 4.0 on, angular velocities of free joints are of fourth order too (`rates`), and `qacc`
/// is left as the mean of the stages; before, it is left as that of the last stage.
pub fn runge_kutta(m: &Model, d: &mut Data) {
    let (dt, start, nv) = (m.opt.timestep, d.time, m.nv());
    d.work.qpos_start.copy_from_slice(&d.qpos);
    d.work.qvel_start.copy_from_slice(&d.qvel);
    d.work.vel_sum.fill(0.0);
    d.work.acc_sum.fill(0.0);
    if m.na() > 0 {
        d.work.act_start.copy_from_slice(&d.act);
        d.work.act_sum.fill(0.0);
    }
    let turns = m.revision.turns_by_stages()
        && (m.jnt_type.iter()).any(|kind| matches!(kind, JointType::Free | JointType::Ball));
    // the time from the start to the current stage
    let mut way = 0.0;
    let skips = d.work.skips;
    d.work.skips = true;
    for (stage, (weight, part)) in WEIGHTS.into_iter().zip(PARTS).enumerate() {
        if turns {
            rates(m, &d.qvel, way, &mut d.work.rates);
        }
        let rates = if turns { &d.work.rates } else { &d.qvel };
        let (vel_sum, acc_sum) = (&mut d.work.vel_sum[..nv], &mut d.work.acc_sum[..nv]);
        for (sum, rate) in vel_sum.iter_mut().zip(rates) {
            *sum += weight * rate;
        }
        for (sum, acceleration) in acc_sum.iter_mut().zip(&d.qacc) {
            *sum += weight * acceleration;
        }
        for (sum, rate) in d.work.act_sum.iter_mut().zip(&d.act_dot) {
            *sum += weight * rate;
        }
        if part > 0.0 {
            d.qpos.copy_from_slice(&d.work.qpos_start);
            way = part * dt;
            integrate_pos(m, &mut d.qpos, rates, way);
            advance_from(&mut d.qvel, &d.work.qvel_start, &d.qacc, way);
            advance_from(&mut d.act, &d.work.act_start, &d.act_dot, way);
            d.time = start + way;
            if stage == 2 {
                d.work.skips = skips; // no evaluation follows
            }
            evaluate(m, d);
            super::energy::update(m, d);
        }
    }
    if m.na() > 0 {
        d.act.copy_from_slice(&d.work.act_start);
        let rates = std::mem::take(&mut d.work.act_sum);
        advance(m, d, &rates);
        d.work.act_sum = rates;
    }
    d.qpos.copy_from_slice(&d.work.qpos_start);
    advance_from(&mut d.qvel, &d.work.qvel_start, &d.work.acc_sum, dt);
    integrate_pos(m, &mut d.qpos, &d.work.vel_sum, dt);
    d.time = start + dt;
    d.qacc_warmstart.copy_from_slice(&d.qacc);
    if m.revision.turns_by_stages() {
        d.qacc.copy_from_slice(&d.work.acc_sum);
    }
}

/// Sets numbers to `start + time * rates`.
fn advance_from(numbers: &mut [f64], start: &[f64], rates: &[f64], time: f64) {
    for (x, (start, rate)) in numbers.iter_mut().zip(start.iter().zip(rates)) {
        *x = start + time * rate;
    }
}

/// Computes the time derivatives of the positions from `qvel`, the velocities of a Runge-Kutta
/// stage.
///
/// From 4.0 on, the derivative for the orientation of a ball or free joint is the derivative of the
/// rotation vector since the start of the timestep (the Runge-Kutta-Munthe-Kaas method). On entry,
/// `rates` has the derivatives of the previous stage, and `way` is the time for which the step
/// advanced with them.
fn rates(m: &Model, qvel: &[f64], way: f64, rates: &mut [f64]) {
    if way == 0.0 {
        rates.copy_from_slice(qvel);
        return;
    }
    let mut done = 0;
    for joint in &m.plan().joints {
        let v = match joint.kind {
            JointType::Free => joint.dof + 3,
            JointType::Ball => joint.dof,
            JointType::Slide | JointType::Hinge => continue,
        };
        rates[done..v].copy_from_slice(&qvel[done..v]);
        let turn = [rates[v], rates[v + 1], rates[v + 2]].map(|rate| rate * way);
        let velocity = [qvel[v], qvel[v + 1], qvel[v + 2]];
        rates[v..v + 3].copy_from_slice(&rate_of_turn(turn, velocity));
        done = v + 3;
    }
    rates[done..].copy_from_slice(&qvel[done..]);
}

/// The rate of change of the rotation vector `turn` at the angular velocity `velocity`, given in
/// the turned frame.
pub(super) fn rate_of_turn(turn: Vec3, velocity: Vec3) -> Vec3 {
    // the last factor is (1 - t / tan t) / (4 t^2), with the square of the angle 2 t
    const SERIES: [f64; 9] = [
        1.230313397310169e-14,
        3.161551550077822e-13,
        1.3455485951057888e-11,
        5.282849430384459e-10,
        2.0876900642039142e-8,
        8.267194907152073e-7,
        3.30687830944332e-5,
        0.0013888888888859755,
        0.08333333333333338,
    ];
    /// The square of the largest angle for which the series is used.
    const SERIES_UP_TO: f64 = 3.0625;
    let (mut turn, mut square) = (turn, dot(turn, turn));
    if square > PI * PI {
        let angle = square.sqrt();
        let within = angle - 2.0 * PI * (angle / (2.0 * PI) + 0.5).floor();
        turn = scale(turn, within / angle);
        square = dot(turn, turn);
    }
    let factor = if square < SERIES_UP_TO {
        SERIES.into_iter().fold(0.0, |sum, x| sum * square + x)
    } else {
        let half = 0.5 * square.sqrt();
        let (sin, cos) = libm::sin_cos(half);
        (1.0 - half / (sin / cos)) / square
    };
    let once = cross(turn, velocity);
    let twice = cross(turn, once);
    add_scaled(add_scaled(velocity, once, 0.5), twice, factor)
}
