// What `--set`, `--table` and `--lhs` ask for: values of an input's params, one set a variant.
#pragma once

#include <vector>

#include "core/diagnostics.h"
#include "fabric/model.h"
#include "pipeline/options.h"

namespace selvage::pipeline {

using Variants = std::vector<std::vector<fabric::Setting>>;

// Without a sweep one variant, often without a setting. Of a sweep the rows of the table, each with all
// combinations of the values that `--set` gives (the last one changes fastest), or so many samples of a Latin
// hypercube: each range LOW:HIGH is divided into as many parts as there are samples, and each part has one of
// them (McKay, Beckman, Conover 1979, Technometrics 21). The same for the same words on every machine.
// Errors (usage): words that are none of that, a table that cannot be read or has rows of other lengths, more
// variants than most_variants.
Result<Variants> variants_of(const Options& options);

inline constexpr std::size_t most_variants = 1'000'000;  // of all inputs together
// Error (usage): more.
Status check_number(double count);

}  // namespace selvage::pipeline
