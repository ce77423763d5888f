"""Puts mutants into a source's text as switches: each is off until the environment chooses it."""

import re
from typing import NamedTuple

from mutant_list import ListError

HEADER = """\
#pragma once
#include <cstdint>
#include <cstdlib>
#include <fcntl.h>
#include <sys/mman.h>
#include <type_traits>
namespace thimble_mutation {
// The number of the mutant that is on (THIMBLE_MUTANT), and a file with a byte per number for those reached (THIMBLE_REACHED).
struct Choice {
    std::uint32_t chosen = 0;
    char* reached = nullptr;
    Choice() {
        if (const char* text = std::getenv("THIMBLE_MUTANT")) chosen = static_cast<std::uint32_t>(std::strtoul(text, nullptr, 10));
        const char* path = std::getenv("THIMBLE_REACHED");
        const int file = path ? ::open(path, O_RDWR | O_CLOEXEC) : -1;
        if (file < 0) return;
        void* bytes = ::mmap(nullptr, 1U << 24U, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
        if (bytes != MAP_FAILED) reached = static_cast<char*>(bytes);
    }
};
inline bool is_on(std::uint32_t number) {
    static const Choice choice;
    if (choice.reached) choice.reached[number] = 1;
    return choice.chosen == number;
}
}  // namespace thimble_mutation
#define MUTATED(n) (thimble_mutation::is_on(n))
#define MUTATED_IN_CONSTEXPR(n) (!std::is_constant_evaluated() && thimble_mutation::is_on(n))
"""
INCLUDE = '#include "mutated.hpp"\n'


class Span(NamedTuple):
    begin: int
    end: int
    mutant: object  # None: a constexpr that must become const


# Text that may surround a mark of several operands, so that the parentheses of the switch change nothing.
BEFORE = re.compile(r"(?:^|[(\[{,;=?:<>]|&&|\|\||return)\s*$")
CALL = re.compile(r"-?[\w:.<>]+\((?:[^()]|\((?:[^()]|\([^()]*\))*\))*\)")
AFTER = re.compile(r"\s*(?:[)\]},;?:<>=]|!=|&&|\|\|)")


def _stands_alone(marked, before, after):
    return " " not in marked or bool(CALL.fullmatch(marked)) or bool(BEFORE.search(before) and AFTER.match(after))


def _any_space(text):
    return "".join(r"\s+" if part.isspace() else re.escape(part) for part in re.split(r"(\s+)", text) if part)


def locate(mutant, text):
    """Where the marked text stands; the text with its context has to occur once."""
    before, marked, after = (_any_space(part) for part in mutant.parts)
    found = list(re.finditer(f"{before}({marked}){after}", text))
    if len(found) != 1:
        raise ListError(f"{mutant}: its text occurs {len(found)} times, not once, in {mutant.file}")
    begin, end = found[0].span(1)
    if not mutant.is_statement and not _stands_alone(text[begin:end], text[:begin][-80:], text[end:]):
        raise ListError(f"{mutant}: its mark is a part of a larger operand; mark the whole of it")
    return Span(begin, end, mutant)


def constant_before(span, text):
    """The constexpr of the variable whose initialiser holds the span, if it does: a constant cannot be switched."""
    declaration = text[max(text.rfind(";", 0, span.begin), text.rfind("\n\n", 0, span.begin)) + 1 : span.begin]
    match = re.search(r"\b(?:static )?(?:inline )?constexpr\b(?=[^()]*(?:=|\{)[^;]*$)", declaration)
    begin = span.begin - len(declaration)
    return match and Span(begin + match.start(), begin + match.end(), None)


def _switched(mutant, old):
    on = f"MUTATED{'_IN_CONSTEXPR' if mutant.in_constexpr else ''}({mutant.number})"
    if not mutant.is_statement:
        if not mutant.new:
            raise ListError(f"{mutant}: without `new` only a statement can be dropped")
        return f"({on} ? ({mutant.new}) : ({old}))"
    inner = f"if ({on}) {{ {mutant.new} }} else {{ {old} }}" if mutant.new else f"if (!{on}) {{ {old} }}"
    return f"{{ {inner} }}"  # an `else` behind the statement stays that of the source


def _variable(words):
    inline = "inline " if "static" in words or "inline" in words else ""
    return f"{'static ' if 'static' in words else ''}{inline}const"


def _render(text, begin, end, spans):
    out, at = "", begin
    while spans:
        first, *rest = spans
        inner = [span for span in rest if span.begin < first.end]
        for span in inner:
            if span.end > first.end:
                raise ListError(f"{first.mutant} and {span.mutant}: their marks overlap")
        old = _render(text, first.begin, first.end, inner)
        out += text[at : first.begin] + (_switched(first.mutant, old) if first.mutant else _variable(old))
        at, spans = first.end, rest[len(inner) :]
    return out + text[at:end]


def with_switches(text, mutants):
    """The source's text with a switch for each mutant. Marks may lie in each other, and be the same."""
    spans = [locate(mutant, text) for mutant in mutants]
    spans += {constant for span in spans if (constant := constant_before(span, text))}
    spans.sort(key=lambda span: (span.begin, -span.end))
    return INCLUDE + _render(text, 0, len(text), spans) if spans else text
