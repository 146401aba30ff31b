"""What a user asks for besides the scene: some of the channels, and how accurate the engines are to be."""

from argparse import ArgumentTypeError
from collections.abc import Sequence
from fnmatch import fnmatchcase
from typing import TypeAlias

from scenes import InputError, Scene
from scenes.errors import nearest
from scenes.motion import channels

TIERS = ("fast", "balanced", "exact")

Accuracy: TypeAlias = str | float  # one of `TIERS`, or the largest relative error


def accuracy(text: str) -> Accuracy:
    """Return the accuracy that an argument asks for.

    Raises:
        ArgumentTypeError: it is none.
    """
    if text in TIERS:
        return text
    try:
        level = float(text)
    except ValueError:
        level = 0.0
    if not 0 < level < 1:
        raise ArgumentTypeError(f"expected {', '.join(TIERS)} or a relative error such as 1e-4, found '{text}'")
    return level


def matching(scene: Scene, patterns: Sequence[str]) -> frozenset[str]:
    """Return the channels of a scene whose names match one of the patterns, `P5.*` for example.

    Raises:
        InputError: a pattern matches no channel.
    """
    known = [channel for channel in channels(scene) if channel not in ("time", scene.drive_channel)]
    for pattern in patterns:
        if not any(fnmatchcase(channel, pattern) for channel in known):
            raise InputError(f"--channels: {scene.name} has no channel '{pattern}'{nearest(pattern, known)}")
    return frozenset(c for c in known if any(fnmatchcase(c, pattern) for pattern in patterns))
