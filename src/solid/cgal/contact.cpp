#include "solid/cgal/contact.h"

#include <algorithm>
#include <map>
#include <numeric>

namespace selvage::solid {

namespace {

class Groups {
 public:
  explicit Groups(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0U); }
  std::uint32_t find(std::uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void unite(std::uint32_t i, std::uint32_t j) {
    i = find(i);
    j = find(j);
    parent_[std::max(i, j)] = std::min(i, j);
  }

 private:
  std::vector<std::uint32_t> parent_;
};

// The triangles of `skin` that lie wholly inside `other`. `crossing`: those that meet it. The rest falls into
// pieces, each wholly inside or wholly outside.
std::vector<bool> find_inside(const Tessellation& skin, const std::vector<bool>& crossing,
                              const TriangleTree& other) {
  Groups pieces(skin.vertices.size());
  for (std::size_t k = 0; k < skin.triangles.size(); ++k) {
    if (crossing[k]) continue;
    pieces.unite(skin.triangles[k][0], skin.triangles[k][1]);
    pieces.unite(skin.triangles[k][0], skin.triangles[k][2]);
  }
  std::map<std::uint32_t, bool> is_inside;
  std::vector<bool> inside(skin.triangles.size(), false);
  for (std::size_t k = 0; k < skin.triangles.size(); ++k) {
    if (crossing[k]) continue;
    const std::uint32_t piece = pieces.find(skin.triangles[k][0]);
    const auto [found, is_new] = is_inside.try_emplace(piece, false);
    const Vec3& p = skin.vertices[piece];
    if (is_new) found->second = other.box().contains(p) && winding_number(other.skin(), p) > 0.5;
    inside[k] = found->second;
  }
  return inside;
}

}  // namespace

std::vector<Contact> find_contacts(const TriangleTree& a, const TriangleTree& b,
                                   const std::vector<TriangleTree::Pair>& pairs) {
  const Tessellation &sa = a.skin(), &sb = b.skin();
  const auto shift = static_cast<std::uint32_t>(sa.vertices.size());
  std::vector<bool> near_a(sa.triangles.size()), near_b(sb.triangles.size());
  std::vector<bool> crossing_a(sa.triangles.size()), crossing_b(sb.triangles.size());
  bool meet = false;
  Groups groups(sa.vertices.size() + sb.vertices.size());
  for (const TriangleTree::Pair& pair : pairs) {
    near_a[pair.a] = near_b[pair.b] = true;
    if (pair.distance == 0.0) crossing_a[pair.a] = crossing_b[pair.b] = meet = true;
    const std::uint32_t root = sa.triangles[pair.a][0];
    for (std::size_t k = 0; k < 3; ++k) {
      groups.unite(root, sa.triangles[pair.a][k]);
      groups.unite(root, sb.triangles[pair.b][k] + shift);
    }
  }
  std::vector<bool> inside_a(sa.triangles.size()), inside_b(sb.triangles.size());
  if (meet || b.box().contains(a.box())) inside_a = find_inside(sa, crossing_a, b);
  if (meet || a.box().contains(b.box())) inside_b = find_inside(sb, crossing_b, a);
  const auto join = [&](const Tessellation& skin, const std::vector<bool>& inside, std::uint32_t offset) {
    for (std::size_t k = 0; k < skin.triangles.size(); ++k) {
      if (!inside[k]) continue;
      groups.unite(skin.triangles[k][0] + offset, skin.triangles[k][1] + offset);
      groups.unite(skin.triangles[k][0] + offset, skin.triangles[k][2] + offset);
    }
  };
  join(sa, inside_a, 0);
  join(sb, inside_b, shift);

  std::map<std::uint32_t, Contact>
      contacts;  // by group, so that their order does not depend on anything else
  const auto collect = [&](const Tessellation& skin, const std::vector<bool>& near,
                           const std::vector<bool>& inside, std::uint32_t offset,
                           std::vector<std::uint32_t> Contact::*list) {
    for (std::uint32_t k = 0; k < skin.triangles.size(); ++k) {
      if (!near[k] && !inside[k]) continue;
      Contact& contact = contacts[groups.find(skin.triangles[k][0] + offset)];
      (contact.*list).push_back(k);
      if (inside[k]) contact.shared = true;
    }
  };
  collect(sa, near_a, inside_a, 0, &Contact::a);
  collect(sb, near_b, inside_b, shift, &Contact::b);
  for (auto& [group, contact] : contacts) contact.nearest.distance = std::numeric_limits<double>::infinity();
  for (const TriangleTree::Pair& pair : pairs) {
    Contact& contact = contacts[groups.find(sa.triangles[pair.a][0])];
    if (pair.distance < contact.nearest.distance) contact.nearest = pair;
    if (pair.distance == 0.0) contact.shared = true;
  }
  std::vector<Contact> list;
  for (auto& [group, contact] : contacts) list.push_back(std::move(contact));
  return list;
}

}  // namespace selvage::solid
