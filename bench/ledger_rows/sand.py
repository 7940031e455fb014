"""Rows of wind and sand: from bench/saltation/results, bench/paper/results and bench/grains/results."""

from ledger_rows import load, row, within

CREYSSELS = "Creyssels et al. 2009, J. Fluid Mech. 625, 47 (wind tunnel, +- 5 %)"
RICE = "Rice, Willetts & McEwan 1995, Sedimentology 42, 695: medium sand, means"
SHAO_LU = "Shao & Lu 2000, J. Geophys. Res. 105, 22437"
HEAPS = "Lube et al. 2005, Phys. Rev. E 72, 041301; Lajeunesse, Monnier & Homsy 2005, Phys. Fluids 17, 103302"
LAWS = {"schiller-naumann": "Schiller & Naumann 1933", "cheng": "Cheng 1997", "duran": "Duran, Andreotti & Claudin 2012", "di-felice": "Di Felice 1994"}


def mean(values):
    return sum(values) / len(values)


def half_range(values):
    return (max(values) - min(values)) / 2 if len(values) > 1 else None


def grains_in_air(bench):
    file = "saltation/results/settling.csv"
    r = load(bench, file)
    for t in r["terminal"]:
        if t["d"] in (.1, .25, 1.):
            yield row("speed of fall, m/s", f"{t['d']:g} mm, drag {t['law']}", t["exact"], t["measured"],
                      f"m g = drag, by bisection (exact); drag of {LAWS[t['law']]}", file)
    for t in r["transient"]:
        yield row(f"speed after {t['t']:g} s, m/s", "0.25 mm from rest, drag schiller-naumann", t["reference"], t["measured"],
                  "integration with a fine step; drag of Schiller & Naumann 1933", file)
    file = "saltation/results/hop.csv"
    for t in load(bench, file)["hops"]:
        case = f"hop, u* = {t['u']:g} m/s, start {t['v']:g} m/s at {t['degrees']} degrees"
        for name, key in (("length, m", "length"), ("height, m", "apex"), ("time, s", "time"), ("speed at the end, m/s", "speed")):
            yield row(name, case, t["reference"][key], t["measured"][key], "integration with a fine step in a logarithmic wind; drag of Schiller & Naumann 1933",
                      file)


def splash(bench):
    file = "saltation/results/splash.csv"
    r = load(bench, file)
    rice = r["rice"]
    for bed in r["beds"]:
        for t in bed["levels"]:
            case = f"{'3D bed' if bed['dimensions'] == 3 else 'slab'}, counted above {t['level']:g} d, {t['impacts']} impacts"
            ratio = t["ejecta"] / rice["ejecta"]
            yield row("grains ejected an impact", case, rice["ejecta"], t["ejecta"], RICE, file, scatter=t["ejecta_error"], bound="factor 1.5",
                      met=1 / 1.5 <= ratio <= 1.5)
            share = t["ejection_speed"] / rice["speed"]
            yield row("speed of the ejected, m/s", case, rice["ejection_speed"], t["ejection_speed"], RICE, file, scatter=t.get("ejection_speed_error"),
                      bound="5 to 12 % of the impact's", met=.05 <= share <= .12)
            yield row("speed of the rebound over the impact's", case, rice["rebound"], t["rebound"], RICE, file, scatter=t["rebound_error"],
                      bound="within 0.1", met=abs(t["rebound"] - rice["rebound"]) <= .1)
            yield row("angle of the rebound, degrees", case, rice["rebound_angle"], t["rebound_angle"], RICE, file)


def threshold(bench):
    file = "saltation/results/threshold.csv"
    rows = load(bench, file)["rows"]
    for d in sorted({t["d"] for t in rows}):
        beds = [(t["low"] + t["high"]) / 2 for t in rows if t["d"] == d]
        reference = next(t["shao_lu"] for t in rows if t["d"] == d)
        bound, met = within(100 * (mean(beds) / reference - 1), 25)
        yield row("fluid threshold u*, m/s", f"{d:g} mm, mean of {len(beds)} beds", reference, mean(beds), SHAO_LU, file, scatter=half_range(beds),
                  bound=bound, met=met)
    file = "saltation/results/impact.csv"
    runs = load(bench, file)["runs"]
    alive = {u: [t["flux"] > .1 for t in runs if t["u"] == u] for u in sorted({t["u"] for t in runs})}
    dies, goes = max(u for u, beds in alive.items() if not any(beds)), min(u for u, beds in alive.items() if all(beds))
    middle, fluid = (dies + goes) / 2, .267
    yield row("impact threshold over the fluid threshold", "0.242 mm, column, two beds", "0.75 to 0.9", middle / fluid,
              "Bagnold 1941: about 0.8; " + SHAO_LU, file, scatter=(goes - dies) / 2 / fluid, bound="0.75 to 0.9", met=.75 <= middle / fluid <= .9,
              bias=100 * (middle / fluid / .8 - 1))


def flux(bench):
    for case, file in (("column", "saltation/results/flux.csv"), ("column in 3D", "saltation/results/flux-3d.csv")):
        runs = load(bench, file)["runs"]
        for u, most in ((.24, 35 if case == "column" else 15), (.40, 15), (.56, 15)):
            beds = [t for t in runs if t["u"] == u]
            measured = mean([t["flux"] for t in beds])
            bound, met = within(100 * (measured / beds[0]["creyssels"] - 1), most)
            scatter = max(half_range([t["flux"] for t in beds]) or 0, max(t["error"] for t in beds) / len(beds) ** .5)
            yield row("saturated flux, g/m/s", f"{case}, u* = {u:g} m/s, {'mean of ' if len(beds) > 1 else ''}{len(beds)} bed{'s' if len(beds) > 1 else ''}", beds[0]["creyssels"], measured,
                      CREYSSELS, file, scatter=scatter, bound=bound, met=met)
    file = "saltation/results/resolved.csv"
    runs = load(bench, file)["runs"]
    for u in sorted({t["u"] for t in runs}):
        beds = [t for t in runs if t["u"] == u]
        measured, wanted = mean([t["flux"] for t in beds]), beds[0]["creyssels"]
        bound, met = within(100 * (measured / wanted - 1), 30)
        inside = max(t["error"] for t in beds) / len(beds) ** .5
        yield row("saturated flux, g/m/s", f"resolved air, u* = {u:g} m/s, {len(beds)} bed{'s' if len(beds) > 1 else ''}", wanted, measured,
                  CREYSSELS + (", the line through its points" if u == .5 else ""), file,
                  scatter=max(half_range([t["flux"] for t in beds]) or 0, inside), bound=bound, met=met)


def heaps(bench):
    file = "saltation/results/heaps.csv"
    r = load(bench, file)
    angles = [t["angle"] for t in r["repose"]]
    yield row("angle of repose above the slot, degrees", f"hopper, {len(angles)} beds", "30 to 34", mean(angles), "dry sand: Carrigy 1970, Sedimentology 14, 147",
              file, scatter=half_range(angles), bound="30 to 34", met=30 <= mean(angles) <= 34, bias=100 * (mean(angles) / 32 - 1))
    for name, key, low, high in (("run-out of 99 % of the grains over L0", "front", 2.4, 3.6), ("run-out before the first gap over L0", "gap", 2.4, 3.6),
                                 ("height over L0", "height", .83, 1.32)):
        values = [t[key] for t in r["collapse"]]
        yield row(name, f"column of sand, a = 2, {len(values)} beds", f"{low:g} to {high:g}", mean(values), HEAPS, file, scatter=half_range(values),
                  bound=f"{low:g} to {high:g}", met=low <= mean(values) <= high, bias=100 * (2 * mean(values) / (low + high) - 1))


def storm(bench):
    file = "saltation/results/storm.csv"
    r = load(bench, file)
    yield row("momentum, rest over what is put in", "dune in air of held speed, 0.5 s", 0, r["share"], "conservation of momentum (exact)", file,
              bound="within 1 %", met=abs(r["share"]) <= .01)
    yield row("momentum, largest rest over what is put in", "dune in air of held speed, 0.5 s", 0, r["largest"], "conservation of momentum (exact)", file,
              bound="within 1 %", met=abs(r["largest"]) <= .01)


def paper(bench):
    file = "paper/results/figures.csv"
    r = load(bench, file)
    for k in r["kernels"]:
        yield row("integral of the cubic kernel", f"h = {k['h']:g}", 1, k["area"], "Monaghan & Lattanzio 1985; Halik et al. 2015, figure 3", file)
    for a in r["airflow"]:
        slope = a["crest"] / a["upstream"] - 1
        yield row("speed-up 1 mm over the crest", f"the paper's dune at {a['ms']:.1f} ms", 4 / 9, slope,
                  "rule 2 H/L of Jackson & Hunt 1975, Q. J. R. Meteorol. Soc. 101, 929, for a low hill without blockage; H = 2 mm, L = 9 mm", file)


def tunnel(bench):
    file = "saltation/results/tunnel.csv"
    runs = load(bench, file)["runs"]
    case = f"dune.toml, a dune of 3 cm in a wind tunnel, {len(runs)} run{'s' if len(runs) > 1 else ''}, means of 0.45 to 0.9 s"
    first = runs[0]

    def figure(quantity, reference, values, source, bound=None, met=None):
        return row(quantity, case, reference, mean(values), source, file, scatter=half_range(values), bound=bound, met=met)
    u_star = [r["u_star_upstream"] for r in runs]
    yield figure("u* of the wind 10 cm before the toe, m/s", .5, u_star, "the wind that enters: law of the wall over a saltating column", "within 10 %", abs(mean(u_star) / .5 - 1) <= .1)
    entering = first["wind_on_the_layers"][2]
    focus = [r["wind_on_the_layers"][1] for r in runs]
    yield figure("wind where the layers near the ground end, m/s", entering, focus, "column of saltating grains (scenes/saltation.toml), whose flux is compared with Creyssels et al. 2009", "within 10 %", abs(mean(focus) / entering - 1) <= .1)
    everything = [r["u_star_of_all_that_drives"] for r in runs]
    yield figure("u* of all that drives air and grains, m/s", .5, everything, "balance of momentum between 5 and 60 cm; the dune's own drag is in it", "within 5 %", abs(mean(everything) / .5 - 1) <= .05)
    flux_before = [r["flux_upstream"] for r in runs]
    yield figure("flux before the toe, g/m/s", 35, flux_before, CREYSSELS, "within 15 %", abs(mean(flux_before) / 35 - 1) <= .15)
    yield figure("speed-up 10 mm over the crest", first["speed_up_2H_over_L_and_blockage"], [r["speed_up_10_mm"] for r in runs], "rule 2 H/L of Jackson & Hunt 1975, with blockage")
    length = [r["reverse_length_over_H"] for r in runs]
    yield figure("reverse flow behind the crest, heights", 7, length, "4 to 10 heights behind the crest: Parsons et al. 2004 and field studies they compare with (recalled)", "4 to 10", 4 <= mean(length) <= 10)


def dune_air(bench):
    file = "saltation/results/dune_reference.csv"
    rows = load(bench, file)["rows"]
    volumes = [r for r in rows if r["method"].startswith("finite")]
    case = "the air alone over the dune of dune.toml, 2.5 mm, k-omega"
    fine = next(r for r in rows if "2.5 mm" in r["method"])
    for reference in volumes:
        bound, met = within(100 * (fine["speed_up"] / reference["speed_up"] - 1), 10)
        yield row("speed-up 10 mm over the crest", case, reference["speed_up"], fine["speed_up"], f"OpenFOAM 1912, {reference['method']}", file, bound=bound, met=met)
        yield row("reverse flow behind the crest, heights", case, reference["bubble_over_H"], fine["bubble_over_H"], f"OpenFOAM 1912, {reference['method']}", file)


def belt_and_stream(bench):
    file = "grains/results/belt_fence_stream.csv"
    r = load(bench, file)
    belt, stream, fence = r["belt"], r["stream"], r["fence"]
    yield row("rate through a slot, kg/m/s", "hopper_belt.toml, 14 diameters", belt["beverloo_kg_m_s"], belt["rate_kg_m_s"],
              "Beverloo, Leniger & van de Velde 1961, form and constants for a slot as in Nedderman 1992 (recalled)", file)
    yield row("height of the layer on a belt, m", "hopper_belt.toml", belt["height_expected_m"], belt["height_m"], "rate over bulk density and speed (exact)", file)
    yield row("load of a belt, kg/m2", "hopper_belt.toml", belt["load_expected_kg_m2"], belt["load_kg_m2"], "rate over speed (exact)", file)
    yield row("force of grains on a belt, N/m", "hopper_belt.toml", belt["force_x_expected_N_m"], belt["force_x_N_m"][0], "momentum that the grains gain (exact)", file,
              scatter=belt["force_x_N_m"][1])
    yield row("flux of sand in water over rho_s sqrt((s - 1) g d^3)", f"water_over_sand.toml, Shields number {stream['shields']:.3f}", stream["wong_parker"],
              stream["flux_dimensionless"][0], "Wong & Parker 2006, J. Hydraul. Eng. 132, 1159 (recalled)", file, scatter=stream["flux_dimensionless"][1])
    yield row("reverse flow behind a fence, heights", "fence_tunnel.toml, a solid fence of six spacings", 12, fence["reverse_length_over_H"],
              "10 to 14 heights: Good & Joubert 1968; Castro & Fackrell 1978 (recalled)", file, bound="10 to 14", met=10 <= fence["reverse_length_over_H"] <= 14)


def peers(bench):
    file = "grains/results/lammps.csv"
    for r in load(bench, file):
        yield row("particle-steps a second over LAMMPS'", f"grains in {r['dimensions']}D, {r['grains']} grains", 1, r["ratio"],
                  "LAMMPS of Debian 12, granular pair style, same grains and step, one core", file, scatter=half_range(r["ratios"]))


def rows(bench):
    return [r for part in (grains_in_air, splash, threshold, flux, heaps, storm, tunnel, dune_air, belt_and_stream, paper, peers) for r in part(bench)]
