"""A family goes on from what an earlier run kept; by workers it is the same as without, whatever dies."""

import os
import pickle
import subprocess
import sys
from base64 import b64encode
from collections.abc import Callable, Mapping, Sequence
from contextlib import nullcontext
from dataclasses import replace
from pathlib import Path
from signal import SIGINT, SIGKILL
from subprocess import PIPE
from typing import Any

import psutil
import pytest

from compare.engines.kept import decoded, encoded
from compare.measure.many import family
from compare.measure.many.family import Asked, Family, Member
from compare.measure.many.going_on import by_processes, going_on, kept_members
from compare.measure.many.grid import grid, variation
from compare.report.output.files import write_family
from scenes import Sampling, load
from tests.comparisons import SLOW
from tests.deaths import children, doomed, within
from tests.killed import of_session

from .runs import CRANK_SLIDER

pytestmark = pytest.mark.usefixtures("few_settings")

ROOT = Path(__file__).parents[3]
SPEEDS = ("--vary", "drive.speed=10:50:5", "--samples", "72")


@pytest.fixture
def solved(monkeypatch: pytest.MonkeyPatch) -> list[float]:
    """Have members solved at once, the third meet Ctrl-C and the fourth crash; return where their speeds will be."""
    speeds: list[float] = []

    def solve(_: Asked, change: Mapping[str, float], *__: object) -> Member:
        speeds.append(change["drive.speed"])
        if len(speeds) == 3:
            raise KeyboardInterrupt
        if len(speeds) == 4:
            raise ZeroDivisionError
        return Member(change, "ok", "")

    monkeypatch.setattr(family, "_member", solve)
    monkeypatch.setattr(family, "workers", lambda *_: nullcontext())
    return speeds


def run(file: Path, folder: Path, samples: int = 24) -> dict[float, str]:
    """The statuses by speed, in the order in which the members come."""
    scene, changes, sampling = load(file), grid([variation("drive.speed=10:40:4")]), Sampling(samples)
    asked = Asked(scene, ["analytic"], sampling)
    members = going_on(kept_members(folder, scene, asked), asked, changes, None, lambda _: None)
    return {member.changes["drive.speed"]: member.status for member in members}


def test_a_stopped_family_goes_on_where_it_was(tmp_path: Path, solved: list[float]) -> None:
    """What crashed may go well the next time."""
    with pytest.raises(KeyboardInterrupt):
        run(CRANK_SLIDER, tmp_path)
    assert run(CRANK_SLIDER, tmp_path) == {10: "ok", 20: "ok", 30: "crashed", 40: "ok"}
    assert run(CRANK_SLIDER, tmp_path) == dict.fromkeys((10, 20, 40, 30), "ok")
    assert solved == [10, 20, 30, 30, 40, 30]


@pytest.mark.parametrize("other", ["scene", "samples"])
def test_what_is_kept_of_another_family_does_not_count(other: str, tmp_path: Path, solved: list[float]) -> None:
    scene, text = tmp_path / "mine.toml", CRANK_SLIDER.read_text(encoding="utf-8")
    scene.write_text(text, encoding="utf-8")
    with pytest.raises(KeyboardInterrupt):
        run(scene, tmp_path)
    if other == "scene":
        scene.write_text(text.replace("mass = 7", "mass = 8"), encoding="utf-8")
    run(scene, tmp_path, 36 if other == "samples" else 24)
    assert solved == [10, 20, 30, 10, 20, 30, 40]


def test_members_that_are_kept_make_the_same_report(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Of an engine that is off, so that causes are kept too; none is solved again."""
    scene, variations, sampling = load(CRANK_SLIDER), [variation("drive.speed=10:20:2")], Sampling(36)
    engines, changes = ["analytic", "pymunk"], grid(variations)
    written = []
    for again in ("first", "second"):
        asked = Asked(scene, engines, sampling)
        members = going_on(kept_members(tmp_path, scene, asked), asked, changes, None, lambda _: None)
        written.append(write_family(Family(scene, variations, engines, [*members]), tmp_path / again))
        monkeypatch.setattr(family, "_member", lambda *_: pytest.fail("solved again"))
    first, second = map(files, written)
    assert {*first} == {"family.html", "family.json", "family.csv"}
    assert first == second


class Bomb:
    """Of which a pickle makes a file where it is read."""

    def __init__(self, file: Path) -> None:
        self.file = file

    def __reduce__(self) -> tuple[object, ...]:
        return Path.touch, (self.file,)


def test_what_is_kept_is_data_that_runs_nothing(tmp_path: Path, solved: list[float]) -> None:
    """Whoever can write there knows how a line is marked."""
    scene, sampling = load(CRANK_SLIDER), Sampling(24)
    changes = grid([variation("drive.speed=10:40:4")])
    packed = b64encode(pickle.dumps(Bomb(tmp_path / "ran"))).decode()
    kept = kept_members(tmp_path, scene, Asked(scene, ["analytic"], sampling))
    other = encoded([Member({}, "ok", ""), {}])
    hostile: list[Any] = [packed, [packed, {}], None, {}, {"pathlib:Path": {}}, other]
    hostile += [{kind: ["os", "system"]} for kind in ("os:system", "tuple", "dict", "array", "settings")]
    for data in hostile:
        kept.add(str(changes[0]), data)
    with pytest.raises(KeyboardInterrupt):
        run(CRANK_SLIDER, tmp_path)
    assert solved == [10, 20, 30]
    assert not (tmp_path / "ran").exists()


NO_DATA: tuple[object, ...] = (
    *({"subprocess:Popen": {"args": "true"}}, {"scenes:Status": {"value": "label"}}, {"nothing": []}),
    *({"compare.engines.processes.isolation:Worker": {"function": 1}}, {"compare.engines.processes.isolation:os": {}}),
    *({"array": ["O", [1], ""]}, {"array": ["<f8", [10**9], ""]}, {"tuple": [], "frozenset": []}),
)


@pytest.mark.parametrize("data", NO_DATA)
def test_data_of_nothing_are_refused(data: object) -> None:
    with pytest.raises((ValueError, TypeError)):
        decoded(data)


def dying(asked: Asked, task: tuple[Mapping[str, float], object]) -> Member:
    """A member that may run; of speeds that end in 5 it takes its process along, of such below 20 the first time."""
    speed = task[0]["drive.speed"]
    tries = Path(asked.scene.file) / f"{speed:g}"
    if speed % 10 == 5 and not (speed < 20 and tries.exists()):
        tries.open("a", encoding="utf-8").write("x")
        os.kill(os.getpid(), SIGKILL)
    return Member(task[0], "ok", "")


def test_a_member_whose_process_dies_is_tried_once_more_by_itself(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("compare.measure.many.going_on._on_worker", dying)
    monkeypatch.setattr("compare.measure.many.going_on.changed", lambda *_: None)
    scene, changes = replace(load(CRANK_SLIDER), file=str(tmp_path)), grid([variation("drive.speed=10:30:5")])
    asked = Asked(scene, ["analytic"], Sampling(24))
    kept = kept_members(tmp_path, scene, asked)
    members = [*going_on(kept, asked, changes, by_processes(2), lambda _: None)]
    assert {member.changes["drive.speed"]: member.status for member in members} == {
        **dict.fromkeys((10, 15, 20, 30), "ok"),
        25: "crashed",
    }
    assert [member.reason for member in members if member.status == "crashed"] == [
        "its process was killed, as where memory runs out, or fell silent"
    ]
    assert {name: (tmp_path / name).read_text("utf-8") for name in ("15", "25")} == {"15": "x", "25": "xx"}
    assert children() == []


def test_an_engine_that_dies_is_a_row_of_its_member(tmp_path: Path) -> None:
    """By workers too, whose engines have processes of their own."""
    scene, changes = load(CRANK_SLIDER), grid([variation("drive.speed=10:20:2")])
    asked = Asked(scene, ["analytic", "pymunk"], Sampling(24))
    with doomed({"pymunk": "abort"}):
        members = [*going_on(kept_members(tmp_path, scene, asked), asked, changes, by_processes(1), lambda _: None)]
    for member in members:
        assert member.judgement is not None
        reasons = {engine: verdict for engine, verdict in member.judgement.verdicts.items() if verdict[0] != "ok"}
        assert reasons == {"pymunk": ("crashed", "its process ended by SIGABRT")}


@SLOW
def test_whatever_dies_the_family_is_the_same(tmp_path: Path) -> None:
    """A run by workers that meets Ctrl-C, and one that goes on from there and loses a worker."""
    arguments = [str(CRANK_SLIDER), *SPEEDS, "--engines", "analytic,pymunk", "--out"]
    # In a process of its own, as the workers are, which certify as many positions as users' runs do.
    subprocess.run([sys.executable, "-m", "compare.run", *arguments, str(tmp_path / "alone")], check=True, cwd=ROOT)
    status, told = stopped([*arguments, str(tmp_path / "out")], tmp_path, 1, lambda run: os.killpg(run.pid, SIGINT))
    assert (status, told.count("\n")) == (130, 1)
    assert "Stopped after" in (tmp_path / "out" / "offset_slider_crank" / "family.html").read_text(encoding="utf-8")
    assert stopped([*arguments, str(tmp_path / "out")], tmp_path, 3, kill_a_worker) == (0, "")
    assert {path.name for path in (tmp_path / "out").iterdir()} == {"offset_slider_crank"}
    alone, out = (files(tmp_path / where / "offset_slider_crank") for where in ("alone", "out"))
    assert alone == out


def files(folder: Path) -> Mapping[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.iterdir()}


def stopped(
    arguments: Sequence[str], folder: Path, after: int, stop: Callable[[subprocess.Popen[str]], None]
) -> tuple[int, str]:
    """Run a family by two workers, stop something after some members, and return the status and what is on stderr."""
    scratch = folder / "scratch"
    scratch.mkdir(exist_ok=True)
    command = [sys.executable, "-m", "compare.run", *arguments, "--workers", "2"]
    surroundings = {**os.environ, "TMPDIR": str(scratch)}
    with (
        (folder / "stderr.txt").open("w+", encoding="utf-8") as errors,
        subprocess.Popen(
            command, cwd=ROOT, env=surroundings, start_new_session=True, stdout=PIPE, stderr=errors, text=True
        ) as run,
    ):
        assert run.stdout is not None
        for _ in range(after):
            assert " ok " in run.stdout.readline()
        stop(run)
        run.stdout.read()
        run.wait()
        errors.seek(0)
        told = errors.read()
    assert within(5.0, lambda: not [*of_session(run.pid)])
    assert [*scratch.iterdir()] == []
    return run.returncode, told


def kill_a_worker(run: subprocess.Popen[str]) -> None:
    """Kill one whose parent is its guard."""
    guards = psutil.Process(run.pid).children()
    assert len(guards) == 2
    guards[0].children()[0].kill()
