//! `cargo xtask docs`: the pages about the environments, and the check of the whole book.

mod book;
mod draw;
mod page;
mod pages;
mod returns;
mod source;
mod wrappers;

use std::path::PathBuf;

use gym::rendering::file;
use gym::{Error, Result};

use crate::root;

#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Plays the episodes behind the table of returns anew; takes minutes.
    #[arg(long)]
    measure: bool,
    /// Draws the pictures anew.
    #[arg(long)]
    draw: bool,
    /// Writes nothing; fails if what is there differs from what would be written.
    #[arg(long)]
    check: bool,
}

/// A file of the book: its path from the root of the workspace, and its content.
type Document = (PathBuf, Vec<u8>);

fn read(path: &str) -> Result<String> {
    let path = root().join(path);
    std::fs::read_to_string(&path).map_err(|error| Error::io(&path, error))
}

pub(crate) fn docs(arguments: &Arguments) -> Result<()> {
    let returns = if arguments.measure { returns::measure()? } else { returns::read()? };
    let mut documents = page::all(&returns)?;
    documents.push(returns::document(&returns)?);
    documents.push(wrappers::document()?);
    if arguments.draw {
        for page in &pages::PAGES {
            documents.push(draw::gif(page)?);
        }
        documents.push(draw::sheet()?);
    }
    let mut changed = documents
        .into_iter()
        .filter(|(path, content)| std::fs::read(root().join(path)).map_or(true, |old| old != *content));
    if arguments.check {
        if let Some((path, _)) = changed.next() {
            let reason = format!("{} is out of date: run `cargo xtask docs`", path.display());
            return Err(Error::custom(reason));
        }
    } else {
        for (path, content) in changed {
            let path = root().join(path);
            let folder = path.parent().unwrap_or(root());
            std::fs::create_dir_all(folder).map_err(|error| Error::io(folder, error))?;
            file::write(&path, &content)?;
            println!("wrote {}", path.display());
        }
    }
    book::check(&root().join("docs"))
}
