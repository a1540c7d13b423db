// Where tests find the samples, their own files and the programs that they run. What differs from machine to
// machine is compiled into this one file, so that the others are the same in every clone.
#pragma once

#include <string>

namespace selvage::places {

std::string samples();        // folder
std::string tests();          // folder
std::string scripts();        // folder
std::string programs();       // folder: selvage, its modules, and what was built for tests
std::string python();         // any Python 3
std::string system_python();  // Debian's, which has numpy and meshio
std::string gmsh();
std::string ccx();

}  // namespace selvage::places
