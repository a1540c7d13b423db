// 3D weaves with binders that a tg3 file says by their parameters: orthogonal, angle interlock and
// layer-to-layer ones. Straight x and y yarns lie in layers; binders among the x yarns bend round the y
// yarns.
#pragma once

#include <optional>
#include <vector>

#include "formats/tg3/fields.h"
#include "formats/tg3/textile.h"

namespace selvage::formats::tg3 {

// How a binder leaves the y yarns that it turns at: round their sides, along a part of their upper or lower
// half, or round the sides where that is the steeper way.
enum class BinderTurn { orthogonal, angle_interlock, layer_to_layer };

// Errors, at the element: sizes and patterns that are missing or do not fit, a binder without a y yarn to
// turn at. Warns of what is not done (Refine).
std::optional<std::vector<TextileYarn>> build_binder_weave(const Element& textile, BinderTurn turn,
                                                           const Fields& fields);

}  // namespace selvage::formats::tg3
