//! `Text`: strings of a length and of given characters.

use std::collections::BTreeSet;
use std::fmt;

use gym_numerics::Generator;
use serde::{Deserialize, Serialize};

use crate::value::{Error, Result, Value};

use super::selection::Selection;
use super::weight::Weight;
use super::{MAX_ELEMENTS, invalid};
use crate::value::fault::Fault;

/// The default characters of a text space, in the order of their numbers.
const ALPHANUMERIC: &str = "0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz";

/// Strings of `min_length` to `max_length` characters of a set: Gymnasium's `Text`.
///
/// ```
/// use gym_core::spaces::TextSpace;
/// let word = TextSpace::new(1, 8)?.with_charset("abc")?;
/// assert_eq!(word.to_string(), "Text(1, 8, charset=abc)");
/// # Ok::<(), gym_core::Error>(())
/// ```
///
/// A sample has a uniform length and uniform characters.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(try_from = "Description", into = "Description")]
pub struct TextSpace {
    min_length: usize,
    max_length: usize,
    /// The characters in the order of their numbers.
    charset: Vec<char>,
}

impl TextSpace {
    /// Strings of digits and Latin letters. Gymnasium's default for `min_length` is 1.
    ///
    /// # Errors
    /// [`Error::InvalidSpace`] if `min_length` is above `max_length`, or that above 2^28.
    pub fn new(min_length: usize, max_length: usize) -> Result<Self> {
        if min_length > max_length {
            return invalid(format!(
                "the lengths of a text run from {min_length} to {max_length}: make the first the smaller"
            ));
        }
        if max_length > MAX_ELEMENTS {
            return invalid(format!(
                "a text of {max_length} characters is too long: at most {MAX_ELEMENTS} are possible"
            ));
        }
        Ok(Self {
            min_length,
            max_length,
            charset: ALPHANUMERIC.chars().collect(),
        })
    }

    /// Strings of these characters, numbered in the order given; repetitions count once.
    ///
    /// # Errors
    /// [`Error::InvalidSpace`] for an empty list.
    pub fn with_charset(self, charset: &str) -> Result<Self> {
        let mut seen = BTreeSet::new();
        let distinct: Vec<char> = charset.chars().filter(|c| seen.insert(*c)).collect();
        if distinct.is_empty() {
            return invalid("the character set of a text is empty: give at least one character");
        }
        Ok(Self {
            charset: distinct,
            ..self
        })
    }

    /// The length of the shortest strings, in characters.
    pub fn min_length(&self) -> usize {
        self.min_length
    }

    /// The length of the longest strings, in characters.
    pub fn max_length(&self) -> usize {
        self.max_length
    }

    /// The characters, in the order that numbers them in a mask and in the flat form.
    pub fn charset(&self) -> &[char] {
        &self.charset
    }

    /// The number of a character.
    pub(super) fn index(&self, c: char) -> Option<usize> {
        self.charset.iter().position(|&other| other == c)
    }

    fn sorted(&self) -> Vec<char> {
        let mut sorted = self.charset.clone();
        sorted.sort_unstable();
        sorted
    }

    pub(super) fn contains(&self, value: &Value) -> bool {
        self.check(value).is_ok()
    }

    pub(super) fn check(&self, value: &Value) -> Result<(), Fault> {
        let Value::Text(text) = value else {
            return Err(Fault::kind("a text", value));
        };
        let length = text.chars().count();
        let (min, max) = (self.min_length, self.max_length);
        if !(min..=max).contains(&length) {
            return Err(Fault::new(format!(
                "{length} characters are not between {min} and {max}"
            )));
        }
        match text
            .chars()
            .enumerate()
            .find(|(_, c)| !self.charset.contains(c))
        {
            None => Ok(()),
            Some((i, c)) => Err(Fault::new(format!("{c:?} is not among the characters")).at(i)),
        }
    }

    pub(super) fn draw<T: Weight>(
        &self,
        rng: &mut Generator,
        selection: &Selection<T>,
        out: &mut Value,
    ) {
        let (length, weights) = match selection {
            Selection::Text { length, characters } => (*length, characters.as_deref()),
            _ => (None, None),
        };
        let length = length.unwrap_or_else(|| {
            rng.integers(self.min_length as i64, self.max_length as i64 + 1) as usize
        });
        let probabilities = match weights {
            Some(weights) => T::probabilities(weights),
            None => vec![1.0 / self.charset.len() as f64; self.charset.len()],
        };
        // If no character is allowed, the text is empty.
        let length = if probabilities.iter().any(|&p| p > 0.0) {
            length
        } else {
            0
        };
        if !matches!(out, Value::Text(_)) {
            *out = Value::Text(String::new());
        }
        if let Value::Text(text) = out {
            text.clear();
            text.extend((0..length).map(|_| self.charset[rng.choice_p(&probabilities)]));
        }
    }
}

/// The order of the characters does not matter, as in Gymnasium.
impl PartialEq for TextSpace {
    fn eq(&self, other: &Self) -> bool {
        self.min_length == other.min_length
            && self.max_length == other.max_length
            && self.sorted() == other.sorted()
    }
}

impl Eq for TextSpace {}

/// Prints as Gymnasium does, with the characters sorted: `Text(1, 8, charset=abc)`.
impl fmt::Display for TextSpace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let charset: String = self.sorted().into_iter().collect();
        write!(
            f,
            "Text({}, {}, charset={charset})",
            self.min_length, self.max_length
        )
    }
}

/// The stored form.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Description {
    min_length: usize,
    max_length: usize,
    charset: String,
}

impl From<TextSpace> for Description {
    fn from(space: TextSpace) -> Self {
        Self {
            min_length: space.min_length,
            max_length: space.max_length,
            charset: space.charset.into_iter().collect(),
        }
    }
}

impl TryFrom<Description> for TextSpace {
    type Error = Error;

    fn try_from(stored: Description) -> Result<Self> {
        Self::new(stored.min_length, stored.max_length)?.with_charset(&stored.charset)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn constructors_refuse_bad_lengths_and_empty_sets() {
        assert!(
            TextSpace::new(3, 2)
                .unwrap_err()
                .to_string()
                .contains("from 3 to 2")
        );
        assert!(TextSpace::new(0, usize::MAX).is_err());
        assert!(TextSpace::new(0, 0).is_ok());
        assert!(TextSpace::new(0, 2).unwrap().with_charset("").is_err());
    }

    #[test]
    fn characters_keep_their_order_and_count_once() {
        let space = TextSpace::new(0, 2).unwrap().with_charset("cabac").unwrap();
        assert_eq!(space.charset(), ['c', 'a', 'b']);
        assert_eq!(space.to_string(), "Text(0, 2, charset=abc)");
        assert_eq!(
            space,
            TextSpace::new(0, 2).unwrap().with_charset("abc").unwrap()
        );
        assert_ne!(
            space,
            TextSpace::new(0, 2).unwrap().with_charset("abd").unwrap()
        );
        assert_ne!(
            space,
            TextSpace::new(1, 2).unwrap().with_charset("abc").unwrap()
        );
    }

    /// With a comparison for each pair of characters this would take minutes.
    #[test]
    fn every_character_can_be_in_the_set() {
        let all: String = ('\0'..=char::MAX).collect();
        let space = TextSpace::new(0, 1).unwrap().with_charset(&all).unwrap();
        assert_eq!(space.charset().len(), all.chars().count());
    }

    #[test]
    fn contains_counts_characters() {
        let space = TextSpace::new(1, 2).unwrap().with_charset("aé").unwrap();
        let contains = |text: &str| space.contains(&Value::Text(text.to_owned()));
        assert!(contains("é") && contains("éa") && contains("aa"));
        assert!(!contains("") && !contains("ééé") && !contains("b"));
        assert!(!space.contains(&Value::Int(1)));
    }

    #[test]
    fn faults_name_the_character() {
        let space = TextSpace::new(1, 3).unwrap().with_charset("ab").unwrap();
        let fault = |text: &str| {
            space
                .check(&Value::Text(text.to_owned()))
                .unwrap_err()
                .to_string()
        };
        assert_eq!(fault("abc"), "[2]: 'c' is not among the characters");
        assert_eq!(fault("abab"), "4 characters are not between 1 and 3");
    }

    #[test]
    fn stored_form_keeps_the_order() {
        let space = TextSpace::new(0, 2).unwrap().with_charset("ba").unwrap();
        let stored = serde_json::to_string(&space).unwrap();
        assert_eq!(stored, r#"{"min_length":0,"max_length":2,"charset":"ba"}"#);
        assert_eq!(
            serde_json::from_str::<TextSpace>(&stored)
                .unwrap()
                .charset(),
            ['b', 'a']
        );
    }
}
