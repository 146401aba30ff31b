"""What settings of engines cost beside each other, in processor time: `pytest benchmarks`."""

from pathlib import Path
from time import process_time
from typing import Any

import numpy as np

import scenes
from scenes import Sampling
from sim_models.exudyn import engine as exudyn
from sim_models.exudyn.engine import DEFAULT, EXACT, WORK_PRECISION
from sim_models.exudyn.settings import ExudynSettings, TextbookTimeStepping
from sim_models.multiprecision import engine as multiprecision
from tests.chain import chain


def test_of_textbook_writing_a_file_is_part() -> None:
    """As its note has it: a quarter at 72 steps."""
    settings = TextbookTimeStepping("", steps=72)
    writing, silent = built(settings), built(settings)
    silent.model.settings.solution.file.write = False
    with_file, without = fastest(25, writing, silent)
    assert 0.1 <= 1 - without / with_file <= 0.65  # measured 0.25, and 0.5 while others kept the file system busy


def test_pointwise_costs_little() -> None:
    cheap = next(s for s in WORK_PRECISION if s.label == "trapezoidal, loose Newton, 72")
    exact, default, percent = fastest(15, *(built(settings) for settings in (EXACT, DEFAULT, cheap)))
    assert exact < default / 2  # measured 0.12 of it
    assert exact <= 4 * percent  # measured 2.6 times


def built(settings: ExudynSettings) -> Any:
    return exudyn.build(scenes.load("toggle_press"), settings, Sampling(72))


def fastest(rounds: int, *simulations: Any) -> list[float]:
    """The least time of the processor that each took to solve, s, in turns; other work does not count."""
    times = [[np.inf] for _ in simulations]
    for _ in range(rounds):
        for simulation, taken in zip(simulations, times, strict=True):
            began = process_time()
            simulation.solve()
            taken.append(process_time() - began)
    return [min(taken) for taken in times]


def test_the_cost_does_not_grow_with_the_cube_of_the_linkage(tmp_path: Path) -> None:
    """From 7 bodies to 19 it is two or three times as much, and more than five with all equations in one group."""

    def seconds(dyads: int) -> float:
        simulation = multiprecision.build(scenes.load(chain(dyads, tmp_path)), multiprecision.DEFAULT, Sampling(36))
        began = process_time()
        simulation.solve()
        return process_time() - began

    assert min(seconds(9) for _ in range(3)) <= 4 * min(seconds(3) for _ in range(3))
