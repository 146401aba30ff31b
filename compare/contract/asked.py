"""What the clauses are held against: the engine that was asked for, and its runs on the shipped scenes."""

from contextlib import ExitStack
from functools import cache
from typing import Any

import pytest

from scenes import Engine, InputError, Request, Sampling, Scene, Settings, Status, load, shipped

from ..engines import TRACEBACK, registry
from ..engines.runner import Run, run
from ..engines.threads import one_thread
from ..judge.measure import Standard, assess
from ..judge.triage import sentences
from ..mechanics.reference import Reference, uncertified

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
    ending = ExitStack()
    config.add_cleanup(ending.close)
    ending.enter_context(one_thread())
    ending.enter_context(pytest.MonkeyPatch.context()).setenv(TRACEBACK, "1")


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    """Have a clause on scenes held against every shipped one."""
    if "scene" in metafunc.fixturenames:
        metafunc.parametrize("scene", [*map(load, shipped())], ids=shipped())


@pytest.fixture(scope="session")
def name(request: pytest.FixtureRequest) -> str:
    """Return the engine's name."""
    return str(request.config.getoption("--engine"))


@pytest.fixture(scope="session")
def engine(name: str) -> Engine[Any]:
    """Return the engine."""
    return registry.engine(name)


@pytest.fixture(scope="session")
def solved(name: str) -> Scene:
    """Return the first shipped scene that the engine solves, by its own account."""
    for scene in shipped():
        if plain_run(name, scene).status is Status.ok:
            return load(scene)
    pytest.fail("expected an engine that solves one of the shipped scenes")


def outcome(engine: str, scene: Scene, request: Request = SAMPLING, settings: Settings | None = None) -> str:
    """The fault of a run by its own output, the reference and its promise, in a sentence, or nothing."""
    kept = request == SAMPLING and settings is None
    ended = plain_run(engine, scene.name) if kept else run(engine, scene, request, settings)
    measured = assess(Standard.of(reference(scene.name), request), ended)
    if measured.run.status is Status.ok:
        return ""
    causes = sentences(reference(scene.name), [measured])
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
    return uncertified(load(scene))
