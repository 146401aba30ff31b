"""What follows from a scene's own numbers otherwise than one may think is named wherever it is judged."""

from pathlib import Path

import pytest

import compare
from compare.judge.plausibility import point_masses
from compare.report.tables import study as tables
from compare.run import main
from scenes import InputError, Scene
from tests import scene_files
from tests.comparisons import SLOW, sampled

pytestmark = pytest.mark.usefixtures("few_settings")


def with_law(*times: float) -> scene_files.Changes:
    """Return the lever's drive by four rows of the cubic t (t - 3)^2 deg, which is largest, 4 deg, after 1 s."""
    rows = [[t, t * (t - 3) ** 2] for t in times]
    return {"drive": {"body": "lever", "law": rows}}


def judged(changes: scene_files.Changes) -> list[str]:
    scene: Scene = scene_files.load("lever", changes)
    return compare.check(scene, engines=("analytic",), samples=24).reasons


def test_a_law_that_leaves_its_table_is_named_with_both_extents(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    sentence = "drives from 0.0000 deg to 4.0000 deg, beyond its table's 0.0000 deg to 3.1360 deg: more rows"
    changes = with_law(0.0, 1.6, 2.5, 3.0)
    (reason,) = judged(changes)
    assert sentence in reason
    result = compare.check(scene_files.load("lever", changes), engines=("analytic",), samples=24)
    assert any(sentence in note for note in tables.notes(result))  # of the page
    main([str(scene_files.write(tmp_path, "lever", changes)), "--engines=analytic", "--check", f"--out={tmp_path}"])
    assert sentence in capsys.readouterr().out


def test_a_law_that_all_but_keeps_to_its_table_needs_no_word() -> None:
    assert judged(with_law(0.0, 1.1, 2.5, 3.0)) == []  # 3.971 deg of 4: by 0.7 % of the range


def test_a_law_that_leaves_its_table_by_more_than_its_range_is_refused() -> None:
    with pytest.raises(InputError) as caught:
        scene_files.load("lever", with_law(0.0, 2.2, 2.6, 3.0))
    assert "drive.law: the spline leaves the table by more than its range" in str(caught.value)
    assert "from 0.0000 deg to 4.0000 deg, the table from 0.0000 deg to 1.4080 deg" in str(caught.value)


def test_the_extent_of_a_law_is_found_between_any_rows() -> None:
    """A thousandth of the table holds a cubic that goes 4 deg beyond it; a grid over the time would not see it."""
    near = [[1e-7 * t, t * (t - 3) ** 2] for t in (0.0, 2.2, 2.6, 3.0)]
    rows = [*near, *([t, 0.0] for t in range(1, 6))]
    with pytest.raises(InputError, match="the spline leaves the table"):
        scene_files.load("lever", {"drive": {"body": "lever", "law": rows}})


BAR, PLATE = "is taken for a uniform bar from A to C", "is taken for a uniform triangular plate"


@sampled(1)
@pytest.mark.parametrize(("height", "taken"), [(0.0, ""), (0.5, BAR), (2.0, PLATE), (49.0, PLATE), (51.0, "")])
def test_a_plate_or_a_bar_that_is_nearly_the_other_is_named(height: float, taken: str) -> None:
    """The lever is 1000 mm long: a triangle no higher than 1 mm is a bar."""
    reasons = judged({"bodies.lever.points.B": [500, height], "sketch.B": [500, height]})
    assert len(reasons) == (taken != "")
    assert all(reason.startswith("lever, of points nearly on one line") and taken in reason for reason in reasons)


@SLOW
def test_a_table_that_is_longer_than_a_turn_is_named() -> None:
    """Of two turns one shows a part, and two all."""
    scene = scene_files.load("twisted_four_bar")
    shown = {turns: compare.check(scene, ("analytic",), samples=24, turns=turns).reasons for turns in (1, 2)}
    assert shown == {1: ["the table of loads.1 has a period of 2 turns; one turn shows a part, --turns 2 all"], 2: []}


@sampled(1)
@pytest.mark.parametrize("given", [True, False])
def test_a_cylinder_that_is_taken_for_a_point_mass_is_named(given: bool) -> None:
    """Both parts of a gas spring; and not the block that slides on a coupler with pins of its own."""
    without = {f"bodies.{name}.{of}": None for name in ("cylinder", "rod") for of in ("com", "inertia")}
    scene = scene_files.load("gas_spring", {} if given else without)
    reasons = compare.check(scene, ("analytic",), samples=24).reasons
    named = [f"{body} is taken for a point mass at {at}" for body, at in (("rod", "R"), ("cylinder", "G"))]
    assert [reason.partition(",")[0] for reason in reasons] == ([] if given else named)
    assert not [*point_masses(scene_files.load("carried_block"))]
