#!/usr/bin/env python3
"""Measures the robots of MuJoCo Menagerie here and in libmujoco, and writes the page docs/robots.md from the results.

    pip install mujoco==4.0.0 pillow      and run it again with mujoco==3.12.0: each release has a column of its own
    tests/peers/robots.py MENAGERIE [--only WORD] [--steps 300] [--bits | --sheet]      at the root of the repository
    tests/peers/robots.py FOLDER --collection NAME      all models of a folder, such as a clone of dm_control: a row of the page's second table
    tests/peers/robots.py --page          writes the page anew from docs/robots/measured.json and docs/robots/collections.json

A robot is a file MENAGERIE/NAME/scene*.xml that the installed libmujoco loads (files for MJX are left out). It takes random controls, by one
generator for each robot and scaled to their ranges, for so many steps; a robot is equal if qpos, qvel, act and sensordata have the same bits after
1, 2, 5, 20, 100 and all of them, replayed by the command `replay`. The rates are the best of three runs on one thread: of
the command `mjcf FILE --steps` in the release build, and of `mujoco.rollout`, with the same controls, up to the step in which the model diverges; `--bits` keeps the rates of an earlier run. `--sheet` draws docs/robots/robots.png by `mjcf FILE --out`.
A collection is every *.xml below a folder that libmujoco loads. Of a model that takes libmujoco more than 20 seconds, as many steps are compared.
"""
import collections
import json
import math
import os
import re
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import timing  # first: it keeps numpy to one thread

MEASURED, COLLECTIONS, PAGE, SHEET = (Path("docs/robots") / name for name in ("measured.json", "collections.json", "../robots.md", "robots.png"))
ARRAYS = ("qpos", "qvel", "act", "sensordata")
# the meshes of these are under the GPL: they have no picture here
WITHOUT_PICTURE = ("shadow_hand",)
CELL, COLUMNS = (128, 96), 8


def commands(*arguments):
    """A command of `cargo xtask`, which builds it in less time, for less speed."""
    release = "cargo run --quiet --release --package xtask --bin commands --".split()
    return subprocess.run([*release, *map(str, arguments)], capture_output=True, text=True)


def controls(m, steps):
    import numpy as np

    rng, all = np.random.RandomState(0), np.empty((steps, m.nu))
    for row in all:
        for i in range(m.nu):
            control, (low, high) = rng.uniform(-1.0, 1.0), m.actuator_ctrlrange[i]
            row[i] = low + (control + 1.0) / 2.0 * (high - low) if m.actuator_ctrllimited[i] else control
    return all


def record(m, steps, seconds=math.inf):
    """The states after some steps, the largest number of contacts, and the steps before the model diverged. Steps end after so many seconds."""
    import mujoco

    d, marks, contacts, sound, start = mujoco.MjData(m), {}, 0, 0, time.monotonic()
    for step, control in enumerate(controls(m, steps), 1):
        d.ctrl[:] = control
        mujoco.mj_step(m, d)
        contacts = max(contacts, d.ncon)
        sound += sound == step - 1 and not any(warning.number for warning in d.warning)
        late = time.monotonic() - start > seconds
        if late or step in (1, 2, 5, 20, 100, steps):
            marks[str(step)] = {name: getattr(d, name).ravel().tolist() for name in ARRAYS}
        if late:
            break
    return marks, contacts, sound


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


def measure(file, steps, rates, seconds=math.inf):
    """What is known of a robot in the installed version; None if libmujoco refuses it. `rates`: those of an earlier run, or None to measure."""
    import mujoco

    try:
        m = mujoco.MjModel.from_xml_path(str(file))
    except Exception as error:
        print(f"{file}: libmujoco: {str(error).splitlines()[0][:120]}")
        return None
    marks, contacts, sound = record(m, steps, seconds)
    result = {"nv": m.nv, "nu": m.nu, "triangles": m.nmeshface, "contacts": contacts}
    version = mujoco.__version__
    with tempfile.TemporaryDirectory() as folder:
        recording = Path(folder) / "robot.json"
        parts = {"kind": "features", "file": str(file.resolve()), "seed": 0, "versions": {version: {"steps": [], "episode": marks}}}
        recording.write_text(json.dumps(parts))
        run = commands("replay", "--out", f"{folder}/found", recording)
        answer = Path(folder) / "found/robot.json"
        found = json.loads(answer.read_text()) if answer.exists() else {"error": run.stderr.strip()}
    if "error" in found:
        reason = re.sub(r"\S*/(?=[^/\s])", "", found["error"])  # names without their folders
        return result | {"refused": reason[:240]}
    difference = first_difference(marks, found["versions"][version]["episode"])
    if rates is None:
        # `rollout` ends where a model diverges
        runs = [commands("mjcf", file, "--mujoco", version, "--steps", sound).stdout for _ in range(3)]
        ours = max((float(rate[1]) for text in runs if (rate := re.search(r"([\d.]+) steps per second", text))), default=0.0)
        rates = {"ours": round(ours), "libmujoco": round(rollout(m, sound))}
    return result | {"difference": difference} | rates


def collection(root, steps):
    """What is known of all models of a folder: how many libmujoco loads, and those of them that are refused or differ, with the reason."""
    import mujoco

    known = {"loads": 0, "equal": 0, "refused": {}, "differ": {}}
    for file in sorted(root.rglob("*.xml")):
        name = str(file.relative_to(root))
        try:
            result = measure(file, steps, {}, seconds=20)
        except mujoco.FatalError as error:
            print(f"{file}: libmujoco fails in a step: {error}")
            continue
        if result is None:
            continue
        known["loads"] += 1
        if "refused" in result:
            known["refused"][name] = result["refused"]
        elif result["difference"]:
            known["differ"][name] = result["difference"]
        else:
            known["equal"] += 1
        print(name, result, flush=True)
    return known


def table(measured):
    """The table of the collections."""
    versions = sorted(measured, reverse=True)
    names = list(dict.fromkeys(name for version in versions for name in measured[version]))
    lines = [
        "| collection | " + " | ".join(f"{v}: libmujoco loads | loads here | equal" for v in versions) + " |",
        "|---|" + "---|---|---|" * len(versions),
    ]
    sums = [0] * 3 * len(versions)
    for name in names:
        cells = []
        for v in versions:
            known = measured[v].get(name, {"loads": 0, "equal": 0, "refused": {}})
            cells += [known["loads"], known["loads"] - len(known["refused"]), known["equal"]]
        sums = [a + b for a, b in zip(sums, cells)]
        lines.append(f"| {name} | " + " | ".join(map(str, cells)) + " |")
    return [*lines, "| all | " + " | ".join(map(str, sums)) + " |", "", *(f"- Refused with {v}: {causes(measured[v])}." for v in versions)]


def mean_speed(results):
    """The geometric mean of the ratios of rates to libmujoco's."""
    return statistics.geometric_mean(result["ours"] / result["libmujoco"] for result in results if "ours" in result)


def causes(measured):
    """Why models are refused, with the number of models."""
    names = {"flexcomp": "flexes", "deformable": "flexes", "extension": "plugins", "sleep": "sleep"}
    parts = collections.Counter()
    for known in measured.values():
        for reason in known["refused"].values():
            words = re.search(r'<(\w+)>(?: attribute "(\w+)")?', reason)
            found = [names[word] for word in words.groups() if word in names] if words else []
            parts[found[0] if found else "what else the list of [what is read](mujoco-models.md#what-is-read) ends with"] += 1
    return ", ".join(f"{part} ({count})" for part, count in parts.most_common())


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
            run = commands("mjcf", file, *start, "--size", size, "--out", out)
            if run.returncode:
                run = commands("mjcf", file, "--size", size, "--out", out)
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
        f"with {v}, {equal[v]} have libmujoco's bits (refused: {sum('refused' in r for r in measured['versions'][v].values())}), and speed is "
        f"{mean_speed(measured['versions'][v].values()):.2f} times libmujoco's in the geometric mean"
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
    replace("measured", [head, *picture, "", *lines, *reasons])
    if COLLECTIONS.exists():
        replace("collections", table(json.loads(COLLECTIONS.read_text())))


def replace(mark, lines):
    """Writes lines in place of what is on the page between a mark and the next end."""
    before, rest = PAGE.read_text().split(f"<!-- {mark} -->\n")
    _, after = rest.split("<!-- end -->\n", 1)
    PAGE.write_text(before + f"<!-- {mark} -->\n\n" + "\n".join(lines) + "\n\n<!-- end -->\n" + after)


def store(measured, to=MEASURED):
    to.write_text(json.dumps(measured, indent=1, sort_keys=True) + "\n")


def main():
    arguments = sys.argv[1:]
    option = lambda name, default: arguments.pop(arguments.index(name) + 1) if name in arguments else default
    only, steps, name = option("--only", ""), int(option("--steps", 300)), option("--collection", None)
    measured = json.loads(MEASURED.read_text()) if MEASURED.exists() else {"steps": steps, "versions": {}}
    if "--page" not in arguments:
        MEASURED.parent.mkdir(exist_ok=True)
        folders = [argument for argument in arguments if not argument.startswith("--")]
        if not folders:
            sys.exit(__doc__)
        root = Path(folders[0])
        if name:
            import mujoco

            all = json.loads(COLLECTIONS.read_text()) if COLLECTIONS.exists() else {}
            all.setdefault(mujoco.__version__, {})[name] = collection(root, steps)
            store(all, COLLECTIONS)
            return page(measured)
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
