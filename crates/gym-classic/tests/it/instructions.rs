//! The machine code of the equations: each step is one function of vector instructions with FMA.
//!
//! If a function of a step is not inlined, the step has neither vector instructions nor FMA: the
//! results are the same, but a step takes five times as long. A measurement of time would show this
//! only on an idle machine; the machine code shows it on any machine. The test also checks that no
//! mathematical function of the platform is called.
#![cfg(all(target_arch = "x86_64", target_os = "linux"))]

use std::process::Command;

use gym_classic as _;
use gym_core::{VectorEnv, VectorEnvExt};

const IDS: [&str; 5] = [
    "Acrobot-v1",
    "CartPole-v1",
    "MountainCar-v0",
    "MountainCarContinuous-v0",
    "Pendulum-v1",
];

/// A function, and its number of FMA instructions on registers of 8, 4 and 1 numbers.
#[derive(Clone, Debug, Default)]
struct Function {
    name: String,
    by_8: usize,
    by_4: usize,
    by_1: usize,
    /// The mathematical function of the platform that the function calls, if any.
    platform: Option<&'static str>,
}

/// Mathematical functions of the platform. Results must not depend on these functions.
const PLATFORM: [&str; 20] = [
    "atan2", "cos", "cosf", "exp", "exp2", "expm1", "fma", "fmaf", "log", "log10", "log1p",
    "log1pf", "log2", "pow", "powf", "sin", "sincos", "sinf", "tan", "tanh",
];

fn functions(disassembly: &str) -> Vec<Function> {
    let mut functions: Vec<Function> = Vec::new();
    for line in disassembly.lines() {
        if let Some(name) = line
            .strip_suffix(">:")
            .and_then(|line| line.split_once('<'))
        {
            functions.push(Function {
                name: name.1.to_owned(),
                ..Function::default()
            });
            continue;
        }
        let Some(function) = functions.last_mut() else {
            continue;
        };
        let instruction = line
            .split_once(":\t")
            .map_or("", |(_, instruction)| instruction);
        if instruction.starts_with("vfm") || instruction.starts_with("vfnm") {
            if instruction.contains("sd ") {
                function.by_1 += 1;
            } else if instruction.contains("%zmm") {
                function.by_8 += 1;
            } else if instruction.contains("%ymm") {
                function.by_4 += 1;
            }
        }
        // `call ... <sin@plt>`, or through a table `call *... # ... <sin@GLIBC_2.2.5>`
        if let Some((_, name)) = instruction
            .split_once('<')
            .filter(|_| instruction.starts_with("call"))
        {
            let name = name
                .trim_end_matches('>')
                .split('@')
                .next()
                .unwrap_or_default();
            function.platform = function
                .platform
                .or(PLATFORM.into_iter().find(|known| *known == name));
        }
    }
    functions
}

#[test]
fn steps_are_vector_instructions_with_fused_multiply_adds() {
    for id in IDS {
        let mut envs = gym_core::make_vec(id, 32, None).unwrap();
        let mut columns = envs.reset(0).unwrap();
        let actions = envs.action_sampler(0).unwrap().sample();
        envs.step_into(&actions, &mut columns).unwrap();
    }
    let program = std::env::current_exe().unwrap();
    let Ok(output) = Command::new("objdump")
        .args(["-d", "--no-show-raw-insn"])
        .arg(program)
        .output()
    else {
        println!("skipped: there is no `objdump`");
        return;
    };
    let functions = functions(&String::from_utf8_lossy(&output.stdout));
    assert!(functions.len() > 1000, "{} functions", functions.len());

    // MountainCar's step, the shortest, has about 30
    let wide: Vec<_> = functions
        .iter()
        .filter(|function| function.by_8 >= 15)
        .collect();
    let narrow: Vec<_> = functions
        .iter()
        .filter(|function| function.by_4 >= 15)
        .collect();
    println!("{wide:#?}\n{narrow:#?}");
    assert!(
        wide.len() >= IDS.len(),
        "only {} kernels with AVX-512",
        wide.len()
    );
    assert!(
        narrow.len() >= IDS.len(),
        "only {} kernels with AVX2",
        narrow.len()
    );
    for function in wide.iter().chain(&narrow) {
        assert!(
            function.by_1 * 4 < function.by_8 + function.by_4,
            "one by one: {function:?}"
        );
    }
    // (an FMA outside of a function that is compiled for FMA would be a call of `fma`)
    for Function { name, platform, .. } in &functions {
        assert!(
            platform.is_none(),
            "`{name}` calls the platform's `{}`",
            platform.unwrap_or_default()
        );
    }
}
