"""What learning libraries need of vectors: pixels, dm_env's time steps, steps inside JAX."""

from __future__ import annotations

import itertools
from typing import Any

import gymnasium
import numpy as np
import pytest
from conftest import assert_same

import rustgym


@pytest.mark.parametrize("env_id", ["CartPole-v1", "FrozenLake-v1", "LunarLander-v3", "HalfCheetah-v5", "CarRacing-v3"])
def test_pixels(env_id: str) -> None:
    envs = rustgym.make_vec(env_id, num_envs=2, render_size=(60, 40), gray=True, frame_stack=4)
    assert envs.single_observation_space.shape == (4, 40, 60) and envs.observation_space.dtype == np.uint8
    first, _ = envs.reset(seed=0)
    envs.action_space.seed(0)
    for _ in range(5):
        last = envs.step(envs.action_space.sample())[0]
    assert first.shape == last.shape == (2, 4, 40, 60) and last.std() > 1
    assert not np.array_equal(first[0], last[0])
    coloured = rustgym.make_vec(env_id, num_envs=2, render_size=(60, 40))
    colours, _ = coloured.reset(seed=0)
    assert colours.shape == (2, 40, 60, 3)
    assert_same(np.array(coloured.render()), colours)
    # the newest picture of the stack is gray by Gymnasium's weights
    gray = (colours[0] @ np.array([0.2125, 0.7154, 0.0721])).astype(np.uint8)
    assert np.abs(gray.astype(int) - first[0, -1]).max() <= 1


def test_pixels_that_cannot_be() -> None:
    with pytest.raises(ValueError, match="render_size is 0"):
        rustgym.make_vec("CartPole-v1", num_envs=2, render_size=(0, 84))
    with pytest.raises(ValueError, match="need render_mode"):
        rustgym.make_vec("CartPole-v1", num_envs=2, gray=True, render_mode="human")
    envs = rustgym.make_vec("CartPole-v1", num_envs=2, render_size=(30, 20), render_mode="rgb_array")
    assert envs.reset(seed=0)[0].shape == (2, 4) and envs.render()[0].shape == (20, 30, 3)


def test_dm_env() -> None:
    dm_env = pytest.importorskip("dm_env")
    env = rustgym.dm_env.make("CartPole-v1", seed=3, max_episode_steps=12)
    twin = rustgym.make("CartPole-v1", max_episode_steps=12)
    timestep = env.reset()
    assert timestep.first() and timestep.reward is None
    assert_same(timestep.observation, twin.reset(seed=3)[0])
    ends = set()
    rng = np.random.default_rng(0)
    for k in range(300):
        action = int(rng.integers(2)) if k % 40 < 20 else k % 2
        timestep = env.step(action)
        env.observation_spec().validate(timestep.observation)
        if timestep.first():
            assert_same(timestep.observation, twin.reset()[0])
            continue
        observation, reward, terminated, truncated, _ = twin.step(action)
        assert_same(timestep.observation, observation)
        assert timestep.reward == reward and timestep.last() == (terminated or truncated)
        assert timestep.discount == (0.0 if terminated else 1.0)
        ends.add((terminated, truncated))
    assert {(True, False), (False, True)} < ends, "it falls, and it reaches the limit"
    env.action_spec().validate(np.int64(1))
    assert isinstance(env, dm_env.Environment)


@pytest.mark.parametrize("env_id", ["Blackjack-v1", "FrozenLake-v1", "Pendulum-v1", "HalfCheetah-v5", "CarRacing-v3"])
def test_dm_envs_specs(env_id: str) -> None:
    pytest.importorskip("dm_env")
    env = rustgym.dm_env.make(env_id, seed=0)
    timestep, spec = env.reset(), env.observation_spec()
    for part, seen in zip(spec, timestep.observation, strict=True) if isinstance(spec, tuple) else [(spec, timestep.observation)]:
        part.validate(seen)
    assert not env.step(env.action_spec().generate_value()).first()


def test_jax() -> None:
    jax = pytest.importorskip("jax")
    from rustgym.jax import Stepper

    def policy(observations: Any) -> Any:
        return (observations[:, 2] > 0).astype(np.int32)

    stepper, twin = Stepper(rustgym.VectorEnv("CartPole-v1", 3)), rustgym.VectorEnv("CartPole-v1", 3)
    carry, observations = stepper.reset(seed=0)

    @jax.jit
    def play(carry: Any, observations: Any) -> Any:
        def step(state: Any, _: Any) -> Any:
            carry, result = stepper.step(state[0], policy(state[1]))
            return (carry, result.observations), (result.rewards, result.terminated)

        return jax.lax.scan(step, (carry, observations), None, length=80)

    (last, seen), (rewards, terminated) = play(carry, observations)
    expected, _ = twin.reset(seed=0)
    for k in range(80):
        expected, reward, end, _, _ = twin.step(np.asarray(policy(expected)))
        assert_same(np.asarray(rewards[k]), reward.astype(np.float32))
        assert_same(np.asarray(terminated[k]), end)
    assert_same(np.asarray(seen), expected)
    assert int(last) == 80 and bool(np.any(terminated))
    with pytest.raises(Exception, match="pass on the carry"):
        jax.block_until_ready(stepper.step(carry, policy(observations)))


@pytest.mark.parametrize("mode", ["NextStep", "SameStep"])
@pytest.mark.parametrize("kind", ["sync", "native", "async"])
@pytest.mark.parametrize("env_id", ["CartPole-v1", "Taxi-v4"])
def test_seeds_of_resets_to_come(env_id: str, kind: str, mode: str) -> None:
    n, steps = 3, 90
    envs = rustgym.make_vec(env_id, num_envs=n, kind=kind, autoreset_mode=mode, seeds=itertools.count(100), max_episode_steps=17)
    plain = rustgym.make_vec(env_id, num_envs=n, kind=kind, autoreset_mode=mode, max_episode_steps=17)
    singles = [rustgym.make(env_id, max_episode_steps=17) for _ in range(n)]
    seeds = iter(range(100, 200))
    first, _ = envs.reset()
    plain.reset(seed=list(range(100, 100 + n)))
    assert_same(first, np.array([env.reset(seed=next(seeds))[0] for env in singles], first.dtype))
    due: dict[int, int] = {}
    rng = np.random.default_rng(0)
    for k in range(steps):
        actions = rng.integers(2, size=n)
        observations, rewards, terminated, truncated, infos = envs.step(actions)
        if k < 8:  # no episode has ended: the vector must equal one without `seeds`
            assert_same((observations, rewards, terminated, truncated, infos), plain.step(actions))
        ended = []
        for i, env in enumerate(singles):
            if i in due:
                observation, reward, end, cut, info = env.reset(seed=due.pop(i))[0], 0.0, False, False, {}
            else:
                observation, reward, end, cut, info = env.step(int(actions[i]))
            if end or cut:
                ended.append(i)
                if mode == "SameStep":
                    assert_same(infos["final_obs"][i], observation)
                    assert infos["_final_obs"][i] and infos["_final_info"][i]
                    for key, value in info.items():
                        assert infos["final_info"][f"_{key}"][i]
                        assert_same(infos["final_info"][key][i], value)
            elif info:
                for key, value in info.items():
                    assert infos[f"_{key}"][i]
                    assert_same(infos[key][i], value)
            if not (mode == "SameStep" and i in ended):
                assert_same(observations[i], observation)
            assert (rewards[i], terminated[i], truncated[i]) == (reward, end, cut)
        for i in ended:
            due[i] = next(seeds)
            if mode == "SameStep":
                assert_same(observations[i], singles[i].reset(seed=due.pop(i))[0])
    assert next(seeds) > 110


def test_a_list_of_seeds_ends() -> None:
    envs = rustgym.make_vec("CartPole-v1", num_envs=2, seeds=[1, 2], max_episode_steps=3)
    envs.reset()
    envs.step([0, 0])
    envs.step([0, 0])
    with pytest.raises(gymnasium.error.Error, match="the 2 seeds are used up"):
        envs.step([0, 0])
    with pytest.raises(gymnasium.error.Error, match="Seed 0 must be a whole number"):
        rustgym.make_vec("CartPole-v1", num_envs=2, seeds=["x"]).reset()


def test_hindsight_replay_trains_on_a_maze() -> None:
    pytest.importorskip("stable_baselines3")
    from stable_baselines3 import SAC, HerReplayBuffer

    env = rustgym.make("PointMaze_UMaze-v3", max_episode_steps=50)
    model = SAC(
        "MultiInputPolicy",
        env,
        replay_buffer_class=HerReplayBuffer,
        replay_buffer_kwargs={"n_sampled_goal": 4, "goal_selection_strategy": "future"},
        learning_starts=60,
        batch_size=32,
        train_freq=32,
        policy_kwargs={"net_arch": [16]},
        seed=0,
        device="cpu",
    )
    model.learn(160)
    assert model.num_timesteps == 160 and model._n_updates > 0
    batch = model.replay_buffer.sample(256)
    reached, wanted = (batch.next_observations[key].numpy() for key in ("achieved_goal", "desired_goal"))
    own = env.reset(seed=0)[0]["desired_goal"]
    assert len(np.unique(wanted, axis=0)) > 10 and own.shape == (2,), "goals were taken from later steps"
    expected = env.unwrapped.compute_reward(reached, wanted, {})
    assert np.array_equal(batch.rewards.numpy()[:, 0], expected) and expected.any()
