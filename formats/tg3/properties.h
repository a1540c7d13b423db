// What a tg3 file says of yarns' fibres and elasticity, as threads and materials.
#pragma once

#include <string>
#include <vector>

#include "fabric/model.h"
#include "formats/tg3/fields.h"

namespace selvage::formats::tg3 {

class Properties {
 public:
  Properties(const Fields& fields, fabric::Fabric& fabric) : fields_(fields), fabric_(fabric) {}

  // The thread of a yarn, which has the textile's properties where it has none of its own; yarns with the
  // same ones share it. Empty: nothing is said.
  std::string thread_of(const Element& yarn, const Element& textile);
  // The material of the matrix; empty: nothing is said of it.
  std::string matrix_of(const Element& textile);

 private:
  struct Unit {
    std::string_view name;
    double factor;  // into the model's unit
  };
  std::optional<double> measured(const Element& element, std::string_view name,
                                 const std::vector<Unit>& units);
  std::optional<double> stress(const Element& element, std::string_view name);
  void read_fibres(const Element& element, fabric::Thread& thread);
  void read_elastic(const Element& element, fabric::Material& material);

  const Fields& fields_;
  fabric::Fabric& fabric_;
  bool warned_of_orthotropy_ = false;
};

}  // namespace selvage::formats::tg3
