//! `cargo xtask docs`: the pages about the environments, and the book around them.

mod draw;
mod numbers;
mod page;
mod returns;

use std::path::{Path, PathBuf};

use gym::render::file;
use gym::{Error, Result};

use crate::output::say;
use crate::workspace::Workspace;

#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Replays the episodes of the table of returns; takes minutes.
    #[arg(long)]
    measure: bool,
    /// Redraws the images.
    #[arg(long)]
    draw: bool,
    /// Writes nothing; fails if a file is out of date.
    #[arg(long)]
    check: bool,
}

/// A file: its path from the folder of the workspace, and its content.
pub type Document = (PathBuf, Vec<u8>);

/// The book that contains the pages on the environments, if a workspace has a book.
#[derive(Clone, Copy, Debug)]
pub struct Book {
    /// Returns the book's table of contents, given the folder of the workspace and the entries of
    /// the families, as a Markdown list.
    pub contents: fn(&Path, &str) -> Result<Document>,
    /// The text below the list of environments.
    pub below_list: &'static str,
    /// The section on differences of a page whose module has none.
    pub no_difference: &'static str,
    /// Returns the book's other generated files, given the folder of the workspace; with `true`,
    /// also the images.
    pub documents: fn(&Path, bool) -> Result<Vec<Document>>,
    /// Checks the book, given the folder of the workspace.
    pub check: fn(&Path) -> Result<()>,
}

pub(crate) fn docs(
    arguments: &Arguments,
    workspace: &Workspace,
    book: Option<&Book>,
) -> Result<()> {
    let folder = workspace.folder();
    let returns = if arguments.measure {
        returns::measure(workspace)?
    } else {
        returns::read(folder)?
    };
    let sections = page::all(workspace)?;
    let mut documents = page::documents(&sections, &returns, folder, book)?;
    if !returns.is_empty() {
        documents.push(returns::document(&returns)?);
    }
    if let Some(book) = book {
        documents.extend((book.documents)(folder, arguments.draw)?);
    }
    if arguments.draw {
        for page in sections.iter().flat_map(|section| &section.pages) {
            documents.extend(draw::gif(page)?);
        }
    }
    settle(documents, folder, arguments.check)?;
    book.map_or(Ok(()), |book| (book.check)(folder))
}

/// Writes the documents that differ from the files of `folder`. With `is_check` it writes nothing, and
/// one that differs is an error.
fn settle(documents: Vec<Document>, folder: &Path, is_check: bool) -> Result<()> {
    let mut changed = documents.into_iter().filter(|(path, content)| {
        gym::file::read(&folder.join(path), usize::MAX).map_or(true, |old| old != *content)
    });
    if is_check {
        if let Some((path, _)) = changed.next() {
            let reason = format!("{} is out of date: run `cargo xtask docs`", path.display());
            return Err(Error::custom(reason));
        }
    } else {
        for (path, content) in changed {
            let path = folder.join(path);
            let folder = path.parent().unwrap_or(folder);
            std::fs::create_dir_all(folder).map_err(|error| Error::io(folder, error))?;
            file::write(&path, &content)?;
            say(format_args!("wrote {}", path.display()))?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A book whose table of contents are the entries, with a page of its own, and a fault if there is a file `fault`.
    #[cfg(unix)]
    const BOOK: Book = Book {
        contents: |_, entries| Ok(("docs/SUMMARY.md".into(), entries.into())),
        below_list: "",
        no_difference: "",
        documents: |_, _| Ok(vec![("docs/own.md".into(), b"own".to_vec())]),
        check: |folder| match folder.join("fault").exists() {
            true => Err(Error::custom("the book has a fault")),
            false => Ok(()),
        },
    };

    #[cfg(unix)]
    #[test]
    fn a_check_compares_the_pages_the_contents_and_what_the_book_adds() {
        let folder = std::env::temp_dir().join(format!("gym-cli-book-{}", std::process::id()));
        std::fs::create_dir(&folder).unwrap();
        std::fs::write(folder.join("Cargo.lock"), "").unwrap();
        // the texts of the pages are those of the modules
        let crates = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap();
        std::os::unix::fs::symlink(crates, folder.join("crates")).unwrap();
        let workspace = Workspace::of(&folder.join("xtask"));
        let docs = |check: bool| {
            let arguments = Arguments {
                measure: false,
                draw: false,
                check,
            };
            docs(&arguments, &workspace, Some(&BOOK)).map_err(|error| error.to_string())
        };
        docs(false).unwrap();
        docs(true).unwrap();
        for name in [
            "docs/own.md",
            "docs/SUMMARY.md",
            "docs/environments/cartpole.md",
        ] {
            let file = folder.join(name);
            let right = std::fs::read(&file).unwrap();
            std::fs::write(&file, [&right[..], b"x"].concat()).unwrap();
            let error = docs(true).unwrap_err();
            assert_eq!(
                error,
                format!("{name} is out of date: run `cargo xtask docs`")
            );
            std::fs::write(&file, right).unwrap();
        }
        std::fs::write(folder.join("fault"), "").unwrap();
        assert_eq!(docs(true).unwrap_err(), "the book has a fault");
        std::fs::remove_dir_all(&folder).unwrap();
    }

    #[test]
    fn a_document_that_differs_is_an_error_or_written() {
        let folder = std::env::temp_dir().join(format!("gym-cli-docs-{}", std::process::id()));
        std::fs::create_dir(&folder).unwrap();
        let documents = [("a.md", "one"), ("deep/er/b.md", "two"), ("c.md", "three")];
        let documents = || {
            let document = |(path, text): (&str, &str)| (PathBuf::from(path), Vec::from(text));
            documents.map(document).to_vec()
        };
        let settle = |is_check| settle(documents(), &folder, is_check);
        let names = |error: Result<()>| error.expect_err("it differs").to_string();

        let error = names(settle(true));
        assert_eq!(error, "a.md is out of date: run `cargo xtask docs`");
        let mut entries = std::fs::read_dir(&folder).unwrap();
        assert!(entries.next().is_none(), "a check writes nothing");
        settle(false).unwrap();
        for (path, text) in documents() {
            assert_eq!(std::fs::read(folder.join(path)).unwrap(), text);
        }
        settle(true).unwrap();
        for (path, text) in documents() {
            let file = folder.join(&path);
            for other in [&b""[..], &[&text[..], b"\n"].concat(), &text[1..]] {
                std::fs::write(&file, other).unwrap();
                let error = names(settle(true));
                assert!(error.starts_with(path.to_str().unwrap()), "{error}");
                assert_eq!(std::fs::read(&file).unwrap(), other);
            }
            settle(false).unwrap();
            assert_eq!(std::fs::read(&file).unwrap(), text);
        }
        std::fs::remove_dir_all(&folder).unwrap();
    }
}
