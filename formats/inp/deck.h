// The parts of the writer and what they share. All Abaqus keywords of the program are written in this
// folder.
#pragma once

#include <string>
#include <vector>

#include "core/text_buffer.h"
#include "fem/contact_surfaces.h"
#include "fem/mesh.h"
#include "fem/sections.h"

namespace selvage::formats::inp {

// A number in at most 20 characters, all that CalculiX reads of one (Fortran's f20.0): the shortest exact
// form where it is that short, else rounded to the digits that fit, at least 13.
std::string real(double value);

// Sixteen entries a row, as Abaqus allows.
void write_set(TextBuffer& text, const std::vector<std::size_t>& nodes);

// How one yarn is held and pulled: the nodes of `start` keep their place along `normal_start`, those of `end`
// move along `normal_end` by `pull`; both faces stay free to contract. `anchor` and `second` (nodes of start)
// take the three rigid motions that are left, without a force.
struct Load {
  std::string start_set, end_set;
  std::vector<std::size_t> start, end;
  Vec3 normal_start, normal_end;  // unit, out of the yarn
  double pull = 0;                // mm
  std::size_t anchor = 0, second = 0;
};

// A thousandth of each yarn's length, on its end faces; a ring is pulled between the two ends of its longest
// extent. None for a region that has no nodes of its own.
std::vector<Load> plan_loads(const fem::Mesh& mesh);

std::vector<fem::NamedSet> sets_of(const std::vector<Load>& loads);

// *TRANSFORM cards, for end faces that look along no coordinate axis. They belong before the step.
void write_transforms(TextBuffer& text, const fem::Mesh& mesh, const std::vector<Load>& loads);
void write_step(TextBuffer& text, const fem::Mesh& mesh, const std::vector<Load>& loads);

// Of dry yarns: Yarn0_Surface, Yarn0_Upper, Yarn0_Lower, ..; the pairs of whole surfaces that are near each
// other, with the interaction YarnContact.
void write_contact_surfaces(TextBuffer& text, const fem::Mesh& mesh, const fem::ContactSurfaces& contact);
void write_contact_pairs(TextBuffer& text, const fem::Mesh& mesh, const fem::ContactSurfaces& contact);

// Of a unit cell: *EQUATION cards and what else belongs before the first step.
void write_cell_conditions(TextBuffer& text, const fem::Mesh& mesh);
// A step for each load case.
void write_cell_steps(TextBuffer& text, const fem::Mesh& mesh);

}  // namespace selvage::formats::inp
