// Every format of the program. Each is defined in its folder, whose README.md says what it reads and writes.
#pragma once

#include "formats/format.h"

namespace selvage::formats {

namespace txt {  // Fabric TXT, the input language
const Descriptor& descriptor();
}
namespace wif {  // weaving information files, the exchange format of weaving programs
const Descriptor& descriptor();
}
namespace knitout {  // knitout 2: programs of knitting machines
const Descriptor& descriptor();
}
namespace tg3 {  // models of TexGen 3: yarns by nodes and sections
const Descriptor& descriptor();
}
namespace iges {  // IGES 5.3, B-spline surfaces or solids
const Descriptor& descriptor();
}
namespace step {  // STEP AP242 or AP214: each yarn a manifold solid with its name and colour
const Descriptor& descriptor();
}
namespace stl {  // STL: triangles of yarns
const Descriptor& descriptor();
}
namespace obj {  // Wavefront OBJ: triangles of yarns, by name
const Descriptor& descriptor();
// NAME.mtl, the colours of NAME.obj.
const Descriptor& material_descriptor();
}  // namespace obj
namespace ply {  // PLY: triangles of yarns with colours
const Descriptor& descriptor();
}
namespace gltf {  // glTF 2.0: triangles of yarns for viewers
const Descriptor& descriptor();
}
namespace svg {  // SVG 1.1: garment pieces and centre lines as a drawing at true scale
const Descriptor& descriptor();
}
namespace dxf {  // DXF of AutoCAD 2000 (AC1015), ASCII: garment pieces and centre lines as blocks
const Descriptor& descriptor();
}
namespace vtp {  // VTK polygonal data: centre lines as points
const Descriptor& descriptor();
}
namespace csv {  // comma-separated values: centre lines as points
const Descriptor& descriptor();
}
namespace inp {  // Abaqus and CalculiX input deck
const Descriptor& descriptor();
}
namespace cdb {  // ANSYS mesh archive
const Descriptor& descriptor();
// NAME.mac, which solves the load cases of the unit cell in NAME.cdb.
const Descriptor& macro_descriptor();
}  // namespace cdb
namespace k {  // LS-DYNA keyword file
const Descriptor& descriptor();
}
namespace bdf {  // Nastran bulk data file
const Descriptor& descriptor();
}
namespace msh {  // Gmsh mesh 4.1
const Descriptor& descriptor();
}
namespace vtu {  // VTK unstructured grid
const Descriptor& descriptor();
}
namespace unv {  // I-DEAS universal file
const Descriptor& descriptor();
}
namespace frd {  // results of CalculiX
const Descriptor& descriptor();
}
namespace foam {  // OpenFOAM: the pore space of a unit cell as a case
const Descriptor& descriptor();
}
namespace hdf5 {  // HDF5: a unit cell as fields on voxels
const Descriptor& descriptor();
}
namespace npz {  // arrays of NumPy in an archive: the same
const Descriptor& descriptor();
}

// In the order in which `selvage formats` lists them.
const std::vector<const Descriptor*>& all_formats();

}  // namespace selvage::formats
