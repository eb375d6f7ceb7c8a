//! The pages about the environments, from the registry and the documentation of their modules.

use std::path::PathBuf;

use gym::registry::{self, EnvId};
use gym::render::RenderMode;
use gym::{Env, Error, Registration, Result};
use serde_json::Value as Json;

use super::Document;
use super::pages::{Clip, PAGES, Page};
use super::returns::{EPISODES, Measured, Returns, Summary};
use super::source::{self, Member};

/// Every page, and the one that lists them.
///
/// # Errors
/// If an environment has no page, or a source file lacks what its page is written from.
pub(super) fn all(returns: &Returns) -> Result<Vec<Document>> {
    let mut registrations = registry::self_contained();
    let mut documents = Vec::new();
    let mut list = LIST_HEAD.to_owned();
    for page in &PAGES {
        let (own, rest): (Vec<_>, Vec<_>) = registrations.into_iter().partition(|entry| page.holds(entry));
        registrations = rest;
        let source = super::read(page.source)?;
        let docs = Docs::parse(page, &source)?;
        list += &page.row(&own, &docs);
        let file = PathBuf::from("docs/environments").join(format!("{}.md", page.name));
        documents.push((file, page.text(&own, &docs, &source, returns)?.into_bytes()));
    }
    if let Some(entry) = registrations.first() {
        return Err(Error::custom(format!("{entry:?} has no page: add it to xtask/src/docs/page.rs")));
    }
    documents.push(("docs/environments/README.md".into(), (list + LIST_TAIL).into_bytes()));
    Ok(documents)
}

const LIST_HEAD: &str = "<!-- Written by `cargo xtask docs`. -->

# Environments

Each page says what the agent sees and does, what it is rewarded for, how an episode starts and ends, which arguments there
are, and what a random and a good policy return.

| | environment | ids |
|---|---|---|
";

const LIST_TAIL: &str = "
An id is `[namespace/]Name[-vVersion]`. Without a version, `make` takes the newest. An older version stays as it was, and
`make` points to the newer one through the `log` crate. Ids in the namespace `rapier/` are the same tasks on another physics
engine, [rapier2d](https://rapier.rs): alike, but not equal to Gymnasium's numbers.

What holds for all of them: NaN or infinite actions are an error; numbers beyond the bounds of a `Box` are not, and the
environment clips them where Gymnasium's does; options of `reset` that an environment does not know are ignored, as in
Gymnasium. The pictures of classic control and Box2D equal Gymnasium's byte for byte at its own size; those of toy text are our
own.

`cargo xtask list --long` prints ids, spaces, limits and thresholds; `cargo xtask play ID` lets you play.
";

const NO_DIFFERENCE: &str = "None that is known: the same seed gives the same episode, to the last bit, \
                             [on the platforms named here](../reproducibility.md).";

/// The documentation of an environment's module, in its parts.
struct Docs {
    /// What the task is, in a sentence.
    summary: String,
    /// The lines of the table.
    table: Vec<String>,
    /// A table of the numbers in an observation.
    observation: Option<String>,
    versions: Option<String>,
    differences: Option<String>,
    rest: Vec<String>,
}

impl Docs {
    fn parse(page: &Page, source: &str) -> Result<Self> {
        let missing = |what: &str| Error::custom(format!("{}: its module docs lack {what}", page.source));
        let text = source::module_docs(source);
        let mut text = source::without_item_links(&text).replace("`Config::", "`");
        text = text.replace("`Config`", "[`Config`](#arguments)");
        if page.actions.is_some() {
            text = text.replace("`Action`", "[`Action`](#actions)");
        }
        let mut paragraphs = text.split("\n\n").map(str::trim);
        let title = paragraphs.next().and_then(|title| title.split_once(": "));
        let (_, summary) = title.ok_or_else(|| missing("a title, as in `Name: what to do.`"))?;
        let mut docs = Self {
            summary: capitalised(&summary.replace('\n', " ")),
            table: Vec::new(),
            observation: None,
            versions: None,
            differences: None,
            rest: Vec::new(),
        };
        for paragraph in paragraphs {
            if paragraph.starts_with("| |") {
                docs.table = paragraph.lines().skip(2).map(str::to_owned).collect();
            } else if paragraph.starts_with("| number |") {
                docs.observation = Some(paragraph.to_owned());
            } else if let Some(versions) = paragraph.strip_prefix("Versions: ") {
                docs.versions = Some(versions.to_owned());
            } else if let Some(differences) = paragraph.strip_prefix("Differences from Gymnasium: ") {
                docs.differences = Some(capitalised(differences));
            } else {
                docs.rest.push(paragraph.to_owned());
            }
        }
        for row in ["observation", "action", "reward", "start", "end", "limit"] {
            if !docs.table.iter().any(|line| line.starts_with(&format!("| {row} |"))) {
                return Err(missing(&format!("the row `{row}` of the table")));
            }
        }
        Ok(docs)
    }
}

fn capitalised(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map(|first| first.to_uppercase().to_string() + letters.as_str()).unwrap_or_default()
}

impl Page {
    fn holds(&self, registration: &Registration) -> bool {
        registration.id().parse::<EnvId>().is_ok_and(|id| self.ids.contains(&id.name.as_str()))
    }

    /// The line of the list.
    fn row(&self, registrations: &[Registration], docs: &Docs) -> String {
        let ids: Vec<_> = registrations.iter().map(|entry| format!("`{}`", entry.id())).collect();
        let Self { name, title, .. } = self;
        format!(
            "| [![{title}](images/{name}.gif)]({name}.md) | [{title}]({name}.md): {} | {} |\n",
            docs.summary,
            ids.join(", ")
        )
    }

    fn text(
        &self,
        registrations: &[Registration],
        docs: &Docs,
        source: &str,
        returns: &Returns,
    ) -> Result<String> {
        let Self { name, title, heuristic, clip, .. } = self;
        let mut text = format!(
            "<!-- Written by `cargo xtask docs` from {} and the registry: change those. -->\n\n\
             # {title}\n\n{}\n\n![An episode of {title}](images/{name}.gif)\n\n| | |\n|---|---|\n{}\n",
            self.source,
            docs.summary,
            docs.table.join("\n")
        );
        let mut section = |title: &str, body: &str| text += &format!("\n## {title}\n\n{}\n", body.trim_end());
        if let Some(observation) = &docs.observation {
            section("Observation", observation);
        }
        if let Some(item) = self.actions {
            section("Actions", &actions(&source::members(source, item)));
        }
        section("Ids", &ids(registrations)?);
        section("Spaces", &spaces(registrations)?);
        section("Arguments", &self.arguments(registrations, source)?);
        section("Rendering", &rendering(registrations)?);
        if let Some(versions) = &docs.versions {
            section("Versions", versions);
        }
        section("Differences from Gymnasium", docs.differences.as_deref().unwrap_or(NO_DIFFERENCE));
        let play = |policy: &str| format!("To play it: `cargo xtask run {} --policy {policy}`.", clip.id);
        let good = if !heuristic.is_empty() {
            format!(" The good policy {heuristic}. {}", play("heuristic"))
        } else if crate::trained::is_stored(clip.id) {
            format!(
                " The good policy is a network that [`gym-ppo`](../training.md) trained and \
                 [this file](../policies/{name}.json) holds. {}",
                play("trained")
            )
        } else {
            String::new()
        };
        let returns = format!(
            "Mean and standard deviation of the return, and mean number of steps, over {EPISODES} episodes \
             (seeds 0 to {}).{good}\n\n{}",
            EPISODES - 1,
            table_of_returns(registrations, returns)?
        );
        section("Returns", &returns);
        if !docs.rest.is_empty() {
            section("Notes", &docs.rest.join("\n\n"));
        }
        Ok(text)
    }

    fn arguments(&self, registrations: &[Registration], source: &str) -> Result<String> {
        // every id that takes arguments takes the same
        let defaults =
            registrations.iter().map(Registration::default_kwargs).max_by_key(serde_json::Map::len);
        let defaults = defaults.unwrap_or_default();
        if defaults.is_empty() {
            return Ok("None.".into());
        }
        let fields = self.config(source)?;
        let mut text = String::from("| argument | type | default | meaning |\n|---|---|---|---|\n");
        for (name, value) in &defaults {
            let undocumented = || Error::custom(format!("{}: its Config documents no `{name}`", self.source));
            let field = fields.iter().find(|field| field.name == *name).ok_or_else(undocumented)?;
            let docs = source::without_item_links(&field.docs).replace("`Config::", "`");
            text += &format!("| `{name}` | {} | `{value}` | {docs} |\n", type_in_json(&field.kind));
        }
        // another value than the default, where there is one to be had
        let example = defaults.iter().find_map(|(name, value)| match value {
            Json::Bool(value) => Some((name, Json::Bool(!value))),
            Json::Number(_) => Some((name, value.clone())),
            _ => None,
        });
        if let Some((name, value)) = example {
            let Self { clip: Clip { id, .. }, module, .. } = self;
            text += &format!(
                "\nThey are set by name, as in `gym::builder(\"{id}\").arg(\"{name}\", {value}).build()?`, or typed, as \
                 fields of `gym::{module}::Config`."
            );
            gym::builder(id).arg(name, value).build()?;
        }
        Ok(text)
    }

    /// The fields of `Config`, from this file or from the one it is taken from.
    fn config(&self, source: &str) -> Result<Vec<Member>> {
        let other = |line: &str| {
            let module = line.strip_prefix("pub use crate::")?.strip_suffix("::Config;")?;
            let (folder, _) = self.source.rsplit_once('/')?;
            Some(format!("{folder}/{module}.rs"))
        };
        if let Some(path) = source.lines().find_map(other) {
            return Ok(source::members(&super::read(&path)?, "struct Config"));
        }
        let mut fields = source::members(source, "struct Config");
        // structs within it, whose fields are arguments too
        let (folder, _) = self.source.rsplit_once('/').unwrap_or_default();
        for (kind, file) in FLATTENED {
            if let Some(i) = fields.iter().position(|field| field.kind == kind) {
                fields.remove(i);
                let within = super::read(&format!("{folder}/{file}"))?;
                fields.extend(source::members(&within, &format!("struct {kind}")));
            }
        }
        Ok(fields)
    }
}

/// Structs that are flattened into the arguments of several environments, and the files that define them.
const FLATTENED: [(&str, &str); 2] = [("Common", "arguments.rs"), ("Observed", "humanoid.rs")];

/// What an argument of a Rust type is in JSON.
fn type_in_json(kind: &str) -> String {
    match kind {
        "bool" => "boolean".into(),
        "f64" => "number".into(),
        "u8" | "u32" | "i32" | "usize" => "integer".into(),
        "Range" => "list of 2 numbers, each or null".into(),
        "Body" => "integer or string".into(),
        "CameraConfig" => "object".into(),
        "Map<String, Json>" => "object of booleans".into(),
        "String" | "Physics" => "string".into(),
        "Vec<String>" => "list of strings".into(),
        "[f64; 3]" => "list of 3 numbers".into(),
        other => match other.strip_prefix("Option<").and_then(|inner| inner.strip_suffix('>')) {
            Some(inner) => format!("{}, or null", type_in_json(inner)),
            None => format!("`{other}`"),
        },
    }
}

fn ids(registrations: &[Registration]) -> Result<String> {
    let mut text = "| id | arguments that it sets | limit of steps | solved at a mean return of |\n\
                    |---|---|---|---|\n"
        .to_owned();
    for entry in registrations {
        let spec = entry.spec()?;
        let kwargs: Vec<_> = spec.kwargs.iter().map(|(name, value)| format!("`{name}`: `{value}`")).collect();
        let kwargs = if kwargs.is_empty() { "none".into() } else { kwargs.join(", ") };
        let limit = spec.max_episode_steps.map_or("none".into(), |limit| limit.to_string());
        let threshold = spec.reward_threshold.map_or("not said".into(), |threshold| threshold.to_string());
        text += &format!("| `{}` | {kwargs} | {limit} | {threshold} |\n", spec.id);
    }
    Ok(text)
}

/// The spaces, each with the ids that have it.
fn spaces(registrations: &[Registration]) -> Result<String> {
    let mut rows: Vec<(String, Vec<String>)> = Vec::new();
    for entry in registrations {
        let env = entry.spec()?.make()?;
        for (kind, space) in [("action", env.action_space()), ("observation", env.observation_space())] {
            // numpy breaks long arrays into lines
            let space = space.to_string().split_whitespace().collect::<Vec<_>>().join(" ");
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
            let ids = if ids.len() == registrations.len() { "all".into() } else { ids.join(", ") };
            format!("| {row} | {ids} |\n")
        })
        .collect();
    Ok(format!("| | space | ids |\n|---|---|---|\n{rows}"))
}

fn actions(variants: &[Member]) -> String {
    let row =
        |(number, action): (usize, &Member)| format!("| {number} | `{}` | {} |\n", action.name, action.docs);
    let rows: String = variants.iter().enumerate().map(row).collect();
    format!("| number | name | meaning |\n|---|---|---|\n{rows}")
}

fn rendering(registrations: &[Registration]) -> Result<String> {
    let Some(entry) = registrations.first() else { return Ok(String::new()) };
    let metadata = entry.spec()?.make()?.metadata();
    let can = |mode: &&RenderMode| metadata.render_modes.contains(&mode.single());
    let modes: Vec<_> = RenderMode::ALL.iter().filter(can).map(|mode| format!("`{mode}`")).collect();
    let (width, height) = metadata.render_size;
    let fps = metadata.render_fps;
    Ok(format!("Modes {}; {width}x{height} pixels, {fps} frames per second.", modes.join(", ")))
}

fn table_of_returns(registrations: &[Registration], returns: &Returns) -> Result<String> {
    let cells = |summary: &Summary| {
        let Summary { mean, deviation, mean_length } = summary;
        format!("{mean:.2} \u{b1} {deviation:.2} | {mean_length:.1}")
    };
    let mut text = "| id | random policy | steps | good policy | steps |\n|---|---|---|---|---|\n".to_owned();
    for entry in registrations {
        let id = entry.id();
        let Some(Measured { random, good }) = returns.get(id) else {
            text += &format!("| `{id}` | not measured | - | - | - |\n");
            continue;
        };
        let good = good.as_ref().map_or("- | -".into(), cells);
        text += &format!("| `{id}` | {} | {good} |\n", cells(random));
    }
    Ok(text)
}
