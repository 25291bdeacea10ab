// The formatter: one layout, nothing lost.
#include <functional>

#include "lumivox/base/file.h"
#include "lumivox/dsl/document.h"
#include "support/support.h"

using namespace lumivox;
using namespace lumivox::dsl;

namespace {

std::string formatted(const std::string& source) {
  const Document document = parse(source, "a.scene");
  for (const Diagnostic& finding : document.findings) FAIL(finding.text());
  return format(document);
}

/// Everything that a text says, without its layout.
std::string meaning(const Document& document) {
  std::string text;
  const std::function<void(const std::vector<Item>&)> visit = [&](const std::vector<Item>& items) {
    for (const Item& item : items) {
      if (item.block) {
        text += item.block->title() + "{";
        visit(item.block->items);
        text += "}";
      } else {
        text += item.property->word;
        for (const Value& value : item.property->values) text += ' ' + value.written();
        text += ';';
      }
    }
  };
  visit(document.items);
  return text;
}

}  // namespace

TEST_CASE("formatting sets indentation, blanks and units one way") {
  CHECK(formatted("scene   \"x\"{\ncamera main{fov   39deg   eye 0 0 +1}\n   mesh  m {\nfile \"m.obj\"   "
                  "scale 2cm }\n}") ==
        "scene \"x\" {\n"
        "  camera main { fov 39 deg  eye 0 0 +1 }\n"
        "  mesh m {\n"
        "    file \"m.obj\"  scale 2 cm\n"
        "  }\n"
        "}\n");
}

TEST_CASE("formatting aligns neighbouring one-line blocks of one word") {
  CHECK(formatted("p {\npass a x.y { }\npass long_name x.longer { b 1 }\n\npass c d.e {}\n}") ==
        "p {\n"
        "  pass a         x.y      { }\n"
        "  pass long_name x.longer { b 1 }\n"
        "\n"
        "  pass c d.e { }\n"
        "}\n");
}

TEST_CASE("formatting keeps every comment and single blank lines") {
  const std::string source =
      "# file\n\n\n# more\nscene \"x\" {  # open\n\n  # above\n  camera main {   # inside\n    eye 0 0 1   # "
      "after\n    # end\n  }  # closed\n"
      "\n\n  b [1 # in a list\n 2]\n  # last\n}\n\n# tail\n";
  const std::string once = formatted(source);
  for (const char* comment : {"# file", "# more", "# open", "# above", "# inside", "# after", "# end",
                              "# closed", "# in a list", "# last", "# tail"}) {
    INFO(once);
    CHECK(once.find(comment) != std::string::npos);
  }
  CHECK(once.find("\n\n\n") == std::string::npos);
  CHECK(once.find("# file\n\n# more\nscene") != std::string::npos);
  CHECK(once.find("camera main {  # inside") != std::string::npos);
  CHECK(once.find("}  # closed") != std::string::npos);
}

TEST_CASE("formatting twice gives the same text as formatting once") {
  const std::vector<std::string> sources = {
      "a{b 1 c 2}",
      "a {\n\n\n b 1 # x\n\n # y\n\n # z\n c 2 }",
      "# only top\na { }",
      "a { b [1\n2 # c\n3] }",
      "a { b 1 # c\n }",
      "a { # c\n }",
      "a { b { c 1 } d 2 }",
      "a { b 1 } # x\n\n\n# y\n\n# z\n",
      "a \"s p\" k { b \"q\\\"\\\\\" c x/y d 1..2 cm e $f..3 }",
      "include \"x\"\na { b 1\n 2\n 3 }\n# end",
      "a { long_property_number_one 1000000 2000000 3000000  long_property_number_two 1000000 2000000 "
      "3000000  three 1 2 3 4 5 6 }",
      "a {\n long_property_number_one 1000000 2000000 3000000  long_property_number_two 1000000 2000000 "
      "3000000  three 1 2 3 4 5 6 7 8 9\n}",
      "p {\n pass a b.c { d 1 } # one\n pass e f.gggggg { h 2 }\n # two\n pass i j.k { l 3 }\n}"};
  for (const std::string& source : sources) {
    const std::string once = formatted(source);
    INFO(source << "\n->\n" << once);
    CHECK(formatted(once) == once);
    CHECK(meaning(parse(source, "a")) == meaning(parse(once, "a")));
  }
}

TEST_CASE("formatting every committed text keeps its meaning and is idempotent") {
  for (const auto& entry :
       std::filesystem::recursive_directory_iterator(test::sourceDirectory() / "scenes")) {
    const auto extension = entry.path().extension();
    if (extension != ".scene" && extension != ".pipeline" && extension != ".part") continue;
    const std::string source = readFile(entry.path());
    const std::string once = formatted(source);
    INFO(entry.path());
    CHECK(formatted(once) == once);
    CHECK(meaning(parse(source, "a")) == meaning(parse(once, "a")));
  }
}

TEST_CASE("a formatted line is at most 110 columns wide unless one statement is longer") {
  const std::string once = formatted(
      "a { one 1000000 2000000 3000000  two 1000000 2000000 3000000  three 1000000 2000000 3000000  four "
      "1000000 2000000 3000000 }");
  std::size_t start = 0;
  while (start < once.size()) {
    const std::size_t end = once.find('\n', start);
    CHECK(end - start <= 110);
    start = end + 1;
  }
}
