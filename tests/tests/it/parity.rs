//! The same seed gives the same episode, sample and number as in Gymnasium and numpy, to the last
//! bit.

use gym::spaces::{
    BoxSpace, DictSpace, Discrete, GraphSpace, MultiBinary, MultiDiscrete, OneOfSpace, Selection,
    SequenceSpace, TextSpace, TupleSpace,
};
use gym::trace::Trace;
use gym::vector::VectorKind;
use gym::{DType, Env, Generator, Seed, Space, VectorEnv, VectorEnvExt};
use gym_tests::{Reference, references};
use serde::de::DeserializeOwned;
use serde_json::{Value as Json, json};

/// Each reference is of a kind that a test reads.
#[test]
fn every_reference_is_of_a_known_kind() {
    for Reference { name, json, .. } in references() {
        let known = ["events", "episodes", "spaces", "raw_u64"]
            .iter()
            .any(|key| json.get(key).is_some());
        assert!(
            known,
            "{name}: neither a trace, nor outcomes, nor samples of spaces, nor random numbers"
        );
    }
}

/// A missing reference file would make a test check nothing. Update the list when you add or remove
/// a file.
#[test]
fn no_reference_is_missing() {
    if std::env::var_os("GYM_REFERENCE").is_some() {
        return; // the folder is the user's, with other files
    }
    let references = references();
    let count = |is: &dyn Fn(&Reference) -> bool| {
        references.iter().filter(|reference| is(reference)).count()
    };
    let has = |key: &'static str| move |reference: &Reference| reference.json.get(key).is_some();
    for (kind, known, expected) in [
        ("files", references.len(), 314),
        (
            "traces of environments",
            count(&|it| has("events")(it) && !has("vector")(it)),
            241,
        ),
        (
            "traces of vectors",
            count(&|it| has("events")(it) && has("vector")(it)),
            58,
        ),
        ("traces with wrappers", count(&has("wrappers")), 54),
        ("traces with pictures", count(&has("render_mode")), 19),
        ("traces with starts", count(&has("start")), 56),
        ("outcomes", count(&has("episodes")), 11),
        ("samples of spaces", count(&has("spaces")), 2),
        ("random numbers", count(&has("raw_u64")), 2),
    ] {
        assert_eq!(known, expected, "{kind}");
    }
}

#[test]
fn traces() {
    let mut count = 0;
    for Reference { name, text, .. } in references().iter().filter(|reference| reference.is_trace())
    {
        let recorded: Trace =
            serde_json::from_str(text).unwrap_or_else(|error| panic!("{name}: {error}"));
        let answered = recorded
            .replay()
            .unwrap_or_else(|error| panic!("{name}: {error}"));
        if let Some(difference) = recorded.first_difference(&answered) {
            panic!("{name}: {difference}");
        }
        count += 1;
    }
    println!("{count} traces are equal");
}

/// Replays the vectors' traces on a pool of threads.
#[test]
fn traces_of_vectors_on_threads() {
    let mut count = 0;
    for Reference { name, text, .. } in references().iter().filter(|reference| reference.is_trace())
    {
        let mut recorded: Trace =
            serde_json::from_str(text).unwrap_or_else(|error| panic!("{name}: {error}"));
        let Some(vector) = &mut recorded.vector else {
            continue;
        };
        vector.kind = Some(VectorKind::Async);
        let answered = recorded
            .replay()
            .unwrap_or_else(|error| panic!("{name}: {error}"));
        if let Some(difference) = recorded.first_difference(&answered) {
            panic!("{name}: {difference}");
        }
        count += 1;
    }
    println!("{count} traces of vectors are equal on threads");
}

/// The actions in traces of vectors are samples of the batched action space, seeded with the
/// trace's seed plus 17.
#[test]
fn actions_of_vectors() {
    for Reference { name, json, text } in
        references().iter().filter(|reference| reference.is_trace())
    {
        let trace: Trace =
            serde_json::from_str(text).unwrap_or_else(|error| panic!("{name}: {error}"));
        if trace.vector.is_none() {
            continue;
        }
        let seed = json["seed"].as_u64().expect("a seed");
        let mut sampler = trace
            .make_vector()
            .unwrap()
            .action_sampler(seed + 17)
            .unwrap();
        for (i, recorded) in trace
            .events
            .iter()
            .filter_map(|event| event.step.as_ref())
            .enumerate()
        {
            assert_eq!(&sampler.sample().to_json(), recorded, "{name}: action {i}");
        }
    }
}

/// The spec and spaces in a trace are compared, too.
#[test]
fn specs_and_spaces_of_traces() {
    for Reference { name, json, text } in
        references().iter().filter(|reference| reference.is_trace())
    {
        let trace: Trace =
            serde_json::from_str(text).unwrap_or_else(|error| panic!("{name}: {error}"));
        let spaces = match &trace.vector {
            Some(_) => {
                let envs = trace
                    .make_vector()
                    .unwrap_or_else(|error| panic!("{name}: {error}"));
                [envs.observation_space(), envs.action_space()]
                    .map(|space| space.expect("a batch").to_string())
            }
            None => {
                let env = trace
                    .make()
                    .unwrap_or_else(|error| panic!("{name}: {error}"));
                [env.observation_space(), env.action_space()].map(|space| space.to_string())
            }
        };
        let spec = trace
            .make()
            .unwrap_or_else(|error| panic!("{name}: {error}"))
            .spec()
            .expect("made by id");
        let known = json!({
            "max_episode_steps": spec.max_episode_steps,
            "reward_threshold": spec.reward_threshold,
            "observation_space": spaces[0],
            "action_space": spaces[1],
        });
        for (key, value) in known.as_object().expect("an object") {
            if let Some(recorded) = json.get(key) {
                let same =
                    value == recorded || value.as_f64() == recorded.as_f64() && value.is_number();
                assert!(same, "{name}: {key} is {value} for {recorded}");
            }
        }
    }
}

#[test]
fn random_numbers() {
    for Reference { name, json, text } in references() {
        if json.get("raw_u64").is_none() {
            continue;
        }
        let seed = big_seed(&text);
        for (key, recorded) in json.as_object().expect("an object") {
            if key == "numpy" || key == "seed" {
                continue;
            }
            let n = recorded.as_array().map_or(0, Vec::len);
            let numbers = primitive(key, Generator::new(&seed), n);
            let numbers = numbers.unwrap_or_else(|| panic!("{name}: nothing here draws `{key}`"));
            assert_eq!(&numbers, recorded, "{name}: {key}");
        }
    }
}

/// Parses the seed of a file, which may have more digits than a JSON number can represent.
fn big_seed(text: &str) -> Seed {
    #[derive(serde::Deserialize)]
    struct File<'a> {
        #[serde(borrow)]
        seed: &'a serde_json::value::RawValue,
    }
    let file: File<'_> = serde_json::from_str(text).expect("a seed");
    file.seed.get().parse().expect("a whole number")
}

/// Returns the first `n` numbers of the primitive that a reference file calls `key`.
fn primitive(key: &str, mut rng: Generator, n: usize) -> Option<Json> {
    use rand::Rng;
    const CARDS: [i64; 13] = [1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 10, 10, 10];
    let mut draw = |f: &mut dyn FnMut(&mut Generator) -> Json| {
        Json::Array((0..n).map(|_| f(&mut rng)).collect())
    };
    Some(match key {
        "raw_u64" => draw(&mut |rng| json!(rng.next_u64())),
        "random" => draw(&mut |rng| json!(rng.random())),
        "random_f32" => draw(&mut |rng| json!(f64::from(rng.random_f32()))),
        "uniform(-0.05,0.05)" => draw(&mut |rng| json!(rng.uniform(-0.05, 0.05))),
        "integers(0,5)" => draw(&mut |rng| json!(rng.integers(0, 5))),
        "integers(0,10**12)" => draw(&mut |rng| json!(rng.integers(0, 1_000_000_000_000))),
        "integers(0,2**40)x then random" => json!([rng.integers(0, 1 << 40), rng.random()]),
        "scalar integers(0,4) x16" => draw(&mut |rng| json!(rng.integers(0, 4))),
        "integers then random interleaved" => Json::Array(
            (0..n / 2)
                .flat_map(|_| [json!(rng.integers(0, 6)), json!(rng.random())])
                .collect(),
        ),
        "integers u8 [0,256)" => {
            let mut bytes = vec![0; n];
            rng.integers_u8(0, 255, &mut bytes);
            json!(bytes)
        }
        "integers i32 [-7,9)" => draw(&mut |rng| json!(rng.integers(-7, 9))),
        "normal" => draw(&mut |rng| json!(rng.standard_normal())),
        "normal(1,0.5)" => draw(&mut |rng| json!(rng.normal(1.0, 0.5))),
        "standard_normal_f32" => draw(&mut |rng| json!(f64::from(rng.standard_normal_f32()))),
        "exponential" => draw(&mut |rng| json!(rng.exponential(1.0))),
        "geometric(0.25)" => draw(&mut |rng| json!(rng.geometric(0.25))),
        "choice([1,10) scalar)" => draw(&mut |rng| json!(CARDS[rng.choice(CARDS.len())])),
        "choice(4,p)" => draw(&mut |rng| json!(rng.choice_p(&[0.1, 0.2, 0.3, 0.4]))),
        "permutation(10)" => json!(rng.permutation(10)),
        "shuffle(range(7))" => {
            let mut items = [0, 1, 2, 3, 4, 5, 6];
            rng.shuffle(&mut items);
            json!(items)
        }
        _ => return None,
    })
}

#[test]
fn samples_of_spaces() {
    for Reference { name, json, .. } in references() {
        let (Some(spaces), Some(masked)) = (json["spaces"].as_object(), json["masked"].as_object())
        else {
            continue;
        };
        let seed = json["seed"].as_u64().expect("a seed");
        for (case, recorded) in spaces {
            let space =
                space(case).unwrap_or_else(|| panic!("{name}: no space is called `{case}` here"));
            assert_eq!(space.to_string(), recorded["space"], "{name}: {case}");
            let mut sampler = space.sampler(seed);
            for (i, sample) in recorded["samples"]
                .as_array()
                .expect("a list")
                .iter()
                .enumerate()
            {
                assert_eq!(
                    &sampler.sample().to_json(),
                    sample,
                    "{name}: {case}, sample {i}"
                );
            }
        }
        for (case, recorded) in masked {
            let space = masked_space(case)
                .unwrap_or_else(|| panic!("{name}: no space is called `{case}` here"));
            assert_eq!(space.to_string(), recorded["space"], "{name}: {case}");
            let mut sampler = space.sampler(seed);
            for (i, sample) in recorded["samples"]
                .as_array()
                .expect("a list")
                .iter()
                .enumerate()
            {
                let drawn = match recorded.get("mask") {
                    Some(mask) => sampler.sample_masked(&selection(mask)),
                    None => sampler.sample_weighted(&selection(&recorded["probability"])),
                };
                assert_eq!(
                    &drawn.expect("a selection that fits").to_json(),
                    sample,
                    "{name}: {case}, sample {i}"
                );
            }
        }
    }
}

/// Parses a list of entries, or a list of lists.
fn selection<T: DeserializeOwned>(json: &Json) -> Selection<T> {
    let values: Result<Vec<T>, _> = serde_json::from_value(json.clone());
    values.map_or_else(
        |_| Selection::Each(serde_json::from_value(json.clone()).expect("lists")),
        Selection::Values,
    )
}

/// Returns the space of a masked case.
fn masked_space(case: &str) -> Option<Space> {
    Some(match case {
        "discrete" => Space::discrete(5),
        "multi_discrete" => MultiDiscrete::new([3, 2]).expect("sizes").into(),
        "multi_binary" => MultiBinary::new([4]).expect("a shape").into(),
        "discrete_probability" => Space::discrete(4),
        _ => return None,
    })
}

/// Returns the space that the reference files call `case`.
fn space(case: &str) -> Option<Space> {
    const INF: f64 = f64::INFINITY;
    let uniform = |low, high, n: usize, dtype| {
        Space::from(BoxSpace::uniform(low, high, [n], dtype).expect("bounds"))
    };
    Some(match case {
        "discrete" => Space::discrete(5),
        "discrete_start" => Discrete::new(7)
            .and_then(|space| space.with_start(-3))
            .expect("bounds")
            .into(),
        "discrete_large" => Space::discrete(1_000_000_000_000),
        "box_bounded_f32" => uniform(-2.0, 3.0, 3, DType::F32),
        "box_bounded_f64" => BoxSpace::new([-1.0, 0.0], [1.0, 10.0])
            .expect("bounds")
            .into(),
        "box_unbounded" => uniform(-INF, INF, 4, DType::F64),
        "box_below" => uniform(1.5, INF, 3, DType::F32),
        "box_above" => uniform(-INF, 2.5, 3, DType::F32),
        "box_mixed" => {
            let inf = f32::INFINITY;
            Space::boxed([-inf, 0.0, -1.0, -inf], [inf, inf, 1.0, 4.0])
        }
        "box_u8" => BoxSpace::uniform(0.0, 255.0, [2, 3], DType::U8)
            .expect("bounds")
            .into(),
        "box_i64" => uniform(-5.0, 5.0, 4, DType::I64),
        "multi_binary" => MultiBinary::new([6]).expect("a shape").into(),
        "multi_binary_2d" => MultiBinary::new([2, 3]).expect("a shape").into(),
        "multi_discrete" => MultiDiscrete::new([3, 5, 2]).expect("sizes").into(),
        "multi_discrete_start" => MultiDiscrete::new([3, 4])
            .and_then(|space| space.with_start([10, -2]))
            .expect("sizes")
            .into(),
        "text" => TextSpace::new(1, 8).expect("lengths").into(),
        "text_charset" => TextSpace::new(2, 5)
            .and_then(|space| space.with_charset("abc"))
            .expect("lengths")
            .into(),
        "tuple" => TupleSpace::new([Space::discrete(3), Space::boxed([0.0; 2], [1.0; 2])]).into(),
        "dict" => DictSpace::new([
            ("b", Space::discrete(4)),
            ("a", uniform(-1.0, 1.0, 2, DType::F64)),
        ])
        .expect("keys")
        .into(),
        "nested" => {
            let x = TupleSpace::new([
                MultiBinary::new([2]).expect("a shape").into(),
                Space::discrete(9),
            ]);
            let y = MultiDiscrete::new([4, 4]).expect("sizes");
            DictSpace::new([("x", x.into()), ("y", y.into())])
                .expect("keys")
                .into()
        }
        "sequence" => SequenceSpace::new(Space::discrete(4)).into(),
        "oneof" => OneOfSpace::new([Space::discrete(3), uniform(0.0, 1.0, 2, DType::F64)])
            .expect("spaces")
            .into(),
        "graph" => GraphSpace::new(uniform(-1.0, 1.0, 2, DType::F64), Some(Space::discrete(3)))
            .expect("spaces")
            .into(),
        _ => return None,
    })
}
