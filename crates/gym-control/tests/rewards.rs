//! The functions that rewards are made of.

use gym_control::rewards::{Sigmoid, Tolerance};

/// The expected values are those of dm_control 1.0.45 with numpy 2.4.6.
#[test]
fn values_are_those_of_the_package() {
    let all = |sigmoid| Tolerance::within(0.3, 0.9).margin(1.7, sigmoid);
    for (sigmoid, x, scalar, element) in [
        (
            Sigmoid::Gaussian,
            1.8262061180942872,
            0.5048512085911016,
            0.5048512085911017,
        ),
        (
            Sigmoid::Gaussian,
            0.1600380451671808,
            0.984513506574113,
            0.984513506574113,
        ),
        (
            Sigmoid::Linear(0.5),
            -1.1530500216010078,
            0.5726323465879388,
            0.5726323465879388,
        ),
        (
            Sigmoid::Linear(0.5),
            1.1936147466205957,
            0.9136427215821777,
            0.9136427215821777,
        ),
        (
            Sigmoid::Quadratic(0.0),
            2.5163797891818556,
            0.09595722391848438,
            0.09595722391848449,
        ),
        (
            Sigmoid::LongTail,
            -0.037500590667177924,
            0.7381563255027297,
            0.7381563255027298,
        ),
        (
            Sigmoid::LongTail,
            2.455456787711417,
            0.11717002031554148,
            0.11717002031554148,
        ),
    ] {
        let tolerance = all(sigmoid);
        assert_eq!(
            [tolerance.of(x), tolerance.of_element(x)],
            [scalar, element],
            "{sigmoid:?}"
        );
    }
    // the linear and the quadratic sigmoid end at 0
    let outer = |sigmoid| [4.29, 4.31, 1e9, -3.71].map(|x| all(sigmoid).of(x));
    let [inside, beyond @ ..] = outer(Sigmoid::Linear(0.5));
    assert!(inside > 0.0 && inside < 0.01 && beyond == [0.0; 3]);
    let [inside, beyond @ ..] = outer(Sigmoid::Quadratic(0.75));
    assert!(inside > 0.0 && inside < 0.01 && beyond == [0.0; 3]);
    let none = Tolerance::within(-1.0, 1.0);
    assert_eq!([0.5, 1.0, 1.1].map(|x| none.of(x)), [1.0, 1.0, 0.0]);
    assert!(none.of(f64::NAN) == 0.0);
}
