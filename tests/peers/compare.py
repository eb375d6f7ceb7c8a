"""The same work here and in other libraries, in one run, as ratios.

    python3 -m venv venv && venv/bin/pip install -r tests/peers/requirements.txt
    venv/bin/python tests/peers/compare.py [--seconds 1] [--json FILE]

Run it from the project's root. Everything runs on one core. Each number is the best of several slices of
time, ours and theirs in turn, so that a noisy machine slows all of them alike; read the ratios.
"""
import argparse
import json
import os
import subprocess
import tempfile
import time
import warnings

os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})  # also for the processes that this script starts
os.environ.setdefault("XLA_FLAGS", "--xla_cpu_multi_thread_eigen=false intra_op_parallelism_threads=1")
warnings.filterwarnings("ignore")

import envpool
import gymnasium
import numpy as np

gymnasium.logger.min_level = gymnasium.logger.ERROR

N = 1024
SMALL = {"CarRacing-v3": 16}  # fewer sub-environments for slow environments
BOX2D_N = 64
SLICES = 5
FRAMES = 500  # frames of the GIF

CLASSIC = ["CartPole-v1", "MountainCar-v0", "MountainCarContinuous-v0", "Pendulum-v1", "Acrobot-v1"]
TOY_TEXT = ["Blackjack-v1", "CliffWalking-v1", "FrozenLake-v1", "Taxi-v4"]
BOX2D = ["LunarLander-v3", "BipedalWalker-v3", "BipedalWalkerHardcore-v3", "CarRacing-v3"]
ENVPOOL_NAMES = {"CliffWalking-v1": "CliffWalking-v0", "Taxi-v4": "Taxi-v3"}
GYMNAX = ["CartPole-v1", "MountainCar-v0", "MountainCarContinuous-v0", "Pendulum-v1", "Acrobot-v1"]


def best(round_, steps, seconds):
    """The steps per second of the fastest slice. A call of `round_` takes `steps` steps."""
    round_()
    rates = []
    for _ in range(SLICES):
        done, start = 0, time.perf_counter()
        while (elapsed := time.perf_counter() - start) < seconds / SLICES:
            round_()
            done += steps
        rates.append(done / elapsed)
    return max(rates)


def ours(env_id, kind, num_envs, seconds):
    with tempfile.NamedTemporaryFile(suffix=".json") as out:
        command = ["cargo", "xtask", "bench", env_id, "--kind", kind]
        command += ["--num-envs", str(num_envs), "--seconds", str(seconds), "--json", out.name]
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
        rows = json.load(open(out.name))["rows"]
    return rows[0]["per_second"] if rows else None


def gymnasium_steps(env_id, seconds, render_mode=None):
    env = gymnasium.make(env_id, render_mode=render_mode)
    env.reset(seed=0)
    env.action_space.seed(0)
    actions = iter([env.action_space.sample() for _ in range(1000)] * 100_000)

    def round_():
        for _ in range(10):
            _, _, terminated, truncated, _ = env.step(next(actions))
            if render_mode:
                env.render()
            if terminated or truncated:
                env.reset()

    return best(round_, 10, seconds)


def gymnasium_vector(env_id, num_envs, seconds):
    envs = gymnasium.make_vec(env_id, num_envs=num_envs)
    envs.reset(seed=0)
    actions = envs.action_space.sample()
    return best(lambda: envs.step(actions), num_envs, seconds)


def our_gif():
    """The seconds that a GIF takes here, and its bytes."""
    with tempfile.NamedTemporaryFile(suffix=".json") as out:
        command = ["cargo", "xtask", "bench", "CartPole-v1"]
        command += ["--kind", "frames", "--gif", "--seconds", "0.1", "--json", out.name]
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
        gif = json.load(open(out.name))["gif"]
    return gif["seconds"], gif["bytes"]


def moviepy_gif():
    """The same for moviepy, with the same frames: episodes of random actions, each from its own seed."""
    from moviepy import ImageSequenceClip

    with tempfile.NamedTemporaryFile(suffix=".gif") as out:
        start = time.perf_counter()
        env = gymnasium.make("CartPole-v1", render_mode="rgb_array")
        frames, seed = [], 0
        while len(frames) < FRAMES:
            env.reset(seed=seed)
            env.action_space.seed(seed)
            frames.append(env.render())
            done = False
            while not done:
                _, _, terminated, truncated, _ = env.step(env.action_space.sample())
                frames.append(env.render())
                done = terminated or truncated
            seed += 1
        ImageSequenceClip(frames[:FRAMES], fps=env.metadata["render_fps"]).write_gif(out.name, logger=None)
        return time.perf_counter() - start, os.path.getsize(out.name)


def envpool_vector(env_id, num_envs, seconds):
    envs = envpool.make_gymnasium(ENVPOOL_NAMES.get(env_id, env_id), num_envs=num_envs, num_threads=1)
    envs.reset()
    actions = np.stack([envs.action_space.sample() for _ in range(num_envs)])
    return best(lambda: envs.step(actions), num_envs, seconds)


def gymnax_vector(env_id, num_envs, seconds):
    import gymnax
    import jax

    env, params = gymnax.make("MountainCarContinuous-v0" if "Continuous" in env_id else env_id)
    length = 100

    @jax.jit
    def roll_out(key, state):
        def step(carry, _):
            key, state = carry
            key, act, move = jax.random.split(key, 3)
            actions = jax.vmap(env.action_space(params).sample)(jax.random.split(act, num_envs))
            obs, state, reward, done, _ = jax.vmap(env.step, (0, 0, 0, None))(jax.random.split(move, num_envs), state, actions, params)
            return (key, state), reward.sum()

        return jax.lax.scan(step, (key, state), None, length)

    key = jax.random.key(0)
    _, state = jax.vmap(env.reset, (0, None))(jax.random.split(key, num_envs), params)
    return best(lambda: jax.block_until_ready(roll_out(key, state)), num_envs * length, seconds)


def attempt(measure, *arguments):
    """The result of `measure`, or None if the library does not have the environment."""
    try:
        return measure(*arguments)
    except Exception as error:  # each library raises an exception of its own
        print(f"  ({measure.__name__} of {arguments[0]}: {type(error).__name__}: {str(error)[:100]})")
        return None


def rows(seconds):
    for env_id in CLASSIC + TOY_TEXT + BOX2D:
        yield f"{env_id}, one environment", ours(env_id, "make", 1, seconds), {"Gymnasium": attempt(gymnasium_steps, env_id, seconds)}
    for env_id in CLASSIC + TOY_TEXT + BOX2D:
        n = SMALL.get(env_id, BOX2D_N) if env_id in BOX2D else N
        mine = ours(env_id, "native", n, seconds) or ours(env_id, "sync", n, seconds)
        theirs = {"Gymnasium": attempt(gymnasium_vector, env_id, n, seconds), "EnvPool": attempt(envpool_vector, env_id, n, seconds)}
        if env_id in GYMNAX:
            theirs["gymnax"] = attempt(gymnax_vector, env_id, n, seconds)
        yield f"{env_id}, vector of {n}", mine, theirs
    for env_id in ["CartPole-v1", "LunarLander-v3"]:
        yield f"{env_id}, frames", ours(env_id, "frames", 1, seconds), {"Gymnasium": attempt(gymnasium_steps, env_id, seconds, "rgb_array")}
    (seconds, size), (their_seconds, their_size) = our_gif(), moviepy_gif()
    work = f"CartPole-v1, frames to a GIF ({FRAMES} frames: {size / 1000:.0f} kB, moviepy {their_size / 1000:.0f} kB)"
    yield work, FRAMES / seconds, {"Gymnasium and moviepy": FRAMES / their_seconds}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seconds", type=float, default=1.0, help="for each number")
    parser.add_argument("--json", help="writes the numbers to a file")
    arguments = parser.parse_args()
    table = []
    print("| work | this library, per second | others, per second (how many times as fast we are) |\n|---|---|---|")
    for work, mine, theirs in rows(arguments.seconds):
        others = ", ".join(f"{name} {rate:,.0f} ({mine / rate:.1f}x)" for name, rate in theirs.items() if rate)
        print(f"| {work} | {mine:,.0f} | {others} |", flush=True)
        table.append({"work": work, "ours": mine, "theirs": theirs})
    if arguments.json:
        with open(arguments.json, "w") as file:
            json.dump(table, file, indent=1)


if __name__ == "__main__":
    main()
