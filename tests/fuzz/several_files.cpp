#include "fuzz/several_files.h"

#include <array>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "core/temporary.h"
#include "formats/registry.h"
#include "fuzz/field_mesh.h"
#include "pipeline/named_files.h"
#include "results/solved_deck.h"

namespace selvage::fuzz {

namespace {

namespace fs = std::filesystem;

constexpr std::string_view separator = "\n===\n";
constexpr std::array<const char*, 4> names = {"a.txt", "b.txt", "c.wif", "d.csv"};

const TemporaryFolder& folder() {
  static const TemporaryFolder made = [] {
    std::error_code failure;
    if (fs::is_directory("/dev/shm", failure)) ::setenv("TMPDIR", "/dev/shm", 1);
    Result<TemporaryFolder> created = TemporaryFolder::create();
    if (!created) std::abort();
    return std::move(*created);
  }();
  return made;
}

}  // namespace

std::vector<std::string_view> parts_of(std::string_view bytes, std::size_t count) {
  std::vector<std::string_view> parts;
  while (parts.size() + 1 < count) {
    const std::size_t end = bytes.find(separator);
    if (end == std::string_view::npos) break;
    parts.push_back(bytes.substr(0, end + 1));
    bytes.remove_prefix(end + separator.size());
  }
  parts.push_back(bytes);
  parts.resize(count);
  return parts;
}

void run_use(std::string_view bytes) {
  const std::vector<std::string_view> parts = parts_of(bytes, names.size());
  for (std::size_t i = 0; i < names.size(); ++i) {
    std::ofstream file(folder().path() / names[i], std::ios::binary);
    if (!(file << parts[i]).flush()) std::abort();
  }
  const Source source =
      Source::from_memory(std::string(parts.front()), (folder().path() / names.front()).string());
  const formats::Descriptor& format = *formats::all_formats().front();
  Diagnostics diagnostics;
  std::optional<fabric::Fabric> fabric = format.read_fabric(source, diagnostics);
  if (fabric)
    for (const std::string& file : pipeline::resolve_files(*fabric, source, false, diagnostics))
      if (fs::canonical(folder().path() / file.substr(0, file.rfind(' '))).parent_path() !=
          fs::canonical(folder().path()))
        std::abort();  // none outside is read
  for (const Message& message : diagnostics.messages()) static_cast<void>(to_string(message));
}

void run_results(std::string_view bytes) {
  const std::vector<std::string_view> parts = parts_of(bytes, 2);
  std::optional<fem::FieldMesh> mesh;
  std::optional<fem::SolvedDeck> deck;
  Diagnostics diagnostics;
  for (const formats::Descriptor* format : formats::all_formats()) {
    const std::string name = "input" + std::string(format->extensions.front());
    if (format->name == "frd")
      mesh = format->read_mesh(Source::from_memory(std::string(parts[0]), name), diagnostics);
    if (format->read_deck != nullptr)
      deck = format->read_deck(Source::from_memory(std::string(parts[1]), name), diagnostics);
  }
  if (!mesh || !deck) return;
  if (fem::apply(*deck, *mesh)) evaluate(*mesh);
}

}  // namespace selvage::fuzz
