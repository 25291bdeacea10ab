#include "stress/protocol.h"

#include <fmt/format.h>

#include "lumivox/base/error.h"

namespace lumivox::stress {
namespace {

using Json = nlohmann::ordered_json;

Json valuesJson(const ParameterValues& values) {
  Json json = Json::object();
  for (const auto& [name, value] : values)
    json[name] = value.word.empty() ? Json(value.number) : Json(value.word);
  return json;
}

ParameterValues valuesOf(const Json& json) {
  ParameterValues values;
  for (const auto& [name, value] : json.items()) {
    if (value.is_string())
      values[name].word = value.get<std::string>();
    else
      values[name].number = value.get<double>();
  }
  return values;
}

}  // namespace

WorkerDevice workerDeviceOf(const gpu::Device& device) {
  return {device.info().renderer, device.info().version, device.programRoute(), device.info().software};
}

std::string lineOf(const WorkerDevice& ready) {
  return Json{{"ready", ready.device},
              {"driver", ready.driver},
              {"shader_input", ready.shaderInput},
              {"software", ready.software}}
      .dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::optional<WorkerDevice> readyFrom(const std::string& line) {
  const Json json = Json::parse(line, nullptr, false);
  if (!json.is_object() || !json.contains("ready")) return std::nullopt;
  try {
    return WorkerDevice{json.at("ready"), json.at("driver"), json.at("shader_input"), json.at("software")};
  } catch (const nlohmann::json::exception&) {
    return std::nullopt;
  }
}

std::string lineOf(const CellRequest& request) {
  return Json{{"cell", request.name},
              {"pipeline", request.pipeline.string()},
              {"quick", request.quick},
              {"image", request.image.string()}}
      .dump();
}

std::string lineOf(const ContentRequest& request) {
  return Json{{"content", request.committedScene},
              {"pipeline", request.pipeline.string()},
              {"quick", request.quick},
              {"width", request.shot.width},
              {"height", request.shot.height},
              {"time", request.shot.time},
              {"seed", request.shot.seed},
              {"camera", request.shot.camera},
              {"parameters", valuesJson(request.shot.parameters)},
              {"pass_parameters", valuesJson(request.shot.passParameters)}}
      .dump();
}

AnyRequest requestOf(const std::string& line) {
  try {
    const Json json = Json::parse(line);
    AnyRequest request;
    const bool quick = json.at("quick");
    const std::string pipeline = json.at("pipeline");
    if (json.contains("cell")) {
      request.cell = CellRequest{pipeline, json.at("cell").get<std::string>(), quick,
                                 json.at("image").get<std::string>()};
      return request;
    }
    ContentRequest content{pipeline, json.at("content").get<std::string>(), quick, {}};
    content.shot.width = json.at("width");
    content.shot.height = json.at("height");
    content.shot.time = json.at("time");
    content.shot.seed = json.at("seed");
    content.shot.camera = json.at("camera");
    content.shot.parameters = valuesOf(json.at("parameters"));
    content.shot.passParameters = valuesOf(json.at("pass_parameters"));
    request.content = content;
    return request;
  } catch (const nlohmann::json::exception& error) {
    throw Error(fmt::format("'{}' is no request to a stress worker: {}", line, error.what()));
  }
}

}  // namespace lumivox::stress
