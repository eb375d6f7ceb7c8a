//! Rules for every space, and samples recorded with Gymnasium 1.4.0 and numpy 2.4.6.

use serde_json::{Value as Json, json};

use gym_core::spaces::*;
use gym_core::{Array, DType, Space, Value};

fn discrete(n: i64, start: i64, dtype: DType) -> Space {
    Discrete::new(n)
        .unwrap()
        .with_start(start)
        .unwrap()
        .with_dtype(dtype)
        .unwrap()
        .into()
}

fn uniform(low: f64, high: f64, shape: &[usize], dtype: DType) -> Space {
    BoxSpace::uniform(low, high, shape, dtype).unwrap().into()
}

fn text(max_length: usize, charset: &str) -> Space {
    TextSpace::new(1, max_length)
        .unwrap()
        .with_charset(charset)
        .unwrap()
        .into()
}

fn bits(shape: &[usize]) -> Space {
    MultiBinary::new(shape).unwrap().into()
}

fn tuple<const N: usize>(spaces: [Space; N]) -> Space {
    TupleSpace::new(spaces).into()
}

fn dict<const N: usize>(spaces: [(&str, Space); N]) -> Space {
    DictSpace::new(spaces).unwrap().into()
}

fn one_of<const N: usize>(spaces: [Space; N]) -> Space {
    OneOfSpace::new(spaces).unwrap().into()
}

fn graph(node_space: Space, edge_space: Option<Space>) -> Space {
    GraphSpace::new(node_space, edge_space).unwrap().into()
}

/// Returns spaces of every kind, and of every kind inside another kind.
pub(crate) fn many() -> Vec<Space> {
    let inf = f64::INFINITY;
    let mut spaces = vec![
        uniform(-1.0, 1.0, &[2, 3], DType::F32),
        uniform(-inf, inf, &[], DType::F64),
        uniform(0.0, 255.0, &[3], DType::U8),
        uniform(0.0, inf, &[2], DType::F32),
        BoxSpace::with_dtype([-inf, 0.0, -3.0], [4.0, inf, 3.0], DType::I32)
            .unwrap()
            .into(),
        BoxSpace::new([i64::MIN, 1 << 60], [i64::MAX - 1, i64::MAX - 1])
            .unwrap()
            .into(),
        discrete(5, -2, DType::I64),
        discrete(200, 0, DType::U8),
        MultiDiscrete::new([3, 1, 4])
            .unwrap()
            .with_start([10, -2, 0])
            .unwrap()
            .into(),
        bits(&[2, 2]),
        text(5, "cab"),
    ];
    let leaves = || {
        [
            discrete(3, 1, DType::I64),
            uniform(0.0, 1.0, &[2], DType::F32),
            text(3, "xy"),
            bits(&[3]),
        ]
    };
    let pair = || {
        tuple([
            discrete(3, 0, DType::I8),
            uniform(-1.0, 1.0, &[2], DType::F32),
        ])
    };
    spaces.extend([
        tuple(leaves()),
        dict([
            ("b", pair()),
            ("a", discrete(4, 0, DType::I64)),
            ("c", tuple(leaves())),
        ]),
        one_of(leaves()),
        tuple([one_of([pair(), text(4, "ab")]), bits(&[2])]),
        graph(
            uniform(-1.0, 1.0, &[2], DType::F64),
            Some(discrete(3, 0, DType::I64)),
        ),
        graph(bits(&[2]), None),
    ]);
    for feature in [
        pair(),
        text(3, "ab"),
        dict([("a", pair()), ("b", bits(&[2]))]),
        one_of(leaves()),
    ] {
        spaces.push(SequenceSpace::new(feature.clone()).into());
        spaces.push(SequenceSpace::stacked(feature.clone()).into());
        spaces.push(tuple([
            SequenceSpace::new(feature).into(),
            discrete(2, 0, DType::I64),
        ]));
    }
    spaces
}

#[test]
fn samples_are_elements_and_survive_json() {
    for space in many() {
        let mut sampler = space.sampler(11);
        for _ in 0..30 {
            let sample = sampler.sample();
            space.check(&sample).unwrap();
            let json = space.to_json(&sample).unwrap();
            assert_eq!(space.from_json(&json).unwrap(), sample, "{space}");
        }
    }
}

#[test]
fn flat_samples_lie_in_the_flat_space_and_return() {
    for space in many() {
        let flat_space = space.flatten_space().unwrap();
        if space.is_flattenable() {
            assert_eq!(
                flat_space.shape(),
                Some(&[space.flatdim().unwrap()][..]),
                "{space}"
            );
        }
        let mut sampler = space.sampler(12);
        for _ in 0..30 {
            let sample = sampler.sample();
            let flat = space.flatten(&sample).unwrap();
            flat_space.check(&flat).unwrap();
            if space.is_flattenable() {
                assert_eq!(flat.as_array().map(Array::dtype), flat_space.dtype());
            }
            assert_eq!(space.unflatten(&flat).unwrap(), sample, "{space}");
        }
    }
}

#[test]
fn contains_and_check_agree() {
    let samples: Vec<Value> = many()
        .iter()
        .map(|space| space.sampler(13).sample())
        .collect();
    for (i, space) in many().iter().enumerate() {
        for (j, sample) in samples.iter().enumerate() {
            assert_eq!(
                space.contains(sample),
                space.check(sample).is_ok(),
                "{sample} in {space}"
            );
            assert!(i != j || space.contains(sample));
        }
        assert!(!space.contains(&Value::Null) && space.flatten(&Value::Null).is_err());
        assert!(space.to_json(&Value::Null).is_err() && space.from_json(&Json::Null).is_err());
        assert!(space.unflatten(&Value::Null).is_err());
    }
}

#[test]
fn descriptions_are_stored() {
    for space in many() {
        let stored = serde_json::to_string(&space).unwrap();
        let restored: Space = serde_json::from_str(&stored).unwrap();
        assert_eq!(restored, space);
        assert_eq!(restored.to_string(), space.to_string());
        assert_eq!(restored.sampler(3).sample(), space.sampler(3).sample());
    }
    let stored = serde_json::to_value(Space::discrete(3)).unwrap();
    assert_eq!(
        stored,
        json!({"type": "Discrete", "n": 3, "start": 0, "dtype": "int64"})
    );
    assert!(serde_json::from_value::<Space>(json!({"type": "Discrete", "n": 3})).is_err());
    assert!(serde_json::from_value::<Space>(json!({"type": "Ring", "n": 3})).is_err());
}

#[test]
fn spaces_differ() {
    for (i, a) in many().iter().enumerate() {
        for (j, b) in many().iter().enumerate() {
            assert_eq!(a == b, i == j, "{a} and {b}");
        }
    }
}

#[test]
fn bad_flat_values_are_refused() {
    let refused = |space: &Space, flat: Vec<f64>| {
        space
            .unflatten(&Value::Array(flat.into()))
            .unwrap_err()
            .to_string()
    };
    let three = Space::discrete(3);
    assert!(
        refused(&three, vec![0.0; 3])
            .starts_with("exactly one of its numbers must be 1, but none is")
    );
    assert!(refused(&three, vec![0.0; 4]).starts_with("the shape is (4,) and should be (3,)"));
    let grid = MultiDiscrete::new([2, 2]).unwrap().into();
    assert!(
        refused(&grid, vec![1.0, 0.0, 1.0, 1.0])
            .starts_with("[1]: exactly one of its numbers must be 1")
    );
    assert!(refused(&text(2, "ab"), vec![0.0, 3.0]).starts_with("a number is not between 0 and 2"));
    assert!(
        refused(&one_of([three.clone()]), vec![1.0, 0.0, 0.0, 1.0])
            .contains("not the index of a space")
    );
    assert!(
        refused(&one_of([three]), vec![f64::NAN, 0.0, 0.0, 1.0])
            .contains("not the index of a space")
    );

    let error = tuple([Space::discrete(3)])
        .flatten(&Value::Tuple(vec![Value::Int(3)]))
        .unwrap_err();
    assert!(
        error
            .to_string()
            .starts_with("[0]: 3 is not between 0 and 2")
    );
    let chosen = Value::OneOf(1, Box::new(Value::Tuple(vec![Value::Int(3)])));
    let error = one_of([Space::discrete(2), tuple([Space::discrete(3)])])
        .flatten(&chosen)
        .unwrap_err();
    assert!(
        error
            .to_string()
            .starts_with("[1][0]: 3 is not between 0 and 2"),
        "{error}"
    );
}

/// Compares samples with Gymnasium's for the same seed.
fn assert_samples(space: &Space, mut sample: impl FnMut(&mut Sampler) -> Value, expected: &Json) {
    let mut sampler = space.sampler(7);
    for expected in expected.as_array().unwrap() {
        assert_eq!(&sample(&mut sampler).to_json(), expected, "{space}");
    }
}

#[test]
fn samples_are_gymnasiums() {
    let inf = f64::INFINITY;
    let half_bounded =
        BoxSpace::with_dtype([-inf, 0.0, -inf], [5.0, inf, inf], DType::I32).unwrap();
    let pair = tuple([Space::discrete(3), bits(&[2])]);
    for (space, expected) in [
        (discrete(100, 0, DType::I8), json!([54, 25, 41, 73])),
        (discrete(200, 0, DType::U8), json!([108, 50, 116, 146])),
        (
            discrete(40_000, 0, DType::U16),
            json!([10_259, 16_653, 32_145, 13_495]),
        ),
        (
            discrete(1 << 32, 0, DType::I64),
            json!([4_058_335_883_i64, 2_684_764_585_i64]),
        ),
        (half_bounded.into(), json!([[5, 1, 0], [2, 0, -1]])),
        (
            BoxSpace::new([i64::MIN; 2], [i64::MAX - 1; 2])
                .unwrap()
                .into(),
            json!([
                [2_307_604_057_237_571_584_i64, 7_327_301_329_031_161_856_i64],
                [
                    5_085_503_372_737_050_624_i64,
                    -5_069_032_639_539_044_352_i64
                ]
            ]),
        ),
        (
            BoxSpace::new([i64::MAX - 8; 2], [i64::MAX - 1; 2])
                .unwrap()
                .into(),
            json!([[i64::MAX - 8, i64::MAX - 8]]),
        ),
        (
            SequenceSpace::stacked(pair).into(),
            json!([
                [[2, 1, 2], [[1, 0], [0, 1], [0, 0]]],
                [[2, 1, 2, 2], [[0, 1], [0, 1], [1, 0], [1, 0]]]
            ]),
        ),
        (
            one_of([
                Space::discrete(3),
                dict([("a", Space::discrete(2)), ("b", text(3, "xyz"))]),
            ]),
            json!([[1, {"a": 1, "b": "zx"}], [1, {"a": 1, "b": "y"}], [1, {"a": 1, "b": "zx"}]]),
        ),
    ] {
        assert_samples(&space, Sampler::sample, &expected);
    }
    assert_samples(
        &graph(Space::discrete(4), Some(bits(&[2]))),
        |sampler| sampler.sample_graph(3, Some(2)).unwrap(),
        &json!([{"nodes": [1, 2, 2], "edges": [[0, 0], [0, 0]], "edge_links": [[2, 1], [2, 2]]}]),
    );
}

#[test]
fn masked_samples_are_gymnasiums() {
    for (space, mask, expected) in [
        (
            text(4, "abcd"),
            Mask::Text {
                length: None,
                characters: Some(vec![1, 0, 0, 1]),
            },
            json!(["ddaa", "dad", "a"]),
        ),
        (
            SequenceSpace::new(Space::discrete(3)).into(),
            Mask::Sequence {
                lengths: Some(vec![1, 4]),
                member: Box::new([1, 0, 1].into()),
            },
            json!([[0, 0, 0, 2], [2, 2, 0, 2], [2, 2, 0, 0]]),
        ),
        (
            graph(Space::discrete(3), Some(Space::discrete(2))),
            Mask::Graph {
                num_nodes: Some(2),
                num_edges: None,
                nodes: Box::new(Mask::Each(vec![vec![1, 0, 1], vec![0, 0, 0]])),
                edges: Box::new([0, 1].into()),
            },
            json!([{"nodes": [0, 0], "edges": [1], "edge_links": [[1, 1]]}]),
        ),
    ] {
        assert_samples(
            &space,
            |sampler| sampler.sample_masked(&mask).unwrap(),
            &expected,
        );
    }
    let ten = vec![0.05, 0.1, 0.15, 0.2, 0.1, 0.1, 0.1, 0.1, 0.05, 0.05];
    for (space, probabilities, expected) in [
        (
            MultiDiscrete::new([10, 2]).unwrap().into(),
            Probabilities::Each(vec![ten, vec![0.25, 0.75]]),
            json!([[5, 1], [6, 0], [3, 1]]),
        ),
        (
            text(4, "abcd"),
            Probabilities::Text {
                length: Some(3),
                characters: Some(vec![0.5, 0.0, 0.0, 0.5]),
            },
            json!(["ddd", "aad", "add"]),
        ),
        (
            bits(&[6]),
            [0.0, 0.2, 0.4, 0.6, 0.8, 1.0].into(),
            json!([[0, 0, 0, 1, 1, 1], [0, 0, 0, 1, 1, 1]]),
        ),
    ] {
        assert_samples(
            &space,
            |sampler| sampler.sample_weighted(&probabilities).unwrap(),
            &expected,
        );
    }
}

/// Each member of a space has its own mask: here all but one of its elements are masked.
#[test]
fn members_have_masks_of_their_own() {
    let member = || Space::discrete(40);
    let only = |n: usize| Mask::Values((0..40).map(|i| i8::from(i == n)).collect());
    let tuple = || Mask::Tuple(vec![only(7), only(31)]);
    let dict = DictSpace::new([("a", member()), ("b", member())]).unwrap();
    let named = [("b".to_owned(), only(31)), ("a".to_owned(), only(7))];
    let both = || -> Space { TupleSpace::new([member(), member()]).into() };
    let nested = Mask::Tuple(vec![tuple(), only(3)]);
    let cases: [(Space, Mask, Json); 4] = [
        (both(), tuple(), json!([7, 31])),
        (
            dict.into(),
            Mask::Dict(named.into()),
            json!({"a": 7, "b": 31}),
        ),
        (
            SequenceSpace::new(both()).into(),
            Mask::Sequence {
                lengths: Some(vec![2]),
                member: Box::new(tuple()),
            },
            json!([[7, 31], [7, 31]]),
        ),
        (
            TupleSpace::new([both(), member()]).into(),
            nested,
            json!([[7, 31], 3]),
        ),
    ];
    for (space, mask, expected) in cases {
        let mut sampler = space.sampler(3);
        for _ in 0..3 {
            let sample = sampler.sample_masked(&mask).unwrap();
            assert_eq!(sample.to_json(), expected, "{space}");
        }
    }
    let mut sampler = one_of([member(), member()]).sampler(3);
    for _ in 0..9 {
        let Value::OneOf(chosen, element) = sampler.sample_masked(&tuple()).unwrap() else {
            panic!("another kind of value");
        };
        assert_eq!(element.to_json(), [7, 31][chosen]);
    }
}

#[test]
fn a_choice_without_numbers_lies_in_the_flat_space() {
    let empty = TextSpace::new(0, 0)
        .unwrap()
        .with_charset("x")
        .unwrap()
        .into();
    for one in [1.0, -1.0] {
        let space = one_of([uniform(one, one, &[2], DType::I8), Space::clone(&empty)]);
        let flat_space = space.flatten_space().unwrap();
        let samples: Vec<_> = space.sampler(0).take(20).collect();
        assert!([0, 1].iter().all(|i| {
            samples
                .iter()
                .any(|value| matches!(value, Value::OneOf(j, _) if i == j))
        }));
        for value in samples {
            let flat = space.flatten(&value).unwrap();
            assert!(flat_space.contains(&flat), "{flat} of {flat_space}");
            assert_eq!(space.unflatten(&flat).unwrap(), value);
        }
    }
}

/// Samples of integers near the limits of their type: type, low, high and the first samples of seed
/// 3. They are recorded with Gymnasium at b8e70f27, which fixed these samples after 1.4. (For a
/// range up to the largest `int64`, Gymnasium's computation overflows; the expected samples are
/// then our own.)
#[test]
fn integers_near_the_limits_are_sampled_as_in_gymnasium() {
    let cases: Vec<(String, Json, Json, Vec<Json>)> =
        serde_json::from_str(include_str!("integer_boxes.json")).unwrap();
    assert!(cases.len() > 50);
    for (dtype, low, high, samples) in cases {
        let space = json!({"type": "Box", "low": low, "high": high, "shape": [1], "dtype": dtype});
        let space: Space = serde_json::from_value(space).unwrap();
        let mut sampler = space.sampler(3);
        for (i, expected) in samples.iter().enumerate() {
            let sample = sampler.sample().to_json();
            assert_eq!(
                sample,
                json!([expected]),
                "{dtype} from {low} to {high}, sample {i}"
            );
        }
    }
}

/// A value that is no element is refused in words that say which part of it is wrong, and why.
#[test]
fn wrong_values_are_told_apart() {
    let int = Value::Int;
    let word = |text: &str| Value::Text(text.into());
    let number = |x: f32| Value::from([x, 0.0]);
    let pair = || tuple([discrete(3, 1, DType::I64), text(2, "ab")]);
    let named = || dict([("a", discrete(3, 0, DType::I64)), ("b", text(2, "ab"))]);
    let choice = || one_of([discrete(3, 0, DType::I64), text(2, "ab")]);
    let entries = |a: Value, b: Value| Value::Dict(vec![("a".into(), a), ("b".into(), b)]);
    let mut wrong = Vec::new();
    for (space, value, words) in [
        (discrete(3, 1, DType::I64), int(0), "1 and 3"),
        (discrete(3, 1, DType::I64), int(4), "1 and 3"),
        (discrete(3, 1, DType::I64), word("a"), "a whole number"),
        (uniform(-1.0, 1.0, &[2], DType::F32), number(1.5), "1.5"),
        (uniform(-1.0, 1.0, &[2], DType::F32), number(-1.5), "-1.5"),
        (
            uniform(-1.0, 1.0, &[2], DType::F32),
            number(f32::NAN),
            "nan",
        ),
        (uniform(-1.0, 1.0, &[3], DType::F32), number(0.0), "(3,)"),
        (bits(&[2]), Value::from([0_i8, 2]), "2 is neither 0 nor 1"),
        (bits(&[2]), Value::from([-1_i8, 1]), "-1 is neither 0 nor 1"),
        (text(3, "ab"), int(1), "a text"),
        (text(3, "ab"), word("abca"), "4"),
        (text(3, "ab"), word(""), "0"),
        (text(3, "ab"), word("ac"), "'c' is not among the characters"),
        (pair(), Value::Tuple(vec![int(1)]), "1"),
        (pair(), Value::Tuple(vec![int(4), word("a")]), "[0]"),
        (pair(), Value::Tuple(vec![int(3), word("c")]), "[1]"),
        (pair(), int(1), "a tuple"),
        (named(), entries(int(3), word("a")), "a"),
        (named(), entries(int(2), word("aba")), "b"),
        (named(), Value::Dict(vec![("a".into(), int(0))]), "b"),
        (named(), int(1), "a dict"),
        (choice(), int(1), "an index with a value"),
        (
            choice(),
            Value::OneOf(2, Box::new(int(0))),
            "the index 2 is not between 0 and 1",
        ),
        (choice(), Value::OneOf(1, Box::new(int(0))), "a text"),
        (choice(), Value::OneOf(0, Box::new(int(3))), "0 and 2"),
    ] {
        let told = space.check(&value).err().map(|error| error.to_string());
        if !told.as_deref().is_some_and(|told| told.contains(words)) {
            wrong.push(format!("{value} in {space}: {told:?}"));
        }
        assert!(!space.contains(&value), "{value} in {space}");
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// What no space has is refused, one case for each part of a condition.
#[test]
fn impossible_spaces_are_refused() {
    fn refused<T>(made: gym_core::Result<T>, words: &str) {
        let told = made.err().map(|error| error.to_string());
        assert!(
            told.as_deref().is_some_and(|told| told.contains(words)),
            "{words}: {told:?}"
        );
    }
    refused(Discrete::new(0), "has no elements: n must be at least 1");
    refused(Discrete::new(-1), "has no elements: n must be at least 1");
    refused(Discrete::new(3).unwrap().with_dtype(DType::F32), "float32");
    refused(
        MultiDiscrete::new([3.5_f64]),
        "give whole numbers that fit int64",
    );
    refused(MultiDiscrete::new([3, 0]), "[1]: n is 0");
    let two = || MultiDiscrete::new([3, 4]).unwrap();
    refused(
        two().with_start([1]),
        "start has shape (1,) and nvec has shape (2,)",
    );
    refused(
        two().with_start([1, 2, 3]),
        "start has shape (3,) and nvec has shape (2,)",
    );
    refused(two().with_dtype(DType::F64), "float64");
    refused(MultiBinary::new([2, 0]), "cannot have shape (2, 0)");
    refused(OneOfSpace::new([]), "OneOf() has no spaces to choose from");
    refused(TextSpace::new(3, 2), "from 3 to 2");
    let empty = TextSpace::new(1, 2).unwrap().with_charset("");
    refused(empty, "the character set of a text is empty");
    let twice = ["a", "b", "a"].map(|key| (key, discrete(2, 0, DType::I64)));
    refused(DictSpace::new(twice), "a");
}
