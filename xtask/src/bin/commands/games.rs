//! The table of games in `docs/atari.md`, from the games and their ids.

use std::path::Path;

use gym::atari::games::{GAMES, Game};
use gym::{Result, registry};
use gym_cli::Document;

use crate::book::{self, Marks};

const PAGE: &str = "docs/atari.md";
const MARKS: Marks = [
    "<!-- games: written by cargo xtask docs -->\n",
    "<!-- end of games -->\n",
];

/// Returns the page with the table of the supported games.
pub(crate) fn document(folder: &Path) -> Result<Document> {
    book::page(folder, PAGE, MARKS, &table())
}

fn table() -> String {
    let rows = GAMES.iter().map(|game| {
        let has_older = registry::find(&format!("{}-v4", game.title)).is_ok();
        let ids = if has_older { "v0, v4, v5" } else { "v5" };
        format!(
            "| {} | `{}` | {ids} | {} | {} |\n",
            game.title,
            game.name,
            modes(game),
            difficulties(game)
        )
    });
    let head = "| game | name | ids | modes | difficulties |\n|---|---|---|---|---|\n";
    head.to_owned() + &rows.collect::<String>()
}

/// Returns all modes or, if there are many, the first mode, the last mode and their number.
fn modes(game: &Game) -> String {
    let modes: Vec<_> = game
        .modes
        .iter()
        .map(|(mode, _)| mode.to_string())
        .collect();
    match &modes[..] {
        [_] => "default".to_owned(),
        [first, .., last] if modes.len() > 10 => format!("{first} to {last} ({})", modes.len()),
        _ => modes.join(", "),
    }
}

fn difficulties(game: &Game) -> String {
    let difficulties: Vec<_> = game.difficulties.iter().map(u8::to_string).collect();
    difficulties.join(", ")
}
