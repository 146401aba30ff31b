"""The members of a family: which there are, those that cannot run, and how each is cross-checked."""

from collections.abc import Sequence
from dataclasses import replace
from multiprocessing.reduction import ForkingPickler

import numpy as np
import pytest

import analytic
import scenes
from compare.engines import registry
from compare.judge.agreement import Agreement, Judgement, Word
from compare.judge.peaks.peaks import peaks
from compare.measure.many.family import Asked, Family, members
from compare.measure.many.grid import grid, variation
from compare.mechanics.reference import uncertified
from compare.report.tables import family as family_tables
from compare.study import judged
from scenes import InputError, Sampling
from tests import scene_files
from tests.comparisons import SLOW, sampled

from .runs import CRANK_SLIDER, ROCKER, one, run

pytestmark = pytest.mark.usefixtures("few_settings")


def test_members_that_cannot_run_are_rows_in_their_place() -> None:
    family = run("toggle_press", [f"{ROCKER}=-100:500:7"])
    assert [member.changes[ROCKER] for member in family] == [-100, 0, 100, 200, 300, 400, 500]
    statuses = ["invalid"] * 2 + ["cannot_assemble"] * 2 + ["ok"] * 2 + ["cannot_assemble"]
    assert [member.status for member in family] == statuses
    for member in family:
        assert (member.cycle is None) == (member.status != "ok")
        assert bool(member.reason) == (member.status != "ok")
    assert family[0].reason == f"{ROCKER}: expected greater than 0, found -100.0"
    assert "crank angle" in family[2].reason


def test_a_grid_is_every_combination_the_last_changing_fastest() -> None:
    changes = grid([variation("a.b=1:2:2"), variation("c=0:1:3")])
    assert [tuple(change.values()) for change in changes] == [(1, 0), (1, 0.5), (1, 1), (2, 0), (2, 0.5), (2, 1)]
    assert all(list(change) == ["a.b", "c"] for change in changes)
    with pytest.raises(InputError, match="200 members at most, found 201"):
        grid([variation("a=0:1:67"), variation("b=0:1:3")])


def test_no_member_is_there_twice() -> None:
    """A family of two of the same kind would never be complete: results are kept by what changes."""
    with pytest.raises(InputError, match="two different values, FROM and TO, and COUNT of them in all"):
        variation("a=1:1.0000000000000002:5")
    with pytest.raises(InputError, match="a: expected each number once"):
        grid([variation("a=0:1:2"), variation("b=0:1:2"), variation("a=2:3:2")])


def test_every_member_is_cross_checked() -> None:
    """And what is reported is that member's own error: an engine that has another linkage in mind is far off."""
    family = run(CRANK_SLIDER, ["bodies.rod.lengths.A-B=250:350:3"], ["analytic", "exudyn"])
    for member in family:
        reference, engine = member.measurements
        assert reference.largest <= 1e-13  # against 50 digits
        assert 0 < engine.largest <= 1e-4  # exudyn's accelerations at 72 samples per turn
        assert member.judgement is not None
        assert [gate.met for gate in member.judgement.held] == ["met"]


def pair(*engines: str) -> Family:
    """Two members that run, 300 and 310."""
    vary = f"{ROCKER}=300:310:2"
    return Family(scenes.load("toggle_press"), [variation(vary)], engines, run("toggle_press", [vary], engines))


def lacking(engine: str, patch: pytest.MonkeyPatch) -> None:
    patch.setitem(registry.ENTRIES, engine, replace(registry.ENTRIES[engine], package="no_such_package"))


def test_an_engine_that_fails_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    lacking("pymunk", monkeypatch)
    family = pair("pymunk")
    assert "closed dead point [mm]" in next(iter(family_tables.overview(family))), "at -1.1 m, as finely as the stroke"
    assert [row["pymunk error"] for row in family_tables.overview(family)] == ["unsupported", "unsupported"]
    floor, *failures = family_tables.notes(family)
    assert floor.startswith("The reference is off by ")
    assert len(failures) == 2
    assert "pip install pymunk" in failures[0]
    assert "pymunk is not installed" in str(family_tables.agreement(family))


@sampled(3)
@pytest.mark.parametrize(
    ("words", "word", "named"),
    [
        ((Word.agrees, Word.agrees), Word.agrees, "to "),
        ((Word.agrees, Word.in_part), Word.in_part, "1: agrees in part; the first is O-P3 = 310: Why."),
        ((Word.not_solved, Word.agrees), Word.in_part, "1: not solved; the first is O-P3 = 300: Why."),
        ((Word.not_solved, Word.not_solved), Word.not_solved, "2: not solved; the first is O-P3 = 300: Why."),
        ((Word.not_solved, Word.disagrees), Word.disagrees, "1: disagrees; the first is O-P3 = 310: Why."),
    ],
)
def test_the_verdict_is_that_on_the_worst_member(
    monkeypatch: pytest.MonkeyPatch, two: Family, words: Sequence[Word], word: Word, named: str
) -> None:
    left = iter(words)
    monkeypatch.setattr(Judgement, "agreement", property(lambda _: Agreement(next(left), "Why.")))
    agreement = family_tables.agreement(two)
    assert agreement.word is word
    assert agreement.sentence.startswith("All 2 members run. ")
    assert named in agreement.sentence


@pytest.fixture(scope="module")
def two() -> Family:
    return pair("analytic", "pymunk")


@SLOW
def test_a_member_keeps_no_samples_but_its_curves() -> None:
    """Two hundred fit into 300 MB, of which the process has 110 without any; pickled they take what they do in memory.

    What the page and the files show of one is the same as of a judgement with all its samples.
    """
    request, change, engines = Sampling(360), {ROCKER: 312.5}, ["analytic", "exudyn"]
    (member,) = members(Asked(scenes.load("toggle_press"), engines, request), [change], lambda _: None)
    kept, whole = member.judgement, judged(scenes.load("toggle_press", change), engines, request)
    assert kept is not None
    assert len(ForkingPickler.dumps(member)) < 0.3e6
    for name in ("ok", "misses", "causes", "verdicts", "agreement", "channel_errors", "held"):
        assert repr(getattr(kept, name)) == repr(getattr(whole, name)), name
    assert [peak.value for peak in kept.peaks] == [peak.value for peak in whole.peaks]


def test_without_a_certificate_none_is_claimed(monkeypatch: pytest.MonkeyPatch) -> None:
    lacking(registry.ORACLE, monkeypatch)
    family = pair("analytic")
    assert [row["analytic error"] for row in family_tables.overview(family)] == ["not certified"] * 2
    assert family_tables.notes(family)[0].startswith("The reference is not certified: ")


def test_a_member_that_breaks_the_reference_is_a_row(monkeypatch: pytest.MonkeyPatch) -> None:
    def solve(scene: scenes.Scene, *_: object) -> scenes.Motion:
        raise ZeroDivisionError(f"{scene.name}\nand more")

    monkeypatch.setattr(registry, "reference", solve)
    for member in pair().members:
        assert member.status == "crashed"
        reason = "ZeroDivisionError: toggle_press and more (tests/compare/many/test_members.py, line "
        assert member.reason.startswith(reason)


def test_numbers_are_those_of_the_single_linkage_and_of_its_worst_joint() -> None:
    changes = {ROCKER: 312.5}
    reference = uncertified(scene_files.load("toggle_press", dict(changes)))
    single = {peak.name: peak for peak in peaks(reference, Sampling(72), [])}
    numbers, cycle = one("toggle_press", changes)
    assert [*numbers] == [*dict.fromkeys(peak.kind for peak in single.values())]
    assert numbers["stroke"].value == single["stroke"].value
    forces = (peak for name, peak in single.items() if name.startswith("largest force"))
    worst = max(forces, key=lambda peak: peak.value)
    assert (numbers["largest force"].of, numbers["largest force"].value) == (worst.of, worst.value)
    motion = analytic.solve(reference.scene, cycle.position)
    for name, channel in (("displacement", "P5.y"), ("velocity", "P5.vy"), ("torque", "drive.torque")):
        np.testing.assert_allclose(cycle.curves[name], motion[channel], rtol=1e-12, atol=1e-9)
    np.testing.assert_allclose(np.degrees(cycle.position), np.linspace(0, 360, 3601), rtol=0, atol=1e-9)


def test_a_point_is_drawn_by_its_coordinates() -> None:
    numbers, cycle = one("four_bar", {"drive.speed": -60})
    assert set(cycle.curves) == {"x", "y", "velocity", "acceleration", "torque"}
    path = cycle.curves["x"] + 1j * cycle.curves["y"]
    longest = max(float(np.abs(path - place).max()) for place in path)
    assert numbers["stroke"].value == pytest.approx(longest)
