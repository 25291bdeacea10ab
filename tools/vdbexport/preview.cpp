#include "vdbexport/preview.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "lumivox/base/error.h"
#include "lumivox/measure/exposure.h"
#include "lumivox/page/contact_sheet.h"
#include "lumivox/toolkit/voxel_view.h"

namespace lumivox::vdb {

void Preview::add(const std::vector<NamedField>& fields, const std::string& frame) {
  const VoxelCanvas canvas(shaders_);
  for (const NamedField& named : fields) {
    const char* axis = "xyz";
    for (ImageBuffer& view : largestAlongAxes(canvas, VoxelField(canvas, named.field.onDevice))) {
      panels_.push_back({named.name,
                         fmt::format("{}{} along {}", frame.empty() ? "" : frame + ": ", named.name, *axis++),
                         named.field.unit.find("W/(sr") != std::string::npos, std::move(view)});
    }
  }
  columns_ = std::max(columns_, static_cast<int>(3 * fields.size()));
}

void Preview::write(const std::filesystem::path& file, const command::DisplayOptions& display) const {
  ExposureMeter meter;
  bool anyRadiance = false;
  std::map<std::string, float> largest;  // by grid
  for (const Panel& panel : panels_) {
    if (panel.radiance) meter.add(panel.image);
    anyRadiance = anyRadiance || panel.radiance;
    for (const float value : panel.image.values())
      if (std::isfinite(value)) largest[panel.grid] = std::max(largest[panel.grid], value);
  }
  const Display exposed{display.given().value_or(meter.exposure()), display.toneCurve()};
  Sheet sheet;
  sheet.columns = columns_;
  sheet.title = "Largest values along the axes";
  sheet.title += anyRadiance
                     ? fmt::format("; radiance at {}, {}", exposureText(exposed.exposure), display.tone)
                     : std::string();
  for (const Panel& panel : panels_) {
    Display own = exposed;
    std::string name = panel.name;
    if (!panel.radiance) {
      const double white = largest[panel.grid];
      own = {white > 0.0 ? std::clamp(-std::log2(white), -kLargestExposure, kLargestExposure) : 0.0,
             Tone::srgb};
      name += fmt::format(" (white: {:.3g})", white);
    }
    sheet.panels.push_back({name, panel.image, own});
  }
  writePng(file, contactSheet(sheet));
}

}  // namespace lumivox::vdb
