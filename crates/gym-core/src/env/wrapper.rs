//! The trait of wrappers. Methods that are left out call the inner environment.
//!
//! [`Wrapper`] has every method of [`Env`](crate::Env) with the inner environment's as its default,
//! and one blanket implementation makes each wrapper an `Env`. The forwarded methods are listed
//! once, in this file; [`BoxEnv`](crate::BoxEnv) uses the same list. A test reads the trait's
//! source and calls every method through every wrapper. A wrapper without a stored form has no
//! spec, because a rebuilt stack must step identically.

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
/// A wrapper implements access to the inner environment, `reset_into` and `step_into`. Methods that
/// it leaves out call the inner environment. Every `Wrapper` is an [`Env`].
///
/// ```
/// use gym_core::{Env, Outcome, Reset, Result, WrapperSpec};
///
/// /// Pays the agent in cents.
/// #[derive(Clone, Debug)]
/// pub struct Cents<E> {
///     env: E,
/// }
///
/// impl<E: Env> gym_core::Wrapper for Cents<E> {
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
///     fn reset_into(&mut self, reset: &Reset, observation: &mut E::Observation) -> Result<()> {
///         self.env.reset_into(reset, observation)
///     }
///
///     fn step_into(&mut self, action: &E::Action, observation: &mut E::Observation) -> Result<Outcome> {
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
/// Name the trait by its path where you implement it, as above, and do not import it: it has
/// methods of the same names as [`Env`], and with both in scope `env.render_into(…)` could mean
/// either. Within the implementation itself, call the wrapper's own methods as
/// `Env::reset_into(self, …)`.
///
/// # Duties of a wrapper
/// - **State.** A wrapper that keeps something from step to step stores it beside the inner
///   snapshot, in [`snapshot`](Self::snapshot) and [`restore`](Self::restore).
/// - **A stored form.** [`wrapper_spec`](Self::wrapper_spec) names the wrapper and its arguments; a
///   [`WrapperRegistration`](crate::registry::WrapperRegistration) of that name rebuilds it.
///   Without one the [`spec`](Env::spec) of the whole stack is `None`, because it would rebuild
///   another environment.
/// - **Spaces.** A wrapper with another `Observation` or `Action` type has another
///   [`observation_space`](Self::observation_space) or [`action_space`](Self::action_space).
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

    /// As [`Env::reset_into`].
    ///
    /// # Errors
    /// The inner environment's errors and the wrapper's own.
    fn reset_into(&mut self, reset: &Reset, observation: &mut Self::Observation) -> Result<()>;

    /// As [`Env::step_into`].
    ///
    /// # Errors
    /// The inner environment's errors and the wrapper's own.
    fn step_into(
        &mut self,
        action: &Self::Action,
        observation: &mut Self::Observation,
    ) -> Result<Outcome>;

    /// The name and arguments of this wrapper in a spec; `None` if it has no stored form, such as a
    /// wrapper around a function.
    fn wrapper_spec(&self) -> Option<WrapperSpec> {
        None
    }

    /// The spec of the whole stack: the inner [`spec`](Env::spec) with
    /// [`wrapper_spec`](Self::wrapper_spec) added; `None` if either is.
    fn spec(&self) -> Option<EnvSpec> {
        let wrapper = self.wrapper_spec()?;
        self.inner().spec().map(|spec| spec.wrapped(wrapper))
    }

    /// The wrapper's name; the default is the name of its type.
    fn name(&self) -> &'static str {
        short_type_name::<Self>()
    }

    /// As [`Env::describe`]: the wrapper's [name](Self::name) around the inner description.
    fn describe(&self) -> String {
        let inner = self.inner().describe();
        let inner = inner
            .strip_prefix('<')
            .and_then(|text| text.strip_suffix('>'))
            .unwrap_or(&inner);
        format!("<{}<{inner}>>", self.name())
    }

    /// As [`Env::any_layer`]: the wrapper itself, or a layer within.
    fn any_layer(&self, layer: TypeId) -> Option<&dyn Any> {
        if layer == TypeId::of::<Self>() {
            Some(self)
        } else {
            self.inner().any_layer(layer)
        }
    }

    /// As [`Env::any_layer_mut`]: the wrapper itself, or a layer within.
    fn any_layer_mut(&mut self, layer: TypeId) -> Option<&mut dyn Any> {
        if layer == TypeId::of::<Self>() {
            Some(self)
        } else {
            self.inner_mut().any_layer_mut(layer)
        }
    }

    /// As [`Env::restore`].
    ///
    /// # Errors
    /// The inner environment's errors and the wrapper's own; the state is then unchanged.
    fn restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        self.inner_mut().restore(snapshot)
    }

    methods!(forward! [Env] {.inner()} {.inner_mut()});
}

/// Gives another macro every method of [`Env`] that passes through a wrapper unchanged, one by one,
/// behind `$words`.
///
/// `reset_into`, `step_into` and `restore` are not among them, because a layer may have state that
/// they change.
macro_rules! methods {
    ($then:ident! $($words:tt)*) => {
        $then! { $($words)* fn observation_space(&self) -> Space }
        $then! { $($words)* fn action_space(&self) -> Space }
        $then! { $($words)* fn snapshot(&self) -> Result<Snapshot> }
        $then! { $($words)* fn info(&self, visit: &mut dyn FnMut(&str, Value)) }
        $then! { $($words)* fn metadata(&self) -> Metadata }
        $then! { $($words)* fn draw(&self, canvas: &mut dyn Canvas) }
        $then! { $($words)* fn frames_drawn(&mut self, count: u64) }
        $then! { $($words)* fn ansi(&self) -> Option<String> }
        $then! { $($words)* fn render_mode(&self) -> Option<RenderMode> }
        $then! { $($words)* fn render_into(&mut self, rendered: &mut Rendered) -> Result<()> }
        $then! { $($words)* fn generator(&mut self) -> Option<&mut Generator> }
        $then! { $($words)* fn inspect(&self) -> Option<&dyn Inspect> }
        $then! { $($words)* fn inspect_mut(&mut self) -> Option<&mut dyn Inspect> }
        $then! { $($words)* fn close(&mut self) }
    };
}
pub(crate) use methods;

/// As [`methods`], with those about layers, for types that are not layers.
macro_rules! all_methods {
    ($then:ident! $($words:tt)*) => {
        $crate::env::wrapper::methods!($then! $($words)*);
        $then! { $($words)* fn spec(&self) -> Option<EnvSpec> }
        $then! { $($words)* fn describe(&self) -> String }
        $then! { $($words)* fn any_layer(&self, layer: TypeId) -> Option<&dyn Any> }
        $then! { $($words)* fn any_layer_mut(&mut self, layer: TypeId) -> Option<&mut dyn Any> }
    };
}
pub(crate) use all_methods;

/// A method that forwards to the same method of another place, such as `self.env` for `{.env}`. A
/// place is given twice, to be read and to be changed.
macro_rules! forward {
    ([$trait:ident] {$($place:tt)*} {$($_:tt)*} fn $name:ident(&self $(, $arg:ident: $type:ty)*) $(-> $result:ty)?) => {
        #[doc = concat!("As [`", stringify!($trait), "::", stringify!($name), "`].")]
        fn $name(&self $(, $arg: $type)*) $(-> $result)? {
            self$($place)*.$name($($arg),*)
        }
    };
    ([$trait:ident] {$($_:tt)*} {$($place:tt)*} fn $name:ident(&mut self $(, $arg:ident: $type:ty)*) $(-> $result:ty)?) => {
        #[doc = concat!("As [`", stringify!($trait), "::", stringify!($name), "`].")]
        fn $name(&mut self $(, $arg: $type)*) $(-> $result)? {
            self$($place)*.$name($($arg),*)
        }
    };
}
pub(crate) use forward;

/// A wrapper is an environment: each method calls the wrapper's.
impl<W: Wrapper> Env for W {
    type Observation = W::Observation;
    type Action = W::Action;

    #[inline]
    fn reset_into(&mut self, reset: &Reset, observation: &mut W::Observation) -> Result<()> {
        Wrapper::reset_into(self, reset, observation)
    }

    #[inline(always)]
    fn step_into(
        &mut self,
        action: &W::Action,
        observation: &mut W::Observation,
    ) -> Result<Outcome> {
        Wrapper::step_into(self, action, observation)
    }

    fn restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        Wrapper::restore(self, snapshot)
    }

    all_methods!(forward! [Env] {} {});
}
