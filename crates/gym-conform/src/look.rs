//! The calls that must not change an environment.

use gym_core::canvas::Blank;
use gym_core::{BoxEnv, Env, EnvExt};

/// Makes every call that must not change `env`.
pub(crate) fn look(env: &BoxEnv) {
    glance(env);
    let _ = env.snapshot();
}

/// Makes the same calls except `snapshot`, which takes long in a large world.
pub(crate) fn glance(env: &BoxEnv) {
    let _ = (
        env.observation_space(),
        env.action_space(),
        env.metadata(),
        env.describe(),
    );
    let _ = (env.info_map(), env.ansi(), env.spec().is_some());
    env.draw(&mut Blank);
}
