// The energy of a woven cloth and what its yarns leave each other free, as a problem with inequalities. All
// lengths are ratios to the square root of the yarns' mean fibre area, all energies to the tension of a
// finished cloth times that area.
//
// A centre line is a cubic B-spline over eight spans from crossing to crossing, a section an ellipse that is
// given at crossings and half way between them, with smooth steps from one to the next. Two plates press on
// the cloth. A crossing is that of
// a row of wefts and a column of warps, one of each or several above each other. Crossings of a class
// (partition.h) have the same unknowns and terms. Every term is a function of what yarns are at one station
// or at two.
#pragma once

#include <array>
#include <optional>
#include <utility>
#include <vector>

#include "mechanics/constants.h"
#include "mechanics/interior_point.h"
#include "mechanics/partition.h"

namespace selvage::mechanics {

inline constexpr int spans_a_gap = 8;

struct WovenYarn {
  double fibre_area = 0;
  double packing = 0.737;       // at rest: fibre area over the area of the section
  double max_packing = 0.9069;  // as close as fibres go
  double aspect = 1;            // width over height of its section by itself
  double stiffness = 1;         // against flattening, of a yarn of the reference twist factor
  bool operator==(const WovenYarn&) const = default;
};

enum class WovenSystem { warp, weft };

// A repeat; all lengths in one unit.
struct WovenCloth {
  // Column by column, and row by row; the yarns of one from the lowest, which keep their order.
  std::vector<WovenYarn> warps, wefts;
  std::vector<int> first_warps;  // of each column, and the number of all warps; empty: one in each column
  int wefts_a_row = 1;
  std::vector<double> warp_gaps, weft_gaps;  // from column k to the next one; from row k to the next one
  std::vector<char> warp_on_top;             // wefts x warps: 1, or 0
  double warp_tension = 1, weft_tension = 1;
  double clearance = 0;              // between yarns
  std::optional<double> pressure;    // of the plates, as constants.pressure, which it is where none is said
  std::optional<double> thickness;   // between the plates, at most
  std::optional<double> warp_share;  // of the waves of both systems, 0 .. 1; of one yarn a row and column
  WovenConstants constants;
  [[nodiscard]] int ends() const { return static_cast<int>(warps.size()); }
  [[nodiscard]] int picks() const { return static_cast<int>(wefts.size()); }
  [[nodiscard]] int columns() const { return static_cast<int>(warp_gaps.size()); }
  [[nodiscard]] int rows() const { return static_cast<int>(weft_gaps.size()); }
  [[nodiscard]] int first_warp(int column) const {
    return first_warps.empty() ? column : first_warps[static_cast<std::size_t>(column)];
  }
  bool operator==(const WovenCloth&) const = default;
};

struct WovenEnergy {
  double bending = 0, tension = 0, flattening = 0, compaction = 0;  // per crossing
  [[nodiscard]] double sum() const { return bending + tension + flattening + compaction; }
};

// Of fibres in a yarn, over both systems.
double mean_area(const WovenCloth& cloth);

// Of the crossings of the repeat.
Partition classes_of(const WovenCloth& cloth, int max_classes);

class WovenProblem final : public BarrierProblem {
 public:
  // `scaled`: lengths already in ratios. `classes`: of classes_of, exact.
  WovenProblem(const WovenCloth& scaled, Partition classes);

  // Unknowns of a start: sections at rest, centre lines whose crimp heights at a crossing sum to the
  // thickness of both yarns there; warp_share: fraction of it that the warp takes.
  [[nodiscard]] Eigen::VectorXd start(double warp_share) const;
  // Everything `by` times as high, and half of that made up for by width.
  [[nodiscard]] Eigen::VectorXd flattened(Eigen::VectorXd x, double by) const;
  // Of the plates; `at`: a minimum of the inequalities that take part.
  [[nodiscard]] double pressure(const Minimum& at) const;
  // Distance of plates that touch the cloth.
  [[nodiscard]] double thickness(const Eigen::VectorXd& x) const;
  // Which inequalities take part: all that are not far from touching. True: one has entered that is violated
  // by more than `tolerance`, or one that no longer holds has left. Multipliers and slacks follow.
  bool update(Minimum& at, double tolerance);
  // Which take part; empty: as in the beginning.
  [[nodiscard]] const std::vector<char>& active() const { return is_active_; }
  void set_active(std::vector<char> active);

  [[nodiscard]] Eigen::Index num_unknowns() const override { return num_unknowns_; }
  [[nodiscard]] Eigen::SparseMatrix<double> places() const override { return places_; }
  double evaluate(const Eigen::VectorXd& x, Eigen::VectorXd& inequalities) const override;
  void differentiate(const Eigen::VectorXd& x, const Eigen::VectorXd& multipliers,
                     const Eigen::VectorXd& weights, Derivatives& made) const override;
  [[nodiscard]] Eigen::VectorXd equality() const override;

  // Per crossing of the repeat, without what only holds loose yarns in place.
  [[nodiscard]] WovenEnergy energy(const Eigen::VectorXd& x) const;
  // (L - p) / p of a system: lengths of all its yarns over those of the cloth, less one.
  [[nodiscard]] double crimp(WovenSystem system, const Eigen::VectorXd& x) const;
  // The deepest violation of any inequality, whether it takes part or not.
  [[nodiscard]] double worst(const Eigen::VectorXd& x) const;
  [[nodiscard]] const WovenCloth& cloth() const { return cloth_; }
  [[nodiscard]] const Partition& classes() const { return classes_; }
  // Places of unknowns of a yarn of the repeat. `knot`: from its first crossing, spans_a_gap a gap. `half`: 2
  // a gap.
  [[nodiscard]] int height(WovenSystem system, int yarn, int knot) const;
  [[nodiscard]] int width_at(WovenSystem system, int yarn,
                             int half) const;  // half; the next: half the height

 private:
  // What a yarn is at a place.
  enum Value { z, slope, curvature, half_width, half_height };
  static constexpr std::size_t num_values = 5;
  using Values = std::array<double, num_values>;
  // The unknowns of a span of a centre line: four heights, half width and half height before and after it.
  static constexpr std::size_t num_of_span = 8, heights_of_span = 4;
  struct Span {
    std::array<int, num_of_span> unknowns{};
    std::array<int, num_of_span*(num_of_span + 1) / 2> places{};  // in places_, lower triangle row by row
  };
  struct SpanPair {
    std::size_t first = 0, second = 0;
    std::array<int, num_of_span * num_of_span> places{};
  };
  struct Station {
    std::size_t span = 0;
    std::array<std::array<double, heights_of_span>, 3> path{};  // z, slope, curvature of the four heights
    double step = 0;                                            // of the sizes, from those before: 0 .. 1
  };
  struct PathTerm {
    std::size_t station = 0;
    double bending = 0, tension = 0, length = 0;
    WovenSystem system = WovenSystem::warp;
  };
  struct SectionTerm {
    std::size_t station = 0;
    double flattening = 0, compaction = 0, log_aspect = 0, packing = 0, fibre_area = 0;
  };
  struct ChangeTerm {                // factor * (difference of the size after the span and before it)^2
    std::size_t span = 0, size = 0;  // size: 0, width; 1, height
    double factor = 0;
  };
  struct HoldTerm {
    std::size_t station = 0;
    double factor = 0;
  };
  struct Packed {
    std::size_t station = 0;
    double least_product = 0;  // of the half sizes
  };
  struct Plate {
    std::size_t first = 0, second = 0, pair = 0;  // of the yarn; of the plates
    double side = 1;
  };
  struct Bound {  // linear
    std::size_t station = 0;
    double constant = 0;
    Values weights{};
  };
  struct Fold {
    std::size_t station = 0;
    double side = 1;
  };
  struct Beside {
    std::size_t first = 0, second = 0, pair = 0;  // stations, and their spans
    double spacing = 0, clearance = 0;
    bool is_level = false;    // neither comes over the other: by their widths alone
    bool is_stacked = false;  // others lie above or below them
  };
  struct Stack {  // one directly above the other along both, over the same place
    std::size_t first = 0, second = 0, pair = 0;  // of the lower one, of the upper one
    double clearance = 0;
  };
  struct Contact {
    std::size_t first = 0, second = 0, pair = 0;  // of the warp, of the weft
    double side = 1, along_warp = 0, along_weft = 0, clearance = 0;
    std::size_t warp_run = 0, weft_run = 0;  // places of its stations in runs_
    int warp_place = 0, weft_place = 0;
  };
  // Stations from a crossing on; slopes count away from it, positive towards the other side.
  struct Run {
    std::vector<std::size_t> stations;
    double sign = 1;
  };
  struct Crossing {
    int pick, end;  // row, column
  };
  // One of a crossing's yarns; layers are numbered from the lowest of each system.
  struct Strand {
    WovenSystem system = WovenSystem::warp;
    int layer = 0;
  };
  // Where a yarn is at a crossing: how many of the other system are below it, and of its own system's yarns
  // between the same two its number from below, and their count.
  struct Rank {
    int below = 0, place = 0, count = 1;
    bool operator==(const Rank&) const = default;
  };
  struct StationSums;
  struct Sums;

  [[nodiscard]] double plates_force() const;  // energy by half their distance
  [[nodiscard]] std::vector<Values> values_at(const Eigen::VectorXd& x) const;
  [[nodiscard]] WovenEnergy weighted_energy(const std::vector<Values>& values,
                                            const Eigen::VectorXd& x) const;
  [[nodiscard]] std::vector<Strand> strands(Crossing at) const;  // warps first
  [[nodiscard]] int count(WovenSystem system, Crossing at) const;
  [[nodiscard]] bool is_stacked(Crossing at) const {
    return count(WovenSystem::warp, at) + count(WovenSystem::weft, at) > 2;
  }
  [[nodiscard]] Rank rank(Strand strand, Crossing at) const;
  [[nodiscard]] std::pair<Strand, Crossing> located(WovenSystem system, int yarn) const;
  [[nodiscard]] int height(Strand strand, Crossing at, int knot) const;
  [[nodiscard]] int width_at(Strand strand, Crossing at, int half) const;
  void add_stations(Strand strand, Crossing at);
  [[nodiscard]] Station station_at(Strand strand, Crossing at, std::size_t span, double in_span) const;
  // `place`: of 2 * spans_a_gap a gap, from the crossing.
  [[nodiscard]] std::size_t station(Strand strand, Crossing at, int place) const;
  [[nodiscard]] std::size_t first_station(Strand strand, Crossing at) const;
  void find_pairs();
  void find_places();  // of the inequalities that take part
  void add_terms(Crossing at, double share);
  void add_yarn(Strand strand, Crossing at, double share);
  void add_plates();
  void add_contacts(Crossing at, int warp_layer, int weft_layer);
  std::size_t add_run(Strand strand, Crossing at, int direction, int places, double sign);
  void add_beside(Strand strand, Crossing at);
  void add_stack(Strand strand, Crossing at);
  [[nodiscard]] double rest_half_height(Strand strand, Crossing at) const;
  [[nodiscard]] std::vector<double> straight_heights(WovenSystem system, Crossing at) const;
  [[nodiscard]] double height_between(WovenSystem straight, Strand strand, Crossing at) const;
  [[nodiscard]] double gap(WovenSystem system, Crossing at, int from) const;  // along the yarn
  [[nodiscard]] const WovenYarn& yarn(Strand strand, Crossing at) const;
  [[nodiscard]] double tension(WovenSystem system) const {
    return system == WovenSystem::warp ? cloth_.warp_tension : cloth_.weft_tension;
  }
  [[nodiscard]] static Crossing along(WovenSystem system, Crossing at, int by) {
    return system == WovenSystem::warp ? Crossing{at.pick + by, at.end} : Crossing{at.pick, at.end + by};
  }
  [[nodiscard]] std::size_t index(Crossing at) const;
  [[nodiscard]] Crossing crossing(int index) const {
    return {index / cloth_.columns(), index % cloth_.columns()};
  }
  [[nodiscard]] static WovenSystem other(WovenSystem system) {
    return system == WovenSystem::warp ? WovenSystem::weft : WovenSystem::warp;
  }
  [[nodiscard]] bool warp_on_top(Crossing at, int warp_layer, int weft_layer) const;
  [[nodiscard]] std::size_t place_of(Strand strand, Crossing at) const;  // among those of the crossing
  [[nodiscard]] int block(Crossing at) const;
  [[nodiscard]] int reach_of(const Run& run, const std::vector<Values>& values) const;
  [[nodiscard]] std::vector<int> reaches(const std::vector<Values>& values) const;
  [[nodiscard]] std::array<double, num_of_span> of_unknowns(const Station& station,
                                                            const Values& first) const;
  void add_station(const Station& station, const StationSums& sums, Derivatives& made) const;
  template <class Use>
  void for_active(const Use& use) const;
  template <class Use>
  void for_candidates(const Use& use) const;
  // Of the candidates.
  [[nodiscard]] std::size_t first_plate() const { return packed_.size() + bounds_.size(); }
  [[nodiscard]] std::size_t first_beside() const { return first_plate() + plates_.size(); }
  [[nodiscard]] std::size_t first_fold() const { return first_beside() + besides_.size(); }
  [[nodiscard]] std::size_t first_stack() const { return first_fold() + folds_.size(); }
  [[nodiscard]] std::size_t first_contact() const { return first_stack() + stacks_.size(); }

  WovenCloth cloth_;
  Partition classes_;
  std::vector<int> first_strands_;  // of each class, and the number of all
  Eigen::Index num_unknowns_ = 0;   // the last one: half the distance of the plates
  double plates_area_ = 0;          // of the crossings of all classes, one each
  std::vector<Span> spans_;
  std::vector<SpanPair> pairs_;
  std::vector<Station> stations_;
  Eigen::SparseMatrix<double> places_;
  std::vector<PathTerm> paths_;
  std::vector<SectionTerm> sections_;
  std::vector<ChangeTerm> changes_;
  std::vector<HoldTerm> holds_;
  std::vector<Packed> packed_;
  std::vector<Bound> bounds_;
  std::vector<Plate> plates_;
  std::vector<Beside> besides_;
  std::vector<Fold> folds_;
  std::vector<Stack> stacks_;
  std::vector<Contact> contacts_;
  std::vector<Run> runs_;
  std::vector<char> is_active_;  // of each candidate, in the order of for_candidates
};

}  // namespace selvage::mechanics
