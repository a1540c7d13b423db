"""Creeping flow through the pore space of a unit cell by OpenFOAM, for scripts/permeability: the case that `selvage mesh --pores -o
FILE.foam` writes, with fields, run by simpleFoam.

The force (1 N/kg times FORCE) is a source in the momentum; viscosity is 1 m2/s, so that the Reynolds number is below 1e-5."""

import os
import pathlib
import re
import shutil
import subprocess

import numpy

FORCE = 1e6  # m/s2: velocities of about 1e-3 m/s in pores of 0.1 mm
RESIDUAL = (
    1e-5  # of the velocity along the force, which has converged then; components that are next to nothing have not
)
AXES = "xyz"
HEAD = "FoamFile\n{{\n    version 2.0;\n    format ascii;\n    class {kind};\n    object {name};\n}}\n\n"


class Failure(Exception):
    pass


def check_installed():
    for program in ("simpleFoam", "checkMesh"):
        if shutil.which(program) is None:
            raise Failure(f"{program} is not installed: apt-get install openfoam, or leave out --solver openfoam")


def numbers_in(path):
    """The rows of a list of numbers in a file of OpenFOAM."""
    text = pathlib.Path(path).read_text()
    return numpy.array(
        [[float(word) for word in row.split()] for row in re.findall(r"^\(([^()]*)\)$", text, re.MULTILINE)]
    )


class Case:
    def __init__(self, path, facts):
        self.path, self.facts = pathlib.Path(path), facts
        self._run("checkMesh", "-constant")
        self._measure()

    def _run(self, *command):
        log = self.path / f"log.{command[0]}"
        # Debian's OpenFOAM looks for its own files there.
        places = {"WM_PROJECT_DIR": "/usr/share/openfoam"}
        with log.open("w") as file:
            run = subprocess.run(
                [*command, "-case", str(self.path)],
                stdout=file,
                stderr=subprocess.STDOUT,
                env={**places, **os.environ},
                check=False,
            )
        if run.returncode != 0:
            raise Failure(f"{command[0]} stopped: {' / '.join(log.read_text().strip().splitlines()[-3:])}")
        return log.read_text()

    def _put(self, name, kind, text):
        file = self.path / name
        file.parent.mkdir(exist_ok=True)
        file.write_text(HEAD.format(kind=kind, name=file.name) + text)

    def _fields(self, axis):
        velocity, pressure = [], []
        for name, kind, count, start in self.boundary():
            if kind == "cyclic":
                own = ("type cyclic;", "type cyclic;")
            elif kind == "wall":
                # What the force is not held by is taken for zero, as solvers do; of the pressure that leaves the force's own slope.
                slopes = FORCE * self.normals[int(start) : int(start) + int(count), axis]
                rows = "\n".join(map(str, slopes))
                own = ("type noSlip;", f"type fixedGradient; gradient nonuniform List<scalar>\n{count}\n(\n{rows}\n);")
            elif name.endswith(AXES[axis]):
                own = ("type zeroGradient;", "type fixedValue; value uniform 0;")
            else:
                own = ("type slip;", "type zeroGradient;")
            velocity.append(f"    {name} {{ {own[0]} }}\n")
            pressure.append(f"    {name} {{ {own[1]} }}\n")
        self._put(
            "0/U",
            "volVectorField",
            "dimensions [0 1 -1 0 0 0 0];\ninternalField uniform (0 0 0);\nboundaryField\n{\n"
            + "".join(velocity)
            + "}\n",
        )
        self._put(
            "0/p",
            "volScalarField",
            "dimensions [0 2 -2 0 0 0 0];\ninternalField uniform 0;\nboundaryField\n{\n" + "".join(pressure) + "}\n",
        )

    def boundary(self):
        """Of each patch its name, type, number of faces and first face."""
        text = (self.path / "constant/polyMesh/boundary").read_text()
        return re.findall(
            r"^    (\w+)\n    \{\n        type +(\w+);.*?nFaces +(\d+);\s+startFace +(\d+);",
            text,
            re.MULTILINE | re.DOTALL,
        )

    def solve(self, axis, _held):
        """As PoreFlow.solve(): the integral of the velocity over the pores for a force of 1 and a viscosity of 1, in mm."""
        for old in self.path.glob("[0-9]*"):
            shutil.rmtree(old)
        self._fields(axis)
        force = " ".join(str(FORCE if k == axis else 0.0) for k in range(3))
        self._put("constant/transportProperties", "dictionary", "transportModel Newtonian;\nnu 1;\n")
        self._put("constant/turbulenceProperties", "dictionary", "simulationType laminar;\n")
        self._put(
            "constant/fvOptions",
            "dictionary",
            "force\n{\n    type vectorSemiImplicitSource;\n    selectionMode all;\n    volumeMode specific;\n"
            f"    injectionRateSuSp {{ U (({force}) 0); }}\n}}\n",
        )
        log = self._run("simpleFoam")
        last = float(re.findall(rf"Solving for U{AXES[axis]}, Initial residual = ([^,]+),", log)[-1])
        if not last < RESIDUAL:
            raise Failure(f"simpleFoam did not converge (residual {last:.1g}): see {self.path / 'log.simpleFoam'}")
        end = max((folder for folder in self.path.glob("[0-9]*")), key=lambda folder: int(folder.name))
        velocity = numbers_in(end / "U")[: len(self.volumes)]
        return (self.volumes[:, None] * velocity).sum(axis=0) / FORCE * 1e6, int(end.name)  # m2 a unit of force: mm2

    def _measure(self):
        """Unit normals of the faces, and the volumes of the cells, mm3."""
        mesh = self.path / "constant/polyMesh"
        points = 1e3 * numbers_in(mesh / "points")
        rows = [row.split() for row in re.findall(r"^[34]\(([^()]*)\)$", (mesh / "faces").read_text(), re.MULTILINE)]
        corners = points[numpy.array([row + row[2:] if len(row) == 3 else row for row in rows], dtype=int)]
        owner, neighbour = (
            numpy.array(re.findall(r"^\d+$", (mesh / name).read_text(), re.MULTILINE)[1:], dtype=int)
            for name in ("owner", "neighbour")
        )
        # Of a triangle the last corner is repeated. The volume under each face, seen from the origin.
        areas = numpy.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1]) / 2
        middles = numpy.where(
            (corners[:, 2] == corners[:, 3]).all(axis=1)[:, None], corners[:, :3].mean(axis=1), corners.mean(axis=1)
        )
        under = numpy.einsum("ni,ni->n", middles, areas) / 3
        count = self.facts["tets"] + self.facts.get("layers", {}).get("wedges", 0)
        self.volumes = numpy.bincount(owner, under, count) - numpy.bincount(neighbour, under[: len(neighbour)], count)
        self.normals = areas / numpy.linalg.norm(areas, axis=1)[:, None]
