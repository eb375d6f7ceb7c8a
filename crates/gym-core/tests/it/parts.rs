//! The part that is wrong is told, or found, wherever it stands: the last of three, and within another.

use gym_core::names::{Names, parts};
use gym_core::spaces::{DictSpace, MultiDiscrete, TextSpace, TupleSpace};
use gym_core::{Space, Value};

fn dict(keys: &[&str], space: &Space) -> Space {
    let entries = keys.iter().map(|key| (*key, space.clone()));
    DictSpace::new(entries).unwrap().into()
}

fn tuple(n: usize, space: &Space) -> Space {
    TupleSpace::new(vec![space.clone(); n]).into()
}

/// Flat numbers of which one does not fit: the refusal names its part, by key or by index.
#[test]
fn the_part_of_a_flat_number_is_told() {
    let text = TextSpace::new(2, 2).and_then(|text| text.with_charset("ab"));
    let text = Space::from(text.unwrap());
    let told = |space: &Space, i: usize| {
        let flat = space.flatten(&space.sampler(0).sample()).unwrap();
        let mut numbers: Vec<f64> = flat.as_array().unwrap().iter_f64().collect();
        numbers[i] = 7.0;
        let spoilt = Value::Array(numbers.into());
        space.unflatten(&spoilt).unwrap_err().to_string()
    };
    for (space, names) in [
        (
            dict(&["x", "y", "z"], &text),
            [r#"["x"]"#, r#"["y"]"#, r#"["z"]"#],
        ),
        (tuple(3, &text), ["[0]", "[1]", "[2]"]),
        (
            tuple(3, &dict(&["x"], &text)),
            [r#"[0]["x"]"#, r#"[1]["x"]"#, r#"[2]["x"]"#],
        ),
        (
            dict(&["x", "y", "z"], &tuple(1, &text)),
            [r#"["x"][0]"#, r#"["y"][0]"#, r#"["z"][0]"#],
        ),
    ] {
        for (i, name) in names.iter().enumerate() {
            let told = told(&space, 2 * i);
            let known = format!("{name}: a number is not between 0 and 2: ");
            assert!(told.starts_with(&known), "{name}: {told}");
        }
    }
}

/// Spaces of more members have another form, also if the first of them are alike.
#[test]
fn a_form_has_a_number_of_members() {
    let one = Space::from(MultiDiscrete::new([3, 4]).unwrap());
    let keys = ["a", "b", "c"];
    for n in 0..4 {
        for m in 0..4 {
            assert_eq!(tuple(n, &one).has_form_of(&tuple(m, &one)), n == m);
            let [own, other] = [n, m].map(|n| dict(&keys[..n], &one));
            assert_eq!(own.has_form_of(&other), n == m, "{n} and {m}");
        }
    }
}

/// No two numbers of a part have one name, wherever they stand.
#[test]
fn any_two_equal_names_are_refused() {
    let space = Space::boxed([0.0; 4], [1.0; 4]);
    for i in 0..4 {
        for j in i + 1..4 {
            let mut names = ["a", "b", "c", "d"];
            names[j] = names[i];
            let names = Names::new(&names, &[]).observation;
            let told = parts(&space, &names).map(drop).unwrap_err().to_string();
            assert!(
                told.starts_with(&format!("number {j} of `space`")),
                "{told}"
            );
        }
    }
}
