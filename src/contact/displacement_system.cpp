#include "contact/displacement_system.h"

#include <algorithm>
#include <cmath>

#include "core/index.h"
#include "core/parallel.h"
#include "nurbs/basis.h"

namespace selvage::contact {

namespace {

constexpr double hold_stiffness = 1e5;

// Cholesky's factor of a symmetric band matrix, in place; column j holds rows j .. j + width - 1.
void factor_band(Eigen::MatrixXd& band) {
  const Eigen::Index n = band.cols(), width = band.rows();
  for (Eigen::Index j = 0; j < n; ++j) {
    const double pivot = std::sqrt(std::max(band(0, j), 1e-300));
    const Eigen::Index below = std::min(width, n - j);
    band.col(j).head(below) /= pivot;
    for (Eigen::Index k = 1; k < below; ++k) {
      const double factor = band(k, j);
      if (factor != 0.0) band.col(j + k).head(below - k) -= factor * band.col(j).segment(k, below - k);
    }
  }
}

void solve_band(const Eigen::MatrixXd& band, Eigen::Ref<Eigen::VectorXd> x) {
  const Eigen::Index n = band.cols(), width = band.rows();
  for (Eigen::Index j = 0; j < n; ++j) {
    x[j] /= band(0, j);
    const Eigen::Index below = std::min(width, n - j);
    x.segment(j + 1, below - 1) -= x[j] * band.col(j).segment(1, below - 1);
  }
  for (Eigen::Index j = n; j-- > 0;) {
    const Eigen::Index below = std::min(width, n - j);
    x[j] = (x[j] - band.col(j).segment(1, below - 1).dot(x.segment(j + 1, below - 1))) / band(0, j);
  }
}

}  // namespace

DisplacementSystem::DisplacementSystem(std::span<const Strand> strands, Lattices lattices,
                                       const Stiffness& stiffness, int modes)
    : strands_(strands),
      stiffness_(stiffness),
      modes_(modes),
      lattices_(std::move(lattices.of)),
      weights_(std::move(lattices.weights)),
      stations_(strands.size()),
      held_(strands.size()) {
  weights_.resize(strands.size(), 1.0);
  for (std::size_t y = 0; y < strands.size(); ++y) {
    if (lattices_[y] == members_.size()) {
      members_.emplace_back();
      offsets_.push_back(size_);
      size_ += static_cast<Eigen::Index>(strands[y].nodes()) * modes;
    }
    if (weights_[y] == 0.0) continue;
    members_[lattices_[y]].push_back(y);
    const int count =
        2 * std::max(2, static_cast<int>(std::lround(strands[y].length() / strands[y].spacing())));
    for (int i = 0; i < count; ++i) {
      Station station;
      station.length = strands[y].length() / count;
      station.stencil = strands[y].stencil((i + 0.5) * station.length);
      stations_[y].push_back(station);
    }
    if (strands[y].is_cyclic()) continue;
    for (double arc : {0.0, strands[y].length()}) {
      // An end stays in its plane, and its path perpendicular to it.
      const Frame& frame = strands[y].row_frame(arc > 0.0 ? strands[y].rows() - 1 : 0);
      const Stencil end = strands[y].stencil(arc);
      std::array<double, 4> turn = end.slope;
      for (double& t : turn) t *= strands[y].spacing();
      const auto hold_along = [&](const std::array<double, 4>& factors, const Vec3& direction, double stiff) {
        Hold held;
        held.stiffness = weights_[y] * stiff;
        for (int k = 0; k < 4; ++k)
          for (int c = 0; c < 3; ++c)
            held.parts.emplace_back(column(y, end.first + k) + c, factors[at(k)] * direction[c]);
        held_[y].push_back(std::move(held));
      };
      hold_along(end.value, frame.along, hold_stiffness);
      if (strands[y].has_cyclic_lattice()) continue;
      hold_along(turn, frame.x, stiffness.end_turn);
      hold_along(turn, frame.y, stiffness.end_turn);
    }
  }
  update(1);
  for (std::vector<Station>& list : stations_)
    for (Station& station : list) {
      station.old_span = station.strain;  // update() left the present length there
      station.strain = 0.0;
    }
}

Eigen::Index DisplacementSystem::length(std::size_t strand) const {
  return static_cast<Eigen::Index>(strands_[strand].nodes()) * modes_;
}

void DisplacementSystem::hold(std::size_t strand, double v) {
  const Strand& one = strands_[strand];
  const nurbs::Surface& s = one.body().surface;
  const int span = nurbs::find_span(s.knots_v, s.degree_v, s.count_v, v);
  nurbs::BasisRow shares;
  nurbs::basis(s.knots_v, s.degree_v, span, v, shares);
  for (int m = 0; m < modes_; ++m) {
    Hold held;
    held.stiffness = weights_[strand] * hold_stiffness;
    for (int r = 0; r <= s.degree_v; ++r) {
      const Stencil& stencil = one.row_stencil(span - s.degree_v + r);
      for (int k = 0; k < 4; ++k)
        held.parts.emplace_back(column(strand, stencil.first + k) + m, shares[at(r)] * stencil.value[at(k)]);
    }
    held_[strand].push_back(std::move(held));
  }
}

// Strands of one lattice after each other: they write to the same nodes.
template <class Work>
void DisplacementSystem::for_each_strand(int threads, const Work& work) const {
  for_each_index(members_.size(), threads, [&](std::size_t lattice) {
    for (std::size_t s : members_[lattice]) work(s);
  });
}

Eigen::Index DisplacementSystem::column(std::size_t strand, int node) const {
  return offsets_[lattices_[strand]] + static_cast<Eigen::Index>(node % strands_[strand].nodes()) * modes_;
}

// The spans between the ends of the stations' stretches, on the present centre line.
void DisplacementSystem::update(int threads) {
  for_each_index(strands_.size(), threads, [&](std::size_t y) {
    const Strand& strand = strands_[y];
    Vec3 last = strand.frame_at(strand.body().surface.first_v()).centre;
    double arc = 0.0;
    for (Station& station : stations_[y]) {
      arc += station.length;
      const Vec3 next = strand.frame_at(strand.parameter_at(arc)).centre;
      const double span = (next - last).norm();
      station.along = (next - last) / span;
      station.strain = station.old_span > 0.0 ? span / station.old_span - 1.0 : span;
      last = next;
    }
  });
}

void DisplacementSystem::apply_energy(const Eigen::VectorXd& x, Eigen::VectorXd& y, int threads) const {
  for_each_strand(threads, [&](std::size_t s) {
    const double h = strands_[s].spacing();
    for (const Station& station : stations_[s]) {
      const double share = weights_[s] * station.length / h;
      for (int m = 0; m < modes_; ++m) {
        double value = 0.0, bend = 0.0;
        for (int k = 0; k < 4; ++k) {
          const double c = x[column(s, station.stencil.first + k) + m];
          value += station.stencil.value[at(k)] * c;
          bend += station.stencil.bend[at(k)] * c;
        }
        const bool moves = m < translation_modes;
        const double stiff = moves ? 1.0 : field_degree(m - translation_modes);
        value *= share * stiff * (moves ? stiffness_.place : stiffness_.shape);
        bend *= share * stiff * (moves ? stiffness_.bend : stiffness_.shape_bend) * h * h * h * h;
        for (int k = 0; k < 4; ++k)
          y[column(s, station.stencil.first + k) + m] +=
              value * station.stencil.value[at(k)] + bend * station.stencil.bend[at(k)];
      }
      double strain = 0.0;
      for (int k = 0; k < 4; ++k)
        strain += station.stencil.slope[at(k)] *
                  station.along.dot(x.segment<3>(column(s, station.stencil.first + k)));
      strain *= share * stiffness_.stretch * h * h;
      for (int k = 0; k < 4; ++k)
        y.segment<3>(column(s, station.stencil.first + k)) +=
            strain * station.stencil.slope[at(k)] * station.along;
    }
    for (const Hold& held : held_[s]) {
      double value = 0.0;
      for (const auto& [index, share] : held.parts) value += share * x[index];
      for (const auto& [index, share] : held.parts) y[index] += held.stiffness * value * share;
    }
  });
}

// Of the energy at the present shape: centre lines that were stretched pull back.
void DisplacementSystem::gradient(Eigen::VectorXd& g) const {
  g.setZero();
  for (std::size_t s = 0; s < strands_.size(); ++s) {
    const double h = strands_[s].spacing();
    for (const Station& station : stations_[s]) {
      const double pull = weights_[s] * station.strain * (station.length / h) * stiffness_.stretch * h * h;
      for (int k = 0; k < 4; ++k)
        g.segment<3>(column(s, station.stencil.first + k)) +=
            pull * station.stencil.slope[at(k)] * station.along;
    }
  }
}

double DisplacementSystem::apply(const Demand& demand, const Eigen::VectorXd& x) const {
  const auto side = [&](const Demand::Side& one) {
    double sum = 0.0;
    for (int k = 0; k < 4; ++k)
      sum += one.form.segment(Eigen::Index{k} * modes_, modes_)
                 .dot(x.segment(column(one.strand, one.first + k), modes_));
    return sum;
  };
  return side(demand.plus) - side(demand.minus);
}

void DisplacementSystem::scatter(const Demand& demand, double value, Eigen::VectorXd& y) const {
  const auto side = [&](const Demand::Side& one, double factor) {
    for (int k = 0; k < 4; ++k)
      y.segment(column(one.strand, one.first + k), modes_) +=
          factor * one.form.segment(Eigen::Index{k} * modes_, modes_);
  };
  side(demand.plus, value);
  side(demand.minus, -value);
}

void DisplacementSystem::factor(std::span<const Demand> demands, const std::vector<char>& active,
                                int threads) {
  const Eigen::Index width = Eigen::Index{4} * modes_;
  bands_.resize(members_.size());
  for (std::size_t lattice = 0; lattice < members_.size(); ++lattice)
    bands_[lattice] = Band::Zero(width, length(members_[lattice].front()));
  std::vector<std::vector<const Demand::Side*>> sides(members_.size());
  for (std::size_t k = 0; k < demands.size(); ++k) {
    if (!active[k]) continue;
    for (const Demand::Side* side : {&demands[k].plus, &demands[k].minus})
      sides[lattices_[side->strand]].push_back(side);
  }
  for_each_strand(threads, [&](std::size_t s) {
    const Strand& strand = strands_[s];
    Band& band = bands_[lattices_[s]];
    const double h = strand.spacing();
    // Entries of the lower triangle within the band; those that go round a ring's seam are left out.
    const auto entry = [&](int node_i, int mode_i, int node_j, int mode_j, double value) {
      const Eigen::Index i = static_cast<Eigen::Index>(node_i % strand.nodes()) * modes_ + mode_i;
      const Eigen::Index j = static_cast<Eigen::Index>(node_j % strand.nodes()) * modes_ + mode_j;
      if (i >= j && i - j < width) band(i - j, j) += value;
    };
    for (const Station& station : stations_[s]) {
      const double share = weights_[s] * station.length / h;
      for (int k = 0; k < 4; ++k)
        for (int l = 0; l < 4; ++l) {
          const int node_k = station.stencil.first + k, node_l = station.stencil.first + l;
          for (int m = 0; m < modes_; ++m) {
            const bool moves = m < translation_modes;
            const double stiff = moves ? 1.0 : field_degree(m - translation_modes);
            entry(node_k, m, node_l, m,
                  share * stiff *
                      ((moves ? stiffness_.place : stiffness_.shape) * station.stencil.value[at(k)] *
                           station.stencil.value[at(l)] +
                       (moves ? stiffness_.bend : stiffness_.shape_bend) * h * h * h * h *
                           station.stencil.bend[at(k)] * station.stencil.bend[at(l)]));
          }
          const double strain = share * stiffness_.stretch * h * h * station.stencil.slope[at(k)] *
                                station.stencil.slope[at(l)];
          for (int m = 0; m < 3; ++m)
            for (int c = 0; c < 3; ++c)
              entry(node_k, m, node_l, c, strain * station.along[m] * station.along[c]);
        }
    }
    // Holds reach over more nodes than the band: their rows' sums on the diagonal are an upper bound.
    for (const Hold& held : held_[s]) {
      double sum = 0.0;
      for (const auto& [i, share] : held.parts) sum += std::abs(share);
      for (const auto& [i, share] : held.parts)
        band(0, i - offset(s)) += held.stiffness * std::abs(share) * sum;
    }
  });
  for_each_index(bands_.size(), threads, [&](std::size_t lattice) {
    Band& band = bands_[lattice];
    const Eigen::Index first = offsets_[lattice];
    for (const Demand::Side* side : sides[lattice]) {
      for (int l = 0; l < 4; ++l) {
        const Eigen::Index left = column(side->strand, side->first + l) - first;
        for (int k = 0; k < 4; ++k) {
          const Eigen::Index below = column(side->strand, side->first + k) - first - left;
          if (below < 0 || below + modes_ > width) continue;
          for (int c = 0; c < modes_; ++c) {
            const double factor = stiffness_.contact * side->form[l * modes_ + c];
            const int from = below == 0 ? c : 0;  // the lower triangle
            band.col(left + c).segment(below + from - c, modes_ - from) +=
                factor * side->form.segment(k * modes_ + from, modes_ - from);
          }
        }
      }
    }
    factor_band(band);
  });
}

void DisplacementSystem::precondition(const Eigen::VectorXd& r, Eigen::VectorXd& z, int threads) const {
  z = r;
  for_each_index(members_.size(), threads, [&](std::size_t lattice) {
    solve_band(bands_[lattice], z.segment(offsets_[lattice], length(members_[lattice].front())));
  });
}

Eigen::VectorXd DisplacementSystem::solve(std::span<const Demand> demands, int threads) {
  Eigen::VectorXd x = Eigen::VectorXd::Zero(size_), start(size_);
  gradient(start);
  std::vector<char> active(demands.size());
  // Which demands press now; how many of them changed.
  const auto activate = [&] {
    std::size_t changed = 0;
    for (std::size_t k = 0; k < demands.size(); ++k) {
      const char now = demands[k].is_equal || demands[k].missing - apply(demands[k], x) > 0.0 ? 1 : 0;
      changed += now != active[k] ? 1 : 0;
      active[k] = now;
    }
    return changed;
  };
  constexpr int rounds = 6, most_steps = 80;
  for (int round = 0; round < rounds; ++round) {
    // The next step starts from new demands anyway: the last few need not settle.
    if (activate() * 100 <= demands.size() && round > 0) break;
    factor(demands, active, threads);
    const auto multiply = [&](const Eigen::VectorXd& p, Eigen::VectorXd& y) {
      y.setZero(size_);
      apply_energy(p, y, threads);
      for (std::size_t k = 0; k < demands.size(); ++k)
        if (active[k] != 0) scatter(demands[k], stiffness_.contact * apply(demands[k], p), y);
    };
    // r = -(gradient + K x - contact forces)
    Eigen::VectorXd r(size_), z(size_), p, q(size_);
    multiply(x, r);
    r = -start - r;
    for (std::size_t k = 0; k < demands.size(); ++k)
      if (active[k] != 0) scatter(demands[k], stiffness_.contact * demands[k].missing, r);
    precondition(r, z, threads);
    p = z;
    double rz = r.dot(z);
    const double goal = 1e-5 * rz;
    for (int step = 0; step < most_steps && rz > goal && rz > 0.0; ++step) {
      multiply(p, q);
      const double curvature = p.dot(q);
      if (!(curvature > 0.0)) break;
      const double alpha = rz / curvature;
      x += alpha * p;
      r -= alpha * q;
      precondition(r, z, threads);
      const double next = r.dot(z);
      p = z + (next / rz) * p;
      rz = next;
    }
  }
  return x;
}

}  // namespace selvage::contact
