"""What GitHub shows of a check: an annotation for each miss, and the summary of the step."""

import os
import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from html import escape
from pathlib import Path

from scenes import InputError, Scene, shipped
from scenes.file.reader import file_of

from ..judge.agreement import Judgement
from ..judge.errors import shown_groups
from ..judge.measure import Miss

WORKSPACE, SUMMARY = "GITHUB_WORKSPACE", "GITHUB_STEP_SUMMARY"  # environment variables that its runners set
MAX_LINKAGES, MAX_LINES = 20, 1000  # linkages of a family, and lines, that a summary shows; it takes a megabyte
# TOML keys, tables and assignments as far as their line is looked for: tomllib returns no line numbers. A path in an
# inline table or over several lines is found up to the part that begins a line; that line is then marked.
_KEY = r"""(?:"[^"\n]*"|'[^'\n]*'|[\w-]+)"""
_PATH = rf"{_KEY}(?:\s*\.\s*{_KEY})*"
_LINE = re.compile(rf"\s*(?:\[\[?\s*(?P<table>{_PATH})\s*\]|(?P<key>{_PATH})\s*=)")


def report(scene: Scene, judged: Mapping[str, Judgement], misses: Mapping[str, Sequence[Miss]]) -> None:
    """Print the annotations of what each misses, and append to the summary of the step where there is one."""
    for name, missed in misses.items():
        causes = judged[name].causes if name in judged else {}
        for miss in missed:
            print(annotation(scene, name, miss, causes.get(miss.engine, "")))
    if file := os.environ.get(SUMMARY):
        off = [name for name in judged if misses[name]] or [*judged]
        lines = [line for name in off[:MAX_LINKAGES] for line in _section(name, judged[name])]
        lines += [f"- missed: {_plain(miss.text)}" for missed in misses.values() for miss in missed]
        try:
            with Path(file).open("a", encoding="utf-8") as summary:
                summary.write("\n".join([*lines[:MAX_LINES], ""]))
        except OSError as error:
            raise InputError(f"{SUMMARY}: {file}: cannot be written ({error.strerror})") from None


def annotation(scene: Scene, name: str, miss: Miss, cause: str = "") -> str:
    """The workflow command that marks a miss, in the scene file at the line of the tolerance if it has one."""
    path, title = ("tolerances", miss.engine, miss.group), f"{name} {miss.engine} {miss.group}".strip()
    return _error(scene.file, path, title, f"{miss.text}; likely cause: {cause}" if cause else miss.text)


@contextmanager
def refusals(name_or_path: str) -> Iterator[None]:
    """Print the annotation of a scene file that is refused, and go on with the error."""
    try:
        yield
    except InputError as error:
        print(_error(str(file_of(name_or_path)), (), name_or_path, str(error)))
        raise


def _error(name_or_file: str, path: Sequence[str], title: str, text: str) -> str:
    """The workflow command that marks an error, at the line of a path in a file, if it is none that ships."""
    place: dict[str, object] = {}
    if name_or_file not in shipped():
        file = Path(name_or_file).resolve()
        root = Path(os.environ.get(WORKSPACE) or Path.cwd()).resolve()
        place["file"] = file.relative_to(root).as_posix() if file.is_relative_to(root) else file
        if line := line_of(file, path):
            place["line"] = line
    properties = ",".join(f"{key}={_escaped(str(value), ':,')}" for key, value in (place | {"title": title}).items())
    return f"::error {properties}::{_escaped(text)}"


def line_of(file: Path, path: Sequence[str]) -> int | None:
    """The line, from 1, of the part of a path that a TOML file has; None where that is nothing, or it has no text.

    The path is as `("tolerances", "exudyn", "reaction")`.
    """
    try:
        text = file.read_text(encoding="utf-8-sig")
    except (OSError, ValueError):
        return None
    table, known, found = (), 0, None
    for number, line in enumerate(text.split("\n"), start=1):
        if not (match := _LINE.match(line)):
            continue
        # The longest part of the path that any line has, the first such line for a part of that length.
        here = tuple(key.strip("\"'") for key in re.findall(_KEY, match["table"] or match["key"]))
        table, here = (here, here) if match["table"] else (table, (*table, *here))
        if len(here) > known and here == tuple(path[: len(here)]):
            known, found = len(here), number
    return found


def _escaped(text: str, more: str = "") -> str:
    """A text with the code of what would end it in a workflow command, and of more characters."""
    return "".join(f"%{ord(c):02X}" if c in f"%\r\n{more}" else c for c in text)


def _section(name: str, judgement: Judgement) -> Iterator[str]:
    """The lines on a linkage, with a row an engine: by group its error and tolerance, bold where that is missed."""
    yield from ("", f"### {_plain(name)}: {judgement.agreement.word}", "", _plain(judgement.agreement.sentence), "")
    groups = shown_groups(judgement.scene)
    yield f"| {' | '.join(('engine', 'status', *groups))} |"
    yield f"|{' --- |' * (2 + len(groups))}"
    gates = {(gate.engine, gate.group): gate for gate in judgement.held}
    for m in judgement.measurements:
        worst, cells = m.worst(), [_plain(m.run.engine), m.run.status.name]
        for group in groups:
            gate = gates.get((m.run.engine, group))
            text = f"{worst[group]:.1e}" if group in worst else "no error known"
            text += f" of {gate.tolerance:.0e}{'' if gate.held else ', not held'}" if gate else ""
            cells.append(f"**{text}**" if gate and gate.missed else text)
        yield f"| {' | '.join(cells)} |"
    yield ""
    yield from (f"- {_plain(reason)}" for reason in judgement.reasons)
    yield from (f"- likely cause: {_plain(cause)}" for cause in judgement.causes.values())


def _plain(text: str) -> str:
    """A text that Markdown shows as it is, also in a table."""
    marked = escape(" ".join(text.split()), quote=False)
    return "".join(f"\\{c}" if c in "\\|`*_[]#" else c for c in marked)
