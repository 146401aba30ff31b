"""The files of studies, families and Monte Carlo runs, and what becomes of those of a stopped run."""

import csv
import json
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import fields, is_dataclass
from enum import Enum
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from scenes import InputError, Motion
from scenes.motion import header
from scenes.scene import SI
from scenes.toml_file import SUMMARY_BYTES, read_text

from ..engines.axis import axis
from ..engines.environment import environment
from ..engines.registry import route
from ..judge.agreement import WorstError, worst_error
from ..judge.measure import Measurement
from ..judge.sketch import distances
from ..study import Study
from . import tables
from .origin import origin
from .page import page
from .placing import placed, remove
from .speed import tables as speed_tables

if TYPE_CHECKING:
    from pandas import DataFrame

    from ..family.family import Family
    from ..monte_carlo.study import MonteCarlo

PARTIAL = ".partial"  # after the name of a folder: what a stopped run has, where a complete result is
REPORT = (
    "report.html",
    "summary.json",
    "peaks.csv",
    "errors.csv",
    "speed.csv",
    "motion.*.csv",
    "stability.csv",
    "hard.csv",
)
FAMILY = ("family.html", "family.json", "family.csv")
MONTE_CARLO = ("monte_carlo.html", "monte_carlo.json", "monte_carlo.csv")
BLOCK = 4096  # rows of a motion that are text at a time


def write(study: Study, folder: Path, changed: Sequence[Any] | None = None, *, complete: bool = True) -> Path:
    """Write a study's files into `folder/<scene>/` and return that folder; `changed` is what did since a baseline.

    One that was stopped does not take the place of a complete one: it goes to `folder/<scene>.partial/`.

    Raises:
        InputError: the folder cannot be written; what it held is then unchanged.
    """
    written = {"peaks": tables.peaks(study), "errors": tables.errors(study), "speed": speed_tables.every_setting(study)}
    in_full = {"stability": study.maps, "hard": study.hard}
    with _result(folder, study.scene.name, REPORT, complete=complete) as (aside, place):
        for name, table in written.items():
            _write_table(table, aside / f"{name}.csv")
        for name, frame in in_full.items():
            if frame is not None and len(frame):
                frame.to_csv(aside / f"{name}.csv", index=False)
        for engine, motion in study.motions.items():
            _write_motion(motion, aside / f"motion.{engine}.csv")
        head = {"complete": complete, "made_from": origin(study.scene, place)}
        since = {} if changed is None else {"since_baseline": changed}
        (aside / "summary.json").write_text(json_text(head | summary(study) | since), encoding="utf-8")
        (aside / "report.html").write_text(page(study), encoding="utf-8")
    return place


def write_family(family: "Family", folder: Path) -> Path:
    """Write `family.html`, `family.json` and `family.csv` into `folder/<scene>/` and return that folder.

    One that was stopped does not take the place of a complete one: it goes to `folder/<scene>.partial/`.

    Raises:
        InputError: the folder cannot be written; what it held is then unchanged.
    """
    from .family.page import page as family_page  # late, as what is of hard cases: no report of a scene needs it
    from .family.tables import in_si

    summary = {
        "varied": {variation.path: variation.values for variation in family.variations},
        "engines": family.engines,
    }
    return _write_many(family, folder, FAMILY, in_si(family), summary, family_page)


def write_monte_carlo(study: "MonteCarlo", folder: Path) -> Path:
    """Write `monte_carlo.html`, `.json` and `.csv` into `folder/<scene>/` and return that folder.

    One that was stopped does not take the place of a complete one: it goes to `folder/<scene>.partial/`.

    Raises:
        InputError: the folder cannot be written; what it held is then unchanged.
    """
    from .monte_carlo.page import page as monte_carlo_page  # late, as what is of families
    from .monte_carlo.tables import in_si, summary

    return _write_many(study, folder, MONTE_CARLO, in_si(study), summary(study), monte_carlo_page)


def _write_many(
    many: Any,
    folder: Path,
    own: tuple[str, str, str],
    table: "DataFrame",
    summary: Mapping[str, Any],
    page: Callable[[Any], str],
) -> Path:
    """Write the page, the summary and the table on many linkages of one scene."""
    html, summary_json, csv = own
    with _result(folder, many.scene.name, own, complete=many.complete) as (aside, place):
        table.to_csv(aside / csv, index=False)
        head = {"complete": many.complete, "made_from": origin(many.scene, place)}
        text = json_text({**head, **summary, "environment": environment()})
        (aside / summary_json).write_text(text, encoding="utf-8")
        (aside / html).write_text(page(many), encoding="utf-8")
    return place


def _write_table(rows: tables.Rows, file: Path) -> None:
    """Write rows, of which each may lack some columns; a cell of what is missing or not a number is empty."""
    columns = dict.fromkeys(column for row in rows for column in row)
    with file.open("w", encoding="utf-8", newline="") as text:
        table = csv.writer(text, lineterminator="\n")
        table.writerow(columns)
        for row in rows:
            cells = (row.get(column) for column in columns)
            table.writerow("" if cell is None or cell != cell else cell for cell in cells)


def _write_motion(motion: Motion, file: Path) -> None:
    """Write a motion's table in blocks: pandas takes three times as long for the same text, and a copy of it all."""
    with file.open("w", encoding="utf-8", newline="\n") as text:
        text.write(",".join(map(header, motion.samples)) + "\n")
        for start in range(0, len(motion["time"]), BLOCK):
            rows = np.stack([values[start : start + BLOCK] for values in motion.samples.values()], axis=1)
            text.writelines(",".join(map(repr, row)) + "\n" for row in rows.tolist())


@contextmanager
def _result(folder: Path, name: str, own: Sequence[str], *, complete: bool) -> Iterator[tuple[Path, Path]]:
    """Yield a folder to write a result into, and its place, which is another where a partial one meets a complete one.

    `own` is what its files match; the one that ends in `.json` has whether the result is complete.
    """
    place, partial = folder / name, folder / f"{name}{PARTIAL}"
    if not complete and _may_be_complete(place, own):
        place = partial
    with placed(folder, place.name, own) as aside:
        yield aside, place
    if complete:
        remove(partial, own)


def _may_be_complete(place: Path, own: Sequence[str]) -> bool:
    """Return whether a folder has a result that is not known to be partial."""
    if not any(list(place.glob(pattern)) for pattern in own):
        return False
    summary = next(name for name in own if name.endswith(".json"))
    try:
        return json.loads(read_text(place / summary, SUMMARY_BYTES))["complete"] is not False
    except (InputError, OSError, ValueError, LookupError, TypeError, RecursionError):
        return True


def summary(study: Study) -> dict[str, Any]:
    """Return what is known of a study, for `summary.json`."""
    scene, hard = study.scene, list[Any]()
    if study.hard is not None:
        from .hard.tables import counts  # late, as what few runs need

        hard = counts(study.hard).to_dict("records")
    return {
        "scene": scene,
        "sampling": study.sampling,
        "axis": axis(scene),
        "reference": {"route": route(scene), "stroke_m": study.reference.stroke, "floor": study.reference.floor},
        "sketch": distances(study.reference),
        "masses": tables.masses(study, SI),
        "verdict": study.agreement,
        "peaks": study.peaks,
        "engines": {m.run.engine: _engine(m, worst_error(scene, m)) for m in study.measurements},
        "causes": study.causes,
        "errors": tables.errors(study),
        "gates": tables.gates(study),
        "cheapest": study.cheapest,
        "orders": study.orders,
        "hard": hard,
        "step_costs": study.step_costs,
        "environment": environment(),
    }


def _engine(measurement: Measurement, worst: WorstError | None) -> dict[str, Any]:
    run = measurement.run
    known = ("version", "status", "reason", "found_by", "settings", "counters", "residuals")
    return {name: getattr(run, name) for name in known} | {
        "seconds": {"build": run.build_s, "solve": run.solve_s, "read": run.read_s},
        "unsupported": run.motion.unsupported if run.motion else {},
        "worst_error": worst and worst._asdict(),
        "checks": measurement.checks,
    }


def json_text(value: Any) -> str:
    """Return a value as JSON: what is not finite becomes null, a pair of points `A-B`, a status its name."""
    return json.dumps(_plain(value), indent=1, ensure_ascii=False, allow_nan=False) + "\n"


def _plain(value: Any) -> Any:
    if isinstance(value, float):
        return float(value) if isfinite(value) else None
    if type(value) in (str, int, bool):  # nearly all that is left
        return value
    if is_dataclass(value):
        return {field.name: _plain(getattr(value, field.name)) for field in fields(value)}
    if isinstance(value, Mapping):
        return {"-".join(sorted(k)) if isinstance(k, frozenset) else str(k): _plain(v) for k, v in value.items()}
    if isinstance(value, frozenset):
        return sorted(value)
    if isinstance(value, Enum):
        return value.name
    if isinstance(value, Iterable) and not isinstance(value, str):
        return [_plain(item) for item in value]
    return value.item() if hasattr(value, "item") else value
