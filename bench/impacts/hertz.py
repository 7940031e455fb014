"""Discs and spheres pressed together (scenes/verification/hertz.toml, hertz_spheres.toml) against Hertz: cases of bench/impacts/cases.py, tables and plots on
docs/impacts.md."""

import tempfile

import numpy as np
from barchan_bench import run
from barchan_bench.frame import Frame

RADIUS, YOUNG, POISSON = 0.02, 1e6, 0.3  # m, Pa, -: hertz.toml
STEEP = YOUNG / (2 * (1 - POISSON**2))  # Pa, E*
GENTLE = 0.015  # m/s, half the largest speed of the middles; the scene's 0.04 gives 2.7 times the approach
SURFACES = "interactions.upper-lower={ restitution = 1, surfaces = true }"
FRAMES = 16  # of the end, whose mean is taken: what vibrates is averaged


def last_frames(ended):
    """Places and fields of the last frames of a run, in the order of ids."""
    frames = [Frame(path, time) for time, path in ended.series()[-FRAMES:]]
    return [{"place": f.x, **f.arrays} for f in frames]


def measure(ended, spacing):
    frames = last_frames(ended)
    upper = frames[0]["phase"] == 0
    mean = {name: np.mean([f[name][upper] for f in frames], axis=0) for name in ("place", "contact_force", "principal_stress")}
    loads = [float(f["contact_force"][upper, 1].sum()) for f in frames]
    load = float(np.mean(loads))
    b = np.sqrt(4 * load * (RADIUS / 2) / (np.pi * STEEP))
    p0 = 2 * load / (np.pi * b)
    touching = np.where(np.hypot(*mean["contact_force"][:, :2].T) > 1e-6 * load)[0]
    touching = touching[np.argsort(mean["place"][touching, 0])]
    x, force = mean["place"][touching, 0], mean["contact_force"][touching, 1]
    centre = float((force * x).sum() / load)
    x = x - centre
    pressure = force / np.gradient(x)  # a particle's share of the surface: to the middles between it and its neighbours
    inside = pressure > 0.2 * pressure.max()
    square, slope = np.linalg.lstsq(np.stack([np.ones(inside.sum()), -x[inside]**2], 1), pressure[inside]**2, rcond=None)[0]
    axis = np.abs(mean["place"][:, 0]) < 0.6 * spacing
    depth = mean["place"][axis, 1] - float(mean["place"][touching, 1].min()) + 0.5 * spacing  # from the surface
    stress = mean["principal_stress"][axis, 2]
    near = depth < 2 * b
    order = np.argsort(depth[near])
    depth, stress = depth[near][order], stress[near][order]
    share = -stress / p0 * np.sqrt(1 + (depth / b)**2)
    below = depth > 2 * spacing
    return {"count": round(RADIUS / spacing), "load": load, "unrest": float(np.std(loads) / load), "b": float(b), "p0": float(p0), "in b": float(b / spacing),
            "moment": float(2 * np.sqrt((force * x**2).sum() / load) / b), "width": float(np.sqrt(square / slope) / b), "farthest": float(np.abs(x).max() / b),
            "peak": float(np.sqrt(square) / p0), "largest": float(pressure.max() / p0), "outer": float(share[~below].min()),
            "axis": [float(share[below].min()), float(share[below].max())],
            "profile": [(x / b).tolist(), (pressure / p0).tolist()], "below": [(depth / b).tolist(), (-stress / p0).tolist()]}


def hertz(program):
    table = []
    for count, speed, surfaces in ((20, None, False), (40, None, False), (80, None, False), (80, GENTLE, False),
                                   (20, None, True), (40, None, True), (80, None, True)):
        with tempfile.TemporaryDirectory(prefix="barchan_hertz_") as folder:
            sets = [f"spacing={RADIUS / count!r}"] + [SURFACES] * surfaces
            if speed:
                sets += [f'motion.{k}.velocity=[0, "{sign}(t < 0.02)*{speed}*(1 - cos(2*pi*t/0.02))"]' for k, sign in ((0, "-"), (1, ""))]
            table.append(measure(run.scene(program, "verification/hertz", folder, sets, shown=True), RADIUS / count) | {"surfaces": surfaces})
    return {"table": table}


RINGS, WIDE = 4, 1.25  # rings of equal area, as far as the radius whose square is WIDE a^2


def measure_spheres(ended, spacing):
    """Surfaces of particles that do not meet place for place: a single particle's force is noise, those of rings and their moments are not."""
    frames = last_frames(ended)
    upper = frames[0]["phase"] == 0
    place, force = (np.mean([f[name][upper] for f in frames], axis=0) for name in ("place", "contact_force"))
    loads = [float(f["contact_force"][upper, 1].sum()) for f in frames]
    load = float(np.mean(loads))
    a = (3 * load * (RADIUS / 2) / (4 * STEEP))**(1 / 3)
    p0 = 3 * load / (2 * np.pi * a**2)
    touching = np.abs(force[:, 1]) > 1e-6 * load
    place, force = place[touching][:, [0, 2]], force[touching][:, 1]
    r = np.hypot(*(place - (force[:, None] * place).sum(0) / load).T)
    edges = a * np.sqrt(np.linspace(0, WIDE, RINGS + 1))
    pressure = np.array([force[(r >= low) & (r < high)].sum() / (np.pi * edges[1]**2) for low, high in zip(edges, edges[1:])])
    middle = np.sqrt((edges[:-1]**2 + edges[1:]**2) / 2)
    inside = pressure > 0.2 * pressure.max()
    square, slope = np.linalg.lstsq(np.stack([np.ones(inside.sum()), -middle[inside]**2], 1), pressure[inside]**2, rcond=None)[0]
    return {"count": round(RADIUS / spacing), "load": load, "unrest": float(np.std(loads) / load), "a": float(a), "p0": float(p0), "in a": float(a / spacing),
            "touching": int(touching.sum()), "moment": float(np.sqrt(2.5 * (force * r**2).sum() / load) / a), "width": float(np.sqrt(square / slope) / a),
            "farthest": float(r.max() / a), "peak": float(np.sqrt(square) / p0),
            "inner": float(force[r < 0.6 * a].sum() / (load * (1 - 0.64**1.5))), "rings": [(middle / a).tolist(), (pressure / p0).tolist()]}


def hertz_spheres(program):
    table = []
    for count, surfaces in ((10, False), (20, False), (40, False), (10, True), (20, True), (40, True)):
        with tempfile.TemporaryDirectory(prefix="barchan_hertz_") as folder:
            sets = [f"spacing={RADIUS / count!r}"] + [SURFACES] * surfaces
            ended = run.scene(program, "verification/hertz_spheres", folder, sets, shown=True)
            table.append(measure_spheres(ended, RADIUS / count) | {"surfaces": surfaces})
    return {"table": table}


CASES = {"hertz": hertz, "hertz_spheres": hertz_spheres}


def name_of(row):
    return f"{row['count']}{', by surfaces' if row.get('surfaces') else ''}"


def page(results):
    return page_of_discs(results) + page_of_spheres(results)


def page_of_spheres(results):
    if "hertz_spheres" not in results:
        return []
    lines = ["### Two elastic spheres pressed together (Hertz)", "",
             "| particles a radius | P [N] | a/R | p_0/E | spacings in a | particles that touch | width over a: by the second moment | by the fit | farthest that touches "
             "| peak over p_0, by the fit | pressure inside 0.6 a over the exact one |",
             "| --- |" + " --- |" * 10]
    lines += [f"| {name_of(r)} | {r['load']:.2f} | {r['a'] / RADIUS:.3f} | {r['p0'] / YOUNG:.3f} | {r['in a']:.1f} | {r['touching']} | {r['moment']:.3f} | "
              f"{r['width']:.3f} | {r['farthest']:.3f} | {r['peak']:.3f} | {r['inner']:.3f} |" for r in results["hertz_spheres"]["table"]]
    return lines + [""]


def page_of_discs(results):
    if "hertz" not in results:
        return []
    lines = ["### Two elastic discs pressed together (Hertz)", "",
             "| particles a radius | P [N/m] | b/R | p_0/E | spacings in b | width over b: by the fit | by the second moment | farthest that touches "
             "| peak over p_0: by the fit | largest of a particle | stress on the axis over the exact one, from 2 spacings to 2 b deep | in the two outermost layers |",
             "| --- |" + " --- |" * 11]
    lines += [f"| {name_of(r)} | {r['load']:.0f} | {r['b'] / RADIUS:.3f} | {r['p0'] / YOUNG:.3f} | {r['in b']:.1f} | {r['width']:.3f} | {r['moment']:.3f} | "
              f"{r['farthest']:.3f} | {r['peak']:.3f} | {r['largest']:.3f} | {r['axis'][0]:.3f} to {r['axis'][1]:.3f} | {r['outer']:.2f} at least |"
              for r in results["hertz"]["table"]]
    lines += ["", "![Pressure in the contact of two discs, and stress below it](gallery/impacts_hertz.png)", ""]
    return lines


def plot(result, gallery, pyplot):
    figure, (left, right) = pyplot.subplots(1, 2, figsize=(9, 3.4), layout="constrained")
    x, z = np.linspace(-1, 1, 201), np.linspace(0, 2, 101)
    left.plot(x, np.sqrt(1 - x**2), "--", color="black", label="Hertz")
    right.plot(1 / np.sqrt(1 + z**2), z, "--", color="black")
    for r, colour, mark in zip(result["table"], ("#0072B2", "#D55E00", "#009E73"), ("o", "s", ".")):
        left.plot(*r["profile"], mark, color=colour, markersize=4, label=f"{r['count']} a radius")
        right.plot(r["below"][1], r["below"][0], mark, color=colour, markersize=4)
    left.set(xlabel="x/b", ylabel="pressure of the contact over p_0")
    right.set(xlabel="stress on the axis over -p_0", ylabel="depth/b", xlim=(0, 1.1))
    right.invert_yaxis()
    left.legend(loc="lower center", bbox_to_anchor=(.5, 1.), ncol=2, frameon=False)
    figure.savefig(gallery / "impacts_hertz.png", dpi=110)
