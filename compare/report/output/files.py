"""The files of studies, families and Monte Carlo runs, and what becomes of those of a stopped run."""

import csv
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import fields
from functools import partial
from os.path import relpath
from pathlib import Path
from typing import TYPE_CHECKING, Any

from scenes import InputError, Motion, Sampling, Scene, shipped
from scenes.file.toml import read_text
from scenes.model.enclosures import Assemblies, Enclosure
from scenes.model.motion import header
from scenes.units import SI

from ...engines.kept import environment
from ...engines.registry import route, stopped
from ...judge.agreement import Agreement, Word, worst_error
from ...judge.floor import UnsolvedError
from ...judge.measure import Measurement
from ...judge.sketch import off_sketch
from ...mechanics.axis import axis
from ...study import Study
from ..linkage.still import sketched, small
from ..pages.report import page, unsolved_page
from ..plain import json_text
from ..tables import TableRows
from ..tables import study as tables
from .earlier import Before, json_of
from .placing import ESCAPED, placed, remove, replace_file

if TYPE_CHECKING:
    from ...measure.many.family import Family
    from ...measure.many.study import MonteCarlo

PARTIAL = ".partial"  # after the name of a folder: what a stopped run has, where a complete result is
TABLES = ("peaks.csv", "enclosures.csv", "errors.csv", "speed.csv", "motion.*.csv", "stability.csv", "hard.csv")
REPORT = ("report.html", "summary.json", *TABLES)
FAMILY = ("family.html", "family.json", "family.csv")
MONTE_CARLO = ("monte_carlo.html", "monte_carlo.json", "monte_carlo.csv")
ASSEMBLIES = ("assemblies.html", "assemblies.json")
MAX_INDEX = 10**8  # bytes of an index.html, with a picture a report


def write(
    study: Study,
    folder: Path,
    since: Mapping[str, Any] | None = None,
    before: Before | None = None,
    *,
    complete: bool = True,
) -> Path:
    """Write a study's files into `folder/<scene>/` and return that folder.

    `since` is what changed, for the summary; `before` an earlier run that the page shows too.

    One that was stopped does not take the place of a complete one: it goes to `folder/<scene>.partial/`.

    Raises:
        InputError: the folder cannot be written; what it held is then unchanged.
    """
    written = {"peaks": tables.peaks(study), "errors": tables.errors(study)}
    if study.speed:
        written["speed"] = [row.cells for row in study.speed]
    known = summary(study) | {"picture": small(study.scene, study.motion), **(since or {})}
    with _result(study.scene, folder, REPORT, known, partial(page, study, before), complete=complete) as (aside, place):
        for name, table in written.items():
            _write_table(table, aside / f"{name}.csv")
        _write_table([row._asdict() for row in study.proof.rows], aside / "enclosures.csv", Enclosure._fields)
        for name, frame in (("stability", study.maps), ("hard", study.hard)):
            if frame is not None and len(frame):
                frame.to_csv(aside / f"{name}.csv", index=False)
        for engine, motion in study.motions.items():
            _write_motion(motion, aside / f"motion.{engine}.csv")
    return place


def write_unsolved(scene: Scene, unsolved: UnsolvedError, folder: Path, known: Mapping[str, Any]) -> Path:
    """Write `report.html` and `summary.json` of a scene that cannot run as `write` does, and return the folder."""
    way = stopped(scene, unsolved.failure.at if unsolved.failure else None)
    drawn = partial(unsolved_page, scene, unsolved, way, known.get("since_baseline", known.get("since_last_run", ())))
    known = {**known, "picture": small(scene, way.motion) if way else sketched(scene)}
    with _result(scene, folder, REPORT, known, drawn, complete=True) as (_, place):
        return place


def write_index(folder: Path) -> str:
    """Write `index.html` over all reports of a folder, and return its path; or why it is not written."""
    from ..pages.index import TITLE, index_page  # late, as it reads what the page of one scene does not

    index = folder / "index.html"
    try:
        if index.exists() and f"<title>{TITLE}: cross-check</title>" not in read_text(index, MAX_INDEX):
            return f"{index} is left as it is: it is not of this program"
        replace_file(index, partial(index_page, folder))
    except (OSError, InputError) as error:
        return f"{index} cannot be written ({getattr(error, 'strerror', None) or error})"
    return str(index)


def write_family(family: "Family", folder: Path) -> Path:
    """Write `family.html`, `family.json` and `family.csv` as `write` does, and return the folder."""
    from ..pages.many import family_page  # late, as what is of hard cases: no report of a scene needs it
    from ..tables.family import in_si

    varied = {variation.path: variation.values for variation in family.variations}
    known = {"varied": varied, "engines": family.engines, "environment": environment()}
    page = partial(family_page, family)
    with _result(family.scene, folder, FAMILY, known, page, complete=family.complete) as (aside, place):
        _write_table(in_si(family), aside / "family.csv")
    return place


def write_monte_carlo(study: "MonteCarlo", folder: Path) -> Path:
    """Write `monte_carlo.html`, `.json` and `.csv` as `write` does, and return the folder."""
    from ..pages.many import monte_carlo_page  # late, as what is of families
    from ..tables.monte_carlo import in_si, summary

    known, page = summary(study) | {"environment": environment()}, partial(monte_carlo_page, study)
    with _result(study.scene, folder, MONTE_CARLO, known, page, complete=study.complete) as (aside, place):
        _write_table(in_si(study), aside / "monte_carlo.csv")
    return place


def write_assemblies(scene: Scene, every: Assemblies, folder: Path) -> Path:
    """Write `assemblies.html` and `assemblies.json` beside a scene's report, and return the folder."""
    from ..pages.many import assemblies_page  # late, as what is of families

    known = {"complete": every.complete, "position": every.position, "assemblies": every.found}
    with _result(scene, folder, ASSEMBLIES, known, partial(assemblies_page, scene, every), complete=True) as (_, place):
        return place


@contextmanager
def _result(
    scene: Scene,
    folder: Path,
    patterns: Sequence[str],
    known: Mapping[str, Any],
    page: Callable[[], str],
    *,
    complete: bool,
) -> Iterator[tuple[Path, Path]]:
    """Yield a folder for a result's tables, and its place; then it gets page and summary, the first `patterns`."""
    place, unfinished = folder / scene.name, folder / f"{scene.name}{PARTIAL}"
    if not complete and _may_be_complete(place, patterns):
        place = unfinished
    with placed(folder, place.name, patterns) as aside:
        yield aside, place
        head = {"complete": complete, "made_from": origin(scene, place), **known}
        (aside / patterns[1]).write_text(json_text(head), encoding="utf-8", errors=ESCAPED)
        (aside / patterns[0]).write_text(page(), encoding="utf-8", errors=ESCAPED)
    if complete:
        remove(unfinished, patterns)


def _may_be_complete(place: Path, patterns: Sequence[str]) -> bool:
    """Whether a folder has a result that is not known to be partial."""
    return (
        any(any(place.glob(pattern)) for pattern in patterns)
        and _written(place / patterns[1]).get("complete") is not False
    )


def _written(summary: Path) -> dict[str, Any]:
    """What an older summary has; nothing where there is none, or it is another program's."""
    with suppress(InputError, OSError, TypeError, ValueError):
        return dict(json_of(summary))
    return {}


def origin(scene: Scene, place: Path) -> str:
    """The name of a shipped scene, or its file as seen from the folder of its results."""
    if scene.file in shipped():
        return scene.file
    file = Path(scene.file).resolve()
    with suppress(ValueError):  # on another drive of Windows
        return relpath(file, place.resolve())
    return str(file)


def check_origin(scene: Scene, place: Path) -> None:
    """Raise an InputError where a folder has the result of another scene file that is still there."""
    origin = shipped().get(scene.file, Path(scene.file)).resolve()
    for _, summary, *_ in (REPORT, FAMILY, MONTE_CARLO):
        with suppress(OSError, ValueError, LookupError, TypeError, RecursionError):  # of an unknown origin
            file = _written(place / summary)["made_from"]
            other = shipped().get(file, place.resolve() / file).resolve()
            if other != origin and other.is_file():
                too = f"is that of {file if file in shipped() else other} too, whose result is in {place}"
                raise InputError(f"{scene.file}: name: '{scene.name}' {too}; expected another name, or another --out")


def _write_table(given: TableRows, file: Path, columns: Sequence[str] = ()) -> None:
    """Write rows, of which each may lack some columns; a cell of what is missing or not a number is empty."""
    rows = [*given]
    with file.open("w", encoding="utf-8", errors=ESCAPED, newline="") as text:
        every = dict.fromkeys((*columns, *(column for row in rows for column in row)))
        table = csv.DictWriter(text, every, lineterminator="\n")
        table.writeheader()
        table.writerows({column: cell for column, cell in row.items() if cell == cell} for row in rows)


def _write_motion(motion: Motion, file: Path) -> None:
    """Write a motion's table: pandas takes three times as long for the same text, and a copy of it all."""
    with file.open("w", encoding="utf-8", errors=ESCAPED, newline="\n") as text:
        text.write(",".join(map(header, motion.samples)) + "\n")
        rows = zip(*(values.data for values in motion.samples.values()), strict=True)  # of Python's own floats
        text.writelines(",".join(map(repr, row)) + "\n" for row in rows)


def summary(study: Study) -> dict[str, Any]:
    """What is known of a study, for `summary.json`."""
    scene = study.scene
    hard: TableRows = ()
    if study.hard is not None:
        from ..tables.hard import counts  # late, as what few runs need

        hard = counts(study.hard)
    return {
        "scene": _scene(scene),
        "sampling": study.sampling,
        "axis": axis(scene),
        "reference": {"route": route(scene), "stroke_m": study.reference.stroke, "floor": study.reference.floor},
        "sketch": off_sketch(study.reference),
        "masses": tables.masses(study, SI),
        "verdict": study.agreement,
        "limits_verdict": (limits := study.limits_verdict) and limits._asdict(),
        "proof": {
            "open_at": study.proof.open_at,
            "why": study.proof.why,
            "limits": [limit._asdict() for limit in study.limits],
        },
        "peaks": study.peaks,
        "engines": {m.run.engine: _engine(scene, m) for m in study.measurements},
        "causes": study.causes,
        "errors": tables.errors(study),
        "gates": tables.gates(study),
        "cheapest": study.cheapest,
        "orders": study.orders,
        "hard": hard,
        "step_costs": study.step_costs,
        "environment": environment(),
    }


def unsolved_summary(scene: Scene, sampling: Sampling, unsolved: UnsolvedError) -> dict[str, Any]:
    """What is known of a scene that cannot run, for `summary.json`."""
    nothing = {"engines": {}, "peaks": (), "errors": (), "cheapest": (), "environment": environment()}
    verdict = Agreement(Word.not_solved, unsolved.sentence)
    return {"scene": _scene(scene), "sampling": sampling, "verdict": verdict, **nothing}


def _scene(scene: Scene) -> dict[str, Any]:
    """A scene as summaries always had it, so that earlier ones stay baselines: its one drive by its body and law.

    The tables that it was made of are left out.
    """
    known, (drive,) = {each.name: getattr(scene, each.name) for each in fields(scene)}, scene.drives
    law = {each.name: getattr(drive.law, each.name) for each in fields(drive.law)}
    alone = {"drive": {"body": drive.body, **law}, "drive_on": drive.on}
    return {name: value for name, value in (known | alone).items() if name not in ("drives", "tables")}


def _engine(scene: Scene, measurement: Measurement) -> dict[str, Any]:
    run, worst = measurement.run, worst_error(scene, measurement)
    known = ("version", "status", "reason", "found_by", "settings", "counters", "residuals")
    return {name: getattr(run, name) for name in known} | {
        "seconds": {"build": run.build_s, "solve": run.solve_s, "read": run.read_s},
        "unsupported": run.motion.unsupported if run.motion else {},
        "worst_error": worst and worst._asdict(),
        "checks": measurement.checks,
    }
