// Statements that change the view, which are not undone.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lumivox/base/error.h"
#include "lumivox/scene/free_camera.h"
#include "viewer/session.h"

namespace lumivox::viewer {
namespace {

template <class Word>
Word wordOf(const std::vector<std::string>& words, const std::string& text) {
  return static_cast<Word>(std::find(words.begin(), words.end(), text) - words.begin());
}

}  // namespace

void Session::freeCamera(const std::function<Camera(Camera)>& change) {
  Camera camera = change(cameraOf(state_, *edited_));
  camera.name = "view";
  // Many small steps could lead beyond the limit of a single statement.
  for (const glm::dvec3& place : {camera.eye, camera.target})
    for (int axis = 0; axis < 3; ++axis)
      if (!(std::abs(place[axis]) <= kFarthest))
        throw Error(
            fmt::format("the camera stays where it is: expected its eye and target within {:g} m of the "
                        "origin along each axis",
                        kFarthest));
  if (!(glm::distance(camera.eye, camera.target) >= kNearest))
    throw Error(
        fmt::format("the camera stays where it is: expected its target at least {:g} m away", kNearest));
  snapshotFrom(*scene_, state_.time, camera, state_.width, state_.height);  // refuses one that looks nowhere
  state_.free = std::move(camera);
}

/// The camera moved back along its direction until it sees all of an object, or of the scene.
Camera Session::framed(const Camera& camera, const std::string& what) const {
  const SceneSnapshot snapshot = snapshotFrom(*edited_, state_.time, camera, state_.width, state_.height);
  Bounds bounds;
  std::vector<std::string> names{"all"};
  for (std::size_t i = 0; i < edited_->objects.size(); ++i) {
    const Object& object = edited_->objects[i];
    names.push_back(object.name);
    if (what != "all" && what != object.name) continue;
    const ObjectState& state = snapshot.objects[i];
    for (std::uint32_t v = 0; v < object.vertexCount; ++v) {
      const glm::vec3& place =
          state.positions.empty() ? edited_->positions[object.firstVertex + v] : state.positions[v];
      bounds.grow(glm::vec3(state.toWorld * glm::vec4(place, 1.0f)));
    }
  }
  if (bounds.empty)
    throw Error(fmt::format("frame '{}': no such object; expected one of {}", what, fmt::join(names, ", ")));
  const glm::dvec3 low(bounds.low), high(bounds.high), centre = snapshot.origin + 0.5 * (low + high);
  // The bounding box's sphere touches the borders of the view.
  const double up = std::tan(0.5 * camera.fov), across = up * state_.width / state_.height;
  const double distance = 0.5 * glm::distance(low, high) / std::sin(std::atan(std::min(up, across)));
  Camera result = camera;
  result.eye = centre - distance * glm::normalize(camera.target - camera.eye);
  result.target = centre;
  return result;
}

bool Session::doLook(const Action& action) {
  const std::string& word = action.word();
  const auto vector = [&] {
    const std::vector<double> n = action.numbers();
    return glm::dvec3(n[0], n[1], n[2]);
  };
  if (word == "camera" && action.property != nullptr) {
    state_.camera = scene_->camera(action.text()).name;
    state_.free.reset();
  } else if (word == "eye") {
    freeCamera([&](Camera camera) { return camera.eye = vector(), camera; });
  } else if (word == "target") {
    freeCamera([&](Camera camera) { return camera.target = vector(), camera; });
  } else if (word == "fov") {
    freeCamera([&](Camera camera) { return camera.fov = action.number(), camera; });
  } else if (word == "move") {
    freeCamera([&](const Camera& camera) { return moved(camera, vector()); });
  } else if (word == "turn" || word == "orbit") {
    const std::vector<double> n = action.numbers();
    freeCamera([&](const Camera& camera) {
      return word == "turn" ? turned(camera, n[0], n[1]) : orbited(camera, n[0], n[1]);
    });
  } else if (word == "zoom") {
    freeCamera([&](const Camera& camera) { return zoomed(camera, action.number()); });
  } else if (word == "time") {
    state_.time = action.number();
  } else if (word == "play") {
    state_.plays = action.flag();
  } else if (word == "speed") {
    state_.speed = action.number();
  } else if (word == "loop") {
    state_.loop = action.number();
  } else if (word == "frame") {
    freeCamera([&](const Camera& camera) { return framed(camera, action.text()); });
  } else if (word == "size") {
    const std::vector<double> n = action.numbers();
    state_.width = static_cast<int>(n[0]);
    state_.height = static_cast<int>(n[1]);
  } else if (word == "output") {
    const std::string name = action.text();
    std::vector<std::string> names{kWholeImage};
    for (const Pipeline::Output& output : state_.sides.front().pipeline->outputs)
      names.push_back(output.name);
    if (std::find(names.begin(), names.end(), name) == names.end())
      throw Error(fmt::format("output '{}': expected one of {}", name, fmt::join(names, ", ")));
    state_.output = name;
    state_.port.reset();
  } else if (word == "layout") {
    state_.layout = wordOf<Layout>(layoutWords(), action.text());
  } else if (word == "error_map") {
    state_.errorMap = wordOf<ErrorMap>(errorMapWords(), action.text());
  } else if (word == "split") {
    state_.split = action.number();
  } else if (word == "exposure") {
    state_.exposure.reset();
    if (action.text() != "auto") state_.exposure = action.number();
  } else if (word == "tone") {
    state_.curve = wordOf<Curve>(curveWords(), action.text());
  } else if (word == "samples") {
    state_.samples = static_cast<int>(action.number());
  } else if (word == "reference") {
    state_.traces = action.flag();
  } else if (word == "times") {
    state_.timesPasses = action.flag();
  } else if (word == "work") {
    state_.countsWork = action.flag();
  } else {
    return doLookAtPort(action);
  }
  return true;
}

bool Session::doLookAtPort(const Action& action) {
  const std::string& word = action.word();
  if (word == "see_through") {
    state_.seeThrough = action.number();
  } else if (word == "port") {
    const std::string name = action.text();
    const std::size_t dot = name.find('.');
    if (name == "nothing") {
      state_.port.reset();
    } else if (dot == std::string::npos) {
      throw Error(fmt::format("port '{}': expected PASS.PORT, or nothing", name));
    } else {
      state_.port.emplace();
      state_.port->pass = name.substr(0, dot);
      state_.port->port = name.substr(dot + 1);
    }
  } else if (word == "texture" || word == "voxels" || word == "channel" || word == "level" ||
             word == "slice" || word == "above") {
    if (!state_.port) throw Error(word + ": no port is shown; expected `port PASS.PORT` before");
    PortChoice& port = *state_.port;
    if (word == "texture") port.texture = action.text(), port.field.clear();
    if (word == "voxels") port.field = action.text() == "nothing" ? std::string() : action.text();
    if (word == "channel") port.channel = wordOf<Channel>(channelWords(), action.text());
    if (word == "level") port.level = static_cast<int>(action.number());
    if (word == "slice") port.slice = static_cast<int>(action.number());
    if (word == "above") port.above = static_cast<float>(action.number());
  } else {
    return false;
  }
  return true;
}

}  // namespace lumivox::viewer
