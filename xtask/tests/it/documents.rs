//! Checks that the commands and options in the documents exist.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;

use super::{prints, said};

/// Appends every page in a folder to `files`.
fn pages(folder: &Path, files: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            pages(&path, files);
        } else if path.extension().is_some_and(|extension| extension == "md") {
            files.push(path);
        }
    }
}

/// The help of each command.
#[derive(Default)]
struct Help(BTreeMap<String, String>);

impl Help {
    fn new() -> Self {
        let mut help = Self::default();
        let list = prints(&["help"]);
        let commands = list.lines().skip_while(|line| *line != "Commands:").skip(1);
        for line in commands.take_while(|line| !line.is_empty()) {
            let name = super::first_word(line).to_owned();
            let mut text = prints(&["help", &name]);
            if name == "atari" {
                text += &prints(&["help", "atari", "check"]);
            }
            help.0.insert(name, text);
        }
        let web = Command::new(env!("CARGO_BIN_EXE_xtask"))
            .args(["web", "--help"])
            .output()
            .unwrap();
        help.0.insert("web".into(), said(&web, &["web", "--help"]));
        help
    }

    /// Checks the text `line`, which follows `cargo xtask` in a document. Returns the fault as an
    /// error.
    fn check(&self, line: &str) -> Result<(), String> {
        let mut words = line
            .split_whitespace()
            .map(|word| word.trim_end_matches([',', '.', ';', ':', ')']));
        let name = words.next().unwrap_or_default();
        if ["COMMAND", "--help"].contains(&name) {
            return Ok(());
        }
        let text = self
            .0
            .get(name)
            .ok_or_else(|| format!("there is no command `{name}`"))?;
        for word in words.filter(|word| word.starts_with("--")) {
            let flag = word.split('=').next().unwrap_or(word);
            let has_it = text.split([' ', '\n', ',']).any(|other| other == flag);
            has_it
                .then_some(())
                .ok_or_else(|| format!("`{name}` has no option `{flag}`"))?;
        }
        Ok(())
    }
}

#[test]
fn commands_and_options_in_the_documents_exist() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let mut files: Vec<_> = ["README.md", "CONTRIBUTING.md", "ARCHITECTURE.md"]
        .map(|name| root.join(name))
        .into();
    pages(&root.join("docs"), &mut files);
    let (help, mut seen) = (Help::new(), 0);
    for file in files {
        let text = std::fs::read_to_string(&file).unwrap();
        for (number, line) in text.lines().enumerate() {
            for rest in line.split("cargo xtask ").skip(1) {
                let rest = rest
                    .split(['`', '#', '|', '&', '<'])
                    .next()
                    .unwrap_or_default()
                    .trim_end_matches("-->");
                seen += 1;
                if let Err(reason) = help.check(rest) {
                    let (file, number) = (file.display(), number + 1);
                    panic!("{file}:{number}: `cargo xtask {rest}`: {reason}");
                }
            }
        }
    }
    assert!(seen > 40, "{seen} commands");
    assert!(
        help.check("play ID --fast").is_err(),
        "an option that there is not"
    );
    assert!(help.check("dance").is_err());
}
