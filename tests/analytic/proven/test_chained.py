"""Dyads that hang on each other as one system: bounds hold, grow as the motion does, and rows of them are proven."""

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
import pytest

import analytic
from analytic.proven.boxes import Boxes
from scenes import Failure, Scene
from tests import scene_files
from tests.naming import loaded

from .true_values import BY_50_DIGITS, Places, escapes, share_known

HALF = 0.25  # rad, of the drive's range
NAMES = {name: name for n in range(40) for name in (f"A{n}", f"B{n}", f"l{n}", f"c{n}", "drive")}


def row(count: int, turned: float = 0.0, off: float = 0.0, seed: int = 0, **changes: Any) -> Scene:
    """Four-bar linkages side by side in a row that is turned, each crank the rocker before, with pins somewhat off.

    Args:
        count: of four-bar linkages.
        turned: by which angle the row is, rad.
        off: how far pins are at most from those of parallelograms of 1 m, m.
        seed: of where they are.
        changes: tables of the file.
    """
    chance, u = np.random.default_rng(seed), complex(np.exp(1j * turned))
    A = [u * (n + 0j) for n in range(count + 1)]
    B = [a + u * (1j + complex(*chance.uniform(-off, off, 2).tolist())) for a in A]
    start = float(np.angle(B[0] - A[0]))
    bars = {f"l{n}": (f"A{n}-B{n}", abs(B[n] - A[n])) for n in range(count + 1)}
    bars |= {f"c{n}": (f"B{n}-B{n + 1}", abs(B[n + 1] - B[n])) for n in range(count)}
    tables: dict[str, Any] = {
        "format": 1,
        "name": "row",
        "gravity": [0, -9.81],
        "ground": {"points": {f"A{n}": [a.real, a.imag] for n, a in enumerate(A)}},
        "bodies": {name: {"lengths": {pair: length}, "mass": 1} for name, (pair, length) in bars.items()},
        "drive": {"body": "l0", "speed": -1, "start": start + HALF, "end": start - HALF},
        "sketch": {"angle": start, **{f"B{n}": [b.real, b.imag] for n, b in enumerate(B)}},
        "output": {"point": f"B{count}"},
    }
    return loaded(tables | changes, NAMES, NAMES)


@pytest.fixture
def chained(monkeypatch: pytest.MonkeyPatch) -> None:
    """Have all dyads of two bars be one system, where there are several."""
    monkeypatch.setattr("analytic.proven.boxes.MAX_ALONE", 0)


SCENES: dict[str, Callable[[], Scene]] = {
    "a row": lambda: row(3, 0.7, 0.2),
    "a row with a spring": lambda: row(
        2, 2.0, 0.2, 1, springs=[{"between": ["ground.A0", "c1.B2"], "stiffness": 30, "length": 1}]
    ),
    "a row with friction": lambda: row(2, 0.4, 0.2, 2, friction=[{"at": "B1", "coefficient": 0.1, "radius": 0.02}]),
    **{name: partial(scene_files.load, name) for name in ("watt_six_bar", "walking_leg", "peaucellier")},
}


@pytest.mark.usefixtures("chained")
@pytest.mark.parametrize("name", SCENES)
def test_values_to_50_digits_are_within_bounds(name: str) -> None:
    places = Places.drawn(SCENES[name](), np.random.default_rng(7), 12)
    assert Boxes(places.scene, None, {}).chained
    assert [*escapes(places, places.by_50_digits, BY_50_DIGITS)] == []
    assert share_known(places) > 0.9


@pytest.mark.usefixtures("chained")
def test_a_number_that_may_be_off() -> None:
    """Machines whose last rocker is longer or shorter are within the bounds of all of them."""
    scene, off = row(3, 0.7, 0.2), {"bodies.l3.lengths.A3-B3": 1e-3}
    found = analytic.enclose(scene, frozenset({"B3.ax", "drive.torque"}), off=off)
    assert found.open_at is None
    for share in (-1.0, -0.3, 1.0):
        numbers = {path: scene.numbers[path].value + share * by for path, by in off.items()}
        motion = analytic.solve(scene.with_numbers(numbers), np.linspace(*scene.drive.law.extent, 200))
        for one in found.rows:
            values = motion[one.channel]
            assert values.max() <= one.high if one.extreme == "most" else one.low <= values.min()
            assert one.high - one.low <= 0.1 * np.ptp(values)


@pytest.mark.usefixtures("chained")
def test_what_a_round_off_does_to_the_last_dyad_of_a_row_goes_with_their_number() -> None:
    """By bounds of the dyad before, that of the first is 2.4^11, or 15000, times as large in the last."""
    boxes = Boxes(row(12, 0.7), frozenset({"l1.angle", "l12.angle"}), {})
    models, _ = boxes(np.array([np.pi / 2 + 0.7]), np.array([np.pi / 2 + 0.7]))
    rest = dict(zip(boxes.names, models.rest[:, 0], strict=False))
    assert rest["l12.angle"] < 30 * rest["l1.angle"]


def test_where_a_dyad_does_not_reach(monkeypatch: pytest.MonkeyPatch) -> None:
    """B2 cannot be reached at the end of a wide range, by closed forms as by one system, in which B1 stays known."""
    drawn = row(4, 0.3, 0.2, 4)
    drive = {"body": "l0", "speed": -1, "start": drawn.sketch.drive + 0.2, "end": drawn.sketch.drive - 2.5}
    scene = row(4, 0.3, 0.2, 4, drive=drive)
    with pytest.raises(Failure, match="B2 cannot be reached"):
        analytic.solve(scene, [scene.sketch.drive - 2.4])
    closed = analytic.enclose(scene, frozenset({"B4.x"}))
    monkeypatch.setattr("analytic.proven.boxes.MAX_ALONE", 0)
    found = analytic.enclose(scene, frozenset({"B4.x"}))
    assert found.why == closed.why == "B2 cannot be reached"
    assert found.open_at == closed.open_at


@pytest.mark.parametrize(
    "turned", [pytest.param(0.0, marks=pytest.mark.study), pytest.param(0.8, marks=pytest.mark.slow)]
)
def test_sixty_one_bodies_are_proven(turned: float) -> None:
    """In parallelograms each rocker is the crank again: B30 is 30 m beside B0."""
    scene = row(30, turned)
    found = analytic.enclose(scene)
    assert found.open_at is None
    assert not found.why
    way = np.linspace(*scene.drive.law.extent, 20001)
    x = np.cos(way) + 30 * np.cos(turned)
    for one in (one for one in found.rows if one.channel == "B30.x"):
        true = x.max() if one.extreme == "most" else x.min()
        assert one.low - 1e-9 <= true <= one.high + 1e-9  # between the places of `way` it is off by a millionth squared
        assert one.high - one.low <= 1e-5
