"""What ezdxf, another program's reader, finds in a DXF file, as JSON: dxf_facts.py FILE. Needs the system's Python with
python3-ezdxf."""

import json
import sys

import ezdxf
from ezdxf.lldxf.encoding import decode_dxf_unicode


def outline(entity, steps=4000):
    """Points along a line or spline, by ezdxf's own evaluation."""
    if entity.dxftype() == "LINE":
        return [entity.dxf.start, entity.dxf.end]
    curve = entity.construction_tool()
    return [curve.point(curve.max_t * i / steps) for i in range(steps + 1)]


def facts(path):
    document = ezdxf.readfile(path)
    audit = document.audit()
    out = {
        "version": document.dxfversion,
        "errors": len(audit.errors),
        "fixes": len(audit.fixes),
        "insunits": document.header["$INSUNITS"],
        "measurement": document.header["$MEASUREMENT"],
        "extents": [list(document.header["$EXTMIN"])[:2], list(document.header["$EXTMAX"])[:2]],
        "blocks": [],
    }
    for insert in document.modelspace().query("INSERT"):
        block = document.blocks.get(insert.dxf.name)
        boundary = [e for e in block if e.dxf.layer == "1" and e.dxftype() in ("LINE", "SPLINE")]
        runs = [outline(e) for e in boundary]
        points = [p for run in runs for p in run]
        area = sum(a[0] * b[1] - a[1] * b[0] for run in runs for a, b in zip(run, run[1:])) / 2
        out["blocks"].append(
            {
                "name": decode_dxf_unicode(insert.dxf.name),
                "at": list(insert.dxf.insert),
                "area": area,
                "closed": all(a[-1].isclose(b[0], abs_tol=1e-12) for a, b in zip(runs, runs[1:] + runs[:1])),
                "box": [[min(p[k] for p in points) for k in (0, 1)], [max(p[k] for p in points) for k in (0, 1)]],
                "kinds": [e.dxftype() for e in boundary],
                "control_points": [
                    [list(p)[:2] for p in e.control_points] for e in boundary if e.dxftype() == "SPLINE"
                ],
                "layers": {
                    layer: sum(e.dxf.layer == layer and e.dxftype() == "POINT" for e in block) for layer in "23"
                },
                "texts": [decode_dxf_unicode(e.dxf.text) for e in block.query("TEXT")],
            }
        )
    return out


if __name__ == "__main__":
    json.dump(facts(sys.argv[1]), sys.stdout)
