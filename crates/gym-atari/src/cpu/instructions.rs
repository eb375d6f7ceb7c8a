//! The instruction set of the 6502 as data: operation and mode of each of the 256 opcodes.
//!
//! Documented opcodes are MOS Technology's (MCS6500 Microcomputer Family Programming Manual, 1976);
//! the names of the others are those of the community's tables ("NMOS 6510 Unintended Opcodes").

/// The operation of an opcode, by its mnemonic.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[rustfmt::skip]
pub(crate) enum Operation {
    // read memory
    Adc, And, Bit, Cmp, Cpx, Cpy, Eor, Lda, Ldx, Ldy, Ora, Sbc,
    // undocumented, read memory
    Alr, Anc, Ane, Arr, Las, Lax, Lxa, Sbx,
    // write memory
    Sta, Stx, Sty,
    // undocumented, write memory
    Sax, Sha, Shx, Shy, Tas,
    // read, change and write memory
    Asl, Dec, Inc, Lsr, Rol, Ror,
    // undocumented, read, change and write memory
    Dcp, Isb, Rla, Rra, Slo, Sre,
    // registers and flags
    Clc, Cld, Cli, Clv, Dex, Dey, Inx, Iny, Nop, Sec, Sed, Sei, Tax, Tay, Tsx, Txa, Txs, Tya,
    // the stack
    Pha, Php, Pla, Plp,
    // branches
    Bcc, Bcs, Beq, Bmi, Bne, Bpl, Bvc, Bvs,
    // jumps
    Brk, Jmp, Jsr, Rti, Rts,
    /// Halts the processor until it is reset.
    Jam,
}

/// The addressing mode of an opcode.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Mode {
    /// Nothing, or the accumulator: `ASL`.
    Implied,
    /// The byte after the opcode: `LDA #$12`.
    Immediate,
    /// `LDA $12`.
    ZeroPage,
    /// `LDA $12,X`.
    ZeroPageX,
    /// `LDX $12,Y`.
    ZeroPageY,
    /// `LDA $1234`.
    Absolute,
    /// `LDA $1234,X`.
    AbsoluteX,
    /// `LDA $1234,Y`.
    AbsoluteY,
    /// `LDA ($12,X)`.
    IndirectX,
    /// `LDA ($12),Y`.
    IndirectY,
    /// `JMP ($1234)`.
    Indirect,
    /// `BNE label`.
    Relative,
}

/// How an operation accesses the memory that its mode addresses; this decides its cycles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Access {
    /// One read.
    Read,
    /// One write.
    Write,
    /// A read, a cycle that computes, a write.
    Modify,
}

impl Operation {
    /// Returns how the operation accesses its operand.
    pub(crate) const fn access(self) -> Access {
        use Operation::*;
        match self {
            Sta | Stx | Sty | Sax | Sha | Shx | Shy | Tas => Access::Write,
            Asl | Dec | Inc | Lsr | Rol | Ror | Dcp | Isb | Rla | Rra | Slo | Sre => Access::Modify,
            _ => Access::Read,
        }
    }
}

/// An operation and its mode.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Instruction {
    pub(crate) operation: Operation,
    pub(crate) mode: Mode,
}

/// For each opcode: the number of bytes that the processor reads before the instruction has an
/// effect. `JSR` reads its third byte last.
pub(crate) const LENGTHS: [u8; 256] = {
    let mut lengths = [2; 256];
    let mut opcode = 0;
    while opcode < 256 {
        let Instruction { operation, mode } = INSTRUCTIONS[opcode];
        match (operation, mode) {
            (Operation::Jsr, _) => {}
            (_, Mode::Implied) => lengths[opcode] = 1,
            (_, Mode::Absolute | Mode::AbsoluteX | Mode::AbsoluteY | Mode::Indirect) => {
                lengths[opcode] = 3;
            }
            _ => {}
        }
        opcode += 1;
    }
    lengths
};

/// Maps an assembler's abbreviations to modes: `abx` is `$1234,X`, `izy` is `($12),Y`.
macro_rules! table {
    ($($operation:ident $mode:ident,)*) => {
        [$(Instruction { operation: Operation::$operation, mode: table!(@$mode) }),*]
    };
    (@imp) => { Mode::Implied };
    (@imm) => { Mode::Immediate };
    (@zp_) => { Mode::ZeroPage };
    (@zpx) => { Mode::ZeroPageX };
    (@zpy) => { Mode::ZeroPageY };
    (@abs) => { Mode::Absolute };
    (@abx) => { Mode::AbsoluteX };
    (@aby) => { Mode::AbsoluteY };
    (@izx) => { Mode::IndirectX };
    (@izy) => { Mode::IndirectY };
    (@ind) => { Mode::Indirect };
    (@rel) => { Mode::Relative };
}

/// The instructions by opcode, eight to a line.
#[rustfmt::skip]
pub(crate) const INSTRUCTIONS: [Instruction; 256] = table! {
    /* 00 */ Brk imp, Ora izx, Jam imp, Slo izx, Nop zp_, Ora zp_, Asl zp_, Slo zp_,
    /* 08 */ Php imp, Ora imm, Asl imp, Anc imm, Nop abs, Ora abs, Asl abs, Slo abs,
    /* 10 */ Bpl rel, Ora izy, Jam imp, Slo izy, Nop zpx, Ora zpx, Asl zpx, Slo zpx,
    /* 18 */ Clc imp, Ora aby, Nop imp, Slo aby, Nop abx, Ora abx, Asl abx, Slo abx,
    /* 20 */ Jsr abs, And izx, Jam imp, Rla izx, Bit zp_, And zp_, Rol zp_, Rla zp_,
    /* 28 */ Plp imp, And imm, Rol imp, Anc imm, Bit abs, And abs, Rol abs, Rla abs,
    /* 30 */ Bmi rel, And izy, Jam imp, Rla izy, Nop zpx, And zpx, Rol zpx, Rla zpx,
    /* 38 */ Sec imp, And aby, Nop imp, Rla aby, Nop abx, And abx, Rol abx, Rla abx,
    /* 40 */ Rti imp, Eor izx, Jam imp, Sre izx, Nop zp_, Eor zp_, Lsr zp_, Sre zp_,
    /* 48 */ Pha imp, Eor imm, Lsr imp, Alr imm, Jmp abs, Eor abs, Lsr abs, Sre abs,
    /* 50 */ Bvc rel, Eor izy, Jam imp, Sre izy, Nop zpx, Eor zpx, Lsr zpx, Sre zpx,
    /* 58 */ Cli imp, Eor aby, Nop imp, Sre aby, Nop abx, Eor abx, Lsr abx, Sre abx,
    /* 60 */ Rts imp, Adc izx, Jam imp, Rra izx, Nop zp_, Adc zp_, Ror zp_, Rra zp_,
    /* 68 */ Pla imp, Adc imm, Ror imp, Arr imm, Jmp ind, Adc abs, Ror abs, Rra abs,
    /* 70 */ Bvs rel, Adc izy, Jam imp, Rra izy, Nop zpx, Adc zpx, Ror zpx, Rra zpx,
    /* 78 */ Sei imp, Adc aby, Nop imp, Rra aby, Nop abx, Adc abx, Ror abx, Rra abx,
    /* 80 */ Nop imm, Sta izx, Nop imm, Sax izx, Sty zp_, Sta zp_, Stx zp_, Sax zp_,
    /* 88 */ Dey imp, Nop imm, Txa imp, Ane imm, Sty abs, Sta abs, Stx abs, Sax abs,
    /* 90 */ Bcc rel, Sta izy, Jam imp, Sha izy, Sty zpx, Sta zpx, Stx zpy, Sax zpy,
    /* 98 */ Tya imp, Sta aby, Txs imp, Tas aby, Shy abx, Sta abx, Shx aby, Sha aby,
    /* a0 */ Ldy imm, Lda izx, Ldx imm, Lax izx, Ldy zp_, Lda zp_, Ldx zp_, Lax zp_,
    /* a8 */ Tay imp, Lda imm, Tax imp, Lxa imm, Ldy abs, Lda abs, Ldx abs, Lax abs,
    /* b0 */ Bcs rel, Lda izy, Jam imp, Lax izy, Ldy zpx, Lda zpx, Ldx zpy, Lax zpy,
    /* b8 */ Clv imp, Lda aby, Tsx imp, Las aby, Ldy abx, Lda abx, Ldx aby, Lax aby,
    /* c0 */ Cpy imm, Cmp izx, Nop imm, Dcp izx, Cpy zp_, Cmp zp_, Dec zp_, Dcp zp_,
    /* c8 */ Iny imp, Cmp imm, Dex imp, Sbx imm, Cpy abs, Cmp abs, Dec abs, Dcp abs,
    /* d0 */ Bne rel, Cmp izy, Jam imp, Dcp izy, Nop zpx, Cmp zpx, Dec zpx, Dcp zpx,
    /* d8 */ Cld imp, Cmp aby, Nop imp, Dcp aby, Nop abx, Cmp abx, Dec abx, Dcp abx,
    /* e0 */ Cpx imm, Sbc izx, Nop imm, Isb izx, Cpx zp_, Sbc zp_, Inc zp_, Isb zp_,
    /* e8 */ Inx imp, Sbc imm, Nop imp, Sbc imm, Cpx abs, Sbc abs, Inc abs, Isb abs,
    /* f0 */ Beq rel, Sbc izy, Jam imp, Isb izy, Nop zpx, Sbc zpx, Inc zpx, Isb zpx,
    /* f8 */ Sed imp, Sbc aby, Nop imp, Isb aby, Nop abx, Sbc abx, Inc abx, Isb abx,
};
