// Time: a frame equals that of a fresh start, whatever was rendered before.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "experiment/measure.h"
#include "lumivox/base/error.h"
#include "stress/case_tools.h"

namespace lumivox::stress {
namespace {

constexpr const char* kBox = "room/box";

/// A camera on a path, a turning and travelling box, a travelling area light, sky and rising smoke; full:
/// also a sun.
Scene everythingMoves(const Bench& bench) {
  std::string text = R"(scene "Everything moves" {
  camera main {
    fov 44 deg
    resolution 48 48
    key { time 0 s  eye 0 1.2 3.4  target 0 0.9 0 }
    key { time 1 s  eye 0.5 1 3  target 0 0.8 0 }
  }
  mesh room { file "../models/skylight.obj" }
  mesh lamp { file "../models/quad.obj"  scale 0.4  rotate 1 0 0 180 deg  translate -0.4 1.8 0 }
  light shine area { mesh lamp  radiance 8 7 6 }
  environment { radiance 0.1 0.1 0.2 }
  medium smoke {
    extinction 0.6 /m
    albedo 0.7
    anisotropy 0.3
    particles 60
    source 0 0.3 0.3
    spread 0.2
    radius 0.15
    rise 0.3 m/s
    drift 0.05 m/s
    life 4 s
  }
  animate room/box { rotate 0 1 0 45 deg/s  translate 0.3 0 0 }
  animate lamp { translate 0.2 0 0.1 }
)";
  if (!bench.quick()) text += "  light sun directional { direction 0.2 -1 0.15  irradiance 10 10 9 }\n";
  return bench.sceneFromText(text + "}\n");
}

/// Number of values of two frames' images that differ in a bit, and the largest difference.
struct Difference {
  std::size_t count = 0, total = 0;
  double largest = 0.0;
  void add(const ImageBuffer& a, const ImageBuffer& b) {
    for (std::size_t i = 0; i < a.values().size(); ++i) {
      ++total;
      if (a.values()[i] == b.values()[i]) continue;
      ++count;
      largest = std::max(largest, std::abs(static_cast<double>(a.values()[i]) - b.values()[i]));
    }
  }
};

/// Whether the last frame differs from the one before it.
enum class Step { moves, rests };

/// Compares the last frame of a sequence with the same frame of a fresh start.
Finding lastAgainstAlone(Bench& bench, const Scene& scene, const std::vector<double>& times,
                         const Edit& edit = {}, Step kind = Step::moves) {
  const char* const measure = "share of the last frame's numbers that differ from the same frame alone";
  const std::size_t last = times.size() - 1;
  const Edit editLast = [&](std::size_t, SceneSnapshot& snapshot) { edit(last, snapshot); };
  // Remains of earlier frames also show with few samples and pixels.
  Shot shot;
  if (bench.quick()) {
    shot.width = shot.height = 32;
    shot.parameters["area_samples"].number = 4;
    shot.parameters["smoke_resolution"].number = 16;
  }
  Shot alone = shot;
  alone.firstFrame = static_cast<int>(last);
  if (!makesImages(bench)) {
    const bool same = bench.contentOfSequence(scene, times, shot, edit) ==
                      bench.contentOfSequence(scene, {times[last]}, alone, edit ? editLast : Edit{});
    return judged("bits of the last frame's last pass differ from the same frame alone (0 or 1)",
                  {same ? 0.0 : 1.0, 0.0}, 0.0);
  }
  const std::vector<Frame> frames = bench.renderSequence(scene, times, shot, edit);
  const Frame& sequence = frames.back();
  // The last frame proves nothing unless something changed before it.
  if (kind == Step::moves && frames[last - 1].compared.values() == sequence.compared.values())
    throw Error("the last two frames are the same: the case shows nothing");
  const Frame fresh = bench.renderSequence(scene, {times[last]}, alone, edit ? editLast : Edit{}).back();
  bench.show(sequence.compared);
  Difference difference;
  std::string detail;
  for (const auto& [name, image] : sequence.result.outputs) {
    Difference of;
    of.add(image, fresh.result.outputs.at(name));
    difference.count += of.count;
    difference.total += of.total;
    detail += fmt::format("{}{}: {} of {}, by {:.3g} at most", detail.empty() ? "" : "; ", name, of.count,
                          of.total, of.largest);
  }
  const double share = difference.total == 0
                           ? 0.0
                           : static_cast<double>(difference.count) / static_cast<double>(difference.total);
  return judged(measure, {share, 0.0}, 0.0, difference.count == 0 ? "" : detail);
}

Finding lastAgainstAlone(Bench& bench, const std::vector<double>& times, const Edit& edit = {},
                         Step kind = Step::moves) {
  return lastAgainstAlone(bench, everythingMoves(bench), times, edit, kind);
}

std::size_t boxOf(const Scene& scene) {
  const auto box = std::find_if(scene.objects.begin(), scene.objects.end(),
                                [](const Object& object) { return object.name == kBox; });
  if (box == scene.objects.end()) throw Error(fmt::format("the scene has no object '{}'", kBox));
  return static_cast<std::size_t>(box - scene.objects.begin());
}

/// Moves the box by so much in the given frames.
Edit boxMoved(Bench& bench, const glm::vec3& by, const std::vector<std::size_t>& frames) {
  const std::size_t box = boxOf(everythingMoves(bench));
  return [=](std::size_t frame, SceneSnapshot& snapshot) {
    if (std::find(frames.begin(), frames.end(), frame) == frames.end()) return;
    glm::mat4& toWorld = snapshot.objects[box].toWorld;
    toWorld = glm::translate(glm::mat4(1.0f), by) * toWorld;
  };
}

std::optional<Finding> teleportedCamera(Bench& bench) {
  // Frame 1 sees the room from its other end, frame 2 from a hundred metres away.
  return lastAgainstAlone(bench, {0.4, 0.4, 0.4, 0.4}, [](std::size_t frame, SceneSnapshot& snapshot) {
    CameraView& camera = snapshot.camera;
    if (frame == 1) {
      camera.eye = glm::vec3(-0.6f, 0.6f, -0.7f);
      camera.right = -camera.right;
      camera.forward = -camera.forward;
    }
    if (frame == 2) camera.eye -= 100.0f * camera.forward;
  });
}

/// A camera stands, jumps and returns while frames accumulate. Its image must then equal that of a fresh
/// start at that view after as many frames.
std::optional<Finding> accumulatingTeleport(Bench& bench) {
  if (!experiment::isProgressive(bench.pipeline(), bench.techniques()))
    return notApplicable("no pass of it goes on from earlier frames");
  const Scene scene = everythingMoves(bench);
  enum class View { home, otherEnd, faraway };
  const auto editOf = [](const std::vector<View>& views) {
    return [views](std::size_t frame, SceneSnapshot& snapshot) {
      CameraView& camera = snapshot.camera;
      const View view = views.at(frame);
      if (view == View::otherEnd) {
        camera.eye = glm::vec3(-0.6f, 0.6f, -0.7f);
        camera.right = -camera.right;
        camera.forward = -camera.forward;
      }
      if (view == View::faraway) camera.eye -= 100.0f * camera.forward;
    };
  };
  Shot shot;
  shot.accumulate = true;
  shot.width = shot.height = bench.quick() ? 32 : 48;
  constexpr double kTime = 0.4;
  const std::vector<View> views{View::home,     View::home,    View::home, View::otherEnd, View::otherEnd,
                                View::otherEnd, View::faraway, View::home, View::home,     View::home};
  const std::vector<Frame> frames =
      bench.renderSequence(scene, std::vector<double>(views.size(), kTime), shot, editOf(views));
  const auto same = [](const Frame& a, const Frame& b) { return a.compared.values() == b.compared.values(); };
  if (same(frames[0], frames[2])) throw Error("frames in a row are the same: the case shows nothing");
  if (same(frames[2], frames[5])) throw Error("both views are the same: the case shows nothing");
  Difference difference;
  std::string detail;
  for (const auto& [last, where] :
       {std::pair<std::size_t, const char*>{5, "at the other end"}, {9, "back again"}}) {
    const std::vector<View> stay(3, views[last]);
    Shot fresh = shot;
    fresh.firstFrame = static_cast<int>(last) - 2;
    const std::vector<Frame> alone =
        bench.renderSequence(scene, std::vector<double>(stay.size(), kTime), fresh, editOf(stay));
    Difference of;
    of.add(frames[last].compared, alone.back().compared);
    difference.count += of.count;
    difference.total += of.total;
    detail += fmt::format("{}{}: {} of {}, by {:.3g} at most", detail.empty() ? "" : "; ", where, of.count,
                          of.total, of.largest);
  }
  bench.show(frames.back().compared);
  return judged(
      "share of the numbers three frames after a jump that differ from a fresh start's three frames",
      {static_cast<double>(difference.count) / static_cast<double>(difference.total), 0.0}, 0.0,
      difference.count == 0 ? "" : detail);
}

constexpr float kAway = 1e4f;  // m

}  // namespace

std::vector<Case> timeCases() {
  const std::string family = "time";
  return {
      {{family, "frame_of_a_sequence", "The fourth frame of a moving scene against the same frame alone",
        true},
       [](Bench& bench) {
         return lastAgainstAlone(bench, {0.0, 0.1, 0.3, 0.5});
       }},
      {{family, "deforming_object",
        "A cloth waves between a lamp and a floor: the fourth frame against the same frame alone", false},
       [](Bench& bench) {
         return lastAgainstAlone(bench, bench.committedScene("waving_cloth"), {0.0, 0.2, 0.7, 0.4});
       }},
      {{family, "teleporting_camera",
        "The camera jumps to the other end of the room and a hundred metres away, and back: no trace stays",
        false},
       teleportedCamera},
      {{family, "accumulation_teleport",
        "The camera jumps to the other end of the room, far away and back while frames accumulate: after each "
        "jump the image of a fresh start",
        true},
       accumulatingTeleport},
      {{family, "teleporting_object",
        "A box jumps through the room within one instant, in every frame: no trace stays where it was",
        false},
       [](Bench& bench) {
         const Edit left = boxMoved(bench, {-0.6f, 0.0f, -0.5f}, {0, 2});
         const Edit right = boxMoved(bench, {0.5f, 0.7f, 0.3f}, {1});
         return lastAgainstAlone(bench, {0.2, 0.2, 0.2, 0.2},
                                 [=](std::size_t frame, SceneSnapshot& snapshot) {
                                   left(frame, snapshot);
                                   right(frame, snapshot);
                                 });
       }},
      {{family, "vanishing_object",
        "A box is there, and in the last frame ten kilometres away: no ghost of it stays", true},
       [](Bench& bench) {
         return lastAgainstAlone(bench, {0.2, 0.2, 0.2}, boxMoved(bench, {0.0f, -kAway, 0.0f}, {2}));
       }},
      {{family, "returning_object",
        "A box goes ten kilometres away and comes back: it is there as if it had stayed", false},
       [](Bench& bench) {
         return lastAgainstAlone(bench, {0.2, 0.2, 0.2}, boxMoved(bench, {0.0f, -kAway, 0.0f}, {1}));
       }},
      {{family, "zero_time_step", "Four frames of the same instant: the last against the same frame alone",
        false},
       [](Bench& bench) {
         return lastAgainstAlone(bench, {0.5, 0.5, 0.5, 0.5}, {}, Step::rests);
       }},
      {{family, "huge_time_step",
        "Between two frames a step of 10^9 s and back: the last against the same frame alone", false},
       [](Bench& bench) {
         return lastAgainstAlone(bench, {0.0, 1e9, 0.5});
       }},
      {{family, "after_a_huge_time_step", "The frame at 10^9 s itself against the same frame alone", false},
       [](Bench& bench) {
         return lastAgainstAlone(bench, {0.0, 0.5, 1e9});
       }},
      {{family, "time_backwards",
        "Time runs from 1 s backwards to -1 s: the last frame against the same alone", false},
       [](Bench& bench) {
         return lastAgainstAlone(bench, {1.0, 0.5, 0.0, -1.0});
       }},
  };
}

}  // namespace lumivox::stress
