// Second-order forward differentiation: a value with its gradient and Hessian by N variables.
// Source: A. Griewank, A. Walther, Evaluating Derivatives, 2nd edition, SIAM 2008, chapter 13.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

namespace selvage::mechanics {

template <std::size_t N>
struct Dual {
  static constexpr std::size_t num_second = N * (N + 1) / 2;

  double value = 0;
  std::array<double, N> first{};
  std::array<double, num_second> second{};  // lower triangle, row by row

  Dual() = default;
  Dual(double constant) : value(constant) {}
  static Dual variable(std::size_t index, double value) {
    Dual made(value);
    made.first[index] = 1.0;
    return made;
  }

  [[nodiscard]] double second_at(std::size_t row, std::size_t column) const {
    return row >= column ? second[row * (row + 1) / 2 + column] : second[column * (column + 1) / 2 + row];
  }

  // f(*this), from the value and the first two derivatives of f there.
  [[nodiscard]] Dual chain(double f, double df, double ddf) const {
    Dual made(f);
    std::size_t k = 0;
    for (std::size_t i = 0; i < N; ++i) {
      made.first[i] = df * first[i];
      for (std::size_t j = 0; j <= i; ++j, ++k) made.second[k] = df * second[k] + ddf * first[i] * first[j];
    }
    return made;
  }

  Dual& operator+=(const Dual& other) {
    value += other.value;
    for (std::size_t i = 0; i < N; ++i) first[i] += other.first[i];
    for (std::size_t k = 0; k < num_second; ++k) second[k] += other.second[k];
    return *this;
  }
  Dual& operator*=(double factor) {
    value *= factor;
    for (double& d : first) d *= factor;
    for (double& d : second) d *= factor;
    return *this;
  }
};

template <std::size_t N>
Dual<N> operator+(Dual<N> a, const Dual<N>& b) {
  return a += b;
}
template <std::size_t N>
Dual<N> operator+(Dual<N> a, double b) {
  a.value += b;
  return a;
}
template <std::size_t N>
Dual<N> operator-(Dual<N> a, const Dual<N>& b) {
  a.value -= b.value;
  for (std::size_t i = 0; i < N; ++i) a.first[i] -= b.first[i];
  for (std::size_t k = 0; k < Dual<N>::num_second; ++k) a.second[k] -= b.second[k];
  return a;
}
template <std::size_t N>
Dual<N> operator-(Dual<N> a, double b) {
  a.value -= b;
  return a;
}
template <std::size_t N>
Dual<N> operator*(Dual<N> a, double factor) {
  return a *= factor;
}
template <std::size_t N>
Dual<N> operator*(double factor, Dual<N> a) {
  return a *= factor;
}
template <std::size_t N>
Dual<N> operator*(const Dual<N>& a, const Dual<N>& b) {
  Dual<N> made(a.value * b.value);
  std::size_t k = 0;
  for (std::size_t i = 0; i < N; ++i) {
    made.first[i] = a.value * b.first[i] + b.value * a.first[i];
    for (std::size_t j = 0; j <= i; ++j, ++k)
      made.second[k] =
          a.value * b.second[k] + b.value * a.second[k] + a.first[i] * b.first[j] + a.first[j] * b.first[i];
  }
  return made;
}
template <std::size_t N>
Dual<N> pow(const Dual<N>& a, double exponent) {
  const double value = std::pow(a.value, exponent);
  return a.chain(value, exponent * value / a.value,
                 exponent * (exponent - 1.0) * value / (a.value * a.value));
}
template <std::size_t N>
Dual<N> sqrt(const Dual<N>& a) {
  const double root = std::sqrt(a.value);
  return a.chain(root, 0.5 / root, -0.25 / (root * a.value));
}
template <std::size_t N>
Dual<N> log(const Dual<N>& a) {
  return a.chain(std::log(a.value), 1.0 / a.value, -1.0 / (a.value * a.value));
}
template <std::size_t N>
Dual<N> reciprocal(const Dual<N>& a) {
  const double r = 1.0 / a.value;
  return a.chain(r, -r * r, 2.0 * r * r * r);
}
template <std::size_t N>
Dual<N> square(const Dual<N>& a) {
  return a * a;
}

}  // namespace selvage::mechanics
