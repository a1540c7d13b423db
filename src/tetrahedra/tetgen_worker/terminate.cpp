// TetGen calls this when it gives up. Its own version frees its memory and throws, whereupon its destructor
// frees the same memory again and the process dies without a word. The name belongs to TetGen's shared
// library, where it can be replaced: this definition is found first. (tetgen.h holds the other one inline, so
// it must not be included here.)
#include "tetrahedra/tetgen_worker/job.h"

class tetgenmesh;

namespace {

struct GaveUp {};
bool is_trial = false;

}  // namespace

void terminatetetgen(tetgenmesh* /*mesh*/, int code) {
  using selvage::fem::Outcome;
  if (is_trial) throw GaveUp();
  // 1: out of memory, 3: crossing facets, 4: a feature that is too small, 5: facets too close, 10: bad input.
  selvage::fem::leave(code == 1 ? Outcome::memory : Outcome::refused, code);
}

bool selvage::fem::gives_up(void (*work)()) {
  is_trial = true;
  bool ours = false;
  try {
    work();
  } catch (const GaveUp&) {
    ours = true;
  } catch (int) {  // TetGen's own
  }
  is_trial = false;
  return ours;
}
