"""Reading of TOML files, whatever they are: what leaves is tables of a few levels and of numbers that fit a double."""

import re
import stat
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ..errors import InputError, at_place, nearest, one_line, path_in_file
from ..limits import FILE_BYTES, INTEGER_BITS, KEY_PARTS, NESTING

_PART = r"""(?:[\w-]++|"(?:[^"\\\n]|\\.)*+"|'[^'\n]*+')"""  # of a key; each character is looked at once
_LONG_KEY = re.compile(rf"(?<![\w\\-]){_PART}(?:[ \t]*+\.[ \t]*+{_PART}){{{KEY_PARTS}}}")
_KINDS = {stat.S_IFDIR: "a folder", stat.S_IFIFO: "a pipe", stat.S_IFSOCK: "a socket"}


def read_toml(name_or_path: str | Path, known: Mapping[str, Path], kind: str) -> dict[str, Any]:
    """The tables of a file: one of the known by its name, any other by its path; InputError names its kind."""
    shown = one_line(str(name_or_path)) or "''"
    path = known.get(str(name_or_path), Path(name_or_path))
    with at_place(shown):
        try:
            text = read_text(path, FILE_BYTES)
            if _LONG_KEY.search(text):
                raise InputError(f"expected keys of {KEY_PARTS} parts at most, found one of more")
            tables = tomllib.loads(text)
        except FileNotFoundError:
            raise InputError(f"no such {kind} or file{nearest(path.stem, known)}") from None
        except (tomllib.TOMLDecodeError, RecursionError) as error:
            raise InputError(f"not valid TOML: {str(error) or type(error).__name__}{_comma(text, error)}") from None
        except ValueError as error:  # an integer of thousands of digits
            raise InputError(f"cannot be read ({error})") from None
        _check_values(tables, ())
    return tables


def _comma(text: str, error: Exception) -> str:
    """What to write in a line that cannot be read, as a number in it has a decimal comma."""
    line = re.search(r"at line (\d+)", str(error))
    comma = line and re.search(r"=\s*([-+]?\d+),(\d+)", text.splitlines()[int(line[1]) - 1])
    return f"; a number's decimals come after a '.', as {comma[1]}.{comma[2]}" if comma else ""


def read_text(path: Path, most: int) -> str:
    """What a text file in UTF-8, of so many bytes at most, holds; else InputError, or FileNotFoundError of none."""
    try:
        mode = path.stat().st_mode
        if not stat.S_ISREG(mode):
            raise InputError(f"expected a text file, found {_KINDS.get(stat.S_IFMT(mode), 'a device')}")
        with path.open("rb") as file:
            content = file.read(most + 1)
        if len(content) > most:
            raise InputError(f"expected a file of {most} bytes at most, found one of more")
        return content.decode("utf-8-sig")  # with the mark that some editors put first, or without
    except FileNotFoundError:
        raise
    except UnicodeDecodeError as error:
        raise InputError(f"expected a text file in UTF-8, and byte {error.start} is none") from None
    except (OSError, ValueError) as error:  # the latter of a zero in the path
        raise InputError(f"cannot be read ({getattr(error, 'strerror', error)})") from None


def _check_values(value: object, place: tuple[object, ...]) -> None:
    """Refuse what is nested deeper than any file needs, and integers that TOML does not promise."""
    if isinstance(value, int) and value.bit_length() > INTEGER_BITS:
        raise InputError(f"{path_in_file(place)}: expected an integer of {INTEGER_BITS} bits at most")
    if isinstance(value, dict | list):
        if len(place) > NESTING:
            raise InputError(f"{path_in_file(place)}: expected {NESTING} levels of tables and lists at most")
        for key, child in value.items() if isinstance(value, dict) else enumerate(value):
            if not isinstance(child, float | str):
                _check_values(child, (*place, key))
