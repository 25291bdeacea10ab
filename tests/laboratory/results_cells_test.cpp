// Stress cells and peak rates of devices in the results store.
#include <cmath>

#include "lumivox/base/error.h"
#include "lumivox/results/store.h"
#include "lumivox/results/stress_cells.h"
#include "stored_records.h"
#include "support/facts.h"
#include "support/support.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

PeakRate peakRateNamed(const std::string& name, double rate, const std::string& created) {
  return {name,    "writes/s", {rate, rate, rate, rate, rate, 3}, created, "0.1.0", "a device", "a driver",
          "spirv", "a host"};
}

}  // namespace

TEST_CASE("a cell of the stress battery comes back as it was stored") {
  const TemporaryDirectory directory;
  const auto file = directory.path() / "results.sqlite";
  StressCell cell = cellNumber(1);
  cell.value = {kNan, kNan};
  ResultsStore(file).add({cell});
  const std::vector<StressCell> cells = ResultsStore(file, ResultsStore::Mode::read).stressCells();
  REQUIRE(cells.size() == 1);
  CHECK(cells[0].key() == cell.key());
  CHECK(std::isnan(cells[0].value.value));
  // Everything else in one: the JSON holds all of a cell but its number.
  StressCell numberless = cells[0];
  numberless.id = 0;
  CHECK(stressCellJson(numberless) == stressCellJson(cell));
  CHECK(stressCellJson(stressCellFrom(stressCellJson(cell))) == stressCellJson(cell));
  CHECK_THROWS_MATCHES(stressCellFrom("{\"case\": 1}"), Error, Tells("is not a cell"));
}

TEST_CASE("a newer cell takes the place of the older, and cells are chosen and removed by what they are") {
  const TemporaryDirectory directory;
  ResultsStore store(directory.path() / "results.sqlite");
  store.add({cellNumber(1), cellNumber(2), cellNumber(3)});
  StressCell again = cellNumber(2);
  again.outcome = StressOutcome::stable;
  store.add({again});
  CHECK(store.stressCells().size() == 3);
  const auto count = [&](auto set) {
    CellFilter filter;
    set(filter);
    CHECK_FALSE(filter.everything());
    return store.stressCells(filter).size();
  };
  CHECK(count([](CellFilter& f) { f.outcome = StressOutcome::stable; }) == 1);
  CHECK(count([](CellFilter& f) { f.outcome = StressOutcome::broken; }) == 1);
  CHECK(count([](CellFilter& f) { f.family = "geometry"; }) == 2);
  CHECK(count([](CellFilter& f) { f.name = "case_2"; }) == 1);
  CHECK(count([](CellFilter& f) { f.pipeline = "one"; }) == 3);
  CHECK(count([](CellFilter& f) { f.pipeline = "two"; }) == 0);
  CHECK(count([](CellFilter& f) { f.technique = "two"; }) == 0);
  CHECK(count([](CellFilter& f) { f.device = "dev"; }) == 3);
  CHECK(count([](CellFilter& f) { f.since = "2016-01-01"; }) == 0);
  CellFilter geometry;
  geometry.family = "geometry";
  CHECK(store.removeCells(geometry) == 2);
  CHECK(store.stressCells().size() == 1);
  CHECK(store.stressCells()[0].techniques.size() == 2);
}

TEST_CASE("merging takes over stress cells and peak rates that are newer, once") {
  const TemporaryDirectory directory;
  ResultsStore mine(directory.path() / "mine.sqlite"), theirs(directory.path() / "theirs.sqlite");
  StressCell newer = cellNumber(2), older = cellNumber(3);
  newer.created = "2016-10-21 16:29:00 UTC";
  older.created = "2014-10-21 16:29:00 UTC";
  mine.add({cellNumber(1), cellNumber(2), cellNumber(3)});
  theirs.add({newer, older, cellNumber(4)});
  mine.add({peakRateNamed("writes", 1.0, "2015"), peakRateNamed("atomics", 1.0, "2015")});
  theirs.add({peakRateNamed("writes", 2.0, "2016"), peakRateNamed("atomics", 2.0, "2014"),
              peakRateNamed("samples", 2.0, "2014")});
  theirs.add(runNumber(1));
  const MergeCount first = mine.merge(theirs), second = mine.merge(theirs);
  CHECK(first.runs == 1);
  CHECK(first.cells == 2);
  CHECK(first.peakRates == 2);
  CHECK(second.runs + second.cells + second.peakRates == 0);
  CHECK(mine.stressCells().size() == 4);
  for (const PeakRate& peakRate : mine.peakRates("a device", "a driver", "spirv", "a host"))
    CHECK(peakRate.rate.median == (peakRate.name == "atomics" ? 1.0 : 2.0));
  CHECK(mine.peakRates("a device", "another driver", "spirv", "a host").empty());
}

TEST_CASE("the newest cells are full ones where there are any") {
  StressCell quick = cellNumber(1), full = cellNumber(1), later = cellNumber(1);
  full.size = "full";
  later.created = "2016-10-21 16:29:00 UTC";
  CHECK(newestCells({quick, later}).at(0).created == later.created);
  CHECK(newestCells({full, later}).at(0).size == "full");
  CHECK(newestCells({later, full}).at(0).size == "full");
  CHECK(newestCells({quick, cellNumber(2)}).size() == 2);
}
