//! The trait of wrappers of vectors.
//!
//! Each method of [`VectorWrapper`] except `wrapper_spec` calls the inner vector by default, and
//! one blanket implementation makes it a [`VectorEnv`](crate::VectorEnv). The inner vector is `&dyn
//! VectorEnv`: one virtual call costs little compared with a step of all. `infos` is made from
//! `info`, `final_info` and `column_infos` in one place, so the order of wrappers cannot change its
//! form.

use std::any::Any;

use super::{Autoreset, Columns, VectorEnv, VectorReset, VectorSpec};
use crate::drawing::render::{Metadata, Rendered};
use crate::env::Inspect;
use crate::env::wrapper::forward;
use crate::spaces::Space;
use crate::spec::WrapperSpec;
use crate::value::{Result, Snapshot, Value};

/// A vector around a vector: every `VectorWrapper` is a [`VectorEnv`].
///
/// Only [`inner`](Self::inner) and [`inner_mut`](Self::inner_mut) are required. Other methods call
/// the inner vector by default, except [`wrapper_spec`](Self::wrapper_spec): a wrapper without one
/// has no spec.
///
/// ```
/// use gym_core::vector::{Columns, Progress, VectorEnv};
/// use gym_core::{Result, Value};
///
/// /// Takes a little from the reward of each step.
/// struct Effort<V> {
///     envs: V,
/// }
///
/// // the full name: both traits have the same methods, and with one of them in scope a call is clear
/// impl<V: VectorEnv> gym_core::VectorWrapper for Effort<V> {
///     fn inner(&self) -> &dyn VectorEnv {
///         &self.envs
///     }
///
///     fn inner_mut(&mut self) -> &mut dyn VectorEnv {
///         &mut self.envs
///     }
///
///     fn step_into(&mut self, actions: &Value, columns: &mut Columns) -> Result<()> {
///         columns.begin();
///         let result = self.envs.step_into(actions, columns);
///         // after an `Err` some sub-environments may have taken their step nevertheless
///         for (reward, progress) in columns.rewards.iter_mut().zip(&columns.progress) {
///             if *progress == Progress::Stepped {
///                 *reward -= 0.01;
///             }
///         }
///         result
///     }
/// }
/// ```
///
/// A wrapper with state of its own overrides [`snapshot`](Self::snapshot) and
/// [`restore`](Self::restore). A wrapper that adds entries to the infos overrides
/// [`info`](Self::info), from which [`infos`](crate::VectorEnvExt::infos) makes the columns.
pub trait VectorWrapper: Any + Send {
    /// The inner vector.
    fn inner(&self) -> &dyn VectorEnv;

    /// The vector within, to be changed.
    fn inner_mut(&mut self) -> &mut dyn VectorEnv;

    /// The name and arguments from which [`VectorSpec::make`] rebuilds this wrapper, if it can.
    fn wrapper_spec(&self) -> Option<WrapperSpec> {
        None
    }

    /// See [`VectorEnv::observation_space`]. For a wrapper that changes the space of a single
    /// observation, the batch of that.
    fn observation_space(&self) -> Result<Space> {
        let single = self.single_observation_space();
        if single == self.inner().single_observation_space() {
            self.inner().observation_space()
        } else {
            single.batch(self.num_envs())
        }
    }

    /// See [`VectorEnv::action_space`]. For a wrapper that changes the space of a single action,
    /// the batch of that.
    fn action_space(&self) -> Result<Space> {
        let single = self.single_action_space();
        if single == self.inner().single_action_space() {
            self.inner().action_space()
        } else {
            single.batch(self.num_envs())
        }
    }

    /// See [`VectorEnv::spec`]: the inner vector's with [`wrapper_spec`](Self::wrapper_spec), if
    /// both exist.
    fn spec(&self) -> Option<VectorSpec> {
        let wrapper = self.wrapper_spec()?;
        self.inner().spec().map(|spec| spec.wrapped(wrapper))
    }

    /// The wrapper's name; the default is the name of its type.
    fn name(&self) -> &'static str {
        crate::env::short_type_name::<Self>()
    }

    /// See [`VectorEnv::describe`]: `<Wrapper, inner>`, as Gymnasium prints a stack.
    fn describe(&self) -> String {
        format!("<{}, {}>", self.name(), self.inner().describe())
    }

    methods!(forward! [VectorEnv] {.inner()} {.inner_mut()});
}

/// Gives another macro every method of [`VectorEnv`] that passes through a wrapper unchanged, one
/// by one, behind `$words`.
macro_rules! methods {
    ($then:ident! $($words:tt)*) => {
        $then! { $($words)* fn num_envs(&self) -> usize }
        $then! { $($words)* fn single_observation_space(&self) -> Space }
        $then! { $($words)* fn single_action_space(&self) -> Space }
        $then! { $($words)* fn autoreset(&self) -> Autoreset }
        $then! { $($words)* fn reset_into(&mut self, reset: &VectorReset, columns: &mut Columns) -> Result<()> }
        $then! { $($words)* fn step_into(&mut self, actions: &Value, columns: &mut Columns) -> Result<()> }
        $then! { $($words)* fn info(&self, index: usize, visit: &mut dyn FnMut(&str, Value)) }
        $then! { $($words)* fn final_info(&self, index: usize, visit: &mut dyn FnMut(&str, Value)) }
        $then! { $($words)* fn column_infos(&self, visit: &mut dyn FnMut(&str, Value)) }
        $then! { $($words)* fn visit_envs(&mut self, visit: &mut dyn FnMut(usize, &mut dyn Any)) -> Result<()> }
        $then! { $($words)* fn inspect(&mut self, index: usize, visit: &mut dyn FnMut(&mut dyn Inspect)) -> Result<()> }
        $then! { $($words)* fn render(&mut self) -> Result<Vec<Rendered>> }
        $then! { $($words)* fn metadata(&self) -> Metadata }
        $then! { $($words)* fn snapshot(&self) -> Result<Snapshot> }
        $then! { $($words)* fn restore(&mut self, snapshot: &Snapshot) -> Result<()> }
        $then! { $($words)* fn close(&mut self) }
    };
}

use methods;

/// As [`methods`], with those for which a wrapper has another default.
macro_rules! all_methods {
    ($then:ident! $($words:tt)*) => {
        methods!($then! $($words)*);
        $then! { $($words)* fn observation_space(&self) -> Result<Space> }
        $then! { $($words)* fn action_space(&self) -> Result<Space> }
        $then! { $($words)* fn spec(&self) -> Option<VectorSpec> }
        $then! { $($words)* fn describe(&self) -> String }
    };
}

/// A wrapper is a vector: each method calls the wrapper's.
impl<W: VectorWrapper> VectorEnv for W {
    fn within(&self) -> Option<&dyn VectorEnv> {
        Some(self.inner())
    }

    fn within_mut(&mut self) -> Option<&mut dyn VectorEnv> {
        Some(self.inner_mut())
    }

    all_methods!(forward! [VectorEnv] {} {});
}

/// A box changes nothing, not even the description.
impl VectorEnv for Box<dyn VectorEnv> {
    fn within(&self) -> Option<&dyn VectorEnv> {
        Some(&**self)
    }

    fn within_mut(&mut self) -> Option<&mut dyn VectorEnv> {
        Some(&mut **self)
    }

    all_methods!(forward! [VectorEnv] {.as_ref()} {.as_mut()});
}
