//! Faults with a sound twin each: `broken/CHECK.NAME-v0` has the fault, and `broken/none.CHECK.NAME-v0`
//! does the same correctly.

/// Defines twists, and registers a walk with the fault and one without.
macro_rules! pairs {
    ($($check:literal $name:literal $Twist:ident $(($Arguments:ident))? { $($item:item)* })*) => {$(
        #[doc = concat!("`", $check, ".", $name, "`, and without `BAD` its sound twin.")]
        #[derive(Debug)]
        pub(crate) struct $Twist<const BAD: bool>;

        impl<const BAD: bool> $crate::twisted::Twist for $Twist<BAD> {
            type Arguments = $crate::pairs::pairs!(@ $($Arguments)?);

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
