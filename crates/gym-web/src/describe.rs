//! The registry, spaces and values as JSON, for the page.

use gym::arguments::Argument;
use gym::registry::EnvId;
use gym::{Array, Registration, Result, Space, Value, registry};
use serde_json::{Value as Json, json};

/// Of larger bounds and observations only the shape is sent.
const MOST_NUMBERS: usize = 512;

/// Describes every environment that can run here, in the order of the gallery: family by family,
/// page by page. What needs another build, or files that a browser has no place for, is left out;
/// what a whole family needs, such as ROMs, the page asks its reader for.
pub(crate) fn list() -> Json {
    let mut entries = Vec::new();
    for (family, mut registrations) in registry::by_family(registry::all()) {
        registrations.retain(|registration| {
            family.needs.is_some() || registration.needs.is_none_or(|need| need.is_met())
        });
        for (page, group) in registry::by_page(registrations).iter().enumerate() {
            let shown = registry::shown(group).map(Registration::id);
            for registration in group {
                let mut entry = entry(registration);
                entry["family"] = json!(family.name);
                // the family's cards by number, and the environment that a card shows first
                entry["card"] = json!(page);
                entry["shown"] = json!(shown == Some(registration.id()));
                entries.push(entry);
            }
        }
    }
    entries.into()
}

fn entry(registration: &Registration) -> Json {
    let id: Option<EnvId> = registration.id().parse().ok();
    json!({
        "id": registration.id(),
        "name": id.as_ref().map(EnvId::unversioned),
        "version": id.and_then(|id| id.version),
        "description": registration.description,
        "missing": missing(registration),
        "policy": registration.page.policy.map(|policy| policy.description),
    })
}

/// Returns the requirement that is missing, such as the ROM of a game.
fn missing(registration: &Registration) -> Option<&'static str> {
    let need = registration.needs?;
    let is_there = need.is_met() && gym::make(registration.id()).is_ok();
    (!is_there).then_some(need.what)
}

/// Describes the arguments of an environment with their values under this id.
pub(crate) fn arguments(registration: &Registration) -> Result<Json> {
    let argument = |argument: &Argument| {
        json!({
            "name": argument.name,
            "value": argument.default,
            "kind": argument.kind,
            "unit": argument.unit,
            "meaning": argument.meaning,
        })
    };
    Ok(registration.arguments()?.iter().map(argument).collect())
}

/// Describes a space: its kind, Gymnasium's text, and the fields that the page uses.
pub(crate) fn space(space: &Space) -> Json {
    let mut description = match space {
        Space::Discrete(space) => {
            json!({"kind": "Discrete", "n": space.n(), "start": space.start()})
        }
        Space::Box(space) => json!({
            "kind": "Box",
            "shape": space.shape(),
            "dtype": space.dtype().name(),
            "low": numbers(space.low()),
            "high": numbers(space.high()),
        }),
        Space::MultiBinary(space) => json!({"kind": "MultiBinary", "shape": space.shape()}),
        Space::MultiDiscrete(space) => {
            json!({"kind": "MultiDiscrete", "shape": space.shape(), "nvec": space.nvec(), "start": space.start()})
        }
        Space::Tuple(space) => {
            json!({"kind": "Tuple", "spaces": space.spaces().iter().map(self::space).collect::<Vec<_>>()})
        }
        Space::Dict(space) => {
            let spaces = space
                .spaces()
                .iter()
                .map(|(name, space)| json!([name, self::space(space)]));
            json!({"kind": "Dict", "spaces": spaces.collect::<Vec<_>>()})
        }
        _ => json!({"kind": "other"}),
    };
    description["text"] = json!(space.to_string());
    description
}

/// Returns the numbers of an array; `None` if there are too many to show. Infinities and NaN become
/// text.
fn numbers(array: &Array) -> Option<Vec<Json>> {
    let number = |x: f64| {
        if x.is_finite() {
            json!(x)
        } else {
            json!(x.to_string())
        }
    };
    (array.len() <= MOST_NUMBERS).then(|| array.iter_f64().map(number).collect())
}

/// Returns the numbers of an observation or action, or the shape of a large array.
pub(crate) fn value(value: &Value) -> Json {
    match value {
        Value::Array(array) if array.len() > MOST_NUMBERS => {
            json!({"shape": array.shape(), "dtype": array.dtype().name()})
        }
        Value::Tuple(parts) => parts.iter().map(self::value).collect(),
        Value::Dict(parts) => Json::Object(
            parts
                .iter()
                .map(|(name, part)| (name.clone(), self::value(part)))
                .collect(),
        ),
        _ => value.to_json(),
    }
}

/// Converts a picture of 3 bytes or 1 byte per pixel to RGBA, as a canvas needs it.
pub(crate) fn to_rgba(pixels: &[u8], bytes_per_pixel: usize, rgba: &mut Vec<u8>) {
    rgba.resize(pixels.len() / bytes_per_pixel * 4, 255);
    for (pixel, rgba) in pixels
        .chunks_exact(bytes_per_pixel)
        .zip(rgba.chunks_exact_mut(4))
    {
        match *pixel {
            [r, g, b] => rgba[..3].copy_from_slice(&[r, g, b]),
            [gray] => rgba[..3].fill(gray),
            _ => {}
        }
    }
}
