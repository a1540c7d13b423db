#include "formats/txt/random_model.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <utility>

#include "fabric/quantities.h"

namespace selvage::test {

namespace {

using namespace fabric;

class Maker {
 public:
  explicit Maker(std::uint64_t seed) : engine_(seed) {}

  Fabric make() {
    Fabric fabric;
    if (coin()) fabric.title = text();
    if (coin()) {
      fabric.units_given = true;
      fabric.units = static_cast<Unit>(up_to(4));
    }
    maybe(fabric.tolerance, [&] { return positive(); });
    for (int i = up_to(3); i > 0; --i) fabric.materials.push_back(material());
    for (int i = up_to(2); i > 0; --i) fabric.outlines.push_back(outline());
    for (int i = 1 + up_to(3); i > 0; --i) fabric.threads.push_back(thread());
    for (int i = up_to(2); i > 0; --i) fabric.blocks.push_back(block());
    for (int i = up_to(8); i > 0; --i) fabric.items.push_back(item());
    if (!yarns_.empty())
      for (int i = up_to(3); i > 0; --i) fabric.edits.push_back(edit());
    if (coin()) fabric.cell = cell();
    return fabric;
  }

 private:
  // --- values
  // -------------------------------------------------------------------------------------------------------
  int up_to(int most) { return std::uniform_int_distribution<int>(0, most)(engine_); }
  bool coin() { return up_to(1) == 1; }
  template <class T, class Make>
  void maybe(std::optional<T>& value, Make make) {
    if (coin()) value = make();
  }
  // Any finite double by its bits: tiny, huge, denormal, negative zero; or one that people write.
  double number() {
    switch (up_to(5)) {
      case 0:
        return up_to(20) - 10;
      case 1:
        return (up_to(2000) - 1000) / 100.0;
      case 2:
        return -0.0;
      case 3:
        return std::numeric_limits<double>::denorm_min() * (1 + up_to(5));
      default:
        break;
    }
    for (;;) {
      const std::uint64_t bits = engine_();
      double value = 0.0;
      std::memcpy(&value, &bits, sizeof value);
      if (std::isfinite(value)) return value;
    }
  }
  double positive() {
    const double value = std::abs(number());
    return value > 0.0 ? value : 0.25;
  }
  double between(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(engine_);
  }
  // One that exists, so that readers take it: the orders of magnitude are equally likely.
  double some(const Quantity& quantity) {
    if (quantity.least <= 0.0) return between(quantity.least, quantity.most);
    return std::clamp(quantity.least * std::pow(quantity.most / quantity.least, between(0.0, 1.0)),
                      quantity.least, quantity.most);
  }
  Vec3 point() { return {number(), number(), number()}; }
  Vec3 direction() { return {number(), 1.5, number()}; }
  int count() { return 1 + up_to(coin() ? 5 : std::numeric_limits<int>::max() - 1); }

  std::string text() {
    static const std::vector<std::string> parts = {"warp", "Größe",  " ",   "#no comment", "a,b",
                                                   "end",  "\t tab", "2/2", "絹",          "x.y-z",
                                                   "",     "nan",    "'q'", "-1.5",        "\\"};
    std::string text;
    for (int i = up_to(3); i >= 0; --i) text += parts[static_cast<std::size_t>(up_to(14))];
    return text;
  }
  std::string new_name() {
    const std::string number = std::to_string(++names_);
    return coin() ? "n" + number : text() + number;
  }
  const std::string& one_of(const std::vector<std::string>& list) {
    return list[static_cast<std::size_t>(up_to(static_cast<int>(list.size()) - 1))];
  }

  // --- threads and materials
  // ----------------------------------------------------------------------------------------
  Material material() {
    Material material;
    material.name = new_name();
    materials_.push_back(material.name);
    maybe(material.density, [&] { return some(density_quantity); });
    maybe(material.packing, [&] { return 1.0 - between(0.0, 0.99); });
    const int law = up_to(2);
    if (law == 1) material.elastic = IsotropicElastic{some(modulus_quantity), between(-0.99, 0.499)};
    if (law == 2) {
      const double e2 = between(1.0, 10.0);
      material.elastic = TransverseElastic{e2 * between(1.0, 20.0), e2, between(-0.3, 0.3),
                                           some(modulus_quantity), between(-0.5, 0.5)};
    }
    const auto strength = [&] { return some(strength_quantity); };
    const int strengths = up_to(2);
    if (strengths == 1) {
      IsotropicStrength same = {strength(), strength(), {}};
      maybe(same.shear, strength);
      material.strength = same;
    }
    if (strengths == 2) {
      TransverseStrength two = {strength(), strength(), {}};
      maybe(two.across, [&] {
        return TransverseStrength::Across{strength(), strength(), strength(), strength()};
      });
      material.strength = two;
    }
    if (coin()) material.expansion = Expansion{some(expansion_quantity), some(expansion_quantity)};
    const auto transport = [&](const Quantity& quantity) {
      const double along = some(quantity);
      return Transport{along, coin() ? along : some(quantity)};
    };
    maybe(material.conductivity, [&] { return transport(conductivity_quantity); });
    maybe(material.diffusivity, [&] { return transport(diffusivity_quantity); });
    maybe(material.permittivity, [&] { return transport(permittivity_quantity); });
    maybe(material.interface, [&] {
      const auto pair = [&](const Quantity& quantity) {
        return Interface::Pair{some(quantity), some(quantity)};
      };
      Interface interface;
      maybe(interface.stiffness, [&] { return pair(interface_stiffness_quantity); });
      if (coin()) {
        interface.strength = pair(interface_strength_quantity);
        interface.energy = pair(interface_energy_quantity);
      }
      return interface;
    });
    return material;
  }
  yarn::Section section() {
    switch (up_to(6)) {
      case 0:
        return yarn::Circle{coin() ? positive() : 0.0};
      case 1:
        return yarn::Ellipse{positive(), positive()};
      case 2:
        return yarn::Lenticular{positive(), positive()};
      case 3:
        return yarn::Racetrack{positive(), positive()};
      case 4:
        return yarn::Power{positive(), positive(), positive()};
      case 5:
        return yarn::Loop7{coin() ? positive() : 0.0};
      default:
        break;
    }
    yarn::Polygon polygon;
    const int corners = 3 + up_to(6);
    for (int i = 0; i < corners; ++i) {
      const double angle = 6.283185307179586 * i / corners;
      polygon.corners.emplace_back(between(0.5, 1.0) * std::cos(angle), std::sin(angle));
    }
    return polygon;
  }
  void fill(Thread& thread) {
    if (coin()) thread.linear_density = {between(1e-3, 1e3), static_cast<LinearDensity::Measure>(up_to(4))};
    maybe(thread.density, [&] { return some(density_quantity); });
    maybe(thread.packing, [&] { return 1.0 - between(0.0, 0.99); });
    maybe(thread.diameter, [&] { return positive(); });
    maybe(thread.section, [&] { return section(); });
    maybe(thread.twist, [&] { return Twist{some(twist_quantity), coin() ? Hand::z : Hand::s, coin()}; });
    maybe(thread.plies, [&] { return Plies{count(), some(twist_quantity), coin() ? Hand::z : Hand::s}; });
    maybe(thread.filaments, [&] { return count(); });
    maybe(thread.color, [&] { return Color{up_to(255), up_to(255), up_to(255)}; });
    if (!materials_.empty()) maybe(thread.material, [&] { return one_of(materials_); });
  }
  Thread thread() {
    Thread thread;
    thread.name = new_name();
    threads_.push_back(thread.name);
    fill(thread);
    return thread;
  }

  // --- yarns
  // --------------------------------------------------------------------------------------------------------
  Path path() {
    Path path;
    path.form = static_cast<yarn::PathForm>(up_to(6));
    const int rows = 3 + up_to(20);
    if (path.form == yarn::PathForm::smooth) path.error = positive();
    if (path.form == yarn::PathForm::control && rows >= 4 && coin()) path.knots = knots(rows, 3);
    const bool sized = coin();
    for (int i = 0; i < rows; ++i) {
      path.points.push_back(point());
      path.points.back().x() = i;  // no two equal
      if (!sized) continue;
      auto& size = path.sizes.emplace_back();
      if (i > 0 && coin()) continue;
      size = SizeAt{positive(), positive(), std::nullopt};
      maybe(size->angle, [&] { return number(); });
    }
    if (coin())
      for (int i = 0; i < rows; ++i) path.fixed.push_back(i == 1 || coin());
    if (!outlines_.empty() && coin())
      for (int i = 0; i < rows; ++i) {
        std::optional<OutlineAt>& at = path.outlines.emplace_back();
        if (i != 1 && coin()) continue;
        at.emplace().from = one_of(outlines_);
        if (coin()) {
          at->to = one_of(outlines_);
          at->share = between(0.0, 1.0);
        }
        if (coin()) at->weight = positive();
      }
    return path;
  }
  PointsFile points_file() {
    PointsFile points;
    points.file = "folder name/" + new_name();
    if (coin()) points.yarn = new_name();
    maybe(points.error, [&] { return positive(); });
    return points;
  }
  Helix helix() { return {{}, positive(), positive(), positive(), coin(), coin() ? number() : 0.0}; }
  Outline outline() {
    Outline outline;
    outline.name = new_name();
    outlines_.push_back(outline.name);
    outline.points = {Vec2(1.0, number()), Vec2(0.0, 1.0), Vec2(-1.0, 0.0)};
    outline.points[0].y() = between(-0.5, 0.5);
    return outline;
  }
  std::vector<double> knots(int count, int degree) {
    std::vector<double> knots;
    double value = -between(0.0, 5.0);
    for (int i = 0; i < count + degree + 1; ++i) {
      if (i > degree && i <= count) value += between(0.1, 2.0);
      knots.push_back(value);
    }
    return knots;
  }
  Grid grid() {
    Grid grid;
    grid.sections = 2 + up_to(6);
    grid.open_round = coin();
    grid.per_section = (grid.open_round ? 4 : 3) + up_to(12);
    grid.closed_along = coin() && grid.sections > 2;
    maybe(grid.degree_along, [&] { return 1 + up_to(grid.sections - 2); });
    maybe(grid.degree_round, [&] { return 1 + up_to(1); });
    if (coin())
      grid.knots_along = knots(grid.sections, grid.degree_along.value_or(std::min(3, grid.sections - 1)));
    if (coin() && grid.open_round) grid.knots_round = knots(grid.per_section, grid.degree_round.value_or(2));
    const bool weighted = coin();
    for (int s = 0; s < grid.sections; ++s)
      for (int i = 0; i < grid.per_section; ++i) {
        const bool seam = grid.open_round && i + 1 == grid.per_section;
        const std::size_t first = grid.points.size() - static_cast<std::size_t>(i);
        if (seam) {
          grid.points.push_back(Vec3(grid.points[first]));
          if (weighted) grid.weights.push_back(double(grid.weights[first]));
          continue;
        }
        grid.points.emplace_back(i, number(), s);
        if (weighted) grid.weights.push_back(coin() ? 1.0 : positive());
      }
    return grid;
  }
  Yarn yarn() {
    Yarn yarn;
    yarn.name = new_name();
    yarns_.push_back(yarn.name);
    if (coin()) yarn.thread = one_of(threads_);
    fill(yarn.own);
    maybe(yarn.role, [&] { return static_cast<Role>(up_to(7)); });
    for (auto* tangent : {&yarn.tangent_start, &yarn.tangent_end})
      maybe(*tangent, [&] { return yarn::EndTangent(direction(), coin()); });
    maybe(yarn.up, [&] { return direction(); });
    yarn.closed = coin();
    if (coin())
      yarn.shape = path();
    else if (coin())
      yarn.shape = grid();
    else if (coin())
      yarn.shape = points_file();
    else
      yarn.shape = helix();
    if (std::holds_alternative<Helix>(yarn.shape)) yarn.closed = false;
    const auto* path = std::get_if<Path>(&yarn.shape);
    if (path != nullptr && !path->knots.empty()) yarn.closed = false;
    return yarn;
  }

  // --- constructions
  // ------------------------------------------------------------------------------------------------
  WeaveSystem system() {
    WeaveSystem system;
    for (int i = up_to(2); i >= 0; --i) system.threads.push_back(one_of(threads_));
    system.count = count();
    system.pitch = positive();
    return system;
  }
  Draft draft() {
    Draft draft;
    do draft.form = static_cast<Draft::Form>(up_to(8));
    while (draft.has_pile());
    if (draft.form == Draft::Form::rows) {
      const int width = 1 + up_to(7);
      for (int i = up_to(6); i >= 0; --i) {
        std::string& row = draft.rows.emplace_back();
        for (int k = 0; k < width; ++k) row += coin() ? '1' : '0';
      }
    } else if (draft.form == Draft::Form::satin) {
      const int ends = 5 + up_to(1) * 3;
      draft.a = ends;
      draft.b = ends == 5 ? 2 + up_to(1) : 3 + 2 * up_to(1);
      if (coin()) draft.b = 0;
      draft.warp_faced = coin();
    } else if (draft.form == Draft::Form::file) {
      draft.file = coin() ? "drafts/a b.wif" : "twill.wif";
    } else if (draft.form == Draft::Form::leno) {
      draft.full_turns = coin();
    } else if (draft.form != Draft::Form::plain) {
      draft.a = count();
      draft.b = count();
      if (draft.form == Draft::Form::twill) {
        draft.hand = coin() ? Hand::z : Hand::s;
        for (int i = 2 * up_to(2); i > 0; --i) draft.further.push_back(count());
      }
    }
    return draft;
  }
  // With a thread of its own, which nothing else knows, and perhaps others in turn.
  NamedBlock block() {
    NamedBlock block;
    block.name = new_name();
    block.fabric = std::make_shared<Fabric>();
    Fabric& fabric = *block.fabric;
    const auto threads = threads_, materials = materials_, outlines = outlines_, blocks = blocks_;
    const auto yarns = std::exchange(yarns_, {});
    maybe(fabric.tolerance, [&] { return positive(); });
    if (coin()) fabric.materials.push_back(material());
    if (coin()) fabric.outlines.push_back(outline());
    fabric.threads.push_back(thread());
    if (up_to(4) == 0) fabric.blocks.push_back(this->block());
    while (fabric.items.size() < 2)
      if (Item one = item(); !std::holds_alternative<Piece>(one)) fabric.items.push_back(std::move(one));
    if (!yarns_.empty() && coin()) fabric.edits.push_back(edit());
    threads_ = threads;
    materials_ = materials;
    outlines_ = outlines;
    blocks_ = blocks;
    yarns_ = yarns;
    blocks_.push_back(block.name);
    return block;
  }
  Use use() {
    Use use;
    use.is_file = blocks_.empty() || up_to(3) == 0;
    use.what = !use.is_file ? one_of(blocks_) : coin() ? "layers/a b.txt" : "twill.wif";
    if (coin()) use.as = new_name();
    if (coin()) use.repeats = {1 + up_to(3), 1 + up_to(3)};
    if (coin()) use.steps = {positive(), positive()};
    for (int i = up_to(4); i > 0; --i) {
      Move& move = use.moves.emplace_back();
      move.form = static_cast<Move::Form>(up_to(3));
      if (move.form == Move::Form::place) {
        move.by = point();
        continue;
      }
      move.axis = up_to(2);
      if (move.form == Move::Form::shear) move.across = (move.axis + 1 + up_to(1)) % 3;
      if (move.form == Move::Form::rotate) move.angle = number();
      if (move.form == Move::Form::shear) move.angle = between(-80.0, 80.0);
    }
    return use;
  }
  Item item() {
    switch (up_to(9)) {
      case 0: {
        Weave weave;
        weave.warp = system();
        weave.weft = system();
        maybe(weave.profile, [&] { return static_cast<Weave::Profile>(up_to(4)); });
        maybe(weave.layers, [&] { return count(); });
        if (weave.profile == Weave::Profile::sine) maybe(weave.amplitude, [&] { return positive(); });
        if (weave.profile == Weave::Profile::straight) {
          weave.draft = {};
          for (int i = up_to(2); i > 0; --i) {
            Binder& binder = weave.binders.emplace_back();
            binder.thread = one_of(threads_);
            binder.every = count();
            binder.first = count();
            for (int k = up_to(4); k >= 0; --k) binder.levels.push_back(up_to(5));
          }
        } else if (!weave.profile && coin()) {
          for (int c = up_to(2); c >= 0; --c) {
            WarpColumn& column = weave.columns.emplace_back();
            for (int k = up_to(2); k >= 0; --k)
              column.push_back(
                  {coin() ? one_of(threads_) : "", {}, {k > 0 ? 0 : weave.layers.value_or(1), 1}});
            std::ranges::sort(column, {}, &StackedWarp::levels);
          }
        } else if (!weave.profile && !weave.layers && coin()) {
          maybe(weave.crimp, [&] { return up_to(8) / 8.0; });
          maybe(weave.state, [&] { return static_cast<Weave::State>(up_to(2)); });
          if (coin()) {
            weave.pile = WarpPile{{},
                                  positive(),
                                  coin() ? one_of(threads_) : "",
                                  3 + up_to(6),
                                  static_cast<WarpPile::Side>(up_to(2)),
                                  coin()};
          } else {
            weave.draft.form = coin() ? Draft::Form::corduroy : Draft::Form::velveteen;
            weave.draft.a = 4 + 2 * up_to(4);
            weave.weft.threads = {threads_.front(), threads_.back()};
            if (threads_.front() == threads_.back()) weave.draft = {};
          }
        } else if (!weave.profile && coin()) {
          weave.draft.form = Draft::Form::plain;
          if (coin())
            weave.fraction = (1 + up_to(8)) / 10.0;
          else
            weave.pressure = positive();
        } else {
          weave.draft = draft();
          maybe(weave.crimp, [&] { return up_to(8) / 8.0; });
          maybe(weave.spacing, [&] { return static_cast<Weave::Spacing>(up_to(1)); });
          if (!weave.profile) maybe(weave.thickness, [&] { return (1 + up_to(8)) / 8.0; });
          if (!weave.layers)
            maybe(weave.pucker, [&] { return Pucker{{}, count(), count(), 1.25, 1 + count()}; });
          if (!weave.profile && !weave.pucker && weave.draft.form != Draft::Form::leno)
            maybe(weave.state, [&] { return static_cast<Weave::State>(up_to(2)); });
          if (weave.draft.form == Draft::Form::leno) {
            Weave leno;
            leno.warp = weave.warp;
            leno.weft = weave.weft;
            leno.draft = weave.draft;
            leno.warp.count = 2 * (1 + up_to(100));
            return leno;
          }
        }
        return weave;
      }
      case 1: {
        Knit knit;
        knit.form = static_cast<Knit::Form>(up_to(static_cast<int>(Knit::Form::chart)));
        if (knit.form == Knit::Form::rib) {
          knit.rib_a = count();
          knit.rib_b = count();
        }
        for (int i = up_to(2); i >= 0; --i) knit.threads.push_back(one_of(threads_));
        if (up_to(1) == 0) knit.course_pitch = positive();
        if (up_to(1) == 0) knit.wale_pitch = positive();
        maybe(knit.loop, [&] { return positive(); });
        knit.courses = count();
        knit.wales = count();
        const bool has_own = !knit.loop && up_to(3) == 0;
        if (has_own) knit.own_loops.push_back(own_loop("KPTUM"[up_to(4)]));
        if (!has_own && knit.form == Knit::Form::jersey)
          maybe(knit.shape, [&] { return static_cast<Knit::Shape>(up_to(1)); });
        if (!has_own && knit.course_pitch == 0 && knit.wale_pitch == 0)
          maybe(knit.unit, [&] { return positive(); });
        maybe(knit.crossing, [&] { return Vec3(positive(), -positive(), positive()); });
        if (knit.shape != Knit::Shape::relaxed)
          maybe(knit.method, [&] { return static_cast<nurbs::Parameterization>(up_to(2)); });
        if (knit.form == Knit::Form::jersey && !has_own && !knit.shape && up_to(1) == 0) {
          knit.plating = one_of(threads_);
          maybe(knit.pile, [&] { return positive(); });
          knit.pile_is_cut = knit.pile && up_to(1) == 0;
        }
        const bool is_jacquard = knit.form == Knit::Form::jacquard;
        if (knit.form == Knit::Form::chart) maybe(knit.feeds, [&] { return count(); });
        if (knit.form == Knit::Form::chart || knit.form == Knit::Form::interlock)
          maybe(knit.gating, [&] { return static_cast<Knit::Gating>(up_to(1)); });
        if (knit.gating == Knit::Gating::opposite) maybe(knit.bed_distance, [&] { return positive(); });
        if (knit.form == Knit::Form::chart || is_jacquard) {
          const int rows = 1 + up_to(3), wales = 1 + up_to(4);
          for (int i = 0; i < rows; ++i) {
            std::string& row = knit.chart.emplace_back();
            for (int j = 0; j < wales; ++j) row += is_jacquard ? "123456"[up_to(5)] : "KPTUM."[up_to(5)];
          }
          for (int i = is_jacquard ? 0 : up_to(3); i > 0; --i) {
            const bool is_dropped = coin();
            knit.moves.push_back({{}, count(), count(), is_dropped ? 0 : up_to(8) - 4, is_dropped});
          }
        }
        return knit;
      }
      case 2:
        return warpknit();
      case 3: {
        Braid braid;
        braid.thread = one_of(threads_);
        braid.flat = coin();
        braid.planar = !braid.flat && coin();
        braid.carriers = braid.flat ? 2 + up_to(100) : 2 * (1 + up_to(100));
        braid.over = count();
        braid.under = count();
        const bool has_mandrel = !braid.flat && !braid.planar && coin();
        for (int i = 0; has_mandrel && i < 2 + up_to(3); ++i)
          braid.mandrel.push_back({Vec3(number(), number(), i), positive()});
        if (!braid.flat && !braid.planar && !has_mandrel) braid.radius = positive();
        if ((braid.flat || braid.planar) && coin()) braid.width = positive();
        braid.angle = between(1.0, 89.0);
        if (!has_mandrel) braid.length = positive();
        if (coin()) {
          braid.axial_thread = one_of(threads_);
          braid.axial_count = count();
        }
        return braid;
      }
      case 4:
        return piece();
      case 5:
        return use();
      default:
        return yarn();
    }
  }
  OwnLoop own_loop(char sign) {
    OwnLoop loop;
    loop.sign = sign;
    for (int i = 4 + up_to(5); i >= 0; --i) loop.points.emplace_back(positive(), -positive(), i);
    return loop;
  }
  Warpknit warpknit() {
    static const std::vector<std::string> lappings = {"1-0/1-2", "2-3/1-0//", "1-0/1-2/2-3/2-1", "1-0 1-2",
                                                      "10-0 / 0-0"};
    Warpknit warpknit;
    if (coin()) {
      warpknit
          .classic = std::vector<std::string>{"tricot", "satin",  "queens-cord", "locknit",
                                              "atlas",  "velvet", "cord"}[static_cast<std::size_t>(up_to(6))];
      warpknit.thread = one_of(threads_);
    } else {
      for (int i = up_to(3); i >= 0; --i) {
        WarpknitBar& bar = warpknit.bars.emplace_back();
        bar.thread = one_of(threads_);
        bar.lapping = one_of(lappings);
        bar.fall_plate = coin();
        maybe(bar.own_loop, [&] { return own_loop('K'); });
      }
    }
    maybe(warpknit.weft, [&] {
      WarpknitWeft weft;
      for (int i = up_to(2); i >= 0; --i) weft.threads.push_back(one_of(threads_));
      weft.every = count();
      weft.first = count();
      return weft;
    });
    warpknit.wales = count();
    warpknit.courses = count();
    warpknit.wale_pitch = positive();
    warpknit.course_pitch = positive();
    maybe(warpknit.stitch, [&] { return static_cast<Warpknit::Stitch>(up_to(1)); });
    maybe(warpknit.substrate, [&] { return positive(); });
    return warpknit;
  }
  Edit curve_edit() {
    Edit edit;
    edit.yarn = new_name();
    edit.form = static_cast<Edit::Form>(up_to(2));
    edit.joint = 1 + up_to(9);
    const Vec3 vector(number(), 1.0, 0.0);
    if (edit.form != Edit::Form::length) {
      edit.target = vector;
      return edit;
    }
    edit.direction = vector;
    if (coin())
      edit.like = LengthOf{new_name(), {new_name(), new_name()}, coin() ? number() : 0.0};
    else
      edit.length = positive();
    return edit;
  }

  Piece piece() {
    Piece piece;
    piece.name = new_name();
    for (int i = up_to(3); i >= 0; --i) {
      PieceCurve& curve = piece.curves.emplace_back();
      curve.name = new_name();
      curve.is_line = coin();
      if (curve.is_line) {
        for (int k = 0; k < 2; ++k) curve.points.emplace_back(number(), k);
        continue;
      }
      using Shape = PieceCurve::Shape;
      curve.shape = static_cast<Shape>(up_to(4));
      const bool is_spline = curve.shape == Shape::control || curve.shape == Shape::spline;
      if (!is_spline && coin()) curve.by = static_cast<nurbs::PointParameters>(up_to(2));
      if (curve.shape == Shape::spline && coin())
        curve.method = static_cast<nurbs::Parameterization>(up_to(2));
      const int points = 4 + up_to(5);
      for (int k = 0; k < points; ++k) curve.points.emplace_back(number(), k);
      if (is_spline && coin())
        for (int k = 0; k < points; ++k) curve.weights.push_back(positive());
      if (curve.shape != Shape::control || coin()) continue;
      curve.knots.assign(4, 0.0);
      for (int k = 4; k < points; ++k) curve.knots.push_back((k - 3.0) / (points - 3.0));
      curve.knots.insert(curve.knots.end(), 4, 1.0);
    }
    for (int i = up_to(2); i > 0; --i) piece.edits.push_back(curve_edit());
    return piece;
  }

  Edit edit() {
    Edit edit;
    edit.yarn = one_of(yarns_);
    edit.form = static_cast<Edit::Form>(up_to(2));
    edit.joint = count();
    if (edit.form == Edit::Form::length) {
      edit.length = positive();
      edit.direction = direction();
    } else {
      edit.target = point();
    }
    return edit;
  }
  Cell cell() {
    Cell cell;
    if (coin()) {
      cell.of_repeats.emplace().counts = {1 + up_to(4), 1 + up_to(4)};
      maybe(cell.of_repeats->margin, [&] { return positive(); });
    } else if (coin()) {
      fabric::CellVectors& vectors = cell.of_vectors.emplace();
      const double along = between(0.5, 20.0), up = between(0.5, 20.0);
      vectors.first = {along, along * between(-0.2, 0.2), 0.0};
      vectors.second = {up * between(-2.0, 2.0), up, 0.0};
      maybe(vectors.height, [&] { return positive(); });
      maybe(vectors.at, [&] { return point(); });
      if (!vectors.height) maybe(vectors.margin, [&] { return positive(); });
    } else {
      corners(cell);
    }
    if (!materials_.empty() && coin()) cell.matrix = one_of(materials_);
    cell.periodic[0] = coin();
    cell.periodic[1] = coin();
    cell.periodic[2] = coin();
    return cell;
  }
  void corners(Cell& cell) {
    cell.low = {between(-5.0, 0.0), between(-5.0, 0.0), between(-5.0, 0.0)};
    cell.high = {positive(), positive(), positive()};
  }

  std::mt19937_64 engine_;
  int names_ = 0;
  std::vector<std::string> threads_, materials_, outlines_, yarns_, blocks_;
};

}  // namespace

Fabric random_fabric(std::uint64_t seed) {
  return Maker(seed).make();
}

}  // namespace selvage::test
