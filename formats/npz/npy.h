// The heads of NumPy's arrays (NEP 1, version 1.0 of the format).
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace selvage::formats::npz {

// What stands before the data of an array; `type` as NumPy spells it ("<f4"), the last dimension the fastest.
std::string npy_head(std::string_view type, const std::vector<std::size_t>& dimensions);

// Texts in UTF-8 as an array of one dimension: all as long as the longest one, in UTF-32.
struct TextArray {
  std::string type, data;
};
TextArray text_array(std::span<const std::string> texts);

}  // namespace selvage::formats::npz
