"""The files of a study. They are written aside and moved in place when all are complete."""

import json
import os
from collections.abc import Iterable, Mapping
from dataclasses import asdict, fields, is_dataclass
from math import isfinite
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import pandas as pd

from scenes import InputError, Motion
from scenes.motion import header

from . import tables
from .environment import environment
from .registry import route
from .report import page
from .study import Study


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
    target = folder / study.scene.name
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with TemporaryDirectory(prefix=f".{study.scene.name}-", dir=folder) as aside:
            written = _write_all(study, Path(aside))
            target.mkdir(exist_ok=True)
            for stale in target.glob("motion.*.csv"):
                stale.unlink()  # an engine that did not run this time must not look as if it had
            for path in written:
                path.replace(target / path.name)
    except OSError as error:
        raise InputError(f"--out {folder}: cannot be written ({error.strerror})") from None
    return target


def _write_all(study: Study, folder: Path) -> list[Path]:
    study.errors.to_csv(folder / "errors.csv", index=False)
    study.speed.to_csv(folder / "speed.csv", index=False)
    for m in study.measurements:
        if m.run.motion is not None:
            _table(m.run.motion).to_csv(folder / f"motion.{m.run.engine}.csv", index=False)
    summary = json.dumps(_plain(_summary(study)), indent=1, allow_nan=False)
    (folder / "summary.json").write_text(summary + "\n", encoding="utf-8")
    (folder / "report.html").write_text(page(study), encoding="utf-8")
    return sorted(folder.iterdir())


def _table(motion: Motion) -> pd.DataFrame:
    return pd.DataFrame({header(channel): values for channel, values in motion.samples.items()})


def _summary(study: Study) -> dict[str, Any]:
    return {
        "scene": study.scene,
        "sampling": asdict(study.sampling),
        "reference": {
            "route": route(study.scene),
            "stroke_m": study.reference.stroke,
            "floor": asdict(study.reference.floor),
        },
        "engines": {
            m.run.engine: {
                "version": m.run.version,
                "status": m.run.status.name,
                "reason": m.run.reason,
                "settings": asdict(m.run.settings) if m.run.settings else None,
                "seconds": {"build": m.run.build_s, "solve": m.run.solve_s, "read": m.run.read_s},
                "counters": m.run.counters,
                "residuals": m.run.residuals,
                "unsupported": m.run.motion.unsupported if m.run.motion else {},
                "checks": [asdict(check) for check in m.checks],
            }
            for m in study.measurements
        },
        "errors": study.errors.to_dict("records"),
        "gates": tables.gates(study).to_dict("records"),
        "environment": environment(),
    }


def _plain(value: Any) -> Any:
    """Return the value as JSON can hold it: what is not finite becomes null, a pair of points `A-B`."""
    if is_dataclass(value):
        return {field.name: _plain(getattr(value, field.name)) for field in fields(value)}
    if isinstance(value, Mapping):
        return {"-".join(sorted(k)) if isinstance(k, frozenset) else str(k): _plain(v) for k, v in value.items()}
    if isinstance(value, Iterable) and not isinstance(value, str):
        return [_plain(item) for item in value]
    if isinstance(value, float):
        return float(value) if isfinite(value) else None
    return value.item() if hasattr(value, "item") else value
