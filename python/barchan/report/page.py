"""The page: its parts in order, in one file that needs no other."""

from ..errors import PackageMissing
from . import parts

STYLE = """
:root{color-scheme:light}*{box-sizing:border-box}body{margin:0;font:15px/1.5 system-ui,"DejaVu Sans",sans-serif;color:#1b1b1b;background:#f6f5f2}
main{max-width:1240px;margin:0 auto;padding:24px 28px 60px}h1{margin:0;font-size:27px;line-height:1.25}h2{margin:0 0 12px;font-size:19px}h3{margin:22px 0 8px;font-size:15.5px}
section{background:#fff;border:1px solid #e3e0d9;border-radius:8px;padding:18px 22px;margin:18px 0}.sub{color:#666;margin:2px 0 14px}
nav{margin:14px 0 0;font-size:13.5px}nav a{margin-right:14px;color:#0072B2;text-decoration:none}
.notice{border-left:5px solid;border-radius:4px;padding:9px 14px;margin:8px 0;background:#fff;overflow-wrap:anywhere}.notice ul{margin:4px 0;padding-left:20px}
.good{border-color:#009E73}.warn{border-color:#E69F00;background:#fff8e8}.bad{border-color:#D55E00;background:#fdf0e8}.note{border-color:#56B4E9}
.tiles{display:flex;flex-wrap:wrap;gap:10px;margin:14px 0}.tiles div{background:#fff;border:1px solid #e3e0d9;border-radius:8px;padding:8px 16px;color:#666;font-size:12.5px}
.tiles span{display:block;font-size:19px;color:#1b1b1b;font-variant-numeric:tabular-nums}
table{border-collapse:collapse;font-size:13px;margin:8px 0}th,td{padding:4px 10px;border-bottom:1px solid #ece9e2;vertical-align:top}th{color:#666;font-weight:600;border-bottom:1.5px solid #cfcabf}
.n{text-align:right;font-variant-numeric:tabular-nums}.l{text-align:left}.wide{overflow-x:auto}.matrix td{border:1px solid #e3e0d9;min-width:150px;font-size:12.5px}.matrix td:first-child{min-width:0}
.none{color:#bbb}.chip{display:inline-block;border-radius:9px;padding:0 8px;font-size:11.5px;border:1px solid}.chip.good{color:#00664a;background:#e6f5f0;border-color:#9ad5c2}
.chip.warn{color:#8a5a00;background:#fff3d6;border-color:#efcf87}.chip.plain{color:#555;background:#f0efec;border-color:#d5d2ca}.off{color:#D55E00}
.hint{color:#6b6b6b;font-size:12.5px}figure{margin:10px 0}figure img,figure video{max-width:100%;border:1px solid #eee}figcaption{font-size:13px;color:#444;margin:2px 0}
.pictures{display:flex;flex-wrap:wrap;gap:6px 18px}.plots{display:flex;flex-wrap:wrap;gap:10px 22px}.plots figure{margin:4px 0;max-width:100%}.plots figcaption{font-weight:600}.plots svg{max-width:100%;height:auto;display:block}
.bars{width:100%;max-width:900px}.bar{width:50%}.bar i{display:block;height:11px;margin-top:4px;background:#0072B2;border-radius:2px}
pre{background:#faf9f6;border:1px solid #e3e0d9;border-radius:6px;padding:12px;overflow:auto;font-size:12.5px;line-height:1.4}code{font-size:.92em;overflow-wrap:anywhere}summary{cursor:pointer;color:#0072B2}
@media print{body{background:#fff}section{break-inside:avoid;border:0;padding:0}}
"""


def frame(title, heading, sub, body):
    """A whole page. `heading` and `body` are HTML, `title` and `sub` texts."""
    return (f'<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1">'
            f'<meta http-equiv="Content-Security-Policy" content="default-src \'none\'; img-src data:; media-src data:; style-src \'unsafe-inline\'">'
            f'<title>{parts.esc(title)}</title><style>{STYLE}</style></head><body><main><h1>{heading}</h1><p class="sub">{parts.esc(sub)}</p>{body}</main></body></html>\n')


def attempt(g, heading, body):
    """The HTML of a part; what a part cannot cope with, a damaged table for one, is said on top and leaves the others whole."""
    try:
        return body()
    except PackageMissing:
        raise
    except Exception as error:  # whatever the file of another person makes of it
        g.remarks.append(f'the part "{heading}" could not be made: {type(error).__name__}: {error}')
        return ""


def make(g, film=False, stream=None):
    """The page of a run, as text. `stream`: speed (m/s) and length (m) of coefficients of force."""
    sections = [("Means", lambda: parts.means(g, stream), "means"), ("What drives the flow", lambda: parts.wind(g), "wind"), ("Pictures", lambda: parts.show_pictures(g) + parts.show_films(g, film), "pictures"),
                ("Measured", lambda: parts.measured(g), "measured"), ("History", lambda: parts.budgets(g) + parts.history(g), "history"),
                ("What ran: phases and their matrix", lambda: parts.matrix(g), "matrix"), ("How the time went", lambda: parts.schedule(g), "time"),
                ("Program, machine, scene", lambda: parts.about(g), "about"), ("How to cite", lambda: parts.citation(g), "cite")]
    sections = [(heading, attempt(g, heading, body), anchor) for heading, body, anchor in sections]
    there = [(heading, body, anchor) for heading, body, anchor in sections if body]
    nav = "<nav>" + "".join(f'<a href="#{anchor}">{parts.esc(heading.split(":")[0])}</a>' for heading, _, anchor in there) + "</nav>"
    numbers = attempt(g, "The numbers that one wants first", lambda: parts.tiles(g))
    body = attempt(g, "How it ended", lambda: parts.ending(g)) + attempt(g, "Warnings", lambda: parts.warnings(g)) + parts.remarks(g) + numbers + nav + "".join(parts.section(*each) for each in there)
    dimensions = g.plan.get("dimensions") if g.plan else g.said("dimensions")
    sub = " · ".join(filter(None, (f"{dimensions}D" if dimensions else "", g.scene_file.rsplit("/", 1)[-1], " ".join(g.run.get("scene", {}).get("set", [])), g.written)))
    return frame(f"{g.title} - Barchan", parts.esc(g.title), sub, body)
