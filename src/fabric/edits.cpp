#include "fabric/edits.h"

#include "nurbs/edit.h"

namespace selvage::fabric {

namespace {

Result<nurbs::Curve> edited(const Edit& edit, const yarn::CentreLine& line) {
  // Rational quadratics are those of straights and arcs; a cubic may be rational from an edit before.
  if (line.curve.degree == 2 && line.curve.is_rational())
    return error(Kind::geometry,
                 "the centre line consists of straights and arcs: a joint that moves would tear them apart; "
                 "change the path's rows, or use a path that is a cubic");
  switch (edit.form) {
    case Edit::Form::point:
      return nurbs::move_joint_by_control(line.curve, line.closed, edit.joint, edit.target);
    case Edit::Form::weight:
      return nurbs::move_joint_by_weight(line.curve, line.closed, edit.joint, edit.target);
    case Edit::Form::length:
      return nurbs::move_joint_to_length(line.curve, line.closed, edit.joint, edit.length, edit.direction);
  }
  return line.curve;
}

}  // namespace

Status apply_edits(const Fabric& fabric, std::string_view yarn, yarn::CentreLine& line) {
  for (const Edit& edit : fabric.edits) {
    if (edit.yarn != yarn) continue;
    Result<nurbs::Curve> curve = edited(edit, line);
    if (!curve) return curve.error().placed(edit.place);
    line.curve = std::move(*curve);
  }
  return {};
}

}  // namespace selvage::fabric
