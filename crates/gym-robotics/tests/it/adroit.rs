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
