//! The book: writes generated text between the marks of a page, and checks that the table of
//! contents has every page and that every link has a target.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use gym::{Error, Result};
use gym_cli::Document;

/// The largest size of all images of a page together. The list of environments loads every GIF.
const MAX_IMAGE_BYTES: u64 = 6_000_000;

/// The lines around a part of a page that the commands write.
pub(crate) type Marks = [&'static str; 2];

/// Returns the page at `path` in `folder`, with `text` between its marks.
pub(crate) fn page(folder: &Path, path: &str, marks: Marks, text: &str) -> Result<Document> {
    let file = folder.join(path);
    let page = gym::file::read_text(&file, usize::MAX).map_err(|error| Error::io(&file, error))?;
    Ok((path.into(), between(path, &page, marks, text)?.into_bytes()))
}

/// Returns the page `page` with `text` between its marks.
fn between(name: &str, page: &str, marks: Marks, text: &str) -> Result<String> {
    let parts = page
        .split_once(marks[0])
        .and_then(|(head, rest)| Some((head, rest.split_once(marks[1])?.1)));
    let (head, tail) =
        parts.ok_or_else(|| Error::custom(format!("{name} lacks the marks around its table")))?;
    Ok(format!("{head}{}\n{text}\n{}{tail}", marks[0], marks[1]))
}

/// Checks the book in `folder`, and reports all faults.
pub(crate) fn check(folder: &Path) -> Result<()> {
    let mut files = Vec::new();
    collect(folder, &mut files)?;
    let mut faults = Vec::new();
    let mut listed = BTreeSet::new();
    for page in files
        .iter()
        .filter(|file| file.extension().is_some_and(|extension| extension == "md"))
    {
        let text =
            gym::file::read_text(page, usize::MAX).map_err(|error| Error::io(page, error))?;
        let name = page.strip_prefix(folder).unwrap_or(page).display();
        for link in links(&text) {
            match target(folder, page, link) {
                Ok(Some(file)) if page.ends_with("SUMMARY.md") => drop(listed.insert(file)),
                Ok(_) => {}
                Err(reason) => faults.push(format!("{name}: the link `{link}` {reason}")),
            }
        }
    }
    for page in &files {
        let name = page.strip_prefix(folder).unwrap_or(page);
        let is_page = page.extension().is_some_and(|extension| extension == "md");
        if is_page && !page.ends_with("SUMMARY.md") && !listed.contains(page) {
            faults.push(format!(
                "{} is not in SUMMARY.md: add it there",
                name.display()
            ));
        }
    }
    let images = files
        .iter()
        .filter(|file| file.extension().is_some_and(|extension| extension == "gif"));
    let bytes: u64 = images
        .filter_map(|image| image.metadata().ok())
        .map(|image| image.len())
        .sum();
    if bytes > MAX_IMAGE_BYTES {
        faults.push(format!(
            "the GIFs take {bytes} bytes: more than {MAX_IMAGE_BYTES}"
        ));
    }
    match &faults[..] {
        [] => Ok(()),
        faults => Err(Error::custom(format!(
            "the book has faults:\n{}",
            faults.join("\n")
        ))),
    }
}

fn collect(folder: &Path, files: &mut Vec<PathBuf>) -> Result<()> {
    for entry in std::fs::read_dir(folder).map_err(|error| Error::io(folder, error))? {
        let path = entry.map_err(|error| Error::io(folder, error))?.path();
        if path.is_dir() {
            collect(&path, files)?;
        } else {
            files.push(path);
        }
    }
    files.sort();
    Ok(())
}

/// Returns the targets of the links and images of a page, outside of code.
fn links(text: &str) -> Vec<&str> {
    let mut links = Vec::new();
    for line in prose(text) {
        // text between backticks is code: every second part
        for part in line.split('`').step_by(2) {
            let targets = part.split("](").skip(1);
            links.extend(
                targets
                    .filter_map(|rest| rest.split_once(')'))
                    .map(|(target, _)| target),
            );
        }
    }
    links
}

/// Iterates over the lines outside of code blocks.
fn prose(text: &str) -> impl Iterator<Item = &str> {
    let mut in_code = false;
    text.lines().filter(move |line| {
        let fence = line.trim_start().starts_with("```");
        in_code ^= fence;
        !in_code && !fence
    })
}

/// Returns the file to which a link of `page` leads, `None` if the link leads out of the book, or
/// an error for a broken link.
fn target(folder: &Path, page: &Path, link: &str) -> Result<Option<PathBuf>, String> {
    // links without a target are chapters that are not written yet
    if link.is_empty() || link.starts_with("https://") || link.starts_with("http://") {
        return Ok(None);
    }
    let (path, anchor) = link.split_once('#').unwrap_or((link, ""));
    let file = match path {
        "" => page.to_owned(),
        path => page.parent().unwrap_or(folder).join(path),
    };
    let file = file
        .canonicalize()
        .map_err(|_| "leads nowhere".to_owned())?;
    let root = folder.canonicalize().map_err(|error| error.to_string())?;
    let Ok(inside) = file.strip_prefix(&root) else {
        return Err("leads out of the book".into());
    };
    if !anchor.is_empty() {
        let text = gym::file::read_text(&file, usize::MAX).map_err(|error| error.to_string())?;
        let headings = prose(&text).filter(|line| line.starts_with('#'));
        if !headings.map(slug).any(|heading| heading == anchor) {
            return Err("leads to a missing heading".into());
        }
    }
    Ok(Some(folder.join(inside)))
}

/// Returns the anchor of a heading, as GitHub and mdBook make it.
fn slug(heading: &str) -> String {
    let text = heading.trim_start_matches('#').trim().to_lowercase();
    let kept = text
        .chars()
        .filter(|c| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_'));
    kept.map(|c| if c == ' ' { '-' } else { c }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn links_are_found_outside_of_code() {
        let text = "[a](b.md) `[c](d)` ![e](f.gif)\n```rust\n[g](h)\n```\n[i](#j)";
        assert_eq!(links(text), ["b.md", "f.gif", "#j"]);
    }

    #[test]
    fn headings_become_anchors() {
        assert_eq!(
            slug("## Why is my environment not found?"),
            "why-is-my-environment-not-found"
        );
        assert_eq!(slug("# `make`, and so on"), "make-and-so-on");
    }

    #[test]
    fn faults_are_reported() {
        let folder = std::env::temp_dir().join(format!("gym-book-{}", std::process::id()));
        let _ = std::fs::remove_dir_all(&folder);
        std::fs::create_dir_all(folder.join("docs")).unwrap();
        std::fs::write(folder.join("outside.md"), "").unwrap();
        let (parent, folder) = (folder.clone(), folder.join("docs"));
        let write = |name: &str, text: &str| std::fs::write(folder.join(name), text).unwrap();
        write("SUMMARY.md", "- [One](one.md)\n- [Later]()");
        write(
            "one.md",
            "# First things\n[here](#first-things), [gym](https://example.org)",
        );
        check(&folder).unwrap();
        write(
            "two.md",
            "[gone](gone.md), [out](../outside.md), [lost](one.md#lost)",
        );
        let faults = check(&folder).unwrap_err().to_string();
        for fault in [
            "`gone.md` leads nowhere",
            "leads out",
            "heading",
            "two.md is not in SUMMARY.md",
        ] {
            assert!(faults.contains(fault), "{faults}");
        }
        std::fs::remove_dir_all(&parent).unwrap();
    }

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
