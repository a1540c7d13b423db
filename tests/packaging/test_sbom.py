"""The bill of materials of the build, read by others: jsonschema with the schema of SPDX 2.3, and license-expression.

SELVAGE_BUILD: the build folder (default: build).
"""

import collections
import json
import os
import pathlib
import re
import subprocess
import sys
import unittest

try:
    import jsonschema
    from license_expression import get_spdx_licensing
except ModuleNotFoundError as missing:
    print(f"{missing}: install python3-jsonschema and python3-license-expression", file=sys.stderr)
    jsonschema = None

REPOSITORY = pathlib.Path(__file__).resolve().parents[2]
BUILD = pathlib.Path(os.environ.get("SELVAGE_BUILD", REPOSITORY / "build")).resolve()
SCHEMA = pathlib.Path(__file__).with_name("spdx-schema.json")
MOMENT = 1700000000
# As the program states its libraries itself (`selvage --version`), with the beginning of the names of Debian's packages.
STATED = {
    "OpenCASCADE": "libocct-",
    "CGAL": "libcgal-dev",
    "Embree": "libembree",
    "TetGen": "libtet",
    "muParser": "libmuparser",
    "Eigen": "libeigen3-dev",
    "fmt": "libfmt-dev",
    "zlib": "zlib1g",
    "libpng": "libpng",
    "pugixml": "libpugixml",
    "HDF5": "libhdf5",
}


def bill(moment):
    script = REPOSITORY / "scripts/packaging/sbom.py"
    environment = {**os.environ, "SOURCE_DATE_EPOCH": str(moment)}
    return subprocess.run(
        [sys.executable, script, BUILD], capture_output=True, text=True, check=True, env=environment
    ).stdout


@unittest.skipIf(jsonschema is None, "no parser of SPDX")
class Sbom(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.text = bill(MOMENT)
        cls.document = json.loads(cls.text)
        cls.packages = {package["name"]: package for package in cls.document["packages"]}

    def linked(self, kind):
        by_id = {package["SPDXID"]: package["name"] for package in self.document["packages"]}
        return {
            by_id[r["relatedSpdxElement"]]
            for r in self.document["relationships"]
            if r["relationshipType"] == kind and r["spdxElementId"] == "SPDXRef-selvage"
        }

    def test_it_keeps_to_the_schema(self):
        validator = jsonschema.Draft7Validator(
            json.loads(SCHEMA.read_text()), format_checker=jsonschema.FormatChecker()
        )
        self.assertEqual([error.message for error in validator.iter_errors(self.document)], [])
        broken = {**self.document, "packages": [{"name": "nothing"}]}
        self.assertNotEqual(list(validator.iter_errors(broken)), [])

    def test_identifiers_are_unique_and_defined(self):
        ids = [self.document["SPDXID"], *(package["SPDXID"] for package in self.document["packages"])]
        self.assertEqual([name for name, count in collections.Counter(ids).items() if count > 1], [])
        for name in ids:
            self.assertRegex(name, r"^SPDXRef-[a-zA-Z0-9.-]+$")
        for r in self.document["relationships"]:
            self.assertIn(r["spdxElementId"], ids)
            self.assertIn(r["relatedSpdxElement"], ids)
        self.assertEqual(
            {r["relatedSpdxElement"] for r in self.document["relationships"]} | {"SPDXRef-DOCUMENT"}, set(ids)
        )

    def test_licences_are_expressions_of_known_licences(self):
        known, extracted = get_spdx_licensing(), self.document["hasExtractedLicensingInfos"]
        own = {licence["licenseId"] for licence in extracted}
        for package in self.document["packages"]:
            expression = package["licenseDeclared"]
            for name in own:
                expression = expression.replace(name, "MIT")
            self.assertEqual(known.validate(expression, strict=True).errors, [], package["name"])
        self.assertEqual(self.packages["selvage"]["licenseDeclared"], "AGPL-3.0-or-later")
        self.assertEqual(self.packages["libtet1.5"]["licenseDeclared"], "AGPL-3.0-or-later")

    def test_versions_are_those_that_are_installed(self):
        query = ["dpkg-query", "-W", "-f", "${Package} ${Version}\n"]
        installed = dict(line.split() for line in subprocess.check_output(query, text=True).splitlines())
        others = {name: package for name, package in self.packages.items() if name not in ("selvage", "three")}
        self.assertGreater(len(others), 20)
        for name, package in others.items():
            self.assertEqual(package["versionInfo"], installed[name])
            self.assertIn(f"pkg:deb/debian/{name}@", package["externalRefs"][0]["referenceLocator"])

    def test_all_that_is_loaded_is_there(self):
        """By the loader: what it maps for the program and its modules, as they name it, is of these packages."""
        files = {}
        for path in [BUILD / "bin/selvage", BUILD / "bin/selvage-tetgen", *(BUILD / "bin").glob("selvage_*.so")]:
            needed = re.findall(r"NEEDED +(\S+)", subprocess.check_output(["objdump", "-p", path], text=True))
            where = dict(re.findall(r"(\S+) => (\S+)", subprocess.check_output(["ldd", path], text=True)))
            files |= {name: os.path.realpath(where[name]) for name in needed if name in where}
        self.assertGreater(len(files), 10)
        # dpkg has files of /lib, which is a link to /usr/lib, by either name.
        names = [name for file in files.values() for name in (file, file.removeprefix("/usr"))]
        answers = subprocess.run(["dpkg", "-S", *names], capture_output=True, text=True).stdout
        owner = {
            file.removeprefix("/usr"): package for package, file in re.findall(r"^([^:]+):.*? (/.*)$", answers, re.M)
        }
        self.assertEqual(
            {
                name: file
                for name, file in files.items()
                if owner[file.removeprefix("/usr")] not in self.linked("DYNAMIC_LINK")
            },
            {},
        )

    def test_all_that_the_program_states_is_there(self):
        stated = subprocess.check_output([BUILD / "bin/selvage", "--version"], text=True).splitlines()[1]
        names = re.findall(r"(\w+) \d[\d.]*", stated)
        self.assertGreater(len(names), 8)
        linked = self.linked("DYNAMIC_LINK") | self.linked("STATIC_LINK")
        for name in names:
            self.assertTrue([package for package in linked if package.startswith(STATED[name])], name)
        self.assertFalse([package for package in linked if "gtest" in package or "benchmark" in package])

    def test_the_library_of_pages_is_that_of_the_lock(self):
        if not (BUILD / "bin/three.module.min.js").exists():
            self.assertNotIn("three", self.packages)
            self.skipTest("built without pages")
        lock = dict(re.findall(r"^(\w+)=(.*)$", (REPOSITORY / "scripts/three.lock").read_text(), re.MULTILINE))
        three = self.packages["three"]
        self.assertEqual(three["versionInfo"], lock["version"])
        self.assertEqual(three["checksums"], [{"algorithm": "SHA256", "checksumValue": lock["sha256"]}])
        self.assertEqual(self.linked("CONTAINS"), {"three"})

    def test_one_build_has_one_text(self):
        self.assertEqual(bill(MOMENT), self.text)
        later = json.loads(bill(MOMENT + 1))
        self.assertEqual(later["creationInfo"]["created"], "2023-11-14T22:13:21Z")
        self.assertNotEqual(later["documentNamespace"], self.document["documentNamespace"])
        self.assertEqual(later["packages"], self.document["packages"])


if __name__ == "__main__":
    unittest.main()
