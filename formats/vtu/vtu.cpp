#include "formats/vtu/vtu.h"

#include <bit>

#include "core/text_buffer.h"
#include "fem/quality.h"
#include "formats/vtu/encoding.h"

namespace selvage::formats::vtu {
namespace {

template <class T>
constexpr std::string_view type_name() {
  if constexpr (std::is_same_v<T, double>) return "Float64";
  if constexpr (std::is_same_v<T, float>) return "Float32";
  if constexpr (std::is_same_v<T, std::int64_t>) return "Int64";
  if constexpr (std::is_same_v<T, std::int32_t>) return "Int32";
  return "UInt8";
}

template <class T>
Status write_array(TextBuffer& text, std::string_view name, const std::vector<T>& values,
                   int components = 1) {
  const Result<std::string> encoded = encode(values.data(), values.size() * sizeof(T));
  if (!encoded) return encoded.error();
  text << "        <DataArray type=\"" << type_name<T>() << "\" Name=\"" << name << "\"";
  if (components > 1) text << " NumberOfComponents=\"" << components << '"';
  text << " format=\"binary\">\n" << *encoded << "\n        </DataArray>\n";
  return {};
}

std::vector<double> flat(const std::vector<Vec3>& vectors) {
  std::vector<double> result;
  result.reserve(3 * vectors.size());
  for (const Vec3& v : vectors) result.insert(result.end(), {v.x(), v.y(), v.z()});
  return result;
}

Status write_cells(TextBuffer& text, const fem::Mesh& mesh) {
  const auto nodes = static_cast<std::size_t>(mesh.nodes_per_element());
  std::vector<std::int64_t> connectivity, offsets;
  for (const auto& element : mesh.elements) {
    for (std::size_t k = 0; k < nodes; ++k) connectivity.push_back(static_cast<std::int64_t>(element[k]));
    offsets.push_back(static_cast<std::int64_t>(connectivity.size()));
  }
  // VTK's 10 and 24: tetrahedra of 4 and 10 nodes, in the order of ours.
  const std::vector<std::uint8_t> types(mesh.elements.size(), mesh.order == 1 ? 10 : 24);
  if (Status done = write_array(text, "connectivity", connectivity); !done) return done;
  if (Status done = write_array(text, "offsets", offsets); !done) return done;
  return write_array(text, "types", types);
}

Status write_cell_data(TextBuffer& text, const fem::Mesh& mesh) {
  std::vector<std::int32_t> yarns(mesh.elements.size(), 0);
  for (std::size_t i = 0; i < mesh.regions.size(); ++i)
    for (std::size_t e = mesh.regions[i].first_element; e < mesh.regions[i].last_element; ++e)
      yarns[e] = static_cast<std::int32_t>(i);
  std::vector<float> jacobians, angles, aspects;
  for (std::size_t e = 0; e < mesh.elements.size(); ++e) {
    const fem::ElementShape shape = fem::shape_of(mesh, e);
    jacobians.push_back(static_cast<float>(shape.scaled_jacobian));
    angles.push_back(static_cast<float>(shape.min_dihedral));
    aspects.push_back(static_cast<float>(shape.aspect));
  }
  if (Status done = write_array(text, "yarn", yarns); !done) return done;
  if (Status done = write_array(text, "along", flat(mesh.along), 3); !done) return done;
  if (Status done = write_array(text, "across", flat(mesh.across), 3); !done) return done;
  if (Status done = write_array(text, "scaled_jacobian", jacobians); !done) return done;
  if (Status done = write_array(text, "min_dihedral", angles); !done) return done;
  return write_array(text, "aspect", aspects);
}

// Two hyphens would end a comment.
std::string comment_text(std::string name) {
  for (std::size_t i = 1; i < name.size(); ++i)
    if (name[i] == '-' && name[i - 1] == '-') name[i] = '_';
  if (!name.empty() && name.back() == '-') name.back() = '_';
  return name;
}

Result<WriteFacts> write(const fem::Mesh& mesh, OutputFile& output) {
  TextBuffer text(output);
  text << "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n";
  for (std::size_t i = 0; i < mesh.regions.size(); ++i)
    text << "<!-- yarn " << i << ": " << comment_text(mesh.regions[i].name) << " -->\n";
  text << "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\""
       << (std::endian::native == std::endian::little ? "LittleEndian" : "BigEndian")
       << "\" header_type=\"UInt64\" compressor=\"vtkZLibDataCompressor\">\n"
       << "  <UnstructuredGrid>\n    <Piece NumberOfPoints=\"" << mesh.nodes.size() << "\" NumberOfCells=\""
       << mesh.elements.size() << "\">\n      <Points>\n";
  if (Status done = write_array(text, "Points", flat(mesh.nodes), 3); !done) return done.error();
  text << "      </Points>\n      <Cells>\n";
  if (Status done = write_cells(text, mesh); !done) return done.error();
  text << "      </Cells>\n      <CellData Scalars=\"yarn\">\n";
  if (Status done = write_cell_data(text, mesh); !done) return done.error();
  text << "      </CellData>\n    </Piece>\n  </UnstructuredGrid>\n</VTKFile>\n";
  if (Status done = text.finish(); !done) return done.error();
  WriteFacts facts;
  facts.entities = {{"points", mesh.nodes.size()}, {"cells", mesh.elements.size()}};
  return facts;
}

bool is_a_vtk_grid(std::string_view head) {
  return head.find("<VTKFile") != std::string_view::npos &&
         head.find("UnstructuredGrid") != std::string_view::npos;
}

}  // namespace

const Descriptor& descriptor() {
  static const Descriptor self = {.name = "vtu",
                                  .title = "VTK unstructured grid",
                                  .extensions = {".vtu"},
                                  .sniff = is_a_vtk_grid,
                                  .write_mesh = write};
  return self;
}

}  // namespace selvage::formats::vtu
