// The rule by which a published table counts as reproduced, on made-up measurements.
#include <cmath>

#include "lumivox/analysis/judge.h"
#include "support/facts.h"
#include "support/support.h"

using namespace lumivox;
using Catch::Contains;
using lumivox::test::Tells;

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

std::vector<Verdict> verdictsOf(const std::vector<MeasuredRow>& rows) {
  std::vector<Verdict> verdicts;
  for (const auto& row : judge(rows).rows) verdicts.push_back(row.verdict);
  return verdicts;
}

MeasuredRow absent(const std::string& name, double published) {
  MeasuredRow result;
  result.name = name;
  result.published = published;
  result.whyNot = "it is not here";
  return result;
}

/// Points at 1, 2, 4 and 8 that grow as x^p, each with quartiles `spread` to both sides of its median.
MeasuredCurve curve(Growth growth, double power, double spread = 0.0) {
  MeasuredCurve result;
  result.name = "curve";
  result.over = "resolution";
  result.growth = growth;
  for (const double x : {1.0, 2.0, 4.0, 8.0}) {
    MeasuredPoint point;
    static_cast<MeasuredSetUp&>(point) = row("", 1.0, std::pow(x, power), spread);
    point.x = x;
    result.points.push_back(point);
  }
  return result;
}

}  // namespace

TEST_CASE("ratios within a factor of 1.5 of the published ones reproduce a table") {
  const JudgedTable table = judge({row("a", 2.0, 1.0), row("b", 4.0, 2.9), row("c", 1.0, 0.34)});
  CHECK(table.verdict == Verdict::reproduced);
  CHECK(table.rows[0].verdict == Verdict::reference);
  CHECK((table.rows[1].verdict == Verdict::reproduced && table.rows[2].verdict == Verdict::reproduced));
  CHECK(table.rows[1].publishedRatio == Approx(2.0));
  CHECK(table.rows[1].ratio == Approx(2.9));
  CHECK_THAT(table.why, Tells(2, "of", 2));
}

TEST_CASE("one row beyond the factor and the table is not reproduced") {
  const double ratio = GENERATE(3.1, 1.3);
  const std::vector<MeasuredRow> rows{row("a", 2.0, 1.0), row("b", 4.0, ratio), row("c", 2.0, 1.0)};
  CHECK(verdictsOf(rows) == std::vector{Verdict::reference, Verdict::notReproduced, Verdict::reproduced});
  CHECK(judge(rows).verdict == Verdict::notReproduced);
  CHECK_THAT(judge(rows).why, Tells(1, "of", 2));
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
  CHECK_THAT(table.rows[1].why, Tells(2.33, 3.27));
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

TEST_CASE("a time of fewer than three repeats allows no verdict, a count does") {
  MeasuredRow reference = row("a", 2.0, 1.0), once = row("b", 4.0, 2.0), slow = row("c", 4.0, 9.0);
  for (MeasuredRow* few : {&reference, &once, &slow}) few->measured->repeats = 2;
  const JudgedTable table = judge({reference, once, slow});
  for (std::size_t r : {1u, 2u}) {
    CHECK(table.rows[r].verdict == Verdict::notComparable);
    CHECK_THAT(table.rows[r].why, Tells(2, "repeats", 3));
  }
  CHECK(table.rows[1].ratio == Approx(2.0));
  CHECK(table.verdict == Verdict::notComparable);
  // Neither is the order of such rows broken.
  MeasuredRow below = row("b", 1.2, 0.9);
  below.measured->repeats = 1;
  CHECK(judge({row("a", 1.0, 1.0), below, row("c", 1.2, 1.2)}).verdict == Verdict::reproduced);
  // The reference's repeats count as well.
  reference.measured->repeats = 1;
  CHECK_THAT(judge({reference, row("b", 4.0, 2.0)}).rows[1].why, Tells(1, "repeat", 3));
  // Fragments and bytes are the same in every repeat.
  for (const PublishedQuantity counted : {PublishedQuantity::fragments, PublishedQuantity::memory}) {
    for (MeasuredRow* few : {&reference, &once, &slow}) few->quantity = counted, few->measured->repeats = 1;
    CHECK(verdictsOf({reference, once}).back() == Verdict::reproduced);
    CHECK(verdictsOf({reference, slow}).back() == Verdict::notReproduced);
  }
}

TEST_CASE("rows in the other order than published break a table although each is within the factor") {
  const JudgedTable broken = judge({row("a", 1.0, 1.0), row("b", 1.2, 1.0), row("c", 1.4, 0.95)});
  CHECK(broken.rows[1].verdict == Verdict::reproduced);
  CHECK(broken.rows[2].verdict == Verdict::reproduced);
  CHECK(broken.verdict == Verdict::notReproduced);
  CHECK_THAT(broken.why, Tells("order"));
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
  CHECK_THAT(table.rows[1].why, Tells("not measured"));
}

TEST_CASE("a row over another one is judged by their quotient, and stands in no order with other rows") {
  // Published 6 over 2, measured 2.6 times: within 3 / 1.5 and 3 * 1.5.
  MeasuredRow base = row("base", 2.0, 5.0), quotient = row("quotient", 6.0, 13.0);
  quotient.over = "base";
  const JudgedTable table = judge({row("a", 1.0, 1.0), base, quotient});
  CHECK(table.rows[2].publishedRatio == Approx(3.0));
  CHECK(table.rows[2].ratio == Approx(2.6));
  CHECK(table.rows[2].verdict == Verdict::reproduced);
  // A substitute for the published set-up below makes the quotient a substitute, too.
  base.whyNot = "another model";
  const JudgedTable substitute = judge({base, quotient});
  CHECK(substitute.rows[1].ratio == Approx(2.6));
  CHECK(substitute.rows[1].verdict == Verdict::notComparable);
  CHECK(substitute.rows[1].why == "another model");
  // Without it there is nothing to divide by.
  const JudgedTable none = judge({absent("base", 2.0), quotient});
  CHECK(none.rows[1].verdict == Verdict::notComparable);
  CHECK(std::isnan(none.rows[1].ratio));
  CHECK_THAT(none.rows[1].why, Tells("base", "measured"));
  // Published above, measured below: two rows of their own would break the table.
  MeasuredRow low = row("low", 9.0, 0.5);
  low.over = "a";
  CHECK_THAT(judge({row("a", 1.0, 1.0), row("b", 1.2, 1.2), low}).why, !Contains("other order"));
}

TEST_CASE("a curve is judged by its exponent: below one, above one, or in proportion within the factor") {
  // Over a factor of 8 in x a factor of 1.5 is an exponent of log 1.5 / log 8 = 0.195.
  const auto [growth, exponent, verdict] = GENERATE(table<Growth, double, Verdict>({
      {Growth::sublinear, 0.9, Verdict::reproduced},
      {Growth::sublinear, 1.1, Verdict::notReproduced},
      {Growth::superlinear, 1.1, Verdict::reproduced},
      {Growth::superlinear, 0.9, Verdict::notReproduced},
      {Growth::linear, 1.19, Verdict::reproduced},
      {Growth::linear, 0.81, Verdict::reproduced},
      {Growth::linear, 1.2, Verdict::notReproduced},
      {Growth::linear, 0.8, Verdict::notReproduced},
      {Growth::unsaid, 1.0, Verdict::notComparable},
  }));
  const JudgedCurve judged = judgeGrowth(curve(growth, exponent));
  CHECK(judged.exponent.value == Approx(exponent));
  CHECK(judged.verdict == verdict);
}

// A median of 5 with quartiles 30 % apart to both sides is uncertain by 0.831 * 0.3 = 25 %. In logarithms the
// sum of (ln x - mean)^2 is (0.693)^2 * 5 = 2.40, so that the slope is uncertain by 0.25 / sqrt(2.40) = 0.16.
TEST_CASE("a curve whose uncertain exponent reaches across one allows no verdict") {
  const JudgedCurve judged = judgeGrowth(curve(Growth::sublinear, 0.9, 0.3));
  CHECK(judged.exponent.uncertainty == Approx(0.161).epsilon(0.02));
  CHECK(judged.verdict == Verdict::notComparable);
  CHECK_THAT(judged.why, Tells("limit"));
  CHECK(judgeGrowth(curve(Growth::sublinear, 0.5, 0.3)).verdict == Verdict::reproduced);
}

TEST_CASE("a curve of two points or repeats, or with a point that stands in for another, allows no verdict") {
  MeasuredCurve few = curve(Growth::linear, 1.0), seldom = few, substitute = few;
  few.points.resize(2);
  CHECK(judgeGrowth(few).verdict == Verdict::notComparable);
  CHECK(std::isnan(judgeGrowth(few).exponent.value));
  CHECK_THAT(judgeGrowth(few).why, Tells("three points"));
  seldom.points[1].measured->repeats = 3;
  CHECK(judgeGrowth(seldom).verdict == Verdict::reproduced);
  seldom.points[1].measured->repeats = 2;
  CHECK(judgeGrowth(seldom).verdict == Verdict::notComparable);
  CHECK_THAT(judgeGrowth(seldom).why, Tells(2, "repeats"));
  substitute.points[2].whyNot = "another model";
  CHECK(judgeGrowth(substitute).verdict == Verdict::notComparable);
  CHECK(judgeGrowth(substitute).exponent.value == Approx(1.0));
  CHECK(judgeGrowth(substitute).why == "another model");
}

TEST_CASE("a claim about two images is judged by which has less, so many times, and not by a stand-in") {
  const auto [than, times, whyNot, verdict, why] =
      GENERATE(table<double, double, const char*, Verdict, const char*>({
          {2.0, 1.0, "", Verdict::reproduced, ""},
          {2.0, 0.5, "", Verdict::notReproduced, ""},  // 1 is not less than 1
          {2.0, 0.51, "", Verdict::reproduced, ""},
          {std::nan(""), 0.51, "", Verdict::notComparable, "no images"},
          {2.0, 0.51, "it was sold", Verdict::notComparable, "it was sold"},
      }));
  MeasuredClaim claim;
  claim.name = "darker";
  claim.lessValue = 1.0;
  claim.thanValue = than;
  claim.times = times;
  claim.whyNot = whyNot;
  ReproducedResult result;
  result.claims = {claim};
  const ReproducedResult again = judged({result}).front();
  REQUIRE(again.judgedClaims.size() == 1);
  for (const auto& one : {judgeClaim(claim), again.judgedClaims.front()}) {
    CHECK(one.verdict == verdict);
    if (*why != 0) CHECK_THAT(one.why, Tells(why));
  }
}
