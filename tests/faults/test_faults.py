"""A sample of the faults: what is above its limit is found, and `above` is what it claims to be."""

import json
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from benchmarks.faults import main, write
from compare.engines.runner import run
from compare.judge.causes.cause import Kind
from compare.judge.causes.words import words
from compare.judge.checks import checks
from compare.judge.measure import measure
from compare.judge.triage import cause
from compare.mechanics.reference import uncertified
from scenes import Motion
from tests import scene_files
from tests.comparisons import References, changed, sampled
from tests.faults import table
from tests.faults.catalogue import catalogue
from tests.faults.fault import Clean, Fault, above
from tests.faults.left_out import left_out
from tests.faults.rates import MEAN, TOTAL, let_through, rates
from tests.faults.spoilt_elements import elements
from tests.faults.table import ENGINES, SAMPLING, Record, judged_faults
from tests.faults.weight_and_friction import friction_of_joints


@pytest.fixture(scope="module")
def records() -> Sequence[Record]:
    return judged_faults(("crank_press", "exudyn"), every=40)


@pytest.fixture
def clean(references: References) -> Clean:
    reference = references("toggle_press")
    return Clean(reference, SAMPLING, measure(reference, "exudyn", SAMPLING).run)


def test_all_above_the_limit_are_found(records: Sequence[Record]) -> None:
    assert sum(record.above for record in records) > 5
    assert let_through(records).empty
    assert rates(records).iloc[-1]["share found"] == 1.0


def test_the_table_and_its_page(records: Sequence[Record], tmp_path: Path) -> None:
    folder = write(records, tmp_path)
    table = json.loads((folder / "faults.json").read_text(encoding="utf-8"))
    asked = {"family", "kind", "magnitude", "scene", "engine", "above", "found", "by", "place", "cause"}
    assert len(table) == len(records)
    assert all(asked < row.keys() for row in table)
    page = (folder / "faults.html").read_text(encoding="utf-8")
    assert all(record.kind in page for record in records)


def test_bad_input(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--scenes", "nosuch", "--out", str(tmp_path)]) == 2
    assert "nosuch" in capsys.readouterr().err


def test_there_are_enough_kinds_in_every_family(clean: Clean) -> None:
    kinds = {(fault.family, fault.kind) for fault in catalogue(clean)}
    assert len(kinds) >= 110
    families = {"sign", "frame", "wrong body", "time", "inertia", "geometry", "load", "gravity", "friction"}
    families |= {"data", "solver", "ten rows", "half a turn", "drifting velocities", "start", "breathing bar"}
    families |= {"coarse samples", "crank without mass", "m s w^2", "I alpha", "load on the neighbour"}
    assert {family for family, _ in kinds} == families  # a constant force is never late


def _record(family: str, kind: str, named: str = "mass", true: str = "mass", place: str = "rod") -> Record:
    return Record(family, kind, 1.0, "s", "e", True, True, "", place, named, "rod", true, "")


def test_many_quantities_of_one_kind_count_as_one_in_the_mean() -> None:
    named = [_record("sign", f"of {k}", "opposite sign", "opposite sign") for k in range(98)]
    table = rates([*named, _record("inertia", "a mass", "load", place="P5"), _record("inertia", "no mass", "unknown")])
    by_family = table.set_index("family")
    assert by_family.loc[TOTAL, "cause right"] == pytest.approx(0.98)
    assert by_family.loc[MEAN, "cause right"] == pytest.approx(0.5)  # of 1 and 0
    assert by_family.loc[MEAN, "wrong cause"] == pytest.approx(0.25)  # of 0 and 1/2
    assert by_family.loc["inertia: mass", "place right"] == 0.5


def test_causes_and_places_are_of_one_vocabulary(records: Sequence[Record], tmp_path: Path) -> None:
    wrong_line = _record("core", "sign", str(Kind.code), str(Kind.code))
    rows = json.loads((write([*records, wrong_line], tmp_path) / "faults.json").read_text(encoding="utf-8"))
    words = {str(kind) for kind in Kind}
    assert {row["cause"] for row in rows} | {row["true_cause"] for row in rows} <= words
    assert sum((row["cause"], row["place"]) == (row["true_cause"], row["true_place"]) for row in rows) > len(rows) / 2
    families = json.loads((tmp_path / "faults" / "families.json").read_text(encoding="utf-8"))
    assert [family["family"] for family in families][-2:] == [MEAN, TOTAL]
    text = " ".join((Path(__file__).parents[2] / "docs" / "trust.md").read_text(encoding="utf-8").split())
    assert not [word for word in words if f"`{word}`" not in text]


@sampled(1)
@pytest.mark.parametrize("family", ["m s w^2", "I alpha", "late load", "load on the neighbour"])
def test_what_is_left_out_and_where_loads_act_is_named(family: str, references: References) -> None:
    """The faults are sums of the core's solutions under constant forces, the causes use the constraints' Jacobian."""
    reference = references("quick_return")
    clean = Clean(reference, SAMPLING, run("analytic", reference.scene, SAMPLING))
    faults = [fault for fault in left_out(clean) if fault.family == family and fault.spoil is not None]
    for fault in faults:
        assert fault.spoil is not None
        named = cause(reference, SAMPLING, fault.spoil())
        assert (named.kind, named.place) == (fault.cause, fault.place), words(reference.scene, named)
    assert faults


@sampled(1)
@pytest.mark.parametrize("name", ["twisted_four_bar", "gas_spring"])
def test_a_spoilt_element_is_found_and_named(name: str) -> None:
    reference = uncertified(scene_files.load(name))
    clean = Clean(reference, SAMPLING, run("analytic", reference.scene, SAMPLING))
    for fault in [*elements(clean)][::6]:
        assert fault.scene is not None
        wrong = run("analytic", fault.scene, SAMPLING).motion
        assert wrong is not None
        named = cause(reference, SAMPLING, wrong)
        assert (fault.cause, fault.place) in [(of.kind, of.place) for of in (named, *named.others)], fault.kind
        off = {check.check: check.worst for check in checks(reference.mechanics, wrong, reference.travel)}
        assert max(off["Newton"], off["Euler"], off["power"]) > 1e-6, fault.kind


PRESSES = [pytest.param(name, marks=pytest.mark.study) for name in ("toggle_press_friction", "crank_press_friction")]


@pytest.mark.slow
@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("name", ["sticking_drawer", *PRESSES])
def test_friction_that_is_wrong_is_found_placed_and_named(
    name: str, engine: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """All of it, by engines that know friction by their own means: aimed at are 99.5, 95 and 85 %."""
    monkeypatch.setattr(table, "catalogue", friction_of_joints)
    faults = [one for one in judged_faults((name, engine)) if one.above]
    assert len(faults) >= 4
    for one in faults:
        assert one.found, one
        assert (one.place, one.cause) == (one.true_place, one.true_cause), one


def test_friction_is_wrong_in_every_way(references: References) -> None:
    """Its coefficient, its radius, its sense, its joint, or it is left out; of a guide also the contact's length."""
    reference = references("toggle_press_friction")
    clean = Clean(reference, SAMPLING, run("analytic", reference.scene, SAMPLING))
    faults = [*friction_of_joints(clean)]
    ways = {"friction's coefficient", "friction's radius", "friction's length", "friction at another pin"}
    assert {fault.kind for fault in faults} == ways | {
        f"{number}friction {way}" for number in ("", "all ") for way in ("left out", "of the wrong sign")
    }
    assert all(fault.scene is not None and fault.scene.friction != clean.scene.friction for fault in faults)


@pytest.mark.parametrize(("times", "is_above"), [(0.9, False), (1.1, True)])
def test_above(clean: Clean, times: float, *, is_above: bool) -> None:
    """One component is off by so many promises; the engine itself is off by far less."""
    fault = Fault("solver", "", 1.0, "", "")
    off = changed(clean.motion, "P3.fx", times * clean.promise * float(clean.size("P3.fx")[40]))
    assert above(fault, clean, off) == is_above
    assert above(replace(fault, family="data"), clean, off)


def test_above_for_the_drive(clean: Clean) -> None:
    late = Motion({**clean.motion.samples, "crank_angle": clean.motion["crank_angle"] - 1e-6})
    assert above(Fault("time", "", 1.0, "", ""), clean, late)
    assert np.allclose(late["crank_angle"], clean.motion["crank_angle"], atol=1e-5)
