"""What the clauses are held against: the engine that was asked for, and its runs on the shipped scenes."""

import os
from functools import cache
from typing import Any

import pytest

from scenes import Engine, InputError, Sampling, Scene, Settings, Status, load, shipped

from ..engines import registry
from ..engines.reasons import TRACEBACK
from ..engines.reference import Reference, found
from ..engines.runner import Run, run
from ..judge.measure import assess
from ..judge.triage import sentences

SAMPLING = Sampling(36)


def pytest_addoption(parser: pytest.Parser) -> None:
    """Take the engine's name."""
    parser.addoption("--engine", metavar="NAME", help="engine that the contract is held against, as of `--list`")


def pytest_configure(config: pytest.Config) -> None:
    """Refuse a name that is no engine's, and an engine that cannot run."""
    name = config.getoption("--engine")
    if not name:
        raise pytest.UsageError("--engine NAME: missing, the engine that the contract is held against")
    try:
        registry.check_names([name])
    except InputError as error:
        raise pytest.UsageError(str(error)) from None
    if missing := registry.ENTRIES[name].missing:
        raise pytest.UsageError(f"--engine {name}: {missing}")
    before = os.environ.get(TRACEBACK)
    os.environ[TRACEBACK] = "1"
    config.add_cleanup(lambda: os.environ.update({TRACEBACK: before or ""}))


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    """Have a clause on scenes held against every shipped one."""
    if "scene" in metafunc.fixturenames:
        metafunc.parametrize("scene", shipped(), indirect=True)


@pytest.fixture(scope="session")
def name(request: pytest.FixtureRequest) -> str:
    """Return the engine's name."""
    return str(request.config.getoption("--engine"))


@pytest.fixture(scope="session")
def engine(name: str) -> Engine[Any]:
    """Return the engine."""
    return registry.engine(name)


@pytest.fixture
def scene(request: pytest.FixtureRequest) -> Scene:
    """Return a shipped scene."""
    return load(request.param)


@pytest.fixture(scope="session")
def solved(name: str) -> Scene:
    """Return the first shipped scene that the engine solves, by its own account."""
    for scene in shipped():
        if plain_run(name, scene).status is Status.ok:
            return load(scene)
    pytest.fail("expected an engine that solves one of the shipped scenes")


def outcome(engine: str, scene: Scene, request: Sampling = SAMPLING, settings: Settings | None = None) -> str:
    """Return what is wrong with a run by its own output, the reference and its promise, in a sentence, or nothing."""
    kept = request == SAMPLING and settings is None
    measured = assess(
        reference(scene.name), request, plain_run(engine, scene.name) if kept else run(engine, scene, request, settings)
    )
    if measured.run.status is Status.ok:
        return ""
    causes = sentences(reference(scene.name), request, [measured])
    return "; likely cause: ".join([f"{measured.run.status.name}, {measured.run.reason}", *causes.values()])


def plain_run(engine: str, scene: str) -> Run:
    """Return an engine's run at its default settings on a shipped scene, not looked at."""
    ended = first_run(engine, scene)
    return ended if ended.status is not Status.crashed else run(engine, load(scene), SAMPLING)  # traceback printed here


@cache
def first_run(engine: str, scene: str) -> Run:
    """Return the first of these runs."""
    return run(engine, load(scene), SAMPLING)


@cache
def reference(scene: str) -> Reference:
    """Return the reference of a shipped scene."""
    return found(load(scene))
