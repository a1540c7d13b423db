#include "pipeline/variants.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numeric>
#include <random>

#include "core/csv.h"
#include "core/number_text.h"
#include "core/source.h"
#include "core/text_report.h"
#include "core/words.h"

namespace selvage::pipeline {

namespace {

using fabric::Setting;

// What one `--set` says: values, or a range without steps.
struct Axis {
  std::string name;
  std::vector<std::string> values;
  double low = 0, high = 0;  // of a range without steps, which has no values
  std::string unit;          // behind each number of a range
};

Message wrong(std::string_view text, std::string_view what) {
  return error(Kind::usage, fmt::format("--set {}: {}", text, what));
}

// Nine digits, in which 0.9 + 0.05 is 0.95.
std::string short_number(double value) {
  return fmt::format("{:.9g}", value);
}

// LOW:HIGH or LOW:HIGH:STEP; a unit may stand behind the last number or behind all of them.
Result<Axis> range_of(Axis axis, std::string_view given, const std::vector<std::string_view>& parts) {
  if (parts.size() > 3) return wrong(given, "a range is LOW:HIGH or LOW:HIGH:STEP");
  std::vector<double> numbers;
  for (const std::string_view part : parts) {
    double number = 0;
    const auto [stop, failure] = std::from_chars(part.data(), part.data() + part.size(), number);
    const std::string_view unit(stop, static_cast<std::size_t>(part.data() + part.size() - stop));
    if (failure != std::errc() || !std::isfinite(number))
      return wrong(given, fmt::format("'{}' is not a number", part));
    if (!axis.unit.empty() && unit != axis.unit) return wrong(given, "its numbers have different units");
    axis.unit = unit;
    numbers.push_back(number);
  }
  axis.low = numbers[0];
  axis.high = numbers[1];
  if (!(axis.low < axis.high)) return wrong(given, "a range goes from the smaller number to the larger one");
  if (numbers.size() == 2) return axis;
  const double step = numbers[2];
  if (!(step > 0.0)) return wrong(given, "a step is larger than 0");
  const double steps = std::floor((axis.high - axis.low) / step * (1.0 + 1e-12) + 1e-9);
  if (Status few = check_number(steps + 1.0); !few) return few.error();
  for (std::size_t i = 0; i <= static_cast<std::size_t>(steps); ++i)
    axis.values.push_back(short_number(axis.low + static_cast<double>(i) * step) + axis.unit);
  return axis;
}

Result<Axis> axis_of(const std::string& given, bool is_sweep) {
  const std::size_t equals = given.find('=');
  if (equals == std::string::npos || equals == 0 || equals + 1 == given.size())
    return wrong(given, "it is NAME=VALUE");
  Axis axis;
  axis.name = given.substr(0, equals);
  const std::string_view value = std::string_view(given).substr(equals + 1);
  const bool is_call =
      value.find('(') != std::string_view::npos;  // its commas and colons are an expression's
  const std::vector<std::string_view> parts = split(value, ':'), list = split(value, ',');
  const bool is_range = parts.size() > 1 && !is_call, is_list = list.size() > 1 && !is_call;
  if ((is_range || is_list) && !is_sweep)
    return wrong(given, "several values are for `selvage sweep`, which makes a variant of each");
  if (is_range) return range_of(std::move(axis), given, parts);
  if (is_list)
    axis.values.assign(list.begin(), list.end());
  else
    axis.values.emplace_back(value);
  if (std::any_of(axis.values.begin(), axis.values.end(), [](const std::string& v) { return v.empty(); }))
    return wrong(given, "a value is missing");
  return axis;
}

// All combinations; the last axis changes fastest.
Result<Variants> grid_of(const std::vector<Axis>& axes) {
  double count = 1;
  for (const Axis& axis : axes) {
    if (axis.values.empty())
      return wrong(axis.name, "a range without a step is for --lhs; with one it is LOW:HIGH:STEP");
    count *= static_cast<double>(axis.values.size());
  }
  if (Status few = check_number(count); !few) return few.error();
  Variants all(static_cast<std::size_t>(count));
  std::size_t each = all.size();
  for (const Axis& axis : axes) {
    each /= axis.values.size();
    for (std::size_t i = 0; i < all.size(); ++i)
      all[i].push_back({axis.name, axis.values[i / each % axis.values.size()]});
  }
  return all;
}

// A number in [0, 1), the same everywhere: std::uniform_real_distribution is not.
double uniform(std::mt19937_64& random) {
  return static_cast<double>(random() >> 11U) * 0x1p-53;
}

Variants hypercube_of(const std::vector<Axis>& axes, std::size_t samples, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  Variants all(samples);
  for (const Axis& axis : axes) {
    std::vector<std::size_t> part(samples);
    std::iota(part.begin(), part.end(), std::size_t{0});
    for (std::size_t i = samples; i > 1; --i)
      std::swap(part[i - 1], part[static_cast<std::size_t>(uniform(random) * static_cast<double>(i))]);
    for (std::size_t i = 0; i < samples; ++i) {
      if (!axis.values.empty()) {
        all[i].push_back({axis.name, axis.values[part[i] * axis.values.size() / samples]});
        continue;
      }
      const double share = (static_cast<double>(part[i]) + uniform(random)) / static_cast<double>(samples);
      all[i].push_back({axis.name, short_number(axis.low + share * (axis.high - axis.low)) + axis.unit});
    }
  }
  return all;
}

// A zero byte ends a text to some, and goes on for others.
bool is_usable(std::string_view text) {
  return text.find('\0') == std::string_view::npos;
}

Result<Variants> rows_of_table(const std::string& path) {
  constexpr std::size_t largest_table = std::size_t{1} << 26;  // bytes: a row of 64 for each variant
  constexpr std::size_t longest_name = 256;                    // stands in each row
  const Result<Source> source = Source::open(path, largest_table);
  if (!source) return error(Kind::usage, fmt::format("--table: {}", source.error().text), {.file = path});
  const Result<CsvTable> table = read_csv(source->bytes());
  const auto at_table = [&](Message message) {
    message.kind = Kind::usage;
    message.file = path;
    return message;
  };
  if (!table) return at_table(table.error());
  for (const std::string& name : table->columns)
    if (name.size() > longest_name || !is_usable(name))
      return at_table(error(Kind::usage, fmt::format("no param is called {}", in_quotes(name)))
                          .placed({table->head_line, 1}));
  if (Status few = check_number(static_cast<double>(table->rows.size())); !few) return at_table(few.error());
  Variants all;
  for (std::size_t row = 0; row < table->rows.size(); ++row) {
    std::vector<Setting>& settings = all.emplace_back();
    for (std::size_t column = 0; column < table->columns.size(); ++column) {
      const std::string& value = table->rows[row][column];
      if (value.empty())
        return at_table(error(Kind::usage, fmt::format("the value of {} is missing", table->columns[column]))
                            .placed({table->lines[row], 1}));
      if (!is_usable(value))
        return at_table(
            error(Kind::usage, fmt::format("the value of {} has a zero byte", table->columns[column]))
                .placed({table->lines[row], 1}));
      settings.push_back({table->columns[column], value});
    }
  }
  return all;
}

}  // namespace

Status check_number(double count) {
  if (count <= static_cast<double>(most_variants)) return {};
  return error(Kind::usage, fmt::format("{:.10g} variants are more than the {} that one call makes: larger "
                                        "steps, or --lhs N, which samples the ranges",
                                        count, most_variants));
}

Result<Variants> variants_of(const Options& options) {
  const SweepWords& words = options.sweep;
  std::vector<Axis> axes;
  for (const std::string& given : words.sets) {
    Result<Axis> axis = axis_of(given, words.wanted);
    if (!axis) return axis.error();
    if (std::any_of(axes.begin(), axes.end(), [&](const Axis& other) { return other.name == axis->name; }))
      return wrong(given, "this param is set twice");
    axes.push_back(std::move(*axis));
  }
  if (words.samples > 0) {
    if (axes.empty()) return error(Kind::usage, "--lhs samples ranges: --set NAME=LOW:HIGH");
    return hypercube_of(axes, words.samples, words.seed);
  }
  Result<Variants> grid = grid_of(axes);
  if (!grid || words.table.empty()) return grid;
  Result<Variants> rows = rows_of_table(words.table);
  if (!rows) return rows;
  if (Status few = check_number(static_cast<double>(rows->size()) * static_cast<double>(grid->size())); !few)
    return few.error();
  Variants all;
  for (const std::vector<Setting>& row : *rows)
    for (const std::vector<Setting>& point : *grid) {
      all.push_back(row);
      all.back().insert(all.back().end(), point.begin(), point.end());
    }
  return all;
}

}  // namespace selvage::pipeline
