//! Sensors of several worlds: see [`sensor`](crate::physics::sensor).

use std::ops::Range;

use fearless_simd::Simd;
use gym_numerics::math::{Lanes, Real};

use super::{Arrays, At, Batch, PerWorld, load, store};
use crate::Model;
use crate::math::number;
use crate::math::spatial::{
    MINVAL, add, rotate_back6, rotation, scale, transform_motion, translation,
};
use crate::model::{Integrator, SensorType, Stage};
use crate::physics::contact_force::force_of;
use crate::physics::sensor::{fixed, touch_of};

/// Iterates over the sensors that write to the first `numbers` elements of `sensordata`.
fn read(m: &Model, numbers: usize) -> impl Iterator<Item = usize> {
    (0..m.nsensor()).filter(move |&i| m.sensor_adr[i] < numbers)
}

/// Whether worlds that step together can compute the first `numbers` elements of `sensordata`.
pub(super) fn fit(m: &Model, numbers: usize) -> bool {
    numbers <= m.nsensordata()
        && read(m, numbers).all(|i| {
            let kind = match m.sensor_type[i] {
                SensorType::SubtreeLinVel | SensorType::Velocimeter | SensorType::Gyro => true,
                SensorType::Touch => m.opt.integrator == Integrator::Euler,
                _ => false,
            };
            kind && m.sensor_cutoff[i] <= 0.0
        })
}

/// Whether a touch sensor writes to the first `numbers` elements of `sensordata`.
pub(super) fn touch(m: &Model, numbers: usize) -> bool {
    read(m, numbers).any(|i| m.sensor_type[i] == SensorType::Touch)
}

impl Batch {
    /// Computes the frames of the new state and the sensors, for the worlds in the register.
    pub(super) fn settle<S: Simd>(&mut self, m: &Model, at: At<S>, len: usize) {
        // touch sensors need the forces, contacts and frames of the last timestep
        self.touch_sensors(m, at.1..len.min(at.1 + Lanes::<S>::LANES));
        let (simd, sensors, whole) = (at.0, self.sensors, self.reads_frames);
        simd.vectorize(
            #[inline(always)]
            || self.arrays.frames(m, at, whole),
        );
        if sensors > 0 {
            simd.vectorize(
                #[inline(always)]
                || {
                    self.arrays.inertias(m, at);
                    self.arrays.motions(m, at);
                    self.arrays.measure(m, at, sensors);
                },
            );
        }
    }

    /// Computes the touch sensors, world by world because each world has its own contacts.
    fn touch_sensors(&mut self, m: &Model, worlds: Range<usize>) {
        for i in read(m, self.sensors) {
            if m.sensor_type[i].stage() != Stage::Acceleration {
                continue;
            }
            let site = m.sensor_objid[i] as usize;
            for world in worlds.clone() {
                let (a, forces) = (&self.arrays, self.method.forces());
                let pos = a.site_xpos[site].each_ref().map(|row| row.0[world]);
                let mat = a.site_xmat[site].each_ref().map(|row| row.0[world]);
                let felt = touch_of(
                    m,
                    (site, pos, &mat),
                    &self.rows.contacts[world],
                    |contact| {
                        let first = contact.efc_address as usize;
                        force_of(m, contact, |k| Some(forces.get(first + k)?.0[world]))[0]
                    },
                );
                self.arrays.sensordata[m.sensor_adr[i]].0[world] = felt;
            }
        }
    }
}

impl Arrays {
    /// Computes the sensors of positions and velocities in the first `numbers` elements of
    /// `sensordata`.
    #[inline(always)]
    pub(super) fn measure<S: Simd>(&mut self, m: &Model, at: At<S>, numbers: usize) {
        if read(m, numbers).any(|i| m.sensor_type[i] == SensorType::SubtreeLinVel) {
            self.subtree_velocities(m, at);
        }
        for i in read(m, numbers) {
            let id = m.sensor_objid[i] as usize;
            let measured = match m.sensor_type[i] {
                SensorType::SubtreeLinVel => number::get::<Lanes<S>, 6>(at, &self.force[id]),
                SensorType::Velocimeter | SensorType::Gyro => self.of_site(m, at, id),
                _ => continue,
            };
            let measured = if m.sensor_type[i] == SensorType::Gyro {
                rotation(&measured)
            } else {
                translation(&measured)
            };
            let first = m.sensor_adr[i];
            for (row, x) in self.sensordata[first..first + 3].iter_mut().zip(measured) {
                store(at, row, x);
            }
        }
    }

    /// Returns the angular velocity of a body, and its linear velocity at a point.
    #[inline(always)]
    fn velocity<S: Simd>(
        &self,
        m: &Model,
        at: At<S>,
        body: usize,
        pos: &[PerWorld; 3],
    ) -> [Lanes<S>; 6] {
        if fixed(m, body) {
            return number::of(at, [0.0; 6]);
        }
        let com = number::get(at, &self.subtree_com[m.body_rootid[body]]);
        let velocity = number::get::<Lanes<S>, 6>(at, &self.cvel[body]);
        transform_motion(&velocity, number::get(at, pos), com)
    }

    /// Returns the angular and linear velocity of a site, in the site's axes.
    #[inline(always)]
    fn of_site<S: Simd>(&self, m: &Model, at: At<S>, site: usize) -> [Lanes<S>; 6] {
        let body = m.site_bodyid[site];
        let velocity = self.velocity(m, at, body, &self.site_xpos[site]);
        if fixed(m, body) {
            return velocity;
        }
        let mat = number::get::<Lanes<S>, 9>(at, &self.site_xmat[site]);
        rotate_back6(&mat, &velocity)
    }

    /// Computes the velocities of the subtrees' centres of mass. The results are in the buffer
    /// `force`.
    #[inline(always)]
    fn subtree_velocities<S: Simd>(&mut self, m: &Model, at: At<S>) {
        for b in 0..m.nbody() {
            let velocity = self.velocity(m, at, b, &self.xipos[b]);
            let momentum = scale(translation(&velocity), m.body_mass[b]);
            self.put_linear(at, b, momentum);
        }
        for b in (0..m.nbody()).rev() {
            let own = self.linear(at, b);
            if b > 0 {
                let parent = m.body_parentid[b];
                let sum = add(self.linear(at, parent), own);
                self.put_linear(at, parent, sum);
            }
            let mass = f64::max(MINVAL, m.body_subtreemass[b]);
            self.put_linear(at, b, scale(own, 1.0 / mass));
        }
    }

    #[inline(always)]
    fn linear<S: Simd>(&self, at: At<S>, body: usize) -> [Lanes<S>; 3] {
        [3, 4, 5].map(
            #[inline(always)]
            |k| load(at, &self.force[body][k]),
        )
    }

    #[inline(always)]
    fn put_linear<S: Simd>(&mut self, at: At<S>, body: usize, velocity: [Lanes<S>; 3]) {
        for (row, x) in self.force[body][3..].iter_mut().zip(velocity) {
            store(at, row, x);
        }
    }
}
