"""Maps of where engines are stable, and their pictures."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest

import scenes
from compare.engines import registry
from compare.engines.processes.stopping import Stopped
from compare.engines.runner import HERE
from compare.judge.floor import establish
from compare.measure.hard import stability
from compare.report.figures.hard import FAILED_COLOUR, LETTERS, stability_maps
from compare.report.figures.offline import offline
from scenes import Scene, Status
from tests import scene_files
from tests.comparisons import SLOW


@pytest.fixture(scope="module")
def press() -> Scene:
    return scenes.load("toggle_press")


def quiet(_: str) -> None:
    pass


@contextmanager
def few(steps: Sequence[int], **others: Sequence[int]) -> Iterator[None]:
    """Maps of fewer cells: of these steps a cycle, and what is across."""
    with pytest.MonkeyPatch.context() as patch:
        for name, numbers in {"STEPS": steps, **others}.items():
            patch.setattr(stability, name, numbers)
        yield


@pytest.fixture(scope="module")
def sweeps(press: Scene) -> pd.DataFrame:
    with few((72, 216), SWEEPS=(8, 64, 256)):
        return pd.DataFrame([*stability.over_sweeps(establish(press), "pymunk", quiet, HERE)])


def test_theory_is_on_the_safe_side_of_where_the_toggle_press_holds(sweeps: pd.DataFrame) -> None:
    assert set(sweeps["needed"]) == {55}
    enough = sweeps["x"] >= sweeps["needed"]
    flips = sweeps["status"].isin(["wrong_branch", "diverged", "nonfinite"])
    assert not (enough & flips).any()
    assert flips[sweeps["x"] < sweeps["needed"] / 4].all()


def test_cells_are_tidy_and_say_all(sweeps: pd.DataFrame) -> None:
    assert len(sweeps) == 6
    assert not sweeps.duplicated(["map", "engine", "x", "steps"]).any()
    good = sweeps[sweeps["status"] == "ok"]
    groups = [name for name in map(str, sweeps) if name.endswith("_max")]
    assert groups == [f"{group}_max" for group in ("position", "velocity", "acceleration", "reaction", "torque")]
    assert (good["error"] == good[groups].max(axis=1)).all()
    assert (good["solve_s"] > 0).all()
    # Of second order: three times the steps, a ninth of the error.
    by_steps = good[good["x"] == 256].set_index("steps")["error"]
    assert 6 < by_steps[72] / by_steps[216] < 12
    bad = sweeps[sweeps["status"] != "ok"]
    assert (bad["reason"] != "").all()
    assert (bad["error"] > 0.01).all()  # handed over though refused


def test_steps_against_scenes_ever_closer_to_a_lock() -> None:
    """Crank-rockers that lie stretched out once a turn, ever closer; without a reference what the engine says."""
    gaps = {f"{gap:g}": {"bodies.rocker.lengths.B-Q": 0.5 + gap} for gap in (1e-1, 1e-6)}
    variants = [(label, scene_files.load("stretched_rocker", changes)) for label, changes in gaps.items()]
    variants.append(("0", scene_files.load("loaded_four_bar", {"bodies.rocker.lengths.C-D": 0.05})))
    with few((72, 648)):
        rows = pd.DataFrame([*stability.over_variants("lock", variants, ["pymunk"], quiet, HERE)])
    assert list(rows["x"]) == [0.1, 0.1, 1e-6, 1e-6, 0, 0]
    by_label = rows.groupby("label")["status"].agg(set)
    assert by_label["0.1"] == {"ok"}
    assert "ok" not in by_label["1e-06"]
    assert by_label["0"] == {"cannot_assemble"}
    assert rows["error"][4:].isna().all()


def test_the_heaviest_body_gets_heavier(press: Scene) -> None:
    for label, scene in stability.heavier(press):
        assert scene.bodies["slider"].mass == pytest.approx(800 * float(label))
        others = {name: body for name, body in scene.bodies.items() if name != "slider"}
        assert others == {name: body for name, body in press.bodies.items() if name != "slider"}
    plate = replace(press.bodies["slider"], inertia=2.0, com=(0.0, 0.0))
    by_factor = dict(stability.heavier(replace(press, bodies={**press.bodies, "slider": plate})))
    assert by_factor["10"].bodies["slider"].inertia == pytest.approx(20)


def test_drift_is_of_the_last_turn(press: Scene) -> None:
    with few((216, 648), TURNS=(1, 4)):
        rows = pd.DataFrame([*stability.over_turns(establish(press), "pymunk", quiet, HERE)])
    assert set(rows["status"]) == {"ok"}
    one, four = rows["error"]
    assert four == pytest.approx(one, rel=1e-3)  # no drift: the crank is moved, and the joints close in every step
    assert one == pytest.approx(rows["position_max"][0])
    once = establish(scenes.load("double_toggle_clamp"))
    assert not [*stability.over_turns(once, "pymunk", quiet, HERE)]


@SLOW
@few((72, 216), SWEEPS=(64,), TURNS=(1,))
def test_all_maps_of_the_engines_that_have_any(press: Scene) -> None:
    assert [name for name in ("pymunk", "analytic") if registry.engine(name).at_steps] == ["pymunk"]
    table = stability.stability_table(press, ("analytic", "pymunk"), [("0.1", press)], quiet)
    assert [*dict.fromkeys(table["map"])] == ["sweeps", "lock", "mass", "drift"]
    assert set(table["engine"]) == {"pymunk"}
    kinematic = replace(press, bodies={n: replace(b, mass=None) for n, b in press.bodies.items()}, loads=())
    table = stability.stability_table(kinematic, ("pymunk",), [], quiet)
    assert [*dict.fromkeys(table["map"])] == ["sweeps", "drift"]
    assert stability.stability_table(press, ("analytic",), [], quiet).empty


def test_a_stop_keeps_what_is_done(press: Scene) -> None:
    said: list[str] = []

    def stop_at_third(sentence: str) -> None:
        said.append(sentence)
        if len(said) == 3:
            raise Stopped

    table = stability.stability_table(press, ("pymunk",), [], stop_at_third)
    assert len(table) == 2
    assert said[0] == "stability of pymunk: 2 sweeps, 24 steps"
    (_, figure), *_ = stability_maps(table)
    assert len(figure.traces[0]["text"]) == 2


def test_what_an_engine_raises_beside_its_runs_is_its_status(press: Scene, monkeypatch: pytest.MonkeyPatch) -> None:
    """Of what is optional in its protocol: the cells that need it are crashed, the others go on."""
    module = SimpleNamespace(**vars(registry.engine("analytic")))
    monkeypatch.setattr(registry, "engine", lambda _: module)
    reference = establish(press)
    module.at_steps, module.iterations_needed = lambda *_: module.DEFAULT, lambda *_: 1 / 0
    with few((24,), SWEEPS=(8,)):
        (cell,) = stability.over_sweeps(reference, "analytic", quiet, HERE)
    assert cell["status"] == "crashed"
    assert str(cell["reason"]).startswith("iterations_needed: ZeroDivisionError: division by zero (tests/compare/hard/")
    module.iterations_needed = lambda *_: "many"
    with few((24,), SWEEPS=(8,)):
        (cell,) = stability.over_sweeps(reference, "analytic", quiet, HERE)
    assert cell["status"] == "crashed"
    module.at_steps, module.iterations_needed = lambda steps: {24: module.DEFAULT, 216: 216}[steps], lambda *_: 9
    with few((24,), SWEEPS=(8,)):
        (cell,) = stability.over_sweeps(reference, "analytic", quiet, HERE)
    assert (cell["status"], cell["needed"]) == ("crashed", 9)
    assert str(cell["reason"]).startswith("at_steps: TypeError")
    with few((24, 72, 216, 648), TURNS=(1,)):
        good, bad, odd = stability.over_turns(reference, "analytic", quiet, HERE)
    assert (good["status"], bad["status"]) == ("ok", "crashed")
    assert str(bad["reason"]).startswith("at_steps: KeyError: 72 (tests/compare/hard/test_stability.py, line ")
    assert odd["reason"] == "at_steps: TypeError: expected scenes.Settings, found int"
    (_, figure), *_ = stability_maps(pd.DataFrame([good, bad]))
    assert offline(figure)


def test_pictures_tell_errors_failures_and_theory(sweeps: pd.DataFrame) -> None:
    ((title, drawn),) = stability_maps(sweeps)
    figure = offline(drawn)
    assert "sweeps" in title
    cells, theory = figure.data
    seen: dict[bool, list[tuple[float, str]]] = {True: [], False: []}
    for place, cell in enumerate(sweeps.to_dict("records")):
        assert (cells.x[place], cells.y[place]) == (
            ["8", "64", "256"].index(cell["label"]),
            [72, 216].index(cell["steps"]),
        )
        fine = cell["status"] == "ok"
        seen[fine].append((cell["error"], cells.meta[place]))
        if fine:
            assert float(cells.text[place]) == pytest.approx(cell["error"], rel=0.5)
        else:
            assert cells.text[place] == LETTERS[Status[cell["status"]]]
            assert cell["reason"].split()[0] in cells.customdata[place]
    assert {shade for _, shade in seen[False]} == {FAILED_COLOUR}
    green = [int(shade[3:5], 16) for _, shade in sorted(seen[True])]  # which only grows along the scale
    assert green == sorted(green)
    assert len({*green}) == len(green) > 1
    # Between 8 and 64 sweeps, by the logarithm.
    assert theory.x[0] == pytest.approx(np.log(55 / 8) / np.log(64 / 8))
    key = figure.layout.annotations[-1].text
    assert all(status.name in key for status in LETTERS if status.name in set(sweeps["status"]))


def test_every_failure_has_a_letter_of_its_own() -> None:
    assert {*LETTERS} == {*Status} - {Status.ok}
    assert len({*LETTERS.values()}) == len(LETTERS)
    assert not [*stability_maps(pd.DataFrame())]
