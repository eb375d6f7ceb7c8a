//! What constructors make of each argument, in full: the space as JSON, or why there is none. What
//! several spaces are together.
//!
//! After an intended change, store the new texts with
//! `GYM_UPDATE_KEPT=1 cargo test --package rust-gym-core --test it made`.

use std::fmt::{Display, Write};
use std::path::Path;

use gym_core::spaces::{
    BoxSpace, DictSpace, Discrete, GraphSpace, MissionSpace, MultiBinary, MultiDiscrete,
    OneOfSpace, SequenceSpace, TextSpace, TupleSpace,
};
use gym_core::{Array, DType, Result, Space};
use gym_testing::kept;

use crate::spaces::many;

pub(crate) const TYPES: [DType; 10] = [
    DType::I8,
    DType::U8,
    DType::I16,
    DType::U16,
    DType::I32,
    DType::U32,
    DType::I64,
    DType::U64,
    DType::F32,
    DType::F64,
];

fn keep(name: &str, told: &str) {
    kept(
        &Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("tests/it")
            .join(name),
        told,
    );
}

/// The lines of a text that grows.
#[derive(Default)]
struct Told(String);

impl Told {
    fn space<S: Into<Space>>(&mut self, what: impl Display, made: Result<S>) {
        match made.map(Into::into) {
            Ok(space) => {
                let stored = serde_json::to_string(&space).unwrap();
                writeln!(self.0, "{what}: {space} {stored}").unwrap();
            }
            Err(error) => writeln!(self.0, "{what}: {error}").unwrap(),
        }
    }
}

#[test]
fn a_box_has_the_bounds_of_its_arguments_in_its_type() {
    let (inf, nan) = (f64::INFINITY, f64::NAN);
    let mut told = Told::default();
    for dtype in TYPES {
        for (low, high) in [
            (-1.0, 1.0),
            (0.0, 0.0),
            (1.0, 0.0),
            (0.5, 2.5),
            (0.0, 300.0),
            (-inf, inf),
            (inf, inf),
            (-1e300, 1e300),
            (0.0, nan),
        ] {
            let what = format!("{low:?} to {high:?}, {dtype}");
            let uniform = |shape: &[usize]| BoxSpace::uniform(low, high, shape, dtype);
            told.space(format!("{what}, uniform"), uniform(&[2]));
            if uniform(&[2]).is_err() || low == -1.0 {
                told.space(format!("{what}, a number"), uniform(&[]));
                told.space(format!("{what}, empty"), uniform(&[0, 3]));
            }
            // the second bound of two, so that no place is always the first
            let second = BoxSpace::with_dtype([0.0, low], [1.0, high], dtype);
            told.space(format!("{what}, second"), second);
        }
        let one = |shape: &[usize]| Array::zeros(dtype, shape).unwrap();
        told.space("other shapes", BoxSpace::new(one(&[2]), one(&[1, 2])));
        told.space(
            "other types",
            BoxSpace::new(one(&[1]), Array::from([1_i16])),
        );
    }
    keep("made_boxes.txt", &told.0);
}

#[test]
fn other_spaces_are_what_their_arguments_say() {
    let mut told = Told::default();
    for dtype in TYPES {
        for (n, start) in [
            (0, 0),
            (-3, 0),
            (1, -1),
            (3, 126),
            (256, 0),
            (2, i64::MAX - 1),
            (2, i64::MAX),
        ] {
            let what = format!("{n} from {start}, {dtype}");
            let one = Discrete::new(n).and_then(|one| one.with_start(start)?.with_dtype(dtype));
            told.space(format!("{what}, one"), one);
            let two = MultiDiscrete::new([3, n])
                .and_then(|two| two.with_dtype(dtype))
                .and_then(|two| two.with_start([0, start]));
            told.space(format!("{what}, second"), two);
        }
    }
    let pairs = MultiDiscrete::new(Array::from([2_i64, 3])).unwrap();
    told.space("start of one", pairs.clone().with_start([1_i64]));
    told.space("start of three", pairs.clone().with_start([1_i64, 2, 3]));
    told.space("half a start", pairs.with_start([1.0, 0.5]));
    told.space("half a number", MultiDiscrete::new([2.0, 1.5]));
    for (least, most) in [(0, 0), (0, 5), (2, 1), (3, 3)] {
        for charset in ["", "a", "ba", "aba", "é\n"] {
            let text = TextSpace::new(least, most).and_then(|text| text.with_charset(charset));
            told.space(format!("text {least} {most} {charset:?}"), text);
        }
        told.space(format!("text {least} {most}"), TextSpace::new(least, most));
    }
    for shape in [vec![], vec![0], vec![2, 3], vec![1 << 40, 1 << 40]] {
        told.space(format!("bits {shape:?}"), MultiBinary::new(shape.clone()));
        let floats = BoxSpace::uniform(0.0, 1.0, shape.clone(), DType::F32);
        if shape.len() < 2 {
            told.space(format!("numbers {shape:?}"), floats);
        } else {
            told.space(
                format!("numbers {shape:?}"),
                floats.map(|_| Space::discrete(1)),
            );
        }
    }
    let [one, two] = [1, 2].map(Space::discrete);
    let both = [("b", one.clone()), ("a", two.clone())];
    told.space("dict", DictSpace::new(both.clone()));
    told.space("dict in order", DictSpace::in_order(both));
    for key in ["a", ""] {
        let twice = [(key, one.clone()), ("c", two.clone()), (key, two.clone())];
        told.space(format!("{key:?} twice"), DictSpace::new(twice.clone()));
        told.space(
            format!("{key:?} twice in order"),
            DictSpace::in_order(twice),
        );
    }
    told.space("no choice", OneOfSpace::new([]));
    told.space("no members", Ok(TupleSpace::new([])));
    told.space("no keys", DictSpace::new::<String>([]));
    for node in many() {
        told.space("nodes", GraphSpace::new(node.clone(), None));
        told.space("edges", GraphSpace::new(two.clone(), Some(node)));
    }
    for (pattern, words) in [
        ("go to {}", vec![vec!["a", "b"]]),
        ("go to {}", vec![]),
        ("go", vec![vec!["a"]]),
        ("{} {}", vec![vec!["a"], vec![]]),
        ("{} {}", vec![vec!["a"], vec!["b", "c", "b"]]),
    ] {
        told.space(
            format!("mission {pattern}"),
            MissionSpace::new(pattern, words),
        );
    }
    keep("made_spaces.txt", &told.0);
}

/// Spaces of which some have one form.
fn alike() -> Vec<Space> {
    let boxed = |low: f64, high: f64, shape: &[usize], dtype| {
        Space::from(BoxSpace::uniform(low, high, shape, dtype).unwrap())
    };
    let whole = |n, start, dtype| {
        let discrete =
            Discrete::new(n).and_then(|space| space.with_start(start)?.with_dtype(dtype));
        Space::from(discrete.unwrap())
    };
    let multi = |nvec: [i64; 2]| Space::from(MultiDiscrete::new(nvec).unwrap());
    let text = |most, charset: &str| {
        Space::from(
            TextSpace::new(1, most)
                .and_then(|text| text.with_charset(charset))
                .unwrap(),
        )
    };
    let dict = |a: &str, space: &Space| -> Space {
        DictSpace::new([(a, space.clone()), ("z", Space::discrete(2))])
            .unwrap()
            .into()
    };
    let of = |space: &Space| -> Vec<Space> {
        vec![
            TupleSpace::new([Space::discrete(2), space.clone()]).into(),
            dict("a", space),
            SequenceSpace::new(space.clone()).into(),
            SequenceSpace::stacked(space.clone()).into(),
            OneOfSpace::new([space.clone()]).unwrap().into(),
        ]
    };
    let leaves = vec![
        boxed(0.0, 1.0, &[2], DType::F32),
        boxed(-2.0, 3.0, &[2], DType::F32),
        boxed(0.0, 1.0, &[2], DType::F64),
        boxed(0.0, 1.0, &[2, 1], DType::F32),
        whole(3, 0, DType::I64),
        whole(5, -1, DType::I8),
        whole(5, 300, DType::I32),
        multi([2, 3]),
        multi([4, 1]),
        Space::from(MultiBinary::new([2]).unwrap()),
        text(3, "ab"),
        text(3, "ba"),
        text(4, "ab"),
    ];
    let mut spaces = leaves.clone();
    for leaf in [&leaves[0], &leaves[1], &leaves[5], &leaves[10]] {
        spaces.extend(of(leaf));
    }
    spaces.push(dict("b", &leaves[0]));
    for (node, edge) in [
        (4, None),
        (5, None),
        (4, Some(4)),
        (4, Some(5)),
        (4, Some(0)),
    ] {
        let edge: Option<Space> = edge.map(|i: usize| leaves[i].clone());
        spaces.push(GraphSpace::new(leaves[node].clone(), edge).unwrap().into());
    }
    spaces
}

/// Gymnasium's rules, and the whole refusal of what has no batch.
#[test]
fn two_spaces_have_one_batch_if_they_differ_in_bounds() {
    let mut told = String::new();
    let alike = alike();
    for a in &alike {
        for b in &alike {
            // the third has the bounds of the second
            let batch = Space::batch_differing(&[a.clone(), b.clone(), b.clone()]);
            let form = if a.has_form_of(b) {
                "alike"
            } else {
                "not alike"
            };
            assert_eq!(a.has_form_of(b), b.has_form_of(a), "{a} and {b}");
            match batch {
                Ok(batch) => {
                    let dtypes = [batch.dtype(), a.dtype()];
                    writeln!(told, "{a} and {b}, {form}: {batch} {dtypes:?}").unwrap();
                    if a == b {
                        assert_eq!(batch, a.batch(3).unwrap());
                    }
                }
                Err(_) if std::mem::discriminant(a) != std::mem::discriminant(b) => {}
                Err(error) => writeln!(told, "{a} and {b}, {form}: {error}").unwrap(),
            }
        }
    }
    for batch in [
        Space::batch_differing(&[]),
        Space::batch_differing(&[alike[0].clone(), alike[4].clone()]),
    ] {
        writeln!(told, "{}", batch.unwrap_err()).unwrap();
    }
    keep("differing.txt", &told);
}
