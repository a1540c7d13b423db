#include "core/sha256.h"

#include <sha256.h>
#include <sys/types.h>

#include <algorithm>
#include <array>

#include "core/source.h"

namespace selvage {

namespace {

class Digest {
 public:
  Digest() { ::SHA256Init(&state_); }
  void add(std::string_view bytes) {
    ::SHA256Update(&state_, reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
  }
  std::string text() {
    std::array<char, SHA256_DIGEST_STRING_LENGTH> digits{};
    ::SHA256End(&state_, digits.data());
    return digits.data();
  }

 private:
  SHA2_CTX state_{};
};

}  // namespace

std::string sha256(std::string_view bytes) {
  Digest digest;
  digest.add(bytes);
  return digest.text();
}

Result<std::string> sha256_of_file(const std::filesystem::path& path) {
  Result<Source> source = Source::open(path);
  if (!source) return source.error();
  return sha256(source->bytes());
}

Result<std::string> sha256_of(const OutputFile& output) {
  Digest digest;
  const std::uint64_t total = output.size();
  constexpr std::uint64_t block = 1U << 20;
  for (std::uint64_t offset = 0; offset < total; offset += block) {
    Result<std::string> bytes =
        output.read_at(offset, static_cast<std::size_t>(std::min(block, total - offset)));
    if (!bytes) return bytes.error();
    digest.add(*bytes);
  }
  return digest.text();
}

}  // namespace selvage
