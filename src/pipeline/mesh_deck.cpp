#include "pipeline/mesh_deck.h"

#include <fmt/format.h>

#include <filesystem>

#include "core/source.h"
#include "core/text_report.h"
#include "formats/registry.h"
#include "results/solved_deck.h"

namespace selvage::pipeline {

namespace {

namespace fs = std::filesystem;

const formats::Descriptor* reader_of_decks() {
  for (const formats::Descriptor* format : formats::all_formats())
    if (format->read_deck != nullptr) return format;
  return nullptr;
}

// The deck, or why there is none, as messages.
bool apply_deck(const std::string& path, fem::FieldMesh& mesh, std::vector<Message>& messages) {
  const Result<Source> source = Source::open(path);
  if (!source) {
    messages.push_back(source.error());
    return false;
  }
  Diagnostics diagnostics;
  const std::optional<fem::SolvedDeck> deck = reader_of_decks()->read_deck(*source, diagnostics);
  messages = diagnostics.messages();
  if (!deck) return false;
  const Status applied = fem::apply(*deck, mesh);
  if (!applied) messages.push_back(applied.error());
  return applied.ok();
}

// CalculiX's stresses at nodes are means over all that meets there.
bool has_mixed_stresses(const fem::FieldMesh& mesh) {
  if (mesh.element_numbers.empty() || mesh.regions.size() < 2) return false;
  for (const fem::FieldMesh::Field& field : mesh.fields)
    if (field.of_nodes && field.components == 6) return true;
  return false;
}

}  // namespace

bool take_deck(Job& job, fem::FieldMesh& mesh) {
  const bool is_named = !job.options.deck.empty();
  const std::string path =
      is_named ? job.options.deck : fs::path(job.input.path).replace_extension(".inp").string();
  if (is_named && mesh.element_numbers.empty())
    return job.fail(error(Kind::unsupported,
                          "--deck is of CalculiX's results (FRD): this file has no numbers of elements"));
  std::error_code failure;
  if (is_named || (!mesh.element_numbers.empty() && fs::is_regular_file(path, failure))) {
    std::vector<Message> messages;
    if (apply_deck(path, mesh, messages)) {
      job.say(note(Kind::unsupported,
                   fmt::format("stresses and strains are reckoned from the displacements and the "
                               "materials of {}",
                               in_quotes(path))));
      return true;
    }
    for (Message& message : messages) {
      if (!is_named && message.severity == Severity::error) {
        message.severity = Severity::warning;
        message.text += fmt::format("; the deck beside the results ({}) is left", in_quotes(path));
      }
      job.say(std::move(message));
    }
    if (is_named) return false;
  }
  if (has_mixed_stresses(mesh))
    job.say(
        warning(Kind::unsupported,
                "stresses and strains where two materials meet are means over both, as CalculiX writes them: "
                "with the deck (--deck FILE.inp, or beside the results) each has its own"));
  return true;
}

}  // namespace selvage::pipeline
