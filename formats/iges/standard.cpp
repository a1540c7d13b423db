#include "formats/iges/standard.h"

#include <algorithm>
#include <array>
#include <iterator>

#include "formats/iges/real_text.h"

namespace selvage::formats::iges {

namespace {

constexpr StandardType types[] = {
    {0, "null", {}, {}},
    {100, "circular arc", {0, 0}, "7"},
    {102, "composite curve", {0, 0}, "#(c)"},
    {104, "conic arc", {0, 3}, "11"},
    {106, "copious data", {}, "@"},
    {108, "plane", {-1, 1}, "4C4"},
    {110, "line", {0, 2}, "6"},
    {112, "parametric spline curve", {0, 0}, "3#13(13)"},
    {114, "parametric spline surface", {0, 0}, "@"},
    {116, "point", {0, 0}, "4"},
    {118, "ruled surface", {0, 1}, "cc2"},
    {120, "surface of revolution", {0, 0}, "lc2"},
    {122, "tabulated cylinder", {0, 0}, "c3"},
    {123, "direction", {0, 0}, "3"},
    {124, "transformation matrix", {0, 12}, "12"},
    {125, "flash", {}, {}},
    {126, "rational B-spline curve", {0, 5}, "@"},
    {128, "rational B-spline surface", {0, 9}, "@"},
    {130, "offset curve", {0, 0}, "c13"},
    {132, "connect point", {}, {}},
    {134, "node", {}, {}},
    {136, "finite element", {}, {}},
    {138, "nodal displacement and rotation", {}, {}},
    {140, "offset surface", {0, 0}, "4s"},
    {141, "boundary", {0, 0}, "2s#(c1#(c))"},
    {142, "curve on a parametric surface", {0, 0}, "1scc1"},
    {143, "bounded surface", {0, 0}, "1s#(b)"},
    {144, "trimmed parametric surface", {0, 0}, "s1#t(t)"},
    {146, "nodal results", {}, {}},
    {148, "element results", {}, {}},
    {150, "block", {}, {}},
    {152, "right angular wedge", {}, {}},
    {154, "right circular cylinder", {}, {}},
    {156, "right circular cone frustum", {}, {}},
    {158, "sphere", {}, {}},
    {160, "torus", {}, {}},
    {162, "solid of revolution", {}, {}},
    {164, "solid of linear extrusion", {}, {}},
    {168, "ellipsoid", {}, {}},
    {180, "Boolean tree", {}, {}},
    {182, "selected component", {}, {}},
    {184, "solid assembly", {}, {}},
    {186, "manifold solid B-rep object", {0, 0}, "h1#(h1)"},
    {190, "plane surface", {0, 1}, "pd:d"},
    {192, "right circular cylindrical surface", {0, 1}, "pd1:d"},
    {194, "right circular conical surface", {0, 1}, "pd2:d"},
    {196, "spherical surface", {0, 1}, "p1:dd"},
    {198, "toroidal surface", {0, 1}, "pd2:d"},
    {202, "angular dimension", {}, {}},
    {204, "curve dimension", {}, {}},
    {206, "diameter dimension", {}, {}},
    {208, "flag note", {}, {}},
    {210, "general label", {}, {}},
    {212, "general note", {}, {}},
    {213, "new general note", {}, {}},
    {214, "leader arrow", {}, {}},
    {216, "linear dimension", {}, {}},
    {218, "ordinate dimension", {}, {}},
    {220, "point dimension", {}, {}},
    {222, "radius dimension", {}, {}},
    {228, "general symbol", {}, {}},
    {230, "sectioned area", {}, {}},
    {302, "associativity definition", {}, {}},
    {304, "line font definition", {}, {}},
    {306, "macro definition", {}, {}},
    {308, "subfigure definition", {0, 0}, "2#(*)"},
    {310, "text font definition", {}, {}},
    {312, "text display template", {}, {}},
    {314, "colour definition", {0, 0}, "@"},
    {316, "units data", {}, {}},
    {320, "network subfigure definition", {}, {}},
    {322, "attribute table definition", {}, {}},
    {402, "associativity instance", {}, "#(*)"},
    {404, "drawing", {}, {}},
    {406, "property", {}, "#(1)"},
    {408, "singular subfigure instance", {0, 0}, "D4"},
    {410, "view", {}, {}},
    {412, "rectangular array subfigure instance", {0, 0}, "*9#1(1)"},
    {414, "circular array subfigure instance", {0, 0}, "*7#1(1)"},
    {416, "external reference", {}, {}},
    {418, "nodal load/constraint", {}, {}},
    {420, "network subfigure instance", {}, {}},
    {422, "attribute table instance", {}, {}},
    {430, "solid instance", {}, {}},
    {502, "vertex list", {1, 1}, "#(3)"},
    {504, "edge list", {1, 1}, "#(cv1v1)"},
    {508, "loop", {0, 1}, "#(1e2#(1c))"},
    {510, "face", {1, 1}, "s#1(o)"},
    {514, "shell", {1, 2}, "#(f1)"},
};

struct Target {
  char letter;
  std::array<int, 12> types;  // the rest 0
};
constexpr Target targets[] = {{'c', {100, 102, 104, 106, 110, 112, 126, 130}},
                              {'C', {100, 102, 104, 106, 110, 112, 126, 130, 142}},
                              {'s', {108, 114, 118, 120, 122, 128, 140, 190, 192, 194, 196, 198}},
                              {'p', {116}},
                              {'d', {123}},
                              {'l', {110}},
                              {'t', {142}},
                              {'b', {141}},
                              {'v', {502}},
                              {'e', {502, 504}},
                              {'o', {508}},
                              {'f', {510}},
                              {'h', {514}},
                              {'D', {308}}};

// A cursor over the values along the fields of the table.
class Walk {
 public:
  Walk(const DirectoryEntry& entry, const Values& values, std::size_t first)
      : entry_(entry), values_(values), at_(first) {}

  References run(std::string_view fields) {
    walk(fields);
    if (!broken_) found_.own = at_;
    return std::move(found_);
  }

 private:
  void walk(std::string_view fields) {
    std::size_t times = 0;
    while (!fields.empty()) {
      const char field = fields[0];
      std::size_t length = 1;
      if (is_digit(field)) {
        std::size_t number = 0;
        for (length = 0; length < fields.size() && is_digit(fields[length]); ++length)
          number = 10 * number + static_cast<std::size_t>(fields[length] - '0');
        at_ += number;
      } else if (field == '#') {
        times = count();
      } else if (field == '(') {
        length = group_length(fields);
        for (; times > 0; --times) walk(fields.substr(1, length - 2));
      } else if (field == ':') {
        if (entry_.form != 1) return;
      } else if (field == '@') {
        take_own();
      } else {
        if (const int pointer = integer(); pointer != 0) found_.all.push_back({pointer, at_ - 1, field});
      }
      fields.remove_prefix(length);
    }
  }

  // With both brackets.
  static std::size_t group_length(std::string_view fields) {
    int depth = 0;
    std::size_t at = 0;
    do depth += fields[at] == '(' ? 1 : fields[at] == ')' ? -1 : 0;
    while (++at < fields.size() && depth > 0);
    return at;
  }

  void take_own() {
    switch (entry_.type) {
      case 106: {
        const int kind = integer();
        const std::size_t points = count();
        at_ += (kind == 1 ? 1U : 0U) + points * (kind == 1 ? 2U : kind == 2 ? 3U : 6U);
        break;
      }
      case 114: {
        at_ += 2;
        const std::size_t m = count(), n = count();
        at_ += m + n + 2 + 48 * (m + 1) * (n + 1);
        break;
      }
      case 126: {
        const std::size_t k = count(), m = count();
        at_ += 4 + k + m + 2 + 4 * (k + 1) + 5;
        break;
      }
      case 128: {
        const std::size_t k = count(), l = count(), m = count(), n = count();
        at_ += 5 + k + m + 2 + l + n + 2 + 4 * (k + 1) * (l + 1) + 4;
        break;
      }
      default:  // 314, with a name or without
        at_ += values_.size() > 4 && values_[4].is_string ? 4 : 3;
    }
  }

  int integer() { return values_.integer(at_++).value_or(0); }
  // No more than there are values.
  std::size_t count() {
    const int stated = integer(), room = static_cast<int>(values_.size()) + 1;
    if (stated < 0 || stated > room) broken_ = true;
    return static_cast<std::size_t>(std::clamp(stated, 0, room));
  }

  const DirectoryEntry& entry_;
  const Values& values_;
  std::size_t at_;
  bool broken_ = false;
  References found_;
};

}  // namespace

const StandardType* standard_type(int number) {
  const auto* const found = std::lower_bound(std::begin(types), std::end(types), number,
                                             [](const StandardType& a, int b) { return a.number < b; });
  return found != std::end(types) && found->number == number ? found : nullptr;
}

std::string_view entity_title(int type) {
  const StandardType* const found = standard_type(type);
  return found != nullptr ? found->title : std::string_view{};
}

bool is_group(int form) {
  return form == 1 || form == 7 || form == 14 || form == 15;
}

References references_of(const DirectoryEntry& entry, const Values& values, std::size_t first) {
  const StandardType* const type = standard_type(entry.type);
  // Of the associativities only groups are listed.
  if (type == nullptr || type->fields.empty() || (entry.type == 402 && !is_group(entry.form))) return {};
  return Walk(entry, values, first).run(type->fields);
}

bool may_point(char to, int type) {
  const auto* const found = std::find_if(std::begin(targets), std::end(targets),
                                         [to](const Target& target) { return target.letter == to; });
  return found == std::end(targets) ||
         std::find(found->types.begin(), found->types.end(), type) != found->types.end();
}

}  // namespace selvage::formats::iges
