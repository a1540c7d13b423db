// What a report is made of: src/cli/report.md says what it means.
#pragma once

#include <string_view>

namespace selvage::pipeline {

// As JSON. A list has one element, the type of all of its own; an object has the members that are known, "*"
// those of any name. "text", "path" (a text without zero bytes), "number", "duration" (from 0), "count" (a
// whole number from 0), "boolean" are types.
inline constexpr std::string_view report_types = R"({
  "selvage": "text", "libraries": {"*": "text"}, "started": "text", "seconds": "duration", "ok": "boolean",
  "counts": {"inputs": "count", "done": "count", "failed": "count", "skipped": "count"},
  "inputs": [{
    "path": "path", "ok": "boolean", "defect": "boolean", "skipped": "boolean", "seconds": "duration",
    "sha256": "text", "settings": "text", "units": "text", "yarn_count": "number", "min_gap": "number",
    "creo_absolute_accuracy": "number", "entities": {"*": "number"}, "not_understood": {"*": "number"},
    "messages": [{"severity": "text", "where": "text", "text": "text", "yarn": "text", "at": ["number"]}],
    "yarns": [{
      "name": "text", "closed": "boolean", "length": "number", "volume": "number", "min_bend_radius": "number",
      "tube_error": "number", "path_miss": "number", "control_points": ["number"], "self_overlap": "boolean"}],
    "pieces": [{
      "name": "text", "perimeter": "number", "area": "number", "valid": "boolean",
      "edges": [{
        "name": "text", "kind": "text", "length": "number",
        "fit": {
          "shape": "text", "by": "text", "largest_error": "number", "largest_distance": "number",
          "points": [{"parameter": "number", "point": ["number"], "error": "number", "distance": "number"}],
          "control_points": [["number"]], "control_points_by_descent": [["number"]],
          "descent_steps": "number"}}]}],
    "parts": [{
      "kind": "text", "faces": "number", "trimmed": "number", "name": "text", "group": "text",
      "area": "number", "volume": "number", "box": [["number"]], "color": "text", "layer": "text",
      "entity": "text"}],
    "overlaps": [{
      "a": "text", "b": "text", "depth": "number", "at": ["number"], "direction": ["number"],
      "area": "number", "site_a": ["number"], "site_b": ["number"]}],
    "contacts": [{
      "a": "text", "b": "text", "gap": "number", "at": ["number"], "area": "number", "site_a": ["number"],
      "site_b": ["number"]}],
    "outputs": [{
      "path": "text", "format": "text", "bytes": "number", "sha256": "text", "entities": {"*": "number"}}],
    "instances": {"shapes": "number", "copies": "number", "largest_deviation": "number"},
    "sheets": {"*": {
      "mass": "number", "thickness": "number", "cover": "number", "fibre_fraction": "number",
      "systems": {"*": {"*": "number"}}, "threads": {"*": {"*": "number"}}, "*": "number"}},
    "relax": {
      "solved": "boolean", "iterations": "number",
      "before": {"overlaps": "number", "depth": "number", "min_gap": "number"},
      "after": {"overlaps": "number", "depth": "number", "min_gap": "number"},
      "largest_move": "number", "moved_most": "text", "largest_area_change": "number",
      "largest_length_change": "number", "largest_volume_change": "number", "reason": "text",
      "jams": [{"a": "text", "b": "text", "gap": "number", "at": ["number"]}]},
    "mesh": {
      "nodes": "number", "tets": "number", "hexahedra": "number", "wedges": "number", "beams": "number",
      "bend": "boolean", "volume": "number", "volume_error": "number", "min_dihedral": "number",
      "first_percentile_dihedral": "number", "max_aspect": "number", "min_scaled_jacobian": "number",
      "below_target": "number", "in_wedges": "number", "estimate": "number", "periodic": "text",
      "yarn_share": "number", "porosity": "number", "equations": "number", "load_cases": "number",
      "regions": [{
        "name": "text", "kind": "text", "tets": "number", "hexahedra": "number", "wedges": "number",
        "beams": "number", "sections": "number", "contact_radius": "number", "volume": "number",
        "exact_volume": "number", "volume_error": "number", "min_dihedral": "number"}],
      "worst": [{"min_dihedral": "number", "region": "text", "at": ["number"]}],
      "interfaces": [{
        "first": "text", "second": "text", "cohesive": "boolean", "triangles": "number", "area": "number"}],
      "patches": [{"name": "text", "kind": "text", "sides": "number"}],
      "passages": {"along": "text", "pockets": "number", "pocket_volume": "number"},
      "layers": {
        "count": "number", "wedges": "number", "asked_thickness": "number", "thickness": "number",
        "thinned": "number", "min_scaled_jacobian": "number"},
      "sections": [{
        "shape": "text", "width": "number", "height": "number", "area": "number", "i11": "number",
        "i22": "number", "torsion": "number"}],
      "contact_pairs": [{"a": "text", "b": "text", "gap": "number", "places": "number", "at": ["number"]}],
      "explicit": {
        "load": "text", "stroke": "number", "stroke_y": "number", "thickness": "number",
        "final_thickness": "number", "friction": "number", "duration": "number", "loose_ends": "number",
        "stable_increment": "number", "stable_element": "number", "stable_length": "number",
        "wave_speed": "number", "increments": "number"}},
    "voxels": {
      "count": ["number"], "lengths": ["number"], "yarn_fraction": "number", "fibre_fraction": "number",
      "overlap_fraction": "number",
      "phases": [{"name": "text", "material": "text", "fraction": "number"}]},
    "roundtrips": [{
      "format": "text", "seconds": "duration", "error": "text", "equal": "boolean",
      "largest_deviation": "number", "largest_of": "text", "closed": ["number"], "volume": ["number"],
      "yarn_count": ["number"], "yarns": [{"name": "text", "deviation": "number"}],
      "differences": ["text"], "notes": ["text"]}],
    "compared": [{"name": "text", "differences": ["text"]}]}]})";

}  // namespace selvage::pipeline
