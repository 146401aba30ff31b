"""A process that is killed leaves one whole result in place, and nothing that the next does not clean.

`python -m benchmarks.kills` kills the main run, a family and `--full`.
"""

import random
from pathlib import Path

import pytest

from compare.report.output.placing import placed
from tests.comparisons import SLOW
from tests.killed import compared, completed, digests, killed

OWN = ("*.csv",)
KILLS, MOST_KILLS = 6, 40  # one in three meets a folder that is being written
WRITER = """
from itertools import count
from pathlib import Path
from compare.report.output.placing import placed
for number in count():
    with placed(Path({out!r}), "name", ("*.csv",)) as aside:
        for file in range(20):
            (aside / f"{{file}}.csv").write_text(str(number))
"""


@SLOW
def test_a_kill_leaves_a_whole_result(tmp_path: Path) -> None:
    """Of a program that does nothing but replace results, 1000 a second."""
    place, draw = tmp_path / "name", random.Random(1)
    with placed(tmp_path, "name", OWN) as aside:
        for file in range(20):
            (aside / f"{file}.csv").write_text("older", encoding="utf-8")
    (place / "notes.txt").write_text("the user's", encoding="utf-8")
    begun, leftovers, kills = completed(["-c", "import compare.report.output.placing"]), 0, 0
    while kills < KILLS or not leftovers:
        kills += 1
        assert kills <= MOST_KILLS, "no kill met a folder that was being written"
        run = killed(["-c", WRITER.format(out=str(tmp_path))], place, begun + draw.uniform(0.1, 1.0))
        assert not run.finished
        assert run.processes == 0
        files = {path.name: path.read_text(encoding="utf-8") for path in place.iterdir()}
        assert files.pop("notes.txt") == "the user's"
        assert len(files) == 20
        assert len({*files.values()}) == 1
        leftovers += len(run.left)
    with placed(tmp_path, "name", OWN) as aside:
        (aside / "0.csv").write_text("", encoding="utf-8")
    assert list(tmp_path.iterdir()) == [place]


@pytest.mark.parametrize(
    ("files", "expected"),
    [
        ({}, "older"),
        ({"report.html": "new</html>\n", "speed.csv": "new"}, "new"),
        ({"report.html": "new</html>\n"}, "mixed=['speed.csv']"),
        ({"report.html": "new", "speed.csv": "new"}, "cut=['report.html']"),
        ({"report.html": "new</html>\n", "speed.csv": "new", "errors.csv": "0"}, "differ=['errors.csv']"),
        ({"report.html": "new</html>\n", "speed.csv": "new", "errors.csv": None}, "differ=['errors.csv']"),
    ],
)
def test_what_counts_as_whole(files: dict[str, str | None], expected: str, tmp_path: Path) -> None:
    for name in ("report.html", "speed.csv", "errors.csv"):
        (tmp_path / name).write_text("older</html>\n", encoding="utf-8")
    older = digests(tmp_path)
    for name, text in files.items():
        if text is None:
            (tmp_path / name).unlink()
        else:
            (tmp_path / name).write_text(text, encoding="utf-8")
    assert expected in compared(older, tmp_path)
