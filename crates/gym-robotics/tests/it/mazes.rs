//! Mazes: maps, reset options, goals, snapshots, vectors.

use gym_core::vector::{Autoreset, Columns, VectorKind};
use gym_core::{BoxEnv, Env, EnvExt, Error, Reset, Value, VectorEnvExt, builder, make, registry};
use gym_robotics as _;
use serde_json::{Value as Json, json};

fn with(id: &str, map: Json) -> Result<BoxEnv, Error> {
    builder(id).arg("maze_map", map).build()
}

fn refusal(id: &str, map: Json) -> String {
    with(id, map).unwrap_err().to_string()
}

fn numbers(observation: &Value, key: &str) -> Vec<f64> {
    observation
        .get(key)
        .unwrap()
        .as_slice::<f64>()
        .unwrap()
        .to_vec()
}

/// The row and the column of a place in PointMaze, of a maze with so many rows and columns.
fn cell(place: &[f64], [rows, columns]: [f64; 2]) -> [f64; 2] {
    [
        (rows / 2.0 - place[1]).floor(),
        (place[0] + columns / 2.0).floor(),
    ]
}

#[test]
fn a_map_on_which_no_episode_can_start_says_what_to_do() {
    let id = "PointMaze_UMaze-v3";
    for (map, says) in [
        (json!([]), "no cells"),
        (json!([[]]), "no cells"),
        (
            json!([[1]]),
            "no cell may be the goal: mark one \"g\", \"c\" or 0",
        ),
        (json!([[0]]), "mark another cell \"r\" or \"c\""),
        (json!([["c"]]), "mark another cell \"r\" or \"c\""),
        (
            json!([["g", 1]]),
            "no cell may be the start: mark one \"r\"",
        ),
        (json!([["r", 1]]), "no cell may be the goal"),
        (json!([["c", "g", 0]]), "mark another cell \"r\" or \"c\""),
        (json!([[0, 0], [0]]), "row 1 has 1 cells and row 0 has 2"),
        (
            json!([[0, 2]]),
            "row 0, column 1 is 2: it is 0 (free), 1 (a wall)",
        ),
        (json!([[0, null]]), "row 0, column 1 is null"),
        (json!(7), "maze_map"),
        (
            json!(vec![vec![0; 101]; 100]),
            "10100 cells: give at most 10000",
        ),
        (
            json!(vec![vec![1; 100]; 100]),
            "10000 walls: give at most 950",
        ),
    ] {
        let error = refusal(id, map.clone());
        assert!(error.contains(says), "{map}: {error}");
    }
}

#[test]
fn a_large_map_can_be_played() {
    let mut map = vec![vec![0; 100]; 100];
    map[..9].fill(vec![1; 100]);
    let mut env = with("PointMaze_UMaze-v3", json!(map)).unwrap();
    env.reset(1).unwrap();
    env.step(&vec![1.0_f32, -1.0].into()).unwrap();
}

#[test]
fn a_map_with_letters_of_one_kind_uses_all_free_cells_for_the_other() {
    let mut env = with("PointMaze_UMaze-v3", json!([["g", 1, 0]])).unwrap();
    for seed in 0..4 {
        let observation = env.reset(seed).unwrap();
        assert_eq!(
            cell(&numbers(&observation, "desired_goal"), [1.0, 3.0]),
            [0.0, 0.0]
        );
        assert_eq!(
            cell(&numbers(&observation, "achieved_goal"), [1.0, 3.0]),
            [0.0, 2.0]
        );
    }
    // AntMaze-v3 does not
    assert!(with("AntMaze_UMaze-v4", json!([["g", 1, 0]])).is_ok());
    let error = refusal("AntMaze_UMaze-v3", json!([["g", 1, 0]]));
    assert!(error.contains("no cell may be the start"), "{error}");
}

#[test]
fn reset_options_place_goal_and_ball() {
    let mut env = make("PointMaze_Medium-v3").unwrap();
    let reset = Reset::seed(3)
        .option("goal_cell", json!([1, 6]))
        .option("reset_cell", json!([6, 1]));
    let observation = env.reset(reset).unwrap();
    assert_eq!(
        cell(&numbers(&observation, "desired_goal"), [8.0, 8.0]),
        [1.0, 6.0]
    );
    assert_eq!(
        cell(&numbers(&observation, "achieved_goal"), [8.0, 8.0]),
        [6.0, 1.0]
    );
    env.reset(Reset::seed(3).option("goal_cell", Json::Null))
        .unwrap();
}

#[test]
fn a_bad_reset_option_changes_nothing() {
    let mut env = make("PointMaze_UMaze-v3").unwrap();
    env.reset(1).unwrap();
    let before = env.snapshot().unwrap();
    for (cell, says) in [
        (json!([0, 1]), "is a wall"),
        (json!([5, 1]), "is outside of the maze"),
        (json!([-1, 1]), "is not a cell"),
        (json!([1]), "is not a cell"),
        (json!([1, 1, 1]), "is not a cell"),
        (json!("c"), "is not a cell"),
        (json!([1.5, 1]), "is not a cell"),
    ] {
        for name in ["goal_cell", "reset_cell"] {
            let error = env
                .reset(Reset::seed(2).option(name, cell.clone()))
                .unwrap_err();
            let error = error.to_string();
            assert!(error.contains(name) && error.contains(says), "{error}");
            assert!(error.contains("5 rows and 5 columns"), "{error}");
        }
    }
    assert_eq!(env.snapshot().unwrap(), before);
    // the only start, given as the goal's cell
    let mut env = with("PointMaze_UMaze-v3", json!([["r", "g", "g"]])).unwrap();
    let error = env.reset(Reset::seed(1).option("goal_cell", json!([0, 0])));
    assert!(
        error
            .unwrap_err()
            .to_string()
            .contains("give `reset_cell` too")
    );
}

/// Pushes the ball to the goal, which lies to the right, and returns the steps after the start.
fn reach(env: &mut BoxEnv) -> Vec<(Vec<f64>, f64, bool, Option<bool>)> {
    env.reset(
        Reset::seed(5)
            .option("goal_cell", json!([0, 2]))
            .option("reset_cell", json!([0, 0])),
    )
    .unwrap();
    let mut steps: Vec<(Vec<f64>, f64, bool, Option<bool>)> = Vec::new();
    while steps
        .last()
        .is_none_or(|(.., success)| *success != Some(true))
    {
        assert!(steps.len() < 500);
        let step = env.step(&vec![1.0_f32, 0.0].into()).unwrap();
        let success = env.info_map().get("success").and_then(Value::as_bool);
        let goal = numbers(&step.observation, "desired_goal");
        steps.push((goal, step.reward, step.terminated, success));
    }
    steps
}

#[test]
fn a_continuing_task_keeps_or_renews_its_goal() {
    let map = json!([["c", "c", "c", "c"]]);
    let play = |continuing: bool, renews: bool| {
        let builder = builder("PointMaze_UMaze-v3").arg("maze_map", map.clone());
        let builder = builder
            .arg("continuing_task", continuing)
            .arg("reset_target", renews);
        let mut env = builder.build().unwrap();
        let steps = reach(&mut env);
        let (goal, reward, terminated, _) = steps.last().unwrap().clone();
        assert_eq!((reward, terminated), (1.0, !continuing));
        assert!(
            steps[..steps.len() - 1]
                .iter()
                .all(|(_, reward, ..)| *reward == 0.0)
        );
        // a stored episode has the next goal
        let snapshot = env.snapshot().unwrap();
        let next = env.step(&vec![0.0_f32; 2].into()).unwrap();
        env.restore(&snapshot).unwrap();
        assert_eq!(
            env.info_map().get("success").and_then(Value::as_bool),
            Some(true)
        );
        assert_eq!(env.step(&vec![0.0_f32; 2].into()).unwrap(), next);
        numbers(&next.observation, "desired_goal") == goal
    };
    assert!(play(true, false), "the goal stays");
    assert!(!play(true, true), "the goal changes after the step");
    assert!(play(false, true), "the episode has ended");
}

/// A ball that reaches the goal in a vector gets another one there too.
#[test]
fn a_vector_steps_as_its_environments() {
    let spec = |id: &str| builder(id).arg("reset_target", true);
    for id in ["PointMaze_OpenDense-v3", "AntMaze_Open_Diverse_GR-v5"] {
        let mut alone: Vec<BoxEnv> = (0..5).map(|_| spec(id).build().unwrap()).collect();
        let mut vector = spec(id).vector(5).kind(VectorKind::Native).build().unwrap();
        vector.reset(7).unwrap();
        for (seed, env) in (7..).zip(&mut alone) {
            env.reset(seed).unwrap();
        }
        let mut actions = vector.action_sampler(1).unwrap();
        for step in 0..60 {
            let actions = actions.sample();
            let seen = vector.step(&actions).unwrap();
            let rows = actions.as_slice::<f32>().unwrap();
            for (index, (env, row)) in alone
                .iter_mut()
                .zip(rows.chunks(rows.len() / 5))
                .enumerate()
            {
                let expected = env.step(&row.to_vec().into()).unwrap();
                assert_eq!(seen.rewards[index], expected.reward, "{id}, step {step}");
                for key in ["observation", "achieved_goal", "desired_goal"] {
                    let numbers = |seen: &Value| numbers(seen, key);
                    let (all, own) = (numbers(&seen.observations), numbers(&expected.observation));
                    assert_eq!(
                        all[index * own.len()..][..own.len()],
                        own,
                        "{id}, step {step}"
                    );
                }
            }
        }
    }
}

#[test]
fn a_goal_is_asked_for_through_wrappers() {
    let env = make("PointMaze_UMazeDense-v3").unwrap();
    let goals = env.goals().unwrap();
    assert_eq!(goals.goal_len(), 2);
    assert_eq!(goals.compute_reward(&[0.0, 0.0], &[0.0, 0.0]), 1.0);
    let error = goals
        .compute_rewards(&[0.0; 4], &[0.0; 3], &mut [0.0; 2])
        .unwrap_err();
    assert!(error.to_string().contains("desired_goal"), "{error}");
}

#[test]
fn an_ant_of_a_file_that_cannot_be_read_is_refused() {
    let refused = |xml_file: &str| {
        let made = builder("AntMaze_UMaze-v5").arg("xml_file", json!(xml_file));
        made.build().unwrap_err().to_string()
    };
    assert!(refused("no_ant.xml").contains("a file's path begins with"));
    assert!(refused("./no_ant.xml").contains("give the path of a model in MJCF"));
    #[cfg(unix)]
    assert!(refused("/dev/zero").contains("not a regular file"));
}

/// The worlds of a native vector step together, with the bits of those of a sync one.
#[test]
fn native_vectors_have_the_bits_of_sync_ones() {
    let bits = |columns: &Columns| {
        let parts = ["observation", "achieved_goal", "desired_goal"];
        let parts = parts.map(|part| numbers(&columns.observations, part));
        let all = parts.iter().flatten().chain(&columns.rewards);
        all.map(|x| x.to_bits()).collect::<Vec<_>>()
    };
    for id in [
        "PointMaze_UMazeDense-v3",
        "AntMaze_UMazeDense-v5",
        "AntMaze_UMaze-v3",
    ] {
        for (n, mujoco, mode) in [
            (1, "4.0", Autoreset::NextStep),
            (7, "3.12", Autoreset::SameStep),
            (8, "4.0", Autoreset::SameStep),
            (9, "3.12", Autoreset::NextStep),
            (67, "4.0", Autoreset::NextStep),
        ] {
            let make = |kind| {
                let spec = builder(id).arg("mujoco", mujoco).max_episode_steps(30);
                let envs = spec.vector(n).autoreset(mode).kind(kind).build();
                envs.unwrap()
            };
            let mut vectors = [VectorKind::Native, VectorKind::Sync].map(make);
            let mut columns = vectors.each_mut().map(|envs| envs.reset(8).unwrap());
            let mut actions = vectors[0].action_sampler(3).unwrap();
            for step in 0..80.min(800 / n) {
                let batch = actions.sample();
                for (envs, columns) in vectors.iter_mut().zip(&mut columns) {
                    envs.step_into(&batch, columns).unwrap();
                }
                let [native, sync] = columns.each_ref().map(bits);
                assert!(native == sync, "{id}, {n}, {mujoco}, {mode:?}, step {step}");
                assert_eq!(columns[0].terminated, columns[1].terminated);
                assert_eq!(columns[0].truncated, columns[1].truncated);
            }
        }
    }
}

#[test]
fn the_good_policy_steers_to_every_goal() {
    for id in ["UMaze", "Medium", "Large", "Open_Diverse_GR"] {
        let id = format!("PointMaze_{id}-v3");
        let policy = registry::find(&id).unwrap().page.policy.unwrap();
        let mut env = builder(&id).arg("continuing_task", false).build().unwrap();
        for seed in 0..5 {
            let mut seen = env.reset(seed).unwrap();
            let mut act = policy.controller(&env).unwrap().unwrap();
            loop {
                let step = env.step(&act(&env, &seen).unwrap()).unwrap();
                assert!(!step.truncated, "{id}, seed {seed}: {seen}");
                if step.terminated {
                    break;
                }
                seen = step.observation;
            }
        }
    }
}
