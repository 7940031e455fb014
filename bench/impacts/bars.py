"""Bars in impact (scenes/verification/two_bars.toml) against exact waves: cases of bench/impacts/cases.py, tables on docs/impacts.md."""

import math

import numpy as np

LENGTH, WAVE, SPEED = 0.040, 5936.0, 10.0  # m, m/s, m/s
EXACT = 2 * LENGTH / WAVE  # s, the time of contact
SMOOTH = ["interactions.a-b={ restitution = 1, surfaces = true }"]
PLAIN = [f"phases.{p}.wave-correction=false" for p in "ab"]


def bars(run):
    """With `wave-correction`, as the scene is, without it, and with contact by surfaces besides."""
    tables, history = {"table": [], "plain": [], "smooth": []}, None
    for name, table in tables.items():
        for count in (20, 40, 80, 160):
            dx = LENGTH / count
            done = run("verification/two_bars", [f"spacing={dx!r}", f"domain.size=[0.1, {5 * dx!r}]", "output.history-every=2e-8", *{"table": [], "plain": PLAIN, "smooth": SMOOTH}[name],
                                                 *(f"fill.{k}.shape.box.max=[{x}, {5 * dx!r}]" for k, x in ((0, 0.045), (1, 0.085)))])
            t, a, b = done["time"], done["a_mean_vx"], done["b_mean_vx"]
            force = np.diff(b) / np.diff(t) * EXACT / SPEED  # over the exact one, which lasts for EXACT
            half, all_of_it = np.where(force > 0.5)[0], np.where(force > 0.05)[0]
            energy = done.energy(["a", "b"])
            table.append({"count": count, "time": float(t[half[-1] + 1] - t[half[0]]) / EXACT, "touch": float(t[all_of_it[-1] + 1] - t[all_of_it[0]]) / EXACT,
                          "restitution": float(b[-1] - a[-1]) / SPEED, "left": float(a[-1]) / SPEED, "energy": float(abs(energy[-1] / energy[0] - 1))})
            if count == 40 and name == "table":
                history = [x[::5].tolist() for x in (t, a, b)]
    return tables | {"history": history}


def row_of(hits, corrected, surfaces=False):
    """A scene: `hits` bars in a row hit as many at rest; all touch from the start, and each is a phase."""
    names = [f"b{k}" for k in range(2 * hits)]
    lines = ["dimensions = 2", "spacing = 1e-3", "[domain]", f"size = [{2 * hits * LENGTH + 0.06:.6g}, 0.005]", 'periodic = ["y"]']
    for name in names:
        lines += [f"[phases.{name}]", 'kind = "elastic"', "density = 7870", "young = 206e9", "poisson = 0.3", f"wave-correction = {str(corrected).lower()}"]
    lines += ["[interactions]", *(f'{name}-{name} = {{ radius = 1.6, kernel = "wendland-c2" }}' for name in names),
              *(f"{a}-{b} = {{ restitution = 1, surfaces = {str(surfaces).lower()} }}" for a, b in zip(names, names[1:]))]
    for k, name in enumerate(names):
        lines += ["[[fill]]", f'phase = "{name}"', f"shape = {{ box = {{ min = [{0.005 + k * LENGTH:.6g}, 0], max = [{0.005 + (k + 1) * LENGTH:.6g}, 0.005] }} }}"]
        lines += [f"velocity = [{SPEED}, 0]"] if k < hits else []
    lines += ["[time]", f"end = {1.3 * (2 * hits + 1) * LENGTH / WAVE!r}", "largest-speed = 20", "[output]", "history-every = 1e-6"]
    return "\n".join(lines) + "\n"


def rows(run):
    table = []
    for corrected, surfaces in ((True, False), (False, False), (True, True)):
        for hits in (2, 5, 11):
            done = run(row_of(hits, corrected, surfaces))
            v = [float(done[f"b{k}_mean_vx"][-1]) / SPEED for k in range(2 * hits)]
            left, given = float(np.mean(v[:hits])), float(np.mean(v[hits:]))
            table.append({"hits": hits, "corrected": corrected, "surfaces": surfaces, "restitution": given - left, "given": given, "worst": max(abs(x - (k >= hits)) for k, x in enumerate(v))})
    return {"table": table}


CASES = {"bars": bars, "rows": rows}


def page(results):
    return page_of_two(results) + page_of_rows(results)


def page_of_two(results):
    if "bars" not in results:
        return []
    lines = ["### A bar hits an equal bar", "",
             "| particles a length | force above half of rho c V/2, over 2L/c | above a twentieth | restitution | speed of A over V | energy, change |",
             "| --- | --- | --- | --- | --- | --- |"]
    for name, words in (("table", ""), ("plain", ", without `wave-correction`"), ("smooth", ", by surfaces")):
        lines += [f"| {r['count']}{words} | {r['time']:.4f} | {r['touch']:.4f} | {r['restitution']:.4f} | {r['left']:.4f} | {r['energy']:.1e} |"
                  for r in results["bars"].get(name, [])]
    first, last = results["bars"]["table"][0], results["bars"]["table"][-1]
    order = math.log(first["left"] / last["left"]) / math.log(last["count"] / first["count"])
    return lines + ["| exact | 1 | 1 | 1 | 0 | 0 |", "", f"The speed that A keeps falls with order {order:.2f} in the spacing: the front of the wave is a jump.", "",
                    "![Speeds of two bars](gallery/impacts_bars.png)", ""]


def page_of_rows(results):
    if "rows" not in results:
        return []
    lines = ["### Bars in a row hit as many", "", "40 particles a length; all bars touch from the start. Exact: those that hit are at rest afterwards, the others have their speed.", "",
             "| bars | `wave-correction` | by surfaces | restitution of the rows | momentum given | single bar, largest difference of its speed over V |", "| --- | --- | --- | --- | --- | --- |"]
    lines += [f"| {r['hits']} hit {r['hits']} | {'yes' if r['corrected'] else 'no'} | {'yes' if r.get('surfaces') else 'no'} | {r['restitution']:.4f} | {r['given']:.4f} | {r['worst']:.3f} |"
              for r in results["rows"]["table"]]
    return lines + ["| exact | | | 1 | 1 | 0 |", ""]
