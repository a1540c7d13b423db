#include "pipeline/batch_plan.h"

#include <algorithm>
#include <charconv>

namespace selvage::pipeline {

namespace {

void add(std::string& record, std::string_view field) {
  record += field;
  record += '\0';
}

void add(std::string& record, std::size_t number) {
  add(record, std::string_view(std::to_string(number)));
}

// Reads what add() wrote.
class Fields {
 public:
  explicit Fields(std::string_view record) : rest_(record) {}
  std::string_view next() {
    const std::size_t end = rest_.find('\0');
    const std::string_view field = rest_.substr(0, end);
    rest_.remove_prefix(end + 1);
    return field;
  }
  std::size_t number() {
    const std::string_view field = next();
    std::size_t value = 0;
    std::from_chars(field.data(), field.data() + field.size(), value);
    return value;
  }

 private:
  std::string_view rest_;
};

}  // namespace

BatchPlan::BatchPlan(const std::vector<Input>& inputs,
                     const std::vector<std::vector<PlannedOutput>>& outputs) {
  records_.reserve(inputs.size());
  std::string record;
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    record.clear();
    for (const std::string* field : {&inputs[i].path, &inputs[i].stem, &inputs[i].other}) add(record, *field);
    add(record, inputs[i].settings.size());
    for (const fabric::Setting& setting : inputs[i].settings) {
      add(record, setting.name);
      add(record, setting.value);
    }
    add(record, outputs[i].size());
    for (const PlannedOutput& output : outputs[i]) {
      const auto format = std::find(formats_.begin(), formats_.end(), output.format);
      add(record, static_cast<std::size_t>(format - formats_.begin()));
      if (format == formats_.end()) formats_.push_back(output.format);
      add(record, output.path);
      add(record, (output.to_standard_output ? 1U : 0U) + (output.is_companion ? 2U : 0U));
      add(record, output.taken.size());
      for (const std::filesystem::path& name : output.taken) add(record, name.native());
    }
    records_.push_back(text_.keep(record));
  }
}

std::string_view BatchPlan::path(std::size_t index) const {
  return Fields(records_[index]).next();
}

std::string BatchPlan::name(std::size_t index) const {
  return at(index).input.name();
}

PlannedInput BatchPlan::at(std::size_t index) const {
  Fields fields(records_[index]);
  PlannedInput planned;
  for (std::string* field : {&planned.input.path, &planned.input.stem, &planned.input.other})
    *field = fields.next();
  planned.input.settings.resize(fields.number());
  for (fabric::Setting& setting : planned.input.settings) {
    setting.name = fields.next();
    setting.value = fields.next();
  }
  planned.outputs.resize(fields.number());
  for (PlannedOutput& output : planned.outputs) {
    output.format = formats_[fields.number()];
    output.path = fields.next();
    const std::size_t flags = fields.number();
    output.to_standard_output = (flags & 1U) != 0;
    output.is_companion = (flags & 2U) != 0;
    for (std::size_t left = fields.number(); left > 0; --left) output.taken.emplace_back(fields.next());
  }
  return planned;
}

}  // namespace selvage::pipeline
