"""Summaries of earlier runs, whoever wrote them: read within bounds, or refused in one line."""

import json
from collections.abc import Callable
from pathlib import Path
from resource import RUSAGE_SELF, getrusage
from typing import Any

import pytest

from compare.report.output.earlier import summary_of
from compare.report.pages.index import index_page
from scenes import InputError
from tests.comparisons import sampled

WHOLE: dict[str, Any] = {
    "scene": {"name": "a", "title": "A", "units": {"length": ["mm", 1e-3]}},
    "sampling": {},
    "environment": {},
    "engines": {},
    "errors": [],
    "peaks": [{"name": "stroke", "of": "A", "channel": "A.x", "value": 0.1, "unit": "m", "differs": {}}],
    "cheapest": [],
    "verdict": {"word": "agrees", "sentence": "They agree."},
}
MEGABYTES = 150  # that one may take in all: 16 of text, its objects, and some room
MANY = 400_000
LARGE: dict[str, tuple[str, Callable[[], str], str]] = {  # by name: the key, its JSON, and why it is refused
    "rows without fields": ("errors", lambda: f"[{_listed('{}')}]", r"errors\.0\.engine\. Field required"),
    "engines without fields": ("engines", lambda: _table("{}"), "10000 entries at most"),
    "changes without text": ("since_last_run", lambda: f"[{_listed('{}')}]", "10000 entries at most"),
    "differences of text": (
        "peaks",
        lambda: json.dumps([WHOLE["peaks"][0] | {"differs": 0}]).replace(" 0}", f" {_table(json.dumps(''))}}}"),
        "10000 entries at most",
    ),
    "a million lists": ("scene", lambda: f'{{"a": [{_listed("[]", 1_000_000)}]}}', "500000 lists and tables at most"),
    "17 MB": ("picture", lambda: json.dumps("a" * (17 << 20)), "16777216 bytes at most"),
}
WRONG: dict[str, dict[str, Any]] = {
    "a unit of no size": {"scene": {"title": "A", "units": {"length": ["mm", 0]}}},
    "a unit below zero": {"scene": {"title": "A", "units": {"length": ["mm", -1e-3]}}},
    "a unit of no number": {"scene": {"title": "A", "units": {"length": ["mm", "NaN"]}}},
    "a unit by itself": {"scene": {"title": "A", "units": {"length": 1}}},
    "a unit beyond doubles": {"scene": {"title": "A", "units": {"length": ["mm", 5e-324]}}},
    "no units": {"scene": {"title": "A"}},
    "a title that is none": {"scene": {"title": [], "units": {"length": ["mm", 1e-3]}}},
    "an unknown verdict": {"verdict": {"word": "excellent", "sentence": ""}},
    "a number of 400 digits": {"peaks": [WHOLE["peaks"][0] | {"value": 10**400}]},
}


def _listed(text: str, count: int = MANY) -> str:
    return ", ".join([text] * count)


def _table(text: str) -> str:
    return "{" + ", ".join(f'"{n}": {text}' for n in range(MANY)) + "}"


def written(folder: Path, **changes: object) -> Path:
    folder.mkdir(parents=True)
    file = folder / "summary.json"
    file.write_text(json.dumps(WHOLE | changes), encoding="utf-8")
    return file


def test_one_that_is_whole(tmp_path: Path) -> None:
    assert summary_of(written(tmp_path / "a")).scene == WHOLE["scene"]


@sampled(2)
@pytest.mark.parametrize("name", LARGE)
def test_a_large_one_takes_no_more_memory_than_its_text_asks_for(name: str, tmp_path: Path) -> None:
    key, text, reason = LARGE[name]
    file = tmp_path / "summary.json"  # by its text: objects that are made here would hide what reading takes
    others = json.dumps({other: value for other, value in WHOLE.items() if other != key})
    file.write_text(f'{others[:-1]}, "{key}": {text()}}}', encoding="utf-8")
    before = getrusage(RUSAGE_SELF).ru_maxrss
    with pytest.raises(InputError, match=reason):
        summary_of(file)
    assert getrusage(RUSAGE_SELF).ru_maxrss - before <= MEGABYTES * 1024


def test_a_wrong_one_is_left_out_of_the_index(tmp_path: Path) -> None:
    written(tmp_path / "whole")
    for name, changes in WRONG.items():
        written(tmp_path / name, **changes)
    page = index_page(tmp_path)
    assert page.count("/summary.json: ") == len(WRONG)
    assert page.count("They agree.") == 1
