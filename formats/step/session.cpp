#include "formats/step/session.h"

#include <Interface_Static.hxx>
#include <STEPCAFControl_Controller.hxx>
#include <StepData_GlobalFactors.hxx>
#include <array>

namespace selvage::formats::step {

namespace {

std::mutex& one_at_a_time() {
  static std::mutex mutex;
  return mutex;
}

// In the order of Unit.
constexpr std::array<const char*, all_units.size()> unit_words = {"M", "CM", "MM", "UM", "INCH"};

}  // namespace

const char* schema_word(std::string_view schema) {
  if (schema == "AP242") return "AP242DIS";
  if (schema == "AP214") return "AP214IS";
  return nullptr;
}

Session::Session() : lock_(one_at_a_time()) {
  STEPCAFControl_Controller::Init();
}

Session Session::to_write(Unit units, std::string_view schema) {
  Session session;
  Interface_Static::SetCVal("write.step.schema", schema_word(schema));
  for (const char* const setting : {"xstep.cascade.unit", "write.step.unit"})
    Interface_Static::SetCVal(setting, unit_words[static_cast<std::size_t>(units)]);
  Interface_Static::SetIVal("write.surfacecurve.mode", 0);
  return session;
}

Session Session::to_read() {
  Session session;
  Interface_Static::SetCVal("xstep.cascade.unit", "MM");
  StepData_GlobalFactors::Intance().SetCascadeUnit(1.0);
  // Curves in parameter space where the file gives them.
  Interface_Static::SetIVal("read.surfacecurve.mode", 0);
  return session;
}

}  // namespace selvage::formats::step
