//! The velocity sweeps of many worlds in lockstep: one world in each lane of vector registers.
//!
//! A sweep is a chain of operations that wait for each other, so one world alone leaves a CPU idle;
//! worlds side by side fill it. It needs islands that are alike: the same bodies and hinges in the
//! same order, as the environments' have. A contact that one world has and another has not is
//! masked. An island that differs is solved by itself ([`Lanes::load`]); the bits are the same.

use fearless_simd::{Level, Simd, dispatch};

use super::Box2d;
use super::contact_solver::lanes::Touch;
use super::island::{Begun, Island};
use super::joint::Constraint as Joint;
use super::joint::lanes::Hinge;
use super::lane_bodies::Bodies;
use super::wide::{LANES, Strip};

/// Fewer worlds are solved faster one by one, as their sweeps repeat (see
/// [`sweeps`](super::sweeps)).
const FEWEST: usize = 4;
/// The contacts of one body that there is room for.
const TOUCHES: usize = 8;

/// Working memory for the steps of some worlds, of which up to [`LANES`] are solved together.
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
    /// One for each world whose step has begun, and more.
    islands: Vec<Island>,
    begun: usize,
}

/// The part of [`Lanes`] that belongs to a world whose step has begun.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Place {
    island: usize,
    /// The lane in which its velocities are solved, if they are solved with others.
    lane: Option<usize>,
}

impl Lanes {
    pub(crate) fn new(level: Level) -> Self {
        Self {
            level,
            sweeps: 0,
            len: 0,
            ends: Vec::new(),
            bodies: Bodies::default(),
            hinges: Vec::new(),
            touches: Vec::new(),
            islands: Vec::new(),
            begun: 0,
        }
    }

    #[cfg(test)]
    pub(crate) fn level(&self) -> Level {
        self.level
    }

    /// One for each SIMD level of this CPU.
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

    /// Begins a step of a world, to be solved with others.
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

    /// Takes the island of a step that has begun into the next lane, and gives its number; `None`
    /// if it is not like those that are there, or there are [`LANES`].
    fn load(&mut self, world: &Box2d, island: &Island) -> Option<usize> {
        let Begun {
            step,
            seed: Some(_),
        } = island.begun?
        else {
            return None;
        };
        let sweeps = step.velocity_iterations;
        let bodies = island.bodies.iter().map(|id| &world.bodies[*id]);
        let dynamic = bodies.clone().take_while(|body| body.dynamic).count();
        let joints = &island.joint_constraints;
        let alike = self.len == 0
            || (sweeps == self.sweeps
                && dynamic == self.bodies.len()
                && joints.len() == self.ends.len());
        let fits = |i: usize, ends: Option<(usize, usize)>| {
            ends.is_some_and(|(a, b)| {
                a < dynamic && b < dynamic && (self.len == 0 || self.ends[i] == (a, b))
            })
        };
        let mut places = Places::default();
        let mut room = |body: usize| places.next(body).1 < TOUCHES;
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
            self.sweeps = sweeps;
            self.ends.clear();
            self.ends
                .extend(joints.iter().filter_map(Joint::driven_ends));
            self.bodies.resize(dynamic);
            self.hinges.resize(joints.len(), Hinge::ZERO);
            self.touches
                .resize(dynamic, [const { Touch::NONE }; TOUCHES]);
            for touch in self.touches.as_flattened_mut() {
                if !touch.is_none() {
                    *touch = Touch::NONE;
                }
            }
        }
        let lane = self.len;
        self.len += 1;
        self.bodies.enter(lane, bodies, &island.velocities);
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
            // numbers in idle lanes must be finite, and not subnormal, which would be slow
            self.bodies.pad(len);
            self.hinges.iter_mut().for_each(|rows| rows.pad(len));
            let touches = self.touches.as_flattened_mut().iter_mut();
            touches
                .filter(|touch| !touch.is_none())
                .for_each(|touch| touch.pad(len));
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

    /// As [`sweeps::sweep`](super::sweeps::sweep): all joints, then all contacts. Those of
    /// different bodies are independent.
    #[inline(always)]
    fn sweep_strip<S: Simd, const R: usize>(&mut self, strip: Strip<S, R>) {
        let Self {
            ends,
            bodies,
            hinges,
            touches,
            ..
        } = self;
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

    /// Finishes the step of a world, once the sweeps are made.
    pub(in crate::physics) fn finish(&mut self, place: Place, world: &mut Box2d) {
        let mut island = std::mem::take(&mut self.islands[place.island]);
        match place.lane.filter(|_| self.len >= FEWEST) {
            Some(lane) => self.collect(lane, &mut island),
            None => island.sweep(),
        }
        world.finish(&mut island);
        self.islands[place.island] = island;
    }

    /// Writes the results of the sweeps back to an island.
    fn collect(&self, lane: usize, island: &mut Island) {
        self.bodies.collect(lane, &mut island.velocities);
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
        (self.len, self.begun) = (0, 0);
    }
}

/// Numbers the contacts of each body, which come one body after the other.
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
