//! Actions: elements of a space, its corners, and values outside of it.

use gym_core::spaces::BoxSpace;
use gym_core::{Array, DType, Data, Space, Value};

/// Returns the first and last elements of a space of numbers; for a box, also two mixed corners, its
/// middle and zeros.
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
        Space::Box(numbers) => {
            let mut corners = match numbers.is_bounded() {
                true => (0..4).filter_map(|which| corner(numbers, which)).collect(),
                false => Vec::new(),
            };
            // the middle, and zeros
            let mut within: Vec<_> = between(numbers, 0.5).into_iter().collect();
            within.extend(uniform(space, 0.0));
            within.retain(|action| space.contains(action) && !corners.contains(action));
            within.dedup();
            // the corners stay first and last
            let place = corners.len().min(1);
            corners.splice(place..place, within);
            corners
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
        Space::MultiBinary(space) => {
            let count = space.shape().iter().product::<usize>();
            let all = |bit: i64| {
                let data = Data::from_i64(DType::I8, vec![bit; count]);
                Array::new(space.shape(), data).ok()
            };
            [0, 1]
                .into_iter()
                .filter_map(all)
                .map(Value::Array)
                .collect()
        }
        // the first corners of all parts together, and the last ones
        Space::Tuple(space) => ends(space.spaces().iter())
            .map(|ends| ends.map(Value::Tuple).to_vec())
            .unwrap_or_default(),
        Space::Dict(space) => {
            let keys = space.spaces().iter().map(|(key, _)| key.clone());
            let named = |ends: Vec<Value>| Value::Dict(keys.clone().zip(ends).collect());
            ends(space.spaces().iter().map(|(_, space)| space))
                .map(|ends| ends.map(named).to_vec())
                .unwrap_or_default()
        }
        _ => Vec::new(),
    }
}

/// Returns the first corners of all spaces, and the last corners of all spaces; `None` if a space
/// has no corners.
fn ends<'a>(spaces: impl Iterator<Item = &'a Space>) -> Option<[Vec<Value>; 2]> {
    let (mut first, mut last) = (Vec::new(), Vec::new());
    for space in spaces {
        let mut corners = corners(space);
        last.push(corners.pop()?);
        first.push(
            corners
                .into_iter()
                .next()
                .unwrap_or_else(|| last[last.len() - 1].clone()),
        );
    }
    Some([first, last])
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

/// Returns a place between the low and the high corner of a bounded box, from 0 to 1.
fn between(space: &BoxSpace, place: f64) -> Option<Value> {
    if !space.is_bounded() {
        return None;
    }
    let bounds = space.low().iter_f64().zip(space.high().iter_f64());
    let numbers = bounds.map(|(low, high)| (1.0 - place) * low + place * high);
    Array::new(space.shape(), Data::from_f64(space.dtype(), numbers))
        .ok()
        .map(Value::Array)
}

/// Returns elements that are no [`corners`]: each element of a discrete space, and places within the
/// other spaces of numbers.
pub(crate) fn inner(space: &Space) -> Vec<Value> {
    const MOST: i64 = 2000;
    match space {
        Space::Discrete(space) if space.n() <= MOST => {
            (space.start()..=space.last()).map(Value::Int).collect()
        }
        Space::Box(numbers) => [0.25, 0.75]
            .into_iter()
            .filter_map(|place| between(numbers, place))
            .filter(|action| space.contains(action))
            .collect(),
        Space::MultiDiscrete(space) => {
            let parts = space.start().iter().zip(space.nvec());
            let middle = parts.map(|(start, n)| start.saturating_add(n / 2));
            let data = Data::from_i64(space.dtype(), middle);
            let middle = Array::new(space.shape(), data).ok();
            middle.map(Value::Array).into_iter().collect()
        }
        _ => Vec::new(),
    }
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

/// Returns invalid actions: actions of another type or shape, out of the range of a discrete space,
/// or with a number that is not finite.
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
    // for a box, an environment may convert this action
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
    actions.extend(wrong_parts(space, valid));
    // some of these may be elements of the space
    actions.retain(|action| !space.contains(action));
    actions
}

/// Returns copies of a tuple or dict in which one part is invalid or missing, and a copy with an
/// additional part.
fn wrong_parts(space: &Space, valid: &Value) -> Vec<Value> {
    let mut wrong = Vec::new();
    match (space, valid) {
        (Space::Tuple(space), Value::Tuple(parts)) => {
            for (i, (space, part)) in space.spaces().iter().zip(parts).enumerate() {
                for other in invalid(space, part) {
                    let mut parts = parts.clone();
                    parts[i] = other;
                    wrong.push(Value::Tuple(parts));
                }
            }
            wrong.push(Value::Tuple(
                parts[..parts.len().saturating_sub(1)].to_vec(),
            ));
            wrong.push(Value::Tuple([parts, &[Value::Int(0)][..]].concat()));
        }
        (Space::Dict(space), Value::Dict(parts)) => {
            for (i, (key, part)) in parts.iter().enumerate() {
                let space = space.spaces().iter().find(|(name, _)| name == key);
                for other in space
                    .map(|(_, space)| invalid(space, part))
                    .unwrap_or_default()
                {
                    let mut parts = parts.clone();
                    parts[i].1 = other;
                    wrong.push(Value::Dict(parts));
                }
                let mut parts = parts.clone();
                parts.remove(i);
                wrong.push(Value::Dict(parts));
            }
            let more = ("no_such_part".to_owned(), Value::Int(0));
            wrong.push(Value::Dict([&parts[..], &[more]].concat()));
        }
        _ => {}
    }
    wrong
}

/// Returns copies of `valid` in which one element is invalid.
fn wrong_elements(space: &Space, valid: &Array) -> Vec<Value> {
    /// The largest number of elements that are changed, because an image has thousands.
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
        Space::MultiBinary(_) => elements
            .flat_map(|i| [-1, 2].map(|x| (i, x)))
            .map(|(i, x)| {
                let mut numbers = vec![0; valid.len()];
                numbers[i] = x;
                Data::from_i64(dtype, numbers)
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

#[cfg(test)]
mod tests {
    use gym_core::spaces::{
        DictSpace, Discrete, MultiBinary, MultiDiscrete, TextSpace, TupleSpace,
    };
    use serde_json::{Value as Json, json};

    use super::*;

    fn of(values: &[Value]) -> Json {
        values.iter().map(Value::to_json).collect()
    }

    /// A space of each kind, its corners, and elements between them.
    #[test]
    fn each_kind_of_space_has_its_corners_and_its_middle() {
        let several = || MultiDiscrete::new([2_i64, 3]).unwrap();
        let (first, last) = (json!([0, 0]), json!([1, 2]));
        let shifted = Discrete::new(20).unwrap().with_start(-1).unwrap();
        let both = TupleSpace::new([Space::discrete(3), several().into()]);
        let named = DictSpace::new([("a", Space::discrete(3)), ("b", several().into())]);
        let spaces: [(Space, Json, Json); 9] = [
            (Space::discrete(3), json!([0, 1, 2]), json!([0, 1, 2])),
            (
                shifted.into(),
                json!([-1, 0, 1, 2, 3, 4, 5, 6, 18]),
                (-1..19).collect(),
            ),
            (
                Space::boxed([0.0, 0.0, 0.0], [1.0, 2.0, 4.0]),
                json!([
                    [0.0, 0.0, 0.0],
                    [0.5, 1.0, 2.0],
                    [1.0, 0.0, 4.0],
                    [0.0, 2.0, 0.0],
                    [1.0, 2.0, 4.0]
                ]),
                json!([[0.25, 0.5, 1.0], [0.75, 1.5, 3.0]]),
            ),
            (
                Space::boxed([-1.0, 2.0], [3.0, 4.0]),
                json!([[-1.0, 2.0], [1.0, 3.0], [3.0, 2.0], [-1.0, 4.0], [3.0, 4.0]]),
                json!([[0.0, 2.5], [2.0, 3.5]]),
            ),
            (
                Space::boxed([0.0], [f32::INFINITY]),
                json!([[0.0]]),
                json!([]),
            ),
            (several().into(), json!([first, last]), json!([[1, 1]])),
            (
                MultiBinary::new([3]).unwrap().into(),
                json!([[0, 0, 0], [1, 1, 1]]),
                json!([]),
            ),
            (both.into(), json!([[0, first], [2, last]]), json!([])),
            (
                named.unwrap().into(),
                json!([{"a": 0, "b": first}, {"a": 2, "b": last}]),
                json!([]),
            ),
        ];
        for (space, at_ends, within) in spaces {
            assert_eq!(of(&corners(&space)), at_ends, "{space}");
            assert_eq!(of(&inner(&space)), within, "{space}");
            let all = [corners(&space), inner(&space)].concat();
            assert!(all.iter().all(|element| space.contains(element)), "{space}");
        }
        let text = TextSpace::new(1, 2).unwrap().into();
        assert!(corners(&text).is_empty() && inner(&text).is_empty());
    }

    #[test]
    fn huge_actions_of_a_box_are_finite() {
        let (far, most) = (f64::from(1e30_f32), f64::from(f32::MAX));
        let expected = [-10.0, 10.0, -far, far, -most, most].map(|x| vec![x, x]);
        let found = huge(&Space::boxed([0.0, 0.0], [1.0, 1.0]));
        let numbers = found.iter().filter_map(Value::as_array);
        let numbers: Vec<Vec<f64>> = numbers.map(|array| array.iter_f64().collect()).collect();
        assert_eq!(numbers, expected);
        assert!(huge(&Space::discrete(2)).is_empty());
    }

    /// Every element of a space is wrong in turn, and nothing that is wrong is in the space.
    #[test]
    fn what_is_invalid_is_outside_of_the_space() {
        let several = MultiDiscrete::new([2_i64, 3]).unwrap().into();
        let both = TupleSpace::new([Space::discrete(3), Space::boxed([0.0], [1.0])]).into();
        let parts = [("a", Space::discrete(3)), ("b", Space::discrete(2))];
        let named = DictSpace::new(parts).unwrap().into();
        let lacking = json!([{"b": 0}, {"a": 0}, {"a": 0, "b": 0, "no_such_part": 0}]);
        for (space, wrong) in [
            (named, lacking),
            (Space::discrete(3), json!([-1, 3])),
            (several, json!([[-1, 0], [2, 0], [0, -1], [0, 3]])),
            (
                MultiBinary::new([2]).unwrap().into(),
                json!([[-1, 0], [2, 0], [0, -1], [0, 2]]),
            ),
            (both, json!([[-1, [0.0]], [3, [0.0]], [0], [0, [0.0], 0]])),
        ] {
            let valid = corners(&space).remove(0);
            let found = invalid(&space, &valid);
            assert!(found.iter().all(|action| !space.contains(action)));
            let found = of(&found);
            for action in wrong.as_array().unwrap() {
                let is_there = found.as_array().unwrap().contains(action);
                assert!(is_there, "{space}: {action} is not in {found}");
            }
        }
    }
}
