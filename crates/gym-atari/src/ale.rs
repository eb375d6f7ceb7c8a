//! A game for an agent: how it starts, what an action does in a frame, and the reward.
//!
//! The rules are those observed from outside in ale-py 0.12.1; see `NOTICE.md`.

use gym_core::RandomState;
use serde::{Deserialize, Serialize};

use crate::action::{Action, Command};
use crate::cartridge::Cartridge;
use crate::console::{Console, Input, Pictures, Row, State as ConsoleState, switch};
use crate::games::{Controller, Game, Menu, Ram};
use crate::paddle::Paddle;

/// RAM after loading a ROM: the same bytes each time. Later power cycles keep RAM.
const POWER_ON_RAM: &[u8; 128] = include_bytes!("power_on/ram.bin");
/// The timer's value when the ROM is loaded.
const LOADING_TIMER: u8 = 0x33;
/// The timer's value at each later power-on.
const POWER_ON_TIMER: &[u8; 6000] = include_bytes!("power_on/timer.bin");
/// Frames between power-on and RESET.
const IDLE_FRAMES: u8 = 60;
/// Frames that run when the ROM is loaded, before the first power-on.
const LOADING_FRAMES: u8 = 60;
/// The frames that run when the ROM of a PAL game is loaded. PAL frames are longer than NTSC
/// frames, so 31 are enough. The number matters only for programs that do not clear RAM, such as
/// Space War, whose first frame is shorter.
const PAL_LOADING_FRAMES: u8 = 31;
/// Frames for which RESET is pressed after a mode was selected.
const RESET_FRAMES: u8 = 4;
/// The largest number of presses of SELECT. ale-py has no limit.
const MOST_PRESSES: u32 = 256;

/// The console draws two pictures in turn.
const PICTURES: u32 = 2;

/// A game that is being played.
#[derive(Clone, Debug)]
pub struct Ale {
    game: &'static Game,
    console: Console,
    loaded: Loaded,
    settings: Settings,
    progress: Progress,
}

/// The state after loading the ROM.
#[derive(Clone, Debug)]
struct Loaded {
    ram: [u8; 128],
    frame_number: u32,
}

/// The settings of episodes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Settings {
    /// The mode; `None` for the game's default.
    pub mode: Option<u16>,
    /// The difficulty; `None` for the game's default.
    pub difficulty: Option<u8>,
    /// The number of frames after which an episode ends; `None` for never.
    pub max_frames: Option<u32>,
    /// The probability of a sticky action: a frame repeats the previous frame's action.
    pub repeat_action_probability: f64,
}

/// The state of a game, apart from the console.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Progress {
    /// How many times the power was switched on.
    power_ons: usize,
    /// The generator that decides whether an action sticks.
    generator: RandomState,
    /// The action of the previous frame.
    previous: Command,
    paddle: Paddle,
    score: i32,
    /// The last frame's reward.
    reward: i32,
    lives: i32,
    over: bool,
    /// Consecutive frames in which RAM shows that the game is over.
    over_for: u8,
    frame_number: u32,
    episode_frame_number: u32,
}

/// The stored form of a game: everything except the ROM and the pictures.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct State {
    console: ConsoleState,
    progress: Progress,
}

/// A state, and the index of the picture that is being drawn.
#[derive(Clone, Debug)]
pub(crate) struct Moment {
    state: State,
    picture: usize,
}

impl State {
    /// Returns the number of frames since the game was made.
    pub fn frame_number(&self) -> u32 {
        self.progress.frame_number
    }

    /// Returns the number of frames in this episode.
    pub fn episode_frame_number(&self) -> u32 {
        self.progress.episode_frame_number
    }
}

impl Ale {
    /// Makes a game from its ROM, at the start of an episode. `seed` seeds the generator of sticky
    /// actions.
    pub fn new(game: &'static Game, rom: &[u8], seed: u32) -> Self {
        Self::with_cartridge(game, Cartridge::new(rom, game.scheme), seed, 0.0)
    }

    fn with_cartridge(
        game: &'static Game,
        cartridge: Cartridge,
        seed: u32,
        repeat_action_probability: f64,
    ) -> Self {
        let mut ale = Self {
            game,
            console: Console::new(cartridge, game.display, *POWER_ON_RAM, LOADING_TIMER),
            loaded: Loaded {
                ram: *POWER_ON_RAM,
                frame_number: 0,
            },
            settings: Settings {
                repeat_action_probability,
                ..Settings::default()
            },
            progress: Progress {
                power_ons: 0,
                generator: RandomState::new(seed),
                previous: Action::Noop.into(),
                paddle: Paddle::middle(game.paddle_end),
                score: 0,
                reward: 0,
                lives: 0,
                over: false,
                over_for: 0,
                frame_number: 0,
                episode_frame_number: 0,
            },
        };
        let frames = if game.display.pal {
            PAL_LOADING_FRAMES
        } else {
            LOADING_FRAMES
        };
        ale.hold(switch::IDLE, frames);
        ale.reset();
        ale.loaded = Loaded {
            ram: *ale.console.ram(),
            frame_number: ale.progress.frame_number,
        };
        ale
    }

    /// Loads the ROM again and starts an episode in the default mode and difficulty. `seed` seeds
    /// the generator of sticky actions. The settings apply from the next [`reset`](Self::reset) on.
    pub fn load(&mut self, seed: u32) {
        let settings = self.settings;
        *self = self.fresh(seed);
        self.settings = settings;
    }

    fn fresh(&self, seed: u32) -> Self {
        let cartridge = self.console.cartridge().clone();
        Self::with_cartridge(
            self.game,
            cartridge,
            seed,
            self.settings.repeat_action_probability,
        )
    }

    /// Has the effect of [`load`](Self::load) and [`reset`](Self::reset). If the frames of loading
    /// are the same for every seed, it does not run them again.
    pub fn reload(&mut self, seed: u32) {
        self.progress.power_ons = 1; // loading was the first power-on
        self.progress.generator = RandomState::new(seed);
        for _ in 0..self.game.idle {
            self.progress.generator.random();
        }
        if self.game.menu.is_some() {
            // sticky actions in the menu, and so RAM, depend on the seed
            let fresh = self.fresh(seed);
            self.loaded = fresh.loaded;
            self.progress.generator = fresh.progress.generator;
        }
        self.progress.frame_number = self.loaded.frame_number;
        *self.console.ram_mut() = self.loaded.ram;
        self.reset();
    }

    /// Starts an episode: power-on, 60 idle frames, RESET, and the game's start actions.
    pub fn reset(&mut self) {
        let ram = *self.console.ram(); // RAM outlasts a power cycle
        let cartridge = self.console.cartridge().clone();
        let timer = POWER_ON_TIMER[self.progress.power_ons % POWER_ON_TIMER.len()];
        self.console = Console::new(cartridge, self.game.display, ram, timer);
        self.progress.power_ons += 1;
        self.progress.previous = Action::Noop.into();
        self.progress.paddle = Paddle::middle(self.game.paddle_end);
        self.hold(switch::IDLE, IDLE_FRAMES);
        self.hold(switch::IDLE & !switch::RESET, self.game.first_reset);
        self.progress.episode_frame_number = 0;
        for _ in 0..self.game.idle {
            self.progress.generator.random();
            self.frame(Action::Noop.into(), switch::IDLE, true);
            self.count_frame();
        }
        if let Some(index) = self.game.mode_at {
            self.choose_mode(index);
            self.press_reset();
        }
        if let Some(menu) = &self.game.menu {
            self.choose_in_menu(menu);
        }
        self.press_reset();
        for &action in self.game.start {
            self.frame(action.into(), switch::IDLE, true);
        }
        self.progress.score = (self.game.score)(&self.ram());
        self.progress.reward = 0;
        self.progress.over_for = 0;
        self.observe();
    }

    /// Presses RESET. The next frame cannot repeat an earlier action.
    fn press_reset(&mut self) {
        self.hold(switch::IDLE & !switch::RESET, RESET_FRAMES);
        self.progress.previous = Action::Noop.into();
    }

    /// Runs `frames` frames with the console's switches in the position `switches`, without an
    /// action.
    fn hold(&mut self, switches: u8, frames: u8) {
        for _ in 0..frames {
            self.frame(Action::Noop.into(), switches, true);
        }
    }

    /// Presses SELECT until RAM shows the mode. ale-py counts one frame per press.
    fn choose_mode(&mut self, index: usize) {
        let game = self.game;
        let chosen = game
            .modes
            .iter()
            .find(|(mode, _)| self.settings.mode == Some(*mode));
        let &(mode, value) = chosen.unwrap_or(&game.modes[0]);
        for press in 0..MOST_PRESSES {
            let shown = self.console.ram()[index];
            let is_shown = shown == value || shown == value | game.mode_bits;
            if is_shown && (game.mode_also)(&self.ram(), mode) && (press > 0 || !game.press_first) {
                break;
            }
            self.hold(switch::IDLE & !switch::SELECT, game.select_frames);
            if game.select_random {
                let more = self.progress.generator.word() as u8;
                self.hold(switch::IDLE & !switch::SELECT, more);
            }
            self.hold(switch::IDLE, 1);
            self.count_frame();
            if game.select_random {
                self.progress.generator.random();
                self.frame(Action::Noop.into(), switch::IDLE, true);
                self.count_frame();
            }
        }
    }

    /// Selects a mode in a menu: moves down to each option's line, and right until RAM shows the
    /// option's value. These actions may stick.
    fn choose_in_menu(&mut self, menu: &Menu) {
        let mode = self.settings.mode.unwrap_or(self.game.modes[0].0);
        self.hold(switch::IDLE & !switch::SELECT, 1);
        self.hold(switch::IDLE, 1);
        self.count_frame();
        for (option, &(line, bit)) in menu.options.iter().enumerate() {
            self.tap_until(Action::Down, |ram| ram.0[menu.line] == line);
            let wanted = mode >> option & 1 != 0;
            self.tap_until(Action::Right, |ram| (ram.0[menu.set] & bit != 0) == wanted);
        }
        self.press_reset();
        self.tap(Action::UpFire);
    }

    fn tap_until(&mut self, action: Action, is_done: impl Fn(Ram<'_>) -> bool) {
        for _ in 0..MOST_PRESSES {
            if is_done(self.ram()) {
                break;
            }
            self.tap(action);
        }
    }

    /// Plays `action` for one frame, then no action for one frame.
    fn tap(&mut self, action: Action) {
        for action in [action, Action::Noop] {
            let executed = self.stick(action.into());
            self.progress.previous = executed;
            self.frame(executed, switch::IDLE, true);
            self.count_frame();
        }
    }

    fn count_frame(&mut self) {
        self.progress.frame_number += 1;
        self.progress.episode_frame_number += 1;
    }

    /// Plays a frame and returns its reward. With probability
    /// [`Settings::repeat_action_probability`] it repeats the last command instead. Actions that
    /// are not [legal](Game::legal) in the game are played as [`Action::Noop`]. Does nothing once
    /// the game is over.
    pub fn act(&mut self, command: impl Into<Command>) -> i32 {
        let command = self.stick(command.into());
        self.play(command, true)
    }

    /// Returns the command to execute: the previous command with the sticky probability, otherwise
    /// `command`, without its action if the action is not legal.
    pub(crate) fn stick(&mut self, command: Command) -> Command {
        if self.progress.generator.random() < self.settings.repeat_action_probability {
            self.progress.previous
        } else if self.game.legal.contains(&command.action) {
            command
        } else {
            Command {
                action: Action::Noop,
                ..command
            }
        }
    }

    /// Plays a frame with `command`, without sticky actions. If `seen` is false, the frame is not
    /// drawn.
    pub(crate) fn play(&mut self, command: Command, seen: bool) -> i32 {
        self.progress.previous = command;
        if self.has_ended() {
            return 0;
        }
        self.frame(command, switch::IDLE, seen);
        self.count_frame();
        let (before, after) = (self.progress.score, (self.game.score)(&self.ram()));
        self.progress.score = after;
        if (self.game.rewards_count)(&self.ram()) {
            self.progress.reward = self.game.rewards.of(before, after);
        }
        self.observe();
        self.progress.reward
    }

    /// Plays `frames` frames with `command`, draws only the last two, and returns the sum of the
    /// rewards.
    ///
    /// The console draws two pictures in turn, and a frame that ends early keeps the older rest of
    /// its picture. To leave both pictures as if every frame had been drawn, the function replays
    /// and draws all frames if one of the last two was not complete.
    pub(crate) fn frames(&mut self, command: Command, frames: u32) -> i32 {
        let unseen = frames.saturating_sub(PICTURES);
        if unseen == 0 {
            return (0..frames).map(|_| self.act(command)).sum();
        }
        let before = self.moment();
        let (mut reward, mut whole) = (0, 0);
        for frame in 0..frames {
            let had_ended = self.has_ended();
            let executed = self.stick(command);
            reward += self.play(executed, frame >= unseen);
            whole += u32::from(frame >= unseen && !had_ended && !self.console.is_short());
        }
        if whole < PICTURES {
            self.set_moment(&before);
            for _ in 0..frames {
                self.act(command);
            }
        }
        reward
    }

    /// Returns everything that frames change, except the pictures' contents.
    pub(crate) fn moment(&self) -> Moment {
        Moment {
            state: self.state(),
            picture: self.console.current_picture(),
        }
    }

    /// Returns to a moment of this game.
    pub(crate) fn set_moment(&mut self, moment: &Moment) {
        self.set_state(&moment.state);
        self.console.set_current_picture(moment.picture);
    }

    fn observe(&mut self) {
        let ram = self.ram();
        let over_for = if (self.game.over)(&ram) {
            self.progress.over_for.saturating_add(1)
        } else {
            0
        };
        let over = over_for >= self.game.over_frames;
        let lives = match over {
            true => self.game.lives_at_end,
            false if (self.game.lives_count)(&ram) => (self.game.lives)(&ram),
            false => self.progress.lives,
        };
        self.progress.over_for = over_for;
        self.progress.over = over;
        self.progress.lives = lives;
    }

    /// Runs the console for a frame.
    fn frame(
        &mut self,
        Command {
            action,
            paddle_strength,
        }: Command,
        switches: u8,
        seen: bool,
    ) {
        let difficulty = self
            .settings
            .difficulty
            .unwrap_or(self.game.difficulties[0]);
        // bit 0 of `difficulty` is the left switch, bit 1 the right switch
        let port_b = switches | difficulty << switch::LEFT_DIFFICULTY.trailing_zeros();
        let input = match self.game.controller {
            Controller::Joystick => Input {
                port_a: action.port_a(),
                port_b,
                fire: [action.fire(), false],
                ..Input::default()
            },
            Controller::RightJoystick => {
                let port_a = action.port_a() >> 4 | 0xf0;
                Input {
                    port_a,
                    port_b,
                    fire: [false, action.fire()],
                    ..Input::default()
                }
            }
            Controller::Paddle(paddle) | Controller::LeftPaddle(paddle) => {
                let end = self.game.paddle_end;
                self.progress
                    .paddle
                    .turn(action.horizontal(), paddle_strength, end);
                let fire = if action.fire() {
                    [0x80, 0x40][paddle & 1]
                } else {
                    0
                };
                let mut charge = [Some(Paddle::middle(end).charge()); 2];
                charge[paddle & 1] = Some(self.progress.paddle.charge());
                let right = matches!(self.game.controller, Controller::Paddle(_)).then_some(0);
                let charge = [charge[0], charge[1], right, right];
                Input {
                    port_a: !fire,
                    port_b,
                    fire: [false; 2],
                    charge,
                }
            }
        };
        if seen {
            self.console.frame(&input);
        } else {
            self.console.frame_unseen(&input);
        }
    }

    /// Returns the game.
    pub fn game(&self) -> &'static Game {
        self.game
    }

    /// Returns the RAM.
    pub fn ram(&self) -> Ram<'_> {
        Ram(self.console.ram())
    }

    /// Returns the RAM for changes. The next frame reads score and lives from it.
    pub fn ram_mut(&mut self) -> &mut [u8; 128] {
        self.console.ram_mut()
    }

    /// Returns the picture: a colour index for each pixel.
    pub fn picture(&self) -> &[Row] {
        self.console.picture()
    }

    /// Returns the console.
    pub fn console(&self) -> &Console {
        &self.console
    }

    /// Returns the remaining lives; 0 in a game without lives.
    pub fn lives(&self) -> i32 {
        self.progress.lives
    }

    /// Whether the game is over.
    pub fn game_over(&self) -> bool {
        self.progress.over
    }

    /// Whether the game is over, or the episode is truncated.
    fn has_ended(&self) -> bool {
        self.progress.over || self.is_truncated()
    }

    /// Whether the episode has reached its frame limit.
    pub fn is_truncated(&self) -> bool {
        self.settings
            .max_frames
            .is_some_and(|most| self.progress.episode_frame_number >= most)
    }

    /// Returns the number of frames since the game was made.
    pub fn frame_number(&self) -> u32 {
        self.progress.frame_number
    }

    /// Returns the number of frames in this episode.
    pub fn episode_frame_number(&self) -> u32 {
        self.progress.episode_frame_number
    }

    /// Sets the settings of later frames and episodes. `mode` and `difficulty` must be among the
    /// game's.
    pub fn configure(&mut self, settings: Settings) {
        self.settings = settings;
    }

    /// Returns the settings of the next episodes.
    pub fn settings(&self) -> Settings {
        self.settings
    }

    /// Restores a state and its pictures. Returns false and changes nothing if they do not belong
    /// to this game.
    pub fn restore(&mut self, state: &State, pictures: &Pictures) -> bool {
        let mut restored = self.clone();
        let fits = restored.set_state(state) && restored.console.set_pictures(pictures);
        if fits {
            *self = restored;
        }
        fits
    }

    /// Returns everything except the ROM and the pictures.
    pub fn state(&self) -> State {
        State {
            console: self.console.state(),
            progress: self.progress.clone(),
        }
    }

    /// Restores a state. Returns false and changes nothing if it does not belong to this game.
    pub fn set_state(&mut self, state: &State) -> bool {
        let fits = self.console.set_state(&state.console);
        if fits {
            self.progress = state.progress.clone();
        }
        fits
    }

    /// Restores a state as ale-py's `restoreState` does. Unlike [`set_state`](Self::set_state),
    /// this keeps the current action that may stick, continues an unfinished frame, and keeps the
    /// generator of sticky actions unless `include_rng` is true.
    pub fn set_state_like_ale(&mut self, state: &State, include_rng: bool) -> bool {
        let fits = self.console.set_state_within_frame(&state.console);
        if fits {
            let Progress {
                previous,
                generator,
                ..
            } = self.progress.clone();
            self.progress = Progress {
                previous,
                ..state.progress.clone()
            };
            if !include_rng {
                self.progress.generator = generator;
            }
        }
        fits
    }
}
