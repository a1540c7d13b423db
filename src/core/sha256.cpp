#include "core/sha256.h"

#include <sha256.h>
#include <sys/types.h>

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
  const auto add = [&](std::string_view bytes) {
    digest.add(bytes);
    return Status();
  };
  if (Status read = output.read_all(add); !read) return read.error();
  return digest.text();
}

}  // namespace selvage
