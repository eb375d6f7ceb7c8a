//! `cargo xtask docs`: the pages about the environments, and the check of the whole book.

mod book;
mod draw;
#[cfg(feature = "families")]
mod games;
mod page;
mod returns;
#[cfg(feature = "families")]
mod versions;
mod wrappers;

use std::path::{Path, PathBuf};

use gym::rendering::file;
use gym::{Error, Result};

use crate::output::say;
use crate::selection::Selection;

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

/// A file of the book: its path from the folder of the workspace or plugin, and its content.
type Document = (PathBuf, Vec<u8>);

/// A file whose path starts at a folder, or at one of those around it.
fn read(folder: &Path, path: &str) -> Result<String> {
    let found = folder
        .ancestors()
        .map(|folder| folder.join(path))
        .find(|path| path.exists());
    let path = found.unwrap_or_else(|| folder.join(path));
    std::fs::read_to_string(&path).map_err(|error| Error::io(&path, error))
}

/// The lines around a part of a page that is written here.
type Marks = [&'static str; 2];

/// A page with this text between its marks.
fn between(name: &str, page: &str, marks: Marks, text: &str) -> Result<String> {
    let parts = page
        .split_once(marks[0])
        .and_then(|(head, rest)| Some((head, rest.split_once(marks[1])?.1)));
    let (head, tail) =
        parts.ok_or_else(|| Error::custom(format!("{name} lacks the marks around its table")))?;
    Ok(format!("{head}{}\n{text}\n{}{tail}", marks[0], marks[1]))
}

pub(crate) fn docs(arguments: &Arguments, selection: Selection) -> Result<()> {
    let folder = selection.folder();
    let returns = if arguments.measure {
        returns::measure(selection)?
    } else {
        returns::read(&folder)?
    };
    let pages = page::all(selection)?;
    let mut documents = page::documents(&pages, &returns)?;
    if !returns.is_empty() {
        documents.push(returns::document(&returns)?);
    }
    documents.extend(wrappers::document(&folder)?);
    #[cfg(feature = "families")]
    documents.extend(games::document(&folder)?);
    #[cfg(feature = "families")]
    documents.extend(versions::document(&folder)?);
    if arguments.draw {
        for page in &pages {
            documents.extend(draw::gif(page)?);
        }
        if let Selection::All = selection {
            documents.push(draw::sheet()?);
        }
    }
    let mut changed = documents.into_iter().filter(|(path, content)| {
        std::fs::read(folder.join(path)).map_or(true, |old| old != *content)
    });
    if arguments.check {
        if let Some((path, _)) = changed.next() {
            let reason = format!("{} is out of date: run `cargo xtask docs`", path.display());
            return Err(Error::custom(reason));
        }
    } else {
        for (path, content) in changed {
            let path = folder.join(path);
            let folder = path.parent().unwrap_or(&folder);
            std::fs::create_dir_all(folder).map_err(|error| Error::io(folder, error))?;
            file::write(&path, &content)?;
            say!("wrote {}", path.display())?;
        }
    }
    let book = folder.join("docs");
    // a plugin need not have a book around its pages
    if book.join("SUMMARY.md").exists() {
        book::check(&book)
    } else {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_is_put_between_its_marks() {
        let marks = ["<a>\n", "<b>\n"];
        let page = between("page.md", "head\n<a>\nold\n<b>\ntail\n", marks, "new\n").unwrap();
        assert_eq!(page, "head\n<a>\n\nnew\n\n<b>\ntail\n");
        assert_eq!(between("page.md", &page, marks, "new\n").unwrap(), page);
        for page in ["", "<a>\n", "<b>\n<a>\n"] {
            let error = between("page.md", page, marks, "new\n")
                .unwrap_err()
                .to_string();
            assert!(error.contains("page.md lacks the marks"), "{error}");
        }
    }
}
