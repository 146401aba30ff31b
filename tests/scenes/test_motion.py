"""A motion as a data frame and as what a notebook shows."""

import re
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from scenes import Motion
from scenes.model.motion import HEIGHT, MARGIN, WIDTH, sparkline

MOTION = Motion(
    {"time": np.array([0.0, 0.5, 1.0]), "P.x": np.array([1.0, -2.0, 3.0])}, {"P/rod.fx": "it has <no> forces & masses"}
)


def corners(curve: str) -> list[tuple[float, float]]:
    (points,) = re.findall(r'points="(.*?)"', curve)
    return [(float(x), float(y)) for x, y in (corner.split(",") for corner in points.split())]


def test_a_frame_has_the_columns_of_the_files() -> None:
    frame = MOTION.to_frame()
    assert list(frame.columns) == ["time [s]", "P.x [m]"]
    assert frame.to_numpy().tolist() == [[0.0, 1.0], [0.5, -2.0], [1.0, 3.0]]


def test_a_frame_as_parquet(tmp_path: Path) -> None:
    pytest.importorskip("pyarrow")
    MOTION.to_frame().to_parquet(tmp_path / "motion.parquet")
    pd.testing.assert_frame_equal(pd.read_parquet(tmp_path / "motion.parquet"), MOTION.to_frame())


def test_what_a_notebook_shows() -> None:
    shown = MOTION._repr_html_()
    assert "<th>3 samples</th>" in shown
    assert "<tr><th>P.x [m]</th><td>-2</td><td>3</td><td><svg" in shown
    assert "<tr><th>P/rod.fx</th><td colspan=3>unsupported: it has &lt;no&gt; forces &amp; masses</td></tr>" in shown
    assert Motion({})._repr_html_().startswith("<table><tr><th>0 samples</th>")


def test_a_curve_goes_from_its_least_value_at_the_bottom_to_its_largest_at_the_top() -> None:
    left, middle, right = MARGIN, WIDTH / 2, WIDTH - MARGIN
    high = HEIGHT - 2 * MARGIN
    by_hand = np.array([(left, MARGIN + 0.4 * high), (middle, HEIGHT - MARGIN), (right, MARGIN)])
    drawn = np.array(corners(sparkline(MOTION["P.x"])))
    assert drawn == pytest.approx(by_hand, abs=0.05)  # tenths of a pixel are written
    assert len(corners(sparkline(np.arange(1e6)))) == WIDTH


@pytest.mark.parametrize("values", [[3.0, 3.0], [3.0], [1.0, np.nan], [np.inf, 2.0]])
def test_a_curve_without_a_height(values: list[float]) -> None:
    assert {y for _, y in corners(sparkline(np.array(values)))} == {HEIGHT / 2}
