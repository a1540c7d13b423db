// Interlacing as topology: where a warp and a weft cross, the centre lines' own z says which is on top, and
// the text's draft, read here by itself, says which has to be.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <string>

#include "nurbs/spline.h"
#include "property/zoo.h"

namespace selvage::zoo {
namespace {

using fabric::Draft;
using fabric::Weave;
using fabric::YarnPlan;
using Profile = Weave::Profile;

// The definitions of formats/txt/README.md, warps and wefts counted from 1.
bool warp_has_to_be_on_top(const Draft& draft, int warp, int weft) {
  const int i = warp - 1, j = weft - 1, period = draft.a + draft.b;
  switch (draft.form) {
    case Draft::Form::rows: {
      const std::string& row = draft.rows[static_cast<std::size_t>(j) % draft.rows.size()];
      return row[static_cast<std::size_t>(i) % row.size()] == '1';
    }
    case Draft::Form::plain:
      return (warp + weft) % 2 == 0;
    case Draft::Form::twill:
      return (i + j) % period < draft.a;
    case Draft::Form::satin:
      return (i + draft.b * j) % draft.a == 0;
    case Draft::Form::basket:
      return (i % period < draft.a) == (j % period < draft.a);
    case Draft::Form::leno:  // standing ends below, doup ends above
      return warp % 2 == 0;
    case Draft::Form::corduroy:  // picks of pile decide
    case Draft::Form::velveteen:
    case Draft::Form::file:
      break;
  }
  ADD_FAILURE() << "a draft that was not read";
  return false;
}

using Plans = std::map<std::string, YarnPlan>;

Plans by_name(const fabric::Fabric& fabric) {
  Plans plans;
  for (YarnPlan& plan : plans_of(fabric)) plans.emplace(plan.name, plan);
  return plans;
}

// The place of a centre line at a coordinate that grows along it.
Vec3 place_at(const YarnPlan& plan, int axis, double value) {
  double low = 0.0, high = 1.0;
  for (int step = 0; step < 60; ++step) {
    const double middle = 0.5 * (low + high);
    (nurbs::evaluate(plan.line.curve, middle)[axis] < value ? low : high) = middle;
  }
  return nurbs::evaluate(plan.line.curve, 0.5 * (low + high));
}

struct WovenCrossing {
  double x = 0, y = 0, warp_z = 0, weft_z = 0;
};

WovenCrossing crossing_of(const YarnPlan& warp, const YarnPlan& weft) {
  const double x = nurbs::evaluate(weft.line.curve, 0.0).x(), y = nurbs::evaluate(warp.line.curve, 0.0).y();
  const Vec3 on_warp = place_at(warp, 0, x), on_weft = place_at(weft, 1, y);
  EXPECT_NEAR(on_warp.y(), y, 1e-12);
  EXPECT_NEAR(on_weft.x(), x, 1e-12);
  return {x, y, on_warp.z(), on_weft.z()};
}

// Of the section where the yarn is nearest to a place along an axis.
double thickness(const YarnPlan& plan, int axis, double place) {
  double parameter = 0.0, least = std::numeric_limits<double>::infinity();
  for (std::size_t row = 0; row < std::min(plan.points.size(), plan.line.parameters.size()); ++row)
    if (const double off = std::abs(plan.points[row][axis] + plan.at[axis] - place); off < least) {
      least = off;
      parameter = plan.line.parameters[row];
    }
  const auto nearer = [&](const yarn::SizeAtParameter& a, const yarn::SizeAtParameter& b) {
    return std::abs(a.parameter - parameter) < std::abs(b.parameter - parameter);
  };
  return std::min_element(plan.spec.sizes.begin(), plan.spec.sizes.end(), nearer)->size.height;
}

// Everything about a weave's order that its centre lines show otherwise than its text says.
class Differences {
 public:
  Differences(const Weave& weave, const Plans& plans) : weave_(weave), plans_(plans) {
    const int layers = weave.layers.value_or(1);
    if (weave.profile == Profile::straight) {
      look_at_stack(layers);
      look_at_binders(layers);
    } else if (!weave.columns.empty()) {
      look_at_columns(layers);
    } else if (weave.pile) {
      look_at_layer(1, 1);
      look_at_warp_pile();
    } else if (weave.draft.has_pile()) {
      look_at_weft_pile();
    } else {
      for (int layer = 1; layer <= layers; ++layer) look_at_layer(layer, layers);
    }
  }
  [[nodiscard]] const std::vector<std::string>& found() const { return found_; }

 private:
  const YarnPlan& plan(const std::string& name) {
    const auto plan = plans_.find(name);
    if (plan != plans_.end()) return plan->second;
    throw std::runtime_error("no yarn " + name);
  }
  void expect(bool holds, const std::string& text) {
    if (!holds) found_.push_back(text);
  }
  static std::string yarn(const std::string& prefix, const char* kind, int number) {
    return prefix + kind + "_" + std::to_string(number);
  }

  void look_at_layer(int layer, int layers) {
    const std::string prefix = layers > 1 ? "layer" + std::to_string(layer) + "_" : "";
    for (int i = 1; i <= weave_.warp.count; ++i)
      for (int j = 1; j <= weave_.weft.count; ++j) {
        const YarnPlan &warp = plan(yarn(prefix, "warp", i)), &weft = plan(yarn(prefix, "weft", j));
        const WovenCrossing crossing = crossing_of(warp, weft);
        const std::string at = warp.name + " x " + weft.name;
        expect((crossing.warp_z > crossing.weft_z) == warp_has_to_be_on_top(weave_.draft, i, j), at);
        // Apart by a small part of their thickness; sines by more, which come nearer on their slopes. In
        // equilibrium nothing holds yarns together under floats.
        const bool is_in_equilibrium =
            std::holds_alternative<yarn::Ellipse>(warp.spec.section) && warp.spec.sizes.size() > 1;
        const double least = 0.5 * (thickness(warp, 0, crossing.x) + thickness(weft, 1, crossing.y)),
                     most = weave_.profile == Profile::sine ? 1.3
                            : is_in_equilibrium             ? std::numeric_limits<double>::infinity()
                                                            : 1.05,
                     apart = std::abs(crossing.warp_z - crossing.weft_z);
        if (!weave_.amplitude) expect(apart > least - 1e-9 && apart < most * least, at + " do not meet");
        if (layer < layers) {
          const std::string above = "layer" + std::to_string(layer + 1) + "_";
          const WovenCrossing next = crossing_of(plan(yarn(above, "warp", i)), plan(yarn(above, "weft", j)));
          expect(std::min(next.warp_z, next.weft_z) > std::max(crossing.warp_z, crossing.weft_z),
                 at + " and the layer above");
        }
      }
  }

  void look_at_stack(int layers) {
    for (int layer = 1; layer <= layers; ++layer) {
      const std::string below = "layer" + std::to_string(layer) + "_",
                        above = "layer" + std::to_string(layer + 1) + "_";
      for (int i = 1; i <= weave_.warp.count; ++i)
        for (int j = 1; j <= weave_.weft.count; ++j) {
          const YarnPlan& warp = plan(yarn(below, "warp", i));
          const WovenCrossing under = crossing_of(warp, plan(yarn(below, "weft", j))),
                              over = crossing_of(warp, plan(yarn(above, "weft", j)));
          expect(under.weft_z < under.warp_z && over.warp_z < over.weft_z, warp.name);
        }
    }
  }

  void look_at_columns(int layers) {
    for (int i = 1; i <= weave_.warp.count; ++i) {
      const fabric::WarpColumn& column =
          weave_.columns[static_cast<std::size_t>(i - 1) % weave_.columns.size()];
      for (std::size_t k = 0; k < column.size(); ++k)
        for (int j = 1; j <= weave_.weft.count; ++j) {
          const YarnPlan& warp = plan(yarn("", "warp", i) + "_" + std::to_string(k + 1));
          int below = 0;
          for (int layer = 1; layer <= layers; ++layer) {
            const YarnPlan& weft = plan(yarn("layer" + std::to_string(layer) + "_", "weft", j));
            const WovenCrossing crossing = crossing_of(warp, weft);
            const double apart = std::abs(crossing.warp_z - crossing.weft_z),
                         least = 0.5 * (thickness(warp, 0, crossing.x) + thickness(weft, 1, crossing.y));
            expect(apart > least - 1e-9, warp.name + " x " + weft.name + " overlap");
            if (crossing.weft_z < crossing.warp_z) ++below;
          }
          const std::vector<int>& levels = column[k].levels;
          expect(below == levels[static_cast<std::size_t>(j - 1) % levels.size()],
                 warp.name + " at weft " + std::to_string(j));
        }
    }
  }

  // Every place of a yarn of pile, of all of its tufts, over or under the one that it crosses at x (y).
  struct Side {
    bool is_over = false, is_under = false;
  };
  [[nodiscard]] Side side_of_pile(int number, int axis, const Vec3& crossed) const {
    const std::string name = "pile_" + std::to_string(number), tuft = name + "_tuft_";
    Side side;
    for (const auto& [yarn_name, pile] : plans_)
      if (yarn_name == name || yarn_name.starts_with(tuft))
        for (int k = 0; k <= 2000; ++k) {
          const Vec3 point = nurbs::evaluate(pile.line.curve, k / 2000.0) + pile.at;
          if (std::abs(point[axis] - crossed[axis]) < 0.02 * weave_.weft.pitch)
            (point.z() > crossed.z() ? side.is_over : side.is_under) = true;
        }
    return side;
  }

  // Bound by picks 1, 3, ... of every group, free over the last two of it at least.
  void look_at_warp_pile() {
    const fabric::WarpPile& pile = *weave_.pile;
    for (int i = 1; i <= weave_.warp.count; ++i) {
      const bool is_up = pile.side == fabric::WarpPile::Side::face ||
                         (pile.side == fabric::WarpPile::Side::both && i % 2 == 1);
      for (int j = 1; j <= weave_.weft.count; ++j) {
        const int of_group = (j - 1) % pile.picks + 1;
        const bool is_bound = of_group % 2 == 1 && of_group <= pile.picks - 2;
        const YarnPlan& weft = plan(yarn("", "weft", j));
        const double y = (i - 0.25) * weave_.warp.pitch;  // of the pile end
        const Side side = side_of_pile(i, 0, place_at(weft, 1, y));
        const std::string at = "pile " + std::to_string(i) + " x weft " + std::to_string(j);
        expect(!(is_bound == is_up ? side.is_over : side.is_under), at);
        if (is_bound) expect(side.is_over || side.is_under, at + " is not bound");
      }
    }
  }

  // The first thread's picks weave plain; pile picks are bound under ends of the middle of a wale, or every
  // other one, in turn.
  void look_at_weft_pile() {
    const std::vector<std::string>& threads = weave_.weft.threads;
    const int width = weave_.draft.a;
    int ground = 0, pile = 0;
    for (int j = 1; j <= weave_.weft.count; ++j) {
      const bool is_ground = threads[static_cast<std::size_t>(j - 1) % threads.size()] == threads.front();
      const int of_kind = ++(is_ground ? ground : pile);
      const int binding = weave_.draft.form == Draft::Form::corduroy ? width / 2 + 1 - (of_kind - 1) % 2
                                                                     : 2 * ((of_kind - 1) % (width / 2)) + 1;
      for (int i = 1; i <= weave_.warp.count; ++i) {
        const YarnPlan& warp = plan(yarn("", "warp", i));
        const std::string at = warp.name + " x pick " + std::to_string(j);
        if (is_ground) {
          const WovenCrossing crossing = crossing_of(warp, plan(yarn("", "weft", j)));
          expect((crossing.warp_z > crossing.weft_z) == ((i + of_kind) % 2 == 0), at);
          continue;
        }
        const bool is_bound = (i - 1) % width + 1 == binding;
        const Side side = side_of_pile(j, 1, place_at(warp, 0, (j - 0.5) * weave_.weft.pitch));
        expect(is_bound ? side.is_under && !side.is_over : !side.is_under, at);
      }
    }
  }

  void look_at_binders(int layers) {
    int number = 0;
    for (const fabric::Binder& binder : weave_.binders)
      for (int gap = binder.first; gap < weave_.warp.count; gap += binder.every) {
        const YarnPlan& yarn_plan = plan(yarn("", "binder", ++number));
        expect(std::abs(nurbs::evaluate(yarn_plan.line.curve, 0.0).y() - gap * weave_.warp.pitch) < 1e-9,
               yarn_plan.name + " is in another gap");
        for (int j = 1; j <= weave_.weft.count; ++j) {
          int below = 0;
          for (int layer = 1; layer <= layers + 1; ++layer) {
            const WovenCrossing crossing =
                crossing_of(yarn_plan, plan(yarn("layer" + std::to_string(layer) + "_", "weft", j)));
            if (crossing.weft_z < crossing.warp_z) ++below;
          }
          const std::size_t place = static_cast<std::size_t>(j - 1) % binder.levels.size();
          expect(below == binder.levels[place], yarn_plan.name + " at weft " + std::to_string(j));
        }
      }
    expect(plans_.count(yarn("", "binder", number + 1)) == 0, "more binders than the text asks for");
  }

  const Weave& weave_;
  const Plans& plans_;
  std::vector<std::string> found_;
};

std::vector<std::string> differences(const Weave& weave, const Plans& plans) {
  return Differences(weave, plans).found();
}

// Those whose yarns lie in planes along x and y: others are looked at in tests/cli/test_real_cloths.py.
std::vector<const ZooFabric*> plane_weaves() {
  std::vector<const ZooFabric*> weaves = with<Weave>();
  std::erase_if(weaves, [](const ZooFabric* zoo) {
    const Weave& weave = item_of<Weave>(*zoo);
    return weave.draft.form == Draft::Form::leno || weave.pucker;
  });
  return weaves;
}

TEST(WeaveProperty, EveryYarnOfTheZooGoesOverAndUnderAsItsDraftSays) {
  const std::vector<const ZooFabric*> weaves = plane_weaves();
  EXPECT_GE(weaves.size(), 15U);
  for (const ZooFabric* zoo : weaves)
    EXPECT_EQ(differences(item_of<Weave>(*zoo), by_name(zoo->fabric)), std::vector<std::string>())
        << zoo->name;
}

TEST(WeaveProperty, AYarnTurnedUpsideDownIsSeen) {
  for (const ZooFabric* zoo : plane_weaves()) {
    const Weave& weave = item_of<Weave>(*zoo);
    Plans plans = by_name(zoo->fabric);
    for (const char* name : {"warp_2", "layer1_weft_1", "binder_1"}) {
      const auto found = plans.find(name);
      if (found == plans.end()) continue;
      for (Vec3& point : found->second.line.curve.points) point.z() = -point.z();
      EXPECT_NE(differences(weave, plans), std::vector<std::string>()) << zoo->name << ": " << name;
      for (Vec3& point : found->second.line.curve.points) point.z() = -point.z();
    }
  }
}

TEST(WeaveProperty, OneWrongBitOfADraftIsSeen) {
  for (const ZooFabric* zoo : with<Weave>()) {
    Weave weave = item_of<Weave>(*zoo);
    if (weave.draft.form != Draft::Form::rows || weave.draft.rows.empty()) continue;
    const Plans plans = by_name(zoo->fabric);
    char& bit = weave.draft.rows[1][2];
    bit = bit == '1' ? '0' : '1';
    EXPECT_NE(differences(weave, plans), std::vector<std::string>()) << zoo->name;
  }
}

TEST(WeaveProperty, OneWrongLevelOfABinderIsSeen) {
  int seen = 0;
  for (const ZooFabric* zoo : with<Weave>()) {
    Weave weave = item_of<Weave>(*zoo);
    if (weave.binders.empty()) continue;
    const Plans plans = by_name(zoo->fabric);
    int& level = weave.binders.back().levels.front();
    level = level == 0 ? 1 : level - 1;
    EXPECT_NE(differences(weave, plans), std::vector<std::string>()) << zoo->name;
    ++seen;
  }
  EXPECT_GE(seen, 3);
}

}  // namespace
}  // namespace selvage::zoo
