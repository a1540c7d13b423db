#include "core/graph.h"

#include <algorithm>
#include <numeric>

namespace selvage {

Graph make_graph(std::size_t count, const std::vector<std::pair<int, int>>& edges) {
  Graph graph{std::vector<std::size_t>(count + 1, 0), std::vector<int>(edges.size())};
  for (const auto& [from, to] : edges) ++graph.firsts[static_cast<std::size_t>(from) + 1];
  std::partial_sum(graph.firsts.begin(), graph.firsts.end(), graph.firsts.begin());
  std::vector<std::size_t> next(graph.firsts.begin(), graph.firsts.end() - 1);
  for (const auto& [from, to] : edges) graph.targets[next[static_cast<std::size_t>(from)]++] = to;
  return graph;
}

std::vector<Circle> sort_from_leaves(const Graph& graph, std::vector<std::size_t>& order) {
  enum : char { untouched, open, done };
  std::vector<char> state(graph.size(), untouched);
  std::vector<std::pair<std::size_t, std::size_t>> path;  // node, where it leads next
  std::vector<Circle> circles;
  order.clear();
  for (std::size_t root = 0; root < state.size(); ++root) {
    if (state[root] != untouched) continue;
    state[root] = open;
    path.assign(1, {root, graph.firsts[root]});
    while (!path.empty()) {
      auto& [at, next] = path.back();
      if (next == graph.firsts[at + 1]) {
        state[at] = done;
        order.push_back(at);
        path.pop_back();
        continue;
      }
      const int target = graph.targets[next++];
      if (target < 0) continue;
      const auto to = static_cast<std::size_t>(target);
      if (state[to] == open) circles.push_back({to, at});
      if (state[to] != untouched) continue;
      state[to] = open;
      path.emplace_back(to, graph.firsts[to]);
    }
  }
  return circles;
}

std::vector<double> count_ways(const Graph& graph, const std::vector<std::size_t>& order) {
  std::vector<double> ways(graph.size(), 0);
  std::for_each(order.rbegin(), order.rend(), [&](std::size_t node) {
    if (ways[node] == 0) ways[node] = 1;
    for (std::size_t edge = graph.firsts[node]; edge < graph.firsts[node + 1]; ++edge)
      if (graph.targets[edge] >= 0) ways[static_cast<std::size_t>(graph.targets[edge])] += ways[node];
  });
  return ways;
}

}  // namespace selvage
