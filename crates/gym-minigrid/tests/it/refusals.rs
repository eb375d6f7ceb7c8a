//! The words in which wrappers of grids refuse arguments, environments and what they meet in an episode.
//!
//! After an intended change, store them with
//! `GYM_UPDATE_KEPT=1 cargo test --package gym-minigrid --test it refusals`.

use std::path::Path;

use gym_core::{BoxEnv, EnvExt, Error, WrapperSpec, make, registry};
use gym_testing::kept;
use serde_json::{Value as Json, json};

fn around(env: BoxEnv, name: &str, kwargs: &Json) -> Result<BoxEnv, Error> {
    let spec = WrapperSpec {
        name: name.to_owned(),
        kwargs: kwargs.as_object().unwrap().clone(),
    };
    spec.wrap(env)
}

/// The first steps of an episode.
fn play(mut env: BoxEnv) -> Result<(), Error> {
    env.reset(1)?;
    let mut actions = env.action_sampler(2)?;
    for _ in 0..3 {
        env.step(&actions.sample())?;
    }
    Ok(())
}

/// Each wrapper with its default arguments around a grid, a grid without a goal, observations that are no
/// dict, pictures, and a longer mission.
#[test]
fn what_a_wrapper_cannot_be_around_is_told_as_kept() {
    let mut told = String::new();
    let grid = || make("MiniGrid-Empty-5x5-v0").unwrap();
    let inside = |name: &str| around(grid(), name, &json!({})).unwrap();
    for wrapper in registry::wrappers() {
        let name = wrapper.name;
        if !wrapper.wraps_envs() || !name.ends_with("Wrapper") && !grids_own(name) {
            continue;
        }
        let required = match name {
            "NoDeath" => json!({"no_death_types": ["lava"]}),
            "ReseedWrapper" => json!({"seeds": [1]}),
            _ => json!({}),
        };
        for (what, env) in [
            ("a grid", grid()),
            ("no goal", make("MiniGrid-Fetch-5x5-N2-v0").unwrap()),
            ("an image alone", inside("ImgObsWrapper")),
            ("pictures", inside("RGBImgPartialObsWrapper")),
            ("numbers", inside("FlatObsWrapper")),
            ("two tasks", make("BabyAI-SynthSeq-v0").unwrap()),
        ] {
            if let Err(error) = around(env, name, &required).and_then(play) {
                told += &format!("{name} around {what}: {error}\n");
            }
        }
    }
    for (name, kwargs) in [
        ("NoDeath", json!({})),
        ("NoDeath", json!({"no_death_types": ["goal"]})),
        ("NoDeath", json!({"no_death_types": ["lava", "goal"]})),
        ("NoDeath", json!({"no_death_types": ["fire"]})),
        ("ReseedWrapper", json!({"seeds": []})),
        ("ReseedWrapper", json!({"seeds": [1, 2], "seed_idx": 2})),
        ("ReseedWrapper", json!({"seeds": [-1]})),
        ("StochasticActionWrapper", json!({"prob": 1.5})),
        ("StochasticActionWrapper", json!({"prob": -0.5})),
        ("StochasticActionWrapper", json!({"random_action": 7})),
        ("ViewSizeWrapper", json!({"agent_view_size": 1})),
        ("ViewSizeWrapper", json!({"agent_view_size": 4})),
        ("ViewSizeWrapper", json!({"agent_view_size": 65})),
        ("RGBImgObsWrapper", json!({"tile_size": 0})),
        ("RGBImgPartialObsWrapper", json!({"tile_size": 0})),
        ("RGBImgPartialObsWrapper", json!({"tile_size": 100_000})),
        ("DirectionObsWrapper", json!({"type": "slant"})),
        ("FlatObsWrapper", json!({"maxStrLen": 5})),
        (
            "DictObservationSpaceWrapper",
            json!({"max_words_in_mission": 3}),
        ),
        (
            "DictObservationSpaceWrapper",
            json!({"word_dict": {"get": 0}}),
        ),
        (
            "DictObservationSpaceWrapper",
            json!({"word_dict": {"get": 0, "to": 2}}),
        ),
        (
            "DictObservationSpaceWrapper",
            json!({"word_dict": {"get": -1}}),
        ),
        (
            "DictObservationSpaceWrapper",
            json!({"word_dict": {"get": 0.5}}),
        ),
        ("ActionBonus", json!({"scale": "far"})),
        ("PositionBonus", json!({"none": 1})),
    ] {
        let refused = around(grid(), name, &kwargs).and_then(play).unwrap_err();
        told += &format!("{name} {kwargs}: {refused}\n");
    }
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    kept(&folder.join("tests/it/refusals.txt"), &told);
}

/// Whether a wrapper without the word in its name is one of grids.
fn grids_own(name: &str) -> bool {
    ["ActionBonus", "PositionBonus", "NoDeath"].contains(&name)
}
