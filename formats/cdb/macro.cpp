// The macro that ANSYS runs on the archive of a unit cell: every load case, and the stresses of the whole.
#include "cell_problem/cell_kind.h"
#include "cell_problem/supports.h"
#include "core/text_buffer.h"
#include "formats/registry.h"

namespace selvage::formats::cdb {
namespace {

void write_opening(TextBuffer& text, const fem::Mesh& mesh, const std::string& stem) {
  const std::string name = stem.empty() ? "cell" : stem;
  text << "! Solves the load cases of the unit cell in '" << name << ".cdb' and prints its mean stresses.\n"
       << "! In the folder of both files, with nothing else loaded: /INPUT,'" << name << "','mac'\n"
       << "! By Selvage: mm, N, MPa.\n"
       << "FINISH\nCDREAD,DB,'" << name << "','cdb'\n";
  const double height = mesh.cell->high.z() - mesh.cell->low.z();
  if (const std::optional<int> axis = fem::beam_axis(mesh.cell->periodic)) {
    const Box3& box = mesh.cell->shape().box;
    text << "cell_length=" << box.sizes()[*axis] << '\n';
    for (int k = 0; k < 3; ++k)
      text << "middle_"
           << "xyz"[k] << '=' << box.center()[k] << '\n';
  } else {
    text << "cell_area=" << mesh.cell->shape().volume() / height << "\ncell_z=" << height
         << "\nmiddle_z=" << (mesh.cell->high.z() + mesh.cell->low.z()) / 2 << '\n';
  }
  text << "cases=" << mesh.load_cases.size() << "\n*DIM,mean,ARRAY,cases,9\n";
}

void write_solution(TextBuffer& text, const fem::Mesh& mesh) {
  text << "/SOLU\nANTYPE,STATIC\nTREF,0\nOUTRES,ALL,ALL\n";
  for (const auto& [node, only] : fem::supports(mesh)) {
    text << "D," << node + 1;
    if (only)
      text << ",U"
           << "XYZ"[*only] << ",0\n";
    else
      text << ",UX,0,,,,UY,UZ\n";
  }
  for (std::size_t k = 0; k < mesh.drivers.size(); ++k)
    text << "D," << mesh.number_of_driver(k) + 1 << ",UY,0,,,,UZ   ! " << mesh.drivers[k].name << '\n';
  for (std::size_t i = 0; i < mesh.load_cases.size(); ++i) {
    const fem::LoadCase& load = mesh.load_cases[i];
    text << "! load step " << i + 1 << ": " << load.name << '\n';
    for (std::size_t k = 0; k < load.drivers.size(); ++k) {
      const std::size_t node = mesh.number_of_driver(k) + 1;
      if (load.drivers[k])
        text << "D," << node << ",UX," << *load.drivers[k] << '\n';
      else
        text << "DDELE," << node << ",UX\n";
    }
    text << "TUNIF," << load.temperature << "\nTIME," << i + 1 << "\nSOLVE\n";
  }
  text << "FINISH\n";
}

// Sums of stress times volume, and of that times the distance from the middle plane, over the elements.
void write_evaluation(TextBuffer& text) {
  text << "/POST1\nRSYS,0\nESEL,S,TYPE,,1\n*DO,k,1,cases\n  SET,k\n  ETABLE,ERASE\n"
          "  ETABLE,vol,VOLU\n  ETABLE,zc,CENT,Z\n  SADD,arm,zc,vol,1,0,-middle_z\n  SMULT,varm,arm,vol\n";
  constexpr std::array<std::string_view, 6> components = {"X", "Y", "Z", "XY", "XZ", "YZ"};
  for (const std::string_view c : components)
    text << "  ETABLE,s" << c << ",S," << c << "\n  SMULT,p" << c << ",s" << c << ",vol\n";
  for (const std::string_view c : {"X", "Y", "XY"}) text << "  SMULT,m" << c << ",s" << c << ",varm\n";
  text << "  SSUM\n";
  int row = 0;
  for (const std::string_view c : components)
    text << "  *GET,mean(k," << ++row << "),SSUM,,ITEM,p" << c << '\n';
  for (const std::string_view c : {"X", "Y", "XY"})
    text << "  *GET,mean(k," << ++row << "),SSUM,,ITEM,m" << c << '\n';
  text << "*ENDDO\nALLSEL\n";
}

// Of a beam along x, y or z: sums of its stress times volume, of that times the distances from the middle,
// and of the torque.
void write_beam_evaluation(TextBuffer& text, int axis) {
  constexpr std::string_view letters = "XYZ";
  const char a = letters[static_cast<std::size_t>(axis)];
  const auto shear = [a](char across) { return std::string{std::min(a, across), std::max(a, across)}; };
  text << "/POST1\nRSYS,0\nESEL,S,TYPE,,1\n*DO,k,1,cases\n  SET,k\n  ETABLE,ERASE\n"
       << "  ETABLE,vol,VOLU\n  ETABLE,sn,S," << a << "\n  SMULT,force,sn,vol\n";
  for (const char b : letters)
    if (b != a)
      text << "  ETABLE,c" << b << ",CENT," << b << "\n  SADD,arm" << b << ",c" << b << ",vol,1,0,-middle_"
           << static_cast<char>(b + 'x' - 'X') << "\n  SMULT,bend" << b << ",force,arm" << b << "\n";
  const char b = letters[static_cast<std::size_t>((axis + 1) % 3)],
             c = letters[static_cast<std::size_t>((axis + 2) % 3)];
  for (const auto& [along, arm] : {std::pair{c, b}, std::pair{b, c}})
    text << "  ETABLE,s" << along << ",S," << shear(along) << "\n  SMULT,p" << along << ",s" << along
         << ",vol\n  SMULT,t" << along << ",p" << along << ",arm" << arm << '\n';
  text << "  SADD,torque,t" << c << ",t" << b << ",1,-1\n  SSUM\n";
  int row = 0;
  for (const std::string& item : {std::string("force"), std::string("torque")})
    text << "  *GET,mean(k," << ++row << "),SSUM,,ITEM," << item << '\n';
  for (const char across : letters)
    if (across != a) text << "  *GET,mean(k," << ++row << "),SSUM,,ITEM,bend" << across << '\n';
  text << "*ENDDO\nALLSEL\n! Force, torque and the two bending moments of each load step: a column of the "
          "beam's\n! stiffness times its strain, twist or curvature.\n"
          "*DO,k,1,cases\n  *DO,j,1,4\n    mean(k,j)=mean(k,j)/cell_length\n  *ENDDO\n*ENDDO\n"
          "*VWRITE,mean(1,1),mean(1,2),mean(1,3),mean(1,4)\n(4E16.7)\n";
}

void write_printing(TextBuffer& text, bool is_plate) {
  if (is_plate)
    text << "! Forces xx, yy, xy and moments xx, yy, xy, a length, of each load step: a column of the ABD "
            "matrix "
            "times its strain\n! or curvature.\n"
            "*DO,k,1,cases\n  *DO,j,1,9\n    mean(k,j)=mean(k,j)/cell_area\n"
            "  *ENDDO\n*ENDDO\n"
            "*VWRITE,mean(1,1),mean(1,2),mean(1,4),mean(1,7),mean(1,8),mean(1,9)\n(6E16.7)\n";
  else
    text << "! Stresses xx, yy, zz, xy, xz, yz of each load step: a column of the stiffness times its "
            "strain.\n"
            "*DO,k,1,cases\n  *DO,j,1,6\n    mean(k,j)=mean(k,j)/(cell_area*cell_z)\n"
            "  *ENDDO\n*ENDDO\n"
            "*VWRITE,mean(1,1),mean(1,2),mean(1,3),mean(1,4),mean(1,5),mean(1,6)\n(6E16.7)\n";
}

Result<WriteFacts> write_model(const fem::Mesh& mesh, OutputFile& output,
                               const MeshFileOptions& /*options*/) {
  if (!mesh.cell || mesh.load_cases.empty())
    return error(Kind::unsupported,
                 "the macro solves the load cases of a unit cell, and this mesh has none: give it a "
                 "matrix and periodic faces (--matrix --periodic)");
  TextBuffer text(output);
  write_opening(text, mesh, output.target().stem().string());
  write_solution(text, mesh);
  if (const std::optional<int> axis = fem::beam_axis(mesh.cell->periodic)) {
    write_beam_evaluation(text, *axis);
  } else {
    write_evaluation(text);
    write_printing(text, !mesh.cell->periodic[2]);
  }
  return finished(text, {{"load cases", mesh.load_cases.size()}});
}

}  // namespace

const Descriptor& macro_descriptor() {
  static const Descriptor self = {.name = "mac",
                                  .title = "ANSYS macro that solves the load cases of a cell's .cdb",
                                  .extensions = {".mac"},
                                  .write_mesh = write_model,
                                  .order_of_surfaces = 2,
                                  .order_of_cohesive = 2};
  return self;
}

}  // namespace selvage::formats::cdb
