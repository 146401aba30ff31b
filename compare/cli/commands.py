"""What is no run: `list`, `new`, `map`, `version`."""

from collections.abc import Sequence
from importlib.metadata import version
from pathlib import Path

from scenes import InputError, load, shipped, write_starter

from ..engines import registry
from .arguments import COMMANDS
from .command import CONSOLE, called

# as options among others
SPELLINGS = {"--list": "list", "--new": "new", "--version": "version", "--result-mapping": "map"}


def command_among(words: Sequence[str]) -> tuple[str, list[str]]:
    """The command that the words of a command line name, and the other words; of a run it has no name."""
    for word in words:
        if word in SPELLINGS:
            return SPELLINGS[word], [other for other in words if other != word]
    named = bool(words) and words[0] in SPELLINGS.values()
    return (words[0], [*words[1:]]) if named else ("", [*words])


def do(name: str, words: Sequence[str]) -> None:
    """Do what a command is for, by words as `COMMANDS` has them."""
    results = [word for word in words if "=" in word]
    match name, [word for word in words if word not in results], results:
        case "list", _, _:
            width = max(map(len, (*shipped(), *registry.ENTRIES)))
            for scene in shipped():
                print(f"scene   {scene:{width}}  {load(scene).title}")
            for engine, entry in registry.ENTRIES.items():
                print(f"engine  {engine:{width}}  {entry.purpose} ({entry.missing or entry.version})")
        case "version", _, _:
            print(CONSOLE, version(CONSOLE))
        case "new", [path], []:
            print("wrote", " and ".join(map(str, write_starter(Path(path)))))
        case "map", ([] | [_]) as given, [result]:
            from ..results.proposal import proposed  # late: slow to import

            print(proposed(load((given or ["toggle_press"])[0]), result), end="")
        case _:
            (usage,) = (usage for usage in COMMANDS if usage.split()[0] == name)
            raise InputError(f"arguments: expected {called()} {usage}, found '{' '.join((name, *words))}'")
