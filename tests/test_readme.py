"""The figures of README and docs/: errors against a fresh run, times and counts against the published summary."""

import re
from pathlib import Path
from xml.etree.ElementTree import fromstring

import pandas as pd
import pytest

import compare
from compare.engines.registry import DEFAULT_ENGINES, REFERENCE, settings_of
from compare.judge.agreement import Judgement
from compare.judge.errors import group_floors, shown_groups
from compare.measure.speed.speed_table import Budget, speed_table
from compare.measure.speed.work_precision import choices
from scenes import write_starter
from tests.comparisons import SLOW

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text(encoding="utf-8")
FINDINGS = (ROOT / "docs" / "findings.md").read_text(encoding="utf-8")
PUBLISHED = (ROOT / "results" / "published" / "README.md").read_text(encoding="utf-8")
DIGITS = 0.06  # of a figure: half of the last of two digits is 0.05 of 1.0, the rest is for other libraries
ROUND_OFF = 1e-12  # below, an error is a few roundings, which other libraries may do in another order: within a factor
MOST_LINES = 130  # what a visitor reads in two minutes
LARGEST = 300_000  # characters of a picture
FACTOR = 3.0  # also of a ratio of times: 1.3 for a busy core, 1.5 for the choice among level settings, both ways


def table(text: str, start: str) -> list[dict[str, str]]:
    """Return the rows of the first table after `start`, by column."""
    lines = re.search(r"(\|.*\n)+", text[text.index(start) :])
    assert lines is not None
    header, _, *rows = ([cell.strip() for cell in line.strip("| ").split("|")] for line in lines[0].splitlines())
    return [dict(zip(header, row, strict=True)) for row in rows]


def holds(printed: str, fresh: float) -> bool:
    figure = float(printed)
    if figure < ROUND_OFF:
        return figure / FACTOR <= fresh <= figure * FACTOR
    return abs(figure - fresh) <= DIGITS * fresh


@pytest.fixture(scope="module")
def fresh() -> Judgement:
    return compare.check("toggle_press")


def test_errors(fresh: Judgement) -> None:
    found = pd.DataFrame(fresh.channel_errors).groupby(["engine", "group"])["max"].max()
    rows = table(README, "<!-- errors -->")
    assert [row["engine"] for row in rows] == [engine for engine in DEFAULT_ENGINES if engine != REFERENCE]
    groups = shown_groups(fresh.scene)
    for row in rows:
        assert list(row)[1:] == list(groups)
        for group in groups:
            assert holds(row[group], float(found[row["engine"], group])), (row["engine"], group)


def test_what_the_reference_is_good_to(fresh: Judgement) -> None:
    (printed,) = re.findall(r"the reference itself is good to (\S+),", README)
    floor = max(group_floors(fresh.reference).values())
    assert floor <= float(printed) <= FACTOR * floor


@pytest.mark.parametrize(("name", "title"), [("times", "## Cheapest settings"), ("hard", "## Hard cases")])
def test_what_is_published(name: str, title: str) -> None:
    published = {row["engine"]: row for row in table(PUBLISHED, title)}
    rows = table(FINDINGS, f"<!-- {name} -->")
    assert len(rows) == len(published)
    for row in rows:
        assert row.items() <= published[row["engine"]].items()


def test_how_many_settings() -> None:
    (printed,) = re.findall(r"`--full` measures (\d+) settings", FINDINGS)
    assert int(printed) == sum(len(settings_of(engine, full=True)) for engine in DEFAULT_ENGINES)


def test_the_scene_is_the_one_that_new_writes(tmp_path: Path) -> None:
    write_starter(tmp_path / "mine")
    (shown,) = re.findall(r"```toml\n(.*?)```", README, re.DOTALL)
    assert shown == (tmp_path / "mine.toml").read_text(encoding="utf-8")


def test_the_picture_of_the_first_screen_is_of_this_linkage(fresh: Judgement) -> None:
    """In SVG alone, with the verdict and numbers of a fresh run."""
    (file,) = re.findall(r"\]\((\S+\.svg)\)", README)
    picture = (ROOT / file).read_text(encoding="utf-8")
    assert len(picture) < LARGEST
    assert not re.search(r"<(script|image|foreignObject)|href|url\(", picture)
    texts = [element.text or "" for element in fromstring(picture).iter("{http://www.w3.org/2000/svg}text")]
    assert fresh.scene.title in texts
    assert any(text.endswith(fresh.agreement.word) for text in texts)
    stroke, force = (texts[texts.index(name) + 1] for name in ("Stroke", "Largest pin force"))
    pins = [peak.value for peak in fresh.peaks if peak.channel.endswith(".fx")]
    assert holds(stroke.split()[0], 1e3 * fresh.reference.stroke)
    assert holds(force.split()[0], 1e-3 * max(pins))


def test_length() -> None:
    assert README.count("\n") < MOST_LINES


@pytest.mark.parametrize(("mark", "end"), [("Run the main job", "-m compare.run"), ("Run the tests", "-m pytest")])
def test_ci_finds_the_commands_that_it_runs(mark: str, end: str) -> None:
    """As `.ci/run` reads them: the first indented line after the one that has the mark."""
    assert mark in (ROOT / ".ci" / "run").read_text(encoding="utf-8")
    command = next(line for line in README[README.index(mark) :].splitlines() if line.startswith("    "))
    assert command.startswith("    python3 -m venv .venv && .venv/bin/pip install -q -e '.[")
    assert command.endswith(f" && .venv/bin/python {end}")


@SLOW
def test_ratios_of_times(fresh: Judgement) -> None:
    speed = speed_table(fresh.reference, ("exudyn", "pymunk"), Budget(3, 0.0), lambda _: None)
    found = (
        pd.DataFrame([*choices(speed)])
        .query("group == 'reaction' and note == ''")
        .set_index(["engine", "level"])["solve_s"]
    )
    rows = {row["engine"]: row for row in table(FINDINGS, "<!-- times -->")}
    for level in ("1 %", "0.1 %", "1e-4", "1e-6"):
        exudyn, pymunk = (float(rows[engine][level].split()[0]) for engine in ("exudyn", "pymunk"))
        ratio = exudyn / pymunk / (found["exudyn", level] / found["pymunk", level])
        assert 1 / FACTOR <= ratio <= FACTOR, level
