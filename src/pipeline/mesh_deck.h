// The deck that results were computed from, beside them or named.
#pragma once

#include "fem/field_mesh.h"
#include "pipeline/job.h"

namespace selvage::pipeline {

// Makes results those of their deck (fem/solved_deck.h): the one of --deck, else the one beside the input
// under its name. False: the one of --deck cannot be taken, which was said. One beside that cannot is left,
// with a warning.
bool take_deck(Job& job, fem::FieldMesh& mesh);

}  // namespace selvage::pipeline
