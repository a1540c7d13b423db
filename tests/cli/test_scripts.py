"""The scripts that people call first tell how far they are where nobody watches a terminal."""

import os
import subprocess
import unittest

from program import Case, ROOT, environment

# Stands for ninja: half way, until somebody opens the pipe `go`.
NINJA = """#!/bin/sh
echo "[7/20] Building something"
read line < "$SELVAGE_BUILD/go"
exit 0
"""


class Progress(Case):
    def test_a_build_is_not_silent(self):
        programs, build = self.folder / "programs", self.folder / "build"
        for path, text in ((programs / "ninja", NINJA), (build / "bin" / "selvage", "#!/bin/sh\necho run: $*\n"),
                           (build / "build.ninja", "")):
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text)
            path.chmod(0o755)
        os.mkfifo(build / "go")
        running = subprocess.Popen([ROOT / "scripts" / "run", "formats"], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                   text=True, env=environment(PATH=f"{programs}:{os.environ['PATH']}", SELVAGE_BUILD=str(build)))
        self.addCleanup(running.kill)
        self.assertEqual(running.stderr.readline(), "building: [7/20]\n")
        (build / "go").write_text("go\n")
        out, rest = running.communicate()
        self.assertEqual((running.returncode, out), (0, "run: formats\n"), rest)


if __name__ == "__main__":
    unittest.main()
