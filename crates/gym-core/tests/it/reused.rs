//! What is written into a value does not depend on what it held before.

use gym_core::spaces::ActionColumn;
use gym_core::{Array, Continuous, DType, Data, Element, Space, Value};

use crate::spaces::many;

/// Values of every kind; some have the number of elements of another, in another shape.
fn before() -> Vec<Value> {
    let mut all: Vec<Value> = many()
        .iter()
        .map(|space| space.sampler(5).sample())
        .collect();
    for (dtype, shape) in [
        (DType::F32, vec![3, 2]),
        (DType::F32, vec![6]),
        (DType::F32, vec![1, 6]),
        (DType::F64, vec![2, 3]),
        (DType::I64, vec![2]),
        (DType::I64, vec![3]),
        (DType::I8, vec![4]),
        (DType::U8, vec![0]),
    ] {
        all.push(Value::Array(Array::zeros(dtype, shape).unwrap()));
    }
    all.extend([
        Value::Null,
        Value::Bool(true),
        Value::Int(7),
        Value::Float(0.5),
        Value::Text("long before".into()),
        Value::Tuple(vec![]),
        Value::Tuple(vec![Value::Int(1); 5]),
        Value::Dict(vec![("other".into(), Value::Int(1))]),
    ]);
    all
}

/// The typed form of `value`, written over each of `before`.
fn rewritten<E: Element>(value: &E, before: &[Value]) {
    let fresh = value.to_value();
    assert_eq!(E::from_value(&fresh).as_ref(), Some(value), "{fresh}");
    assert_eq!(E::with(&fresh, E::clone).as_ref(), Some(value), "{fresh}");
    for old in before {
        let mut out = old.clone();
        value.write(&mut out);
        assert_eq!(out, fresh, "over {old}");
        let mut out = old.clone();
        E::fill(&mut out, |element| element.clone_from(value));
        assert_eq!(out, fresh, "filled over {old}");
    }
}

gym_core::discrete! {
    /// Two ways.
    enum Way {
        /// One.
        Up,
        /// The other.
        Down,
    }
}

#[test]
fn a_typed_element_is_written_over_any_value() {
    let before = before();
    rewritten(&3_i64, &before);
    rewritten(&3_u8, &before);
    rewritten(&3_u32, &before);
    rewritten(&3_usize, &before);
    rewritten(&[0.5_f32, 1.0], &before);
    rewritten(&[1_i64, 2, 3], &before);
    rewritten(&String::from("now"), &before);
    rewritten(&Way::Down, &before);
    assert_eq!(Way::space(), Space::discrete(Way::VARIANTS.len() as i64));
    rewritten(&(1_i64, [2.0_f64]), &before);
    rewritten(&(1_i64, String::from("b"), [3_i8; 3]), &before);
    rewritten(&(1_i64, 2_i64, 3_i64, 4_i64), &before);
    rewritten(&Continuous::from([0.5_f32, 1.0]), &before);
    rewritten(&Continuous::from([0.1_f64, 1.0, 2.0]), &before);
    for value in &before {
        rewritten(value, &before);
        if let Value::Array(array) = value {
            rewritten(array, &before);
        }
    }
}

/// A tuple has the number of members of its type, neither more nor less.
#[test]
fn a_typed_tuple_has_its_length() {
    let ints = |n: usize| Value::Tuple(vec![Value::Int(1); n]);
    for n in 0..6 {
        let found = [
            <(i64, i64)>::from_value(&ints(n)).is_some(),
            <(i64, i64, i64)>::from_value(&ints(n)).is_some(),
            <(i64, i64, i64, i64)>::from_value(&ints(n)).is_some(),
        ];
        assert_eq!(found, [n == 2, n == 3, n == 4], "{n} members");
        let array = Value::from(vec![1_i64; n]);
        assert_eq!(<[i64; 2]>::from_value(&array).is_some(), n == 2);
        assert_eq!(
            Continuous::<3>::from_value(&Value::from(vec![1.0; n])).is_some(),
            n == 3
        );
    }
    // a member of another kind, the last
    let mixed = Value::Tuple(vec![Value::Int(1), Value::Text("b".into())]);
    assert_eq!(<(i64, i64)>::from_value(&mixed), None);
}

#[test]
fn samples_and_rows_are_written_over_any_value() {
    let before = before();
    for space in many() {
        let sample = space.sampler(3).sample();
        let (mut two, other) = (space.empty_batch(2).unwrap(), space.sampler(4).sample());
        space.write_row(&mut two, 0, &other).unwrap();
        space.write_row(&mut two, 1, &sample).unwrap();
        assert_eq!(
            two,
            space.concatenate(&[other, sample.clone()]).unwrap(),
            "{space}"
        );
        let real = {
            let mut real = Value::Null;
            space
                .real_action(&sample, None, &mut real)
                .is_ok()
                .then_some(real)
        };
        let flat = space.flatten(&sample).unwrap();
        for old in &before {
            let mut out = old.clone();
            space.sampler(3).sample_into(&mut out);
            assert_eq!(out, sample, "{space} over {old}");
            let mut out = old.clone();
            space.read_row(&two, 1, &mut out).unwrap();
            assert_eq!(out, sample, "a row of {space} over {old}");
            let mut out = old.clone();
            space.read_action(&two, 1, &mut out).unwrap();
            assert_eq!(out, sample, "an action of {space} over {old}");
            if let Some(real) = &real {
                let mut out = old.clone();
                space.real_action(&sample, None, &mut out).unwrap();
                assert_eq!(out, *real, "numbers of {space} over {old}");
            }
            if let (Value::Array(old), Value::Array(flat)) = (old, &flat)
                && (old.shape(), old.dtype()) == (flat.shape(), flat.dtype())
            {
                let mut out = old.clone();
                space.flatten_into(&sample, &mut out).unwrap();
                assert!(
                    out.iter_f64().eq(flat.iter_f64()),
                    "flat {space} over {old}"
                );
            }
        }
    }
}

/// Actions of a box of real numbers, in each form that a batch may have.
#[test]
fn an_action_is_read_from_the_second_row_of_any_batch() {
    let space = Space::boxed([-1.0; 2], [1.0; 2]);
    let [first, second] = [[0.25_f32, 0.5], [0.75, 1.0]];
    let single = Array::new([2, 2], Data::F32([first, second].concat())).unwrap();
    let double: Vec<f64> = single.iter_f64().collect();
    let double = Array::new([2, 2], Data::F64(double)).unwrap();
    let each = Value::Tuple(vec![first.into(), second.into()]);
    for (batch, expected) in [
        (Value::Array(single), Value::from(second)),
        (Value::Array(double), Value::from(second.map(f64::from))),
        (each, Value::from(second)),
    ] {
        for old in before() {
            let mut out = old.clone();
            space.read_action(&batch, 1, &mut out).unwrap();
            assert_eq!(out, expected, "{batch} over {old}");
            assert!(space.read_action(&batch, 2, &mut out).is_err(), "{batch}");
        }
        space.check_actions(&batch, 2).unwrap();
        assert!(Continuous::<2>::items(&batch, 2).is_some(), "{batch}");
        for n in [1, 3] {
            assert!(space.check_actions(&batch, n).is_err(), "{n} of {batch}");
            assert!(
                Continuous::<2>::items(&batch, n).is_none(),
                "{n} of {batch}"
            );
        }
    }
}
