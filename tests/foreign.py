"""Results as other programs write them: the analytic motion in other units, another frame, and at decimals."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

import analytic
from scenes import Scene
from scenes.channels import Role
from scenes.model.motion import Samples
from scenes.scene import GROUND

Texts = Mapping[str, list[str]]  # by column
DEGREES = {"crank_angle": 'unit = "deg"'}  # what a mapping has besides the name of a column


@dataclass(frozen=True)
class Writer:
    """How a program writes a motion."""

    length: float = 1.0  # m that its unit of length has
    angle: float = 1.0  # rad
    force: float = 1.0  # N
    origin: complex = 0j  # m, of its frame
    turn: float = 0.0  # rad, of its x axis
    mirrored: bool = False
    other_side: bool = False  # whether all forces are those on the other body
    decimals: str = ".17g"

    def columns(self, scene: Scene, times: Samples, channels: list[str]) -> dict[str, Samples]:
        """Return what it writes, by channel: the motion at instants, s, which is in its units and frame."""
        solved = analytic.solve(scene, scene.drive.law.at(times).position, times)
        found = {channel: self._written(scene, solved.samples, channel) for channel in channels}
        return {"time": times} | found

    def _written(self, scene: Scene, motion: Mapping[str, Samples], channel: str) -> Samples:
        stem, _, kind = channel.rpartition(".")
        way, other = (
            (-1 if self.mirrored else 1),
            (-1 if self.other_side and channel in scene.channels.names(Role.force) else 1),
        )
        if kind in ("fx", "fy"):
            return other * self._component(motion, stem, "f", kind) / self.force
        if kind[-1] in "xy":
            return self._component(motion, stem, kind[:-1], kind) / self.length
        if kind in ("angle", "crank_angle"):
            turn = 0.0 if kind == "crank_angle" and scene.drive.on != GROUND else self.turn  # of two bodies, which turn
            return np.asarray(way * (motion[channel] - turn) / self.angle)
        if kind in ("omega", "alpha"):
            return way * motion[channel] / self.angle
        unit = self.force * (self.length if kind in ("guide_moment", "torque") else 1.0)
        return np.asarray(other * (way if kind != "force" else 1) * motion[channel] / unit)

    def _component(self, motion: Mapping[str, Samples], stem: str, order: str, kind: str) -> Samples:
        vector = motion[f"{stem}.{order}x"] + 1j * motion[f"{stem}.{order}y"]
        vector = (vector - (self.origin if not order else 0)) * np.exp(-1j * self.turn)
        vector = vector.conj() if self.mirrored else vector
        return np.asarray(vector.real if kind[-1] == "x" else vector.imag)

    def texts(self, columns: Mapping[str, Samples]) -> dict[str, list[str]]:
        """Return columns as they are written, by channel."""
        return {channel: [format(value, self.decimals) for value in values] for channel, values in columns.items()}

    def file(self, folder: Path, columns: Mapping[str, Samples], *mapping: str, **read: str) -> Path:
        """Write columns and their mapping, see `write`."""
        return write(folder, self.texts(columns), *mapping, **read)


def instants(scene: Scene, count: int = 90, cycles: float = 0.9, seed: int = 1) -> Samples:
    """Return instants in no equal steps, s, over a part of a cycle."""
    steps = np.random.default_rng(seed).uniform(0.3, 1.7, count)
    return np.asarray(np.cumsum(steps) / steps.sum() * cycles * scene.cycle)


def channels(scene: Scene) -> list[str]:
    """Return all channels but the time and the drive's."""
    return [*scene.channels.names(Role.kinematic, Role.force, Role.friction)]


def write(folder: Path, texts: Texts, mapping: str = "", name: str = "theirs", sep: str = ",", **read: str) -> Path:
    """Write a table, whose columns are c0, c1, ..., and its mapping, and return the table's file."""
    file = folder / f"{name}.csv"
    lines = [sep.join(f"c{k}" for k in range(len(texts)))]
    lines += [sep.join(row) for row in zip(*texts.values(), strict=True)]
    file.write_text("\n".join(lines) + "\n", encoding="utf-8")
    as_read = {c: f'{{ column = "c{k}", {read[c]} }}' if c in read else f'"c{k}"' for k, c in enumerate(texts)}
    columns = "".join(f'"{channel}" = {column}\n' for channel, column in as_read.items())
    file.with_suffix(".toml").write_text(f"{mapping}\n[columns]\n{columns}", encoding="utf-8")
    return file


MILLIMETRES = 'units = { length = "mm", angle = "deg", force = "kN" }\n'
ELSEWHERE = Writer(1e-3, np.pi / 180, 1e3, complex(0.12, -0.34), 0.6, mirrored=True, other_side=True)
MAPPED = (
    'made_by = "A. Designer"\nmade_with = "Mechanica 7"\nother_side = ["*"]\n'
    f"{MILLIMETRES}frame = {{ origin = [120, -340], angle = {float(np.degrees(0.6))!r}, mirrored = true }}\n"
)
