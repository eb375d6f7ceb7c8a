//! The table of wrappers and their arguments in `docs/wrappers.md`, from the registrations.

use std::fmt::Write;
use std::path::Path;

use gym::registry::{self, WrapperRegistration};
use gym::{Argument, Error, Result};
use gym_cli::Document;

use crate::book::{self, Marks};

const PAGE: &str = "docs/wrappers.md";
const MARKS: Marks = [
    "<!-- wrappers: written by cargo xtask docs -->\n",
    "<!-- end of wrappers -->\n",
];

/// Returns the page with the table of the registered wrappers.
pub(crate) fn document(folder: &Path) -> Result<Document> {
    let mut table =
        String::from("| wrapper | around | what it does | arguments |\n|---|---|---|---|\n");
    let all = registry::wrappers();
    for (i, wrapper) in all.iter().enumerate() {
        // one row for a wrapper of environments and its counterpart for vectors
        if i > 0 && all[i - 1].name == wrapper.name {
            continue;
        }
        let same: Vec<_> = all
            .iter()
            .filter(|other| other.name == wrapper.name)
            .collect();
        let (mut arguments, mut seen) = (Vec::new(), Vec::new());
        for argument in same.iter().flat_map(|wrapper| wrapper.arguments()) {
            if !seen.contains(&argument.name) {
                seen.push(argument.name);
                arguments.push(described(&argument));
            }
        }
        let around = |is: fn(&WrapperRegistration) -> bool| same.iter().any(|wrapper| is(wrapper));
        let around = match (
            around(WrapperRegistration::wraps_envs),
            around(WrapperRegistration::wraps_vectors),
        ) {
            (true, true) => "both",
            (true, false) => "environments",
            _ => "vectors",
        };
        let (name, what) = (wrapper.name, wrapper.description);
        let row = writeln!(
            table,
            "| `{name}` | {around} | {what} | {} |",
            arguments.join("<br>")
        );
        row.map_err(|error| Error::custom(error.to_string()))?;
    }
    book::page(folder, PAGE, MARKS, &table)
}

/// Describes an argument, such as `` `delay` (integer, 1): ... ``.
fn described(argument: &Argument) -> String {
    let Argument {
        name,
        kind,
        meaning,
        default,
        required,
        ..
    } = argument;
    let default = if *required {
        "required".to_owned()
    } else {
        format!("default `{default}`")
    };
    // links work only in the crate's documentation
    let meaning = meaning.replace("[`", "`").replace("`]", "`");
    format!(
        "`{name}` ({kind}, {default}): {}",
        meaning.replace('|', "\\|")
    )
}
