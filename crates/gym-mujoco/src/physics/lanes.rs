//! Worlds of one model side by side, one in each lane of vector registers.
//!
//! The smooth stages run for all worlds at once, and each world has the bits that it has alone.
//! Every function called under `vectorize` is `#[inline(always)]`: otherwise it is compiled without
//! the CPU's vector instructions.

use fearless_simd::{Level, Simd};
use gym_core::math::{Lanes, Real};

use super::com::{Inertias, com_pos_of};
use super::inertia::{Composite, crb_of};
use super::kinematics::{Frames, kinematics_of};
use super::number::Number;
use super::velocity::{Bias, Motion, com_vel_of, rne_of};
use crate::{Data, Model};

/// The most worlds that are stepped at once.
pub(crate) const WORLDS: usize = 8;

/// A number of each world.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub(crate) struct Row(pub(crate) [f64; WORLDS]);

impl Row {
    const ZERO: Self = Self([0.0; WORLDS]);
}

/// The worlds in a register: as many as it has lanes, from the second one on.
type Place<S> = (S, usize);

impl<S: Simd> Number for Lanes<S> {
    type Place = Place<S>;
    type Cell = Row;
    type Mask = <Self as Real>::Mask;

    #[inline(always)]
    fn of((simd, _): Place<S>, x: f64) -> Self {
        <Self as Real>::get(simd, &[x; WORLDS])
    }

    #[inline(always)]
    fn get((simd, at): Place<S>, cell: &Row) -> Self {
        <Self as Real>::get(simd, &cell.0[at..])
    }

    #[inline(always)]
    fn put(self, (_, at): Place<S>, cell: &mut Row) {
        Real::put(self, &mut cell.0[at..]);
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        Real::sqrt(self)
    }

    #[inline(always)]
    fn inverse(self) -> Self {
        self.same(1.0) / self
    }

    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        Real::sin_cos(self)
    }

    #[inline(always)]
    fn is_below(self, x: f64) -> Self::Mask {
        self.lt(self.same(x))
    }

    #[inline(always)]
    fn is_off(self, from: f64, by: f64) -> Self::Mask {
        (self - from).abs().gt(self.same(by))
    }

    #[inline(always)]
    fn is_zero(self) -> Self::Mask {
        self.abs().le(self.same(0.0))
    }

    #[inline(always)]
    fn choose<const K: usize>(
        mask: Self::Mask,
        yes: impl FnOnce() -> [Self; K],
        no: impl FnOnce() -> [Self; K],
    ) -> [Self; K] {
        let (yes, mut no) = (yes(), no());
        for (no, yes) in no.iter_mut().zip(yes) {
            *no = Self::select(mask, yes, *no);
        }
        no
    }
}

/// The arrays of the smooth stages.
macro_rules! arrays {
    ($($name:ident: $type:ty = ($zero:expr, $length:expr),)+) => {
        /// The worlds' arrays, as in [`Data`].
        #[derive(Clone, Debug, Default)]
        pub(crate) struct Worlds {
            $(pub(crate) $name: Vec<$type>,)+
        }

        impl Worlds {
            pub(crate) fn new(m: &Model) -> Self {
                $(let $name: fn(&Model) -> usize = $length;)+
                Self { $($name: vec![$zero; $name(m)],)+ }
            }
        }
    };
}

arrays! {
    qpos: Row = (Row::ZERO, |m| m.nq()),
    qvel: Row = (Row::ZERO, |m| m.nv()),
    xpos: [Row; 3] = ([Row::ZERO; 3], |m| m.nbody()),
    xquat: [Row; 4] = ([Row([1.0; WORLDS]), Row::ZERO, Row::ZERO, Row::ZERO], |m| m.nbody()),
    xmat: [Row; 9] = (IDENTITY, |m| m.nbody()),
    xipos: [Row; 3] = ([Row::ZERO; 3], |m| m.nbody()),
    ximat: [Row; 9] = (IDENTITY, |m| m.nbody()),
    xanchor: [Row; 3] = ([Row::ZERO; 3], |m| m.njnt()),
    xaxis: [Row; 3] = ([Row::ZERO; 3], |m| m.njnt()),
    geom_xpos: [Row; 3] = ([Row::ZERO; 3], |m| m.ngeom()),
    geom_xmat: [Row; 9] = (IDENTITY, |m| m.ngeom()),
    site_xpos: [Row; 3] = ([Row::ZERO; 3], |m| m.nsite()),
    site_xmat: [Row; 9] = (IDENTITY, |m| m.nsite()),
    subtree_com: [Row; 3] = ([Row::ZERO; 3], |m| m.nbody()),
    cinert: [Row; 10] = ([Row::ZERO; 10], |m| m.nbody()),
    crb: [Row; 10] = ([Row::ZERO; 10], |m| m.nbody()),
    cdof: [Row; 6] = ([Row::ZERO; 6], |m| m.nv()),
    cdof_dot: [Row; 6] = ([Row::ZERO; 6], |m| m.nv()),
    cvel: [Row; 6] = ([Row::ZERO; 6], |m| m.nbody()),
    acc: [Row; 6] = ([Row::ZERO; 6], |m| m.nbody()),
    force: [Row; 6] = ([Row::ZERO; 6], |m| m.nbody()),
    qm: Row = (Row::ZERO, |m| m.plan().m_colind.len()),
    qfrc_bias: Row = (Row::ZERO, |m| m.nv()),
}

const ONE: Row = Row([1.0; WORLDS]);
const IDENTITY: [Row; 9] = [
    ONE,
    Row::ZERO,
    Row::ZERO,
    Row::ZERO,
    ONE,
    Row::ZERO,
    Row::ZERO,
    Row::ZERO,
    ONE,
];

impl Worlds {
    /// Takes the positions and velocities of a world.
    pub(crate) fn gather(&mut self, world: usize, d: &Data) {
        for (row, x) in self.qpos.iter_mut().zip(&d.qpos) {
            row.0[world] = *x;
        }
        for (row, x) in self.qvel.iter_mut().zip(&d.qvel) {
            row.0[world] = *x;
        }
    }

    /// Runs the smooth stages: frames, inertias, the inertia matrix, velocities and bias forces.
    /// False where the CPU has no vectors of numbers with fused multiply-adds.
    pub(crate) fn smooth(&mut self, m: &Model, level: Level) -> bool {
        #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
        {
            if let Some(simd) = level.as_avx512() {
                simd.vectorize(
                    #[inline(always)]
                    || self.stages(m, simd),
                );
                return true;
            }
            if let Some(simd) = level.as_avx2() {
                simd.vectorize(
                    #[inline(always)]
                    || self.stages(m, simd),
                );
                return true;
            }
        }
        let _ = (m, level);
        false
    }

    #[inline(always)]
    fn stages<S: Simd>(&mut self, m: &Model, simd: S) {
        for first in (0..WORLDS).step_by(<Lanes<S> as Real>::LANES) {
            let at = (simd, first);
            let frames = Frames {
                qpos: &self.qpos,
                mocap_pos: &[],
                mocap_quat: &[],
                xpos: &mut self.xpos,
                xquat: &mut self.xquat,
                xmat: &mut self.xmat,
                xipos: &mut self.xipos,
                ximat: &mut self.ximat,
                xanchor: &mut self.xanchor,
                xaxis: &mut self.xaxis,
                geom_xpos: &mut self.geom_xpos,
                geom_xmat: &mut self.geom_xmat,
                site_xpos: &mut self.site_xpos,
                site_xmat: &mut self.site_xmat,
            };
            kinematics_of::<Lanes<S>>(m, at, frames);
            let inertias = Inertias {
                xmat: &self.xmat,
                xipos: &self.xipos,
                ximat: &self.ximat,
                xanchor: &self.xanchor,
                xaxis: &self.xaxis,
                subtree_com: &mut self.subtree_com,
                cinert: &mut self.cinert,
                cdof: &mut self.cdof,
            };
            com_pos_of::<Lanes<S>>(m, at, inertias);
            let composite = Composite {
                cinert: &self.cinert,
                cdof: &self.cdof,
                crb: &mut self.crb,
                qm: &mut self.qm,
            };
            crb_of::<Lanes<S>>(
                m,
                at,
                composite,
                #[inline(always)]
                |_, _, _| 0,
            );
            let motion = Motion {
                qvel: &self.qvel,
                cdof: &self.cdof,
                cvel: &mut self.cvel,
                cdof_dot: &mut self.cdof_dot,
            };
            com_vel_of::<Lanes<S>>(m, at, motion);
            let bias = Bias {
                qvel: &self.qvel,
                cinert: &self.cinert,
                cdof: &self.cdof,
                cvel: &self.cvel,
                cdof_dot: &self.cdof_dot,
                acc: &mut self.acc,
                force: &mut self.force,
                qfrc_bias: &mut self.qfrc_bias,
            };
            rne_of::<Lanes<S>>(m, at, bias);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tasks::{load, models};
    use crate::{Revision, forward, step};

    /// The levels of this CPU with vectors of several widths.
    fn levels() -> Vec<Level> {
        let level = Level::new();
        let mut levels = vec![level];
        #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
        if let Some(avx2) = level.as_avx2() {
            levels.push(avx2.level());
        }
        levels
    }

    /// All numbers of a world.
    macro_rules! same {
        ($worlds:ident, $world:ident, $data:ident, $what:expr, $($name:ident)+) => {$(
            for (rows, numbers) in $worlds.$name.iter().zip(&$data.$name) {
                let rows: &[Row] = rows;
                for (row, x) in rows.iter().zip(numbers) {
                    assert_eq!(row.0[$world].to_bits(), x.to_bits(), "{} {}", stringify!($name), $what);
                }
            }
        )+};
    }

    #[test]
    fn worlds_have_the_bits_of_one_alone() {
        for (name, _) in models() {
            for revision in Revision::ALL {
                let m = load(name, revision).unwrap();
                let mut alone: Vec<Data> = (0..WORLDS).map(|_| Data::new(&m)).collect();
                let mut seed = 7_u64;
                let mut random = move || {
                    seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
                    (seed >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
                };
                for (world, d) in alone.iter_mut().enumerate() {
                    // some worlds stay where they begin, and some have a zero angle
                    for _ in 0..world * 7 {
                        d.ctrl.iter_mut().for_each(|ctrl| *ctrl = random());
                        step(&m, d);
                    }
                    forward(&m, d);
                }
                for level in levels() {
                    let mut worlds = Worlds::new(&m);
                    for (world, d) in alone.iter().enumerate() {
                        worlds.gather(world, d);
                    }
                    if !worlds.smooth(&m, level) {
                        return;
                    }
                    for (world, d) in alone.iter().enumerate() {
                        let what = format!("{name} {revision}, world {world}");
                        same!(worlds, world, d, what,
                            xpos xquat xmat xipos ximat xanchor xaxis geom_xpos geom_xmat site_xpos site_xmat
                            subtree_com cinert cdof cdof_dot cvel);
                        for (row, x) in worlds.qfrc_bias.iter().zip(&d.qfrc_bias) {
                            assert_eq!(row.0[world].to_bits(), x.to_bits(), "{what}");
                        }
                        for i in 0..m.nv() {
                            for k in m.plan().m_row(i) {
                                assert_eq!(
                                    worlds.qm[k].0[world].to_bits(),
                                    d.qm[k].to_bits(),
                                    "{what}"
                                );
                            }
                        }
                    }
                }
            }
        }
    }
}
