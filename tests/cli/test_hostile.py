"""Small files that ask for endless work, or for what nobody should read: each ends soon, within bounds, with its place.

The table below is every command that reads a file times every such file. Ended soon: `--timeout` of the program itself, with a wide margin,
stops what goes on, which is then the wrong message and exit code; `edit` has no such option and is given processor time.
More inputs from outside are run where their folder is present, and the run says so.
"""

import json
import os
import re
import resource
import subprocess
import sys
import unittest

from program import Case, PATH, PROGRAM, ROOT, environment, run

OUTSIDE = ROOT.parent / "shared" / "fixtures" / "hostile"
SECONDS = 60
MEGABYTES = 2000
THREAD = "fabric 1\nthread a\n  diameter 0.4\nend\n"
CELL = "cell 0 0 -1 4 4 1\n  periodic x y\nend\n"


def weave(system="2 pitch 2", rest=" draft plain\n", more=""):
    return THREAD + f"weave\n warp a {system}\n weft a 2 pitch 2\n{rest}end\n" + more


def path(thread, rows=" 0 0 0\n 1 0 0\n", more=""):
    return f"fabric 1\nthread a\n{thread}end\nyarn x a\n path\n{rows} end\nend\n" + more


# The text, and the message's place and words.
REFUSED = {
    "density_in_kg": (path("  tex 15\n  density 1520\n  packing 0.5\n"),
                      r":4:11: error: a density of 1520 g/cm3 is far outside .* 25 g/cm3: if these are kg/m3, write 1\.52"),
    "twist": (path("  diameter 0.4\n  twist 1e9 Z rotate\n"), r":4:9: error: a twist of 1e\+09 turns per metre"),
    "tex": (path("  tex 3e10\n  density 1.5\n  packing 0.5\n"), r":3:7: error: a linear density of 3e\+10 g/km"),
    "ne": (path("  Ne 1e-9\n  density 1.5\n  packing 0.5\n"), r":3:6: error: a linear density of .* g/km"),
    "modulus_in_pa": ("fabric 1\nmaterial m\n elastic isotropic 72e9 0.2\nend\n" + THREAD[9:] + "yarn x a\n path\n 0 0 0\n 1 0 0\n end\nend\n",
                      r":3:20: error: a modulus of 7\.2e\+10 MPa .*: if these are Pa, write 72000"),
    "nanometres": (path("  diameter 1e-6\n"), r":2:1: error: a section's size of 1e-06 mm"),
    "light_years": (path("  diameter 0.4\n", " 0 0 0\n 1e300 0 0\n"), r":8:2: error: a coordinate of 1e\+300 mm"),
    "fine_tolerance": ("fabric 1\ntolerance 1e-300\n" + path("  diameter 0.4\n")[9:], r":1:1: error: a tolerance of 1e-300 mm"),
    "weave_pitch": (weave("2 pitch 9.2e18"), r":6:2: error: a pitch of 9\.2e\+18 mm is out of all proportion"),
    "weave_tiny_pitch": (weave("2 pitch 1e-300"), r":6:2: error: a pitch of 1e-300 mm is out of all proportion"),
    "weave_count": (weave("2147483647 pitch 2"), r":5:1: error: this would be .* yarns through .* data points"),
    "weave_layers": (weave(rest=" profile straight\n layers 100000000\n binder a every 1 levels 3 0\n"),
                     r":5:1: error: 100000000 layers are more than the 100000"),
    "weave_cell": (weave(more="cell 0 0 -1 1e300 4 1\n periodic x y\nend\n"), r":10:1: error: a coordinate of 1e\+300 mm"),
    "twill": (weave(rest=" draft twill 2147483647/2147483647\n"), r":8:2: error: a draft of 4294967294 x 4294967294"),
    "knit_rib": (THREAD + "knit rib 2147483647x2147483647\n thread a\n courses 2\n wales 2\nend\n",
                 r":5:1: error: a rib 2147483647x2147483647 begins anew after 4294967294 wales"),
    "knit_wales": (THREAD + "knit jersey\n thread a\n courses 2147483647\n wales 2147483647\nend\n" + CELL,
                   r":5:1: error: this would be .* data points"),
    "braid_length": (THREAD + "braid\n thread a\n carriers 4\n pattern 1/1\n radius 2\n angle 40\n length 1e5\nend\n",
                     r":5:1: error: one of its yarns would have .* data points"),
    "braid_radius": (THREAD + "braid\n thread a\n carriers 4\n pattern 1/1\n radius 1e300\n angle 40\n length 10\nend\n",
                     r":9:9: error: a radius of 1e\+300 mm is out of all proportion"),
    "plies": (path("  diameter 0.5\n  plies 3000 100 Z\n  filaments 3000\n"),
              r":7:1: error: this would be 9000000 yarns .*`--detail yarn`"),
    "draft_device": (weave(rest=" draft file /dev/zero\n"), r":8:2: error: no draft in the file '/dev/zero': .*--allow-outside"),
    "draft_outside": (weave(rest=" draft file ../../outside.wif\n"), r":8:2: error: no draft in the file '\.\./\.\./outside\.wif'"),
    "draft_geometry": (weave(rest=" draft file yarns.igs\n"), r":8:2: error: no draft in the file 'yarns.igs': it is iges"),
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


def within_bounds(command, arguments):
    if command != "edit":
        return run(*arguments, "--memory", MEGABYTES, "--timeout", SECONDS)

    def limit():
        resource.setrlimit(resource.RLIMIT_AS, (MEGABYTES << 20, MEGABYTES << 20))
        resource.setrlimit(resource.RLIMIT_CPU, (SECONDS, SECONDS))
    return subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True, errors="replace", env=environment(),
                          stdin=subprocess.DEVNULL, preexec_fn=limit)


class Hostile(Case):
    def test_what_is_refused(self):
        self.succeeds("convert", PATH, "-o", self.folder / "yarns.igs", "--quiet")
        for name, (text, pattern) in REFUSED.items():
            source = self.folder / f"{name}.txt"
            source.write_text(text)
            for command, arguments in commands(source, self.folder):
                if (name, command) == ("plies", "edit"):  # works on the yarn as one
                    continue
                with self.subTest(name=name, command=command):
                    done = within_bounds(command, arguments)
                    self.assertEqual(done.returncode, 1, done.stderr)
                    self.assertRegex(done.stderr, re.escape(source.name) + pattern)
                    self.assertLess(len(done.stderr), 10000)
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
            for command, arguments in (("info", ("info", source)), ("check", ("check", source)),
                                       ("convert", ("convert", source, "--to", "iges", "-o", str(self.folder / "out") + "/"))):
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
