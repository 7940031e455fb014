#!/usr/bin/python3
"""How fast whole steps are, beside the limit loops, in one session: the tables and the plot of docs/performance.md.

    /usr/bin/python3 bench/throughput/measure.py BUILD [--only PART]... [--rounds 3] [--write]

BUILD holds bench/throughput and bench/limit_pairs (cmake --preset bench && ninja -C build-bench). Parts: steps, limit,
threads, growth, bare. Runs are interleaved and medians taken over the rounds; results are kept part by part in
bench/throughput/results.csv. With --write, docs/gallery/performance.png is drawn from them.
"""

import argparse
import json
import pathlib
import statistics
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from barchan_bench import ROOT, page as pages, run, store  # noqa: E402

RESULTS = ROOT / "bench/throughput/results.csv"
CASES = {  # name: options of throughput
    "air 2D, plain, 3.0 dx, double": ["--case", "air2d"],
    "air 2D, plain, 3.0 dx, mixed": ["--case", "air2d", "--precision", "mixed"],
    "air 2D, consistent, 2.6 dx, double": ["--case", "air2d-consistent"],
    "air 2D, consistent, 2.6 dx, mixed": ["--case", "air2d-consistent", "--precision", "mixed"],
    "air 3D, plain, 2.86 dx, double": ["--case", "air3d", "--steps", "10"],
    "air 3D, plain, 2.86 dx, mixed": ["--case", "air3d", "--precision", "mixed", "--steps", "10"],
    "elastic 2D, 2.6 dx": ["--case", "elastic2d", "--n", "100000", "--warm", "150"],
    "elastic 2D, total Lagrangian, 2.6 dx, double": ["--case", "elastic2d-total", "--n", "100000", "--warm", "150"],
    "elastic 2D, total Lagrangian, 2.6 dx, mixed": ["--case", "elastic2d-total", "--precision", "mixed", "--n", "100000", "--warm", "150"],
    "grains 2D, 1.1 d": ["--case", "grains2d", "--n", "100000"],
    "paper/dune.toml": ["--case", str(ROOT / "scenes/paper/dune.toml"), "--steps", "100"],
}
GROWTH = {"2D": ("air2d", [1e4, 1e5, 1e6, 4e6]), "3D": ("air3d", [1e5, 1e6])}


def throughput(build, options):
    out = run.command([build / "bench/throughput", *options, "--json"], check=True)
    result = json.loads(out.stdout)
    result["case"] = pathlib.PurePath(result["case"]).name
    return result


def limit(build, dimensions):
    out = run.command([build / "bench/limit_pairs", "--dim", dimensions, "--rebuild", "10" if dimensions == 2 else "5", "--repeat", "5", "--json"], check=True)
    return json.loads(out.stdout)


def median_of(rounds):
    """Median of every number; what is not a number is taken from the first round."""
    first = rounds[0]
    return {k: statistics.median(r[k] for r in rounds) if isinstance(v, (int, float)) else v for k, v in first.items()}


def measure(build, part, rounds):
    if part in ("steps", "limit"):  # in one session, in turn
        steps, limits = {name: [] for name in CASES}, {2: [], 3: []}
        for _ in range(rounds):
            for d in limits:
                limits[d].append(limit(build, d))
            for name, options in CASES.items():
                steps[name].append(throughput(build, options))
        forms = {}
        for d, runs in limits.items():
            forms[str(d)] = {"neighbours": runs[0]["neighbours"], "forms": {
                f["form"]: {key: statistics.median(r["forms"][k][key] for r in runs)
                            for key in ("mega_pairs_per_second", "mega_particle_steps_per_second")}
                for k, f in enumerate(runs[0]["forms"])}}
        return {"steps": {name: median_of(r) for name, r in steps.items()}, "limit": forms}
    if part == "threads":
        table = {}
        for name, options in CASES.items():
            one, two = [], []
            for _ in range(rounds):
                one.append(throughput(build, options)["particle_steps_per_second"])
                two.append(throughput(build, options + ["--threads", "2"])["particle_steps_per_second"])
            table[name] = {"one": statistics.median(one), "two": statistics.median(two),
                           "ratio": statistics.median(b / a for a, b in zip(one, two))}
        return {"threads": table}
    if part == "growth":
        return {"growth": {d: {f"{n:.0e}": median_of([throughput(build, ["--case", case, "--n", str(n), "--steps", "5"])
                                                      for _ in range(rounds)]) for n in sizes}
                           for d, (case, sizes) in GROWTH.items()}}
    out = [float(run.command([build / "bench/throughput", "--case", "air2d", "--n", "100000", "--steps", "5", "--bare"], check=True).stdout)
           for _ in range(rounds)]
    return {"bare": statistics.median(out)}


def page(results):
    lines = []
    if "steps" in results:
        lines += ["| case | particles | neighbours | M particle-steps/s | M pairs/s, step | M pairs/s, pair pass | steps a rebuild, skin "
                  "| bytes a particle |", "| --- | --- | --- | --- | --- | --- | --- | --- |"]
        for name, r in results["steps"].items():
            lines.append(f"| {name} | {r['particles']:.0f} | {r['neighbours']:.1f} | {r['particle_steps_per_second'] / 1e6:.2f} | "
                         f"{r['pairs_per_second'] / 1e6:.0f} | {r['pair_pass_pairs_per_second'] / 1e6:.0f} | "
                         f"{r['steps_per_rebuild']:.0f}, {r['skin']:.3f} | {r['bytes_per_particle']:.0f} |")
        lines += ["", "Limit loops, the same session, one core:", "",
                  "| loop | 2D, M pairs/s | M particle-steps/s | 3D, M pairs/s | M particle-steps/s |", "| --- | --- | --- | --- | --- |"]
        two, three = results["limit"]["2"]["forms"], results["limit"]["3"]["forms"]
        keep = ("omp simd", "vectors, all", "list, records", "list, mixed", "roof, 256", "whole step")
        for form, f in two.items():
            if not form.startswith(keep):
                continue
            g = three.get(form) or three.get(form.replace("every 10", "every 5"), {})
            cells = [f"{f['mega_pairs_per_second']:.0f}", f"{f['mega_particle_steps_per_second']:.2f}"]
            cells += [f"{g['mega_pairs_per_second']:.0f}", f"{g['mega_particle_steps_per_second']:.2f}"] if g else ["", ""]
            lines.append(f"| {form.replace(' every 10', ' every 10 (3D: 5)')} | " + " | ".join(cells) + " |")
        shares = results["steps"]["air 2D, plain, 3.0 dx, double"].get("share", {})
        if shares:
            lines += ["", "Where a step of plain air in 2D goes: " +
                      ", ".join(f"{k} {100 * v:.1f} %" for k, v in shares.items() if v > 0.002) + "."]
    if "threads" in results:
        lines += ["", "Two threads over one (wall time of two against CPU time of one):", "", "| case | one | two | ratio |", "| --- | --- | --- | --- |"]
        for name, r in results["threads"].items():
            lines.append(f"| {name} | {r['one'] / 1e6:.2f} | {r['two'] / 1e6:.2f} | {r['ratio']:.2f} |")
    if "growth" in results:
        lines += ["", "Growth, one thread, M particle-steps/s:", "", "| | " + " | ".join(
            f"{d} {n}" for d, r in results["growth"].items() for n in r) + " |",
            "| --- " * (1 + sum(len(r) for r in results["growth"].values())) + "|",
            "| M particle-steps/s | " + " | ".join(f"{x['particle_steps_per_second'] / 1e6:.2f}" for r in results["growth"].values()
                                                   for x in r.values()) + " |"]
    if "bare" in results:
        lines += ["", f"Plain air in 2D costs {results['bare']:.3f} times a program that has only that air in it "
                  "(bench/throughput/bare_air.hpp), in CPU seconds, step by step in turn."]
    return "\n".join(lines)


def plot(results):
    """Colours of Okabe & Ito (Color Universal Design, 2008) and a mark for each series, so that nobody needs to see the colours;
    the legend stands above the axes, where it covers nothing."""
    pyplot = pages.pyplot()
    names = list(results["steps"])[::-1]
    rates = [results["steps"][name] for name in names]
    figure, axes = pyplot.subplots(figsize=(8, 4.8), layout="constrained")
    axes.barh(names, [r["pairs_per_second"] / 1e6 for r in rates], color="#56B4E9", label="whole step")
    axes.plot([r["pair_pass_pairs_per_second"] / 1e6 for r in rates], names, "D", color="#D55E00", label="pair pass alone")
    limits = {}   # of the rows whose law the limit loop has
    for d in ("2", "3"):
        for precision, key in (("double", "whole step, law of the air, list"), ("mixed", "whole step, law of the air, mixed")):
            for name in names:
                if name.startswith(f"air {d}D, plain") and name.endswith(precision):
                    limits[name] = next(f["mega_pairs_per_second"] for k, f in results["limit"][d]["forms"].items() if k.startswith(key))
    axes.plot(list(limits.values()), list(limits), "|", color="#000000", markersize=24, markeredgewidth=2.5,
              label="limit loop of the same law, whole step")
    axes.set_xlabel("million pairs a second, one core")
    axes.legend(fontsize=9, loc="lower center", bbox_to_anchor=(0.3, 1.01), ncols=3, frameon=False)
    figure.savefig(ROOT / "docs/gallery/performance.png", dpi=110)


def tables():
    """That of docs/performance.md."""
    return {"measured": page(store.load(RESULTS, {}))}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", type=pathlib.Path)
    parser.add_argument("--only", action="append", choices=["none", "steps", "threads", "growth", "bare"],
                        help="these parts; with none nothing is measured, and --write draws the plot from what there is")
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--write", action="store_true")
    options = parser.parse_args()
    results = store.load(RESULTS, {})
    for part in options.only or ["steps", "threads", "growth", "bare"]:
        if part == "none":
            continue
        results.update(measure(options.build.resolve(), part, options.rounds))
        store.keep(RESULTS, results)
    text = page(results)
    print(text)
    if options.write and "steps" in results:
        plot(results)


if __name__ == "__main__":
    main()
