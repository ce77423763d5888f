"""The table of a campaign, its score, and whether it is worse than the lists say."""

from mutant_list import CLASSES

AIM = {"ordinary": 90, "rare": 75}  # per cent


def is_killed(mutant, results):
    return bool(results.get(mutant.number, {}).get("killer"))


def verdict(mutant, result):
    if result.get("killer"):
        return f"killed by {result['killer']}"
    if mutant.equivalent:
        return f"equivalent: {mutant.equivalent}"
    never = "" if result.get("passed") else ", never reached"
    return f"survived{never}" + (f" (known: {mutant.survives})" if mutant.survives else "")


def complaints(mutants, results):
    """Mutants that the lists take for killed and that survive; and those of which the lists say wrongly that they survive."""
    known = [mutant for mutant in mutants if mutant.equivalent or mutant.survives]
    worse = [mutant for mutant in mutants if mutant not in known and not is_killed(mutant, results)]
    return worse, [mutant for mutant in known if is_killed(mutant, results)]


def counts(mutants, results, kind):
    """Of a class: mutants, equivalent ones among them, killed ones."""
    ones = [mutant for mutant in mutants if mutant.kind == kind]
    killed = sum(is_killed(mutant, results) for mutant in ones)
    return len(ones), sum(bool(mutant.equivalent) and not is_killed(mutant, results) for mutant in ones), killed


def summary(mutants, results):
    parts = []
    for kind in CLASSES:
        total, equivalent, killed = counts(mutants, results, kind)
        parts.append(f"{killed} of {total - equivalent} {kind}")
    return f"mutants killed: {' and '.join(parts)} ones"


def score_lines(mutants, results):
    lines = ["| class | mutants | equivalent | killed | score | aim |", "| --- | --- | --- | --- | --- | --- |"]
    for kind in CLASSES:
        total, equivalent, killed = counts(mutants, results, kind)
        counted = total - equivalent
        share = f"{100 * killed / counted:.1f} %" if counted else "-"
        lines.append(f"| {kind} | {total} | {equivalent} | {killed} of {counted} | {share} | {AIM[kind]} % |")
    return lines


def table(mutants, results):
    """Markdown: the score, then a row per mutant, survivors first within a room."""
    lines = [*score_lines(mutants, results), "", "| room | class | mutant | result |", "| --- | --- | --- | --- |"]
    for mutant in sorted(mutants, key=lambda one: (one.room, is_killed(one, results))):
        change = str(mutant).replace("|", "\\|")
        lines.append(f"| {mutant.room} | {mutant.kind} | `{change}` | {verdict(mutant, results.get(mutant.number, {}))} |")
    return "\n".join(lines) + "\n"
