//! Tests of the tasks' arguments in each version, of snapshots, and of users' own models.

use gym_core::{Array, BoxEnv, Env, EnvExt, Value, builder, make, registry};
use gym_mujoco as _;
use serde_json::{Value as Json, json};

fn refusal(id: &str, name: &str, value: Json) -> String {
    let taken = format!("{id} takes {name}: {value}");
    match builder(id).arg(name, value).build() {
        Ok(_) => panic!("{taken}"),
        Err(error) => error.to_string(),
    }
}

#[test]
fn there_are_thirty_nine_ids() {
    let ids: Vec<String> = registry::all()
        .iter()
        .map(|entry| entry.id().to_owned())
        .collect();
    assert_eq!(ids.len(), 39, "{ids:?}");
    for version in ["v2", "v4", "v5"] {
        assert_eq!(ids.iter().filter(|id| id.ends_with(version)).count(), 11);
    }
    assert_eq!(ids.iter().filter(|id| id.ends_with("-v3")).count(), 6);
}

#[test]
fn versions_have_gymnasiums_spaces() {
    // id, numbers observed, numbers of an action and their bound
    for (id, observed, actions, bound) in [
        ("InvertedPendulum-v5", 4, 1, 3.0),
        ("InvertedDoublePendulum-v4", 11, 1, 1.0),
        ("InvertedDoublePendulum-v5", 9, 1, 1.0),
        ("Reacher-v2", 11, 2, 1.0),
        ("Reacher-v5", 10, 2, 1.0),
        ("Pusher-v4", 23, 7, 2.0),
        ("Swimmer-v3", 8, 2, 1.0),
        ("HalfCheetah-v5", 17, 6, 1.0),
        ("Hopper-v5", 11, 3, 1.0),
        ("Walker2d-v5", 17, 6, 1.0),
        ("Ant-v3", 111, 8, 1.0),
        ("Ant-v4", 27, 8, 1.0),
        ("Ant-v5", 105, 8, 1.0),
        ("Humanoid-v4", 376, 17, 0.4),
        ("Humanoid-v5", 348, 17, 0.4),
        ("HumanoidStandup-v2", 376, 17, 0.4),
        ("HumanoidStandup-v5", 348, 17, 0.4),
    ] {
        let env = make(id).unwrap();
        assert_eq!(
            env.observation_space().to_string(),
            format!("Box(-inf, inf, ({observed},), float64)"),
            "{id}"
        );
        assert_eq!(
            env.action_space().to_string(),
            format!("Box(-{bound:.1}, {bound:.1}, ({actions},), float32)"),
            "{id}"
        );
    }
}

#[test]
fn each_version_takes_its_own_arguments() {
    assert!(
        refusal("HalfCheetah-v4", "xml_file", json!("half_cheetah.xml"))
            .contains("unknown argument `xml_file`")
    );
    assert!(refusal("HalfCheetah-v3", "width", json!(100)).contains("ctrl_cost_weight"));
    assert!(refusal("Ant-v5", "use_contact_forces", json!(true)).contains("contact_force_range"));
    assert!(refusal("Ant-v2", "ctrl_cost_weight", json!(1.0)).contains("(known are `mujoco`)"));
    builder("HalfCheetah-v3")
        .arg("xml_file", "half_cheetah.xml")
        .build()
        .unwrap();
    builder("Ant-v4")
        .arg("use_contact_forces", true)
        .build()
        .unwrap();
    builder("Hopper-v5")
        .arg("healthy_z_range", json!([0.5, null]))
        .build()
        .unwrap();
    builder("Ant-v5").arg("main_body", "aux_1").build().unwrap();
}

/// JSON has no infinity and no NaN, but a program can pass them.
#[test]
fn noise_without_bounds_is_refused() {
    for reset_noise_scale in [f64::INFINITY, f64::NAN] {
        let config = gym_mujoco::ant::Config {
            reset_noise_scale,
            ..Default::default()
        };
        let error = gym_mujoco::Ant::new(config).unwrap_err().to_string();
        assert!(error.contains("reset_noise_scale"), "{error}");
    }
}

#[test]
fn bad_arguments_say_what_is_wrong() {
    for (id, name, value, said) in [
        ("Ant-v5", "xml_file", json!("cat.xml"), "humanoid.xml"),
        (
            "Ant-v5",
            "xml_file",
            json!("./no_such_file.xml"),
            "no_such_file.xml",
        ),
        ("Ant-v5", "main_body", json!("tail"), "tail"),
        ("Ant-v5", "main_body", json!(99), "0 to 13"),
        (
            "Ant-v5",
            "main_body",
            json!(-1),
            "the number of a body, counted from 0, or its name",
        ),
        ("Ant-v5", "main_body", json!(14), "0 to 13"),
        ("Ant-v5", "frame_skip", json!(0), "frame_skip"),
        ("Ant-v5", "reset_noise_scale", json!(1e308), "within ±1e9"),
        (
            "Walker2d-v3",
            "reset_noise_scale",
            json!(-1e10),
            "within ±1e9",
        ),
        (
            "HalfCheetah-v5",
            "forward_reward_weight",
            json!(-1e308),
            "within ±1e100",
        ),
        ("Ant-v5", "healthy_reward", json!(1e101), "within ±1e100"),
        ("Ant-v5", "camera_name", json!("none"), "track"),
        ("Ant-v5", "camera_id", json!(7), "1 cameras"),
        ("Ant-v5", "keyframe", json!("home"), "has no keyframe"),
        ("Ant-v4", "keyframe", json!("home"), "unknown argument"),
        (
            "Ant-v5",
            "healthy_z_range",
            json!([1.0, 0.2]),
            "healthy_z_range",
        ),
        (
            "Ant-v5",
            "default_camera_config",
            json!({"distance": -1.0}),
            "distance",
        ),
        ("Reacher-v5", "xml_file", json!("pusher.xml"), "fingertip"),
        (
            "InvertedDoublePendulum-v5",
            "xml_file",
            json!("swimmer.xml"),
            "sites",
        ),
    ] {
        let message = refusal(id, name, value);
        assert!(message.contains(said), "{id} {name}: {message}");
    }
}

/// A model with one hinge fewer than a task needs is refused with both numbers; one with as many may
/// be refused for another reason only, or takes steps.
#[test]
fn a_model_that_is_too_small_says_how_much_a_task_needs() {
    let chain = |hinges: usize| {
        let body = r#"<body><joint name="NAME"/><geom size="0.1"/>"#;
        let bodies: String = (0..hinges)
            .map(|i| body.replace("NAME", &i.to_string()))
            .collect();
        let motors: String = (0..hinges)
            .map(|i| format!(r#"<motor joint="{i}" ctrlrange="-1 1"/>"#))
            .collect();
        let ends = "</body>".repeat(hinges);
        // (cameras follow one of the first bodies)
        let still = r#"<body><geom size="0.1"/></body>"#;
        json!(format!(
            "<mujoco><worldbody>{still}{still}{bodies}{ends}</worldbody><actuator>{motors}</actuator></mujoco>"
        ))
    };
    for (id, what, needed) in [
        ("Ant-v5", "positions", 3),
        ("HalfCheetah-v5", "positions", 1),
        ("Hopper-v5", "positions", 3),
        ("Humanoid-v5", "positions", 3),
        ("HumanoidStandup-v5", "positions", 3),
        ("InvertedDoublePendulum-v5", "degrees of freedom", 3),
        ("InvertedPendulum-v5", "positions", 2),
        ("Pusher-v5", "positions", 11),
        ("Reacher-v5", "positions", 4),
        ("Swimmer-v5", "positions", 2),
        ("Walker2d-v5", "positions", 3),
    ] {
        for hinges in 0..needed {
            let said = refusal(id, "xml_file", chain(hinges));
            let reason = format!("the model has {hinges} {what}, the task needs {needed}");
            assert!(said.ends_with(&reason), "{id}: {said}");
        }
        match builder(id).arg("xml_file", chain(needed)).build() {
            Err(error) => assert!(!error.to_string().contains(what), "{id}: {error}"),
            Ok(mut env) => {
                env.reset(0).unwrap();
                play(&mut env, 0, 3);
            }
        }
    }
}

#[test]
fn files_of_users_are_models() {
    let folder = std::env::temp_dir().join(format!("gym-mujoco-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let path = folder.join("lizard.xml");
    let text = "<mujoco><worldbody><body><joint type=\"slide\" axis=\"1 0 0\" name=\"x\"/><geom size=\"0.1\"/></body></worldbody>\
                <actuator><motor joint=\"x\" ctrlrange=\"-2 2\"/></actuator></mujoco>";
    std::fs::write(&path, text).unwrap();
    let mut env = builder("HalfCheetah-v5")
        .arg("xml_file", path.to_str().unwrap())
        .build()
        .unwrap();
    assert_eq!(
        env.action_space().to_string(),
        "Box(-2.0, 2.0, (1,), float32)"
    );
    env.reset(0).unwrap();
    let step = env.step(&Value::Array(Array::from([1.0f32]))).unwrap();
    assert!(step.reward.is_finite());
    std::fs::remove_dir_all(&folder).unwrap();
}

fn play(env: &mut BoxEnv, seed: u64, steps: usize) -> Vec<f64> {
    let mut actions = env.action_sampler(seed).unwrap();
    let mut seen = Vec::new();
    for _ in 0..steps {
        let step = env.step(&actions.sample()).unwrap();
        seen.push(step.reward);
        seen.extend(step.observation.as_slice::<f64>().unwrap());
    }
    seen
}

#[test]
fn a_snapshot_in_mid_contact_continues_bit_for_bit() {
    for id in [
        "HalfCheetah-v5",
        "Ant-v5",
        "Humanoid-v5",
        "Pusher-v5",
        "InvertedDoublePendulum-v4",
    ] {
        let mut env = builder(id).build().unwrap();
        env.reset(5).unwrap();
        play(&mut env, 1, 12);
        let text = serde_json::to_string(&env.snapshot().unwrap()).unwrap();
        let mut other = make(id).unwrap();
        other
            .restore(&serde_json::from_str(&text).unwrap())
            .unwrap();
        assert_eq!(play(&mut env, 2, 8), play(&mut other, 2, 8), "{id}");
    }
}

#[test]
fn a_snapshot_holds_states_alone() {
    for task in registry::all()
        .into_iter()
        .filter(|entry| entry.id().ends_with("-v5"))
    {
        let mut env = make(task.id()).unwrap();
        env.reset(5).unwrap();
        play(&mut env, 1, 12);
        let model = env
            .layer::<gym_sim::SimEnv>()
            .map(|env| env.simulation().model.clone())
            .expect("a task");
        let text = serde_json::to_value(env.snapshot().unwrap()).unwrap();
        // a snapshot has the state, the state at the start of the last step, the generator's state,
        // and the results of the step
        let states = 2 * (model.nq() + 2 * model.nv() + model.nu() + 1);
        let held = numbers(&text);
        assert!(
            held >= states && held < states + 60,
            "{}: {held} numbers for {states}",
            task.id()
        );
    }
}

/// Returns the number of numbers in `json`.
fn numbers(json: &Json) -> usize {
    match json {
        Json::Number(_) => 1,
        Json::Array(all) => all.iter().map(numbers).sum(),
        Json::Object(all) => all.values().map(numbers).sum(),
        _ => 0,
    }
}

#[test]
fn a_state_that_was_set_is_seen_at_once_and_gone_on_from() -> gym_core::Result<()> {
    use gym_sim::SimEnv;

    let mut env = make("Hopper-v5")?;
    let early = env
        .layer_mut::<SimEnv>()
        .expect("a Hopper")
        .set_state(&[0.0; 6], &[0.0; 6]);
    let message = "cannot call `set_state` before `reset`: call `env.reset(seed)` first";
    assert_eq!(early.unwrap_err().to_string(), message);
    env.reset(1)?;
    let mut twin = env.clone();
    let action = env.action_sampler(0)?.sample();
    twin.step(&action)?;
    let (qpos, qvel) = {
        let data = twin
            .layer::<SimEnv>()
            .and_then(|env| env.data())
            .expect("an episode");
        (data.qpos.clone(), data.qvel.clone())
    };
    let simulated = env.layer_mut::<SimEnv>().expect("a Hopper");
    for (qpos, qvel, message) in [
        (
            &qpos[1..],
            &qvel[..],
            "qpos: the model has 6 numbers, not 5",
        ),
        (&qpos, &[f64::NAN; 6], "qvel: NaN is not within ±1e10"),
        (&qpos, &[-2e10; 6], "qvel: -20000000000 is not within ±1e10"),
    ] {
        let error = simulated.set_state(qpos, qvel).unwrap_err().to_string();
        assert!(error.contains(message), "{error}");
    }
    simulated.set_state(&qpos, &qvel)?;
    let data = simulated.data().expect("an episode");
    assert_eq!((&data.qpos, &data.qvel), (&qpos, &qvel));
    let torso = simulated
        .simulation()
        .model
        .body_id("torso")
        .expect("a torso");
    assert_eq!(data.xpos[torso][0], qpos[0], "positions of bodies follow");
    // the solver starts from other accelerations, and finds the same forces up to rounding
    let (Value::Array(a), Value::Array(b)) = (
        env.step(&action)?.observation,
        twin.step(&action)?.observation,
    ) else {
        panic!("observations are arrays")
    };
    assert!(
        a.iter_f64()
            .zip(b.iter_f64())
            .all(|(a, b)| (a - b).abs() < 1e-12),
        "{a:?} for {b:?}"
    );
    Ok(())
}

/// Versions start at 2. A version above the newest version has the newest version's rules.
#[test]
fn versions_that_never_were_are_refused() {
    use gym_mujoco::Ant;
    for version in [0, 1] {
        let error = Ant::with_version(Default::default(), version)
            .unwrap_err()
            .to_string();
        let expected = format!("version {version} does not exist: set 2 to 5");
        assert!(error.contains(&expected), "{error}");
    }
    let length = |version| {
        let env = Ant::with_version(Default::default(), version).unwrap();
        env.observation_space().shape().unwrap()[0]
    };
    assert_eq!([2, 3, 4, 5, 6].map(length), [111, 111, 27, 105, 105]);
}

/// Returns the default value of the argument `mujoco`.
fn default_version(id: &str) -> Json {
    let arguments = registry::find(id).unwrap().arguments().unwrap();
    let mut named = arguments
        .iter()
        .filter(|argument| argument.name == "mujoco");
    named.next().expect("the argument").default.clone()
}

#[test]
fn every_id_takes_a_version_of_mujoco() {
    for registration in registry::all() {
        let id = registration.id();
        let old = id.ends_with("-v2") || id.ends_with("-v3") || id == "Pusher-v4";
        assert_eq!(
            default_version(id),
            if old { "3.12" } else { "4.0" },
            "{id}"
        );
        let message = refusal(id, "mujoco", json!("3.14"));
        assert!(
            message.contains("there is no MuJoCo version \"3.14\"")
                && message.contains("\"3.12\" (also 3.11, 3.13")
                && message.contains("\"3.17\" (also 3.17.0), \"4.0\" (also 4.0.0), \"4.0.1\""),
            "{message}"
        );
    }
}

#[test]
fn versions_with_other_names_have_the_same_numbers() {
    let numbers = |version: Option<&str>| {
        let mut builder = builder("Ant-v5");
        if let Some(version) = version {
            builder = builder.arg("mujoco", version);
        }
        let mut env = builder.build().unwrap();
        env.reset(3).unwrap();
        let seen = play(&mut env, 1, 20);
        seen.into_iter().map(f64::to_bits).collect::<Vec<_>>()
    };
    let (old, new) = (numbers(Some("3.12")), numbers(Some("4.0")));
    assert_ne!(old, new);
    for version in ["3.11", "3.12.0", "3.13.0"] {
        assert_eq!(numbers(Some(version)), old, "{version}");
    }
    // 4.0.1 differs where the side of a cylinder lies on a face
    for version in [None, Some("4.0.0"), Some("4.0.1")] {
        assert_eq!(numbers(version), new, "{version:?}");
    }
}

#[test]
fn a_snapshot_of_another_version_of_mujoco_is_refused() {
    let made = |version: &str| builder("Hopper-v5").arg("mujoco", version).build().unwrap();
    for (taken, other) in [("3.12", "4.0"), ("4.0", "3.12")] {
        let mut env = made(taken);
        env.reset(5).unwrap();
        play(&mut env, 1, 5);
        let snapshot = env.snapshot().unwrap();
        let mut refuses = made(other);
        refuses.reset(6).unwrap();
        let before = refuses.snapshot().unwrap();
        let error = refuses.restore(&snapshot).unwrap_err().to_string();
        let said = format!(
            "of MuJoCo {taken}, and this one is of MuJoCo {other}: restore it into an environment made with mujoco=\"{taken}\""
        );
        assert!(error.contains(&said), "{error}");
        assert_eq!(refuses.snapshot().unwrap(), before);
        made(taken).restore(&snapshot).unwrap();
        // if another argument differs, the error does not name the version
        let mut wide = builder("Hopper-v5").arg("frame_skip", 3).build().unwrap();
        let error = wide.restore(&made("4.0").snapshot().unwrap()).unwrap_err();
        assert!(error.to_string().contains("other arguments"), "{error}");
    }
}

/// A model for HalfCheetah's task, which needs little, with keyframes.
const KEYED: &str = r#"<mujoco><worldbody><geom type="plane" size="9 9 1"/><body pos="0 0 1"><joint type="slide" axis="1 0 0"/>
    <joint type="slide" axis="0 0 1"/><joint name="knee" axis="0 1 0"/><geom size=".1"/></body></worldbody>
    <actuator><motor joint="knee"/></actuator>
    <keyframe><key name="home" qpos=".5 .25 1" qvel="0 -.5 0"/><key qpos="0 .75 2"/></keyframe></mujoco>"#;

#[test]
fn an_episode_starts_at_a_keyframe() {
    let start = |key: Option<&str>, scale: f64, seed: u64| {
        let mut builder = builder("HalfCheetah-v5")
            .arg("xml_file", KEYED)
            .arg("reset_noise_scale", scale)
            .arg("exclude_current_positions_from_observation", false);
        if let Some(key) = key {
            builder = builder.arg("keyframe", key);
        }
        let seen = builder.build().unwrap().reset(seed).unwrap();
        let Value::Array(seen) = seen else {
            panic!("{seen:?}")
        };
        seen.iter_f64().collect::<Vec<_>>()
    };
    assert_eq!(
        start(Some("home"), 0.0, 1),
        [0.5, 0.25, 1.0, 0.0, -0.5, 0.0]
    );
    assert_eq!(start(Some("1"), 0.0, 1), [0.0, 0.75, 2.0, 0.0, 0.0, 0.0]);
    assert_eq!(start(None, 0.0, 1), [0.0; 6]);
    // the noise is that of an episode without keyframes
    let (noise, home) = (start(None, 0.1, 7), start(Some("home"), 0.1, 7));
    assert!(noise.iter().all(|x| *x != 0.0), "{noise:?}");
    let base = [0.5, 0.25, 1.0, 0.0, -0.5, 0.0];
    let sums: Vec<f64> = base.iter().zip(&noise).map(|(x, of)| x + of).collect();
    assert_eq!(home, sums);
    let arguments = [("xml_file", json!(KEYED)), ("keyframe", json!("away"))];
    let builder = arguments
        .into_iter()
        .fold(builder("HalfCheetah-v5"), |of, (name, x)| of.arg(name, x));
    let error = builder.build().map(drop).unwrap_err().to_string();
    assert!(
        error.contains(r#""away": the model has home, 1"#),
        "{error}"
    );
}
