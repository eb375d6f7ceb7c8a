//! A correct environment passes the checks in every wrapper.

use broken_envs as _;
use gym_conform::Severity;
use gym_core::{EnvSpec, Result, WrapperSpec};
use gym_render as _;
use gym_wrappers as _;
use serde_json::{Value as Json, json};

/// Wrappers that store observations restore any observation; an observation outside of its space is
/// not refused.
const KEEPS_OBSERVATIONS: &[&str] = &["snapshot-legal"];
/// Wrappers that store a step count restore any count, even one that differs from the count of the
/// inner time limit.
const COUNTS_STEPS: &[&str] = &["snapshot-legal"];
/// Wrappers that estimate statistics keep their statistics from episode to episode.
const ESTIMATES: &[&str] = &["reset-forgets"];

/// Returns wrappers with their arguments, the innermost first, and the exemptions that they need.
fn stacks() -> Vec<(Json, &'static [&'static str])> {
    vec![
        (
            json!([["RecordEpisodeStatistics", {"buffer_length": 3}]]),
            &[],
        ),
        (
            json!([["FrameStackObservation", {"stack_size": 3, "padding_type": [0.5, -0.5]}]]),
            KEEPS_OBSERVATIONS,
        ),
        (
            json!([["FrameStackObservation", {"stack_size": 2}], ["FlattenObservation", {}]]),
            KEEPS_OBSERVATIONS,
        ),
        (
            json!([["DelayObservation", {"delay": 2}]]),
            KEEPS_OBSERVATIONS,
        ),
        (
            json!([
                ["TimeAwareObservation", {"flatten": false}],
                ["FilterObservation", {"filter_keys": ["time"]}],
            ]),
            COUNTS_STEPS,
        ),
        (
            json!([["TimeAwareObservation", {"normalize_time": true}]]),
            COUNTS_STEPS,
        ),
        (
            json!([["NormalizeObservation", {"epsilon": 0.1}]]),
            ESTIMATES,
        ),
        (
            json!([
                ["MaxAndSkipObservation", {"skip": 2}],
                ["ReshapeObservation", {"shape": [2, 1]}],
            ]),
            &[],
        ),
        (json!([["DtypeObservation", {"dtype": "float64"}]]), &[]),
        (
            json!([["RescaleObservation", {"min_obs": 0.0, "max_obs": [0.5, 1.0]}]]),
            &[],
        ),
        (
            json!([["DiscretizeObservation", {"bins": [5, 9], "multidiscrete": true}]]),
            &[],
        ),
        (json!([["DiscretizeObservation", {"bins": 7}]]), &[]),
        (
            json!([
                [
                    "StickyAction",
                    {"repeat_action_probability": 0.5, "repeat_action_duration": [2, 4]},
                ],
            ]),
            &[],
        ),
        (json!([["RepeatAction", {"num_repeats": 2}]]), &[]),
        (
            json!([["NormalizeReward", {"gamma": 0.9, "epsilon": 1e-4}]]),
            ESTIMATES,
        ),
        (json!([["ClipReward", {"max_reward": 0.5}]]), &[]),
        (json!([["TimeLimit", {"max_episode_steps": 9}]]), &[]),
    ]
}

fn spec(wrappers: &Json) -> Result<EnvSpec> {
    let spec = gym_core::builder("broken/none-v0").spec()?;
    Ok(wrappers
        .as_array()
        .expect("a list")
        .iter()
        .fold(spec, |spec, wrapper| {
            let kwargs = wrapper[1].as_object().expect("arguments").clone();
            spec.wrapped(WrapperSpec {
                name: wrapper[0].as_str().expect("a name").into(),
                kwargs,
            })
        }))
}

#[test]
fn wrappers_keep_the_rules() {
    // in threads, because the check of the clock waits for a second
    std::thread::scope(|scope| {
        for (wrappers, excused) in stacks() {
            scope.spawn(move || {
                let findings = gym_conform::check(|| spec(&wrappers)?.make());
                let errors: Vec<_> = findings
                    .iter()
                    .filter(|finding| finding.severity == Severity::Error)
                    .collect();
                let checks: Vec<_> = errors.iter().map(|finding| finding.check).collect();
                assert_eq!(checks, excused, "{wrappers}: {errors:#?}");
            });
        }
    });
}
