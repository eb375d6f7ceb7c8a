//! Registrations of the ids `rapier/...`.

use gym_core::Registration;

/// Adapts the registration of an id `rapier/...`: without the feature `rapier`, the id is still
/// registered, with the missing feature as a requirement.
pub(crate) const fn on_rapier(registration: Registration) -> Registration {
    if cfg!(feature = "rapier") {
        registration
    } else {
        registration.needs("the feature `rapier`", || false)
    }
}

/// An exemption from gym-conform's check `no-allocation`.
pub(crate) const RAPIER_ALLOCATES: (&str, &str) =
    ("no-allocation", "rapier2d allocates in its own step");
