// How long it takes to find all overlaps of a cloth, whether the cost of a loop (or a crossing) stays the
// same with its size, and how that compares with CGAL: do_intersect on all pairs of yarns whose boxes meet,
// of their tessellations as `check` makes them. Raw jerseys, whose loops overlap, and plain weaves free of
// overlap. Every pair that CGAL finds has to be among ours; anything else is an error. One JSON object.
//
// CGAL answers less: yes or no for a pair of yarns, and nothing about a yarn that meets itself. It goes
// through the pairs in order; at the limit it stops, and its time is extrapolated from the share of the pairs
// that it did.
//
//   contact [--jersey N,N,...] [--weave N,N,...] [--threads N] [--repeats N] [--peer-limit SECONDS]
#include "contact/contact.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/intersection.h>
#include <CGAL/Surface_mesh.h>
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <mutex>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/box_tree.h"
#include "core/parallel.h"
#include "scripts/benchmarks/built.h"
#include "solid/tessellation.h"

namespace {

using namespace selvage;
using Clock = std::chrono::steady_clock;
using Mesh = CGAL::Surface_mesh<CGAL::Exact_predicates_inexact_constructions_kernel::Point_3>;
using Pair = std::pair<std::size_t, std::size_t>;
using Pairs = std::set<Pair>;

struct Settings {
  std::vector<int> jersey = {10, 20, 35, 50}, weave = {16, 24, 40, 64};
  int threads = 2, repeats = 1;
  double peer_limit = 60;  // s, for the pairs of one cloth
};

using benchmarks::fail;

double since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

// Of round yarns, 0.2 mm thick.
std::vector<yarn::Body> cloth_of(bool weave, int size) {
  fabric::Fabric cloth;
  fabric::Thread thread;
  thread.name = "cotton30";
  thread.diameter = 0.2;
  if (weave) {
    thread.section = yarn::Circle{0.2};
    fabric::Weave item;
    item.warp.threads = item.weft.threads = {thread.name};
    item.warp.count = item.weft.count = size;
    item.warp.pitch = item.weft.pitch = 0.5;
    item.profile = fabric::Weave::Profile::peirce;
    cloth.items = {item};
  } else {
    fabric::Knit item;
    item.threads = {thread.name};
    item.courses = item.wales = size;
    cloth.items = {item};
  }
  cloth.threads = {thread};
  fabric::BuildOptions options;
  options.as_published = !weave;
  return benchmarks::built(cloth, options);
}

contact::Contacts contacts_of(const std::vector<yarn::Body>& bodies, int threads, double reach) {
  contact::ContactOptions options;
  options.threads = threads;
  options.reach = reach;
  Result<contact::Contacts> found = contact::find_contacts(bodies, options);
  if (!found) fail(to_string(found.error()));
  return std::move(*found);
}

Pairs pairs_in(const contact::Contacts& contacts) {
  Pairs pairs;
  for (const contact::Contact& contact : contacts.list) pairs.emplace(contact.a, contact.b);
  return pairs;
}

// The chord error that `check` takes, file units.
double chord_of(const yarn::Body& body) {
  return yarn::narrowest_section(body) / 200.0;
}

struct Peer {
  std::size_t triangles = 0, candidates = 0, done = 0;
  double tessellation = 0, pairs = 0;  // s, of the pairs that were done
  Pairs found;

  [[nodiscard]] double share() const {
    return candidates == 0 ? 1.0 : static_cast<double>(done) / static_cast<double>(candidates);
  }
  [[nodiscard]] double seconds() const { return tessellation + pairs / share(); }
};

Mesh mesh_of(const yarn::Body& body) {
  const Result<solid::Tessellation> skin = solid::tessellate(body, chord_of(body));
  if (!skin) fail(to_string(skin.error()));
  Mesh mesh;
  const auto vertices = static_cast<Mesh::size_type>(skin->vertices.size()),
             faces = static_cast<Mesh::size_type>(skin->triangles.size());
  mesh.reserve(vertices, vertices + faces, faces);
  for (const Vec3& p : skin->vertices) mesh.add_vertex({p.x(), p.y(), p.z()});
  using Vertex = Mesh::Vertex_index;
  for (const auto& t : skin->triangles)
    if (mesh.add_face(Vertex(t[0]), Vertex(t[1]), Vertex(t[2])) == Mesh::null_face())
      fail("yarn '" + body.name + "' is no surface to CGAL");
  return mesh;
}

// Pairs of meshes whose boxes meet.
std::vector<Pair> candidates_of(const std::vector<Mesh>& meshes) {
  std::vector<Box3> boxes(meshes.size());
  for (std::size_t k = 0; k < meshes.size(); ++k)
    for (const Mesh::Vertex_index v : meshes[k].vertices()) {
      const auto& p = meshes[k].point(v);
      boxes[k].extend(Vec3(p.x(), p.y(), p.z()));
    }
  std::vector<Pair> pairs;
  BoxTree(std::move(boxes)).near_pairs(0.0, [&](std::uint32_t i, std::uint32_t j) {
    pairs.emplace_back(i, j);
  });
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

Peer ask_peer(const std::vector<yarn::Body>& bodies, const Settings& settings) {
  Peer peer;
  const Clock::time_point begin = Clock::now();
  std::vector<Mesh> meshes(bodies.size());
  for_each_index(bodies.size(), settings.threads, [&](std::size_t k) { meshes[k] = mesh_of(bodies[k]); });
  peer.tessellation = since(begin);
  for (const Mesh& mesh : meshes) peer.triangles += mesh.number_of_faces();

  const Clock::time_point pairs_begin = Clock::now();
  const std::vector<Pair> candidates = candidates_of(meshes);
  peer.candidates = candidates.size();
  std::mutex guard;
  for_each_index(candidates.size(), settings.threads, [&](std::size_t k) {
    if (k > 0 && since(pairs_begin) > settings.peer_limit) return;
    const auto& [a, b] = candidates[k];
    const bool meet = CGAL::Polygon_mesh_processing::do_intersect(meshes[a], meshes[b]);
    const std::lock_guard lock(guard);
    ++peer.done;
    if (meet) peer.found.insert(candidates[k]);
  });
  peer.pairs = since(pairs_begin);
  return peer;
}

// How many pairs CGAL has beyond ours. A chord lies outside of a bend's inner side, so that triangles of
// yarns that are nearer than both chord errors may meet; any other pair is an error.
std::size_t compare(const std::vector<yarn::Body>& bodies, const Pairs& ours, const Peer& peer, int threads) {
  std::vector<Pair> beyond;
  std::set_difference(peer.found.begin(), peer.found.end(), ours.begin(), ours.end(),
                      std::back_inserter(beyond));
  if (beyond.empty()) return 0;
  double chord = 0.0;
  for (const yarn::Body& body : bodies) chord = std::max(chord, chord_of(body));
  const Pairs near = pairs_in(contacts_of(bodies, threads, 2.0 * chord));
  for (const auto& [a, b] : beyond)
    if (!near.contains({a, b}))
      fail(fmt::format("CGAL finds that '{}' and '{}' meet, and we do not", bodies[a].name, bodies[b].name));
  return beyond.size();
}

std::string row_of(bool weave, int size, const Settings& settings) {
  const std::vector<yarn::Body> bodies = cloth_of(weave, size);
  contact::Contacts contacts;
  double seconds = 0.0;
  for (int k = 0; k < settings.repeats; ++k) {
    const Clock::time_point begin = Clock::now();
    contacts = contacts_of(bodies, settings.threads, 0.0);
    const double took = since(begin);
    seconds = k == 0 ? took : std::min(seconds, took);
  }
  const Pairs ours = pairs_in(contacts);
  const Peer peer = ask_peer(bodies, settings);
  const std::size_t beyond = compare(bodies, ours, peer, settings.threads);
  std::size_t self = 0;
  for (const contact::Contact& contact : contacts.list) self += contact.a == contact.b ? 1 : 0;
  return fmt::format(
      "  {{\"cloth\": \"{}\", \"size\": {}, \"yarns\": {}, \"contacts\": {}, \"self_contacts\": {}, "
      "\"resolution\": {:.3g}, \"seconds\": {:.4g}, \"milliseconds_a_unit\": {:.4g}, \"triangles\": {}, "
      "\"peer_candidates\": {}, \"peer_share\": {:.4g}, \"peer_pairs\": {}, \"peer_pairs_within_chords\": "
      "{}, "
      "\"peer_tessellation_seconds\": {:.4g}, \"peer_seconds\": {:.4g}, \"times_peer\": {:.4g}}}",
      weave ? "plain weave" : "jersey", size, bodies.size(), contacts.list.size(), self, contacts.resolution,
      seconds, 1e3 * seconds / size / size, peer.triangles, peer.candidates, peer.share(), peer.found.size(),
      beyond, peer.tessellation, peer.seconds(), peer.seconds() / seconds);
}

}  // namespace

int main(int count, char** words) {
  Settings settings;
  for (int i = 1; i + 1 < count; i += 2) {
    const std::string word = words[i];
    if (word == "--jersey") settings.jersey = benchmarks::numbers_in(words[i + 1]);
    if (word == "--weave") settings.weave = benchmarks::numbers_in(words[i + 1]);
    if (word == "--threads") settings.threads = std::max(1, std::atoi(words[i + 1]));
    if (word == "--repeats") settings.repeats = std::max(1, std::atoi(words[i + 1]));
    if (word == "--peer-limit") settings.peer_limit = std::max(0.0, std::atof(words[i + 1]));
  }
  std::string rows;
  for (const bool weave : {false, true})
    for (const int size : weave ? settings.weave : settings.jersey)
      rows += (rows.empty() ? "" : ",\n") + row_of(weave, size, settings);
  fmt::print("{{\"benchmark\": \"contact\", \"threads\": {}, \"rows\": [\n{}\n]}}\n", settings.threads, rows);
  return 0;
}
