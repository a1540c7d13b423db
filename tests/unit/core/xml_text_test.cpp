#include "core/xml_text.h"

#include <gtest/gtest.h>

namespace selvage {
namespace {

TEST(XmlText, HoldsWhatXmlMayHold) {
  EXPECT_EQ(xml_text("<a&\"b\">"), "&lt;a&amp;&quot;b&quot;&gt;");
  EXPECT_EQ(xml_text("\xC3\xA9\xE4\xBD\x93"), "\xC3\xA9\xE4\xBD\x93");
  EXPECT_EQ(xml_text("a\x01z\xFFq"), "a\xEF\xBF\xBDz\xEF\xBF\xBDq");
  EXPECT_EQ(xml_text("a\x01z\xFFq\xEF\xBF\xBE", "?"), "a?z?q?");
  EXPECT_EQ(xml_text("\t\r\n"), "\t&#13;\n");
  EXPECT_EQ(xml_text(""), "");
}

}  // namespace
}  // namespace selvage
