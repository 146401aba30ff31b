"""What a motion law asks for over boxes of instants holds what 50 digits have of the same law, in every piece."""

from collections.abc import Callable, Iterator
from fractions import Fraction
from math import pi

import numpy as np
import pytest
from flint import arb, ctx

from analytic.proven.boxes import driven
from analytic.recorded.arithmetics.taylor_models import point
from scenes.drive import MotionLaw
from scenes.laws import LAWS, SAME_INSTANT_TOL, HarmonicLaw, SegmentedLaw
from sim_models.multiprecision.drive import law_of
from tests.comparisons import sampled

from .exact_values import BITS

Law = MotionLaw | SegmentedLaw | HarmonicLaw
INSTANTS, CYCLES = 12, 5  # of a law, and in the first of how many of its cycles they are
HAIR = 4 * SAME_INSTANT_TOL  # of a cycle: so close to a boundary 50 digits take an instant as on it


def spline(chance: np.random.Generator) -> MotionLaw:
    """A table of uneven instants, periodic or not, as a file may have it."""
    while not (law := _spline(chance)).beyond <= 1:
        pass
    return law


def _spline(chance: np.random.Generator) -> MotionLaw:
    count, periodic = int(chance.integers(4, 12)), bool(chance.integers(0, 2))
    times = np.cumsum([0.0, *10.0 ** chance.uniform(-2, 0, count - 1)])
    positions = chance.uniform(-3, 3, count)
    if periodic:
        positions[-1] = positions[0] + 2 * pi * chance.integers(-1, 2)
    return MotionLaw(tuple(times.tolist()), tuple(positions.tolist()), periodic)


def segments(chance: np.random.Generator) -> SegmentedLaw:
    """Named laws and dwells, some of which take a hundred times as long as others."""
    count = int(chance.integers(2, 7))
    laws = [str(law) if law != "dwell" else None for law in chance.choice([*LAWS, "dwell"], count)]
    ends = tuple(None if law is None else float(chance.uniform(-2, 2)) for law in laws)
    durations = tuple(map(float, np.round(10.0 ** chance.uniform(-1, 1, count), 3)))
    return SegmentedLaw(float(chance.uniform(-1, 1)), ends, durations, tuple(laws), False)


def after_a_long_dwell(chance: np.random.Generator) -> SegmentedLaw:
    """Segments of some ms after a minute: when they begin is a sum, which is rounded as a minute is."""
    count = 6
    durations = (
        float(np.round(chance.uniform(30, 90), 6)),
        *map(float, np.round(chance.uniform(2e-3, 2e-2, count), 6)),
    )
    ends = (None, *map(float, chance.uniform(-2, 2, count)))
    laws = (None, *map(str, chance.choice([*LAWS], count)))
    return SegmentedLaw(0.0, ends, durations, laws, False)


def sines(chance: np.random.Generator) -> HarmonicLaw:
    """Sines of frequencies with a digit or two."""
    count = int(chance.integers(1, 5))
    frequencies = tuple(map(float, chance.integers(1, 60, count) / chance.choice([2, 10])))
    sizes = tuple(map(float, chance.uniform(-2, 2, count)))
    return HarmonicLaw(
        float(chance.uniform(-2, 2)), sizes, frequencies, tuple(map(float, chance.uniform(-4, 4, count)))
    )


DRAWN: dict[str, Callable[[np.random.Generator], Law]] = {
    "spline": spline,
    "segments": segments,
    "after a long dwell": after_a_long_dwell,
    "sines": sines,
}


def beyond(kind: str, seed: int) -> Iterator[float]:
    """Yield by how much of its rest each true value of a law leaves its enclosure, negative where it does not."""
    chance = np.random.default_rng(seed)
    law = DRAWN[kind](chance)
    first = [*(piece.begin for piece in law.pieces), law.cycle]
    with ctx.workprec(BITS):
        exact = law_of(law)
        for piece in chance.integers(0, len(law.pieces), INSTANTS).tolist():
            before = law.cycle * int(chance.integers(0, CYCLES)) if law.periodic else 0.0
            begins = [before + begin for begin in first]
            inside = begins[piece] + chance.uniform(0, 1) * (begins[piece + 1] - begins[piece])
            cycles = Fraction(inside / law.cycle)
            command = exact(cycles)
            instant = float(command.time)
            own = int(np.searchsorted(begins, instant, side="right")) - 1
            if min(instant - begins[own], begins[own + 1] - instant) <= HAIR * law.cycle:
                continue
            width = 10.0 ** chance.uniform(-12, -0.5) * law.cycle
            low = max(instant - width * chance.uniform(0, 1), begins[own])
            high = min(instant + width * chance.uniform(0, 1), begins[own + 1])
            middle = (low + high) / 2
            way = point([middle], 3)
            way.c[1] = max(high - middle, middle - low)
            s = (command.time - arb(middle)) / arb(float(way.c[1, 0]))
            for model, true in zip(driven(law, way, np.array([middle])), command[1:], strict=True):
                c, rest = model.c[:, 0].tolist(), float(model.rest[0])
                apart = abs(true - (arb(c[0]) + arb(c[1]) * s + arb(c[2]) * s * s))
                yield float((apart - arb(rest)) / arb(rest or 1.0))


@sampled(2)
@pytest.mark.parametrize("kind", DRAWN)
def test_no_law_leaves_its_boxes(kind: str) -> None:
    found = [off for seed in range(12) for off in beyond(kind, seed)]
    assert len(found) > 300
    assert all(off <= 0 for off in found)


@pytest.mark.slow
@pytest.mark.parametrize("kind", DRAWN)
def test_no_law_of_many_leaves_its_boxes(kind: str) -> None:
    found = [off for seed in range(12, 100) for off in beyond(kind, seed)]
    assert all(off <= 0 for off in found)
