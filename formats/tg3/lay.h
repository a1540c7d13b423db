// The yarns of a textile as those of a fabric: repeated over the domain, units that follow each other as one
// yarn.
#pragma once

#include <optional>

#include "fabric/model.h"
#include "formats/tg3/fields.h"
#include "formats/tg3/textile.h"

namespace selvage::formats::tg3 {

// The element <Domain>. Warns of one that is no box along the axes. Nothing: it has no sides (an error says
// why, or a warning of a prism, which has none that are read), or encloses no volume, with a warning.
std::optional<Domain> read_domain(const Element& element, const Fields& fields);

// The domain as a cell, where it is a box along the axes.
std::optional<fabric::Cell> cell_of(const Domain& domain);

// Adds the yarn to the fabric: without a domain once, else at every sum of its repeats at which it reaches
// into the domain. A yarn that goes on where it ends (its last node is its first one, a sum of repeats away,
// and so is the section there) becomes one yarn for each of its lines. Errors: as YarnPath::make and
// surface_of; repeats that are dependent (geometry), more copies than can be held (limit).
// `tolerance`: of YarnShape. Gives back how far the surface is from the sections, about.
double lay(const TextileYarn& yarn, const std::optional<Domain>& domain, double tolerance,
           const Fields& fields, fabric::Fabric& fabric);

}  // namespace selvage::formats::tg3
