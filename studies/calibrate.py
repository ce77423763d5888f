#!/usr/bin/env python3
"""Calibrates the virtual operator on experiment 1: studies/preregistration/README.md has the rules.

    python3 studies/calibrate.py build/release/bin/thimble out/calibration

A study that has ended is not run again, so an interrupted search goes on. Writes OUT/draws.csv, OUT/verify.csv and OUT/operator.toml.
"""
import concurrent.futures
import csv
import hashlib
import json
import math
import os
import pathlib
import random
import subprocess
import sys
import tomllib

PLAN_FILE = pathlib.Path(__file__).parent / "preregistration" / "calibration.toml"
PLAN = tomllib.loads(PLAN_FILE.read_text())
FREE, FIXED, TARGETS, SEARCH = (PLAN[k] for k in ("free", "fixed", "targets", "search"))
WORKERS = 5  # studies at a time, a thread each; changes no result
MODALITIES = ("HF", "CF", "CCF", "VF")
SIZES = ("f_mean", "f_max", "ratio_mean", "ratio_max", "t_mean_ccf_cf", "t_max_ccf_cf", "hold_rms_m")
LOGARITHMIC = ("f_mean", "f_max", "hold_rms_m")


def session_text(values):
    """A session file: experiment 1 with these values, whose keys are dotted."""
    tables = {}
    for key, value in {**FIXED, **values}.items():
        table, name = key.split(".")
        tables.setdefault(table, []).append(f"{name} = {json.dumps(value)}")
    text = f"""[session]
modalities = {json.dumps(MODALITIES)}
delays_s = [0.0]
order = "shuffled"

[protocol]
experiments = [1]
subjects = {PLAN['design']['subjects']}
trials_per_modality = {PLAN['design']['trials_per_modality']}
"""
    return text + "".join(f"\n[{t}]\n" + "\n".join(lines) + "\n" for t, lines in tables.items())


def anova(table):
    """F for repeated measures of rows of HF, CF, CCF, VF, and t of CCF - CF by its pooled error."""
    n, k = len(table), len(table[0])
    grand = sum(map(sum, table)) / (n * k)
    columns = [sum(row[j] for row in table) / n for j in range(k)]
    error = sum((row[j] - sum(row) / k - columns[j] + grand) ** 2 for row in table for j in range(k))
    error /= (n - 1) * (k - 1)
    f = n * sum((c - grand) ** 2 for c in columns) / (k - 1) / error
    return f, (columns[2] - columns[1]) / math.sqrt(2 * error / n), columns


def sizes_of(trials):
    """The sizes of SIZES, of a study's trials.csv."""
    rows = list(csv.DictReader(trials.open()))
    found = {}
    for name, column in (("mean", "penetration_mean_m"), ("max", "penetration_max_m")):
        cells = {}
        for row in rows:
            cells.setdefault((row["subject"], row["modality"]), []).append(float(row[column]))
        subjects = sorted({s for s, _ in cells})
        table = [[sum(cells[s, m]) / len(cells[s, m]) for m in MODALITIES] for s in subjects]
        f, t, means = anova(table)
        found.update({f"f_{name}": f, f"t_{name}_ccf_cf": t,
                      f"ratio_{name}": (means[1] - means[0]) / (means[3] - means[0])})
    held = [float(r["oscillation_rms_m"]) for r in rows if r["modality"] != "HF"]
    found["hold_rms_m"] = sum(held) / len(held)
    return [found[name] for name in SIZES]


def study(thimble, folder, values, seed):
    summary = folder / "summary.json"  # an interrupted study writes one, too
    if not summary.exists() or json.loads(summary.read_text())["provenance"]["complete"] != "yes":
        folder.mkdir(parents=True, exist_ok=True)
        session = folder / "session.toml"
        session.write_text(session_text(values))
        command = [thimble, "study", session, "--seed", str(seed), "--no-control", "--jobs", "1", "--overwrite",
                   "--out", folder]
        # Without gnuplot on its path the study draws no pictures.
        subprocess.run(command, check=True, env={**os.environ, "PATH": "/nonexistent"},
                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    return sizes_of(folder / "trials.csv")


def hypercube(box, count, rng):
    columns = []
    for low, high in box:
        strata = list(range(count))
        rng.shuffle(strata)
        columns.append([low + (high - low) * (s + rng.random()) / count for s in strata])
    return [list(point) for point in zip(*columns)]


def scaled(point):
    """To -1 to 1 over the whole ranges."""
    return [2 * (x - f["low"]) / (f["high"] - f["low"]) - 1 for x, f in zip(point, FREE.values())]


def least_squares(inputs, outputs):
    """Coefficients, the intercept first, by the normal equations."""
    rows = [[1.0] + row for row in inputs]
    size = len(rows[0])
    system = [[sum(r[i] * r[j] for r in rows) for j in range(size)] + [sum(r[i] * y for r, y in zip(rows, outputs))]
              for i in range(size)]
    for i in range(size):
        pivot = max(range(i, size), key=lambda r: abs(system[r][i]))
        system[i], system[pivot] = system[pivot], system[i]
        for r in range(size):
            if r != i:
                share = system[r][i] / system[i][i]
                system[r] = [a - share * b for a, b in zip(system[r], system[i])]
    return [system[i][size] / system[i][i] for i in range(size)]


def misses(sizes):
    """How far each size is from its target, in its spread."""
    result = []
    for name, size in zip(SIZES, sizes):
        target = TARGETS[name]
        if "value" in target:
            result.append(math.log(size / target["value"]) / target["spread_log"])
        else:
            over = max(0.0, size - target.get("most", math.inf)) - max(0.0, target.get("least", -math.inf) - size)
            result.append(over / target["spread"])
    return result


def best_point(points, found, rng):
    """Of the least cost on linear surfaces through all draws: random starts, then smaller and smaller steps."""
    inputs = [scaled(p) for p in points]
    transform = [math.log if s in LOGARITHMIC else float for s in SIZES]
    surfaces = [least_squares(inputs, [t(f[i]) for f in found]) for i, t in enumerate(transform)]
    start = scaled([f["start"] for f in FREE.values()])

    def cost(u):
        sizes = [c[0] + sum(a * b for a, b in zip(c[1:], u)) for c in surfaces]
        sizes = [math.exp(s) if name in LOGARITHMIC else s for name, s in zip(SIZES, sizes)]
        prior = sum((a - b) ** 2 for a, b in zip(u, start))
        return sum(m * m for m in misses(sizes)) + TARGETS["prior"] * prior

    best = min(([rng.uniform(-1, 1) for _ in FREE] for _ in range(2000)), key=cost)
    lowest = cost(best)
    for step in range(20000):
        width = 0.5 * 0.9997 ** step
        trial = [min(1.0, max(-1.0, a + rng.gauss(0, width) * (rng.random() < 0.3))) for a in best]
        if (value := cost(trial)) < lowest:
            best, lowest = trial, value
    return [f["low"] + (u + 1) / 2 * (f["high"] - f["low"]) for u, f in zip(best, FREE.values())]


def main(thimble, out):
    rng = random.Random(SEARCH["first_seed"])
    points, found = [], []

    def studies(batch, first_seed, name):
        seeds = range(first_seed, first_seed + len(batch))
        with concurrent.futures.ThreadPoolExecutor(WORKERS) as workers:
            yield from workers.map(lambda point, seed: study(thimble, out / f"{name}{seed}", point, seed), batch, seeds)

    def add(batch):
        named = [dict(zip(FREE, point)) for point in batch]
        for point, sizes in zip(batch, studies(named, SEARCH["first_seed"] + len(points), "draw")):
            points.append(point)
            found.append(sizes)
            print(len(points), " ".join(f"{name} {size:.4g}" for name, size in zip(SIZES, sizes)), flush=True)

    add(hypercube([(f["low"], f["high"]) for f in FREE.values()], SEARCH["wide"], rng))
    centre = best_point(points, found, rng)
    box = [(max(f["low"], c - (f["high"] - f["low"]) / 4), min(f["high"], c + (f["high"] - f["low"]) / 4))
           for c, f in zip(centre, FREE.values())]
    add(hypercube(box, SEARCH["narrow"], rng))
    chosen = {key: float(f"{x:.3g}") for key, x in zip(FREE, best_point(points, found, rng))}

    with (out / "draws.csv").open("w") as file:
        file.write(",".join([*FREE, *SIZES]) + "\n")
        file.writelines(",".join(f"{x:.6g}" for x in p + f) + "\n" for p, f in zip(points, found))
    digest = hashlib.sha256(PLAN_FILE.read_bytes()).hexdigest()
    (out / "operator.toml").write_text(f"# SHA-256 of the plan: {digest}\n" + session_text(chosen))
    print(session_text(chosen))
    with (out / "verify.csv").open("w") as file:
        file.write(",".join(["seed", *SIZES]) + "\n")
        first = SEARCH["verify_first_seed"]
        for seed, sizes in enumerate(studies([chosen] * SEARCH["verify"], first, "verify"), first):
            file.write(",".join([str(seed), *(f"{s:.6g}" for s in sizes)]) + "\n")


if __name__ == "__main__":
    main(str(pathlib.Path(sys.argv[1]).resolve()), pathlib.Path(sys.argv[2]))
