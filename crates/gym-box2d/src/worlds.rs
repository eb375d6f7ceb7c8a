//! Steps of one world alone, or of many worlds together.

use gym_core::math;
use gym_core::vector::lockstep::Together;

use crate::physics::{LANES, Lanes, Place, World};

/// Working memory for worlds whose velocity iterations run together.
#[derive(Clone, Debug)]
pub struct Worlds(Lanes);

impl Default for Worlds {
    fn default() -> Self {
        Self(Lanes::new(math::level()))
    }
}

impl Together for Worlds {
    const LEN: usize = LANES;

    fn solve(&mut self) {
        self.0.solve_velocities();
    }

    fn clear(&mut self) {
        self.0.clear();
    }
}

/// A reset or step that [`Lockstep`](gym_core::vector::lockstep::Lockstep) has begun for many
/// environments together, before the environment's own `reset` or `step` is called.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ahead {
    call: Call,
    pub(crate) place: Place,
}

impl Ahead {
    /// Records that `call` has begun; `place` is `None` if it could not begin.
    pub(crate) fn of(call: Call, place: Option<Place>) -> Option<Self> {
        place.map(|place| Self { call, place })
    }

    /// Clears `ahead`, and returns whether it was `call` that had begun.
    pub(crate) fn take(ahead: &mut Option<Self>, call: Call) -> bool {
        ahead.take().is_some_and(|ahead| ahead.call == call)
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Call {
    Reset,
    Step,
}

/// Steps `world`. With `worlds`, only begins the step: `worlds` runs the velocity iterations, and
/// [`Worlds::finish`] finishes the step.
pub(crate) fn step(world: &mut World, fps: f64, worlds: Option<&mut Worlds>) -> Place {
    let dt = (1.0 / fps) as f32;
    match worlds {
        Some(worlds) => world.begin(&mut worlds.0, dt, VELOCITY_ITERATIONS, POSITION_ITERATIONS),
        None => {
            world.step(dt, VELOCITY_ITERATIONS, POSITION_ITERATIONS);
            Place::default()
        }
    }
}

impl Worlds {
    /// Finishes the step of `world` that [`step`] began. `place` is the result of `step`.
    pub(crate) fn finish(&mut self, world: &mut World, place: Place) {
        world.finish(&mut self.0, place);
    }
}

/// Iterations of the velocity solver per step: 6 * 30 in all of Gymnasium's three environments.
pub(crate) const VELOCITY_ITERATIONS: u32 = 180;
/// Iterations of the position solver per step: 2 * 30.
pub(crate) const POSITION_ITERATIONS: u32 = 60;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bipedal_walker::{self, BipedalWalker, Heuristic};
    use crate::lunar_lander::{self, LunarLander, heuristic};
    use gym_core::vector::lockstep::Lockstep;
    use gym_core::{Element, Env, Outcome, Reset};

    /// Returns the results of `n` environments under `policy`, which receives an environment's
    /// number and last observation. The environments play one episode after another, in lockstep if
    /// `worlds` is given. Each seventh environment skips some steps, so that not every group has
    /// the same environments.
    fn run<E, const N: usize>(
        make: impl Fn(usize) -> E,
        n: usize,
        steps: usize,
        mut worlds: Option<Worlds>,
        mut policy: impl FnMut(usize, &[f32; N]) -> E::Action,
    ) -> Vec<u64>
    where
        E: Lockstep<Group = Worlds> + Env<Observation = [f32; N]>,
    {
        let mut envs: Vec<E> = (0..n).map(make).collect();
        let mut asks: Vec<Result<Reset, E::Action>> =
            (0..n).map(|i| Ok(Reset::from(i as u64))).collect();
        let mut bits = Vec::new();
        for step in 0..steps {
            let mut asked: Vec<usize> = (0..n).filter(|i| i % 7 > 0 || step % 3 > 0).collect();
            asked.rotate_left(step % 2);
            if let Some(worlds) = &mut worlds {
                worlds.clear();
                for &i in &asked {
                    match &asks[i] {
                        Ok(reset) => envs[i].begin_reset(reset, worlds),
                        Err(action) => envs[i].begin_step(action, worlds),
                    }
                }
                worlds.solve();
                asked.iter().for_each(|&i| envs[i].collect(worlds));
            }
            for &i in &asked {
                let mut observation = <[f32; N]>::empty();
                let outcome = match &asks[i] {
                    Ok(reset) => envs[i]
                        .reset_into(reset, &mut observation)
                        .map(|()| Outcome::default()),
                    Err(action) => envs[i].step_into(action, &mut observation),
                };
                let outcome = outcome.unwrap();
                bits.push(outcome.reward.to_bits());
                if step % 5 == 0 || outcome.terminated {
                    bits.extend(observation.map(|x| u64::from(x.to_bits())));
                }
                let next = policy(i, &observation);
                asks[i] = if outcome.terminated {
                    Ok(Reset::default())
                } else {
                    Err(next)
                };
            }
        }
        bits
    }

    /// A pseudorandom number from -1 to 1.
    fn noise(state: &mut u64) -> f32 {
        *state = state
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (*state >> 40) as f32 / (1u32 << 23) as f32 - 1.0
    }

    #[test]
    fn landers_side_by_side_keep_the_bits() {
        let make = |i: usize| {
            let gravity = -4.0 - 0.3 * (i % 20) as f64;
            let config = lunar_lander::Config {
                gravity,
                enable_wind: i % 2 == 1,
                ..Default::default()
            };
            LunarLander::new(lunar_lander::Config {
                continuous: true,
                ..config
            })
            .unwrap()
        };
        let run = |worlds| {
            let mut state = 3;
            // some landers try to land and come to rest; others tumble
            let policy = |i: usize, observation: &[f32; 8]| match i % 3 {
                0 => [noise(&mut state), noise(&mut state)].into(),
                _ => heuristic(observation, true),
            };
            run(make, 35, 250, worlds, policy)
        };
        let alone = run(None);
        for lanes in Lanes::of_each_level() {
            let level = lanes.level();
            assert!(run(Some(Worlds(lanes))) == alone, "{level:?}");
        }
    }

    #[test]
    fn walkers_side_by_side_keep_the_bits() {
        let make = |i: usize| {
            BipedalWalker::new(bipedal_walker::Config {
                hardcore: i % 2 == 1,
                ..Default::default()
            })
        };
        let run = |worlds| {
            let (mut state, mut pilots) = (3, [(); 9].map(|()| Heuristic::default()));
            let policy = |i: usize, observation: &[f32; 24]| match i % 3 {
                0 => [(); 4].map(|()| noise(&mut state)).into(),
                _ => pilots[i].act(observation).into(),
            };
            run(make, 9, 150, worlds, policy)
        };
        let alone = run(None);
        for lanes in Lanes::of_each_level() {
            let level = lanes.level();
            assert!(run(Some(Worlds(lanes))) == alone, "{level:?}");
        }
    }

    /// Returns the memory of the world after the first step, and the most after any later step. The
    /// run continues past the ends of several episodes.
    fn world_bytes<E, const N: usize>(
        mut env: E,
        bytes: impl Fn(&E) -> usize,
        mut policy: impl FnMut(&[f32; N]) -> E::Action,
    ) -> [usize; 2]
    where
        E: Env<Observation = [f32; N]>,
    {
        let mut observation = <[f32; N]>::empty();
        let (mut first, mut most) = (0, 0);
        for seed in 0..8 {
            env.reset_into(&Reset::from(seed), &mut observation)
                .unwrap();
            first = first.max(bytes(&env));
            for _ in 0..300 {
                env.step_into(&policy(&observation), &mut observation)
                    .unwrap();
                most = most.max(bytes(&env));
            }
        }
        [first, most]
    }

    #[test]
    fn worlds_are_small_and_grow_no_more() {
        let mut state = 3;
        let lander = LunarLander::new(lunar_lander::Config {
            continuous: true,
            ..Default::default()
        })
        .unwrap();
        let policy = |_: &[f32; 8]| [noise(&mut state), noise(&mut state)].into();
        let [first, most] = world_bytes(lander, LunarLander::world_bytes, policy);
        assert!(
            first == most && most < 8_000,
            "LunarLander: {first} bytes, then {most}"
        );
        for (hardcore, bound) in [(false, 13_500), (true, 26_000)] {
            let walker = BipedalWalker::new(bipedal_walker::Config {
                hardcore,
                ..Default::default()
            });
            let mut pilot = Heuristic::default();
            let policy = |observation: &[f32; 24]| pilot.act(observation).into();
            let [first, most] = world_bytes(walker, BipedalWalker::world_bytes, policy);
            assert!(
                first == most && most < bound,
                "hardcore {hardcore}: {first} bytes, then {most}"
            );
        }
    }
}
