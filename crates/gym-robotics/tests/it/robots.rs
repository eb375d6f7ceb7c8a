//! Fetch, the Shadow hand and the kitchen, whose models are the user's: most of these tests run where the
//! package is installed, or `GYMNASIUM_ROBOTICS_ASSETS` names its folder.

use std::fs;
use std::path::{Path, PathBuf};

use gym_core::{BoxEnv, Env, EnvExt, Error, Value, builder, make, registry};
use gym_robotics::assets;
use serde_json::{Value as Json, json};

use crate::episodes::unlike;

/// The folder of models; `None`, and a line that says so, without the package.
fn models() -> Option<PathBuf> {
    let found = assets::find().filter(|folder| folder.join("hand/reach.xml").is_file());
    if found.is_none() {
        println!("SKIPPED: there are no models of gymnasium-robotics");
    }
    found
}

/// Small models of our own, on which the package plays the same.
const OWN: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/own");

/// The folders of models that are there.
fn folders() -> Vec<PathBuf> {
    std::iter::once(PathBuf::from(OWN))
        .chain(models())
        .collect()
}

/// A folder of this test that does not exist yet.
fn folder(name: &str) -> PathBuf {
    let path = std::env::temp_dir().join(format!("gym-robotics-{name}-{}", std::process::id()));
    let _ = fs::remove_dir_all(&path);
    path
}

fn from(id: &str, assets: &Path) -> Result<BoxEnv, Error> {
    builder(id).arg("assets", assets.to_str().unwrap()).build()
}

fn copy(from: &Path, to: &Path) {
    fs::create_dir_all(to).unwrap();
    for entry in fs::read_dir(from).unwrap() {
        let entry = entry.unwrap();
        let target = to.join(entry.file_name());
        if entry.file_type().unwrap().is_dir() {
            copy(&entry.path(), &target);
        } else {
            fs::copy(entry.path(), target).unwrap();
        }
    }
}

#[test]
fn there_are_65_ids_that_need_models() {
    let needy = registry::all().into_iter();
    let needy: Vec<_> = needy
        .filter(|one| one.source.package == "gym-robotics" && one.needs.is_some())
        .collect();
    assert_eq!(needy.len(), 65);
    let count = |word: &str| needy.iter().filter(|one| one.id().contains(word)).count();
    let counts = ["Fetch", "HandReach", "Block", "Egg", "Pen", "Kitchen"].map(count);
    assert_eq!(counts, [8, 2, 26, 14, 14, 1]);
    assert_eq!(count("TouchSensors"), 32);
}

#[test]
fn a_folder_without_models_says_what_to_install() {
    let nowhere = folder("nowhere");
    for id in ["FetchReach-v4", "HandReach-v3", "FrankaKitchen-v1"] {
        let error = from(id, &nowhere).unwrap_err().to_string();
        assert!(error.contains("there is no file"), "{error}");
        let says = "pip install gymnasium-robotics==1.4.2";
        assert!(
            error.contains(says) && error.contains(assets::VARIABLE),
            "{error}"
        );
    }
}

#[test]
fn episodes_on_models_are_the_packages() {
    if models().is_some() {
        unlike(include_str!("../robots.txt").lines());
    }
}

/// The package plays the same on small models of our own, which are always there.
#[test]
fn episodes_on_small_models_are_the_packages() {
    let lines: Vec<String> = include_str!("../own.txt")
        .lines()
        .map(|line| {
            let (id, rest) = line.split_once(" {").unwrap();
            let comma = if rest.starts_with('}') { "" } else { "," };
            format!("{id} {{\"assets\":{}{comma}{rest}", json!(OWN))
        })
        .collect();
    assert!(lines.len() > 20, "{}", lines.len());
    unlike(lines.iter().map(String::as_str));
}

/// The names of all numbers on those models, by the checksum of a line for each.
#[test]
fn every_number_on_small_models_is_named() {
    let own = Path::new(OWN);
    let mut text = String::new();
    for id in [
        "FetchReach-v4",
        "FetchPush-v4",
        "HandReach-v3",
        "HandManipulateBlock-v1",
        "HandManipulateEgg_BooleanTouchSensors-v1",
        "HandManipulateEgg_ContinuousTouchSensors-v1",
        "FrankaKitchen-v1",
    ] {
        let env = from(id, own).unwrap();
        let names = registry::find(id).unwrap().page.names.unwrap()(&env);
        for name in names.observation.iter().chain(&names.action) {
            text += &format!("{id}: {name}\n");
        }
    }
    assert_eq!(crc32fast::hash(text.as_bytes()), 0x3686_3a86, "{text}");
}

#[test]
fn files_that_are_missing_or_others_are_refused() {
    let Some(models) = models() else { return };
    let own = folder("damaged");
    for part in ["fetch", "stls/fetch", "textures"] {
        copy(&models.join(part), &own.join(part));
    }
    from("FetchReach-v4", &own).unwrap();
    // a file that is no model does not matter
    fs::write(own.join("fetch/notes.txt"), "mine").unwrap();
    from("FetchReach-v4", &own).unwrap();
    let refusal = || from("FetchReach-v4", &own).unwrap_err().to_string();
    let mesh = own.join("stls/fetch/gripper_link.stl");
    let bytes = fs::read(&mesh).unwrap();
    fs::remove_file(&mesh).unwrap();
    let error = refusal();
    assert!(
        error.contains("gripper_link.stl") && error.contains("pip install"),
        "{error}"
    );
    fs::write(&mesh, &bytes[..bytes.len() - 50]).unwrap();
    let error = refusal();
    assert!(error.contains("gripper_link.stl"), "{error}");
    fs::write(&mesh, &bytes).unwrap();
    // another version: a mass, which the model takes
    let robot = own.join("fetch/robot.xml");
    let text = fs::read_to_string(&robot).unwrap();
    fs::write(&robot, text.replace("mass=\"4\"", "mass=\"5\"")).unwrap();
    let error = refusal();
    assert!(
        error.contains("not those of gymnasium-robotics 1.4.2"),
        "{error}"
    );
    fs::remove_dir_all(&own).unwrap();
}

/// Models that no package has: what is wrong with them is found without the package.
#[test]
fn made_up_models_are_refused() {
    let own = folder("made-up");
    let write = |path: &str, text: &str| {
        let path = own.join(path);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    };
    let refused = |id: &str, says: &str| {
        let error = from(id, &own).unwrap_err().to_string();
        let remedies = ["pip install gymnasium-robotics==1.4.2", assets::VARIABLE];
        for says in remedies.into_iter().chain([says]) {
            assert!(error.contains(says), "{id}: {error}");
        }
    };
    let part = r#"<mujoco><include file="shared.xml"/></mujoco>"#;
    write("fetch/reach.xml", part);
    refused("FetchReach-v4", "shared.xml");
    write("fetch/shared.xml", "<mujoco><asset>");
    refused("FetchReach-v4", "shared.xml");
    let mesh =
        r#"<mujoco><asset><mesh name="base" file="../stls/fetch/base.stl"/></asset></mujoco>"#;
    write("fetch/shared.xml", mesh);
    refused("FetchReach-v4", "base.stl");
    write("stls/fetch/base.stl", "solid");
    refused("FetchReach-v4", "base.stl");
    // models that are whole, of a folder that lacks others
    for (id, path, lacks) in [
        ("FetchPush-v4", "fetch/push.xml", "textures"),
        ("HandReach-v3", "hand/reach.xml", "stls/hand"),
        (
            "HandManipulateEgg-v1",
            "hand/manipulate_egg.xml",
            "stls/hand",
        ),
    ] {
        write(path, "<mujoco/>");
        refused(id, lacks);
    }
    write("textures/block.png", "");
    write("stls/hand/F1.stl", "");
    write(
        "kitchen_franka/kitchen_assets/kitchen_env_model.xml",
        "<mujoco/>",
    );
    for id in [
        "FetchPush-v4",
        "HandReach-v3",
        "HandManipulateEgg-v1",
        "FrankaKitchen-v1",
    ] {
        refused(id, "not those of gymnasium-robotics 1.4.2");
    }
    fs::remove_dir_all(&own).unwrap();
}

fn numbers(observation: &Value, key: &str) -> Vec<f64> {
    let part = observation.get(key).unwrap();
    part.as_slice::<f64>().unwrap().to_vec()
}

#[test]
fn a_stored_episode_goes_on_and_its_models_may_move() {
    let moved = folder("moved");
    copy(Path::new(OWN), &moved);
    let elsewhere = [Some(moved.clone()), None];
    for (models, elsewhere) in folders().iter().zip(elsewhere) {
        for id in [
            "FetchPickAndPlace-v4",
            "FetchPush-v4",
            "FetchReachDense-v4",
            "HandReach-v3",
            "HandManipulateEgg_ContinuousTouchSensors-v1",
            "HandManipulatePenRotate-v1",
            "FrankaKitchen-v1",
        ] {
            let mut env = from(id, models).unwrap();
            let mut actions = env.action_sampler(1).unwrap();
            env.reset(5).unwrap();
            for _ in 0..3 {
                env.step(&actions.sample()).unwrap();
            }
            let snapshot = env.snapshot().unwrap();
            let mut clone = env.clone();
            let next = actions.sample();
            let step = env.step(&next).unwrap();
            let mut other = match &elsewhere {
                Some(folder) => from(id, folder).unwrap(),
                None => make(id).unwrap(),
            };
            other.restore(&snapshot).unwrap();
            for other in [&mut other, &mut clone] {
                assert_eq!(other.step(&next).unwrap(), step, "{id}");
                assert_eq!(other.info_map(), env.info_map(), "{id}");
            }
            let first = env.reset(()).unwrap();
            for other in [&mut other, &mut clone] {
                assert_eq!(other.reset(()).unwrap(), first, "{id}");
                assert_eq!(other.info_map(), env.info_map(), "{id}");
            }
        }
    }
    fs::remove_dir_all(&moved).unwrap();
}

#[test]
fn seeds_alone_decide_an_episode() {
    for (folder, id) in folders().iter().flat_map(|folder| {
        let ids = [
            "FetchSlide-v4",
            "HandReach-v3",
            "HandManipulateBlockRotateZ-v1",
            "FrankaKitchen-v1",
        ];
        ids.map(|id| (folder, id))
    }) {
        let mut env = from(id, folder).unwrap();
        let mut actions = env.action_sampler(1).unwrap();
        let action = actions.sample();
        let play = |env: &mut BoxEnv| {
            let first = env.reset(3).unwrap();
            (first, env.info_map(), env.step(&action).unwrap())
        };
        let expected = play(&mut env);
        env.reset(4).unwrap();
        for _ in 0..3 {
            env.step(&actions.sample()).unwrap();
        }
        assert_eq!(play(&mut env), expected, "{id}");
    }
}

#[test]
fn goals_are_rewarded_as_in_the_package() {
    let own = Path::new(OWN);
    let near = |id: &str, x: f64| {
        let env = from(id, own).unwrap();
        let goals = env.goals().unwrap();
        let mut goal = vec![0.0; goals.goal_len()];
        let desired = goal.clone();
        goal[0] = x;
        goals.compute_reward(&goal, &desired)
    };
    assert_eq!(near("FetchReach-v4", 0.04), 0.0);
    assert_eq!(near("FetchReach-v4", 0.06), -1.0);
    assert_eq!(near("FetchReachDense-v4", 0.5), -0.5);
    assert_eq!(near("HandReach-v3", 0.02), -1.0);
    // the package turns the pen about its axis in single rewards, and otherwise in columns
    let env = from("HandManipulatePenRotate-v1", own).unwrap();
    let goals = env.goals().unwrap();
    let (still, turned) = (
        [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0],
        [0.0, 0.0, 0.0, 0.8, 0.0, 0.0, 0.6],
    );
    assert_eq!(goals.compute_reward(&still, &turned), 0.0);
    let mut rewards = [7.0; 4];
    goals
        .compute_rewards(&still.repeat(4), &turned.repeat(4), &mut rewards)
        .unwrap();
    assert_eq!(rewards, [-1.0, -1.0, 0.0, -1.0]);
}

#[test]
fn arguments_that_do_not_fit_say_why() {
    for (id, name, value, says) in [
        (
            "HandReach-v3",
            "initial_qpos",
            json!({"robot0:WRJ9": 0.1}),
            "no joint `robot0:WRJ9`",
        ),
        (
            "HandReach-v3",
            "initial_qpos",
            json!({"robot0:WRJ1": "a"}),
            "give an angle",
        ),
        (
            "HandManipulateEgg-v1",
            "target_rotation",
            json!("fixed"),
            "target_rotation",
        ),
        (
            "FrankaKitchen-v1",
            "tasks_to_complete",
            json!(["sink"]),
            "the tasks are bottom burner",
        ),
        (
            "FrankaKitchen-v1",
            "tasks_to_complete",
            json!([]),
            "at least one",
        ),
        ("FrankaKitchen-v1", "robot_noise_ratio", json!(1e9), "1e6"),
        ("FetchReach-v4", "reward_type", json!("best"), "reward_type"),
    ] {
        let made = builder(id).arg("assets", OWN).arg(name, value).build();
        let error = made.unwrap_err().to_string();
        assert!(
            error.contains(name) && error.contains(says),
            "{id}: {error}"
        );
    }
    let mut env = builder("HandReach-v3")
        .arg("assets", OWN)
        .arg("initial_qpos", json!({"robot0:FFJ2": 0.5}))
        .build()
        .unwrap();
    let seen = numbers(&env.reset(1).unwrap(), "observation");
    assert_eq!((seen[2], seen[3]), (0.0, 0.5));
}

#[test]
fn the_kitchen_counts_what_is_done() {
    // the things begin near some of their goals
    let chores = ["light switch", "slide cabinet"];
    let mut env = builder("FrankaKitchen-v1")
        .arg("assets", OWN)
        .arg("tasks_to_complete", json!(chores))
        .build()
        .unwrap();
    let observation = env.reset(1).unwrap();
    let goal = observation.get("desired_goal").unwrap();
    let Value::Dict(entries) = goal else {
        panic!("{goal}")
    };
    let names: Vec<&str> = entries.iter().map(|(name, _)| &**name).collect();
    assert_eq!(names, chores);
    let list = |env: &BoxEnv, name: &str| match env.info_map().remove(name) {
        Some(Value::Tuple(tasks)) => tasks.len(),
        other => panic!("{other:?}"),
    };
    assert_eq!(list(&env, "tasks_to_complete"), 2);
    // the slide cabinet, pushed to its goal
    let mut state: Json = env.inspect().unwrap().state().unwrap();
    state["qpos"][19] = json!(0.37);
    env.inspect_mut().unwrap().set_state(state).unwrap();
    let step = env.step(&vec![0.0_f64; 9].into()).unwrap();
    assert_eq!((step.reward, step.terminated), (1.0, false));
    let lists = [
        "tasks_to_complete",
        "step_task_completions",
        "episode_task_completions",
    ];
    assert_eq!(lists.map(|name| list(&env, name)), [1, 1, 1]);
    // a task that is done is not rewarded again
    let step = env.step(&vec![0.0_f64; 9].into()).unwrap();
    assert_eq!((step.reward, step.terminated), (0.0, false));
    assert_eq!(lists.map(|name| list(&env, name)), [1, 0, 1]);
}

/// Returns the number of 20 episodes in which the good policy of an environment succeeds.
fn successes(id: &str) -> usize {
    let policy = registry::find(id).unwrap().page.policy.unwrap();
    let mut env = make(id).unwrap();
    let mut succeeds = |seed: u64| {
        let mut seen = env.reset(seed).unwrap();
        let mut act = policy.controller(&env).unwrap().unwrap();
        loop {
            let step = env.step(&act(&env, &seen).unwrap()).unwrap();
            if step.truncated {
                return step.reward == 0.0;
            }
            seen = step.observation;
        }
    };
    (0..20).filter(|seed| succeeds(*seed)).count()
}

#[test]
fn good_policies_succeed() {
    if models().is_some() {
        assert_eq!(
            ["FetchReach-v4", "FetchPickAndPlace-v4"].map(successes),
            [20, 20]
        );
    }
}
