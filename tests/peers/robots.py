#!/usr/bin/env python3
"""Measures the robots of MuJoCo Menagerie here and in libmujoco, and writes the page docs/robots.md from the results.

    pip install mujoco==4.0.0 pillow      and run it again with mujoco==3.12.0: each release has a column of its own
    tests/peers/robots.py MENAGERIE [--only WORD] [--steps 300] [--bits | --sheet]      at the root of the repository
    tests/peers/robots.py --page          writes the page anew from docs/robots/measured.json

A robot is a file MENAGERIE/NAME/scene*.xml that the installed libmujoco loads (files for MJX are left out). It takes random controls, by one
generator for each robot and scaled to their ranges, for so many steps; a robot is equal if qpos, qvel, act and sensordata have the same bits after
1, 2, 5, 20, 100 and all of them, replayed by `cargo xtask replay`. The rates are the best of three runs on one thread: of
`cargo xtask mjcf FILE --steps`, and of `mujoco.rollout`, with the same controls; `--bits` keeps the rates of an earlier run. `--sheet` draws docs/robots/robots.png by `cargo xtask mjcf FILE --out`.
"""
import json
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

import timing  # first: it keeps numpy to one thread

MEASURED, PAGE, SHEET = (Path("docs/robots") / name for name in ("measured.json", "../robots.md", "robots.png"))
ARRAYS = ("qpos", "qvel", "act", "sensordata")
# the meshes of these are under the GPL: they have no picture here
WITHOUT_PICTURE = ("shadow_hand",)
CELL, COLUMNS = (128, 96), 8


def xtask(*arguments):
    return subprocess.run(["cargo", "xtask", *map(str, arguments)], capture_output=True, text=True)


def controls(m, steps):
    import numpy as np

    rng, all = np.random.RandomState(0), np.empty((steps, m.nu))
    for row in all:
        for i in range(m.nu):
            control, (low, high) = rng.uniform(-1.0, 1.0), m.actuator_ctrlrange[i]
            row[i] = low + (control + 1.0) / 2.0 * (high - low) if m.actuator_ctrllimited[i] else control
    return all


def record(m, steps):
    """The states after some steps, and the largest number of contacts."""
    import mujoco

    d, marks, contacts = mujoco.MjData(m), {}, 0
    for step, control in enumerate(controls(m, steps), 1):
        d.ctrl[:] = control
        mujoco.mj_step(m, d)
        contacts = max(contacts, d.ncon)
        if step in (1, 2, 5, 20, 100, steps):
            marks[str(step)] = {name: getattr(d, name).ravel().tolist() for name in ARRAYS}
    return marks, contacts


def first_difference(expected, found):
    """None if all is equal; else the step after which the first array differs, and by how much."""
    import numpy as np

    for mark in sorted(expected, key=int):
        for name in ARRAYS:
            a, b = (np.array(state.get(mark, {}).get(name, []), dtype=float).ravel() for state in (expected, found))
            if a.tobytes() != b.tobytes():
                off = f"{np.nanmax(np.abs(a - b)):.0e}" if a.shape == b.shape else "a length"
                return f"step {mark}, {off}"
    return None


def rollout(m, steps):
    """The best rate of `mujoco.rollout`, in steps per second."""
    import time

    import mujoco
    import numpy as np
    from mujoco import rollout

    d = mujoco.MjData(m)
    start = np.zeros(mujoco.mj_stateSize(m, mujoco.mjtState.mjSTATE_FULLPHYSICS))
    mujoco.mj_getState(m, d, start, mujoco.mjtState.mjSTATE_FULLPHYSICS)
    given, times = controls(m, steps), []
    for _ in range(3):
        d = mujoco.MjData(m)
        begin = time.perf_counter()
        rollout.rollout(m, d, start[None], given[None])
        times.append(time.perf_counter() - begin)
    return steps / min(times)


def measure(file, steps, rates):
    """What is known of a robot in the installed version; None if libmujoco refuses it. `rates`: those of an earlier run, or None to measure."""
    import mujoco

    try:
        m = mujoco.MjModel.from_xml_path(str(file))
    except Exception as error:
        print(f"{file}: libmujoco: {str(error).splitlines()[0][:120]}")
        return None
    marks, contacts = record(m, steps)
    result = {"nv": m.nv, "nu": m.nu, "triangles": m.nmeshface, "contacts": contacts}
    version = mujoco.__version__
    with tempfile.TemporaryDirectory() as folder:
        recording = Path(folder) / "robot.json"
        parts = {"kind": "features", "file": str(file.resolve()), "seed": 0, "versions": {version: {"steps": [], "episode": marks}}}
        recording.write_text(json.dumps(parts))
        run = xtask("replay", "--out", f"{folder}/found", recording)
        answer = Path(folder) / "found/robot.json"
        found = json.loads(answer.read_text()) if answer.exists() else {"error": run.stderr.strip()}
    if "error" in found:
        reason = re.sub(r"\S*/(?=[^/\s])", "", found["error"])  # names without their folders
        return result | {"refused": reason[:240]}
    difference = first_difference(marks, found["versions"][version]["episode"])
    if rates is None:
        runs = [xtask("mjcf", file, "--mujoco", version, "--steps", steps).stdout for _ in range(3)]
        ours = max((float(rate[1]) for text in runs if (rate := re.search(r"([\d.]+) steps per second", text))), default=0.0)
        rates = {"ours": round(ours), "libmujoco": round(rollout(m, steps))}
    return result | {"difference": difference} | rates


def sheet(robots):
    """Draws the robots, smaller and in one picture of 256 colours; returns the names in their order."""
    from PIL import Image

    names = []
    whole = Image.new("RGB", (CELL[0] * COLUMNS, CELL[1] * (len(robots) // COLUMNS + 1)), "white")
    for name, file in robots:
        with tempfile.TemporaryDirectory() as folder:
            out = Path(folder) / "robot.png"
            size = f"{2 * CELL[0]}x{2 * CELL[1]}"
            start = ["--keyframe", "0"]
            run = xtask("mjcf", file, *start, "--size", size, "--out", out)
            if run.returncode:
                run = xtask("mjcf", file, "--size", size, "--out", out)
            if run.returncode or name.startswith(WITHOUT_PICTURE):
                continue
            picture = Image.open(out).resize(CELL, Image.LANCZOS)
        whole.paste(picture, (len(names) % COLUMNS * CELL[0], len(names) // COLUMNS * CELL[1]))
        names.append(name)
    rows = -(-len(names) // COLUMNS)
    whole.crop((0, 0, CELL[0] * COLUMNS, CELL[1] * rows)).quantize(256).save(SHEET, optimize=True)
    return names


def page(measured):
    """The page with its table, in place of what is between the marks."""
    versions = sorted(measured["versions"], reverse=True)
    robots = sorted({name for robots in measured["versions"].values() for name in robots})
    lines = [
        "| robot | degrees of freedom | contacts | " + " | ".join(f"{v}: bits | steps/s | libmujoco" for v in versions) + " |",
        "|---|---|---|" + "---|---|---|" * len(versions),
    ]
    equal = dict.fromkeys(versions, 0)
    for name in robots:
        of = {v: measured["versions"][v].get(name) for v in versions}
        any = next(result for result in of.values() if result)
        cells = [name, str(any["nv"]), str(any["contacts"])]
        for v, result in of.items():
            if result is None:
                cells += ["libmujoco refuses it", "", ""]
            elif "refused" in result:
                cells += ["refused", "", ""]
            else:
                equal[v] += result["difference"] is None
                bits = "equal" if result["difference"] is None else result["difference"]
                cells += [bits, *(timing.shown(result[rate]) if rate in result else "" for rate in ("ours", "libmujoco"))]
        lines.append("| " + " | ".join(cells) + " |")
    counts = "; ".join(
        f"with {v}, {equal[v]} have libmujoco's bits and {sum('refused' in r for r in measured['versions'][v].values())} are refused"
        for v in versions
    )
    head = f"{len(robots)} scenes, {measured['steps']} steps with random controls: {counts}."
    names = measured.get("sheet", [])
    rows = [", ".join(names[i : i + COLUMNS]) for i in range(0, len(names), COLUMNS)]
    picture = ["", "![Robots of Menagerie](robots/robots.png)", "", *(f"{i}. {row}" for i, row in enumerate(rows, 1))] if names else []
    refused = [
        f"- {name}: {result['refused']}"
        for name in robots
        for result in [measured["versions"][versions[0]].get(name)]
        if result and "refused" in result
    ]
    reasons = ["", "Refused, with the reason:", "", *refused] if refused else []
    text = PAGE.read_text()
    before, rest = text.split("<!-- measured -->\n")
    _, after = rest.split("<!-- end -->\n")
    PAGE.write_text(before + "<!-- measured -->\n\n" + "\n".join([head, *picture, "", *lines, *reasons]) + "\n\n<!-- end -->\n" + after)


def store(measured):
    MEASURED.write_text(json.dumps(measured, indent=1, sort_keys=True) + "\n")


def main():
    arguments = sys.argv[1:]
    option = lambda name, default: arguments.pop(arguments.index(name) + 1) if name in arguments else default
    only, steps = option("--only", ""), int(option("--steps", 300))
    measured = json.loads(MEASURED.read_text()) if MEASURED.exists() else {"steps": steps, "versions": {}}
    if "--page" not in arguments:
        MEASURED.parent.mkdir(exist_ok=True)
        folders = [argument for argument in arguments if not argument.startswith("--")]
        if not folders:
            sys.exit(__doc__)
        root = Path(folders[0])
        files = sorted(file for file in root.glob("*/*scene*.xml") if "mjx" not in file.name and only in str(file))
        robots = [(f"{file.parent.name}" + ("" if file.stem == "scene" else f"/{file.stem.removeprefix('scene_')}"), file) for file in files]
        if not files:
            sys.exit(f"{root}: no folder there has a scene*.xml")
        if "--sheet" in arguments:
            measured["sheet"] = sheet(robots)
        else:
            import mujoco

            measured["steps"] = steps
            results = measured["versions"].setdefault(mujoco.__version__, {})
            for name, file in robots:
                before = results.pop(name, {})
                rates = {key: before[key] for key in ("ours", "libmujoco") if key in before} if "--bits" in arguments else None
                if result := measure(file, steps, rates):
                    results[name] = result
                    print(name, result, flush=True)
                store(measured)
        store(measured)
    page(measured)


if __name__ == "__main__":
    main()
