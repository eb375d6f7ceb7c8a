//! Names of the numbers in observations and actions.

use crate::spaces::Space;
use crate::value::{DType, Error, Result};

/// The names of the numbers in observations and actions, for
/// [`Registration::names`](crate::Registration::names). A name ends with its unit, if there is one:
/// `cart velocity (m/s)`.
///
/// The numbers are those of each `Box` and each discrete part, in the order of the space; a picture
/// and a text have none.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Names {
    /// A name for each number of an observation; empty for none.
    pub observation: Vec<String>,
    /// A name for each number of an action; empty for none.
    pub action: Vec<String>,
}

impl Names {
    /// The names of an observation's numbers and of an action's.
    pub fn new(observation: &[&str], action: &[&str]) -> Self {
        let owned = |names: &[&str]| names.iter().map(|name| (*name).to_owned()).collect();
        Self {
            observation: owned(observation),
            action: owned(action),
        }
    }
}

/// A part of a space whose numbers have names.
#[derive(Clone, Debug)]
pub struct Part<'a> {
    /// Its path in the space, such as `goal/door`; empty for the space itself.
    pub path: String,
    /// Its space.
    pub space: &'a Space,
    /// The names of its numbers.
    pub names: &'a [String],
}

/// The parts of `space`, each with its share of `names`. Without names there are no parts.
///
/// # Errors
/// If the number of names is not that of the numbers, or if a name is blank or occurs twice in a
/// part.
pub fn parts<'a>(space: &'a Space, names: &'a [String]) -> Result<Vec<Part<'a>>> {
    if names.is_empty() {
        return Ok(Vec::new());
    }
    let mut sizes = Vec::new();
    collect(String::new(), space, &mut sizes);
    let numbers: usize = sizes.iter().map(|(_, _, numbers)| numbers).sum();
    if names.len() != numbers {
        return Err(Error::custom(format!(
            "{} names for the {numbers} numbers of {space}",
            names.len()
        )));
    }
    let mut rest = names;
    let mut named = Vec::new();
    for (path, space, numbers) in sizes {
        let (names, others) = rest.split_at(numbers);
        rest = others;
        for (i, name) in names.iter().enumerate() {
            if name.trim().is_empty() || names[..i].contains(name) {
                let what = if path.is_empty() { "space" } else { &path };
                return Err(Error::custom(format!(
                    "number {i} of `{what}` is called {name:?}, which is blank or the name of another"
                )));
            }
        }
        named.push(Part { path, space, names });
    }
    Ok(named)
}

/// Adds the parts of `space` with numbers, and how many each has.
fn collect<'a>(path: String, space: &'a Space, parts: &mut Vec<(String, &'a Space, usize)>) {
    let within = |name: &str| match &*path {
        "" => name.to_owned(),
        path => format!("{path}/{name}"),
    };
    let numbers = match space {
        Space::Dict(dict) => {
            for (key, space) in dict.spaces() {
                collect(within(key), space, parts);
            }
            0
        }
        Space::Tuple(tuple) => {
            for (i, space) in tuple.spaces().iter().enumerate() {
                collect(within(&i.to_string()), space, parts);
            }
            0
        }
        Space::Discrete(_) => 1,
        Space::Box(space) if is_picture(space.shape(), space.dtype()) => 0,
        Space::Box(_) | Space::MultiBinary(_) | Space::MultiDiscrete(_) => {
            space.shape().map_or(0, |shape| shape.iter().product())
        }
        _ => 0,
    };
    if numbers > 0 {
        parts.push((path, space, numbers));
    }
}

/// Whether numbers are pixels or cells: bytes with rows and columns, or anything with more axes.
fn is_picture(shape: &[usize], dtype: DType) -> bool {
    shape.len() > 2 || shape.len() == 2 && dtype == DType::U8
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spaces::{BoxSpace, DictSpace, TupleSpace};

    fn strings(names: &[&str]) -> Vec<String> {
        Names::new(names, &[]).observation
    }

    #[test]
    fn names_go_to_the_parts_of_a_space_in_its_order() {
        let picture = BoxSpace::uniform(0.0, 255.0, [4, 4], DType::U8).unwrap();
        let goal = DictSpace::new([("door", Space::boxed([0.0; 2], [1.0; 2]))]).unwrap();
        let space: Space = DictSpace::new([
            ("cards", TupleSpace::new([2, 3].map(Space::discrete)).into()),
            ("goal", goal.into()),
            ("picture", picture.into()),
        ])
        .unwrap()
        .into();
        let names = strings(&["sum", "ace", "x (m)", "y (m)"]);
        let parts = parts(&space, &names).unwrap();
        let found: Vec<_> = parts.iter().map(|part| (&*part.path, part.names)).collect();
        let expected = [
            ("cards/0", &names[..1]),
            ("cards/1", &names[1..2]),
            ("goal/door", &names[2..]),
        ];
        assert_eq!(found, expected);
    }

    #[test]
    fn names_that_do_not_fit_are_refused() {
        let space = Space::boxed([0.0; 2], [1.0; 2]);
        for (names, fault) in [
            (&["x"] as &[&str], "1 names for the 2 numbers of Box"),
            (&["x", "x"], "number 1"),
            (&["x", " "], "number 1"),
        ] {
            let error = parts(&space, &strings(names)).unwrap_err().to_string();
            assert!(error.contains(fault), "{error}");
        }
        assert!(parts(&space, &[]).unwrap().is_empty());
    }
}
