"""Random fabrics as texts of the input language: every construction, section, form of path and unit, small enough to go
through the whole program in about a second. A seed is a fabric, always the same one.

Lengths are drawn in mm and written in the unit of the file, so that tex, density and turns per metre stay those of real yarns.
Most draws can be built and keep their yarns apart; one in eight is careless, to see what the program says of it.
"""

import math
import random

UNITS = {"mm": 1.0, "cm": 10.0, "m": 1000.0, "um": 0.001, "inch": 25.4}
FAMILIES = {
    "weave": 20,
    "stack": 8,
    "knit": 12,
    "warpknit": 12,
    "braid": 14,
    "bundle": 8,
    "free": 14,
    "grid": 8,
    "piece": 4,
    "mixed": 4,
}
CELLED = ("weave", "stack", "knit", "warpknit", "fibre")
LAPPINGS = [
    "1-0/1-2",
    "1-0/2-3",
    "1-0/3-4",
    "0-1/2-1",
    "1-0/0-1",
    "1-0/1-2/2-3/2-1",
    "2-3/1-0",
    "1-2/1-0",
    "0-1/1-0",
    "1-0/1-2/1-0/2-3/2-1/2-3",
    "0-0/2-2",
    "0-0/3-3",
    "1-1/0-0",
]
KNITTING = 10  # of these make loops


class Thread:
    """A thread's name and the size of its section, mm."""

    def __init__(self, name, width, height, is_round):
        self.name, self.width, self.height, self.is_round = name, width, height, is_round


class Maker:
    def __init__(self, seed, family=None):
        self.random = random.Random(seed)
        self.blocks, self.threads, self.yarns = [], [], []
        self.family = family or self.random.choices(list(FAMILIES), list(FAMILIES.values()))[0]
        self.careless = self.chance(1 / 8)
        self.cell = self.cell_material = None
        self.finest = math.inf  # thickness, mm

    # ---- draws

    def chance(self, share):
        return self.random.random() < share

    def pick(self, *values):
        return self.random.choice(values)

    def count(self, low, high):
        return self.random.randint(low, high)

    def between(self, low, high):
        """A number as people write it."""
        return float(f"{self.random.uniform(low, high):.3g}")

    def mm(self, value):
        return f"{value / UNITS[self.unit]:.9g}"

    def row(self, *values):
        return " ".join(map(self.mm, values))

    # ---- the file

    def text(self):
        self.unit = "mm" if self.chance(0.5) else self.pick(*UNITS)
        getattr(self, self.family)()
        head = ["fabric 1"]
        if self.chance(0.3):
            head.append(f'title "{self.family}, drawn"')
        if self.unit != "mm" or self.chance(0.5):
            head.append(f"units {self.unit}")
        if self.chance(0.85) and self.finest < math.inf:  # the default makes surfaces that take long
            head.append(f"tolerance {self.mm(self.finest * self.between(0.004, 0.015))}")
        return "\n".join(head + self.blocks) + "\n"

    def block(self, head, *lines):
        body = "\n".join("  " + line for part in lines for line in part.split("\n"))
        return f"{head}\n{body}\nend" if body else f"{head}\nend"

    def add(self, head, *lines):
        self.blocks.append(self.block(head, *lines))

    def name(self, stem):
        """Plain, or in quotes."""
        return stem if self.chance(0.9) else f'"{stem} no. {self.count(1, 9)}"'

    # ---- materials and threads

    def material(self):
        name = f"m{len(self.blocks)}"
        law = self.pick("elastic isotropic 3400 0.35", "elastic transverse 51500 17500 0.26 5800 0.31", "density 1.2")
        self.add(f"material {name}", law, *(["expansion 6e-6 21e-6"] if self.chance(0.3) else []))
        return name

    def section(self, width, height):
        """A statement for a section of this size, and whether it is round."""
        w, h = self.mm(width), self.mm(height)
        form = self.pick("circle", "ellipse", "lenticular", "racetrack", "power", "loop7", "polygon")
        if form == "circle":
            return f"section circle {h}", True
        if form == "loop7":
            return f"section loop7 {h}", True
        if form == "power":
            return f"section power {w} {h} {self.between(0.4, 2.2)}", False
        if form == "polygon":
            corners = self.count(3, 8)
            turn = self.random.uniform(0, 2 * math.pi / corners)
            rows = [
                f"{self.mm(width / 2 * math.cos(turn + 2 * math.pi * i / corners))} "
                f"{self.mm(height / 2 * math.sin(turn + 2 * math.pi * i / corners))}"
                for i in range(corners)
            ]
            return self.block("section polygon", *rows), False
        return f"section {form} {w} {h}", False

    def thread(self, size=None, flat=None, sized_by_tex=True):
        """A thread of about `size` (mm) thickness. flat: False for round, True for any section, None for either."""
        size = size or self.between(0.1, 1.0)
        name = self.name(f"t{len(self.threads)}")
        lines, width, is_round = [], size, True
        if flat is False or (flat is None and self.chance(0.5)):
            if sized_by_tex and self.chance(0.4):
                density, packing = self.between(0.9, 2.7), self.between(0.5, 0.95)
                tex = float(f"{size ** 2 / 4 * 1000 * math.pi * density * packing:.4g}")
                measure, value = self.pick(("tex", tex), ("denier", 9 * tex), ("Ne", 590.541 / tex))
                lines += [f"{measure} {value:.6g}", f"density {density}", f"packing {packing}"]
            else:
                lines.append(f"diameter {self.mm(size)}" if self.chance(0.5) else f"section circle {self.mm(size)}")
        else:
            width = size * self.between(1.0, 4.0)
            statement, is_round = self.section(width, size)
            width = size if is_round else width
            lines.append(statement)
        if self.chance(0.2) and "packing" not in " ".join(lines):
            lines.append(f"packing {self.between(0.3, 1)}")
        if self.chance(0.2):
            turns = self.between(0, 60 / size)
            lines.append(f"twist {turns} {self.pick('Z', 'S')}{' rotate' if self.chance(0.1) else ''}")
        if self.chance(0.3):
            lines.append(f"color {self.count(0, 255)} {self.count(0, 255)} {self.count(0, 255)}")
        if self.chance(0.2):
            lines.append(f"material {self.material()}")
        self.random.shuffle(lines)
        self.add(f"thread {name}", *lines)
        self.finest = min(self.finest, size)
        self.threads.append(Thread(name, width, size, is_round))
        return self.threads[-1]

    def box(self, low, high, periodic, share=0.4):
        """A `cell`, in a share of the fabrics."""
        if not self.chance(share):
            return
        axes = [axis for axis in periodic if self.chance(0.9)]
        lines = [f"periodic {' '.join(axes)}"] if axes else []
        if self.chance(0.8):
            lines.append(f"matrix {self.material()}")
        self.add(f"cell {self.row(*low)}  {self.row(*high)}", *lines)

    # ---- constructions

    def system(self, threads, most=4):
        """(threads in turn, count) of warp or weft."""
        used = self.random.sample(threads, self.count(1, min(2, len(threads))))
        return used, len(used) * self.count(1, max(1, most // len(used)))

    def draft(self):
        form = self.pick("plain", "twill", "satin", "basket", "rows")
        if form == "plain":
            return "draft plain", 2, 2
        if form == "rows":
            width, height = self.count(1, 5), self.count(1, 5)
            rows = ["".join(self.pick("0", "1") for _ in range(width)) for _ in range(height)]
            return self.block("draft", *rows), width, height
        if form == "satin":
            ends, step = self.pick((5, 2), (5, 3), (7, 2), (8, 3))
            return f"draft satin {ends}/{step}", ends, ends
        a, b = self.count(1, 3), self.count(1, 2)
        return f"draft {form} {a}/{b}", a + b, a + b

    def weave(self):
        threads = [self.thread(self.between(0.15, 0.8))]
        if self.chance(0.4):
            threads.append(self.thread(threads[0].height * self.between(0.6, 1.5)))
        warp, weft = self.system(threads), self.system(threads)
        thickness = max(t.height for t in warp[0]) + max(t.height for t in weft[0])
        pitches = [
            (max(t.width for t in used) + 0.5 * thickness)
            * self.between(*((0.5, 1.2) if self.careless else (1.05, 2.2)))
            for used, _ in (warp, weft)
        ]
        draft, columns, rows = self.draft()
        profile, layers = self.pick("", "", "peirce", "sine", "sine A", "lenticular", "racetrack"), 1
        if profile == "sine A":
            profile = f"sine {self.mm(thickness * self.between(0.15, 0.4))}"
        lines = [
            f"{kind} {','.join(t.name for t in used)} {count} pitch {self.mm(pitch)}"
            for kind, (used, count), pitch in zip(("warp", "weft"), (warp, weft), pitches)
        ]
        lines.append(draft)
        if profile:
            lines.append(f"profile {profile}")
        if self.chance(0.15):
            lines.append(f"crimp {self.between(0, 1)}")
        if self.chance(0.15):
            layers = 2
            lines.append("layers 2")
        elif not profile and self.chance(0.35):
            return self.pile(lines, draft, threads, thickness)
        self.random.shuffle(lines)
        self.add("weave", *lines)
        size = [math.lcm(rows, len(weft[0])) * pitches[1], math.lcm(columns, len(warp[0])) * pitches[0]]
        if max(size[0] / pitches[1], size[1] / pitches[0]) <= 6:
            top = layers * thickness * self.between(0.55, 0.8)
            self.box((0, 0, -top), (*size, top), "xy")

    def pile(self, lines, draft, threads, thickness):
        """A weave of these lines with warp pile, or with weft pile in the place of its draft."""
        names = [t.name for t in threads]
        if len(names) > 1 and self.chance(0.4):
            used = ",".join(names[:1] + names[1:] * self.count(1, 3))
            lines[1] = " ".join(["weft", used] + lines[1].rsplit(" ", 3)[1:])
            lines[lines.index(draft)] = f"draft {self.pick('corduroy', 'velveteen')} {2 * self.count(2, 5)}"
        else:
            height = self.mm(thickness * self.between(0.5, 6))
            words = [f"pile {height}", self.pick("", names[-1]), self.pick("", f"every {self.count(3, 6)}")]
            lines.append(" ".join(filter(None, words + [self.pick("", "face", "back", "both"), self.pick("", "cut")])))
        self.random.shuffle(lines)
        self.add("weave", *lines)

    def stack(self):
        warp, weft = (self.thread(self.between(0.2, 0.6), flat=True) for _ in range(2))
        binder = self.thread(min(warp.height, weft.height) * self.between(0.4, 0.8))
        layers = self.count(1, 2)
        pitches = [
            warp.width + binder.width * self.between(1.2, 2),
            (weft.width + binder.height) * self.between(1.2, 2) + weft.height,
        ]
        counts = self.count(2, 4), self.count(2, 4)
        lines = [
            f"warp {warp.name} {counts[0]} pitch {self.mm(pitches[0])}",
            f"weft {weft.name} {counts[1]} pitch {self.mm(pitches[1])}",
            "profile straight",
        ]
        if layers > 1 or self.chance(0.5):
            lines.append(f"layers {layers}")
        top, repeat = layers + 1, 1
        for first in range(1, 1 + self.count(0, 2)):
            levels = self.pick(
                [top, 0],
                [0, top],
                list(range(top + 1)) + list(range(top - 1, 0, -1)),
                [top, max(0, top - 2)],
                [self.count(0, top) for _ in range(self.count(1, 3))],
            )
            lines.append(
                f"binder {binder.name} every {self.count(1, 2)} first {first} levels {' '.join(map(str, levels))}"
            )
            repeat = math.lcm(repeat, len(levels))
        self.random.shuffle(lines)
        self.add("weave", *lines)
        height = (layers * warp.height + (layers + 1) * weft.height) / 2 + 2.2 * binder.height
        if repeat <= 4:
            self.box(
                (pitches[1], pitches[0] * 0.9, -height), ((1 + repeat) * pitches[1], 2.9 * pitches[0], height), "xy"
            )

    def knit(self):
        thread = self.thread(self.between(0.1, 0.5), flat=False if self.chance(0.8) else None)
        courses, wales = self.count(2, 4), self.count(2, 3)
        form = self.pick("jersey", "purl", "rib 1x1", "rib 2x1", "chart")
        lines = [f"thread {thread.name}", f"courses {courses}", f"wales {wales}"]
        if self.chance(0.4):
            lines.append(f"method {self.pick('uniform', 'chord', 'centripetal')}")
        repeat = {"jersey": (1, 1), "purl": (1, 2), "rib 1x1": (2, 1), "rib 2x1": (3, 1)}.get(form)
        if form == "chart":
            width, height = self.count(1, 3), self.count(1, 3)
            signs = "KP" if self.chance(0.4) else "KKKPPTM" if not self.careless else "KPTM"
            lines.append(
                self.block("chart", *["".join(self.pick(*signs) for _ in range(width)) for _ in range(height)])
            )
            repeat = width, height
        self.add("knit" if form == "chart" else f"knit {form}", *lines)
        r = thread.height / 2
        self.box((8 * r * 0.6, 0, -3.1 * r), (8 * r * (0.6 + repeat[0]), 7 * r * repeat[1], 3.6 * r), "xy", 0.1)

    def warpknit(self):
        threads = [self.thread(self.between(0.08, 0.3), flat=False) for _ in range(self.count(1, 2))]
        thick = max(t.height for t in threads)
        lines, bars, head = [], 1, "warpknit"
        if self.chance(0.5):
            classic = self.pick("tricot", "cord", "satin", "velvet", "locknit", "queens-cord", "atlas")
            head, bars = f"warpknit {classic}", 2 if classic in ("locknit", "queens-cord") else 1
            lines.append(f"thread {threads[0].name}")
            if self.chance(0.4):
                lines.append(f"stitch {self.pick('open', 'closed')}")
        else:
            bars = self.count(1, 2)
            for i in range(bars):
                lapping = self.pick(*(LAPPINGS[:KNITTING] if i == 0 else LAPPINGS))
                lapping = self.pick(lapping, lapping + "//", lapping.replace("/", " "))
                fall_plate = " fall-plate" if self.chance(0.1) else ""
                lines.append(f"bar {self.pick(*threads).name} {lapping}{fall_plate}")
        loose = self.between(0.8, 1.3) if self.careless else self.between(1.05, 2)
        wales, courses = self.count(1, 3), self.count(2, 3)
        pitches = (2 * bars + 2) * thick * loose, (2 * bars + 4.4) * thick * loose
        lines += [f"wales {wales} pitch {self.mm(pitches[0])}", f"courses {courses} pitch {self.mm(pitches[1])}"]
        self.add(head, *lines)
        high = (2 + 3 * bars) * thick
        self.box((0, pitches[1] * 0.3, -high), (pitches[0], 2.3 * pitches[1], high), "xy", 0.1)

    def braid(self):
        thread = self.thread(self.between(0.1, 0.5))
        a = self.count(1, 3)
        angle = self.between(15, 65)
        axial = f"axial {self.thread(thread.height * self.between(0.5, 1.2)).name} {{}}" if self.chance(0.25) else None
        lines = [f"thread {thread.name}", f"angle {angle}"]
        if self.chance(0.4):
            carriers = self.count(2, 7)
            width = (carriers + 1) * thread.width / math.cos(math.radians(angle)) * self.between(1, 1.8)
            pattern = self.pick("1/1", "1/1", "2/2", "2/1")
            lines += [
                f"flat {self.mm(width)}" if self.chance(0.5) else "flat",
                f"length {self.mm(self.between(1, 3) * width)}",
            ]
            columns = carriers - 1
        else:
            b = self.pick(a, a, self.count(1, 3))
            carriers = math.lcm(2, a + b) * self.count(1, 2)
            pattern = f"{a}/{b}"
            room = 2 * carriers / 2 * (thread.width + thread.height) / math.cos(math.radians(angle))
            radius = (
                room / (2 * math.pi) * (self.between(0.5, 1) if self.careless else self.between(0.7, 2)) + thread.height
            )
            lines += [f"radius {self.mm(radius)}", f"length {self.mm(self.between(0.5, 1.5) * 2 * radius)}"]
            columns = carriers
        lines += [f"carriers {carriers}", f"pattern {pattern}"]
        if axial and columns > 0:
            lines.append(axial.format(self.count(1, max(1, columns // 2))))
        self.random.shuffle(lines)
        self.add("braid", *lines)

    # ---- yarns by hand

    def lane(self, number, step, rows):
        """The rows of a path that keeps to its lane, or of one that goes where it likes."""
        wander = self.careless or self.chance(0.25)
        points, x = [], 0.0
        for _ in range(rows):
            y = number * step * (0.5 if wander else 1) + self.random.uniform(-0.15, 0.15) * step * (4 if wander else 1)
            points.append((x, y, self.random.uniform(-0.4, 0.4) * step))
            x += self.random.uniform(1.2, 2.5) * step
        return points

    def path_yarn(self, thread, number, step):
        form = self.pick("", "chord", "uniform", "centripetal", "polyline", "control", "loop")
        rows = self.count(2, 6)
        closed = form != "loop" and self.chance(0.15)
        if closed:
            rows = max(rows, self.pick(3, 4, 6, 8))
            radius = step * self.between(1, 2) * (1 if rows > 4 else 1.5)
            turn = self.random.uniform(0, 1)
            points = [
                (
                    radius * math.cos(2 * math.pi * (i + turn) / rows),
                    radius * math.sin(2 * math.pi * (i + turn) / rows),
                    number * step + self.random.uniform(-0.1, 0.1) * step,
                )
                for i in range(rows)
            ]
        else:
            points = self.lane(number, step, rows)
        sized = self.chance(0.3)
        turned = sized and self.chance(0.4)
        lines = []
        for i, point in enumerate(points):
            line = self.row(*point)
            if sized and (i == 0 or self.chance(0.6)):
                line += " " + self.row(
                    thread.width * self.random.uniform(0.7, 1.2), thread.height * self.random.uniform(0.7, 1.2)
                )
                if turned and self.chance(0.7):
                    line += f" {self.between(-90, 90)}"
            if self.chance(0.05):
                line += " fixed"
            lines.append(line)
        head = (
            [f"role {self.pick('warp', 'weft', 'wale', 'course', 'braider', 'axial', 'binder', 'other')}"]
            if self.chance(0.5)
            else []
        )
        if closed:
            head.append("closed")
        else:
            if self.chance(0.15):
                head.append(
                    f"tangent {self.pick('start', 'end')} 1 {self.between(-0.5, 0.5)} {self.between(-0.5, 0.5)}"
                )
            if self.chance(0.15):
                head.append(f"ends {self.pick('patch', 'fan', 'planar', 'patch fan', 'fan planar')}")
        if self.chance(0.1):
            head.append(f"up {self.between(-0.5, 0.5)} {self.between(-0.5, 0.5)} 1")
        name = self.name(f"y{number}")
        self.add(f"yarn {name} {thread.name}", *head, self.block(f"path {form}".strip(), *lines))
        joints = len(points) - 2 if form == "control" else 2 * len(points) - 4 if form == "loop" else len(points)
        if form != "polyline" and not closed and joints >= 3 and self.chance(0.2):
            self.edit(name, points, joints, step)

    def edit(self, name, points, joints, step):
        joint = self.count(2, joints - 1)
        near = points[min(joint - 1, len(points) - 1)]
        target = self.row(near[0], near[1], near[2] + self.random.uniform(-0.2, 0.2) * step)
        if self.chance(0.6):
            self.blocks.append(f"edit {name} {self.pick('point', 'point', 'weight')} {joint} to {target}")
        else:
            length = sum(math.dist(a, b) for a, b in zip(points, points[1:]))
            self.blocks.append(
                f"edit {name} length {self.mm(length * self.between(1.02, 1.2))} point {joint} along 0 0 1"
            )

    def free(self):
        threads = [self.thread(self.between(0.1, 1)) for _ in range(self.count(1, 2))]
        step = 1.6 * max(max(t.width, t.height) for t in threads)
        for number in range(self.count(1, 4)):
            self.path_yarn(self.pick(*threads), number, step)

    def bundle(self):
        """Plies and filaments, and what runs straight through a cell."""
        size = self.between(0.2, 0.8)
        lines = (
            [f"diameter {self.mm(size)}"]
            if self.chance(0.8)
            else [f"section ellipse {self.mm(2 * size)} {self.mm(size)}"]
        )
        if self.chance(0.7) and lines[0].startswith("diameter"):
            lines.append(f"plies {self.count(2, 4)} {self.between(0, 250 / size)} {self.pick('Z', 'S')}")
        if len(lines) == 1 or self.chance(0.3):
            lines.append(f"filaments {self.count(2, 9)}")
            lines.append(f"packing {self.between(0.3, 0.75)}")
        if self.chance(0.5) and not lines[0].startswith("section"):
            lines.append(f"twist {self.between(0, 150 / size)} {self.pick('Z', 'S')}")
        self.add("thread bundle", *lines)
        self.finest = min(self.finest, size / 5)
        thread = Thread("bundle", size, size, True)
        for number in range(self.count(1, 2)):
            points = [
                (4 * size * i, 3 * size * number, self.random.uniform(-0.3, 0.3) * size)
                for i in range(self.count(2, 4))
            ]
            self.add(f"yarn y{number} {thread.name}", self.block("path", *[self.row(*p) for p in points]))

    def grid(self):
        for number in range(self.count(1, 3)):
            self.grid_yarn(number)

    def grid_yarn(self, number):
        """Sections that are stars about a middle which wanders along x."""
        size = self.between(0.3, 1.5)
        self.finest = min(self.finest, 0.6 * size)
        sections, around = self.count(2, 7), self.count(4, 10)
        ring = sections >= 4 and self.chance(0.2)
        open_round = self.chance(0.3)
        weighted = self.chance(0.4)
        words = []
        degree_along = min(3, sections - 1)
        if self.chance(0.3) and not ring:
            degree_along = self.count(1, min(4, sections - 1))
            words.append(f"degree {degree_along} along")
        if self.chance(0.3) and not ring:
            knots, value = [0.0] * (degree_along + 1), 0.0
            for _ in range(sections - degree_along):
                value += self.between(0.3, 2)
                knots.append(value)
            knots += [value] * degree_along
            words.append("knots along " + " ".join(f"{k:.6g}" for k in knots))
        if self.chance(0.2):
            words.append(f"degree {self.count(2, 3)} round")
        if open_round:
            words.append("open round")
            around += 1
        if ring:
            words.append("closed")
        self.random.shuffle(words)
        rows = []
        for s in range(sections):
            wide, high = (size * self.random.uniform(0.8, 1.1) for _ in range(2))
            shift = [self.random.uniform(-0.15, 0.15) * size for _ in range(2)]
            corners = around - 1 if open_round else around
            turn = self.random.uniform(0, 0.2)
            ring_angle = 2 * math.pi * s / sections
            section = []
            for i in range(corners):
                angle = turn + 2 * math.pi * i / corners
                across, up = wide / 2 * math.cos(angle) + shift[0], high / 2 * math.sin(angle) + shift[1]
                if ring:
                    radius = 2.5 * size - across  # outward normals as along x
                    point = radius * math.sin(ring_angle), 6 * size * number - radius * math.cos(ring_angle), up
                else:
                    point = 1.5 * size * s, across + 3 * size * number, up
                weight = f" {self.between(0.5, 2)}" if weighted and self.chance(0.5) else ""
                section.append(self.row(*point) + weight)
            if open_round:
                section.append(section[0])
            rows += section
        lines = [f"role {self.pick('warp', 'weft')}"] if self.chance(0.3) else []
        if not ring and self.chance(0.2):
            lines.append(f"ends {self.pick('patch', 'fan')}")
        self.add(f"yarn g{number}", *lines, self.block(f"grid {sections} {around}", *words, *rows))

    # ---- the rest

    def piece(self):
        width, height = self.between(20, 400), self.between(20, 400)
        corners = [
            (0, 0),
            (width, self.between(-5, 5)),
            (width + self.between(-8, 8), height),
            (self.between(-8, 8), height),
        ]
        lines = []
        for i, (start, end) in enumerate(zip(corners, corners[1:] + corners[:1])):
            if self.chance(0.5):
                lines.append(f"line side_{i} {self.row(*start)} {self.row(*end)}")
                continue
            count = self.count(3, 6)
            bulge = self.random.uniform(-0.15, 0.15)
            across = end[1] - start[1], start[0] - end[0]
            rows = []
            for k in range(count):
                t = k / (count - 1)
                b = bulge * 4 * t * (1 - t)
                rows.append(self.row(*[start[d] + t * (end[d] - start[d]) + b * across[d] for d in range(2)]))
            control = " control" if count == 4 and self.chance(0.3) else ""
            lines.append(self.block(f"curve side_{i}{control}", *rows))
        self.add(f"piece {self.name('front')}", *lines)

    def mixed(self):
        """Several kinds of blocks in one file."""
        for family in self.random.sample(["free", "grid", "piece"], 2):
            getattr(self, family)()
        self.box((-1, -1, -1), (2, 2, 2), "", 0.2)


def fabric(seed, family=None):
    """(family, text) of a seed."""
    maker = Maker(seed, family)
    return maker.family, maker.text()


if __name__ == "__main__":
    import sys

    print(fabric(int(sys.argv[1]), *sys.argv[2:])[1], end="")
