#include <catch2/catch.hpp>

#include "lumivox/base/deflate.h"
#include "lumivox/base/error.h"
#include "support/facts.h"
#include "support/support.h"

using namespace lumivox;
using lumivox::test::Tells;

namespace {

Deflated deflatedOf(const std::string& text) {
  return Deflated::ofStream(zlibStream(text, 8), text.size());
}

}  // namespace

TEST_CASE("deflated bytes expand to what they were, and repeated text takes a tenth of its room") {
  std::string text;
  for (int i = 0; i < 1000; ++i)
    text += "layout(binding = " + std::to_string(i % 8) + ") uniform sampler3D grid;\n";
  const Deflated deflated = deflatedOf(text);
  CHECK(deflated.expanded() == text);
  CHECK(deflated.expandedBytes == text.size());
  CHECK(deflated.stream.size() * 10 < text.size());
  CHECK(deflatedOf("").expanded().empty());
}

TEST_CASE("deflated bytes that are damaged, cut off or of another length are refused") {
  const Deflated whole = deflatedOf("one two three one two three one two three");
  const auto message = [](const Deflated& deflated) {
    return test::messageOf<Error>([&] { deflated.expanded(); });
  };
  for (std::size_t at = 0; at < whole.stream.size(); ++at) {
    std::string damaged(whole.stream);
    damaged[at] = static_cast<char>(damaged[at] ^ 0x55);
    CHECK_THAT(message(Deflated::ofStream(damaged, whole.expandedBytes)), Tells("damaged"));
    damaged.resize(at);
    CHECK_THAT(message(Deflated::ofStream(damaged, whole.expandedBytes)), Tells("damaged"));
  }
  for (const std::uint64_t bytes : {whole.expandedBytes - 1, whole.expandedBytes + 1, std::uint64_t{1} << 62})
    CHECK_THAT(message(Deflated::ofStream(std::string(whole.stream), bytes)), Tells("damaged"));
}
