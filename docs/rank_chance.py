#!/usr/bin/env python3
"""How far ranks alone decide the paper's tests of experiment 3 (10 subjects, 4 modalities, Friedman, then Dunn).

    python3 docs/rank_chance.py

Enumerates every way in which ten subjects can rank three exchangeable modalities below a fourth that each of
them ranks highest, and prints how probable the paper's significances then are. No data, no model: what comes
out is the share of chance in these claims.
"""
from collections import Counter
from itertools import permutations
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


if __name__ == "__main__":
    main()
