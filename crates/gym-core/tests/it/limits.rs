//! Documented limits of spaces and vectors: the last value that is taken, and the next, which is refused.

use gym_core::spaces::{Discrete, MultiBinary, MultiDiscrete, TextSpace};
use gym_core::vector::AsyncVectorEnv;
use gym_core::{Array, DType, Result, Space, Value};
use gym_testing::Count;

/// The integer types, with their smallest and largest number as far as `i64` has them.
const TYPES: [(DType, i64, i64); 8] = [
    (DType::I8, i8::MIN as i64, i8::MAX as i64),
    (DType::I16, i16::MIN as i64, i16::MAX as i64),
    (DType::I32, i32::MIN as i64, i32::MAX as i64),
    (DType::I64, i64::MIN, i64::MAX),
    (DType::U8, 0, u8::MAX as i64),
    (DType::U16, 0, u16::MAX as i64),
    (DType::U32, 0, u32::MAX as i64),
    (DType::U64, 0, i64::MAX),
];

/// Whether a space is made or, if not, whether the error has the words.
fn is_made<T>(made: Result<T>, words: &str) -> bool {
    match made {
        Ok(_) => true,
        Err(error) => {
            let error = error.to_string();
            assert!(error.contains(words), "{error} has not: {words}");
            false
        }
    }
}

/// The integers from `start` on fit their type, and so does their number, which numpy keeps in the same type.
#[test]
fn integers_fit_their_type() {
    let words = "choose a larger type";
    for (dtype, least, most) in TYPES {
        let one = |n: i64, start: i64| {
            let space = Discrete::new(n).and_then(|space| space.with_start(start));
            is_made(space.and_then(|space| space.with_dtype(dtype)), words)
        };
        // the second element is at fault, and named
        let several = |n: i64, start: i64| {
            let space =
                MultiDiscrete::new([1, n]).and_then(|space| space.with_start([0_i64, start]));
            let made = space.and_then(|space| space.with_dtype(dtype));
            let is_made = is_made(made, words);
            is_made || {
                let space = MultiDiscrete::new([1, n])
                    .unwrap()
                    .with_start([0_i64, start]);
                let error = space.and_then(|space| space.with_dtype(dtype)).unwrap_err();
                assert!(error.to_string().contains("[1]"), "{error}");
                false
            }
        };
        for (n, start) in [(most, 0), (1, most), (1, least), (most, 1), (2, most - 1)] {
            assert!(
                one(n, start) && several(n, start),
                "{dtype}: {n} from {start}"
            );
        }
        let beyond = [
            most.checked_add(1).map(|n| (n, 0)),
            Some((2, most)),
            Some((most, 2)),
        ];
        let below = least.checked_sub(1).map(|start| (1, start));
        for (n, start) in beyond.into_iter().chain([below]).flatten() {
            // the largest integers of all
            if !(dtype == DType::U64 && n == most) {
                assert!(
                    !one(n, start) && !several(n, start),
                    "{dtype}: {n} from {start}"
                );
            }
        }
    }
    for dtype in [DType::F32, DType::F64] {
        let words = "choose an integer type";
        assert!(!is_made(Discrete::new(2).unwrap().with_dtype(dtype), words));
        assert!(!is_made(
            MultiDiscrete::new([2]).unwrap().with_dtype(dtype),
            words
        ));
    }
    assert!(is_made(Discrete::new(1), ""));
    assert!(!is_made(Discrete::new(0), "n must be at least 1"));
    assert!(!is_made(
        MultiDiscrete::new([3, 0]),
        "n is 0 and must be at least 1"
    ));
}

#[test]
fn texts_and_shapes_have_a_largest_size() {
    const MOST: usize = 1 << 28;
    assert!(is_made(TextSpace::new(MOST, MOST), ""));
    assert!(!is_made(
        TextSpace::new(1, MOST + 1),
        "a text of 268435457 characters is too long: at most 268435456 are possible"
    ));
    assert!(!is_made(TextSpace::new(3, 2), "run from 3 to 2"));
    assert!(!is_made(
        TextSpace::new(0, 2).unwrap().with_charset(""),
        "is empty"
    ));
    assert!(is_made(MultiBinary::new([MOST / 4, 4]), ""));
    assert!(!is_made(
        MultiBinary::new([MOST / 4 + 1, 4]),
        "too many elements: at most 268435456 are possible"
    ));
    for (axes, fits) in [(64, true), (65, false)] {
        let words = format!("the shape has {axes} axes: at most 64 are possible");
        assert_eq!(is_made(MultiBinary::new(vec![1; axes]), &words), fits);
        assert_eq!(
            Array::zeros(DType::F32, vec![1; axes]).is_ok(),
            fits,
            "{axes}"
        );
    }
}

/// A list of spaces has two levels, a list of texts' and numbers' spaces four more and their axes.
#[test]
fn spaces_are_stored_up_to_a_depth() {
    let nested = |depth: usize, axes: usize| {
        let inner = Space::from(MultiBinary::new(vec![1; axes]).unwrap());
        (0..depth).fold(inner, |space, _| {
            Space::from(gym_core::spaces::TupleSpace::new([space]))
        })
    };
    let stored = |space: &Space| serde_json::to_string(space);
    // 112 levels: 53 times two, four, and two axes
    let deepest = nested(53, 2);
    let text = stored(&deepest).unwrap();
    assert_eq!(serde_json::from_str::<Space>(&text).unwrap(), deepest);
    for beyond in [nested(54, 2), nested(53, 3)] {
        let error = stored(&beyond).unwrap_err().to_string();
        assert!(error.contains("more than 112 levels"), "{error}");
    }
}

#[test]
fn an_async_vector_has_from_one_to_1024_threads() {
    let vector = || AsyncVectorEnv::new((0..2).map(|_| Count::default())).unwrap();
    for (threads, fits) in [
        (0, false),
        (1, true),
        (2, true),
        (1024, true),
        (1025, false),
    ] {
        let words = format!("threads is {threads}: it must be from 1 to 1024");
        let made = vector().with_threads(threads);
        assert_eq!(is_made(made, &words), fits, "{threads}");
    }
    // what was refused changes nothing, and more threads than environments are no more
    let mut envs = vector().with_threads(1024).unwrap();
    let columns = gym_core::VectorEnvExt::reset(&mut envs, 0).unwrap();
    assert_eq!(columns.observations, Value::from([0_i64, 0]));
}
