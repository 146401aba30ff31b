"""How many faults were found, family by family, and how many had their place and their cause named."""

from collections.abc import Sequence
from dataclasses import asdict

import pandas as pd

from ..judge.causes.evidence import Kind
from .table import Record

TOTAL = "all of the engines' answers"
CODE = ("core", "shared", "comparison")  # families of wrong lines, which have no cause of the kind that triage names


def rates(records: Sequence[Record]) -> pd.DataFrame:
    """Return one row a family, and one of all faults in engines' answers.

    `place right`, `cause right` and `wrong cause` are shares of the faults that are above the limit and found.
    """
    table = pd.DataFrame(map(asdict, records))
    rows = [_row(str(family), own) for family, own in table.groupby("family", sort=False)]
    answers = table[~table["family"].isin(CODE)]
    return pd.DataFrame([*rows, _row(TOTAL, answers)] if len(answers) else rows)


def _row(family: str, faults: pd.DataFrame) -> dict[str, object]:
    above = faults[faults["above"]]
    found = above[above["found"]]
    placed, named = found["place"] == found["true_place"], found["cause"] == found["true_cause"]
    known = (found["cause"] != Kind.unknown) & (found["cause"] != "")
    judged = family not in CODE
    return {
        "family": family,
        "kinds": faults["kind"].nunique(),
        "faults": len(faults),
        "above the limit": len(above),
        "found": len(found),
        "share found": len(found) / len(above) if len(above) else float("nan"),
        "place right": placed.mean() if family != "comparison" else float("nan"),
        "cause right": named.mean() if judged else float("nan"),
        "wrong cause": (known & ~named).mean() if judged else float("nan"),
    }


def let_through(records: Sequence[Record]) -> pd.DataFrame:
    """Return the faults above the limit that were not found."""
    return pd.DataFrame([asdict(record) for record in records if record.above and not record.found])
