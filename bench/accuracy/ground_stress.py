"""The stress of the ground over a low, rough hill (scenes/verification/rough_hill.toml) beside linear theories (linear_hill.py).

    /usr/bin/python3 bench/accuracy/ground_stress.py BARCHAN [SPACING ...]

Writes docs/gallery/ground_stress.png and bench/accuracy/results/ground_stress.csv; prints a table.
"""
import pathlib
import sys
import tempfile

import numpy

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))  # bench/
from barchan_bench import ROOT, frame, page, run, store, table
from linear_hill import jackson_hunt, mixing_length, over_hill

PERIOD, DEPTH, LENGTH, ROUGHNESS, STRESS = 10.0, 1.5, 1.0, 1e-3, 0.196  # of the scene; m, m, m, m, Pa


def hill(x):
    return 0.05 / (1.0 + (x - 5.0) ** 2)


def measured(program, spacing, out):
    """Places, the stress along the surface over rho u*^2, and the seconds of the run."""
    ended = run.scene(program, "rough_hill", out, [f"spacing={spacing}"])
    t = frame.table(pathlib.Path(out) / "wall_shear_ground.csv")
    return t["x"], numpy.hypot(t["shear_stress_mean_x"], t["shear_stress_mean_y"]) * numpy.sign(t["shear_stress_mean_x"]) / STRESS, ended.seconds


def compare(name, spacing, x, stress, theory, bound, seconds):
    """The largest difference as a share of the largest change that the theory has, and the same of the crest's side."""
    change = numpy.max(numpy.abs(theory - 1.0))
    case = "rough hill, H/L = 0.05"
    table.report(case, "consistent", round(LENGTH / spacing), f"largest |tau - tau of {name}|/(rho u*^2)", numpy.max(numpy.abs(stress - theory)), bound, seconds)
    table.report(case, "consistent", round(LENGTH / spacing), f"the same over the largest change of {name}, {change:.3f}", numpy.max(numpy.abs(stress - theory)) / change, bound, seconds)
    table.report(case, "consistent", round(LENGTH / spacing), f"largest tau over that of {name}, less 1", stress.max() / theory.max() - 1.0, bound, seconds)


def main(program, spacings):
    figure, axes = page.pyplot().subplots(figsize=(8, 4.6))
    fine = numpy.linspace(0.0, PERIOD, 401)
    theories = {"the linear equations": lambda k: mixing_length(k, ROUGHNESS, DEPTH),
                "Jackson & Hunt": lambda k: jackson_hunt(k, LENGTH, ROUGHNESS, DEPTH)}
    curves = {name: over_hill(fine, PERIOD, hill, transfer) for name, transfer in theories.items()}
    for (name, curve), colour, style in zip(curves.items(), (page.BLACK, page.ORANGE), ("-", "--")):
        axes.plot(fine - 5.0, curve, style, color=colour, label=name)
    for spacing, colour, mark in zip(spacings, (page.BLUE, page.VERMILION, page.GREEN), "osv"):
        with tempfile.TemporaryDirectory() as out:
            x, stress, seconds = measured(program, spacing, out)
        axes.plot(x - 5.0, stress, mark, color=colour, markersize=3, label=f"Barchan, {round(LENGTH / spacing)} spacings in L")
        for name, curve in curves.items():
            compare(name, spacing, x, stress, numpy.interp(x, fine, curve), 0.1, seconds)
    axes.set(xlabel="x/L, from the crest", ylabel="stress of the ground over rho u*$^2$", xlim=(-5, 5))
    axes.axhline(1.0, color="0.7", linewidth=0.8)
    axes.legend(loc="upper right", fontsize=8)
    figure.tight_layout()
    figure.savefig(ROOT / "docs/gallery/ground_stress.png", dpi=110)
    store.keep(pathlib.Path(__file__).resolve().parent / "results/ground_stress.csv", table.rows)


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    main(sys.argv[1], [float(s) for s in sys.argv[2:]] or [0.025])
