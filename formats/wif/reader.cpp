#include "formats/wif/reader.h"

#include <fmt/format.h>

#include <array>

#include "formats/wif/yarns.h"

namespace selvage::formats::wif {

namespace {

// Sections of the specification that this reader uses: what [CONTENTS] promises of them is looked after.
constexpr std::array<std::string_view, 15> used_sections = {
    "COLOR PALETTE", "COLOR TABLE",  "WEAVING",      "WARP",           "WEFT",
    "THREADING",     "TIEUP",        "TREADLING",    "LIFTPLAN",       "WARP COLORS",
    "WEFT COLORS",   "WARP SPACING", "WEFT SPACING", "WARP THICKNESS", "WEFT THICKNESS"};

void check_contents(const Ini& ini, TextReport& report) {
  for (const std::string_view name : used_sections) {
    const Entry* const entry = ini.find("CONTENTS", name);
    if (entry == nullptr || ini.find(name) != nullptr) continue;
    if (boolean(*entry, report).value_or(false))
      report.warning(entry->key_spot, fmt::format("[CONTENTS] promises [{}], which is not there", name));
  }
}

void check_version(const Ini& ini, TextReport& report) {
  const Entry* const version = ini.find("WIF", "Version");
  if (version == nullptr) return;
  const std::optional<double> number = real_number(*version, report);
  if (number && *number >= 2)
    report.warning(version->value_spot, "a WIF of a later version; it is read as version 1.1");
}

bool refuse_binary(const Source& source, TextReport& report) {
  const std::string_view bytes = source.bytes();
  const Spot start;
  const bool is_wide = bytes.starts_with("\xFF\xFE") || bytes.starts_with("\xFE\xFF");
  if (is_wide)
    report.error(start, "the text is UTF-16; save it as UTF-8");
  else if (bytes.find('\0') != std::string_view::npos)
    report.error(start, "this is no text: it has zero bytes");
  return report.errors() > 0;
}

// A title fit for every format: UTF-8 (older programs write Latin-1), without control characters and double
// quotes.
std::string made_title(std::string_view text) {
  const bool is_utf8 = [&] {
    std::string plain(text);
    for (char& c : plain)
      if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F) c = ' ';
    return text_prefix(plain) == plain.size();
  }();
  std::string title;
  for (const char c : text) {
    const auto code = static_cast<unsigned char>(c);
    if (code < 0x20 || code == 0x7F)
      title += ' ';
    else if (c == '"')
      title += '\'';
    else if (code < 0x80 || is_utf8)
      title += c;
    else
      title.append({static_cast<char>(0xC0 | code >> 6U), static_cast<char>(0x80 | (code & 0x3FU))});
  }
  return title;
}

std::optional<fabric::Fabric> read(const Source& source, TextReport& report) {
  if (refuse_binary(source, report)) return std::nullopt;
  const Ini ini(source, report);
  if (ini.find("WIF") == nullptr) return report.error(Spot(), "this is no WIF: the section [WIF] is missing");
  check_version(ini, report);
  check_contents(ini, report);
  const Loom loom = read_loom(ini, report);
  std::optional<std::vector<std::string>> rows = read_drawdown(ini, loom, report);
  if (!rows || report.errors() > 0) return std::nullopt;
  Yarns yarns =
      read_yarns(ini, loom, static_cast<int>(rows->front().size()), static_cast<int>(rows->size()), report);
  if (report.errors() > 0) return std::nullopt;

  fabric::Fabric fabric;
  fabric.file = source.name();
  fabric.units = yarns.units;
  fabric.units_given = true;
  const Entry* const title = ini.find("TEXT", "Title");
  if (title != nullptr && !title->value.empty()) fabric.title = made_title(title->value);
  fabric.threads = std::move(yarns.threads);
  fabric::Weave weave;
  weave.place = ini.find("WEAVING")->spot.place();
  weave.warp = std::move(yarns.warp);
  weave.weft = std::move(yarns.weft);
  weave.draft.form = fabric::Draft::Form::rows;
  weave.draft.rows = std::move(*rows);
  fabric.items.emplace_back(std::move(weave));
  return fabric;
}

}  // namespace

std::optional<fabric::Fabric> read_fabric(const Source& source, Diagnostics& diagnostics) {
  return reported(source, diagnostics, read);
}

}  // namespace selvage::formats::wif
