//! Groups that step together, at each level of vector instructions.

use gym_core::vector::lockstep::Lockstep;
use gym_core::{Array, Element, Env, EnvExt, Value};

use fearless_simd::Level;
use gym_core::vector::lockstep::Together;
use gym_mujoco::{HalfCheetah, half_cheetah};
use gym_sim::{Groups, SimEnv};
use mujoco_engine::lanes::Group;

fn levels() -> Vec<Level> {
    let level = Level::new();
    let mut levels = vec![level, Level::baseline()];
    #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
    levels.extend(level.as_avx2().map(Level::Avx2));
    levels
}

/// Of nine worlds, eight step together and one steps alone.
#[test]
fn whole_registers_step_together() {
    for level in levels() {
        let make = || HalfCheetah::new(half_cheetah::Config::default()).unwrap();
        let mut envs: Vec<SimEnv> = (0..9).map(|_| make()).collect();
        let mut alone = envs.clone();
        let mut worlds = Groups::new(level);
        let mut seen = Value::empty();
        for (i, env) in envs.iter_mut().chain(&mut alone).enumerate() {
            env.reset_into(&(i as u64 % 9).into(), &mut seen).unwrap();
        }
        let mut sampler = envs[0].action_sampler(4).unwrap();
        for _ in 0..40 {
            let actions: Vec<Array> = (0..9).map(|_| sampler.sample().clone()).collect();
            worlds.clear();
            for (env, action) in envs.iter_mut().zip(&actions) {
                env.begin_step(action, &mut worlds);
            }
            worlds.solve();
            let mut together = 0;
            for ((env, alone), action) in envs.iter_mut().zip(&mut alone).zip(&actions) {
                env.collect(&mut worlds);
                let outcome = env.step_into(action, &mut seen).unwrap();
                let mut expected = Value::empty();
                let other = alone.step_into(action, &mut expected).unwrap();
                assert_eq!((outcome, &seen), (other, &expected), "{level:?}");
                together += usize::from(env.has_stale_arrays());
            }
            let expected = if Group::can_step(level) { 8 } else { 0 };
            assert_eq!(together, expected, "{level:?}");
        }
    }
}
