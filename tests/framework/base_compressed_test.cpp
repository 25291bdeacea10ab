#include <catch2/catch.hpp>

#include "lumivox/base/compressed.h"
#include "lumivox/base/error.h"
#include "support/facts.h"
#include "support/support.h"

using namespace lumivox;
using lumivox::test::Tells;

TEST_CASE("compressed bytes expand to what they were, and a text that comes again far behind takes no room") {
  std::string text;
  for (int i = 0; i < 5000; ++i)
    text += "layout(binding = " + std::to_string(i * 7919 % 10007) + ") uniform sampler3D grid;\n";
  REQUIRE(text.size() > 200000);  // farther than deflate looks back
  const Compressed once = Compressed::of(text), twice = Compressed::of(text + text);
  CHECK(once.expanded() == text);
  CHECK(twice.expanded() == text + text);
  CHECK(once.expandedBytes == text.size());
  CHECK(twice.stream.size() < once.stream.size() * 11 / 10);
  CHECK(Compressed::of("").expanded().empty());
}

TEST_CASE("compressed bytes that are damaged, cut off or of another length are refused") {
  const Compressed whole = Compressed::of("one two three one two three one two three");
  const auto message = [&](std::string stream, std::uint64_t bytes) {
    const auto holder = std::make_shared<const std::string>(std::move(stream));
    return test::messageOf<Error>([&] { Compressed{*holder, bytes, holder}.expanded(); });
  };
  for (std::size_t at = 0; at < whole.stream.size(); ++at) {
    INFO(at);
    std::string damaged(whole.stream);
    damaged[at] = static_cast<char>(damaged[at] ^ 0x55);
    CHECK_THAT(message(damaged, whole.expandedBytes), Tells("damaged"));
    damaged.resize(at);
    CHECK_THAT(message(damaged, whole.expandedBytes), Tells("damaged"));
  }
  for (const std::uint64_t bytes : {whole.expandedBytes - 1, whole.expandedBytes + 1, std::uint64_t{1} << 62})
    CHECK_THAT(message(std::string(whole.stream), bytes), Tells("damaged"));
}
