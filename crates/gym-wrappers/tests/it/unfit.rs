//! What does not fit a wrapper.

use gym_core::spaces::{BoxSpace, DictSpace};
use gym_core::{BoxEnv, DType, Space, WrapperSpec};
use serde_json::{Value as Json, json};

use super::spy::Spy;

/// What does not fit an environment is refused in words that say why, one for each part of a condition.
#[test]
fn wrappers_that_do_not_fit_say_why() {
    let unit = || Space::boxed([-1.0, 0.0], [1.0, 1.0]);
    let picture = |high, shape: &[usize]| -> Space {
        BoxSpace::uniform(0.0, high, shape.to_vec(), DType::U8)
            .unwrap()
            .into()
    };
    let dict = || -> Space {
        DictSpace::new([("a", Space::discrete(2)), ("b", Space::discrete(3))])
            .unwrap()
            .into()
    };
    let wrap = |space: Space, name: &str, kwargs: Json| {
        let kwargs = kwargs.as_object().expect("arguments").clone();
        let spec = WrapperSpec {
            name: name.into(),
            kwargs,
        };
        spec.wrap(BoxEnv::new(Spy::new(space))).map(drop)
    };
    let mut wrong = Vec::new();
    let finite = "both must be finite, or both infinite";
    for (space, name, kwargs, words) in [
        (
            unit(),
            "ClipReward",
            json!({}),
            "neither min_reward nor max_reward is given",
        ),
        (
            unit(),
            "ClipReward",
            json!({"min_reward": 2.0, "max_reward": 1.0}),
            "2",
        ),
        (
            unit(),
            "ClipReward",
            json!({"max_reward": [1.0, 2.0]}),
            "a reward has one bound",
        ),
        (
            unit(),
            "FilterObservation",
            json!({"filter_keys": ["a"]}),
            "names need a Dict",
        ),
        (
            dict(),
            "FilterObservation",
            json!({"filter_keys": [0]}),
            "names need a Dict",
        ),
        (
            dict(),
            "FilterObservation",
            json!({"filter_keys": []}),
            "filter_keys is empty",
        ),
        (
            dict(),
            "FilterObservation",
            json!({"filter_keys": ["a", "c"]}),
            "there is no member c",
        ),
        (
            unit(),
            "GrayscaleObservation",
            json!({}),
            "it needs uint8 observations from 0 to 255",
        ),
        (
            picture(254.0, &[4, 4, 3]),
            "GrayscaleObservation",
            json!({}),
            "from 0 to 255",
        ),
        (
            picture(255.0, &[4, 4]),
            "GrayscaleObservation",
            json!({}),
            "shape (height, width, 3)",
        ),
        (
            picture(255.0, &[4, 4, 4]),
            "GrayscaleObservation",
            json!({}),
            "shape (height, width, 3)",
        ),
        (
            picture(255.0, &[4]),
            "ResizeObservation",
            json!({"shape": [2, 2]}),
            "two or three axes",
        ),
        (
            picture(255.0, &[4, 4]),
            "ResizeObservation",
            json!({"shape": [0, 2]}),
            "at least 1",
        ),
        (
            picture(255.0, &[4, 4]),
            "ResizeObservation",
            json!({"shape": [2, 0]}),
            "at least 1",
        ),
        (
            unit(),
            "ReshapeObservation",
            json!({"shape": [3]}),
            "does not hold the elements",
        ),
        (
            unit(),
            "ReshapeObservation",
            json!({"shape": [1, 1]}),
            "does not hold the elements",
        ),
        (
            picture(9.0, &[2]),
            "RescaleObservation",
            json!({"min_obs": 0.0, "max_obs": 1.0}),
            "holds no fractions",
        ),
        (
            unit(),
            "RescaleObservation",
            json!({"min_obs": "-inf", "max_obs": 1.0}),
            finite,
        ),
        (
            unit(),
            "RescaleObservation",
            json!({"min_obs": 0.0, "max_obs": "inf"}),
            finite,
        ),
        (
            unit(),
            "RescaleObservation",
            json!({"min_obs": 2.0, "max_obs": 1.0}),
            "2",
        ),
        (
            unit(),
            "RescaleObservation",
            json!({"min_obs": [0.0, 0.0, 0.0], "max_obs": 1.0}),
            "3",
        ),
        (
            unit(),
            "RescaleObservation",
            json!({"min_obs": [[0.0, 0.0], [0.0]], "max_obs": 1.0}),
            "the lists of a bound have different lengths",
        ),
        (
            dict(),
            "DtypeObservation",
            json!({"dtype": "float64"}),
            "it needs a Box, Discrete",
        ),
        (
            dict(),
            "NormalizeObservation",
            json!({}),
            "it needs observations with a shape",
        ),
        (
            dict(),
            "MaxAndSkipObservation",
            json!({}),
            "it needs observations with a shape",
        ),
        (
            unit(),
            "NormalizeObservation",
            json!({"epsilon": 0.0}),
            "it must be above 0",
        ),
        (
            unit(),
            "NormalizeReward",
            json!({"gamma": 1.5}),
            "gamma is 1.5: it must be in [0, 1]",
        ),
        (
            unit(),
            "NormalizeReward",
            json!({"gamma": -0.5}),
            "gamma is -0.5: it must be in [0, 1]",
        ),
        (
            unit(),
            "NormalizeReward",
            json!({"epsilon": 0.0}),
            "it must be above 0",
        ),
        (
            unit(),
            "AddWhiteNoise",
            json!({"probability_of_noise_per_pixel": 1.0}),
            "it must be in [0, 1)",
        ),
        (
            unit(),
            "AddWhiteNoise",
            json!({"probability_of_noise_per_pixel": -0.1}),
            "it must be in [0, 1)",
        ),
        (
            unit(),
            "ObstructView",
            json!({"obstructed_pixels_ratio": 1.0, "obstruction_width": 1}),
            "it must be in [0, 1)",
        ),
        (
            unit(),
            "ObstructView",
            json!({"obstructed_pixels_ratio": 0.5, "obstruction_width": 0}),
            "obstruction_width is 0",
        ),
        (
            unit(),
            "DiscretizeObservation",
            json!({"bins": [2]}),
            "bins are given for 1 of 2 elements",
        ),
        (
            unit(),
            "DiscretizeObservation",
            json!({"bins": [2, 0]}),
            "0",
        ),
        (
            dict(),
            "DiscretizeObservation",
            json!({"bins": 2}),
            "it needs a Box observation space",
        ),
        (
            Space::boxed([0.0], [f32::INFINITY]),
            "DiscretizeObservation",
            json!({"bins": 2}),
            "bins need finite bounds",
        ),
        (
            unit(),
            "DiscretizeAction",
            json!({"bins": [2, 2]}),
            "bins are given for 2 of 1 elements",
        ),
        (
            unit(),
            "RescaleAction",
            json!({"min_action": 1.0, "max_action": 1.0}),
            "they must differ",
        ),
        (
            unit(),
            "RecordEpisodeStatistics",
            json!({"buffer_length": u64::MAX}),
            "do not fit in memory",
        ),
        (
            unit(),
            "DelayObservation",
            json!({"delay": u32::MAX}),
            "do not fit in memory",
        ),
        (
            unit(),
            "TimeLimit",
            json!({}),
            "it needs `max_episode_steps`",
        ),
        (unit(), "TimeLimit", json!({"max_episode_steps": 0}), "0"),
        (unit(), "RepeatAction", json!({"num_repeats": 0}), "0"),
    ] {
        let told = wrap(space, name, kwargs.clone())
            .err()
            .map(|error| error.to_string());
        if !told
            .as_deref()
            .is_some_and(|told| told.contains(words) && told.contains(name))
        {
            wrong.push(format!("{name} with {kwargs}: {told:?}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
