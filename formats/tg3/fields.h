// Attributes of the elements of a tg3 file as values. What is wrong goes to the report, at the element.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "core/source.h"
#include "core/text_report.h"
#include "core/vec.h"
#include "formats/tg3/xml.h"

namespace selvage::formats::tg3 {

class Fields {
 public:
  Fields(const Source& source, TextReport& report) : source_(source), report_(report) {}

  void error(const Element& element, std::string text, Kind kind = Kind::malformed) const {
    if (!is_full()) report_.error(spot_at(source_, element.place), std::move(text), kind);
  }
  void error(const Message& message, TextPlace otherwise) const;
  void warning(TextPlace place, std::string text) const {
    report_.warning(spot_at(source_, place), std::move(text));
  }
  void warning(const Element& element, std::string text) const { warning(element.place, std::move(text)); }
  void note(const Element& element, std::string text) const {
    report_.note(spot_at(source_, element.place), std::move(text));
  }
  [[nodiscard]] int errors() const { return report_.errors(); }
  [[nodiscard]] bool is_full() const { return report_.is_full(); }
  void set_yarn(std::string_view name) const { report_.set_yarn(name); }

  // The value `otherwise` where the element has no such attribute; without one it is needed.
  [[nodiscard]] double number(const Element& element, std::string_view name,
                              std::optional<double> otherwise = std::nullopt) const;
  [[nodiscard]] double positive(const Element& element, std::string_view name) const;
  // A whole number from `least` to `most`.
  [[nodiscard]] int whole(const Element& element, std::string_view name, int least, int most,
                          std::optional<int> otherwise = std::nullopt) const;
  [[nodiscard]] bool flag(const Element& element, std::string_view name, bool otherwise) const;
  // Numbers between commas.
  [[nodiscard]] Vec2 pair(const Element& element, std::string_view name) const;
  [[nodiscard]] Vec3 vector(const Element& element, std::string_view name,
                            const std::optional<Vec3>& otherwise = std::nullopt) const;
  // Empty: there is none.
  [[nodiscard]] std::string_view text(const Element& element, std::string_view name) const;

 private:
  [[nodiscard]] std::vector<double> numbers(const Element& element, std::string_view name,
                                            std::size_t count) const;

  const Source& source_;
  TextReport& report_;
};

}  // namespace selvage::formats::tg3
