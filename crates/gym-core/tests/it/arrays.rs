//! Arrays of each type of numbers: their bytes, their places, and what is written into them.

use std::io::Cursor;

use gym_core::{Array, DType, Data, Value};

use crate::made::TYPES;

/// Numbers that every type has.
const NUMBERS: [f64; 6] = [0.0, 1.0, 2.0, 3.0, 100.0, 127.0];

fn array(dtype: DType, numbers: &[f64]) -> Array {
    Array::new([numbers.len()], Data::from_f64(dtype, numbers.to_vec())).unwrap()
}

fn numbers(array: &Array) -> Vec<f64> {
    array.iter_f64().collect()
}

#[test]
fn an_array_has_as_many_numbers_as_its_shape() {
    for dtype in TYPES {
        for len in 0..8 {
            let data = || Data::from_f64(dtype, vec![1.0; len]);
            for shape in [
                vec![],
                vec![0],
                vec![1],
                vec![6],
                vec![2, 3],
                vec![3, 1, 2],
                vec![4, 0],
            ] {
                let made = Array::new(shape.clone(), data());
                let reshaped = Array::new([len], data()).unwrap().reshape(shape.clone());
                assert_eq!(made.is_ok(), shape.iter().product::<usize>() == len);
                match made {
                    Ok(array) => {
                        assert_eq!((array.shape(), array.dtype()), (&shape[..], dtype));
                        assert_eq!((array.len(), array.is_empty()), (len, len == 0));
                        assert_eq!(reshaped.unwrap(), array);
                    }
                    Err(error) => {
                        let told = format!("shape {shape:?} does not hold {len} numbers");
                        assert_eq!(error.to_string(), told);
                        assert_eq!(reshaped.unwrap_err().to_string(), told);
                    }
                }
            }
        }
    }
}

/// The bytes of a number, the lowest first.
fn bytes(dtype: DType, x: f64) -> Vec<u8> {
    match dtype {
        DType::F32 => (x as f32).to_le_bytes().to_vec(),
        DType::F64 => x.to_le_bytes().to_vec(),
        whole => (x as i64).to_le_bytes()[..whole.size()].to_vec(),
    }
}

#[test]
fn bytes_are_those_of_each_number_in_turn() {
    for dtype in TYPES {
        let own = array(dtype, &NUMBERS);
        let all: Vec<u8> = NUMBERS.iter().flat_map(|x| bytes(dtype, *x)).collect();
        assert_eq!(own.to_bytes(), all);
        let read = |shape: &[usize], bytes: &[u8]| Array::from_bytes(dtype, shape, bytes);
        assert_eq!(read(&[6], &all), Some(own.clone()));
        assert_eq!(read(&[2, 3], &all).unwrap().shape(), [2, 3]);
        assert_eq!(read(&[5], &all), None);
        for wrong in [&all[1..], &[&all[..], &[0]].concat(), &[]] {
            assert_eq!(read(&[6], wrong), None);
            let mut filled = own.clone();
            assert!(!filled.fill_bytes(wrong));
            assert_eq!(filled, own);
        }
        let mut filled = array(dtype, &[7.0; 6]);
        assert!(filled.fill_bytes(&all));
        assert_eq!(filled, own);
        // the second of two arrays in a stream, and one that ends too early
        let mut stream = Cursor::new([&all[..], &all[..all.len() - 1]].concat());
        let mut first = array(dtype, &[7.0; 6]);
        first.read_from(&mut stream).unwrap();
        assert_eq!(first, own);
        assert_eq!(stream.position(), all.len() as u64);
        assert!(first.read_from(&mut stream).is_err());
    }
}

#[test]
fn an_index_has_its_number_and_others_have_none() {
    for dtype in TYPES {
        let own = array(dtype, &NUMBERS).reshape([1, 2, 3]).unwrap();
        for i in 0..2 {
            for j in 0..3 {
                for k in 0..4 {
                    let known = (i < 1 && j < 2 && k < 3).then(|| NUMBERS[3 * j + k]);
                    assert_eq!(own.get([i, j, k]), known, "{i} {j} {k}");
                }
            }
        }
        assert_eq!(
            (own.get([0]), own.get([0, 0]), own.get([0; 4])),
            (None, None, None)
        );
        let mut all = own.iter_f64();
        for left in (0..=6).rev() {
            assert_eq!((all.len(), all.size_hint()), (left, (left, Some(left))));
            assert_eq!(all.next().is_some(), left > 0);
        }
        assert!(own.has_shape(&[1, 2, 3]) && !own.has_shape(&[2, 3]) && !own.has_shape(&[1, 2, 4]));
    }
}

/// Whole numbers wrap around, and others lose what is behind the point.
#[test]
fn numbers_are_cast_as_numpy_casts_them() {
    for from in TYPES {
        for to in TYPES {
            let mut out = array(to, &[7.0; 6]);
            out.assign_cast(&array(from, &NUMBERS)).unwrap();
            assert_eq!((out.dtype(), numbers(&out)), (to, NUMBERS.to_vec()));
            let error = out.assign_cast(&array(from, &NUMBERS[1..])).unwrap_err();
            assert!(
                error
                    .to_string()
                    .ends_with("an array has 5 numbers and should have 6"),
                "{error}"
            );
        }
    }
    let wrapped = [(DType::I8, 44.0), (DType::U8, 44.0), (DType::I16, 300.0)];
    for (to, known) in wrapped {
        for from in [DType::I16, DType::U16, DType::I32, DType::I64, DType::U64] {
            let mut out = array(to, &[0.0]);
            out.assign_cast(&array(from, &[300.0])).unwrap();
            assert_eq!(numbers(&out), [known], "{from} to {to}");
        }
    }
    for (to, known) in [
        (DType::U8, 255.0),
        (DType::U16, 65535.0),
        (DType::I32, -1.0),
    ] {
        let mut out = array(to, &[0.0]);
        out.assign_cast(&array(DType::I8, &[-1.0])).unwrap();
        assert_eq!(numbers(&out), [known], "{to}");
    }
    for dtype in TYPES {
        let is_real = [DType::F32, DType::F64].contains(&dtype);
        let known = |x: f64| if is_real { x } else { x.trunc() };
        for x in [0.0, 0.5, 1.75, 100.25] {
            let mut out = array(dtype, &[7.0; 3]);
            out.assign_cast(&array(DType::F64, &[x; 3])).unwrap();
            assert_eq!(numbers(&out), [known(x); 3], "{dtype}");
            assert_eq!(numbers(&array(dtype, &[x])), [known(x)], "{dtype}");
            let mut out = array(dtype, &[7.0; 3]);
            out.set_f64(1, x);
            out.set_f64(3, x);
            assert_eq!(numbers(&out), [7.0, known(x), 7.0], "{dtype}");
        }
    }
}

#[test]
fn numbers_are_clipped_filled_and_compared_in_each_type() {
    for dtype in TYPES {
        let own = |numbers: &[f64]| array(dtype, numbers);
        // each row of a batch has the bounds
        let mut batch = own(&NUMBERS).reshape([2, 3]).unwrap();
        batch.clip(&own(&[1.0, 0.0, 5.0]), &own(&[2.0, 1.0, 6.0]));
        assert_eq!(numbers(&batch), [1.0, 1.0, 5.0, 2.0, 1.0, 6.0], "{dtype}");
        let mut most = own(&NUMBERS);
        most.maximum(&own(&[1.0, 1.0, 1.0, 4.0, 99.0, 127.0]));
        assert_eq!(
            numbers(&most),
            [1.0, 1.0, 2.0, 4.0, 100.0, 127.0],
            "{dtype}"
        );
        let mut filled = own(&NUMBERS);
        filled.fill_int(5);
        assert_eq!(filled, own(&[5.0; 6]));
        assert!(filled.is_finite());
    }
    for dtype in [DType::F32, DType::F64] {
        let nan = array(dtype, &[1.0, f64::NAN, 3.0]);
        let (mut clipped, mut most) = (nan.clone(), array(dtype, &[2.0; 3]));
        clipped.clip(&array(dtype, &[2.0; 3]), &array(dtype, &[2.5; 3]));
        assert_eq!(format!("{:?}", numbers(&clipped)), "[2.0, NaN, 2.5]");
        most.maximum(&nan);
        assert_eq!(format!("{:?}", numbers(&most)), "[2.0, NaN, 3.0]");
        let mut of_nan = nan.clone();
        of_nan.maximum(&array(dtype, &[2.0; 3]));
        assert_eq!(format!("{:?}", numbers(&of_nan)), "[2.0, NaN, 3.0]");
        for x in [f64::NAN, f64::INFINITY, -f64::INFINITY] {
            assert!(!array(dtype, &[1.0, x]).is_finite());
        }
    }
}

/// Each accessor of a value has what is in the value, and nothing of others.
#[test]
fn a_value_is_read_as_what_it_is() {
    let items = vec![Value::Int(1), Value::Float(0.5)];
    let entries = vec![("a".to_owned(), Value::Int(3)), ("b".into(), Value::Null)];
    let numbers = Array::from([1.0_f32, 2.0]);
    let values = [
        Value::Null,
        Value::Bool(true),
        Value::Int(7),
        Value::Float(0.5),
        Value::Text("t".into()),
        Value::Array(numbers.clone()),
        Value::Tuple(items.clone()),
        Value::Dict(entries),
        Value::OneOf(1, Box::new(Value::Int(2))),
    ];
    let at = |is: &dyn Fn(&Value) -> bool| -> Vec<usize> {
        (0..values.len()).filter(|i| is(&values[*i])).collect()
    };
    assert_eq!(at(&|value| value.as_bool() == Some(true)), [1]);
    assert_eq!(at(&|value| value.as_int() == Some(7)), [2]);
    assert_eq!(at(&|value| value.as_int().is_some()), [2]);
    assert_eq!(at(&|value| value.as_float().is_some()), [2, 3]);
    assert_eq!([2, 3].map(|i| values[i].as_float()), [Some(7.0), Some(0.5)]);
    assert_eq!(at(&|value| value.as_text().is_some()), [4]);
    assert_eq!(at(&|value| value.as_array().is_some()), [5]);
    assert_eq!(at(&|value| value.as_slice::<f32>().is_some()), [5]);
    assert_eq!(
        at(&|value| value.as_slice::<f64>().is_some()),
        [] as [usize; 0]
    );
    assert_eq!(at(&|value| value.as_tuple().is_some()), [6]);
    assert_eq!(at(&|value| value.get("a").is_some()), [7]);
    assert_eq!(at(&|value| value.get("c").is_some()), [] as [usize; 0]);
    assert_eq!(values[4].as_text(), Some("t"));
    assert_eq!(values[5].as_array(), Some(&numbers));
    assert_eq!(values[5].as_slice::<f32>(), Some(&[1.0, 2.0][..]));
    assert_eq!(values[6].as_tuple(), Some(&items[..]));
    assert_eq!(
        (values[7].get("a"), values[7].get("b")),
        (Some(&Value::Int(3)), Some(&Value::Null))
    );
}
