//! `exp_m1` and `tanh`, after fdlibm (`s_expm1.c`, `s_tanh.c`), as glibc computes them.

use super::Fma;
use super::log::LN2_SHORT;

/// Coefficients of z^1 to z^5 of the rational part of e^x - 1, with z = x^2 / 2.
const Q: [f64; 5] = [
    f64::from_bits(0xbfa1_1111_1111_10f4),
    f64::from_bits(0x3f5a_01a0_19fe_5585),
    f64::from_bits(0xbf14_ce19_9eaa_dbb7),
    f64::from_bits(0x3ed0_cfca_86e6_5239),
    f64::from_bits(0xbe8a_fdb7_6e09_c32d),
];

/// Returns e^x - 1.
#[inline(always)]
pub(super) fn exp_m1<F: Fma>(x: f64) -> f64 {
    let high_word = (x.to_bits() >> 32) as u32 & 0x7fff_ffff;
    if high_word >= 0x4043_687a {
        // at least 56 ln 2
        if x.is_nan() {
            return x;
        }
        if x < 0.0 {
            return -1.0;
        }
        if x > 709.782_712_893_384 {
            return f64::INFINITY;
        }
    }
    if high_word < 0x3c90_0000 {
        return x; // below 2^-54
    }
    // x = k ln 2 + r, and `c` is the rounding error of `r`
    let (k, r, c) = if high_word > 0x3fd6_2e42 {
        let (high, low, k) = if high_word < 0x3ff0_a2b2 {
            let sign = 1f64.copysign(x);
            (x - sign * LN2_SHORT[0], sign * LN2_SHORT[1], sign as i32)
        } else {
            let k = F::fma(std::f64::consts::LOG2_E, x, 0.5f64.copysign(x)) as i32;
            let n = f64::from(k);
            (F::fma(-n, LN2_SHORT[0], x), n * LN2_SHORT[1], k)
        };
        let r = high - low;
        (k, r, (high - r) - low)
    } else {
        (0, x, 0.0)
    };
    let half = 0.5 * r;
    let z = r * half;
    let z2 = z * z;
    let first = F::fma(z, Q[0], 1.0);
    let second = F::fma(z, Q[2], Q[1]);
    let third = F::fma(z, Q[4], Q[3]);
    let r1 = F::fma(z2 * z2, third, F::fma(z2, second, first));
    let t = F::fma(-r1, half, 3.0);
    let e = z * ((r1 - t) / F::fma(-r, t, 6.0));
    if k == 0 {
        return r - F::fma(r, e, -z);
    }
    let e = F::fma(r, e - c, -c) - z;
    match k {
        -1 => F::fma(0.5, r - e, -0.5),
        1 if r < -0.25 => -2.0 * (e - (r + 0.5)),
        1 => F::fma(2.0, r - e, 1.0),
        _ => {
            let add = |y: f64| {
                f64::from_bits(
                    y.to_bits()
                        .wrapping_add((i64::from(k) << 52).cast_unsigned()),
                )
            };
            if k <= -2 || k > 56 {
                return add(1.0 - (e - r)) - 1.0;
            }
            if k < 20 {
                let t = 1.0 - f64::from_bits(((1023 - i64::from(k)) << 52).cast_unsigned());
                add(t - (e - r))
            } else {
                let t = f64::from_bits(((1023 - i64::from(k)) << 52).cast_unsigned());
                add(r - (e + t) + 1.0)
            }
        }
    }
}

/// Returns the hyperbolic tangent.
#[inline(always)]
pub(super) fn tanh<F: Fma>(x: f64) -> f64 {
    let magnitude = x.abs();
    if x.is_nan() {
        return x;
    }
    let z = if magnitude >= 22.0 {
        1.0
    } else if magnitude < 2f64.powi(-55) {
        return x * (1.0 + x);
    } else if magnitude >= 1.0 {
        1.0 - 2.0 / (exp_m1::<F>(2.0 * magnitude) + 2.0)
    } else {
        let t = exp_m1::<F>(-2.0 * magnitude);
        -t / (t + 2.0)
    };
    if x < 0.0 { -z } else { z }
}
