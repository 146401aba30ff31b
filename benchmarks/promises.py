"""How verdicts keep their word on random clean scenes.

`python -m benchmarks.promises [--scenes N] [--engines a,b] [--out FILE]`: engines at FAST, balanced and EXACT, 36, 72
and 360 samples; and at accuracies from 1e-2 to 1e-6 at one of the three, scene by scene another one. The true errors
are found outside the comparison, see `tests/true_errors.py`. Records go to a CSV file as they come, so that a run that
was stopped goes on. 200 scenes take about an hour on one core.
"""

import argparse
from collections.abc import Sequence
from dataclasses import asdict, fields
from pathlib import Path
from tempfile import TemporaryDirectory

import pandas as pd

from compare.engines.settings import TIERS
from tests.clean_scenes import clean_scenes
from tests.promises import ACCURACIES, ENGINES, NUMBERS, PromiseRecord, records

SCENES = 200
SAMPLES = (36, 72, 360)
OUT = Path(__file__).parents[1] / "results" / "promises.csv"
BY = ["engine", "accuracy"]


def main() -> None:
    """Judge the scenes that are not in the file yet, and print the tables of all that are."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--scenes", type=int, default=SCENES)
    parser.add_argument("--engines", default=",".join(ENGINES))
    parser.add_argument("--out", type=Path, default=OUT)
    options = parser.parse_args()
    with TemporaryDirectory() as folder:
        study(Path(folder), options.scenes, options.engines.split(","), options.out)
    report(pd.read_csv(options.out, keep_default_na=False, na_values={"error": [""], "drive": [""]}))


def study(folder: Path, count: int, engines: Sequence[str], out: Path) -> None:
    """Append the records of the scenes that are not there yet."""
    done = set(pd.read_csv(out, usecols=["number"])["number"]) if out.exists() else set()
    for number, scene in enumerate(clean_scenes(folder, count)):
        if number not in done:
            wanted = dict.fromkeys(SAMPLES, TIERS) | {SAMPLES[number % 3]: ACCURACIES}
            rows = [{"number": number, **asdict(record)} for record in records(scene, wanted, engines)]
            pd.DataFrame(rows).to_csv(out, mode="a", header=not out.exists(), index=False)
            print(f"{number + 1} of {count}: {scene.name}", flush=True)


def report(table: pd.DataFrame) -> None:
    """Print what became of all runs: by engine and accuracy, by feature, and every run with a wrong verdict."""
    names = [field.name for field in fields(PromiseRecord)]
    made = [PromiseRecord(*row) for row in table[names].itertuples(index=False)]
    table = table.assign(
        ok=table["status"] == "ok",
        refused=table["status"] != "ok",
        broken=[record.broken for record in made],
        false_alarm=[record.false_alarm for record in made],
    )
    table["error_of_ok"] = table["error"].where(table["ok"])
    order = {str(accuracy): rank for rank, accuracy in enumerate((*TIERS, *NUMBERS))}
    counts = ["ok", "refused", "broken", "false_alarm"]
    by_accuracy = table.groupby(BY)[counts].sum().join(table.groupby(BY)["error_of_ok"].max())
    print(f"\n{table['number'].nunique()} scenes, {len(table)} runs")
    print(by_accuracy.sort_index(key=lambda index: index.map(lambda name: order.get(name, name))).to_string())
    print("\nBy feature:")
    each = table.assign(feature=table["features"].str.split()).explode("feature")
    print(each.groupby(["engine", "feature"])[counts].sum().to_string())
    print("\nRefused, and why:")
    print(table[table["refused"]].groupby([*BY, "status", "found_by"]).size().to_string())
    print("\nWrong verdicts:")
    for record in (record for record in made if record.broken or record.false_alarm):
        what = "broken promise" if record.broken else "false alarm"
        print(f"{what}: {record}")


if __name__ == "__main__":
    main()
