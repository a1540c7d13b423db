"""Constructions whose yarns cross with sharp or not quite round sections: no two overlap, and nothing is warned of."""

import json
import unittest

from program import Case, run

TRIANGLE = """thread t
  section polygon
    0.297935381 0.077312
    -0.257432955 0.120616
    -0.040502426 -0.197927
  end
end
"""
BRAID = "braid\n  thread t\n{}end\n"
TEXTS = {
    # Edges of two braiders cross between the places where the gap is sampled.
    "edges": "fabric 1\n"
    + TRIANGLE
    + BRAID.format("  carriers 6\n  pattern 3/3\n  radius 2.08435543\n  angle 46.6\n  length 2.40951487\n"),
    # The flat side of a tape shows the round yarn inside only from the round one.
    "flat side": "fabric 1\nthread t\n  section racetrack 0.6944 0.248\nend\nthread a\n  diameter 0.232872\nend\n"
    + BRAID.format(
        "  axial a 1\n  carriers 4\n  pattern 1/1\n  radius 1.65070829\n  angle 45.8\n  length 4.42389823\n"
    ),
    # Seven spans round the section are no circle, and its tolerance is large.
    "loop7": "fabric 1\ntolerance 0.0034874\nthread t\n  section loop7 0.329\nend\n"
    + BRAID.format("  flat\n  carriers 5\n  pattern 1/1\n  angle 23.7\n  length 3\n"),
    # A binder goes round the edge of a weft.
    "binder": """fabric 1
thread t0
  section circle 0.202
end
thread t1
  section polygon
    0.387875638 0.247548781
    -0.894971972 -0.021049572
    0.507096333 -0.226499209
  end
end
thread t2
  diameter 0.0929
end
weave
  binder t2 every 1 first 1 levels 0 2
  profile straight
  warp t0 2 pitch 0.37800058
  layers 1
  weft t1 4 pitch 3.0982752
end
""",
    # Straight layers of loop7, of which one turns.
    "layers": """fabric 1
tolerance 0.001
thread t0
  section loop7 0.458
  twist 19 S rotate
end
thread t1
  section loop7 0.32
end
weave
  warp t0 3 pitch 1.5645
  profile straight
  weft t1 2 pitch 1.1372
  layers 2
end
""",
}


class Clearances(Case):
    def test_yarns_keep_apart(self):
        for name, text in TEXTS.items():
            with self.subTest(name):
                text_file, report = self.folder / "text.txt", self.folder / "report.json"
                text_file.write_text(text)
                run("check", text_file, "--report", report)
                entry = json.loads(report.read_text())["inputs"][0]
                self.assertEqual([(o["a"], o["b"], o["depth"]) for o in entry["overlaps"]], [])
                self.assertEqual([m["text"] for m in entry["messages"] if m["severity"] != "note"], [])
                self.assertTrue(entry["ok"])


if __name__ == "__main__":
    unittest.main()
