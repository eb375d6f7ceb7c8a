//! `Mission`: the sentences that a pattern and lists of words form.

use std::fmt;

use gym_numerics::Generator;
use serde::{Deserialize, Serialize};

use super::invalid;
use crate::value::fault::Fault;
use crate::value::{Error, Result, Value};

/// The placeholder for a word in a pattern.
const BLANK: &str = "{}";

/// The sentences of a pattern whose blanks are filled with words: minigrid's `MissionSpace`.
///
/// ```
/// use gym_core::spaces::MissionSpace;
/// let mission = MissionSpace::new("go to the {} {}", [vec!["blue", "red"], vec!["door"]])?;
/// assert!(mission.has("go to the red door") && !mission.has("go to the door"));
/// # Ok::<(), gym_core::Error>(())
/// ```
///
/// A sample has a uniform word in each blank. Two spaces are equal if their patterns are, and the
/// words of each blank in any order.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(try_from = "Description")]
pub struct MissionSpace {
    pattern: String,
    words: Vec<Vec<String>>,
    any: bool,
}

impl MissionSpace {
    /// The sentences of `pattern`, in which each `{}` stands for one of the words of its list.
    ///
    /// # Errors
    /// [`Error::InvalidSpace`] unless there are as many lists as blanks, each with at least one
    /// word and none twice.
    pub fn new<W: Into<String>>(
        pattern: &str,
        words: impl IntoIterator<Item = Vec<W>>,
    ) -> Result<Self> {
        let words: Vec<Vec<String>> = words
            .into_iter()
            .map(|list| list.into_iter().map(Into::into).collect())
            .collect();
        let blanks = pattern.matches(BLANK).count();
        if blanks != words.len() {
            return invalid(format!(
                "the pattern {pattern:?} has {blanks} blanks `{{}}`, and there are {} lists of words: give one for each",
                words.len()
            ));
        }
        for (i, list) in words.iter().enumerate() {
            if list.is_empty() {
                return invalid(format!(
                    "list {i} of the words of a mission is empty: give at least one word"
                ));
            }
            if let Some(twice) = list
                .iter()
                .enumerate()
                .find(|(j, word)| list[..*j].contains(word))
            {
                return invalid(format!(
                    "list {i} of the words of a mission has {:?} twice: give it once",
                    twice.1
                ));
            }
        }
        Ok(Self {
            pattern: pattern.to_owned(),
            words,
            any: false,
        })
    }

    /// The space of every text, whose samples are the sentence `sample`: minigrid's
    /// `BabyAIMissionSpace`.
    pub fn any(sample: &str) -> Self {
        Self {
            pattern: sample.to_owned(),
            words: Vec::new(),
            any: true,
        }
    }

    /// The sentence with blanks.
    pub fn pattern(&self) -> &str {
        &self.pattern
    }

    /// The words for each blank.
    pub fn words(&self) -> &[Vec<String>] {
        &self.words
    }

    /// Whether a text is an element.
    pub fn has(&self, text: &str) -> bool {
        if self.any {
            return true;
        }
        let mut literals = self.pattern.split(BLANK);
        let first = literals.next().unwrap_or_default();
        let Some(rest) = text.strip_prefix(first) else {
            return false;
        };
        // the texts that can remain after the part of the pattern that was matched
        let mut rests = vec![rest];
        for (list, literal) in self.words.iter().zip(literals) {
            let mut next: Vec<&str> = rests
                .iter()
                .flat_map(|rest| {
                    list.iter()
                        .filter_map(|word| rest.strip_prefix(word.as_str()))
                })
                .filter_map(|rest| rest.strip_prefix(literal))
                .collect();
            next.sort_unstable_by_key(|rest| rest.len());
            next.dedup_by_key(|rest| rest.len());
            rests = next;
        }
        rests.contains(&"")
    }

    /// The sentence with these words in its blanks.
    fn sentence<'a>(&'a self, words: impl Iterator<Item = &'a str>, out: &mut String) {
        out.clear();
        let mut words = words;
        for (i, literal) in self.pattern.split(BLANK).enumerate() {
            if i > 0 {
                out.push_str(words.next().unwrap_or_default());
            }
            out.push_str(literal);
        }
    }

    /// The sentence of the first words, or of the last.
    pub(super) fn corner(&self, last: bool) -> Value {
        let mut text = String::new();
        let pick = |list: &'_ Vec<String>| if last { list.len() - 1 } else { 0 };
        self.sentence(
            self.words.iter().map(|list| list[pick(list)].as_str()),
            &mut text,
        );
        Value::Text(text)
    }

    pub(super) fn contains(&self, value: &Value) -> bool {
        value.as_text().is_some_and(|text| self.has(text))
    }

    pub(super) fn check(&self, value: &Value) -> Result<(), Fault> {
        match value {
            Value::Text(text) if self.has(text) => Ok(()),
            Value::Text(_) => Err(Fault::new(format!(
                "it does not fit the pattern {:?}",
                self.pattern
            ))),
            _ => Err(Fault::kind("a text", value)),
        }
    }

    pub(super) fn draw(&self, rng: &mut Generator, out: &mut Value) {
        if !matches!(out, Value::Text(_)) {
            *out = Value::Text(String::new());
        }
        if let Value::Text(text) = out {
            let words = self.words.iter();
            self.sentence(
                words.map(|list| list[rng.choice(list.len())].as_str()),
                text,
            );
        }
    }
}

/// The order of the words of a blank does not matter, as in minigrid.
impl PartialEq for MissionSpace {
    fn eq(&self, other: &Self) -> bool {
        let sorted = |list: &Vec<String>| {
            let mut list = list.clone();
            list.sort_unstable();
            list
        };
        self.any == other.any
            && self.pattern == other.pattern
            && self
                .words
                .iter()
                .map(sorted)
                .eq(other.words.iter().map(sorted))
    }
}

impl Eq for MissionSpace {}

/// `MissionSpace("go to the {} door", [["blue", "red"]])`.
impl fmt::Display for MissionSpace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "MissionSpace({:?}, {:?})", self.pattern, self.words)
    }
}

/// The stored form, before it is checked.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Description {
    pattern: String,
    words: Vec<Vec<String>>,
    any: bool,
}

impl TryFrom<Description> for MissionSpace {
    type Error = Error;

    fn try_from(stored: Description) -> Result<Self> {
        if stored.any && stored.words.is_empty() {
            return Ok(Self::any(&stored.pattern));
        }
        let any = stored.any;
        Ok(Self {
            any,
            ..Self::new(&stored.pattern, stored.words)?
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Space;

    fn fetch() -> MissionSpace {
        let syntax = vec!["get a", "go get a", "you must fetch a"];
        MissionSpace::new(
            "{} {} {}",
            [syntax, vec!["red", "blue"], vec!["key", "ball"]],
        )
        .unwrap()
    }

    #[test]
    fn elements_are_the_sentences_of_the_pattern() {
        let space = fetch();
        assert!(space.has("go get a red ball") && space.has("get a blue key"));
        for other in [
            "go get a red box",
            "red ball",
            "get a red ball now",
            "get a  red ball",
            "",
        ] {
            assert!(!space.has(other), "{other}");
        }
        // a word that is the start of another word
        let space = MissionSpace::new("{}{}", [vec!["a", "ab"], vec!["c", "bc"]]).unwrap();
        assert!(["ac", "abc", "abbc"].iter().all(|text| space.has(text)) && !space.has("ab"));
        assert!(
            MissionSpace::new("", Vec::<Vec<&str>>::new())
                .unwrap()
                .has("")
        );
        assert!(MissionSpace::any("go").has("open the door"));
    }

    /// As minigrid's after `space.seed(seed)`.
    #[test]
    fn samples_are_minigrids() {
        let colors = || vec!["blue", "green", "grey", "purple", "red", "yellow"];
        let kinds = || vec!["key", "ball", "box"];
        let space = MissionSpace::new(
            "put the {} {} near the {} {}",
            [colors(), kinds(), colors(), kinds()],
        );
        let mut sampler = Space::from(space.unwrap()).sampler(7);
        for expected in SAMPLES {
            assert_eq!(sampler.sample().as_text(), Some(expected));
        }
    }

    const SAMPLES: [&str; 3] = [
        "put the yellow ball near the red box",
        "put the purple box near the yellow key",
        "put the blue key near the green box",
    ];

    #[test]
    fn constructors_refuse_what_forms_no_sentence() {
        let reason = |pattern: &str, words: Vec<Vec<&str>>| {
            MissionSpace::new(pattern, words).unwrap_err().to_string()
        };
        assert!(reason("go {}", vec![]).contains("has 1 blanks"));
        assert!(
            reason("go {}", vec![vec![]]).contains("list 0 of the words of a mission is empty")
        );
        assert!(reason("go {}", vec![vec!["a", "b", "a"]]).contains("\"a\" twice"));
    }

    #[test]
    fn stored_form_and_equality() {
        let space = Space::from(fetch());
        let stored = serde_json::to_string(&space).unwrap();
        assert_eq!(serde_json::from_str::<Space>(&stored).unwrap(), space);
        let any = Space::from(MissionSpace::any("go"));
        let stored = serde_json::to_string(&any).unwrap();
        assert_eq!(
            stored,
            r#"{"type":"Mission","pattern":"go","words":[],"any":true}"#
        );
        assert_eq!(serde_json::from_str::<Space>(&stored).unwrap(), any);
        let of = |words: [&str; 2]| MissionSpace::new("go {}", [words.to_vec()]).unwrap();
        assert_eq!(of(["a", "b"]), of(["b", "a"]));
        assert_ne!(of(["a", "b"]), of(["a", "c"]));
        let sentence = MissionSpace::new("go", Vec::<Vec<&str>>::new()).unwrap();
        assert_ne!(MissionSpace::any("go"), sentence);
        assert_eq!(
            of(["a", "b"]).to_string(),
            r#"MissionSpace("go {}", [["a", "b"]])"#
        );
        assert!(Space::from(fetch()).flatten_space().is_err());
    }

    #[test]
    fn faults_name_the_pattern() {
        let error = Space::from(fetch()).check(&Value::from("fly")).unwrap_err();
        assert!(
            error
                .to_string()
                .contains("it does not fit the pattern \"{} {} {}\""),
            "{error}"
        );
    }
}
