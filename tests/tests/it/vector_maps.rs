//! A stateless wrapper of a vector has the effect of the same wrapper around each sub-environment.

use gym::render::RenderMode;
use gym::vector::{Autoreset, Columns, VectorKind};
use gym::{EnvSpec, VectorEnv, VectorEnvExt, WrapperSpec, builder, registry};
use serde_json::{Value as Json, json};

/// Returns environments, and wrappers for them.
fn cases() -> Vec<(EnvSpec, Json)> {
    let short = |id: &str| builder(id).max_episode_steps(7);
    let plain = |id: &str| short(id).spec().unwrap();
    let pictures = short("CartPole-v1")
        .render_mode(RenderMode::RgbArray)
        .render_size(30, 20);
    let pictures = pictures
        .wrap(WrapperSpec::new("AddRenderObservation"))
        .spec()
        .unwrap();
    let state = WrapperSpec::new("AddRenderObservation").arg("render_only", false);
    let dict = short("CartPole-v1")
        .render_mode(RenderMode::RgbArray)
        .render_size(6, 4)
        .wrap(state)
        .spec()
        .unwrap();
    vec![
        (
            plain("Blackjack-v1"),
            json!([["FilterObservation", {"filter_keys": [2, 0]}], ["FlattenObservation", {}]]),
        ),
        (
            dict.clone(),
            json!([["FilterObservation", {"filter_keys": ["state"]}]]),
        ),
        (
            dict,
            json!([["FlattenObservation", {}], ["DtypeObservation", {"dtype": "float64"}]]),
        ),
        (
            pictures.clone(),
            json!([
                ["GrayscaleObservation", {"keep_dim": true}],
                ["ResizeObservation", {"shape": [7, 9]}],
            ]),
        ),
        (
            pictures,
            json!([["ResizeObservation", {"shape": [10, 15]}], ["GrayscaleObservation", {}]]),
        ),
        (
            plain("CartPole-v1"),
            json!([["ReshapeObservation", {"shape": [2, 2]}]]),
        ),
        (
            plain("Taxi-v4"),
            json!([["DtypeObservation", {"dtype": "float32"}]]),
        ),
        (plain("Taxi-v4"), json!([["FlattenObservation", {}]])),
        (
            plain("MountainCar-v0"),
            json!([["RescaleObservation", {"min_obs": [-1.0, -0.5], "max_obs": 1.0}],
                   ["DiscretizeObservation", {"bins": [5, 9], "multidiscrete": true}]]),
        ),
        (
            plain("MountainCar-v0"),
            json!([["DiscretizeObservation", {"bins": 7}]]),
        ),
        (
            plain("Pendulum-v1"),
            json!([["RescaleAction", {"min_action": -1.0, "max_action": 1.0}], ["ClipAction", {}]]),
        ),
        (
            plain("Pendulum-v1"),
            json!([["DiscretizeAction", {"bins": 5}], ["ClipReward", {"min_reward": -0.5}]]),
        ),
        (
            plain("Pendulum-v1"),
            json!([["DiscretizeAction", {"bins": [5], "multidiscrete": true}]]),
        ),
    ]
}

fn wrappers(stack: &Json) -> Vec<WrapperSpec> {
    let wrapper = |entry: &Json| json!({"name": entry[0], "kwargs": entry[1]});
    stack
        .as_array()
        .expect("a list")
        .iter()
        .map(|entry| serde_json::from_value(wrapper(entry)).unwrap())
        .collect()
}

#[test]
fn every_map_serves_vectors() {
    let mut tested: Vec<_> = cases()
        .iter()
        .flat_map(|(_, stack)| wrappers(stack))
        .map(|spec| spec.name)
        .collect();
    tested.sort();
    tested.dedup();
    let stateful = [
        "NormalizeObservation",
        "NormalizeReward",
        "RecordEpisodeStatistics",
        "RecordVideo",
    ];
    let both = registry::wrappers()
        .into_iter()
        .filter(|wrapper| wrapper.wraps_vectors());
    // the tests of gym-minigrid cover these wrappers
    let of_grids = [
        "DictObservationSpaceWrapper",
        "FlatObsWrapper",
        "ImgObsWrapper",
        "OneHotPartialObsWrapper",
    ];
    let maps: Vec<_> = both
        .map(|wrapper| wrapper.name)
        .filter(|name| !stateful.contains(name) && !of_grids.contains(name))
        .collect();
    assert_eq!(tested, maps);
}

#[test]
fn a_map_around_a_vector_is_one_around_each() {
    for (spec, stack) in cases() {
        for autoreset in [Autoreset::NextStep, Autoreset::SameStep] {
            let mut within = spec.clone();
            within.additional_wrappers.extend(wrappers(&stack));
            let make = |spec: EnvSpec| {
                gym::vector::VectorSpec::new(spec, 3, VectorKind::Sync)
                    .autoreset(autoreset)
                    .make()
                    .unwrap()
            };
            let mut within = make(within);
            let wrap =
                |envs: Box<dyn VectorEnv>, wrapper: WrapperSpec| wrapper.wrap_vector(envs).unwrap();
            let mut around = wrappers(&stack).into_iter().fold(make(spec.clone()), wrap);
            assert_eq!(
                around.single_observation_space(),
                within.single_observation_space(),
                "{stack}"
            );
            assert_eq!(
                around.single_action_space(),
                within.single_action_space(),
                "{stack}"
            );
            let mut actions = within.action_sampler(3).unwrap();
            let (mut a, mut b) = (within.reset(5).unwrap(), around.reset(5).unwrap());
            assert_eq!(a.observations, b.observations, "{stack}");
            for _ in 0..20 {
                let batch = actions.sample();
                within.step_into(&batch, &mut a).unwrap();
                around.step_into(&batch, &mut b).unwrap();
                let Columns {
                    observations,
                    rewards,
                    terminated,
                    truncated,
                    has_final,
                    ..
                } = &a;
                assert_eq!(
                    (observations, rewards),
                    (&b.observations, &b.rewards),
                    "{stack}"
                );
                assert_eq!(
                    (terminated, truncated, has_final),
                    (&b.terminated, &b.truncated, &b.has_final)
                );
                let space = within.single_observation_space();
                for index in (0..3).filter(|index| a.has_final[*index]) {
                    let [mut x, mut y] = [gym::Value::Null, gym::Value::Null];
                    space
                        .read_row(&a.final_observations, index, &mut x)
                        .unwrap();
                    space
                        .read_row(&b.final_observations, index, &mut y)
                        .unwrap();
                    assert_eq!(x, y, "{stack}");
                }
            }
            let mut again = around.spec().unwrap().make().unwrap();
            assert_eq!(again.reset(9).unwrap(), around.reset(9).unwrap(), "{stack}");
        }
    }
}
