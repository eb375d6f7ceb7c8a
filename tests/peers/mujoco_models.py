#!/usr/bin/env python3
"""Records what libmujoco makes of a model that is changed, and of its functions beside `mj_step`, to the last bit.

    pip install mujoco==3.12.0
    python mujoco_models.py OUT.json      run again with mujoco==4.0.0: the file gets a second version

The model has joints, contacts, a tendon, actuators and sensors; `crates/mujoco-engine/tests/it/changes.rs` replays the file.
"""
import json
import os
import sys

import mujoco
import numpy as np

XML = """<mujoco>
  <option><flag energy="enable"/></option>
  <worldbody>
    <geom name="floor" type="plane" size="5 5 .1"/>
    <body name="upper" pos="0 0 .6"><joint name="j0" axis="0 1 0" damping=".1"/>
      <geom name="g0" type="capsule" fromto="0 0 0 .4 0 0" size=".04"/><site name="s0" pos=".1 0 .05"/>
      <body name="lower" pos=".4 0 0"><joint name="j1" axis="0 1 .3" range="-120 60" stiffness=".5" frictionloss=".05"/>
        <geom name="g1" type="capsule" fromto="0 0 0 .35 0 0" size=".03"/><site name="s1" pos=".35 0 0"/></body></body>
    <body name="box" pos="-.5 .1 .12"><freejoint/><geom name="g2" type="box" size=".1 .08 .12"/></body>
    <body name="ball" pos=".1 .6 .11"><joint name="x" type="slide" axis="1 0 0"/><joint type="slide" axis="0 0 1"/><geom name="g3" size=".1"/></body>
  </worldbody>
  <tendon><fixed name="t"><joint joint="j0" coef="1"/><joint joint="j1" coef="-.5"/></fixed>
    <spatial name="u" stiffness="3" damping=".2" springlength=".2"><site site="s0"/><site site="s1"/></spatial></tendon>
  <equality><joint joint1="j1" joint2="x" polycoef="0 .5 0 0 0" solref=".1 1"/></equality>
  <actuator><motor joint="j0" gear="2"/><position tendon="t" kp="5"/></actuator>
  <sensor><accelerometer site="s1"/><velocimeter site="s1"/><framepos objtype="body" objname="lower"/></sensor>
</mujoco>"""
CHANGES = [
    ["opt.gravity", None, [0.5, 0.0, -3.0]],
    ["opt.timestep", None, 0.005],
    ["body_mass", 1, 3.0],
    ["body_mass", 4, 0.7],
    ["body_inertia", 3, [0.02, 0.03, 0.025]],
    ["body_pos", 2, [0.3, 0.05, 0.0]],
    ["body_pos", 3, [-0.5, 0.1, 0.3]],
    ["geom_size", 3, [0.09, 0.07, 0.11]],
    ["geom_friction", 0, [0.2, 0.01, 0.001]],
    ["geom_margin", 0, 0.02],
    ["dof_damping", 0, 0.9],
    ["dof_armature", 1, 0.05],
    ["dof_frictionloss", 0, 0.3],
    ["jnt_stiffness", 1, 4.0],
    ["jnt_range", 1, [-0.4, 0.3]],
    ["actuator_gear", 0, [7.0, 0.0, 0.0, 0.0, 0.0, 0.0]],
    ["actuator_gainprm", 1, [9.0]],
    ["tendon_stiffness", 1, 20.0],
    ["site_pos", 1, [0.2, 0.0, 0.1]],
]


def state(d):
    return {name: getattr(d, name).ravel().tolist() for name in ("qpos", "qvel", "sensordata")}


def control(d, step):
    for i in range(len(d.ctrl)):
        d.ctrl[i] = ((7 * step + 3 * i) % 11) / 5 - 1


def steps(m, count=50, step=mujoco.mj_step):
    d = mujoco.MjData(m)
    for i in range(count):
        control(d, i)
        step(m, d)
    return d


def changed(change, constants):
    m = mujoco.MjModel.from_xml_string(XML)
    name, index, value = change
    if name.startswith("opt."):
        setattr(m.opt, name[4:], value)
    elif isinstance(value, list):
        getattr(m, name)[index][: len(value)] = value
    else:
        getattr(m, name)[index] = value
    if constants:
        mujoco.mj_setConst(m, mujoco.MjData(m))
    return state(steps(m))


def main():
    out = sys.argv[1]
    whole = json.load(open(out)) if os.path.exists(out) else {"xml": XML, "changes": CHANGES, "versions": {}}
    m = mujoco.MjModel.from_xml_string(XML)

    def halves(m, d):
        mujoco.mj_step1(m, d)
        mujoco.mj_step2(m, d)

    def applied(m, d):
        d.qfrc_applied[0], d.xfrc_applied[3] = 0.3, [0.1, 0.2, 0.3, 0.01, 0.02, 0.03]
        mujoco.mj_step(m, d)

    rk4 = mujoco.MjModel.from_xml_string(XML)
    rk4.opt.integrator = mujoco.mjtIntegrator.mjINT_RK4
    inverse = steps(m)
    inverse.qacc[:] = [i / 8 - 0.5 for i in range(m.nv)]
    mujoco.mj_inverse(m, inverse)
    at = steps(m)
    mujoco.mj_forward(m, at)
    mujoco.mj_energyPos(m, at)
    mujoco.mj_energyVel(m, at)
    jac = np.zeros((2, 3, m.nv))
    mujoco.mj_jacSite(m, at, jac[0], jac[1], m.site("s1").id)
    forces = np.zeros((at.ncon, 6))
    for i in range(at.ncon):
        mujoco.mj_contactForce(m, at, i, forces[i])
    geom = np.zeros(1, np.int32)
    distance = mujoco.mj_ray(m, at, np.array([-0.45, 0.1, 2.0]), np.array([0.0, 0.01, -1.0]), None, 1, -1, geom)
    distance = distance if isinstance(distance, float) else float(distance)
    whole["versions"][mujoco.__version__] = {
        "written": [changed(change, False) for change in CHANGES],
        "constants": [changed(change, True) for change in CHANGES],
        "halves": state(steps(m, step=halves)),
        "halves_rk4": state(steps(rk4, step=halves)),
        "applied": state(steps(m, step=applied)),
        "inverse": {"qfrc_inverse": inverse.qfrc_inverse.tolist()} | state(inverse),
        "forward": {
            "energy": at.energy.tolist(),
            "jac": jac.ravel().tolist(),
            "contact_force": forces.ravel().tolist(),
            "ray": [distance, int(geom[0])],
        },
    }
    json.dump(whole, open(out, "w"), separators=(",", ":"))


if __name__ == "__main__":
    main()
