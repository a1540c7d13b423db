"""Pictures of the samples: see scripts/pictures, which builds the program and calls this."""

import argparse
import pathlib
import re
import subprocess
import sys
import tempfile
import textwrap
import xml.etree.ElementTree as xml

from PIL import Image, ImageDraw, ImageFont

import mesh_picture

ROOT = pathlib.Path(__file__).resolve().parents[1]
SAMPLES = ROOT / "samples"

# The committed pictures: name, sample, where the eye is.
PICTURES = [
    ("weave", "weave_plain.txt", "iso"),
    ("satin", "weave_satin5.txt", "iso"),
    ("orthogonal", "weave_orthogonal.txt", "iso"),
    ("terry", "weave_terry.txt", "iso"),
    ("corduroy", "weave_corduroy.txt", "iso"),
    ("jersey", "jersey.txt", "top"),
    ("purl", "knit_purl.txt", "iso"),
    ("tricot_front", "warpknit_tricot.txt", "top"),
    ("tricot_back", "warpknit_tricot.txt", "bottom"),
    ("braid", "braid_triaxial.txt", "iso"),
    ("plait", "braid_flat3.txt", "top"),
    ("plies", "cabled.txt", "iso"),
]
# Those of meshes: name, sample with a cell.
MESH_PICTURES = [
    ("cell_plain", "cell_plain.txt"),
    ("cell_jersey", "cell_jersey.txt"),
    ("cell_orthogonal", "cell_orthogonal.txt"),
]
PICTURE_SIZE = (480, 360)
COLORS = 128  # of a committed picture

TILE, CAPTION = (300, 225), 46  # of the sheet, pixels
COLUMNS = 5


def run(selvage, *arguments):
    return subprocess.run([selvage, *map(str, arguments), "--quiet"], capture_output=True, text=True)


def shrink(path):
    """Fewer colours, then the same pixels in fewer bytes."""
    Image.open(path).quantize(COLORS, method=Image.Quantize.MEDIANCUT, dither=Image.Dither.NONE).save(path)
    subprocess.run(["optipng", "-quiet", "-o5", "-strip", "all", path], check=True)


def make_pictures(selvage, folder):
    folder.mkdir(parents=True, exist_ok=True)
    total = 0
    for name, sample, view in PICTURES:
        path = folder / f"{name}.png"
        done = run(
            selvage, "view", SAMPLES / sample, "-o", path, "--from", view, "--size", "{}x{}".format(*PICTURE_SIZE)
        )
        if done.returncode != 0:
            sys.exit(f"pictures: {sample} has no picture:\n{done.stderr}")
        shrink(path)
        total += path.stat().st_size
        print(f"{path}: {path.stat().st_size} bytes")
    for name, sample in MESH_PICTURES:
        path = folder / f"{name}.png"
        with tempfile.TemporaryDirectory() as scratch:
            vtu = pathlib.Path(scratch) / "cell.vtu"
            done = run(selvage, "mesh", SAMPLES / sample, "--matrix", "--periodic", "-o", vtu)
            if done.returncode != 0:
                sys.exit(f"pictures: {sample} has no mesh:\n{done.stderr}")
            mesh_picture.draw(vtu, path, PICTURE_SIZE)
        shrink(path)
        total += path.stat().st_size
        print(f"{path}: {path.stat().st_size} bytes")
    print(f"{len(PICTURES) + len(MESH_PICTURES)} pictures, {total} bytes")


def title_of(path):
    found = re.search(r'(?mi)^\s*title\s*[ =]\s*"?([^"\r\n]+)', path.read_text(encoding="utf-8", errors="replace"))
    return found[1].strip() if found else ""


def subpaths(data):
    """The polygons of an SVG path of M, L, C and Z with absolute coordinates; curves as twelve chords."""
    points, words = [], re.findall(r"[MLCZ]|-?[\d.]+(?:e-?\d+)?", data)
    at, command = 0, ""
    while at < len(words):
        if words[at].isalpha():
            command, at = words[at], at + 1
        if command == "Z":
            continue
        count = 6 if command == "C" else 2
        numbers = list(map(float, words[at : at + count]))
        at += count
        if command != "C":
            points.append(tuple(numbers))
            continue
        corners = [points[-1], *zip(numbers[::2], numbers[1::2])]
        for k in range(1, 13):
            t = k / 12
            basis = ((1 - t) ** 3, 3 * t * (1 - t) ** 2, 3 * t * t * (1 - t), t**3)
            points.append(tuple(sum(b * c[axis] for b, c in zip(basis, corners)) for axis in (0, 1)))
    return points


def drawing(selvage, sample):
    """The outlines of a sample's garment pieces; None when it has none."""
    done = run(selvage, "convert", sample, "--to", "svg", "-o", "-")
    if done.returncode != 0:
        return None
    tree = xml.fromstring(done.stdout)
    left, top, width, height = map(float, tree.get("viewBox").split())
    scale = min(TILE[0] / width, TILE[1] / height)
    tile = Image.new("RGB", TILE, "white")
    for path in tree.iter("{http://www.w3.org/2000/svg}path"):
        line = [((x - left) * scale, (y - top) * scale) for x, y in subpaths(path.get("d"))]
        ImageDraw.Draw(tile).line(line, fill="black", width=2)
    return tile


def message_tile(text):
    tile = Image.new("RGB", TILE, (255, 225, 225))
    ImageDraw.Draw(tile).text((6, 6), "NO PICTURE\n" + textwrap.fill(text, 46), fill="black")
    return tile


def tile_of(selvage, sample, folder, view):
    """(the sample's tile, whether it shows something)"""
    path = folder / (sample.name + ".png")
    done = run(selvage, "view", sample, "-o", path, "--from", view, "--size", "{}x{}".format(2 * TILE[0], 2 * TILE[1]))
    if done.returncode == 0:
        return Image.open(path).convert("RGB").resize(TILE, Image.Resampling.LANCZOS), True
    tile = drawing(selvage, sample) if "no yarn to show" in done.stderr else None
    return (tile, True) if tile else (message_tile(done.stderr.replace(str(SAMPLES), "")), False)


def make_sheet(selvage, target, view):
    samples = sorted(path for path in SAMPLES.iterdir() if path.is_file() and path.suffix != ".md")
    font = ImageFont.load_default()
    width, height = TILE[0], TILE[1] + CAPTION
    rows = -(-len(samples) // COLUMNS)
    sheet = Image.new("RGB", (COLUMNS * width, rows * height), "white")
    draw, failed = ImageDraw.Draw(sheet), []
    with tempfile.TemporaryDirectory() as folder:
        for k, sample in enumerate(samples):
            x, y = k % COLUMNS * width, k // COLUMNS * height
            tile, shown = tile_of(selvage, sample, pathlib.Path(folder), view)
            sheet.paste(tile, (x, y))
            title = title_of(sample)
            draw.text((x + 6, y + TILE[1] + 2), sample.name, fill="black", font=font)
            draw.text((x + 6, y + TILE[1] + 14), textwrap.fill(title, 47), fill="#555555", font=font)
            if not shown:
                failed.append(sample.name)
    sheet.save(target, optimize=True)
    print(f"{target}: {len(samples)} samples, {target.stat().st_size} bytes")
    if failed:
        sys.exit("pictures: nothing to see of: " + ", ".join(failed))


def main():
    parser = argparse.ArgumentParser(prog="scripts/pictures")
    parser.add_argument("--selvage", required=True, help=argparse.SUPPRESS)
    parser.add_argument("--out", type=pathlib.Path, default=SAMPLES / "pictures")
    parser.add_argument("--sheet", nargs="?", type=pathlib.Path, const=pathlib.Path("sheet.png"))
    parser.add_argument("--from", dest="view", default="iso", help="of the sheet (default: iso)")
    chosen = parser.parse_args()
    if chosen.sheet:
        make_sheet(chosen.selvage, chosen.sheet, chosen.view)
    else:
        make_pictures(chosen.selvage, chosen.out)


if __name__ == "__main__":
    main()
