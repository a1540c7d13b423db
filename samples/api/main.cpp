// plain_weave FILE.igs: the cloth of samples/weave_plain.txt, made in code and written as IGES.
#include <cstdio>
#include <filesystem>
#include <memory>

#include "construction/build.h"
#include "formats/registry.h"

namespace {

using namespace selvage;

fabric::Fabric plain_weave() {
  fabric::Thread cotton;
  cotton.name = "cotton";
  cotton.diameter = 0.3;  // mm, as the fabric's units are
  cotton.color = yarn::Color{225, 215, 195};

  fabric::Weave weave;
  weave.warp.threads = weave.weft.threads = {cotton.name};
  weave.warp.count = weave.weft.count = 4;
  weave.warp.pitch = weave.weft.pitch = 0.7;
  weave.draft.form = fabric::Draft::Form::plain;
  weave.profile = fabric::Weave::Profile::peirce;  // without: in equilibrium

  fabric::Fabric cloth;
  cloth.title = "Plain weave of round yarns, by Peirce's arcs and straights";
  cloth.threads.push_back(cotton);
  cloth.items.emplace_back(weave);
  return cloth;
}

// Builds one yarn after the other, and hands it to the writer. What there is to say goes to `diagnostics`.
Status write(const fabric::Fabric& cloth, const std::filesystem::path& path, Diagnostics& diagnostics) {
  const fabric::BuildOptions build;
  const std::optional<fabric::YarnBuilder> builder = fabric::YarnBuilder::create(cloth, build, diagnostics);
  if (!builder) return *diagnostics.first_error();

  Result<OutputFile> file = OutputFile::create(path);
  if (!file) return file.error();
  formats::SurfaceOptions options;
  options.title = cloth.title.value_or("");
  options.file_name = path.filename();
  options.units = cloth.units;
  options.expected_bodies = builder->count();
  options.tolerance = fabric::tolerance_of(cloth, build);
  Result<std::unique_ptr<formats::BodyWriter>> writer =
      formats::iges::descriptor().open_bodies(*file, options);
  if (!writer) return writer.error();

  for (std::size_t i = 0; i < builder->count(); ++i) {
    const Result<yarn::Body> body = builder->build(i);
    if (!body) return body.error();
    for (const Message& message : body->messages) diagnostics.add(message);
    if (Status added = (*writer)->add(*body); !added) return added;
  }
  const Result<formats::WriteFacts> written = (*writer)->finish();
  if (!written) return written.error();
  for (const Message& message : written->messages) diagnostics.add(message);
  return file->commit();
}

}  // namespace

int main(int count, char** words) {
  if (count != 2) {
    std::fprintf(stderr, "usage: plain_weave FILE.igs\n");
    return 2;
  }
  Diagnostics diagnostics;
  const Status done = write(plain_weave(), words[1], diagnostics);
  for (const Message& message : diagnostics.messages())
    if (message.severity != Severity::error) std::fprintf(stderr, "%s\n", to_string(message).c_str());
  if (done) return 0;
  std::fprintf(stderr, "%s\n", to_string(done.error()).c_str());
  return 1;
}
