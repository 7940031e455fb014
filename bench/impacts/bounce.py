"""Elastic bodies that bounce: cases of bench/impacts/cases.py and their tables on docs/impacts.md."""


def rings(run_of):
    table = []
    for across in (5, 10):
        run = run_of("rings", [f"spacing={0.01 / across!r}"])
        parts = {kind: sum(run[f"{b}_{kind}_energy"] for b in "ab") for kind in ("kinetic", "strain", "hourglass")}
        energy = sum(parts.values())
        momentum = run["momentum_x"]
        mass = 2 * parts["kinetic"][0] / 6.95**2 / 2  # of one ring
        table.append({"across": across, "kept": float(run["b_mean_vx"][-1] / 6.95), "energy": float(abs(energy[-1] / energy[0] - 1)),
                      "touching": float(abs(energy / energy[0] - 1).max()), "momentum": float(abs(momentum - momentum[0]).max() / (mass * 6.95)),
                      "strained": float((parts["strain"] / energy[0]).max()), "hourglass": float((parts["hourglass"] / energy[0]).max())})
    return {"table": table}


def block(run_of):
    table = []
    for across in (10, 20, 40):
        run = run_of("bouncing_block", [f"spacing={0.1 / across!r}"])
        t, y = run["time"], run["middle_y"]
        energy = sum(run[f"block_{kind}_energy"] for kind in ("kinetic", "strain", "hourglass")) + 10 * 9.81 * y
        tops = [k for k in range(1, len(y) - 1) if y[k] > y[k - 1] and y[k] >= y[k + 1] and y[k] > 0.07]
        free = y > 0.07  # above the floor whatever its shape
        table.append({"across": across, "first": float((y[tops[0]] - 0.05) / 0.2), "time": float(t[tops[0]]),
                      "energy": float(abs(energy - energy[0])[free].max() / (10 * 9.81 * 0.2))})
    return {"table": table}


CASES = {"rings": rings, "block": block}


def page(results):
    lines = []
    if "rings" in results:
        lines += ["### Two rubber rings", "",
                  "| particles across | speed kept | energy, change after the bounce | largest change while they touch (stored in the contact) | momentum over that of a ring "
                  "| strain energy, hourglass energy at most, of all |", "| --- | --- | --- | --- | --- | --- |"]
        lines += [f"| {r['across']} | {r['kept']:.3f} | {r['energy']:.1e} | {r['touching']:.1e} | {r['momentum']:.0e} | {r['strained']:.2f}, {r['hourglass']:.3f} |"
                  for r in results["rings"]["table"]]
        lines += ["", "They bounce and go on vibrating. They cannot tear: a total Lagrangian body keeps the neighbours of its first shape.", ""]
    if "block" in results:
        lines += ["### A block of rubber that bounces", "",
                  "| particles a side | height of the first bounce over that of the fall | at [s] | energy in flight, largest change over that of the fall |",
                  "| --- | --- | --- | --- |"]
        lines += [f"| {r['across']} | {r['first']:.3f} | {r['time']:.3f} | {r['energy']:.1e} |" for r in results["block"]["table"]]
        lines += ["", "What is missing in height vibrates; nothing damps it.", ""]
    return lines
