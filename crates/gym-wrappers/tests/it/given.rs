//! Values in other forms than those of the spaces: observations and actions of other kinds, types and
//! lengths, each with its result or its refusal; and arguments in the forms of Rust and JSON.
//!
//! After an intended change, read what differs, and store it with
//! `GYM_UPDATE_KEPT=1 cargo test --package gym-wrappers --test it given`.

use std::collections::BTreeSet;
use std::fmt::Write;
use std::path::Path;

use gym_core::spaces::{BoxSpace, DictSpace, MultiDiscrete, TextSpace, TupleSpace};
use gym_core::vector::SyncVectorEnv;
use gym_core::{
    Array, BoxEnv, DType, Data, Env, EnvExt, Result, Space, Value, VectorEnv, VectorEnvExt,
};
use gym_testing::kept;
use gym_wrappers::{
    Bound, DtypeObservation, RescaleObservation, VectorWrap, Wrap, clip_reward, rescale_action,
    rescale_observation,
};
use serde_json::{Value as Json, json};

use crate::around::{Echo, WRAPPERS, spaces, spec, sum};

fn boxed(low: f64, high: f64, shape: &[usize], dtype: DType) -> Space {
    BoxSpace::uniform(low, high, shape, dtype).unwrap().into()
}

fn array(dtype: DType, numbers: &[f64]) -> Value {
    let data = Data::from_f64(dtype, numbers.iter().copied());
    Array::new([numbers.len()], data).unwrap().into()
}

fn numbers(value: &Value) -> Vec<f64> {
    match value {
        Value::Tuple(items) => items.iter().flat_map(numbers).collect(),
        Value::Array(array) => array.iter_f64().collect(),
        Value::Int(i) => vec![*i as f64],
        value => vec![value.as_float().unwrap()],
    }
}

/// Spaces whose elements an environment shows that claims another one.
fn others() -> Vec<Space> {
    let line = |key: &str| (key.to_owned(), boxed(-1.0, 1.0, &[2], DType::F32));
    vec![
        boxed(-1.0, 3.0, &[3], DType::F32),
        boxed(-1.0, 3.0, &[2], DType::F64),
        boxed(0.0, 9.0, &[3], DType::U8),
        boxed(0.0, 255.0, &[4, 6, 3], DType::U8),
        boxed(0.0, 255.0, &[72], DType::U8),
        boxed(0.0, 255.0, &[6, 4], DType::U8),
        boxed(-1.0, 1.0, &[0], DType::F32),
        Space::discrete(50),
        MultiDiscrete::new([3]).unwrap().into(),
        TextSpace::new(1, 3).unwrap().into(),
        TupleSpace::new([boxed(-1.0, 1.0, &[2], DType::F32)]).into(),
        DictSpace::new([line("a"), line("time")]).unwrap().into(),
        DictSpace::new([line("b")]).unwrap().into(),
    ]
}

/// The refusals of an environment's results.
fn refusals(results: &[Result<String>], told: &mut BTreeSet<String>) {
    told.extend(
        results
            .iter()
            .filter_map(|result| Some(result.as_ref().err()?.to_string())),
    );
}

/// The sum of a wrapper's results, and the first two of its refusals, which the sum has too.
fn line(name: &str, kwargs: &str, all: &[String], refused: &BTreeSet<String>) -> String {
    let mut line = format!("{name} {kwargs} {}\n", sum(all));
    for text in refused.iter().take(2) {
        writeln!(line, "  {text}").unwrap();
    }
    line
}

fn keep(name: &str, told: &str) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/it");
    kept(&folder.join(name), told);
}

#[test]
fn observations_that_are_not_of_their_space_are_shown_or_refused_as_they_were() {
    let mut told = String::new();
    for (name, cases) in WRAPPERS {
        for kwargs in *cases {
            let (mut all, mut refused) = (Vec::new(), BTreeSet::new());
            for space in spaces() {
                for shown in others() {
                    let inner = Echo::new(&space, &Space::discrete(3), 5).showing(&shown);
                    let Ok(mut env) = spec(name, kwargs).wrap(BoxEnv::new(inner)) else {
                        continue;
                    };
                    let mut results = vec![env.reset(1).map(|seen| format!("{seen:?}"))];
                    for action in [0, 2, 1] {
                        let step = env.step(&Value::Int(action));
                        results.push(step.map(|step| format!("{step:?}")));
                    }
                    refusals(&results, &mut refused);
                    all.push(format!("{results:?}"));
                }
            }
            told += &line(name, kwargs, &all, &refused);
        }
    }
    keep("given_observations.txt", &told);
}

/// Actions in every form in which somebody may give one, fit or not.
fn actions() -> Vec<Value> {
    let mut all = vec![
        Value::Null,
        Value::Int(1),
        Value::Int(-3),
        Value::Int(99),
        Value::Float(0.5),
        Value::Text("a".into()),
        Value::Tuple(vec![Value::Float(0.25), Value::Int(1)]),
        Value::Tuple(vec![Value::Float(0.25), Value::Float(f64::NAN)]),
    ];
    for dtype in [
        DType::F32,
        DType::F64,
        DType::I32,
        DType::I64,
        DType::U8,
        DType::I8,
    ] {
        for row in [&[1.0, 2.0][..], &[0.0, 9.0], &[1.0], &[1.0, 0.0, 1.0]] {
            all.push(array(dtype, row));
        }
    }
    for dtype in [DType::F32, DType::F64] {
        for row in [[0.3, -7.5], [f64::NAN, 0.0], [f64::INFINITY, 0.0]] {
            all.push(array(dtype, &row));
        }
    }
    all
}

#[test]
fn actions_in_any_form_are_taken_or_refused_as_they_were() {
    let mut told = String::new();
    for (name, cases) in WRAPPERS.iter().filter(|(name, _)| name.contains("Action")) {
        for kwargs in *cases {
            let (mut all, mut refused) = (Vec::new(), BTreeSet::new());
            for space in spaces() {
                let inner = Echo::new(&Space::discrete(50), &space, 50);
                let Ok(mut env) = spec(name, kwargs).wrap(BoxEnv::new(inner.clone())) else {
                    continue;
                };
                env.reset(1).unwrap();
                let given = actions();
                let mut taken = |action: &Value| -> Result<String> {
                    let step = env.step(action);
                    step.map(|step| format!("{step:?} {:?}", env.info_map()))
                };
                let results: Vec<_> = given.iter().map(&mut taken).collect();
                refusals(&results, &mut refused);
                all.push(format!("{results:?}"));
                let envs = Box::new(SyncVectorEnv::new([inner.clone(), inner]).unwrap());
                let Ok(mut envs) = spec(name, kwargs).wrap_vector(envs) else {
                    continue;
                };
                let mut columns = envs.columns().unwrap();
                envs.reset_into(&1.into(), &mut columns).unwrap();
                let mut taken = |action: &Value| -> Result<String> {
                    envs.step_into(action, &mut columns)?;
                    Ok(format!("{columns:?} {:?}", envs.infos(&columns)))
                };
                let results: Vec<_> = given.iter().map(&mut taken).collect();
                refusals(&results, &mut refused);
                all.push(format!("{results:?}"));
            }
            told += &line(name, kwargs, &all, &refused);
        }
    }
    keep("given_actions.txt", &told);
}

/// The numbers that an environment receives for an action.
fn received(name: &str, kwargs: &str, space: &Space, action: &Value) -> Vec<f64> {
    let env = Echo::new(&Space::discrete(50), space, 50);
    let mut env = spec(name, kwargs).wrap(BoxEnv::new(env)).unwrap();
    env.reset(1).unwrap();
    env.step(action).unwrap();
    numbers(env.layer::<Echo>().unwrap().last())
}

/// Bounds without a short form in binary: an action of `float64` is computed in `float64`.
#[test]
fn actions_are_clipped_and_rescaled_whatever_their_precision() {
    for dtype in [DType::F32, DType::F64] {
        let space = boxed(0.1, 0.7, &[2], dtype);
        let [low, high] = [0.1, 0.7].map(|bound| numbers(&array(dtype, &[bound]))[0]);
        for given in [[-5.0, 0.3], [0.1, 0.7], [0.69, 1e9]] {
            for action in [array(DType::F32, &given), array(DType::F64, &given)] {
                let clipped: Vec<f64> = numbers(&action)
                    .iter()
                    .map(|x| x.clamp(low, high))
                    .collect();
                assert_eq!(
                    received("ClipAction", "{}", &space, &action),
                    clipped,
                    "{action}"
                );
            }
        }
        for given in [[-1.0, 1.0], [0.25, -0.75]] {
            for action in [array(DType::F32, &given), array(DType::F64, &given)] {
                let kwargs = r#"{"min_action": -1, "max_action": 1}"#;
                let rescaled = received("RescaleAction", kwargs, &space, &action);
                for (x, y) in given.iter().zip(rescaled) {
                    let expected = low + (x + 1.0) * (high - low) / 2.0;
                    assert!(
                        (y - expected).abs() < 1e-6,
                        "{dtype} {action}: {y} is not {expected}"
                    );
                }
            }
        }
    }
}

/// Gymnasium's numbers: numpy subtracts bounds of `float32` in `float32`.
#[test]
fn bounds_of_float32_are_subtracted_in_float32() {
    for (min, max, expected) in [
        (-6.3_f32, 3.86_f32, 2.166_666_f32),
        (-2.96, 5.86, 4.389_999_4),
        (-0.03, 8.83, 7.353_332_5),
        (-4.27, 2.86, 1.671_667_1),
    ] {
        let space = boxed(0.0, 3.0, &[1], DType::F32);
        let halfway = boxed(2.5, 2.5, &[1], DType::F32);
        let inner = Echo::new(&space, &Space::discrete(3), 50).showing(&halfway);
        let mut env = RescaleObservation::new(inner, ([min], [max])).unwrap();
        let shown = env.reset(1).unwrap();
        assert_eq!(
            shown,
            Value::Array([expected].into()),
            "from {min} to {max}"
        );
    }
}

#[test]
fn integers_keep_their_start_in_another_type() {
    let nvec = MultiDiscrete::new([3, 4]).unwrap();
    let space = Space::from(nvec.with_start([-2, 5]).unwrap());
    for dtype in [DType::I8, DType::I16, DType::I32] {
        let inner = Echo::new(&space, &Space::discrete(3), 5);
        let mut env = DtypeObservation::new(inner, dtype).unwrap();
        let Space::MultiDiscrete(cast) = env.observation_space() else {
            panic!("{}", env.observation_space())
        };
        assert_eq!(
            (cast.dtype(), cast.nvec(), cast.start()),
            (dtype, &[3, 4][..], &[-2, 5][..])
        );
        let seen = env.reset(1).unwrap();
        assert_eq!(numbers(&seen), numbers(&space.sampler(500).sample()));
        assert!(env.observation_space().contains(&seen));
    }
}

/// Bounds in every form of Rust, as JSON, and back.
#[test]
fn bounds_are_stored_in_their_shape() {
    let plane = Array::new([2, 3], Data::F64((0..6).map(f64::from).collect())).unwrap();
    let bounds: [(Bound, Json); 6] = [
        (0.0.into(), json!(0.0)),
        (f64::NEG_INFINITY.into(), json!("-inf")),
        ([0.5_f32, -1.0].into(), json!([0.5, -1.0])),
        ([0.0_f64].into(), json!([0.0])),
        (plane.into(), json!([[0.0, 1.0, 2.0], [3.0, 4.0, 5.0]])),
        (
            Array::zeros(DType::F32, [2, 1]).unwrap().into(),
            json!([[0.0], [0.0]]),
        ),
    ];
    for (bound, stored) in &bounds {
        let json = serde_json::to_value(bound).unwrap();
        assert_eq!(json, *stored);
        let back: Bound = serde_json::from_value(json).unwrap();
        assert_eq!(format!("{back:?}"), format!("{bound:?}"));
        for (other, also) in &bounds {
            let pair = || (bound.clone(), other.clone());
            let observed = rescale_observation::Config::from(pair());
            let expected = json!({"min_obs": stored, "max_obs": also});
            assert_eq!(serde_json::to_value(observed).unwrap(), expected);
            let taken = rescale_action::Config::from(pair());
            let expected = json!({"min_action": stored, "max_action": also});
            assert_eq!(serde_json::to_value(taken).unwrap(), expected);
        }
    }
    let sides = [None, Some(0.0), Some(-1.5)];
    for (min, max) in sides
        .iter()
        .flat_map(|min| sides.iter().map(move |max| (*min, *max)))
    {
        let config = serde_json::to_value(clip_reward::Config::from((min, max))).unwrap();
        let of = |key: &str| config.get(key).cloned().unwrap_or_default();
        assert_eq!(
            [of("min_reward"), of("max_reward")],
            [json!(min), json!(max)]
        );
    }
}

/// A space that is given is the space around; without one, the inner space is.
#[test]
fn transformed_values_have_the_space_that_was_given() {
    let inner = || Echo::new(&boxed(0.0, 1.0, &[2], DType::F32), &Space::discrete(3), 5);
    let vector = || SyncVectorEnv::new([inner(), inner()]).unwrap();
    let copy = |value: &Value| value.clone();
    let other = boxed(-7.0, 7.0, &[2], DType::F32);
    for given in [None, Some(other), Some(Space::discrete(9))] {
        let [mut seen, mut taken] = [inner().observation_space(), inner().action_space()];
        if let Some(space) = &given {
            (seen, taken) = (space.clone(), space.clone());
        }
        let given = || given.clone();
        assert_eq!(
            inner()
                .transform_observation(copy, given())
                .observation_space(),
            seen
        );
        assert_eq!(
            inner().transform_action(copy, given()).action_space(),
            taken
        );
        let envs = VectorWrap::transform_observation(vector(), copy, given());
        assert_eq!(envs.single_observation_space(), seen);
        let envs = VectorWrap::transform_action(vector(), copy, given());
        assert_eq!(envs.single_action_space(), taken);
    }
}
