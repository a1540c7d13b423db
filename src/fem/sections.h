// The groups by which decks speak of a mesh's parts: the same in every format, by names that it takes.
#pragma once

#include <string>
#include <vector>

#include "core/diagnostics.h"
#include "fem/mesh.h"
#include "fem/names.h"

namespace selvage::fem {

struct NamedSet {
  std::string name;
  std::vector<std::size_t> members;  // nodes or elements
};

// Of a unit cell: FaceA .. FaceF (without edges), Edge1 .. Edge12 (without corners), Corner1 .. Corner8,
// those that have nodes. Without a cell: the yarns' ends, NAME_Start and NAME_End, of those that have ends.
std::vector<NamedSet> node_sets(const Mesh& mesh, const DeckNames& names);

// Index into Mesh::materials of the region's own; their number where it has none.
std::size_t material_of(const Mesh& mesh, const Region& region);

// The elements of one region that have one material.
struct Section {
  std::string name;  // the region's where it is of one material, else NAME_Section1, ..
  std::size_t region = 0;
  std::size_t material = 0;           // index into Mesh::materials
  std::vector<std::size_t> elements;  // increasing
};

// Every element is in exactly one. Error (internal): a region without a material that has the constants of
// Mesh::physics.
Result<std::vector<Section>> sections(const Mesh& mesh, const DeckNames& names);

// The sets of elements: of each region, then of the sections that are not a whole one.
std::vector<NamedSet> element_sets(const Mesh& mesh, const std::vector<Section>& sections,
                                   const DeckNames& names);
// The material of each element.
std::vector<std::size_t> element_materials(const Mesh& mesh, const std::vector<Section>& sections);

// Orientations that are in use: of each section whose material is not isotropic, its elements' (along,
// across) made a right-handed orthonormal frame; frames that are equal to the bit are one.
struct Frames {
  static constexpr std::uint32_t none = 0;
  std::vector<std::array<Vec3, 3>> axes;  // unit: along, across, along x across; in order of first use
  std::vector<std::uint32_t> of_element;  // none, or 1 + index into `axes`
};
Frames frames(const Mesh& mesh, const std::vector<Section>& sections);

}  // namespace selvage::fem
