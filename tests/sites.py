"""Folders as distributions with engines are installed in, for tests of engines from outside."""

import sys
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import TypeAlias

import pytest

from compare.engines import outside, registry

Texts: TypeAlias = Mapping[str, str]
ENGINES = "linkage_crosscheck.engines"  # the group of entry points
GOOD = "from analytic.engine import DEFAULT, build\n"  # a module of an engine, with the least that it needs


def install(
    site: Path, name: str, points: Texts, modules: Texts | None = None, metadata: str = "", group: str = ENGINES
) -> None:
    """Install a distribution with entry points of engines: by name their modules; and by name the text of modules."""
    info = site / f"{name}-1.0.dist-info"
    info.mkdir(parents=True)
    head = f"Metadata-Version: 2.1\nName: {name}\nVersion: 1.0\n{metadata}"
    lines = "".join(f"{engine} = {module}\n" for engine, module in points.items())
    (info / "METADATA").write_text(head, encoding="utf-8")
    (info / "entry_points.txt").write_text(f"[{group}]\n{lines}", encoding="utf-8")
    for module, text in (modules or {}).items():
        (site / f"{module}.py").write_text(text, encoding="utf-8")


@contextmanager
def known(site: Path, modules: Iterable[str]) -> Iterator[None]:
    """Have engines looked for in a folder too, and forget what was imported from there afterwards."""
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(str(site))
        patch.setattr(registry, "ENTRIES", registry.OWN | outside.entries(registry.OWN))
        yield
    for module in modules:
        sys.modules.pop(module, None)
    outside.imported.cache_clear()
    outside._offers.cache_clear()
