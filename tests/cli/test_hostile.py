"""Small files that ask for endless work, or for what nobody should read: each ends soon, within bounds, with its place.

The table is every command that reads a file times every such file, and is printed with its exit codes. Ended soon: within
SECONDS of processor time, of all processes of the run; what goes on is stopped by `--timeout` of the program, with a wide
margin (`edit` has no such option and is given processor time).
More inputs from outside are run where their folder is present, and the run says so.
"""

import os
import re
import resource
import subprocess
import sys
import unittest

from program import Case, GRID, PATH, PROGRAM, ROOT, environment, run, start

OUTSIDE = ROOT.parent / "shared" / "fixtures" / "hostile"
SECONDS = 10
TIMEOUT = 60
MEGABYTES = 2000
THREAD = "fabric 1\nthread a\n  diameter 0.4\nend\n"
CELL = "cell 0 0 -1 4 4 1\n  periodic x y\nend\n"


def weave(system="2 pitch 2", rest=" draft plain\n", more=""):
    return THREAD + f"weave\n warp a {system}\n weft a 2 pitch 2\n{rest}end\n" + more


def path(thread, rows=" 0 0 0\n 1 0 0\n", more=""):
    return f"fabric 1\nthread a\n{thread}end\nyarn x a\n path\n{rows} end\nend\n" + more


# The text, and the message's place and words.
REFUSED = {
    "density_in_kg": (
        path("  tex 15\n  density 1520\n  packing 0.5\n"),
        r":4:11: error: a density of 1520 g/cm3 is far outside .* 25 g/cm3: if these are kg/m3, write 1\.52",
    ),
    "twist": (path("  diameter 0.4\n  twist 1e9 Z rotate\n"), r":4:9: error: a twist of 1e\+09 turns per metre"),
    "tex": (path("  tex 3e10\n  density 1.5\n  packing 0.5\n"), r":3:7: error: a linear density of 3e\+10 g/km"),
    "ne": (path("  Ne 1e-9\n  density 1.5\n  packing 0.5\n"), r":3:6: error: a linear density of .* g/km"),
    "modulus_in_pa": (
        "fabric 1\nmaterial m\n elastic isotropic 72e9 0.2\nend\n"
        + THREAD[9:]
        + "yarn x a\n path\n 0 0 0\n 1 0 0\n end\nend\n",
        r":3:20: error: a modulus of 7\.2e\+10 MPa .*: if these are Pa, write 72000",
    ),
    "nanometres": (path("  diameter 1e-6\n"), r":2:1: error: a section's size of 1e-06 mm"),
    "light_years": (path("  diameter 0.4\n", " 0 0 0\n 1e300 0 0\n"), r":8:2: error: a coordinate of 1e\+300 mm"),
    "fine_tolerance": (
        "fabric 1\ntolerance 1e-300\n" + path("  diameter 0.4\n")[9:],
        r":1:1: error: a tolerance of 1e-300 mm",
    ),
    "weave_pitch": (
        weave("2 pitch 9.2e18"),
        r":6:17: error: the pitch '9\.2e18' is \d\.\d+e\+19 times the width of the yarn",
    ),
    "weave_tiny_pitch": (weave("2 pitch 1e-300"), r":6:2: error: a pitch of 1e-300 mm is out of all proportion"),
    "weave_count": (weave("2147483647 pitch 2"), r":5:1: error: this would be .* yarns through .* data points"),
    "weave_layers": (
        weave(rest=" profile straight\n layers 100000000\n binder a every 1 levels 3 0\n"),
        r":5:1: error: 100000000 layers are more than the 100000",
    ),
    "weave_cell": (
        weave(more="cell 0 0 -1 1e300 4 1\n periodic x y\nend\n"),
        r":10:1: error: a coordinate of 1e\+300 mm",
    ),
    "twill": (weave(rest=" draft twill 2147483647/2147483647\n"), r":8:2: error: a draft of 4294967294 x 4294967294"),
    "knit_rib": (
        THREAD + "knit rib 2147483647x2147483647\n thread a\n courses 2\n wales 2\nend\n",
        r":5:1: error: a rib 2147483647x2147483647 begins anew after 4294967294 wales",
    ),
    "knit_wales": (
        THREAD + "knit jersey\n thread a\n courses 2147483647\n wales 2147483647\nend\n" + CELL,
        r":5:1: error: this would be .* data points",
    ),
    "braid_length": (
        THREAD + "braid\n thread a\n carriers 4\n pattern 1/1\n radius 2\n angle 40\n length 1e5\nend\n",
        r":5:1: error: one of its yarns would have .* data points",
    ),
    "braid_radius": (
        THREAD + "braid\n thread a\n carriers 4\n pattern 1/1\n radius 1e300\n angle 40\n length 10\nend\n",
        r":9:9: error: a radius of 1e\+300 mm is out of all proportion",
    ),
    "plies": (
        path("  diameter 0.5\n  plies 3000 100 Z\n  filaments 3000\n"),
        r":7:1: error: this would be 9000000 yarns .*`--detail yarn`",
    ),
    "draft_device": (
        weave(rest=" draft file /dev/zero\n"),
        r":8:2: error: no draft in the file '/dev/zero': .*--allow-outside",
    ),
    "draft_outside": (
        weave(rest=" draft file ../../outside.wif\n"),
        r":8:2: error: no draft in the file '\.\./\.\./outside\.wif'",
    ),
    "draft_geometry": (
        weave(rest=" draft file yarns.igs\n"),
        r":8:2: error: no draft in the file 'yarns.igs': it is iges",
    ),
}
# What can be read, and has to be.
READ = {
    "names": 'fabric 1\ntolerance 0.05\nyarn "a\\X2\\0041\\X0\\b"\n diameter 0.4\n path polyline\n 0 0 0\n 0 1 0\n end\nend\n',
}


def commands(source, folder):
    """Every command that reads a text."""
    yield "info", ("info", source)
    yield "check", ("check", source)
    yield "convert", ("convert", source, "-o", folder / "o.igs")
    yield "mesh", ("mesh", source, "-o", folder / "o.inp")
    yield "relax", ("relax", source, "-o", folder / "o.txt")
    yield "view", ("view", source, "-o", folder / "o.png", "--size", "64x48")
    yield "roundtrip", ("roundtrip", source)
    yield "diff", ("diff", source, source)
    yield "edit", ("edit", source, "--yarn", "x", "--point", "1", "--to", "0,0,0", "-o", folder / "e.txt")


def model_commands(source, folder):
    """Every command that reads a file of another program."""
    return [pair for pair in commands(source, folder) if pair[0] not in ("relax", "edit")]


def processor_time():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def within_bounds(command, arguments):
    """The run, with the processor time that it took as `seconds`."""
    before = processor_time()
    if command == "edit":

        def limit():
            resource.setrlimit(resource.RLIMIT_AS, (MEGABYTES << 20, MEGABYTES << 20))
            resource.setrlimit(resource.RLIMIT_CPU, (SECONDS, SECONDS))

        done = subprocess.run(
            [PROGRAM, *map(str, arguments)],
            capture_output=True,
            text=True,
            errors="replace",
            env=environment(),
            stdin=subprocess.DEVNULL,
            preexec_fn=limit,
        )
    else:
        done = run(*arguments, "--memory", MEGABYTES, "--timeout", TIMEOUT)
    done.seconds = processor_time() - before
    return done


def swapped(text, entity, old, new):
    """With the first reference of the first such entity to an `old` pointing to the first `new`."""
    kinds = dict(re.findall(r"(?m)^(#\d+) = ([A-Z0-9_]+)", text))
    other = next(number for number, kind in kinds.items() if kind == new)
    for match in re.finditer(rf"(?ms)^#\d+ = {entity}\((.*?);$", text):
        for reference in re.finditer(r"#\d+", match.group(1)):
            if kinds.get(reference.group()) == old:
                at = match.start(1) + reference.start()
                return text[:at] + other + text[at + len(reference.group()) :]
    raise AssertionError(f"no {entity} refers to a {old}")


def exponential(text, levels=40):
    """The assembly in another, twice, and that in another, twice ..."""
    top, context = re.search(r"(?m)^(#\d+) = PRODUCT_DEFINITION\([^;]*(#\d+)\);", text).groups()
    product_context = re.search(r"(?m)^(#\d+) = PRODUCT_CONTEXT", text).group(1)
    rows, number = [], 1000000
    for level in range(levels):
        rows += [
            f"#{number} = PRODUCT('l{level}','l{level}','',({product_context}));",
            f"#{number + 1} = PRODUCT_DEFINITION_FORMATION('','',#{number});",
            f"#{number + 2} = PRODUCT_DEFINITION('design','',#{number + 1},{context});",
            f"#{number + 3} = NEXT_ASSEMBLY_USAGE_OCCURRENCE('1','a','',#{number + 2},{top},$);",
            f"#{number + 4} = NEXT_ASSEMBLY_USAGE_OCCURRENCE('2','b','',#{number + 2},{top},$);",
        ]
        top, number = f"#{number + 2}", number + 5
    end = text.rindex("ENDSEC;")
    return text[:end] + "\n".join(rows) + "\n" + text[end:]


def heavy(text):
    """With one weight of 1e9 in the middle of the first surface, which says that it is rational."""
    lines = text.split("\n")
    first = next(k for k, line in enumerate(lines) if line.startswith("128,") and line[72] == "P")
    values = lines[first].split(",")
    values[7] = "0"  # PROP3
    lines[first] = ",".join(values)
    weights = [
        k for k, line in enumerate(lines) if line[:64].rstrip() == "1.," * 21 and line[64:72] == lines[first][64:72]
    ]
    middle = weights[len(weights) // 2]
    lines[middle] = "1.,1.,1E9," + "1.," * 18 + lines[middle][64:]
    return "\n".join(lines)


def crossing(count):
    """Straight yarns in one plane, each through all of the other direction."""
    rows = [
        f"yarn {d}{k} a\n path polyline\n {start}\n {end}\n end\nend\n"
        for k in range(count)
        for d, start, end in (
            ("x", f"0 {k + 1} 0", f"{count + 1} {k + 1} 0"),
            ("y", f"{k + 1} 0 0", f"{k + 1} {count + 1} 0"),
        )
    ]
    return THREAD + "".join(rows)


# Exit codes where it is not 1 for all: 2 and 3 are defects that were found, 0 is read and done.
WRONG = dict.fromkeys(("info", "check", "convert", "mesh", "view", "roundtrip", "diff"), 1)
READABLE = {"info": 0, "check": 3, "convert": 0, "mesh": 1, "view": 0, "roundtrip": 0, "diff": 0}
MODELS = {
    "edge_without_vertex.stp": (WRONG, r":\d+:\d+: error: #\d+: attribute 2 of EDGE_CURVE is "),
    "loop_of_points.stp": (WRONG, r":\d+:\d+: error: #\d+: attribute 2 of EDGE_LOOP "),
    "face_on_its_shell.stp": (WRONG, r":\d+:\d+: error: #\d+ refers to itself, by way of #\d+"),
    "exponential.stp": (WRONG, r":\d+:\d+: error: #\d+: 1099511627776 instances of this product, more than 1000000"),
    "heavy.igs": (READABLE | {"roundtrip": 1}, ""),  # the weight folds the surface: no solid of STEP
    "crossing.igs": (READABLE, ""),
}


class Hostile(Case):
    def table(self, rows):
        """Prints the exit codes of {input: {command: code}}."""
        names = ("info", "check", "convert", "mesh", "relax", "view", "roundtrip", "diff", "edit")
        width = max(map(len, rows))
        print("\n" + " " * width, *names, file=sys.stderr)
        for name, codes in rows.items():
            print(name.ljust(width), *(str(codes.get(n, "-")).rjust(len(n)) for n in names), file=sys.stderr)

    def ended_soon(self, done):
        self.assertNotRegex(done.stderr, "was stopped|crash|unexpected")
        self.assertLess(done.seconds, SECONDS)

    def models(self):
        """Files of STEP and IGES of our own, made wrong."""
        for name in ("base.stp", "base.igs"):
            self.succeeds("convert", GRID, "-o", self.folder / name, "--quiet")
        step, iges = ((self.folder / name).read_text() for name in ("base.stp", "base.igs"))
        (self.folder / "crossing.txt").write_text(crossing(4))
        self.succeeds("convert", self.folder / "crossing.txt", "-o", self.folder / "crossing.igs", "--quiet")
        for name, text in (
            ("edge_without_vertex.stp", swapped(step, "EDGE_CURVE", "VERTEX_POINT", "CARTESIAN_POINT")),
            ("loop_of_points.stp", swapped(step, "EDGE_LOOP", "ORIENTED_EDGE", "VERTEX_POINT")),
            ("face_on_its_shell.stp", swapped(step, "ADVANCED_FACE", "B_SPLINE_SURFACE_WITH_KNOTS", "CLOSED_SHELL")),
            ("exponential.stp", exponential(step)),
            ("heavy.igs", heavy(iges)),
        ):
            (self.folder / name).write_text(text)

    def test_models(self):
        self.models()
        rows = {}
        for name, (codes, pattern) in MODELS.items():
            source = self.folder / name
            for command, arguments in model_commands(source, self.folder):
                with self.subTest(name=name, command=command):
                    done = within_bounds(command, arguments)
                    rows.setdefault(name, {})[command] = done.returncode
                    self.ended_soon(done)
                    self.assertEqual(done.returncode, codes[command], done.stderr)
                    if codes is WRONG:
                        self.assertRegex(done.stderr, re.escape(name) + pattern)
        self.table(rows)

    def test_what_is_no_file(self):
        """A device, and a pipe that nobody writes to: the commands wait for it at the same time."""
        for command, arguments in commands("/dev/zero", self.folder):
            with self.subTest(command=command):
                done = within_bounds(command, arguments)
                self.assertEqual(done.returncode, 1)
                self.assertIn("/dev/zero: error: this is a device, not a file", done.stderr)
        pipe = self.folder / "pipe.txt"
        os.mkfifo(pipe)
        for command, process in [(command, start(*arguments)) for command, arguments in commands(pipe, self.folder)]:
            with self.subTest(command=command):
                _, errors = process.communicate(timeout=300)
                self.assertEqual(process.returncode, 1)
                self.assertIn("pipe.txt: error: nothing has opened this pipe to write to it within 10 s", errors)

    def test_what_is_refused(self):
        self.succeeds("convert", PATH, "-o", self.folder / "yarns.igs", "--quiet")
        rows = {}
        for name, (text, pattern) in REFUSED.items():
            source = self.folder / f"{name}.txt"
            source.write_text(text)
            for command, arguments in commands(source, self.folder):
                if name == "plies":
                    if command == "edit":  # works on the yarn as one
                        continue
                    arguments = [*arguments, "--detail", "filaments"]
                with self.subTest(name=name, command=command):
                    done = within_bounds(command, arguments)
                    rows.setdefault(source.name, {})[command] = done.returncode
                    self.ended_soon(done)
                    self.assertEqual(done.returncode, 1, done.stderr)
                    self.assertRegex(done.stderr, re.escape(source.name) + pattern)
                    self.assertLess(len(done.stderr), 10000)
        self.table(rows)
        self.assertEqual([path.name for path in self.folder.iterdir() if path.name[:2] in ("o.", "e.")], [])

    def test_what_can_be_read(self):
        for name, text in READ.items():
            source = self.folder / f"{name}.txt"
            source.write_text(text)
            for command, arguments in commands(source, self.folder):
                if command in ("mesh", "edit"):
                    continue
                with self.subTest(name=name, command=command):
                    done = within_bounds(command, arguments)
                    self.assertEqual(done.returncode, 0, done.stderr)

    def test_inputs_from_outside(self):
        """The exit codes of files that are not ours to copy; only where they are."""
        if not OUTSIDE.is_dir():
            print("no inputs from outside: the table above is all", file=sys.stderr)
            return
        print(f"with the inputs of {OUTSIDE}", file=sys.stderr)
        readable = {"bs.txt", "slow_check.igs", "heavy_weight.igs"}
        for source in sorted(OUTSIDE.iterdir()):
            for command, arguments in (
                ("info", ("info", source)),
                ("check", ("check", source)),
                ("convert", ("convert", source, "--to", "iges", "-o", str(self.folder / "out") + "/")),
            ):
                with self.subTest(source.name, command=command):
                    done = within_bounds(command, arguments)
                    self.assertNotRegex(done.stderr, "was stopped|crash|more memory")
                    if source.name not in readable:
                        self.assertEqual(done.returncode, 1, done.stderr)
                        self.assertRegex(done.stderr, re.escape(source.name) + r":\d+:(\d+:)? error: ")
                    elif command != "check":
                        self.assertEqual(done.returncode, 0, done.stderr)


if __name__ == "__main__":
    unittest.main()
