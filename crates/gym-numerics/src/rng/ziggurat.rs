//! Normal and exponential numbers by the ziggurat method, as in numpy's
//! `numpy/random/src/distributions/distributions.c` at v2.4.6.
//!
//! One word gives the layer (8 bits), a sign (normal distribution only) and a position in the
//! layer. About 99 % of positions certainly lie under the curve. The others are compared with the
//! curve or, in layer 0, drawn from the tail beyond the last layer. `1 - u` instead of `u` keeps
//! the logarithm finite.

use rand::Rng;

use super::Generator;
use super::ziggurat_tables::{
    FE_DOUBLE, FI_DOUBLE, FI_FLOAT, KE_DOUBLE, KI_DOUBLE, KI_FLOAT, WE_DOUBLE, WI_DOUBLE, WI_FLOAT,
};
use crate::math::{exp, ln_1p, ln_1p_f32};

/// The start of the normal distribution's tail: numpy's `ziggurat_nor_r`.
const NORMAL_R: f64 = 3.654152885361009;
/// numpy's `ziggurat_nor_inv_r`.
const NORMAL_INV_R: f64 = 0.2736612373297583;
/// numpy's `ziggurat_nor_r_f`.
const NORMAL_R_F32: f32 = 3.6541529;
/// numpy's `ziggurat_nor_inv_r_f`.
const NORMAL_INV_R_F32: f32 = 0.27366123;
/// The start of the exponential distribution's tail: numpy's `ziggurat_exp_r`.
const EXPONENTIAL_R: f64 = 7.69711747013105;

impl Generator {
    /// Draws from the normal distribution with mean 0 and standard deviation 1.
    pub fn standard_normal(&mut self) -> f64 {
        loop {
            // from the lowest bit: 8 bits of layer, 1 of sign, 52 of position, 3 unused
            let word = self.next_u64();
            let layer = usize::from(word as u8);
            // set the sign by its bit: a branch would be mispredicted half of the time
            let sign = (word >> 8 & 1) << 63;
            let position = word >> 9 & ((1 << 52) - 1);
            let x = f64::from_bits((position as f64 * WI_DOUBLE[layer]).to_bits() | sign);
            if position < KI_DOUBLE[layer] {
                return x;
            }
            if layer == 0 {
                let tail = self.normal_tail();
                // numpy takes this sign from the position
                return if position >> 8 & 1 == 1 { -tail } else { tail };
            }
            let (above, below) = (FI_DOUBLE[layer - 1], FI_DOUBLE[layer]);
            if (above - below) * self.random() + below < exp(-0.5 * x * x) {
                return x;
            }
        }
    }

    fn normal_tail(&mut self) -> f64 {
        loop {
            let x = -NORMAL_INV_R * ln_1p(-self.random());
            let y = -ln_1p(-self.random());
            if y + y > x * x {
                return NORMAL_R + x;
            }
        }
    }

    /// Draws from the normal distribution with 32 bits: numpy's
    /// `standard_normal(dtype=np.float32)`.
    pub fn standard_normal_f32(&mut self) -> f32 {
        loop {
            // from the lowest bit: 8 bits of layer, 1 of sign, 23 of position
            let word = self.next_u32();
            let layer = usize::from(word as u8);
            let sign = (word >> 8 & 1) << 31;
            let position = word >> 9;
            let x = f32::from_bits((position as f32 * WI_FLOAT[layer]).to_bits() | sign);
            if position < KI_FLOAT[layer] {
                return x;
            }
            if layer == 0 {
                let tail = self.normal_tail_f32();
                return if position >> 8 & 1 == 1 { -tail } else { tail };
            }
            let (above, below) = (FI_FLOAT[layer - 1], FI_FLOAT[layer]);
            // in C, the right side is a `double`, because the constant -0.5 is
            let density = exp(-0.5 * f64::from(x) * f64::from(x));
            if f64::from((above - below) * self.random_f32() + below) < density {
                return x;
            }
        }
    }

    fn normal_tail_f32(&mut self) -> f32 {
        loop {
            let x = -NORMAL_INV_R_F32 * ln_1p_f32(-self.random_f32());
            let y = -ln_1p_f32(-self.random_f32());
            if y + y > x * x {
                return NORMAL_R_F32 + x;
            }
        }
    }

    /// Returns `loc + scale * standard_normal()`, for any two numbers.
    #[inline]
    pub fn normal(&mut self, loc: f64, scale: f64) -> f64 {
        loc + scale * self.standard_normal()
    }

    /// Draws from the exponential distribution with mean 1.
    pub fn standard_exponential(&mut self) -> f64 {
        loop {
            // from the lowest bit: 3 unused, 8 bits of layer, 53 of position
            let word = self.next_u64() >> 3;
            let layer = usize::from(word as u8);
            let position = word >> 8;
            let x = position as f64 * WE_DOUBLE[layer];
            if position < KE_DOUBLE[layer] {
                return x;
            }
            if layer == 0 {
                return EXPONENTIAL_R - ln_1p(-self.random());
            }
            let (above, below) = (FE_DOUBLE[layer - 1], FE_DOUBLE[layer]);
            if (above - below) * self.random() + below < exp(-x) {
                return x;
            }
        }
    }

    /// Returns `scale * standard_exponential()`, for any `scale`.
    #[inline]
    pub fn exponential(&mut self, scale: f64) -> f64 {
        scale * self.standard_exponential()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn first_values_are_numpys() {
        for (seed, normals, exponentials, normals_f32) in [
            (
                0,
                [0.1257302210933933, -0.1321048632913019],
                [0.6799319039689096, 1.0195971014658647],
                [1.117622, -1.3871249, -0.4265716],
            ),
            (
                42,
                [0.30471707975443135, -1.0399841062404955],
                [2.4042086039659947, 2.3361896558244535],
                [0.14190717, -1.6685079, -1.332108],
            ),
            (
                123,
                [-0.9891213503478509, -0.3677866514678832],
                [0.5969724951226518, 0.11703106104833545],
                [-0.033286825, 1.1667464, -0.5064895],
            ),
        ] {
            let start = Generator::from(seed);
            let mut rng = start.clone();
            assert_eq!(normals.map(|_| rng.standard_normal()), normals);
            let mut rng = start.clone();
            assert_eq!(
                normals.map(|_| rng.normal(2.0, 3.0)),
                normals.map(|z| 2.0 + 3.0 * z)
            );
            let mut rng = start.clone();
            assert_eq!(
                exponentials.map(|_| rng.standard_exponential()),
                exponentials
            );
            let mut rng = start.clone();
            assert_eq!(
                exponentials.map(|_| rng.exponential(0.5)),
                exponentials.map(|x| 0.5 * x)
            );
            let mut rng = start;
            assert_eq!(normals_f32.map(|_| rng.standard_normal_f32()), normals_f32);
        }
    }

    /// Enough draws to reach every layer, its edge and the tail. Sum and greatest magnitude are
    /// compared with a tolerance (the tail uses the logarithm), the position in the stream exactly.
    #[test]
    fn long_runs_are_numpys() {
        type Draw = fn(&mut Generator) -> f64;
        let cases: [(Draw, f64, f64, u64); 3] = [
            (
                Generator::standard_normal,
                190.8526145758009,
                4.522829666849905,
                0xc70a_d0ff_47cf_517b,
            ),
            (
                Generator::standard_exponential,
                199928.6474211806,
                11.45871735227823,
                0x0898_16cb_fccf_392c,
            ),
            (
                |rng| f64::from(rng.standard_normal_f32()),
                -772.4880594501337,
                4.729030132293701,
                0x1302_f377_5fec_771f,
            ),
        ];
        for (draw, sum, greatest, next_word) in cases {
            let mut rng = Generator::from(7);
            let values: Vec<f64> = (0..200_000).map(|_| draw(&mut rng)).collect();
            assert!((values.iter().sum::<f64>() - sum).abs() < 1e-6);
            assert!(
                (values.iter().fold(0.0, |top: f64, x| top.max(x.abs())) - greatest).abs() < 1e-6
            );
            assert_eq!(rng.next_u64(), next_word);
        }
    }

    #[test]
    fn moments_are_right() {
        const N: usize = 200_000;
        let mut rng = Generator::from(1);
        let (mut mean, mut square, mut exponential) = (0.0, 0.0, 0.0);
        for _ in 0..N {
            let z = rng.standard_normal();
            mean += z / N as f64;
            square += z * z / N as f64;
            exponential += rng.standard_exponential() / N as f64;
        }
        // five standard errors: 1/sqrt(N) of the means, sqrt(2/N) of the mean square
        assert!(
            mean.abs() < 0.0112
                && (square - 1.0).abs() < 0.0159
                && (exponential - 1.0).abs() < 0.0112
        );
    }
}
