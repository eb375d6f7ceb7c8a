//! The velocity sweeps of many worlds in lockstep: one world in each lane of vector registers.
//!
//! A sweep is a chain of operations that wait for each other, so one world alone leaves a CPU idle; worlds side by
//! side fill it. It needs islands that are alike: the same bodies and hinges in the same order, as the
//! environments' have. A contact that one world has and another has not is masked. Whatever is not alike is solved by itself
//! ([`Lanes::load`]); the bits are the same.

use fearless_simd::{Level, Simd, dispatch};

use super::Box2d;
use super::contact_solver::lanes::Touch;
use super::joint::Constraint as Joint;
use super::joint::lanes::Hinge;
use super::motion::Velocity;
use super::wide::{LANES, Pair, Strip, Wide, rows};

/// Fewer worlds are solved faster one by one, as their sweeps repeat (see [`sweeps`](super::sweeps)).
const FEWEST: usize = 4;
/// Contacts of one body that find room.
const TOUCHES: usize = 8;

rows! {
    /// A body.
    struct BodyRows { inv_mass, inv_inertia, v_x, v_y, w }
}

/// The bodies that move.
#[derive(Clone, Debug, Default)]
pub(super) struct Bodies(Vec<BodyRows>);

impl Bodies {
    /// Reciprocal mass and moment of inertia.
    #[inline(always)]
    pub(super) fn masses<S: Simd, const R: usize>(
        &self,
        strip: Strip<S, R>,
        body: usize,
    ) -> (Wide<S, R>, Wide<S, R>) {
        let rows = &self.0[body];
        (strip.load(&rows.inv_mass), strip.load(&rows.inv_inertia))
    }

    /// Velocity and angular velocity.
    #[inline(always)]
    pub(super) fn load<S: Simd, const R: usize>(
        &self,
        strip: Strip<S, R>,
        body: usize,
    ) -> (Pair<S, R>, Wide<S, R>) {
        let rows = &self.0[body];
        (strip.pair(&rows.v_x, &rows.v_y), strip.load(&rows.w))
    }

    #[inline(always)]
    pub(super) fn store<S: Simd, const R: usize>(
        &mut self,
        strip: Strip<S, R>,
        body: usize,
        v: Pair<S, R>,
        w: Wide<S, R>,
    ) {
        let rows = &mut self.0[body];
        strip.store(&mut rows.v_x, v.x);
        strip.store(&mut rows.v_y, v.y);
        strip.store(&mut rows.w, w);
    }
}

/// Working memory for the islands of up to [`LANES`] worlds.
#[derive(Clone, Debug)]
pub(crate) struct Lanes {
    level: Level,
    sweeps: u32,
    /// Lanes in use.
    len: usize,
    /// The bodies of each hinge.
    ends: Vec<(usize, usize)>,
    bodies: Bodies,
    hinges: Vec<Hinge>,
    /// Those of each body.
    touches: Vec<[Touch; TOUCHES]>,
}

impl Lanes {
    pub(crate) fn new(level: Level) -> Self {
        let (bodies, hinges, touches) = (Bodies::default(), Vec::new(), Vec::new());
        Self { level, sweeps: 0, len: 0, ends: Vec::new(), bodies, hinges, touches }
    }

    /// Takes the island of a step that has begun into the next lane, and gives its number; `None` if it is not like
    /// those that are there, or there are [`LANES`].
    pub(in crate::physics) fn load(&mut self, world: &Box2d) -> Option<usize> {
        let island = &world.island;
        let begun = world.begun.filter(|begun| begun.seed.is_some())?;
        let sweeps = begun.step.velocity_iterations;
        let bodies = island.bodies.iter().map(|id| &world.bodies[*id]);
        let dynamic = bodies.clone().take_while(|body| body.dynamic).count();
        let joints = &island.joint_constraints;
        let alike = self.len == 0
            || (sweeps == self.sweeps && dynamic == self.bodies.0.len() && joints.len() == self.ends.len());
        let fits = |i: usize, ends: Option<(usize, usize)>| {
            ends.is_some_and(|(a, b)| a < dynamic && b < dynamic && (self.len == 0 || self.ends[i] == (a, b)))
        };
        let mut places = Places::default();
        let mut room = |body: usize| places.next(body).1 < TOUCHES;
        if !alike
            || self.len == LANES
            || !joints.iter().enumerate().all(|(i, joint)| fits(i, joint.driven_ends()))
            || !(island.contact_constraints.iter())
                .all(|contact| contact.moving_body(dynamic, &island.velocities).is_some_and(&mut room))
        {
            return None;
        }

        if self.len == 0 {
            self.sweeps = sweeps;
            self.ends.clear();
            self.ends.extend(joints.iter().filter_map(Joint::driven_ends));
            self.bodies.0.resize(dynamic, BodyRows::ZERO);
            self.hinges.resize(joints.len(), Hinge::ZERO);
            self.touches.resize(dynamic, [const { Touch::NONE }; TOUCHES]);
            for touch in self.touches.as_flattened_mut() {
                if !touch.is_none() {
                    *touch = Touch::NONE;
                }
            }
        }
        let lane = self.len;
        self.len += 1;
        for ((rows, body), velocity) in self.bodies.0.iter_mut().zip(bodies).zip(&island.velocities) {
            rows.inv_mass.0[lane] = body.inv_mass;
            rows.inv_inertia.0[lane] = body.inv_inertia;
            rows.v_x.0[lane] = velocity.v.x;
            rows.v_y.0[lane] = velocity.v.y;
            rows.w.0[lane] = velocity.w;
        }
        for (rows, joint) in self.hinges.iter_mut().zip(joints) {
            rows.load(lane, joint);
        }
        let mut places = Places::default();
        for contact in &island.contact_constraints {
            let (body, place) = places.next(contact.body_b());
            self.touches[body][place].load(lane, contact);
        }
        Some(lane)
    }

    /// Makes the sweeps in all lanes.
    pub(crate) fn sweep(&mut self) {
        let len = self.len;
        if len < FEWEST {
            return;
        }
        if len < LANES {
            // what is computed in idle lanes must be finite and not small, which would be slow
            self.bodies.0.iter_mut().for_each(|rows| rows.pad(len));
            self.hinges.iter_mut().for_each(|rows| rows.pad(len));
            let touches = self.touches.as_flattened_mut().iter_mut();
            touches.filter(|touch| !touch.is_none()).for_each(|touch| touch.pad(len));
        }
        let level = self.level;
        dispatch!(level, simd => self.sweep_all(simd));
    }

    #[inline(always)]
    fn sweep_all<S: Simd>(&mut self, simd: S) {
        use fearless_simd::prelude::*;
        let width = S::f32s::LEN;
        let mut at = 0;
        while at < self.len {
            if self.len - at > width {
                self.sweep_strip(Strip::<S, 2> { simd, at });
                at += 2 * width;
            } else {
                self.sweep_strip(Strip::<S, 1> { simd, at });
                at += width;
            }
        }
    }

    /// As [`sweeps::sweep`](super::sweeps::sweep): all joints, then all contacts. Those of different bodies do not
    /// know of each other.
    #[inline(always)]
    fn sweep_strip<S: Simd, const R: usize>(&mut self, strip: Strip<S, R>) {
        let Self { ends, bodies, hinges, touches, .. } = self;
        for _ in 0..self.sweeps {
            for (hinge, ends) in hinges.iter_mut().zip(&*ends) {
                hinge.sweep(strip, bodies, *ends);
            }
            for (body, touches) in touches.iter_mut().enumerate() {
                for touch in touches {
                    if touch.is_none() {
                        break;
                    }
                    touch.sweep(strip, bodies, body);
                }
            }
        }
    }

    /// Gives an island back what the sweeps have made of it.
    pub(in crate::physics) fn collect(&self, lane: usize, world: &mut Box2d) {
        if self.len < FEWEST {
            return world.sweep();
        }
        let island = &mut world.island;
        for (Velocity { v, w }, rows) in island.velocities.iter_mut().zip(&self.bodies.0) {
            (v.x, v.y, *w) = (rows.v_x.0[lane], rows.v_y.0[lane], rows.w.0[lane]);
        }
        for (joint, rows) in island.joint_constraints.iter_mut().zip(&self.hinges) {
            rows.collect(lane, joint);
        }
        let mut places = Places::default();
        for contact in &mut island.contact_constraints {
            let (body, place) = places.next(contact.body_b());
            self.touches[body][place].collect(lane, contact);
        }
    }

    /// Makes room for the next worlds.
    pub(crate) fn clear(&mut self) {
        self.len = 0;
    }
}

/// Numbers the contacts of each body, which come one body after the other.
#[derive(Default)]
struct Places {
    last: Option<(usize, usize)>,
}

impl Places {
    fn next(&mut self, body: usize) -> (usize, usize) {
        let place = self.last.filter(|(last, _)| *last == body).map_or(0, |(_, place)| place + 1);
        *self.last.insert((body, place))
    }
}
