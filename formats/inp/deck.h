// The parts of the writer and what they share. All Abaqus keywords of the program are written in this
// folder.
#pragma once

#include <string>
#include <vector>

#include "cell_problem/contact_surfaces.h"
#include "core/text_buffer.h"
#include "fem/forming.h"
#include "fem/mesh.h"
#include "fem/sections.h"
#include "formats/format.h"

namespace selvage::formats::inp {

// A number in at most 20 characters, all that CalculiX reads of one (Fortran's f20.0): the shortest exact
// form where it is that short, else rounded to the digits that fit, at least 13.
std::string real(double value);

// Numbers from 1 on, sixteen a row, as Abaqus allows.
void write_set(TextBuffer& text, const std::vector<std::size_t>& members);

// Names of at most 80 characters.
fem::DeckNames names_of(const fem::Mesh& mesh);

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
std::vector<Load> plan_loads(const fem::Mesh& mesh, const fem::DeckNames& names);

// What is written of a mesh, which has to outlive it.
struct Deck {
  const fem::Mesh& mesh;
  fem::DeckNames names;
  std::vector<fem::Section> sections;
  fem::ContactSurfaces contact;
  std::vector<Load> loads;                // of dry yarns that no cell cuts
  std::vector<fem::NamedSet> node_sets;   // without those of all nodes, of drivers and of dependent nodes
  std::string_view element, wedge;        // types of elements
  const fem::Forming* forming = nullptr;  // an explicit step, in place of all other loads
};
// Error (internal): a region without a material that has elastic constants.
Result<Deck> plan_deck(const fem::Mesh& mesh, const MeshFileOptions& options);

// Has the section's material axes? Yarns have an orientation in any case, for the material that somebody may
// give them later.
bool is_oriented(const fem::Mesh& mesh, const fem::Section& section);

// The head of both parts: units, and whose name is not its own.
void write_names(TextBuffer& text, const Deck& deck);
// Nodes, elements, sets, surfaces, and the directions of the elements (*DISTRIBUTION YARNDIST1).
void write_mesh_part(TextBuffer& text, const Deck& deck);
// How many of what that is.
EntityCounts counts_of_mesh(const Deck& deck);
// Materials, sections, conditions and steps.
void write_model_part(TextBuffer& text, const Deck& deck);

// *TRANSFORM cards, for end faces that look along no coordinate axis. They belong before the step.
void write_transforms(TextBuffer& text, const fem::Mesh& mesh, const std::vector<Load>& loads);
void write_step(TextBuffer& text, const fem::Mesh& mesh, const std::vector<Load>& loads);

// Of dry yarns: NAME_Surface, NAME_Upper, NAME_Lower; the pairs of whole surfaces that are near each other,
// with the interaction YarnContact.
void write_contact_surfaces(TextBuffer& text, const Deck& deck);
void write_contact_pairs(TextBuffer& text, const Deck& deck);

// Of interfaces that are cohesive: COH3D6, their laws and sections, by NAME_Cohesive.
void write_cohesive_elements(TextBuffer& text, const Deck& deck);
void write_cohesive_materials(TextBuffer& text, const Deck& deck);
// Of interfaces that are surfaces: NAME_Side and NAME_Facing, and the ties of the nodes NAME_Tied to the
// latter.
void write_interface_surfaces(TextBuffer& text, const Deck& deck);
void write_ties(TextBuffer& text, const Deck& deck);

// Of a unit cell: the nodes that equations eliminate, each once, in their order.
std::vector<std::size_t> dependent_nodes(const fem::Mesh& mesh);
// *EQUATION cards and what else belongs before the first step.
void write_cell_conditions(TextBuffer& text, const fem::Mesh& mesh);
// A step for each load case.
void write_cell_steps(TextBuffer& text, const fem::Mesh& mesh);

// Of an explicit step: the nodes of plates and of references, behind the mesh's; plates, grips and the sets
// of references (NAME_Ref, References).
void write_rigid_nodes(TextBuffer& text, const fem::Mesh& mesh, const fem::Forming& forming);
void write_rigid_parts(TextBuffer& text, const fem::Mesh& mesh, const fem::Forming& forming);
// *RIGID BODY and *AMPLITUDE cards, which belong before the step.
void write_rigid_bodies(TextBuffer& text, const fem::Mesh& mesh, const fem::Forming& forming);
void write_amplitudes(TextBuffer& text, const fem::Forming& forming);
// Of beams: what is thick in contact.
struct ContactThickness {
  std::string surface;
  double thickness = 0;  // mm
};
void write_explicit_step(TextBuffer& text, const fem::Forming& forming,
                         const std::vector<ContactThickness>& thicknesses = {});

// Yarns as beams: a deck of its own.
Result<WriteFacts> write_beams(const fem::BeamModel& beams, OutputFile& output,
                               const MeshFileOptions& options);

// The file of write_mesh_part, which --split-deck makes.
const Descriptor& mesh_descriptor();

}  // namespace selvage::formats::inp
