//! The hand: reset options, and what snapshots hold.

use gym_core::{Env, EnvExt, Reset, Value, make};
use gym_robotics as _;
use serde_json::json;

#[test]
fn a_bad_state_says_what_to_give() {
    let mut env = make("AdroitHandDoor-v1").unwrap();
    env.reset(1).unwrap();
    let before = env.snapshot().unwrap();
    let zeros = vec![0.0; 30];
    for (state, says) in [
        (json!(7), "it is no dict"),
        (json!({}), "`qpos` is not 30 numbers"),
        (
            json!({"qpos": zeros, "qvel": zeros}),
            "`door_body_pos` is not 3 numbers",
        ),
        (
            json!({"qpos": [0.0], "qvel": zeros, "door_body_pos": [0, 0, 0]}),
            "`qpos` is not 30",
        ),
        (
            json!({"qpos": zeros, "qvel": zeros, "door_body_pos": [0, 0, 1e11]}),
            "within ±1e10",
        ),
        (
            json!({"qpos": zeros, "qvel": zeros, "door_pos": [0, 0, 0]}),
            "unknown entry `door_pos`",
        ),
    ] {
        let error = env
            .reset(Reset::seed(2).option("initial_state_dict", state))
            .unwrap_err();
        let error = error.to_string();
        assert!(error.contains(says), "{error}");
        assert!(
            error.contains("give `qpos` (30 numbers), `qvel` (30 numbers), `door_body_pos` (3"),
            "{error}"
        );
    }
    assert_eq!(env.snapshot().unwrap(), before);
}

/// The height of the board is drawn anew, x and y stay as the last state set them.
#[test]
fn what_a_reset_does_not_draw_stays() {
    let mut env = make("AdroitHandHammer-v1").unwrap();
    let place = |seen: &Value| seen.as_slice::<f64>().unwrap()[42..45].to_vec();
    let first = place(&env.reset(1).unwrap());
    let zeros = vec![0.0; 33];
    let state = json!({"qpos": zeros, "qvel": zeros, "board_pos": [0.3, 0.1, 0.2]});
    let moved = place(
        &env.reset(Reset::seed(1).option("initial_state_dict", state))
            .unwrap(),
    );
    assert!(
        (moved[0] - first[0] - 0.25).abs() < 1e-12 && (moved[1] - first[1] - 0.1).abs() < 1e-12
    );
    let next = place(&env.reset(1).unwrap());
    assert!((next[0] - moved[0]).abs() < 1e-12 && (next[2] - first[2]).abs() < 1e-12);
}

#[test]
fn success_is_told_after_steps() {
    for id in ["AdroitHandDoorSparse-v1", "AdroitHandPen-v1"] {
        let mut env = make(id).unwrap();
        env.reset(1).unwrap();
        assert!(env.info_map().is_empty());
        let action = env.action_sampler(1).unwrap().sample().clone();
        let step = env.step(&action).unwrap();
        assert_eq!(
            env.info_map().get("success").and_then(Value::as_bool),
            Some(false)
        );
        assert!(id.contains("Pen") || step.reward == -0.1);
    }
}

/// Rewards near goals, which random actions do not reach. `adroit_rewards.py` recorded them.
#[test]
fn rewards_near_goals_are_the_packages() {
    let hammer = json!({"board_pos": [0.05, 0.0, 0.2]});
    let door = json!({"door_body_pos": [-0.05, 0.27, 0.29]});
    let ball =
        |x: f64, up: f64| json!({"obj_pos": [0.0, 0.0, 0.035], "target_pos": [x, 0.0, 0.035 + up]});
    type Numbers = &'static [(usize, f64)];
    let cases: [(&str, usize, Numbers, serde_json::Value, f64, bool); 14] = [
        (
            "AdroitHandDoor-v1",
            30,
            &[(28, 0.1)],
            door.clone(),
            -0.18437477934276006,
            false,
        ),
        (
            "AdroitHandDoor-v1",
            30,
            &[(28, 0.3)],
            door.clone(),
            1.8735613272257,
            false,
        ),
        (
            "AdroitHandDoor-v1",
            30,
            &[(28, 1.1)],
            door.clone(),
            10.029781456140386,
            false,
        ),
        (
            "AdroitHandDoor-v1",
            30,
            &[(28, 1.4)],
            door.clone(),
            20.05906723585121,
            true,
        ),
        (
            "AdroitHandHammer-v1",
            33,
            &[],
            hammer.clone(),
            -1.3686220251819108,
            false,
        ),
        (
            "AdroitHandHammer-v1",
            33,
            &[(26, 0.075)],
            hammer.clone(),
            24.322196937166446,
            false,
        ),
        (
            "AdroitHandHammer-v1",
            33,
            &[(26, 0.085)],
            hammer.clone(),
            99.41064474279892,
            true,
        ),
        (
            "AdroitHandHammer-v1",
            33,
            &[(26, 0.085), (28, 0.1)],
            hammer.clone(),
            101.43837686634085,
            true,
        ),
        (
            "AdroitHandHammer-v1",
            33,
            &[(28, -0.03)],
            hammer.clone(),
            -1.384811553679457,
            false,
        ),
        (
            "AdroitHandRelocate-v1",
            36,
            &[],
            ball(0.3, 0.0),
            0.02302589292971099,
            false,
        ),
        (
            "AdroitHandRelocate-v1",
            36,
            &[(32, 0.1)],
            ball(0.3, 0.1),
            0.6870014756330368,
            false,
        ),
        (
            "AdroitHandRelocate-v1",
            36,
            &[(32, 0.1)],
            ball(0.08, 0.1),
            10.871084477699846,
            true,
        ),
        (
            "AdroitHandRelocate-v1",
            36,
            &[(32, 0.1)],
            ball(0.03, 0.1),
            30.903399176834654,
            true,
        ),
        (
            "AdroitHandRelocate-v1",
            36,
            &[],
            ball(0.03, 0.0),
            30.02302589292971,
            true,
        ),
    ];
    for (id, size, numbers, places, reward, success) in cases {
        let mut qpos = vec![0.0; size];
        numbers
            .iter()
            .for_each(|&(index, number)| qpos[index] = number);
        let mut state = places;
        state["qpos"] = json!(qpos);
        state["qvel"] = json!(vec![0.0; size]);
        let mut env = make(id).unwrap();
        env.reset(Reset::seed(1).option("initial_state_dict", state.clone()))
            .unwrap();
        let still = env.action_space().zero().unwrap();
        let step = env.step(&still).unwrap();
        assert!(
            (step.reward - reward).abs() < 1e-12,
            "{id} {state}: {}",
            step.reward
        );
        let told = env.info_map().get("success").and_then(Value::as_bool);
        assert_eq!(told, Some(success), "{id} {state}");
    }
}
