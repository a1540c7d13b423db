// The deck that results were computed from, beside them or named.
#pragma once

#include "pipeline/job.h"
#include "results/field_mesh.h"

namespace selvage::pipeline {

// Makes results those of their deck (results/solved_deck.h): the one of --deck, else the one beside the input
// under its name. False: the one of --deck cannot be taken, which was said. One beside that cannot is left,
// with a warning.
bool take_deck(Job& job, fem::FieldMesh& mesh);

}  // namespace selvage::pipeline
