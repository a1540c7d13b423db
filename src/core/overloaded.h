// A visitor of a variant, made of one function a type: one that is forgotten does not compile.
#pragma once

namespace selvage {

template <class... Fs>
struct Overloaded : Fs... {
  using Fs::operator()...;
};
template <class... Fs>
Overloaded(Fs...) -> Overloaded<Fs...>;

}  // namespace selvage
