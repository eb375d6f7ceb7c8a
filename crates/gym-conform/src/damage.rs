//! Damaged snapshots: snapshots in which one part is replaced.

use std::collections::BTreeMap;

use serde_json::{Map, Value as Json, json};

/// The keys of objects and indices of arrays that lead to a part.
type Path = Vec<String>;

/// One part of a snapshot, and its replacement.
pub(crate) struct Damage {
    pointer: String,
    other: Json,
}

impl Damage {
    /// Calls `f` with the damaged `snapshot`, then puts the original part back.
    pub(crate) fn done_to<R>(&self, snapshot: &mut Json, f: impl FnOnce(&Json) -> R) -> R {
        let mut other = self.other.clone();
        let mut swap = |snapshot: &mut Json| {
            if let Some(part) = snapshot.pointer_mut(&self.pointer) {
                std::mem::swap(part, &mut other);
            }
        };
        swap(snapshot);
        let result = f(snapshot);
        swap(snapshot);
        result
    }

    /// Returns the JSON pointer to the part.
    pub(crate) fn place(&self) -> &str {
        &self.pointer
    }

    /// Describes the replacement, the replaced value and its place.
    pub(crate) fn difference(&self, good: &Json) -> String {
        let Self { pointer, other } = self;
        let short = |json: &Json| json.to_string().chars().take(60).collect::<String>();
        format!(
            "{} for {} at `{pointer}`",
            short(other),
            good.pointer(pointer).map_or("nothing".into(), short)
        )
    }

    /// Returns whether two snapshots have equal parts at this place.
    pub(crate) fn is_same(&self, one: &Json, other: &Json) -> bool {
        one.pointer(&self.pointer) == other.pointer(&self.pointer)
    }
}

/// Returns every kind of damage to every field and container, and a few kinds of damage to the
/// first and the last element of a long array. A large snapshot takes long to read: of its fields,
/// each gets only a few kinds of damage. In a huge snapshot, each gets the next kind in turn.
pub(crate) fn damages(good: &Json) -> Vec<Damage> {
    let paths = paths(good);
    let parts = paths.len();
    let representatives = representatives(good, paths);
    let size = Size::of(parts, representatives.len());
    let mut turn = 0;
    damages_by(good, representatives, |part, place| {
        let others = others(part);
        let (near, far) = match (place, size) {
            (Place::Field, Size::Small) => (others.len(), 0),
            (Place::Field, Size::Large) => (2, 2),
            (Place::First, Size::Small) => (3, 3),
            (Place::First, Size::Large) => (1, 1),
            (Place::Last, Size::Small) => (3, 0),
            (Place::Last, Size::Large) => (1, 0),
            (_, Size::Huge) => (0, 1),
        };
        // all near replacements, and as many far replacements as the budget allows, in turn
        let (close, rest) = others.split_at(near.min(others.len()));
        turn += far;
        close
            .iter()
            .chain(rest.iter().cycle().skip(turn).take(far.min(rest.len())))
            .cloned()
            .collect()
    })
}

/// How long a snapshot takes to read.
#[derive(Clone, Copy)]
enum Size {
    Small,
    /// It has more than 200 [`representatives`].
    Large,
    /// It also has more than 10,000 parts.
    Huge,
}

impl Size {
    fn of(parts: usize, representatives: usize) -> Self {
        match (parts, representatives) {
            (10_001.., 201..) => Self::Huge,
            (_, 201..) => Self::Large,
            _ => Self::Small,
        }
    }
}

fn damages_by(
    good: &Json,
    representatives: Vec<(Path, Place)>,
    mut others: impl FnMut(&Json, Place) -> Vec<Json>,
) -> Vec<Damage> {
    let damages = representatives.into_iter().filter_map(|(path, place)| {
        let pointer = pointer(&path);
        let others = others(good.pointer(&pointer)?, place);
        Some(others.into_iter().map(move |other| Damage {
            pointer: pointer.clone(),
            other,
        }))
    });
    damages.flatten().collect()
}

/// Returns replacements of the same type that may give another valid state: numbers near and far,
/// and inverted bools.
pub(crate) fn moves(good: &Json) -> Vec<Damage> {
    let others = |part: &Json, _| match part {
        Json::Bool(is) => vec![json!(!is)],
        Json::Number(number) => match (number.as_i64(), number.as_f64()) {
            // one integer may encode several numbers, such as row, column and passenger
            (Some(int), _) => (0..10)
                .flat_map(|power| [1 << power, -(1 << power)])
                .map(|by| json!(int.saturating_add(by)))
                .collect(),
            (None, Some(float)) => [float + 1.0, float - 1.0, 2.0 * float, -float]
                .map(|x| json!(x))
                .to_vec(),
            (None, None) => vec![],
        },
        _ => vec![],
    };
    damages_by(good, representatives(good, paths(good)), others)
}

/// Returns replacements of numbers by numbers beyond any episode.
pub(crate) fn far(good: &Json) -> Vec<Damage> {
    let others = |part: &Json, _| match part {
        Json::Number(number) if number.is_f64() => vec![json!(1e300), json!(-1e300)],
        Json::Number(_) => vec![json!(i64::MAX), json!(i64::MIN)],
        _ => vec![],
    };
    damages_by(good, representatives(good, paths(good)), others)
}

/// Returns copies of the objects of a state of which each lacks a key.
pub(crate) fn gaps(good: &Json) -> Vec<Damage> {
    /// The most gaps that are tried.
    const MOST: usize = 100;
    let others = |part: &Json, _| match part {
        Json::Object(map) => {
            let without = |key: &String| {
                let mut less = map.clone();
                less.remove(key);
                Json::Object(less)
            };
            map.keys().map(without).collect()
        }
        _ => vec![],
    };
    let mut gaps = damages_by(good, representatives(good, paths(good)), others);
    let every = gaps.len().div_ceil(MOST).max(1);
    let mut number = 0;
    gaps.retain(|_| {
        number += 1;
        number % every == 0
    });
    gaps
}

/// Returns the replacements of a part: values of another type or of another size, and near values.
fn others(part: &Json) -> Vec<Json> {
    let mut others = match part {
        Json::Number(number) => {
            let float = number.as_f64().unwrap_or(0.0);
            let near = match number.as_i64() {
                Some(int) => [1, -1, 1000]
                    .map(|by| json!(int.saturating_add(by)))
                    .to_vec(),
                None => [2.0 * float, float + 1.0, -float]
                    .map(|x| json!(x))
                    .to_vec(),
            };
            let mut others = [
                near,
                vec![json!(-1), json!(1000), json!(1e300), json!(u64::MAX)],
            ]
            .concat();
            if number.is_f64() {
                others.extend(["NaN", "inf", "-inf"].map(|text| json!({"$float": text})));
            }
            others
        }
        Json::Bool(is) => vec![json!(!is)],
        Json::Array(items) => {
            let less = items[..items.len().saturating_sub(1)].to_vec();
            let more = [
                &items[..],
                items.last().map_or(&[json!(0)][..], std::slice::from_ref),
            ]
            .concat();
            vec![json!(less), json!(more)]
        }
        Json::Object(map) => {
            let less: Map<_, _> = map
                .iter()
                .skip(1)
                .map(|(key, value)| (key.clone(), value.clone()))
                .collect();
            let mut more = map.clone();
            more.insert("no_such_field".into(), json!(0));
            vec![json!(less), json!(more)]
        }
        Json::String(text) => vec![json!(""), json!(format!("{text}0"))],
        Json::Null => vec![],
    };
    others.extend([json!(null), json!("x"), json!([]), json!({})]);
    others.retain(|other| other != part);
    others
}

/// The place of a part.
#[derive(Clone, Copy)]
enum Place {
    /// Not within a long array.
    Field,
    /// The first part of its kind in a long array.
    First,
    /// The last part of its kind.
    Last,
}

/// Returns the paths of the parts of `json` that are damaged: of a long array, only the parts in the
/// first and the last element. `paths` has the path of every part.
fn representatives(json: &Json, paths: Vec<Path>) -> Vec<(Path, Place)> {
    /// The elements of arrays with more elements count as one kind.
    const TUPLE: usize = 4;
    let mut kinds: BTreeMap<String, Vec<Path>> = BTreeMap::new();
    for path in paths {
        let mut kind = Vec::new();
        for (depth, step) in path.iter().enumerate() {
            let items = json
                .pointer(&pointer(&path[..depth]))
                .and_then(Json::as_array);
            // the elements of a short array may differ in meaning
            kind.push(if items.is_some_and(|items| items.len() > TUPLE) {
                "*"
            } else {
                step
            });
        }
        let kind = kind.join("/");
        kinds.entry(kind).or_default().push(path);
    }
    let mut chosen = Vec::new();
    for (kind, mut paths) in kinds {
        let last = if paths.len() > 1 { paths.pop() } else { None };
        let place = if kind.split('/').any(|step| step == "*") {
            Place::First
        } else {
            Place::Field
        };
        chosen.extend(paths.into_iter().next().map(|path| (path, place)));
        chosen.extend(last.map(|path| (path, Place::Last)));
    }
    chosen
}

/// Returns the paths of all parts, each container before its contents.
fn paths(json: &Json) -> Vec<Path> {
    fn walk(json: &Json, path: &mut Path, paths: &mut Vec<Path>) {
        paths.push(path.clone());
        let parts: Vec<(String, &Json)> = match json {
            Json::Array(items) => items
                .iter()
                .enumerate()
                .map(|(i, item)| (i.to_string(), item))
                .collect(),
            Json::Object(map) => map
                .iter()
                .map(|(key, value)| (key.clone(), value))
                .collect(),
            _ => Vec::new(),
        };
        for (step, part) in parts {
            path.push(step);
            walk(part, path, paths);
            path.pop();
        }
    }
    let mut paths = Vec::new();
    walk(json, &mut Vec::new(), &mut paths);
    paths
}

/// Returns `path` as a JSON pointer.
fn pointer(path: &[String]) -> String {
    path.iter()
        .map(|step| format!("/{}", step.replace('~', "~0").replace('/', "~1")))
        .collect()
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    /// Returns an object with `n` fields.
    fn fields(n: usize) -> Map<String, Json> {
        (0..n).map(|i| (format!("field {i}"), json!(i))).collect()
    }

    fn damaged(good: &Json) -> Vec<Json> {
        damages(good)
            .iter()
            .map(|damage| damage.done_to(&mut good.clone(), Json::clone))
            .collect()
    }

    #[test]
    fn small_fields_beside_a_long_array_have_their_turn() {
        let track: Vec<[f64; 2]> = (0..5000).map(|i| [f64::from(i), 0.5]).collect();
        let good = json!({"track": track, "row": 3, "battery": 0.5, "done": false});
        let copies = damaged(&good);
        assert!(copies.len() < 200, "{}", copies.len());
        for (field, value) in [
            ("row", json!(4)),
            ("row", json!(1003)),
            ("battery", json!(-1)),
            ("done", json!(true)),
        ] {
            assert!(
                copies.iter().any(|copy| copy[field] == value),
                "{field} = {value}"
            );
        }
        let lengths: Vec<_> = copies
            .iter()
            .filter_map(|copy| Some(copy["track"].as_array()?.len()))
            .collect();
        assert!(lengths.contains(&4999) && lengths.contains(&5001));
        assert!(
            copies
                .iter()
                .any(|copy| copy["track"][4999][1] == json!(1.0)),
            "the last element too"
        );
        assert!(copies.iter().all(|copy| *copy != good));
    }

    #[test]
    fn every_field_of_many_has_every_kind_of_damage() {
        let copies = damaged(&json!(fields(150)));
        for i in 0..150 {
            let field = format!("field {i}");
            for value in [
                json!(i + 1),
                json!(i - 1),
                json!(-1),
                json!(1e300),
                json!(null),
                json!([]),
            ] {
                assert!(
                    copies.iter().any(|copy| copy[&field] == value),
                    "{field} = {value}"
                );
            }
        }
    }

    #[test]
    fn no_field_of_a_large_world_is_left_out() {
        let copies = damaged(&json!(fields(1000)));
        for i in 0..1000 {
            let field = format!("field {i}");
            assert!(copies.iter().any(|copy| copy[&field] == i + 1), "{field}");
            assert!(
                copies.iter().filter(|copy| copy[&field] != i).count() >= 4,
                "{field}"
            );
        }
        for far in [
            json!(-1),
            json!(1e300),
            json!(u64::MAX),
            json!(null),
            json!("x"),
            json!([]),
            json!({}),
        ] {
            let is_far = |copy: &Json| {
                copy.as_object()
                    .is_some_and(|map| map.values().any(|x| *x == far))
            };
            assert!(copies.iter().any(is_far), "{far}");
        }
    }

    #[test]
    fn each_field_of_a_huge_world_has_the_next_kind_of_damage() {
        let fields = fields(10_001);
        let damages = damages(&json!(fields));
        let damaged: BTreeSet<_> = damages.iter().map(Damage::place).collect();
        assert!(
            fields
                .keys()
                .all(|field| damaged.contains(&*format!("/{field}")))
        );
        assert_eq!(damages.len(), damaged.len());
        for other in [json!(-1), json!(u64::MAX), json!(null), json!({})] {
            assert!(
                damages.iter().any(|damage| damage.other == other),
                "{other}"
            );
        }
    }

    #[test]
    fn damage_is_mended_again_and_named() {
        let good = json!({"a": [1, 2]});
        let damage = Damage {
            pointer: "/a/1".into(),
            other: json!(3),
        };
        let mut snapshot = good.clone();
        assert_eq!(
            damage.done_to(&mut snapshot, Json::clone),
            json!({"a": [1, 3]})
        );
        assert_eq!(snapshot, good);
        assert_eq!(damage.difference(&good), "3 for 2 at `/a/1`");
    }
}
