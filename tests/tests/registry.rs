//! Link-time and runtime registration, the listing, and specs.

use gym::classic::{CartPole, Pendulum};
use gym::toytext::FrozenLake;
use gym::{Env, EnvExt, EnvSpec, Error, Registration, Reset, VectorEnvExt, make, registry};

// A second crate that claims a taken id, and a registration with broken arguments.
gym::inventory::submit! { Registration::new::<CartPole>("twice/CartPole-v0").source("first-crate", "", "") }
gym::inventory::submit! { Registration::new::<Pendulum>("twice/CartPole-v0").source("second-crate", "", "") }
gym::register!(Registration::new::<CartPole>("broken/Arguments-v0").kwargs("[1"));

#[test]
fn every_family_is_linked() {
    let ids: Vec<String> = registry::all()
        .iter()
        .map(|registration| registration.id().to_owned())
        .collect();
    for id in [
        "Acrobot-v1",
        "Blackjack-v1",
        "CartPole-v0",
        "CartPole-v1",
        "CliffWalking-v0",
        "CliffWalking-v1",
        "CliffWalkingSlippery-v1",
        "FrozenLake-v1",
        "FrozenLake8x8-v1",
        "MountainCar-v0",
        "MountainCarContinuous-v0",
        "Pendulum-v1",
        "Taxi-v3",
        "Taxi-v4",
    ] {
        assert_eq!(ids.iter().filter(|other| *other == id).count(), 1, "{id}");
    }
}

#[test]
fn the_order_is_that_of_ids() {
    let ids: Vec<registry::EnvId> = registry::all()
        .iter()
        .map(|registration| registration.id().parse().unwrap())
        .collect();
    assert!(ids.is_sorted());
}

#[test]
fn duplicates_are_reported() {
    let error = gym::make("twice/CartPole-v0").unwrap_err();
    assert!(
        matches!(&error, Error::Duplicate { crates, .. } if crates == "first-crate, second-crate"),
        "{error}"
    );
}

#[test]
fn broken_arguments_are_reported() {
    let error = gym::make("broken/Arguments-v0").unwrap_err();
    assert!(error.to_string().contains("not a JSON object"), "{error}");
}

#[test]
fn near_names_of_namespaces() {
    let error = gym::make("twise/CartPole-v0").unwrap_err();
    assert!(
        error.to_string().contains("did you mean `twice`?"),
        "{error}"
    );
    let error = gym::make("twice/CartPol-v0").unwrap_err();
    assert!(
        error
            .to_string()
            .contains("did you mean `twice/CartPole-v0`?"),
        "{error}"
    );
}

#[test]
fn an_old_version_points_to_the_newest() {
    let error = gym::make("LunarLander-v1").unwrap_err();
    assert!(
        matches!(&error, Error::DeprecatedVersion { latest, .. } if latest == "LunarLander-v3"),
        "{error}"
    );
}

#[test]
fn runtime_registration() {
    let lake = || {
        Registration::dynamic::<FrozenLake>("runtime/Lake-v0").kwargs(r#"{"is_slippery": false}"#)
    };
    registry::register(lake().max_episode_steps(9)).unwrap();
    let env = gym::make("runtime/Lake-v0").unwrap();
    let spec = env.spec().unwrap();
    assert_eq!(spec.max_episode_steps, Some(9));
    assert_eq!(spec.kwargs["is_slippery"], false);
    assert!(
        matches!(registry::register(lake()), Err(Error::Registration { .. })),
        "the id is taken"
    );
    let unversioned = Registration::dynamic::<FrozenLake>("runtime/Lake");
    let error = registry::register(unversioned).unwrap_err();
    assert!(
        error.to_string().contains("`runtime/Lake-v0` exists"),
        "{error}"
    );
    let malformed = Registration::dynamic::<FrozenLake>("a b");
    assert!(matches!(
        registry::register(malformed),
        Err(Error::MalformedId(_))
    ));
}

#[test]
fn gymnasiums_own_spec_is_understood() {
    let json = r#"{"id": "CartPole-v1", "entry_point": "gymnasium.envs.classic_control.cartpole:CartPoleEnv",
        "reward_threshold": 475.0, "nondeterministic": false, "max_episode_steps": 500, "order_enforce": true,
        "disable_env_checker": false, "kwargs": {}, "additional_wrappers": [],
        "vector_entry_point": "gymnasium.envs.classic_control.cartpole:CartPoleVectorEnv"}"#;
    let spec: EnvSpec = serde_json::from_str(json).unwrap();
    assert_eq!(spec, gym::make("CartPole-v1").unwrap().spec().unwrap());
    assert_eq!(spec.make().unwrap().spec(), Some(spec));
}

#[test]
fn the_listing_groups_by_family() {
    let text = registry::pretty(3);
    let (classic, rest) = text
        .split_once("===== Toy text: gym-toytext =====")
        .expect("a group per family");
    assert!(
        classic.contains("===== Classic control: gym-classic =====\nAcrobot-v1"),
        "{text}"
    );
    assert!(rest.contains("Taxi-v4"), "{text}");
}

#[test]
fn arguments_reach_the_environment() {
    let env = gym::builder("FrozenLake-v1")
        .arg("map_name", "8x8")
        .build()
        .unwrap();
    assert_eq!(env.observation_space().to_string(), "Discrete(64)");
    assert_eq!(
        env.layer::<FrozenLake>().unwrap().dynamics().p().states(),
        64
    );
    assert!(env.layer::<CartPole>().is_none());
    assert_eq!(
        registry::find("FrozenLake8x8-v1")
            .unwrap()
            .spec()
            .unwrap()
            .kwargs["map_name"],
        "8x8"
    );
}

/// Gymnasium's `make(id, **kwargs)` accepts further arguments in addition to the constructor's.
#[test]
fn arguments_of_make_may_stand_among_the_others() {
    let spec = |json: &str| {
        let kwargs = serde_json::from_str(json).unwrap();
        gym::builder("CartPole-v1")
            .args(kwargs)
            .build()
            .map(|env| env.spec().unwrap())
    };
    assert_eq!(
        spec(r#"{"max_episode_steps": 7}"#)
            .unwrap()
            .max_episode_steps,
        Some(7)
    );
    assert_eq!(
        spec(r#"{"max_episode_steps": -1}"#)
            .unwrap()
            .max_episode_steps,
        None
    );
    assert!(
        spec(r#"{"max_episode_steps": 0}"#)
            .unwrap_err()
            .to_string()
            .contains("at least 1")
    );
    assert!(
        spec(r#"{"disable_env_checker": true}"#)
            .unwrap()
            .disable_env_checker
    );
    let drawn = spec(r#"{"render_mode": "rgb_array_list", "sutton_barto_reward": true}"#).unwrap();
    assert_eq!(
        drawn.render_mode,
        Some(gym::render::RenderMode::RgbArrayList)
    );
    assert_eq!(drawn.kwargs.len(), 1);
}

/// A misspelt reset option is an error if the options are known, and changes nothing.
#[test]
fn reset_options_that_are_not_known_are_refused() {
    let reset = || Reset::seed(1).option("lo", -0.01);
    let mut env = make("CartPole-v1").unwrap();
    let error = env.reset(reset()).unwrap_err().to_string();
    assert_eq!(
        error,
        "invalid argument for reset options of `CartPole-v1`: unknown option `lo`: did you mean `low`? (known are `low`, `high`)"
    );
    for kind in gym::vector::VectorKind::ALL {
        let mut envs = gym::make_vec("CartPole-v1", 2, kind).unwrap();
        let mut columns = envs.columns().unwrap();
        let reset = gym::vector::VectorReset::from(1);
        let error = envs
            .reset_into(&reset.clone().option("lo", -0.01), &mut columns)
            .unwrap_err()
            .to_string();
        assert!(error.contains("did you mean `low`?"), "{kind}: {error}");
        envs.reset_into(&reset.option("low", -0.01), &mut columns)
            .unwrap();
    }
    let error = make("Pendulum-v1")
        .unwrap()
        .reset(Reset::seed(1).option("zzz", 1))
        .unwrap_err()
        .to_string();
    assert!(
        error.contains("unknown option `zzz` (known are `x_init`, `y_init`)"),
        "{error}"
    );
    // as in Gymnasium, for a task without options
    make("Taxi-v4").unwrap().reset(reset()).unwrap();
}

/// Every native vector refuses unknown options as its environments do.
#[test]
fn native_vectors_refuse_unknown_reset_options() {
    let mut modules = std::collections::BTreeSet::new();
    for registration in registry::all() {
        let names = registration.reset_options.0;
        let is_native = registration.vector_entry_point.is_some() && !names.is_empty();
        if !is_native || !modules.insert(registration.source.module) {
            continue;
        }
        let id = registration.id();
        let kind = gym::vector::VectorKind::Native;
        let mut envs = gym::make_vec(id, 2, kind).unwrap();
        let mut columns = envs.columns().unwrap();
        let reset = gym::vector::VectorReset::from(1).option("no_such_option", 1);
        let error = envs.reset_into(&reset, &mut columns).unwrap_err();
        let known = format!("(known are `{}`", names[0].0);
        assert!(error.to_string().contains(&known), "{id}: {error}");
        envs.reset(1).unwrap();
    }
    assert!(modules.len() > 6, "{modules:?}");
}

#[test]
fn an_id_without_its_namespace_is_suggested_with_it() {
    for (asked, meant) in [
        ("Arguments-v0", "did you mean `broken/Arguments-v0`?"),
        ("arguments-v3", "did you mean `broken/Arguments-v0`?"),
        ("runtme/Arguments-v0", "namespace `runtme` not found"),
        ("twice/Arguments-v0", "did you mean `broken/Arguments-v0`?"),
        ("Pong-v5", "`ALE/Pong-v5`"),
        ("CartPol-v1", "did you mean `CartPole-v1`?"),
    ] {
        let error = make(asked).unwrap_err().to_string();
        assert!(error.contains(meant), "{asked}: {error}");
    }
}

/// Only similar names are suggested: names that share at least 60 % of their letters.
#[test]
fn only_what_is_alike_is_suggested() {
    for (asked, is_alike) in [
        ("CarPoll-v1", true),
        ("cartpole-v1", true),
        ("Pole-v1", false),
    ] {
        let error = make(asked).unwrap_err().to_string();
        assert_eq!(
            error.contains("did you mean `CartPole-v1`?"),
            is_alike,
            "{asked}: {error}"
        );
    }
}
