//! Functions for which numpy uses Intel's vector library on a CPU with AVX-512, such as
//! `np.exp`, whose results differ from glibc's in the last bit for a twentieth of all arguments.
//!
//! Source: `numpy/SVML`, `linux/avx512` (3-clause BSD licence), `svml_z0_exp_d_ha`,
//! `svml_z0_log1p_d_ha`, `svml_z0_atan2_d_ha`, `svml_z0_acos_d_ha`. Tables and coefficients are given as bits.

use super::{Fma, arc, exp as glibc, log};

const fn f(bits: u64) -> f64 {
    f64::from_bits(bits)
}

/// 2^(i/16): the nearest number, and the remainder divided by that number.
const POWERS: [[u64; 2]; 16] = [
    [0x3ff0_0000_0000_0000, 0],
    [0x3ff0_b558_6cf9_890f, 0x3c97_9aa6_5d83_7b6d],
    [0x3ff1_72b8_3c7d_517b, 0xbc80_1b15_eaa5_9348],
    [0x3ff2_387a_6e75_6238, 0x3c96_8efd_e3a8_a894],
    [0x3ff3_06fe_0a31_b715, 0x3c83_4d75_4db0_abb6],
    [0x3ff3_dea6_4c12_3422, 0x3c85_9f48_a72a_4c6d],
    [0x3ff4_bfda_d536_2a27, 0x3c76_90ce_bb7a_afb0],
    [0x3ff5_ab07_dd48_5429, 0x3c90_63e1_e21c_5409],
    [0x3ff6_a09e_667f_3bcd, 0xbc93_b3ef_bf5e_2228],
    [0x3ff7_a114_73eb_0187, 0xbc7b_32dc_b94d_a51d],
    [0x3ff8_ace5_422a_a0db, 0x3c8d_b72f_c1f0_eab4],
    [0x3ff9_c491_82a3_f090, 0x3c71_affc_2b91_ce27],
    [0x3ffa_e89f_995a_d3ad, 0x3c8c_1a77_92cb_3387],
    [0x3ffc_199b_dd85_529c, 0x3c73_6eae_30af_0cb3],
    [0x3ffd_5818_dcfb_a487, 0x3c74_a385_a63d_07a7],
    [0x3ffe_a4af_a2a4_90da, 0xbc8f_f712_8fd3_91f0],
];

/// `np.exp`.
#[inline(always)]
pub(super) fn exp<F: Fma>(x: f64) -> f64 {
    /// For magnitudes from this number on, another function computes the result.
    const RARE: f64 = f(0x4086_1da0_4cba_fe44);
    /// 3 * 2^46 + 1023: adding it rounds to a multiple of 1/16.
    const SHIFT: f64 = f(0x42f8_0000_0000_3ff0);
    const INVERSE: f64 = f(0x3ff7_1547_652b_82fe);
    const LN2: [f64; 2] = [f(0x3fe6_2e42_fefa_39ef), f(0x3c7a_bc9e_3b39_803f)];
    /// The coefficients of r^6 to r.
    const C: [f64; 6] = [
        f(0x3f57_4118_3694_0c04),
        f(0x3f81_101c_bbc2_65c0),
        f(0x3fa5_5557_242d_68fe),
        f(0x3fc5_5555_5393_9732),
        f(0x3fe0_0000_0000_d008),
        f(0x3fef_ffff_ffff_ff70),
    ];
    if x.is_nan() || x.abs() >= RARE {
        return glibc::exp::<F>(x);
    }
    // rounded towards zero
    let nearest = F::fma(x, INVERSE, SHIFT);
    let above = F::fma(x, INVERSE, SHIFT - nearest) < 0.0;
    let shifted = f(nearest.to_bits() - u64::from(above));
    let n = shifted - SHIFT;
    let r = F::fma(-n, LN2[1], F::fma(-n, LN2[0], x));
    let r2 = r * r;
    let high = F::fma(F::fma(C[0], r, C[1]), r2, F::fma(C[2], r, C[3]));
    let p = F::fma(high, r2, F::fma(C[4], r, C[5]));
    let [power, rest] = POWERS[shifted.to_bits() as usize & 15].map(f);
    let scaled = F::fma(power, F::fma(p, r, rest), power);
    // the result is not subnormal, because |n| < 1021
    scaled * f(((n.floor() as i64 + 1023) as u64) << 52)
}

/// -ln of the rounded inverses of numbers from 1 to 2, indexed by the first four fraction bits: a
/// number with few bits, and the remainder.
const LOGARITHMS: [[u64; 2]; 16] = [
    [0, 0],
    [0xbfaf_0a30_c012_0000, 0x3d53_ab33_d066_d1d2],
    [0xbfbe_2707_6e2b_0000, 0x3d2a_342c_2af0_003c],
    [0xbfc5_ff30_70a7_8000, 0xbd43_d3c8_73e2_0a07],
    [0xbfcc_8ff7_c79a_8000, 0xbd4a_21ac_25d8_1ef3],
    [0xbfd1_675c_abab_c000, 0x3d59_f1fc_6338_2a8f],
    [0xbfd4_618b_c21c_4000, 0xbd5e_c27d_0b7b_37b3],
    [0xbfd7_39d7_f6bb_c000, 0xbd50_069c_e24c_53fb],
    [0x3fd2_6962_1134_c000, 0x3d5b_9278_3beb_7677],
    [0x3fcf_991c_6cb3_8000, 0x3d59_bcbe_cca0_cdf3],
    [0x3fca_93ed_3c8b_0000, 0xbd53_0e48_6a0a_c42d],
    [0x3fc5_bf40_6b54_0000, 0x3d5e_d8fd_c149_767e],
    [0x3fc1_178e_8228_0000, 0xbd4b_8421_cc74_be04],
    [0x3fb9_335e_5d59_0000, 0x3d52_622b_8757_a8fb],
    [0x3fb0_8598_b59e_0000, 0x3d4d_0344_51fe_cdfb],
    [0x3fa0_415d_89e8_0000, 0xbd57_7771_fd18_7145],
];

/// The largest numbers from 1 to 2 whose approximate inverse (the CPU's instructions `vrcp14pd` and
/// `vrndscalepd`) is rounded to 32/32, 31/32, and so on. Each entry has the upper 28 bits of the
/// number.
const INVERSES: [u32; 16] = [
    0x3ff_040e, 0x3ff_0c96, 0x3ff_15b3, 0x3ff_1f6f, 0x3ff_29e5, 0x3ff_3522, 0x3ff_4142, 0x3ff_4e5e,
    0x3ff_5c98, 0x3ff_6c14, 0x3ff_7d06, 0x3ff_8f9b, 0x3ff_a419, 0x3ff_bacf, 0x3ff_d41b, 0x3ff_f07f,
];

/// `np.log1p`.
#[inline(always)]
pub(super) fn ln_1p<F: Fma>(x: f64) -> f64 {
    const LN2: [f64; 2] = [f(0x3fe6_2e42_fefa_0000), f(0x3d7c_f79a_bc9e_0000)];
    /// The coefficients of r^9 to r^2.
    const C: [f64; 8] = [
        f(0x3fbc_81cd_309d_7c70),
        f(0xbfc0_0735_7e93_af62),
        f(0x3fc2_4922_9cee_81ef),
        f(0xbfc5_5553_fb28_db06),
        f(0x3fc9_9999_99cc_9f5c),
        f(0xbfd0_0000_000c_05bd),
        f(0x3fd5_5555_5555_5466),
        f(0xbfdf_ffff_ffff_ffc6),
    ];
    let sum = 1.0 + x;
    if !(sum > 0.0 && sum < f64::INFINITY) {
        return log::ln_1p::<F>(x);
    }
    let bits = sum.to_bits();
    let mantissa = f(bits & 0x000f_ffff_ffff_ffff | 0x3ff0_0000_0000_0000);
    let exponent = (bits >> 52) as i64 - 1023;
    let low = x.min(1.0) - (sum - x.max(1.0));
    let low = low * f(((1023 - exponent) as u64) << 52);
    let lead = (mantissa.to_bits() >> 36) as u32;
    let above = INVERSES.iter().filter(|last| lead > **last).count();
    let inverse = (32 - above) as f64 / 32.0;
    let exponent = exponent as f64 + f64::from(u8::from(inverse < 0.75));
    let [log_high, log_low] = LOGARITHMS[(inverse.to_bits() >> 48) as usize & 15].map(f);
    let first = F::fma(inverse, mantissa, -1.0);
    let second = inverse * low;
    let r = first + second;
    let rest = log_low + (second - (r - first));
    let r2 = r * r;
    let nine_to_six = F::fma(F::fma(C[0], r, C[1]), r2, F::fma(C[2], r, C[3]));
    let five_to_two = F::fma(F::fma(C[4], r, C[5]), r2, F::fma(C[6], r, C[7]));
    let p = F::fma(nine_to_six, r2 * r2, five_to_two);
    let base = F::fma(exponent, LN2[0], log_high);
    let main = base + r;
    let p = F::fma(p, r2, r - (main - base));
    let result = main + (p + F::fma(exponent, LN2[1], rest));
    // a result of 0 has the sign of `x`
    f(result.to_bits() | x.to_bits() & 1 << 63)
}

/// For a slope above a limit, the angle is computed relative to the angle of a reference slope.
/// Each row: the limit, the reference slope, its angle, and the remainder of the angle. The last
/// reference slope is vertical.
const SLOPES: [[u64; 4]; 4] = [
    [
        0x3fdc_0000_0000_0000,
        0x3fe0_0000_0000_0000,
        0x3fdd_ac67_0561_bb4f,
        0x3c7a_2b7f_222f_65e2,
    ],
    [
        0x3fe6_0000_0000_0000,
        0x3ff0_0000_0000_0000,
        0x3fe9_21fb_5444_2d18,
        0x3c81_a626_3314_5c07,
    ],
    [
        0x3ff3_0000_0000_0000,
        0x3ff8_0000_0000_0000,
        0x3fef_730b_d281_f69b,
        0x3c70_0788_7af0_cbbd,
    ],
    [
        0x4003_8000_0000_0000,
        0x3ff0_0000_0000_0000,
        0x3ff9_21fb_5444_2d18,
        0x3c91_a626_3314_5c07,
    ],
];

/// `np.arctan2`.
#[inline(always)]
pub(super) fn atan2<F: Fma>(y: f64, x: f64) -> f64 {
    const PI: [f64; 2] = [f(0x4009_21fb_5444_2d18), f(0x3ca1_a640_0000_0000)];
    /// The coefficients of the even powers of r, from r^24 to r^2.
    const C: [f64; 12] = [
        f(0x3f8b_e4fb_e673_3718),
        f(0xbfa0_4cd7_1f92_185e),
        f(0x3fa6_ad55_58fe_19c9),
        f(0xbfaa_9e75_5ca1_3d23),
        f(0x3fae_12f1_edf7_c393),
        f(0xbfb1_108d_326c_68ed),
        f(0x3fb3_b132_b731_e73a),
        f(0xbfb7_45d1_1967_7a4f),
        f(0x3fbc_71c7_19f9_9f96),
        f(0xbfc2_4924_9244_1a21),
        f(0x3fc9_9999_9999_8f43),
        f(0xbfd5_5555_5555_5552),
    ];
    let (over, along) = (y.abs(), x.abs());
    let usual = |length: f64| (2f64.powi(-1020)..2f64.powi(989)).contains(&length);
    if !(usual(over) && usual(along)) {
        return arc::atan2::<F>(y, x);
    }
    let beyond = SLOPES.iter().filter(|[limit, ..]| along * f(*limit) < over);
    let (numerator, denominator, angle, rest) = match beyond.count().checked_sub(1) {
        None => (over, along, 0.0, 0.0),
        Some(i) => {
            let [_, slope, angle, rest] = SLOPES[i].map(f);
            let (over_part, along_part) = if i == 3 { (0.0, 0.0) } else { (over, along) };
            let numerator = F::fma(-slope, along, over_part);
            (numerator, F::fma(slope, over, along_part), angle, rest)
        }
    };
    // SVML uses the CPU's approximate inverse with two Newton steps, which differs from this
    // quotient only in the last bits
    let inverse = 1.0 / denominator;
    let r = inverse * numerator;
    let r2 = r * r;
    let r4 = r2 * r2;
    let mut rest = F::fma(-r, denominator, numerator) * inverse + rest;
    let sum = |first: usize| {
        C.iter()
            .skip(first)
            .step_by(2)
            .fold(0.0, |sum, c| F::fma(sum, r4, *c))
    };
    let p = F::fma(sum(0), r2, sum(1)) * r2;
    let left = x < 0.0;
    if left {
        rest -= PI[1];
    }
    let mut result = r + F::fma(p, r, rest);
    result += angle;
    if left {
        result = PI[0] - result;
    }
    f(result.to_bits() | y.to_bits() & 1 << 63)
}

/// `np.arccos`.
#[inline(always)]
pub(super) fn acos<F: Fma>(x: f64) -> f64 {
    const PI: [f64; 2] = [f(0x4009_21fb_5444_2d18), f(0x3ca1_a626_3314_5c07)];
    /// The coefficients of e^3 to 1 in the correction of a square root.
    const ROOT: [f64; 4] = [
        f(0xbf91_8000_993b_24c3),
        f(0x3fa4_0000_6f70_d42d),
        f(0xbfb7_ffff_ffff_fe97),
        f(0x3fcf_ffff_ffff_ff9d),
    ];
    /// The coefficients of z^12 to z.
    const C: [f64; 12] = [
        f(0x3fa0_7520_c70e_b909),
        f(0xbf90_fb17_f7db_b0ed),
        f(0x3f94_3f44_bfbc_3bae),
        f(0x3f7a_5833_95d4_5ed5),
        f(0x3f88_f8dc_2afc_cad6),
        f(0x3f8c_6dbb_cb88_bd57),
        f(0x3f91_c6dc_f538_ad2e),
        f(0x3f96_e89c_ebde_fadd),
        f(0x3f9f_1c72_e13a_d8be),
        f(0x3fa6_db6d_b3b4_45f8),
        f(0x3fb3_3333_3337_e0de),
        f(0x3fc5_5555_5555_529c),
    ];
    let length = x.abs();
    if length.is_nan() || length > 1.0 {
        return f64::NAN;
    }
    let sign = x.to_bits() & 1 << 63;
    let signed = |number: f64| f(number.to_bits() ^ sign);
    let half = F::fma(-length, 0.5, 0.5);
    let z = (length * length).min(half);
    // the asine of `-length`, or of the square root of `half`, and the angle to which it is added
    let (mut arc, mut rest, mut angle) = (-length, 0.0, [PI[0] / 2.0, PI[1] / 2.0]);
    if z >= half {
        // SVML uses the CPU's approximation (`vrsqrt14pd`), which differs from this one for some
        // numbers, and then the result for one in a thousand
        let inverse = if half < f(0x3000_0000_0000_0000) {
            0.0
        } else {
            f(((1.0 / half.sqrt()).to_bits() + (1 << 38)) & !((1 << 39) - 1))
        };
        let double = half + half;
        arc = inverse * double;
        let e = F::fma(inverse * inverse, double, -2.0);
        let p = F::fma(F::fma(F::fma(ROOT[0], e, ROOT[1]), e, ROOT[2]), e, ROOT[3]);
        rest = F::fma(arc * e, p, -F::fma(inverse, double, -arc));
        angle = if x < 0.0 { PI } else { [0.0; 2] };
    }
    let z2 = z * z;
    let high = F::fma(F::fma(C[0], z, C[1]), z2, F::fma(C[2], z, C[3]));
    let low = F::fma(F::fma(C[4], z, C[5]), z2, F::fma(C[6], z, C[7]));
    let p = F::fma(F::fma(high, z2 * z2, low), z2, F::fma(C[8], z, C[9]));
    let p = F::fma(F::fma(p, z, C[10]), z, C[11]) * z;
    signed(F::fma(arc - rest, p, signed(angle[1]) - rest) + arc) + angle[0]
}

#[cfg(test)]
mod tests {
    use super::super::{Emulated, Hardware, numpy_acos, numpy_atan2, numpy_exp, numpy_ln_1p};
    use super::*;

    /// Bits of arguments and results where numpy 2.4.6 with AVX-512 differs from glibc.
    const EXP: [[u64; 2]; 8] = [
        [0xc051_abb9_04a6_84f7, 0x3990_49bf_957b_bb10],
        [0xbf53_4e3d_7cd9_035c, 0x3fef_f65a_55d1_2696],
        [0xbfd3_3e7c_7151_5a4c, 0x3fe7_b09a_9471_ae07],
        [0xbf29_8b04_faa2_7151, 0x3fef_fe67_59e1_f450],
        [0xc082_cab3_0bda_6222, 0x09b5_e8cf_7bdf_faf6],
        [0xc077_042d_b462_b36c, 0x1eba_3301_6d68_0d82],
        [0xbeed_46df_5e7a_4b3d, 0x3fef_ffe2_b92e_060a],
        [0xc067_3e35_2507_8a8c, 0x2f2a_b6d1_b271_06ba],
    ];
    const LN_1P: [[u64; 2]; 8] = [
        [0x4046_4916_15b3_6e17, 0x400e_8dde_161f_8e93],
        [0x401f_b377_c74a_f4b8, 0x4001_82d6_794c_6a71],
        [0x405c_5e46_3f86_4f6c, 0x4012_f61b_8275_fb21],
        [0x4023_9142_cbdb_f7dd, 0x4003_0638_37ff_dcb7],
        [0x4084_c0c1_1386_474c, 0x4019_ffed_55bc_4357],
        [0x3fb7_79ff_660a_6ad6, 0x3fb6_7630_fb66_562d],
        [0x3f42_6630_47c1_4b05, 0x3f42_64dd_e09a_15b6],
        [0x40a7_a5f9_3791_a050, 0x4020_0803_b38e_ae7d],
    ];
    const ATAN2: [[u64; 3]; 6] = [
        [
            0x3ff4_97bf_9ae1_5d56,
            0x3fde_aad8_0fb6_2536,
            0x3ff3_6e22_80c1_bc04,
        ],
        [
            0xbfe3_8f64_30ec_3790,
            0xbfee_37d6_2c74_78f6,
            0xc004_8975_d3df_ace0,
        ],
        [
            0xbfe7_3790_8fa8_44f6,
            0xbfe3_5656_6043_7266,
            0xc002_1f47_7ef4_b3e4,
        ],
        [
            0x3fd3_f774_4b81_0c5d,
            0x3fef_3084_af7a_bc68,
            0x3fd3_d370_edb7_d89a,
        ],
        [
            0xbff9_1c3e_e618_eaad,
            0x3fe2_71a1_db0f_27f3,
            0xbff3_8055_828a_2b80,
        ],
        [
            0x3ff4_c0e6_1616_ab15,
            0xbfd6_94dc_9f0e_fd62,
            0x3ffd_61da_8fce_550a,
        ],
    ];

    // numpy 2.5.5
    const ACOS: [[u64; 2]; 8] = [
        [0xbfe2_bb33_ad4e_5432, 0x4001_91a2_3a83_5cb6],
        [0xbfec_8922_0133_3918, 0x4005_6032_a687_da80],
        [0xbfeb_83dc_024b_0262, 0x4004_d89b_11fb_6238],
        [0xbfe3_8a3e_7362_c674, 0x4001_d238_550a_ef98],
        [0xbfd4_660f_9f47_5af4, 0x3ffe_52ad_67cc_1a60],
        [0x3fdd_94d3_5e12_6904, 0x3ff1_71eb_2324_3ffc],
        [0x3fd2_d2ba_3b3a_3d54, 0x3ff4_5b38_0f71_c482],
        [0xbfd7_c341_75e5_91e8, 0x3fff_381a_44ba_2cdc],
    ];

    #[test]
    fn results_are_numpys_with_and_without_fma() {
        for [x, y] in EXP.map(|pair| pair.map(f)) {
            assert_eq!([exp::<Hardware>(x), exp::<Emulated>(x)], [y, y], "{x}");
            assert_ne!(super::super::exp(x), y, "glibc's");
        }
        for [x, y] in LN_1P.map(|pair| pair.map(f)) {
            assert_eq!([ln_1p::<Hardware>(x), ln_1p::<Emulated>(x)], [y, y], "{x}");
            assert_ne!(super::super::ln_1p(x), y, "glibc's");
        }
        for [y, x, angle] in ATAN2.map(|row| row.map(f)) {
            let both = [atan2::<Hardware>(y, x), atan2::<Emulated>(y, x)];
            assert_eq!(both, [angle; 2], "{y} {x}");
        }
        for [x, angle] in ACOS.map(|pair| pair.map(f)) {
            let both = [acos::<Hardware>(x), acos::<Emulated>(x)];
            assert_eq!(both, [angle; 2], "{x}");
        }
        let ends = [1.0, 0.0, -1.0].map(numpy_acos);
        assert_eq!(
            ends,
            [0.0, std::f64::consts::FRAC_PI_2, std::f64::consts::PI]
        );
        assert!(numpy_acos(1.5).is_nan() && numpy_acos(f64::NAN).is_nan());
        assert_eq!(numpy_atan2(0.0, -1.0), std::f64::consts::PI);
        assert_eq!([numpy_exp(0.0), numpy_exp(-800.0)], [1.0, 0.0]);
        assert_eq!([numpy_ln_1p(0.0), numpy_ln_1p(-0.0)], [0.0, 0.0]);
        assert!(numpy_exp(f64::NAN).is_nan() && numpy_ln_1p(-2.0).is_nan());
    }
}
