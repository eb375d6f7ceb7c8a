//! Sine and cosine of an `f32`, with the same bits on every platform.
//!
//! The algorithm is glibc's on x86-64 (ARM's optimized routines: reduction to a quarter turn and
//! polynomials, in `f64`). Its result is the same with and without FMA.

/// Polynomial of the sine over ±π/4: x + S1 x³ + S2 x⁵ + S3 x⁷.
const SIN: [f64; 3] = [
    f64::from_bits(0xBFC5_5554_5995_A603),
    f64::from_bits(0x3F81_1076_0523_0BC4),
    f64::from_bits(0xBF29_94EB_3774_CF24),
];
/// Polynomial of the cosine over ±π/4: 1 + C1 x² + C2 x⁴ + C3 x⁶ + C4 x⁸.
const COS: [f64; 4] = [
    f64::from_bits(0xBFDF_FFFF_FD0C_621C),
    f64::from_bits(0x3FA5_5553_E106_8F19),
    f64::from_bits(0xBF56_C087_E89A_359D),
    f64::from_bits(0x3EF9_9343_027B_F8C3),
];
/// 2/π · 2²⁴.
const HALF_TURNS: f64 = f64::from_bits(0x4164_5F30_6DC9_C883);
/// π/2 in two parts whose products with small integers are exact, so the reduction rounds only
/// once, like FMA.
const HALF_PI: [f64; 2] = [
    f64::from_bits(0x3FF9_21FB_5444_2D00),
    f64::from_bits(0x3CF8_0000_0000_0000),
];
/// π/2 · 2⁻⁶².
const HALF_PI_62: f64 = f64::from_bits(0x3C19_21FB_5444_2D18);
/// Digits of 2/π in base 2³²; each word starts 8 bits after the previous one.
const TWO_OVER_PI: [u32; 24] = [
    0xa2, 0xa2f9, 0xa2f983, 0xa2f9836e, 0xf9836e4e, 0x836e4e44, 0x6e4e4415, 0x4e441529, 0x441529fc,
    0x1529fc27, 0x29fc2757, 0xfc2757d1, 0x2757d1f5, 0x57d1f534, 0xd1f534dd, 0xf534ddc0, 0x34ddc0db,
    0xddc0db62, 0xc0db6295, 0xdb629599, 0x6295993c, 0x95993c43, 0x993c4390, 0x3c439041,
];

/// Returns the sine and the cosine of an angle in rad, like the C library's `sinf` and `cosf`.
#[inline]
#[must_use]
pub fn sin_cos(angle: f32) -> (f32, f32) {
    let bits = angle.to_bits() & 0x7fff_ffff;
    let x = f64::from(angle);
    if bits < 0x3f40_0000 {
        // |angle| < 0.75
        if bits < 0x3980_0000 {
            return (angle, 1.0); // |angle| < 2⁻¹²
        }
        return (
            sin_polynomial(x, x * x) as f32,
            cos_polynomial(x * x) as f32,
        );
    }
    let (x, quarter) = if bits < 0x42f0_0000 {
        // |angle| < 120
        let quarter = ((x * HALF_TURNS) as i32 + 0x80_0000) >> 24;
        let n = f64::from(quarter);
        (x - n * HALF_PI[0] - n * HALF_PI[1], quarter)
    } else if bits < 0x7f80_0000 {
        let (x, quarter) = reduce_large(bits);
        if angle < 0.0 {
            (-x, -quarter)
        } else {
            (x, quarter)
        }
    } else {
        return (f32::NAN, f32::NAN);
    };
    let (sin, cos) = (
        sin_polynomial(x, x * x) as f32,
        cos_polynomial(x * x) as f32,
    );
    match quarter & 3 {
        0 => (sin, cos),
        1 => (cos, -sin),
        2 => (-sin, -cos),
        _ => (-cos, sin),
    }
}

#[inline]
fn sin_polynomial(x: f64, x2: f64) -> f64 {
    let x3 = x * x2;
    x + x3 * SIN[0] + x3 * x2 * (SIN[1] + x2 * SIN[2])
}

#[inline]
fn cos_polynomial(x2: f64) -> f64 {
    let x4 = x2 * x2;
    1.0 + x2 * COS[0] + x4 * COS[1] + x4 * x2 * (COS[2] + x2 * COS[3])
}

/// Divides by π/2; returns the remainder and the low bits of the quotient. `bits` are the bits of a
/// positive `f32` of at least 120; its mantissa is multiplied by the relevant digits of 2/π.
fn reduce_large(bits: u32) -> (f64, i32) {
    let digits = &TWO_OVER_PI[(bits >> 26 & 15) as usize..];
    let fraction = (bits & 0xff_ffff | 0x80_0000) << (bits >> 23 & 7);
    let low = (u64::from(fraction) * u64::from(digits[8])) >> 32;
    let high = u64::from(fraction.wrapping_mul(digits[0])) << 32;
    let product = (high | low).wrapping_add(u64::from(fraction) * u64::from(digits[4]));
    let quarter = product.wrapping_add(1 << 61) >> 62;
    (
        (product.wrapping_sub(quarter << 62)).cast_signed() as f64 * HALF_PI_62,
        quarter as i32,
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Results of `sinf` and `cosf` in glibc 2.36.
    #[test]
    fn equals_glibc() {
        for (angle, sin, cos) in GLIBC {
            let (s, c) = sin_cos(f32::from_bits(angle));
            assert_eq!(
                (s.to_bits(), c.to_bits()),
                (sin, cos),
                "angle {}",
                f32::from_bits(angle)
            );
        }
        assert!(sin_cos(f32::INFINITY).0.is_nan());
    }

    /// Bits of an angle, its sine and its cosine.
    const GLIBC: [(u32, u32, u32); 20] = [
        (0x3f000000, 0x3ef57744, 0x3f60a940),
        (0x3f400000, 0x3f2e7fe1, 0x3f3b4ff6),
        (0x3f490fdb, 0x3f3504f3, 0x3f3504f3),
        (0x3f800000, 0x3f576aa4, 0x3f0a5140),
        (0xbfc90fdb, 0xbf800000, 0xb33bbd2e),
        (0x40490fdb, 0xb3bbbd2e, 0xbf800000),
        (0x40a00000, 0xbf757c10, 0x3e913c2c),
        (0xc1200000, 0x3f0b44f8, 0xbf56cd64),
        (0x41a3d70a, 0x3f7f8b74, 0xbd742ba4),
        (0x42b60000, 0x3dd90ffb, 0xbf7e8ede),
        (0x42efffff, 0x3f14a287, 0x3f506e74),
        (0x42f00000, 0x3f14a2ef, 0x3f506e2a),
        (0xc2f60000, 0x3eeb7878, 0xbf6351ee),
        (0x447a0000, 0x3f53ae61, 0x3f0ff813),
        (0x49742400, 0xbeb33259, 0x3f6fcefd),
        (0x7f7fffff, 0xbf0599b3, 0x3f5a5f96),
        (0x39800000, 0x39800000, 0x3f800000),
        (0x39000000, 0x39000000, 0x3f800000),
        (0xbdcccccd, 0xbdcc7577, 0x3f7eb898),
        (0x41e6b021, 0xbf08584f, 0xbf58ab9e),
    ];
}
