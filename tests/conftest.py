"""What several tests need: the toggle press, its reference, and engines that end as told."""

import os
from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path
from tempfile import gettempdir
from typing import Any

import pytest
from hypothesis import settings
from hypothesis.configuration import set_hypothesis_home_dir

import scenes
from compare.cli.arguments import matching
from compare.engines import registry
from compare.judge.floor import establish
from compare.mechanics.reference import Reference, uncertified
from compare.study import Study
from scenes import Motion, Scene

from . import scene_files
from .comparisons import SAMPLING, Outcome, Plug, References, Stub, Studies, commanded, only_few_settings, studied

set_hypothesis_home_dir(Path(gettempdir()) / "hypothesis")
settings.register_profile("no leftovers", database=None)
settings.load_profile("no leftovers")


BROWSER = "tests/browser/"
LONGEST = (
    *(BROWSER, "tests/test_wheel.py", "tests/test_docs.py", "tests/compare/test_library.py"),
    *("tests/compare/judge/test_promises.py", "tests/test_friction_ladder.py", "tests/faults/test_faults.py"),
    *("tests/analytic/proven/test_chained.py", "tests/analytic/proven/test_enclosures.py"),
)
SLOW_CASES = 2  # times as many as those by default, of a test of many cases


@pytest.hookimpl(tryfirst=True)  # before tests are left out by their marks
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Of a test that is marked `sampled(count)`, leave so many cases to the default tests; more are slow, others study.

    Those of each are as far apart in their order as can be. Cases that are slow by themselves do not count.
    """
    cases = defaultdict(list)
    for item in items:
        mark = item.get_closest_marker("sampled")
        if mark and not any(item.get_closest_marker(name) for name in ("slow", "study")):
            cases[item.nodeid.partition("[")[0], mark.args[0]].append(item)
    for (_, count), found in cases.items():
        left = spread(found, count)
        for item in left:
            found.remove(item)
        slow = spread(found, SLOW_CASES * count)
        for item in found:
            item.add_marker("slow" if item in slow else "study")


def spread(items: Sequence[pytest.Item], count: int) -> list[pytest.Item]:
    """Return so many, or all where there are no more, the first and the last among them."""
    places = {round(number * (len(items) - 1) / max(count - 1, 1)) for number in range(count)}
    return [item for place, item in enumerate(items) if place in places]


@pytest.hookimpl(optionalhook=True)  # of pytest-xdist
def pytest_xdist_auto_num_workers() -> int | None:
    """Of `-n auto` one more than there are cores: tests that wait for a process or a page leave theirs to others."""
    return None if "PYTEST_XDIST_AUTO_NUM_WORKERS" in os.environ else (os.cpu_count() or 1) + 1


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: Any) -> Any:
    """Give each process of the tests whole files, and one of them all pages in a browser, which is started once.

    What takes longest is begun first, so that no process works on alone at the end; other files follow by how many
    tests they have.
    """
    from xdist.scheduler import LoadFileScheduling

    class ByFile(LoadFileScheduling):  # type: ignore[misc]  # it has no types
        def _split_scope(self, nodeid: str) -> str:
            file = super()._split_scope(nodeid)
            return BROWSER if file.startswith(BROWSER) else file

        def _assign_work_unit(self, node: Any) -> None:
            for file in LONGEST:
                if file in self.workqueue:
                    self.workqueue.move_to_end(file, last=False)
                    break
            super()._assign_work_unit(node)

    return ByFile(config, log)


@pytest.fixture
def toggle_press() -> Scene:
    return scenes.load("toggle_press")


@pytest.fixture(scope="session")
def reference() -> Reference:
    return establish(scenes.load("toggle_press"))


@pytest.fixture
def motion(reference: Reference) -> Motion:
    return commanded(reference)


@pytest.fixture(scope="session")
def references() -> References:
    """Return a function that solves the reference of a mechanism, without its floor, and only once."""
    return cache(lambda name: uncertified(scene_files.load(name)))


@pytest.fixture(scope="session")
def studies() -> Studies:
    """Return a function that studies a scene, all of its channels or some, by the analytic core, and only once."""

    @cache
    def of(name: str, *patterns: str) -> Study:
        scene = scene_files.load(name)
        asked = matching(scene, patterns) if patterns else None
        return studied(scene, sampling=replace(SAMPLING, channels=asked))

    return of


@pytest.fixture
def few_settings() -> Iterator[None]:
    with only_few_settings():
        yield


@pytest.fixture
def plug(monkeypatch: pytest.MonkeyPatch) -> Plug:
    """Return a function that makes the engine named `stub` end as told."""
    real = registry.engine
    entry = registry.Entry("a stub", "", "numpy", "numpy", "")
    monkeypatch.setitem(registry.ENTRIES, "stub", entry)

    def plug(outcome: Outcome) -> None:
        monkeypatch.setattr(registry, "engine", lambda name: Stub(outcome) if name == "stub" else real(name))

    return plug
