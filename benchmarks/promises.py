"""How verdicts keep their word on random clean scenes.

`python -m benchmarks.promises [--scenes N] [--elements] [--engines a,b] [--out FILE]`: engines at FAST, balanced and
EXACT, 36, 72 and 360 samples; and at accuracies from 1e-2 to 1e-6 at one of the three, scene by scene another one. The
true errors are found outside the comparison, see `tests/true_errors.py`. Every fourth scene is one of small remainders:
level springs, small strokes, drives near balance, see `tests/remainder_scenes.py`; all sketches are a little off. With
`--elements` other scenes, with loads, springs, friction and drives of every kind. Records go to a CSV file as they
come, so that a run that was stopped goes on. 200 scenes take about an hour on one core.
"""

import argparse
from collections.abc import Sequence
from dataclasses import asdict, fields
from pathlib import Path
from tempfile import TemporaryDirectory

import pandas as pd

from compare.engines.registry import TIERS
from tests.clean_scenes import clean_scenes
from tests.promises import ACCURACIES, ENGINES, NUMBERS, PromiseRecord, records

SCENES = 200
SAMPLES = (36, 72, 360)
OUT = Path(__file__).parents[1] / "results" / "promises.csv"
BY, COUNTS = ["engine", "accuracy"], ["ok", "refused", "broken", "false_alarm"]


def main() -> None:
    """Judge the scenes that are not in the file yet, and print the tables of all that are."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--scenes", type=int, default=SCENES)
    parser.add_argument("--engines", default=",".join(ENGINES))
    parser.add_argument("--elements", action="store_true")
    parser.add_argument("--out", type=Path)
    options = parser.parse_args()
    with TemporaryDirectory() as folder:
        out = options.out or OUT.with_stem("promises_elements" if options.elements else OUT.stem)
        report(study(Path(folder), options.scenes, options.engines.split(","), out, elements=options.elements))


def study(folder: Path, count: int, engines: Sequence[str], out: Path, *, elements: bool = False) -> pd.DataFrame:
    """Append the records of the scenes that are not there yet, and return those of all."""
    done = set(pd.read_csv(out, usecols=["number"])["number"]) if out.exists() else set()
    for number, scene in enumerate(clean_scenes(folder, count, elements=elements, rough=True)):
        if number not in done:
            # The ladder of accuracies costs several times a tier, so each scene runs it at one sampling, by turns: over
            # many scenes all samplings are covered alike.
            wanted = dict.fromkeys(SAMPLES, TIERS) | {SAMPLES[number % 3]: ACCURACIES}
            rows = [{"number": number, **asdict(record)} for record in records(scene, wanted, engines)]
            pd.DataFrame(rows).to_csv(out, mode="a", header=not out.exists(), index=False)
            print(f"{number + 1} of {count}: {scene.name}", flush=True)
    # Empty texts stay texts: only errors may be missing. By default pandas would turn statuses and reasons that are
    # empty into NaN.
    return pd.read_csv(out, keep_default_na=False, na_values={"error": [""], "drive": [""]})


def judged(table: pd.DataFrame) -> pd.DataFrame:
    """Return the records with what became of each run: `COUNTS`, and the error of those that are ok."""
    names = [field.name for field in fields(PromiseRecord)]
    made = [PromiseRecord(*row) for row in table[names].itertuples(index=False)]
    broken, false_alarm = [record.broken for record in made], [record.false_alarm for record in made]
    ok = table["status"] == "ok"
    found = table.assign(ok=ok, refused=~ok, broken=broken, false_alarm=false_alarm)
    return found.assign(error_of_ok=table["error"].where(ok))


def by_accuracy(table: pd.DataFrame) -> pd.DataFrame:
    """Return one row an engine and accuracy: how many runs became what, and the largest error of those that are ok."""
    order = {str(accuracy): rank for rank, accuracy in enumerate((*TIERS, *NUMBERS))}
    groups = table.groupby(BY)
    counted = groups.agg(scenes=("number", "nunique"), **{count: (count, "sum") for count in COUNTS})
    found = counted.join(groups["error_of_ok"].max())
    return found.sort_index(key=lambda index: index.map(lambda name: order.get(name, name)))


def report(table: pd.DataFrame) -> None:
    """Print what became of all runs: by engine and accuracy, by feature, and every run with a wrong verdict."""
    table = judged(table)
    print(f"\n{table['number'].nunique()} scenes, {len(table)} runs")
    print(by_accuracy(table).to_string())
    print("\nBy feature:")
    each = table.assign(feature=table["features"].str.split()).explode("feature")
    print(each.groupby(["engine", "feature"])[COUNTS].sum().to_string())
    print("\nRefused, and why:")
    print(table[table["refused"]].groupby([*BY, "status", "found_by"]).size().to_string())
    print(f"\nSilent errors: {table['broken'].sum()}, false doubts: {table['false_alarm'].sum()}")
    for row in table[table["broken"] | table["false_alarm"]].to_dict("records"):
        print(f"{'broken promise' if row['broken'] else 'false alarm'}: {row}")


if __name__ == "__main__":
    main()
