//! The tables of the numbers in observations and actions, on the pages about the environments.

use std::collections::BTreeSet;

use gym::names::{Part, parts};
use gym::{DType, Env, Names, Registration, Result, Space};

/// The most rows with a number each; in longer tables, alike numbers share a row.
const MOST_ROWS: usize = 40;

/// Returns the tables of `registrations`, of which `shown` comes first; empty if their numbers have no
/// names. A single number, whose name the page has anyway, needs no table.
pub(super) fn tables(shown: &Registration, registrations: &[Registration]) -> Result<String> {
    let others = registrations
        .iter()
        .filter(|entry| entry.id() != shown.id());
    let mut named = Vec::new();
    for entry in [shown].into_iter().chain(others) {
        if let Some(names) = entry.page.names {
            let env = entry.spec()?.make()?;
            named.push((entry.id(), names(&env), env));
        }
    }
    let mut text = String::new();
    for (kind, names_of, space_of) in KINDS {
        let Some((id, names, env)) = named.iter().find(|(_, names, _)| names_of(names).len() > 1)
        else {
            continue;
        };
        let all: BTreeSet<_> = named.iter().map(|(_, names, _)| names_of(names)).collect();
        let of = if all.len() > 1 || registrations.len() > named.len() {
            format!(" of `{id}`")
        } else {
            String::new()
        };
        let space = space_of(env);
        let table = table(&parts(&space, names_of(names))?);
        text += &format!("{kind}{of}:\n\n{table}\n");
    }
    Ok(text)
}

type Kind = (
    &'static str,
    fn(&Names) -> &[String],
    fn(&gym::BoxEnv) -> Space,
);

const KINDS: [Kind; 2] = [
    (
        "An observation",
        |names| &names.observation,
        |env| env.observation_space(),
    ),
    ("An action", |names| &names.action, |env| env.action_space()),
];

fn table(parts: &[Part<'_>]) -> String {
    let has_parts = parts.iter().any(|part| !part.path.is_empty());
    let is_long = parts.iter().map(|part| part.names.len()).sum::<usize>() > MOST_ROWS;
    let mut rows = Vec::new();
    for part in parts {
        let ranges = ranges(part.space);
        let range = |i: usize| ranges.get(i).map_or("", String::as_str);
        let mut first = 0;
        while first < part.names.len() {
            let (mut count, mut name) = (1, part.names[first].clone());
            if is_long {
                (count, name) = run(&part.names[first..]);
            }
            let last = first + count - 1;
            if (first..=last).any(|i| range(i) != range(first)) {
                (count, name) = (1, part.names[first].clone());
            }
            let number = match count {
                1 => first.to_string(),
                _ => format!("{first} to {last}"),
            };
            rows.push([
                format!("`{}`", part.path),
                number,
                name,
                range(first).to_owned(),
            ]);
            first += count;
        }
    }
    let has_ranges = rows.iter().any(|[.., range]| !range.is_empty());
    let columns = [has_parts, true, true, has_ranges];
    let line = |cells: [&str; 4]| {
        let cells = cells.into_iter().zip(columns).filter(|(_, shown)| *shown);
        let cells: Vec<_> = cells.map(|(cell, _)| cell.replace('|', "\\|")).collect();
        format!("| {} |\n", cells.join(" | "))
    };
    let mut text = line(["part", "number", "name", "range"]);
    text += &format!(
        "|{}\n",
        "---|".repeat(columns.iter().filter(|shown| **shown).count())
    );
    for row in &rows {
        text += &line([&row[0], &row[1], &row[2], &row[3]]);
    }
    text
}

/// Returns how many names at the start differ in one word alone, and their common text with all
/// these words: `angle of hip, knee (rad)`.
fn run(names: &[String]) -> (usize, String) {
    let first: Vec<_> = names[0].split(' ').collect();
    let mut place = None;
    let mut varying = Vec::new();
    for name in &names[1..] {
        let words: Vec<_> = name.split(' ').collect();
        if words.len() != first.len() {
            break;
        }
        let mut different = (0..words.len()).filter(|i| words[*i] != first[*i]);
        let (Some(at), None) = (different.next(), different.next()) else {
            break;
        };
        if *place.get_or_insert(at) != at {
            break;
        }
        varying.push(words[at]);
    }
    let Some(at) = place else {
        return (1, names[0].clone());
    };
    let list = [&[first[at]], &varying[..]].concat().join(", ");
    let mut words = first;
    words[at] = &list;
    (varying.len() + 1, words.join(" "))
}

/// Returns the range of each number of a space; empty texts where there is none.
fn ranges(space: &Space) -> Vec<String> {
    match space {
        Space::Discrete(space) => {
            let last = i128::from(space.start()) + i128::from(space.n()) - 1;
            vec![format!("{} to {last}", space.start())]
        }
        Space::Box(space) => {
            let text = |x: f64| match space.dtype() {
                DType::F32 => (x as f32).to_string(),
                _ => x.to_string(),
            };
            let bounds = space.low().iter_f64().zip(space.high().iter_f64());
            let range = |(low, high): (f64, f64)| match (low.is_finite(), high.is_finite()) {
                (true, true) => format!("{} to {}", text(low), text(high)),
                (true, false) => format!("from {}", text(low)),
                (false, true) => format!("up to {}", text(high)),
                (false, false) => String::new(),
            };
            bounds.map(range).collect()
        }
        _ => Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn strings(names: &[&str]) -> Vec<String> {
        Names::new(names, &[]).observation
    }

    #[test]
    fn alike_numbers_share_a_row() {
        let names = strings(&[
            "x of hip (m)",
            "y of hip (m)",
            "z of hip (m)",
            "z of knee (m)",
            "z",
        ]);
        assert_eq!(run(&names), (3, "x, y, z of hip (m)".to_owned()));
        assert_eq!(run(&names[2..]), (2, "z of hip, knee (m)".to_owned()));
        assert_eq!(run(&names[3..]), (1, "z of knee (m)".to_owned()));
    }

    #[test]
    fn a_table_has_the_columns_that_are_needed() {
        let space = Space::boxed([-4.8_f32, f32::NEG_INFINITY], [4.8, 0.5]);
        let names = strings(&["position (m)", "velocity (m/s)"]);
        let text = table(&parts(&space, &names).unwrap());
        let expected = "| number | name | range |\n|---|---|---|\n| 0 | position (m) | -4.8 to 4.8 |\n\
                        | 1 | velocity (m/s) | up to 0.5 |\n";
        assert_eq!(text, expected);
    }
}
