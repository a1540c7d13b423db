// The energy of a woven cloth and what its yarns leave each other free, as a problem with inequalities. All
// lengths are ratios to the square root of the yarns' mean fibre area, all energies to the tension of a
// finished cloth times that area.
//
// A centre line is a cubic B-spline over eight spans from crossing to crossing, a section an ellipse that is
// given at crossings and half way between them, with smooth steps from one to the next. Crossings of a class
// (partition.h) have the same unknowns; terms are written once for crossings with neighbours of the same
// classes.
#pragma once

#include <array>
#include <optional>
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
  std::vector<WovenYarn> warps, wefts;
  std::vector<double> warp_gaps, weft_gaps;  // from warp k to the next one; from weft k to the next one
  std::vector<char> warp_on_top;             // picks x ends: 1, or 0
  double warp_tension = 1, weft_tension = 1;
  double clearance = 0;              // between yarns
  std::optional<double> thickness;   // between plates, at most
  std::optional<double> warp_share;  // of the waves of both systems, 0 .. 1
  WovenConstants constants;
  [[nodiscard]] int ends() const { return static_cast<int>(warps.size()); }
  [[nodiscard]] int picks() const { return static_cast<int>(wefts.size()); }
};

struct WovenEnergy {
  double bending = 0, tension = 0, flattening = 0, compaction = 0;  // per crossing
  [[nodiscard]] double sum() const { return bending + tension + flattening + compaction; }
};

class WovenProblem final : public BarrierProblem {
 public:
  // `scaled`: lengths already in ratios.
  WovenProblem(const WovenCloth& scaled, int max_classes);

  // Unknowns of a start: sections at rest, centre lines whose crimp heights at a crossing sum to the
  // thickness of both yarns there; warp_share: fraction of it that the warp takes.
  [[nodiscard]] Eigen::VectorXd start(double warp_share) const;
  // Which inequalities take part: all that are not far from touching. True: one has entered that is violated
  // by more than `tolerance`, or one that no longer holds has left. Multipliers and slacks follow.
  bool update(Minimum& at, double tolerance);
  // Which take part; empty: as in the beginning.
  [[nodiscard]] const std::vector<char>& active() const { return is_active_; }
  void set_active(std::vector<char> active) { is_active_ = std::move(active); }

  [[nodiscard]] Eigen::Index num_unknowns() const override { return num_unknowns_; }
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
  [[nodiscard]] const Partition& classes() const { return classes_; }
  // Places of unknowns. `knot`: from the crossing, spans_a_gap a gap. `half`: 2 a gap.
  [[nodiscard]] int height(WovenSystem system, int pick, int end, int knot) const;
  [[nodiscard]] int width_at(WovenSystem system, int pick, int end,
                             int half) const;  // half; the next: half the height

 private:
  struct Point {  // of a centre line, with what its section is there
    Form z, slope, curvature, half_width, half_height;
  };
  struct PathTerm {
    std::array<Form, 2> forms;  // slope, second derivative
    double bending = 0, tension = 0, length = 0;
    WovenSystem system = WovenSystem::warp;
  };
  struct SectionTerm {
    std::array<Form, 2> forms;  // half width, half height
    double flattening = 0, compaction = 0, log_aspect = 0, packing = 0, fibre_area = 0;
  };
  struct SquareTerm {
    Form form;
    double factor = 0;
  };
  struct Contact {
    std::array<Form, 8> forms;  // z, slope, half width, half height of the warp; of the weft
    double side = 1, along_warp = 0, along_weft = 0, clearance = 0;
    std::size_t warp_run = 0, weft_run = 0;  // places of its stations in runs_
    int warp_place = 0, weft_place = 0;
  };
  struct Beside {
    std::array<Form, 8> forms;  // z, slope, half width, half height of both
    double spacing = 0, clearance = 0;
  };
  struct Fold {
    std::array<Form, 3> forms;  // slope, second derivative, half height
    double side = 1;
  };
  struct Packed {
    std::array<Form, 2> forms;
    double least_product = 0;  // of the half sizes
  };
  struct Linear {
    std::array<Form, 1> forms;
  };
  // Slopes of a yarn at the places of a half gap, away from the crossing, positive towards the other side.
  struct Run {
    std::vector<Form> slopes;
    double sign = 1;
  };
  struct Crossing {
    int pick, end;
  };

  [[nodiscard]] WovenEnergy weighted_energy(const Eigen::VectorXd& x) const;
  void add_terms(Crossing at, double share);
  void add_yarn(WovenSystem system, Crossing at, double share);
  void add_contacts(Crossing at);
  std::size_t add_run(WovenSystem system, Crossing at, int direction, double sign);
  void add_beside(WovenSystem system, Crossing at);
  [[nodiscard]] Point point(WovenSystem system, Crossing at, double gaps) const;
  [[nodiscard]] double gap(WovenSystem system, Crossing at, int from) const;  // along the yarn
  [[nodiscard]] const WovenYarn& yarn(WovenSystem system, Crossing at) const;
  [[nodiscard]] double tension(WovenSystem system) const {
    return system == WovenSystem::warp ? cloth_.warp_tension : cloth_.weft_tension;
  }
  [[nodiscard]] static Crossing along(WovenSystem system, Crossing at, int by) {
    return system == WovenSystem::warp ? Crossing{at.pick + by, at.end} : Crossing{at.pick, at.end + by};
  }
  [[nodiscard]] bool warp_on_top(Crossing at) const;
  [[nodiscard]] int block(int pick, int end) const;
  [[nodiscard]] int reach_of(const Run& run, const Eigen::VectorXd& x) const;
  template <class Use>
  void for_active(const Use& use) const;
  template <class Use>
  void for_candidates(const Use& use) const;

  WovenCloth cloth_;
  Partition classes_;
  Eigen::Index num_unknowns_ = 0;
  std::vector<PathTerm> paths_;
  std::vector<SectionTerm> sections_;
  std::vector<SquareTerm> changes_, holds_;
  std::vector<Contact> contacts_;
  std::vector<Beside> besides_;
  std::vector<Fold> folds_;
  std::vector<Packed> packed_;
  std::vector<Linear> linears_;
  std::vector<Run> runs_;
  std::vector<char> is_active_;  // of each candidate, in the order of for_candidates
};

}  // namespace selvage::mechanics
