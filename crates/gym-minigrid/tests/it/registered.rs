//! Environments made by id: native vectors, snapshots, wrappers and good policies.

use gym_core::vector::Autoreset;
use gym_core::{Env, EnvExt, Value, WrapperSpec, builder, make, registry};
use gym_minigrid::{Cell, Kind, World};
use gym_testing::native_equals_sync;
use serde_json::json;

/// Native vectors equal scalar environments, also after a snapshot.
#[test]
fn native_vectors_equal_scalar_environments() {
    for id in [
        "MiniGrid-DoorKey-5x5-v0",
        "MiniGrid-Dynamic-Obstacles-6x6-v0",
        "BabyAI-GoToLocal-v0",
        "BabyAI-PutNextS5N2Carrying-v0",
    ] {
        for autoreset in [Autoreset::NextStep, Autoreset::SameStep] {
            native_equals_sync(&format!("{id}, {autoreset:?}"), 300, 7, |kind| {
                let vector = builder(id).vector(9).kind(kind).autoreset(autoreset);
                vector.build().unwrap()
            });
        }
    }
}

/// With these seeds objects fill the first room, and minigrid looks for ever for a place from which
/// the agent faces none: another level is drawn.
#[test]
fn a_level_without_a_place_for_the_agent_is_drawn_again() {
    let mut env = make("BabyAI-SynthS5R2-v0").unwrap();
    for seed in [1741, 2678, 3586, 4033] {
        let again = [0; 2].map(|_| env.reset(seed).unwrap());
        assert_eq!(again[0], again[1]);
    }
}

/// In `DynamicObstacles` the actions beyond the action space turn left, as in minigrid.
#[test]
fn actions_beyond_three_turn_left_before_dynamic_obstacles() {
    for other in 3..=6 {
        let [mut turns, mut env] = [0; 2].map(|_| {
            let mut env = make("MiniGrid-Dynamic-Obstacles-8x8-v0").unwrap();
            env.reset(4).unwrap();
            env
        });
        for step in 0..40 {
            let expected = turns.step(&Value::Int(0)).unwrap();
            assert_eq!(
                env.step(&Value::Int(other)).unwrap(),
                expected,
                "action {other}, step {step}"
            );
        }
        assert_eq!(turns.snapshot().unwrap(), env.snapshot().unwrap());
        assert!(env.step(&Value::Int(7)).is_err());
    }
}

#[test]
fn good_policies_solve_their_tasks() {
    let mut count = 0;
    for registration in registry::all() {
        let Some(policy) = registration.page.policy else {
            continue;
        };
        let mut env = make(registration.id()).unwrap();
        for seed in 0..3 {
            let mut controller = policy.controller(&env).unwrap().unwrap();
            let mut observation = env.reset(seed).unwrap();
            let reward = loop {
                let action = controller(&env, &observation).unwrap();
                let step = env.step(&action).unwrap();
                observation = step.observation;
                if step.terminated || step.truncated {
                    break step.reward;
                }
            };
            assert!(reward > 0.3, "{}, seed {seed}: {reward}", registration.id());
        }
        count += 1;
    }
    assert!(count > 60, "{count}");
}

fn wrapped(id: &str, name: &str, kwargs: serde_json::Value) -> gym_core::BoxEnv {
    let serde_json::Value::Object(kwargs) = kwargs else {
        panic!("the arguments are an object");
    };
    let spec = WrapperSpec {
        name: name.to_owned(),
        kwargs,
    };
    spec.wrap(make(id).unwrap()).unwrap()
}

/// Spaces contain the wrappers' observations, a snapshot continues with the same steps, and a spec
/// rebuilds the wrappers.
#[test]
fn wrappers_keep_the_rules() {
    for (name, kwargs) in [
        ("ImgObsWrapper", json!({})),
        ("OneHotPartialObsWrapper", json!({})),
        ("FlatObsWrapper", json!({})),
        ("DictObservationSpaceWrapper", json!({})),
        ("FullyObsWrapper", json!({})),
        ("SymbolicObsWrapper", json!({})),
        ("ViewSizeWrapper", json!({"agent_view_size": 9})),
        ("RGBImgObsWrapper", json!({"tile_size": 4})),
        ("RGBImgPartialObsWrapper", json!({})),
        ("DirectionObsWrapper", json!({"type": "angle"})),
        ("ActionBonus", json!({})),
        ("PositionBonus", json!({"scale": 0.5})),
        (
            "NoDeath",
            json!({"no_death_types": ["lava"], "death_cost": -0.5}),
        ),
        ("StochasticActionWrapper", json!({"prob": 0.5})),
        ("ReseedWrapper", json!({"seeds": [3, 4]})),
    ] {
        let mut env = wrapped("MiniGrid-LavaCrossingS9N1-v0", name, kwargs);
        let space = env.observation_space();
        let mut actions = env.action_space().sampler(1);
        space.check(&env.reset(5).unwrap()).unwrap();
        let mut other = env.spec().unwrap().make().unwrap();
        for step in 0..60 {
            if step == 20 {
                other.restore(&env.snapshot().unwrap()).unwrap();
            }
            let action = actions.sample();
            let after = env.step(&action).unwrap();
            space.check(&after.observation).unwrap();
            if step >= 20 {
                assert_eq!(other.step(&action).unwrap(), after, "{name}: step {step}");
            }
            if after.done() {
                let first = env.reset(()).unwrap();
                if step >= 20 {
                    assert_eq!(other.reset(()).unwrap(), first, "{name}: step {step}");
                }
            }
        }
    }
}

#[test]
fn a_world_is_found_through_wrappers() {
    let mut env = wrapped("MiniGrid-Empty-5x5-v0", "ImgObsWrapper", json!({}));
    assert!(env.layer::<World>().is_none());
    env.reset(0).unwrap();
    let world = env.layer::<World>().unwrap();
    assert_eq!(
        world
            .grid
            .cells()
            .iter()
            .filter(|cell| **cell == Cell::GOAL)
            .count(),
        1
    );
    assert!(world.front().is_empty() && !world.front().is(Kind::Wall));
    let text = "WGWGWGWGWG\nWG>>    WG\nWG      WG\nWG    GGWG\nWGWGWGWGWG";
    assert_eq!(world.text(), text);
    assert_eq!(env.step(&Value::Int(2)).unwrap().reward, 0.0);
}

/// A step that the environment refuses draws nothing, so the next step is the same as without it.
#[test]
fn a_refused_step_draws_nothing() {
    let make = || {
        let kwargs = json!({"prob": 0.5});
        let mut env = wrapped("MiniGrid-Empty-5x5-v0", "StochasticActionWrapper", kwargs);
        env.reset(1).unwrap();
        env
    };
    let (mut plain, mut asked) = (make(), make());
    let mut refusals = 0;
    for step in 0..30 {
        let before = asked.snapshot().unwrap();
        match asked.step(&Value::Int(7)) {
            Err(_) => {
                refusals += 1;
                assert_eq!(asked.snapshot().unwrap(), before, "step {step}");
            }
            // the wrapper has replaced the invalid action by a random action
            Ok(_) => asked.restore(&before).unwrap(),
        }
        let action = Value::Int(step % 3);
        assert_eq!(
            asked.step(&action).unwrap(),
            plain.step(&action).unwrap(),
            "step {step}"
        );
    }
    assert!((5..25).contains(&refusals), "{refusals}");
}

/// Checks both ends of the range of each argument of the wrappers.
#[test]
fn the_ends_of_a_wrappers_arguments() {
    let fits = |name: &str, kwargs: serde_json::Value| {
        let serde_json::Value::Object(kwargs) = kwargs else {
            panic!("the arguments are an object");
        };
        let name = name.to_owned();
        let env = make("MiniGrid-Empty-5x5-v0").unwrap();
        WrapperSpec { name, kwargs }.wrap(env).is_ok()
    };
    for (prob, is_one) in [
        (0.0, true),
        (1.0, true),
        (-1e-9, false),
        (1.0 + 1e-9, false),
    ] {
        let kwargs = json!({"prob": prob});
        assert_eq!(fits("StochasticActionWrapper", kwargs), is_one, "{prob}");
    }
    for (action, is_one) in [(0, true), (6, true), (7, false)] {
        let kwargs = json!({"random_action": action});
        assert_eq!(fits("StochasticActionWrapper", kwargs), is_one, "{action}");
    }
    for (index, is_one) in [(0, true), (1, true), (2, false)] {
        let kwargs = json!({"seeds": [5, 6], "seed_idx": index});
        assert_eq!(fits("ReseedWrapper", kwargs), is_one, "{index}");
    }
    assert!(!fits("ReseedWrapper", json!({"seeds": []})));
    assert!(!fits(
        "NoDeath",
        json!({"no_death_types": ["lava", "goal"]})
    ));
}

/// A snapshot of a wrapper with more seeds is refused if its index is out of range, and then
/// changes nothing.
#[test]
fn a_place_in_another_list_of_seeds_is_refused() {
    let of = |seeds: &[u64]| {
        let kwargs = json!({"seeds": seeds});
        wrapped("MiniGrid-FourRooms-v0", "ReseedWrapper", kwargs)
    };
    let mut long = of(&[1, 2, 3]);
    long.reset(()).unwrap();
    long.reset(()).unwrap();
    let third = long.snapshot().unwrap();
    let mut short = of(&[1, 2]);
    short.reset(()).unwrap();
    let before = short.snapshot().unwrap();
    let error = short.restore(&third).unwrap_err().to_string();
    assert!(error.contains("does not fit this ReseedWrapper"), "{error}");
    assert_eq!(short.snapshot().unwrap(), before);
    let mut other = of(&[7, 8, 3]);
    other.restore(&third).unwrap();
    assert_eq!(other.reset(()).unwrap(), long.reset(()).unwrap());
}

/// `NoDeath` looks at the cell in front of the agent, and at the agent's own cell.
#[test]
fn no_death_where_the_agent_stands() {
    for (kind, lives) in [("empty", true), ("lava", false)] {
        let kwargs = json!({"no_death_types": [kind], "death_cost": -0.5});
        let mut env = wrapped("MiniGrid-GoToDoor-5x5-v0", "NoDeath", kwargs);
        env.reset(0).unwrap();
        // (the action `done` ends this episode)
        let end = env.step(&Value::Int(6)).unwrap();
        let expected = if lives { (false, -0.5) } else { (true, 0.0) };
        assert_eq!((end.terminated, end.reward), expected, "{kind}");
    }
}

/// A snapshot with another mission, or with a position outside of the grid, is refused.
#[test]
fn states_that_no_episode_has_are_refused() {
    let mut env = make("MiniGrid-Fetch-5x5-N2-v0").unwrap();
    env.reset(0).unwrap();
    let before = env.snapshot().unwrap();
    let state = env.inspect().unwrap().state().unwrap();
    for (key, value) in [
        ("mission", json!("dance")),
        ("direction", json!(4)),
        ("max_steps", json!(0)),
    ] {
        let mut other = state.clone();
        assert_ne!(other[key], value);
        other[key] = value;
        assert!(
            env.inspect_mut().unwrap().set_state(other).is_err(),
            "{key}"
        );
        assert_eq!(env.snapshot().unwrap(), before, "{key}");
    }
    env.inspect_mut().unwrap().set_state(state).unwrap();
}

/// `restore` checks both tasks of an instruction.
#[test]
fn both_tasks_of_a_state_are_checked() {
    let mut env = make("BabyAI-OpenDoorsOrderN2-v0").unwrap();
    let ordered = (0..50).find_map(|seed| {
        env.reset(seed).unwrap();
        let state = env.inspect().unwrap().state().unwrap();
        let then = &state["instr"]["Then"];
        then.is_object().then_some(state)
    });
    let state = ordered.expect("two doors, one after the other");
    for part in ["first", "second"] {
        let mut other = state.clone();
        let door = &mut other["instr"]["Then"][part]["Open"]["door"];
        assert!(door["objects"].is_array(), "{door}");
        door["objects"] = json!([60_000]);
        assert!(
            env.inspect_mut().unwrap().set_state(other).is_err(),
            "{part}"
        );
    }
    env.inspect_mut().unwrap().set_state(state).unwrap();
}
