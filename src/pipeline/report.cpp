#include "pipeline/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/sha256.h"
#include "core/source.h"
#include "pipeline/parts.h"
#include "pipeline/versions.h"

namespace selvage::pipeline {

using Json = nlohmann::ordered_json;

namespace {

Json point(const Vec3& p) {
  return Json::array({p.x(), p.y(), p.z()});
}

Json yarn_json(const YarnReport& yarn) {
  Json out = {{"name", yarn.name}};
  if (yarn.closed) out["closed"] = *yarn.closed;
  out["length"] = yarn.length;
  out["volume"] = yarn.volume;
  if (yarn.min_bend_radius && std::isfinite(*yarn.min_bend_radius))
    out["min_bend_radius"] = *yarn.min_bend_radius;
  out["tube_error"] = yarn.tube_error;
  if (yarn.path_miss) out["path_miss"] = *yarn.path_miss;
  out["control_points"] = {yarn.count_u, yarn.count_v};
  if (yarn.self_overlap) out["self_overlap"] = *yarn.self_overlap;
  return out;
}

Json fit_json(const PieceReport::Fit& fit) {
  const auto plane = [](const Vec2& p) { return Json::array({p.x(), p.y()}); };
  Json points = Json::array(), solved = Json::array(), descended = Json::array();
  for (const PieceReport::Point& point : fit.points)
    points.push_back({{"parameter", point.parameter},
                      {"point", plane(point.at)},
                      {"error", point.error},
                      {"distance", point.distance}});
  for (const Vec2& p : fit.solved) solved.push_back(plane(p));
  for (const Vec2& p : fit.descended) descended.push_back(plane(p));
  return {{"shape", fit.shape},
          {"points", points},
          {"largest_error", fit.largest_error},
          {"largest_distance", fit.largest_distance},
          {"control_points", solved},
          {"control_points_by_descent", descended},
          {"descent_steps", fit.iterations}};
}

Json piece_json(const PieceReport& piece) {
  Json edges = Json::array();
  for (const PieceReport::Edge& edge : piece.edges) {
    Json out = {{"name", edge.name}, {"kind", edge.is_line ? "line" : "curve"}, {"length", edge.length}};
    if (edge.fit) out["fit"] = fit_json(*edge.fit);
    edges.push_back(std::move(out));
  }
  Json out = {{"name", piece.name}, {"perimeter", piece.perimeter}, {"area", piece.area}};
  if (piece.valid) out["valid"] = *piece.valid;
  out["edges"] = std::move(edges);
  return out;
}

Json output_json(const OutputReport& output) {
  Json out = {
      {"path", output.path}, {"format", output.format}, {"bytes", output.bytes}, {"sha256", output.sha256}};
  if (!output.entities.empty()) out["entities"] = output.entities;
  return out;
}

template <class T, class Make>
Json list_json(const std::vector<T>& list, Make make) {
  Json out = Json::array();
  for (const T& item : list) out.push_back(make(item));
  return out;
}

Json mesh_json(const MeshReport& mesh) {
  const char* elements = mesh.hexahedra ? "hexahedra" : "tets";
  Json out = {{"nodes", mesh.nodes}, {"tets", mesh.tets}, {"volume", mesh.volume}};
  if (mesh.hexahedra) {
    out["hexahedra"] = *mesh.hexahedra;
  } else {
    out["min_dihedral"] = mesh.min_dihedral;
    out["max_aspect"] = mesh.max_aspect;
    out["volume_error"] = mesh.volume_error;
  }
  if (mesh.below_target) out["below_target"] = *mesh.below_target;
  if (mesh.in_wedges) out["in_wedges"] = *mesh.in_wedges;
  out["regions"] = list_json(mesh.regions, [&](const MeshReport::Region& region) {
    Json one = {
        {"name", region.name}, {"kind", region.kind}, {elements, region.elements}, {"volume", region.volume}};
    if (region.exact_volume) {
      one["exact_volume"] = *region.exact_volume;
      one["volume_error"] = region.volume / *region.exact_volume - 1;
    }
    if (!mesh.hexahedra) one["min_dihedral"] = region.min_dihedral;
    return one;
  });
  if (!mesh.worst.empty())
    out["worst"] = list_json(mesh.worst, [](const MeshReport::Worst& bad) {
      return Json{{"min_dihedral", bad.min_dihedral}, {"region", bad.region}, {"at", point(bad.at)}};
    });
  if (mesh.estimate) out["estimate"] = *mesh.estimate;
  if (!mesh.yarn_share) return out;
  out["yarn_share"] = *mesh.yarn_share;
  out["periodic"] = mesh.periodic;
  out["equations"] = mesh.equations;
  out["load_cases"] = mesh.load_cases;
  return out;
}

// Where both surfaces are met, of an overlap or a near contact.
template <class Place>
void add_sites(Json& to, const Place& place) {
  if (place.site_a) to["site_a"] = Json::array({place.site_a->x(), place.site_a->y()});
  if (place.site_b) to["site_b"] = Json::array({place.site_b->x(), place.site_b->y()});
}

Json relax_json(const RelaxReport& relax) {
  const auto state = [](const RelaxReport::State& from) {
    Json to = {{"overlaps", from.overlaps}};
    if (from.overlaps > 0) to["depth"] = from.depth;
    if (from.min_gap) to["min_gap"] = *from.min_gap;
    return to;
  };
  Json out = {{"solved", relax.solved},
              {"iterations", relax.iterations},
              {"before", state(relax.before)},
              {"after", state(relax.after)},
              {"largest_move", relax.largest_move},
              {"largest_area_change", relax.area_change},
              {"largest_length_change", relax.length_change},
              {"largest_volume_change", relax.volume_change}};
  if (!relax.moved_most.empty()) out["moved_most"] = relax.moved_most;
  if (!relax.reason.empty()) out["reason"] = relax.reason;
  if (!relax.jams.empty()) {
    out["jams"] = list_json(relax.jams, [](const RelaxReport::Jam& jam) {
      return Json{{"a", jam.a}, {"b", jam.b}, {"gap", jam.gap}, {"at", point(jam.at)}};
    });
  }
  return out;
}

Json roundtrip_json(const RoundtripReport& trip) {
  Json out = {{"format", trip.format}, {"seconds", trip.seconds}};
  if (!trip.error.empty()) {
    out["error"] = trip.error;
    return out;
  }
  Json yarns = Json::array();
  for (const RoundtripReport::Yarn& yarn : trip.yarns) {
    yarns.push_back({{"name", yarn.name}});
    if (std::isfinite(yarn.deviation)) yarns.back()["deviation"] = yarn.deviation;
  }
  out["equal"] = trip.equal;
  if (std::isfinite(trip.largest)) out["largest_deviation"] = trip.largest;
  if (!trip.largest_of.empty()) out["largest_of"] = trip.largest_of;
  out["closed"] = {trip.closed_before, trip.closed_after};
  out["volume"] = {trip.volume_before, trip.volume_after};
  out["yarn_count"] = {trip.yarns_before, trip.yarns_after};
  out["yarns"] = yarns;
  out["differences"] = trip.differences;
  if (!trip.notes.empty()) out["notes"] = trip.notes;
  return out;
}

Json message_json(const Message& message, double to_mm) {
  std::string where = message.file;
  if (message.place.line > 0) where += fmt::format(":{}", message.place.line);
  if (message.place.line > 0 && message.place.column > 0) where += fmt::format(":{}", message.place.column);
  Json out = {{"severity", name_of(message.severity)}};
  if (!where.empty()) out["where"] = where;
  out["text"] = message.text;
  if (!message.yarn.empty()) out["yarn"] = message.yarn;
  if (message.at) out["at"] = point(*message.at * to_mm);
  return out;
}

// Names and messages may hold bytes that are not UTF-8: they are replaced, never a reason to fail.
std::string text_of(const Json& json, int indent = -1) {
  return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

std::string text_at(const Json& object, const char* key) {
  if (!object.is_object()) return {};
  const auto found = object.find(key);
  return found != object.end() && found->is_string() ? found->get<std::string>() : std::string();
}

}  // namespace

std::string to_json(const InputReport& report) {
  const double to_mm = millimetres_per(report.units.value_or(Unit::mm));
  Json out = {{"path", report.path}, {"ok", report.ok}, {"seconds", report.seconds}};
  if (!report.sha256.empty()) out["sha256"] = report.sha256;
  if (!report.settings.empty()) out["settings"] = report.settings;
  if (report.units) out["units"] = name_of(*report.units);
  if (report.yarn_count) out["yarn_count"] = *report.yarn_count;
  if (report.yarn_count) out["yarns"] = list_json(report.yarns, yarn_json);
  if (!report.pieces.empty()) out["pieces"] = list_json(report.pieces, piece_json);
  if (report.overlaps) {
    out["overlaps"] = list_json(*report.overlaps, [](const OverlapReport& overlap) {
      Json one{{"a", overlap.a},
               {"b", overlap.b},
               {"depth", overlap.depth},
               {"at", point(overlap.at)},
               {"direction", point(overlap.direction)}};
      if (overlap.area > 0) one["area"] = overlap.area;
      add_sites(one, overlap);
      return one;
    });
  }
  if (report.contacts) {
    out["contacts"] = list_json(*report.contacts, [](const ContactReport& contact) {
      Json one{{"a", contact.a}, {"b", contact.b}, {"gap", contact.gap}, {"at", point(contact.at)}};
      add_sites(one, contact);
      return one;
    });
  }
  if (!report.entities.empty()) out["entities"] = report.entities;
  if (!report.unknown.empty()) out["not_understood"] = report.unknown;
  if (report.min_gap) out["min_gap"] = *report.min_gap;
  if (report.creo_absolute_accuracy) out["creo_absolute_accuracy"] = *report.creo_absolute_accuracy;
  if (!report.outputs.empty()) out["outputs"] = list_json(report.outputs, output_json);
  if (report.instances)
    out["instances"] = {{"shapes", report.instances->shapes},
                        {"copies", report.instances->copies},
                        {"largest_deviation", report.instances->largest_deviation}};
  if (report.relax) out["relax"] = relax_json(*report.relax);
  if (report.mesh) out["mesh"] = mesh_json(*report.mesh);
  if (!report.roundtrips.empty()) out["roundtrips"] = list_json(report.roundtrips, roundtrip_json);
  out["messages"] = list_json(report.messages, [to_mm](const Message& m) { return message_json(m, to_mm); });
  return text_of(out);
}

std::string whole_report(const std::string& started, double seconds, bool ok, const Counts& counts,
                         const std::vector<std::string>& inputs) {
  Json libraries = Json::object();
  for (const auto& [name, version] : library_versions()) libraries[std::string(name)] = version;
  Json list = Json::array();
  for (const std::string& text : inputs)
    if (!text.empty()) list.push_back(Json::parse(text, nullptr, false));
  const Json out = {{"selvage", version()},
                    {"libraries", libraries},
                    {"started", started},
                    {"seconds", seconds},
                    {"ok", ok},
                    {"counts",
                     {{"inputs", counts.inputs},
                      {"done", counts.done},
                      {"failed", counts.failed},
                      {"skipped", counts.skipped}}},
                    {"inputs", list}};
  return text_of(out, 2) + "\n";
}

Result<std::map<std::string, std::string>> read_entries(const std::string& report_path) {
  Result<Source> source = Source::open(report_path);
  if (!source) return source.error();
  const Json report = Json::parse(source->bytes(), nullptr, false);
  const auto inputs = report.is_object() ? report.find("inputs") : report.end();
  if (!report.is_object() || inputs == report.end() || !inputs->is_array()) {
    Message message =
        error(Kind::malformed, "this is not a report of selvage, so nothing can be resumed from it");
    message.file = report_path;
    return message;
  }
  std::map<std::string, std::string> entries;
  for (const Json& entry : *inputs)
    if (const std::string path = text_at(entry, "path"); !path.empty()) entries[path] = text_of(entry);
  return entries;
}

bool is_still_valid(const std::string& entry, const std::string& input_sha256, const std::string& settings,
                    const std::vector<std::string>& output_paths) {
  const Json earlier = Json::parse(entry, nullptr, false);
  if (!earlier.is_object() || !earlier.contains("ok") || earlier["ok"] != true) return false;
  if (text_at(earlier, "sha256") != input_sha256 || text_at(earlier, "settings") != settings) return false;
  const auto outputs = earlier.find("outputs");
  if (outputs == earlier.end() || !outputs->is_array()) return false;
  std::size_t matched = 0;
  const auto is_whole = [&](const std::string& path) {
    const auto found = std::find_if(outputs->begin(), outputs->end(),
                                    [&](const Json& output) { return text_at(output, "path") == path; });
    if (found == outputs->end()) return false;
    const Result<std::string> now = sha256_of_file(path);
    if (!now.ok() || *now != text_at(*found, "sha256")) return false;
    ++matched;
    return true;
  };
  for (const std::string& path : output_paths) {
    if (is_whole(path)) continue;
    // It may have taken several files.
    int number = 1;
    while (is_whole(part_path(path, number).string())) ++number;
    if (number == 1) return false;
  }
  return matched == outputs->size();
}

std::string marked_skipped(const std::string& entry) {
  Json out = Json::parse(entry, nullptr, false);
  if (out.is_object()) out["skipped"] = true;
  return text_of(out);
}

}  // namespace selvage::pipeline
