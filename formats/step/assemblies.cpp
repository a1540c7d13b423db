#include "formats/step/assemblies.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/graph.h"

namespace selvage::formats::step {

namespace {

using Edges = std::vector<std::pair<int, int>>;  // places of the whole and of its part

class Assemblies {
 public:
  Assemblies(const Part21& file, TextReport& report) : file_(file), report_(report) {}

  void check() {
    gather();
    count(products_, "part of itself", "instances of this product");
    if (report_.errors() == 0)
      count(representations_, "mapped into itself", "instances of this representation");
  }

 private:
  // The n-th thing that a statement names; -1: none.
  [[nodiscard]] int named_by(std::size_t place, std::size_t n) const {
    const std::size_t at = file_.statements[place].first_ref + n;
    return at < file_.refs_end(place) ? file_.targets[at] : -1;
  }
  [[nodiscard]] bool is_of(int place, std::string_view type) const {
    return place >= 0 && file_.type_of(file_.statements[static_cast<std::size_t>(place)]) == type;
  }

  void gather() {
    for (std::size_t i = 0; i < file_.statements.size(); ++i) {
      const std::string_view type = file_.type_of(file_.statements[i]);
      if (type == "NEXT_ASSEMBLY_USAGE_OCCURRENCE")
        add(products_, named_by(i, 0), named_by(i, 1));
      else if (type.find("REPRESENTATION") != std::string_view::npos)
        gather_mapped(i);
    }
  }

  // A representation holds another by way of its items that are MAPPED_ITEMs of a REPRESENTATION_MAP.
  void gather_mapped(std::size_t i) {
    for (std::size_t r = file_.statements[i].first_ref; r < file_.refs_end(i); ++r) {
      if (!is_of(file_.targets[r], "MAPPED_ITEM")) continue;
      const int map = named_by(static_cast<std::size_t>(file_.targets[r]), 0);
      if (is_of(map, "REPRESENTATION_MAP"))
        add(representations_, static_cast<int>(i), named_by(static_cast<std::size_t>(map), 1));
    }
  }

  static void add(Edges& edges, int whole, int part) {
    if (whole >= 0 && part >= 0) edges.emplace_back(whole, part);
  }

  void count(const Edges& edges, std::string_view circular, std::string_view counted) {
    if (edges.empty()) return;
    const Graph graph = make_graph(file_.statements.size(), edges);
    std::vector<std::size_t> order;
    if (const std::vector<Circle> circles = sort_from_leaves(graph, order); !circles.empty()) {
      const Statement &at = file_.statements[circles[0].at], &by = file_.statements[circles[0].by];
      report_.error(at.spot, fmt::format("#{} is {}, by way of #{}", at.id, circular, by.id));
      return;
    }
    const std::vector<double> ways = count_ways(graph, order);
    const auto most = std::max_element(ways.begin(), ways.end());
    if (*most <= most_instances) return;
    const Statement& at = file_.statements[static_cast<std::size_t>(most - ways.begin())];
    report_.error(at.spot,
                  fmt::format("#{}: {:.15g} {}, more than {:.0f}", at.id, *most, counted, most_instances),
                  Kind::limit);
  }

  const Part21& file_;
  TextReport& report_;
  Edges products_, representations_;
};

}  // namespace

void check_assemblies(const Part21& file, TextReport& report) {
  Assemblies(file, report).check();
}

}  // namespace selvage::formats::step
