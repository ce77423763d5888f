#!/usr/bin/env python3
"""How far ranks alone decide the paper's tests of experiment 3 (10 subjects, 4 modalities, Friedman, then Dunn).

    python3 docs/rank_chance.py

Enumerates every way in which ten subjects can rank three exchangeable modalities below a fourth that each of
them ranks highest, and prints how probable the paper's significances then are. No data, no model: what comes
out is the share of chance in these claims.

Then it looks for ceilings. Subjects are independent, and each ranks the modalities by the same chances, whatever
these are: the script seeks the chances with which several claims come out most often.
"""
from collections import Counter
from itertools import combinations, permutations
from math import erfc, sqrt

SUBJECTS, CONDITIONS = 10, 4


def dunn_p(rank_sum_difference):
    """Dunn after Friedman, times the six pairs (Bonferroni)."""
    z = abs(rank_sum_difference) / SUBJECTS / sqrt(CONDITIONS * (CONDITIONS + 1) / (6 * SUBJECTS))
    return min(1.0, 6 * erfc(z / sqrt(2)))


def rank_sums(orders):
    """Rank sums over all subjects, each order equally likely: a Counter of tuples."""
    sums = Counter({(0,) * len(orders[0]): 1})
    for _ in range(SUBJECTS):
        grown = Counter()
        for so_far, ways in sums.items():
            for order in orders:
                grown[tuple(a + b for a, b in zip(so_far, order))] += ways
        sums = grown
    return sums


def least_difference(level):
    """Of rank sums, so that Dunn's P is below the level."""
    return next(d for d in range(CONDITIONS * SUBJECTS) if dunn_p(d) < level)


def probabilities(outcomes, chances, wanted):
    """Of each of `wanted`, predicates of the sum of all subjects' outcomes."""
    sums = {(0,) * len(outcomes[0]): 1.0}
    for _ in range(SUBJECTS):
        grown = Counter()
        for so_far, p in sums.items():
            for outcome, chance in zip(outcomes, chances):
                grown[tuple(a + b for a, b in zip(so_far, outcome))] += p * chance
        sums = grown
    return [sum(p for total, p in sums.items() if is_it(total)) for is_it in wanted]


def climb(outcomes, wanted):
    """Moves chance from outcome to outcome while the least of the probabilities grows."""
    chances = [1 / len(outcomes)] * len(outcomes)
    best = probabilities(outcomes, chances, wanted)
    for step in (0.2, 0.1, 0.05, 0.02, 0.01, 0.005):
        grows = True
        while grows:
            grows = False
            for giver, taker in permutations(range(len(outcomes)), 2):
                moved = list(chances)
                part = min(step, moved[giver])
                moved[giver] -= part
                moved[taker] += part
                found = probabilities(outcomes, moved, wanted)
                if min(found) > min(best) + 1e-6:
                    best, chances, grows = found, moved, True
    return best


def most_probable(outcomes, wanted):
    """The largest that the least probable of them can be, over all mixtures of three outcomes (a fourth adds nothing here)."""
    return max((climb(three, wanted) for three in combinations(outcomes, 3)), key=min)


def print_ceilings(title, outcomes, wanted):
    each = most_probable(outcomes, wanted)
    at_once = most_probable(outcomes, [lambda total: all(is_it(total) for is_it in wanted)])
    print(title)
    print("  each, where the least probable is as probable as can be: " + ", ".join(f"{100 * p:.0f} %" for p in each))
    print(f"  at once, at best: {100 * at_once[0]:.0f} %")


def ceilings():
    """Rankings that no other beats in all differences at once are enough: a larger difference makes no claim less probable."""
    hf_ccf, vf_cf = least_difference(0.05), least_difference(0.001)
    print_ceilings(
        "maximum penetration, any chances: HF > CCF (P < .05) and VF > CF (P < .001)",
        [(3, 1), (2, 2), (1, 3)],  # HF - CCF and VF - CF of HF > VF > CF > CCF, HF > VF > CCF > CF, VF > HF > CCF > CF
        [lambda total: total[0] >= hf_ccf, lambda total: total[1] >= vf_cf],
    )
    levels = [least_difference(level) for level in (0.01, 0.05, 0.001)]
    print_ceilings(
        "completion time, any chances: HF > VF (P < .01), HF > CF (P < .05), HF > CCF (P < .001)",
        [tuple(CONDITIONS - rank for rank in order) for order in permutations((1, 2, 3))],  # HF is slowest
        [lambda total, i=i: total[i] >= levels[i] for i in range(3)],
    )


def main():
    highest = CONDITIONS * SUBJECTS
    sums = rank_sums(list(permutations((1, 2, 3))))
    total = sum(sums.values())

    def probability(wanted):
        return sum(ways for below, ways in sums.items() if wanted(below)) / total

    print("completion time: HF slowest in all ten subjects, the other three exchangeable")
    for level in (0.05, 0.01, 0.001):
        p = probability(lambda below: dunn_p(highest - below[0]) < level)
        print(f"  HF above one given modality at P < {level:g}: {100 * p:.1f} %")
    everything = probability(
        lambda below: dunn_p(highest - below[0]) < 0.01
        and dunn_p(highest - below[1]) < 0.05
        and dunn_p(highest - below[2]) < 0.001
    )
    print(f"  the paper's three at once (VF .01, CF .05, CCF .001): {100 * everything:.1f} %")
    print("maximum penetration: HF deepest in all ten subjects")
    print(f"  smallest P that VF above CF can have: {dunn_p(2 * SUBJECTS):.4f}")
    print("maximum penetration: rank sums (CF, CCF, VF, HF) that give all of the paper's verdicts at once")
    fits = [
        (cf, ccf, vf, 100 - cf - ccf - vf)
        for cf in range(10, 41)
        for ccf in range(10, 41)
        for vf in range(10, 41)
        if 10 <= 100 - cf - ccf - vf <= 40
        and dunn_p(100 - cf - ccf - vf - cf) < 0.001
        and dunn_p(100 - cf - ccf - vf - ccf) < 0.05
        and dunn_p(vf - cf) < 0.001
        and dunn_p(vf - ccf) >= 0.05
        and dunn_p(100 - cf - ccf - 2 * vf) >= 0.05
        and 100 - cf - ccf - vf > cf
        and vf > cf
        and cf + ccf >= 30
    ]
    handle = [f[3] for f in fits]
    print(f"  {len(fits)} of them, HF from {min(handle)} to {max(handle)} of 40 (40: deepest in every subject)")
    ceilings()


if __name__ == "__main__":
    main()
