//! Checks claims of the documents: snippets run, and names exist.

use std::path::{Path, PathBuf};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

fn read(path: impl AsRef<Path>) -> String {
    let path = root().join(path);
    std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// Collects the Markdown files of the book.
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
            !has_snippets || tested.contains(&format!("/{page}\"")),
            "{page}: add it to tests/src/lib.rs"
        );
        assert!(
            !text.contains("```rust,"),
            "{page}: a snippet that does not run"
        );
    }
}

#[test]
fn every_readme_of_a_crate_with_snippets_is_a_doc_test() {
    let mut seen = 0;
    for entry in std::fs::read_dir(root().join("crates")).expect("a folder") {
        let folder = entry.expect("an entry").path();
        let Ok(readme) = std::fs::read_to_string(folder.join("README.md")) else {
            continue;
        };
        if ["```rust\n", "```rust,no_run\n"]
            .iter()
            .any(|start| readme.contains(start))
        {
            let lib = read(folder.join("src/lib.rs"));
            let is_tested = lib.contains("include_str!(\"../README.md\")");
            assert!(is_tested, "{}: include its README", folder.display());
            seen += 1;
        }
    }
    assert!(seen > 15, "{seen} READMEs");
}

/// The wrapper names of specs, read from the error for an unknown name.
#[test]
fn every_wrapper_of_the_registry_is_in_the_table() {
    let page = read("docs/wrappers.md");
    let unknown =
        gym::WrapperSpec::new("Unknown").wrap(gym::make("CartPole-v1").expect("CartPole"));
    let error = unknown.expect_err("no wrapper has this name").to_string();
    let (_, names) = error.split_once("known are ").expect("a list of names");
    assert!(names.split(", ").count() > 20, "{names}");
    for name in names.split(", ") {
        assert!(
            page.contains(&format!("`{name}`")),
            "docs/wrappers.md lacks {name}"
        );
    }
}

/// Returns the README and every page of the book with their texts.
fn documents() -> Vec<(String, String)> {
    let mut all = vec![PathBuf::from("README.md")];
    pages(Path::new("docs"), &mut all);
    all.into_iter()
        .map(|path| (path.display().to_string(), read(&path)))
        .collect()
}

/// Iterates over the longest words of characters that `is_part` accepts.
fn words(text: &str, is_part: impl Fn(char) -> bool) -> impl Iterator<Item = &str> {
    text.split(move |c| !is_part(c))
        .filter(|word| !word.is_empty())
}

/// Iterates over the ids in a text: `[namespace/]Name-vVersion`.
fn ids(text: &str) -> impl Iterator<Item = &str> {
    let words = words(text, |c| {
        c.is_ascii_alphanumeric() || matches!(c, '-' | '_' | '/')
    });
    words.filter(|word| {
        word.rsplit_once("-v").is_some_and(|(name, version)| {
            !name.is_empty() && !version.is_empty() && version.bytes().all(|b| b.is_ascii_digit())
        })
    })
}

#[test]
fn every_id_in_the_documents_is_registered() {
    let mut seen = 0;
    for (page, text) in documents() {
        // the book's placeholder for an Atari game
        for id in ids(&text.replace("<Game>", "Breakout")) {
            // an id of an example, or the Python package's form of one of our ids
            let id = match id.split_once('/') {
                Some(("my_envs", _)) => continue,
                // in Python the namespace is a prefix
                Some(("rustgym", name)) => &name
                    .replacen("ALE-", "ALE/", 1)
                    .replacen("rapier-", "rapier/", 1),
                _ => id,
            };
            if let Err(error) = gym::registry::find(id) {
                panic!("{page}: {error}");
            }
            seen += 1;
        }
    }
    assert!(seen > 200, "{seen} ids");
}

#[test]
fn the_readme_names_every_environment() {
    let readme = read("README.md");
    let names = gym::registry::self_contained();
    let names = names.iter().map(gym::Registration::id);
    // ids that are named by their prefix
    let prefixes = [
        "MiniGrid-",
        "BabyAI-",
        "dm_control/",
        "PointMaze_",
        "AntMaze_",
        "AdroitHand",
    ];
    let (many, names): (Vec<_>, Vec<_>) =
        names.partition(|id| prefixes.iter().any(|prefix| id.starts_with(prefix)));
    for prefix in prefixes {
        let count = many.iter().filter(|id| id.starts_with(prefix)).count();
        let named = format!("the {count} ids `{prefix}*`");
        assert!(readme.contains(&named), "README.md lacks {named}");
    }
    // the second engine's ids have the names of the first engine's
    for id in names.into_iter().filter(|id| !id.starts_with("rapier/")) {
        let name = id.rsplit_once("-v").map_or(id, |(name, _)| name);
        assert!(readme.contains(&format!("`{name}")), "README.md lacks {id}");
    }
    let games = gym::atari::games::GAMES.len();
    assert!(
        readme.contains(&format!("{games} games")),
        "README.md: there are {games} games"
    );
}

#[test]
fn features_are_named() {
    let manifest = read("crates/gym/Cargo.toml");
    let (_, features) = manifest.split_once("[features]").expect("features");
    let (features, _) = features.split_once("\n[").expect("the next table");
    let lines: Vec<(&str, &str)> = features
        .lines()
        .filter_map(|line| line.split_once(" = ["))
        .collect();
    let list_of = |name: &str| {
        let line = lines.iter().find(|(feature, _)| *feature == name);
        let (_, list) = line.expect("a list");
        words(list, |c| c.is_ascii_alphanumeric() || c == '-')
    };
    let all: Vec<_> = lines.iter().map(|(feature, _)| *feature).collect();
    let default: Vec<_> = list_of("default").chain(list_of("families")).collect();
    assert!(all.len() > default.len() && default.len() > 10, "{all:?}");
    for (page, features) in [("README.md", &all), ("docs/first-steps.md", &default)] {
        let text = read(page);
        for feature in features.iter().filter(|feature| **feature != "default") {
            assert!(
                text.contains(&format!("`{feature}`")),
                "{page} lacks the feature {feature}"
            );
        }
    }
}

#[test]
fn columns_have_the_fields_that_the_book_names() {
    let source = read("crates/gym-core/src/vector/columns.rs");
    let mut seen = 0;
    for (page, text) in documents() {
        for code in text
            .split('`')
            .filter_map(|code| code.strip_prefix("columns."))
        {
            let name = words(code, |c| c.is_ascii_alphanumeric() || c == '_')
                .next()
                .unwrap_or_default();
            let is_there = ["pub ", "pub fn "].iter().any(|start| {
                source.contains(&format!("{start}{name}:"))
                    || source.contains(&format!("{start}{name}("))
            });
            assert!(is_there, "{page}: `Columns` has no `{name}`");
            seen += 1;
        }
    }
    assert!(seen > 2, "{seen} fields");
}

/// The README's two ratios are the smallest and the largest in the tables.
#[test]
fn the_readme_tells_the_measured_speed() {
    let tables = read("docs/benchmarks.md") + &read("docs/atari.md");
    let ratios = tables
        .split('(')
        .skip(1)
        .filter_map(|rest| rest.split_once("x)")?.0.parse::<f64>().ok());
    let (mut least, mut most) = (f64::INFINITY, 0.0f64);
    for ratio in ratios {
        (least, most) = (least.min(ratio), most.max(ratio));
    }
    let readme = read("README.md");
    let told: Vec<f64> = readme
        .split(" times (")
        .filter_map(|text| {
            text.split_whitespace()
                .next_back()?
                .replace(',', "")
                .parse()
                .ok()
        })
        .collect();
    assert_eq!(
        told[..2],
        [least, (most / 100.0).floor() * 100.0],
        "from {least} to {most} times"
    );
}

/// The paths that the book names: the compiler checks that they exist.
mod imports {
    #![expect(unused_imports, reason = "the paths only have to exist")]
    use gym::Reset as _;
    use gym::VectorWrapper as _;
    use gym::Wrapper as _;
    use gym::builder as _;
    use gym::canvas::Canvas as _;
    use gym::conform::check as _;
    use gym::make as _;
    use gym::make_vec as _;
    use gym::policy::reflex as _;
    use gym::register as _;
    use gym::registry::pretty as _;
    use gym::render as _;
    use gym::render::RecordVectorVideo as _;
    use gym::sim::engine as _;
    use gym::vector::native as _;
    use gym::wrappers::map as _;
    use gym::wrappers::observing as _;
}

#[test]
fn paths_in_the_book_exist() {
    let imports = include_str!("book.rs");
    for (page, text) in documents() {
        for code in text.split('`').filter(|code| code.starts_with("gym::")) {
            let path = words(code, |c| {
                c.is_ascii_alphanumeric() || matches!(c, '_' | ':')
            })
            .next();
            let path = path.unwrap_or_default().trim_end_matches(':');
            // drop a method after its type
            let mut is_method = false;
            let parts = path.split("::").take_while(|part| {
                !std::mem::replace(&mut is_method, part.starts_with(char::is_uppercase))
            });
            let path = parts.collect::<Vec<_>>().join("::");
            // the environments' pages name their own modules, which come from the registrations
            let import = format!("    use {path} as _;\n");
            let is_listed = imports.contains(&import) || page.contains("environments");
            assert!(
                is_listed || path == "gym",
                "{page}: add `{path}` to the paths of this test"
            );
        }
    }
}
