"""What changed since a baseline: every change that is put into a summary is named, and nothing else is."""

import json
import math
import os
from collections.abc import Callable
from copy import deepcopy
from pathlib import Path
from typing import Any

import pytest

from compare.ci.baseline import changes, in_file, unit_of
from compare.report.output.earlier import Change, Summary, read
from compare.report.output.files import summary
from compare.report.plain import json_text
from compare.run import main
from scenes import InputError, Sampling
from tests import scene_files
from tests.comparisons import sampled, studied

Json = dict[str, Any]
Changes = dict[str, Callable[[Json], object]]


@pytest.fixture(scope="module")
def before() -> Json:
    study = studied(scene_files.load("four_bar"), ["analytic", "pymunk"], Sampling(24))
    found: Json = json.loads(json_text(summary(study)))
    return found


def since(old: Json, *made: Callable[[Json], object], new: Json | None = None) -> list[Change]:
    """What changed where changes were made of the old, or in the new."""
    after = deepcopy(new or old)
    for change in made:
        change(after)
    return changes(Summary.model_validate(old), Summary.model_validate(after))


def row(table: list[Json], **known: str) -> Json:
    return next(each for each in table if all(each[name] == value for name, value in known.items()))


def grown(by: float) -> Callable[[Json], None]:
    return lambda s: error(by * row(s["errors"], engine="pymunk", channel="B.fx")["max"])(s)


def put(key: str | int, value: object, *way: str | int) -> Callable[[Json], None]:
    def change(summary: Json) -> None:
        table: Any = summary
        for part in way:
            table = table[part]
        table[key] = value

    return change


def moved(by: float) -> Callable[[Json], None]:
    return lambda s: (peak := row(s["peaks"], name="peak speed")).update(value=(1 + by) * peak["value"])


def without(table: str, **known: str) -> Callable[[Json], None]:
    return lambda s: s[table].remove(row(s[table], **known))


def slower(by: float) -> Callable[[Json], None]:
    def change(summary: Json) -> None:
        for choice in summary["cheapest"]:
            if choice["engine"] == "pymunk" and choice.get("ratio"):
                choice["ratio"] *= by

    return change


def error(size: float | None, engine: str = "pymunk") -> Callable[[Json], None]:
    return lambda s: row(s["errors"], engine=engine, channel="B.fx").update(max=size)


WORSE: Changes = {
    "pymunk: crashed, was ok": put("status", "crashed", "engines", "pymunk"),
    "pymunk reaction: error in B.fx ": grown(2.5),
    "pymunk reaction: error in B.fx unknown, was ": error(None),
    "analytic reaction: error in B.fx 3.0e-12, was ": error(3e-12, "analytic"),
    "pymunk reaction: not returned any more: B.fx": without("errors", engine="pymunk", channel="B.fx"),
    "peaks: peak speed (T) 308": moved(1e-3),
    "peaks: peak speed (T) 3078.": moved(3e-8),
    "peaks: stroke (T) in it alone": without("peaks", name="stroke"),
}
COUPLER = "scene.bodies.coupler"
OTHER: Changes = {
    "scene.bodies.crank.mass 0.7 kg, was 0.5 kg": put("mass", 0.7, "scene", "bodies", "crank"),
    "scene.tolerances.pymunk.position 0.1, was 1e-05": put("position", 0.1, "scene", "tolerances", "pymunk"),
    "scene.bodies.crank.lengths.A-O 110 mm, was 100 mm": put("A-O", 0.11, "scene", "bodies", "crank", "lengths"),
    f"{COUPLER}.inertia 62083 kg mm², was 52083 kg mm²": put("inertia", 0.062083, "scene", "bodies", "coupler"),
    "scene.drive.speed −45 rpm, was −60 rpm": put("speed", -1.5 * math.pi, "scene", "drive"),
    "scene.drive.start 90 deg, was 0 deg": put("start", math.pi / 2, "scene", "drive"),
    "scene.ground.C.0 210 mm, was 200 mm": put(0, 0.21, "scene", "ground", "C"),
    "scene.gravity.1 −9.8 m/s², was −9.81 m/s²": put(1, -9.8, "scene", "gravity"),
    "sampling.samples 48, was 24": put("samples", 48, "sampling"),
    "environment.numpy 9.0, was ": put("numpy", "9.0", "environment"),
    "pymunk: pymunk 9, was pymunk 7.": put("version", "pymunk 9", "engines", "pymunk"),
    "pymunk: run at label others, was ": put("label", "others", "engines", "pymunk", "settings"),
    "pymunk: run at promise 0.5, was ": put("promise", 0.5, "engines", "pymunk", "settings"),
    "pymunk: run at sha256 ab, was none": put("sha256", "ab", "engines", "pymunk", "settings"),  # as of a result
    "pymunk: in it alone": lambda s: (s["engines"].pop("pymunk"), s.update(errors=[], cheapest=[])),
    "pymunk reaction: smaller error in B.fx ": grown(0.4),
    "pymunk: 3 times the time, ": slower(3.0),
    "peaks not in it: another (T)": lambda s: s["peaks"].append(row(s["peaks"], name="stroke") | {"name": "another"}),
}
NOTHING: Changes = {
    "nothing": lambda _: None,
    "an error of less than twice its size": grown(1.9),
    "an error at rounding": error(9e-13, "analytic"),
    "a peak within its interpolation": moved(5e-9),
    "a peak within what the engines differ by": lambda s: (
        moved(1e-3)(s),
        row(s["peaks"], name="peak speed").update(differs={"pymunk": 1e-2}),
    ),
    "a length a last place off, as in another unit": put(0, math.nextafter(0.2, 1), "scene", "ground", "C"),
    "a zero that a unit's conversion rounds": put(1, 1e-17, "scene", "ground", "C"),
    "seconds": put("solve", 1e9, "engines", "pymunk", "seconds"),
    "times in the same ratio": slower(1.5),
    "the title": put("title", "another", "scene"),
    "the file": put("file", "elsewhere.toml", "scene"),
}


@sampled(9)
@pytest.mark.parametrize("text", [*WORSE, *OTHER])
def test_what_changed(text: str, before: Json) -> None:
    (change,) = since(before, (WORSE | OTHER)[text])
    assert change.worse is (text in WORSE)
    assert str(change).startswith(f"{'worse than' if change.worse else 'changed since'} the baseline: {text}")


@pytest.mark.parametrize("what", NOTHING)
def test_what_is_no_change(what: str, before: Json) -> None:
    assert since(before, NOTHING[what]) == []


@pytest.mark.parametrize(
    ("change", "worse"),
    [
        (put("position", 0.1, "scene", "tolerances", "pymunk"), [True, True, False]),
        (put("mass", 0.7, "scene", "bodies", "crank"), 3 * [False]),
        (put("samples", 48, "sampling"), 3 * [False]),
    ],
)
def test_only_of_the_same_linkage_and_sampling_are_errors_and_peaks_worse(
    change: Callable[[Json], None], worse: list[bool], before: Json
) -> None:
    assert [each.worse for each in since(before, change, grown(2.5), moved(1e-3))] == worse


@pytest.mark.parametrize(("value", "named"), [(1e-11, False), (1e-9, True)])
def test_a_moment_that_is_zero_but_for_rounding(value: float, named: bool, before: Json) -> None:
    """What 1e-12 of the largest force makes at an arm of the stroke, 7e-11 N m, is no change."""
    moment = row(before["peaks"], name="peak driving torque") | {"name": "moment", "of": "guide", "differs": {}}
    old, new = ({**before, "peaks": [*before["peaks"], moment | {"value": of}]} for of in (0.0, value))
    assert bool(since(old, new=new)) is named


def test_of_a_scene_that_could_not_run_only_that_and_what_was_asked_for(before: Json) -> None:
    """Nothing ran, so that no engine is missing and no peak is gone."""
    nothing: Json = {"engines": {}, "errors": [], "peaks": [], "cheapest": []}
    assert since(before, new=before | nothing) == [Change("it does not run", worse=True)]
    became, given = since(before | nothing, put("samples", 48, "sampling"), new=before)
    assert (became, given.text) == (Change("it runs"), "sampling.samples 48, was 24")
    assert since(before | nothing, new=before | nothing) == []


def test_units_are_those_of_the_file() -> None:
    units = {"length": ["mm", 1e-3], "mass": ["t", 1e3], "force": ["kN", 1e3], "angle": ["deg", math.pi / 180]}
    scene = {"units": units, "drive": {"body": "ram"}, "bodies": {"ram": {"slide": {}}}}
    expected = {"m/s^2": ("mm/s^2", 1e-3), "N*m": ("kN*mm", 1.0), "N/m": ("kN/mm", 1e6), "rad": ("deg", math.pi / 180)}
    expected |= {"kg*m^2": ("t*mm^2", 1e-3), "s": ("s", 1.0), "J": ("J", 1.0), "": ("", 1.0)}
    for si, (name, size) in expected.items():
        assert in_file(si, scene)[0] == name
        assert in_file(si, scene)[1] == pytest.approx(size, rel=1e-15)
    assert unit_of(("scene", "drive", "start"), scene)[0] == "mm", "of a driven slider"
    assert unit_of(("scene", "bodies", "ram", "slide", "through", 0), scene)[0] == "mm"
    assert unit_of(("scene", "bodies", "ram", "slide", "along", 0), scene)[0] == ""
    assert unit_of(("scene", "bodies"), scene)[0] == ""
    assert unit_of(("scene", "bodies", "ram", "slide"), scene)[0] == ""


def test_many_changes_of_a_kind_are_a_line(before: Json) -> None:
    def grow(after: Json) -> None:
        for error in after["errors"]:
            if error["engine"] == "pymunk" and error["group"] == "reaction":
                error["max"] *= 5 if error["channel"] == "C.fy" else 3

    (change,) = since(before, grow)
    assert change.text.startswith("pymunk reaction: error in C.fy ")
    assert change.text.endswith("; and 5 more")


@pytest.mark.usefixtures("few_settings")
def test_the_command_names_what_changed_and_stops_where_it_is_worse(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    scene = str(scene_files.path("slider_crank"))
    command = [scene, "--engines", "analytic", "--samples", "24", "--check", "--out", str(tmp_path)]
    assert main(command) == 0
    file, text = tmp_path / "slider_crank" / "summary.json", "peaks: stroke (B) 2 m, was 2.5"
    edited = json.loads(file.read_text(encoding="utf-8"))
    assert "since_baseline" not in edited
    row(edited["peaks"], name="stroke")["value"] = 2.5
    file.write_text(json.dumps(edited), encoding="utf-8")
    assert main([*command, "--baseline", str(tmp_path)]) == 1
    assert f"slider_crank  missed: worse than the baseline: {text}\n" in capsys.readouterr().out
    assert json.loads(file.read_text(encoding="utf-8"))["since_baseline"] == [{"text": text, "worse": True}]
    assert f"Worse than the baseline: {text}" in file.with_name("report.html").read_text(encoding="utf-8")


BROKEN = dict.fromkeys(("", "{", "[" * 100_000, "\ufeff"), "not valid JSON: ")
BROKEN |= {"[]": "expected the summary.json of an earlier run", "{}": "scene. Field required"}


@pytest.mark.parametrize("text", BROKEN, ids=lambda text: text[:3] or "empty")
def test_a_broken_baseline_is_named(text: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (file := tmp_path / "old.json").write_text(text, encoding="utf-8")
    assert main(["--baseline", str(file), "--out", str(tmp_path / "out")]) == 2
    error = capsys.readouterr().err
    assert error.startswith(f"--baseline: {file}: ")
    assert BROKEN[text] in error
    assert error.count("\n") == 1
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("change", "text"),
    [
        (put("max", float("nan"), "errors", 3), "errors.3.max."),
        (put("max", "large", "errors", 3), "errors.3.max."),
        (put("errors", {}), "errors."),
        (put("pymunk", None, "engines"), "engines.pymunk."),
        (put("differs", [], "peaks", 0), "peaks.0.differs."),
        (put("name", "toggle_press", "scene"), "expected a result of four_bar, found one of toggle_press"),
        (lambda s: s["scene"].pop("name"), "expected a result of four_bar, found one of None"),
    ],
)
def test_a_baseline_that_is_not_of_the_scene(
    change: Callable[[Json], None], text: str, before: Json, tmp_path: Path
) -> None:
    change(broken := deepcopy(before))
    (file := tmp_path / "old.json").write_text(json.dumps(broken), encoding="utf-8")
    with pytest.raises(InputError, match=text):
        read(file, scene_files.load("four_bar"))


@pytest.mark.parametrize(
    ("name", "why"),
    [("missing.json", "cannot be read"), (".", "cannot be read"), ("pipe", "expected a text file, found a pipe")],
)
def test_a_baseline_that_is_not_there(name: str, why: str, tmp_path: Path) -> None:
    """Nobody writes to a pipe, so that reading it would never end."""
    os.mkfifo(tmp_path / "pipe")
    with pytest.raises(InputError, match=why):
        read(tmp_path / name, scene_files.load("four_bar"))


def test_what_a_baseline_has_is_one_line(before: Json) -> None:
    """No text of another file ends a line: the next would be a command of the workflow."""
    old, bad = deepcopy(before), "x\n::error::\x1b[2J"
    old["engines"]["pymunk"] |= {"version": bad, "status": bad}
    old["engines"][bad] = old["engines"]["pymunk"]
    old["errors"].append(row(old["errors"], engine="pymunk", channel="B.fx") | {"channel": bad, "group": bad})
    old["peaks"].append(old["peaks"][0] | {"name": bad, "of": bad, "unit": bad})
    found = since(old, new=before)
    assert len(found) >= 5
    assert all(str(change).isprintable() for change in found)
