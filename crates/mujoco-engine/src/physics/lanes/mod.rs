//! Steps many worlds of one model together, one world in each lane of the vector registers.
//!
//! The smooth stages run for all worlds at once. Each world has the same bits as a world that steps
//! alone. Every function called under `vectorize` is `#[inline(always)]`: otherwise the compiler
//! would not use the CPU's vector instructions in the function.
//!
//! | file | what |
//! |---|---|
//! | `worlds`, `group` | worlds in columns, and worlds that are owned one by one |
//! | `derived` | a step of environments, and the arrays that they read after it |
//! | `fits` | which models and CPUs step worlds together |
//! | `stages`, `tree`, `actuators`, `sensors` | the smooth stages |
//! | `rows` | rows of constraints |
//! | `newton`, `gauss_seidel`, `alone` | constraint forces; `alone` makes rows, or solves, world by world |
//! | `arrays`, `per_world` | the memory, and the registers |

mod actuators;
mod alone;
mod arrays;
mod derived;
mod fits;
mod gauss_seidel;
mod group;
mod newton;
mod per_world;
mod rows;
mod sensors;
mod stages;
mod tree;
mod worlds;

use fearless_simd::{Level, Simd};
use gym_numerics::math::{Lanes, Real};

use self::alone::Alone;
pub(crate) use self::arrays::Arrays;
pub use self::derived::{Derived, Stride};
pub use self::fits::differ_in_stiffness;
pub(crate) use self::fits::{fits, width};
use self::gauss_seidel::GaussSeidel;
pub use self::group::Group;
use self::newton::Newton;
use self::per_world::{At, copy, load, same, store};
pub(crate) use self::per_world::{PerWorld, WORLDS};
use self::rows::{Rows, worlds};
pub use self::worlds::Worlds;
use super::integrate::{PARTS, WEIGHTS, integrate_pos_of};
use super::post_constraint::push_apart;
use crate::Model;
use crate::math::MAXVAL;
use crate::model::{Integrator, Solver};

/// Up to [`WORLDS`] worlds of one model, and the buffers of their stages.
#[derive(Clone, Debug)]
pub(crate) struct Batch {
    arrays: Arrays,
    rows: Rows,
    method: Method,
    /// [`Stride::settles`], and the number of elements of `sensordata` that a step computes.
    settles: bool,
    sensors: usize,
    /// Whether the task or a sensor reads frames of geoms or sites, and whether a touch sensor does.
    reads_frames: bool,
    feels: bool,
    /// A buffer: the contact forces on the bodies of one world.
    cfrc_ext: Vec<[f64; 6]>,
    /// A bit for each world: 1 if the world diverged.
    diverged: u64,
}

/// Returns the length of a world's state: `qpos`, `qvel` and `qacc_warmstart`.
pub(crate) fn state_len(m: &Model) -> usize {
    m.nq() + 2 * m.nv()
}

/// Returns the length of a world's record: the input of a step, which the step replaces by the
/// output. Input: state, actuator forces, poses of mocap bodies, controls, stiffness of joints.
/// Output: state, the state at the start of the last timestep, and the derived arrays that the task reads.
pub(crate) fn record_len(m: &Model, reads: &[Derived]) -> usize {
    let derived: usize = reads.iter().map(|array| array.len(m)).sum();
    let controls = actuators::inputs(m);
    let input = state_len(m) + m.nv() + 7 * m.nmocap() + controls + m.plan().springs.len();
    input.max(2 * state_len(m) + derived)
}

/// Returns the length of the longest record of a precomputed step in `Data`. The last number is the
/// time.
pub(crate) fn most_len(m: &Model) -> usize {
    record_len(m, &Derived::ALL) + 2 * m.ntendon() + m.nsensordata() + 1
}

/// How the constraint forces are found.
#[derive(Clone, Debug)]
enum Method {
    Newton(Box<Newton>),
    /// Newton's method, with rows that are made world by world.
    Gathered(Alone, Box<Newton>),
    GaussSeidel(GaussSeidel),
    /// World by world.
    Alone(Alone),
}

impl Method {
    fn new(m: &Model) -> Self {
        match m.opt.solver {
            _ if fits::gathers(m) => Self::Gathered(Alone::new(m), Box::new(Newton::new(m))),
            _ if !fits::makes_rows(m) => Self::Alone(Alone::new(m)),
            Solver::PGS => Self::GaussSeidel(GaussSeidel::new(m)),
            _ => Self::Newton(Box::new(Newton::new(m))),
        }
    }

    /// Returns the forces of the constraint rows.
    fn forces(&self) -> &[PerWorld] {
        match self {
            Self::Newton(newton) | Self::Gathered(_, newton) => newton.forces(),
            Self::GaussSeidel(gauss_seidel) => &gauss_seidel.force,
            Self::Alone(alone) => &alone.force,
        }
    }
}

impl Batch {
    /// Allocates worlds whose steps are of the kind `stride`.
    pub(crate) fn new(m: &Model, stride: &Stride) -> Self {
        let sensors = stride.sensors();
        let feels = sensors::touch(m, sensors);
        let keeps = stride.reads.contains(&Derived::CfrcExt) || feels;
        let of_frames = |array: &Derived| {
            matches!(
                array,
                Derived::GeomXpos | Derived::GeomXmat | Derived::SiteXpos
            )
        };
        Self {
            arrays: Arrays::new(m),
            rows: Rows::new(m, keeps),
            settles: stride.settles,
            sensors,
            reads_frames: sensors > 0 || stride.reads.iter().any(of_frames),
            feels,
            method: Method::new(m),
            cfrc_ext: vec![[0.0; 6]; m.nbody()],
            diverged: 0,
        }
    }

    /// Reads the input of world `world` from `record`.
    pub(crate) fn gather(&mut self, world: usize, record: &[f64]) {
        let a = &mut self.arrays;
        let arrays = [
            &mut a.qpos[..],
            &mut a.qvel,
            &mut a.warm,
            &mut a.qfrc_actuator,
            a.mocap_pos.as_flattened_mut(),
            a.mocap_quat.as_flattened_mut(),
            &mut a.input,
            &mut a.stiffness,
        ];
        let mut numbers = record.iter();
        for array in arrays {
            for (row, x) in array.iter_mut().zip(&mut numbers) {
                row.0[world] = *x;
            }
        }
    }

    /// Writes the output of world `world` to `record`. Returns false if the world diverged.
    pub(crate) fn scatter(
        &mut self,
        m: &Model,
        world: usize,
        reads: &[Derived],
        record: &mut [f64],
    ) -> bool {
        if reads.contains(&Derived::CfrcExt) {
            self.contact_forces(m, world);
        }
        let a = &self.arrays;
        let after = [&a.qpos, &a.qvel, &a.warm];
        let before = [&a.qpos_before, &a.qvel_before, &a.warm_before];
        let state = after.into_iter().chain(before).map(Vec::as_slice);
        let derived = reads.iter().map(|array| array.of(a));
        let mut numbers = record.iter_mut();
        for array in state.chain(derived) {
            for (row, x) in array.iter().zip(&mut numbers) {
                *x = row.0[world];
            }
        }
        self.diverged >> world & 1 == 0
    }

    /// Returns a key of world `world` in the last timestep: worlds with near keys take equally long.
    pub(crate) fn likeness(&self, world: usize) -> (u64, usize) {
        let likeness = match &self.method {
            Method::Gathered(alone, _) => alone.likeness(world),
            _ => 0,
        };
        (likeness, self.rows.count[world])
    }

    /// Computes `cfrc_ext` of world `world` from its contacts.
    fn contact_forces(&mut self, m: &Model, world: usize) {
        let mut forces = std::mem::take(&mut self.cfrc_ext);
        let (a, forces_of_rows) = (&self.arrays, self.method.forces());
        forces.fill([0.0; 6]);
        for contact in &self.rows.contacts[world] {
            let Ok(row) = usize::try_from(contact.efc_address) else {
                continue;
            };
            let edge = |k: usize| Some(forces_of_rows.get(row + k)?.0[world]);
            let com = |body: usize| a.subtree_com[body].each_ref().map(|row| row.0[world]);
            push_apart(m, contact, edge, com, &mut forces);
        }
        let rows = self.arrays.cfrc_ext.as_flattened_mut().iter_mut();
        for (row, x) in rows.zip(forces.as_flattened()) {
            row.0[world] = *x;
        }
        self.cfrc_ext = forces;
    }

    /// Advances the first `len` worlds, which were [gathered](Self::gather), by `steps` timesteps.
    /// Returns false if [`width`](fits::width) is `None` for `level`.
    pub(crate) fn step(&mut self, m: &Model, level: Level, len: usize, steps: usize) -> bool {
        #[cfg(all(feature = "lanes", any(target_arch = "x86", target_arch = "x86_64")))]
        {
            if let Some(simd) = level.as_avx512() {
                self.steps(m, simd, len, steps);
                return true;
            }
            if let Some(simd) = level.as_avx2() {
                self.steps(m, simd, len, steps);
                return true;
            }
        }
        let _ = (m, level, len, steps);
        false
    }

    fn steps<S: Simd>(&mut self, m: &Model, simd: S, len: usize, steps: usize) {
        let lanes = <Lanes<S> as Real>::LANES;
        self.diverged = 0;
        for first in (0..len).step_by(lanes) {
            let (at, live) = ((simd, first), u64::MAX >> (64 - (len - first).min(lanes)));
            // lanes without a world get a copy of the last world
            for world in len..first + lanes {
                let a = &mut self.arrays;
                let rows = [&mut a.qpos, &mut a.qvel, &mut a.warm, &mut a.qfrc_actuator];
                for row in rows.into_iter().flatten() {
                    row.0[world] = row.0[len - 1];
                }
            }
            for step in 1..=steps {
                // all frames in the last timestep, unless `settle` computes them again; touch sensors
                // read those of its start
                let reads = if self.settles {
                    self.feels
                } else {
                    self.reads_frames
                };
                let whole = reads && step == steps;
                self.one_step(m, at, live, whole);
            }
            simd.vectorize(
                #[inline(always)]
                || {
                    let a = &self.arrays;
                    let state = [&a.qpos, &a.qvel, &a.warm];
                    for numbers in state {
                        self.diverged |= beyond(at, numbers) << first;
                    }
                },
            );
            if self.settles {
                self.settle(m, at, len);
            }
        }
    }

    /// Advances the worlds in the register by one timestep. `live` has a bit for each world. If
    /// `whole` is false, frames that no stage reads keep their old values.
    fn one_step<S: Simd>(&mut self, m: &Model, at: At<S>, live: u64, whole: bool) {
        let simd = at.0;
        simd.vectorize(
            #[inline(always)]
            || self.begin(m, at),
        );
        let in_stages = m.opt.integrator == Integrator::RK4;
        self.evaluate(m, at, live, whole && !in_stages);
        simd.vectorize(
            #[inline(always)]
            || {
                let bad = beyond(at, &self.arrays.qacc);
                self.diverged |= bad << at.1;
            },
        );
        if in_stages {
            for stage in 0..4 {
                simd.vectorize(
                    #[inline(always)]
                    || self.stage(m, at, stage),
                );
                if PARTS[stage] > 0.0 {
                    self.evaluate(m, at, live, whole && stage == 2);
                }
            }
        }
        simd.vectorize(
            #[inline(always)]
            || self.integrate(m, at),
        );
    }

    /// Stores the state at the start of the timestep, and resets worlds that diverged.
    #[inline(always)]
    fn begin<S: Simd>(&mut self, m: &Model, at: At<S>) {
        let a = &mut self.arrays;
        let bad = beyond(at, &a.qpos) | beyond(at, &a.qvel);
        for world in worlds(bad, at.1) {
            self.diverged |= 1 << world;
            for (row, x) in a.qpos.iter_mut().zip(&m.qpos0) {
                row.0[world] = *x;
            }
            for row in a.qvel.iter_mut().chain(&mut a.warm) {
                row.0[world] = 0.0;
            }
        }
        copy(at, &a.qpos, &mut a.qpos_before);
        copy(at, &a.qvel, &mut a.qvel_before);
        copy(at, &a.warm, &mut a.warm_before);
    }

    /// Runs all stages of [`forward`](crate::forward).
    fn evaluate<S: Simd>(&mut self, m: &Model, at: At<S>, live: u64, whole: bool) {
        let simd = at.0;
        simd.vectorize(
            #[inline(always)]
            || self.arrays.positions(m, at, whole),
        );
        simd.vectorize(
            #[inline(always)]
            || self.arrays.matrix(m, at),
        );
        simd.vectorize(
            #[inline(always)]
            || self.arrays.velocities(m, at),
        );
        let Self {
            arrays,
            rows,
            method,
            ..
        } = self;
        simd.vectorize(
            #[inline(always)]
            || {
                rows.make(m, at, arrays, live);
                rows.reference(m, at, &arrays.qvel);
            },
        );
        if let Method::Gathered(alone, _) = method {
            alone.make(m, arrays, rows, at.1);
        }
        match method {
            Method::Alone(alone) => alone.solve(m, at, arrays, rows),
            Method::Newton(newton) | Method::Gathered(_, newton) if rows.used > 0 => {
                newton.solve(m, at, arrays, rows, live);
            }
            Method::GaussSeidel(gauss_seidel) if rows.used > 0 => {
                gauss_seidel.solve(m, at, arrays, rows, live);
            }
            _ => simd.vectorize(
                #[inline(always)]
                || {
                    copy(at, &arrays.qacc_smooth, &mut arrays.qacc);
                    for force in &mut arrays.qfrc_constraint {
                        store(at, force, same(at, 0.0));
                    }
                },
            ),
        }
    }

    /// Ends stage `stage` of the Runge-Kutta method: adds the rates of the stage to the sums, and
    /// moves the state to the next stage.
    #[inline(always)]
    fn stage<S: Simd>(&mut self, m: &Model, at: At<S>, stage: usize) {
        let a = &mut self.arrays;
        let (dt, weight, part) = (m.opt.timestep, WEIGHTS[stage], PARTS[stage]);
        // the time from the start of the timestep to stage `stage`
        let way = if stage == 0 {
            0.0
        } else {
            PARTS[stage - 1] * dt
        };
        a.stage_rates(m, at, way);
        for i in 0..m.nv() {
            let sums = [
                (&mut a.vel_sum[i], &a.rates[i]),
                (&mut a.acc_sum[i], &a.qacc[i]),
            ];
            for (sum, x) in sums {
                let before = if stage == 0 {
                    same(at, 0.0)
                } else {
                    load::<S>(at, sum)
                };
                store(at, sum, before + load::<S>(at, x) * weight);
            }
        }
        if part > 0.0 {
            copy(at, &a.qpos_before, &mut a.qpos);
            let way = part * dt;
            integrate_pos_of::<Lanes<S>>(m, at, &mut a.qpos, &a.rates, way);
            for i in 0..m.nv() {
                let moved = load::<S>(at, &a.qvel_before[i]) + load::<S>(at, &a.qacc[i]) * way;
                store(at, &mut a.qvel[i], moved);
            }
        }
    }

    /// Integrates velocities, then positions: with Euler's method, or with the sums of all
    /// Runge-Kutta stages.
    #[inline(always)]
    fn integrate<S: Simd>(&mut self, m: &Model, at: At<S>) {
        let a = &mut self.arrays;
        let (dt, runge_kutta) = (m.opt.timestep, m.opt.integrator == Integrator::RK4);
        if runge_kutta {
            copy(at, &a.qpos_before, &mut a.qpos);
        } else if m.plan().implicit {
            for i in 0..m.nv() {
                let force = load::<S>(at, &a.qfrc_smooth[i]) + load(at, &a.qfrc_constraint[i]);
                store(at, &mut a.acc_sum[i], force);
            }
            tree::solve(m, at, &a.qh, &a.qh_diag_inv, &mut a.acc_sum);
        } else {
            copy(at, &a.qacc, &mut a.acc_sum);
        }
        let start = if runge_kutta { &a.qvel_before } else { &a.qvel };
        for i in 0..m.nv() {
            // in Euler's method `qvel_before` equals `qvel`
            let moved = load::<S>(at, &start[i]) + load::<S>(at, &a.acc_sum[i]) * dt;
            store(at, &mut a.rates[i], moved);
        }
        copy(at, &a.rates, &mut a.qvel);
        let along = if runge_kutta { &a.vel_sum } else { &a.qvel };
        integrate_pos_of::<Lanes<S>>(m, at, &mut a.qpos, along, dt);
        copy(at, &a.qacc, &mut a.warm);
    }
}

/// Returns a bit for each world in the register, from the lowest bit: 1 if one of the world's
/// `numbers` is not finite or exceeds `MAXVAL`.
#[inline(always)]
fn beyond<S: Simd>(at: At<S>, numbers: &[PerWorld]) -> u64 {
    let most = same::<S>(at, MAXVAL);
    let mut good = most.le(most);
    for row in numbers {
        good &= Real::abs(load::<S>(at, row)).le(most);
    }
    !Lanes::<S>::bits(good) & (u64::MAX >> (64 - <Lanes<S> as Real>::LANES))
}

#[cfg(test)]
pub(crate) mod tests;
