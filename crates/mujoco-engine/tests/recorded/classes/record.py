#!/usr/bin/env python3
"""Record what an actuator has from a class that sets another kind of actuator, for the test `classes`.

    python record.py --models > models.txt
    pip install mujoco==3.12.0        python record.py > 3.12.txt; repeat with 3.17.0 and 4.0.0

A line of `models.txt` is a model. A line of the others is the digest of the kinds, parameters and ranges of its actuator; `-` if MuJoCo refuses
the model.
"""
import pathlib
import sys

FOLDER = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(FOLDER.parent))
from digests import of_lines, of_numbers

KINDS = {
    "general": 'gainprm="2 3 4" biastype="affine" biasprm="1 2 3" dyntype="filter" dynprm=".3 .2" ctrlrange="-1 2" gear="2"',
    "motor": 'ctrlrange="-1 2" gear="3" forcerange="-4 5"',
    "position": 'kp="3" kv=".5" timeconst=".2"',
    "velocity": 'kv="2" ctrlrange="-1 2"',
    "intvelocity": 'kp="4" kv=".25" actrange="-2 3"',
    "damper": 'kv="2" ctrlrange="0 2"',
    "cylinder": 'timeconst=".4" area="2" bias="1 2 3"',
    "muscle": 'timeconst=".02 .05" range=".7 1.1" force="9" scale="100" lmin=".4" lmax="1.7" vmax="1.4" fpmax="1.2" fvmax="1.1"',
    "adhesion": 'ctrlrange="0 2" gain="3"',
}
# what an element of the kind cannot do without
NEEDS = {"muscle": ' lengthrange=".1 1"', "adhesion": ' ctrlrange="0 1"', "intvelocity": ' actrange="-1 1"'}
BODY = '<worldbody><body name="b"><joint name="j"/><geom size=".1"/></body></worldbody>'


def models():
    for first in KINDS:
        for second in dict.fromkeys(("", "general", first)):
            classes = f"<{first} {KINDS[first]}/>" + (f"<{second} {KINDS[second]}/>" if second else "")
            for kind in KINDS:
                target = 'body="b"' if kind == "adhesion" else 'joint="j"'
                if second != first:
                    yield f"<mujoco><default>{classes}</default>{BODY}<actuator><{kind} {target}{NEEDS.get(kind, '')}/></actuator></mujoco>"


def digest(text):
    import mujoco

    try:
        m = mujoco.MjModel.from_xml_string(text)
    except ValueError:
        return "-"
    numbers = [m.actuator_dyntype[0], m.actuator_gaintype[0], m.actuator_biastype[0], m.actuator_ctrllimited[0]]
    for array in (m.actuator_dynprm, m.actuator_gainprm, m.actuator_biasprm, m.actuator_ctrlrange, m.actuator_forcerange, m.actuator_actrange, m.actuator_gear):
        numbers.extend(array[0])
    return f"{of_numbers(numbers):016x}"


def main():
    if "--models" in sys.argv:
        print(*models(), sep="\n")
    else:
        of_lines(FOLDER / "models.txt", digest)


if __name__ == "__main__":
    main()
