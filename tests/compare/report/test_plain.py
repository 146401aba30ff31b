"""Values as JSON has them."""

from compare.report.plain import plain
from tests import scene_files


def test_tables_of_the_file_stay_tables() -> None:
    varied = {"variations": [{"path": "drive.speed", "plus_minus": 0.1}], "limits": {"O.force": {"most": 2.0}}}
    shown = plain(scene_files.load("four_bar", varied))
    assert shown["variations"] == [{"path": "drive.speed", "plus_minus": 0.1, "distribution": "normal"}]
    assert shown["limits"] == {"O.force": {"least": None, "most": 2.0}}
