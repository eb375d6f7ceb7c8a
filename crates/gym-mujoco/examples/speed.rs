//! Time of the engine per environment step, on the models of Gymnasium's tasks under random controls.
use std::time::Instant;

use gym_mujoco::{Data, Model, physics as p, step};

fn main() {
    let folder = std::path::PathBuf::from(std::env::var_os("GYM_REFERENCE").expect("GYM_REFERENCE"))
        .join("models_mujoco");
    let only: Vec<String> = std::env::args().skip(1).collect();
    for (name, skip) in [
        ("inverted_pendulum", 2),
        ("inverted_double_pendulum", 5),
        ("reacher", 2),
        ("pusher_v5", 5),
        ("swimmer", 4),
        ("half_cheetah", 5),
        ("hopper", 4),
        ("walker2d_v5", 4),
        ("ant", 5),
        ("humanoid", 5),
        ("humanoidstandup", 5),
    ] {
        if !only.is_empty() && !only.iter().any(|o| o == name) {
            continue;
        }
        let text = std::fs::read_to_string(folder.join(name).with_extension("json")).unwrap();
        let m: Model = serde_json::from_str(&text).unwrap();
        let n = if name.starts_with("human") { 400 } else { 2000 };
        let mut best = f64::MAX;
        let (mut rows, mut iterations, mut calls) = (0, 0, 0);
        for _ in 0..4 {
            let mut d = Data::new(&m);
            let mut seed = 1_u64;
            let t = Instant::now();
            for _ in 0..n {
                for i in 0..m.nu() {
                    seed =
                        seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                    let u = (seed >> 40) as f64 / f64::from(1_u32 << 24) * 2.0 - 1.0;
                    d.ctrl[i] = u * m.actuator_ctrlrange[i][1];
                }
                for _ in 0..skip {
                    step(&m, &mut d);
                    rows += d.efc.nefc();
                    iterations += d.solver_niter.iter().sum::<usize>();
                    calls += 1;
                }
            }
            best = best.min(t.elapsed().as_secs_f64() / f64::from(n));
        }
        if std::env::var_os("STAGES").is_some() {
            stages(&m, name);
        }
        println!(
            "{name:26} {:8.2} us/env step ({:6.2} per step), {:.1} rows, {:.1} iterations",
            best * 1e6,
            best * 1e6 / f64::from(skip),
            rows as f64 / calls as f64,
            iterations as f64 / calls as f64
        );
    }
}

/// Time of each stage, averaged over states of a rollout.
fn stages(m: &Model, name: &str) {
    type Stage = (&'static str, fn(&Model, &mut Data));
    let stages: [Stage; 13] = [
        ("kinematics", p::kinematics),
        ("com_pos", p::com_pos),
        ("crb", p::crb),
        ("factor_m", p::factor_m),
        ("collision", p::collision),
        ("make_constraint", p::make_constraint),
        ("com_vel", p::com_vel),
        ("passive", p::passive),
        ("reference", p::reference_constraint),
        ("rne", p::rne),
        ("actuation", p::fwd_actuation),
        ("solver", p::fwd_constraint),
        ("forward", p::forward),
    ];
    let mut total = [0.0; 13];
    let mut d = Data::new(m);
    let mut seed = 1_u64;
    let states = 100;
    for _ in 0..states {
        for i in 0..m.nu() {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let u = (seed >> 40) as f64 / f64::from(1_u32 << 24) * 2.0 - 1.0;
            d.ctrl[i] = u * m.actuator_ctrlrange[i][1];
        }
        for _ in 0..5 {
            step(m, &mut d);
        }
        let mut e = d.clone();
        p::forward(m, &mut e);
        for (k, (_, stage)) in stages.iter().enumerate() {
            let mut least = f64::MAX;
            for _ in 0..5 {
                let t = Instant::now();
                for _ in 0..20 {
                    stage(m, &mut e);
                }
                least = least.min(t.elapsed().as_secs_f64() / 20.0);
            }
            total[k] += least;
        }
    }
    print!("{name}: ");
    for (k, (label, _)) in stages.iter().enumerate() {
        print!("{label} {:.0}  ", total[k] / f64::from(states) * 1e9);
    }
    println!("ns");
}
