//! The console: processor, RIOT, TIA and cartridge on one bus.
//!
//! ```
//! use gym_atari::cartridge::{Cartridge, Scheme};
//! use gym_atari::console::{Console, Input};
//!
//! // sta WSYNC; jmp $F000: a program that never ends a frame, which the console does for it
//! let mut rom = [0xea; 4096];
//! rom[..5].copy_from_slice(&[0x85, 0x02, 0x4c, 0x00, 0xf0]);
//! rom[0xffc..0xffe].copy_from_slice(&[0x00, 0xf0]);
//! let mut console = Console::new(Cartridge::new(&rom, Scheme::Rom4K), Default::default(), [0; 128], 74);
//! console.frame(&Input::default());
//! assert_eq!(console.ram().len(), 128);
//! ```

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use crate::blocks::{self, Blocks};
use crate::cartridge::{Banks, Cartridge};
use crate::cpu::Cpu;
use crate::riot::Riot;
pub use crate::screen::Pictures;
use crate::screen::Screen;
use crate::tia::{Display, Tia};
use crate::wires::Chips;

/// A call returns after this number of instructions even if the frame has not ended.
const MOST_INSTRUCTIONS: u32 = 25_000;

/// A row of the picture: an even colour index for each of 160 pixels.
pub type Row = crate::screen::Row;

/// The positions of controllers and switches during a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Input {
    /// Port A of the RIOT, `SWCHA`: the joysticks' directions, active low. The left stick is in the
    /// upper four bits.
    pub port_a: u8,
    /// Port B, `SWCHB`: the console's switches; see [`switch`].
    pub port_b: u8,
    /// The fire buttons, read at `INPT4` and `INPT5`.
    pub fire: [bool; 2],
    /// The paddles, read at `INPT0` to `INPT3`: the time in colour clocks to charge the capacitor,
    /// or `None` without a paddle.
    pub charge: [Option<u32>; 4],
}

impl Default for Input {
    fn default() -> Self {
        Self {
            port_a: 0xff,
            port_b: switch::IDLE,
            fire: [false; 2],
            charge: [None; 4],
        }
    }
}

/// Bits of port B.
pub mod switch {
    /// Nothing pressed, colour, both difficulties B.
    pub const IDLE: u8 = 0x3f;
    /// 0 while RESET is pressed.
    pub const RESET: u8 = 0x01;
    /// 0 while SELECT is pressed.
    pub const SELECT: u8 = 0x02;
    /// 1 for the left player's difficulty A.
    pub const LEFT_DIFFICULTY: u8 = 0x40;
    /// 1 for the right player's difficulty A.
    pub const RIGHT_DIFFICULTY: u8 = 0x80;
}

/// An Atari 2600 with a cartridge.
#[derive(Clone, Debug)]
pub struct Console {
    cpu: Cpu,
    chips: Chips,
    cartridge: Cartridge,
    blocks: Arc<Blocks>,
}

/// The state of a console without the pictures: a few hundred bytes.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct State {
    cpu: Cpu,
    riot: Riot,
    tia: Tia,
    banks: Banks,
    frame_ended: bool,
}

impl Console {
    /// Switches a console on, with the contents `ram` and a timer that runs as if `timer` had been
    /// written to `TIM64T`.
    pub fn new(cartridge: Cartridge, display: Display, ram: [u8; 128], timer: u8) -> Self {
        let mut cartridge = cartridge;
        cartridge.reset();
        let pc = u16::from_le_bytes([0xfffc, 0xfffd].map(|address| cartridge.read(address, 0)));
        let chips = Chips {
            riot: Riot::new(ram, timer),
            tia: Tia::new(display),
            screen: Screen::new(),
            frame_ended: false,
            continued: true,
        };
        Self {
            cpu: Cpu::new(pc),
            chips,
            blocks: Blocks::of(&cartridge),
            cartridge,
        }
    }

    /// Runs a frame, until the program ends it or for 25,000 instructions.
    pub fn frame(&mut self, input: &Input) {
        self.run(input, true);
    }

    /// Like [`frame`](Self::frame) without drawing. Everything except the picture is the same.
    pub fn frame_unseen(&mut self, input: &Input) {
        self.run(input, false);
    }

    fn run(&mut self, input: &Input, seen: bool) {
        let Self {
            cpu,
            chips,
            cartridge,
            blocks,
        } = self;
        chips.riot.port_a = input.port_a;
        chips.riot.port_b = input.port_b;
        chips.tia.fire = input.fire;
        chips.tia.charge = input.charge;
        if chips.screen.unseen == seen {
            chips.screen.unseen = !seen;
            chips.tia.start_picture();
        }
        chips.continued = !std::mem::take(&mut chips.frame_ended);
        if !chips.continued {
            chips.screen.swap();
        }
        blocks::run(cpu, chips, cartridge, blocks, MOST_INSTRUCTIONS);
    }

    /// Returns the 128 bytes of RAM.
    pub fn ram(&self) -> &[u8; 128] {
        &self.chips.riot.ram
    }

    /// Returns the 128 bytes of RAM for changes.
    pub fn ram_mut(&mut self) -> &mut [u8; 128] {
        &mut self.chips.riot.ram
    }

    /// Returns the picture, row by row from the top.
    pub fn picture(&self) -> &[Row] {
        &self.chips.screen.picture()[..self.chips.tia.display().rows]
    }

    /// Whether the last call did not draw a complete picture: the frame ended early, has not ended,
    /// or began in an earlier call. The rest of the picture is then two frames old.
    pub fn is_short(&self) -> bool {
        self.chips.continued || !self.chips.frame_ended || self.chips.tia.is_short()
    }

    /// Returns the state without the pictures.
    pub fn state(&self) -> State {
        let Chips {
            riot,
            tia,
            screen: _,
            frame_ended,
            continued: _,
        } = &self.chips;
        let mut tia = tia.clone();
        tia.place_all();
        State {
            cpu: self.cpu,
            riot: riot.clone(),
            tia,
            banks: self.cartridge.banks().clone(),
            frame_ended: *frame_ended,
        }
    }

    /// Restores a state; keeps the pictures. Returns false and changes nothing if the state does
    /// not fit the cartridge.
    pub fn set_state(&mut self, state: &State) -> bool {
        let State {
            cpu,
            riot,
            tia,
            banks,
            frame_ended,
        } = state;
        if !tia.is_valid(cpu.cycle) || !riot.is_valid(cpu.cycle) || !self.cartridge.set_banks(banks)
        {
            return false;
        }
        let display = *self.chips.tia.display();
        self.cpu = *cpu;
        self.chips.riot = riot.clone();
        self.chips.tia = tia.clone();
        self.chips.tia.set_display(display);
        self.chips.tia.start_picture();
        self.chips.frame_ended = *frame_ended;
        true
    }

    /// Like [`set_state`](Self::set_state), but the next call starts or continues a frame as if no
    /// state had been restored.
    pub(crate) fn set_state_within_frame(&mut self, state: &State) -> bool {
        let starts = self.chips.frame_ended;
        let fits = self.set_state(state);
        let Chips {
            tia, frame_ended, ..
        } = &mut self.chips;
        if fits && *frame_ended != starts {
            if starts {
                tia.start_frame(self.cpu.cycle);
            } else {
                tia.continue_frame();
            }
            *frame_ended = starts;
        }
        fits
    }

    /// Returns the pictures in a form that can be stored.
    pub fn pictures(&self) -> Pictures {
        Pictures::of(&self.chips.screen)
    }

    /// Restores stored pictures. Returns false and changes nothing if they are damaged.
    pub fn set_pictures(&mut self, pictures: &Pictures) -> bool {
        let screen = pictures.screen();
        let fits = screen.is_some();
        if let Some(screen) = screen {
            self.chips.screen = screen;
        }
        fits
    }

    /// Returns the index of the picture that is being drawn.
    pub(crate) fn current_picture(&self) -> usize {
        self.chips.screen.current
    }

    /// Selects the picture to draw: 0 or 1.
    pub(crate) fn set_current_picture(&mut self, picture: usize) {
        self.chips.screen.current = picture;
    }

    /// Returns the cartridge.
    pub fn cartridge(&self) -> &Cartridge {
        &self.cartridge
    }
}
