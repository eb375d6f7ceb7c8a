//! The wrappers that `make` puts around every environment.

use std::sync::Arc;

use crate::env::{BoxEnv, Env, Outcome};
use crate::spec::Reset;
use crate::spec::{EnvSpec, ResetOptions};
use crate::value::Result;
use crate::wrappers::{OrderEnforcing, PassiveEnvChecker, Render, TimeLimit};

/// The rendering of an environment.
pub(super) enum Renders {
    /// The environment.
    Itself,
    /// The wrapper `Render`, from the environment's drawings.
    Drawings,
}

/// Adds the wrappers of `make` to `env`, from the inside: `Render` if there is a render mode,
/// `PassiveEnvChecker`, `OrderEnforcing`, `TimeLimit`. The caller adds the spec's additional
/// wrappers.
pub(super) fn stack<E: Env>(
    env: E,
    renders: Renders,
    spec: &EnvSpec,
    options: ResetOptions,
) -> Result<BoxEnv> {
    // the wrappers will add themselves to the spec
    let bare = EnvSpec {
        max_episode_steps: None,
        order_enforce: false,
        disable_env_checker: true,
        render_mode: None,
        render_size: None,
        additional_wrappers: Vec::new(),
        ..spec.clone()
    };
    let env = Registered {
        inner: env,
        spec: Arc::new(bare),
        options,
    };
    let (Some(mode), Renders::Drawings) = (spec.render_mode, renders) else {
        return guarded(env, spec);
    };
    let mut render = Render::new(env, mode.single())?;
    if let Some((width, height)) = spec.render_size {
        render = render.with_size(width, height)?;
    }
    // a `BoxEnv` here saves compiling a second stack of types per environment; the cost is small
    // compared with drawing
    guarded(BoxEnv::new(render), spec)
}

/// Adds the wrappers outside `Render`. With the default wrappers, the result is one type in one
/// `BoxEnv`, so a step converts its action and observation once, and not in each wrapper.
fn guarded<E: Env>(env: E, spec: &EnvSpec) -> Result<BoxEnv> {
    let EnvSpec {
        disable_env_checker,
        order_enforce,
        max_episode_steps,
        ..
    } = *spec;
    if !disable_env_checker && order_enforce {
        return limited(
            OrderEnforcing::new(PassiveEnvChecker::new(env)),
            max_episode_steps,
        );
    }
    let mut env = BoxEnv::new(env);
    if !disable_env_checker {
        env = BoxEnv::new(PassiveEnvChecker::new(env));
    }
    if order_enforce {
        env = BoxEnv::new(OrderEnforcing::new(env));
    }
    limited(env, max_episode_steps)
}

fn limited<E: Env>(env: E, max_episode_steps: Option<u32>) -> Result<BoxEnv> {
    Ok(match max_episode_steps {
        Some(steps) => BoxEnv::new(TimeLimit::new(env, steps)?),
        None => BoxEnv::new(env),
    })
}

/// An environment with its spec.
#[derive(Clone)]
struct Registered<E> {
    inner: E,
    spec: Arc<EnvSpec>,
    options: ResetOptions,
}

impl<E: Env> crate::env::Wrapper for Registered<E> {
    type Observation = E::Observation;
    type Action = E::Action;

    crate::inner!(E);

    fn on_reset(&mut self, reset: &Reset, observation: &mut E::Observation) -> Result<()> {
        if !reset.options.is_empty() {
            self.options.check(&self.spec.id, &reset.options)?;
        }
        self.inner.reset_into(reset, observation)
    }

    #[inline]
    fn on_step(&mut self, action: &E::Action, observation: &mut E::Observation) -> Result<Outcome> {
        self.inner.step_into(action, observation)
    }

    fn on_spec(&self) -> Option<EnvSpec> {
        Some(EnvSpec::clone(&self.spec))
    }

    fn on_visit_layers(&self, visit: &mut dyn FnMut(&'static str)) {
        self.inner.visit_layers(visit);
    }

    fn on_describe(&self) -> String {
        format!("{}<{}>", self.inner.describe(), self.spec.id)
    }
}
