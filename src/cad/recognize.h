// Yarns in a CAD file, found by their geometry: a surface closed round, and the faces that seal its two ends,
// in whatever order, grouping and direction the file has them.
#pragma once

#include <vector>

#include "cad/model.h"
#include "core/diagnostics.h"
#include "yarn/body.h"

namespace selvage::cad {

struct Recognized {
  std::vector<yarn::Body> yarns;  // in the order of their tubes in the file
  std::vector<Part> rest;         // what is no yarn, or no part of one
  std::vector<Message> messages;  // warnings
};

// A tube is an untrimmed surface that is closed in one direction (first and last control column equal to
// 1e-9 of its size; they are made equal to the bit), and no pole at an end; one closed in both is a ring.
// Tubes that are closed in v, or not clamped, are brought to the form of yarn::Body, which moves no control
// point of a clamped one.
//
// An end is sealed by a face whose border is the tube's end curve, to 1e-4 of its extent: a patch, whose
// corners become Body::quarters; a fan; a trimmed plane. Faces of the same part are preferred, then the
// nearest. A patch whose sides do not run with the end curve's parameter is made anew, with a warning.
// Without such a face the end is open.
//
// A part of kind `solid` is a yarn only if nothing of it is left over. Names: the part's, else the face's,
// else yarn_1, ...; of equal ones the later get .2, .3, ... Cost: near to linear in the number of faces.
Recognized recognize_yarns(std::vector<Part> parts);

}  // namespace selvage::cad
