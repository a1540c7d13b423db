#include <string>
#include <vector>

#include "core/text_buffer.h"
#include "formats/registry.h"
#include "formats/vtp/reader.h"
#include "yarn/line_samples.h"

namespace selvage::formats::vtp {

namespace {

using yarn::LineSample;

bool looks_like_vtp(std::string_view head) {
  return head.find("<VTKFile") != std::string_view::npos && head.find("PolyData") != std::string_view::npos;
}

class Writer final : public BodyWriter {
 public:
  Writer(OutputFile& output, const SurfaceOptions& options) : output_(&output), options_(options) {}

  Status add_line(const yarn::Body& body) override {
    const std::vector<LineSample>& samples = sampler_.sample(body, line_tolerance(options_, body));
    samples_.insert(samples_.end(), samples.begin(), samples.end());
    ends_.push_back(samples_.size());
    names_.push_back(body.name);
    roles_.push_back(static_cast<int>(body.role));
    return {};
  }

  Result<WriteFacts> finish() override {
    if (ends_.empty()) return error(Kind::geometry, "there is no yarn, whose centre line could be written");
    TextBuffer text(*output_);
    text << "<?xml version=\"1.0\"?>\n"
            "<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n"
            "<PolyData>\n";
    put_names(text);
    text << "<Piece NumberOfPoints=\"" << samples_.size() << "\" NumberOfVerts=\"0\" NumberOfLines=\""
         << ends_.size() << "\" NumberOfStrips=\"0\" NumberOfPolys=\"0\">\n<PointData Scalars=\"radius\">\n";
    put_scalars(text, "parameter", &LineSample::parameter);
    put_scalars(text, "arc_length", &LineSample::arc_length);
    put_vectors(text, "tangent", &LineSample::tangent);
    put_vectors(text, "side", &LineSample::side);
    put_vectors(text, "up", &LineSample::up);
    put_scalars(text, "width", &LineSample::width);
    put_scalars(text, "height", &LineSample::height);
    put_scalars(text, "radius", &LineSample::radius);
    put_scalars(text, "curvature", &LineSample::curvature);
    put_scalars(text, "speed", &LineSample::speed);
    text << "</PointData>\n<CellData>\n";
    put_list(text, "Int32", "yarn", ends_.size(), [&](std::size_t i) { return i; });
    put_list(text, "Int32", "role", roles_.size(), [&](std::size_t i) { return roles_[i]; });
    text << "</CellData>\n<Points>\n";
    put_vectors(text, "points", &LineSample::position);
    text << "</Points>\n<Lines>\n";
    put_list(text, "Int64", "connectivity", samples_.size(), [](std::size_t i) { return i; });
    put_list(text, "Int64", "offsets", ends_.size(), [&](std::size_t i) { return ends_[i]; });
    text << "</Lines>\n</Piece>\n</PolyData>\n</VTKFile>\n";
    return finished(text, {{"lines", ends_.size()}, {"points", samples_.size()}});
  }

 private:
  // VTK has strings as their bytes, each followed by a 0.
  void put_names(TextBuffer& text) {
    text << "<FieldData>\n<Array type=\"String\" Name=\"yarn_names\" NumberOfTuples=\"" << names_.size()
         << "\" format=\"ascii\">\n";
    for (const std::string& name : names_) {
      for (const char c : name) text << static_cast<int>(static_cast<unsigned char>(c)) << ' ';
      text << "0\n";
    }
    text << "</Array>\n</FieldData>\n";
  }

  template <class At>
  static void put_list(TextBuffer& text, std::string_view type, std::string_view name, std::size_t count,
                       const At& at) {
    text << "<DataArray type=\"" << type << "\" Name=\"" << name << "\" format=\"ascii\">\n";
    for (std::size_t i = 0; i < count; ++i) text << at(i) << '\n';
    text << "</DataArray>\n";
  }
  void put_scalars(TextBuffer& text, std::string_view name, double LineSample::*member) const {
    put_list(text, "Float64", name, samples_.size(), [&](std::size_t i) { return samples_[i].*member; });
  }
  void put_vectors(TextBuffer& text, std::string_view name, Vec3 LineSample::*member) const {
    text << "<DataArray type=\"Float64\" Name=\"" << name
         << "\" NumberOfComponents=\"3\" format=\"ascii\">\n";
    for (const LineSample& sample : samples_) {
      const Vec3& v = sample.*member;
      text << v.x() + 0.0 << ' ' << v.y() + 0.0 << ' ' << v.z() + 0.0 << '\n';
    }
    text << "</DataArray>\n";
  }

  OutputFile* output_;
  SurfaceOptions options_;
  yarn::LineSampler sampler_;
  std::vector<LineSample> samples_;  // of all yarns
  std::vector<std::size_t> ends_;    // behind each yarn's last one
  std::vector<std::string> names_;
  std::vector<int> roles_;
};

}  // namespace

const Descriptor& descriptor() {
  static const Descriptor self = {
      .name = "vtp",
      .title = "VTK polygonal data, centre lines as points with frame, section and arc length",
      .extensions = {".vtp"},
      .sniff = looks_like_vtp,
      .read_points = read_points,
      .open_bodies = open_by<Writer>,
      .carries_surfaces = false,
      .carries_lines = true,
  };
  return self;
}

}  // namespace selvage::formats::vtp
