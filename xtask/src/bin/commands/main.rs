//! The commands over the environments of this workspace, and its book.

mod book;
#[cfg(feature = "families")]
mod games;
mod sheet;
#[cfg(feature = "families")]
mod versions;
mod wrappers;

use std::path::Path;
use std::process::ExitCode;

use gym::Result;
use gym_cli::{Book, Document};

fn main() -> ExitCode {
    let book = Book {
        contents: |folder, entries| book::page(folder, CONTENTS, CONTENTS_MARKS, entries),
        below_list: BELOW_LIST,
        no_difference: NO_DIFFERENCE,
        documents,
        check: |folder| book::check(&folder.join("docs")),
    };
    gym_cli::main_with_book(env!("CARGO_MANIFEST_DIR"), &book)
}

/// Returns the pages with the tables of wrappers and games, and the contact sheet.
fn documents(folder: &Path, draw: bool) -> Result<Vec<Document>> {
    let mut documents = vec![wrappers::document(folder)?];
    #[cfg(feature = "families")]
    documents.push(games::document(folder)?);
    #[cfg(feature = "families")]
    documents.push(versions::document(folder)?);
    if draw {
        documents.push(sheet::document()?);
    }
    Ok(documents)
}

const CONTENTS: &str = "docs/SUMMARY.md";
const CONTENTS_MARKS: book::Marks = [
    "<!-- families: written by cargo xtask docs -->\n",
    "<!-- end of families -->\n",
];

const BELOW_LIST: &str = "
## Ids

An id is `[namespace/]Name[-vVersion]`. Without a version, `make` takes the newest. Older versions keep their behaviour; `make` then
logs a warning that names the newer one. Ids in the namespace `rapier/` are the same tasks on another physics engine,
[rapier2d](https://rapier.rs): similar to Gymnasium's, but not equal.

For every environment, NaN or infinite actions are an error. Numbers beyond the bounds of a `Box` are not; the environment clips them
if Gymnasium's does. Unknown options of `reset` are an error in the environments with options (classic control, CarRacing, mazes and
the Adroit hands), and ignored elsewhere, as in Gymnasium.

`cargo xtask list --long` prints ids, spaces, limits and thresholds; `cargo xtask play ID` lets you play.
";

const NO_DIFFERENCE: &str = "None known: the same seed gives the same episode, to the last bit ([reproducibility](../reproducibility.md)).";
