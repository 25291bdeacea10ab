// Long loops in portions that drivers run to their end.
#include "lumivox/toolkit/loop_limit.h"

#include <vector>

#include "support/support.h"

using namespace lumivox;

TEST_CASE("portions hold every item once, in order, and keep to the limit of turns") {
  for (const int items : {0, 1, 7, 999, 60000, 100000})
    for (const std::int64_t turns :
         {std::int64_t{0}, std::int64_t{1}, std::int64_t{58}, std::int64_t{29999}, std::int64_t{59999}}) {
      CAPTURE(items, turns);
      int next = 0, portions = 0;
      forEachPortion(items, turns, [&](int first, int count) {
        CHECK(first == next);
        CHECK(count > 0);
        CHECK(count * (turns + 1) <= kLoopLimit);
        next = first + count;
        ++portions;
      });
      CHECK(next == items);
      // No more portions than needed.
      const std::int64_t most = kLoopLimit / (turns + 1);
      CHECK(portions == (items + most - 1) / most);
    }
}

TEST_CASE("an item with more turns than the limit has a portion to itself") {
  std::vector<int> counts;
  forEachPortion(3, 10 * kLoopLimit, [&](int, int count) { counts.push_back(count); });
  CHECK(counts == std::vector<int>{1, 1, 1});
  CHECK(portionOf(3, 10 * kLoopLimit) == 1);
}
