//! The velocity iterations of many worlds in lockstep: one world in each lane of the vector
//! registers.
//!
//! In one iteration, each operation waits for the result of the previous one, so a single world
//! leaves most of a CPU idle; several worlds use the idle time. All islands must have the same
//! bodies and joints in the same order, as worlds of one environment have. Masks handle contacts
//! that only some worlds have. [`Lanes::load`] rejects an island with other bodies or joints; the
//! caller then solves this island alone. The bits are the same either way.

use fearless_simd::{Level, Simd, dispatch};

use super::Box2d;
use super::contact_solver::lanes::WideContact;
use super::island::{Begun, Island};
use super::joint::Constraint as Joint;
use super::joint::lanes::WideJoint;
use super::lane_bodies::Bodies;
use super::wide::{Chunk, LANES};

/// With fewer worlds, solving one by one is faster, because repeating iterations can be skipped
/// (see [`velocity_iterations`](super::velocity_iterations)).
const FEWEST: usize = 4;
/// The largest number of contacts of one body.
const CONTACTS_PER_BODY: usize = 8;

/// Working memory for the steps of several worlds, of which at most [`LANES`] are solved together.
#[derive(Clone, Debug)]
pub(crate) struct Lanes {
    level: Level,
    iterations: u32,
    /// The number of lanes in use.
    len: usize,
    /// The indices of the two bodies of each joint.
    ends: Vec<(usize, usize)>,
    bodies: Bodies,
    joints: Vec<WideJoint>,
    /// The contacts of each body.
    contacts: Vec<[WideContact; CONTACTS_PER_BODY]>,
    /// The islands of the worlds between [`begin`](Self::begin) and [`finish`](Self::finish), and
    /// spare ones.
    islands: Vec<Island>,
    begun: usize,
}

/// The part of [`Lanes`] that a world uses between [`Lanes::begin`] and [`Lanes::finish`].
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Place {
    island: usize,
    /// The lane that solves the world's velocities; `None` if the world is solved alone.
    lane: Option<usize>,
}

impl Lanes {
    pub(crate) fn new(level: Level) -> Self {
        Self {
            level,
            iterations: 0,
            len: 0,
            ends: Vec::new(),
            bodies: Bodies::default(),
            joints: Vec::new(),
            contacts: Vec::new(),
            islands: Vec::new(),
            begun: 0,
        }
    }

    #[cfg(test)]
    pub(crate) fn level(&self) -> Level {
        self.level
    }

    /// Returns one `Lanes` for each SIMD level of this CPU.
    #[cfg(test)]
    pub(crate) fn of_each_level() -> Vec<Self> {
        let best = Level::new();
        #[cfg_attr(
            not(any(target_arch = "x86", target_arch = "x86_64")),
            expect(unused_mut)
        )]
        let mut levels = vec![best, Level::baseline()];
        #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
        {
            levels.extend(best.as_avx512().map(Level::Avx512));
            levels.extend(best.as_avx2().map(Level::Avx2));
            levels.extend(best.as_sse4_2().map(Level::Sse4_2));
            levels.extend(best.as_sse2().map(Level::Sse2));
        }
        levels.sort_by_key(|level| format!("{level:?}"));
        levels.dedup_by_key(|level| format!("{level:?}"));
        levels.into_iter().map(Self::new).collect()
    }

    /// Begins a step of `world`: runs everything before the velocity iterations, and loads the
    /// island into a lane.
    pub(in crate::physics) fn begin(
        &mut self,
        world: &mut Box2d,
        dt: f32,
        velocity_iterations: u32,
        position_iterations: u32,
    ) -> Place {
        if self.begun == self.islands.len() {
            self.islands.push(Island::new());
        }
        let mut island = std::mem::take(&mut self.islands[self.begun]);
        world.begin(&mut island, dt, velocity_iterations, position_iterations);
        let place = Place {
            island: self.begun,
            lane: self.load(world, &island),
        };
        self.islands[self.begun] = island;
        self.begun += 1;
        place
    }

    /// Loads an island into the next lane and returns the lane. Returns `None` if the islands in
    /// the other lanes have other bodies or joints, or if all [`LANES`] are in use.
    fn load(&mut self, world: &Box2d, island: &Island) -> Option<usize> {
        let Begun {
            step,
            seed: Some(_),
        } = island.begun?
        else {
            return None;
        };
        let iterations = step.velocity_iterations;
        let bodies = island.bodies.iter().map(|id| &world.bodies[*id]);
        let dynamic = bodies.clone().take_while(|body| body.dynamic).count();
        if !cfg!(feature = "native-vectors") {
            return None;
        }
        let joints = &island.joint_constraints;
        let alike = self.len == 0
            || (iterations == self.iterations
                && dynamic == self.bodies.len()
                && joints.len() == self.ends.len());
        let fits = |i: usize, ends: Option<(usize, usize)>| {
            ends.is_some_and(|(a, b)| {
                a < dynamic && b < dynamic && (self.len == 0 || self.ends[i] == (a, b))
            })
        };
        let mut places = Places::default();
        let mut room = |body: usize| places.next(body).1 < CONTACTS_PER_BODY;
        if !alike
            || self.len == LANES
            || !joints
                .iter()
                .enumerate()
                .all(|(i, joint)| fits(i, joint.driven_ends()))
            || !(island.contact_constraints.iter()).all(|contact| {
                contact
                    .moving_body(dynamic, &island.velocities)
                    .is_some_and(&mut room)
            })
        {
            return None;
        }

        if self.len == 0 {
            self.iterations = iterations;
            self.ends.clear();
            self.ends
                .extend(joints.iter().filter_map(Joint::driven_ends));
            self.bodies.resize(dynamic);
            self.joints.resize(joints.len(), WideJoint::ZERO);
            self.contacts
                .resize(dynamic, [const { WideContact::NONE }; CONTACTS_PER_BODY]);
            for contact in self.contacts.as_flattened_mut() {
                if !contact.is_none() {
                    *contact = WideContact::NONE;
                }
            }
        }
        let lane = self.len;
        self.len += 1;
        self.bodies.enter(lane, bodies, &island.velocities);
        for (rows, joint) in self.joints.iter_mut().zip(joints) {
            rows.load(lane, joint);
        }
        let mut places = Places::default();
        for contact in &island.contact_constraints {
            let (body, place) = places.next(contact.body_b());
            self.contacts[body][place].load(lane, contact);
        }
        Some(lane)
    }

    /// Runs the velocity iterations in all lanes.
    pub(crate) fn solve_velocities(&mut self) {
        let len = self.len;
        if len < FEWEST {
            return;
        }
        if len < LANES {
            // copy a used lane to the idle lanes: subnormal numbers in an idle lane would slow all
            // lanes
            self.bodies.pad(len);
            self.joints.iter_mut().for_each(|rows| rows.pad(len));
            let contacts = self.contacts.as_flattened_mut().iter_mut();
            contacts
                .filter(|contact| !contact.is_none())
                .for_each(|contact| contact.pad(len));
        }
        #[cfg(feature = "native-vectors")]
        {
            let level = self.level;
            dispatch!(level, simd => self.solve_all(simd));
        }
    }

    #[inline(always)]
    fn solve_all<S: Simd>(&mut self, simd: S) {
        use fearless_simd::prelude::*;
        let width = S::f32s::LEN;
        let mut at = 0;
        while at < self.len {
            if self.len - at > width {
                self.solve_chunk(Chunk::<S, 2> { simd, at });
                at += 2 * width;
            } else {
                self.solve_chunk(Chunk::<S, 1> { simd, at });
                at += width;
            }
        }
    }

    /// Like [`velocity_iterations::iterate`](super::velocity_iterations::iterate): all joints, then all contacts. Contacts of
    /// different bodies are independent, so their order does not matter.
    #[inline(always)]
    fn solve_chunk<S: Simd, const R: usize>(&mut self, chunk: Chunk<S, R>) {
        let Self {
            ends,
            bodies,
            joints,
            contacts,
            ..
        } = self;
        for _ in 0..self.iterations {
            for (joint, ends) in joints.iter_mut().zip(&*ends) {
                joint.solve_velocity(chunk, bodies, *ends);
            }
            for (body, contacts) in contacts.iter_mut().enumerate() {
                for contact in contacts {
                    if contact.is_none() {
                        break;
                    }
                    contact.solve_velocity(chunk, bodies, body);
                }
            }
        }
    }

    /// Finishes the step of `world` after its velocity iterations.
    pub(in crate::physics) fn finish(&mut self, place: Place, world: &mut Box2d) {
        let mut island = std::mem::take(&mut self.islands[place.island]);
        match place.lane.filter(|_| self.len >= FEWEST) {
            Some(lane) => self.collect(lane, &mut island),
            None => island.solve_velocities(),
        }
        world.finish(&mut island);
        self.islands[place.island] = island;
    }

    /// Writes the results of `lane` back to `island`.
    fn collect(&self, lane: usize, island: &mut Island) {
        self.bodies.collect(lane, &mut island.velocities);
        for (joint, rows) in island.joint_constraints.iter_mut().zip(&self.joints) {
            rows.collect(lane, joint);
        }
        let mut places = Places::default();
        for contact in &mut island.contact_constraints {
            let (body, place) = places.next(contact.body_b());
            self.contacts[body][place].collect(lane, contact);
        }
    }

    /// Removes all worlds.
    pub(crate) fn clear(&mut self) {
        (self.len, self.begun) = (0, 0);
    }
}

/// Numbers the contacts of each body from 0. The contacts of one body must be consecutive.
#[derive(Default)]
struct Places {
    last: Option<(usize, usize)>,
}

impl Places {
    fn next(&mut self, body: usize) -> (usize, usize) {
        let place = self
            .last
            .filter(|(last, _)| *last == body)
            .map_or(0, |(_, place)| place + 1);
        *self.last.insert((body, place))
    }
}
