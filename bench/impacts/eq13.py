"""Energy of an impact with viscosity (eq. 13 of Halik et al. 2015): a case of bench/impacts/cases.py, its table on docs/impacts.md."""

import pathlib
import tempfile

from barchan_bench import run
from barchan_bench.frame import table as columns

UPDATED = [f'phases.{p}={{ kind = "elastic", formulation = "updated-lagrangian", density = 7870, young = 206e9, poisson = 0.3, artificial-viscosity = 0.2, '
           "energy = true }" for p in "ab"]
PLAIN = [f"phases.{p}.artificial-viscosity=0" for p in "ab"]
BARS = UPDATED + ['interactions={ kernel = "cubic-spline", a-a = 2.4, b-b = 2.4, a-b = 1.0 }']
RUNS = {"cubes, one spacing between them (figure 7b)": ("paper/impact_cubes.toml", []),
        "the same without viscosity": ("paper/impact_cubes.toml", PLAIN),
        "cubes, 2.4 spacings everywhere (figure 6b)": ("paper/impact_cubes.toml", ["interactions.a-b=2.4"]),
        "two bars, 40 a length": ("verification/two_bars.toml", BARS),
        "the same bars without viscosity": ("verification/two_bars.toml", BARS + PLAIN)}


def measure(path):
    rows = columns(path).rows()
    total = lambda what: [sum(row[f"{p}_{what}_energy"] for p in "ab") for row in rows]
    motion, internal, strain = total("kinetic"), total("internal"), total("strain")
    start = motion[0]
    return {"kept": max(abs(k + e - start) for k, e in zip(motion, internal)) / start, "motion": motion[-1] / start, "strain": max(strain) / start,
            "rest": (internal[-1] - strain[-1]) / start, "apart": max(abs(e - s) for e, s in zip(internal, strain)) / start}


def eq13(program):
    table = {}
    for name, (scene, sets) in RUNS.items():
        with tempfile.TemporaryDirectory(prefix="barchan_eq13_") as folder:
            run.scene(program, scene, folder, sets, shown=True)
            table[name] = measure(pathlib.Path(folder) / "history.csv")
    return {"table": table}


CASES = {"eq13": eq13}


def page(results):
    if "eq13" not in results:
        return []
    lines = ["### Energy of an impact with viscosity (eq. 13)", "",
             "| run | largest change of kinetic + internal energy | kinetic energy at the end | largest strain energy | internal less strain energy at the end | at most |",
             "| --- |" + " --- |" * 5]
    lines += [f"| {name} | {r['kept']:.1e} | {r['motion']:.4f} | {r['strain']:.3f} | {r['rest']:.1e} | {r['apart']:.1e} |" for name, r in results["eq13"]["table"].items()]
    return lines + ["", "All over the kinetic energy of the start.", ""]
