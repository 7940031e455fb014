#!/usr/bin/python3
"""The air alone over the dune of scenes/dune.toml, as particles and as finite volumes (OpenFOAM): speed-up, stress on the ground, bubble.

    /usr/bin/python3 bench/saltation/dune_reference.py build/barchan [--out DIR]     7 minutes of one core; finite volumes where blockMesh and simpleFoam are (Debian: openfoam)

Rough ground, z0 = 0.4 mm, u* = 0.5 m/s, ends as in the scene. Particles: k-omega (Wilcox 2006), 5 mm everywhere, and 2.5 mm below 7 cm; means of 0.4 to 0.6 s. Finite volumes, steady:
OpenFOAM 1912, kOmega (Wilcox 1998) and kOmegaSST, 330 x 64 cells, 1.7 mm high at the ground, nutkAtmRoughWallFunction, a stress of rho u*^2 on the lid.
"""
import argparse
import os
import pathlib
import re
import shutil
import sys
import tomllib

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from barchan_bench import ROOT, run, store  # noqa: E402
from barchan_bench.frame import Frame, series, table  # noqa: E402
from tunnel import Ground  # noqa: E402

RESULT = ROOT / "bench/saltation/results/dune_reference.csv"
LENGTH, TOP, U, Z0, KAPPA, NU, DENSITY = 0.66, 0.255, 0.5, 4e-4, 0.4, 1.48e-5, 1.225  # m, m, m/s, m, -, m2/s, kg/m3
ABOVE, FROM, TO = 0.01, 0.4, 0.6  # m over the ground, of the speed-up; s
LOW = 0.0025                      # m over the ground, where the air is looked at for reversal
PLACES = (0.01, 0.05, 0.1, 0.14, 0.158, 0.17, 0.2, 0.22, 0.24, 0.26, 0.28, 0.295, 0.31, 0.36, 0.4, 0.45, 0.5, 0.55, 0.6, 0.65)  # m, of the stress
NX, NY, GRADE = 330, 64, 3.0
MODELS = {"kOmega": "finite volumes, k-omega (Wilcox 1998)", "kOmegaSST": "finite volumes, k-omega SST"}


def scene_of(ground, spacing):
    """The text of the scene of the air alone."""
    dune = f'{{ form = "asymmetric", slip-face-angle = {ground.angle}, height = {ground.height_of_dune}, length = {ground.windward + ground.lee:g}, at = {ground.crest} }}'
    levels = [("air", spacing, 0.0, TOP)] if spacing == 5e-3 else [("air", spacing, 0.0, 0.07), ("above", 5e-3, 0.07, TOP)]
    wind = f"{{ log-profile = {{ friction-velocity = {U}, roughness = {Z0}"
    lines = [f"dimensions = 2\nspacing = {spacing}\n[domain]\nsize = [{LENGTH}, {TOP}]"]
    for name, dx, _, _ in levels:
        lines.append(f'[phases.{name}]\nkind = "fluid"\ndensity = {DENSITY}\nviscosity = {NU}\nsound-speed = 75\nturbulence = "k-omega"\nspacing = {dx}')
    lines.append(f'[phases.ground]\nkind = "wall"\nroughness = {Z0}\n[phases.lid]\nkind = "wall"\nshear-stress = [{DENSITY * U * U}, 0]\nspacing = 5e-3\n[interactions]')
    for name, *_ in levels:
        lines.append(f"{name}-{name} = 2.1\n{name}-ground = 2.1\n{name}-lid = {'2.1' if name == levels[-1][0] else 'false'}")
    if len(levels) > 1:
        lines.append('air-above = { radius = 2.1, border = "y - 0.07" }')
    lines.append(f'[[fill]]\nphase = "ground"\nshape = {{ bed = {ground.bed}, dune = {dune} }}\npacking = "fitted"\n[[fill]]\nphase = "lid"\nshape = {{ sides = ["top"] }}')
    for name, _, low, high in levels[1:]:
        lines.append(f'[[fill]]\nphase = "{name}"\nshape = {{ box = {{ min = [0, {low}], max = [{LENGTH}, {high}] }} }}\nvelocity = {wind} }} }}')
    lines.append(f'[[fill]]\nphase = "air"\nshape = "the-rest"\npacking = "fitted"\nvelocity = {wind}, along-ground = true }} }}')
    for name, *_ in levels:
        lines.append(f'[[inflow]]\nphase = "{name}"\nside = "left"\nvelocity = {wind} }} }}\n[[outflow]]\nphase = "{name}"\nside = "right"' + ("\nlayer = 0.1" if len(levels) > 1 else ""))
    lines.append(f'[[wall-shear]]\nname = "ground"\nphase = "air"\nwall = "ground"\nevery = 2e-3\nstart = {FROM}\n[time]\nend = {TO}\n[output]\nevery = 5e-3\nhistory-every = 1e-2\nwalls = false')
    return "\n".join(lines) + "\n", [name for name, *_ in levels]


def row(method, ground, at, stress):
    """`at(x, z)`: wind along x (m/s); `stress(x)`: Pa over rho u*^2."""
    behind = np.arange(ground.crest, LENGTH - 0.005, 0.004)
    low = np.array([at(x, LOW) for x in behind])
    back = np.nonzero(low < 0)[0]
    return {"method": method, "upstream_m_s": at(ground.toe - 0.1, ABOVE), "crest_m_s": at(ground.crest, ABOVE), "speed_up": at(ground.crest, ABOVE) / at(ground.toe - 0.1, ABOVE) - 1,
            "bubble_over_H": float(behind[back[-1]] - ground.crest) / ground.height_of_dune if len(back) else 0.0, "slowest_m_s": float(np.nanmin(low)), "stress": [round(stress(x), 3) for x in PLACES]}


def particles(program, out, ground, spacing):
    text, names = scene_of(ground, spacing)
    out.mkdir(parents=True, exist_ok=True)
    file = out / f"dune_air_{1e3 * spacing:g}mm.toml"
    file.write_text(text)
    folder = out / file.stem
    if not (folder / "wall_shear_ground.csv").exists():
        run.scene(program, file, folder, [], threads=1)
    air = np.concatenate([np.column_stack([f.x[:, :2], f["velocity"][:, 0]]) for t, path in series(next(folder.glob("*.pvd"))) if FROM <= t <= TO for f in (Frame(path, phase=n) for n in names)])
    height = air[:, 1] - ground.height(air[:, 0])

    def at(x, z):
        near = (np.abs(air[:, 0] - x) < 0.005) & (np.abs(height - z) < max(0.7 * spacing, 1.25e-3))
        return float(np.polyfit(height[near] - z, air[near, 2], 1)[1])
    wall = table(folder / "wall_shear_ground.csv")
    stress = np.hypot(wall["shear_stress_mean_x"], wall["shear_stress_mean_y"]) * np.sign(wall["shear_stress_mean_x"]) / (DENSITY * U * U)
    return row(f"particles of {1e3 * spacing:g} mm, k-omega (Wilcox 2006)", ground, at, lambda x: float(np.interp(x, wall["x"], stress)))


def head(kind, name):
    return f"FoamFile {{ version 2.0; format ascii; class {kind}; object {name}; }}\n"


def case(folder, ground, model):
    """Writes a case of OpenFOAM."""
    for part in ("0", "constant", "system"):
        (folder / part).mkdir(parents=True, exist_ok=True)
    x = np.linspace(0, LENGTH, 661)
    y, bed = ground.height(x), ground.bed

    def line(z):
        return " ".join(f"({a:.6f} {b:.7f} {z})" for a, b in zip(x[1:-1], y[1:-1]))
    corners = " ".join(f"({a} {b} {z})" for z in (0, 0.01) for a, b in ((0, bed), (LENGTH, bed), (LENGTH, TOP), (0, TOP)))
    (folder / "system/blockMeshDict").write_text(head("dictionary", "blockMeshDict") + f"""scale 1;
vertices ({corners});
blocks (hex (0 1 2 3 4 5 6 7) ({NX} {NY} 1) simpleGrading (1 {GRADE} 1));
edges (polyLine 0 1 ({line(0)}) polyLine 4 5 ({line(0.01)}));
boundary (inlet {{ type patch; faces ((0 4 7 3)); }} outlet {{ type patch; faces ((1 2 6 5)); }} ground {{ type wall; faces ((0 1 5 4)); }}
lid {{ type patch; faces ((3 7 6 2)); }} sides {{ type empty; faces ((0 3 2 1) (4 5 6 7)); }});
""")
    step = (GRADE ** (1 / (NY - 1))) ** np.arange(NY)
    faces = np.concatenate([[0], np.cumsum(step)]) / step.sum() * (TOP - bed)
    z = 0.5 * (faces[1:] + faces[:-1])
    wind, omega, k = U / KAPPA * np.log((z + Z0) / Z0), U / (0.3 * KAPPA * (z + Z0)), U * U / 0.3

    def many(kind, values):
        return f"nonuniform List<{kind}> {len(values)} (" + " ".join(f"({v:g} 0 0)" if kind == "vector" else f"{v:g}" for v in values) + ")"
    fields = {"U": ("volVectorField", "[0 1 -1 0 0 0 0]", "uniform (4 0 0)", f"type fixedValue; value {many('vector', wind)};", "type inletOutlet; inletValue uniform (0 0 0); value uniform (4 0 0);",
                    "type noSlip;", f"type fixedShearStress; tau ({U * U} 0 0); value uniform ({wind[-1]:g} 0 0);"),
              "p": ("volScalarField", "[0 2 -2 0 0 0 0]", "uniform 0", "type zeroGradient;", "type fixedValue; value uniform 0;", "type zeroGradient;", "type zeroGradient;"),
              "k": ("volScalarField", "[0 2 -2 0 0 0 0]", f"uniform {k}", f"type fixedValue; value uniform {k};", "type zeroGradient;", f"type kqRWallFunction; value uniform {k};", "type zeroGradient;"),
              "omega": ("volScalarField", "[0 0 -1 0 0 0 0]", "uniform 100", f"type fixedValue; value {many('scalar', omega)};", "type zeroGradient;", "type omegaWallFunction; value uniform 100;",
                        f"type fixedValue; value uniform {U / (0.3 * KAPPA * (TOP - bed + Z0)):g};"),
              "nut": ("volScalarField", "[0 2 -1 0 0 0 0]", "uniform 0.01", *["type calculated; value uniform 0.01;"] * 2, f"type nutkAtmRoughWallFunction; z0 uniform {Z0}; value uniform 0.001;",
                      "type calculated; value uniform 0.01;")}
    for name, (kind, unit, inside, *sides) in fields.items():
        patches = " ".join(f"{patch} {{ {text} }}" for patch, text in zip(("inlet", "outlet", "ground", "lid"), sides))
        (folder / "0" / name).write_text(head(kind, name) + f"dimensions {unit}; internalField {inside};\nboundaryField {{ {patches} sides {{ type empty; }} }}\n")
    texts = {"constant/transportProperties": f"transportModel Newtonian; nu {NU};", "constant/turbulenceProperties": f"simulationType RAS; RAS {{ RASModel {model}; turbulence on; printCoeffs off; }}",
             "system/controlDict": "application simpleFoam; startFrom startTime; startTime 0; stopAt endTime; endTime 4000; deltaT 1; writeControl timeStep; writeInterval 4000; purgeWrite 1; "
             "writeFormat ascii; writePrecision 8;",
             "system/fvSchemes": "ddtSchemes { default steadyState; } gradSchemes { default Gauss linear; } divSchemes { default none; div(phi,U) bounded Gauss linearUpwind grad(U); "
             "div(phi,k) bounded Gauss limitedLinear 1; div(phi,omega) bounded Gauss limitedLinear 1; div((nuEff*dev2(T(grad(U))))) Gauss linear; } laplacianSchemes { default Gauss linear corrected; } "
             "interpolationSchemes { default linear; } snGradSchemes { default corrected; } wallDist { method meshWave; }",
             "system/fvSolution": "solvers { p { solver GAMG; smoother GaussSeidel; tolerance 1e-8; relTol 0.05; } \"(U|k|omega)\" { solver smoothSolver; smoother symGaussSeidel; tolerance 1e-9; relTol 0.05; } } "
             "SIMPLE { consistent yes; nNonOrthogonalCorrectors 1; residualControl { p 2e-6; U 2e-6; } } relaxationFactors { equations { U 0.7; k 0.6; omega 0.6; } fields { p 0.4; } }"}
    for name, text in texts.items():
        (folder / name).write_text(head("dictionary", name.split("/")[1]) + text + "\n")


def values(text, after, width):
    """Those of a list of OpenFOAM behind a word."""
    begin = text.index("(\n", text.index(after)) + 2
    return np.array(re.findall(r"[-+0-9.eE]+", text[begin:text.index("\n)\n", begin)]), float).reshape(-1, width)


def volumes(out, ground, model):
    folder = out / model
    if not any(p.name.isdigit() and p.name != "0" for p in folder.glob("*")):
        case(folder, ground, model)
        etc = pathlib.Path("/usr/share/openfoam")
        environment = dict(os.environ, WM_PROJECT_DIR=str(etc), FOAM_ETC=str(etc / "etc"))
        for command in (["blockMesh"], ["simpleFoam"], ["simpleFoam", "-postProcess", "-func", "wallShearStress", "-latestTime"]):
            run.command(command, environment=environment, folder=folder, check=True)
    last = max((p for p in folder.iterdir() if p.name.isdigit()), key=lambda p: int(p.name))
    u = values((last / "U").read_text(), "internalField", 3)[:, 0].reshape(NY, NX)
    tau = -values((last / "wallShearStress").read_text(), "    ground", 3) / (U * U)
    x, step = (np.arange(NX) + 0.5) * LENGTH / NX, (GRADE ** (1 / (NY - 1))) ** np.arange(NY)
    faces = np.concatenate([[0], np.cumsum(step)]) / step.sum()
    share, room = 0.5 * (faces[1:] + faces[:-1]), TOP - ground.height(x)

    def at(place, z):
        k = int(np.argmin(np.abs(x - place)))
        return float(np.interp(z, share * room[k], u[:, k]))
    stress = np.hypot(tau[:, 0], tau[:, 1]) * np.sign(tau[:, 0])
    return row(MODELS[model], ground, at, lambda place: float(np.interp(place, x, stress)))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("barchan", type=pathlib.Path)
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("/tmp/barchan_dune_reference"))
    options = parser.parse_args()
    ground = Ground(tomllib.loads((ROOT / "scenes/dune.toml").read_text()))
    rows = [particles(options.barchan.resolve(), options.out, ground, spacing) for spacing in (5e-3, 2.5e-3)]
    if shutil.which("simpleFoam"):
        rows += [volumes(options.out, ground, model) for model in MODELS]
    for one in rows:
        print(one)
    store.keep(RESULT, {"places": list(PLACES), "rows": rows})


if __name__ == "__main__":
    main()
