"""minigrid's wrappers give the same results around our environments as around its own, and find the attributes they read."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from conftest import assert_same

import rustgym
from rustgym._specs import class_of, registered, spec_of
from rustgym.envs.minigrid import Grid

minigrid = pytest.importorskip("minigrid")
import gymnasium  # noqa: E402
from minigrid import wrappers  # noqa: E402

IDS = [
    "MiniGrid-Empty-5x5-v0",
    "MiniGrid-Empty-Random-6x6-v0",
    "MiniGrid-DoorKey-5x5-v0",
    "MiniGrid-FourRooms-v0",
    "MiniGrid-LavaCrossingS9N2-v0",
    "MiniGrid-Dynamic-Obstacles-6x6-v0",
    "MiniGrid-Unlock-v0",
    "MiniGrid-KeyCorridorS3R2-v0",
    "MiniGrid-MultiRoom-N2-S4-v0",
    "BabyAI-GoToLocal-v0",
]
GOALS = IDS[:6]
WRAPPERS: dict[str, Any] = {
    "ImgObsWrapper": wrappers.ImgObsWrapper,
    "OneHotPartialObsWrapper": wrappers.OneHotPartialObsWrapper,
    "RGBImgObsWrapper": lambda env: wrappers.RGBImgObsWrapper(env, tile_size=4),
    "RGBImgPartialObsWrapper": lambda env: wrappers.RGBImgPartialObsWrapper(env, tile_size=4),
    "FullyObsWrapper": wrappers.FullyObsWrapper,
    "DictObservationSpaceWrapper": wrappers.DictObservationSpaceWrapper,
    "FlatObsWrapper": wrappers.FlatObsWrapper,
    "ViewSizeWrapper 3": lambda env: wrappers.ViewSizeWrapper(env, agent_view_size=3),
    "ViewSizeWrapper 9": lambda env: wrappers.ViewSizeWrapper(env, agent_view_size=9),
    "DirectionObsWrapper": lambda env: wrappers.DirectionObsWrapper(env, type="angle"),
    "SymbolicObsWrapper": wrappers.SymbolicObsWrapper,
    "ReseedWrapper": lambda env: wrappers.ReseedWrapper(env, seeds=(3, 4)),
    "ActionBonus": wrappers.ActionBonus,
    "PositionBonus": wrappers.PositionBonus,
    "NoDeath": lambda env: wrappers.NoDeath(env, no_death_types=("lava",), death_cost=-0.5),
}


@pytest.mark.parametrize("name", WRAPPERS)
def test_wrappers_of_minigrid_see_the_same(name: str) -> None:
    for env_id in GOALS if name == "DirectionObsWrapper" else IDS:
        if name == "DictObservationSpaceWrapper" and env_id.startswith("BabyAI"):
            continue  # the wrapper's table of words lacks those of BabyAI
        envs = [WRAPPERS[name](make(env_id)) for make in (rustgym.make, gymnasium.make)]
        actions = np.random.default_rng(5).integers(0, 3 if "Obstacles" in env_id else 6, 60).tolist()
        seen = [env.reset(seed=2)[0] for env in envs]
        assert_same(seen[0], seen[1], f"{env_id} reset")
        for i, action in enumerate(actions):
            ours, theirs = (env.step(action) for env in envs)
            assert_same(ours[:4], theirs[:4], f"{env_id} step {i}")
            if ours[2] or ours[3]:
                ours, theirs = (env.reset()[0] for env in envs)
                assert_same(ours, theirs, f"{env_id} reset after step {i}")


@pytest.mark.parametrize("env_id", IDS)
def test_attributes_are_those_of_minigrid(env_id: str) -> None:
    ours, theirs = (make(env_id).unwrapped for make in (rustgym.make, gymnasium.make))
    for env in (ours, theirs):
        env.reset(seed=1)
        env.step(1)
    for name in "width height agent_pos agent_dir front_pos mission step_count max_steps agent_view_size see_through_walls".split():
        a, b = getattr(ours, name), getattr(theirs, name)
        assert np.array_equal(a, b), f"{name}: {a} is not {b}"
    assert_same(ours.grid.encode(), theirs.grid.encode(), "grid")
    for size in (3, 7, 11):
        (grid, mask), (their_grid, their_mask) = (env.gen_obs_grid(size) for env in (ours, theirs))
        assert_same(mask, their_mask, f"cells seen of {size}")
        assert_same(grid.encode(mask), their_grid.encode(their_mask), f"view of {size}")


@pytest.mark.parametrize("env_id", IDS)
def test_a_grid_without_the_package_has_its_cells(env_id: str) -> None:
    theirs: Any = gymnasium.make(env_id).unwrapped
    theirs.reset(seed=1)
    image, mask = theirs.grid.encode(), np.random.default_rng(0).integers(2, size=(theirs.width, theirs.height)).astype(bool)
    grid = Grid(image)
    assert (grid.width, grid.height, len(grid.grid)) == (theirs.width, theirs.height, theirs.width * theirs.height)
    for i in range(grid.width):
        for j in range(grid.height):
            cell, expected = grid.get(i, j), theirs.grid.get(i, j)
            assert cell is grid.grid[j * grid.width + i]
            if expected is None:
                assert cell is None
            else:
                assert cell is not None and (cell.type, cell.color, cell.state) == (expected.type, expected.color, expected.encode()[2])
    assert_same(grid.encode(), image)
    assert_same(grid.encode(mask), theirs.grid.encode(mask))
    grid.encode()[:] = 0
    assert_same(grid.encode(), image)
    with pytest.raises(gymnasium.error.DependencyNotInstalled) as raised:
        grid.set(1, 1, None)
    assert str(raised.value) == "a grid can be changed with the package minigrid: run `pip install minigrid`"


def test_actions_beyond_three_turn_left_before_dynamic_obstacles() -> None:
    ours, theirs = (
        make("MiniGrid-Dynamic-Obstacles-6x6-v0") for make in (rustgym.make, gymnasium.make)
    )
    for env in (ours, theirs):
        env.reset(seed=3)
    for action in (3, 4, np.int64(5), 6, 7, 100, 2, 3):
        a, b = (env.step(action) for env in (ours, theirs))
        assert_same(a[:4], b[:4], f"action {action}")
        if b[2] or b[3]:
            for env in (ours, theirs):
                env.reset()
    with pytest.raises(Exception, match="invalid action"):
        ours.step("left")


def test_names_of_classes() -> None:
    ids = [env_id for env_id in rustgym.ids() if spec_of(env_id)["crate"] == "gym-minigrid"]
    assert len(ids) == 172
    for env_id in ids:
        theirs = registered(env_id)
        assert theirs is not None and class_of(env_id).__name__ == str(theirs.entry_point).partition(":")[2], env_id
    text = "<OrderEnforcing<PassiveEnvChecker<EmptyEnv<MiniGrid-Empty-8x8-v0>>>>"
    assert str(rustgym.make("MiniGrid-Empty-8x8-v0")) == text


#: Wide, high and square.
SHAPES = [f"MiniGrid-{name}-v0" for name in ("Unlock", "BlockedUnlockPickup", "RedBlueDoors-6x6", "DistShift1", "FourRooms")]


@pytest.mark.parametrize("env_id", SHAPES)
def test_views_without_the_package_are_those_of_minigrid(env_id: str, monkeypatch: pytest.MonkeyPatch) -> None:
    theirs = gymnasium.make(env_id).unwrapped
    monkeypatch.setattr(rustgym.envs.minigrid, "package_of", lambda env_id: None)
    monkeypatch.setattr(rustgym._class_env, "package_of", lambda env_id: None)
    ours = rustgym.make(env_id).unwrapped
    for env in (ours, theirs):
        env.reset(seed=1)
    for action in np.random.default_rng(3).integers(0, 6, 60).tolist():
        for size in (None, 3, 9):
            (grid, mask), (their_grid, their_mask) = (env.gen_obs_grid(size) for env in (ours, theirs))
            assert_same(mask, their_mask, f"cells seen of {size}")
            assert_same(grid.encode(mask), their_grid.encode(their_mask), f"view of {size}")
        if any(theirs.step(action)[2:4]):
            break
        ours.step(action)


def test_actions_are_minigrids_own_or_equal_them(monkeypatch: pytest.MonkeyPatch) -> None:
    from minigrid.core.actions import Actions

    env: Any = rustgym.make("MiniGrid-Empty-5x5-v0").unwrapped
    assert env.actions is Actions
    monkeypatch.setattr(rustgym.envs.minigrid, "package_of", lambda env_id: None)
    assert [(action.name, action.value) for action in env.actions] == [(action.name, action.value) for action in Actions]
    with pytest.raises(gymnasium.error.DependencyNotInstalled) as raised:
        type("Mine", (type(env),), {"step_count": 3, "_reward": None, "_gen_grid": None})
    assert str(raised.value).startswith("Mine overrides _gen_grid, which minigrid calls: ")
