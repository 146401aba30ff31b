"""Ten thousand turns: the reference stays as exact as in the first, the engines drift by no more than is explained.

Run by `pytest benchmarks/test_long_runs.py -n 0 -s`; it takes about a minute.
"""

import numpy as np
import pytest

import scenes
from compare.engines import registry
from compare.judge.floor import establish
from compare.judge.measure import Measurement, measure
from compare.mechanics.reference import Reference
from compare.mechanics.scales import relative_errors
from scenes import Sampling
from scenes.model.inputs import passing

TURNS = (1, 100, 1000, 10_000)
STEPS, SAMPLES = 72, 8


@pytest.fixture(scope="module")
def reference() -> Reference:
    return establish(scenes.load("toggle_press"))


def test_the_reference_is_flat(reference: Reference) -> None:
    """At the last turn as at the same angles reduced to the first, each double taken for what it is."""
    scene, turns = reference.scene, TURNS[-1]
    # A double at 10,000 turns is off by up to 4e-12 rad, which no model can undo. So the same double is reduced by
    # whole turns with 40 digits, and both calls stand for the same angle: what is left between them is the core's own
    # error.
    position = Sampling(360, turns).commanded(scene)[-361:]
    reduced = np.array([float(_reduced(angle)) for angle in position])
    late, early = (reference.at(passing(scene, angles, np.zeros(361))) for angles in (position, reduced))
    errors = relative_errors(scene.channels, late, early, reference.scale)
    worst = max(float(error.max()) for channel, error in errors.items() if channel != "crank_angle")
    print(f"\nanalytic: {worst:.1e} between turn {turns} and the first")
    assert worst <= 5e-15  # a few units in the last place, as in the first turn


@pytest.mark.parametrize(("engine", "position", "drift"), [("exudyn", 1e-9, 1e-9), ("pymunk", 1e-2, 1e-6)])
def test_an_engine_drifts_little(reference: Reference, engine: str, position: float, drift: float) -> None:
    """Position errors of the last turn, at the angle the engine had; and its drive's, against the angle asked for.

    Both hold the drive in its position, so nothing adds up but rounding: Exudyn takes the angle from the time, whose
    double loses as much as the angle's; pymunk adds a rounding a step, of an angle that grows: as turns squared.
    """
    at_steps = registry.engine(engine).at_steps
    assert at_steps is not None
    settings = at_steps(STEPS)
    found = {turns: last_turn(measure(reference, engine, Sampling(SAMPLES, turns), settings)) for turns in TURNS}
    for turns, (of_position, of_drive) in found.items():
        print(f"\n{engine}, {turns} turns: position {of_position:.1e}, drive {of_drive:.1e} rad", end="")
        assert of_position <= position
        assert abs(of_position - found[1][0]) <= drift


def last_turn(measured: Measurement) -> tuple[float, float]:
    """Return the largest error of positions in the last turn, and of the drive, rad."""
    return measured.worst("last_turn_max")["position"], measured.worst("commanded_max")["drive"]


def _reduced(angle: float) -> float:
    """Return the angle less whole turns, by more digits than a double has."""
    import flint

    with flint.ctx.workdps(40):
        whole = 2 * flint.arb.pi() * round(angle / (2 * np.pi))
        return float(flint.arb(angle) - whole)
