"""What every figure shares: style, axis labels, stability segments, special points, labels that keep clear of each other."""
from dataclasses import dataclass

import matplotlib
import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.transforms import Bbox

matplotlib.rcParams.update({
    "font.size": 9.5, "axes.labelsize": 10, "axes.titlesize": 9.5, "legend.fontsize": 8.5, "xtick.labelsize": 9,
    "ytick.labelsize": 9, "font.family": "DejaVu Sans", "mathtext.fontset": "dejavusans", "axes.linewidth": 0.7,
    "xtick.direction": "in", "ytick.direction": "in", "xtick.major.width": 0.7, "ytick.major.width": 0.7,
    "legend.frameon": False, "pdf.fonttype": 42, "axes.unicode_minus": True, "lines.solid_capstyle": "butt",
})

# Okabe and Ito: told apart with any colour vision.
BLUE, VERMILLION, GREEN, PURPLE, SKY, ORANGE = "#0072B2", "#D55E00", "#009E73", "#AA4499", "#56B4E9", "#E69F00"
INK, GREY, PALE = "#1a1a1a", "#6b6b6b", "#d9d9d9"
CYCLE = (BLUE, VERMILLION, GREEN, PURPLE, ORANGE, SKY)
TITLE_SIZE = {"bold": 10.5, "normal": 9.5}
DASHES = (0, (3.5, 2.0))

# Shape and words of each special point. A branch point that starts whirling is WH.
SPECIAL = {
    "LP": ("s", "fold"), "WH": ("D", "whirling point"), "BP": ("d", "branch point"), "HB": ("o", "Hopf point"),
    "PD": ("v", "period doubling"), "TR": ("h", "torus bifurcation"), "RP": ("P", "resonance peak"), "UZ": ("p", "user value"),
    "unresolved": ("X", "unresolved change of stability"),
}

SYMBOLS = {
    "omega": r"$\omega$", "omega_ratio": r"$\omega/\omega_1$", "support_motion.amplitude": r"$U$", "support_amplitude": r"$U$",
    "damping.out_of_plane": r"$\zeta_1$",
    "damping.in_plane": r"$\zeta_2$", "cable.chord_tension": r"$T$", "cable.inclination_deg": r"$\theta$",
    "cable.chord_length": r"$L$", "tension_max": r"$T_{\max}$",
}


# --- words -----------------------------------------------------------------------------------------------------------------

NB = "\u00a0"  # keeps a number and its unit on one line


def label(symbol, unit):
    return symbol if unit in ("", "-") else f"{symbol} [{unit.replace('^2', '²')}]"


def number(x, digits=3):
    """A number for a sentence: 0.5, -2.70, 1.23e-12; the minus sign is a minus sign."""
    text = f"{x:.{digits}g}"
    return text.replace("-", "−")


def parameter_of(result, branch):
    name = str(result.group("study").attributes.get("continuation.parameter", "omega"))
    if name in branch.columns:
        return name
    described = [c for c in branch.columns if branch.descriptions[c] == "continuation parameter"]
    return described[0] if described else next(iter(branch.columns))


def damping_words(out_of_plane, in_plane):
    return rf"$\zeta_1$ = {out_of_plane:g}, $\zeta_2$ = {in_plane:g}"


def study_words(result, kind_words, varied=None, damping=True):
    """Study, support motion, damping and what is unusual about the run: a line under every title. What varies is left out."""
    a = result.group("study").attributes
    varied = varied or str(a.get("continuation.parameter", "omega"))
    words = [kind_words]
    if "support_motion.amplitude" in a and varied not in ("support_motion.amplitude", "support_amplitude"):
        words.append(rf"$U$ = {a['support_motion.amplitude']:g} m")
    if damping and {"damping.out_of_plane", "damping.in_plane"} <= a.keys() and not varied.startswith("damping"):
        words.append(damping_words(a["damping.out_of_plane"], a["damping.in_plane"]))
    if varied != "omega" and "omega" in a:
        words.append(rf"$\omega$ = {a['omega']:g} rad/s")
    words += [f"{key} = {value:g}" for key, value in model_parameters(result).items() if key not in (varied, a.get("second.parameter"))]
    words += [f"{a[key]} {noun}" for key, noun in (("model.terms", "terms"), ("cable.coefficients", "coefficients")) if key in a]
    if a.get("outcome") != "complete":
        words.append("partial result")
    return ", ".join(w.replace(" ", NB) for w in words)


def model_parameters(result):
    """Numbers of a system that the study file gives as expressions."""
    return {key: float(value) for key, value in result.group("model/parameters").columns.items() if np.ndim(value) == 0}


# --- page ------------------------------------------------------------------------------------------------------------------

LINE = 0.19  # inches from one line of text to the next
KEYS = {"handlelength": 2.0, "columnspacing": 1.1, "labelspacing": 0.35, "borderaxespad": 0.3}


class Page:
    """A figure with a caption-like title above (its first line bold), a legend below and panels between."""

    def __init__(self, width, panels_height, title, sentences, legend=()):
        self.width, self.legend = width, list(legend)
        self.figure = Figure(figsize=(width, 1.0))
        self.canvas = FigureCanvasAgg(self.figure)
        self.lines = [(line, "bold") for line in self.wrapped(title, "bold")]
        self.lines += [(line, "normal") for sentence in sentences for line in self.wrapped(sentence, "normal")]
        self.columns = self.legend_columns()
        self.top = LINE * len(self.lines) + 0.14
        self.bottom = LINE * -(-len(self.legend) // self.columns) + (0.1 if self.legend else 0.0)
        self.height = panels_height + self.top + self.bottom
        self.figure.set_size_inches(width, self.height)

    def wrapped(self, sentence, weight):
        """The sentence in lines that fit the page."""
        lines = [""]
        for word in sentence.split(" "):
            longer = f"{lines[-1]} {word}".strip()
            if lines[-1] and self.text_width(longer, weight) > self.width - 0.2:
                lines.append(word)
            else:
                lines[-1] = longer
        return lines if sentence else []

    def text_width(self, text, weight):
        probe = self.figure.text(0, 0, text, fontsize=TITLE_SIZE[weight], fontweight=weight)
        extent = probe.get_window_extent(self.canvas.get_renderer()).width / self.figure.dpi
        probe.remove()
        return extent

    def legend_columns(self):
        """As many columns, up to four, as the page is wide."""
        for columns in (4, 3, 2):
            probe = self.figure.legend(handles=by_rows(self.legend, columns), loc="lower center", ncol=columns, **KEYS)
            extent = probe.get_window_extent(self.canvas.get_renderer()).width / self.figure.dpi
            probe.remove()
            if extent < self.width - 0.1:
                return min(columns, max(len(self.legend), 1))
        return 1

    def subplots(self, rows=1, columns=1, **keywords):
        return self.figure.subplots(rows, columns, squeeze=False, **keywords)

    def finish(self):
        """Writes title and legend, lays the panels out between them."""
        y = self.height - 0.07
        for line, weight in self.lines:
            self.figure.text(0.09 / self.width, y / self.height, line, va="top", fontsize=TITLE_SIZE[weight], fontweight=weight,
                             color=INK)
            y -= LINE
        if self.legend:
            self.figure.legend(handles=by_rows(self.legend, self.columns), loc="lower center", ncol=self.columns,
                               bbox_to_anchor=(0.5, 0.0), **KEYS)
        between = (0, self.bottom / self.height, 1, 1 - self.top / self.height)
        self.figure.tight_layout(rect=between, pad=0.4, h_pad=0.9, w_pad=1.0)
        self.canvas.draw()
        return self.figure


def by_rows(items, columns):
    """A legend fills column by column; this order makes it read row by row."""
    return [items[i] for c in range(columns) for i in range(c, len(items), columns)]


def line_key(text, **style):
    return Line2D([], [], label=text, **style)


def marker_key(text, marker, **style):
    return Line2D([], [], label=text, linestyle="none", marker=marker, **style)


def letter(k):
    return f"({chr(ord('a') + k)})" if k < 26 else f"({k + 1})"


# --- branches --------------------------------------------------------------------------------------------------------------

@dataclass
class Knots:
    """A branch with its special points sewn in at their arclength; `calm[i]`: no unstable direction between knots i and i + 1."""
    arclength: np.ndarray
    columns: dict
    calm: np.ndarray

    def pieces(self):
        """Stretches of one stability, neighbours sharing the knot between them: (stable, first, last)."""
        first = 0
        for i in range(1, len(self.calm) + 1):
            if i == len(self.calm) or self.calm[i] != self.calm[first]:
                yield bool(self.calm[first]), first, i
                first = i


def knots_of(result, name, columns):
    """The drawn knots of one branch: its points and its special points, in order."""
    branch, special = result.group("branches").group(name), result.group("special_points")
    chosen = np.flatnonzero(special.column("branch") == name) if special else np.array([], dtype=int)

    def sewn(of_branch, of_special):
        return np.concatenate([branch.column(of_branch), special.column(of_special)[chosen] if len(chosen) else []])

    s = sewn("arclength", "arclength")
    order = np.argsort(s, kind="stable")
    after, before = sewn("n_unstable", "unstable_after")[order], sewn("n_unstable", "unstable_before")[order]
    return Knots(s[order], {c: sewn(c, c)[order] for c in columns}, calm_between(after, before, order >= branch.rows()))


def calm_between(after, before, is_special):
    """Computed points speak for the stretch beside them; between two special points the first one's `after` does."""
    calm = np.empty(max(len(after) - 1, 0), dtype=bool)
    for i in range(len(calm)):
        ends = [u for u, special in ((after[i], is_special[i]), (before[i + 1], is_special[i + 1])) if not special]
        calm[i] = all(u == 0 for u in ends) if ends else after[i] == 0
    return calm


def draw_branch(axes, knots, x, y, colour, width=1.6):
    """Stable solid, unstable dashed and thinner."""
    for stable, first, last in knots.pieces():
        piece = slice(first, last + 1)
        axes.plot(knots.columns[x][piece], knots.columns[y][piece], color=colour, linewidth=width if stable else 0.8 * width,
                  linestyle="-" if stable else DASHES, zorder=3 if stable else 2.5)


def stability_keys(branches, colour=INK, words=""):
    """Solid and dashed, as far as the branches have them."""
    unstable = np.concatenate([b.column("n_unstable") for b in branches]) > 0
    keys = [line_key(f"{words}stable", color=colour, linewidth=1.6)] if not np.all(unstable) else []
    return keys + ([line_key(f"{words}unstable", color=colour, linewidth=1.3, linestyle=DASHES)] if np.any(unstable) else [])


# --- special points --------------------------------------------------------------------------------------------------------

@dataclass
class Special:
    name: str       # LP1, WH2: as in the file, with WH for a branch point where whirling starts
    kind: str       # key of SPECIAL
    branch: str
    row: int


def special_points(result, columns):
    """Special points, a point on two branches once: the first branch keeps it."""
    table = result.group("special_points")
    found, places = [], []
    for i in range(table.rows()):
        place = np.array([table.column(c)[i] for c in columns])
        if any(np.allclose(place, p, rtol=1e-7, atol=1e-9) for p in places):
            continue
        places.append(place)
        kind, subtype = str(table.column("type")[i]), str(table.column("subtype")[i])
        name = str(table.column("label")[i])
        if kind == "BP" and subtype == "WH":
            kind, name = "WH", name.replace("BP", "WH", 1)
        found.append(Special(name, kind, str(table.column("branch")[i]), i))
    return told_apart(found)


def told_apart(points):
    """Numbers run per branch in the file: a name that two branches share gets its branch."""
    names = [p.name for p in points]
    for p in points:
        if names.count(p.name) > 1:
            p.name = f"{p.name} ({p.branch})"
    return points


def draw_special(axes, table, points, x, y, colour_of):
    for p in points:
        marker = SPECIAL.get(p.kind, SPECIAL["unresolved"])[0]
        axes.plot(table.column(x)[p.row], table.column(y)[p.row], marker=marker, markersize=5.2, markerfacecolor="white",
                  markeredgecolor=colour_of(p.branch), markeredgewidth=1.2, linestyle="none", zorder=6, clip_on=False)


def special_keys(points):
    kinds = dict.fromkeys(p.kind for p in points)
    return [marker_key(f"{k if k in SPECIAL else ''} {SPECIAL.get(k, SPECIAL['unresolved'])[1]}".strip(),
                       SPECIAL.get(k, SPECIAL["unresolved"])[0], markersize=5.2, markerfacecolor="white", markeredgecolor=INK,
                       markeredgewidth=1.2) for k in kinds]


# --- labels that keep clear ------------------------------------------------------------------------------------------------

@dataclass
class Tag:
    """A text to stand near one of several places (data coordinates) of a panel."""
    text: str
    places: list
    colour: str = INK
    bold: bool = False
    leader: bool = True


def place_tags(axes, tags):
    """Sets each text where it covers least: curves, markers, other texts and the frame are obstacles. Call after the layout."""
    if not tags:
        return
    scale = axes.figure.dpi / 72
    ink = Ink(drawn_pixels(axes), axes.get_window_extent())
    standing = [t.get_window_extent() for t in axes.texts if t.get_text()]
    texts = [axes.annotate(tag.text, xy=tag.places[0], xytext=(0, 0), textcoords="offset points", color=tag.colour, fontsize=8.5,
                           fontweight="bold" if tag.bold else "normal", ha="center", va="center", zorder=8, annotation_clip=False)
             for tag in tags]
    sizes = [np.array([e.width, e.height]) for e in (t.get_window_extent() for t in texts)]
    choices = [best_spots(axes, tag, size, ink, scale) for tag, size in zip(tags, sizes)]
    for tag, text, size, spot in zip(tags, texts, sizes, arrangement(choices, standing, scale)):
        text.xy = tag.places[spot.anchor]
        text.set_position(spot.offset / scale)
        if tag.leader and np.hypot(*gap(spot.offset, size)) > LEADER * scale:
            draw_leader(axes, tag, spot.anchor, spot.offset, size, scale)


LEADER = 10  # points of distance from which a text is tied to its place by a line


class Ink:
    """Which cells of a panel are drawn on, with running sums so that a box is counted at once."""
    CELL = 2.0  # pixels

    def __init__(self, pixels, frame):
        self.frame = frame
        self.shape = (int(frame.width / self.CELL) + 2, int(frame.height / self.CELL) + 2)
        self.cells = np.zeros(self.shape, dtype=bool)
        i, j = self.index(pixels).T
        inside = (i >= 0) & (j >= 0) & (i < self.shape[0]) & (j < self.shape[1])
        self.cells[i[inside], j[inside]] = True
        self.sums = np.pad(np.cumsum(np.cumsum(self.cells, axis=0), axis=1), ((1, 0), (1, 0)))

    def index(self, pixels):
        return np.floor((np.asarray(pixels) - self.frame.p0) / self.CELL).astype(int)

    def covered(self, box):
        (i0, j0), (i1, j1) = np.clip(self.index([box.p0, box.p1]), 0, np.array(self.shape) - 1)
        return self.sums[i1 + 1, j1 + 1] - self.sums[i0, j1 + 1] - self.sums[i1 + 1, j0] + self.sums[i0, j0]

    def along(self, way):
        i, j = np.clip(self.index(way), 0, np.array(self.shape) - 1).T
        return np.count_nonzero(self.cells[i, j])

    def holds(self, box):
        return box.x0 > self.frame.x0 and box.x1 < self.frame.x1 and box.y0 > self.frame.y0 and box.y1 < self.frame.y1


@dataclass
class Spot:
    """Where a text may stand: which of its places, offset of its centre and box in pixels, what it covers and crosses there."""
    anchor: int
    offset: np.ndarray
    box: Bbox
    cost: float = 0.0

    def way(self):
        """From the text's centre to its place."""
        return 0.5 * (self.box.p0 + self.box.p1) - np.linspace(0, 1, 25)[:, None] * self.offset


def best_spots(axes, tag, size, ink, scale, most=60):
    """The cheapest spots of a text by what is drawn there."""
    spots = list(candidates(axes, tag, size, scale))
    for spot in spots:
        padded = grown(spot.box, 2 * scale)
        distance = np.hypot(*gap(spot.offset, size)) / scale
        spot.cost = 1e6 * (not ink.holds(padded)) + 12 * ink.covered(padded) + distance
        if distance > LEADER:
            way = spot.way()
            spot.cost += 15 * ink.along(way[np.hypot(*(way - way[-1]).T) > 7 * scale])
    return sorted(spots, key=lambda s: s.cost)[:most]


def arrangement(choices, standing, scale):
    """One text after the other takes its best spot beside the others, from several orders; the best whole is kept."""
    shuffle, best, least = np.random.default_rng(1), None, np.inf
    costs = [np.array([s.cost for s in spots]) for spots in choices]
    padded = [np.array([grown(s.box, 2 * scale).extents for s in spots]) for spots in choices]
    ways = [np.array([s.way() for s in spots]) for spots in choices]
    fixed = [b.extents for b in standing]
    for _ in range(8):
        chosen, order = {}, shuffle.permutation(len(choices))
        for i in [*order, *order, *order]:
            others = np.array([choices[k][c].box.extents for k, (c, _) in chosen.items() if k != i] + fixed).reshape(-1, 4)
            total = costs[i] + crowding(padded[i], ways[i], others)
            chosen[i] = (int(np.argmin(total)), float(np.min(total)))
        if sum(cost for _, cost in chosen.values()) < least:
            least = sum(cost for _, cost in chosen.values())
            best = [choices[i][chosen[i][0]] for i in range(len(choices))]
    return best


def crowding(boxes, ways, others):
    """For every spot: overlapping other texts, or running the leader through them. Boxes are rows x0, y0, x1, y1."""
    b, o = boxes[:, None, :], others[None, :, :]
    overlaps = (b[..., 0] < o[..., 2]) & (b[..., 2] > o[..., 0]) & (b[..., 1] < o[..., 3]) & (b[..., 3] > o[..., 1])
    w, o = ways[:, :, None, :], others[None, None, :, :]
    crossed = np.any(np.all((w > o[..., :2]) & (w < o[..., 2:]), axis=-1), axis=1)
    return 1e4 * overlaps.sum(axis=1) + 300 * crossed.sum(axis=1)


def candidates(axes, tag, size, scale):
    """Spots on rings about each place."""
    for k, place in enumerate(tag.places):
        centre = axes.transData.transform(place)
        for clear in (4, 9, 15, 22, 30, 40, 52):
            for angle in np.arange(0, 360, 22.5) * np.pi / 180:
                direction = np.array([np.cos(angle), np.sin(angle)])
                offset = direction * (0.5 * size + clear * scale)
                low = centre + offset - 0.5 * size
                yield Spot(k, offset, Bbox.from_bounds(*low, *size))


def gap(offset, size):
    """From the place to the nearest edge of the text."""
    return np.maximum(np.abs(offset) - 0.5 * size, 0.0)


def grown(box, by):
    return Bbox.from_extents(box.x0 - by, box.y0 - by, box.x1 + by, box.y1 + by)


def drawn_pixels(axes, spacing=2.0):
    """Points every few pixels along everything plotted."""
    points = [np.empty((0, 2))]
    for line in axes.lines:
        if not isinstance(line.get_transform(), type(axes.transData)) or line.get_gid() == "background":
            continue
        xy = axes.transData.transform(np.column_stack([np.asarray(line.get_xdata(), float), np.asarray(line.get_ydata(), float)]))
        xy = xy[np.all(np.isfinite(xy), axis=1)]
        if line.get_marker() not in (None, "None", ""):
            r = 0.5 * line.get_markersize() * axes.figure.dpi / 72
            points += [xy + [dx, dy] for dx in (-r, 0, r) for dy in (-r, 0, r)]
        if line.get_linestyle() != "None" and len(xy) > 1:
            for a, b in zip(xy[:-1], xy[1:]):
                n = max(int(np.hypot(*(b - a)) / spacing), 1)
                points.append(a + (b - a) * np.linspace(0, 1, n, endpoint=False)[:, None])
    return np.concatenate(points)


def draw_leader(axes, tag, anchor, offset, size, scale):
    end = np.sign(offset) * np.minimum(np.abs(offset), gap(offset, size) - 1.0 * scale).clip(min=0)
    axes.annotate("", xy=tag.places[anchor], xytext=end / scale, textcoords="offset points", zorder=5, annotation_clip=False,
                  arrowprops={"arrowstyle": "-", "color": tag.colour, "linewidth": 0.6, "shrinkA": 0, "shrinkB": 3})


def branch_tag(knots, x, y, name, colour, axes):
    """The branch's name beside its curve, where between its ends it sits clear."""
    low, high = axes.get_xlim(), axes.get_ylim()
    xs, ys = knots.columns[x], knots.columns[y]
    inside = np.flatnonzero((xs >= low[0]) & (xs <= low[1]) & (ys >= high[0]) & (ys <= high[1]))
    picks = inside[np.unique(np.linspace(0.12, 0.88, 14) * (len(inside) - 1)).astype(int)] if len(inside) else [0]
    return Tag(name, [(xs[i], ys[i]) for i in picks], colour, bold=True, leader=False)
