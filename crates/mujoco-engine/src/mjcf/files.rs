//! The text of a model and those that it includes.

use std::cell::Cell;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::rc::Rc;

use roxmltree::{Document, Node, ParsingOptions};

use super::store::Store;
use super::tidy::tidy;
use super::xml::{Lines, MAX_VISITS, Place};
use crate::{Error, Result};

/// The largest size in bytes of a file, and of all files of a model together.
pub(crate) const MAX_LEN: usize = 8 << 20;
/// The largest number of nodes (elements, texts and comments).
const MAX_NODES: u32 = 200_000;
/// The largest number of attributes of an element, and of namespaces: the parser compares each with
/// all others.
const MAX_ATTRIBUTES: usize = 1000;
const MAX_NAMESPACES: usize = 10;
/// The largest number of files of a model, each as often as it is named, and the largest number of
/// models within each other.
const MAX_FILES: usize = 100;
const MAX_MODELS: usize = 10;
/// Why a model in a text names no files.
const NO_FOLDER: &str = "a text has no folder: read the model from its file, with from_path";

/// A text of a model.
#[derive(Debug)]
struct Text {
    /// The name of the file, for errors; empty for the model itself.
    name: Rc<str>,
    text: String,
    /// The path; none if the model is a text.
    path: Option<PathBuf>,
    /// The number of the model among those of all texts.
    model: usize,
}

impl Text {
    /// Whether it is that of the file.
    fn is(&self, path: &Path, store: Store<'_>) -> bool {
        let own = self.path.as_deref();
        own.is_some_and(|own| store.same(own, path))
    }
}

/// A model whose texts are read: the first, or one that another attaches.
#[derive(Debug)]
struct Root {
    /// The folder of the model; none if it is a text.
    folder: Option<PathBuf>,
    /// The number of the model that names it; its own for the first.
    parent: usize,
}

/// The texts of a model, its included files, and the models that it attaches, before they are
/// parsed.
#[derive(Debug, Default)]
pub(crate) struct Texts<'a> {
    store: Store<'a>,
    texts: Vec<Text>,
    models: Vec<Root>,
    /// The text that each element `include` or `model` names, by the number of its own text and its
    /// position there.
    named: BTreeMap<(usize, usize), usize>,
}

impl<'a> Texts<'a> {
    /// The text of a model without files: an `include` is an error.
    pub(crate) fn of(text: &str) -> Result<Self> {
        Self::load(text, None, Store::Disk)
    }

    /// A file and all that it includes.
    pub(crate) fn of_file(path: &Path, store: Store<'a>) -> Result<Self> {
        Self::load(&read(path, store)?, Some(path), store)
    }

    /// Where the files are that they name.
    pub(crate) fn store(&self) -> Store<'a> {
        self.store
    }

    /// Reads the files that the texts name: included ones each once, so that files that include each
    /// other are an error, and models that are not within themselves.
    fn load(text: &str, path: Option<&Path>, store: Store<'a>) -> Result<Self> {
        let mut all = Self {
            store,
            texts: vec![Text {
                name: Rc::default(),
                text: tidy(text).into_owned(),
                path: path.map(Path::to_owned),
                model: 0,
            }],
            models: vec![Root {
                folder: path.map(folder_of),
                parent: 0,
            }],
            ..Self::default()
        };
        let mut next = 0;
        while next < all.texts.len() {
            for Named {
                position,
                file,
                model,
                place,
            } in all.files_of(next)?
            {
                let path = all
                    .path_of(next, &file)
                    .map_err(|e| place.attribute("file", e))?;
                let (owner, number) = (all.texts[next].model, all.texts.len());
                if model {
                    all.check_models(owner, &path)
                        .map_err(|reason| place.attribute("file", reason))?;
                    all.models.push(Root {
                        folder: Some(folder_of(&path)),
                        parent: owner,
                    });
                } else if all
                    .texts
                    .iter()
                    .any(|text| text.model == owner && text.is(&path, store))
                {
                    let reason = format!("{} is included already", path.display());
                    return Err(place.attribute("file", reason));
                }
                let text = tidy(&read(&path, store)?).into_owned();
                let length: usize = all.texts.iter().map(|text| text.text.len()).sum();
                if number == MAX_FILES || length + text.len() > MAX_LEN {
                    let reason =
                        format!("more than {MAX_FILES} files or {MAX_LEN} bytes are not supported");
                    return Err(place.attribute("file", reason));
                }
                all.named.insert((next, position), number);
                all.texts.push(Text {
                    name: path.display().to_string().into(),
                    text,
                    path: Some(path),
                    model: if model { all.models.len() - 1 } else { owner },
                });
            }
            next += 1;
        }
        Ok(all)
    }

    /// The path of a text that another names: beside its model, or else beside the other text.
    fn path_of(&self, text: usize, file: &str) -> Result<PathBuf, String> {
        let Text { path, model, .. } = &self.texts[text];
        let (Some(folder), Some(path)) = (&self.models[*model].folder, path) else {
            return Err(NO_FOLDER.to_owned());
        };
        let candidates = [folder.join(file), folder_of(path).join(file)];
        let found = candidates.iter().find(|path| self.store.has_file(path));
        found
            .cloned()
            .ok_or_else(|| format!("there is no file {}", candidates[0].display()))
    }

    /// Refuses a model within itself, and too many within each other.
    fn check_models(&self, mut around: usize, path: &Path) -> Result<(), String> {
        for _ in 0..MAX_MODELS {
            // the first text of a model is that of its own file
            let mut texts = self.texts.iter();
            let own = texts.find(|text| text.model == around);
            if own.is_some_and(|text| text.is(path, self.store)) {
                return Err(format!("{} would be a part of itself", path.display()));
            }
            let Root { parent, .. } = self.models[around];
            if parent == around {
                return Ok(());
            }
            around = parent;
        }
        Err(format!(
            "more than {MAX_MODELS} models within each other are not supported"
        ))
    }

    /// The elements of a text that name other texts.
    fn files_of(&self, number: usize) -> Result<Vec<Named>> {
        let Text { name, text, .. } = &self.texts[number];
        if !text.contains("<include") && !text.contains("<model") {
            return Ok(Vec::new());
        }
        let (document, lines) = (parse(name, text)?, Lines::of(text));
        let elements = document.descendants().filter(Node::is_element);
        let naming = elements.filter(|node| ["include", "model"].contains(&node.tag_name().name()));
        naming
            .map(|node| {
                let model = node.has_tag_name("model");
                let place = Place::new(
                    name.clone(),
                    lines.at(node.range().start),
                    node.tag_name().name(),
                );
                if node.children().any(|child| child.is_element()) {
                    return Err(place.error("it has no elements within"));
                }
                let known = if model {
                    &["file", "name"][..]
                } else {
                    &["file"]
                };
                if let Some(other) = node.attributes().find(|a| !known.contains(&a.name())) {
                    let reason = format!("not supported: only {} is", known.join(" and "));
                    return Err(place.attribute(other.name(), reason));
                }
                let file = node
                    .attribute("file")
                    .ok_or_else(|| place.attribute("file", "missing: it must be given"))?;
                Ok(Named {
                    position: node.range().start,
                    file: file.to_owned(),
                    model,
                    place,
                })
            })
            .collect()
    }

    /// The texts as elements.
    pub(crate) fn parse(&self) -> Result<Files<'_>> {
        let mut files = Files {
            files: Vec::new(),
            texts: self,
            visits: Cell::new(0),
        };
        for Text { name, text, .. } in &self.texts {
            let (document, lines) = (parse(name, text)?, Lines::of(text));
            files.files.push((name, document, lines));
        }
        Ok(files)
    }
}

/// An element that names another text.
struct Named {
    position: usize,
    file: String,
    /// Whether the text is a model of its own, not a part of this one.
    model: bool,
    place: Place,
}

fn folder_of(path: &Path) -> PathBuf {
    path.parent().unwrap_or(Path::new("")).to_owned()
}

fn read(path: &Path, store: Store<'_>) -> Result<String> {
    store.read_text(path, MAX_LEN).map_err(|error| Error::File {
        path: path.display().to_string(),
        reason: error.to_string(),
    })
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
    texts: &'input Texts<'input>,
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
        let Text { path, model, .. } = &self.texts.texts[text];
        let (Some(beside), Some(path)) = (&self.texts.models[*model].folder, path) else {
            return Err(NO_FOLDER.to_owned());
        };
        let own = folder_of(path);
        let candidates = [beside.join(folder).join(file), own.join(file)];
        let exists = candidates.iter().find(|path| self.texts.store.exists(path));
        exists
            .cloned()
            .ok_or_else(|| format!("there is no file {}", candidates[0].display()))
    }

    /// The line of a position in a file.
    pub(crate) fn line(&self, file: usize, position: usize) -> u32 {
        self.files[file].2.at(position)
    }

    /// The file that an element `include` or `model` of a file names.
    pub(crate) fn named(&self, file: usize, node: Node<'_, '_>, kind: &str) -> Option<usize> {
        let number = self.texts.named.get(&(file, node.range().start));
        number.copied().filter(|_| node.has_tag_name(kind))
    }
}
