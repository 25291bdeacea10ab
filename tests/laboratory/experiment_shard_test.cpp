// Plans in shares: every part in one of them, of about the same time, kept in a file.
#include <numeric>

#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "lumivox/experiment/shard.h"
#include "lumivox/experiment/sweep.h"
#include "support/support.h"

using namespace lumivox;
using namespace lumivox::test;

TEST_CASE("a share is read as i/n and anything else is refused") {
  CHECK(shardOf("2/3").index == 2);
  CHECK(shardOf("2/3").count == 3);
  for (const char* text : {"0/3", "4/3", "1", "1/", "/3", "1/0", "a/3", "1/3x", "-1/3", "1.5/3", ""})
    CHECK_THROWS_WITH(shardOf(text), Catch::Contains("from 1/n to n/n"));
}

TEST_CASE("shares hold every part once and differ by less than the dearest part") {
  std::vector<double> costs;
  for (int i = 0; i < 100; ++i) costs.push_back(1.0 + (i * 37 % 11));
  for (const std::size_t count : {1, 2, 7, 100, 150}) {
    const std::vector<std::size_t> cuts = cutsOf(costs, count);
    REQUIRE(cuts.size() == count + 1);
    CHECK(cuts.front() == 0);
    CHECK(cuts.back() == costs.size());
    const double mean = std::accumulate(costs.begin(), costs.end(), 0.0) / static_cast<double>(count);
    for (std::size_t i = 0; i < count; ++i) {
      REQUIRE(cuts[i] <= cuts[i + 1]);
      const auto begin = costs.begin();
      const double share = std::accumulate(begin + static_cast<std::ptrdiff_t>(cuts[i]),
                                           begin + static_cast<std::ptrdiff_t>(cuts[i + 1]), 0.0);
      CHECK(share <= mean + 11.0);
    }
  }
  // Without times all count the same; unknown ones like the mean of the others.
  CHECK(cutsOf(std::vector<double>(6, 0.0), 3) == std::vector<std::size_t>{0, 2, 4, 6});
  CHECK(cutsOf({8.0, 0.0, 8.0, 8.0}, 2) == std::vector<std::size_t>{0, 2, 4});
  CHECK(cutsOf({9.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0}, 2) == std::vector<std::size_t>{0, 1, 10});
  CHECK(cutsOf({}, 2) == std::vector<std::size_t>{0, 0, 0});
}

TEST_CASE("there are as many tasks as their time asks for, and never more than parts") {
  CHECK(tasksFor(std::vector<double>(100, 60.0), 0, 600.0) == 10);
  CHECK(tasksFor(std::vector<double>(100, 0.0), 0, 600.0) == kTasksUnknown);
  CHECK(tasksFor(std::vector<double>(3, 0.0), 0, 600.0) == 3);
  CHECK(tasksFor(std::vector<double>(100, 60.0), 7, 600.0) == 7);
  CHECK(tasksFor(std::vector<double>(100'000, 60.0), 0, 60.0) == kMostTasks);
  // What is unknown counts like the mean.
  CHECK(tasksFor({60.0, 0.0, 0.0, 60.0}, 0, 120.0) == 2);
}

TEST_CASE("a shared plan comes back from its file, and a wrong file is refused with its line") {
  const TemporaryDirectory directory;
  const auto file = directory.path() / "plan.txt";
  const SharedPlan plan{"abc", 100, {{0, 1, 2, 7}, {}, {9, 11, 12, 99}}};
  plan.write(file);
  CHECK(readFile(file) == "lumivox plan 1\nabc 100 3\n0-2 7\n\n9 11-12 99\n");
  const SharedPlan back = SharedPlan::load(file);
  CHECK(back.hash == plan.hash);
  CHECK(back.points == plan.points);
  CHECK(back.shares == plan.shares);
  const auto refused = [&](const std::string& text, const std::string& where) {
    INFO(text);
    CHECK_THROWS_WITH(SharedPlan::load(directory.write("wrong.txt", text)), Catch::Contains(where));
  };
  refused("", "wrong.txt:1: ");
  refused("lumivox plan 2\n", "wrong.txt:1: 'lumivox plan 2'");
  refused("lumivox plan 1\nabc x 3\n", "wrong.txt:2: ");
  refused("lumivox plan 1\nabc 5 2\n0-1\n", "wrong.txt:4: ");
  refused("lumivox plan 1\nabc 5 1\n0-5\n", "wrong.txt:3: ");
  refused("lumivox plan 1\nabc 5 1\n3-2\n", "wrong.txt:3: ");
}
