"""The files of studies and families. They are written aside and moved in place when all are complete."""

import json
import os
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import fields, is_dataclass
from enum import Enum
from math import isfinite
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import pandas as pd

from scenes import InputError
from scenes.motion import header

from ..engines.axis import axis
from ..engines.environment import environment
from ..engines.registry import route
from ..family.family import Family
from ..judge.errors import group_floors
from ..judge.measure import Measurement
from ..judge.sketch import distances
from ..speed import work_precision
from ..study import Study
from .family.page import page as family_page
from .family.tables import in_si
from .hard import tables as hard_tables
from .page import page


def check_writable(folder: Path) -> None:
    """Raise InputError when the folder is sure not to take files; nothing is created."""
    existing = next(parent for parent in (folder, *folder.absolute().parents) if parent.exists())
    if not existing.is_dir():
        raise InputError(f"--out {folder}: expected a folder, and {existing} is a file")
    if not os.access(existing, os.W_OK | os.X_OK):
        raise InputError(f"--out {folder}: expected a folder that can be written, and {existing} cannot")


def write(study: Study, folder: Path) -> Path:
    """Write a study's files into `folder/<scene>/` and return that folder.

    Raises:
        InputError: the folder cannot be written; what it held is then unchanged.
    """
    tables = {"errors": study.errors, "speed": study.speed}
    tables |= {name: table for name, table in (("stability", study.maps), ("hard", study.hard)) if len(table)}
    for engine, motion in study.motions.items():
        named = {header(channel): values for channel, values in motion.samples.items()}
        tables[f"motion.{engine}"] = pd.DataFrame(named)
    stale = ("motion.*.csv", "stability.csv", "hard.csv")  # what was not run this time must not look as if it had
    with placed(folder, study.scene.name, *stale) as aside:
        for name, table in tables.items():
            table.to_csv(aside / f"{name}.csv", index=False)
        (aside / "summary.json").write_text(json_text(_summary(study)), encoding="utf-8")
        (aside / "report.html").write_text(page(study), encoding="utf-8")
    return folder / study.scene.name


def write_family(family: Family, folder: Path) -> Path:
    """Write `family.html` and `family.csv` into `folder/<scene>/` and return that folder.

    Raises:
        InputError: the folder cannot be written; what it held is then unchanged.
    """
    with placed(folder, family.scene.name, "family.*") as aside:
        in_si(family).to_csv(aside / "family.csv", index=False)
        (aside / "family.html").write_text(family_page(family), encoding="utf-8")
    return folder / family.scene.name


@contextmanager
def placed(folder: Path, name: str, *stale: str) -> Iterator[Path]:
    """Yield a folder to write files into; once all are complete they go to `folder/<name>/` in place of the stale ones.

    Raises:
        InputError: the folder cannot be written; what it held is then unchanged.
    """
    target = folder / name
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with TemporaryDirectory(prefix=f".{name}-", dir=folder) as aside:
            yield Path(aside)
            target.mkdir(exist_ok=True)
            for path in (path for pattern in stale for path in target.glob(pattern)):
                path.unlink()
            for path in Path(aside).iterdir():
                path.replace(target / path.name)
    except OSError as error:
        raise InputError(f"--out {folder}: cannot be written ({error.strerror})") from None


def _summary(study: Study) -> dict[str, Any]:
    scene = study.scene
    return {
        "scene": scene,
        "sampling": study.sampling,
        "axis": axis(scene),
        "reference": {"route": route(scene), "stroke_m": study.reference.stroke, "floor": study.reference.floor},
        "sketch": distances(study.reference),
        "engines": {m.run.engine: _engine(m) for m in study.measurements},
        "causes": study.causes,
        "errors": study.errors.to_dict("records"),
        "gates": study.gates.to_dict("records"),
        "cheapest": work_precision.choices(study.speed).to_dict("records"),
        "orders": work_precision.orders(study.speed, group_floors(study.reference)).to_dict("records"),
        "hard": hard_tables.counts(study.hard).to_dict("records") if len(study.hard) else [],
        "step_costs": work_precision.step_costs(study.speed).to_dict("records"),
        "environment": environment(),
    }


def _engine(measurement: Measurement) -> dict[str, Any]:
    run = measurement.run
    known = ("version", "status", "reason", "found_by", "settings", "counters", "residuals")
    return {name: getattr(run, name) for name in known} | {
        "seconds": {"build": run.build_s, "solve": run.solve_s, "read": run.read_s},
        "unsupported": run.motion.unsupported if run.motion else {},
        "checks": measurement.checks,
    }


def json_text(value: Any) -> str:
    """Return a value as JSON: what is not finite becomes null, a pair of points `A-B`, a status its name."""
    return json.dumps(_plain(value), indent=1, ensure_ascii=False, allow_nan=False) + "\n"


def _plain(value: Any) -> Any:
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
    if isinstance(value, float):
        return float(value) if isfinite(value) else None
    return value.item() if hasattr(value, "item") else value
