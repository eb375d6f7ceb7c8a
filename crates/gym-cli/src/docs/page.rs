//! The pages about the environments, generated from registrations and from the documentation of the
//! modules.

use std::path::{Path, PathBuf};

use gym::registry::Family;
use gym::render::RenderMode;
use gym::{Env, Error, Registration, Result, registry};
use serde_json::Value as Json;

use super::returns::{EPISODES, Measured, Returns, Summary};
use super::{Book, Document, numbers};
use crate::workspace::{self, Workspace};

/// What stands for the description of a good policy where there is none.
const NO_POLICY: &str = " No good policy is kept for it: [Training](../training.md) makes one. Pictures show random actions.";

/// A page: the environments that one module registers.
pub(super) struct Page {
    /// The name of the file, without its extension.
    pub(super) name: String,
    registrations: Vec<Registration>,
    docs: Docs,
}

/// The pages of a family.
pub(super) struct Section {
    family: Family,
    /// The environments that have no page, because they have an external requirement.
    needy: Vec<Registration>,
    pub(super) pages: Vec<Page>,
}

/// Returns the families of a workspace with their pages, in the order of the registry.
///
/// # Errors
/// If the documentation of a module lacks a part of its page.
pub(super) fn all(workspace: &Workspace) -> Result<Vec<Section>> {
    let own = workspace.own()?;
    workspace::tell_needy(&own);
    let sections = registry::by_family(own).into_iter();
    let sections = sections.map(|(family, registrations)| {
        let (needy, others): (Vec<_>, Vec<_>) = registrations
            .into_iter()
            .partition(|registration| registration.needs.is_some());
        let pages = registry::by_page(others).into_iter();
        let pages = pages.map(|registrations| Page::read(registrations, workspace.folder()));
        Ok(Section {
            family,
            needy,
            pages: pages.collect::<Result<_>>()?,
        })
    });
    let mut sections = sections.collect::<Result<Vec<_>>>()?;
    // if two modules have the same name, the page whose ids have a namespace gets the namespace as
    // a prefix
    let pages = || sections.iter().flat_map(|section| &section.pages);
    let names: Vec<String> = pages().map(|page| page.name.clone()).collect();
    for page in sections.iter_mut().flat_map(|section| &mut section.pages) {
        let twice = names.iter().filter(|name| **name == page.name).count() > 1;
        if let Some((namespace, _)) = page.registrations[0].id().split_once('/').filter(|_| twice) {
            page.name = format!("{}-{}", namespace.replace('_', "-"), page.name);
        }
    }
    Ok(sections)
}

/// Returns the texts of the pages, the page that lists the pages and, for a book, its table of
/// contents.
pub(super) fn documents(
    sections: &[Section],
    returns: &Returns,
    folder: &Path,
    book: Option<&Book>,
) -> Result<Vec<Document>> {
    let mut list = LIST_HEAD.to_owned();
    list.extend(sections.iter().map(Section::list));
    list += book.map_or("", |book| book.below_list);
    let environments = PathBuf::from("docs/environments");
    let mut documents = vec![(environments.join("README.md"), list.into_bytes())];
    if let Some(book) = book {
        let contents: String = sections.iter().map(Section::contents).collect();
        documents.push((book.contents)(folder, contents.trim_end())?);
    }
    for page in sections.iter().flat_map(|section| &section.pages) {
        documents.push((
            environments.join(format!("{}.md", page.name)),
            page.text(returns, book)?.into_bytes(),
        ));
    }
    Ok(documents)
}

const LIST_HEAD: &str = "<!-- Written by `cargo xtask docs`. -->

# Environments

Each page has the spaces, rewards, starts and ends of an environment, its arguments, and the returns of a random and a good policy.
";

impl Section {
    /// Returns the family's part of the list of pages.
    fn list(&self) -> String {
        let Self {
            family: Family { name, page, .. },
            needy,
            pages,
        } = self;
        let heading = match page {
            Some(page) => format!("[{name}](../{page})"),
            None => (*name).to_owned(),
        };
        let mut text = format!("\n## {heading}\n\n");
        if let Some(need) = needy.first().and_then(|first| first.needs) {
            let ids = match &needy[..] {
                [one] => format!("`{}` needs", one.id()),
                all => format!("{} ids, which need", all.len()),
            };
            text += &format!("{ids} {}.\n", need.what);
        }
        if !needy.is_empty() && !pages.is_empty() {
            text += "\n";
        }
        if !pages.is_empty() {
            text += "| | environment | ids |\n|---|---|---|\n";
            text.extend(pages.iter().map(Page::row));
        }
        text
    }

    /// Returns the family's part of the book's table of contents.
    fn contents(&self) -> String {
        let page = self.family.page.unwrap_or_default();
        let mut text = format!("- [{}]({page})\n", self.family.name);
        for Page { name, docs, .. } in &self.pages {
            text += &format!("  - [{}](environments/{name}.md)\n", docs.title);
        }
        text
    }
}

/// The documentation of an environment's module, in its parts.
struct Docs {
    title: String,
    /// The task, in a sentence.
    summary: String,
    /// The lines of the table.
    table: Vec<String>,
    versions: Option<String>,
    differences: Option<String>,
    rest: Vec<String>,
}

impl Docs {
    /// Reads the documentation at the start of a source file.
    fn parse(source: &str, file: &str, has_actions: bool) -> Result<Self> {
        let missing =
            |what: &str| Error::custom(format!("{file}: its module docs (`//!`) lack {what}"));
        let lines = source.lines().map_while(|line| line.strip_prefix("//!"));
        let lines: Vec<_> = lines
            .map(|line| line.strip_prefix(' ').unwrap_or(line))
            .collect();
        let mut text =
            without_item_links(&lines.join("\n")).replace("`Config`", "[`Config`](#arguments)");
        if has_actions {
            text = text.replace("`Action`", "[`Action`](#actions)");
        }
        let mut paragraphs = text.split("\n\n").map(str::trim);
        let title = paragraphs.next().and_then(|title| title.split_once(": "));
        let (title, summary) =
            title.ok_or_else(|| missing("a title, as in `Name: what to do.`"))?;
        let mut docs = Self {
            title: title.to_owned(),
            summary: capitalised(&summary.replace('\n', " ")),
            table: Vec::new(),
            versions: None,
            differences: None,
            rest: Vec::new(),
        };
        for paragraph in paragraphs {
            if paragraph.starts_with("| |") {
                docs.table = paragraph.lines().skip(2).map(str::to_owned).collect();
            } else if let Some(versions) = paragraph.strip_prefix("Versions: ") {
                docs.versions = Some(versions.to_owned());
            } else if let Some((_, differences)) = paragraph
                .strip_prefix("Differences from ")
                .and_then(|rest| rest.split_once(": "))
            {
                docs.differences = Some(capitalised(differences));
            } else {
                docs.rest.push(paragraph.to_owned());
            }
        }
        for row in ["observation", "action", "reward", "start", "end", "limit"] {
            if !docs
                .table
                .iter()
                .any(|line| line.starts_with(&format!("| {row} |")))
            {
                return Err(missing(&format!("the row `{row}` of the table")));
            }
        }
        Ok(docs)
    }
}

/// Replaces rustdoc's links to items by code without brackets.
fn without_item_links(text: &str) -> String {
    let mut parts = text.split("](crate::");
    let mut plain = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let (_, rest) = part.split_once(')').unwrap_or(("", part));
        plain += "]";
        plain += rest;
    }
    // (joins adjacent code: [`f`]`(x)` becomes `f(x)`)
    plain
        .replace("`]`", "")
        .replace("[`", "`")
        .replace("`]", "`")
        .replace("`Config::", "`")
}

fn capitalised(text: &str) -> String {
    let mut letters = text.chars();
    letters
        .next()
        .map(|first| first.to_uppercase().to_string() + letters.as_str())
        .unwrap_or_default()
}

impl Page {
    fn read(registrations: Vec<Registration>, folder: &Path) -> Result<Self> {
        let source = registrations[0].source;
        let module = source.module.rsplit("::").next().unwrap_or_default();
        let actions = registrations
            .iter()
            .any(|entry| !entry.page.actions.is_empty());
        let path = folder.join(source.file);
        let text =
            gym::file::read_text(&path, usize::MAX).map_err(|error| Error::io(&path, error))?;
        Ok(Self {
            name: module.replace('_', "-"),
            docs: Docs::parse(&text, source.file, actions)?,
            registrations,
        })
    }

    /// Returns the registration whose GIF and arguments the page shows.
    pub(super) fn shown(&self) -> &Registration {
        self.registrations
            .iter()
            .find(|entry| entry.page.clip.is_some())
            .unwrap_or(&self.registrations[0])
    }

    /// Returns the line that shows the GIF, if there is one.
    fn image(&self, text: &str) -> String {
        let image = self
            .shown()
            .page
            .clip
            .as_ref()
            .map(|_| format!("![{text}](images/{}.gif)", self.name));
        image.unwrap_or_default()
    }

    /// Returns the row of this page in the list of pages.
    fn row(&self) -> String {
        let ids: Vec<_> = self
            .registrations
            .iter()
            .map(|entry| format!("`{}`", entry.id()))
            .collect();
        let (name, Docs { title, summary, .. }) = (&self.name, &self.docs);
        let image = self.image(title);
        let image = if image.is_empty() {
            image
        } else {
            format!("[{image}]({name}.md)")
        };
        format!(
            "| {image} | [{title}]({name}.md): {summary} | {} |\n",
            ids.join(", ")
        )
    }

    fn text(&self, returns: &Returns, book: Option<&Book>) -> Result<String> {
        let Self {
            registrations,
            docs,
            ..
        } = self;
        let Docs { title, summary, .. } = docs;
        let mut text = format!(
            "<!-- Written by `cargo xtask docs` from {} and the registry: change those. -->\n\n# {title}\n\n{summary}\n",
            self.shown().source.file
        );
        let image = self.image(&format!("An episode of {title}"));
        if !image.is_empty() {
            text += &format!("\n{image}\n");
        }
        text += &format!("\n| | |\n|---|---|\n{}\n", docs.table.join("\n"));
        let mut section =
            |title: &str, body: &str| text += &format!("\n## {title}\n\n{}\n", body.trim_end());
        let numbers = numbers::tables(self.shown(), registrations)?;
        if !numbers.is_empty() {
            section("Numbers", &numbers);
        }
        if let Some(entry) = registrations
            .iter()
            .find(|entry| !entry.page.actions.is_empty())
        {
            section("Actions", &actions(entry.page.actions));
        }
        section("Ids", &ids(registrations)?);
        section("Spaces", &spaces(registrations)?);
        section("Arguments", &arguments(self.shown(), registrations)?);
        section("Rendering", &rendering(registrations)?);
        if let Some(versions) = &docs.versions {
            section("Versions", versions);
        }
        let no_difference = book.map(|book| book.no_difference);
        if let Some(differences) = docs.differences.as_deref().or(no_difference) {
            section("Differences", differences);
        }
        if registrations
            .iter()
            .any(|entry| returns.contains_key(entry.id()))
        {
            section("Returns", &self.returns(returns));
        }
        if !docs.rest.is_empty() {
            section("Notes", &docs.rest.join("\n\n"));
        }
        Ok(text)
    }

    fn returns(&self, returns: &Returns) -> String {
        let shown = self.shown();
        let good = match shown.page.policy {
            Some(policy) => format!(
                " The good policy {}. To play it: `cargo xtask run {} --policy good`.",
                policy.description,
                shown.id()
            ),
            None => NO_POLICY.to_owned(),
        };
        format!(
            "Mean and standard deviation of the return, and mean number of steps, over {EPISODES} episodes \
             (seeds 0 to {}).{good}\n\n{}",
            EPISODES - 1,
            table_of_returns(&self.registrations, returns)
        )
    }
}

/// Returns the table of arguments with the default values of `shown`. `registrations` are all
/// registrations of the page.
fn arguments(shown: &Registration, registrations: &[Registration]) -> Result<String> {
    let table = shown.arguments()?;
    if table.is_empty() {
        return Ok("None.".into());
    }
    let tables = registrations.iter().map(Registration::arguments);
    let tables = tables.collect::<Result<Vec<_>>>()?;
    let is_everywhere = |name: &str| {
        let mut tables = tables.iter();
        tables.all(|table| table.iter().any(|argument| argument.name == name))
    };
    let mut text = String::from("| argument | type | default | meaning |\n|---|---|---|---|\n");
    for argument in &table {
        let unit = if argument.unit.is_empty() {
            String::new()
        } else {
            format!(" {}", argument.unit)
        };
        let versions = match argument.versions {
            "" => String::new(),
            _ if is_everywhere(argument.name) => String::new(),
            versions => format!(" (versions `{versions}`)"),
        };
        let meaning = without_item_links(&argument.meaning);
        let (name, kind, default) = (argument.name, &argument.kind, &argument.default);
        text += &format!(
            "| `{name}` | {kind} | `{default}`{unit} | {}{versions} |\n",
            meaning.replace('|', "\\|")
        );
    }
    // the first argument of type bool (inverted) or number
    let example = table.iter().find_map(|argument| match &argument.default {
        Json::Bool(value) => Some((argument.name, Json::Bool(!value))),
        Json::Number(_) => Some((argument.name, argument.default.clone())),
        _ => None,
    });
    if let Some((name, value)) = example {
        let (id, module) = (shown.id(), shown.source.module.replacen("gym_", "gym::", 1));
        text += &format!(
            "\nSet one by name, as in `gym::builder(\"{id}\").arg(\"{name}\", {value}).build()?`, or as a field of \
             `{module}::Config`."
        );
        gym::builder(id).arg(name, value).build()?;
    }
    Ok(text)
}

fn ids(registrations: &[Registration]) -> Result<String> {
    let mut text = "| id | arguments it sets | step limit | solved at a mean return of |\n\
                    |---|---|---|---|\n"
        .to_owned();
    for entry in registrations {
        let spec = entry.spec()?;
        let kwargs: Vec<_> = spec
            .kwargs
            .iter()
            .map(|(name, value)| format!("`{name}`: `{value}`"))
            .collect();
        let kwargs = if kwargs.is_empty() {
            "none".into()
        } else {
            kwargs.join(", ")
        };
        let limit = spec
            .max_episode_steps
            .map_or("none".into(), |limit| limit.to_string());
        let threshold = spec
            .reward_threshold
            .map_or("not defined".into(), |threshold| threshold.to_string());
        text += &format!("| `{}` | {kwargs} | {limit} | {threshold} |\n", spec.id);
    }
    Ok(text)
}

/// Returns the list of spaces, each with the ids that have this space.
fn spaces(registrations: &[Registration]) -> Result<String> {
    let mut rows: Vec<(String, Vec<String>)> = Vec::new();
    for entry in registrations {
        let env = entry.spec()?.make()?;
        for (kind, space) in [
            ("action", env.action_space()),
            ("observation", env.observation_space()),
        ] {
            // numpy breaks long arrays into lines
            let space = space
                .to_string()
                .split_whitespace()
                .collect::<Vec<_>>()
                .join(" ");
            let row = format!("{kind} | `{space}`");
            match rows.iter_mut().find(|(other, _)| *other == row) {
                Some((_, ids)) => ids.push(format!("`{}`", entry.id())),
                None => rows.push((row, vec![format!("`{}`", entry.id())])),
            }
        }
    }
    rows.sort();
    let rows: String = rows
        .iter()
        .map(|(row, ids)| {
            let ids = if ids.len() == registrations.len() {
                "all".into()
            } else {
                ids.join(", ")
            };
            format!("| {row} | {ids} |\n")
        })
        .collect();
    Ok(format!("| | space | ids |\n|---|---|---|\n{rows}"))
}

fn actions(variants: &[(&str, &str)]) -> String {
    let row = |(number, (name, docs)): (usize, &(&str, &str))| {
        let words: Vec<_> = docs.split_whitespace().collect();
        format!("| {number} | `{name}` | {} |\n", words.join(" "))
    };
    let rows: String = variants.iter().enumerate().map(row).collect();
    format!("| number | name | meaning |\n|---|---|---|\n{rows}")
}

fn rendering(registrations: &[Registration]) -> Result<String> {
    let Some(entry) = registrations.first() else {
        return Ok(String::new());
    };
    let metadata = entry.spec()?.make()?.metadata();
    let can = |mode: &&RenderMode| metadata.render_modes.contains(&mode.single());
    let modes: Vec<_> = RenderMode::ALL
        .iter()
        .filter(can)
        .map(|mode| format!("`{mode}`"))
        .collect();
    let (width, height) = metadata.render_size;
    let fps = metadata.render_fps;
    Ok(format!(
        "Modes {}; {width}x{height} pixels, {fps} frames per second.",
        modes.join(", ")
    ))
}

fn table_of_returns(registrations: &[Registration], returns: &Returns) -> String {
    let cells = |summary: &Summary| {
        let Summary {
            mean,
            deviation,
            mean_length,
        } = summary;
        format!("{mean:.2} \u{b1} {deviation:.2} | {mean_length:.1}")
    };
    let mut text =
        "| id | random policy | steps | good policy | steps |\n|---|---|---|---|---|\n".to_owned();
    for entry in registrations {
        let id = entry.id();
        let Some(Measured { random, good }) = returns.get(id) else {
            text += &format!("| `{id}` | not measured | - | - | - |\n");
            continue;
        };
        let good = good.as_ref().map_or("- | -".into(), cells);
        text += &format!("| `{id}` | {} | {good} |\n", cells(random));
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn module_docs_are_taken_apart() {
        let rows = ["observation", "action", "reward", "start", "end", "limit"]
            .map(|row| format!("//! | {row} | x |\n"));
        let source = format!(
            "//! Lake: cross\n//! it.\n//!\n//! | | |\n//! |---|---|\n{}//!\n//! Versions: 1, with [`Config`] and [`f`]`(x)`.\n//!\n\
             //! Differences from Pond: the [`Action`](crate::Action) is new.\n\n\
             use x; //! no more",
            rows.concat()
        );
        let docs = Docs::parse(&source, "lake.rs", false).unwrap();
        assert_eq!(
            (&*docs.title, &*docs.summary, docs.table.len()),
            ("Lake", "Cross it.", 6)
        );
        assert_eq!(
            docs.versions.as_deref(),
            Some("1, with [`Config`](#arguments) and `f(x)`.")
        );
        assert_eq!(docs.differences.as_deref(), Some("The `Action` is new."));
        let error = Docs::parse(&source.replace("| end |", "| ends |"), "lake.rs", false)
            .err()
            .unwrap();
        assert!(
            error.to_string().contains("lake.rs") && error.to_string().contains("`end`"),
            "{error}"
        );
    }
}
