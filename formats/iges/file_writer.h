// One IGES file while it is written.
#pragma once

#include <array>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "formats/format.h"
#include "formats/iges/entities.h"
#include "formats/iges/header.h"
#include "formats/iges/part.h"
#include "formats/iges/records.h"

namespace selvage::formats::iges {

// Every add either writes the whole thing or, where it fails before the output does, nothing of it: finish()
// then still gives a whole file with what came before. Errors: geometry (a number that is not finite; a solid
// of a yarn whose ends are open), limit (more lines in a section than the limits allow), io.
class FileWriter final : public BodyWriter, private ColorSource {
 public:
  // A yarn, or a copy of one.
  struct Item {
    yarn::Body body;
    std::optional<Instance> instance{};

    [[nodiscard]] const Instance* shape() const { return instance ? &*instance : nullptr; }
  };

  FileWriter(OutputFile& output, const SurfaceOptions& options, Records::Limits limits);

  Status add(const yarn::Body& body) override { return add(body, nullptr); }
  Status add_instance(const yarn::Body& body, const Instance& instance) override {
    return add(body, &instance);
  }
  // The plies or filaments of a yarn, one after the other, and the group that has the yarn's name.
  Status add_group(std::span<const Item> parts);
  Status add_piece(const fabric::PieceShape& piece) override;
  Status add_part(const cad::Part& part) override;
  Status add_curve(const cad::NamedCurve& curve) override;
  Result<WriteFacts> finish() override;

  // The lines of the longer section of a file that holds nothing but this yarn.
  std::int64_t lines_of(const yarn::Body& body);
  [[nodiscard]] std::uint64_t bodies() const { return bodies_; }  // that are in the file
  [[nodiscard]] bool is_empty() const { return bodies_ == 0; }
  // After finish(): what the file begins with, and a number that is another one for another content.
  [[nodiscard]] const Header& header() const { return header_; }
  [[nodiscard]] std::uint64_t digest() const { return extremes_.digest; }

 private:
  struct Shared {
    std::vector<std::pair<yarn::Color, int>> colors;        // and their 314
    std::array<bool, yarn::all_roles.size() + 1> levels{};  // by role, and that of pieces
    std::map<std::size_t, int> definitions;                 // of shapes that have copies: their 308

    [[nodiscard]] std::uint64_t entities() const;  // of colours and levels
  };

  // What fails leaves no trace, and says of which yarn (none: empty) and place it is, where it does not.
  Status whole_or_nothing(const std::string& yarn, TextPlace place, const std::function<Status()>& work);
  Status check(const yarn::Body& body);
  // `values`: an upper bound of the lines that `write` writes; `what`: "yarn warp1".
  Status check_room(std::int64_t values, const std::string& what, const std::function<void()>& write);
  struct Needed {
    Records::Lines lines;
    std::uint64_t shared = 0;  // entities
  };
  Needed measured(const std::function<void()>& write, Records::Measuring how = Records::Measuring::lines);
  // How many entities the file will have, by what `bodies` have, `shared` among them.
  void expect(std::uint64_t entities, std::uint64_t shared, std::uint64_t bodies);
  void expect_as_first(std::int64_t values, const std::function<void()>& write, std::uint64_t bodies);
  Status add_checked(const std::string& name, const std::string& what, std::int64_t values,
                     const std::function<void()>& write, std::uint64_t bodies = 1);
  // Of a yarn or, where there is an `instance`, a copy of one.
  Status add(const yarn::Body& body, const Instance* instance);
  Status check(const yarn::Body& body, const Instance* instance);
  [[nodiscard]] std::int64_t most_values_of(const yarn::Body& body, const Instance* instance) const;
  int write(const yarn::Body& body, const Instance* instance = nullptr);

  int definition_of(const Instance& instance);
  // What `write` writes and, behind its `entities`, its name.
  int named(Common common, int entities, const std::function<int(const Common&)>& write);
  void warn_of_name(const std::string& name, const std::string& what);
  std::vector<int> write_faces(const Common& common, const yarn::Body& body);
  Common common_of(const yarn::Body& body, std::string_view label);
  int color(const yarn::Color& color);
  int pointer(const std::optional<cad::Color>& of) override { return of ? color(*of) : 0; }
  void take_size(const std::vector<Vec3>& points);
  Status close_group();
  int level(std::size_t index, std::string_view name);

  OutputFile* output_;
  SurfaceOptions options_;
  bool is_solid_;
  Header header_;
  Records records_;
  Shared shared_;
  // The group whose parts come at present, and theirs so far.
  std::string group_;
  std::vector<int> members_;
  std::uint64_t bodies_ = 0, expected_ = 0;  // that are in the file; that will be, as far as one can tell
  // Of all that was written.
  struct Extremes {
    double largest = 0;
    double smallest_size = std::numeric_limits<double>::infinity();
    std::uint64_t digest = 0xCBF29CE484222325;  // of control points
  } extremes_;
  std::vector<Message> messages_;
  bool renamed_ = false;
};

}  // namespace selvage::formats::iges
