//! ROMs. The user provides them; this crate contains none.

use std::env;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

use gym_core::{Error, Result, file};

use crate::games::{self, Game};

/// The environment variable that names a folder of ROMs, as in ale-py.
pub const VARIABLE: &str = "ALE_ROMS_DIR";

/// The largest size of a ROM file: twice the longest cartridge of the Atari 2600.
const MAX_LEN: usize = 1 << 20;

/// A ROM of a known game, checked by its MD5.
#[derive(Clone, Debug)]
pub struct Rom {
    game: &'static Game,
    md5: String,
    bytes: Arc<[u8]>,
}

impl Rom {
    /// Makes a ROM from its bytes, if its MD5 belongs to a known game.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] if no game has a ROM with this MD5.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self> {
        let md5 = format!("{:x}", md5::compute(bytes));
        match games::by_md5(&md5) {
            Some(game) => Ok(Self {
                game,
                md5,
                bytes: bytes.into(),
            }),
            None => Err(Error::argument(
                "a ROM",
                format!(
                    "no game has the MD5 {md5}: {} games are known",
                    games::GAMES.len()
                ),
            )),
        }
    }

    /// Makes a ROM from your own program; it is played with the settings of `game`, and its MD5 is
    /// not checked.
    pub fn homebrew(game: &'static Game, bytes: &[u8]) -> Self {
        Self {
            game,
            md5: format!("{:x}", md5::compute(bytes)),
            bytes: bytes.into(),
        }
    }

    /// Returns the MD5 of the bytes.
    pub fn md5(&self) -> &str {
        &self.md5
    }

    /// Returns the game.
    pub fn game(&self) -> &'static Game {
        self.game
    }

    /// Returns the bytes.
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }
}

/// The [provided](provide) ROMs.
static PROVIDED: Mutex<Vec<Rom>> = Mutex::new(Vec::new());

/// Provides a ROM from memory, for platforms without files. [`load`] uses it if the user names no
/// folder.
pub fn provide(rom: Rom) {
    let mut provided = PROVIDED.lock().unwrap_or_else(PoisonError::into_inner);
    provided.retain(|other| other.game.name != rom.game.name);
    provided.push(rom);
}

/// Returns the game's provided ROM, if any.
fn provided(game: &Game) -> Option<Rom> {
    let provided = PROVIDED.lock().unwrap_or_else(PoisonError::into_inner);
    provided
        .iter()
        .find(|rom| rom.game.name == game.name)
        .cloned()
}

/// A folder of ROMs with ale-py's file names, such as `breakout.bin`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RomDir(PathBuf);

impl RomDir {
    /// Makes a `RomDir` for `path`.
    pub fn new(path: impl Into<PathBuf>) -> Self {
        Self(path.into())
    }

    /// Finds a folder: the one in `ALE_ROMS_DIR`; otherwise the folder of an installed ale-py, in
    /// the active virtual environment, in `.venv` in the current folder, or next to a `python3` in
    /// the `PATH`.
    pub fn find() -> Option<Self> {
        if let Some(path) = env::var_os(VARIABLE).filter(|path| !path.is_empty()) {
            return Some(Self(path.into()));
        }
        file::of_python("ale_py/roms").map(Self)
    }

    /// Returns the path of the folder.
    pub fn path(&self) -> &Path {
        &self.0
    }

    /// Returns the path of a game's ROM, which may not exist.
    pub fn file(&self, game: &Game) -> PathBuf {
        self.0.join(format!("{}.bin", game.name))
    }

    /// Reads the ROM of a game.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] if the file does not exist, is not a regular file, or has another
    /// MD5 than the game's ROM.
    pub fn rom(&self, game: &'static Game) -> Result<Rom> {
        let path = self.file(game);
        let bytes = file::read(&path, MAX_LEN).map_err(|error| {
            let fault = match error.kind() {
                io::ErrorKind::InvalidInput => {
                    "is not a regular file: put the ROM there, or a link to it".to_owned()
                }
                io::ErrorKind::FileTooLarge => format!(
                    "is longer than {MAX_LEN} bytes, the largest cartridge: it is not a ROM of this game"
                ),
                _ => format!("cannot be read: {error}"),
            };
            let reason = format!("the ROM {} {fault}. {}", path.display(), advice());
            Error::argument(game.title, reason)
        })?;
        let md5 = format!("{:x}", md5::compute(&bytes));
        if md5 != game.md5 {
            return Err(Error::argument(
                game.title,
                format!(
                    "the ROM {} has the MD5 {md5}, not {}: it is another game or edition",
                    path.display(),
                    game.md5
                ),
            ));
        }
        Ok(Rom {
            game,
            md5,
            bytes: bytes.into(),
        })
    }
}

/// Loads the ROM of a game: from `folder`; without `folder`, the [provided](provide) ROM or a file
/// in [`RomDir::find`].
///
/// # Errors
/// The errors of [`RomDir::rom`]; without any folder, an error that says how to get ROMs.
pub fn load(game: &'static Game, folder: Option<&Path>) -> Result<Rom> {
    if folder.is_none()
        && let Some(rom) = provided(game)
    {
        return Ok(rom);
    }
    match folder.map(RomDir::new).or_else(RomDir::find) {
        Some(folder) => folder.rom(game),
        None => Err(Error::argument(
            game.title,
            format!("no ROMs were found. {}", advice()),
        )),
    }
}

/// Whether a ROM was [provided](provide), or [`RomDir::find`] has ROMs.
pub fn available() -> bool {
    if !PROVIDED
        .lock()
        .unwrap_or_else(PoisonError::into_inner)
        .is_empty()
    {
        return true;
    }
    RomDir::find().is_some_and(|folder| games::GAMES.iter().any(|game| folder.rom(game).is_ok()))
}

fn advice() -> String {
    if cfg!(target_family = "wasm") {
        return "ROMs are not included: give one from memory with `gym_atari::rom::provide`".into();
    }
    format!(
        "ROMs are not included: `pip install ale-py` brings them, in the active virtual environment or in \
         `.venv`; or set {VARIABLE} to a folder with files such as `breakout.bin`, or give the argument `rom_dir`"
    )
}
