"""Writes tests/golden/statistics.json: what R, SciPy and statsmodels say about the data sets below.

usage: /usr/bin/python3 tests/golden/make_statistics.py     (Debian: r-base-core python3-scipy python3-statsmodels
                                                             python3-mpmath; run by hand, not by the tests)

Data sets with a large offset are handed to those programs without it, and it is checked that taking it away is
exact: the statistics do not depend on it, but the programs' digits would. Where two programs know a statistic they
must agree here. Analyses of variance are also done in rational numbers, and those are the ones written.
"""

import itertools
import json
import pathlib
import random
import subprocess
from fractions import Fraction

import mpmath
import numpy as np
import pandas
import scipy
import scipy.stats
import statsmodels
from statsmodels.stats.anova import AnovaRM
from statsmodels.stats.proportion import proportion_confint
from statsmodels.stats.weightstats import DescrStatsW, ttost_paired

HERE = pathlib.Path(__file__).resolve().parent
mpmath.mp.dps = 25
draw = random.Random(20260101)


def noise(n, sd=1.0, digits=6):
    return [round(draw.gauss(0, 1) * sd, digits) for _ in range(n)]


def made(n, means, subject_sd, sd, digits=6):
    """Rows of a table: condition means, plus the subject, plus noise (one sd, or one per condition)."""
    sds = sd if isinstance(sd, list) else [sd] * len(means)
    rows = []
    for _ in range(n):
        subject = draw.gauss(0, 1) * subject_sd
        rows.append([round(m + subject + draw.gauss(0, 1) * s, digits) for m, s in zip(means, sds)])
    return rows


def moved(rows, offset):
    """The rows with an offset, and what is left when it is taken away again: exactly what doubles can hold."""
    far = [[offset + x for x in row] for row in rows]
    near = [[x - offset for x in row] for row in far]
    for far_row, near_row in zip(far, near):
        assert all(Fraction(f) - Fraction(offset) == Fraction(n) for f, n in zip(far_row, near_row))
    return far, near


def same(a, b, relative, absolute=0.0):
    assert len(a) == len(b) and np.allclose(a, b, rtol=relative, atol=absolute), (a, b)


class R:
    """Collects questions, asks them all at once."""

    def __init__(self):
        self.lines, self.answers = [], {}

    def ask(self, kind, name, columns, values):
        shape = ",".join(str(c) for c in columns)
        self.lines.append(" ".join([kind, name, shape, *(f"{v:.17g}" for v in values)]))

    def run(self):
        done = subprocess.run(["Rscript", "--vanilla", HERE / "make_statistics.R"], input="\n".join(self.lines) + "\n",
                              capture_output=True, text=True, check=True)
        for line in done.stdout.splitlines():
            name, key, *values = line.split()
            self.answers[name, key] = values if key == "version" else [float(v) for v in values]

    def get(self, name, key):
        return self.answers.get((name, key))


# ---- data -----------------------------------------------------------------------------------------------------

def make_tables():
    """name: (rows as tested, rows as asked)"""
    plain = {
        "hand": [[1, 2, 4], [2, 3, 3], [3, 5, 6.5], [4, 4, 9]],
        "paper_like": made(16, [1.2, 2.0, 2.4, 5.0], 0.5, 0.7),
        "null": made(10, [3, 3, 3, 3], 1, 1),
        "ties": [[draw.randrange(1, 5) for _ in range(4)] for _ in range(12)],
        "two_conditions": made(8, [1, 1.5], 1, 0.5),
        "more_conditions_than_subjects": made(5, [0, 1, 0, 2, 1, 0], 1, 0.8),
        "three_subjects": made(3, [0, 1, 2, 4], 1, 0.5),
        "unequal_variances": made(10, [1, 1.2, 1.4, 3], 0.3, [0.05, 0.05, 0.1, 2]),
        "metres": made(20, [1.2e-9, 2e-9, 2.4e-9, 2.1e-9], 1e-9, 1e-9, digits=15),
        "three_conditions": made(30, [0, 0.3, 0.6], 1, 1),
        "tiny_p": made(25, [0, 10, 20, 40], 1, 0.5),
        "five_conditions": made(10, [0, 0.5, 0.5, 1, 0], 1, 1, digits=1),
        "beyond_exact": made(100, [0, 0.1, 0.2, 0.1, 0], 1, 1),
        "half_tied": [[0, 0, 0, 1], [1, 0, 0, 0], [0, 0, 1, 1], [2, 2, 1, 1], [0, 1, 2, 2], [3, 3, 3, 3], [0, 1, 1, 5]],
    }
    duplicate = made(9, [0, 0, 1], 1, 1)
    plain["equal_columns"] = [[a, b, b, c] for a, b, c in duplicate]
    tables = {name: (rows, rows) for name, rows in plain.items()}
    tables["offset"] = moved(made(16, [0.001, 0.002, 0.0025, 0.004], 0.001, 0.001), 1e6)
    tables["offset_of_subjects"] = (lambda rows: (rows, rows))(made(12, [0, 1, 2, 4], 1e3, 1, digits=3))
    return tables


def make_groups():
    plain = {
        "hand": [[1, 2, 3], [2, 3, 4], [6, 7, 8]],
        "paper_like": [noise(8, 0.4), noise(8, 0.4), noise(8, 0.4), [round(6 + x, 6) for x in noise(8, 0.4)]],
        "null": [noise(8) for _ in range(4)],
        "unequal_sizes": [noise(3), noise(12), [1 + x for x in noise(7)], noise(2)],
        "single_value": [noise(1), noise(5), noise(4)],
        "two_groups": [noise(10), [0.5 + x for x in noise(10)]],
        "ties": [[draw.randrange(1, 4) for _ in range(9)] for _ in range(3)],
        "constant_group": [[2, 2, 2, 2], noise(4), noise(6)],
        "tiny_p": [[round(10 * i + x, 6) for x in noise(20)] for i in range(4)],
        "metres": [[round(m + x, 15) for x in noise(8, 1e-9, 15)] for m in (0, 1e-9, 3e-9)],
        "seven_groups": [noise(5) for _ in range(7)],
        "equal_groups": [[1, 2, 4], [1, 2, 4], [1, 2, 4]],
    }
    groups = {name: (value, value) for name, value in plain.items()}
    groups["offset"] = moved([noise(8, 1e-3), [1e-3 + x for x in noise(6, 1e-3)], noise(9, 1e-3)], 1e6)
    return groups


def make_columns():
    plain = {
        "eight": noise(8),
        "normal": noise(50),
        "normal_100": noise(100),
        "exponential": [round(draw.expovariate(1), 6) for _ in range(40)],
        "heavy": [round(draw.gauss(0, 1) ** 3, 6) for _ in range(30)],
        "flat": [round(draw.random(), 6) for _ in range(60)],
        "ties": [draw.randrange(0, 5) for _ in range(25)],
        "outlier": [*noise(15), 30.0],
        "metres": noise(16, 1e-9, 15),
        "two_peaks": [*noise(12, 0.2), *[5 + x for x in noise(14, 0.2)]],
        "tiny_p": [*noise(300, 0.1), 40.0, 45.0],
        "ascending": [float(i * i) for i in range(20)],
    }
    columns = {name: (value, value) for name, value in plain.items()}
    far, near = moved([noise(24, 1e-3)], 1e6)
    columns["offset"] = (far[0], near[0])
    return columns


def make_pairs():
    """name: (first, second, low, high, first as asked, second as asked)"""
    pairs = {}

    def add(name, first, shift, sd, low, high, offset=0.0):
        second = [round(x - shift + d, 12) for x, d in zip(first, noise(len(first), sd, 12))]
        if offset:
            (first, second), (near_1, near_2) = moved([first, second], offset)
            pairs[name] = (first, second, low, high, near_1, near_2)
        else:
            pairs[name] = (first, second, low, high, first, second)

    add("equivalent", noise(16), 0.02, 0.1, -0.2, 0.2)
    add("different", noise(16), 1.0, 0.3, -0.2, 0.2)
    add("undecided", noise(8), 0.1, 0.5, -0.3, 0.3)
    add("two_subjects", noise(2), 0.1, 0.5, -1, 1)
    add("three_subjects", noise(3), 0.1, 0.2, -1, 1)
    add("one_sided_bounds", noise(20), 0.1, 0.3, -0.05, 0.6)
    add("negative", noise(12), -2.0, 1.0, -3, 0.5)
    add("metres", noise(16, 1e-3), 1e-5, 1e-4, -2e-4, 2e-4)
    add("many", noise(200), 0.0, 1.0, -0.2, 0.2)
    add("large_effect", noise(10), 5.0, 1.0, -1, 1)
    add("tiny_p", noise(30), 0.0, 0.05, -1, 1)
    add("offset", noise(16, 1e-3), 2e-4, 5e-4, -1e-3, 1e-3, offset=1e6)
    return pairs


def make_shifts():
    """Values without ties or zeros; R is exact for those. A stream of its own: the data sets above stay as they are."""
    of_shifts = random.Random(20261124)

    def some(n, mean=0.0, sd=1.0, digits=6):
        return [round(mean + of_shifts.gauss(0, 1) * sd, digits) for _ in range(n)]

    signed = {"none": some(10), "all_above": some(10, 9), "six": some(6, 2), "eight": some(8, 1.5), "paper_like": some(16, 0.7),
              "below": some(12, -1), "odd": some(9, 0.4), "metres": some(10, 1e-9, 1e-9, 15), "many": some(45, 0.3),
              "hundred": some(100, 0.2), "tiny_p": some(40, 5), "heavy": [x ** 3 for x in some(11, 0.5)]}
    sums = {"none": (some(8), some(8)), "apart": (some(8, 9), some(8)), "uneven": (some(5, 1), some(14)), "four": (some(4, 5), some(4)),
            "paper_like": (some(8, 1.2), some(8)), "below": (some(12), some(9, 1)), "metres": (some(8, 1e-9, 1e-9, 15), some(8, 0, 1e-9, 15)),
            "many": (some(30, 0.5), some(35)), "fifty": (some(50, 0.3), some(50)), "odd": (some(7, 0.5), some(9)),
            "heavy": ([x ** 3 for x in some(9, 0.5)], some(10))}
    return signed, sums


# ---- references written here ----------------------------------------------------------------------------------

def repeated(rows):
    """Sums of squares (conditions, error, subjects) and epsilons, in rational numbers from the doubles as they are.

    Greenhouse-Geisser from the double-centred covariance matrix R' R / (n - 1), Huynh-Feldt from that.
    """
    x = [[Fraction(v) for v in row] for row in rows]
    n, k = len(x), len(x[0])
    grand = sum(sum(row) for row in x) / (n * k)
    subject = [sum(row) / k - grand for row in x]
    condition = [sum(row[c] for row in x) / n - grand for c in range(k)]
    rest = [[x[s][c] - grand - subject[s] - condition[c] for c in range(k)] for s in range(n)]
    ss = [n * sum(v * v for v in condition), sum(v * v for row in rest for v in row), k * sum(v * v for v in subject)]
    products = [sum(row[a] * row[b] for row in rest) for a in range(k) for b in range(k)]
    gg = ss[1] ** 2 / ((k - 1) * sum(v * v for v in products))
    below = (k - 1) * (n - 1 - (k - 1) * gg)
    hf = Fraction(1) if below <= 0 else min(Fraction(1), (n * (k - 1) * gg - 2) / below)
    return [float(v) for v in ss], float(ss[0] / (ss[1] / (n - 1))), [float(gg), float(max(gg, hf))]


def oneway(groups):
    """Sums of squares between and within, in rational numbers, and F."""
    x = [[Fraction(v) for v in group] for group in groups]
    n = sum(len(group) for group in x)
    grand = sum(sum(group) for group in x) / n
    means = [sum(group) / len(group) for group in x]
    between = sum(len(group) * (mean - grand) ** 2 for group, mean in zip(x, means))
    within = sum((v - mean) ** 2 for group, mean in zip(x, means) for v in group)
    f = between / (len(x) - 1) / (within / (n - len(x)))
    return [float(between), float(within)], float(f)


def friedman_exact(rows):
    """All arrangements of every row, by adding shifted copies of the joint distribution of the column sums."""
    ranks = np.array([2 * scipy.stats.rankdata(row) for row in rows]).astype(int)
    n, k = ranks.shape
    step = 2 if np.all(ranks % 2 == 0) else 1  # no half ranks: a grid half as fine
    low = ranks.min(axis=1)
    ranks = (ranks - low[:, None]) // step
    size = int(np.sum(ranks.max(axis=1))) + 1
    if size ** (k - 1) > 4e6:
        return None
    p = np.zeros([size] * (k - 1))
    p[(0,) * (k - 1)] = 1
    for row in ranks:
        ways = sorted(set(itertools.permutations(row)))
        new = np.zeros_like(p)
        for way in ways:
            to = tuple(slice(w, size) for w in way[:-1])
            fro = tuple(slice(0, size - w) for w in way[:-1])
            new[to] += p[fro]
        p = new / len(ways)
    total = int(np.sum(ranks))
    grid = np.indices(p.shape)
    sums = np.concatenate([grid, [total - np.sum(grid, axis=0)]])
    squares = np.sum((k * sums - total) ** 2, axis=0)
    observed = np.sum((k * np.sum(ranks, axis=0) - total) ** 2)
    return float(np.sum(np.sort(p[squares >= observed])))


def dunn(rows):
    ranks = np.array([scipy.stats.rankdata(row) for row in rows])
    n, k = ranks.shape
    means = ranks.mean(axis=0)
    pairs = list(itertools.combinations(range(k), 2))
    z = [abs(means[i] - means[j]) / np.sqrt(k * (k + 1) / (6 * n)) for i, j in pairs]
    p = [2 * scipy.stats.norm.sf(v) for v in z]
    return {"mean_ranks": list(means), "z": z, "p": p, "p_adjusted": [min(1.0, len(pairs) * v) for v in p]}


def tail_p(f, a, b):
    """P(F >= f) at 25 digits."""
    f, a, b = map(mpmath.mpf, (f, a, b))
    return float(mpmath.betainc(b / 2, a / 2, 0, b / (b + a * f), regularized=True))


# ---- answers --------------------------------------------------------------------------------------------------

PAIR_FIELDS = ("difference", "t", "df", "p", "low", "high", "low_all", "high_all", "p_bonferroni", "p_holm")


def pair_answers(r, name, key):
    if r.get(name, key + ".p") is None:
        return None
    return {field: r.get(name, f"{key}.{field}") for field in PAIR_FIELDS}


def by_column(rows):
    return [list(column) for column in zip(*rows)]


def paired_possible(rows):
    return all(len({a - b for a, b in zip(x, y)}) > 1 for x, y in itertools.combinations(by_column(rows), 2))


def check_table(r, name, rows, f, p):
    n, k = len(rows), len(rows[0])
    frame = pandas.DataFrame([{"s": s, "c": c, "y": rows[s][c]} for s in range(n) for c in range(k)])
    peer = AnovaRM(frame, "y", "s", within=["c"]).fit().anova_table
    same([peer["F Value"].iloc[0], peer["Num DF"].iloc[0], peer["Den DF"].iloc[0]], [f, k - 1, (n - 1) * (k - 1)], 1e-8, 1e-12)
    same(r.get(name, "anova.f"), [f], 1e-7)
    same(r.get(name, "anova.p"), [p], 1e-6)
    if k > 2:
        chi, p_friedman = scipy.stats.friedmanchisquare(*by_column(rows))
        same(r.get(name, "friedman")[0::2], [chi, p_friedman], 1e-10)


def table_answers(r, name, far, near):
    (ss_c, ss_e, ss_s), f, eps = repeated(far)
    df_1, df_2 = r.get(name, "anova.df")
    p = tail_p(f, df_1, df_2)
    check_table(r, name, near, f, p)
    p_eps = [tail_p(f, e * df_1, e * df_2) for e in eps]
    if r.get(name, "anova.epsilons"):
        gg, hf = r.get(name, "anova.epsilons")
        same([gg, max(gg, hf)], eps, 1e-7)
        # At 1e-9 R's tolerances cut the contrasts short: its corrected P then follow another epsilon than it prints.
        if hf >= gg and name != "t.metres":
            same(r.get(name, "anova.p_corrected"), p_eps, 1e-6)
    same(r.get(name, "anova.ss"), [ss_c, ss_e, ss_s], 1e-7, 1e-25)
    return {
        "name": name, "columns": by_column(far),
        "anova": {"f": f, "df": [df_1, df_2], "p": p, "ss": [ss_c, ss_e, ss_s], "epsilons": eps, "p_corrected": p_eps,
                  "partial_eta_squared": ss_c / (ss_c + ss_e), "generalised_eta_squared": ss_c / (ss_c + ss_e + ss_s)},
        "pooled": pair_answers(r, name, "pooled"), "paired": pair_answers(r, name, "paired"),
        "friedman": {"chi_squared": r.get(name, "friedman")[0], "p": r.get(name, "friedman")[2],
                     "p_exact": friedman_exact(near)},
        "dunn": dunn(near),
    }


def group_answers(r, name, far, near):
    f_r, df_1, df_2, p_r, *ss_r = r.get(name, "anova")
    (ss_1, ss_2), f = oneway(far)
    p = tail_p(f, df_1, df_2)
    same([f_r, p_r, *ss_r], [f, p, ss_1, ss_2], 1e-9, 1e-25)
    peer = scipy.stats.f_oneway(*near)
    same(list(peer), [f, p], 1e-8, 1e-20)
    return {"name": name, "groups": far, "f": f, "df": [df_1, df_2], "p": p, "ss": [ss_1, ss_2],
            "eta_squared": ss_1 / (ss_1 + ss_2), "pooled": pair_answers(r, name, "pooled")}


def column_answers(r, name, far, near):
    x = np.array(near, dtype=float)
    offset = far[0] - near[0]
    # SciPy 1.10's quantiles of t are good to about 1e-9 only; R's are taken.
    interval = r.get(name, "interval_95")
    same(scipy.stats.t.interval(0.95, len(x) - 1, x.mean(), scipy.stats.sem(x)), interval, 1e-7)
    k2, p = scipy.stats.normaltest(x)
    return {"name": name, "values": far, "offset": offset, "mean": x.mean(), "sd": x.std(ddof=1),
            "quantiles": {q: float(np.quantile(x, float(q))) for q in ("0", "0.1", "0.25", "0.5", "0.9", "1")},
            "mean_interval": interval, "k2": k2, "p": p,
            "skewness": scipy.stats.skew(x), "kurtosis": scipy.stats.kurtosis(x, fisher=False),
            "z_skewness": scipy.stats.skewtest(x).statistic, "z_kurtosis": scipy.stats.kurtosistest(x).statistic}


def pair_case_answers(r, name, pair):
    first, second, low, high, near_1, near_2 = pair
    differences = np.array(near_1) - np.array(near_2)
    _, (t_low, p_low, df), (t_high, p_high, _) = ttost_paired(np.array(near_1), np.array(near_2), low, high)
    interval = r.get(name, "interval_90")
    same(DescrStatsW(differences).tconfint_mean(alpha=0.1), interval, 1e-6)
    return {"name": name, "first": first, "second": second, "bounds": [low, high], "difference": differences.mean(),
            "t": [t_low, t_high], "p": [p_low, p_high], "df": df,
            "interval_90": interval}


def shift_answers(r, name, p_scipy, **values):
    estimate, p, low, high, low_six, high_six = r.get(name, "shift")
    same([p], [p_scipy], 1e-9)
    return {"name": name, **values, "estimate": estimate, "p": p, "interval": [low, high], "interval_of_six": [low_six, high_six]}


PROPORTIONS = [(0, 10), (10, 10), (1, 10), (5, 10), (0, 1), (1, 1), (3, 7), (999, 1000), (1, 1000000), (500, 1000), (17, 20)]
P_VALUES = [[0.01], [0.01, 0.02, 0.03], [0.03, 0.02, 0.01], [0.5, 0.5, 0.5], [1e-30, 0.2, 0.9, 1.0], [0.0, 0.0, 0.1],
            [0.01, 0.01, 0.01, 0.01], [0.04, 0.001, 0.3, 0.02, 0.02, 0.7], [1.0, 1.0], [0.2, 0.0001, 0.05, 0.05, 0.6, 0.03]]


def main():
    tables, groups, columns = make_tables(), make_groups(), make_columns()
    pairs = make_pairs()
    signed, sums = make_shifts()
    r = R()
    for name, (_, near) in tables.items():
        flat = [x for row in near for x in row]
        r.ask("table", "t." + name, [len(near[0])], flat)
        if paired_possible(near):
            r.ask("paired", "t." + name, [len(near[0])], flat)
    for name, (_, near) in groups.items():
        r.ask("groups", "g." + name, [len(g) for g in near], [x for g in near for x in g])
    for name, pair in pairs.items():
        r.ask("interval", "d." + name, [0], [a - b for a, b in zip(pair[4], pair[5])])
    for name, (_, near) in columns.items():
        r.ask("interval", "c." + name, [0], near)
    for i, p in enumerate(P_VALUES):
        r.ask("adjust", f"a.{i}", [0], p)
    for name, x in signed.items():
        r.ask("signed_rank", "w." + name, [0], x)
    for name, (first, second) in sums.items():
        r.ask("rank_sum", "u." + name, [len(first), len(second)], [*first, *second])
    r.run()
    golden = {
        "versions": {"R": r.get("r", "version")[0], "scipy": scipy.__version__, "statsmodels": statsmodels.__version__,
                     "numpy": np.__version__, "mpmath": mpmath.__version__},
        "tables": [table_answers(r, "t." + name, *both) for name, both in tables.items()],
        "groups": [group_answers(r, "g." + name, *both) for name, both in groups.items()],
        "columns": [column_answers(r, "c." + name, *both) for name, both in columns.items()],
        "pairs": [pair_case_answers(r, "d." + name, pair) for name, pair in pairs.items()],
        "proportions": [{"successes": s, "trials": n, "interval": list(proportion_confint(s, n, method="wilson"))}
                        for s, n in PROPORTIONS],
        "adjustments": [{"p": p, "bonferroni": r.get(f"a.{i}", "bonferroni"), "holm": r.get(f"a.{i}", "holm")}
                        for i, p in enumerate(P_VALUES)],
        "signed_rank": [shift_answers(r, "w." + name, scipy.stats.wilcoxon(x, mode="exact").pvalue, values=x)
                        for name, x in signed.items()],
        "rank_sum": [shift_answers(r, "u." + name, scipy.stats.mannwhitneyu(*both, method="exact").pvalue, first=both[0], second=both[1])
                     for name, both in sums.items()],
    }
    text = json.dumps(golden, default=float, allow_nan=False)
    # One data set a line.
    text = text.replace('{"name"', '\n{"name"').replace('{"successes"', '\n{"successes"').replace('{"p": [', '\n{"p": [')
    (HERE / "statistics.json").write_text(text + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
