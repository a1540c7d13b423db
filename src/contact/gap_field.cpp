#include "contact/gap_field.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "contact/face.h"
#include "contact/skin_distance.h"
#include "core/parallel.h"

namespace selvage::contact {

namespace {

// A point inside a yarn is nearer to its skin than half its thickness; sections change between pieces.
constexpr double depth_share = 0.75;

class GapField {
 public:
  GapField(std::span<const yarn::Body> bodies, std::span<const SkinMesh> skins,
           const GapFieldOptions& options)
      : skins_(skins), options_(options), model_(bodies, options.threads), tree_({}) {
    trees_.resize(skins.size());
    pieces_.resize(skins.size());
    depths_.assign(skins.size(), 0.0);
    for (const Piece& piece : model_.pieces())
      depths_[piece.body] = std::max(depths_[piece.body], depth_share * piece.thickness);
    for (const double depth : depths_) reaches_.push_back(std::max(options.reach, depth));
    for_each_index(skins.size(), options.threads, [&](std::size_t b) {
      trees_[b] = std::make_unique<SkinDistance>(skins[b]);
      pieces_[b] = pieces_along(b);
    });
    std::vector<Box3> boxes;
    for (std::size_t b = 0; b < skins.size(); ++b) {
      boxes.push_back(trees_[b]->box());
      largest_reach_ = std::max(largest_reach_, reaches_[b]);
    }
    tree_ = BoxTree(std::move(boxes));
  }

  std::vector<std::vector<double>> values() const {
    struct Block {
      std::size_t skin, first, last;
    };
    constexpr std::size_t block = 1024;
    std::vector<std::vector<double>> out(skins_.size());
    std::vector<Block> blocks;
    for (std::size_t b = 0; b < skins_.size(); ++b) {
      const std::size_t count = skins_[b].vertices.size();
      out[b].resize(count);
      for (std::size_t k = 0; k < count; k += block) blocks.push_back({b, k, std::min(count, k + block)});
    }
    const auto fill = [&](std::size_t k) {
      const Block& part = blocks[k];
      for (std::size_t v = part.first; v < part.last; ++v) out[part.skin][v] = value(part.skin, v);
    };
    for_each_index(blocks.size(), options_.threads, fill, options_.progress);
    return out;
  }

 private:
  // The piece of the side at each vertex.
  [[nodiscard]] std::vector<std::uint32_t> pieces_along(std::size_t b) const {
    const SkinMesh& skin = skins_[b];
    if (skin.vertices.empty()) return {};
    std::vector<std::uint32_t> ids;
    std::vector<double> ends;  // the last v of each
    const Face& side = model_.faces()[model_.side(b)];
    for (std::uint32_t cell = side.rows.front(); cell < side.rows.back() + side.count_u;) {
      const Piece& piece = model_.piece_of_cell(cell);
      ids.push_back(static_cast<std::uint32_t>(&piece - model_.pieces().data()));
      cell += piece.count;
      ends.push_back(model_.cells()[cell - 1].high.y());
    }
    std::vector<std::uint32_t> at(skin.vertices.size());
    for (std::size_t k = 0; k < at.size(); ++k) {
      const auto found = std::lower_bound(ends.begin(), ends.end() - 1, skin.along[k]);
      at[k] = ids[static_cast<std::size_t>(found - ends.begin())];
    }
    return at;
  }

  [[nodiscard]] std::optional<double> to_itself(std::size_t b, const Vec3& point, const Piece& here) const {
    return trees_[b]->to_part(point, reaches_[b], depths_[b], [&](std::uint32_t triangle) {
      const Piece& there = model_.pieces()[pieces_[b][skins_[b].triangles[triangle][0]]];
      return model_.way_along(here, there) > self_distance * std::max(here.width, there.width);
    });
  }

  [[nodiscard]] double value(std::size_t skin, std::size_t vertex) const {
    const Vec3& point = skins_[skin].vertices[vertex];
    double least = options_.reach;
    tree_.near_point(point, largest_reach_, [&](std::uint32_t b) {
      const std::optional<double> gap = b == skin
                                            ? to_itself(b, point, model_.pieces()[pieces_[skin][vertex]])
                                            : trees_[b]->at(point, reaches_[b]);
      if (gap) least = std::min(least, *gap);
      return largest_reach_;
    });
    return least;
  }

  std::span<const SkinMesh> skins_;
  const GapFieldOptions& options_;
  CellModel model_;
  std::vector<std::unique_ptr<SkinDistance>> trees_;
  std::vector<std::vector<std::uint32_t>> pieces_;  // of the model, one a vertex
  std::vector<double> depths_;                      // how deep a point can be in each body
  std::vector<double> reaches_;                     // how far to look for each body's skin
  double largest_reach_ = 0;
  BoxTree tree_;  // of all skins
};

}  // namespace

std::vector<std::vector<double>> gap_field(std::span<const yarn::Body> bodies,
                                           std::span<const SkinMesh> skins, const GapFieldOptions& options) {
  return GapField(bodies, skins, options).values();
}

}  // namespace selvage::contact
