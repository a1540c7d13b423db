#include "fuzz/expression_text.h"

#include <fmt/format.h>

#include <array>
#include <cmath>

namespace selvage::fuzz {

namespace {

class Reckoner {
 public:
  explicit Reckoner(std::string_view bytes) : bytes_(bytes) {}

  ExpressionText text() {
    constexpr std::array<std::pair<const char*, double>, 5> units = {
        {{"mm", 1}, {"cm", 10}, {"m", 1000}, {"um", 0.001}, {"inch", 25.4}}};
    const auto& [unit, size] = units[choice(units.size())];
    unit_ = size;
    ExpressionText made;
    made.text = fmt::format("fabric 1\nunits {}\n", unit);
    for (const char* name : {"a", "width_2", "Chest"}) {
      const Value value = number(choice(3) + 0U);
      params_.push_back({name, value.value});
      made.text += fmt::format("param {} {}\n", name, value.text);
    }
    made.text += "thread t\ndiameter 1\nend\nyarn y t\npath control\n20000 0 0\n";  // rows may be equal
    for (int row = 0; row < 2; ++row) {
      for (int k = 0; k < 3; ++k) {
        const Value value = number(4);
        made.numbers.push_back(value.value);
        made.text += value.text + (k < 2 ? "  " : "\n");
      }
    }
    made.text += "end\nend\n";
    return made;
  }

 private:
  struct Value {
    std::string text;
    double value = 0;
  };
  std::size_t choice(std::size_t count) {
    if (bytes_.empty()) return 0;
    const auto byte = static_cast<unsigned char>(bytes_.front());
    bytes_.remove_prefix(1);
    return byte % count;
  }
  // Of at most so many levels of brackets.
  Value number(std::size_t deep) {
    const Value value = raw_number(deep);
    const double size = std::abs(value.value);
    return value.value == 0 || (size < 1e4 && size > 1e-2) ? value : Value{"1", 1};
  }
  Value raw_number(std::size_t deep) {
    const std::size_t kind = choice(deep > 0 ? 10 : 3);
    switch (kind) {
      case 0: {
        const double value = static_cast<double>(choice(200)) / 8;
        return {fmt::format("{}", value), value};
      }
      case 1: {
        constexpr std::array<std::pair<const char*, double>, 6> lengths = {
            {{"mm", 1}, {"cm", 10}, {"dm", 100}, {"m", 1000}, {"um", 0.001}, {"in", 25.4}}};
        const double value = static_cast<double>(1 + choice(200)) / 4;
        const auto& [unit, size] = lengths[choice(lengths.size())];
        return {fmt::format("{}{}", value, unit), value * size / unit_};
      }
      case 2: {
        if (params_.empty()) return {"2", 2};
        const auto& [name, value] = params_[choice(params_.size())];
        return {name, value};
      }
      case 3: {
        const Value of = number(deep - 1);
        return {fmt::format("sqrt(abs({}))", of.text), std::sqrt(std::abs(of.value))};
      }
      case 4: {
        const Value one = number(deep - 1), other = number(deep - 1);
        return {fmt::format("max({}, {})", one.text, other.text), std::max(one.value, other.value)};
      }
      case 5: {
        const Value of = number(deep - 1);
        return {fmt::format("(-({}))", of.text), -of.value};
      }
      default:
        break;
    }
    const Value one = number(deep - 1), other = number(deep - 1);
    const auto with = [&](char sign, double value) {
      return Value{fmt::format("(({}) {} ({}))", one.text, sign, other.text), value};
    };
    if (kind == 6) return with('+', one.value + other.value);
    if (kind == 7) return with('-', one.value - other.value);
    if (kind == 8 || other.value == 0) return with('*', one.value * other.value);
    return with('/', one.value / other.value);
  }

  std::string_view bytes_;
  double unit_ = 1;  // of the file, millimetres
  std::vector<std::pair<std::string, double>> params_;
};

}  // namespace

ExpressionText expression_text(std::string_view bytes) {
  return Reckoner(bytes).text();
}

}  // namespace selvage::fuzz
