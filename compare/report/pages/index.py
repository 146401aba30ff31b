"""The page with all reports of a folder, a row each, by their `summary.json`."""

from base64 import b64encode
from os import fsencode
from pathlib import Path
from typing import Any
from urllib.parse import quote

from scenes import InputError
from scenes.errors import one_line

from ...judge.agreement import Agreement, Word
from ..numbers import capital, suited, written
from ..output.earlier import Summary, summary_of
from ..tables.first_screen import parted
from .html import render

TITLE = "Reports"


def index_page(folder: Path) -> str:
    """The whole page as HTML, with the reports that lie in a folder, and what there is no report of this program."""
    rows, left_out = list[dict[str, Any]](), dict[str, str]()
    for file in sorted(folder.glob("[!.]*/summary.json")):
        try:
            rows.append(_row(file.parent, summary_of(file)))
        except (InputError, OSError, KeyError, TypeError, ValueError) as error:
            left_out[file.parent.name] = one_line(str(error))
    return render("index.html", title=TITLE, rows=rows, left_out=left_out)


def _row(folder: Path, known: Summary) -> dict[str, Any]:
    title, peaks = one_line(str(known.scene["title"])), parted(known.peaks)[0]
    units = suited(known.scene["units"], ((peak.unit, peak.value) for peak in peaks))
    return {
        "title": title,
        "folder": folder.name,
        "link": quote(fsencode(folder.name) + b"/report.html") if (folder / "report.html").is_file() else "",
        "stopped": not known.complete,
        "agreement": Agreement(Word[known.verdict["word"]], known.verdict["sentence"]),
        "limits": known.limits_verdict,
        "picture": b64encode(known.picture.encode()).decode(),  # as an image: no script of it can run
        "peaks": [(capital(peak.name), written(peak.value, peak.unit, units)) for peak in peaks],
        "since": "the baseline" if known.since_baseline is not None else "the last run",
        "changes": known.since_last_run if known.since_baseline is None else known.since_baseline,
    }
