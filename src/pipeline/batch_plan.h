// The inputs of a run and their outputs, kept so that a run of 100,000 is as fast an input as one of ten.
#pragma once

#include <string_view>
#include <vector>

#include "core/shared_text.h"
#include "pipeline/inputs.h"
#include "pipeline/outputs.h"

namespace selvage::pipeline {

struct PlannedInput {
  Input input;
  std::vector<PlannedOutput> outputs;
};

class BatchPlan {
 public:
  // As many of both.
  BatchPlan(const std::vector<Input>& inputs, const std::vector<std::vector<PlannedOutput>>& outputs);

  [[nodiscard]] std::size_t size() const { return records_.size(); }
  // Made anew by each call.
  [[nodiscard]] PlannedInput at(std::size_t index) const;
  // Input::path of it.
  [[nodiscard]] std::string_view path(std::size_t index) const;
  // Input::name() of it.
  [[nodiscard]] std::string name(std::size_t index) const;

 private:
  SharedText text_;
  std::vector<const formats::Descriptor*> formats_;
  std::vector<std::string_view> records_;  // fields that end in a zero byte, which no path has
};

}  // namespace selvage::pipeline
