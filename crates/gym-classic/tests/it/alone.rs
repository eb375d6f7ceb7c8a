//! Tests one family without the facade and without a renderer.

use gym_classic as _; // a crate that is not named is not linked, and its environments are missing
use gym_core::prelude::*;
use gym_core::registry;

#[test]
fn only_this_family_is_linked() {
    assert!(
        registry::all()
            .iter()
            .all(|registration| registration.source.package == "gym-classic")
    );
    assert_eq!(registry::all().len(), 6);
    make("Acrobot-v1").unwrap().reset(0).unwrap();
}

#[test]
fn pictures_need_a_crate_that_draws() {
    let error = builder("CartPole-v1")
        .render_mode(RenderMode::RgbArray)
        .build()
        .unwrap_err()
        .to_string();
    assert!(
        error.contains(
            "turn on the feature `render` of rust-gym, or add gym-render and `use gym_render as _;`"
        ),
        "{error}"
    );
}
