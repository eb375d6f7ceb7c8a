#!/usr/bin/env python3
"""Record digests of all fields of compiled models, for the test `compiled_fields`.

    pip install mujoco==3.12.0        python record.py > 3.12.txt; repeat with 3.17.0 and 4.0.0

A line has the digest of one of the models of `parts` and `random`: of the field, the place and the value of each number that is neither 0 nor -1,
which stand for nothing; `-` if MuJoCo refuses the model. Fields are those that `fields.json` has, except for `LEFT_OUT`.
"""
import json
import pathlib
import sys

import mujoco

FOLDER = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(FOLDER.parent), str(FOLDER.parent / "parts")]
from digests import added, of_numbers, of_texts
from fields import fields
from record import models

# flags that have no effect here, numbers of constraints that nothing reads, and boxes that only meshes need
LEFT_OUT = {"opt.enableflags", "eq_data", "geom_aabb"}
KNOWN = set(json.loads((FOLDER.parent / "fields.json").read_text())["versions"]["3.12.0"]["plain"]) - LEFT_OUT


def digest(text):
    try:
        model = mujoco.MjModel.from_xml_string(text)
    except ValueError:
        return "-"
    digest = of_numbers(())
    for name, numbers in sorted(fields(model).items()):
        for place, number in enumerate(numbers if name in KNOWN else ()):
            if number not in (0, -1):
                digest = added(digest, [sum(name.encode()), place, number])
    return f"{digest:016x}"


if __name__ == "__main__":
    of_texts(models("random"), digest)
