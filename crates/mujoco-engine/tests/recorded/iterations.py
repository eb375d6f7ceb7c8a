#!/usr/bin/env python3
"""Print how many iterations the solver takes for each island in each step, for the test `iterations`.

    pip install mujoco==3.12.0        python iterations.py > iterations/3.12.txt; repeat with 3.17.0 and 4.0.0

A line has the options of a case of `it/iterations.rs`, and the counts of 12 steps: those of a step's islands with commas between.
"""
import re
from pathlib import Path

import mujoco

text = (Path(__file__).parent.parent / "it/iterations.rs").read_text()
pile = re.search(r'r#"(<mujoco>.*?)"#', text, re.S)[1]
cases = re.search(r"const CASES.*?= \[(.*?)\n\];", text, re.S)[1]
for option, flag in re.findall(r'\(\s*r#"(.*?)"#,\s*r?#?"(.*?)"#?,?\s*\)', cases):
    model = mujoco.MjModel.from_xml_string(pile.replace("{option}", option).replace("{flag}", flag))
    data = mujoco.MjData(model)
    data.qvel[:] = [((7 * i) % 11 - 5) / 5 for i in range(model.nv)]
    steps = []
    for _ in range(12):
        mujoco.mj_step(model, data)
        count = max(data.nisland, 1) if data.nefc else 0
        steps.append(",".join(str(n) for n in data.solver_niter[:count]))
    print(" ".join(steps))
