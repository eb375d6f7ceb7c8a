//! The book keeps its promise that every Rust snippet in it runs as a test.

use std::path::{Path, PathBuf};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

fn read(path: impl AsRef<Path>) -> String {
    let path = root().join(path);
    std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// The Markdown files of the book.
fn pages(folder: &Path, pages: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(root().join(folder)).expect("a folder") {
        let entry = entry.expect("an entry");
        let path = folder.join(entry.file_name());
        if entry.path().is_dir() {
            self::pages(&path, pages);
        } else if path.extension().is_some_and(|extension| extension == "md") {
            pages.push(path);
        }
    }
}

#[test]
fn every_page_with_snippets_is_a_doc_test() {
    let tested = read("tests/src/lib.rs");
    let mut all = vec![PathBuf::from("README.md")];
    pages(Path::new("docs"), &mut all);
    assert!(all.len() > 15, "{all:?}");
    for page in all {
        let text = read(&page);
        let has_snippets = text.contains("```rust");
        let page = page.to_str().expect("UTF-8").replace('\\', "/");
        assert!(
            !has_snippets || tested.contains(&format!("\"{page}\"")),
            "{page}: add it to tests/src/lib.rs"
        );
        assert!(!text.contains("```rust,"), "{page}: a snippet that does not run");
    }
}

/// The names that specs know, as an unknown one is told them.
#[test]
fn every_wrapper_of_the_registry_is_in_the_table() {
    let page = read("docs/wrappers.md");
    let unknown = gym::WrapperSpec::new("Unknown").wrap(gym::make("CartPole-v1").expect("CartPole"));
    let error = unknown.expect_err("no wrapper has this name").to_string();
    let (_, names) = error.split_once("known are ").expect("a list of names");
    assert!(names.split(", ").count() > 20, "{names}");
    for name in names.split(", ") {
        assert!(page.contains(&format!("`{name}`")), "docs/wrappers.md lacks {name}");
    }
}
