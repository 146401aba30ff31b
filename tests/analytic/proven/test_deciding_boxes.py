"""The boxes that decide an extreme, judged again in balls of 200 bits: by the same formulas in another arithmetic."""

from collections.abc import Callable, Mapping
from math import tau
from typing import Any

import numpy as np
import pytest
from flint import arb, ctx

import analytic
import scenes
from analytic.recorded.expressions import needed
from analytic.recorded.program import recorded
from scenes import Scene
from scenes.channels import named
from scenes.model.enclosures import Enclosure
from tests.comparisons import sampled

from .exact_values import BITS
from .rules import TRUE

FEW = ("crank_press", "four_bar", "toggle_press")
MORE = [
    "andrews_squeezer",
    "crank_press_friction",
    "double_toggle_clamp",
    "double_toggle_clamp_scheme4",
    "excavator_bucket",
    "four_stroke_engine",
    "garage_door",
    "peaucellier",
    "quick_return",
    "self_locking_toggle",
    "stephenson_six_bar",
    "toggle_press_friction",
    "walking_leg",
    "watt_six_bar",
]
# Of balls that overlap, where the exact rules are of numbers.
OF_BALLS: Mapping[str, Callable[..., Any]] = {
    **TRUE,
    "minimum": lambda x, y: x.min(y),
    "maximum": lambda x, y: x.max(y),
}
WHOLE = 1e-3  # of a range: a box that is so wide decides nothing by itself


@pytest.fixture(autouse=True)
def bits() -> Any:
    before, ctx.prec = ctx.prec, BITS
    yield
    ctx.prec = before


def in_balls(scene: Scene) -> Callable[[str, float, float], Any]:
    """What a channel or magnitude may be between two positions of the drive; None where a condition is open in them."""
    program, reference = recorded(scene, scene.numbers.keys()), analytic.solver(scene)
    inputs = {path: arb(number.value) for path, number in scene.numbers.items()}
    inputs |= {place: arb(end) for place, end in reference.stroke_ends.items()}

    def between(name: str, low: float, high: float) -> Any:
        position = arb((low + high) / 2, (high - low) / 2 + 1e-17 * abs(high))
        given = inputs | {"position": position, "time": (position - inputs["drive.start"]) / inputs["drive.speed"]}
        given |= {one: arb(float(turn(np.array(low)))) for one, turn in reference.windings.items()}
        parts = [
            program.channels[part] for part in scene.channels.magnitudes.get(name, (name,)) if part in program.channels
        ]
        balls: dict[int, Any] = {}
        for made in needed(parts):
            of = [balls[one.order] for one in made.operands]
            if made.operation in ("constant", "input"):
                balls[made.order] = arb(made.of[0]) if made.operation == "constant" else given[made.of[0]]
            else:
                balls[made.order] = None if any(one is None for one in of) else OF_BALLS[made.operation](*of)
        values = [balls[part.order] for part in parts]
        if not values or any(value is None for value in values):
            return None
        return sum((value**2 for value in values), arb(0)).sqrt() if len(values) > 1 else values[0]

    return between


def on(row: Enclosure, ball: Any) -> Any:
    """An angle's ball, of whose whole turns the formulas know nothing, on the turn of its bounds."""
    turns = 0 if ball is None else round((row.low - float(ball.mid())) / tau)
    return None if ball is None else ball + 2 * arb.pi() * turns


@sampled(1)
@pytest.mark.parametrize("name", [*FEW, *(pytest.param(name, marks=pytest.mark.slow) for name in MORE)])
def test_what_is_in_the_box_can_be_the_extreme(name: str) -> None:
    """The extreme is in the box, so that the ball over it meets its bounds; and nothing in the box is beyond it."""
    scene, judged = scenes.load(name), 0
    between = in_balls(scene)
    for row in analytic.enclose(scene, accuracy=1e-9).rows:
        low, high = row.position_low, row.position_high
        if high - low < WHOLE * np.ptp(scene.drive.law.extent):
            balls = (between(row.channel, *ends) for ends in ((low, high), 2 * [(low + high) / 2]))
            ball, middle = (on(row, ball) if named(row.channel).name == "angle" else ball for ball in balls)
            judged += ball is not None
            assert ball is None or not (ball < row.low or ball > row.high), (row, ball)
            assert middle is None or not (middle < row.low if row.extreme == "least" else middle > row.high), row
    assert judged > 20


def test_a_flat_extreme_is_in_its_place() -> None:
    """The crank's pin is furthest left at half a turn, by hand; boxes beside it are off by less than a rounding."""
    rows = analytic.enclose(scenes.load("toggle_press"), frozenset({"P2.x"}), 1e-9).rows
    (least,) = (row for row in rows if row.extreme == "least")
    assert least.position_low <= np.pi <= least.position_high
    assert least.position_high - least.position_low <= 1e-4  # flat: about the root of 1e-9
