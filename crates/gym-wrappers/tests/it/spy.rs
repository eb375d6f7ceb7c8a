//! Every wrapper forwards every method that it does not implement to the inner environment.

use std::any::{Any, TypeId};
use std::collections::BTreeSet;
use std::sync::{Arc, Mutex};

use gym_core::canvas::{Blank, Canvas};
use gym_core::render::{Frame, Metadata, RenderMode, Rendered};
use gym_core::spaces::{BoxSpace, DictSpace};
use gym_core::{
    Array, BoxEnv, DType, Env, EnvExt, EnvSpec, Generator, Inspect, Outcome, Reset, Result,
    Snapshot, Space, Value, WrapperSpec, registry,
};
use gym_wrappers::*;
use serde_json::{Value as Json, json};

/// An environment that records the names of the methods called on it.
#[derive(Clone)]
pub(super) struct Spy {
    calls: Arc<Mutex<BTreeSet<&'static str>>>,
    observation_space: Space,
    rng: Generator,
}

impl Spy {
    pub(super) fn new(observation_space: impl Into<Space>) -> Self {
        let calls = Arc::default();
        Self {
            calls,
            observation_space: observation_space.into(),
            rng: Generator::from(0),
        }
    }

    fn note(&self, method: &'static str) {
        self.calls.lock().unwrap().insert(method);
    }

    fn observe(&self, observation: &mut Value) {
        *observation = self.observation_space.sampler(0).sample();
    }
}

impl Inspect for Spy {
    fn arguments(&self) -> Json {
        "spy".into()
    }
}

impl Env for Spy {
    type Observation = Value;
    type Action = Value;

    fn observation_space(&self) -> Space {
        self.note("observation_space");
        self.observation_space.clone()
    }

    fn action_space(&self) -> Space {
        self.note("action_space");
        Space::boxed([-1.0], [1.0])
    }

    fn reset_into(&mut self, _reset: &Reset, observation: &mut Value) -> Result<()> {
        self.note("reset_into");
        self.observe(observation);
        Ok(())
    }

    fn step_into(&mut self, _action: &Value, observation: &mut Value) -> Result<Outcome> {
        self.note("step_into");
        self.observe(observation);
        Ok(Outcome::default())
    }

    fn snapshot(&self) -> Result<Snapshot> {
        self.note("snapshot");
        Snapshot::of(&0)
    }

    fn restore(&mut self, _snapshot: &Snapshot) -> Result<()> {
        self.note("restore");
        Ok(())
    }

    fn info(&self, visit: &mut dyn FnMut(&str, Value)) {
        self.note("info");
        visit("spy", Value::Int(7));
    }

    fn metadata(&self) -> Metadata {
        self.note("metadata");
        Metadata {
            render_modes: &[RenderMode::Ansi, RenderMode::RgbArray],
            ..Metadata::default()
        }
    }

    fn draw(&self, _canvas: &mut dyn Canvas) {
        self.note("draw");
    }

    fn ansi(&self) -> Option<String> {
        self.note("ansi");
        Some("spy".into())
    }

    fn depth(&self, _size: (u32, u32)) -> Option<Vec<f32>> {
        self.note("depth");
        Some(vec![1.5])
    }

    fn render_mode(&self) -> Option<RenderMode> {
        self.note("render_mode");
        Some(RenderMode::RgbArray)
    }

    fn render_into(&mut self, rendered: &mut Rendered) -> Result<()> {
        self.note("render_into");
        *rendered = Rendered::Frame(Frame::new(2, 2).unwrap());
        Ok(())
    }

    fn spec(&self) -> Option<EnvSpec> {
        self.note("spec");
        serde_json::from_str(
            r#"{"id": "Spy-v0", "max_episode_steps": 9, "render_mode": "rgb_array"}"#,
        )
        .ok()
    }

    fn frames_drawn(&mut self, count: u64) {
        assert_eq!(count, 3);
        self.note("frames_drawn");
    }

    fn inspect(&self) -> Option<&dyn Inspect> {
        self.note("inspect");
        Some(self)
    }

    fn inspect_mut(&mut self) -> Option<&mut dyn Inspect> {
        self.note("inspect_mut");
        Some(self)
    }

    fn describe(&self) -> String {
        self.note("describe");
        "Spy".into()
    }

    fn visit_layers(&self, visit: &mut dyn FnMut(&'static str)) {
        self.note("visit_layers");
        visit("Spy");
    }

    fn any_layer(&self, _layer: TypeId) -> Option<&dyn Any> {
        self.note("any_layer");
        Some(self)
    }

    fn any_layer_mut(&mut self, _layer: TypeId) -> Option<&mut dyn Any> {
        self.note("any_layer_mut");
        Some(self)
    }

    fn generator(&mut self) -> Option<&mut Generator> {
        self.note("generator");
        Some(&mut self.rng)
    }

    fn close(&mut self) {
        self.note("close");
    }
}

type Call = (&'static str, fn(&mut BoxEnv));

/// A call of each method; `close` comes last.
const CALLS: &[Call] = &[
    ("observation_space", |env| drop(env.observation_space())),
    ("action_space", |env| drop(env.action_space())),
    ("reset_into", |env| drop(env.reset(0).unwrap())),
    ("step_into", |env| {
        let action = env.action_space().sampler(0).sample();
        drop(env.step(&action).unwrap());
    }),
    ("snapshot", |env| drop(env.snapshot().unwrap())),
    ("restore", |env| {
        env.restore(&env.snapshot().unwrap()).unwrap();
    }),
    ("info", |env| {
        assert_eq!(env.info_map()["spy"], Value::Int(7));
    }),
    ("metadata", |env| assert!(env.metadata().render_fps > 0)),
    ("draw", |env| env.draw(&mut Blank)),
    ("ansi", |env| assert_eq!(env.ansi().as_deref(), Some("spy"))),
    ("depth", |env| {
        assert_eq!(env.depth((1, 1)), Some(vec![1.5]));
    }),
    ("render_mode", |env| assert!(env.render_mode().is_some())),
    ("render_into", |env| drop(env.render().unwrap())),
    ("frames_drawn", |env| env.frames_drawn(3)),
    ("inspect", |env| {
        assert_eq!(env.inspect().map(Inspect::arguments), Some("spy".into()));
    }),
    ("inspect_mut", |env| {
        assert!(env.inspect_mut().is_some());
    }),
    ("spec", |env| drop(env.spec())),
    ("describe", |env| assert!(env.describe().contains("Spy"))),
    ("visit_layers", |env| {
        let mut last = "";
        env.visit_layers(&mut |name| last = name);
        assert_eq!(last, "Spy");
    }),
    ("any_layer", |env| assert!(env.layer::<Spy>().is_some())),
    ("any_layer_mut", |env| {
        assert!(env.layer_mut::<Spy>().is_some());
    }),
    ("generator", |env| assert!(env.generator().is_some())),
    ("close", |env| env.close()),
];

/// Returns the methods of the trait `Env`, read from its source.
fn methods() -> BTreeSet<&'static str> {
    let source = include_str!("../../../gym-core/src/env/mod.rs");
    let (_, body) = source.split_once("pub trait Env:").unwrap();
    let (body, _) = body.split_once("\n}\n").unwrap();
    let functions = body.lines().filter_map(|line| line.strip_prefix("    fn "));
    functions
        .map(|line| line.split(['(', '<']).next().unwrap())
        .collect()
}

#[test]
fn every_method_is_called() {
    let called: BTreeSet<_> = CALLS.iter().map(|(method, _)| *method).collect();
    assert_eq!(
        called,
        methods(),
        "a method of `Env` is missing here, or no longer there"
    );
}

/// Returns the wrapper `name` around a spy, and the methods that the wrapper does not forward.
fn wrapped(name: &str, spy: &Spy) -> Option<(BoxEnv, &'static [&'static str])> {
    let spy = || spy.clone();
    let registered = |name: &str, kwargs: serde_json::Value| {
        let kwargs = kwargs.as_object().expect("arguments").clone();
        WrapperSpec {
            name: name.into(),
            kwargs,
        }
        .wrap(BoxEnv::new(spy()))
        .unwrap()
    };
    let seen = ["observation_space"].as_slice();
    let done = ["action_space"].as_slice();
    let pair = |name: &str, low: f64, high: f64| json!({format!("min_{name}"): low, format!("max_{name}"): high});
    let (kwargs, own): (_, &[&str]) = match name {
        "AddRenderObservation"
        | "FlattenObservation"
        | "GrayscaleObservation"
        | "NormalizeObservation"
        | "TimeAwareObservation" => (json!({}), seen),
        "AddWhiteNoise" => (json!({"probability_of_noise_per_pixel": 0.5}), &[]),
        "ObstructView" => (
            json!({"obstructed_pixels_ratio": 0.5, "obstruction_width": 1}),
            &[],
        ),
        "Autoreset"
        | "NormalizeReward"
        | "OrderEnforcing"
        | "PassiveEnvChecker"
        | "RecordEpisodeStatistics"
        | "MaxAndSkipObservation" => (json!({}), &[]),
        "ClipAction" => (json!({}), done),
        "ClipReward" => (pair("reward", 0.0, 1.0), &[]),
        "DelayObservation" => (json!({"delay": 1}), &[]),
        "DiscretizeAction" => (json!({"bins": 3}), done),
        "DiscretizeObservation" => (json!({"bins": 3}), seen),
        "DtypeObservation" => (json!({"dtype": "float64"}), seen),
        "FilterObservation" => (json!({"filter_keys": ["a"]}), seen),
        "FrameStackObservation" => (json!({"stack_size": 2}), seen),
        // (`render` returns the collected frames)
        "RenderCollection" => (json!({}), &["render_into"]),
        "RepeatAction" => (json!({"num_repeats": 2}), &[]),
        "RescaleAction" => (pair("action", -2.0, 2.0), done),
        "RescaleObservation" => (pair("obs", -2.0, 2.0), seen),
        "ReshapeObservation" => (json!({"shape": [1, 2]}), seen),
        "ResizeObservation" => (json!({"shape": [2, 2]}), seen),
        "StickyAction" => (json!({"repeat_action_probability": 0.5}), &[]),
        "TimeLimit" => (json!({"max_episode_steps": 5}), &[]),
        _ => return unregistered(name, &spy()),
    };
    Some((registered(name, kwargs), own))
}

/// Like [`wrapped`], for wrappers that are not registered.
fn unregistered(name: &str, spy: &Spy) -> Option<(BoxEnv, &'static [&'static str])> {
    let spy = || spy.clone();
    Some(match name {
        // (`Render` renders texts with `ansi`, even if the environment renders by itself)
        "Render" => (
            BoxEnv::new(Render::new(spy(), RenderMode::Ansi).unwrap()),
            &["render_mode", "render_into"],
        ),
        // (a function cannot be stored, so there is no spec)
        "TransformAction" => (
            BoxEnv::new(TransformAction::new(spy(), Value::clone, None)),
            &["spec"],
        ),
        "TransformObservation" => (
            BoxEnv::new(TransformObservation::new(spy(), Value::clone, None)),
            &["spec"],
        ),
        "TransformReward" => (
            BoxEnv::new(TransformReward::new(spy(), |reward| reward)),
            &["spec"],
        ),
        "BoxEnv" => (BoxEnv::new(BoxEnv::new(spy())), &[]),
        _ => return None,
    })
}

/// Returns each wrapper's name, a spy, the wrapper around it, and the methods that the wrapper does not forward.
fn every_wrapper() -> Vec<(&'static str, Spy, BoxEnv, &'static [&'static str])> {
    let registered = registry::wrappers().into_iter().map(|wrapper| wrapper.name);
    let unregistered = [
        "Render",
        "TransformAction",
        "TransformObservation",
        "TransformReward",
        "BoxEnv",
    ];
    let names: Vec<_> = registered.chain(unregistered).collect();
    assert!(names.len() >= 33, "{names:?}");
    let wrap = |name| {
        let picture = BoxSpace::uniform(0.0, 255.0, [4, 4, 3], DType::U8).unwrap();
        let spy = match name {
            "GrayscaleObservation" | "ResizeObservation" => Spy::new(picture),
            "FilterObservation" => Spy::new(
                DictSpace::new([("a", Space::discrete(2)), ("b", Space::discrete(3))]).unwrap(),
            ),
            _ => Spy::new(Space::boxed([-1.0, 0.0], [1.0, 1.0])),
        };
        let (env, own) =
            wrapped(name, &spy).unwrap_or_else(|| panic!("`{name}` is not in the list"));
        (name, spy, env, own)
    };
    names.into_iter().map(wrap).collect()
}

/// A window and a box are no wrappers of Gymnasium's.
#[test]
fn every_wrapper_names_itself_around_its_environment() {
    for (name, _, env, _) in every_wrapper() {
        let expected = match name {
            "Render" | "BoxEnv" => "Spy".to_owned(),
            _ => format!("<{name}<Spy>>"),
        };
        assert_eq!(env.describe(), expected);
        let mut layers = Vec::new();
        env.visit_layers(&mut |layer| layers.push(layer));
        let own = layers.strip_suffix(&["Spy"]).expect("the environment");
        assert!(
            own == [name] || (name == "BoxEnv" && own.is_empty()),
            "{layers:?}"
        );
    }
}

/// A snapshot in which a part of a wrapper's state is missing, superfluous or a word is refused, before the environment is
/// restored.
#[test]
fn every_wrapper_refuses_snapshots_that_are_not_its_own() {
    let mut stateful = 0;
    for (name, spy, mut env, _) in every_wrapper() {
        env.reset(0).unwrap();
        env.step(&env.action_space().sampler(0).sample()).unwrap();
        let good = env.snapshot().unwrap();
        let Json::Array(parts) = json!(good) else {
            continue;
        };
        stateful += 1;
        let mut wrong = vec![
            parts[1..].to_vec(),
            parts[..parts.len() - 1].to_vec(),
            [&parts[..], &[json!(0)]].concat(),
        ];
        for i in 1..parts.len() {
            let mut parts = parts.clone();
            parts[i] = json!("none");
            wrong.push(parts);
        }
        for parts in wrong {
            spy.calls.lock().unwrap().clear();
            let snapshot = serde_json::from_value(json!(parts)).unwrap();
            assert!(env.restore(&snapshot).is_err(), "{name}: {parts:?}");
            assert!(
                !spy.calls.lock().unwrap().contains("restore"),
                "{name}: {parts:?}"
            );
            assert_eq!(env.snapshot().unwrap(), good, "{name}: {parts:?}");
        }
        env.restore(&good).unwrap();
    }
    assert!(stateful >= 10, "{stateful}");
}

#[test]
fn every_wrapper_passes_on_what_it_does_not_answer_itself() {
    for (name, spy, mut env, own) in every_wrapper() {
        for (method, call) in CALLS {
            if *method != "reset_into" && *method != "close" {
                env.reset(0).unwrap();
            }
            spy.calls.lock().unwrap().clear();
            call(&mut env);
            let reached = spy.calls.lock().unwrap().contains(method);
            assert_eq!(reached, !own.contains(method), "`{name}` and `{method}`");
        }
    }
}

#[test]
fn wrappers_are_reached_through_boxes() {
    let spy = Spy::new(Space::boxed([-1.0, 0.0], [1.0, 1.0]));
    let env = BoxEnv::new(spy).normalize_observation().unwrap();
    let env = BoxEnv::new(ClipReward::new(env, (0.0, 1.0)).unwrap());
    let mut env = BoxEnv::new(TimeLimit::new(env, 3).unwrap());
    env.reset(0).unwrap();
    env.step(&Value::from([0.0_f32])).unwrap();
    assert_eq!(env.layer::<TimeLimit>().unwrap().elapsed_steps(), 1);
    let normalize = env.layer_mut::<NormalizeObservation>().unwrap();
    let statistics = normalize.statistics().clone();
    assert_eq!((statistics.len(), statistics.count().round()), (2, 2.0));
    normalize.update_running_mean(false);
    env.step(&Value::from([0.0_f32])).unwrap();
    assert_eq!(
        env.layer::<NormalizeObservation>().unwrap().statistics(),
        &statistics
    );
    assert!(env.layer::<Autoreset>().is_none());
    let limit = TimeLimit::new(Autoreset::new(env), 2).unwrap();
    assert!(limit.get_ref().get_ref().layer::<TimeLimit>().is_some());
    assert_eq!(
        limit
            .into_inner()
            .into_inner()
            .layer::<TimeLimit>()
            .unwrap()
            .max_episode_steps(),
        3
    );
    let _: Array = statistics.mean();
}
