//! Faults with a sound twin each: `broken/CHECK.NAME-v0` has the fault, and `broken/none.CHECK.NAME-v0`
//! does the same correctly.

use gym_core::{Outcome, Result, Value};

use crate::arguments::Scale;
use crate::twisted::{Twist, Twisted};

/// Takes a step of the walk and scales its reward by the argument.
pub(crate) fn scaled_step<T: Twist<Arguments = Scale>>(
    env: &mut Twisted<T>,
    action: &Value,
    observation: &mut Value,
) -> Result<Outcome> {
    let outcome = env.step_of_spoilt(action, observation)?;
    Ok(Outcome {
        reward: outcome.reward * env.arguments.scale,
        ..outcome
    })
}

/// Defines twists, and registers for each a walk with the fault and a walk without the fault. A
/// name before the braces is the function that steps both walks.
macro_rules! pairs {
    ($($check:literal $name:literal $Twist:ident $(($Arguments:ident))? $($step:ident)? { $($item:item)* })*) => {$(
        #[doc = concat!("`", $check, ".", $name, "`, and without `BAD` its sound twin.")]
        #[derive(Debug)]
        pub(crate) struct $Twist<const BAD: bool>;

        impl<const BAD: bool> $crate::twisted::Twist for $Twist<BAD> {
            type Arguments = $crate::pairs::pairs!(@ $($Arguments)?);

            $(fn step(
                env: &mut $crate::twisted::Twisted<Self>,
                action: &gym_core::Value,
                observation: &mut gym_core::Value,
            ) -> gym_core::Result<gym_core::Outcome> {
                $crate::pairs::$step(env, action, observation)
            })?

            $($item)*
        }

        gym_core::register!(
            gym_core::Registration::new::<$crate::twisted::Twisted<$Twist<true>>>(
                concat!("broken/", $check, ".", $name, "-v0")
            )
            .description("Walk from the middle to either end.")
            .reset_options(&[("start", "0.25")])
            .max_episode_steps(12)
        );
        gym_core::register!(
            gym_core::Registration::new::<$crate::twisted::Twisted<$Twist<false>>>(
                concat!("broken/none.", $check, ".", $name, "-v0")
            )
            .description("Walk from the middle to either end.")
            .reset_options(&[("start", "0.25")])
            .max_episode_steps(12)
        );
    )*};
    (@) => { $crate::arguments::Scale };
    (@ $Arguments:ident) => { $Arguments };
}

pub(crate) use pairs;
