// What decks call the parts of a mesh: the yarns' own names as far as a solver takes them, each only once.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "core/text_buffer.h"
#include "fem/mesh.h"

namespace selvage::fem {

// The first region's surface, the second one's that faces it, its nodes that are tied, the elements between.
inline constexpr std::array<std::string_view, 4> interface_endings = {"_Side", "_Facing", "_Tied",
                                                                      "_Cohesive"};

// Which names a solver takes. Upper and lower case are the same to all of them.
struct NameRule {
  std::size_t longest = 0;  // bytes
  // False: letters, digits, underscores and characters of `also` after a letter. True: whatever can be seen,
  // in UTF-8, that neither begins nor ends with a blank, but for characters of `unfit`.
  bool is_text = false;
  std::string_view also{}, unfit{};
  std::string_view begin = "Y_";            // put before what has to begin with a letter, and does not
  std::vector<std::string_view> taken{};    // words that mean something else
  std::vector<std::string_view> endings{};  // that are put behind names: they are unique with these, too
};

// One for each, in their order: the same every time. Those that the rule allows stay as they are, however the
// others are spelt. Of others what does not fit becomes an underscore, of what is too long the middle is left
// out ("__" stands for it), and a number tells equal ones apart. Precondition: `longest` is more than the
// longest of `endings` by 16 at least.
std::vector<std::string> unique_names(const std::vector<std::string>& own, const NameRule& rule);

// The names of a mesh's regions in a deck, and what follows from them. The rule's `endings` need not say
// _Start, _End, _Section1, .., nor those of interfaces; the other names of decks (All, Matrix, FaceA,
// drivers, ..) are never a yarn's.
class DeckNames {
 public:
  DeckNames(const Mesh& mesh, NameRule rule);
  // The yarn's, or "Matrix".
  [[nodiscard]] const std::string& of(std::size_t region) const { return names_[region]; }
  // NAME_Section1, ..: of those parts of a region that have one material. `number` counts from 0.
  [[nodiscard]] std::string of_section(std::size_t region, std::size_t number) const;
  // Of what belongs to an interface, by its first region and `ending` (one of interface_endings): NAME_Side
  // .. where the second region is the matrix, NAME_Side1 .. where it is a yarn, counted over the first
  // region's.
  [[nodiscard]] std::string of_interface(const Mesh& mesh, std::size_t interface,
                                         std::string_view ending) const;

 private:
  std::vector<std::string> names_;
};

// "NAME is yarn 'OWN'", in the order of the yarns, of each whose name is not its own one: as comments, which
// begin with `mark`. What is longer than `width` columns takes several lines, "NAME is yarn" and then the
// parts of its name, each in quotes.
void write_yarn_names(TextBuffer& text, const Mesh& mesh, const DeckNames& names, std::string_view mark,
                      std::size_t width);

}  // namespace selvage::fem
