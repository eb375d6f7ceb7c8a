//! The trait of wrappers of vectors.
//!
//! Each hook of [`VectorWrapper`] calls the inner vector by default, and one blanket implementation
//! makes it a [`VectorEnv`](crate::VectorEnv). The inner vector is `&dyn
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
/// Only [`inner`](Self::inner) and [`inner_mut`](Self::inner_mut) are required. The method `x` of
/// [`VectorEnv`] calls the hook `on_x` (`on_reset` for `reset_into`, `on_step` for `step_into`).
/// Hooks call the inner vector by default, except [`on_spec`](Self::on_spec): a wrapper without
/// [`wrapper_spec`](Self::wrapper_spec) has no spec.
///
/// ```
/// use gym_core::vector::{Columns, Progress, VectorEnv};
/// use gym_core::{Result, Value, VectorWrapper};
///
/// /// Takes a little from the reward of each step.
/// struct Effort<V> {
///     envs: V,
/// }
///
/// impl<V: VectorEnv> VectorWrapper for Effort<V> {
///     fn inner(&self) -> &dyn VectorEnv {
///         &self.envs
///     }
///
///     fn inner_mut(&mut self) -> &mut dyn VectorEnv {
///         &mut self.envs
///     }
///
///     fn on_step(&mut self, actions: &Value, columns: &mut Columns) -> Result<()> {
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
/// A wrapper with state of its own overrides [`on_snapshot`](Self::on_snapshot) and
/// [`on_restore`](Self::on_restore). A wrapper that adds entries to the infos overrides
/// [`on_info`](Self::on_info), from which [`infos`](crate::VectorEnvExt::infos) makes the columns.
pub trait VectorWrapper: Any + Send {
    /// The inner vector.
    fn inner(&self) -> &dyn VectorEnv;

    /// The inner vector, mutable.
    fn inner_mut(&mut self) -> &mut dyn VectorEnv;

    /// The name and arguments from which [`VectorSpec::make`] rebuilds this wrapper, if it can.
    fn wrapper_spec(&self) -> Option<WrapperSpec> {
        None
    }

    /// The hook of [`VectorEnv::observation_space`]: a batch of
    /// [`on_single_observation_space`](Self::on_single_observation_space) if the wrapper changes
    /// it.
    fn on_observation_space(&self) -> Result<Space> {
        let single = self.on_single_observation_space();
        if single == self.inner().single_observation_space() {
            self.inner().observation_space()
        } else {
            single.batch(self.on_num_envs())
        }
    }

    /// The hook of [`VectorEnv::action_space`]: a batch of
    /// [`on_single_action_space`](Self::on_single_action_space) if the wrapper changes it.
    fn on_action_space(&self) -> Result<Space> {
        let single = self.on_single_action_space();
        if single == self.inner().single_action_space() {
            self.inner().action_space()
        } else {
            single.batch(self.on_num_envs())
        }
    }

    /// The hook of [`VectorEnv::spec`]: the inner spec with [`wrapper_spec`](Self::wrapper_spec)
    /// added; `None` if either is.
    fn on_spec(&self) -> Option<VectorSpec> {
        let wrapper = self.wrapper_spec()?;
        self.inner().spec().map(|spec| spec.wrapped(wrapper))
    }

    /// The wrapper's name; the default is the name of its type.
    fn name(&self) -> &'static str {
        crate::env::short_type_name::<Self>()
    }

    /// The hook of [`VectorEnv::describe`]: `<Wrapper, inner>`, as Gymnasium prints a stack.
    fn on_describe(&self) -> String {
        format!("<{}, {}>", self.name(), self.inner().describe())
    }

    methods!(forward! hooks [VectorEnv]);
}

/// Calls the macro `$then` with `$words` and the signature of each method of [`VectorEnv`] that
/// passes through a wrapper unchanged. The name of the method's hook follows the name of the
/// method. `all` adds the methods whose hooks have other defaults.
macro_rules! methods {
    (all $then:ident! $($words:tt)*) => {
        methods!($then! $($words)*);
        $then! { $($words)* fn observation_space on_observation_space(&self) -> Result<Space> }
        $then! { $($words)* fn action_space on_action_space(&self) -> Result<Space> }
        $then! { $($words)* fn spec on_spec(&self) -> Option<VectorSpec> }
        $then! { $($words)* fn describe on_describe(&self) -> String }
    };
    ($then:ident! $($words:tt)*) => {
        $then! { $($words)* fn num_envs on_num_envs(&self) -> usize }
        $then! { $($words)* fn single_observation_space on_single_observation_space(&self) -> Space }
        $then! { $($words)* fn single_action_space on_single_action_space(&self) -> Space }
        $then! { $($words)* fn autoreset on_autoreset(&self) -> Autoreset }
        $then! { $($words)* fn reset_into on_reset(&mut self, reset: &VectorReset, columns: &mut Columns) -> Result<()> }
        $then! { $($words)* fn step_into on_step(&mut self, actions: &Value, columns: &mut Columns) -> Result<()> }
        $then! { $($words)* fn info on_info(&self, index: usize, visit: &mut dyn FnMut(&str, Value)) }
        $then! { $($words)* fn final_info on_final_info(&self, index: usize, visit: &mut dyn FnMut(&str, Value)) }
        $then! { $($words)* fn column_infos on_column_infos(&self, visit: &mut dyn FnMut(&str, Value)) }
        $then! { $($words)* fn visit_envs on_visit_envs(&mut self, visit: &mut dyn FnMut(usize, &mut dyn Any)) -> Result<()> }
        $then! { $($words)* fn inspect on_inspect(&mut self, index: usize, visit: &mut dyn FnMut(&mut dyn Inspect)) -> Result<()> }
        $then! { $($words)* fn render on_render(&mut self) -> Result<Vec<Rendered>> }
        $then! { $($words)* fn metadata on_metadata(&self) -> Metadata }
        $then! { $($words)* fn snapshot on_snapshot(&self) -> Result<Snapshot> }
        $then! { $($words)* fn restore on_restore(&mut self, snapshot: &Snapshot) -> Result<()> }
        $then! { $($words)* fn close on_close(&mut self) }
    };
}

use methods;

/// A wrapper is a vector: each method calls its hook.
impl<W: VectorWrapper> VectorEnv for W {
    fn within(&self) -> Option<&dyn VectorEnv> {
        Some(self.inner())
    }

    fn within_mut(&mut self) -> Option<&mut dyn VectorEnv> {
        Some(self.inner_mut())
    }

    methods!(all forward! calls);
}

/// A box forwards every method, and does not appear in the description.
impl VectorEnv for Box<dyn VectorEnv> {
    fn within(&self) -> Option<&dyn VectorEnv> {
        Some(&**self)
    }

    fn within_mut(&mut self) -> Option<&mut dyn VectorEnv> {
        Some(&mut **self)
    }

    methods!(all forward! {.as_ref()} {.as_mut()});
}
