// Changes between two stored results.
#include <cmath>

#include "lumivox/analysis/changes.h"
#include "stored_records.h"
#include "support/facts.h"
#include "support/support.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

RunChange changeOf(const RunComparison& comparison, const std::string& quantity) {
  for (const RunChange& one : comparison.changes)
    if (one.quantity == quantity) return one;
  FAIL("not compared: " << quantity);
  return {};
}

/// Of so many frames that all took as long.
TimingStatistics exactly(double ms, int repeats = 25) {
  return {ms, ms, ms, ms, ms, repeats};
}

}  // namespace

TEST_CASE("a change is significant beyond three standard uncertainties of the difference") {
  StoredRun before = runNumber(6), after = runNumber(6);
  before.point.errors[0].error.rmse = {1.0, 0.01};
  const auto change = [&](double rmse) {
    after.point.errors[0].error.rmse = {rmse, 0.01};
    return changeOf(compareResults({before}, {after}), "indirect_diffuse rmse against one_bounce_diffuse");
  };
  // sigma of the difference: sqrt(2) 0.01.
  CHECK(change(1.04).sigmas == Approx(0.04 / (std::sqrt(2.0) * 0.01)));
  CHECK_FALSE(change(1.04).significant);
  CHECK(change(1.05).significant);
  CHECK_FALSE(change(1.05).better);
  CHECK(change(0.9).better);
  CHECK(change(1.0).sigmas == 0.0);
}

TEST_CASE("a time changed when its median moved beyond its spread and by a twentieth") {
  StoredRun before = runNumber(6), after = runNumber(6);
  const auto frame = [&](double median, double spread) {
    before.point.frameMs = {10.0, 10.0 - spread, 10.0 + spread, 9.0, 12.0, 25};
    after.point.frameMs = {median, median - spread, median + spread, 9.0, 12.0, 25};
    return compareResults({before}, {after}).changes.front();
  };
  // Quartiles 1.349 sigma apart; a median of 25 values is uncertain by 1.2533 sigma / 5.
  CHECK(frame(11.0, 0.6745).before.uncertainty == Approx(1.2533 / 5.0).epsilon(1e-3));
  CHECK_FALSE(frame(11.0, 0.6745).significant);
  CHECK(frame(11.5, 0.6745).significant);
  CHECK_FALSE(frame(10.4, 0.001).significant);
  CHECK(frame(9.4, 0.001).better);
}

TEST_CASE("a time of fewer than three frames proves nothing, however far it moved") {
  StoredRun before = runNumber(6), after = runNumber(6);
  const auto frame = [&](int repeats) {
    before.point.frameMs = exactly(10.0);
    after.point.frameMs = exactly(20.0, repeats);
    return changeOf(compareResults({before}, {after}), "frame ms");
  };
  for (const int repeats : {1, 2}) {
    CHECK_FALSE(frame(repeats).significant);
    CHECK(frame(repeats).undecided);
  }
  CHECK(frame(3).significant);
  CHECK_FALSE(frame(3).undecided);
}

TEST_CASE("an error of fewer than three seeds proves nothing unless there are no random numbers") {
  StoredRun before = runNumber(6), after = runNumber(6);
  const auto flip = [&](int seeds, bool deterministic) {
    after.point.errors[0].error.flip = 0.5;
    after.point.errors[0].seeds = seeds;
    after.point.errors[0].deterministic = deterministic;
    return changeOf(compareResults({before}, {after}), "indirect_diffuse flip against one_bounce_diffuse");
  };
  CHECK(flip(2, false).undecided);
  CHECK_FALSE(flip(2, false).significant);
  CHECK(flip(3, false).significant);
  CHECK(flip(2, true).significant);
  // Of an older store: the RMSE is of all seeds, the others of the first alone.
  after.point.errors[0].everyMetricPerSeed = false;
  CHECK(flip(3, false).undecided);
  CHECK_FALSE(changeOf(compareResults({before}, {after}), "indirect_diffuse rmse against one_bounce_diffuse")
                  .undecided);
}

TEST_CASE("times must be further apart than those of the same point measured twice") {
  StoredRun before = runNumber(6), after = runNumber(6);
  before.point.frameMs = exactly(10.0);
  after.point.frameMs = exactly(11.0);
  const auto control = [](double ms, double again) {
    return RepeatedControl{"2026-01-31 12:00:00 UTC", {ms, 0.0}, {1.0, 0.0}, {again, 0.0}, {1.0, 0.0}};
  };
  CHECK(changeOf(compareResults({before}, {after}, timeFloorOf({})), "frame ms").significant);
  const TimeFloor quiet = timeFloorOf({control(8.0, 8.2), control(5.0, 4.8)});
  CHECK(quiet.controls == 2);
  CHECK(quiet.frame == Approx(5.0 / 4.8 - 1.0));
  CHECK(changeOf(compareResults({before}, {after}, quiet), "frame ms").significant);
  const TimeFloor restless = timeFloorOf({control(8.0, 9.6), control(5.0, 4.8)});
  CHECK(restless.frame == Approx(0.2));
  CHECK_FALSE(changeOf(compareResults({before}, {after}, restless), "frame ms").significant);
}

TEST_CASE("points are matched by what they are called, and what cannot be compared is named") {
  StoredRun old = runNumber(1), now = runNumber(1);
  now.identity.device = "another device";
  const RunComparison times =
      compareResults({old, runNumber(2), runNumber(3)}, {now, runNumber(2), runNumber(4)});
  CHECK(times.compared == 2);
  for (const auto& [names, told] : {std::pair(times.onlyBefore, Tells("cones=3")),
                                    {times.onlyAfter, Tells("cones=4")},
                                    {times.incomparable, Tells("devices")}}) {
    REQUIRE(names.size() == 1);
    CHECK_THAT(names[0], told);
  }
  for (const RunChange& change : times.changes) CHECK_FALSE(change.significant);

  now = runNumber(1);
  now.identity.sceneHash = "other";
  CHECK(compareResults({old}, {now}).incomparable.size() == 1);
  now.point.failure = "4 GiB do not fit";
  CHECK_THAT(compareResults({old}, {now}).incomparable.at(0), Tells("fails"));
}
