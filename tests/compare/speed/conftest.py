"""The engine whose errors and times are known."""

import pytest

from compare.engines import registry
from compare.mechanics.reference import Reference

from .stubs import Clock, StubEngine


@pytest.fixture
def stub(reference: Reference, monkeypatch: pytest.MonkeyPatch) -> StubEngine:
    """Return an engine named `stub`, the only one there is besides the analytic core, under a clock of its own."""
    clock, real = Clock(tick=1e-9), registry.engine
    engine = StubEngine(reference, clock)
    monkeypatch.setitem(registry.ENTRIES, "stub", registry.Entry("a stub", "", "numpy", "numpy", ""))
    monkeypatch.setattr(registry, "engine", lambda name: engine if name == "stub" else real(name))
    for name in ("processor_time", "perf_counter"):
        monkeypatch.setattr(f"compare.engines.runner.{name}", clock)
    return engine
