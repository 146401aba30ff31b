"""Engines compute on one thread wherever they run: in this process and in those of their own, whoever calls them."""

import os
from collections.abc import Iterator

import numpy as np
import pytest
from threadpoolctl import threadpool_info, threadpool_limits

import compare
from compare.engines.processes.inside import Limits
from compare.engines.processes.isolation import isolated
from compare.engines.processes.workers import workers
from compare.engines.runner import HERE
from compare.engines.threads import VARIABLE
from compare.judge.canaries import canaries
from scenes import load


def threads(*_: object) -> set[int]:
    """Return the numbers of threads that libraries of linear algebra would take."""
    np.linalg.inv(np.eye(2))
    return {library["num_threads"] for library in threadpool_info() if library["user_api"] == "blas"}


def numbers_of_threads() -> list[int]:
    return [*threads()]


@pytest.fixture(autouse=True)
def _several(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Have a program that computes on two threads, as a notebook does, and has them again afterwards."""
    monkeypatch.delenv(VARIABLE, raising=False)
    with threadpool_limits(2, "blas"):
        yield
        assert threads() == {2}
        assert os.environ.get(VARIABLE) != "1"


def test_an_engine_in_this_process_and_in_its_own_and_the_reference_beside_it() -> None:
    assert HERE.asked("analytic", load("four_bar"), threads) == {1}
    with workers(["analytic"], lambda: None) as runs:
        assert runs.asked("analytic", load("four_bar"), numbers_of_threads) == [1]
        assert threads() == {1}
    assert [*isolated(threads, [0], Limits(), lambda: None)] == [(0, {1})]


def test_a_check_from_its_first_run_to_its_last_canary(monkeypatch: pytest.MonkeyPatch) -> None:
    seen: list[set[int]] = []

    def look(_: object) -> list[str]:
        seen.append(threads())
        return []

    monkeypatch.setattr(canaries, "canaries", look)
    assert compare.check("four_bar", ("analytic", "exudyn"), samples=24).ok
    assert seen == [{1}]

    monkeypatch.setenv(VARIABLE, "2")  # a number that the user gave stays
    assert HERE.asked("analytic", load("four_bar"), threads) == {2}
