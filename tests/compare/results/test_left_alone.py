"""What a proposed mapping leaves alone: round-off, other axes where the ground's fit as well, and links' axes."""

import re
from pathlib import Path

import numpy as np
import pytest

import analytic
import scenes
from compare.results.proposal import proposed
from tests import scene_files
from tests.comparisons import SLOW, sampled
from tests.foreign import Writer, channels, instants

ROUND_OFF = 1e-12  # SI, of channels of linkages of about a metre, a second and a newton


@sampled(1)
@pytest.mark.parametrize("name", [pytest.param("lift", marks=SLOW), "two_blocks", "wedge_and_ram"])
def test_round_off_is_no_match(name: str, tmp_path: Path) -> None:
    """Channels that stand still are written as what is left of sums, 1e-16 or so: in a table they show nothing."""
    scene = scene_files.load(name)
    columns = Writer().columns(scene, instants(scene, 40), channels(scene))
    still = [channel for channel in channels(scene) if 0 < np.ptp(columns[channel]) < ROUND_OFF]
    assert still
    moves = [channel for channel in channels(scene) if np.ptp(columns[channel]) > 1e-3][:4]
    table = {channel: columns[channel] for channel in ("time", *still, *moves)}
    lines = proposed(scene, f"theirs={Writer().file(tmp_path, table)}").splitlines()
    read = {column for line in lines if line.startswith('"') for column in re.findall(r'"(c\d+)"', line)}
    assert read
    assert not read & {f"c{k}" for k, channel in enumerate(table) if channel in still}, lines


@sampled(1)
@pytest.mark.parametrize("signs", [(-1, -1), (-1, 1), (1, -1)])
def test_the_scenes_axes_come_first(signs: tuple[int, int], tmp_path: Path) -> None:
    """Forces on the other bodies are no forces in a mirrored and turned frame, whatever other columns fit little."""
    scene = scenes.load("four_bar")
    times = instants(scene, 60)
    names = [f"{pin}.f{q}" for pin in ("O", "C", "A", "B") for q in "xy"]
    columns = Writer().columns(scene, times, names)
    columns = {c: values * (signs["xy".index(c[-1])] if c != "time" else 1) for c, values in columns.items()}
    columns |= {"other": np.random.default_rng(0).standard_normal(60), "third": np.cos(3 * times) ** 2}
    columns |= {"fourth": np.sin(times) ** 3}
    lines = proposed(scene, f"theirs={Writer(decimals='.5g').file(tmp_path, columns)}").splitlines()
    assert not [line for line in lines if line.startswith("frame")]
    for k, channel in enumerate(names, 1):
        sign = ", sign = -1 }" if signs["xy".index(channel[-1])] < 0 else ""
        column = f'{{ column = "c{k}"{sign}' if sign else f'"c{k}"'
        assert any(line.startswith(f'"{channel}" = {column}  # sure') for line in lines), (channel, lines)


def test_joints_by_the_axes_of_their_links_are_named(tmp_path: Path) -> None:
    """Each column is named; none is read as a channel that it is like by chance, as A's is an acceleration."""
    scene = scenes.load("four_bar")
    times = instants(scene, 60)
    true = analytic.solve(scene, scene.drive.law.at(times).position, times)
    columns = Writer().columns(scene, times, ["T.x", "T.y"])
    for pin, body in (("A", "coupler"), ("B", "rocker")):
        vector = (true[f"{pin}.fx"] + 1j * true[f"{pin}.fy"]) * np.exp(-1j * (true[f"{body}.angle"] + 0.3))
        columns |= {f"{pin} along": vector.real / 1e3, f"{pin} across": vector.imag / 1e3}  # in kN, of its own x axis
    lines = proposed(scene, f"theirs={Writer().file(tmp_path, columns)}").splitlines()
    assert [line.split('"')[1] for line in lines if line.startswith('"')] == ["time", "T.x", "T.y"]
    for column, pin, body in (("c3", "A", "coupler"), ("c4", "A", "coupler"), ("c5", "B", "rocker")):
        named = f"# No mapping reads {column}: it is of {pin}.fx, {pin}.fy by the axes of {body}, not the ground's"
        assert any(line.startswith(named) for line in lines), lines
