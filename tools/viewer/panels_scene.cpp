// The panel of the scene: its parts and their edits.
#include <fmt/format.h>

#include <algorithm>
#include <glm/gtc/constants.hpp>
#include <map>

#include "viewer/panel_rows.h"

namespace lumivox::viewer {
namespace {

constexpr double kBrightest = 1e6;                   // of controls; statements accept more
constexpr double kFarthest = 1e6;                    // m
constexpr double kSharpestExponent = 1e5;            // of the narrowest Phong lobes in use
constexpr double kDensest = 1e3;                     // 1/m
constexpr double kMostAnisotropy = 0.999;            // the limit of texts
constexpr double kNarrowest = 0.1, kWidest = 179.0;  // deg, the limits of texts

template <class Vector>
std::array<double, 3> threeOf(const Vector& value) {
  return {value.x, value.y, value.z};
}

/// The edit of a part; an empty edit if it has none.
template <class Edit>
const Edit& editOf(const std::map<std::string, Edit>& edits, const std::string& name) {
  static const Edit none;
  const auto found = edits.find(name);
  return found == edits.end() ? none : found->second;
}

/// The row of an editable part; after an edit it is marked and has a reset to the text.
Row ofPart(Row row, const std::string& part, bool changed) {
  row.changed = changed;
  if (changed) row.resets.push_back({"reset", "reset " + quoted(part)});
  return row;
}

const char* unitOf(const Scene& scene, const EditableLight& light) {
  if (light.area) return "radiance, W/(sr m2)";
  for (const Light& one : scene.lights)
    if (one.name == light.name && one.kind == LightKind::directional) return "irradiance, W/m2";
  return "intensity, W/sr";
}

void addLights(std::vector<Row>& rows, const Session& session) {
  const SceneEdits& edits = session.state().edits;
  for (const EditableLight& light : editableLights(session.scene())) {
    const auto edit = edits.powers.find(light.name);
    if (light.keyed) continue;
    rows.push_back(heading("light " + light.name));
    rows.push_back(ofPart(triple("power " + light.name, unitOf(session.scene(), light),
                                 threeOf(edit == edits.powers.end() ? light.power : edit->second), 0,
                                 kBrightest, "light " + quoted(light.name) + " { power {} }",
                                 "red, green and blue; - and + halve and double"),
                          "light " + light.name, edit != edits.powers.end()));
  }
  rows.push_back(heading("sky"));
  rows.push_back(ofPart(
      triple("sky", "radiance, W/(sr m2)", threeOf(edits.environment.value_or(session.scene().environment)),
             0, kBrightest, "environment {}",
             session.scene().environmentMap && !edits.environment
                 ? "mean of the map; a value here takes its place, the same from all directions"
                 : "of the environment, from all directions"),
      "environment", edits.environment.has_value()));
}

void addMaterials(std::vector<Row>& rows, const Session& session) {
  const SceneEdits& edits = session.state().edits;
  for (const Material& material : editableMaterials(session.scene())) {
    const MaterialEdit& edit = editOf(edits.materials, material.name);
    const std::string part = "material " + material.name,
                      statement = "material " + quoted(material.name) + " { ";
    rows.push_back(heading(part));
    rows.push_back(ofPart(
        triple("diffuse " + material.name, "diffuse albedo", threeOf(edit.diffuse.value_or(material.diffuse)),
               0, 1, statement + "diffuse {} }", "diffuse + specular is at most 1"),
        part, edit.diffuse.has_value()));
    rows.push_back(ofPart(triple("specular " + material.name, "specular albedo",
                                 threeOf(edit.specular.value_or(material.specular)), 0, 1,
                                 statement + "specular {} }", "of the Phong lobe, at normal incidence"),
                          part, edit.specular.has_value()));
    Row exponent =
        number("exponent " + material.name, "Phong exponent", edit.exponent.value_or(material.exponent), 0,
               kSharpestExponent, false, statement + "exponent {} }", "of the Phong lobe");
    exponent.logarithmic = true;
    rows.push_back(ofPart(std::move(exponent), part, edit.exponent.has_value()));
    rows.push_back(ofPart(triple("emission " + material.name, "emission, W/(sr m2)",
                                 threeOf(edit.emission.value_or(material.emission)), 0, kBrightest,
                                 statement + "emission {} }", "radiance of its front side"),
                          part, edit.emission.has_value()));
  }
}

void addMedia(std::vector<Row>& rows, const Session& session) {
  const SceneEdits& edits = session.state().edits;
  for (const Medium& medium : session.scene().media) {
    const MediumEdit& edit = editOf(edits.media, medium.name);
    const std::string part = "medium " + medium.name, statement = "medium " + quoted(medium.name) + " { ";
    rows.push_back(heading(part));
    rows.push_back(ofPart(triple("extinction " + medium.name, "extinction, 1/m",
                                 threeOf(edit.extinction.value_or(medium.extinction)), 0, kDensest,
                                 statement + "extinction {} /m }", "where its density is 1"),
                          part, edit.extinction.has_value()));
    rows.push_back(
        ofPart(triple("albedo " + medium.name, "albedo", threeOf(edit.albedo.value_or(medium.albedo)), 0, 1,
                      statement + "albedo {} }", "scattering / extinction"),
               part, edit.albedo.has_value()));
    rows.push_back(ofPart(
        number("anisotropy " + medium.name, "anisotropy g", edit.anisotropy.value_or(medium.anisotropy),
               -kMostAnisotropy, kMostAnisotropy, false, statement + "anisotropy {} }",
               "mean cosine of the scattering angle (Henyey-Greenstein)"),
        part, edit.anisotropy.has_value()));
  }
}

void addCameras(std::vector<Row>& rows, const Session& session) {
  const SceneEdits& edits = session.state().edits;
  const Camera here = cameraOf(session.state(), session.shownScene());
  for (const Camera& camera : session.scene().cameras) {
    const CameraEdit& edit = editOf(edits.cameras, camera.name);
    const std::string part = "camera " + camera.name, statement = "camera " + quoted(camera.name) + " { ";
    rows.push_back(heading(part));
    const double degrees = 180.0 / glm::pi<double>();
    if (!moves(camera)) {
      rows.push_back(
          ofPart(triple("eye " + camera.name, "position, m", threeOf(edit.eye.value_or(camera.eye)),
                        -kFarthest, kFarthest, statement + "eye {} }"),
                 part, edit.eye.has_value()));
      rows.push_back(
          ofPart(triple("target " + camera.name, "target, m", threeOf(edit.target.value_or(camera.target)),
                        -kFarthest, kFarthest, statement + "target {} }"),
                 part, edit.target.has_value()));
      rows.push_back(
          button("place " + camera.name, "as I look now",
                 statement + fmt::format("eye {} target {} fov {} rad }}", written(threeOf(here.eye)),
                                         written(threeOf(here.target)), here.fov)));
    }
    if (hasKeysOfFov(camera)) continue;
    rows.push_back(
        ofPart(number("fov " + camera.name, "field of view, deg", degrees * edit.fov.value_or(camera.fov),
                      kNarrowest, kWidest, false, statement + "fov {} deg }", "the full vertical angle"),
               part, edit.fov.has_value()));
  }
}

}  // namespace

Panel scenePanel(const Session& session) {
  Panel panel{"scene", "Scene", {}};
  const SceneEdits& edits = session.state().edits;
  panel.rows.push_back(text("name", "scene", session.scene().name));
  panel.rows.push_back(button("undo", fmt::format("undo ({})", session.undoable()), "undo 1", "Ctrl Z"));
  panel.rows.push_back(button("reset", "all as in the text", "reset scene"));
  for (const std::string& part : partsOf(session.scene())) {
    const bool on = edits.off.count(part) == 0;
    panel.rows.push_back(toggle(part, part, on, (on ? "off " : "on ") + quoted(part)));
  }
  addLights(panel.rows, session);
  addMaterials(panel.rows, session);
  addMedia(panel.rows, session);
  addCameras(panel.rows, session);
  return panel;
}

}  // namespace lumivox::viewer
