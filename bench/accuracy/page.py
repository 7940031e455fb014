"""docs/accuracy.md and its plot, from the results of bench/accuracy/results."""

import json
import platform

from harness import HEAD, RESULTS, ROOT, line

# L1(t=1) by particles a side: PySPH runs at the settings (h/dx, sound speed) of the schemes' papers, without run times
PEERS = {"EDAC-TVF": {30: .0122, 50: .0090, 70: .0096, 100: .0078}, "TVF": {30: .1182, 50: .0674, 70: .0519, 100: .0393},
         "delta+": {30: .0267, 50: .0266, 70: .0243, 100: .0207}}


def processor():
    try:
        return next(l.split(":")[1].strip() for l in open("/proc/cpuinfo") if l.startswith("model name"))
    except (OSError, StopIteration):
        return platform.machine()


def plot(points):
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as pyplot
    figure, axes = pyplot.subplots(figsize=(8, 5))
    for r in points:
        if r["what"] == "L1(t=1)":
            axes.annotate(str(r["n"]), (r["seconds"], r["value"]), textcoords="offset points", xytext=(4, 4), fontsize=7)
    points = [r for r in points if r["what"] == "L1(t=1)"]
    for scheme in dict.fromkeys(r["scheme"] for r in points):
        axes.loglog(*zip(*[(r["seconds"], r["value"]) for r in points if r["scheme"] == scheme]), "o-", label=scheme)
    for style, (name, values) in zip((":", "--", "-."), PEERS.items()):
        axes.axhline(values[100], color="0.6", linestyle=style, label=f"{name} at 100 x 100 (no time published)")
    axes.set(xlabel="user CPU seconds to t = 1, one thread", ylabel="L1(t = 1)",
             title="Taylor-Green, Re 100, disturbed: run time against error")
    axes.legend(fontsize=8)
    axes.grid(True, which="both", alpha=0.3)
    figure.tight_layout()
    figure.savefig(ROOT / "docs/gallery/accuracy.png", dpi=120)


def write_page(cases):
    """docs/accuracy.md between its markers, and the plot, from all results that are there."""
    tables = []
    for name, (_, heading) in cases.items():
        tables.append(f"\n## {heading}\n\n`cases.py build/barchan {name}`\n")
        file = RESULTS / f"{name}.json"
        if not file.exists():
            tables.append("Not measured yet.\n")
            continue
        result = json.loads(file.read_text())
        tables.append(HEAD + "\n" + "\n".join(line(r) for r in result["rows"]) + f"\n\nMeasured on {result['processor']}.\n")
        if name == "cost":
            plot(result["rows"])
            tables.append("![run time against error](gallery/accuracy.png)\n")
            tables.append("Peers at the same settings (PySPH runs; L1(t=1) by particles a side):\n")
            tables.append("| peer | 30 | 50 | 70 | 100 |\n| --- | --- | --- | --- | --- |")
            tables += [f"| {peer} | " + " | ".join(f"{e:.4f}" for e in values.values()) + " |" for peer, values in PEERS.items()]
    page = ROOT / "docs/accuracy.md"
    before, begin, rest = page.read_text().partition("<!-- figures: begin -->\n")
    _, end, after = rest.partition("<!-- figures: end -->\n")
    if not begin or not end:
        raise RuntimeError(f"{page} has lost its markers <!-- figures: begin --> and <!-- figures: end -->")
    page.write_text(before + begin + "\n".join(tables) + "\n" + end + after)
