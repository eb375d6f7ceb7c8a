//! Branches that an ordinary episode does not take: partial masks, snapshots of another size, calls
//! after `close`, equal time limits.

use gym_core::render::{RenderMode, Rendered};
use gym_core::spaces::{
    DictSpace, Mask, OneOfSpace, Probabilities, SequenceSpace, TextSpace, TupleSpace,
};
use gym_core::vector::{Autoreset, SyncVectorEnv, VectorReset};
use gym_core::wrappers::{OrderEnforcing, Render, RenderCollection, StepCount, TimeLimit};
use gym_core::{
    BoxEnv, Env, EnvExt, Error, Registration, Result, Sampler, Snapshot, Space, Value, VectorEnv,
    VectorEnvExt, WrapperSpec, make,
};
use gym_testing::Count;
use serde_json::{Value as Json, json};

use crate::spaces::many;

gym_core::register!(
    Registration::new::<Count>("edges/Count-v0").max_episode_steps(5),
    Registration::new::<Count>("edges/Endless-v0"),
);

const MODES: [Autoreset; 3] = [
    Autoreset::NextStep,
    Autoreset::SameStep,
    Autoreset::Disabled,
];

fn actions<const N: usize>(actions: [i64; N]) -> Value {
    Value::Array(actions.into())
}

/// A closed sub-environment stays closed, even if [`call`](VectorEnvExt) changes it afterwards.
#[test]
fn a_sub_environment_that_is_changed_after_close_stays_closed() {
    let mut sync = SyncVectorEnv::new(vec![BoxEnv::new(Count::default()); 2]).unwrap();
    let mut columns = sync.columns().unwrap();
    sync.reset_into(&0.into(), &mut columns).unwrap();
    let snapshot = sync.snapshot().unwrap();
    sync.close();
    sync.call(|_, env| env.reset(1).map(drop))
        .into_iter()
        .for_each(|reset| reset.unwrap());
    let is_closed = |result: Result<()>, call: &str| {
        let error = result.unwrap_err();
        let Error::SubEnvironment { source, .. } = &error else {
            panic!("{error}");
        };
        assert!(
            matches!(**source, Error::Closed(closed) if closed == call),
            "{error}"
        );
    };
    is_closed(sync.step_into(&actions([1, 1]), &mut columns), "step");
    is_closed(sync.reset_into(&0.into(), &mut columns), "reset");
    is_closed(sync.restore(&snapshot), "restore");
    // an open vector refuses the snapshot of a closed one
    let closed = sync.snapshot().unwrap();
    let mut open = SyncVectorEnv::new(vec![BoxEnv::new(Count::default()); 2]).unwrap();
    let error = open.restore(&closed).unwrap_err().to_string();
    assert!(error.contains("taken after `close`"), "{error}");
}

/// After `call` has changed an open sub-environment, a step needs its reset first.
#[test]
fn a_sub_environment_that_is_changed_must_be_reset() {
    for mode in MODES {
        let mut envs = SyncVectorEnv::new(vec![BoxEnv::new(Count::default()); 2])
            .unwrap()
            .with_autoreset(mode);
        let mut columns = envs.columns().unwrap();
        envs.reset_into(&0.into(), &mut columns).unwrap();
        envs.call(|index, env| {
            if index == 1 {
                env.step(&Value::Int(1)).unwrap();
            }
        });
        let error = envs.step_into(&actions([1, 1]), &mut columns).unwrap_err();
        let text = error.to_string();
        assert!(text.contains("it was changed through `call`"), "{text}");
        let mask = VectorReset::default().mask([false, true]);
        envs.reset_into(&mask, &mut columns).unwrap();
        envs.step_into(&actions([1, 1]), &mut columns).unwrap();
        let seen = columns.observations.as_array().unwrap();
        assert_eq!(seen.as_slice::<i64>().unwrap(), [1, 1], "{mode:?}");
    }
}

/// A vector refuses snapshots of vectors with another observation space, mode or size.
#[test]
fn snapshots_of_other_vectors_are_refused() {
    let one = |env: BoxEnv, mode| SyncVectorEnv::new([env]).unwrap().with_autoreset(mode);
    let count = || BoxEnv::new(Count::default());
    let mut envs = one(count(), Autoreset::SameStep);
    envs.reset(0).unwrap();
    let mut refuses = |snapshot: Snapshot, words: &str| {
        let error = envs.restore(&snapshot).unwrap_err().to_string();
        assert!(error.contains(words), "{error}");
    };
    let stored = |mut envs: SyncVectorEnv| {
        envs.reset(0).unwrap();
        envs.snapshot().unwrap()
    };
    refuses(
        stored(one(count(), Autoreset::Disabled)),
        "taken with autoreset Disabled, and this vector has SameStep",
    );
    let two = SyncVectorEnv::new([count(), count()]).unwrap();
    refuses(
        stored(two.with_autoreset(Autoreset::SameStep)),
        "it has 2 sub-environments, and this vector 1",
    );
    let mut text: serde_json::Value = stored(one(count(), Autoreset::SameStep)).get().unwrap();
    text["slots"][0]["observation"] = serde_json::json!({"Text": "7"});
    assert!(envs.restore(&Snapshot::of(&text).unwrap()).is_err());
}

fn texts(rendered: Rendered) -> Vec<String> {
    let Rendered::Texts(texts) = rendered else {
        panic!("{rendered:?} are not texts");
    };
    texts
}

#[test]
fn a_restore_drops_the_frames_of_the_abandoned_history() {
    let drawn = Render::new(Count::default(), RenderMode::Ansi).unwrap();
    let mut env = RenderCollection::new(drawn);
    env.reset(0).unwrap();
    let start = env.snapshot().unwrap();
    env.step(&1).unwrap();
    env.restore(&start).unwrap();
    assert_eq!(texts(env.render().unwrap()), [""; 0]);
    env.step(&1).unwrap();
    assert_eq!(texts(env.render().unwrap()), ["1"]);
    // a reset clears the list too
    env.step(&1).unwrap();
    env.reset(0).unwrap();
    assert_eq!(texts(env.render().unwrap()), ["0"]);
    assert_eq!(env.render_mode(), Some(RenderMode::AnsiList));
    // a clone has its own copy of the collected frames
    env.step(&1).unwrap();
    let mut clone = env.clone();
    assert_eq!(texts(clone.render().unwrap()), ["1"]);
    assert_eq!(texts(env.render().unwrap()), ["1"]);
    // a list of lists is refused
    let mut nested = RenderCollection::new(env);
    nested.reset(0).unwrap();
    let error = nested.render().unwrap_err().to_string();
    assert!(error.contains("a mode of single items"), "{error}");
}

/// In a spec, `max_episode_steps` is the limit of `make`; a longer or an outer `TimeLimit` is an
/// additional wrapper.
#[test]
fn an_equal_or_shorter_limit_replaces_that_of_make() {
    let limited = |id: &str, limit| TimeLimit::new(make(id).unwrap(), limit).unwrap();
    let spec = |id: &str, limit| limited(id, limit).spec().unwrap();
    let wrapper = |limit: u32| WrapperSpec::new("TimeLimit").arg("max_episode_steps", limit);
    let own = make("edges/Count-v0").unwrap().spec().unwrap();
    assert_eq!(own.max_episode_steps, Some(5));
    assert_eq!(spec("edges/Count-v0", 5), own);
    let shorter = spec("edges/Count-v0", 4);
    assert_eq!(shorter.max_episode_steps, Some(4));
    assert!(shorter.additional_wrappers.is_empty());
    let longer = spec("edges/Count-v0", 6);
    assert_eq!(longer, own.clone().wrapped(wrapper(6)));
    let endless = spec("edges/Endless-v0", 7);
    assert_eq!(endless.max_episode_steps, Some(7));
    assert!(endless.additional_wrappers.is_empty());
    // a shorter limit outside of another wrapper is an additional wrapper too
    let order = OrderEnforcing::new(limited("edges/Count-v0", 6));
    let outer = TimeLimit::new(order, 2).unwrap().spec().unwrap();
    let names: Vec<_> = outer.additional_wrappers.iter().map(|w| &*w.name).collect();
    assert_eq!(names, ["TimeLimit", "OrderEnforcing", "TimeLimit"]);
    assert_eq!(outer.max_episode_steps, Some(5));
    assert_eq!(outer.time_limit(), Some(2));
    // an environment made from the spec has episodes of the same length
    for (spec, length) in [
        (own, 5),
        (shorter, 4),
        (longer, 5),
        (endless, 7),
        (outer, 2),
    ] {
        let mut env = spec.make().unwrap();
        env.reset(0).unwrap();
        let played = (1..).find(|_| env.step(&Value::Int(1)).unwrap().done());
        assert_eq!(played, Some(length), "{spec:?}");
    }
    assert!(TimeLimit::new(Count::default(), 0).is_err());
}

/// With two time limits, the layer [`StepCount`] is the count with fewer remaining steps.
#[test]
fn the_count_of_the_nearest_limit_is_shown() {
    let count = |inner: u32, outer: u32| {
        let inner = TimeLimit::new(Count::default(), inner).unwrap();
        let mut env = BoxEnv::new(TimeLimit::new(inner, outer).unwrap());
        env.reset(0).unwrap();
        env.step(&Value::Int(1)).unwrap();
        *env.layer::<StepCount>().unwrap()
    };
    for (inner, outer) in [(3, 8), (8, 3), (3, 3)] {
        let count = count(inner, outer);
        assert_eq!((count.max_episode_steps, count.elapsed_steps), (3, 1));
    }
}

/// A wrapper around a `RenderCollection` stays outside of the `RenderCollection`, in the spec too.
#[test]
fn a_collection_stays_inside_of_a_later_wrapper() {
    let mut spec = make("edges/Count-v0").unwrap().spec().unwrap();
    spec.render_mode = Some(RenderMode::AnsiList);
    let spec = spec.wrapped(WrapperSpec::new("TimeLimit").arg("max_episode_steps", 3));
    let names: Vec<_> = spec.additional_wrappers.iter().map(|w| &*w.name).collect();
    assert_eq!(names, ["RenderCollection", "TimeLimit"]);
    assert_eq!(spec.render_mode, Some(RenderMode::Ansi));
}

/// A snapshot contains the count of steps and the limit: an environment with another limit is
/// another environment.
#[test]
fn a_limit_holds_from_the_step_that_is_restored() {
    let limited = |limit| TimeLimit::new(Count::default(), limit).unwrap();
    let mut long = limited(10);
    long.reset(0).unwrap();
    for _ in 0..4 {
        assert!(!long.step(&1).unwrap().truncated);
    }
    let snapshot = long.snapshot().unwrap();
    for other in [2, 5, 11] {
        let mut other = limited(other);
        other.reset(0).unwrap();
        other.step(&1).unwrap();
        let before = other.snapshot().unwrap();
        let error = other.restore(&snapshot).unwrap_err().to_string();
        assert!(error.contains("taken with a limit of 10 steps"), "{error}");
        assert_eq!(other.snapshot().unwrap(), before);
    }
    let mut same = limited(10);
    same.restore(&snapshot).unwrap();
    assert_eq!(same.elapsed_steps(), 4);
    for step in 5..=12 {
        // beyond the limit every step truncates
        assert_eq!(same.step(&1).unwrap().truncated, step >= 10, "{step}");
        let snapshot = same.snapshot().unwrap();
        same.restore(&snapshot).unwrap();
    }
    // both flags are true if a step terminates at the limit
    let mut both = limited(1);
    both.reset(0).unwrap();
    let step = both.step(&9).unwrap();
    assert!(step.terminated && step.truncated);
}

/// A mask that allows no character gives the empty text, if the space has the empty text.
#[test]
fn a_mask_of_no_character_gives_the_empty_text() {
    let text = |min| TextSpace::new(min, 5).unwrap().with_charset("abc").unwrap();
    let mask = |length, characters: [i8; 3]| Mask::Text {
        length,
        characters: Some(characters.into()),
    };
    let mut sampler = Space::from(text(0)).sampler(1);
    for length in [None, Some(0), Some(4)] {
        let sample = sampler.sample_masked(&mask(length, [0, 0, 0])).unwrap();
        assert_eq!(sample, Value::Text(String::new()), "{length:?}");
    }
    assert_eq!(
        sampler.sample_masked(&mask(Some(4), [0, 1, 0])).unwrap(),
        Value::Text("bbbb".into())
    );
    assert_eq!(
        sampler.sample_masked(&mask(Some(0), [0, 1, 0])).unwrap(),
        Value::Text(String::new())
    );
    // with a length and without one, all allowed characters are drawn
    let mut seen = std::collections::BTreeSet::new();
    for _ in 0..50 {
        let Value::Text(sample) = sampler.sample_masked(&mask(None, [1, 0, 1])).unwrap() else {
            panic!("a text is a text");
        };
        seen.extend(sample.chars());
    }
    assert_eq!(seen.into_iter().collect::<String>(), "ac");
    let weighted = Probabilities::Text {
        length: Some(3),
        characters: Some(vec![0.0, 0.0, 1.0]),
    };
    assert_eq!(
        sampler.sample_weighted(&weighted).unwrap(),
        Value::Text("ccc".into())
    );
    // these are errors: a space without the empty text, lengths outside the bounds, a mask of
    // another length
    let mut sampler = Space::from(text(1)).sampler(1);
    for refused in [
        mask(None, [0, 0, 0]),
        mask(Some(0), [1, 1, 1]),
        mask(Some(6), [1, 1, 1]),
        Mask::Text {
            length: None,
            characters: Some(vec![1, 1]),
        },
    ] {
        assert!(sampler.sample_masked(&refused).is_err(), "{refused:?}");
    }
    for length in [1, 5] {
        let sample = sampler.sample_masked(&mask(Some(length), [1, 1, 1]));
        assert!(matches!(sample, Ok(Value::Text(text)) if text.len() == length));
    }
}

/// Every stored space can be read again. A space with too many levels of nesting cannot be stored.
#[test]
fn every_space_that_is_stored_is_read_again() {
    type Nest = fn(Space) -> Space;
    let nests: [Nest; 4] = [
        |space| TupleSpace::new([space]).into(),
        |space| DictSpace::new([("a", space)]).unwrap().into(),
        |space| OneOfSpace::new([space]).unwrap().into(),
        |space| SequenceSpace::new(space).into(),
    ];
    for nest in nests {
        let mut space = Space::boxed([0.0], [1.0]);
        let mut deepest = 0;
        for depth in 1..200 {
            space = nest(space);
            match serde_json::to_string(&space) {
                Ok(text) => {
                    // the JSON of a space may be nested in other JSON
                    let within = format!("[[[[{text}]]]]");
                    let read: [[[[Space; 1]; 1]; 1]; 1] = serde_json::from_str(&within)
                        .unwrap_or_else(|error| panic!("{depth}: {error}"));
                    assert_eq!(read[0][0][0][0], space);
                    deepest = depth;
                }
                Err(error) => {
                    assert!(error.to_string().contains("nested too deep"), "{error}");
                    break;
                }
            }
        }
        assert!((30..199).contains(&deepest), "{deepest}");
    }
}

/// How many members have members, recursively.
fn members(streams: &Json) -> Json {
    let own = streams["members"].as_array().unwrap();
    own.iter().map(members).collect()
}

/// A stored sampler goes on, and has a generator for each member of its space.
#[test]
fn a_stored_sampler_has_the_generators_of_its_space() {
    let drawn = |space: &Space| {
        let mut sampler = space.sampler(3);
        sampler.sample();
        sampler
    };
    let stored = |space| (serde_json::to_value(drawn(&space)).unwrap(), space);
    let all: Vec<(Json, Space)> = many().into_iter().map(stored).collect();
    let mut refused = 0;
    for (own, space) in &all {
        let (mut read, mut drawn): (Sampler, _) =
            (serde_json::from_value(own.clone()).unwrap(), drawn(space));
        assert_eq!(
            [read.sample(), read.sample()],
            [drawn.sample(), drawn.sample()]
        );
        for (other, _) in &all {
            let mixed = json!({"space": own["space"], "streams": other["streams"]});
            let read = serde_json::from_value::<Sampler>(mixed);
            if members(&own["streams"]) == members(&other["streams"]) {
                assert!(read.is_ok(), "{read:?}");
            } else {
                let told = format!("its generators are not those of {space}");
                let error = read.unwrap_err().to_string();
                assert!(error.contains(&told), "{error}");
                refused += 1;
            }
        }
    }
    assert!(refused > 100, "{refused}");
}

/// Reading the stored form of a value gives the same value, for every kind.
#[test]
fn values_are_read_from_their_stored_form() {
    for value in [
        Value::Null,
        Value::Bool(true),
        Value::Int(i64::MIN),
        Value::Float(f64::NEG_INFINITY),
        Value::Text("$float".into()),
        Value::from([0.5_f32, f32::INFINITY]),
        Value::from([7_i64; 40]),
        Value::Tuple(vec![Value::Int(1), Value::Tuple(vec![])]),
        Value::Dict(vec![("b".into(), Value::Int(1)), ("a".into(), Value::Null)]),
        Value::Dict(vec![("$key".into(), Value::Float(0.0))]),
        Value::OneOf(3, Box::new(Value::Int(1))),
    ] {
        let text = serde_json::to_string(&value).unwrap();
        assert_eq!(
            serde_json::from_str::<Value>(&text).unwrap(),
            value,
            "{text}"
        );
    }
    for text in [
        "18446744073709551615",
        r#"{"$float": "much"}"#,
        r#"{"$unknown": 1}"#,
    ] {
        assert!(serde_json::from_str::<Value>(text).is_err(), "{text}");
    }
}

/// A value is a batch of a space only if the kind, type, shape, number of rows and keys of every
/// part fit the space.
#[test]
fn a_batch_of_another_form_is_none() {
    let line = || Space::boxed([0.0], [1.0]);
    let dict = |second: &str| -> Space {
        DictSpace::new([("a", line()), (second, Space::discrete(3))])
            .unwrap()
            .into()
    };
    let space = dict("b");
    let batch = space.empty_batch(2).unwrap();
    assert!(space.is_batch(&batch, 2));
    space.check_batch(&batch, 2).unwrap();
    let tuple = |members: Vec<Space>| Space::from(TupleSpace::new(members));
    for (other, n) in [
        (dict("c"), 2),
        (space.clone(), 3),
        (DictSpace::new([("a", line())]).unwrap().into(), 2),
        (tuple(vec![line(), Space::discrete(3)]), 2),
        (
            DictSpace::new([
                ("a", Space::boxed([0.0; 2], [1.0; 2])),
                ("b", Space::discrete(3)),
            ])
            .unwrap()
            .into(),
            2,
        ),
    ] {
        let other = other.empty_batch(n).unwrap();
        assert!(!space.is_batch(&other, 2), "{other}");
        assert!(space.check_batch(&other, 2).is_err(), "{other}");
        let element = space.zero().unwrap();
        let written = space.write_row(&mut other.clone(), 1, &element);
        assert_eq!(written.is_ok(), n == 3, "{other}");
    }
    let members = tuple(vec![line(), Space::discrete(3)]);
    let fewer = tuple(vec![line()]).empty_batch(2).unwrap();
    assert!(!members.is_batch(&fewer, 2));
    let floats = Value::from([0.0_f64; 2]);
    assert!(!Space::discrete(3).is_batch(&floats, 2));
}
