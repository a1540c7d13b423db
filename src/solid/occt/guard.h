// OpenCASCADE's exceptions and messages stop here. Internal to the module selvage_occt.
#pragma once

#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <Standard_Failure.hxx>
#include <Standard_OutOfMemory.hxx>
#include <mutex>
#include <new>
#include <string>

#include "core/diagnostics.h"
#include "core/module.h"

namespace selvage::solid::occt {

// What OpenCASCADE prints by itself (to standard output) is not for our users.
inline void silence() {
  static std::once_flag once;
  std::call_once(once, [] { ::Message::DefaultMessenger()->ChangePrinters().Clear(); });
}

// Runs `work`, which returns a Result or Status; what OpenCASCADE throws becomes a geometry error that begins
// with `what`. Its signal handlers (OSD::SetSignal) are never installed: signals are the program's own.
template <class Work>
auto guarded(const std::string& what, Work&& work) -> decltype(work()) {
  silence();
  return guarded_by_module(what, [&]() -> decltype(work()) {
    try {
      return work();
    } catch (const Standard_OutOfMemory&) {
      throw std::bad_alloc();
    } catch (const Standard_Failure& failure) {
      const char* text = failure.GetMessageString();
      const std::string reason = text != nullptr && *text != '\0' ? text : failure.DynamicType()->Name();
      return error(Kind::geometry, what + ": OpenCASCADE refuses it: " + reason);
    }
  });
}

}  // namespace selvage::solid::occt
