// `selvage formats`.
#pragma once

#include <string>

namespace selvage::cli {

// Every format: its name and extensions, and what is read and written of it.
std::string table_of_formats();

}  // namespace selvage::cli
