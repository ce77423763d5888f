"""The lists of mutants: one TOML file per room beside this one.

tests = ["unit_ROOM"]               the room's own test programs, which run first
[[ordinary]] or [[rare]]            a mutant and its class: rare ones need a fault, a timeout, a wrap-around or a recovery
file = "key_ring.cpp"               the source's name, with as much of its path as makes it unique
old = "if («now < due») return;"    text that occurs once; « » marks what the mutant replaces; any white space matches any other
new = "now <= due"                  what replaces it; without `new` the marked statement is dropped
equivalent = "why"                  optional: no test can tell, so the score leaves it out
survives = "why"                    optional: no test kills it yet
in_constexpr = true                 optional: the mark is inside a constexpr function
"""

import dataclasses
import hashlib
import json
import pathlib
import re
import tomllib

HERE = pathlib.Path(__file__).resolve().parent
CLASSES = ("ordinary", "rare")
FIELDS = {"file", "old", "new", "equivalent", "survives", "in_constexpr"}
ROOMS = ("common", "netem", "master", "slave_sim", "cutaneous_node", "visual_node", "stability", "session", "analysis", "study", "thimble")
SOURCE = re.compile(rf"({'|'.join(ROOMS)})/.*\.[ch]pp")


class ListError(Exception):
    """An entry that cannot be used: the message names it."""


@dataclasses.dataclass(frozen=True)
class Mutant:
    room: str
    kind: str
    file: str
    old: str
    new: str = ""
    equivalent: str = ""
    survives: str = ""
    in_constexpr: bool = False

    @property
    def parts(self):
        """Text before the mark, marked text, text after it."""
        parts = re.split("[«»]", self.old)
        if len(parts) != 3 or not parts[1].strip():
            raise ListError(f"{self}: `old` needs one mark «...»")
        return parts

    @property
    def is_statement(self):
        return ";" in self.parts[1]

    @property
    def number(self):
        """Depends on the entry alone, so that an added entry moves no other one's number."""
        text = "\0".join((self.file, self.old, self.new))
        return int(hashlib.sha256(text.encode()).hexdigest()[:6], 16)

    def __str__(self):
        old = re.split("[«»]", self.old)
        change = " ".join((old[1] if len(old) == 3 else self.old).split())
        return f"{self.file}: {change} -> {' '.join(self.new.split()) or '(dropped)'}"


def read_list(name, text):
    """The mutants of one list, and its room's test programs."""
    try:
        tables = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise ListError(f"{name}.toml: {error}") from error
    tests = tables.pop("tests", [])
    if unknown := set(tables) - set(CLASSES):
        raise ListError(f"{name}.toml: unknown table {sorted(unknown)[0]!r}")
    mutants = []
    for kind in CLASSES:
        for entry in tables.get(kind, []):
            if not {"file", "old"} <= set(entry) <= FIELDS:
                raise ListError(f"{name}.toml: {entry} needs file and old, and may have {sorted(FIELDS)}")
            mutants.append(Mutant(name, kind, **entry))
    return mutants, tests


def read_lists(folder=HERE):
    """All mutants, and {room: its test programs}."""
    mutants, tests = [], {}
    for path in sorted(folder.glob("*.toml")):
        found, tests[path.stem] = read_list(path.stem, path.read_text(encoding="utf-8"))
        mutants += found
    numbers = {}
    for mutant in mutants:
        if other := numbers.setdefault(mutant.number, mutant):
            if other is not mutant:
                raise ListError(f"{mutant}: the same number as {other}; change the context in `old`")
    return mutants, tests


def with_survivors(name, text, numbers, why):
    """The list's text, in which each of these mutants has `survives = why`. Entries stand apart by blank lines."""
    blocks = text.split("\n\n")
    for i, block in enumerate(blocks):
        mutants, _ = read_list(name, block)
        if mutants and mutants[0].number in numbers:
            blocks[i] = f"{block.rstrip()}\nsurvives = {json.dumps(why)}" + ("\n" if block.endswith("\n") else "")
    return "\n\n".join(blocks)


def path_of(mutant, paths):
    """The one source whose path ends with the mutant's file."""
    found = [path for path in paths if SOURCE.fullmatch(path) and f"/{path}".endswith(f"/{mutant.file}")]
    if len(found) != 1:
        raise ListError(f"{mutant}: {len(found)} sources have this name{': ' if found else ''}{', '.join(found)}")
    return found[0]
