"""Plain weaves in equilibrium against SciPy's SLSQP: the same energy and inequalities, discretized anew (cubic splines through
heights at even places of a quarter wave, sections at crossings and half way), from the formulas of the documentation alone.

Needs the system's Python with numpy and scipy.
"""

import json
import math
import re
import unittest

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.optimize import minimize

from program import Case, ROOT

TEXT = """fabric 1
units mm
tolerance 0.0001
thread warp
  tex {warp_tex}
  density 1.52
  packing 0.6
  twist Z {warp_twist}/m
end
thread weft
  tex {weft_tex}
  density 1.52
  packing 0.6
  twist Z {weft_twist}/m
end
weave
  warp  warp 4 pitch {warp_pitch}
  weft  weft 4 pitch {weft_pitch}
  draft plain
  state {state}
{more}end
"""
# warp tex, weft tex, turns a metre of both, pitches of both, state, thickness over the free one
CLOTHS = (
    (20, 20, 800, 800, 0.40, 0.40, "finished", None),
    (20, 20, 800, 700, 0.32, 0.38, "loom", None),
    (20, 20, 800, 700, 0.32, 0.38, "relaxed", None),
    (30, 20, 600, 700, 0.36, 0.42, "finished", None),
    (15, 30, 900, 500, 0.30, 0.45, "loom", None),
    (20, 20, 200, 200, 0.42, 0.42, "finished", None),
    (20, 20, 400, 900, 0.40, 0.44, "relaxed", None),
    (60, 60, 400, 400, 0.70, 0.80, "finished", None),
    (10, 10, 1200, 1200, 0.25, 0.30, "loom", None),
    (20, 20, 800, 800, 0.40, 0.40, "finished", 0.85),
)
PIECES = 20  # of a quarter wave
PLACES = 16  # of contact, along each yarn


def constants():
    text = (ROOT / "src/mechanics/constants.h").read_text()
    return {
        name: float(re.search(rf"{name} = ([\d.e-]+);", text)[1])
        for name in (
            "bending",
            "loom_tension",
            "flattening",
            "packing",
            "compaction",
            "pressure",
            "cohesion",
            "relaxed_tension",
        )
    }


class Profile:
    """Heights, slopes and second derivatives at places of half a gap, as matrices on the heights of its nodes: level at the
    crossing, zero and without curvature half way."""

    def __init__(self, half_gap, places):
        nodes = np.linspace(0, half_gap, PIECES + 1)
        self.rows = [np.empty((len(places), PIECES)) for _ in range(3)]
        for k in range(PIECES):
            heights = np.zeros(PIECES + 1)
            heights[k] = 1
            spline = CubicSpline(nodes, heights, bc_type=((1, 0.0), (2, 0.0)))
            for order in range(3):
                self.rows[order][:, k] = spline(places, order)

    def __call__(self, heights):
        return [row @ heights for row in self.rows]


class Cloth:
    def __init__(self, areas, twists, gaps, tensions, clearance, thickness):
        c = constants()
        self.areas, self.gaps, self.tensions = areas, gaps, tensions
        self.clearance, self.thickness = clearance, thickness
        self.flattening = [c["flattening"] * (c["cohesion"] + (1 - c["cohesion"]) * t / 4000) for t in twists]
        self.bending, self.compaction, self.packing = c["bending"], c["compaction"], c["packing"]
        self.plates_force = 2 * c["pressure"] * gaps[0] * gaps[1]  # of half their distance
        nodes, weights = np.polynomial.legendre.leggauss(3)
        self.quadrature, self.weights, self.points = [], [], []
        for gap in gaps:  # along the yarn
            edges = np.linspace(0, gap / 2, PIECES + 1)
            step = edges[1] / 2
            places = (edges[:-1, None] + step * (1 + nodes)).ravel()
            self.points.append(places)
            self.quadrature.append(Profile(gap / 2, places))
            self.weights.append(np.tile(step * weights, PIECES))
        self.places = [np.linspace(0, gap / 2, PLACES + 1) for gap in gaps]
        self.profiles = [Profile(gap / 2, places) for gap, places in zip(gaps, self.places)]

    def split(self, x):
        """Of warp and weft: heights of the nodes; half width and half height at crossings and half way. (The last unknown
        is half the distance of the plates.)"""
        size = PIECES + 4
        return [(x[k * size : k * size + PIECES], x[k * size + PIECES : (k + 1) * size]) for k in range(2)]

    @staticmethod
    def sections(sections, t):
        """Smooth steps from crossings (t = 0) to half way (t = 1)."""
        step = t * t * (3 - 2 * t)
        a, b, far_a, far_b = sections
        return a + step * (far_a - a), b + step * (far_b - b)

    def energy(self, x):
        """Per crossing: both halves of a gap of each system."""
        total = 0.0
        for k, (heights, sections) in enumerate(self.split(x)):
            _, slope, second = self.quadrature[k](heights)
            a, b = self.sections(sections, self.points[k] / (self.gaps[k] / 2))
            stretch = 1 + slope**2
            area_ratio = math.pi * a * b * self.packing / self.areas[k]
            density = 0.5 * self.bending * second**2 * stretch**-2.5 + self.tensions[k] * (np.sqrt(stretch) - 1)
            density += 0.5 * self.flattening[k] * np.log(a / b) ** 2
            density += self.compaction / self.packing * (0.5 / area_ratio**2 + area_ratio - 1.5)
            changes = (sections[2] - sections[0]) ** 2 + (sections[3] - sections[1]) ** 2
            change = 0.5 * self.tensions[k] * 0.25 * 1.2 * changes / (self.gaps[k] / 2)
            total += 2 * self.areas[k] * (self.weights[k] @ density + change)
        return total

    def with_plates(self, x):
        return self.energy(x) + self.plates_force * x[-1]

    def inequalities(self, x):
        (warp, warp_sections), (weft, weft_sections) = self.split(x)
        u, du, ddu = self.profiles[0](warp)
        w, dw, ddw = (-row for row in self.profiles[1](weft))
        a, b = self.sections(warp_sections, np.linspace(0, 1, PLACES + 1))
        c, d = self.sections(weft_sections, np.linspace(0, 1, PLACES + 1))
        xi, eta = self.places[0][:, None], self.places[1][None, :]
        du2, dw2 = du[:, None] ** 2, dw[None, :] ** 2
        gap = u[:, None] - w[None, :] - du[:, None] * xi + dw[None, :] * eta
        gap = gap - np.sqrt(a[:, None] ** 2 * dw2 + b[:, None] ** 2 * (1 + du2))
        gap = (
            gap - np.sqrt(c[None, :] ** 2 * du2 + d[None, :] ** 2 * (1 + dw2)) - self.clearance * np.sqrt(1 + du2 + dw2)
        )
        parts = [gap.ravel()]
        for k, (z, slope, second, width, height, sections) in enumerate(
            ((u, du, ddu, a, b, warp_sections), (w, dw, ddw, c, d, weft_sections))
        ):
            beside = self.gaps[1 - k]
            parts.append(
                (beside / (2 * width + self.clearance)) ** 2
                - 1
                + (2 * z / (2 * height * np.sqrt(1 + slope**2) + self.clearance)) ** 2
            )
            parts.append([beside - self.clearance - 2 * sections[2]])
            for side in (-1, 1):
                parts.append((1 + slope**2) ** 1.5 - 1.05 * side * second * height)
                parts.append(2.2 - side * slope)
                parts.append(x[-1] - side * z - height)
            least = self.areas[k] / (math.pi * math.pi / (2 * math.sqrt(3)))
            parts.append([sections[0] * sections[1] / least - 1, sections[2] * sections[3] / least - 1])
        if self.thickness:
            parts.append([self.thickness / 2 - x[-1]])
        return np.concatenate(parts)

    def minimum(self, share):
        radii = [math.sqrt(area / math.pi / self.packing) for area in self.areas]
        start = []
        for k, part in enumerate((share, 1 - share)):
            t = np.arange(PIECES) / PIECES
            start += [part * sum(radii) * np.cos(0.5 * math.pi * t), [radii[k]] * 4]
        start.append([2 * sum(radii)])
        bounds = ([(None, None)] * PIECES + [(0.02, None)] * 4) * 2 + [(0, None)]
        found = minimize(
            self.with_plates,
            np.concatenate(start),
            method="SLSQP",
            bounds=bounds,
            options={"maxiter": 500, "ftol": 1e-10},
            constraints={"type": "ineq", "fun": self.inequalities},
        )
        return found if found.success and self.inequalities(found.x).min() > -1e-6 else None


class Minimiser(Case):
    def sheet(self, cloth, more=""):
        warp_tex, weft_tex, warp_twist, weft_twist, warp_pitch, weft_pitch, state, _ = cloth
        path = self.folder / "cloth.txt"
        path.write_text(
            TEXT.format(
                warp_tex=warp_tex,
                weft_tex=weft_tex,
                warp_twist=warp_twist,
                weft_twist=weft_twist,
                warp_pitch=warp_pitch,
                weft_pitch=weft_pitch,
                state=state,
                more=more,
            )
        )
        return json.loads(self.succeeds("info", path, "--json").stdout)["inputs"][0]["sheets"]["weave"]

    def test_another_minimiser_agrees(self):
        c = constants()
        for cloth in CLOTHS:
            warp_tex, weft_tex, warp_twist, weft_twist, warp_pitch, weft_pitch, state, pressed = cloth
            areas = [tex / 1520 for tex in (warp_tex, weft_tex)]
            unit = math.sqrt(sum(areas) / 2)
            sheet = self.sheet(cloth)
            thickness = pressed * sheet["thickness"] if pressed else None
            if thickness:
                sheet = self.sheet(cloth, f"  thickness {thickness!r}\n")
            diameters = [2 * math.sqrt(tex / 1520 / 0.6 / math.pi) for tex in (warp_tex, weft_tex)]
            tensions = {"loom": (1, c["loom_tension"]), "relaxed": (c["relaxed_tension"],) * 2, "finished": (1, 1)}[
                state
            ]
            problem = Cloth(
                [area / unit**2 for area in areas],
                [warp_twist * math.sqrt(warp_tex), weft_twist * math.sqrt(weft_tex)],
                [weft_pitch / unit, warp_pitch / unit],
                tensions,
                (2e-4 + 0.01 * min(diameters)) / unit,
                thickness / unit if thickness else None,
            )
            minima = [found for found in (problem.minimum(share) for share in (0.5, 0.75, 0.3)) if found is not None]
            self.assertTrue(minima, cloth)
            best = min(minima, key=lambda found: found.fun).x
            energy = problem.energy(best)
            with self.subTest(cloth=cloth):
                self.assertLess(abs(sheet["energy"] / energy - 1), 1e-3)
                for name, (heights, sections) in zip(("warp", "weft"), problem.split(best)):
                    system = sheet["systems"][name]
                    self.assertAlmostEqual(system["axis_height"] / (heights[0] * unit), 1, delta=8e-3)
                    self.assertAlmostEqual(system["width"] / (2 * sections[0] * unit), 1, delta=8e-3)
                    self.assertAlmostEqual(system["height"] / (2 * sections[1] * unit), 1, delta=8e-3)
                print(cloth, f"energy {sheet['energy'] / energy - 1:+.1e}")


if __name__ == "__main__":
    unittest.main()
