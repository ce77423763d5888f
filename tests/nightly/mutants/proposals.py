"""Proposes mutants of given sources: comparisons, signs, constants and dropped statements, drawn with a seed. A person chooses."""

import json
import pathlib
import random
import re
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "checks"))
from sources import HIDDEN  # noqa: E402

OPERAND = r"[\w.\]\[]+(?:->\w+|\(\))*"
CHANGED = {"<": "<=", "<=": "<", ">": ">=", ">=": ">", "==": "!=", "!=": "==", "+": "-", "-": "+", "&&": "||", "||": "&&"}
# Where an expression of two operands begins, so that no stronger operator takes one of them away.
BEGIN = r"(?:(?<=[(,;] )|(?<=[({!])|(?<== )|(?<=return )|(?<=&& )|(?<=\|\| ))"
SIGN = r"(?P<sign><=|>=|==|!=|&&|\|\||[<>+-])"
BINARY = re.compile(rf"{BEGIN}(?P<left>{OPERAND}) {SIGN} (?P<right>{OPERAND})(?=[;,)]| &&| \|\|| \?)")
CONSTANT = re.compile(r"(?<=[ ({])(?P<number>\d+(?:\.\d+)?)(?=[;,)} ])")
STATEMENT = re.compile(r"(?m)(?<=^ {4})(?P<text> *(?:[\w.>-]+\([^;{}\n]*\)|[\w.>-]+ [+-]?= [^;{}\n]+|\+\+[\w.>-]+);)$")


def changes(text):
    """(begin, end, new text) of each place that can be changed."""
    code = HIDDEN.sub(lambda match: re.sub(r"[^\n]", " ", match.group()), text)
    for match in BINARY.finditer(code):
        yield *match.span(), f"{match['left']} {CHANGED[match['sign']]} {match['right']}"
    for match in CONSTANT.finditer(code):
        number = match["number"]
        yield *match.span(), f"{2 * float(number):g}" if "." in number else str(int(number) + 1)
    for match in STATEMENT.finditer(code):
        if match["text"].lstrip().startswith("assert(") or ".reserve(" in match["text"]:
            continue  # no test can fail for want of them
        begin = match.start() + len(match["text"]) - len(match["text"].lstrip())
        yield begin, match.end(), ""


def unique_context(text, begin, end):
    """The marked place within as few lines as make it unique."""
    first, last = text.rfind("\n", 0, begin) + 1, (text + "\n").find("\n", end)
    while text.count(text[first:last]) > 1 and first > 0:
        first = text.rfind("\n", 0, first - 1) + 1
    return (text[first:begin] + "«" + text[begin:end] + "»" + text[end:last]).strip()


def propose(texts, count, seed):
    """`count` entries for a list, as text; texts: {path: text}."""
    places = [(path, *change) for path, text in sorted(texts.items()) for change in changes(text)]
    entries = []
    for path, begin, end, new in random.Random(seed).sample(places, min(count, len(places))):
        old = unique_context(texts[path], begin, end)
        quoted = json.dumps(old, ensure_ascii=False) if "\n" not in old else f"'''\n{old}'''"
        entries.append(f'[[ordinary]]\nfile = "{path.rsplit("/", 1)[-1]}"\nold = {quoted}\n' + (f"new = {json.dumps(new)}\n" if new else ""))
    return "\n".join(entries)
