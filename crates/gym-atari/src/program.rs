//! A ROM and its decoded instructions, which all consoles of the ROM share.

use std::fmt;
use std::sync::{Arc, Mutex, OnceLock, PoisonError, Weak};

use crate::blocks::Op;
use crate::cartridge::Scheme;

/// The bytes of the largest ROM.
pub(crate) const ROM: usize = 0x4000;

/// A ROM and its decoded instructions.
pub(crate) struct Program {
    scheme: Scheme,
    /// The bytes; zeros behind a smaller ROM.
    pub(crate) rom: [u8; ROM],
    /// The block of instructions that starts at a byte: see [`Kind::entry`](crate::cartridge::Kind::entry). A block is decoded
    /// when it is first executed, and follows from the ROM alone.
    pub(crate) blocks: Box<[OnceLock<Box<[Op]>>]>,
}

impl fmt::Debug for Program {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Program").field("scheme", &self.scheme).finish_non_exhaustive()
    }
}

/// The programs of all consoles that there are.
static PROGRAMS: Mutex<Vec<Weak<Program>>> = Mutex::new(Vec::new());

impl Program {
    /// The program of a ROM: the same for all who ask while one of them has it.
    pub(crate) fn of(rom: [u8; ROM], scheme: Scheme) -> Arc<Self> {
        let mut programs = PROGRAMS.lock().unwrap_or_else(PoisonError::into_inner);
        programs.retain(|program| program.strong_count() > 0);
        let known = programs.iter().filter_map(Weak::upgrade);
        if let Some(program) =
            known.into_iter().find(|program| program.scheme == scheme && program.rom == rom)
        {
            return program;
        }
        let entries = match scheme {
            Scheme::Rom2K | Scheme::Rom4K => 0x1000,
            Scheme::F8 => 0x2000,
            Scheme::F6 => 0x4000,
            Scheme::E0 => 0x8000,
            // others are not decoded
            Scheme::F8SC | Scheme::F6SC | Scheme::FE | Scheme::Dpc => 0,
        };
        let program = Arc::new(Self { scheme, rom, blocks: (0..entries).map(|_| OnceLock::new()).collect() });
        programs.push(Arc::downgrade(&program));
        program
    }
}
