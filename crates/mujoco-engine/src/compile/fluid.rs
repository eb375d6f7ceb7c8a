//! Coefficients of the ellipsoid fluid model.

use std::f64::consts::PI;

use crate::math::libm;
use crate::model::GeomType;

/// MuJoCo's `geom_fluid`: 1 for the ellipsoid model, five coefficients, and the virtual masses and
/// virtual moments of the equivalent ellipsoid.
pub(super) fn coefficients(shape: GeomType, size: [f64; 3], given: [f64; 5]) -> [f64; 12] {
    let [x, y, z] = match shape {
        GeomType::Sphere => [size[0]; 3],
        GeomType::Capsule => [size[0], size[0], size[1] + size[0]],
        GeomType::Cylinder => [size[0], size[0], size[1]],
        _ => size,
    };
    let volume = 4.0 / 3.0 * PI * x * y * z;
    let kappas = [kappa(x, y, z), kappa(y, z, x), kappa(z, x, y)];
    const LEAST: f64 = 1e-14;
    let mass = kappas.map(|kappa| volume * kappa / f64::max(LEAST, 2.0 - kappa));
    // the virtual moment about an axis, from the squares and the kappas of the two other axes
    let moment = |a: f64, b: f64, ka: f64, kb: f64| {
        let square = (a * a - b * b) * (a * a - b * b);
        let below = 2.0 * (a * a - b * b) + (a * a + b * b) * (kb - ka);
        let factor = square * (kb - ka).abs() / f64::max(LEAST, below.abs());
        volume * factor / 5.0
    };
    let [kx, ky, kz] = kappas;
    let moments = [
        moment(y, z, kz, ky),
        moment(z, x, kx, kz),
        moment(x, y, ky, kx),
    ];
    let mut all = [1.0; 12];
    all[1..6].copy_from_slice(&given);
    all[6..9].copy_from_slice(&mass);
    all[9..].copy_from_slice(&moments);
    all
}

/// The coefficient of added mass along the first axis: `x y z` times the integral of
/// `1 / sqrt((x^2 + l)^3 (y^2 + l) (z^2 + l))` over `l` from 0 on, by a Gauss-Kronrod rule of 15
/// points after the substitution `l = u^3 / (1 - u)^2`.
fn kappa(x: f64, y: f64, z: f64) -> f64 {
    const WEIGHTS: [f64; 8] = [
        0.01146766, 0.03154605, 0.05239501, 0.07032663, 0.08450236, 0.09517529, 0.10221647,
        0.10474107,
    ];
    const PLACES: [f64; 15] = [
        7.865151709349917e-08,
        1.7347976913907274e-05,
        0.0003548008144506193,
        0.002846636252924549,
        0.014094260903596077,
        0.053063261727396636,
        0.17041978741317773,
        0.5,
        1.4036301548686991,
        3.9353484827022642,
        11.644841677041734,
        39.53187807410903,
        177.5711362220801,
        1429.4772912937397,
        54087.416549217705,
    ];
    const SLOPES: [f64; 15] = [
        5.538677720489877e-05,
        0.002080868285293228,
        0.016514126520723166,
        0.07261900344370877,
        0.23985243401862602,
        0.6868318249020725,
        1.8551129519182894,
        5.0,
        14.060031152313941,
        43.28941239611009,
        156.58546376397112,
        747.9826085305024,
        5827.4042950027115,
        116754.0197944512,
        25482945.327264845,
    ];
    let [px, py, pz] = [x, y, z].map(|d| 1.0 / (d * d));
    let scale = libm::pow(x * x * x * y * z, 0.4);
    let mut sum = 0.0;
    for i in 0..15 {
        let l = scale * PLACES[i];
        let root = ((1.0 + l * px) * (1.0 + l * py) * (1.0 + l * pz)).sqrt();
        sum += scale * SLOPES[i] / ((1.0 + l * px) * root) * WEIGHTS[i.min(14 - i)];
    }
    sum * px
}
