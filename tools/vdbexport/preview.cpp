#include "vdbexport/preview.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "lumivox/base/error.h"
#include "lumivox/measure/exposure.h"
#include "lumivox/page/contact_sheet.h"

namespace lumivox::vdb {
namespace {

using openvdb::Coord;
using openvdb::CoordBBox;

constexpr std::array kAxes{"x", "y", "z"};

openvdb::Vec3f shownValue(float value) {
  return openvdb::Vec3f(std::abs(value));
}
openvdb::Vec3f shownValue(std::int32_t value) {
  return openvdb::Vec3f(std::abs(static_cast<float>(value)));
}
openvdb::Vec3f shownValue(bool value) {
  return openvdb::Vec3f(value ? 1.0f : 0.0f);
}
openvdb::Vec3f shownValue(const openvdb::Vec3f& value) {
  return {std::abs(value.x()), std::abs(value.y()), std::abs(value.z())};
}

/// Views of a box of voxels, before anything is drawn.
std::vector<ImageBuffer> blank(const Coord& size) {
  std::vector<ImageBuffer> views;
  views.emplace_back(size.z(), size.y(), 3);
  views.emplace_back(size.x(), size.z(), 3);
  views.emplace_back(size.x(), size.y(), 3);
  return views;
}

/// The larger of both; NaN stays, so that it is seen.
void raise(ImageBuffer& view, int x, int y, const openvdb::Vec3f& value) {
  for (int c = 0; c < 3; ++c) {
    float& pixel = view.at(x, y, c);
    if (std::isnan(value[c]) || value[c] > pixel) pixel = value[c];
  }
}

template <class Grid>
std::vector<ImageBuffer> projected(const Grid& grid) {
  const CoordBBox box = grid.evalActiveVoxelBoundingBox();
  if (box.empty()) return blank({1, 1, 1});
  const Coord low = box.min(), size = box.dim();
  std::vector<ImageBuffer> views = blank(size);
  for (auto value = grid.cbeginValueOn(); value; ++value) {
    const openvdb::Vec3f shown = shownValue(value.getValue());
    CoordBBox voxels;  // one, or those of a tile
    value.getBoundingBox(voxels);
    for (auto voxel = voxels.begin(); voxel; ++voxel) {
      const Coord at = *voxel - low;
      const int row = size.y() - 1 - at.y();
      raise(views[0], size.z() - 1 - at.z(), row, shown);
      raise(views[1], at.x(), at.z(), shown);
      raise(views[2], at.x(), row, shown);
    }
  }
  return views;
}

}  // namespace

std::vector<ImageBuffer> projections(const openvdb::GridBase& grid) {
  if (grid.isType<openvdb::FloatGrid>()) return projected(static_cast<const openvdb::FloatGrid&>(grid));
  if (grid.isType<openvdb::Vec3SGrid>()) return projected(static_cast<const openvdb::Vec3SGrid&>(grid));
  if (grid.isType<openvdb::BoolGrid>()) return projected(static_cast<const openvdb::BoolGrid&>(grid));
  if (grid.isType<openvdb::Int32Grid>()) return projected(static_cast<const openvdb::Int32Grid&>(grid));
  throw Error(fmt::format("grid '{}' is of type {}; expected float, vec3s, bool or int32", grid.getName(),
                          grid.valueType()));
}

void Preview::add(const std::vector<openvdb::GridBase::ConstPtr>& grids, const std::string& frame) {
  for (const auto& grid : grids) {
    const openvdb::Metadata::ConstPtr unit = (*grid)["lumivox.unit"];
    std::vector<ImageBuffer> views = projections(*grid);
    for (std::size_t axis = 0; axis < views.size(); ++axis)
      panels_.push_back(
          {grid->getName(),
           fmt::format("{}{} along {}", frame.empty() ? "" : frame + ": ", grid->getName(), kAxes[axis]),
           unit && unit->str().find("W/(sr") != std::string::npos, std::move(views[axis])});
  }
  columns_ = std::max(columns_, static_cast<int>(grids.size() * kAxes.size()));
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
