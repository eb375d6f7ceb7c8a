//! numpy's `arcsinh` on a CPU with AVX-512: Intel's vector library, which numpy contains.
//!
//! `ln(x + sqrt(1 + x^2))`, with the square root from the CPU's approximate reciprocal root and a
//! correction, and the logarithm from a reciprocal of five bits, a table and a polynomial. The last
//! bit differs from the C library's for one number in twenty.
//!
//! Source of algorithm and constants: `svml_z0_asinh_d_ha.s` of <https://github.com/numpy/SVML>
//! (BSD 3-clause). The approximate reciprocals were measured.

#![expect(
    clippy::disallowed_methods,
    reason = "a fused product is the same on every platform"
)]

/// The inverse hyperbolic sine.
#[must_use]
pub fn arcsinh(number: f64) -> f64 {
    let x = number.abs();
    if x.is_nan() || x.is_infinite() {
        return number;
    }
    let square = x * x;
    if x < 0.0220947265625 {
        return x
            .mul_add(square * polynomial(&SMALL, square), x)
            .copysign(number);
    }
    let (high, low, shift) = if x < 6.703903964971299e+153 {
        let (high, low) = argument(x, square);
        (high, low, 0.0)
    } else {
        (x * 0.125, 0.0, 4.0)
    };
    logarithm(high, low, shift).copysign(number)
}

/// `x + sqrt(1 + x^2)`, and what its rounding leaves out.
fn argument(x: f64, square: f64) -> (f64, f64) {
    let sum = 1.0 + square;
    let root = reciprocal_root(sum);
    let low = f64::min(square, 1.0) - (sum - f64::max(square, 1.0));
    let low = low + x.mul_add(x, -square);
    // the root is `high + low`, and an error relative to it
    let high = sum * root;
    let low = root.mul_add(low, sum.mul_add(root, -high));
    let error = (-root).mul_add(low, (-high).mul_add(root, 1.0));
    let low = polynomial(&ROOT, error).mul_add(high * error, low);
    let whole = high + x;
    let left = x - (whole - high);
    let total = whole + low;
    (total, (low - (total - whole)) + left)
}

/// `ln(high + low)`, `shift` powers of two larger.
fn logarithm(high: f64, low: f64, shift: f64) -> f64 {
    let (reciprocal, exponent, index) = reciprocal(high);
    let exponent = exponent - shift;
    let first = high.mul_add(reciprocal, -1.0);
    let rest = low.mul_add(reciprocal, first);
    let table = (-LN_2_HIGH).mul_add(exponent, TABLE_HIGH[index]);
    let small = (-LN_2_LOW).mul_add(exponent, low.mul_add(reciprocal, TABLE_LOW[index]));
    let whole = first + table;
    let left = first + (table - whole);
    whole + ((rest * rest).mul_add(polynomial(&LOG, rest), small) + left)
}

/// A polynomial, by Horner's rule.
fn polynomial(coefficients: &[f64], x: f64) -> f64 {
    let mut rest = coefficients.iter();
    let first = rest.next().copied().unwrap_or_default();
    rest.fold(first, |sum, next| sum.mul_add(x, *next))
}

/// The CPU's approximate `1 / sqrt(x)` for a normal `x` of at least 1, VRSQRT14PD: 32 linear pieces
/// for each parity of the exponent, of 15 bits of the mantissa.
fn reciprocal_root(x: f64) -> f64 {
    let bits = x.to_bits();
    let exponent = (bits >> 52) as i64 - 1023;
    let odd = (exponent & 1) as usize;
    let mantissa = (bits >> 37 & 0x7fff) as usize;
    let (start, slope) = PIECES[32 * odd + (mantissa >> 10)];
    let along = (mantissa & 0x3ff) as u64;
    let half = (exponent >> 1) as u64;
    let found = if bits << 12 == 0 && odd == 0 {
        1 << 16
    } else {
        (128 * u64::from(start) - u64::from(slope) * along) >> 9
    };
    f64::from_bits(((1022 - half) << 52) + (found << 36))
}

/// `1 / x` rounded to five bits by way of the CPU's VRCP14PD, its exponent, and the four bits after
/// the first.
fn reciprocal(x: f64) -> (f64, f64, usize) {
    let bits = x.to_bits();
    let exponent = (bits >> 52) as i64 - 1023;
    let mantissa = (bits >> 36 & 0xffff) as u16;
    let sixteenths = 16 - FALLS.iter().filter(|fall| mantissa >= **fall).count() as u64;
    let bits = (((1022 - exponent) as u64) << 52) + (sixteenths << 48);
    let exponent = (bits >> 52) as i64 - 1023;
    (
        f64::from_bits(bits),
        exponent as f64,
        (sixteenths % 16) as usize,
    )
}

/// The polynomial for small numbers.
const SMALL: [f64; 3] = [
    -0.04461320260298888,
    0.07499999095181989,
    -0.16666666666578314,
];
/// The correction of the square root, by the relative error.
const ROOT: [f64; 4] = [0.2734375014705118, 0.3125000011459633, 0.375, 0.5];
/// The polynomial of the logarithm.
const LOG: [f64; 9] = [
    -0.10024549070045696,
    0.11133423031841783,
    -0.12499973411222166,
    0.14285695137066726,
    -0.1666666667945777,
    0.20000000006706162,
    -0.24999999999997438,
    0.3333333333333251,
    -0.5,
];
const LN_2_HIGH: f64 = 0.6931471805582987;
const LN_2_LOW: f64 = 1.6465949582866463e-12;
/// The logarithm of the rounded reciprocal, for each of its fractions, negated.
const TABLE_HIGH: [f64; 16] = [
    0.0,
    -0.06062462181671435,
    -0.11778303565643,
    -0.17185025692651834,
    -0.22314355131402408,
    -0.27193371548401046,
    -0.3184537311180975,
    -0.3629054936891407,
    -0.4054651081078191,
    -0.44628710262804816,
    -0.4855078157816024,
    -0.5232481437642491,
    -0.5596157879353996,
    -0.5947071077471264,
    -0.6286086594227527,
    -0.6613984822452039,
];
const TABLE_LOW: [f64; 16] = [
    0.0,
    2.795098818345971e-13,
    4.654729747598445e-14,
    -1.4088127937111135e-13,
    -1.856757095979601e-13,
    3.687042831583768e-13,
    -4.3712191957429144e-13,
    -2.2774076114039556e-13,
    -3.452764795203977e-13,
    -3.713514191959202e-13,
    -9.840465278232627e-14,
    -2.987291820444133e-13,
    -2.3119493838005378e-14,
    4.336393617286218e-13,
    3.785425126545704e-13,
    -1.6108575753932459e-13,
];
/// The mantissas at which the rounded reciprocal falls by one.
const FALLS: [u16; 16] = [
    1039, 3224, 5556, 8048, 10726, 13604, 16707, 20064, 23705, 27670, 32007, 36765, 42010, 47825,
    54300, 61570,
];
/// The start and the slope of each piece of the reciprocal root.
const PIECES: [(u32, u16); 64] = [
    (262121, 1001),
    (254113, 955),
    (246469, 915),
    (239154, 877),
    (232142, 841),
    (225415, 807),
    (218957, 775),
    (212753, 747),
    (206778, 719),
    (201025, 693),
    (195479, 669),
    (190132, 647),
    (184962, 625),
    (179962, 603),
    (175135, 585),
    (170459, 567),
    (165927, 549),
    (161539, 533),
    (157279, 517),
    (153144, 501),
    (149133, 487),
    (145235, 473),
    (141448, 461),
    (137763, 449),
    (134175, 437),
    (130683, 425),
    (127286, 415),
    (123966, 403),
    (120735, 393),
    (117590, 385),
    (114511, 375),
    (111514, 367),
    (108565, 707),
    (102905, 675),
    (97500, 647),
    (92324, 619),
    (87372, 595),
    (82615, 571),
    (78049, 549),
    (73657, 527),
    (69437, 509),
    (65371, 491),
    (61445, 473),
    (57661, 457),
    (54005, 441),
    (50474, 427),
    (47057, 413),
    (43755, 401),
    (40551, 389),
    (37443, 377),
    (34431, 365),
    (31513, 355),
    (28675, 345),
    (25918, 335),
    (23236, 325),
    (20632, 317),
    (18098, 309),
    (15629, 301),
    (13223, 293),
    (10878, 285),
    (8597, 279),
    (6365, 271),
    (4192, 265),
    (2070, 259),
];
