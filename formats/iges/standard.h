// The entity types of IGES 5.3, sections 4 and 5, each declared once: its name, its forms, what its
// parameters hold and point to.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "formats/iges/file.h"

namespace selvage::formats::iges {

struct StandardType {
  int number = 0;
  std::string_view title;  // "rational B-spline surface"
  struct Forms {
    int first = 1, last = 0;  // first > last: not listed

    [[nodiscard]] bool allow(int form) const { return first > last || (form >= first && form <= last); }
  } forms;
  // The entity's own parameters in order; empty: not listed.
  //   12          so many values
  //   a letter    a pointer, to: c curve, C closed curve or 142, s surface, p 116, d 123, l 110,
  //               t 142, b 141, v 502, e 502 or 504, o 508, f 510, h 514, D 308, * anything
  //   #  ( )      a count; what stands so often
  //   :           the rest only in form 1
  //   @           values by a rule of its own
  std::string_view fields;
};

// Null for a type that the standard does not have.
const StandardType* standard_type(int number);
std::string_view entity_title(int type);  // empty for such a type
// Is a 402 of this form a group? 1: with back pointers, 7: without, 14 and 15: the same, ordered.
bool is_group(int form);

// What an entity's own values point to, by the table above.
struct References {
  struct Reference {
    int pointer = 0;        // as it stands there; not 0
    std::size_t value = 0;  // index among the values
    char to = '*';
  };
  std::vector<Reference> all;
  // How many values are the entity's own, its type among them; nothing: not known.
  std::optional<std::size_t> own;
};
// `values` from the type on, or with `first` the index of the one behind it.
References references_of(const DirectoryEntry& entry, const Values& values, std::size_t first = 1);
// Is an entity of `type` what such a pointer is for?
bool may_point(char to, int type);

}  // namespace selvage::formats::iges
