// Graphs of things that hold or name each other.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

namespace selvage {

struct Graph {
  std::vector<std::size_t> firsts;  // node i leads to targets[firsts[i]] up to targets[firsts[i + 1]]
  std::vector<int> targets;         // negative ones lead nowhere

  [[nodiscard]] std::size_t size() const { return firsts.size() - 1; }
};

// Of `count` nodes; one that leads to another twice has two edges. The order of a node's edges is that of
// `edges`.
Graph make_graph(std::size_t count, const std::vector<std::pair<int, int>>& edges);

// A node that is reached from itself, the last step from `by`.
struct Circle {
  std::size_t at = 0, by = 0;
};

// All circles, in the order in which a walk from the first node on finds them. `order` gets all nodes, each
// after those that it leads to but for circles. Time and memory are linear, and nothing recurses: a chain may
// be as long as a file.
std::vector<Circle> sort_from_leaves(const Graph& graph, std::vector<std::size_t>& order);

// In how many ways each node is reached from the nodes that nothing leads to; those themselves: 1. `order` is
// that of sort_from_leaves. As double: the numbers grow beyond all integers.
std::vector<double> count_ways(const Graph& graph, const std::vector<std::size_t>& order);

}  // namespace selvage
