"""The page of faults: one self-contained HTML file that looks like a scene's report."""

from collections.abc import Sequence
from dataclasses import asdict

import pandas as pd

from compare.report.pages.html import render

from .rates import let_through, rates
from .table import Record

FILE = "faults.json"
COLUMNS = ["kind", "magnitude", "scene", "engine", "above", "found", "by", "place", "true_place", "cause", "true_cause"]
COLUMNS += ["detail"]


def page(records: Sequence[Record]) -> str:
    """Return the page as HTML."""
    table = pd.DataFrame(map(asdict, records))
    families = table.groupby("family", sort=False)
    return render(
        "faults.html",
        "tests.faults",
        rates=rates(records).to_dict("records"),
        let_through=let_through(records).to_dict("records"),
        families=[
            (family, own.sort_values("found", kind="stable")[COLUMNS].to_dict("records")) for family, own in families
        ],
        file=FILE,
    )
