"""The software bill of materials of a build, on standard output: SPDX 2.3 (ISO/IEC 5962) as JSON.

sbom.py BUILD: a folder that ninja has built on Debian. Stated of the program, its modules, its workers and the library: the packages of
the shared libraries that they load, and those whose headers and static archives are compiled in, as the compiler and the linker
were given them; the library of pages by its lock. The same build and SOURCE_DATE_EPOCH give the same bytes.
"""

import argparse
import datetime
import functools
import hashlib
import json
import os
import pathlib
import re
import subprocess
import sys
import urllib.parse
import uuid

ROOT = pathlib.Path(__file__).resolve().parents[2]
TARGETS = ("program", "libselvage")
# Licences of what is used, by Debian's source package, from its file `copyright`.
LICENCES = {
    "boost1.74": "BSL-1.0",
    "cgal": "GPL-3.0-or-later AND LGPL-3.0-or-later",
    "cli11": "BSD-3-Clause",
    "eigen3": "MPL-2.0",
    "embree": "Apache-2.0",
    "fmtlib": "MIT",
    "gcc-12": "GPL-3.0-or-later WITH GCC-exception-3.1",
    "glibc": "LGPL-2.1-or-later",
    "gmp": "LGPL-3.0-or-later OR GPL-2.0-or-later",
    "hdf5": "BSD-3-Clause",
    "libmd": "BSD-3-Clause AND BSD-2-Clause AND ISC AND Beerware AND LicenseRef-libmd-public-domain",
    "libpng1.6": "libpng-2.0",
    "linux": "GPL-2.0-only WITH Linux-syscall-note",
    "minizip": "Zlib",
    "mpfr4": "LGPL-3.0-or-later",
    "muparser": "MIT",
    "nlohmann-json3": "MIT",
    "opencascade": "LGPL-2.1-only WITH OCCT-exception-1.0",
    "pugixml": "MIT",
    "tetgen": "AGPL-3.0-or-later",
    "zlib": "Zlib",
}
PUBLIC_DOMAIN = {
    "licenseId": "LicenseRef-libmd-public-domain",
    "name": "Public domain, of parts of libmd",
    "extractedText": "md4.c, md5.c and sha1.c of libmd are in the public domain (/usr/share/doc/libmd-dev/copyright).",
}


class Failure(Exception):
    pass


def output_of(*command):
    done = subprocess.run([*map(str, command)], capture_output=True, text=True, env={**os.environ, "LC_ALL": "C"})
    if done.returncode != 0:
        raise Failure(f"{command[0]}: {done.stderr.strip()}")
    return done.stdout


# ---- what is used ------------------------------------------------------------------------------------------


class Build:
    """What ninja knows of a build folder."""

    def __init__(self, folder):
        self.folder = folder.resolve()
        self.inputs = sorted(set(output_of("ninja", "-C", self.folder, "-t", "inputs", *TARGETS).split()))

    def binaries(self):
        """The program, its modules and its workers."""
        inputs = output_of("ninja", "-C", self.folder, "-t", "query", "src/cli/program").split("outputs:")[0]
        return [self.folder / name for name in sorted(set(re.findall(r"\bbin/\S+", inputs)))]

    def compiled_in(self):
        """Files of the system: headers of every object, and static archives."""
        found, counts = {name for name in self.inputs if re.fullmatch(r"/.*\.a", name)}, False
        objects = {name for name in self.inputs if name.endswith((".o", ".gch"))}
        for line in output_of("ninja", "-C", self.folder, "-t", "deps").splitlines():
            if not line.startswith(" "):
                counts = line.split(":")[0] in objects
            elif counts and line.strip().startswith("/usr/"):
                found.add(line.strip())
        return found

    def loaded(self):
        """Files of the shared libraries that a binary names."""
        known = dict(reversed(re.findall(r"^\s+(\S+) \(.*\) => (\S+)$", output_of("ldconfig", "-p"), re.MULTILINE)))
        names = set()
        for path in self.binaries():
            names |= set(re.findall(r"\(NEEDED\).*\[(.*)\]", output_of("readelf", "--dynamic", path)))
        missing = names - known.keys()
        if missing:
            raise Failure(f"ldconfig has no {', '.join(sorted(missing))}")
        return {known[name] for name in names}


def packages_of(files):
    """Debian's packages that the files are from. /lib is a link to /usr/lib, and dpkg has either name."""
    names = {name for path in files for name in (path, os.path.realpath(path))}
    names |= {name[4:] for name in names if name.startswith("/usr/lib")} | {
        "/usr" + n for n in names if n.startswith("/lib")
    }
    found = subprocess.run(["dpkg-query", "--search", *sorted(names)], capture_output=True, text=True).stdout
    owner = {path: package for package, path in re.findall(r"^([\w.+-]+)(?::\w+)?: (/.*)$", found, re.MULTILINE)}
    for path in files:
        same = {path, os.path.realpath(path)}
        same |= {name[4:] for name in same} | {"/usr" + name for name in same}
        if not same & owner.keys():
            raise Failure(f"{path} is of no Debian package")
    return set(owner.values())


# ---- how SPDX writes it ------------------------------------------------------------------------------------


@functools.cache
def distribution():
    return dict(re.findall(r'^(\w+)="?(.*?)"?$', pathlib.Path("/etc/os-release").read_text(), re.MULTILINE))


def locator(kind, name, version, **qualifiers):
    quoted = urllib.parse.quote(version, safe=".-~")
    text = f"pkg:{kind}/{name}@{quoted}" + ("?" if qualifiers else "") + urllib.parse.urlencode(qualifiers)
    return [{"referenceCategory": "PACKAGE-MANAGER", "referenceType": "purl", "referenceLocator": text}]


def package(name, version, licence, **more):
    return {
        "SPDXID": "SPDXRef-" + re.sub(r"[^a-zA-Z0-9.-]", "-", name),
        "name": name,
        "versionInfo": version,
        "downloadLocation": "NOASSERTION",
        "filesAnalyzed": False,
        "licenseConcluded": "NOASSERTION",
        "licenseDeclared": licence,
        "copyrightText": "NOASSERTION",
        **more,
    }


def debian_package(name):
    fields = "${Version}\t${Architecture}\t${source:Package}\t${source:Version}\t${Homepage}\n"
    version, processor, source, its_version, page = (
        output_of("dpkg-query", "-W", "-f", fields, name).split("\n")[0].split("\t")
    )
    system = distribution()
    if source not in LICENCES:
        raise Failure(f"the licence of Debian's source package '{source}' is missing in LICENCES of {__file__}")
    return package(
        name,
        version,
        LICENCES[source],
        supplier=f"Organization: {system['NAME']}",
        sourceInfo=f"built from {source} {its_version} of {system['PRETTY_NAME']}",
        primaryPackagePurpose="LIBRARY",
        externalRefs=locator(
            "deb", f"{system['ID']}/{name}", version, arch=processor, distro=system["VERSION_CODENAME"]
        ),
        **({"homepage": page} if page else {}),
    )


def library_of_pages(folder):
    """[] where it was built without."""
    path = folder / "bin" / "three.module.min.js"
    if not path.exists():
        return []
    version = re.search(r"^version=(.*)$", (ROOT / "scripts/three.lock").read_text(), re.MULTILINE)[1]
    digest = {"algorithm": "SHA256", "checksumValue": hashlib.sha256(path.read_bytes()).hexdigest()}
    return [
        package(
            "three",
            version,
            "MIT",
            packageFileName="three.module.min.js",
            checksums=[digest],
            primaryPackagePurpose="LIBRARY",
            externalRefs=locator("npm", "three", version),
        )
    ]


def document(build):
    version = re.match(r"selvage (\S+)", output_of(build.folder / "bin" / "selvage", "--version"))[1]
    self = package("selvage", version, "AGPL-3.0-or-later", primaryPackagePurpose="APPLICATION")
    loaded, compiled = packages_of(build.loaded()), packages_of(build.compiled_in())
    libraries = {name: debian_package(name) for name in sorted(loaded | compiled)}
    pages = library_of_pages(build.folder)

    def relationship(kind, to, element=self["SPDXID"]):
        return {"spdxElementId": element, "relationshipType": kind, "relatedSpdxElement": to["SPDXID"]}

    relationships = [relationship("DESCRIBES", self, "SPDXRef-DOCUMENT")]
    relationships += [relationship("DYNAMIC_LINK", libraries[name]) for name in sorted(loaded)]
    relationships += [relationship("STATIC_LINK", libraries[name]) for name in sorted(compiled - loaded)]
    relationships += [relationship("CONTAINS", part) for part in pages]
    packages = [self, *libraries.values(), *pages]
    moment = int(os.environ.get("SOURCE_DATE_EPOCH", datetime.datetime.now().timestamp()))
    created = datetime.datetime.fromtimestamp(moment, datetime.timezone.utc).strftime("%Y-%m-%dT%H:%M:%SZ")
    content = json.dumps([created, packages, relationships])
    return {
        "spdxVersion": "SPDX-2.3",
        "dataLicense": "CC0-1.0",
        "SPDXID": "SPDXRef-DOCUMENT",
        "name": f"selvage-{version}",
        "documentNamespace": f"https://spdx.org/spdxdocs/selvage-{version}-{uuid.uuid5(uuid.NAMESPACE_URL, content)}",
        "comment": "DYNAMIC_LINK: shared libraries that are loaded. STATIC_LINK: headers, templates and archives that are compiled in.",
        "creationInfo": {"created": created, "creators": ["Organization: The Selvage maintainers", "Tool: sbom.py"]},
        "hasExtractedLicensingInfos": [PUBLIC_DOMAIN],
        "packages": packages,
        "relationships": relationships,
    }


def main():
    parser = argparse.ArgumentParser(description="The SPDX document of a build, on standard output.")
    parser.add_argument("build", type=pathlib.Path)
    try:
        json.dump(document(Build(parser.parse_args().build)), sys.stdout, indent=1)
        print()
    except (Failure, OSError) as failure:
        sys.exit(f"sbom: {failure}")


if __name__ == "__main__":
    main()
