// The quadratic problem of one step: which small displacement of all yarns costs the least elastic energy and
// ends what stands in the way.
#pragma once

#include <Eigen/Core>
#include <span>
#include <utility>
#include <vector>

#include "contact/strand.h"
#include "contact/ties.h"

namespace selvage::contact {

// How stiff a yarn is, for displacements in units of length. Only ratios count.
struct Stiffness {
  double place = 0.05;   // against moving away from where it was
  double bend = 0.02;    // against bending of the displacement (times spacing^4)
  double stretch = 4.0;  // against a change of length of the centre line
  double shape = 0.05;   // against changes of the section's shape
  double shape_bend = 0.01;
  double contact = 50;     // of what presses two surfaces apart
  double end_turn = 10.0;  // against turning the path out of the normal of an end
};

// J x >= missing: J the difference of two linear forms of the displacement.
struct Demand {
  struct Side {
    std::uint32_t strand = 0;
    int first = 0;  // node of the form's first block
    Form form = Form::Zero();
  };
  Side plus, minus;
  double missing = 0;     // J x has to reach it
  bool is_equal = false;  // J x = missing, from both sides
};

class DisplacementSystem {
 public:
  // Every step starts from the shape that it finds: only lengths are remembered from the beginning.
  DisplacementSystem(std::span<const Strand> strands, Lattices lattices, const Stiffness& stiffness,
                     int modes);

  [[nodiscard]] Eigen::Index size() const { return size_; }
  [[nodiscard]] Eigen::Index offset(std::size_t strand) const { return offsets_[lattices_[strand]]; }
  [[nodiscard]] Eigen::Index length(std::size_t strand) const;
  // Holds the place at the body's parameter v where it is, and its section there as it is.
  void hold(std::size_t strand, double v);

  // Measures the strands' present lengths.
  void update(int threads);
  // The step: coefficients of all strands. `demands` of the present shape.
  Eigen::VectorXd solve(std::span<const Demand> demands, int threads);

 private:
  struct Station {
    Stencil stencil;
    Vec3 along = Vec3::Zero();
    double length = 0;  // of the yarn that it stands for
    double strain = 0;  // present, of the span to the next station
    double old_span = 0;
  };
  // A sum of unknowns that has to stay zero.
  struct Hold {
    std::vector<std::pair<Eigen::Index, double>> parts;  // unknowns with their factors
    double stiffness = 0;
  };
  using Band = Eigen::MatrixXd;  // column j: rows j .. j + width - 1 of the lower triangle
  template <class Work>
  void for_each_strand(int threads, const Work& work) const;
  void apply_energy(const Eigen::VectorXd& x, Eigen::VectorXd& y, int threads) const;
  void gradient(Eigen::VectorXd& g) const;
  void factor(std::span<const Demand> demands, const std::vector<char>& active, int threads);
  void precondition(const Eigen::VectorXd& r, Eigen::VectorXd& z, int threads) const;
  [[nodiscard]] double apply(const Demand& demand, const Eigen::VectorXd& x) const;
  void scatter(const Demand& demand, double value, Eigen::VectorXd& y) const;
  [[nodiscard]] Eigen::Index column(std::size_t strand, int node) const;

  std::span<const Strand> strands_;
  Stiffness stiffness_;
  int modes_;
  std::vector<std::size_t> lattices_;
  std::vector<double> weights_;                    // of each strand's energy
  std::vector<std::vector<std::size_t>> members_;  // strands of each lattice
  std::vector<Eigen::Index> offsets_;              // of each lattice
  Eigen::Index size_ = 0;
  std::vector<std::vector<Station>> stations_;
  std::vector<std::vector<Hold>> held_;
  std::vector<Band> bands_;
};

}  // namespace selvage::contact
