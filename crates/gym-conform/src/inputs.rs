//! Actions: elements of a space, its corners, and values outside of it.

use gym_core::spaces::BoxSpace;
use gym_core::{Array, DType, Data, Space, Value};

/// Returns the first and last elements of a space of numbers; of a box also two mixed corners.
pub(crate) fn corners(space: &Space) -> Vec<Value> {
    const FIRST: i64 = 8;
    match space {
        Space::Discrete(space) => {
            let end = space.start().saturating_add(FIRST).min(space.last());
            (space.start()..end)
                .chain([space.last()])
                .map(Value::Int)
                .collect()
        }
        Space::Box(space) if space.is_bounded() => {
            (0..4).filter_map(|which| corner(space, which)).collect()
        }
        Space::MultiDiscrete(space) => {
            let last = space
                .start()
                .iter()
                .zip(space.nvec())
                .map(|(start, n)| start.saturating_add(n - 1));
            let corners = [space.start().to_vec(), last.collect()].into_iter();
            let array = |data| Array::new(space.shape(), Data::from_i64(space.dtype(), data)).ok();
            corners.filter_map(array).map(Value::Array).collect()
        }
        _ => Vec::new(),
    }
}

/// Returns one of four corners of a box: all low, all high, or alternating.
fn corner(space: &BoxSpace, which: usize) -> Option<Value> {
    let is_high = |i: usize| {
        if i.is_multiple_of(2) {
            which & 1 != 0
        } else {
            which & 2 != 0
        }
    };
    let bounds = space
        .low()
        .iter_f64()
        .zip(space.high().iter_f64())
        .enumerate();
    let corner = bounds.map(|(i, (low, high))| if is_high(i) { high } else { low });
    Array::new(space.shape(), Data::from_f64(space.dtype(), corner))
        .ok()
        .map(Value::Array)
}

/// Returns finite actions beyond the bounds of a box.
pub(crate) fn huge(space: &Space) -> Vec<Value> {
    let Space::Box(numbers) = space else {
        return Vec::new();
    };
    let (lowest, highest) = numbers.dtype().finite_range();
    [-10.0, 10.0, -1e30, 1e30, lowest, highest]
        .into_iter()
        .filter_map(|x| uniform(space, x))
        .collect()
}

/// Returns an array of the shape of a box whose numbers are all `x`.
pub(crate) fn uniform(space: &Space, x: f64) -> Option<Value> {
    let Space::Box(space) = space else {
        return None;
    };
    let data = Data::from_f64(space.dtype(), vec![x; space.low().len()]);
    Array::new(space.shape(), data).ok().map(Value::Array)
}

/// Returns invalid actions: of another type or shape, out of the range of a discrete space, or not
/// finite.
pub(crate) fn invalid(space: &Space, valid: &Value) -> Vec<Value> {
    let mut actions = vec![
        Value::Null,
        Value::Bool(true),
        Value::Int(i64::MIN),
        Value::Int(i64::MAX),
        Value::Float(0.5),
        Value::Float(f64::NAN),
        Value::Text("left".into()),
        Value::Array(Array::default()),
        Value::Tuple(vec![]),
        Value::Dict(vec![("a".into(), Value::Int(0))]),
        Value::OneOf(usize::MAX, Box::new(Value::Null)),
    ];
    // an environment may convert these for a box
    if !matches!(space, Space::Box(_)) {
        actions.push(Value::Array([0.5f64, 0.5].into()));
    }
    if let Space::Discrete(space) = space {
        actions.extend(space.start().checked_sub(1).map(Value::Int));
        actions.extend(space.last().checked_add(1).map(Value::Int));
    }
    if let Value::Array(array) = valid {
        let (dtype, shape) = (array.dtype(), array.shape());
        actions.extend(wrong_elements(space, array));
        for float in [DType::F32, DType::F64] {
            let not_a_number = Data::from_f64(float, vec![f64::NAN; array.len()]);
            actions.extend(Array::new(shape, not_a_number).map(Value::Array));
        }
        let others = [
            Array::zeros(dtype, [shape, &[2]].concat()),
            Array::zeros(dtype, [array.len() + 1]),
            Array::zeros(DType::F64, [array.len() + 1]),
        ];
        actions.extend(others.into_iter().flatten().map(Value::Array));
    }
    // some of these may be elements of the space
    actions.retain(|action| !space.contains(action));
    actions
}

/// Returns copies of `valid` in which one element is invalid.
fn wrong_elements(space: &Space, valid: &Array) -> Vec<Value> {
    /// The number of elements that are tried; an image has thousands.
    const MAX: usize = 16;
    let (dtype, shape) = (valid.dtype(), valid.shape());
    let elements = 0..valid.len().min(MAX);
    let arrays: Vec<_> = match space {
        Space::Box(_) if dtype.is_float() => elements
            .flat_map(|i| [f64::NAN, f64::INFINITY, f64::NEG_INFINITY].map(|x| (i, x)))
            .map(|(i, x)| {
                let mut numbers: Vec<f64> = valid.iter_f64().collect();
                numbers[i] = x;
                Data::from_f64(dtype, numbers)
            })
            .collect(),
        Space::MultiDiscrete(space) => elements
            .flat_map(|i| {
                let (start, n) = (space.start()[i], space.nvec()[i]);
                [
                    start.saturating_sub(1),
                    start.saturating_add(n),
                    i64::MIN,
                    i64::MAX,
                ]
                .map(|x| (i, x))
            })
            .map(|(i, x)| {
                let mut numbers = space.start().to_vec();
                numbers[i] = x;
                Data::from_i64(dtype, numbers)
            })
            .collect(),
        _ => Vec::new(),
    };
    arrays
        .into_iter()
        .filter_map(|data| Array::new(shape, data).ok())
        .map(Value::Array)
        .collect()
}
