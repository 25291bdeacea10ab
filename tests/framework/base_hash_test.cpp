// Content hashes.
#include "lumivox/base/hash.h"
#include "support/support.h"

using namespace lumivox;

TEST_CASE("the hash of nothing is XXH3's published one") {
  // xxHash's own check value for XXH3_128bits of no bytes with seed 0.
  REQUIRE(hashOf("").text() == "99aa06d3014798d86001c324468d497f");
}

TEST_CASE("bytes hash the same in one piece and in many") {
  std::string text(1000, '\0');
  for (std::size_t i = 0; i < text.size(); ++i) text[i] = static_cast<char>(i * 7);
  Hasher pieces;
  for (std::size_t i = 0; i < text.size(); i += 37)
    pieces.bytes(text.data() + i, std::min<std::size_t>(37, text.size() - i));
  REQUIRE(pieces.finish() == hashOf(text));
}

TEST_CASE("neighbouring strings do not run together, and every bit counts") {
  const auto hash = [](std::string_view a, std::string_view b) { return Hasher().add(a).add(b).finish(); };
  REQUIRE(hash("ab", "c") != hash("a", "bc"));
  REQUIRE(hash("ab", "") != hash("", "ab"));
  REQUIRE(hash("ab", "c") == hash("ab", "c"));
  REQUIRE(Hasher().add(1.0f).finish() != Hasher().add(-1.0f).finish());
  REQUIRE(Hasher().add(std::vector<int>{1, 2}).add(std::vector<int>{}).finish() !=
          Hasher().add(std::vector<int>{1}).add(std::vector<int>{2}).finish());
}

TEST_CASE("finishing a hash does not end it") {
  Hasher hasher;
  hasher.add("first");
  const ContentHash once = hasher.finish();
  REQUIRE(hasher.finish() == once);
  REQUIRE(hasher.add("second").finish() == Hasher().add("first").add("second").finish());
}
