// The rooms made of few flat faces: the Cornell box, the corridor, the furnace and the room under a skylight.
#include "models.h"
#include "obj_model.h"

namespace lumivox::models {
namespace {

using Facing = ObjModel::Facing;

/// The published box is in millimetres; scenes are in metres.
glm::dvec3 millimetres(double x, double y, double z) {
  return glm::dvec3(x, y, z) / 1000.0;
}

/// A block of the Cornell box: a prism over the four corners of its top, given counter-clockwise as seen from
/// above.
void cornellBlock(ObjModel& model, const glm::dvec3 (&top)[4]) {
  model.flatQuad(top[0], top[1], top[2], top[3]);
  for (int i = 0; i < 4; ++i) {
    const glm::dvec3 a = top[i], b = top[(i + 1) % 4];
    model.flatQuad({a.x, 0, a.z}, {b.x, 0, b.z}, b, a);
  }
}

}  // namespace

// Cornell University Program of Computer Graphics, "Cornell Box Data" (1998): the measured vertices, the area
// light filling its hole in the ceiling. Albedos and the area light's radiance (set in the scene text) are
// the usual Rec. 709 values for the measured spectra. X points to the left when looking in, so the red wall,
// at high X, is the left one.
void writeCornell(const std::filesystem::path& directory) {
  ObjModel model("cornell",
                 "The measured Cornell box in metres, Cornell University Program of Computer Graphics");
  model.material({.name = "white", .diffuse = {0.725, 0.71, 0.68}});
  model.material({.name = "red", .diffuse = {0.63, 0.065, 0.05}});
  model.material({.name = "green", .diffuse = {0.14, 0.45, 0.091}});
  model.material({.name = "lamp", .diffuse = glm::dvec3(0.78)});

  const auto m = millimetres;
  model.object("floor", "white");
  model.flatQuad(m(552.8, 0, 0), m(0, 0, 0), m(0, 0, 559.2), m(549.6, 0, 559.2));
  model.object("back_wall", "white");
  model.flatQuad(m(549.6, 0, 559.2), m(0, 0, 559.2), m(0, 548.8, 559.2), m(556, 548.8, 559.2));
  model.object("right_wall", "green");
  model.flatQuad(m(0, 0, 559.2), m(0, 0, 0), m(0, 548.8, 0), m(0, 548.8, 559.2));
  model.object("left_wall", "red");
  model.flatQuad(m(552.8, 0, 0), m(549.6, 0, 559.2), m(556, 548.8, 559.2), m(556, 548.8, 0));

  // Ceiling and area light share edges, so that no surface lies upon another.
  const glm::dvec3 ceiling[4] = {m(556, 548.8, 0), m(556, 548.8, 559.2), m(0, 548.8, 559.2), m(0, 548.8, 0)};
  const glm::dvec3 areaLight[4] = {m(343, 548.8, 227), m(343, 548.8, 332), m(213, 548.8, 332),
                                   m(213, 548.8, 227)};
  model.object("ceiling", "white");
  for (int i = 0; i < 4; ++i)
    model.flatQuad(ceiling[i], ceiling[(i + 1) % 4], areaLight[(i + 1) % 4], areaLight[i]);
  model.object("ceiling_lamp", "lamp");
  model.flatQuad(areaLight[0], areaLight[1], areaLight[2], areaLight[3]);

  model.object("short_box", "white");
  cornellBlock(model, {m(130, 165, 65), m(82, 165, 225), m(240, 165, 272), m(290, 165, 114)});
  model.object("tall_box", "white");
  cornellBlock(model, {m(423, 330, 247), m(265, 330, 296), m(314, 330, 456), m(472, 330, 406)});
  model.write(directory);
}

// An L: leg A along -Z from the camera, leg B along +X behind the corner, 2 m wide and 2.5 m high. Leg B
// beyond x = 1.4 m is not visible from leg A, so a light that shines along +X from x = 2 m or further is
// never seen directly.
void writeCorridor(const std::filesystem::path& directory) {
  ObjModel model("corridor", "An L-shaped corridor");
  model.material({.name = "plaster", .diffuse = {0.7, 0.69, 0.66}});
  model.material({.name = "floor", .diffuse = {0.42, 0.38, 0.33}});
  model.material({.name = "blue", .diffuse = {0.2, 0.32, 0.62}});
  model.material({.name = "orange", .diffuse = {0.8, 0.42, 0.12}});
  model.material({.name = "crate", .diffuse = {0.55, 0.4, 0.24}});

  const double height = 2.5;
  model.object("floor",
               "floor");  // leg A, the corner, leg B: shared edges, no corner in the middle of an edge
  model.box({-1, 0, -6}, {1, height, 0}, Facing::inward, "y");
  model.box({-1, 0, -8}, {1, height, -6}, Facing::inward, "y");
  model.box({1, 0, -8}, {7, height, -6}, Facing::inward, "y");
  model.object("ceiling", "plaster");
  model.box({-1, 0, -6}, {1, height, 0}, Facing::inward, "Y");
  model.box({-1, 0, -8}, {1, height, -6}, Facing::inward, "Y");
  model.box({1, 0, -8}, {7, height, -6}, Facing::inward, "Y");
  model.object("walls_a", "plaster");
  model.box({-1, 0, -6}, {1, height, 0}, Facing::inward, "XZ");
  model.box({-1, 0, -8}, {1, height, -6}, Facing::inward, "z");
  model.object("left_wall", "blue");
  model.box({-1, 0, -6}, {1, height, 0}, Facing::inward, "x");
  model.box({-1, 0, -8}, {1, height, -6}, Facing::inward, "x");
  model.object("walls_b", "plaster");
  model.box({1, 0, -8}, {7, height, -6}, Facing::inward, "zZ");
  model.object("lit_wall", "orange");
  model.box({1, 0, -8}, {7, height, -6}, Facing::inward, "X");
  // Objects that cast soft shadows in the indirect light. Bottom faces on the floor are left out.
  model.object("crate", "crate");
  model.box({0.35, 0, -5.2}, {0.95, 0.6, -4.6}, Facing::outward, "xXYzZ");
  model.object("pillar", "plaster");
  model.box({-0.9, 0, -6.4}, {-0.6, 2.2, -6.1}, Facing::outward, "xXYzZ");
  model.write(directory);
}

// White furnace: with albedo a and emission e on every face of a closed room, the radiance is e / (1 - a) = 2
// everywhere and in every direction.
void writeFurnace(const std::filesystem::path& directory) {
  ObjModel model("furnace", "A closed room of albedo 0.5 that emits radiance 1 inwards: 2 everywhere");
  model.material({.name = "ember", .diffuse = glm::dvec3(0.5), .emission = glm::dvec3(1)});
  model.object("walls", "ember");
  model.box(glm::dvec3(-1), glm::dvec3(1), Facing::inward);
  model.write(directory);
}

// A room open towards +Z with a square hole in the ceiling, and a box that floats under it so that it can
// turn.
void writeSkylight(const std::filesystem::path& directory) {
  ObjModel model("skylight", "A room with a hole in the ceiling and a floating box");
  model.material({.name = "white", .diffuse = {0.74, 0.73, 0.7}});
  model.material({.name = "amber", .diffuse = {0.72, 0.45, 0.1}});
  model.material({.name = "teal", .diffuse = {0.1, 0.42, 0.45}});
  model.material({.name = "box", .diffuse = {0.78, 0.74, 0.7}});
  const glm::dvec3 low{-1, 0, -1}, high{1, 2, 1};
  model.object("floor", "white");
  model.box(low, high, Facing::inward, "y");
  model.object("back_wall", "white");
  model.box(low, high, Facing::inward, "z");
  model.object("left_wall", "amber");
  model.box(low, high, Facing::inward, "x");
  model.object("right_wall", "teal");
  model.box(low, high, Facing::inward, "X");
  model.object("ceiling",
               "white");  // a slab with the hole in its middle; its edge keeps the sun off the walls
  model.ring({0.4, 0.4}, {1.5, 1.5}, 2, 2.1);
  model.object("box", "box");
  model.box({-0.3, 0.25, -0.3}, {0.3, 0.85, 0.3});
  model.write(directory);
}

void writeQuad(const std::filesystem::path& directory) {
  ObjModel model("quad", "A square of side 1 about the origin, facing up (+Y)");
  model.material({.name = "white", .diffuse = glm::dvec3(0.75)});
  model.object("quad", "white");
  const glm::dvec3 up{0, 1, 0};
  model.quad({{-0.5, 0, 0.5}, up, {0, 0}}, {{0.5, 0, 0.5}, up, {1, 0}}, {{0.5, 0, -0.5}, up, {1, 1}},
             {{-0.5, 0, -0.5}, up, {0, 1}});
  model.write(directory);
}

void writeBlock(const std::filesystem::path& directory) {
  ObjModel model("block", "A block of side 1 with its low corner at the origin, to be scaled into walls");
  model.material({.name = "white", .diffuse = glm::dvec3(0.75)});
  model.object("block", "white");
  model.box(glm::dvec3(0), glm::dvec3(1));
  model.write(directory);
}

void writeStressModels(const std::filesystem::path& directory) {
  const auto stress = [](const char* name, const char* comment) {
    ObjModel model(name, comment);
    model.material({.name = "grey", .diffuse = glm::dvec3(0.5)});
    model.object("all", "grey");
    return model;
  };
  ObjModel one = stress("one_triangle", "One triangle of one square metre");
  one.flatTriangle({-1, 0, 0}, {1, 0, 0}, {0, 1, 0});
  one.write(directory);

  ObjModel degenerate =
      stress("degenerate", "A floor among triangles without area: a point, a line, and a sliver");
  degenerate.flatQuad({-1, 0, 1}, {1, 0, 1}, {1, 0, -1}, {-1, 0, -1});
  degenerate.flatTriangle({0, 0.5, 0}, {0, 0.5, 0}, {0, 0.5, 0});
  degenerate.flatTriangle({-1, 0.5, 0}, {0, 0.5, 0}, {1, 0.5, 0});
  degenerate.flatTriangle({-1, 0.5, 0}, {1, 0.5, 0}, {0, 0.5001, 0});
  degenerate.write(directory);

  ObjModel white("white_room", "A closed room that absorbs nothing, lit by a quad under the ceiling");
  white.material({.name = "white", .diffuse = glm::dvec3(1)});
  white.material({.name = "lamp", .diffuse = glm::dvec3(1)});
  white.object("walls", "white");
  white.box({-1, 0, -1}, {1, 2, 1}, Facing::inward);
  white.object("lamp", "lamp");
  white.box({-0.25, 1.9, -0.25}, {0.25, 2, 0.25}, Facing::outward, "y");
  white.write(directory);
}

}  // namespace lumivox::models
