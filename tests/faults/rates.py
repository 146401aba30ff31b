"""How many faults were found, family by family, and how many had their place and their cause named."""

from collections.abc import Sequence
from dataclasses import asdict

import pandas as pd

from compare.judge.causes.cause import Kind

from .table import Record

MEAN, TOTAL = "mean over the families of answers", "all of the engines' answers"
CODE = ("core", "shared", "comparison")  # families of wrong lines
SHARES = ("share found", "place right", "cause right", "wrong cause")


def rates(records: Sequence[Record]) -> pd.DataFrame:
    """Return one row a family, one of the mean over those of engines' answers, and one of all faults in these.

    A family is one kind of fault, whatever its quantity, place and amount; many of one kind count as one in the mean.
    `place right`, `cause right` and `wrong cause` are shares of the faults that are above the limit and found.
    """
    table = pd.DataFrame(map(asdict, records))
    code = table["family"].isin(CODE)
    names = table["family"].where(code, table["family"] + ": " + table["true_cause"])
    grouped = (table[of].groupby(names, sort=False) for of in (code, ~code))
    rows, answers = ([_row(str(name), own) for name, own in groups] for groups in grouped)
    if answers:
        mean = pd.DataFrame(answers)[list(SHARES)].mean()
        total = _row(TOTAL, table[~code])
        answers += [{**total, "family": MEAN, **mean}, total]
    return pd.DataFrame([*rows, *answers])


def _row(family: str, faults: pd.DataFrame) -> dict[str, object]:
    above = faults[faults["above"]]
    found = above[above["found"]]
    named = found["cause"] == found["true_cause"]
    shares = (
        len(found) / len(above) if len(above) else float("nan"),
        (found["place"] == found["true_place"]).mean(),
        named.mean(),
        ((found["cause"] != Kind.unknown) & ~named).mean(),
    )
    counts = {"kinds": faults["kind"].nunique(), "faults": len(faults), "above the limit": len(above)}
    return {"family": family, **counts, "found": len(found), **dict(zip(SHARES, shares, strict=True))}


def let_through(records: Sequence[Record]) -> pd.DataFrame:
    """Return the faults above the limit that were not found."""
    return pd.DataFrame([asdict(record) for record in records if record.above and not record.found])
