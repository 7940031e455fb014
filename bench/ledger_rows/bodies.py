"""Rows of bodies and impacts: from bench/impacts/results/impacts.csv. Bounds are those of tests/physics and of the page docs/impacts.md."""

from ledger_rows import load, row, within

FILE = "impacts/results/impacts.csv"
GRAY = "Timoshenko's beam with shear and rotatory inertia; the plate of Gray, Monaghan & Swift 2001, Comput. Methods Appl. Mech. Engrg 190, 6641, section 6"
TUREK = "Turek & Hron 2006, in Fluid-Structure Interaction (Springer), p. 371, CSM3"
BARS = "exact: one-dimensional waves of c = sqrt((lambda + 2 mu)/rho)"
HERTZ = "Hertz 1882; Johnson 1985, Contact Mechanics, section 4.2"
BY_SURFACES = ", by surfaces"
PAPER = "Halik et al. 2015, section 5, figure "


def plates(r):
    for t in r["cantilever"]["table"]:
        case = f"clamped plate, {t['across']} particles across"
        yield row("period, s", case, .2565, t["period"], GRAY, FILE)
        yield row("amplitude, m", case, .0231, t["amplitude"], "thin beam: Landau & Lifshitz, Theory of Elasticity, section 25", FILE)
    for t in r["csm3"]["table"]:
        case = f"plate that swings (CSM3), {t['across']} particles across"
        yield row("frequency, Hz", case, 1.0995, t["frequency"], TUREK, FILE)
        yield row("mean of u_x, mm", case, -14.305, 1e3 * t["ux"][0], TUREK, FILE)
        yield row("amplitude of u_x, mm", case, 14.305, 1e3 * t["ux"][1], TUREK, FILE)
        yield row("mean of u_y, mm", case, -63.607, 1e3 * t["uy"][0], TUREK, FILE)
        yield row("amplitude of u_y, mm", case, 65.160, 1e3 * t["uy"][1], TUREK, FILE)


def contacts(r):
    for name, words in (("table", "two bars"), ("plain", "two bars without wave-correction"), ("smooth", "two bars" + BY_SURFACES)):
        for t in r["bars"][name]:
            case = f"{words}, {t['count']} particles a length"
            bound, met = within(100 * (t["touch"] - 1), 1) if name == "table" and t["count"] >= 40 else (None, None)
            yield row("time with more than half of the force, over 2L/c", case, 1, t["time"], BARS, FILE)
            yield row("time with more than a twentieth of the force, over 2L/c", case, 1, t["touch"], BARS, FILE, bound=bound, met=met)
            yield row("restitution", case, 1, t["restitution"], BARS, FILE)
            yield row("speed of A after the impact, over V", case, 0, t["left"], BARS, FILE)
    for t in r["rows"]["table"]:
        case = f"{t['hits']} bars hit {t['hits']}" + ("" if t["corrected"] else ", without wave-correction") + BY_SURFACES * t.get("surfaces", False)
        bound, met = within(100 * (t["restitution"] - 1), 2)
        yield row("restitution of the rows", case, 1, t["restitution"], BARS, FILE, bound=bound, met=met)
        yield row("speed of a single bar, largest difference over V", case, 0, t["worst"], BARS, FILE)
    for t in r["restitution"]["table"]:
        if t["young"] != 206e9 or t["speed"] != 10:
            continue
        error, most = t["measured"] - t["written"], 1e-4 if t["written"] == 1 else .01
        yield row(f"restitution {t['written']:g}", "two particles, E = 206 GPa, 10 m/s", t["written"], t["measured"],
                  "the value that the scene writes (exact)", FILE, bound=f"within {most:g}", met=abs(error) <= most)
    for t in r["hertz"]["table"]:
        case = f"two discs, {t['count']} particles a radius, P = {t['load']:.0f} N/m" + BY_SURFACES * t.get("surfaces", False)
        for name, key in (("half the contact's width over b, second moment", "moment"), ("half the contact's width over b, fit", "width"), ("peak pressure over p_0, fit", "peak")):
            bound, met = within(100 * (t[key] - 1), 10)
            yield row(name, case, 1, t[key], HERTZ, FILE, bound=bound, met=met)
    for t in r["hertz_spheres"]["table"]:
        case = f"two spheres, {t['count']} particles a radius" + BY_SURFACES * t.get("surfaces", False)
        for name, key in (("contact's radius over a, second moment", "moment"), ("contact's radius over a, fit", "width"), ("peak pressure over p_0, fit", "peak"),
                          ("pressure inside 0.6 a over the exact one", "inner")):
            bound, met = within(100 * (t[key] - 1), 10) if t["count"] == 40 else (None, None)
            yield row(name, case, 1, t[key], HERTZ, FILE, bound=bound, met=met)


def rigid(r):
    for t in r["pendulum"]["table"]:
        yield row("period, s", f"bar that swings by 90 degrees, {t['across']} particles across", t["exact"], t["period"],
                  "elliptic integral of the physical pendulum; Landau & Lifshitz, Mechanics, section 11", FILE)
    for t in r["rolling"]["table"]:
        yield row("acceleration, m/s2", f"{t['shape']} that rolls, {t['count']} particles a radius", t["exact"], t["acceleration"],
                  "rolling without slipping: a = g sin(15)/(1 + I/(M R^2)) (exact)", FILE)
    top, gears = r["top"], r["gears"]
    yield row("energy, change over the start's", "free top, 100 turns", 0, top["energy"], "Euler's equations of the free top (exact)", FILE, bound="<= 1e-06",
              met=top["energy"] <= 1e-6)
    yield row("angular momentum, change over the start's", "free top, 100 turns", 0, top["momentum"], "Euler's equations of the free top (exact)", FILE,
              bound="<= 1e-06", met=top["momentum"] <= 1e-6)
    exact = "involutes: speeds are as 20 to 30, torques without friction too (exact)"
    yield row("speed of the driven gear over the driver's", "gears of 20 and 30 teeth", -2 / 3, gears["ratio"], exact, FILE)
    yield row("mean torque on the driven gear, N m/m", "gears of 20 and 30 teeth", -100., gears["driven"], exact, FILE)
    yield row("torque on the driver over that on the driven", "gears of 20 and 30 teeth", 2 / 3, gears["driver"] / gears["driven"], exact, FILE)
    b = r["bearing"]
    yield row("work less kinetic energy, heat and contacts, over the work", "ball bearing", 0, b["left"], "conservation of energy (exact)", FILE)
    yield row("momentum, rest over that exchanged", "ball bearing", 0, b["momentum"], "conservation of momentum (exact)", FILE)


def energies(r):
    for t in r["rings"]["table"]:
        yield row("energy after the bounce, change", f"two rubber rings, {t['across']} particles across", 0, t["energy"], "nothing damps (exact)", FILE,
                  bound="<= 0.01", met=t["energy"] <= .01)
        yield row("momentum over that of a ring", f"two rubber rings, {t['across']} particles across", 0, t["momentum"], "conservation of momentum (exact)",
                  FILE, bound="<= 1e-12", met=t["momentum"] <= 1e-12)
    for t in r["block"]["table"]:
        yield row("energy in flight, largest change over the fall's", f"block of rubber, {t['across']} particles a side", 0, t["energy"],
                  "nothing damps (exact)", FILE)
    for name, t in r["eq13"]["table"].items():
        yield row("kinetic and internal energy, largest change", name.replace("|", "/"), 0, t["kept"], "conservation of energy (exact)", FILE,
                  bound="<= 0.0001", met=t["kept"] <= 1e-4)


def paper(r):
    """The paper gives curves without numbers; what it says in words is half of the speed for figures 6a, 6b and 7a."""
    for t in r["paper"]["table"]:
        if t["figure"] in ("6a", "6b", "7a"):
            yield row("speed of A at the end, m/s", f"the paper's impact, figure {t['figure']}", 5., t["a"], f"{PAPER}{t['figure']}: half of 10 m/s", FILE,
                      bound="half, as the paper says", met=abs(t["a"] - 5) < .5)
        elif t["figure"] == "7b":
            yield row("speed of A less that of B, m/s", "the paper's impact, figure 7b", "below 0", t["a"] - t["b"],
                      f"{PAPER}7b: A is slower than B, they do not stick", FILE, bound="below 0", met=t["a"] < t["b"], bias=0.)


def rows(bench):
    r = load(bench, FILE)
    return [*plates(r), *contacts(r), *rigid(r), *energies(r), *paper(r)]
