//! The text of a model and those that it includes.

use std::cell::Cell;
use std::collections::BTreeMap;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::rc::Rc;

use gym_numerics::file;
use roxmltree::{Document, Node, ParsingOptions};

use super::tidy::tidy;
use super::xml::{Lines, MAX_VISITS, Place};
use crate::{Error, Result};

/// The largest size in bytes of a file, and of all files of a model together.
const MAX_LEN: usize = 8 << 20;
/// The largest size in bytes of all files of a model that are no texts, each as often as it is named.
pub(crate) const MAX_ASSETS: u64 = 256 << 20;
/// The largest number of nodes (elements, texts and comments).
const MAX_NODES: u32 = 200_000;
/// The largest number of attributes of an element, and of namespaces: the parser compares each with
/// all others.
const MAX_ATTRIBUTES: usize = 1000;
const MAX_NAMESPACES: usize = 10;
/// The largest number of files of a model.
const MAX_FILES: usize = 100;
/// Why a model in a text names no files.
const NO_FOLDER: &str = "a text has no folder: read the model from its file, with from_path";

/// The texts of a model and its included files, before they are parsed.
#[derive(Debug, Default)]
pub(crate) struct Texts {
    /// The name of each file, for errors (empty for the model itself), and its text.
    texts: Vec<(Rc<str>, String)>,
    /// The text that each element `include` names, by the number of its own text and its position
    /// there.
    included: BTreeMap<(usize, usize), usize>,
    /// The folder of the model; none if it is a text.
    folder: Option<PathBuf>,
}

impl Texts {
    /// The text of a model without files: an `include` is an error.
    pub(crate) fn of(text: &str) -> Result<Self> {
        Self::load(text, None)
    }

    /// A file and all that it includes.
    pub(crate) fn of_file(path: &Path) -> Result<Self> {
        Self::load(&read(path)?, Some(path))
    }

    /// Reads the included files, each once: files that include each other are an error.
    fn load(text: &str, path: Option<&Path>) -> Result<Self> {
        let folder_of = |path: &Path| path.parent().unwrap_or(Path::new("")).to_owned();
        let mut all = Self {
            texts: vec![(Rc::default(), tidy(text).into_owned())],
            folder: path.map(folder_of),
            ..Self::default()
        };
        let mut paths: Vec<PathBuf> = path.map(Path::to_owned).into_iter().collect();
        let mut next = 0;
        while next < all.texts.len() {
            for (position, file, place) in all.includes(next)? {
                let Some(folder) = &all.folder else {
                    return Err(place.attribute("file", NO_FOLDER));
                };
                let own = folder_of(&paths[next]);
                let candidates = [folder.join(&file), own.join(&file)];
                let Some(path) = candidates.iter().find(|path| path.is_file()) else {
                    let [first, _] = candidates.map(|path| path.display().to_string());
                    return Err(place.attribute("file", format!("there is no file {first}")));
                };
                let same = |other: &PathBuf| match (other.canonicalize(), path.canonicalize()) {
                    (Ok(other), Ok(path)) => other == path,
                    _ => other == path,
                };
                if paths.iter().any(same) {
                    let reason = format!("{} is included already", path.display());
                    return Err(place.attribute("file", reason));
                }
                let text = tidy(&read(path)?).into_owned();
                let length: usize = all.texts.iter().map(|(_, text)| text.len()).sum();
                if paths.len() == MAX_FILES || length + text.len() > MAX_LEN {
                    let reason =
                        format!("more than {MAX_FILES} files or {MAX_LEN} bytes are not supported");
                    return Err(place.attribute("file", reason));
                }
                paths.push(path.clone());
                all.included.insert((next, position), all.texts.len());
                all.texts.push((path.display().to_string().into(), text));
            }
            next += 1;
        }
        Ok(all)
    }

    /// The position, the file name and the place of each `include` of a text.
    fn includes(&self, number: usize) -> Result<Vec<(usize, String, Place)>> {
        let (name, text) = &self.texts[number];
        if !text.contains("<include") {
            return Ok(Vec::new());
        }
        let (document, lines) = (parse(name, text)?, Lines::of(text));
        let elements = document.descendants();
        let includes = elements.filter(|node| node.is_element() && node.has_tag_name("include"));
        includes
            .map(|node| {
                let place = Place::new(name.clone(), lines.at(node.range().start), "include");
                if node.children().any(|child| child.is_element()) {
                    return Err(place.error("it has no elements within"));
                }
                if let Some(other) = node.attributes().find(|a| a.name() != "file") {
                    return Err(place.attribute(other.name(), "not supported: only file is"));
                }
                let file = node
                    .attribute("file")
                    .ok_or_else(|| place.attribute("file", "missing: it must be given"))?;
                Ok((node.range().start, file.to_owned(), place))
            })
            .collect()
    }

    /// The texts as elements.
    pub(crate) fn parse(&self) -> Result<Files<'_>> {
        let mut files = Files {
            files: Vec::new(),
            included: &self.included,
            folder: self.folder.as_deref(),
            visits: Cell::new(0),
        };
        for (name, text) in &self.texts {
            let (document, lines) = (parse(name, text)?, Lines::of(text));
            files.files.push((name, document, lines));
        }
        Ok(files)
    }
}

fn read(path: &Path) -> Result<String> {
    file::read_text(path, MAX_LEN).map_err(|error| Error::File {
        path: path.display().to_string(),
        reason: error.to_string(),
    })
}

/// The bytes of a regular file. `left`, how many more may be read, becomes smaller.
pub(crate) fn bytes(path: &Path, left: &mut u64) -> Result<Vec<u8>, String> {
    let most = usize::try_from(*left).unwrap_or(usize::MAX);
    let bytes = file::read(path, most).map_err(|error| match error.kind() {
        ErrorKind::FileTooLarge => format!(
            "the files of all assets together have more than {MAX_ASSETS} bytes: simplify them"
        ),
        _ => error.to_string(),
    })?;
    *left -= bytes.len() as u64;
    Ok(bytes)
}

/// The elements of a text.
fn parse<'input>(name: &str, text: &'input str) -> Result<Document<'input>> {
    let not_xml = |line: u32, reason: String| Place::new(name, line, "mujoco").error(reason);
    if text.len() > MAX_LEN {
        let reason = format!("the text is too long: the limit is {MAX_LEN} bytes");
        return Err(not_xml(1, reason));
    }
    check_tags(text).map_err(|(line, reason)| not_xml(line, reason))?;
    let options = ParsingOptions {
        allow_dtd: false,
        nodes_limit: MAX_NODES,
        ..ParsingOptions::default()
    };
    Document::parse_with_options(text, options)
        .map_err(|error| not_xml(error.pos().row, format!("the text is not XML: {error}")))
}

/// Refuses texts that the parser would take long to read; the error names the line.
fn check_tags(text: &str) -> std::result::Result<(), (u32, String)> {
    let mut rest = text;
    let mut namespaces = 0;
    while let Some(start) = rest.find('<') {
        rest = &rest[start + 1..];
        if let Some(comment) = rest.strip_prefix("!--") {
            rest = comment.find("-->").map_or("", |end| &comment[end..]);
            continue;
        }
        let tag = &rest[..rest.find('<').unwrap_or(rest.len())];
        namespaces += tag.matches("xmlns").count();
        let reason = if tag.matches('=').count() > MAX_ATTRIBUTES {
            format!("an element has more than {MAX_ATTRIBUTES} attributes")
        } else if namespaces > MAX_NAMESPACES {
            format!("the text has more than {MAX_NAMESPACES} namespaces")
        } else {
            continue;
        };
        let before = &text[..text.len() - rest.len()];
        return Err((before.matches('\n').count() as u32 + 1, reason));
    }
    Ok(())
}

/// Parsed texts.
pub(crate) struct Files<'input> {
    files: Vec<(&'input Rc<str>, Document<'input>, Lines)>,
    included: &'input BTreeMap<(usize, usize), usize>,
    folder: Option<&'input Path>,
    /// The number of visits of nodes.
    visits: Cell<usize>,
}

impl<'input> Files<'input> {
    /// The outermost element of a file.
    pub(crate) fn root(&self, file: usize) -> Node<'_, 'input> {
        self.files[file].1.root_element()
    }

    /// The name of a file; empty for the model itself.
    pub(crate) fn name(&self, file: usize) -> &Rc<str> {
        self.files[file].0
    }

    /// Counts the visit of a node; returns whether there may be as many.
    pub(crate) fn visit(&self) -> bool {
        self.visits.set(self.visits.get() + 1);
        self.visits.get() <= MAX_VISITS
    }

    /// The path of a file that is no text: in `folder` beside the model, or else beside a text.
    pub(crate) fn find(&self, text: usize, folder: &str, file: &str) -> Result<PathBuf, String> {
        let beside = self.folder.ok_or_else(|| NO_FOLDER.to_owned())?;
        let own = match Path::new(&**self.name(text)).parent() {
            Some(own) if text > 0 => own,
            _ => beside,
        };
        let candidates = [beside.join(folder).join(file), own.join(file)];
        let exists = candidates.iter().find(|path| path.exists());
        exists
            .cloned()
            .ok_or_else(|| format!("there is no file {}", candidates[0].display()))
    }

    /// The line of a position in a file.
    pub(crate) fn line(&self, file: usize, position: usize) -> u32 {
        self.files[file].2.at(position)
    }

    /// The file that an element of a file includes.
    pub(crate) fn included(&self, file: usize, node: Node<'_, '_>) -> Option<usize> {
        let number = self.included.get(&(file, node.range().start));
        number.copied().filter(|_| node.has_tag_name("include"))
    }
}
