// Yarns cut across: the same surface, in pieces that are closed.
#include "yarn/cut.h"

#include <gtest/gtest.h>

#include <numbers>

#include "yarn/finish.h"
#include "yarn/grid.h"

namespace selvage::yarn {
namespace {

using std::numbers::pi;

// A waved bar or a ring of round sections; weights 1, 1.2, 1.4 in turn where it is rational.
Body made(bool ring, bool rational, EndStyle ends) {
  GridNet net;
  net.sections = 12;
  net.per_section = 8;
  net.closed_along = ring;
  for (int j = 0; j < net.sections; ++j)
    for (int i = 0; i < net.per_section; ++i) {
      const double a = 2 * pi * i / net.per_section, t = 2 * pi * j / net.sections;
      const double across = std::cos(a), up = std::sin(a);
      if (ring)
        net.points.emplace_back((6 + across) * std::cos(t), (6 + across) * std::sin(t), up);
      else
        net.points.emplace_back(2.0 * j, across, up + 0.3 * std::sin(2 * t));
      if (rational) net.weights.push_back(1 + 0.2 * (i % 3));
    }
  Body body;
  body.name = "y";
  body.group = "g";
  body.role = Role::weft;
  body.color = {1, 2, 3};
  EXPECT_TRUE(fill_from_grid(body, net).ok());
  EXPECT_TRUE(finish(body, ends).ok());
  return body;
}

void expect_same_surface(const Body& whole, const std::vector<Body>& pieces) {
  for (const Body& piece : pieces)
    for (int k = 0; k <= 20; ++k) {
      const nurbs::Surface& s = piece.surface;
      const double v = s.first_v() + (s.last_v() - s.first_v()) * k / 20;
      const double u = s.first_u() + (s.last_u() - s.first_u()) * ((7 * k) % 21) / 21;
      EXPECT_LT((nurbs::evaluate(s, u, v) - nurbs::evaluate(whole.surface, u, v)).norm(), 1e-13);
      EXPECT_LT((nurbs::evaluate(piece.axis, v) - nurbs::evaluate(whole.axis, v)).norm(), 1e-13);
    }
}

TEST(Cut, PiecesAreTheSameSurfaceAndShareTheirRows) {
  for (const bool ring : {false, true})
    for (const bool rational : {false, true})
      for (const int count : {2, 3, 5}) {
        const Body whole = made(ring, rational, EndStyle::patch);
        const Result<std::vector<Body>> pieces = cut(whole, count, EndStyle::patch);
        ASSERT_TRUE(pieces.ok());
        ASSERT_EQ(pieces->size(), static_cast<std::size_t>(count));
        expect_same_surface(whole, *pieces);
        double volume = 0;
        for (std::size_t k = 0; k < pieces->size(); ++k) {
          const Body& piece = (*pieces)[k];
          EXPECT_EQ(piece.name, "y.part" + std::to_string(k + 1));
          EXPECT_EQ(piece.group, "g");
          EXPECT_EQ(piece.color, whole.color);
          EXPECT_FALSE(piece.closed_along);
          EXPECT_EQ(piece.start.style, EndStyle::patch);
          EXPECT_EQ(piece.end.style, EndStyle::patch);
          EXPECT_LT(end_gap(piece, false), 1e-13);
          EXPECT_LT(end_gap(piece, true), 1e-13);
          volume += piece.volume;
          const bool is_last = k + 1 == pieces->size();
          if (is_last && !ring) break;
          const nurbs::Curve end = nurbs::boundary_row(piece.surface, true);
          const nurbs::Curve next = nurbs::boundary_row((*pieces)[is_last ? 0 : k + 1].surface, false);
          EXPECT_EQ(end.points, next.points);
          EXPECT_EQ(end.weights, next.weights);
        }
        // What the cut faces add on one side they take on the other.
        EXPECT_NEAR(volume, whole.volume, 1e-10 * whole.volume);
      }
}

TEST(Cut, WhatNoCutTouchesKeepsItsBits) {
  const Body whole = made(false, false, EndStyle::fan);
  const Result<std::vector<Body>> pieces = cut(whole, 2, EndStyle::patch);
  ASSERT_TRUE(pieces.ok());
  const nurbs::Surface &first = pieces->front().surface, &last = pieces->back().surface;
  for (int i = 0; i < first.count_u; ++i) {
    for (int j = 0; j < 3; ++j) {
      EXPECT_EQ(first.point(i, j), whole.surface.point(i, j));
      EXPECT_EQ(last.point(i, last.count_v - 1 - j), whole.surface.point(i, whole.surface.count_v - 1 - j));
    }
  }
  EXPECT_EQ(pieces->front().start.style, EndStyle::fan);
  EXPECT_EQ(pieces->front().start.surface.points, whole.start.surface.points);
  EXPECT_EQ(pieces->back().end.surface.points, whole.end.surface.points);
  EXPECT_EQ(pieces->front().end.style, EndStyle::patch);
}

TEST(Cut, AnOpenYarnStaysOpen) {
  const Result<std::vector<Body>> pieces = cut(made(false, false, EndStyle::none), 3, EndStyle::patch);
  ASSERT_TRUE(pieces.ok());
  for (const Body& piece : *pieces) {
    EXPECT_EQ(piece.start.style, EndStyle::none);
    EXPECT_EQ(piece.end.style, EndStyle::none);
  }
}

TEST(Cut, NeedsAKnotForEachCut) {
  const Body whole = made(false, false, EndStyle::patch);
  const auto inner =
      static_cast<int>(nurbs::breakpoints(whole.surface.knots_v, whole.surface.degree_v).size()) - 2;
  EXPECT_TRUE(cut(whole, inner + 1, EndStyle::patch).ok());
  const Result<std::vector<Body>> pieces = cut(whole, inner + 2, EndStyle::patch);
  ASSERT_FALSE(pieces.ok());
  EXPECT_EQ(pieces.error().kind, Kind::geometry);
  EXPECT_EQ(pieces.error().yarn, "y");
}

}  // namespace
}  // namespace selvage::yarn
