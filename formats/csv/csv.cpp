#include <string>

#include "core/csv.h"
#include "core/text_buffer.h"
#include "formats/csv/reader.h"
#include "formats/registry.h"
#include "yarn/line_samples.h"

namespace selvage::formats::csv {

namespace {

class Writer final : public BodyWriter {
 public:
  Writer(OutputFile& output, const SurfaceOptions& options) : options_(options), text_(output) {
    const std::string unit(name_of(options.units));
    text_ << "yarn,point,parameter,arc_length_" << unit;
    for (const std::string_view axis : {"x", "y", "z"}) text_ << ',' << axis << '_' << unit;
    text_ << ",tangent_x,tangent_y,tangent_z,side_x,side_y,side_z,up_x,up_y,up_z";
    for (const std::string_view size : {"width", "height", "radius"}) text_ << ',' << size << '_' << unit;
    text_ << ",curvature_per_" << unit << ",speed_" << unit << '\n';
  }

  Status add_line(const yarn::Body& body) override {
    const std::string name = csv_value(body.name);
    std::size_t number = 0;
    for (const yarn::LineSample& sample : sampler_.sample(body, line_tolerance(options_, body))) {
      text_ << name << ',' << ++number << ',' << sample.parameter << ',' << sample.arc_length;
      for (const Vec3& vector : {sample.position, sample.tangent, sample.side, sample.up})
        for (const double value : vector) text_ << ',' << value + 0.0;
      for (const double value : {sample.width, sample.height, sample.radius, sample.curvature, sample.speed})
        text_ << ',' << value;
      text_ << '\n';
    }
    points_ += number;
    ++lines_;
    return {};
  }

  Result<WriteFacts> finish() override {
    if (lines_ == 0) return error(Kind::geometry, "there is no yarn, whose centre line could be written");
    return finished(text_, {{"lines", lines_}, {"points", points_}});
  }

 private:
  SurfaceOptions options_;
  TextBuffer text_;
  yarn::LineSampler sampler_;
  std::uint64_t lines_ = 0, points_ = 0;
};

}  // namespace

const Descriptor& descriptor() {
  static const Descriptor self = {
      .name = "csv",
      .title = "CSV, centre lines as points with frame, section and arc length",
      .extensions = {".csv"},
      .read_points = read_points,
      .open_bodies = open_by<Writer>,
      .carries_surfaces = false,
      .carries_lines = true,
  };
  return self;
}

}  // namespace selvage::formats::csv
