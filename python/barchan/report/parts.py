"""The parts of a report's page, each a function from what was gathered to HTML; "" where there is nothing to say."""

import html
import math
import pathlib
import re

import numpy

from . import pictures, plots
from .. import files
from ..tables import bare

SENTENCE = {"ended": "ended", "running": "is still running", "killed": "was killed, or its machine stopped", "broken": "broke down", "stopped": "was stopped by a signal",
            "failed": "could not write its output, or failed"}
LIMIT_HEAD = ("limit", "steps that it ruled", "share", "step at the start (s)", "why")


def esc(text):
    return html.escape(str(text), quote=True)


def number(value, digits=4):
    """A number as the page writes it: 0.0001235 as 1.235e-4, a million with spaces between thousands."""
    if value is None:
        return ""
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        return esc(value)
    if not math.isfinite(value):
        return str(value)
    if float(value).is_integer() and abs(value) < 1e12:
        return f"{int(value):,}".replace(",", "&#8201;") if abs(value) >= 10000 else str(int(value))
    text = f"{value:.{digits}g}"
    return text if "e" not in text else text.replace("e-0", "e-").replace("e+0", "e").replace("e+", "e")


def duration(seconds):
    """Seconds in words of a clock."""
    if seconds is None:
        return ""
    if seconds < 120:
        return f"{seconds:.3g} s"
    return f"{seconds / 60:.3g} min" if seconds < 7200 else f"{seconds / 3600:.3g} h"


def rows_table(head, rows, numeric=True):
    """A table; cells are HTML already."""
    if not rows:
        return ""
    is_number = lambda value: bool(re.match(r"(<b[^>]*>)?-?(\d|nan|inf)", str(value))) and len(re.sub("<.*?>|&.*?;", "", str(value))) < 16
    side = ["n" if numeric and k and any(is_number(row[k]) for row in rows) and all(is_number(row[k]) or not row[k] for row in rows) else "l" for k in range(len(head))]
    line = lambda tag, row: "<tr>" + "".join(f'<{tag} class="{side[k]}">{value}</{tag}>' for k, value in enumerate(row)) + "</tr>"
    top = f"<thead>{line('th', head)}</thead>" if any(head) else ""
    return f'<div class="wide"><table>{top}<tbody>{"".join(line("td", row) for row in rows)}</tbody></table></div>'


def section(heading, body, anchor):
    return f'<section id="{anchor}"><h2>{esc(heading)}</h2>{body}</section>' if body else ""


def ending(g):
    """How the run ended, on top."""
    reason = g.reason if g.reason not in ("", "running") else ""
    kind = {"ended": "good", "running": "note"}.get(g.state, "bad")
    end, now = g.end_time, g.run.get("simulated_time")
    far = "" if now is None else f" at {number(now)} s" + (f" of {number(end)} s" if end is not None else "") + f", after {number(g.run.get('steps'))} steps"
    if g.state == "running":
        rows = g.history["time [s]"] if g.history is not None and g.history.length else []
        now = float(rows[-1]) if len(rows) else now
        far = "" if now is None else f"; it has come to {number(now)} s" + (f" of {number(end)} s" if end is not None else "")
    head = f"The run {SENTENCE[g.state]}{far}." + (f" Exit status {g.status}." if g.status is not None else "")
    why = "" if g.state in ("ended", "running") else f"<br>{esc(reason)}{question(reason)}"
    if g.state in ("killed", "stopped"):
        why += "<br>It goes on with <code>barchan run SCENE --restart latest</code>."
    out = [f'<div class="notice {kind}"><b>{head}</b>{why}</div>']
    if early := (g.state == "ended" and end is not None and now is not None and now < end * (1 - 1e-9)):
        out.append(f'<div class="notice note">It ended before time.end{" (" + esc(reason) + ")" if early and reason else ""}.</div>')
    return "".join(out)


def warnings(g):
    """The warnings of the program."""
    said = g.run.get("warnings") or [] if g.run.get("warnings") is not None else (g.plan or {}).get("warnings", [])
    if said:
        return f'<div class="notice warn"><b>{len(said)} warning{"s" * (len(said) > 1)} of the program</b><ul>' + "".join(f"<li>{esc(w)}{question(w)}</li>" for w in said) + "</ul></div>"
    return '<div class="notice good">The program gave no warning.</div>' if g.run and g.state != "running" else ""


# How a message begins, after the numbers and names that change, and the entry of docs/faq.md that explains it.
QUESTIONS = (
    (r"interactions\.\S+: under the cubic spline particles pair", "Under the cubic spline particles pair"),
    (r'\d+ particles? of "[^"]*".* left through the open side', "Particles left through the open side"),
    (r'"[^"]*" was pulled with ', "The wind pulls much harder than the scene says"),
    (r"the ground took ", "The ground takes more than the wind that the scene states"),
    (r'the flux of "[^"]*" still grows at the outflow', "The ground takes more than the wind that the scene states"),
    (r"(breakdown: )?(particle|body) .* (passed the wall|escaped through)", "A body passed a wall, or a particle left the domain"),
    (r"(breakdown: )?particle .*density .* is out of bounds", "The density is out of bounds"),
)


def question(message):
    """A link to the entry of docs/faq.md for a message of the program, "" where there is no such entry. The page of a package without docs/ has the name of the entry alone."""
    heading = next((heading for begin, heading in QUESTIONS if re.match(begin, message[:2000])), None)  # of a stranger's text no more
    if heading is None:
        return ""
    anchor = re.sub(r"[^\w -]", "", heading.lower()).replace(" ", "-")
    page = shared("docs/faq.md")
    text = f"docs/faq.md: {heading}"
    return f' (<a href="{esc(page.as_uri())}#{anchor}">{esc(text)}</a>)' if page else f" ({esc(text)})"


def shared(name):
    """A file of the source tree, or of the documents of an installation (PREFIX/share/doc/barchan); None where neither is there."""
    here = pathlib.Path(__file__).resolve().parents  # of ROOT/python/barchan/report, PREFIX/share/barchan/python/barchan/report
    places = (here[3] / name, here[4] / "doc/barchan" / name.removeprefix("docs/"))
    return next((place for place in places if place.is_file()), None)


def remarks(g):
    """What could not be read."""
    if not g.remarks:
        return ""
    return '<div class="notice note"><b>What this page could not read</b><ul>' + "".join(f"<li>{esc(r)}</li>" for r in dict.fromkeys(g.remarks)) + "</ul></div>"


def tiles(g):
    """The numbers that one wants first."""
    run, particles = g.run, g.run.get("particles") or {name: p["particles"] for name, p in (g.plan or {}).get("phases", {}).items()}
    found = [("simulated time", f"{number(run.get('simulated_time'))} s" if run.get("simulated_time") is not None else None), ("steps", number(run.get("steps"))),
             ("particles", number(sum(particles.values())) if particles else None), ("frames", number(len(g.series)) if g.series else "0"),
             ("wall time", duration(run.get("wall_seconds"))), ("processor time", duration(run.get("cpu_seconds"))), ("threads", number(run.get("threads"))),
             ("particle-steps a second", f"{number(round(run['particle_steps_per_second'] / 1e6, 2))} M" if run.get("particle_steps_per_second") else None)]
    return '<div class="tiles">' + "".join(f'<div><span>{v}</span>{k}</div>' for k, v in found if v) + "</div>"


def wind(g):
    """The friction velocity of every wind: as asked for, as it was at the end and in the last tenth of the run."""
    if g.history is None:
        return ""
    rows = []
    for full, values in g.history.items():
        name = bare(full)
        kind = next((k for k in ("_equivalent_friction_velocity", "_bed_friction_velocity") if name.endswith(k)), None)
        finite = values[numpy.isfinite(values)]
        if not kind or not len(finite):
            continue
        tail = finite[-max(len(finite) // 10, 1):]
        phase = name.removesuffix(kind)
        asked = asked_friction_velocity(g, phase) if kind == "_equivalent_friction_velocity" else None
        ratio = f"{tail.mean() / asked:.2f}" if asked else ""
        what = "what drives the flow pulls as a wind of this u* does" if kind == "_equivalent_friction_velocity" else "the air at the bed's surface"
        rows.append([f"<code>{esc(name)}</code>", what, number(asked) if asked else "", number(float(finite[0])), number(float(tail.mean())), number(float(finite[-1])),
                     f'<b class="{"off" if asked and not .5 < tail.mean() / asked < 2 ** .5 else ""}">{ratio}</b>' if asked else ""])
    grains = "grains" in {p.get("kind") for p in (g.plan or {}).get("phases", {}).values()}
    text = ("<p>The friction velocity u* is the square root of stress over density." + " A picture of sand in the wind means little without this number." * grains + "</p>")
    return text + rows_table(("column", "what", "u* of the scene (m/s)", "at the start", "mean of the last tenth", "last", "mean / scene"), rows) if rows else ""


def asked_friction_velocity(g, phase):
    """u* (m/s) that the scene says for this fluid or column: of its forcing, else of its logarithmic wind."""
    scene = g.scene or {}
    of_phase = lambda section: [f for f in scene.get(section, []) if f.get("phase") == phase]
    places = of_phase("forcing")
    places += [f["velocity"]["log-profile"] for f in of_phase("fill") + of_phase("inflow") if isinstance(f.get("velocity"), dict) and "log-profile" in f["velocity"]]
    column = scene.get("phases", {}).get(phase, {})
    places += [column, column.get("log-profile", {}) if isinstance(column, dict) else {}]
    return next((float(p["friction-velocity"]) for p in places if isinstance(p.get("friction-velocity"), (int, float))), None)


MEANS = r".*(_force_[xyz]|_torque(_[xyz])?|_flux|mean_v[xyz]|_equivalent_friction_velocity|_bed_friction_velocity|mean_pressure)$"


FEWEST_TIMES = 20   # autocorrelation times of a window that is judged
STEADY = 0.01       # share of the mean below which a change does not count
SETTLED, CHANGES, SHORT = "settled", "still changes", "too short to say"


def halves(times, values):
    """Mean and standard deviation over the second half of the time, the window, and whether they have settled: SETTLED, CHANGES or SHORT (`judged`). None with less than eight rows there."""
    late = times >= 0.5 * (times[0] + times[-1])
    chosen = values[late & numpy.isfinite(values)]
    if len(chosen) < 8:
        return None
    return float(chosen.mean()), float(chosen.std()), judged(chosen)


def judged(values):
    """SETTLED, CHANGES or SHORT for rows (n,) at equal distances in time.

    CHANGES: the means of the two halves differ by more than STEADY of the mean and two standard errors, of which each is s sqrt(tau/n) of its half, with the standard deviation s about its own mean and the
    integrated autocorrelation time tau (`autocorrelation_time`). SHORT: there are fewer than FEWEST_TIMES such times, so that error is not to be trusted; the values change all the same
    if the means of the four quarters only rise or only fall. SETTLED: all else, and values that stay within STEADY of their mean."""
    first, second = numpy.array_split(values, 2)
    difference, scale = abs(first.mean() - second.mean()), STEADY * abs(values.mean())
    if difference <= scale and values.std() <= scale:
        return SETTLED
    tau = max(autocorrelation_time(half) for half in (first, second))
    error = math.sqrt(sum(half.var() * tau / len(half) for half in (first, second)))
    if len(values) < FEWEST_TIMES * max(tau, autocorrelation_time(values)):
        steps = numpy.diff([quarter.mean() for quarter in numpy.array_split(values, 4)])
        return CHANGES if difference > max(2 * error, scale) and ((steps > 0).all() or (steps < 0).all()) else SHORT
    return CHANGES if difference > max(2 * error, scale) else SETTLED


def autocorrelation_time(values):
    """Integrated autocorrelation time of rows (n,), in rows, 1 for independent values: 1 + 2 sum rho(k), up to the first lag k that is five times the sum so far (Madras & Sokal 1988,
    J. Stat. Phys. 50, 109, window with c = 5). bench/barchan_bench/statistics.py has the same as a loop; here the products are made by a Fourier transform."""
    x = values - values.mean()
    if not x.any():
        return 1.0
    power = abs(numpy.fft.rfft(x, 2 * len(x))) ** 2
    rho = numpy.fft.irfft(power)[:len(x)]
    total = 2 * numpy.cumsum(rho / rho[0]) - 1
    ends = numpy.flatnonzero(numpy.arange(len(x)) >= 5 * total)
    ends = ends[ends > 0]
    return max(float(total[ends[0] if len(ends) else -1]), 1.0)


def means(g, stream=None):
    """Means over the second half of the run; with `stream`, (speed in m/s, length in m), the coefficients of every force too."""
    if g.history is None or g.history.length < 16:
        return '<p class="hint">No coefficients: history.csv has fewer than 16 rows.</p>' if stream else ""
    times = g.history["time [s]"]
    rows = []
    for full, values in sorted(g.history.items(), key=lambda item: "_force_" not in item[0]):
        found = halves(times, values) if re.fullmatch(MEANS, bare(full)) and not plots.is_round_off(full, g.history) else None
        if found and (found[0] or found[1]):
            rows.append([f"<code>{esc(bare(full))}</code>", number(found[0]), number(found[1]), esc(g.history.unit(full)), settled(found[2])])
    out = rows_table(("column", "mean of the second half", "standard deviation", "", ""), rows)
    return out + (coefficients(g, times, *stream) if stream else "")


def settled(state):
    return f'<span class="chip {"good" if state == SETTLED else "plain" if state == SHORT else "warn"}">{state}</span>'


def coefficients(g, times, speed, length):
    """Cd along the flow and Cl across: force over 1/2 rho U^2 A, A = L by metre of depth in 2D and pi L^2/4 in 3D, and the Strouhal number f L/U of what changes its sign about its mean."""
    forces = {full: re.fullmatch(r"(.*)_force_([xyz])", bare(full)) for full in g.history}
    forces = {full: found for full, found in forces.items() if found}
    if not forces:
        return '<p class="hint">No coefficients: the scene has no [[force]], so history.csv has no column of a force. Add [[force]] with the phase of the body.</p>'
    fluid = only_fluid(g)
    if fluid is None:
        return '<p class="hint">No coefficients: the scene has not one fluid alone.</p>'
    name, density = fluid
    along, sign, why = flow_axis(g, times, name, speed)
    two = (g.plan or {}).get("dimensions", g.said("dimensions")) == 2
    area = length if two else math.pi / 4 * length ** 2
    rows = []
    for full, found in sorted(forces.items(), key=lambda item: item[1][2] != along):
        c = g.history[full] / (0.5 * density * speed ** 2 * area) * (sign if found[2] == along else 1)
        if of := halves(times, c):
            rows.append([f"<b>{'Cd' if found[2] == along else 'Cl'}</b>", f"<code>{esc(bare(full))}</code>", number(of[0]), number(of[1]),
                         number(float(numpy.ptp(c[times >= 0.5 * (times[0] + times[-1])])) / 2), number(strouhal(times, c, speed, length)), settled(of[2])])
    note = (f'<p class="hint">C = F/(1/2 rho U^2 A): U = {number(speed)} m/s, A = {"L" if two else "pi L^2/4"} with L = {number(length)} m{" by metre of depth" if two else ""}, '
            f"rho = {number(density)} kg/m3; second half of the run. Cd is along the flow, {esc(why)}, Cl across.</p>")
    return "<h3>Coefficients of force</h3>" + rows_table(("", "force", "mean", "standard deviation", "half of the range", "Strouhal number", ""), rows) + note if rows else ""


def flow_axis(g, times, fluid, speed):
    """The axis of the flow, its sign, and how it was found: that of the largest mean velocity of the fluid in the second half, else x."""
    late = times >= 0.5 * (times[0] + times[-1])
    found = {axis: float(numpy.nanmean(g.history[f"{fluid}_mean_v{axis}"][late])) for axis in "xyz" if f"{fluid}_mean_v{axis}" in g.history}
    axis = max(found, key=lambda each: abs(found[each]), default="x")
    if not found or not abs(found[axis]) > 0.1 * speed:
        return "x", 1, f'taken as x: "{fluid}" has no mean velocity of a tenth of U'
    return axis, 1 if found[axis] > 0 else -1, f'{"+" if found[axis] > 0 else "-"}{axis}, the mean velocity of "{fluid}"'


def only_fluid(g):
    """Name and density (kg/m3) of the only fluid of the scene; None: there are none or several."""
    found = [(name, p.get("density")) for name, p in (g.scene or {}).get("phases", {}).items() if isinstance(p, dict) and p.get("kind") == "fluid"]
    return (found[0][0], float(found[0][1])) if len(found) == 1 and isinstance(found[0][1], (int, float)) else None


def strouhal(times, values, speed, length):
    """f L/U from the upward passages of the mean in the second half; None with less than three periods."""
    late = (times >= 0.5 * (times[0] + times[-1])) & numpy.isfinite(values)
    t, v = times[late], values[late] - values[late].mean()
    up = numpy.flatnonzero((v[:-1] < 0) & (v[1:] >= 0))
    if len(up) < 4:
        return None
    passed = t[up] - v[up] * (t[up + 1] - t[up]) / (v[up + 1] - v[up])
    periods = numpy.diff(passed)
    if periods.std() > 0.2 * periods.mean():   # no oscillation
        return None
    return float(length / speed / periods.mean())


def show_pictures(g):
    """Rendered pictures where there are some, else frames drawn here."""
    shown, note = pictures.rendered(g), ""
    if not shown:
        shown = pictures.drawn(g)
        note = '<p class="hint">Drawn from the frames. <code>barchan report DIR --render</code> has ParaView render the scene\'s own states.</p>' if shown else ""
    elif g.state == "broken":
        shown += [each for each in pictures.drawn(g) if "bad" in each[0]]
    return note + '<div class="pictures">' * bool(shown) + "".join(f'<figure><img alt="{esc(c)}" src="{uri}"><figcaption>{esc(c)}</figcaption></figure>' for c, uri in shown) + "</div>" * bool(shown)


def show_films(g, asked):
    """The films, embedded if that was asked for, else named."""
    if not g.films:
        return ""
    if not asked:
        return f'<p class="hint">{", ".join(esc(f.name) for f in g.films)} in the folder pictures: <code>--film</code> puts films into this page.</p>'
    return "".join(f'<figure><video controls src="{uri}"></video><figcaption>{esc(c)}</figcaption></figure>' for c, uri in pictures.films(g))


def matrix(g):
    """Phases, and the matrix of interactions with the consistency of each entry."""
    plan = g.plan
    if not plan:
        pairs = g.run.get("pairs") or {}
        return rows_table(("entry", "directed pairs in the last list"), [[esc(k), number(v)] for k, v in pairs.items()])
    phases = plan["phases"]
    rows = [[esc(n), esc(p["kind"]), number(p["particles"]), number(p["spacing"]), number(p["mass"]), number(p["sound_speed"]), esc(p.get("enclosure", ""))] for n, p in phases.items()]
    out = rows_table(("phase", "kind", "particles", "spacing (m)", "mass of one (kg)", "sound speed (m/s)", ""), rows)
    names, entries = list(phases), plan.get("interactions") or {}  # a scene may have none
    cells = []
    for k, a in enumerate(names):
        row = [f"<b>{esc(a)}</b>"] + [""] * k
        for b in names[k:]:
            entry = entries.get(f"{a}-{b}") or entries.get(f"{b}-{a}")
            row.append(entry_cell(entry, g.run.get("pairs", {}), (f"{a}-{b}", f"{b}-{a}")) if entry else '<span class="none">&middot;</span>')
        cells.append(row)
    if not entries:
        return out + "<p>No phase interacts with another or with itself: the matrix is empty.</p>"
    out += "<h3>The matrix of interactions</h3>" + rows_table(["", *map(esc, names)], cells, numeric=False).replace("<table>", '<table class="matrix">')
    return out + ('<p class="hint">An entry that is not there costs nothing. &Sigma;VW and the gradient sum are those of a lattice; the truth is 1 and 1. '
                  '<span class="chip good">consistent</span> by itself or <span class="chip good">corrected</span> by the scheme; <span class="chip plain">contact</span>: no kernel sum; '
                  '<span class="chip warn">not consistent</span>: a plain sum with the error that the numbers show.</p>')


def entry_cell(entry, pairs, names):
    contact = entry["neighbours"] == 0
    chip = ("good", "consistent") if entry["consistent"] else ("good", "corrected") if entry.get("corrected") else ("plain", "contact" if "touch" in entry["meaning"] else "no kernel") \
        if contact else ("warn", "not consistent")
    count = next((pairs[n] for n in names if n in pairs), entry.get("pairs"))
    sums = "" if contact else f"<br>{number(entry['neighbours'])} neighbours, &Sigma;VW {entry['volume_sum']:.3f}, gradient {entry['gradient_sum']:.3f}"
    return (f'<b>{esc(entry["law"])}</b> <span class="chip {chip[0]}">{chip[1]}</span><br>radius {number(entry["radius"])} m{sums}<br>{number(count)} pairs'
            f'<br><span class="hint">{esc(entry["meaning"])}</span>')


def schedule(g):
    """The passes of a step with their times, what repeats, what was skipped, and what limits the step."""
    run, plan = g.run, g.plan or {}
    seconds = {k: v for k, v in (run.get("seconds") or {}).items() if v is not None}
    total = sum(v for k, v in seconds.items() if k != "output (behind)") or 1.
    bars = "".join(f'<tr><td class="l">{esc(k)}</td><td class="n">{duration(v)}</td><td class="n">{100 * v / total:.1f} %</td>'
                   f'<td class="bar"><i style="width:{min(100 * v / total, 100):.2f}%{";background:#bbb" if k.startswith("output") else ""}"></i></td></tr>' for k, v in seconds.items())
    out = (f'<table class="bars"><thead><tr><th class="l">pass, in the order of a step</th><th class="n">time</th><th class="n">share</th><th></th></tr></thead><tbody>{bars}</tbody></table>'
           if bars else "")
    if out and "output (behind)" in seconds:
        out += '<p class="hint">output (behind): on a thread of its own while the steps go on; it is not part of the sum.</p>'
    if not seconds and (run.get("passes") or plan.get("passes")):
        out += "<p>Passes: " + ", ".join(map(esc, run.get("passes") or plan["passes"])) + ".</p>"
    if plan.get("skipped"):
        out += f'<p><b>Skipped</b>, because this scene does not need it: {esc(", ".join(plan["skipped"]))}.</p>'
    if plan.get("not_measured"):
        out += f'<p><b>Not measured:</b> {esc(", ".join(plan["not_measured"]))}.</p>'
    repeats = run.get("repeats") or plan.get("repeats") or []
    steps = run.get("steps") or 0
    out += rows_table(("what a step does not do once", "planned interval (s)", "calls", "calls a step", "time"),
                      [[f"{esc(r.get('name', ''))} of {esc(r.get('of', ''))}", number(r.get("interval")), number(r.get("calls")), number(r["calls"] / steps) if steps and r.get("calls") else "",
                        duration(r.get("seconds"))] for r in repeats])
    limits, counts = plan.get("limits", {}), run.get("time_step_limits") or {}
    ruled = sum(counts.values()) or 1
    names = sorted({*limits, *counts}, key=lambda n: -counts.get(n, 0))
    out += rows_table(LIMIT_HEAD, [[esc(n), number(counts.get(n, 0)), f"{100 * counts.get(n, 0) / ruled:.1f} %", number(limits.get(n, {}).get("value")), esc(limits.get(n, {}).get("reason", ""))]
                                   for n in names])
    used = run.get("threads_used") or []
    if len(used) > 1:
        out += rows_table(("threads", "steps", "wall time"), [[number(u.get("threads")), number(u.get("steps")), duration(u.get("seconds"))] for u in used])
    retreats = run.get("retreats") or {}
    if retreats.get("count"):
        out += f"<p><b>The run went back {number(retreats['count'])} times</b> after a failed step.</p>" + rows_table(
            ("step that failed", "time (s)", "back to step", "share of the step from there", "why"),
            [[*(number(r.get(key)) for key in ("step", "time", "back_to", "share_of_step")), esc(r.get("reason", ""))] for r in retreats.get("list", [])])
    return out


def budgets(g):
    """What the scene promises to keep, and did it."""
    kept = [(key, g.run.get("budgets", {}).get(key), bound) for key, bound in (("momentum_drift", .01), ("energy_growth", .05), ("angular_momentum_drift", .01))]
    rows = [[esc(key.replace("_", " ")), number(value), f"{bound:g}", '<span class="chip good">kept</span>' if (value if key == "energy_growth" else abs(value)) <= bound else '<span class="chip warn">above</span>']
            for key, value, bound in kept if value is not None]
    return rows_table(("what the scene promises to keep", "relative", "a warning is given above", ""), rows)


def grid_of(shown):
    return '<div class="plots">' + "".join(f"<figure><figcaption>{esc(h)}</figcaption>{s}</figure>" for h, s in shown) + "</div>" if shown else ""


def history(g):
    """Plots of every column of history.csv."""
    if g.history is None or not g.history.length:
        return ""
    if g.history.length == 1:
        return "<p>history.csv has one row: there is nothing to plot yet.</p>"
    shown, constant = plots.history_plots(g.history)
    out = grid_of(shown)
    if constant:
        out += '<p class="hint">Columns that do not change, or by round-off alone: ' + ", ".join(f"<code>{esc(n)}</code> = {number(v)} {esc(u)}".rstrip() for n, u, v in constant) + ".</p>"
    return out


def measured(g):
    """What the scene measures: plots of each instrument."""
    out = ""
    samples = {(m.get("kind"), m.get("name")): m.get("samples") for m in g.run.get("measured", [])}
    for name, each in g.profiles.items():
        kind = next(k for k in ("profile", "probe", "gauge", "wall_shear", "saltation") if name.startswith(k + "_"))
        label = f"{kind.replace('_', '-')} {name.removeprefix(kind + '_')}"
        count = samples.get((kind.replace("_", "-"), name.removeprefix(kind + "_")))
        shown = plots.instrument_plots(name, each)
        out += f"<h3>{esc(label)}</h3>" + (f'<p class="hint">{number(count)} samples in time; <code>{esc(name)}.csv</code></p>' if count is not None else "")
        out += grid_of(shown) or "<p>No sample yet.</p>"
        if kind == "saltation":
            out += saltation_numbers(g.saltation.get(name.removeprefix("saltation_"), {})) if count else ""
    for name, grid in g.grids.items():
        shown = plots.grid_plots(grid)
        out += f"<h3>grid {esc(name)}</h3>" + (grid_of(shown) or "<p>No sample yet, or a grid in 3D: open it in ParaView.</p>")
    return out


def saltation_numbers(found):
    """What saltation_NAME.json says."""
    rows = [["flux (kg/m/s)", number(found.get("flux")), ""], ["flux in flight (kg/m/s)", number(found.get("flux_in_flight")), ""], ["height of the bed (m)", number(found.get("bed")), ""]]
    for key in ("flux_decay", "concentration_decay"):
        d = found.get(key) or {}
        if d.get("slices"):
            rows.append([f"{key.split('_')[0]} falls by a factor e over (m)", number(d.get("height")), f"&plusmn; {number(d.get('standard_error'))} over {number(d['slices'])} slices"])
    return rows_table(("", "", ""), rows) if found else ""


def about(g):
    """Program, machine, command, scene text."""
    run, said = g.run, g.run.get("scene", {})
    command = " ".join(["barchan run", said.get("file", ""), *(f"--set {each}" for each in said.get("set", []))]) if said else ""
    memory = (g.plan or {}).get("memory", {}).get("bytes")
    rows = [[k, v] for k, v in (("scene", f"<code>{esc(g.scene_file)}</code>"), ("command", f"<code>{esc(command)}</code>"), ("folder", f"<code>{esc(g.folder.absolute())}</code>"),
                                ("program", esc(" ".join(filter(None, ("barchan", run.get("version"), f"({run['commit']})" if run.get("commit") else ""))))), ("compiler", esc(run.get("compiler", ""))),
                                ("instruction set", esc(run.get("instruction_set", ""))), ("VTK", esc(run.get("vtk", ""))), ("host, process", esc(f"{run.get('host', '')}, {run.get('process', '')}")),
                                ("end reason", esc(g.reason)), ("run.json written", esc(g.written)), ("memory as planned", f"{memory / 1e6:.1f} MB" if memory else "")) if v]
    out = rows_table(("", ""), rows, numeric=False)
    if g.scene_text:
        out += f'<details{" open" if len(g.scene_text) < 1500 else ""}><summary>The scene file ({len(g.scene_text.splitlines())} lines)</summary><pre>{esc(g.scene_text)}</pre></details>'
    return out


def citation(g):
    """A text that names the program, its version and the article of its method, to be copied; from CITATION.cff where it is there."""
    file = shared("CITATION.cff")
    text = files.text(file) if file else 'title: Barchan\nauthors:\n  - name: The Barchan developers\n'
    own, _, reference = text.partition("\nreferences:")
    version = g.run.get("version") or field_of(own, "version")
    commit = f" (commit {g.run['commit']})" if g.run.get("commit") else ""
    lines = [f"{people(own)}: {field_of(own, 'title')}" + (f", version {version}{commit}." if version else ".")]
    if reference:
        lines.append(f"Method: {people(reference)} ({field_of(reference, 'year')}): {field_of(reference, 'title')}.")
    return f"<pre>{esc(chr(10).join(lines))}</pre>"


def field_of(text, key):
    """The value of a key of CITATION.cff, "" where there is none."""
    found = re.search(rf'^[ -]*{key}:\s*"?(.*?)"?\s*$', text, re.M)
    return found[1] if found else ""


def people(text):
    """The names of the authors of a part of CITATION.cff."""
    block = re.search(r"^ *authors:\n((?: *- .*\n?)+)", text, re.M)
    names = [each for line in (block[1].splitlines() if block else ()) for each in (re.search(r'name: *"?([^"]*?)"?$', line), re.search(r"family-names: *(.*?), *given-names: *(.*?)\}", line)) if each]
    return ", ".join(" ".join(reversed(each.groups())) for each in names)
