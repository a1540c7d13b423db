#include "property/zoo.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "core/source.h"
#include "formats/format.h"
#include "formats/registry.h"
#include "places.h"

namespace selvage::zoo {

namespace {

const formats::Descriptor* reader_for(const std::string& extension) {
  for (const formats::Descriptor* format : formats::all_formats())
    if (format->read_fabric != nullptr && std::find(format->extensions.begin(), format->extensions.end(),
                                                    extension) != format->extensions.end())
      return format;
  return nullptr;
}

std::string text_of(const Diagnostics& diagnostics) {
  std::string text;
  for (const Message& message : diagnostics.messages()) text += to_string(message) + "\n";
  return text;
}

std::vector<ZooFabric> read_all() {
  std::vector<ZooFabric> zoo;
  for (const auto& entry : std::filesystem::directory_iterator(places::samples())) {
    const formats::Descriptor* format = reader_for(entry.path().extension().string());
    if (!entry.is_regular_file() || format == nullptr) continue;
    Result<Source> source = Source::open(entry.path().string());
    Diagnostics diagnostics;
    std::optional<fabric::Fabric> fabric;
    if (source.ok()) fabric = format->read_fabric(*source, diagnostics);
    if (fabric)
      zoo.push_back({entry.path().filename().string(), std::move(*fabric)});
    else
      ADD_FAILURE() << entry.path() << ": " << text_of(diagnostics);
  }
  std::sort(zoo.begin(), zoo.end(), [](const ZooFabric& a, const ZooFabric& b) { return a.name < b.name; });
  return zoo;
}

}  // namespace

const std::vector<ZooFabric>& all() {
  static const std::vector<ZooFabric> zoo = read_all();
  return zoo;
}

std::vector<fabric::YarnPlan> plans_of(const fabric::Fabric& fabric) {
  std::vector<fabric::YarnPlan> plans;
  Diagnostics diagnostics;
  const std::optional<fabric::YarnBuilder> builder = fabric::YarnBuilder::create(fabric, {}, diagnostics);
  if (!builder) {
    ADD_FAILURE() << fabric.file << ": " << text_of(diagnostics);
    return plans;
  }
  for (std::size_t i = 0; i < builder->count(); ++i) {
    Result<fabric::YarnPlan> plan = builder->plan(i);
    if (plan.ok())
      plans.push_back(std::move(*plan));
    else
      ADD_FAILURE() << to_string(plan.error());
  }
  return plans;
}

std::vector<fabric::YarnPlan> plans_of(const ZooFabric& zoo) {
  return plans_of(zoo.fabric);
}

fabric::Fabric fabric_of(const std::string& text) {
  const Source source = Source::from_memory(text, "test.txt");
  Diagnostics diagnostics;
  std::optional<fabric::Fabric> fabric = formats::txt::descriptor().read_fabric(source, diagnostics);
  if (!fabric) {
    ADD_FAILURE() << text_of(diagnostics);
    return {};
  }
  return std::move(*fabric);
}

}  // namespace selvage::zoo
