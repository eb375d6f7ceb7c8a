#!/usr/bin/env python3
"""Record digests of all that a forward call computes, and of single functions, for the test `results`.

    pip install mujoco==3.12.0        python record.py > 3.12.txt; repeat with 3.17.0 and 4.0.0

A line has the digests of the groups of results of one of the models of `parts` and `random`, in the order of `results`, after three steps from
random velocities under random controls, with random forces on joints and bodies; `-` if MuJoCo refuses the model or its motion diverges.
"""
import pathlib
import sys

import mujoco
import numpy as np

FOLDER = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(FOLDER.parent), str(FOLDER.parent / "parts"), str(FOLDER.parents[4] / "tests/peers")]
from digests import of_numbers, of_texts
from random_models import is_calm
from record import models

STEPS = 3


def jacobian(model, data):
    """The Jacobian of the constraints, with its zeros."""
    if not mujoco.mj_isSparse(model):
        # there may be room for more rows
        return data.efc_J[: data.nefc * model.nv]
    full = np.zeros((data.nefc, model.nv))
    for row in range(data.nefc):
        first = data.efc_J_rowadr[row]
        own = slice(first, first + data.efc_J_rownnz[row])
        full[row, data.efc_J_colind[own]] = data.efc_J[own]
    return full


def results(model, data, random):
    """The groups of results: each a list of arrays."""
    nv, drawn = model.nv, lambda: random.uniform(-1, 1, model.nv)
    yield [data.xpos, data.xquat, data.xmat, data.xipos, data.ximat, data.xanchor, data.xaxis, data.geom_xpos, data.geom_xmat, data.site_xpos, data.site_xmat]
    yield [data.subtree_com, data.cinert, data.cdof, data.cvel, data.cdof_dot, data.ten_length, data.ten_velocity, data.actuator_length, data.actuator_velocity]
    full, product, solution, x = np.zeros((nv, nv)), np.zeros(nv), np.zeros((1, nv)), drawn()
    mujoco.mj_fullM(model, data, full)
    mujoco.mj_mulM(model, data, product, x)
    mujoco.mj_solveM(model, data, solution, x[None])
    yield [full, product, solution, data.qLDiagInv]
    yield [data.act_dot, data.actuator_force, data.qfrc_actuator, data.qfrc_passive, data.qfrc_bias, data.qfrc_smooth, data.qacc_smooth]
    forces = np.zeros((data.ncon, 6))
    for number, force in enumerate(forces):
        mujoco.mj_contactForce(model, data, number, force)
    touching = data.contact
    yield [touching.dist, touching.pos, touching.frame, touching.includemargin, touching.friction, touching.solref, touching.solimp, touching.mu, touching.dim, touching.geom, touching.efc_address, forces]
    yield [jacobian(model, data), data.efc_pos, data.efc_margin, data.efc_diagA, data.efc_R, data.efc_D, data.efc_KBIP, data.efc_vel, data.efc_aref, data.efc_b, data.efc_force, data.qfrc_constraint, data.qacc]
    mujoco.mj_rnePostConstraint(model, data)
    mujoco.mj_energyPos(model, data)
    mujoco.mj_energyVel(model, data)
    place, turn = np.zeros((3, nv)), np.zeros((3, nv))
    mujoco.mj_jac(model, data, place, turn, data.xipos[-1], model.nbody - 1)
    positions, met = data.qpos.copy(), []
    mujoco.mj_integratePos(model, positions, data.qvel, 0.1)
    for _ in range(8):
        point, along, geom = random.uniform(-1, 1, 3), random.uniform(-1, 1, 3), np.zeros(1, np.int32)
        met.append([mujoco.mj_ray(model, data, point, along, None, True, -1, geom, None), geom[0]])
    yield [data.cfrc_ext, data.energy, place, turn, positions, met]
    data.qacc[:] = drawn()
    mujoco.mj_inverse(model, data)
    yield [data.qfrc_constraint, data.qfrc_inverse, data.sensordata]


def digest(text):
    random = np.random.RandomState(0)
    try:
        model = mujoco.MjModel.from_xml_string(text)
        data = mujoco.MjData(model)
        drawn = lambda *shape: random.uniform(-1, 1, shape)
        data.qvel[:] = drawn(model.nv)
        for _ in range(STEPS):
            data.ctrl[:] = drawn(model.nu)
            mujoco.mj_step(model, data)
        data.ctrl[:], data.qfrc_applied[:], data.xfrc_applied[:] = drawn(model.nu), drawn(model.nv), drawn(model.nbody, 6)
        mujoco.mj_forward(model, data)
        groups = [of_numbers(x + 0.0 for array in group for x in np.ravel(array)) for group in results(model, data, random)]
    except (ValueError, mujoco.FatalError):
        return "-"
    # zeros without a sign, and half of each digest
    return " ".join(f"{(digest ^ digest >> 32) % 2**32:08x}" for digest in groups) if is_calm(data) else "-"


if __name__ == "__main__":
    of_texts(models("random"), digest)
