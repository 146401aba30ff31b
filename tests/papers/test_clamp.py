"""The clamp's claims: its numbers and verdicts against a second transcription, its rounding, and the engines' rows."""

import re

import numpy as np
import pytest

from compare.engines import registry
from papers.claims import EQUATION_TOL, Claim, Verdict, half_unit
from papers.clamp.claims import ENGINES, by_engines, claims
from papers.clamp.formulas import MEASURES
from papers.clamp.printed import TABLE_2
from papers.clamp.tables import corners, one_for_all

from . import audit_transcription as second

CLAMPS = {"initial": second.INITIAL, "scheme 4": second.SCHEME_4}


@pytest.fixture(scope="module")
def rows() -> dict[str, Claim]:
    return {claim.claim: claim for claim in (*claims(), *by_engines(pytest.fail))}


def test_the_clamps_numbers(rows: dict[str, Claim]) -> None:
    """The figures that were worked out by hand, to the digits given."""
    expected = {
        "table 1 M_P, initial": 20.10666,
        "table 1 R_S, initial": 1.0149010,
        "table 1 R_V max, initial": 1.63040,
        "table 1 M_P, scheme 4": 22.73834,
        "table 1 R_S, scheme 4": 1.0982354,
        "table 1 R_V max, scheme 4": 1.79600,
        "table 1 L_sum, scheme 4": 1347.0,
        "constraint on S_m, scheme 4": 600.4775,
    }
    for name, value in expected.items():
        assert rows[name].computed == pytest.approx(value, rel=3e-7 if "R_S" in name else 3e-6), name


def test_the_readings_of_the_acceleration(rows: dict[str, Claim]) -> None:
    """By the second transcription, at 100 mm/s; none has the printed rise of 5.5 %, and the note names how far off."""
    spans, means = {}, {}
    for name, clamp in CLAMPS.items():
        alphas = np.linspace(0.5, clamp.alpha_max - 0.2, 4000)  # the differences need room
        a = clamp.acceleration(alphas, 100.0)
        spans[name] = a.max() - a[: a.argmax()].min()
        assert rows[f"table 1 a_m peak-valley, {name}"].computed == pytest.approx(spans[name], rel=1e-5)
        ends = clamp.crosshead(np.array([0.0, clamp.alpha_max]))
        means[name] = clamp.ratio(np.array([clamp.alpha_max]))[0] / np.ptp(ends)
    row = rows["table 1 change of a_m peak-valley, at the same V_o"]
    assert row.computed == pytest.approx(100 * (spans["scheme 4"] / spans["initial"] - 1), abs=1e-3)
    assert row.verdict is Verdict.NOT_REPRODUCIBLE
    assert f"{100 * (means['scheme 4'] / means['initial'] - 1):+.1f} the mean deceleration" in row.note
    assert f"at {np.sqrt(128.5 / means['initial']):.0f} mm/s" in row.note
    assert "as printed, over the stroke" in row.note


def test_the_clamps_verdicts(rows: dict[str, Claim]) -> None:
    assert rows["eq R_S"].verdict is Verdict.WRONG_BRANCH
    assert rows["eq a_m"].verdict is Verdict.MISPRINT
    for name in ("R_V", "omega_1", "omega_2", "omega_4", "epsilon_1", "M_P"):
        assert rows[f"eq {name}"].verdict is Verdict.HOLDS
    for name in ("eq R_S", "eq a_m"):
        assert (rows[name].corrected_residual or 0.0) <= EQUATION_TOL
    assert rows["constraint on L1/L2, scheme 4"].verdict is Verdict.INCONSISTENT
    assert rows["constraint on S_m, scheme 4"].verdict is Verdict.UNDERDETERMINED
    assert rows["constraint, toggle-lock stability, initial"].verdict is Verdict.MISPRINT


def test_the_largest_force_ratio_goes_with_the_sizes_that_are_not_given(rows: dict[str, Claim]) -> None:
    row = rows["optimisation, largest M_P"]
    assert row.printed == "26.55"
    assert row.verdict is Verdict.UNDERDETERMINED
    assert row.computed == pytest.approx(28.757368, abs=1e-6)
    assert "possible: 26.373 to 30.757;" in row.note
    assert "26.55 where L3 ≥ 132, L4 ≥ 135 and L1 − H_b ≤ 129 mm" in row.note


def test_the_engines_verdicts(rows: dict[str, Claim]) -> None:
    for name in ("eq R_V, exudyn", "eq M_P, exudyn", "eq omega_4, exudyn"):
        assert rows[name].verdict is Verdict.HOLDS
    assert rows["eq a_m, exudyn"].verdict is Verdict.MISPRINT
    for engine in ENGINES:
        row = rows[f"simulated R_V, as ADAMS, {engine}"]
        assert row.verdict is Verdict.HOLDS
        assert "R_S 1.09824, R_V max 1.79" in str(row.computed)


def test_an_engine_that_cannot_run_has_no_row(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(registry.Entry, "missing", "it is not installed")
    notes: list[str] = []
    assert list(by_engines(notes.append)) == []
    assert len(notes) == len(ENGINES)


@pytest.mark.parametrize("name", CLAMPS)
def test_one_clamp_has_all_of_table_1(name: str, rows: dict[str, Claim]) -> None:
    """The clamp that is named rounds to table 2, and its numbers round to table 1, by the second transcription."""
    listed = str(rows[f"table 1 but for a_m with table 2, {name}"].computed).partition(":")[2]
    named = {variable: float(value) for variable, value in re.findall(r"(\w+) (\d+\.\d+)", listed)}
    for variable, text in TABLE_2[name].items():
        assert abs(named[variable] - float(text)) <= half_unit(text)
    clamp = second.Clamp(**{variable: value for variable, value in named.items() if variable != "L3"})
    third = np.sqrt(clamp.L1**2 + clamp.L5**2 - 2 * clamp.L1 * clamp.L5 * np.cos(np.radians(clamp.gamma)))
    assert named["L3"] == pytest.approx(third, abs=1e-3)  # seven digits are listed
    ratios = clamp.ratio(np.linspace(1, clamp.alpha_max, 2000))
    numbers = {
        "M_P": 1 / clamp.ratio(np.array([2.5]))[0],
        "R_S": clamp.stroke_ratio,
        "L_sum": sum(named[f"L{k}"] for k in range(1, 6)),
        "R_V max": ratios.max(),
        "R_V startup": ratios[-1],
        "R_V peak-valley": ratios.max() - ratios[ratios.argmax() :].min(),
    }
    for what, value in numbers.items():
        text = rows[f"table 1 {what}, {name}"].printed
        assert abs(value - float(text)) <= half_unit(text), what


def test_no_clamp_is_named_where_none_rounds_to_table_2() -> None:
    force = MEASURES["M_P"].of
    assert one_for_all("initial", [(force, "20.60")]) is not None
    assert one_for_all("initial", [(force, "20.80")]) is None  # beyond the largest corner, 20.72


@pytest.mark.parametrize("name", ["M_P", "R_S", "L_sum", "S_m", "R_V max", "R_V start"])
def test_the_rounding_of_table_2_is_a_range_around_face_value(name: str) -> None:
    face, (low, high) = corners("initial").over(MEASURES[name].of)
    assert low < face < high


@pytest.mark.parametrize(("name", "out", "most"), [("initial", 0, 20.721), ("scheme 4", 32, 23.542)])
def test_corners_that_cannot_lock_are_reported(name: str, out: int, most: float, rows: dict[str, Claim]) -> None:
    """By the second transcription: the crosshead is nowhere where DE is too short for the locked pose."""
    halves = {variable: half_unit(text) for variable, text in TABLE_2[name].items() if variable != "L3"}
    with np.errstate(invalid="ignore"):
        signs = np.stack(np.meshgrid(*[[-1, 1]] * len(halves))).reshape(len(halves), -1)
        ends = {v: getattr(CLAMPS[name], v) + half * s for (v, half), s in zip(halves.items(), signs, strict=True)}
        clamps = second.Clamp(**ends)  # all at once
        locked = clamps.crosshead(np.zeros(signs.shape[1]))
        ratios = 1 / clamps.ratio(np.full(signs.shape[1], 2.5))
    assert np.isnan(locked).sum() == out
    assert ratios[~np.isnan(locked)].max() == pytest.approx(most, abs=5e-4)
    assert f"to {most}; " in rows[f"table 1 M_P, {name}"].note  # the range is over the others alone
    row = rows[f"table 2 with its rounding, {name}"]
    assert str(row.computed).startswith(f"{256 - out} of 256 corners")
    assert row.verdict is (Verdict.UNDERDETERMINED if out else Verdict.HOLDS)
