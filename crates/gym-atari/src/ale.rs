//! A game for an agent: its start, the effect of an action on a frame, and the reward.
//!
//! The rules are those observed from outside in ale-py 0.12.1; see `NOTICE.md`.

use serde::{Deserialize, Serialize};

use crate::action::{Action, Command};
use crate::cartridge::Cartridge;
use crate::console::{Console, Input, Pictures, Row, State as ConsoleState, switch};
use crate::games::{Controller, Game, Menu, Ram};
use crate::mt19937::Mt19937;
use crate::paddle::Paddle;

/// RAM when the ROM is loaded, the same each time. Later it stays as it is while the power is off.
const POWER_ON_RAM: &[u8; 128] = include_bytes!("power_on/ram.bin");
/// The timer's value when the ROM is loaded, before the game is started for the first time.
const LOADING_TIMER: u8 = 0x33;
/// The timer's values, for each time that the power is switched on.
const POWER_ON_TIMER: &[u8; 6000] = include_bytes!("power_on/timer.bin");
/// The frames between power-on and RESET.
const IDLE_FRAMES: u8 = 60;
/// The frames that are run when the ROM is loaded, before the game is started for the first time.
const LOADING_FRAMES: u8 = 60;
/// The same for PAL sets, where 30 frames of their length are enough. A program that does not clear
/// its RAM shows them: of the games Space War, whose first frame is shorter.
const PAL_LOADING_FRAMES: u8 = 31;
/// The frames that RESET is pressed for after a mode was chosen, in games that have several, and
/// once more.
const RESET_FRAMES: u8 = 4;
/// The most presses of SELECT; ale-py continues forever.
const MOST_PRESSES: u32 = 256;

/// The pictures, drawn in turn.
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

/// The state after loading the ROM, which starts the game once.
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
    /// The probability with which a frame repeats the action of the one before: actions are sticky.
    pub repeat_action_probability: f64,
}

/// The state of a game, beside the console.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Progress {
    /// The number of times the power was switched on.
    power_ons: usize,
    /// Draws whether an action sticks.
    generator: Mt19937,
    /// The action of the previous frame.
    previous: Command,
    paddle: Paddle,
    score: i32,
    /// The last frame's reward.
    reward: i32,
    lives: i32,
    over: bool,
    /// The number of frames for which RAM has said that the game is over.
    over_for: u8,
    frame_number: u32,
    episode_frame_number: u32,
}

/// The stored form of a game: all except ROM and picture.
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
    /// The frames since the game was made.
    pub fn frame_number(&self) -> u32 {
        self.progress.frame_number
    }

    /// The frames of the episode.
    pub fn episode_frame_number(&self) -> u32 {
        self.progress.episode_frame_number
    }
}

impl Ale {
    /// A game from its ROM, with the generator of sticky actions seeded, at the start of an
    /// episode.
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
                generator: Mt19937::new(seed),
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

    /// Loads the ROM again, with the generator of sticky actions reseeded: an episode of the
    /// default mode and difficulty stands at its start. The settings count from the next
    /// [`reset`](Self::reset) on.
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

    /// As [`load`](Self::load) and [`reset`](Self::reset): starts the first episode after loading
    /// the ROM. It does not play the frames of loading again where they are the same for every
    /// seed.
    pub fn reload(&mut self, seed: u32) {
        self.progress.power_ons = 1; // loading took the first
        self.progress.generator = Mt19937::new(seed);
        for _ in 0..self.game.idle {
            self.progress.generator.random();
        }
        if self.game.menu.is_some() {
            // sticky actions in the menu, and their traces in RAM, depend on the seed
            let fresh = self.fresh(seed);
            self.loaded = fresh.loaded;
            self.progress.generator = fresh.progress.generator;
        }
        self.progress.frame_number = self.loaded.frame_number;
        *self.console.ram_mut() = self.loaded.ram;
        self.reset();
    }

    /// Starts an episode: power-on, an idle second, RESET, and the game's own first actions.
    pub fn reset(&mut self) {
        let ram = *self.console.ram(); // outlasts it
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

    /// Presses RESET; no action from before it sticks.
    fn press_reset(&mut self) {
        self.hold(switch::IDLE & !switch::RESET, RESET_FRAMES);
        self.progress.previous = Action::Noop.into();
    }

    /// Leaves the console's switches so for some frames, while the player does nothing.
    fn hold(&mut self, switches: u8, frames: u8) {
        for _ in 0..frames {
            self.frame(Action::Noop.into(), switches, true);
        }
    }

    /// Presses SELECT until RAM shows the mode; ale-py counts a frame for each press.
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
                let more = self.progress.generator.byte();
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

    /// Goes down the menu's lines, and right at each option that the mode changes, until RAM shows
    /// both. The actions may stick.
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

    /// An action for a frame, and nothing for another.
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

    /// The executed command: this one if its action is legal, or with a probability the one before.
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

    /// Plays a frame with exactly this command. An unseen frame does not change the picture.
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

    /// Plays frames with one command and returns the sum of their rewards. Only the last two are
    /// drawn.
    ///
    /// There are two pictures, drawn in turn, and a frame that ends early keeps the rest of an
    /// older one. So both pictures are always what they would be with every frame drawn: where two
    /// whole ones do not come out, the frames are played again, and all of them are drawn.
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

    /// All that frames change, but the pictures.
    pub(crate) fn moment(&self) -> Moment {
        Moment {
            state: self.state(),
            picture: self.console.current_picture(),
        }
    }

    /// Goes back to a moment of this game.
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
        // bit 0 is the left switch, bit 1 the right one
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

    /// The game.
    pub fn game(&self) -> &'static Game {
        self.game
    }

    /// The RAM.
    pub fn ram(&self) -> Ram<'_> {
        Ram(self.console.ram())
    }

    /// The RAM, to be changed. Score and lives are read from it with the next frame.
    pub fn ram_mut(&mut self) -> &mut [u8; 128] {
        self.console.ram_mut()
    }

    /// The picture: a colour index for each pixel.
    pub fn picture(&self) -> &[Row] {
        self.console.picture()
    }

    /// The console.
    pub fn console(&self) -> &Console {
        &self.console
    }

    /// The remaining lives; 0 if a game has none.
    pub fn lives(&self) -> i32 {
        self.progress.lives
    }

    /// Whether the game is over.
    pub fn game_over(&self) -> bool {
        self.progress.over
    }

    /// Whether no frame follows: the game is over, or the episode has as many frames as it may.
    fn has_ended(&self) -> bool {
        self.progress.over || self.is_truncated()
    }

    /// Whether the episode has as many frames as it may.
    pub fn is_truncated(&self) -> bool {
        self.settings
            .max_frames
            .is_some_and(|most| self.progress.episode_frame_number >= most)
    }

    /// The frames since the game was made.
    pub fn frame_number(&self) -> u32 {
        self.progress.frame_number
    }

    /// The frames of this episode.
    pub fn episode_frame_number(&self) -> u32 {
        self.progress.episode_frame_number
    }

    /// Sets how later frames and episodes are played; mode and difficulty must be among the game's.
    pub fn configure(&mut self, settings: Settings) {
        self.settings = settings;
    }

    /// The settings of the episodes that follow.
    pub fn settings(&self) -> Settings {
        self.settings
    }

    /// Continues from a state, and shows the pictures of it; `false` and no change if they are not
    /// of this game.
    pub fn restore(&mut self, state: &State, pictures: &Pictures) -> bool {
        let mut restored = self.clone();
        let fits = restored.set_state(state) && restored.console.set_pictures(pictures);
        if fits {
            *self = restored;
        }
        fits
    }

    /// All but ROM and picture.
    pub fn state(&self) -> State {
        State {
            console: self.console.state(),
            progress: self.progress.clone(),
        }
    }

    /// Continues from a state; `false` and no change if it is not one of this game.
    pub fn set_state(&mut self, state: &State) -> bool {
        let fits = self.console.set_state(&state.console);
        if fits {
            self.progress = state.progress.clone();
        }
        fits
    }

    /// As [`set_state`](Self::set_state), in the way of ale-py's `restoreState`: the action that
    /// may stick is the last that was done, the numbers that decide it go on, unless they are to be
    /// those of the state, and an unfinished frame goes on.
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
