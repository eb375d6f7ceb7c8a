//! The game of an Atari environment, for Python's `ale` objects.

use std::path::PathBuf;

use gym::Error;
use gym::atari::ale::{Settings, State};
use gym::atari::{Action, Ale as Game, Rom, RomDir};
use numpy::{IxDyn, PyArray, PyArrayMethods, PyReadwriteArrayDyn, PyUntypedArrayMethods};
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use pyo3::types::PyTuple;

use crate::env::Env;
use crate::error::OrRaise;

/// A view of the game that an environment plays.
#[pyclass(frozen, module = "rustgym._native")]
#[derive(Debug)]
pub(crate) struct Ale(Py<Env>);

/// The state of a game, and the settings of its next episodes.
#[pyclass(frozen, eq, module = "rustgym._native")]
#[derive(Debug, PartialEq)]
pub(crate) struct AleState {
    /// The state as JSON.
    state: String,
    /// Whether restoring this state also restores the random number generator.
    include_rng: bool,
    frame_number: u32,
    episode_frame_number: u32,
    /// The mode and difficulty of the next episodes.
    mode: u16,
    difficulty: u8,
}

/// The values from which Python rebuilds an `AleState`.
type StateParts = (String, bool, u16, u8);

impl Ale {
    fn with<T>(&self, py: Python<'_>, f: impl FnOnce(&mut Game) -> PyResult<T>) -> PyResult<T> {
        self.0.get().with_atari(py, |env| f(env.ale_mut()))
    }
}

/// Lets `fill` write bytes to a Python buffer, or to a new array if there is none.
fn bytes<'py>(
    py: Python<'py>,
    buffer: Option<PyReadwriteArrayDyn<'py, u8>>,
    shape: &[usize],
    fill: impl FnOnce(&mut [u8]),
) -> PyResult<Option<Bound<'py, PyAny>>> {
    let Some(mut buffer) = buffer else {
        let array = PyArray::<u8, IxDyn>::zeros(py, shape, false);
        fill(array.try_readwrite()?.as_slice_mut()?);
        return Ok(Some(array.into_any()));
    };
    if buffer.shape() != shape {
        let found = buffer.shape();
        return Err(PyRuntimeError::new_err(format!(
            "the buffer has the shape {found:?}, expecting {shape:?}"
        )));
    }
    fill(buffer.as_slice_mut()?);
    Ok(None)
}

#[pymethods]
impl Ale {
    /// The game of this environment.
    #[new]
    fn new(env: Py<Env>) -> Self {
        Self(env)
    }

    /// The name of the game of a ROM.
    #[staticmethod]
    fn supported(rom: &[u8]) -> Option<&'static str> {
        Rom::from_bytes(rom).ok().map(|rom| rom.game().name)
    }

    /// The file of the ROM; only a name if the ROM came from memory.
    fn rom_file(&self, py: Python<'_>) -> PyResult<PathBuf> {
        self.0.get().with_atari(py, |env| {
            let folder = env
                .config()
                .rom_dir
                .clone()
                .map(RomDir::new)
                .or_else(RomDir::find);
            Ok(folder
                .unwrap_or_else(|| RomDir::new(""))
                .file(env.ale().game()))
        })
    }

    /// Plays a frame, and returns the reward.
    fn act(&self, py: Python<'_>, action: i64, paddle_strength: f32) -> PyResult<i32> {
        let Some(&action) = usize::try_from(action)
            .ok()
            .and_then(|number| Action::ALL.get(number))
        else {
            let reason = format!(
                "{action} is not an action of the Atari 2600: the actions are 0 to {}",
                Action::ALL.len() - 1
            );
            return Err(Error::argument("act", reason)).or_raise();
        };
        self.with(py, |game| {
            Ok(game.act(gym::atari::Command {
                action,
                paddle_strength,
            }))
        })
    }

    /// Starts an episode.
    fn reset(&self, py: Python<'_>) -> PyResult<()> {
        self.with(py, |game| {
            game.reset();
            Ok(())
        })
    }

    /// Loads the ROM again.
    fn load(&self, py: Python<'_>, seed: u32) -> PyResult<()> {
        self.with(py, |game| {
            game.load(seed);
            Ok(())
        })
    }

    /// The number of lives, whether the game is over, whether the episode has reached its frame
    /// limit, the frame number, and the episode's frame number.
    fn progress(&self, py: Python<'_>) -> PyResult<(i32, bool, bool, u32, u32)> {
        self.with(py, |game| {
            let over = (game.game_over(), game.is_truncated());
            Ok((
                game.lives(),
                over.0,
                over.1,
                game.frame_number(),
                game.episode_frame_number(),
            ))
        })
    }

    /// The constant data: name, rows of the picture, legal and minimal actions, modes,
    /// difficulties.
    fn facts<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        self.with(py, |game| {
            let game = game.game();
            let indices = |actions: &[Action]| {
                actions
                    .iter()
                    .map(|action| *action as usize)
                    .collect::<Vec<_>>()
            };
            let modes: Vec<u16> = game.modes.iter().map(|(mode, _)| *mode).collect();
            let (legal, minimal) = (indices(game.legal), indices(game.minimal));
            // (Python would receive `Vec<u8>` as bytes)
            let difficulties: Vec<u16> = game.difficulties.iter().copied().map(u16::from).collect();
            (
                game.name,
                game.display.rows,
                legal,
                minimal,
                modes,
                difficulties,
            )
                .into_pyobject(py)
        })
    }

    /// The mode, difficulty and frame limit of the next episodes.
    fn settings(&self, py: Python<'_>) -> PyResult<(Option<u16>, Option<u8>, Option<u32>)> {
        self.with(py, |game| {
            let Settings {
                mode,
                difficulty,
                max_frames,
                ..
            } = game.settings();
            Ok((mode, difficulty, max_frames))
        })
    }

    /// Sets the mode, difficulty and frame limit of the next episodes.
    fn configure(
        &self,
        py: Python<'_>,
        mode: Option<u16>,
        difficulty: Option<u8>,
        max_frames: Option<u32>,
    ) -> PyResult<()> {
        self.with(py, |game| {
            let known = game.game();
            if mode.is_some_and(|mode| known.modes.iter().all(|(other, _)| *other != mode)) {
                return Err(PyRuntimeError::new_err("Invalid game mode requested"));
            }
            if difficulty.is_some_and(|difficulty| !known.difficulties.contains(&difficulty)) {
                return Err(PyRuntimeError::new_err("Invalid difficulty requested"));
            }
            game.configure(Settings {
                mode,
                difficulty,
                max_frames,
                ..game.settings()
            });
            Ok(())
        })
    }

    /// The picture: as indices of colours, in `gray` or in `rgb`.
    #[pyo3(signature = (kind, buffer = None))]
    fn screen<'py>(
        &self,
        py: Python<'py>,
        kind: &str,
        buffer: Option<PyReadwriteArrayDyn<'py, u8>>,
    ) -> PyResult<Option<Bound<'py, PyAny>>> {
        self.with(py, |game| {
            let pixels = game.picture().as_flattened();
            let (rows, width) = (game.picture().len(), pixels.len() / game.picture().len());
            let display = &game.game().display;
            match kind {
                "rgb" => bytes(py, buffer, &[rows, width, 3], |out| {
                    for (rgb, index) in out.as_chunks_mut::<3>().0.iter_mut().zip(pixels) {
                        *rgb = display.rgb()[usize::from(*index)];
                    }
                }),
                "gray" => bytes(py, buffer, &[rows, width], |out| {
                    out.iter_mut()
                        .zip(pixels)
                        .for_each(|(gray, index)| *gray = display.gray()[usize::from(*index)]);
                }),
                _ => bytes(py, buffer, &[rows, width], |out| {
                    out.copy_from_slice(pixels);
                }),
            }
        })
    }

    /// The RAM.
    #[pyo3(signature = (buffer = None))]
    fn ram<'py>(
        &self,
        py: Python<'py>,
        buffer: Option<PyReadwriteArrayDyn<'py, u8>>,
    ) -> PyResult<Option<Bound<'py, PyAny>>> {
        self.with(py, |game| {
            bytes(py, buffer, &[128], |out| out.copy_from_slice(game.ram().0))
        })
    }

    /// Changes a byte of the RAM.
    fn set_ram(&self, py: Python<'_>, index: usize, value: u8) -> PyResult<()> {
        self.with(py, |game| match game.ram_mut().get_mut(index) {
            Some(byte) => {
                *byte = value;
                Ok(())
            }
            None => Err(PyRuntimeError::new_err("setRAM index out of bounds.")),
        })
    }

    /// The state of the game.
    fn state(&self, py: Python<'_>, include_rng: bool) -> PyResult<AleState> {
        self.with(py, |game| {
            let (settings, known) = (game.settings(), game.game());
            let mode = settings.mode.unwrap_or(known.modes[0].0);
            let difficulty = settings.difficulty.unwrap_or(known.difficulties[0]);
            AleState::of(&game.state(), include_rng, mode, difficulty)
        })
    }

    /// Continues from a state.
    fn set_state(&self, py: Python<'_>, state: &AleState) -> PyResult<()> {
        let stored = state.read()?;
        self.with(py, |game| {
            if !game.set_state_like_ale(&stored, state.include_rng) {
                return Err(Error::Snapshot("it was taken from another game".into())).or_raise();
            }
            let (mode, difficulty) = (Some(state.mode), Some(state.difficulty));
            game.configure(Settings {
                mode,
                difficulty,
                ..game.settings()
            });
            Ok(())
        })
    }
}

impl AleState {
    fn of(state: &State, include_rng: bool, mode: u16, difficulty: u8) -> PyResult<Self> {
        Ok(Self {
            state: serde_json::to_string(state)
                .map_err(|error| Error::Snapshot(error.to_string()))
                .or_raise()?,
            include_rng,
            frame_number: state.frame_number(),
            episode_frame_number: state.episode_frame_number(),
            mode,
            difficulty,
        })
    }

    fn read(&self) -> PyResult<State> {
        serde_json::from_str(&self.state)
            .map_err(|error| Error::Snapshot(error.to_string()))
            .or_raise()
    }
}

#[pymethods]
impl AleState {
    /// Rebuilds a state from the parts that `__reduce__` returned.
    #[new]
    fn new(state: &str, include_rng: bool, mode: u16, difficulty: u8) -> PyResult<Self> {
        let state: State = serde_json::from_str(state)
            .map_err(|error| Error::Snapshot(error.to_string()))
            .or_raise()?;
        Self::of(&state, include_rng, mode, difficulty)
    }

    /// The frames since the game was made.
    #[pyo3(name = "getFrameNumber")]
    fn frame_number(&self) -> u32 {
        self.frame_number
    }

    /// The frames of the episode.
    #[pyo3(name = "getEpisodeFrameNumber")]
    fn episode_frame_number(&self) -> u32 {
        self.episode_frame_number
    }

    /// The mode of the next episodes.
    #[pyo3(name = "getCurrentMode")]
    fn current_mode(&self) -> u16 {
        self.mode
    }

    /// The difficulty of the next episodes.
    #[pyo3(name = "getDifficulty")]
    fn difficulty(&self) -> u8 {
        self.difficulty
    }

    /// Whether another state is equal.
    fn equals(&self, other: &Self) -> bool {
        self == other
    }

    /// The state as bytes.
    fn serialize(&self) -> &[u8] {
        self.state.as_bytes()
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<(Bound<'py, PyAny>, StateParts)> {
        let state = slf.get();
        let parts = (
            state.state.clone(),
            state.include_rng,
            state.mode,
            state.difficulty,
        );
        Ok((slf.get_type().into_any(), parts))
    }
}
