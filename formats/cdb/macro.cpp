// The macro that ANSYS runs on the archive of a unit cell: every load case, and the stresses of the whole.
#include "core/text_buffer.h"
#include "fem/complete_cell.h"
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
  text << "cell_area=" << mesh.cell->shape().volume() / height << "\ncell_z=" << height
       << "\nmiddle_z=" << (mesh.cell->high.z() + mesh.cell->low.z()) / 2
       << "\ncases=" << mesh.load_cases.size() << "\n*DIM,mean,ARRAY,cases,9\n";
}

void write_solution(TextBuffer& text, const fem::Mesh& mesh) {
  text << "/SOLU\nANTYPE,STATIC\nTREF,0\nOUTRES,ALL,ALL\n";
  if (const auto held = fem::held_node(mesh)) text << "D," << *held + 1 << ",UX,0,,,,UY,UZ\n";
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
  write_evaluation(text);
  write_printing(text, !mesh.cell->periodic[2]);
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
