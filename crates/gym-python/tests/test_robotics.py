"""The tasks of Gymnasium-Robotics: goals through wrappers and vectors, options, maps, and learners."""

import importlib.util
import os

import gymnasium
import numpy as np
import pytest
import rustgym


def test_compute_reward_is_that_of_the_step():
    env = gymnasium.make("rustgym/PointMaze_UMazeDense-v3")
    observation, info = env.reset(seed=3)
    assert set(observation) == {"observation", "achieved_goal", "desired_goal"}
    assert info == {"success": False}
    for _ in range(20):
        observation, reward, terminated, truncated, info = env.step(env.action_space.sample())
        goals = observation["achieved_goal"], observation["desired_goal"]
        assert reward == env.unwrapped.compute_reward(*goals, info)
        assert type(reward) is np.float64
        assert env.unwrapped.compute_terminated(*goals, info) is terminated is False
        assert env.unwrapped.compute_truncated(*goals, info) is False
    assert env.get_wrapper_attr("compute_reward")(np.zeros(2), np.zeros(2), {}) == 1.0


def test_batches_of_goals():
    env = rustgym.Env("PointMaze_UMaze-v3", continuing_task=False)
    achieved, desired = np.array([[0.0, 0.0], [1.0, 1.0]]), np.array([[0.0, 0.4], [3.0, 1.0]])
    rewards = env.compute_reward(achieved, desired, [{}, {}])
    assert rewards.dtype == np.float64 and rewards.tolist() == [1.0, 0.0]
    assert env.compute_reward(achieved[:, None], desired[:, None], None).shape == (2, 1)
    assert env.compute_reward(achieved.astype(np.float32), desired[0], None).tolist() == [1.0, 0.0]
    assert env.compute_terminated(achieved, desired, {}).tolist() == [True, False]
    assert env.compute_terminated(achieved[0], desired[0], {}) is True
    with pytest.raises(ValueError, match="a goal has 2"):
        env.compute_reward(np.zeros(3), np.zeros(3), {})


def test_goals_of_a_vector():
    for envs in (
        gymnasium.make_vec("rustgym/PointMaze_UMaze-v3", num_envs=3, vectorization_mode="sync"),
        rustgym.VectorEnv("PointMaze_UMaze-v3", 3, kind="sync"),
    ):
        envs.reset(seed=0)
        assert envs.call("compute_reward", np.zeros(2), np.zeros(2), {}) == (1.0, 1.0, 1.0)


def test_options_and_maps():
    maze_map = [[1, 1, 1, 1], [1, "r", 0, "g"], [1, 1, 1, 1]]
    env = gymnasium.make("rustgym/AntMaze_UMaze-v5", maze_map=maze_map, max_episode_steps=5)
    observation, info = env.reset(seed=1)
    assert (np.abs(observation["desired_goal"] - [6, 0]) <= 1).all()
    assert (np.abs(observation["achieved_goal"] - [-2, 0]) <= 1).all()
    assert "x_position" in info and info["success"] is False
    for step in range(5):
        *_, truncated, info = env.step(env.action_space.sample())
    assert truncated and "reward_forward" in info
    env = gymnasium.make("rustgym/PointMaze_Medium-v3")
    observation, _ = env.reset(seed=1, options={"goal_cell": np.array([1, 1]), "reset_cell": np.array([6, 6])})
    assert (np.abs(observation["desired_goal"] - [-2.5, 2.5]) <= 0.25).all()
    with pytest.raises(ValueError, match="goal_cell.*is a wall"):
        env.reset(options={"goal_cell": [0, 0]})
    with pytest.raises(ValueError, match="row 0, column 1 is 2"):
        gymnasium.make("rustgym/PointMaze_UMaze-v3", maze_map=[[0, 2]])


def test_a_state_of_the_hand():
    env = gymnasium.make("rustgym/AdroitHandDoor-v1")
    state = {"qpos": np.zeros(30), "qvel": np.zeros(30), "door_body_pos": np.array([-0.25, 0.3, 0.3])}
    first, _ = env.reset(seed=1, options={"initial_state_dict": state})
    again, _ = env.reset(seed=2, options={"initial_state_dict": state})
    assert (first == again).all()
    assert env.action_space == gymnasium.spaces.Box(-1, 1, (28,), np.float32)
    _, reward, _, _, info = env.step(env.action_space.sample())
    assert type(reward) is np.float64 and info == {"success": False}
    with pytest.raises(ValueError, match="door_body_pos"):
        env.reset(options={"initial_state_dict": {"qpos": np.zeros(30), "qvel": np.zeros(30)}})


@pytest.fixture
def models():
    """Skips a test without the models of the package."""
    folder = os.environ.get("GYMNASIUM_ROBOTICS_ASSETS")
    if not folder and importlib.util.find_spec("gymnasium_robotics") is None:
        pytest.skip("there are no models of gymnasium-robotics")


def test_without_models_an_error_says_what_to_install(tmp_path):
    with pytest.raises(ValueError, match=r"pip install gymnasium-robotics==1\.4\.2.*GYMNASIUM_ROBOTICS_ASSETS"):
        gymnasium.make("rustgym/FetchReach-v4", assets=str(tmp_path))


def test_fetch(models):
    env = gymnasium.make("rustgym/FetchPickAndPlaceDense-v4")
    observation, info = env.reset(seed=3)
    assert {name: part.shape for name, part in observation.items()} == {"achieved_goal": (3,), "desired_goal": (3,), "observation": (25,)}
    assert info == {} and env.action_space == gymnasium.spaces.Box(-1, 1, (4,), np.float32)
    observation, reward, terminated, _, info = env.step(env.action_space.sample())
    goals = observation["achieved_goal"], observation["desired_goal"]
    assert reward == env.unwrapped.compute_reward(*goals, info) == -np.linalg.norm(goals[0] - goals[1], axis=-1)
    assert not terminated and info == {"is_success": 0.0}
    assert type(env.unwrapped).__name__ == "MujocoFetchPickAndPlaceEnv"
    assert env.unwrapped.metadata["render_modes"] == ["human", "rgb_array"] and env.unwrapped.metadata["render_fps"] == 25


def test_hand(models):
    env = gymnasium.make("rustgym/HandManipulatePen_BooleanTouchSensors-v1")
    observation, _ = env.reset(seed=3)
    assert observation["observation"].shape == (153,) and set(observation["observation"][61:]) <= {0.0, 1.0}
    assert type(env.unwrapped).__name__ == "MujocoHandPenTouchSensorsEnv"
    with pytest.raises(ValueError, match="target_rotation"):
        gymnasium.make("rustgym/HandManipulatePen-v1", target_rotation="fixed")


def test_kitchen(models):
    env = gymnasium.make("rustgym/FrankaKitchen-v1", tasks_to_complete=["microwave", "kettle"])
    observation, info = env.reset(seed=3)
    tasks = ["kettle", "microwave"]
    assert info == {"tasks_to_complete": tasks, "step_task_completions": [], "episode_task_completions": []}
    assert {name: goal.shape for name, goal in observation["desired_goal"].items()} == {"kettle": (7,), "microwave": (1,)}
    assert observation in env.observation_space and env.action_space.dtype == np.float64
    observation, reward, *_, info = env.step(env.action_space.sample())
    assert info["tasks_to_complete"] == tasks
    goals = observation["achieved_goal"], observation["desired_goal"]
    assert env.unwrapped.compute_reward(*goals, info) == reward == 0.0
    assert env.unwrapped.compute_reward(goals[1], goals[1], info) == 2.0


def test_her_trains():
    sb3 = pytest.importorskip("stable_baselines3")
    env = gymnasium.make("rustgym/PointMaze_UMaze-v3", max_episode_steps=30)
    model = sb3.SAC(
        "MultiInputPolicy",
        env,
        replay_buffer_class=sb3.HerReplayBuffer,
        replay_buffer_kwargs={"n_sampled_goal": 4},
        learning_starts=100,
        batch_size=32,
        policy_kwargs={"net_arch": [16]},
        seed=0,
    )
    model.learn(160)
    # goals that were achieved later are worth 1
    batch = model.replay_buffer.sample(256)
    assert 0 < float(batch.rewards.mean()) < 1
