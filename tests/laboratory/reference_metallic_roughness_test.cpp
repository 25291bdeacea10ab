// How far our material is from the metallic-roughness model of glTF 2.0 that it stands for: the path tracer
// gives ours, the formulas of the specification give the true one.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "framework/one_model.h"
#include "support/gltf_files.h"
#include "support/scene_builder.h"

using namespace lumivox;
using test::kPi;

namespace {

/// glTF 2.0, Appendix B.3: Lambert below a dielectric layer mixed with a metal, one channel.
struct TrueModel {
  double base, metallic, roughness;

  double brdf(const glm::dvec3& in, const glm::dvec3& out) const {  // the normal is +y
    const glm::dvec3 half = glm::normalize(in + out);
    const double alpha2 = std::pow(roughness, 4.0), cosine = half.y;
    const double root = cosine * cosine * (alpha2 - 1.0) + 1.0;
    const double density = alpha2 / (kPi * root * root);
    const auto visible = [&](double c) { return c + std::sqrt(alpha2 + (1.0 - alpha2) * c * c); };
    const double specular = density / (visible(in.y) * visible(out.y));
    const double edge = std::pow(1.0 - glm::dot(out, half), 5.0);
    const double metal = specular * (base + (1.0 - base) * edge);
    const double fresnel = 0.04 + 0.96 * edge;
    const double dielectric = (1.0 - fresnel) * base / kPi + fresnel * specular;
    return metallic * metal + (1.0 - metallic) * dielectric;
  }
};

/// A floor of 2 m x 2 m that faces up, of a material with these factors, below a sun of 1 W/m^2 from `in`.
Scene floorOf(const TrueModel& material, const glm::dvec3& in) {
  test::GltfWriter writer;
  const int positions = writer.numbers<float>({-1, 0, 1, 1, 0, 1, 1, 0, -1, -1, 0, -1}, "VEC3");
  const int indices = writer.numbers<std::uint8_t>({0, 1, 2, 0, 2, 3}, "SCALAR");
  const std::string file = writer.gltf(fmt::format(
      R"("nodes":[{{"mesh":0}}],"meshes":[{{"primitives":[{{"attributes":{{"POSITION":{}}},"indices":{},)"
      R"("material":0}}]}}],"materials":[{{"pbrMetallicRoughness":{{"baseColorFactor":[{},0,0,1],)"
      R"("metallicFactor":{},"roughnessFactor":{}}}}}])",
      positions, indices, material.base, material.metallic, material.roughness));
  return test::OneModel(
             "m.gltf", file, "",
             fmt::format("light sun directional {{ direction {} {} {}  irradiance 1 }}", -in.x, -in.y, -in.z))
      .load();
}

struct Difference {
  double albedo, trueAlbedo;  ///< of light from this direction
  double shape;  ///< half the integral of the difference of the two, each with albedo 1: 0 equal, 1 disjoint
};

/// Light comes in at an angle. Directions out are a midpoint grid over the hemisphere.
Difference differenceOf(const TrueModel& material, double angle) {
  // Half a turn: both sides of the plane of incidence are alike.
  constexpr int kRings = 20, kTurns = 20;
  const glm::dvec3 in(std::sin(angle), std::cos(angle), 0.0);
  const Scene scene = floorOf(material, in);
  const ReferenceOptions options = test::quietly(2, 1);
  std::vector<double> ours, theirs;
  for (int ring = 0; ring < kRings; ++ring) {
    for (int turn = 0; turn < kTurns; ++turn) {
      const double cosine = std::sqrt((ring + 0.5) / kRings), azimuth = kPi * (turn + 0.5) / kTurns;
      const double sine = std::sqrt(1.0 - cosine * cosine);
      const glm::dvec3 out(sine * std::cos(azimuth), cosine, sine * std::sin(azimuth));
      const glm::vec3 radiance = referenceRadiance(scene, 0.0, 0.5 * out, glm::vec3(-out), options);
      ours.push_back(static_cast<double>(radiance.r) / in.y);
      theirs.push_back(material.brdf(in, out));
    }
  }
  // Equal weights: the cosine is in the density of the grid.
  Difference result{};
  const double weight = kPi / (kRings * kTurns);
  for (std::size_t i = 0; i < ours.size(); ++i) {
    result.albedo += weight * ours[i];
    result.trueAlbedo += weight * theirs[i];
  }
  for (std::size_t i = 0; i < ours.size(); ++i)
    result.shape += 0.5 * weight * std::abs(ours[i] / result.albedo - theirs[i] / result.trueAlbedo);
  return result;
}

}  // namespace

TEST_CASE("our material reflects what the metallic-roughness model does, within a stated error") {
  const LogCapture quiet;
  double worstAlbedo = 0.0, worstShape = 0.0;
  for (const double metallic : {0.0, 0.5, 1.0}) {
    for (const double roughness : {0.4, 0.7, 1.0}) {
      for (const double degrees : {0.0, 45.0}) {
        const Difference d = differenceOf({0.6, metallic, roughness}, degrees * kPi / 180.0);
        std::printf("metallic %.1f roughness %.1f at %2.0f deg: albedo %.3f of %.3f, shape %.3f\n", metallic,
                    roughness, degrees, d.albedo, d.trueAlbedo, d.shape);
        worstAlbedo = std::max(worstAlbedo, std::abs(d.albedo - d.trueAlbedo));
        worstShape = std::max(worstShape, d.shape);
      }
    }
  }
  CHECK(worstAlbedo < 0.17);
  CHECK(worstShape < 0.35);
}
