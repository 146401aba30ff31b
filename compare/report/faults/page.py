"""The page of faults: one self-contained HTML file that looks like a scene's report."""

from collections.abc import Sequence
from dataclasses import asdict

import pandas as pd

from ...faults.rates import let_through, rates
from ...faults.table import Record
from ..html import details_html, head, table_html, template, versions_html

FILE = "faults.json"
COLUMNS = ["kind", "magnitude", "scene", "engine", "above", "found", "by", "place", "true_place", "cause", "true_cause"]


def page(records: Sequence[Record]) -> str:
    """Return the page as HTML."""
    table = pd.DataFrame(map(asdict, records))
    families = []
    for family, own in table.groupby("family", sort=False):
        missed_first = own.sort_values("found", kind="stable")[COLUMNS]
        families.append(details_html(f"{family}: {len(own)} faults", table_html(missed_first, "text", whole=FILE)))
    return template("compare.report.faults", "faults.html").substitute(
        head=head("Faults, and whether they are found"),
        rates=table_html(rates(records)),
        let_through=table_html(let_through(records), "text", whole=FILE),
        families="".join(families),
        environment=versions_html(),
    )
