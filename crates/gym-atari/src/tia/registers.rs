//! Addresses and bits of the registers, from the Stella Programmer's Guide (1979), section "TIA".

/// The bits of an address that select a register for reading.
pub(super) const READ_ADDRESS: u16 = 0x0f;
/// The bits of an address that select a register for writing.
pub(super) const WRITE_ADDRESS: u16 = 0x3f;

// read
pub(super) const CXM0P: u16 = 0x00;
pub(super) const CXPPMM: u16 = 0x07;
pub(super) const INPT0: u16 = 0x08;
pub(super) const INPT3: u16 = 0x0b;
pub(super) const INPT4: u16 = 0x0c;
pub(super) const INPT5: u16 = 0x0d;

// write
pub(super) const VSYNC: u16 = 0x00;
pub(super) const VBLANK: u16 = 0x01;
pub(super) const WSYNC: u16 = 0x02;
pub(super) const NUSIZ0: u16 = 0x04;
pub(super) const NUSIZ1: u16 = 0x05;
pub(super) const COLUP0: u16 = 0x06;
pub(super) const COLUP1: u16 = 0x07;
pub(super) const COLUPF: u16 = 0x08;
pub(super) const COLUBK: u16 = 0x09;
pub(super) const CTRLPF: u16 = 0x0a;
pub(super) const REFP0: u16 = 0x0b;
pub(super) const REFP1: u16 = 0x0c;
pub(super) const PF0: u16 = 0x0d;
pub(super) const PF1: u16 = 0x0e;
pub(super) const PF2: u16 = 0x0f;
pub(super) const RESP0: u16 = 0x10;
pub(super) const RESP1: u16 = 0x11;
pub(super) const RESM0: u16 = 0x12;
pub(super) const RESBL: u16 = 0x14;
pub(super) const GRP0: u16 = 0x1b;
pub(super) const GRP1: u16 = 0x1c;
pub(super) const ENAM0: u16 = 0x1d;
pub(super) const ENAM1: u16 = 0x1e;
pub(super) const ENABL: u16 = 0x1f;
pub(super) const HMP0: u16 = 0x20;
pub(super) const HMBL: u16 = 0x24;
pub(super) const VDELP0: u16 = 0x25;
pub(super) const VDELP1: u16 = 0x26;
pub(super) const VDELBL: u16 = 0x27;
pub(super) const RESMP0: u16 = 0x28;
pub(super) const RESMP1: u16 = 0x29;
pub(super) const HMOVE: u16 = 0x2a;
pub(super) const HMCLR: u16 = 0x2b;
pub(super) const CXCLR: u16 = 0x2c;

/// The bits of the registers' values.
pub(super) mod bit {
    /// `VSYNC`: vertical sync is on.
    pub(in crate::tia) const SYNC: u8 = 0x02;
    /// `VBLANK`: vertical blank is on.
    pub(in crate::tia) const BLANK: u8 = 0x02;
    /// `VBLANK`: the triggers are latched.
    pub(in crate::tia) const LATCH: u8 = 0x40;
    /// `VBLANK`: the paddles' capacitors are discharged.
    pub(in crate::tia) const DISCHARGE: u8 = 0x80;
    /// `COLUxx`: hue and luminance.
    pub(in crate::tia) const COLOR: u8 = 0xfe;
    /// `CTRLPF`: the right half of the playfield mirrors the left half.
    pub(in crate::tia) const REFLECT_PLAYFIELD: u8 = 0x01;
    /// `CTRLPF`: the halves of the playfield have the players' colours.
    pub(in crate::tia) const SCORE: u8 = 0x02;
    /// `CTRLPF`: the playfield is drawn over the players.
    pub(in crate::tia) const PRIORITY: u8 = 0x04;
    /// `REFPx`: the player is reflected.
    pub(in crate::tia) const REFLECT: u8 = 0x08;
    /// `ENAMx` and `ENABL`: the object is visible.
    pub(in crate::tia) const ENABLE: u8 = 0x02;
    /// `VDELPx` and `VDELBL`: vertical delay is on.
    pub(in crate::tia) const DELAY: u8 = 0x01;
    /// `RESMPx`: the missile is hidden and locked to its player.
    pub(in crate::tia) const LOCK: u8 = 0x02;
    /// `INPTx`: the capacitor is charged, or the trigger is not pressed.
    pub(in crate::tia) const INPUT: u8 = 0x80;
}
