"""Reductions of blocks: the same as of all samples at once, whatever the blocks are."""

import numpy as np
import pytest

import analytic
import scenes

LENGTHS = {"bodies.rocker.lengths.O-P3": np.array([300, 200, 301.0])}  # the second does not assemble all the way


@pytest.mark.parametrize("count", [50, 9001])
def test_reductions_are_of_all_samples(count: int) -> None:
    scene = scenes.load("toggle_press")
    grid = analytic.Grid(0.5, 6.5, count)
    at = np.linspace(0.5, 6.5, count)
    extremes, integral = analytic.Extremes("P5.vy", 3), analytic.Integral("drive.torque", 3)
    histogram = analytic.Histogram("P5.vy", np.linspace(-5, 5, 11))
    told: list[int] = []
    status, reason = analytic.reduce_many(
        scene, LENGTHS, grid, [extremes, integral, histogram], lambda done, of: told.append(of - done)
    )
    whole = analytic.solve_many(scene, LENGTHS, at)
    assert (tuple(status), tuple(reason)) == (whole.status, whole.reason)
    v, torque = whole["P5.vy"], whole["drive.torque"]
    assert extremes.largest == pytest.approx(np.nanmax(v, axis=1), rel=1e-13)  # positions differ by roundings
    assert extremes.least == pytest.approx(np.nanmin(v, axis=1), rel=1e-13)
    assert extremes.least_at == pytest.approx(at[np.nanargmin(v, axis=1)], abs=1e-12)
    fine = [0, 2]
    assert integral.total[fine] == pytest.approx(np.trapezoid(torque[fine], at, axis=1), rel=1e-10)
    assert np.isnan(integral.total[1])
    assert np.abs(histogram.counts - np.histogram(v[np.isfinite(v)], histogram.edges)[0]).max() <= 1  # at an edge
    assert told[-1] == 0


def test_positions_of_one_machine() -> None:
    extremes = analytic.Extremes("P5.y")
    (status,), _ = analytic.reduce_many(scenes.load("toggle_press"), {}, [0.1, 0.2, 0.3], [extremes])
    assert status is scenes.Status.ok
    highest = analytic.solve(scenes.load("toggle_press"), [0.1, 0.2, 0.3])["P5.y"].max()
    assert extremes.largest == pytest.approx(highest, rel=1e-14)  # roundings


def test_larger_groups() -> None:
    """The crank of the second machine is so long that it locks."""
    scene, crank = scenes.load("class_iii"), "bodies.crank.lengths.O-A"
    changes = {crank: [scenes.numbers_in("class_iii", (crank,))[0], 200]}
    extremes, at = analytic.Extremes("D.x", 2), np.linspace(0, 6, 9001)
    status, reason = analytic.reduce_many(scene, changes, at, [extremes])
    whole = analytic.solve_many(scene, changes, at, channels={"D.x"})
    assert (tuple(status), tuple(reason)) == (whole.status, whole.reason)
    assert [one.name for one in status] == ["ok", "cannot_assemble"]
    assert np.array_equal(extremes.largest, np.nanmax(whole["D.x"], axis=1))
