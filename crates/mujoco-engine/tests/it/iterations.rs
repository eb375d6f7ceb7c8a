//! The solver takes as many iterations as libmujoco's, in each island of each step. `recorded/iterations.py` recorded them.

use mujoco_engine::{Data, Model, step};

/// An arm with dry friction and a limit, boxes on each other, a ball and a capsule, on a floor: several islands.
const PILE: &str = r#"<mujoco>
  <option {option}><flag {flag}/></option>
  <worldbody>
    <geom type="plane" size="5 5 1"/>
    <body pos="0 0 .1"><joint axis="0 1 0" frictionloss=".1" damping=".1"/>
      <geom type="capsule" fromto="0 0 0 .3 0 -.05" size=".05"/>
      <body pos=".3 0 -.05"><joint axis="0 1 0" range="-10 5"/><geom type="capsule" fromto="0 0 0 .2 0 0" size=".04"/></body></body>
    <body pos="1 0 .095" euler="2 1 0"><freejoint/><geom type="box" size=".1 .12 .1"/></body>
    <body pos="1.02 .01 .29"><freejoint/><geom type="box" size=".1 .1 .1" condim="4"/></body>
    <body pos="-1 0 .19"><freejoint/><geom size=".2" condim="6"/></body>
    <body pos="-1 1 .09" euler="80 0 0"><freejoint/><geom type="capsule" size=".1 .2" condim="1"/></body>
    <body pos="0 2 3"><freejoint/><geom size=".1"/></body>
  </worldbody>
</mujoco>"#;

/// Options and flags.
const CASES: [(&str, &str); 24] = [
    (r#"solver="Newton" cone="pyramidal""#, ""),
    (r#"solver="Newton" cone="elliptic""#, ""),
    (r#"solver="Newton" cone="elliptic" impratio="5""#, ""),
    (r#"solver="Newton" iterations="2""#, ""),
    (r#"solver="Newton" tolerance="1e-3""#, ""),
    (r#"solver="Newton" integrator="RK4""#, ""),
    (r#"solver="Newton" noslip_iterations="4""#, ""),
    (
        r#"solver="Newton" cone="elliptic" noslip_iterations="4""#,
        "",
    ),
    (r#"solver="Newton" jacobian="sparse""#, ""),
    (r#"solver="Newton""#, r#"warmstart="disable""#),
    (r#"solver="Newton""#, r#"island="disable""#),
    (r#"solver="Newton" cone="elliptic""#, r#"island="disable""#),
    (r#"solver="CG" cone="pyramidal""#, ""),
    (r#"solver="CG" cone="elliptic""#, ""),
    (r#"solver="CG" iterations="3""#, ""),
    (r#"solver="CG" tolerance="1e-3""#, ""),
    (r#"solver="CG" noslip_iterations="4""#, ""),
    (r#"solver="CG""#, r#"island="disable""#),
    (r#"solver="PGS" cone="pyramidal""#, ""),
    (r#"solver="PGS" cone="elliptic""#, ""),
    (r#"solver="PGS" iterations="3""#, ""),
    (r#"solver="PGS" tolerance="1e-3""#, ""),
    (r#"solver="PGS" cone="elliptic" noslip_iterations="4""#, ""),
    (r#"solver="PGS""#, r#"island="disable""#),
];

/// The iterations of 12 steps with spaces between, those of the islands of a step with commas between.
fn iterations((option, flag): (&str, &str), version: &str) -> String {
    let text = PILE.replace("{option}", option).replace("{flag}", flag);
    let m = Model::from_xml_with(&text, version.parse().unwrap()).unwrap();
    let mut d = Data::new(&m);
    for (i, x) in d.qvel.iter_mut().enumerate() {
        *x = ((7 * i % 11) as f64 - 5.0) / 5.0;
    }
    let steps = (0..12).map(|_| {
        step(&m, &mut d);
        let counts: Vec<_> = d.solver_niter.iter().map(usize::to_string).collect();
        counts.join(",")
    });
    steps.collect::<Vec<_>>().join(" ")
}

#[test]
fn the_solver_takes_as_many_iterations_as_libmujocos() {
    let mut unlike = Vec::new();
    for (version, recorded) in [
        ("3.12", include_str!("../recorded/iterations/3.12.txt")),
        ("3.17", include_str!("../recorded/iterations/3.17.txt")),
        ("4.0", include_str!("../recorded/iterations/4.0.txt")),
    ] {
        assert_eq!(recorded.lines().count(), CASES.len());
        for (case, expected) in CASES.into_iter().zip(recorded.lines()) {
            let found = iterations(case, version);
            if found != expected {
                unlike.push(format!("{version}, {case:?}:\n{found}\n{expected}"));
            }
        }
    }
    assert!(unlike.is_empty(), "{}", unlike.join("\n"));
}
