"""What is not a number passes no check, no comparison and no gate, whatever it is compared with."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from compare.engines.runner import Run
from compare.judge.checks import checks
from compare.judge.errors import compare
from compare.judge.measure import Measurement, gates
from compare.judge.verdict import compared, judged
from compare.mechanics.reference import Reference
from scenes import Motion, Status
from tests.comparisons import SAMPLING, References, changed, commanded, rows_of, sampled, violations

OK = Run("stub", None, Status.ok)


@sampled(1)
@pytest.mark.parametrize("name", ["shaper", "driven_toggle", "crank_press"])  # a slot, a spring and a table, a press
def test_no_channel_passes_the_checks(references: References, name: str) -> None:
    """Among the checks are minima over the ways in which a press force may stand, and maxima over a body's points."""
    reference = references(name)
    motion = commanded(reference)
    assert judged(OK, checks(reference.mechanics, motion, reference.travel)) == OK
    for channel in set(reference.scene.channels.names()) - {"time"}:
        found = checks(reference.mechanics, changed(motion, channel, np.nan), reference.travel)
        assert judged(OK, found).status is not Status.ok, channel


@sampled(1)
@pytest.mark.parametrize("name", ["shaper", "driven_toggle"])
def test_each_balance_of_a_body_has_it(references: References, name: str) -> None:
    """Newton's, Euler's and the power: of the joints and loads at a point, one that is not a number is enough."""
    reference = references(name)
    motion = commanded(reference)
    for pin in reference.scene.pins:
        for channel in (f"{pin.channel}.fx", f"{pin.channel}.fy"):
            worst = violations(reference, changed(motion, channel, np.nan))
            for body in {pin.first, pin.second} & set(reference.scene.bodies):
                assert np.isnan([worst["Newton", body], worst["Euler", body]]).all(), (channel, body)


@pytest.mark.parametrize(
    ("channel", "body"), [("E.y", "ram"), ("E.x", "link"), ("A.x", "block"), ("block.angle", "block")]
)
def test_an_open_joint_has_it(references: References, channel: str, body: str) -> None:
    """On a guide, at a bar's end, in a slot, and where a block turns against its slot."""
    reference = references("shaper")
    assert np.isnan(violations(reference, changed(commanded(reference), channel, np.nan))["closure", body])


def test_a_place_that_is_no_number_is_another_branch(reference: Reference, motion: Motion) -> None:
    """The comparison alone: the checks have seen nothing."""
    comparison = compare(reference, SAMPLING, changed(motion, "P4.x", np.nan))
    assert compared(OK, reference.scene, comparison, {}).status is Status.wrong_branch


def test_an_error_that_is_no_number_is_the_largest(reference: Reference, motion: Motion) -> None:
    table = rows_of(reference, changed(motion, "P3.fx", np.nan))
    row = pd.DataFrame(table).set_index("channel").loc["P3.fx"]
    assert row[["max", "unexplained", "rms", "commanded_max", "commanded_rms"]].isna().all()
    assert row["max_at"] == pytest.approx(200.0)
    assert np.isnan(Measurement(OK, None, [], table).worst()["reaction"])
    scene = replace(reference.scene, tolerances={"stub": {"reaction": 1e9, "torque": 1e9}})
    assert {gate.group: gate.missed for gate in gates(scene, [Measurement(OK, None, [], table)])} == {
        "reaction": True,
        "torque": False,
    }
