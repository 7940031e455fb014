"""Rows of flows: from bench/accuracy/results. What each figure is compared with is in SOURCES by case; figures that are no comparison are not taken."""

from ledger_rows import load, row

# A file of results: the source of its reference.
SOURCES = {
    "abc": "exact solution of the Navier-Stokes equations; Dombre et al. 1986, J. Fluid Mech. 167, 353",
    "backward-step": "Erturk 2008, Computers & Fluids 37, 633: reattachment by Re, expansion ratio 2",
    "cavity": "Ghia, Ghia & Shin 1982, J. Comput. Phys. 48, 387, tables I and II",
    "couette": "series of Batchelor 1967; numbers of Morris, Fox & Zhu 1997, J. Comput. Phys. 136, 214",
    "poiseuille": "series of Batchelor 1967; numbers of Morris, Fox & Zhu 1997, J. Comput. Phys. 136, 214",
    "cylinder": "range of Dennis & Chang 1970, Williamson 1989, Park et al. 1998, Posdziech & Grundmann 2007; blockage by Allen & Vincenti 1944",
    "dam-break": "Martin & Moyce 1952, Phil. Trans. R. Soc. A 244, 312, table 2, n^2 = 2",
    "dam-break-3d": "Martin & Moyce 1952, Phil. Trans. R. Soc. A 244, 312, table 2, n^2 = 2",
    "logarithmic-layer": "law of the wall, u = u*/0.4 ln(y/z0); von Karman 1930, Prandtl 1932",
    "low-hill": "potential flow over 0.1/(1 + x^2), computed by the bench to rounding (bench/accuracy/cases_walls.py)",
    "square-patch": "Colagrossi 2005; Le Touze et al. 2013, Int. J. Numer. Methods Fluids 73, 660; free flight of the corners: exact",
    "standing-wave": "Lamb 1932, Hydrodynamics, section 228",
    "still-tank": "hydrostatics: nothing moves (exact)",
    "taylor-green": "exact solution; Taylor & Green 1937, Proc. R. Soc. A 158, 499",
    "taylor-green-1000": "exact solution; Taylor & Green 1937, Proc. R. Soc. A 158, 499",
    "two-phase-column": "hydrostatics: nothing moves, dp/dy = -rho g in each fluid (exact)",
    "waves": "formula of the lattice, and exp(-nu k^2 t): linear theory, derived in bench/accuracy/cases_periodic.py",
    "whole-fluids": "steady solutions of the Euler equations: Gresho & Chan 1990, Int. J. Numer. Methods Fluids 11, 621; Taylor & Green 1937",
}
# The same of cases that --measure leaves out.
LONG = {
    "open-cylinder": "Dennis & Chang 1970, J. Fluid Mech. 42, 471 (Re 20); Park et al. 1998, Phys. Fluids 10, 345; Williamson 1989",
    "sinking-sphere": "Faxen's series for a sphere in a tube: Happel & Brenner 1983, section 7-3",
    "heaving-cylinder": "Ito 1977, thesis, MIT; linear theory: Maskell & Ursell 1970, J. Fluid Mech. 44, 303; Yeung 1982, J. Eng. Math. 16, 97",
    **{f"fsi{k}": "Turek & Hron 2006, in Fluid-Structure Interaction, Springer, p. 371, finest grids" for k in (1, 2, 3)},
    "wave-maker": "linear theory of the piston: Havelock 1929, Phil. Mag. 8, 569; Dean & Dalrymple 1991, section 6.3",
    "viscous-wave": "linear theory, solved by bench/accuracy/viscous_wave_reference.py: Prosperetti 1981, Phys. Fluids 24, 1217; Lamb 1932, section 349",
    "falling-film": "exact: Nusselt 1916, Z. VDI 60, 541; turbulent: the mixing length of Prandtl 1932, integrated",
    "sloshing": "Lamb 1932, Hydrodynamics, section 257; resonance: Faltinsen & Timokha 2009, Sloshing, chapter 5",
    "far-front": "Martin & Moyce 1952, Phil. Trans. R. Soc. A 244, 312, a = 2.25 in: n^2 = 1 by Xie 2021, arXiv:2108.08769; n^2 = 2, figure 3",
    "dam-pressure": "Buchner 2002, thesis, Delft, as TrixiParticles.jl keeps it; sensor 45 mm lower: Greco 2001, Adami et al. 2012",
    "dam-sensors": "Lobovsky et al. 2014, J. Fluids Struct. 48, 407, table 2; the record at 30 mm as PySPH keeps it",
    "elastic-gate": "Antoci, Gallati & Sibilla 2007, Comput. Struct. 85, 879, as Ng et al. 2020 draw it",
    "long-rest": "hydrostatics: nothing moves (exact)",
    "long-wave": "Lamb 1932, Hydrodynamics, section 228",
    "open-step": "bench/accuracy/step_reference.py, finite differences; for an expansion of 2 within 0.7 % of Erturk 2008, Computers & Fluids 37, 633",
    "backward-step-turbulent": "Fessler & Eaton 1999, J. Fluid Mech. 394, 97, as later papers quote it: back at 7.4 H",
}
# Figures that compare with nothing but themselves: parts of them are in their names.
OWN = ("Re of the flow", "x_r/S", "order from", "runs to the end", "measured places that the run saw", "least and largest", "omega t at the end",
       "least distance", "spread of the number", "angular momentum", "profile at the step", "/that of Taylor-Green in 2D", "as measured")
# A figure that is a value beside its reference, not an error.
VALUES = {("square-patch", "omega t = 0.5"): -.1330, ("square-patch", "omega t = 1.0"): -.1038, ("dam-break", "pressure at rest/hydrostatic"): 1.}


def rows(bench):
    """The rows of all files of SOURCES."""
    found = []
    for name, source in (SOURCES | LONG).items():
        file = f"accuracy/results/{name}.csv"
        for r in load(bench, file)["rows"]:
            made = one(name, r, source, file)
            if made:
                found.append(made)
    return [*found, *peers(bench)]


def peers(bench):
    """L1 of Taylor-Green vortices beside other codes: measured on one machine, and published by PySPH."""
    file = "accuracy/peers.csv"
    both = load(bench, file)
    ours = {n: error for s in both["measured"]["series"] if s["code"] == "Barchan" for n, error, _ in s["points"]}
    for s in both["measured"]["series"]:
        for n, error, _ in s["points"]:
            if s["code"] != "Barchan" and n in ours:
                yield row("L1 of the speed at t = 1, beside another code's", f"Taylor-Green, Re 100, {n} a side; {s['code']}, {s['scheme']}", error, ours[n],
                          f"{s['code']}, run beside Barchan on one machine in 2026 (bench/accuracy/peers.csv)", file)
    for name, errors in both["published"]["series"].items():
        for n, error in zip(both["published"]["sizes"], errors):
            if n in ours:
                yield row("L1 of the speed at t = 1, beside a published one", f"Taylor-Green, Re 100, {n} a side; {name}", error, ours[n],
                          "PySPH: Ramachandran et al. 2021, ACM Trans. Math. Softw. 47, 34, and its automated runs", file)


def one(name, r, source, file):
    """The row of one figure, None for one that compares with nothing."""
    what, value = r["what"], r["value"]
    if any(part in what for part in OWN) and r["good"]:   # a figure that misses its bound is never left out
        return None
    what = what.replace("the same with the measured clock", "front against 15 measured places, with the measured clock")
    if "total energy" in what:
        source = "conservation of energy: nothing adds to it (exact)"
    case = f"{r['case']}, {r['scheme']}, N = {r['n']:g}"
    reference = next((wanted for (of, part), wanted in VALUES.items() if of == name and part in what), None)
    if reference is not None:
        return row(what, case, reference, float(value), source, file)
    if what == "amplitude of the lift coefficient":   # told beside the literature's range, which it misses; nothing was asked of it
        return row(what, case, "0.32 to 0.34", float(value), source, file, bias=100 * (float(value) / .34 - 1))
    if what == "runs to the end":  # it broke down
        return row("runs that came to their end, of one", case, 1, 0., source, file, bound=">= 1", met=False)
    if isinstance(value, str):
        try:
            value = float(value)
        except ValueError:
            return None
        if what.startswith("highest particle") or what.startswith("largest error of the pressure"):
            return row(what, case, 0, value, source, file)
        return None
    bound = r["bound"]
    if bound is None:
        if what.startswith("amplitude that a period takes"):
            return row(what, case, 0, value, source, file)
        return None
    words = f"{'>=' if r['at_least'] else '<='} {bound:g}"
    return row(what, case, 0, value, source, file, bound=words, met=r["good"])
