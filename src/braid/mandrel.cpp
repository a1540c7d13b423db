#include "braid/mandrel.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "yarn/path.h"

namespace selvage::fabric {

namespace {

constexpr int looks_a_row = 32;  // from row to row

}  // namespace

Result<Mandrel> Mandrel::make(const std::vector<MandrelRow>& rows, TextPlace place) {
  yarn::PathRows path;
  for (const MandrelRow& row : rows) path.points.push_back(row.axis);
  const Result<yarn::CentreLine> line = yarn::make_centre_line(path);
  if (!line) return line.error().placed(place);
  Result<yarn::FrameField> frames =
      yarn::FrameField::make(line->curve, yarn::FrameGuide::free_from(std::nullopt), false, true);
  if (!frames) return frames.error().placed(place);
  std::vector<double> shares;
  std::vector<yarn::SizeProfile::Values> radii;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    shares.push_back(frames->length_at(line->parameters[i]) / frames->length());
    radii.push_back({rows[i].radius, rows[i].radius, 0.0});
  }
  Mandrel mandrel(std::move(*frames), {shares, radii, false});
  const int looks = looks_a_row * static_cast<int>(rows.size() - 1);
  for (int i = 0; i <= looks; ++i) {
    const double t = static_cast<double>(i) / looks;
    mandrel.parameters_.push_back(t);
    mandrel.lengths_.push_back(mandrel.frames_.length_at(t));
  }
  for (const double s : mandrel.lengths_) {
    const double curvature = mandrel.curvature(s), radius = mandrel.radius(s);
    mandrel.is_straight_ = mandrel.is_straight_ && curvature * mandrel.length() < 1e-9;
    if (curvature * radius >= 1.0)
      return error(Kind::geometry,
                   fmt::format(
                       "the mandrel folds: {:.4g} along its axis that bends with a radius of {:.4g}, and the "
                       "cloth's radius is {:.4g} there",
                       s, 1.0 / curvature, radius))
          .placed(place);
  }
  return mandrel;
}

// Newton's method from the nearest look.
yarn::Frame Mandrel::frame_at(double s) const {
  s = std::clamp(s, 0.0, length());
  const auto after =
      static_cast<std::size_t>(std::upper_bound(lengths_.begin(), lengths_.end(), s) - lengths_.begin());
  const std::size_t k = std::clamp<std::size_t>(after, 1, lengths_.size() - 1);
  double t = parameters_[k - 1] +
             (s - lengths_[k - 1]) / (lengths_[k] - lengths_[k - 1]) * (parameters_[k] - parameters_[k - 1]);
  yarn::Frame frame = frames_.at(t);
  for (int step = 0; step < 8; ++step) {
    const double off = (frames_.length_at(t) - s) / frame.speed;
    t = std::clamp(t - off, 0.0, 1.0);
    frame = frames_.at(t);
    if (std::abs(off) < 1e-15) break;
  }
  return frame;
}

double Mandrel::curvature(double s) const {
  const yarn::Frame frame = frame_at(s);
  return frame.tangent_dt.norm() / frame.speed;
}

Mandrel::Place Mandrel::carried(const Vec3& position, const Vec3& derivative, double radius) const {
  const Vec2 across(position.x(), position.y()), way(derivative.x(), derivative.y());
  const double distance = across.norm(), s = std::clamp(position.z(), 0.0, length());
  const Vec2 out = across / distance, round(-out.y(), out.x());
  const yarn::Frame frame = frame_at(s);
  const double here = this->radius(s) + distance - radius;
  const double climb = slope(s) * derivative.z() + way.dot(out), turn = way.dot(round) / distance;
  const Vec3 away = out.x() * frame.across + out.y() * frame.up,
             sideways = round.x() * frame.across + round.y() * frame.up;
  const double shortened = 1.0 - here * away.dot(frame.tangent_dt / frame.speed);
  return {frame.position + here * away,
          derivative.z() * shortened * frame.tangent + climb * away + here * turn * sideways, away};
}

}  // namespace selvage::fabric
