//! The trait of wrappers. Hooks that are left out call the inner environment.
//!
//! [`Wrapper`] has a hook for every method of [`Env`](crate::Env), and one blanket implementation
//! makes each wrapper an `Env`. The hooks have names of their own, so that both traits can be
//! imported. The forwarded methods are listed once, in this file; [`BoxEnv`](crate::BoxEnv) uses
//! the same list. A test reads the trait's source and calls every method through every wrapper. A
//! wrapper without a stored form has no spec, because a rebuilt stack must step identically.

use std::any::{Any, TypeId};

use gym_numerics::Generator;

use crate::drawing::canvas::Canvas;
use crate::drawing::render::{Metadata, RenderMode, Rendered};
use crate::env::{Env, Inspect, Outcome, short_type_name};
use crate::spaces::Space;
use crate::spec::{EnvSpec, Reset, WrapperSpec};
use crate::value::{Element, Result, Snapshot, Value};

/// An environment around another one that changes some of its behaviour: Gymnasium's `Wrapper`.
///
/// A wrapper implements access to the inner environment, and the hooks `on_reset` and `on_step`.
/// Every `Wrapper` is an [`Env`] whose method `x` calls the hook `on_x` (`on_reset` for
/// `reset_into`, `on_step` for `step_into`, `on_render` for `render_into`). Hooks that a wrapper
/// leaves out call the inner environment.
///
/// ```
/// use gym_core::{Env, Outcome, Reset, Result, Wrapper, WrapperSpec};
///
/// /// Pays the agent in cents.
/// #[derive(Clone, Debug)]
/// pub struct Cents<E> {
///     env: E,
/// }
///
/// impl<E: Env> Wrapper for Cents<E> {
///     type Inner = E;
///     type Observation = E::Observation;
///     type Action = E::Action;
///
///     fn inner(&self) -> &E {
///         &self.env
///     }
///
///     fn inner_mut(&mut self) -> &mut E {
///         &mut self.env
///     }
///
///     fn on_reset(&mut self, reset: &Reset, observation: &mut E::Observation) -> Result<()> {
///         self.env.reset_into(reset, observation)
///     }
///
///     fn on_step(&mut self, action: &E::Action, observation: &mut E::Observation) -> Result<Outcome> {
///         let outcome = self.env.step_into(action, observation)?;
///         Ok(Outcome { reward: 100.0 * outcome.reward, ..outcome })
///     }
///
///     fn wrapper_spec(&self) -> Option<WrapperSpec> {
///         Some(WrapperSpec::new("my_envs/Cents"))
///     }
/// }
/// ```
///
/// # Duties of a wrapper
/// - **State.** A wrapper that keeps something from step to step stores it beside the inner
///   snapshot, in [`on_snapshot`](Self::on_snapshot) and [`on_restore`](Self::on_restore).
/// - **A stored form.** [`wrapper_spec`](Self::wrapper_spec) names the wrapper and its arguments; a
///   [`WrapperRegistration`](crate::registry::WrapperRegistration) of that name rebuilds it.
///   Without one the [`spec`](Env::spec) of the whole stack is `None`, because it would rebuild
///   another environment.
/// - **Spaces.** A wrapper with another `Observation` or `Action` type has another
///   [`on_observation_space`](Self::on_observation_space) or
///   [`on_action_space`](Self::on_action_space).
pub trait Wrapper: Clone + Send + 'static {
    /// The inner environment.
    type Inner: Env;
    /// The type of observations.
    type Observation: Element;
    /// The type of actions.
    type Action: Element;

    /// The inner environment.
    fn inner(&self) -> &Self::Inner;

    /// The inner environment.
    fn inner_mut(&mut self) -> &mut Self::Inner;

    /// The hook of [`Env::reset_into`].
    ///
    /// # Errors
    /// The inner environment's errors and the wrapper's own.
    fn on_reset(&mut self, reset: &Reset, observation: &mut Self::Observation) -> Result<()>;

    /// The hook of [`Env::step_into`].
    ///
    /// # Errors
    /// The inner environment's errors and the wrapper's own.
    fn on_step(
        &mut self,
        action: &Self::Action,
        observation: &mut Self::Observation,
    ) -> Result<Outcome>;

    /// The name and arguments of this wrapper in a spec; `None` if it has no stored form, such as a
    /// wrapper around a function.
    fn wrapper_spec(&self) -> Option<WrapperSpec> {
        None
    }

    /// The hook of [`Env::spec`]: the inner spec with [`wrapper_spec`](Self::wrapper_spec) added;
    /// `None` if either is.
    fn on_spec(&self) -> Option<EnvSpec> {
        let wrapper = self.wrapper_spec()?;
        self.inner().spec().map(|spec| spec.wrapped(wrapper))
    }

    /// The wrapper's name; the default is the name of its type.
    fn name(&self) -> &'static str {
        short_type_name::<Self>()
    }

    /// The hook of [`Env::describe`]: the wrapper's [name](Self::name) around the inner
    /// description.
    fn on_describe(&self) -> String {
        let inner = self.inner().describe();
        let inner = inner
            .strip_prefix('<')
            .and_then(|text| text.strip_suffix('>'))
            .unwrap_or(&inner);
        format!("<{}<{inner}>>", self.name())
    }

    /// The hook of [`Env::visit_layers`]: the wrapper's [name](Self::name), and the layers within.
    fn on_visit_layers(&self, visit: &mut dyn FnMut(&'static str)) {
        visit(self.name());
        self.inner().visit_layers(visit);
    }

    /// The hook of [`Env::any_layer`]: the wrapper itself, or a layer within.
    fn on_any_layer(&self, layer: TypeId) -> Option<&dyn Any> {
        if layer == TypeId::of::<Self>() {
            Some(self)
        } else {
            self.inner().any_layer(layer)
        }
    }

    /// The hook of [`Env::any_layer_mut`]: the wrapper itself, or a layer within.
    fn on_any_layer_mut(&mut self, layer: TypeId) -> Option<&mut dyn Any> {
        if layer == TypeId::of::<Self>() {
            Some(self)
        } else {
            self.inner_mut().any_layer_mut(layer)
        }
    }

    /// The hook of [`Env::restore`].
    ///
    /// # Errors
    /// The inner environment's errors and the wrapper's own; the state is then unchanged.
    fn on_restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        self.inner_mut().restore(snapshot)
    }

    methods!(forward! hooks [Env]);
}

/// Calls the macro `$then` with `$words` and the signature of each method of [`Env`] that passes
/// through a wrapper unchanged. The name of the method's hook follows the name of the method. `all`
/// adds the methods whose hooks have other defaults.
///
/// The list excludes `reset_into`, `step_into` and `restore`, because these methods may change the
/// state of a layer.
macro_rules! methods {
    (all $then:ident! $($words:tt)*) => {
        $crate::env::wrapper::methods!($then! $($words)*);
        $then! { $($words)* fn spec on_spec(&self) -> Option<EnvSpec> }
        $then! { $($words)* fn describe on_describe(&self) -> String }
        $then! { $($words)* fn visit_layers on_visit_layers(&self, visit: &mut dyn FnMut(&'static str)) }
        $then! { $($words)* fn any_layer on_any_layer(&self, layer: TypeId) -> Option<&dyn Any> }
        $then! { $($words)* fn any_layer_mut on_any_layer_mut(&mut self, layer: TypeId) -> Option<&mut dyn Any> }
    };
    ($then:ident! $($words:tt)*) => {
        $then! { $($words)* fn observation_space on_observation_space(&self) -> Space }
        $then! { $($words)* fn action_space on_action_space(&self) -> Space }
        $then! { $($words)* fn snapshot on_snapshot(&self) -> Result<Snapshot> }
        $then! { $($words)* fn info on_info(&self, visit: &mut dyn FnMut(&str, Value)) }
        $then! { $($words)* fn metadata on_metadata(&self) -> Metadata }
        $then! { $($words)* fn draw on_draw(&self, canvas: &mut dyn Canvas) }
        $then! { $($words)* fn frames_drawn on_frames_drawn(&mut self, count: u64) }
        $then! { $($words)* fn ansi on_ansi(&self) -> Option<String> }
        $then! { $($words)* fn depth on_depth(&self, size: (u32, u32)) -> Option<Vec<f32>> }
        $then! { $($words)* fn render_mode on_render_mode(&self) -> Option<RenderMode> }
        $then! { $($words)* fn render_into on_render(&mut self, rendered: &mut Rendered) -> Result<()> }
        $then! { $($words)* fn generator on_generator(&mut self) -> Option<&mut Generator> }
        $then! { $($words)* fn inspect on_inspect(&self) -> Option<&dyn Inspect> }
        $then! { $($words)* fn inspect_mut on_inspect_mut(&mut self) -> Option<&mut dyn Inspect> }
        $then! { $($words)* fn close on_close(&mut self) }
    };
}
pub(crate) use methods;

/// Defines one method of [`methods`]. The first words select the form:
///
/// - `declared`: the method without a body;
/// - `hooks`: the hook, which calls the method of `inner()`;
/// - `calls`: the method, which calls the hook;
/// - `{.env} {.env}`: the method, which calls the same method of `self.env`. The first place is for
///   methods that take `&self`, the second for methods that take `&mut self`.
macro_rules! forward {
    (declared fn $name:ident $hook:ident $arguments:tt $(-> $result:ty)?) => {
        fn $name $arguments $(-> $result)?;
    };
    (hooks [$trait:ident] fn $name:ident $hook:ident(&self $(, $arg:ident: $type:ty)*) $(-> $result:ty)?) => {
        #[doc = concat!("The hook of [`", stringify!($trait), "::", stringify!($name), "`].")]
        fn $hook(&self $(, $arg: $type)*) $(-> $result)? {
            self.inner().$name($($arg),*)
        }
    };
    (hooks [$trait:ident] fn $name:ident $hook:ident(&mut self $(, $arg:ident: $type:ty)*) $(-> $result:ty)?) => {
        #[doc = concat!("The hook of [`", stringify!($trait), "::", stringify!($name), "`].")]
        fn $hook(&mut self $(, $arg: $type)*) $(-> $result)? {
            self.inner_mut().$name($($arg),*)
        }
    };
    (calls fn $name:ident $hook:ident(&self $(, $arg:ident: $type:ty)*) $(-> $result:ty)?) => {
        fn $name(&self $(, $arg: $type)*) $(-> $result)? {
            self.$hook($($arg),*)
        }
    };
    (calls fn $name:ident $hook:ident(&mut self $(, $arg:ident: $type:ty)*) $(-> $result:ty)?) => {
        fn $name(&mut self $(, $arg: $type)*) $(-> $result)? {
            self.$hook($($arg),*)
        }
    };
    ({$($place:tt)*} {$($_:tt)*} fn $name:ident $hook:ident(&self $(, $arg:ident: $type:ty)*) $(-> $result:ty)?) => {
        fn $name(&self $(, $arg: $type)*) $(-> $result)? {
            self$($place)*.$name($($arg),*)
        }
    };
    ({$($_:tt)*} {$($place:tt)*} fn $name:ident $hook:ident(&mut self $(, $arg:ident: $type:ty)*) $(-> $result:ty)?) => {
        fn $name(&mut self $(, $arg: $type)*) $(-> $result)? {
            self$($place)*.$name($($arg),*)
        }
    };
}
pub(crate) use forward;

/// A wrapper is an environment: each method calls its hook.
impl<W: Wrapper> Env for W {
    type Observation = W::Observation;
    type Action = W::Action;

    #[inline]
    fn reset_into(&mut self, reset: &Reset, observation: &mut W::Observation) -> Result<()> {
        self.on_reset(reset, observation)
    }

    #[inline(always)]
    fn step_into(
        &mut self,
        action: &W::Action,
        observation: &mut W::Observation,
    ) -> Result<Outcome> {
        self.on_step(action, observation)
    }

    fn restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        self.on_restore(snapshot)
    }

    methods!(all forward! calls);
}
