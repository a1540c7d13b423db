#include "solid/cgal/overlaps.h"
namespace selvage::solid {
Neighbourhood find_overlaps(std::span<const Skinned>, int, const std::function<void()>&) { return {}; }
}
