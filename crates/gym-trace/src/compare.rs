//! The comparison of two traces of the same calls: which parts are compared, and the first
//! difference.

use gym_core::EnvSpec;
use serde_json::{Number, Value as Json, json};

use crate::{Event, Trace};

/// A fact about the environment that a recording notes and the comparison checks: its name in
/// [`Trace::about`], and a function that computes the fact from the observation space, the action
/// space and the spec, if there is one.
pub(crate) type Fact = (
    &'static str,
    fn(&[String; 2], Option<&EnvSpec>) -> Option<Json>,
);

pub(crate) const FACTS: [Fact; 4] = [
    ("observation_space", |spaces, _| Some(json!(spaces[0]))),
    ("action_space", |spaces, _| Some(json!(spaces[1]))),
    ("max_episode_steps", |_, spec| {
        Some(json!(spec?.max_episode_steps))
    }),
    ("reward_threshold", |_, spec| {
        Some(json!(spec?.reward_threshold))
    }),
];

impl Trace {
    /// The first difference from another trace of the same calls: a fact about the environment, or
    /// the event, the part of it, the place in that part, and both answers. Numbers are compared to
    /// the last bit.
    ///
    /// What [`compared`](Self::compared) leaves out is not compared.
    pub fn first_difference(&self, other: &Self) -> Option<String> {
        let fact = FACTS.iter().find_map(|(name, _)| {
            let noted = self.about.get(*name)?;
            let Some(here) = other.about.get(*name) else {
                return Some(format!("{name}: nothing for {}", start_of(noted)));
            };
            difference(&one_line(noted), &one_line(here))
                .map(|difference| format!("{name}{difference}"))
        });
        if fact.is_some() {
            return fact;
        }
        if self.events.len() != other.events.len() {
            return Some(format!(
                "{} events for {}",
                other.events.len(),
                self.events.len()
            ));
        }
        let parts = self.parts();
        self.events
            .iter()
            .zip(&other.events)
            .enumerate()
            .find_map(|(i, (a, b))| {
                parts.iter().find_map(|(name, part)| {
                    let [a, b] = [a, b].map(|event| part(event).unwrap_or(&Json::Null));
                    difference(a, b).map(|difference| format!("event {i}, {name}{difference}"))
                })
            })
    }

    /// The names of what [`first_difference`](Self::first_difference) compares: parts of answers
    /// that some event of this trace records, and facts about the environment. Without a part of an
    /// answer, equality proves nothing.
    pub fn compared(&self) -> (Vec<&'static str>, Vec<&'static str>) {
        let parts = self.parts().into_iter().map(|(name, _)| name).collect();
        let facts = FACTS.iter().map(|(name, _)| *name);
        let facts = facts.filter(|name| self.about.contains_key(*name));
        (parts, facts.collect())
    }

    /// The names of what this trace records and nothing compares.
    pub fn not_compared(&self) -> Vec<&str> {
        let notes = self.about.keys().map(String::as_str);
        let notes = notes.filter(|name| FACTS.iter().all(|(fact, _)| fact != name));
        let (parts, _) = self.compared();
        let recorded = PARTS.iter().chain(&[FRAME_PLAIN]).filter(|(name, part)| {
            !parts.contains(name) && self.events.iter().any(|event| part(event).is_some())
        });
        let recorded = recorded.map(|(name, _)| *name);
        notes.chain(recorded).chain(self.unused()).collect()
    }

    /// Iterates over the names of settings on which no event depends: a version of MuJoCo for an
    /// environment without this argument, and settings of pictures if the trace has no checksum of
    /// a picture.
    fn unused(&self) -> impl Iterator<Item = &str> {
        let parts = self.parts();
        let has = |part: &str| parts.iter().any(|(name, _)| *name == part);
        let shows = PICTURES.iter().any(|name| has(name));
        let named = |name, is_unused: bool| is_unused.then_some(name);
        let mujoco =
            self.mujoco.is_some() && (!self.takes("mujoco") || self.kwargs.contains_key("mujoco"));
        [
            named("mujoco", mujoco),
            named("render_mode", self.render_mode.is_some() && !shows),
            named(
                "frame_mask",
                !self.frame_mask.is_empty() && !has("frame_masked"),
            ),
            named(
                "observation_mask",
                !self.observation_mask.is_empty() && !has("observation_masked"),
            ),
        ]
        .into_iter()
        .flatten()
    }

    /// The parts of answers that are compared.
    fn parts(&self) -> Vec<Part> {
        let mut recorded = PARTS.to_vec();
        recorded.retain(|(_, part)| self.events.iter().any(|event| part(event).is_some()));
        // if a masked checksum is recorded, the checksum of the whole picture is not compared
        for (masked, plain) in [
            ("frame_masked", "frame"),
            ("observation_masked", "observation_crc32"),
        ] {
            if recorded.iter().any(|(name, _)| *name == masked) {
                recorded.retain(|(name, _)| *name != plain);
            }
        }
        recorded
    }
}

/// A text with single spaces, since numpy aligns numbers in columns and breaks lines; any other
/// JSON as it is.
fn one_line(json: &Json) -> Json {
    match json {
        Json::String(text) => text.split_whitespace().collect::<Vec<_>>().join(" ").into(),
        other => other.clone(),
    }
}

/// A part of an answer: its name and its value.
type Part = (&'static str, fn(&Event) -> Option<&Json>);

/// The compared parts.
const PARTS: [Part; 10] = [
    ("observation", |event| event.observation.as_ref()),
    ("reward", |event| event.reward.as_ref()),
    ("terminated", |event| event.terminated.as_ref()),
    ("truncated", |event| event.truncated.as_ref()),
    ("info", |event| event.info.as_ref()),
    ("state", |event| event.state.as_ref()),
    ("frame", |event| event.frame.as_ref()),
    ("frame_masked", |event| event.frame_masked.as_ref()),
    ("observation_crc32", |event| {
        event.observation_crc32.as_ref()
    }),
    ("observation_masked", |event| {
        event.observation_masked.as_ref()
    }),
];

/// The parts that need pictures.
const PICTURES: [&str; 4] = [
    "frame",
    "frame_masked",
    "observation_crc32",
    "observation_masked",
];

/// The part of an event that is read, and not compared.
const FRAME_PLAIN: Part = ("frame_plain", |event| event.frame_plain.as_ref());

/// Describes the first difference of two JSON values, by its place and both values there: `[3]: 1
/// for 2`. Numbers are compared to the last bit; `1` and `1.0` are the same number, and `0.0` and
/// `-0.0` are not.
fn difference(a: &Json, b: &Json) -> Option<String> {
    let inside = |place: String, a: &Json, b: &Json| {
        difference(a, b).map(|difference| format!("{place}{difference}"))
    };
    match (a, b) {
        (Json::Number(x), Json::Number(y)) if same_number(x, y) => None,
        (Json::Array(x), Json::Array(y)) if x.len() == y.len() => {
            let mut pairs = x.iter().zip(y).enumerate();
            pairs.find_map(|(i, (x, y))| inside(format!("[{i}]"), x, y))
        }
        (Json::Object(x), Json::Object(y)) => {
            let of_both = x.iter().find_map(|(key, x)| match y.get(key) {
                Some(y) => inside(format!(".{key}"), x, y),
                None => Some(format!(".{key}: nothing for {}", start_of(x))),
            });
            let surplus = || y.iter().find(|(key, _)| !x.contains_key(*key));
            of_both.or_else(|| {
                surplus().map(|(key, y)| format!(".{key}: {} for nothing", start_of(y)))
            })
        }
        _ if a == b && !a.is_number() => None,
        _ => Some(format!(": {} for {}", start_of(b), start_of(a))),
    }
}

/// The start of a value as JSON.
fn start_of(json: &Json) -> String {
    const MAX_LENGTH: usize = 100;
    if let Json::Array(list) = json
        && list.len() > 20
    {
        return format!("a list of {}", list.len());
    }
    let text = json.to_string();
    match text.char_indices().nth(MAX_LENGTH) {
        Some((end, _)) => format!("{}...", &text[..end]),
        None => text,
    }
}

fn same_number(x: &Number, y: &Number) -> bool {
    let integer = |n: &Number| {
        n.as_i64()
            .map(i128::from)
            .or_else(|| n.as_u64().map(i128::from))
    };
    let real = |n: &Number| n.as_f64().unwrap_or(f64::NAN);
    match (integer(x), integer(y)) {
        (Some(x), Some(y)) => x == y,
        (None, None) => real(x).to_bits() == real(y).to_bits(),
        // an integer above 2^53 may differ from the real number that it rounds to
        (Some(i), None) => is_integer(real(y), i),
        (None, Some(i)) => is_integer(real(x), i),
    }
}

/// Whether a real number equals an integer exactly. `-0.0` equals no integer.
fn is_integer(x: f64, i: i128) -> bool {
    x.to_bits() == (i as f64).to_bits() && x as i128 == i
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_compared_to_the_last_bit() {
        let same = |a: &str, b: &str| {
            let [a, b] = [a, b].map(|text| serde_json::from_str(text).unwrap());
            difference(&a, &b).is_none()
        };
        for (a, b) in [
            ("1", "1.0"),
            ("0", "0.0"),
            ("-0.0", "-0.0"),
            ("9007199254740992", "9007199254740992.0"),
            ("[1, {\"a\": 2}]", "[1.0, {\"a\": 2.0}]"),
        ] {
            assert!(same(a, b) && same(b, a), "{a} {b}");
        }
        for (a, b) in [
            ("0.0", "-0.0"),
            ("0", "-0.0"),
            ("9007199254740993", "9007199254740992"),
            ("9007199254740993", "9007199254740992.0"),
            ("18446744073709551615", "18446744073709551614"),
            ("0.1", "0.10000000000000002"),
            ("{}", "{\"surplus\": 1}"),
            ("{}", "{\"surplus\": null}"),
            ("[1]", "[1, 1]"),
            ("true", "1"),
        ] {
            assert!(!same(a, b) && !same(b, a), "{a} {b}");
        }
    }

    fn trace(events: impl Into<Json>) -> Trace {
        let events: Json = events.into();
        serde_json::from_value(json!({ "id": "None-v0", "events": events })).unwrap()
    }

    #[test]
    fn every_recorded_part_is_compared() {
        let reset = json!({ "reset": { "seed": 1, "options": null }, "observation": [0.5], "info": { "a": 1 } });
        let step = json!({ "step": 0, "observation": [0.5], "reward": 1.0, "terminated": false, "truncated": false,
            "info": {}, "state": [1] });
        let recorded = trace(json!([reset, step]));
        assert_eq!(recorded.first_difference(&recorded), None);
        for part in [
            "observation",
            "reward",
            "terminated",
            "truncated",
            "info",
            "state",
        ] {
            let mut other = step.clone();
            other[part] = json!("another");
            let difference = recorded
                .first_difference(&trace(json!([reset, other])))
                .unwrap();
            assert!(
                difference.starts_with(&format!("event 1, {part}")),
                "{difference}"
            );
            // the comparison ignores a field that one of the events lacks
            let mut lacking = step.clone();
            lacking.as_object_mut().unwrap().remove(part);
            assert!(
                recorded
                    .first_difference(&trace(json!([reset, lacking])))
                    .is_some(),
                "{part}"
            );
            let mut both = json!([reset, lacking, step]);
            let recorded = trace(both.clone());
            both[1][part] = json!("surplus");
            assert!(recorded.first_difference(&trace(both)).is_some(), "{part}");
        }
    }

    /// Each part counts, even if only the last of several events has it.
    #[test]
    fn a_part_of_a_late_event_alone_is_compared() {
        for (part, _) in PARTS {
            let event = |value: u32| {
                let mut late = json!({ "step": 0 });
                late[part] = value.into();
                trace(json!([{ "step": 0 }, { "step": 0 }, { "step": 0 }, late]))
            };
            assert_eq!(event(1).compared(), (vec![part], vec![]));
            assert_eq!(event(1).first_difference(&event(1)), None);
            let expected = format!("event 3, {part}: 2 for 1");
            assert_eq!(event(1).first_difference(&event(2)), Some(expected));
        }
        let whole = trace(json!([{ "step": 0, "reward": 1 }]));
        let longer = trace(json!([{ "step": 0, "reward": 1 }, { "step": 0 }]));
        assert_eq!(whole.first_difference(&longer).unwrap(), "2 events for 1");
        assert_eq!(longer.first_difference(&whole).unwrap(), "1 events for 2");
    }

    #[test]
    fn a_difference_has_a_place_and_no_more_numbers_than_it_needs() {
        let of = |a: Json, b: Json| difference(&a, &b).unwrap();
        let many: Vec<f64> = (0..1_000_000).map(f64::from).collect();
        let mut other = many.clone();
        other[654_321] = -1.0;
        assert_eq!(of(json!(many), json!(other)), "[654321]: -1.0 for 654321.0");
        assert_eq!(
            of(json!(many), json!([1, 2])),
            ": [1,2] for a list of 1000000"
        );
        assert_eq!(
            of(json!({"a": [1, {"b": 2}]}), json!({"a": [1, {"b": 3}]})),
            ".a[1].b: 3 for 2"
        );
        assert_eq!(of(json!({"a": null}), json!({})), ".a: nothing for null");
        assert_eq!(of(json!({}), json!({"a": 1})), ".a: 1 for nothing");
        let long = "x".repeat(1_000_000);
        assert!(of(json!(long), json!("y")).len() < 200);
    }

    /// Facts about the environment are compared, `null` too, and the other notes are named.
    #[test]
    fn facts_in_the_head_are_compared_and_notes_named() {
        let head = json!({ "id": "None-v0", "numpy": "2.4.6", "policy": "random", "return": 1.0,
            "observation_space": "Box([0.  1.],\n [1. 2.])", "action_space": "Discrete(2)",
            "max_episode_steps": null, "reward_threshold": 195.0,
            "events": [{ "step": 0, "reward": 1.0, "frame_plain": 3 }] });
        let read = |json: &Json| serde_json::from_value::<Trace>(json.clone()).unwrap();
        let recorded = read(&head);
        assert_eq!(recorded.first_difference(&recorded), None);
        assert_eq!(
            recorded.not_compared(),
            ["numpy", "policy", "return", "frame_plain"]
        );
        let mut unused = head.clone();
        unused["mujoco"] = json!("3.12");
        unused["render_mode"] = json!("rgb_array");
        for mask in ["frame_mask", "observation_mask"] {
            unused[mask] = json!([[0, 0, 1, 1]]);
        }
        let named = ["mujoco", "render_mode", "frame_mask", "observation_mask"];
        assert_eq!(read(&unused).not_compared()[4..], named);
        unused["events"] = json!([{ "step": 0, "frame_masked": 1, "observation_masked": 2 }]);
        assert_eq!(read(&unused).not_compared()[3..], ["mujoco"]);
        let facts = FACTS.map(|(name, _)| name);
        assert_eq!(recorded.compared(), (vec!["reward"], facts.to_vec()));
        for (name, value) in [
            ("observation_space", json!("Box([0. 1.], [1. 3.])")),
            ("action_space", json!("Discrete(3)")),
            ("max_episode_steps", json!(200)),
            ("reward_threshold", json!(null)),
        ] {
            let mut other = head.clone();
            other[name] = value;
            let difference = recorded.first_difference(&read(&other)).unwrap();
            assert!(difference.starts_with(name), "{difference}");
            other.as_object_mut().unwrap().remove(name);
            let difference = recorded.first_difference(&read(&other)).unwrap();
            assert!(difference.contains("nothing for"), "{difference}");
            assert_eq!(
                read(&other).first_difference(&recorded),
                None,
                "it is not recorded"
            );
        }
        // columns and lines of numpy's text
        let mut other = head.clone();
        other["observation_space"] = json!("Box([0. 1.], [1. 2.])");
        assert_eq!(recorded.first_difference(&read(&other)), None);
        // writing keeps the notes
        assert_eq!(serde_json::to_value(&recorded).unwrap()["numpy"], "2.4.6");
        assert_eq!(
            trace(json!([{ "step": 0 }])).compared(),
            (vec![], vec![]),
            "an event without answers proves nothing"
        );
    }

    /// A masked checksum, if present, replaces the checksum of the whole frame.
    #[test]
    fn a_masked_checksum_stands_for_the_other() {
        let event = |frame: u32, masked: Option<u32>| {
            let mut event = json!({ "step": 0, "reward": 1.0, "frame": frame });
            if let Some(masked) = masked {
                event["frame_masked"] = masked.into();
            }
            trace(json!([event]))
        };
        let masked = event(1, Some(5));
        assert_eq!(masked.first_difference(&event(2, Some(5))), None);
        assert!(
            masked
                .first_difference(&event(1, Some(6)))
                .unwrap()
                .starts_with("event 0, frame_masked")
        );
        assert!(
            event(1, None)
                .first_difference(&event(2, None))
                .unwrap()
                .starts_with("event 0, frame:")
        );
    }
}
