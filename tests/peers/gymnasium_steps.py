"""Steps and frames per second of Gymnasium, to set beside `cargo bench --package gym`.

    python3 -m venv venv && venv/bin/pip install "gymnasium[classic-control,toy-text]==1.4.0"
    venv/bin/python gymnasium_steps.py
"""
import time

import gymnasium

STEPS = 30_000
FRAMES = 300


def steps_per_second(env_id):
    env = gymnasium.make(env_id)
    env.reset(seed=0)
    env.action_space.seed(0)
    actions = [env.action_space.sample() for _ in range(STEPS)]
    start = time.perf_counter()
    for action in actions:
        _, _, terminated, truncated, _ = env.step(action)
        if terminated or truncated:
            env.reset()
    return STEPS / (time.perf_counter() - start)


def frames_per_second():
    env = gymnasium.make("CartPole-v1", render_mode="rgb_array")
    env.reset(seed=0)
    start = time.perf_counter()
    for _ in range(FRAMES):
        env.render()
    return FRAMES / (time.perf_counter() - start)


for env_id in ["Acrobot-v1", "Blackjack-v1", "CartPole-v1", "CliffWalking-v1", "FrozenLake-v1", "MountainCar-v0", "Pendulum-v1", "Taxi-v4"]:
    print(f"{env_id:20} {steps_per_second(env_id):>10.0f} steps/s")
print(f"{'CartPole-v1':20} {frames_per_second():>10.0f} frames/s")
