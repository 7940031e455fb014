"""The tables of docs/accuracy.md and its plot, from the results of bench/accuracy/results and from peers.csv."""

import pathlib

from barchan_bench import ROOT, store
from barchan_bench.page import BLACK, BLUE, GREEN, ORANGE, PURPLE, SKY, VERMILION, processor, pyplot  # noqa: F401
from barchan_bench.table import HEAD, line
from harness import RESULTS

PEERS = store.load(pathlib.Path(__file__).resolve().parent / "peers.csv")
OURS = ((BLUE, "o"), (SKY, "s"), (GREEN, "^"), (VERMILION, "D"), (BLACK, "v"), (PURPLE, "P"))  # a scheme's colour and marker
THEIRS = {"LAMMPS": (ORANGE, ("X", "*")), "SPHinXsys": (PURPLE, ("<", ">")), "Barchan": (BLACK, ("h",))}


def plot(points, measured_on):
    """Error against time: our schemes in full lines with full markers, peers dashed with hollow ones, the legend below the axes."""
    figure, axes = pyplot().subplots(figsize=(9, 7.6))
    points = [r for r in points if r["what"] == "L1(t=1)"]
    for (colour, marker), scheme in zip(OURS, dict.fromkeys(r["scheme"] for r in points)):
        own = [r for r in points if r["scheme"] == scheme]
        sizes = ", ".join(str(r["n"]) for r in own)
        axes.loglog([r["seconds"] for r in own], [r["value"] for r in own], "-", color=colour, marker=marker, markersize=6,
                    label=f"{scheme}: {sizes} a side")
    axes.plot([], [], " ", label=f"full lines: Barchan on {measured_on}")
    used = {}
    for peer in PEERS["measured"]["series"]:
        colour, markers = THEIRS[peer["code"]]
        marker = markers[used.setdefault(peer["code"], 0)]
        used[peer["code"]] += 1
        n, error, seconds = zip(*peer["points"])
        axes.loglog(seconds, error, "--", color=colour, marker=marker, markersize=8, markerfacecolor="white",
                    label=f"{peer['code']}, {peer['label']}: {', '.join(map(str, n))} a side")
    axes.plot([], [], " ", label="dashed: measured together on an AVX-512 Xeon")
    for name, errors in PEERS["published"]["series"].items():
        axes.axhline(errors[-1], color="0.6", linestyle=":", linewidth=1)
        axes.annotate(f"{name}, {PEERS['published']['sizes'][-1]} a side", (1, errors[-1]), xycoords=("axes fraction", "data"),
                      textcoords="offset points", xytext=(4, 0), va="center", fontsize=8, color="0.35")
    axes.set(xlabel="user CPU seconds to t = 1, one thread", ylabel="L1(t = 1)",
             title="Taylor-Green, Re 100, disturbed: run time against error\n(dotted: PySPH runs at published settings, no run time)")
    figure.subplots_adjust(left=.09, right=.81, bottom=.27, top=.92)
    axes.legend(fontsize=8, loc="upper center", bbox_to_anchor=(.56, -.12), borderaxespad=0, ncol=2)
    axes.grid(True, which="major", alpha=0.3)
    figure.savefig(ROOT / "docs/gallery/accuracy.png", dpi=120)


def peers():
    """Tables of the peers."""
    measured, published = PEERS["measured"], PEERS["published"]
    out = [f"Peers measured beside Barchan ({measured['where']}; {measured['what']}):\n",
           "| code | scheme | 25 a side | 50 | 100 |\n| --- | --- | --- | --- | --- |"]
    for peer in measured["series"]:
        cells = {n: f"{error:g} in {seconds:g} s" for n, error, seconds in peer["points"]}
        note = f" ({peer['note']})" if "note" in peer else ""
        out.append(f"| {peer['code']} | {peer['scheme']}{note} | {cells.get(25, '')} | {cells.get(50, '')} | {cells.get(100, '')} |")
    out += [f"\nPeers without run times ({published['what']}):\n", "| peer | " + " | ".join(map(str, published["sizes"])) + " |\n"
            + "| --- " * (1 + len(published["sizes"])) + "|"]
    return out + [f"| {peer} | " + " | ".join(f"{e:.4f}" for e in errors) + " |" for peer, errors in published["series"].items()]


def figures(cases):
    """Of all results that are there; cases without results are named at the end."""
    tables = []
    for name, (_, heading) in cases.items():
        file = RESULTS / f"{name}.csv"
        if not file.exists():
            continue
        tables.append(f"\n## {heading}\n\n`cases.py build/barchan {name}`\n")
        result = store.load(file)
        tables.append(HEAD + "\n" + "\n".join(line(r) for r in result["rows"]) + f"\n\nMeasured on {result['processor']}.\n")
        if name == "cost":
            tables.append("![run time against error](gallery/accuracy.png)\n")
            tables += peers()
    left = [f"`{name}` ({heading})" for name, (_, heading) in cases.items() if not (RESULTS / f"{name}.csv").exists()]
    if left:
        tables.append("\n## Without results here\n\nThe same command runs these cases too: " + "; ".join(left) + ".")
    return "\n".join(tables)
