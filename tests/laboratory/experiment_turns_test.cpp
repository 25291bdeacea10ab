// The protocol of times: points take turns, and a failure is a point's own.
#include <span>

#include "experiment/turns.h"
#include "framework/pipeline_toys.h"
#include "lumivox/base/error.h"
#include "support/scene_builder.h"
#include "support/techniques.h"

using namespace lumivox;
using namespace lumivox::test;
using experiment::Turn;

namespace {

/// Points of one toy pipeline. Who is opened, painted and read is written down.
class Turns {
 public:
  Turns() {
    toys_.add<Paint>("toys", "paint");
    scene_ = litRoom(8, 8);
    pipeline_ = Pipeline::parse(
        "pipeline \"Toy\" {\n  pass a toys.paint { }\n  output direct a.radiance\n}\n", "toy.pipeline");
  }
  Turn turn(const std::string& name, ReportPoint& point) {
    return {
        name, [this, name, &point](const std::shared_ptr<TransientMemory>& memory) {
          events.push_back("open " + name);
          return experiment::TimedPoint({device(), toys_, scene_, options_, 8, 8, memory}, pipeline_, point);
        }};
  }
  /// Points "a", "b" ..., and their turns.
  std::vector<Turn> turnsOf(std::span<ReportPoint> points) {
    std::vector<Turn> all;
    for (std::size_t i = 0; i < points.size(); ++i) all.push_back(turn(std::string(1, "abcd"[i]), points[i]));
    return all;
  }
  std::vector<std::string> events;

 private:
  TestTechniques toys_;
  Scene scene_;
  Pipeline pipeline_;
  ReportOptions options_;
};

}  // namespace

TEST_CASE("points that are timed in turns have all their repeats and frames, and pass orders of one frame") {
  Turns turns;
  ReportPoint points[3];
  std::vector<Turn> all = turns.turnsOf(points);
  experiment::timeInTurns(device(), all, 3, 2);
  for (std::size_t i = 0; i < 3; ++i) {
    CHECK(all[i].failure.empty());
    CHECK(points[i].frameMs.repeats == 3);
    CHECK(points[i].nextFrameMs.repeats == 2);
    CHECK(points[i].stillFrameMs.repeats == 2);
    CHECK(points[i].movedFrameMs.repeats == 2);
    CHECK(points[i].passOrder == std::vector<std::string>{"a"});
    CHECK(points[i].passDeviceMs.at("a").repeats == 3);
  }
}

TEST_CASE("a point that fits alone but not beside others is timed after them, and has no failure") {
  Turns turns;
  ReportPoint points[4];
  std::vector<Turn> all = turns.turnsOf(points);
  // The third takes all memory: none may be open beside it.
  std::size_t open = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    const auto make = all[i].open;
    all[i].open = [&open, make, i, &turns](const std::shared_ptr<TransientMemory>& memory) {
      if (i == 2 && open > 0) {
        turns.events.push_back("refuse c");
        throw Error("c does not fit");
      }
      ++open;
      return make(memory);
    };
    all[i].read = [&open](experiment::TimedPoint&) { --open; };
  }
  experiment::timeInTurns(device(), all, 3, 0);
  CHECK(turns.events == std::vector<std::string>{"open a", "open b", "refuse c", "open c", "open d"});
  for (std::size_t i = 0; i < 4; ++i) {
    INFO(i << all[i].failure);
    CHECK(all[i].failure.empty());
    CHECK(points[i].frameMs.repeats == 3);
  }
}

TEST_CASE("a point that fails beside others is timed again alone, and costs no other") {
  Turns turns;
  ReportPoint points[4];
  std::vector<Turn> all = turns.turnsOf(points);
  int readings = 0;
  all[1].read = [&](experiment::TimedPoint&) {
    if (++readings == 1) throw Error("no memory for a moment");
  };
  all[2].open = [](const auto&) -> experiment::TimedPoint { throw Error("never"); };
  experiment::timeInTurns(device(), all, 3, 1);
  CHECK(turns.events == std::vector<std::string>{"open a", "open b", "open d", "open b"});
  CHECK(readings == 2);
  CHECK(all[2].failure == "never");
  for (const std::size_t i : {0u, 1u, 3u}) {
    CHECK(all[i].failure.empty());
    CHECK(points[i].frameMs.repeats == 3);
    CHECK(points[i].passOrder.size() == 1);
  }
  CHECK(points[2].frameMs.repeats == 0);
}
