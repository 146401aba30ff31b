"""What the optional engines' own limits leave out, and what they do not."""

from time import perf_counter, process_time

import pytest

from compare.engines import registry
from compare.engines.runner import run
from scenes import Sampling, Status, budget, hard, load


def test_a_body_that_is_too_light_is_unsupported() -> None:
    pytest.importorskip("mujoco")
    light = next(rung.scene() for rung in hard.ladder("mass_slider").rungs if rung.label == "1e-9")
    ended = run("mujoco", light, Sampling(24))
    assert ended.status is Status.unsupported
    assert ended.reason == "'slider' is too light for MuJoCo beside the heaviest body"


@pytest.mark.parametrize("name", ["casadi", "mujoco", "pinocchio"])
def test_every_run_has_its_own_time(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """What is kept of a scene's first run does not keep the end of that run's time."""
    pytest.importorskip(registry.ENTRIES[name].package)
    scene = load("four_bar")
    assert run(name, scene, Sampling(24)).status is Status.ok
    monkeypatch.setattr(budget, "perf_counter", lambda: perf_counter() + 1e4)
    monkeypatch.setattr(budget, "process_time", lambda: process_time() + 1e4)
    assert run(name, scene, Sampling(24)).status is Status.ok
