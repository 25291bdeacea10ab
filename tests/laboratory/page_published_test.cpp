// Published values of parameters, as the cards quote them.
#include "lumivox/base/error.h"
#include "lumivox/page/published_passages.h"
#include "support/support.h"

using namespace lumivox;
using Catch::Contains;

namespace {

std::string written(const std::string& markdown) {
  const std::vector<PublishedParameter> parameters = {{"cones", "inject", "kernel", "box", "tent"},
                                                      {"cones", "gather", "kernel", "box", "tent"},
                                                      {"cones", "gather", "width", "0.5 m", "0.25 m"},
                                                      {"cones", "filter", "kernel", "box", "gaussian"},
                                                      {"rays", "march", "exit", "late", "early"}};
  return withPublishedPassages(markdown, "card.md", parameters);
}

}  // namespace

TEST_CASE("published values are quoted by technique or pass, and passes that share them share a line") {
  const std::string head = "\n\n| parameter | published | ours | passes |\n|---|---|---|---|\n";
  CHECK(written("a\n<!-- published table cones -->old<!-- end --> z") ==
        "a\n<!-- published table cones -->" + head +
            "| `kernel` | box | tent | `inject`, `gather` |\n| `width` | 0.5 m | 0.25 m | `gather` |\n"
            "| `kernel` | box | gaussian | `filter` |\n\n<!-- end --> z");
  CHECK(written("<!-- published table cones; inject; filter --><!-- end -->") ==
        "<!-- published table cones; inject; filter -->" + head +
            "| `kernel` | box | tent | `inject` |\n| `kernel` | box | gaussian | `filter` |\n\n<!-- end -->");
  CHECK(written("none here") == "none here");
}

TEST_CASE("a passage of published values that cannot be written is refused at its line") {
  const auto refused = [](const std::string& passage, const std::string& named) {
    CHECK_THROWS_WITH(written("a\nb\n" + passage + "<!-- end -->"),
                      Contains("card.md:3: ") && Contains(named));
  };
  refused("<!-- published list cones -->", "'list'");
  refused("<!-- published table cone -->", "did you mean 'cones'");
  refused("<!-- published table cones; march -->", "'march'");
}
