#include "fuzz/fabric_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <initializer_list>

namespace selvage::fuzz {

namespace {

class Writer {
 public:
  explicit Writer(std::string_view bytes) : bytes_(bytes) {}

  std::string text() {
    line("fabric 1");
    line("units {}", one_of({"mm", "cm", "um", "inch", "m"}));
    if (choice(3) == 1) line("tolerance {}", number(0.0005, 0.02));
    line("material epoxy\n density 1.2\n elastic isotropic {} {}\nend", number(100, 5000),
         number(-0.3, 0.45));
    for (const char* name : {"a", "b"}) thread(name);
    // Few braids: to fit their amplitude takes most of an execution.
    const int kind = choice(16);
    if (kind < 3)
      weave();
    else if (kind < 7)
      knit();
    else if (kind < 11)
      warpknit();
    else if (kind < 12)
      braid();
    else
      yarns();
    if (choice(2) == 1) cell();
    return text_;
  }

  std::string placed_text() {
    line("fabric 1");
    if (choice(3) == 1) line("tolerance {}", number(0.0005, 0.02));
    line("material epoxy\n density 1.2\nend");
    for (const char* name : {"a", "b"}) thread(name);
    const int blocks = 1 + choice(3);
    for (int i = 0; i < blocks; ++i) {
      line("block b{}", i);
      const int kind = choice(4);
      if (kind == 1)
        weave();
      else if (kind == 2 && i > 0)
        use(choice(i));
      else
        line("yarn y {}\n path\n  0 0 0\n  {} {} {}\n end\nend", one_of({"a", "b"}), number(1, 9),
             number(0, 3), number(-1, 1));
      line("end");
    }
    for (int i = 1 + choice(2); i > 0; --i) use(choice(blocks));
    if (choice(3) == 1)
      line("cell repeat {} x {}\n{} matrix epoxy\nend", 1 + choice(2), 1 + choice(2),
           choice(2) == 1 ? fmt::format(" margin {}\n", number(0.01, 1)) : "");
    return text_;
  }

 private:
  template <class... Values>
  void line(fmt::format_string<Values...> format, Values&&... values) {
    text_ += fmt::format(format, std::forward<Values>(values)...) + "\n";
  }
  // 0 .. count - 1
  int choice(int count) {
    if (bytes_.empty()) return 0;
    const int byte = static_cast<unsigned char>(bytes_.front());
    bytes_.remove_prefix(1);
    return byte % count;
  }
  std::string one_of(std::initializer_list<const char*> words) {
    return words.begin()[choice(static_cast<int>(words.size()))];
  }
  // One of 256 between both ends.
  double number(double low, double high) { return low + (high - low) * choice(256) / 255.0; }

  // A length in widths of the widest section, so that most fabrics have room for their yarns.
  double widths(double low, double high) { return width_ * number(low, high); }

  std::string section() {
    const double width = number(0.1, 1.5), height = width * number(0.1, 1.2);
    width_ = std::max({width_, width, height});
    switch (choice(5)) {
      case 0:
        return fmt::format("circle {}", height);
      case 1:
        return fmt::format("ellipse {} {}", width, height);
      case 2:
        return fmt::format("lenticular {} {}", width, height);
      case 3:
        return fmt::format("racetrack {} {}", width, std::min(height, width));
      default:
        return fmt::format("power {} {} {}", width, height, number(0.2, 3));
    }
  }
  void thread(std::string_view name) {
    line("thread {}\n section {}\n material epoxy", name, section());
    if (choice(4) == 1) line(" twist {} {}{}", number(0, 400), one_of({"Z", "S"}), one_of({"", " rotate"}));
    if (choice(6) == 1) line(" plies {} {} {}", 2 + choice(2), number(0, 300), one_of({"Z", "S"}));
    if (choice(8) == 1) line(" filaments {}", 2 + choice(3));
    line("end");
  }
  std::string threads() { return one_of({"a", "b", "a,b", "b,a,a"}); }

  void weave() {
    line("weave\n warp {} {} pitch {}", threads(), 1 + choice(4), widths(0.6, 4));
    line(" weft {} {} pitch {}", threads(), 1 + choice(4), widths(0.6, 4));
    if (choice(4) == 1) {
      line(" profile straight\n layers {}", 1 + choice(2));
      line(" binder {} every {} levels {} {}", one_of({"a", "b"}), 1 + choice(2), choice(3), choice(3));
      line("end");
      return;
    }
    if (choice(6) == 1) {
      line(" layers 2\n levels {} {} , b {} 2", choice(2), choice(2), 1 + choice(2));
      line(" levels {} {}", choice(3), choice(3));
      line("end");
      return;
    }
    if (choice(6) == 1) {
      line(" draft plain\n pile {} {} every {} {} {}", widths(0.5, 6), one_of({"a", "b", ""}), 3 + choice(3),
           one_of({"face", "back", "both"}), one_of({"", "cut"}));
      line("end");
      return;
    }
    if (choice(8) == 1) {
      line(" draft {} {}", one_of({"corduroy", "velveteen"}), 4 + 2 * choice(3));
      line("end");
      return;
    }
    if (choice(3) == 1) {
      const int width = 1 + choice(4);
      line(" draft");
      for (int row = 1 + choice(4); row > 0; --row) {
        std::string signs;
        for (int i = 0; i < width; ++i) signs += choice(2) == 1 ? '1' : '0';
        line("  {}", signs);
      }
      line(" end");
    } else {
      line(" draft {}", one_of({"plain", "twill 2/1", "twill 1/3", "satin 5/2", "basket 2/2"}));
    }
    const int profile = choice(6);
    if (profile == 5) line(" profile sine {}", number(0.01, 1));
    if (profile > 0 && profile < 5)
      line(" profile {}", one_of({"peirce", "sine", "lenticular", "racetrack"}));
    if (choice(3) == 1) line(" crimp {}", number(0, 1));
    if (choice(4) == 1) line(" layers 2");
    if (choice(4) == 1) line(" spacing {}", one_of({"even", "relaxed"}));
    if (choice(4) == 1 && profile == 0) line(" thickness {}", number(0.01, 2));
    if (choice(8) == 1 && profile == 0) line(" {} {}", one_of({"fraction", "compact"}), number(0.1, 1));
    if (choice(4) == 1 && profile == 0) line(" state {}", one_of({"loom", "relaxed", "finished"}));
    line("end");
  }
  void knit() {
    const int form = choice(6);
    const bool has_pitches = choice(3) == 1;
    line("knit {}\n thread {}\n courses {}{}\n wales {}{}",
         form == 0   ? "jersey"
         : form == 1 ? "purl"
         : form == 2 ? fmt::format("rib {}x{}", 1 + choice(2), 1 + choice(2))
         : form == 4 ? one_of({"interlock", "full-cardigan", "half-cardigan", "milano", "half-milano"})
         : form == 5 ? "jacquard"
                     : "",
         form == 5 ? "a,b" : one_of({"a", "b", "a,b"}), 1 + choice(3),
         has_pitches ? fmt::format(" pitch {}", widths(1, 5)) : "", 1 + choice(4),
         has_pitches ? fmt::format(" pitch {}", widths(2, 8)) : "");
    if (choice(4) == 1) line(" loop {}", widths(5, 30));
    if (choice(3) == 1) line(" method {}", one_of({"uniform", "chord", "centripetal"}));
    const bool is_opposite = form == 3 && choice(3) == 1;
    if (is_opposite) line(" gating opposite{}\n feeds {}", choice(2) == 1 ? " 2" : "", 1 + choice(3));
    if (form == 3 || form == 5) {
      const int width = 1 + choice(3);
      line(" chart");
      for (int row = 1 + choice(3); row > 0; --row) {
        std::string signs;
        for (int i = 0; i < width; ++i)
          signs += form == 5 ? "12"[choice(2)] : "KPTMU"[choice(is_opposite ? 5 : 4)];
        if (form == 3 && choice(8) == 1) signs.back() = '.';
        line("  {}", signs);
      }
      line(" end");
      if (form == 3 && choice(3) == 1)
        line(" transfer {} {} {} {}", 1 + choice(3), 1 + choice(3), one_of({"right", "left"}), choice(3));
      if (form == 3 && choice(6) == 1) line(" drop {} {}", 1 + choice(3), 1 + choice(3));
    }
    line("end");
  }
  void warpknit() {
    const bool classic = choice(2) == 1;
    line("warpknit {}",
         classic ? one_of({"tricot", "cord", "satin", "velvet", "locknit", "queens-cord", "atlas"}) : "");
    if (classic) line(" thread {}", one_of({"a", "b"}));
    for (int bar = classic ? 0 : 1 + choice(2); bar > 0; --bar) {
      std::string lapping;
      for (int course = 1 + choice(3); course > 0; --course)
        lapping += fmt::format("{}{}-{}", lapping.empty() ? "" : "/", choice(4), choice(4));
      line(" bar {} {}//{}", one_of({"a", "b"}), lapping, one_of({"", " fall-plate"}));
    }
    line(" wales {} pitch {}\n courses {} pitch {}", 1 + choice(3), widths(1, 9), 1 + choice(4),
         widths(1, 9));
    if (choice(2) == 1) line(" stitch {}", one_of({"closed", "open"}));
    line("end");
  }
  void braid() {
    const bool flat = choice(2) == 1;
    line("braid\n thread {}\n carriers {}\n pattern {}/{}", one_of({"a", "b"}),
         flat ? 2 + choice(5) : 2 * (1 + choice(4)), 1 + choice(2), 1 + choice(2));
    if (flat)
      line(" flat{}", choice(2) == 1 ? fmt::format(" {}", widths(3, 20)) : "");
    else
      line(" {} {}", one_of({"radius", "planar"}), widths(0.5, 9));
    line(" angle {}\n length {}", number(5, 85), widths(1, 30));
    if (choice(3) == 1) line(" axial {} {}", one_of({"a", "b"}), 1 + choice(3));
    line("end");
  }
  void yarns() {
    const int count = 1 + choice(3);
    for (int i = 1; i <= count; ++i) {
      const bool closed = choice(4) == 1;
      line("yarn y{} {}\n{} path {}", i, one_of({"a", "b"}), closed ? " closed\n" : "",
           one_of({"chord", "uniform", "centripetal", "polyline", "control", "loop"}));
      for (int row = 0, rows = 3 + choice(6); row < rows; ++row)
        line("  {} {} {}", row * 2.0 * width_ + widths(0, 1.5), widths(-2, 2), widths(-1, 1));
      line(" end\n ends {}\nend", one_of({"patch", "fan", "planar", "none"}));
    }
    if (choice(4) == 1)
      line("edit y1 point {} to {} {} {}", 1 + choice(3), number(-1, 3), number(-2, 2), number(-1, 1));
  }
  void use(int block) {
    line("use b{}{}", block, choice(3) == 1 ? fmt::format(" as n{}", choice(3)) : "");
    if (choice(3) == 1)
      line(" repeat {} {}{}", 1 + choice(2), 1 + choice(2),
           choice(2) == 1 ? fmt::format(" step {} {}", number(0.1, 9), number(-9, -0.1)) : "");
    for (int i = choice(4); i > 0; --i) {
      const int axis = choice(3), other = (axis + 1 + choice(2)) % 3;
      switch (choice(4)) {
        case 0:
          line(" place {} {} {}", number(-9, 9), number(-9, 9), number(-9, 9));
          break;
        case 1:
          line(" rotate {} {}", "xyz"[axis], choice(2) == 1 ? 90.0 * choice(4) : number(-360, 360));
          break;
        case 2:
          line(" mirror {}", "xyz"[axis]);
          break;
        default:
          line(" shear {} {} {}", "xyz"[axis], "xyz"[other], number(-80, 80));
          break;
      }
    }
    line("end");
  }
  void cell() {
    const double x = widths(-2, 2), y = widths(-2, 2), z = widths(-2, 0);
    if (choice(4) == 1)
      return line("cell vectors {} 0 0  {} {} 0  0 0 {} at {} {} {}\n matrix epoxy\nend", widths(1, 10),
                  widths(-2, 2), widths(1, 10), widths(1, 5), x, y, z);
    line("cell {} {} {}  {} {} {}\n matrix epoxy\n periodic x y\nend", x, y, z, x + widths(1, 10),
         y + widths(1, 10), z + widths(1, 5));
  }

  std::string_view bytes_;
  std::string text_;
  double width_ = 0;  // of the widest section
};

}  // namespace

std::string fabric_text(std::string_view bytes) {
  return Writer(bytes).text();
}

std::string placed_text(std::string_view bytes) {
  return Writer(bytes).placed_text();
}

}  // namespace selvage::fuzz
