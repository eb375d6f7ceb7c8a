"""Compares the installed MuJoCo with the environments, stage by stage: `mujoco_versions.py [VERSION] [TASK...]`.

VERSION is the argument `mujoco` of the environments; without it, the one that repeats the installed version, or the newest. For each task it
plays an episode in Gymnasium and in rustgym, and prints the first step with a difference; then it puts each state of the episode into
MuJoCo's own data, runs `mj_forward` there and `set_state` here, and prints the stages that differ, the first one first: what comes
after it follows from it. Takes some minutes, and fails where a task differs. Needs gymnasium[mujoco] and rustgym.
"""

import sys
import warnings

import gymnasium
import mujoco
import numpy as np
import rustgym

warnings.filterwarnings("ignore")
gymnasium.logger.min_level = gymnasium.logger.ERROR

TASKS = ["InvertedPendulum", "InvertedDoublePendulum", "Reacher", "Swimmer", "HalfCheetah", "Hopper", "Walker2d", "Ant", "Pusher"]
TASKS += ["Humanoid", "HumanoidStandup"]
STEPS = 1000
# the arrays that a forward call computes, in the order of its stages
STAGES = {
    "kinematics": ["xanchor", "xaxis", "xpos", "xquat", "xmat", "xipos", "ximat", "geom_xpos", "geom_xmat", "site_xpos", "site_xmat"],
    "com": ["subtree_com", "cinert", "cdof"],
    "tendon": ["ten_length"],
    "velocity": ["cvel", "cdof_dot", "ten_velocity"],
    "passive": ["qfrc_passive"],
    "rne": ["qfrc_bias"],
    "actuation": ["actuator_force", "qfrc_actuator"],
    "acceleration": ["qfrc_smooth", "qacc_smooth"],
    "constraint": ["qacc", "qfrc_constraint"],
}


def same(a, b):
    return np.asarray(a, np.float64).tobytes() == np.asarray(b, np.float64).tobytes()


def play(task, version):
    """The first step with another observation, reward or end (None for no step), and Gymnasium's states."""
    theirs, ours = gymnasium.make(f"{task}-v5"), rustgym.make(f"{task}-v5", mujoco=version)
    theirs.action_space.seed(0)
    first, states, data = None, [], theirs.unwrapped.data

    def compare(step, a, b):
        nonlocal first
        # resets return the observation; steps also return reward and ends
        equal = same(a[0], b[0]) and (len(a) == 2 or a[1:4] == b[1:4])
        first = step if first is None and not equal else first

    compare(0, theirs.reset(seed=0), ours.reset(seed=0))
    for step in range(1, STEPS + 1):
        states.append((data.qpos.copy(), data.qvel.copy()))
        action = theirs.action_space.sample()
        result, own = theirs.step(action), ours.step(action)
        compare(step, result, own)
        if result[2] or result[3]:
            compare(step, theirs.reset(), ours.reset())
    return first, states


def stages(task, version, states):
    """For each stage with differences: the first array that differs, and the number of states in which one differs."""
    theirs, ours = gymnasium.make(f"{task}-v5").unwrapped, rustgym.make(f"{task}-v5", mujoco=version).unwrapped
    ours.reset(seed=0)
    found = {}
    for qpos, qvel in states[::10]:
        data = mujoco.MjData(theirs.model)
        data.qpos[:], data.qvel[:] = qpos, qvel
        mujoco.mj_forward(theirs.model, data)
        ours.set_state(qpos, qvel)
        own = ours._arrays()
        for stage, names in STAGES.items():
            if off := [name for name in names if not same(own[name], getattr(data, name))]:
                found.setdefault(stage, [off[0], 0])[1] += 1
    return found


def main():
    asked = sys.argv[1:]
    versions = rustgym.make("Ant-v5").unwrapped._made_of["versions"]
    short = ".".join(mujoco.__version__.split(".")[:2])
    known = next((name for name, equal in versions.items() if short in equal), max(versions, key=lambda name: float(name)))
    version = asked.pop(0) if asked and asked[0][0].isdigit() else known
    print(f"mujoco {mujoco.__version__} against the environments with mujoco={version!r}")
    differ = 0
    for task in asked or TASKS:
        first, states = play(task, version)
        moved = stages(task, version, states)
        differ += first is not None or bool(moved)
        told = ", ".join(f"{stage} ({name}) in {count} states" for stage, (name, count) in moved.items())
        print(f"{task}: {'equal' if first is None else f'differs from step {first}'}; {told or 'every stage equal'}", flush=True)
    print(f"{differ} of {len(asked or TASKS)} tasks differ")
    return 1 if differ else 0


if __name__ == "__main__":
    sys.exit(main())
