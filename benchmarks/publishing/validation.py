"""Published numbers and tables of other codes as results: `python -m benchmarks.publishing.validation --tables FOLDER`.

FOLDER has `values.csv`, a number a row: `scene,row,drive_position,time,channel,value,tolerance`, SI, the time empty
where the drive's position is the axis; and `scenes/<scene>.toml`. Each scene's numbers become a table and run as by
`--result`; a position that is there twice, forth and back, is in a second table. The page written has no
number of theirs: sources, how many values, and the agreement.
"""

import argparse
import sys
from math import inf, nan
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NamedTuple

import numpy as np
import pandas as pd

from benchmarks.publishing.reference import markdown
from compare.judge.floor import establish
from compare.judge.foreign import assess_result
from compare.judge.measure import Measurement
from compare.mechanics.reference import Reference
from compare.results.result import read_result
from scenes import InputError, load

OUT = Path(__file__).parents[2] / "docs" / "validation.md"
PROMISE = 1e-6  # relative: what each table is held to besides its own tolerances
HEAD = """# Validation

Numbers that nobody here computed: tables of other codes, published reference solutions, exact results. Each ran as a
user's result does, by `--result`, and is judged at its own instants. The tolerances are what the sources are good to;
the last column but one is the largest part of its tolerance that an error takes.

Made by `python -m benchmarks.publishing.validation --tables FOLDER`.

"""


class Agreement(NamedTuple):
    """How the numbers of one scene agree."""

    scene: str
    source: str
    channels: int
    values: int
    error: float  # the largest, relative as everywhere
    of_tolerance: float  # the largest ratio of an error and the tolerance of its value
    status: str


def main() -> int:
    """Run all tables, write the page, and return 1 if a tolerance is missed or a scene is refused."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--tables", type=Path, required=True)
    options = parser.parse_args()
    values = pd.read_csv(options.tables / "values.csv", dtype=str, keep_default_na=False)
    with TemporaryDirectory() as folder:
        found = [
            agreement(options.tables / "scenes" / f"{scene}.toml", numbers, Path(folder))
            for scene, numbers in values.groupby("scene", sort=False)
        ]
    table = pd.DataFrame(found).rename(columns={"error": "largest error", "of_tolerance": "of its tolerance"})
    for column in ("largest error", "of its tolerance"):
        table[column] = table[column].map("{:.1e}".format)
    OUT.write_text(f"{HEAD}{markdown(table)}\n", encoding="utf-8")
    print(table.drop(columns="source").to_string(index=False))
    return int(any(each.status != "ok" or not each.of_tolerance <= 1 for each in found))


def agreement(file: Path, values: pd.DataFrame, folder: Path) -> Agreement:
    """Return how the numbers of a scene agree with the reference, and how its results are judged."""
    count = values["channel"].nunique(), len(values)
    try:
        scene = load(file)
        reference = establish(scene)
        way = "time" if (values["time"] != "").all() else "drive_position"
        # A position that the drive passes forth and back has two values of one channel. Numbered by their occurrence,
        # the values become tables in each of which the axis is unique, as a result needs it.
        again = values.groupby([way, "channel"]).cumcount()
        found = [judged(reference, numbers, way, folder / scene.name) for _, numbers in values.groupby(again)]
    except InputError as error:
        return Agreement(file.stem, "", *count, nan, inf, f"refused: {str(error).rpartition('/')[2]}")
    measured = [each for each, _ in found]
    worst = max(error for each in measured for error in each.worst().values())
    status = next((f"{m.run.status.name}: {m.run.reason}" for m in measured if m.run.reason), "ok")
    return Agreement(scene.name, scene.source, *count, worst, max(ratio for _, ratio in found), status)


def judged(reference: Reference, values: pd.DataFrame, way: str, file: Path) -> tuple[Measurement, float]:
    """Return how numbers are judged as a result, and the largest ratio of an error and its tolerance."""
    scene = reference.scene
    drive = "time" if way == "time" else scene.channels.drive.position
    # Texts stay texts on the way into the CSV file, so that the result is read with the digits of its source; only the
    # order is by number.
    rows = values.sort_values(way, key=lambda texts: texts.astype(float))
    table = rows.pivot(index=way, columns="channel", values="value").loc[rows[way].unique()]
    most = rows.pivot(index=way, columns="channel", values="tolerance").loc[table.index].astype(float)
    table.rename_axis(drive).to_csv(file.with_suffix(".csv"))
    columns = "".join(f'"{channel}" = "{channel}"\n' for channel in (drive, *table.columns))
    file.with_suffix(".toml").write_text(f"promise = {PROMISE}\n[columns]\n{columns}", encoding="utf-8")
    result = read_result(scene, f"theirs={file.with_suffix('.csv')}")
    assert result.run.motion is not None
    true = reference.at(result.run.motion.inputs(scene))
    off = {c: np.abs(result.run.motion[c] - true[c]) / most[c].to_numpy() for c in table.columns}
    return assess_result(reference, result), max(float(ratio.max()) for ratio in off.values())


if __name__ == "__main__":
    sys.exit(main())
