"""Print rewards of Gymnasium-Robotics' hand near goals, for the test `rewards_near_goals_are_the_packages`.

    pip install gymnasium-robotics==1.4.2 gymnasium==1.4.0 mujoco==4.0.0
    python adroit_rewards.py

A line is the id, the state from which the step without action starts (the numbers of `qpos` that are not 0, and the places), and the reward.
"""

import gymnasium
import gymnasium_robotics
import numpy as np

gymnasium.register_envs(gymnasium_robotics)

CASES = [("AdroitHandDoor-v1", 30, {28: angle}, {"door_body_pos": [-0.05, 0.27, 0.29]}) for angle in (0.1, 0.3, 1.1, 1.4)]
CASES += [
    ("AdroitHandHammer-v1", 33, {26: nail, 28: up}, {"board_pos": [0.05, 0, 0.2]})
    for nail, up in ((0, 0), (0.075, 0), (0.085, 0), (0.085, 0.1), (0, -0.03))
]
CASES += [
    ("AdroitHandRelocate-v1", 36, {32: up}, {"obj_pos": [0, 0, 0.035], "target_pos": [x, 0, 0.035 + up]})
    for x, up in ((0.3, 0), (0.3, 0.1), (0.08, 0.1), (0.03, 0.1), (0.03, 0))
]

for name, size, numbers, places in CASES:
    qpos = np.zeros(size)
    for index, number in numbers.items():
        qpos[index] = number
    state = {"qpos": qpos, "qvel": np.zeros(size)} | {key: np.array(place) for key, place in places.items()}
    env = gymnasium.make(name)
    env.reset(seed=1, options={"initial_state_dict": state})
    _, reward, _, _, info = env.step(np.zeros(env.action_space.shape, np.float32))
    print(f"{name} {numbers} {places}: {float(reward)!r} {bool(info['success'])}")
