// The directory and parameter sections of an IGES file while they grow: 80-column lines with running numbers,
// filled in place in one reused buffer. The standard wants the whole directory before the first parameter
// line although a directory entry is known only after its parameters: so room for the directory is set aside
// in the file, and only where that room turns out wrong are the parameters moved, once, in finish(). Memory
// does not grow with the file.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "core/diagnostics.h"
#include "core/output.h"
#include "core/pointed_number.h"
#include "nurbs/spline.h"

namespace selvage::formats::iges {

inline constexpr std::size_t line_length = 81;         // 80 columns and the newline
inline constexpr std::size_t data_columns = 64;        // of a parameter line
inline constexpr std::int64_t most_lines = 9'999'999;  // in one section: the number has seven columns

// The status field: blank, subordinate, use, hierarchy; two digits each.
inline constexpr std::string_view independent = "00000000";
inline constexpr std::string_view dependent = "00010000";  // physically: exists only inside its parent
inline constexpr std::string_view dependent_in_2d =
    "00010500";  // the same, a curve in a surface's parameters
inline constexpr std::string_view definition = "00000200";

// What the directory says of an entity.
struct Entity {
  int type = 0;
  int form = 0;
  std::string_view status = independent;
  int color = 0;  // directory pointer of a 314; 0: none
  int level = 0;
  std::string_view label;  // ASCII; its first 8 characters are kept
  int matrix = 0;          // directory pointer of a 124; 0: none
};

class Records {
 public:
  struct Limits {
    std::int64_t lines = most_lines;    // a section; tests lower it
    std::size_t buffer_lines = 13'000;  // of parameters kept before they are written: 1 MiB
    std::size_t directory_lines = 3'200;
  };

  // The directory begins at byte `offset` of `output`, which outlives this. Long lists of numbers are
  // formatted by `threads`.
  Records(OutputFile& output, std::uint64_t offset, Limits limits, int threads = 1);

  // One entity: begin(), its values in order, end(). begin() returns its directory pointer, which is what
  // next() said.
  [[nodiscard]] int next() const { return static_cast<int>(2 * entities_ + 1); }
  int begin(const Entity& entity);
  void integer(std::int64_t value);
  void real(double value) { reals(&value, 1); }
  void reals(const double* values, std::size_t count);
  void reals(const std::vector<double>& values) { reals(values.data(), values.size()); }
  void points(const std::vector<Vec3>& points) { reals(points.data()->data(), 3 * points.size()); }
  void ones(std::size_t count);            // 1. so many times
  void list(std::span<const int> values);  // how many there are, then they themselves
  void text(std::string_view ascii);
  // `property`: directory pointer of a property of this entity; 0: none.
  void end(int property = 0);

  // Between measure(how) and measure(Measuring::off) everything is counted and nothing is kept; where only
  // entities are, reals are passed over, and lines of parameters mean nothing. Only between entities.
  // measure(Measuring::off) returns the lines that both sections would have after it.
  enum class Measuring { off, entities, lines };
  struct Lines {
    std::int64_t directory = 0, parameters = 0;
  };
  Lines measure(Measuring how);
  [[nodiscard]] Lines lines() const { return {2 * entities_, lines_}; }
  [[nodiscard]] const std::map<int, std::uint64_t>& counts() const {
    return counts_;
  }  // of entities, by type
  [[nodiscard]] const Limits& limits() const { return limits_; }

  // How many entities the file will have, as far as one can tell; asked once, when the first full buffer has
  // to go to its place. A wrong answer costs only time.
  void expect(std::uint64_t entities) { expected_entities_ = entities; }

  // The first failure of the output, kept until asked for.
  [[nodiscard]] Status status() const { return status_; }

  // Puts everything into its final place; returns the offset of the first byte after the parameters.
  Result<std::uint64_t> finish();

 private:
  struct Extent {
    std::uint64_t offset = 0, size = 0;
  };

  // Texts of numbers, each with its comma.
  struct Tokens {
    std::vector<char> text;
    std::vector<std::uint8_t> lengths;
    void format(const double* values, std::size_t count);
  };
  void put(const Tokens& tokens);
  void reals_by_threads(const double* values, std::size_t count);

  char* next_line(char* token, const char* token_end);
  void close_line(char* at);
  void number_line();
  void flush_parameters();
  void flush_directory();
  void place_parameters();
  void append(std::vector<Extent>& extents, std::string_view bytes);
  void write(std::uint64_t offset, std::string_view bytes);
  void move(Extent from, std::uint64_t to);
  void file_entity(std::int64_t first_line, std::int64_t line_count);

  OutputFile* output_;
  Limits limits_;
  int threads_;
  std::vector<Tokens> tokens_;  // reused
  Status status_;
  Measuring measuring_ = Measuring::off;
  Lines before_measuring_;

  std::unique_ptr<char[]> buffer_;  // whole lines, then room for one number; not touched before it is needed
  char* line_ = nullptr;            // the present line in it
  char* cursor_ = nullptr;          // where the next value goes
  char tail_[17];                   // columns 65-80 and the newline of the present line
  std::int64_t lines_ = 0;          // finished parameter lines
  std::unique_ptr<char[]> directory_;
  std::size_t directory_used_ = 0;
  std::int64_t entities_ = 0;
  std::map<int, std::uint64_t> counts_;
  Entity entity_;
  std::int64_t entity_line_ = 0;

  std::uint64_t offset_;
  std::uint64_t expected_entities_ = 0;
  bool placed_ = false;
  std::uint64_t room_ = 0;  // bytes set aside for the directory
  std::uint64_t file_end_ = 0;
  std::vector<Extent> directory_extents_, parameter_extents_;  // in order; neighbours are joined
};

}  // namespace selvage::formats::iges
