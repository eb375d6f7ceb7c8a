//! What is registered of each wrapper, and arguments in short.
//!
//! After an intended change, store the new table with
//! `GYM_UPDATE_KEPT=1 cargo test --package gym-wrappers --test it registered`.

use std::fmt::Write;
use std::path::Path;

use gym_core::{DType, registry};
use gym_testing::kept;
use gym_wrappers::*;
use serde::Serialize;
use serde_json::{Value as Json, json};

/// The effect of each wrapper, what it goes around, and its arguments with their defaults.
#[test]
fn every_wrapper_is_registered_as_kept() {
    let mut told = String::new();
    for wrapper in registry::wrappers() {
        let around = match (wrapper.wraps_envs(), wrapper.wraps_vectors()) {
            (true, true) => "environments and vectors",
            (true, false) => "environments",
            (false, true) => "vectors",
            (false, false) => "nothing",
        };
        let (name, effect) = (wrapper.name, wrapper.description);
        writeln!(told, "{name} {effect}; around {around}").unwrap();
        for argument in wrapper.arguments() {
            let given = match argument.required {
                true => "required".to_owned(),
                false => argument.default.to_string(),
            };
            writeln!(told, "  {}: {}, {given}", argument.name, argument.kind).unwrap();
        }
    }
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/it");
    kept(&folder.join("registered.txt"), &told);
}

/// A number in place of the arguments is the first of them; the others have their defaults.
#[test]
fn arguments_in_short_are_the_first_of_them() {
    fn check<C: Serialize + Default>(short: impl Into<C>, given: &Json) {
        let mut expected = serde_json::to_value(C::default()).unwrap();
        for (name, value) in given.as_object().unwrap() {
            expected[name] = value.clone();
        }
        assert_eq!(serde_json::to_value(short.into()).unwrap(), expected);
    }
    check::<delay_observation::Config>(3, &json!({"delay": 3}));
    check::<dtype_observation::Config>(DType::I16, &json!({"dtype": "int16"}));
    check::<frame_stack_observation::Config>(5, &json!({"stack_size": 5}));
    check::<grayscale_observation::Config>(true, &json!({"keep_dim": true}));
    check::<max_and_skip_observation::Config>(7, &json!({"skip": 7}));
    check::<normalize_reward::Config>(0.5, &json!({"gamma": 0.5}));
    check::<repeat_action::Config>(3, &json!({"num_repeats": 3}));
    check::<sticky_action::Config>(0.25, &json!({"repeat_action_probability": 0.25}));
    let noise = json!({"probability_of_noise_per_pixel": 0.25});
    check::<add_white_noise::Config>(0.25, &noise);
    let noise = json!({"probability_of_noise_per_pixel": 0.25, "is_noise_grayscale": true});
    check::<add_white_noise::Config>((0.25, true), &noise);
    let patches = json!({"obstructed_pixels_ratio": 0.25, "obstruction_width": 3});
    check::<obstruct_view::Config>((0.25, 3), &patches);
    let patches = json!({
        "obstructed_pixels_ratio": 0.25, "obstruction_width": 3, "is_noise_grayscale": true
    });
    check::<obstruct_view::Config>((0.25, 3, true), &patches);
}
