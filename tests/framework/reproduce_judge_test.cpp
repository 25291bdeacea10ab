// The rule by which a published table counts as reproduced, on made-up measurements.
#include <cmath>

#include "lumivox/report/reproduce.h"
#include "support/support.h"

using namespace lumivox;
using Catch::Contains;

namespace {

/// A row of 10 * `ratio` ms whose quartiles lie `spread` of it apart on both sides.
MeasuredRow row(const std::string& name, double published, double ratio, double spread = 0.0) {
  const double median = 10.0 * ratio, low = median * (1.0 - spread), high = median * (1.0 + spread);
  MeasuredRow result;
  result.name = name;
  result.published = published;
  result.measured = TimingStatistics{median, low, high, low, high, 5};
  return result;
}

MeasuredRow absent(const std::string& name, double published) {
  MeasuredRow result;
  result.name = name;
  result.published = published;
  result.whyNot = "it is not here";
  return result;
}

}  // namespace

TEST_CASE(
    "ratios within a factor of 1.5 of the published ones reproduce a table, whatever the device's speed") {
  const JudgedTable table = judge({row("a", 2.0, 1.0), row("b", 4.0, 2.9), row("c", 1.0, 0.34)});
  CHECK(table.verdict == Verdict::reproduced);
  CHECK(table.rows[0].verdict == Verdict::reference);
  CHECK(table.rows[1].verdict == Verdict::reproduced);
  CHECK(table.rows[1].publishedRatio == Approx(2.0));
  CHECK(table.rows[1].ratio == Approx(2.9));
  CHECK(table.rows[2].verdict == Verdict::reproduced);
  CHECK_THAT(table.why, Contains("2 of 2 comparable rows"));
}

TEST_CASE("one row beyond the factor and the table is not reproduced") {
  for (const double ratio : {3.1, 1.3}) {
    const JudgedTable table = judge({row("a", 2.0, 1.0), row("b", 4.0, ratio), row("c", 2.0, 1.0)});
    CHECK(table.rows[1].verdict == Verdict::notReproduced);
    CHECK(table.rows[2].verdict == Verdict::reproduced);
    CHECK(table.verdict == Verdict::notReproduced);
    CHECK_THAT(table.why, Contains("1 of 2"));
  }
}

// The standard uncertainty of a median of n values is sqrt(pi/2) sigma / sqrt(n), sigma a 1.349th of the
// distance of the quartiles. With quartiles a share s to both sides and n = 5: 1.2533 * 2 s / 1.349 / sqrt(5)
// = 0.831 s of the median.
TEST_CASE("an uncertainty that reaches across the limit allows no verdict, more repeats do") {
  // The limit is at 3; 2.8 with s = 0.1 reaches 2.8 (1 + 2 * 0.0831).
  const JudgedTable table = judge({row("a", 2.0, 1.0), row("b", 4.0, 2.8, 0.1)});
  CHECK(table.rows[1].verdict == Verdict::notComparable);
  CHECK(table.rows[1].lowRatio == Approx(2.8 * (1.0 - 2.0 * 0.0831)).epsilon(1e-3));
  CHECK(table.rows[1].highRatio == Approx(2.8 * (1.0 + 2.0 * 0.0831)).epsilon(1e-3));
  CHECK_THAT(table.rows[1].why, Contains("2.33 to 3.27"));
  // A table of nothing but that is not comparable.
  CHECK(table.verdict == Verdict::notComparable);
  CHECK(judge({row("a", 2.0, 1.0), row("b", 4.0, 2.8, 0.02)}).rows[1].verdict == Verdict::reproduced);
  MeasuredRow often = row("b", 4.0, 2.8, 0.1);
  often.measured->repeats = 500;
  CHECK(judge({row("a", 2.0, 1.0), often}).rows[1].verdict == Verdict::reproduced);
  // The reference's own uncertainty counts as well.
  CHECK(judge({row("a", 2.0, 1.0, 0.1), row("b", 4.0, 2.8)}).rows[1].verdict == Verdict::notComparable);
  CHECK(judge({row("a", 2.0, 1.0, 0.1), row("b", 4.0, 5.0)}).rows[1].verdict == Verdict::notReproduced);
}

TEST_CASE("rows in the other order than published break a table although each is within the factor") {
  const JudgedTable broken = judge({row("a", 1.0, 1.0), row("b", 1.2, 1.0), row("c", 1.4, 0.95)});
  CHECK(broken.rows[1].verdict == Verdict::reproduced);
  CHECK(broken.rows[2].verdict == Verdict::reproduced);
  CHECK(broken.verdict == Verdict::notReproduced);
  CHECK_THAT(broken.why, Contains("in the other order"));
  // Not within their uncertainty: then nobody knows which is above.
  CHECK(judge({row("a", 1.0, 1.0), row("b", 1.2, 1.0, 0.05), row("c", 1.4, 0.99, 0.02)}).verdict ==
        Verdict::reproduced);
}

TEST_CASE("an absent first row gives its place to the next, and absent rows alone allow no verdict") {
  const JudgedTable table = judge({absent("a", 8.0), row("b", 2.0, 1.0), row("c", 4.0, 2.0)});
  CHECK(table.rows[0].verdict == Verdict::notComparable);
  CHECK(table.rows[0].publishedRatio == Approx(4.0));
  CHECK(std::isnan(table.rows[0].ratio));
  CHECK(table.rows[1].verdict == Verdict::reference);
  CHECK(table.rows[2].publishedRatio == Approx(2.0));
  CHECK(table.verdict == Verdict::reproduced);
  CHECK(judge({absent("a", 1.0), absent("b", 2.0)}).verdict == Verdict::notComparable);
  CHECK(std::isnan(judge({absent("a", 1.0)}).rows[0].publishedRatio));
  CHECK(judge({}).verdict == Verdict::notComparable);
}

TEST_CASE("what stands in for the published set-up is shown with its ratio, but never counts") {
  MeasuredRow first = row("a", 1.0, 1.0), second = row("b", 2.0, 9.0);
  first.whyNot = second.whyNot = "another model";
  const JudgedTable table = judge({first, second});
  CHECK(table.rows[1].ratio == Approx(9.0));
  CHECK(table.rows[1].verdict == Verdict::notComparable);
  CHECK(table.rows[1].why == "another model");
  CHECK(table.verdict == Verdict::notComparable);
  // A real row never takes a substitute as its reference.
  const JudgedTable mixed = judge({first, row("b", 2.0, 4.0), row("c", 4.0, 8.0)});
  CHECK(mixed.rows[1].verdict == Verdict::reference);
  CHECK(mixed.rows[2].ratio == Approx(2.0));
}

TEST_CASE("frame rates count as times of frames, and numbers of another kind have a first row of their own") {
  MeasuredRow rate = row("rate", 50.0, 2.0);  // 20 ms published, 20 ms measured
  rate.quantity = PublishedQuantity::frameRate;
  MeasuredRow few = row("few", 1000.0, 1.0), many = row("many", 4000.0, 4.0);
  few.quantity = many.quantity = PublishedQuantity::fragments;
  const JudgedTable table = judge({row("a", 10.0, 1.0), rate, few, many});
  CHECK(table.rows[1].publishedRatio == Approx(2.0));
  CHECK(table.rows[1].verdict == Verdict::reproduced);
  CHECK(table.rows[2].verdict == Verdict::reference);
  CHECK(table.rows[3].verdict == Verdict::reproduced);
}

TEST_CASE("a row whose time is zero was not measured") {
  const JudgedTable table = judge({row("a", 1.0, 1.0), row("b", 1.0, 0.0)});
  CHECK(table.rows[1].verdict == Verdict::notComparable);
  CHECK_THAT(table.rows[1].why, Contains("not measured"));
}
