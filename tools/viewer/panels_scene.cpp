// What the scene consists of.
#include <fmt/format.h>

#include <algorithm>

#include "viewer/panel_rows.h"

namespace lumivox::viewer {

Panel scenePanel(const Session& session) {
  Panel panel{"scene", "Scene", {}};
  const SceneEdits& edits = session.state().edits;
  panel.rows.push_back(text("name", "scene", session.scene().name));
  for (const std::string& part : partsOf(session.scene())) {
    const bool on = edits.off.count(part) == 0;
    panel.rows.push_back(toggle(part, part, on, (on ? "off " : "on ") + quoted(part)));
  }
  for (const Light& light : session.scene().lights) {
    const auto edit = edits.powers.find(light.name);
    const glm::vec3 power = edit == edits.powers.end() ? light.power : edit->second;
    panel.rows.push_back(heading("light " + light.name));
    panel.rows.push_back(
        text("power " + light.name, "power", fmt::format("{:.4g} {:.4g} {:.4g}", power.x, power.y, power.z)));
    panel.rows.push_back(button("brighter " + light.name, "twice as bright",
                                fmt::format("light {} {{ power {} {} {} }}", quoted(light.name), 2 * power.x,
                                            2 * power.y, 2 * power.z)));
    panel.rows.push_back(button("darker " + light.name, "half as bright",
                                fmt::format("light {} {{ power {} {} {} }}", quoted(light.name), power.x / 2,
                                            power.y / 2, power.z / 2)));
  }
  for (const Material& material : session.scene().materials) {
    const auto found = edits.materials.find(material.name);
    const MaterialEdit* const edit = found == edits.materials.end() ? nullptr : &found->second;
    const glm::vec3 diffuse = edit != nullptr && edit->diffuse ? *edit->diffuse : material.diffuse;
    const float exponent = edit != nullptr && edit->exponent ? *edit->exponent : material.exponent;
    panel.rows.push_back(heading("material " + material.name));
    panel.rows.push_back(
        number("albedo " + material.name, "albedo", std::max({diffuse.x, diffuse.y, diffuse.z}), 0, 1, false,
               "material " + quoted(material.name) + " { diffuse {} }", "grey of this albedo"));
    if (material.glossy())
      panel.rows.push_back(number("exponent " + material.name, "Phong exponent", exponent, 0, 100000, false,
                                  "material " + quoted(material.name) + " { exponent {} }"));
  }
  return panel;
}

}  // namespace lumivox::viewer
