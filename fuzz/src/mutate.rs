//! Mutations of inputs.

use std::ops::Range;

use gym::Generator;
use serde_json::{Value as Json, json};

/// Numbers for which formulas and checks often fail.
const NUMBERS: [&str; 20] = [
    "0",
    "-0",
    "1",
    "-1",
    "2",
    "0.5",
    "1e-3",
    "1e-9",
    "1e-15",
    "1e-160",
    "5e-324",
    "1e6",
    "1e15",
    "1e160",
    "1e308",
    "-1e308",
    "1000",
    "2147483648",
    "90",
    "nan",
];

/// Mutates inputs at random, mostly as JSON or XML, so that they pass the parser.
#[derive(Debug)]
pub struct Mutator {
    rng: Generator,
}

impl Mutator {
    /// Makes a mutator; equal seeds make equal mutations.
    pub fn new(seed: u64) -> Self {
        Self {
            rng: Generator::from(seed),
        }
    }

    /// Returns a number below `n`, which must be at least 1.
    pub fn below(&mut self, n: usize) -> usize {
        self.rng.integers(0, n.max(1) as i64) as usize
    }

    /// Returns `input` with one to four mutations, which may copy parts of `other`.
    pub fn mutate(&mut self, input: &[u8], other: &[u8]) -> Vec<u8> {
        const OF_BYTES: usize = 6; // one in six inputs
        let changes = 1 + self.below(4);
        let parsed = serde_json::from_slice::<Json>(input);
        if self.below(OF_BYTES) > 0
            && let Ok(mut json) = parsed
        {
            let other = serde_json::from_slice(other).unwrap_or(Json::Null);
            for _ in 0..changes {
                self.change(&mut json, &other);
            }
            return json.to_string().into_bytes();
        }
        if self.below(OF_BYTES) > 0
            && input.starts_with(b"<")
            && let (Ok(text), Ok(other)) = (str::from_utf8(input), str::from_utf8(other))
        {
            let mut text = text.to_owned();
            for _ in 0..changes {
                self.change_xml(&mut text, other);
            }
            return text.into_bytes();
        }
        // words of a text after its first byte
        let text = input.get(1..).filter(|text| text.is_ascii());
        if self.below(OF_BYTES) > 0
            && let Some(Ok(text)) = text.map(str::from_utf8)
        {
            let mut text = text.to_owned();
            for _ in 0..changes {
                self.change_words(&mut text);
            }
            return [&input[..1], text.as_bytes()].concat();
        }
        let mut bytes = input.to_vec();
        for _ in 0..changes {
            self.change_bytes(&mut bytes, other);
        }
        bytes
    }

    /// Returns `input`, a JSON text, once for each of its nodes and each replacement of a node;
    /// nothing for other inputs.
    pub fn everywhere(input: &[u8]) -> impl Iterator<Item = Vec<u8>> {
        let json = serde_json::from_slice::<Json>(input).unwrap_or(Json::Null);
        let nodes = count(&json);
        (1..nodes).flat_map(move |target| {
            let near = node_mut(&mut json.clone(), &mut { target }).and_then(|node| node.as_f64());
            let changed = replacements(near.unwrap_or_default()).map(|replacement| {
                let mut json = json.clone();
                if let Some(node) = node_mut(&mut json, &mut { target }) {
                    *node = replacement;
                }
                json.to_string().into_bytes()
            });
            changed.into_iter()
        })
    }

    /// Changes a line or a word of a text.
    fn change_words(&mut self, text: &mut String) {
        let mut lines: Vec<Vec<&str>> =
            text.lines().map(|line| line.split(' ').collect()).collect();
        let (i, j) = (self.below(lines.len()), self.below(lines.len()));
        let Some(words) = lines.get_mut(i) else {
            return;
        };
        let word = self.below(words.len());
        match self.below(5) {
            0 => drop(lines.remove(i)),
            1 => lines.insert(i, lines[j].clone()),
            2 => words.insert(word, NUMBERS[self.below(NUMBERS.len())]),
            _ if words.is_empty() => {}
            3 => drop(words.remove(word)),
            _ => words[word] = NUMBERS[self.below(NUMBERS.len())],
        }
        let lines: Vec<_> = lines.iter().map(|words| words.join(" ")).collect();
        *text = lines.join("\n");
    }

    /// Changes one node. Each node has the same probability.
    fn change(&mut self, json: &mut Json, other: &Json) {
        let target = self.below(count(json));
        let part = self.below(count(other));
        let Some(node) = node_mut(json, &mut { target }) else {
            return;
        };
        match self.below(4) {
            0 => {
                *node = node_mut(&mut other.clone(), &mut { part })
                    .cloned()
                    .unwrap_or(Json::Null);
            }
            1 => self.restructure(node),
            _ => self.replace(node),
        }
    }

    fn replace(&mut self, node: &mut Json) {
        let near = node.as_f64().unwrap_or_default();
        let fixed = replacements(near);
        *node = match self.below(fixed.len() + 2) {
            0 => json!(1u64 << self.below(64)),
            1 => json!(self.rng.uniform(-2.0, 2.0)),
            i => fixed[i - 2].clone(),
        };
    }

    /// Adds, removes, repeats or swaps elements of an array or object.
    fn restructure(&mut self, node: &mut Json) {
        match node {
            Json::Array(items) => {
                let (i, j) = (self.below(items.len()), self.below(items.len()));
                match self.below(3) {
                    _ if items.is_empty() => items.push(json!(0)),
                    0 => drop(items.remove(i)),
                    1 => items.insert(i, items[j].clone()),
                    _ => items.swap(i, j),
                }
            }
            Json::Object(map) => {
                let Some(key) = map.keys().nth(self.below(map.len())).cloned() else {
                    return;
                };
                match self.below(3) {
                    0 => drop(map.remove(&key)),
                    1 => drop(map.insert(format!("{key}x"), json!(1))),
                    _ => {
                        let other = map
                            .keys()
                            .nth(self.below(map.len()))
                            .cloned()
                            .unwrap_or_default();
                        let value = map[&other].clone();
                        map.insert(key, value);
                    }
                }
            }
            Json::String(text) => {
                let mut bytes = std::mem::take(text).into_bytes();
                self.change_bytes(&mut bytes, b"aG\xc3\xa9");
                *text = String::from_utf8_lossy(&bytes).into_owned();
            }
            _ => self.replace(node),
        }
    }

    /// Changes an attribute, or moves lines, which nearly always contain whole elements.
    fn change_xml(&mut self, text: &mut String, other: &str) {
        let (own, others) = (attributes(text), attributes(other));
        let choice = self.below(9);
        if choice < 3 || own.is_empty() {
            let from = if self.below(2) == 0 {
                text.as_str()
            } else {
                other
            };
            let new = from
                .lines()
                .nth(self.below(from.lines().count()))
                .unwrap_or_default()
                .to_owned();
            let mut lines: Vec<&str> = text.lines().collect();
            let i = self.below(lines.len());
            match choice {
                _ if lines.is_empty() => lines.push(&new),
                0 => drop(lines.remove(i)),
                1 => lines.insert(i, &new),
                _ => lines[i] = &new,
            }
            *text = lines.join("\n");
            return;
        }
        let [name, value] = own[self.below(own.len())].clone();
        let taken = others.get(self.below(others.len())).cloned();
        let taken = taken.map(|ranges| ranges.map(|range| &other[range]));
        let mut words: Vec<&str> = text[value.clone()].split_whitespace().collect();
        let i = self.below(words.len());
        match (choice, taken) {
            (3, _) => text.replace_range(name.start..value.end + 1, ""),
            (4, Some([other_name, _])) => text.replace_range(name, other_name),
            (5, Some([_, other_value])) => text.replace_range(value, other_value),
            (6, Some([other_name, other_value])) => {
                text.insert_str(name.start, &format!("{other_name}=\"{other_value}\" "));
            }
            _ => {
                match self.below(8) {
                    _ if words.is_empty() => words.push("1"),
                    0 => drop(words.remove(i)),
                    1 => words.insert(i, "0"),
                    2 => words.iter_mut().for_each(|word| *word = "0"),
                    _ => words[i] = NUMBERS[self.below(NUMBERS.len())],
                }
                let words = words.join(" ");
                text.replace_range(value, &words);
            }
        }
    }

    fn change_bytes(&mut self, bytes: &mut Vec<u8>, other: &[u8]) {
        let (i, j) = (self.below(bytes.len()), self.below(other.len()));
        match self.below(5) {
            _ if bytes.is_empty() => bytes.extend(other),
            0 => drop(bytes.remove(i)),
            1 => bytes.insert(i, self.below(256) as u8),
            2 => bytes[i] ^= 1 << self.below(8),
            3 => bytes.truncate(i),
            _ => bytes
                .splice(i.., other.get(j..).unwrap_or_default().iter().copied())
                .for_each(drop),
        }
    }
}

/// Values in place of a node, of which `near` is the number.
fn replacements(near: f64) -> [Json; 21] {
    [
        Json::Null,
        json!(true),
        json!(""),
        json!([]),
        json!({}),
        json!(i64::MAX),
        json!(i64::MIN),
        json!(u64::MAX),
        json!(1e308),
        json!(-1e308),
        json!(5e-324),
        json!("inf"),
        json!({"$float": "NaN"}),
        json!({"$float": "inf"}),
        json!(-1),
        json!(0),
        json!(near + 1.0),
        json!((near as i64).saturating_add(1)),
        json!((near as i64).saturating_sub(1)),
        json!(near * 1000.0),
        json!(-near),
    ]
}

/// Finds the attributes of an XML text: names, and values without quotes.
fn attributes(text: &str) -> Vec<[Range<usize>; 2]> {
    let mut found = Vec::new();
    let mut start = 0;
    while let Some(equals) = text[start..].find("=\"").map(|i| start + i) {
        let value = equals + 2;
        let Some(end) = text[value..].find('"').map(|i| value + i) else {
            break;
        };
        let before = text[..equals]
            .rfind(|c: char| !c.is_ascii_alphanumeric())
            .map_or(0, |i| i + 1);
        // the character before a name may have several bytes
        if text.is_char_boundary(before) {
            found.push([before..equals, value..end]);
        }
        start = end + 1;
    }
    found
}

/// Returns the number of nodes in a document.
fn count(json: &Json) -> usize {
    1 + match json {
        Json::Array(items) => items.iter().map(count).sum(),
        Json::Object(map) => map.values().map(count).sum(),
        _ => 0,
    }
}

/// Returns the node with the index `index`, in depth-first order.
fn node_mut<'a>(json: &'a mut Json, index: &mut usize) -> Option<&'a mut Json> {
    if *index == 0 {
        return Some(json);
    }
    *index -= 1;
    match json {
        Json::Array(items) => items.iter_mut().find_map(|item| node_mut(item, index)),
        Json::Object(map) => map.values_mut().find_map(|value| node_mut(value, index)),
        _ => None,
    }
}
