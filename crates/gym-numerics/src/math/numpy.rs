//! Functions for which numpy does not use the C library.

use super::fma::fma_f32;
use super::trig_f32;

/// `np.sin` and `np.cos` of a `float32`: numpy's own polynomials (error at most 1.5 ulp), evaluated
/// with FMA. Source: numpy 2, `loops_trigonometric.dispatch.cpp`.
#[must_use]
pub fn sin_cos(x: f32) -> (f32, f32) {
    /// Above this magnitude, numpy calls the C library.
    const MAX: f32 = 71_476.06;
    #[expect(
        clippy::approx_constant,
        reason = "the first part has fewer digits than the constant"
    )]
    /// -pi/2 in three parts, for Cody and Waite's reduction.
    const MINUS_PI_2: [f32; 3] = [-1.570_796, -3.139_164_7e-7, -5.390_302_5e-15];
    const TWO_OVER_PI: f32 = 0.636_619_75;
    // coefficients from the highest power down: x^9, x^7, x^5, x^3 and x^8, x^6, x^4, x^2, 1
    const SIN: [f32; 4] = [
        2.840_409_7e-6,
        -0.000_198_564_91,
        0.008_333_397,
        -0.166_666_67,
    ];
    const COS: [f32; 5] = [2.437_226_6e-5, -0.001_388_652, 0.041_666_62, -0.5, 1.0];

    if x.abs() > MAX {
        return trig_f32::sin_cos(x);
    }
    // adding and subtracting 1.5 * 2^23 rounds to the nearest integer
    const ROUND: f32 = 12_582_912.0;
    let quadrant = fma_f32(x, TWO_OVER_PI, ROUND) - ROUND;
    let r = MINUS_PI_2
        .iter()
        .fold(x, |r, part| fma_f32(quadrant, *part, r));
    let r2 = r * r;
    let sin = SIN.iter().fold(0.0, |sum: f32, c| fma_f32(sum, r2, *c));
    let sin = fma_f32(sin * r2, r, r);
    let cos = COS.iter().fold(0.0, |sum: f32, c| fma_f32(sum, r2, *c));
    match quadrant as i32 & 3 {
        0 => (sin, cos),
        1 => (cos, -sin),
        2 => (-sin, -cos),
        _ => (-cos, sin),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Bits of argument, sine and cosine where numpy 2.4.6 differs from the correctly rounded
    /// result.
    #[test]
    fn single_precision_sine_and_cosine_are_numpys() {
        const CASES: [[u32; 3]; 7] = [
            [0x3d8c8c12, 0x3d8c6fd6, 0x3f7f65bc],
            [0x3dbab5f1, 0x3dba73c2, 0x3f7eefd6],
            [0x3da6daec, 0x3da6abaf, 0x3f7f269d],
            [0xbdcbe560, 0xbdcb8f30, 0x3f7ebb79],
            [0xc0137b2f, 0xbf3e2639, 0xbf2b675c],
            [0x402d9fdb, 0x3ed4d674, 0xbf68d526],
            [0xc03df688, 0xbe30b1a2, 0xbf7c28fb],
        ];
        for [x, sin, cos] in CASES {
            let (got_sin, got_cos) = sin_cos(f32::from_bits(x));
            assert_eq!((got_sin.to_bits(), got_cos.to_bits()), (sin, cos));
        }
    }
}
