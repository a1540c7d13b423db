// The vectors of RFC 4648, section 10, and every byte.
#include "core/base64.h"

#include <gtest/gtest.h>

#include "core/little_endian.h"

namespace selvage {
namespace {

std::string letters(std::string_view bytes) {
  std::string text;
  append_base64(text, bytes);
  return text;
}

TEST(Base64, VectorsOfItsStandard) {
  EXPECT_EQ(letters(""), "");
  EXPECT_EQ(letters("f"), "Zg==");
  EXPECT_EQ(letters("fo"), "Zm8=");
  EXPECT_EQ(letters("foo"), "Zm9v");
  EXPECT_EQ(letters("foob"), "Zm9vYg==");
  EXPECT_EQ(letters("fooba"), "Zm9vYmE=");
  EXPECT_EQ(letters("foobar"), "Zm9vYmFy");
  EXPECT_EQ(letters(std::string_view("\x00\xFF\xBE", 3)), "AP++");
}

TEST(Base64, IsAddedToWhatIsThere) {
  std::string text = "data:,";
  append_base64(text, "foo");
  EXPECT_EQ(text, "data:,Zm9v");
}

TEST(LittleEndian, LeastByteFirst) {
  std::string bytes;
  append_little_endian(bytes, std::uint32_t{0x01020304});
  append_little_endian(bytes, std::uint8_t{5});
  append_little_endian(bytes, 1.0F);  // 3F800000
  EXPECT_EQ(bytes, std::string("\x04\x03\x02\x01\x05\x00\x00\x80\x3F", 9));
}

}  // namespace
}  // namespace selvage
