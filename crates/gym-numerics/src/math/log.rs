//! Logarithms: `ln` after ARM's optimized routines (`log.c`, MIT), `ln_1p` after fdlibm
//! (`s_log1p.c`), as glibc computes them.

use super::Fma;
use super::tables::LOG;

/// ln 2 in two parts; the first has 43 binary digits after the point.
pub(super) const LN2: [f64; 2] = [
    f64::from_bits(0x3fe6_2e42_fefa_3800),
    f64::from_bits(0x3d2e_f357_93c7_6730),
];
/// The start of the octave to which arguments are reduced.
const START: u64 = 0x3fe6_0000_0000_0000;
/// Coefficients of x^2 to x^6 of ln(1 + x), for |x| <= 1 / 256.
const A: [f64; 5] = [
    f64::from_bits(0xbfe0_0000_0000_0001),
    f64::from_bits(0x3fd5_5555_5551_305b),
    f64::from_bits(0xbfcf_ffff_ffeb_4590),
    f64::from_bits(0x3fc9_99b3_24f1_0111),
    f64::from_bits(0xbfc5_5575_e506_c89f),
];
/// Coefficients of x^2 to x^12 of ln(1 + x), for |x| <= 1 / 16.
const B: [f64; 11] = [
    -0.5,
    f64::from_bits(0x3fd5_5555_5555_5577),
    f64::from_bits(0xbfcf_ffff_ffff_fdcb),
    f64::from_bits(0x3fc9_9999_9995_dd0c),
    f64::from_bits(0xbfc5_5555_5567_45a7),
    f64::from_bits(0x3fc2_4924_a344_de30),
    f64::from_bits(0xbfbf_ffff_a442_3d65),
    f64::from_bits(0x3fbc_7184_282a_d6ca),
    f64::from_bits(0xbfb9_99eb_43b0_68ff),
    f64::from_bits(0x3fb7_8182_f7af_d085),
    f64::from_bits(0xbfb5_5213_75d1_45cd),
];

/// Returns the natural logarithm.
#[inline(always)]
pub(super) fn ln<F: Fma>(x: f64) -> f64 {
    const LOW: f64 = 1.0 - 0.0625;
    const HIGH: f64 = 1.0 + f64::from_bits(0x3fb0_9000_0000_0000);
    if (LOW..HIGH).contains(&x) {
        return near_one::<F>(x);
    }
    let mut bits = x.to_bits();
    if !(f64::MIN_POSITIVE..f64::INFINITY).contains(&x) {
        if x == 0.0 {
            return f64::NEG_INFINITY;
        }
        if !(x > 0.0 && x < f64::INFINITY) {
            return if x > 0.0 { x } else { f64::NAN };
        }
        bits = (x * 2f64.powi(52)).to_bits().wrapping_sub(52 << 52);
    }
    let offset = bits.wrapping_sub(START);
    let [reciprocal, log] = LOG[(offset >> 45) as usize & 127];
    let k = (offset.cast_signed() >> 52) as f64;
    let z = f64::from_bits(bits.wrapping_sub(offset & 0xfff << 52));
    let r = F::fma(z, reciprocal, -1.0);
    let w = F::fma(k, LN2[0], log);
    let high = w + r;
    let low = F::fma(k, LN2[1], w - high + r);
    let r2 = r * r;
    let p = F::fma(r2, F::fma(r, A[4], A[3]), F::fma(r, A[2], A[1]));
    F::fma(r * r2, p, F::fma(r2, A[0], low)) + high
}

#[inline(always)]
fn near_one<F: Fma>(x: f64) -> f64 {
    let r = x - 1.0;
    let r2 = r * r;
    let r3 = r * r2;
    let three = |b: &[f64]| F::fma(r2, b[2], F::fma(r, b[1], b[0]));
    let p = F::fma(
        r3,
        F::fma(r3, F::fma(r3, B[10], three(&B[7..10])), three(&B[4..7])),
        three(&B[1..4]),
    );
    let scaled = r * 134_217_728.0;
    let r_high = r + scaled - scaled;
    let r_low = r - r_high;
    let w = r_high * r_high * B[0];
    let high = r + w;
    let low = r - high + w;
    let low = F::fma(B[0] * r_low, r_high + r, low);
    F::fma(r3, p, low) + high
}

/// Coefficients of z^1 to z^7 of ln(1 + f) = 2 s + s R(z), with s = f / (2 + f) and z = s^2.
const L: [f64; 7] = [
    f64::from_bits(0x3fe5_5555_5555_5593),
    f64::from_bits(0x3fd9_9999_9997_fa04),
    f64::from_bits(0x3fd2_4924_9422_9359),
    f64::from_bits(0x3fcc_71c5_1d8e_78af),
    f64::from_bits(0x3fc7_4664_96cb_03de),
    f64::from_bits(0x3fc3_9a09_d078_c69f),
    f64::from_bits(0x3fc2_f112_df3e_5244),
];
/// ln 2 in two parts; the first has 32 bits.
pub(super) const LN2_SHORT: [f64; 2] = [
    f64::from_bits(0x3fe6_2e42_fee0_0000),
    f64::from_bits(0x3dea_39ef_3579_3c76),
];

/// Returns the natural logarithm of 1 + x.
#[inline(always)]
pub(super) fn ln_1p<F: Fma>(x: f64) -> f64 {
    if !(x > -1.0 && x < f64::INFINITY) {
        return if x == -1.0 {
            f64::NEG_INFINITY
        } else if x > 0.0 {
            x
        } else {
            f64::NAN
        };
    }
    let magnitude = x.abs();
    if magnitude < 2f64.powi(-29) {
        return if magnitude < 2f64.powi(-54) {
            x
        } else {
            F::fma(-(x * x), 0.5, x)
        };
    }
    // 1 + x = 2^k (1 + f), where the high 32 bits of 1 + f are between the square roots of 1/2 and
    // 2; `c` is the rounding error, relative to 1 + x
    let high_word = |x: f64| (x.to_bits() >> 32) as u32;
    let (k, f, c) = if high_word(x) < 0x3fda_827a || (x < 0.0 && high_word(x) <= 0xbfd2_bec3) {
        (0, x, 0.0)
    } else {
        let (sum, k, c) = if high_word(x) < 0x4340_0000 || x < 0.0 {
            let sum = 1.0 + x;
            let k = (sum.to_bits() >> 52) as i64 - 1023;
            let c = if k > 0 {
                1.0 - (sum - x)
            } else {
                x - (sum - 1.0)
            };
            (sum, k, c / sum)
        } else {
            (x, (x.to_bits() >> 52) as i64 - 1023, 0.0)
        };
        let mantissa = sum.to_bits() & ((1 << 52) - 1);
        let upper = (mantissa >> 32) as u32 >= 0x6_a09e;
        let (k, exponent) = if upper {
            (k + 1, 0x3fe << 52)
        } else {
            (k, 0x3ff << 52)
        };
        (k, f64::from_bits(mantissa | exponent) - 1.0, c)
    };
    let hfsq = 0.5 * f * f;
    let n = k as f64;
    if k != 0 && f.abs() < 2f64.powi(-20) {
        let c = F::fma(n, LN2_SHORT[1], c);
        if f == 0.0 {
            return F::fma(n, LN2_SHORT[0], c);
        }
        let r = hfsq * F::fma(-2.0 / 3.0, f, 1.0);
        return F::fma(n, LN2_SHORT[0], -((r - c) - f));
    }
    let s = f / (2.0 + f);
    let z = s * s;
    let z2 = z * z;
    let pair = |i: usize| F::fma(z, L[i + 1], L[i]);
    let r = F::fma(
        z2 * z2 * z2,
        pair(5),
        F::fma(z2 * z2, pair(3), F::fma(z, L[0], z2 * pair(1))),
    );
    let p = s * (hfsq + r);
    if k == 0 {
        return f - (hfsq - p);
    }
    let c = F::fma(n, LN2_SHORT[1], c);
    F::fma(n, LN2_SHORT[0], -((hfsq - (p + c)) - f))
}
