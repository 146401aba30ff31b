"""A sample of the faults: what is above its limit is found, and `above` is what it claims to be."""

import json
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from compare.faults.__main__ import main, write
from compare.faults.catalogue import catalogue
from compare.faults.fault import Clean, Fault, above
from compare.faults.rates import let_through, rates
from compare.faults.table import SAMPLING, Record, judged_faults
from compare.judge.measure import measure
from scenes import Motion
from tests.comparisons import References, changed


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
    assert {family for family, _ in kinds} == families | {"data", "solver"}


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
