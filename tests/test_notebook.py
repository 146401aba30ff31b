"""The notebook of docs/: every cell runs, what it shows is a table and a picture, and it is kept without outputs."""

from pathlib import Path

import nbformat
from nbclient import NotebookClient

from tests.comparisons import SLOW

NOTEBOOK = Path(__file__).parents[1] / "docs" / "notebook.ipynb"
SHOWN = {  # by the last line of a cell: the kind of what it shows, and what is in that
    "result": (
        "text/html",
        ["Hoecken", "@keyframes", "Largest pin force", "<th>torque</th>", "<td>exudyn</td>", "<td>pymunk</td>"],
    ),
    'result.plot("T.ay")': ("application/vnd.plotly.v1+json", ["T.ay", "exudyn error", "pymunk error", "floor"]),
    "motion": ("text/html", ["73 samples", "drive.torque [N*m]", "<polyline"]),
    "motion.to_frame().head()  # .to_csv(...), .to_parquet(...)": ("text/html", ["time [s]", "crank_angle [rad]"]),
    "family": ("text/html", ["<td>240</td>", "<td>260</td>", "stroke", "<polyline"]),
    "family.plot()": ("application/vnd.plotly.v1+json", ["C-B = 240", "C-B = 260", "T: velocity"]),
}


@SLOW
def test_every_cell_shows_what_it_is_for() -> None:
    notebook = nbformat.read(NOTEBOOK, as_version=4)  # type: ignore[no-untyped-call]
    cells = [cell for cell in notebook.cells if cell.cell_type == "code"]
    assert not any(cell.outputs or cell.execution_count for cell in cells)
    NotebookClient(notebook, timeout=120).execute()
    assert len(cells) == len(SHOWN)
    for cell, (last, (kind, parts)) in zip(cells, SHOWN.items(), strict=True):
        assert cell.source.endswith(last)
        (output,) = cell.outputs
        for part in parts:
            assert part in str(output.data[kind]), last
