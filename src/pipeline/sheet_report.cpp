#include "pipeline/sheet_report.h"

#include <fmt/format.h>

#include <map>

#include "core/readable.h"
#include "pipeline/table.h"

namespace selvage::pipeline {

namespace {

constexpr double per_cm = 10, per_inch = 25.4;

std::string cell(const std::optional<double>& value, double times = 1) {
  return value ? pipeline::cell(times * *value) : "-";
}
std::optional<double> known(double value) {
  return value > 0 ? std::optional(value) : std::nullopt;
}
std::string percent(const std::optional<double>& share) {
  return share ? fmt::format("{:.2f} %", 100 * *share) : "-";
}

std::string line(std::string_view what, std::string_view value) {
  return fmt::format("    {:<18}{}\n", what, value);
}

Json system_json(const fabric::SystemSheet& system, bool is_per_metre) {
  Json json;
  const auto put = [&](const char* key, const std::optional<double>& value, double times = 1) {
    if (value) json[key] = times * *value;
  };
  if (is_per_metre)
    put("yarns", system.per_mm);
  else
    put("per_cm", system.per_mm, per_cm);
  put("crimp", system.crimp);
  put("take_up", system.take_up);
  put("yarn_ratio", system.yarn_ratio);
  put("length", system.length);
  put("mass", known(system.mass));
  put("cover_factor", system.cover_factor);
  put("loop_length", system.loop_length);
  put("tightness_factor", system.tightness);
  put("run_in", system.run_in);
  return json;
}

Json thread_json(const fabric::ThreadSheet& thread) {
  Json json;
  const auto put = [&](const char* key, const std::optional<double>& value) {
    if (value) json[key] = *value;
  };
  put("tex", known(thread.tex));
  put("length", thread.length);
  put("mass", known(thread.mass));
  put("fibre_fraction", known(thread.fibre_fraction));
  put("twist_factor", thread.twist_factor);
  put("cotton_twist_factor", thread.cotton_twist_factor);
  return json;
}

void add_equilibrium(const fabric::EquilibriumReport& found, Json& json) {
  for (const auto& system : found.systems) {
    Json& of = json["systems"][std::string(system.name)];
    of["width"] = system.width;
    of["height"] = system.height;
    of["width_between"] = system.width_between;
    of["height_between"] = system.height_between;
    of["axis_height"] = system.axis_height;
    of["packing_fraction"] = system.packing;
  }
  json["energy"] = found.energy;
  json["bending_fraction"] = found.bending;
  json["tension_fraction"] = found.tension;
  json["flattening_fraction"] = found.flattening;
  json["compaction_fraction"] = found.compaction;
  json["newton_steps"] = found.steps;
  json["residual"] = found.residual;
}

Json sheet_json(const fabric::Sheet& sheet) {
  Json json;
  const auto put = [&](const char* key, const std::optional<double>& value, double times = 1) {
    if (value) json[key] = times * *value;
  };
  put("mass", known(sheet.mass));
  put("linear_mass", known(sheet.linear_mass));
  put("thickness", sheet.thickness);
  put("cover", sheet.cover);
  put("porosity", sheet.porosity());
  put("yarn_fraction", sheet.yarn_fraction);
  put("fibre_fraction", known(sheet.fibre_fraction));
  put("courses_per_cm", sheet.courses_per_mm, per_cm);
  put("wales_per_cm", sheet.wales_per_mm, per_cm);
  put("braid_angle", sheet.braid_angle);
  if (sheet.pile) {
    put("pile_height", sheet.pile->height);
    put("ground_thickness", sheet.pile->ground);
    put("pile_ratio", sheet.pile_ratio);
    put("wales_per_cm", sheet.pile->wales_per_mm, per_cm);
  }
  put("repeat_x", sheet.repeat_x);
  put("repeat_y", known(sheet.repeat_y));
  for (const fabric::SystemSheet& system : sheet.systems)
    json["systems"][system.name] = system_json(system, sheet.is_per_metre());
  if (sheet.equilibrium) add_equilibrium(*sheet.equilibrium, json);
  for (const fabric::ThreadSheet& thread : sheet.threads) json["threads"][thread.name] = thread_json(thread);
  return json;
}

std::string systems_table(const fabric::Sheet& sheet) {
  const bool is_per_metre = sheet.is_per_metre(), is_knit = sheet.courses_per_mm.has_value();
  const std::string_view on = is_per_metre ? "m" : "m2";
  std::vector<std::string> heads = {"system"};
  if (is_per_metre)
    heads.emplace_back("yarns");
  else
    heads.insert(heads.end(), {"per cm", "per inch"});
  heads.insert(heads.end(), {is_knit        ? "yarn/fabric"
                             : is_per_metre ? "take-up %"
                                            : "crimp %",
                             fmt::format("m/{}", on), fmt::format("g/{}", on)});
  if (sheet.kind == "weave") heads.emplace_back("cover factor");
  if (sheet.kind == "knit") heads.insert(heads.end(), {"loop length mm", "tightness factor"});
  if (sheet.kind == "warpknit") heads.emplace_back("mm a rack");
  Table table(std::move(heads));
  for (const fabric::SystemSheet& system : sheet.systems) {
    std::vector<std::string> cells = {system.name};
    if (is_per_metre)
      cells.push_back(cell(system.per_mm));
    else
      cells.insert(cells.end(), {cell(system.per_mm, per_cm), cell(system.per_mm, per_inch)});
    const auto in_percent = [](double share) { return fmt::format("{:.2f}", 100 * share); };
    cells.insert(cells.end(), {system.crimp        ? in_percent(*system.crimp)
                               : system.take_up    ? in_percent(*system.take_up)
                               : system.yarn_ratio ? fmt::format("{:.4g}", *system.yarn_ratio)
                                                   : "-",
                               pipeline::cell(system.length), cell(known(system.mass))});
    if (sheet.kind == "weave") cells.push_back(cell(system.cover_factor));
    if (sheet.kind == "knit") cells.insert(cells.end(), {cell(system.loop_length), cell(system.tightness)});
    if (sheet.kind == "warpknit") cells.push_back(cell(system.run_in));
    table.add(cells);
  }
  return table.text();
}

std::string threads_table(const fabric::Sheet& sheet) {
  const std::string_view on = sheet.is_per_metre() ? "m" : "m2";
  Table table({"thread", "tex", "fibres %", fmt::format("m/{}", on), fmt::format("g/{}", on), "twist factor",
               "(cotton)"});
  for (const fabric::ThreadSheet& thread : sheet.threads)
    table.add({thread.name, cell(known(thread.tex)), cell(known(thread.fibre_fraction), 100),
               pipeline::cell(thread.length), cell(known(thread.mass)), cell(thread.twist_factor),
               cell(thread.cotton_twist_factor)});
  return table.text();
}

std::string equilibrium_text(const fabric::EquilibriumReport& found) {
  std::string text = line("equilibrium", fmt::format("state {}; {} Newton steps, residual {:.1e}",
                                                     found.state, found.steps, found.residual));
  text += line(
      "energy",
      fmt::format("bending {:.0f} %, tension {:.0f} %, flattening {:.0f} %, compaction {:.0f} %",
                  100 * found.bending, 100 * found.tension, 100 * found.flattening, 100 * found.compaction));
  Table table({"system", "section at crossings, mm", "between", "packing", "crimp %", "take-up %"});
  const auto size = [](double width, double height) { return fmt::format("{:.4g} x {:.4g}", width, height); };
  for (const auto& system : found.systems)
    table.add({std::string(system.name), size(system.width, system.height),
               size(system.width_between, system.height_between), fmt::format("{:.3f}", system.packing),
               fmt::format("{:.2f}", 100 * system.crimp), fmt::format("{:.2f}", 100 * system.take_up())});
  return text + table.text();
}

std::string without_mass(const fabric::Sheet& sheet) {
  for (const fabric::ThreadSheet& thread : sheet.threads)
    if (!(thread.tex > 0))
      return fmt::format(": thread '{}' says neither its tex nor its material", shortened(thread.name, 30));
  return {};
}

}  // namespace

std::string sheet_text(const fabric::Sheet& sheet, std::string_view file) {
  const auto with = [&](const std::optional<double>& value, std::string_view unit) {
    return value ? fmt::format("{:.4g} {}", *value, unit) : "not known" + without_mass(sheet);
  };
  std::string text = fmt::format("  data sheet of the {} at line {}", sheet.kind, sheet.place.line);
  if (sheet.file != file) text += fmt::format(" of {}", readable(sheet.file));
  text += sheet.repeat_y > 0
              ? fmt::format(", endless, by a repeat of {:.6g} x {:.6g} mm\n", sheet.repeat_x, sheet.repeat_y)
              : fmt::format(", endless, by a repeat of {:.6g} mm\n", sheet.repeat_x);
  text += line("mass", with(known(sheet.mass), "g/m2"));
  if (sheet.linear_mass > 0) text += line("", with(sheet.linear_mass, "g/m"));
  text += line("thickness", with(sheet.thickness, "mm"));
  if (sheet.pile) {
    text += line("of the ground", with(sheet.pile->ground, "mm"));
    text += line("pile height", with(sheet.pile->height, "mm"));
    if (sheet.pile_ratio) text += line("pile ratio", fmt::format("{:.4g}", *sheet.pile_ratio));
    if (const auto& wales = sheet.pile->wales_per_mm)
      text +=
          line("wales", fmt::format("{:.4g} per cm, {:.4g} per inch", per_cm * *wales, per_inch * *wales));
  }
  if (sheet.braid_angle) text += line("braid angle", with(sheet.braid_angle, "degrees"));
  if (sheet.courses_per_mm)
    text += line("courses x wales", fmt::format("{:.4g} x {:.4g} per cm", per_cm * *sheet.courses_per_mm,
                                                per_cm * *sheet.wales_per_mm));
  if (sheet.cover) text += line("cover", percent(sheet.cover));
  text += line("yarns fill", percent(sheet.yarn_fraction));
  if (sheet.fibre_fraction > 0) {
    text += line("fibres fill", percent(sheet.fibre_fraction));
    text += line("porosity", percent(sheet.porosity()));
  }
  if (sheet.equilibrium) text += equilibrium_text(*sheet.equilibrium);
  return text + systems_table(sheet) + threads_table(sheet);
}

Json sheets_json(std::span<const fabric::Sheet> sheets) {
  Json json;
  std::map<std::string, int> numbers;
  for (const fabric::Sheet& sheet : sheets) {
    const int number = ++numbers[sheet.kind];
    json[number == 1 ? sheet.kind : fmt::format("{}_{}", sheet.kind, number)] = sheet_json(sheet);
  }
  return json;
}

}  // namespace selvage::pipeline
