// What results need to know of the deck that they are of: sections, fibres, materials, temperatures.
#pragma once

#include <optional>

#include "core/diagnostics.h"
#include "core/source.h"
#include "results/solved_deck.h"

namespace selvage::formats::inp {

// Decks of Abaqus and CalculiX in one file: C3D4, C3D10, C3D6 and C3D8 (and those that only conduct), solid
// sections, linear elasticity by isotropic or engineering constants, orientations of all elements or of each,
// one temperature a step. What else decks say is passed by, but what makes stresses that do not follow from
// these: includes, plasticity, large displacements.
std::optional<fem::SolvedDeck> read_deck(const Source& source, Diagnostics& diagnostics);

}  // namespace selvage::formats::inp
