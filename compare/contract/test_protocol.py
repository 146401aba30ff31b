"""What the engine's module offers."""

import pickle
from dataclasses import FrozenInstanceError
from typing import Any

import pytest

from scenes import Engine, Settings
from scenes.errors import one_line

from ..engines.outside import check
from ..engines.registry import settings_of, tiers


def test_it_gives_its_version(engine: Engine[Any]) -> None:
    """The module can be imported; its version is one line that names what does the work."""
    version = engine.version()
    assert isinstance(version, str)
    assert version == one_line(version) != ""


def test_settings_are_data(name: str) -> None:
    """Settings are frozen dataclasses of `scenes.Settings`, which can be sent to another process."""
    for settings in settings_of(name, full=True):
        assert isinstance(settings, Settings), f"{settings!r}: expected scenes.Settings"
        assert pickle.loads(pickle.dumps(settings)) == settings
        with pytest.raises(FrozenInstanceError):
            settings.label = "another"  # type: ignore[misc]


def test_settings_can_be_told_apart(engine: Engine[Any]) -> None:
    """No two have one label, by which alone tables and figures know them; promises are relative errors."""
    check(engine)


def test_settings_promise_more_the_more_accurate_they_are(name: str) -> None:
    """EXACT promises no less than DEFAULT, which promises no less than FAST."""
    promises = [settings.promise for settings in tiers(name).values()]
    assert promises == sorted(promises, reverse=True)


def test_settings_by_steps(engine: Engine[Any]) -> None:
    """`at_steps`, where there is one, gives settings of so many steps a cycle, and so many iterations in each."""
    if engine.at_steps:
        assert engine.at_steps(24).steps == 24
        assert not engine.iterations_needed or isinstance(engine.at_steps(24, 10), Settings)
