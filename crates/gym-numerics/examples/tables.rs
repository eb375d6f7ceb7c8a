//! Prints the tables of the mathematical functions, computed with 420 binary digits after the
//! point:
//!
//! ```text
//! cargo run --package gym-numerics --example tables > crates/gym-numerics/src/math/tables.rs
//! ```
//!
//! A test compares the tables with this program's output. The reciprocals of the logarithms are a
//! choice rather than a computation: they are those of ARM's optimized routines, which glibc uses.

use std::fmt::Write;

use num_bigint::BigInt;

fn main() {
    print!("{}", generate());
}

/// Binary digits after the point in all computations.
const PLACES: u32 = 420;

fn one() -> BigInt {
    BigInt::from(1) << PLACES
}

fn product(a: &BigInt, b: &BigInt) -> BigInt {
    (a * b) >> PLACES
}

/// Returns the sum of `first`, `first * factor(1)`, `first * factor(1) * factor(2)`, ...
fn series(first: BigInt, factor: impl Fn(&BigInt, u32) -> BigInt) -> BigInt {
    let (mut term, mut sum) = (first.clone(), first);
    for k in 1.. {
        term = factor(&term, k);
        if term == BigInt::ZERO || term == BigInt::from(-1) {
            break;
        }
        sum += &term;
    }
    sum
}

/// Returns e^x for `x` below 1.
fn exp(x: &BigInt) -> BigInt {
    series(one(), |term, k| product(term, x) / k)
}

/// Returns the sine of `x`, which must be below 1.
fn sin(x: &BigInt) -> BigInt {
    let square = product(x, x);
    series(x.clone(), |term, k| {
        -product(term, &square) / (2 * k * (2 * k + 1))
    })
}

/// Returns the cosine of `x`, which must be below 1.
fn cos(x: &BigInt) -> BigInt {
    let square = product(x, x);
    series(one(), |term, k| {
        -product(term, &square) / (2 * k * (2 * k - 1))
    })
}

/// Returns the natural logarithm, by the series of the inverse hyperbolic tangent of (x - 1) / (x +
/// 1).
fn ln(x: &BigInt) -> BigInt {
    let y: BigInt = ((x - one()) << PLACES) / (x + one());
    let square = product(&y, &y);
    let (mut power, mut sum) = (y.clone(), y);
    for k in 1.. {
        power = product(&power, &square);
        if power == BigInt::ZERO || power == BigInt::from(-1) {
            break;
        }
        sum += &power / (2 * k + 1);
    }
    sum * 2
}

/// Returns the arc tangent of 1 / n with `places` binary digits after the point.
fn atan(n: i64, places: u32) -> BigInt {
    let mut power = (BigInt::from(1) << places) / n;
    let mut sum = power.clone();
    for k in 1.. {
        power /= -n * n;
        if power == BigInt::ZERO {
            break;
        }
        sum += &power / (2 * k + 1);
    }
    sum
}

/// Returns 2 / pi with `places` binary digits after the point, by Machin's formula.
fn two_over_pi(places: u32) -> BigInt {
    let more = places + 64;
    let half_pi: BigInt = 8 * atan(5, more) - 2 * atan(239, more);
    ((BigInt::from(1) << (2 * more)) / half_pi) >> 64u32
}

/// Converts the bits of an `f64`, which must be positive, normal and below 4.
fn exact(bits: u64) -> BigInt {
    let exponent = (bits >> 52) as u32;
    let mantissa = BigInt::from(bits & ((1 << 52) - 1) | (1 << 52));
    (mantissa << PLACES) >> (1075 - exponent)
}

/// Rounds to `places` binary digits after the point, halves away from zero.
fn round(x: &BigInt, places: i64) -> BigInt {
    let drop = i64::from(PLACES) - places;
    if drop <= 0 {
        return x.clone();
    }
    let magnitude = BigInt::from(x.magnitude().clone());
    let rounded: BigInt = ((magnitude >> (drop - 1)) + 1) >> 1;
    let rounded: BigInt = rounded << drop;
    if x.sign() == num_bigint::Sign::Minus {
        -rounded
    } else {
        rounded
    }
}

/// Rounds to a normal `f64`; returns its bits and the remainder.
fn nearest(x: &BigInt) -> (u64, BigInt) {
    if *x == BigInt::ZERO {
        return (0, BigInt::ZERO);
    }
    let places = i64::from(PLACES) + 53 - x.bits() as i64;
    let rounded = round(x, places);
    let magnitude = rounded.magnitude();
    let exponent = magnitude.bits() as i64 - 1 - i64::from(PLACES);
    let shift = magnitude.bits() as i64 - 53;
    let mantissa = if shift >= 0 {
        magnitude >> shift
    } else {
        magnitude << -shift
    };
    let mantissa = u64::try_from(mantissa).unwrap_or_default() & ((1 << 52) - 1);
    let sign = u64::from(rounded.sign() == num_bigint::Sign::Minus) << 63;
    (
        sign | ((exponent + 1023) as u64) << 52 | mantissa,
        x - rounded,
    )
}

fn hex(bits: u64) -> String {
    let part = |shift: u32| bits >> shift & 0xffff;
    format!(
        "0x{:04x}_{:04x}_{:04x}_{:04x}",
        part(48),
        part(32),
        part(16),
        part(0)
    )
}

/// Writes a table with its documentation to `out`.
fn table<const N: usize>(out: &mut String, name: &str, doc: &str, kind: &str, rows: &[[u64; N]]) {
    let row_type = if N == 1 {
        kind.to_owned()
    } else {
        format!("[{kind}; {N}]")
    };
    let _ = writeln!(out, "\n{doc}\n#[rustfmt::skip]");
    let _ = writeln!(
        out,
        "pub(super) static {name}: [{row_type}; {}] = [",
        rows.len()
    );
    let number = |bits: u64| {
        if kind == "f64" {
            format!("f({})", hex(bits))
        } else {
            hex(bits)
        }
    };
    for row in rows {
        let row = row.map(number);
        let _ = match row.len() {
            1 => writeln!(out, "    {},", row[0]),
            // a longer row is wider than a line
            4.. => writeln!(
                out,
                "    [{},\n     {}],",
                row[..2].join(", "),
                row[2..].join(", ")
            ),
            _ => writeln!(out, "    [{}],", row.join(", ")),
        };
    }
    let _ = writeln!(out, "];");
}

/// Returns the source text of `src/math/tables.rs`.
pub(crate) fn generate() -> String {
    let mut out = String::from(
        "//! Tables, generated by `examples/tables.rs`: change that program and run it.\n\n\
         const fn f(bits: u64) -> f64 {\n    f64::from_bits(bits)\n}\n",
    );

    let pair = |x: &BigInt| {
        let (high, rest) = nearest(x);
        [high, nearest(&rest).0]
    };
    let rows: Vec<[u64; 4]> = (0..128)
        .map(|k| {
            let x: BigInt = (BigInt::from(k) << PLACES) / 128;
            let ([s, ss], [c, cc]) = (pair(&sin(&x)), pair(&cos(&x)));
            [s, ss, c, cc]
        })
        .collect();
    let doc = "/// Sine and cosine of k / 128, each followed by its rounding error.";
    table(&mut out, "SIN_COS", doc, "f64", &rows);

    let wide = 1280u32;
    let digits = two_over_pi(wide);
    let words: Vec<[u64; 1]> = (0..wide / 64)
        .map(|i| {
            let word: BigInt = (&digits >> (wide - 64 * (i + 1))) & BigInt::from(u64::MAX);
            [u64::try_from(word).unwrap_or_default()]
        })
        .collect();
    table(
        &mut out,
        "TWO_OVER_PI",
        "/// The digits of 2 / pi in base 2^64.",
        "u64",
        &words,
    );

    let ln2 = ln(&(one() * 2));
    let rows: Vec<[u64; 2]> = (0..128u64)
        .map(|i| {
            let x = exp(&(&ln2 * i / 128));
            let (high, rest) = nearest(&x);
            let tail: BigInt = (rest << PLACES) / exact(high);
            [nearest(&tail).0, high.wrapping_sub(i << 45)]
        })
        .collect();
    let doc = "/// For 2^(i / 128): the relative rounding error of the nearest double, and the double's bits minus\n\
               /// i / 128 in the exponent's place.";
    table(&mut out, "EXP", doc, "u64", &rows);

    let rows: Vec<[u64; 1]> = (0..32u64)
        .map(|i| [nearest(&exp(&(&ln2 * i / 32))).0.wrapping_sub(i << 47)])
        .collect();
    let doc =
        "/// For 2^(i / 32): the bits of the nearest double minus i / 32 in the exponent's place.";
    table(&mut out, "EXP2F", doc, "u64", &rows);

    let rows: Vec<[u64; 2]> = LOG_RECIPROCALS
        .iter()
        .map(|reciprocal| {
            [
                *reciprocal,
                nearest(&round(&-ln(&exact(*reciprocal)), 43)).0,
            ]
        })
        .collect();
    let doc = "/// For each 128th of an octave: a reciprocal, and minus its logarithm, rounded to 43 binary digits.";
    table(&mut out, "LOG", doc, "f64", &rows);

    let rows: Vec<[u64; 3]> = (0..128u64)
        .map(|i| {
            // the middle of an interval: an octave from 0x3fe69555_00000000 on has 128 intervals
            let start = 0x3fe6_9555_0000_0000u64;
            let [low, high] = [i, i + 1].map(|i| exact(start + (i << 45)));
            let centre: BigInt = (low + high) / 2;
            let parts = if centre < one() { 128 } else { 256 };
            let quotient: BigInt = ((one() * parts) << PLACES) / centre;
            let reciprocal = round(&quotient, 0) / parts;
            let log = -ln(&reciprocal);
            let high = round(&log, 43);
            [
                nearest(&reciprocal).0,
                nearest(&high).0,
                nearest(&(log - high)).0,
            ]
        })
        .collect();
    let doc = "/// For `pow`, for each 128th of an octave: a reciprocal, minus its logarithm, rounded to 43 binary\n\
               /// digits, and the rounding error.";
    table(&mut out, "POW_LOG", doc, "f64", &rows);

    let rows: Vec<[u64; 2]> = POWF_RECIPROCALS
        .iter()
        .map(|reciprocal| {
            let log2: BigInt = (-ln(&exact(*reciprocal)) << PLACES) / &ln2;
            [*reciprocal, nearest(&log2).0]
        })
        .collect();
    let doc = "/// For `powf`, for each 16th of an octave: a reciprocal, and minus its logarithm to base 2.";
    table(&mut out, "POWF_LOG2", doc, "f64", &rows);
    out
}

/// The reciprocals 1 / c of `log_data.c` in ARM's optimized routines (MIT), which were found by a
/// search.
#[rustfmt::skip]
const LOG_RECIPROCALS: [u64; 128] = [
    0x3ff7_34f0_c3e0_de9f, 0x3ff7_1378_6a2c_e91f, 0x3ff6_f260_08fa_b5a0, 0x3ff6_d1a6_1f13_8c7d,
    0x3ff6_b149_0bc5_b4d1, 0x3ff6_9147_332f_0cba, 0x3ff6_719f_1822_4223, 0x3ff6_524f_99a5_1ed9,
    0x3ff6_3356_aa8f_24c4, 0x3ff6_14b3_6b9d_dc14, 0x3ff5_f664_52c6_5c4c, 0x3ff5_d867_b591_2c4f,
    0x3ff5_babc_cb5b_90de, 0x3ff5_9d61_f2d9_1a78, 0x3ff5_8056_1246_5687, 0x3ff5_6397_cee7_6bd3,
    0x3ff5_4725_e2a7_7f93, 0x3ff5_2aff_4206_4583, 0x3ff5_0f22_dbb2_bddf, 0x3ff4_f38f_4734_ded7,
    0x3ff4_d843_cfde_2840, 0x3ff4_bd3e_c078_a3c8, 0x3ff4_a27f_c3e0_258a, 0x3ff4_8805_24d4_8434,
    0x3ff4_6dce_1b19_2d0b, 0x3ff4_53d9_d339_1854, 0x3ff4_3a27_44b4_845a, 0x3ff4_20b5_4115_f8fb,
    0x3ff4_0782_da3e_f4b1, 0x3ff3_ee8f_5d57_fe8f, 0x3ff3_d5d9_a00b_4ce9, 0x3ff3_bd60_c010_c12b,
    0x3ff3_a524_2b75_dab8, 0x3ff3_8d22_cd9f_d002, 0x3ff3_755b_c584_7a1c, 0x3ff3_5dce_49ad_36e2,
    0x3ff3_4679_984d_d440, 0x3ff3_2f5c_ceff_cb24, 0x3ff3_1877_75a1_0d49, 0x3ff3_01c8_373e_3990,
    0x3ff2_eb4e_bb95_f841, 0x3ff2_d50a_0219_a9d1, 0x3ff2_bef9_a8b7_fd2a, 0x3ff2_a91c_7a0c_1bab,
    0x3ff2_9372_6014_b530, 0x3ff2_7dfa_5757_a1f5, 0x3ff2_68b3_9b1d_3bbf, 0x3ff2_539d_838f_f5bd,
    0x3ff2_3eb7_aac9_083b, 0x3ff2_2a01_2ba9_40b6, 0x3ff2_1579_96cc_4132, 0x3ff2_0120_1dd2_fc9b,
    0x3ff1_ecf4_494d_480b, 0x3ff1_d8f5_528f_6569, 0x3ff1_c523_1157_7e7c, 0x3ff1_b17c_74cb_26e9,
    0x3ff1_9e01_0c2c_1ab6, 0x3ff1_8ab0_7bb6_70bd, 0x3ff1_778a_25ef_bcb6, 0x3ff1_648d_354c_31da,
    0x3ff1_51b9_9027_5fdd, 0x3ff1_3f0e_a432_d24c, 0x3ff1_2c8b_7210_f9da, 0x3ff1_1a30_28ec_b531,
    0x3ff1_07fb_da84_34af, 0x3ff0_f5ee_0f4e_6bb3, 0x3ff0_e406_5d2a_9fce, 0x3ff0_d244_632c_a521,
    0x3ff0_c0a7_7ce2_981a, 0x3ff0_af2f_83c6_36d1, 0x3ff0_9ddb_98a0_1339, 0x3ff0_8cab_af52_e7df,
    0x3ff0_7b9f_2f4e_28fb, 0x3ff0_6ab5_8c35_8f19, 0x3ff0_59ee_a5ec_f92c, 0x3ff0_4949_cdd1_2c90,
    0x3ff0_38c6_c6f0_ada9, 0x3ff0_2865_1379_32a9, 0x3ff0_1824_27ea_7348, 0x3ff0_0804_0614_b195,
    0x3fef_e01f_f726_fa1a, 0x3fef_a11c_c261_ea74, 0x3fef_6310_b081_992e, 0x3fef_25f6_3cee_adcd,
    0x3fee_e9c8_0391_13e7, 0x3fee_ae80_78cb_b1ab, 0x3fee_741a_a29d_0c9b, 0x3fee_3a91_830a_99b5,
    0x3fee_01e0_0960_9a56, 0x3fed_ca01_e577_bb98, 0x3fed_92f2_0b7c_9103, 0x3fed_5cac_66fb_5cce,
    0x3fed_272c_aa5e_de9d, 0x3fec_f26e_3e6b_2ccd, 0x3fec_be6d_a2a7_7902, 0x3fec_8b26_6d37_086d,
    0x3fec_5894_bd5d_5804, 0x3fec_26b5_33bb_9f8c, 0x3feb_f583_eeec_e73f, 0x3feb_c4fd_75db_96c1,
    0x3feb_951e_0c86_4a28, 0x3feb_65e2_c5ef_3e2c, 0x3feb_3748_67c9_888b, 0x3feb_094b_211d_304a,
    0x3fea_dbe8_85f2_ef7e, 0x3fea_af1d_3160_3da2, 0x3fea_82e6_3fd3_58a7, 0x3fea_5740_ef09_738b,
    0x3fea_2c2a_90ab_4b27, 0x3fea_01a0_1393_f2d1, 0x3fe9_d79f_24db_3c1b, 0x3fe9_ae25_05c7_b190,
    0x3fe9_852e_f297_ce2f, 0x3fe9_5cba_eea4_4b75, 0x3fe9_34c6_9de7_4838, 0x3fe9_0d4f_2f67_52e6,
    0x3fe8_e652_8eff_d79d, 0x3fe8_bfce_9fcc_007c, 0x3fe8_99c0_dabe_c30e, 0x3fe8_7427_aa23_17fb,
    0x3fe8_4f00_acb3_9a08, 0x3fe8_2a49_e865_3e55, 0x3fe8_0601_95f4_0260, 0x3fe7_e225_63e0_a329,
    0x3fe7_beb3_77dc_b5ad, 0x3fe7_9baa_6797_25c2, 0x3fe7_7907_f217_0657, 0x3fe7_56ca_dbd6_130c,
];

/// The reciprocals of `powf_log2_data.c` in ARM's optimized routines.
#[rustfmt::skip]
const POWF_RECIPROCALS: [u64; 16] = [
    0x3ff6_61ec_79f8_f3be, 0x3ff5_71ed_4aaf_883d, 0x3ff4_9539_f0f0_10b0, 0x3ff3_c995_b0b8_0385,
    0x3ff3_0d19_0c88_64a5, 0x3ff2_5e22_7b0b_8ea0, 0x3ff1_bb4a_4a1a_343f, 0x3ff1_2358_f08a_e5ba,
    0x3ff0_953f_4199_00a7, 0x3ff0_0000_0000_0000, 0x3fee_608c_fd9a_47ac, 0x3fec_a4b3_1f02_6aa0,
    0x3feb_2036_576a_fce6, 0x3fe9_c2d1_63a1_aa2d, 0x3fe8_86e6_0378_41ed, 0x3fe7_67dc_f553_4862,
];
