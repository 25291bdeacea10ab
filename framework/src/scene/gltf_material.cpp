#include "scene/gltf_material.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "lumivox/base/image.h"
#include "scene/limits.h"

namespace lumivox {
namespace {

namespace fs = std::filesystem;

std::optional<GltfValue> extensionOf(const GltfValue& value, const char* name) {
  const auto extensions = value.find("extensions");
  return extensions ? extensions->find(name) : std::nullopt;
}

glm::vec3 vector3(const std::optional<std::vector<double>>& values, const glm::vec3& fallback) {
  return values ? glm::vec3((*values)[0], (*values)[1], (*values)[2]) : fallback;
}

}  // namespace

glm::vec2 TexcoordUse::operator()(const glm::vec2& texcoord) const {
  // Counter-clockwise as the image is seen, with v down: as Khronos' viewer and its test model have it.
  const glm::dvec2 scaled = scale * glm::dvec2(texcoord);
  const double cosine = std::cos(rotation), sine = std::sin(rotation);
  const glm::dvec2 result =
      offset + glm::dvec2(cosine * scaled.x + sine * scaled.y, cosine * scaled.y - sine * scaled.x);
  return {static_cast<float>(result.x), static_cast<float>(1.0 - result.y)};
}

int GltfMaterials::numberOf(std::optional<std::size_t> material, const glm::vec3& colour) {
  constexpr std::size_t kGrey = ~std::size_t{0};
  const auto [entry, isNew] = numbers_.emplace(
      std::pair(material.value_or(kGrey), std::array<float, 3>{colour.x, colour.y, colour.z}),
      static_cast<int>(table_.size()));
  if (!isNew) return entry->second;
  if (material) {
    table_.push_back(converted(*material, colour));
  } else {
    ModelMaterial grey;
    grey.values.name = "default";
    grey.values.diffuse = kUnknownAlbedo * colour;
    table_.push_back(std::move(grey));
  }
  std::string& name = table_.back().values.name;
  name = sceneNameOf(name, "material", names_);
  return entry->second;
}

std::string GltfMaterials::nameOf(std::size_t material) const {
  const std::string name = document_.root().item("materials", material).text("name");
  return name.empty() ? fmt::format("material_{}", material) : name;
}

TexcoordUse GltfMaterials::texcoordsOf(std::optional<std::size_t> material) const {
  TexcoordUse use;
  if (!material) return use;
  const auto model = document_.root().item("materials", *material).find("pbrMetallicRoughness");
  const auto texture = model ? model->find("baseColorTexture") : std::nullopt;
  if (!texture) return use;
  constexpr std::uint64_t kMostSets = 7;
  use.set = texture->whole("texCoord", 0, kMostSets);
  const auto transform = extensionOf(*texture, "KHR_texture_transform");
  if (!transform) return use;
  use.set = transform->whole("texCoord", use.set, kMostSets);
  if (const auto offset = transform->numbers("offset", 2, -1e6, 1e6))
    use.offset = {(*offset)[0], (*offset)[1]};
  if (const auto scale = transform->numbers("scale", 2, -1e6, 1e6)) use.scale = {(*scale)[0], (*scale)[1]};
  use.rotation = transform->number("rotation", 0.0, -1e6, 1e6);
  return use;
}

ModelImage GltfMaterials::imageOf(const GltfValue& textureInfo) {
  const GltfValue root = document_.root();
  const std::size_t texture = textureInfo.member("index").asIndex(root.count("textures"), "textures");
  const GltfValue place = root.item("textures", texture);
  const auto source = place.index("source", root.count("images"), "images");
  if (!source) {
    losses_.dropped.insert("textures of other formats than PNG and JPEG");
    return {};
  }
  if (const auto sampler = place.index("sampler", root.count("samplers"), "samplers")) {
    constexpr std::uint64_t kRepeat = 10497;
    const GltfValue values = root.item("samplers", *sampler);
    if (values.whole("wrapS", kRepeat, 65535) != kRepeat || values.whole("wrapT", kRepeat, 65535) != kRepeat)
      losses_.reduced.insert("textures that do not repeat do");
  }
  const GltfValue image = root.item("images", *source);
  ModelImage result;
  result.name = image.text("name", fmt::format("image_{}", *source));
  if (result.name.empty()) result.name = fmt::format("image_{}", *source);
  result.file = document_.file().string() + ": " + image.pointer();
  auto& embedded = embedded_[*source];
  if (embedded == nullptr) {
    if (const auto view = image.index("bufferView", root.count("bufferViews"), "buffer views")) {
      embedded = std::make_shared<const std::string>(document_.view(*view).bytes);
    } else {
      const std::string uri = image.member("uri").asText();
      if (auto bytes = GltfDocument::dataOf(uri, image.member("uri"))) {
        embedded = std::make_shared<const std::string>(*std::move(bytes));
      } else {
        result.file = document_.fileOf(uri, image.member("uri"));
        result.name = result.file.lexically_relative(document_.file().parent_path()).string();
        std::error_code error;
        if (!fs::exists(result.file, error))
          image.member("uri").refuse(fmt::format("the image '{}' does not exist", result.name),
                                     fmt::format("it at {}", result.file.string()));
      }
    }
  }
  result.bytes = embedded;
  return result;
}

glm::vec3 GltfMaterials::meanOf(const GltfValue& textureInfo, bool isColour) {
  const ModelImage image = imageOf(textureInfo);
  if (!image.present()) return glm::vec3(1.0f);
  const auto [entry, isNew] = means_.emplace(std::pair(image.file.string(), isColour), glm::vec3(1.0f));
  if (!isNew) return entry->second;
  std::string read;
  if (image.bytes == nullptr) {
    read = readFile(image.file, kLargestImageFile);
    hasher_.add(read);
  }
  const ByteImage pixels = decodeByteImage(image.bytes == nullptr ? read : *image.bytes, image.file);
  const auto channels = static_cast<std::size_t>(pixels.channels);
  std::array<std::array<std::size_t, 256>, 3> counts{};
  for (std::size_t i = 0; i < pixels.values.size(); i += channels)
    for (std::size_t c = 0; c < 3; ++c) ++counts[c][pixels.values[i + (channels < 3 ? 0 : c)]];
  glm::dvec3 sum(0.0);
  for (std::size_t value = 0; value < 256; ++value) {
    const float stored = static_cast<float>(value) / 255.0f;
    const double linear = isColour ? srgbToLinear(stored) : stored;
    for (std::size_t c = 0; c < 3; ++c)
      sum[static_cast<int>(c)] += linear * static_cast<double>(counts[c][value]);
  }
  const std::size_t count = pixels.values.size() / channels;
  if (count > 0) entry->second = glm::vec3(sum / static_cast<double>(count));
  return entry->second;
}

ModelMaterial GltfMaterials::converted(std::size_t index, const glm::vec3& colour) {
  const GltfValue source = document_.root().item("materials", index);
  ModelMaterial result;
  result.values.name = nameOf(index);
  result.masksByAlphaOnly = true;
  const auto model = source.find("pbrMetallicRoughness");
  const auto factor = model ? model->numbers("baseColorFactor", 4, 0, 1) : std::nullopt;
  MetallicRoughness material;
  material.baseColour = colour * vector3(factor, glm::vec3(1.0f));
  material.metallic = static_cast<float>(model ? model->number("metallicFactor", 1.0, 0, 1) : 1.0);
  material.roughness = static_cast<float>(model ? model->number("roughnessFactor", 1.0, 0, 1) : 1.0);
  const auto texture = model ? model->find("baseColorTexture") : std::nullopt;
  const auto varying = model ? model->find("metallicRoughnessTexture") : std::nullopt;
  if (varying && (material.metallic > 0.0f || material.roughness > 0.0f)) {
    losses_.reduced.insert("metalness and roughness of textures become their means");
    const glm::vec3 mean = meanOf(*varying, false);
    material.roughness *= mean.g;
    material.metallic *= mean.b;
  }
  if (extensionOf(source, "KHR_materials_unlit")) {
    losses_.reduced.insert("unlit surfaces are lit as diffuse ones");
    result.values.diffuse = material.baseColour;
  } else {
    MetallicRoughness tinted = material;
    if (texture && material.metallic > 0.0f) {
      losses_.reduced.insert("colours of textures tint metals by their means");
      tinted.baseColour *= meanOf(*texture, true);
    }
    const PhongLobes whole = phongLobesOf(material), lobes = phongLobesOf(tinted);
    result.values.diffuse = whole.diffuse;
    result.values.specular = lobes.specular;
    result.values.exponent = lobes.exponent;
    // The brightest texel may not reflect more than it receives.
    for (int i = 0; i < 3; ++i)
      result.values.diffuse[i] = std::min(result.values.diffuse[i], 1.0f - result.values.specular[i]);
  }
  if (texture) result.diffuse = imageOf(*texture);
  readAlpha(source, texture, factor ? static_cast<float>((*factor)[3]) : 1.0f, result);
  readEmission(source, result);
  noteLosses(source);
  return result;
}

void GltfMaterials::readAlpha(const GltfValue& source, const std::optional<GltfValue>& texture, float alpha,
                              ModelMaterial& result) {
  const std::string mode = source.text("alphaMode", "OPAQUE");
  if (mode == "OPAQUE") return;
  if (mode != "MASK" && mode != "BLEND")
    source.member("alphaMode").refuse(fmt::format("is '{}'", mode.substr(0, 20)), "OPAQUE, MASK or BLEND");
  double cutoff = 0.5;
  if (mode == "MASK")
    cutoff = source.number("alphaCutoff", 0.5, 0, 1e6);
  else
    losses_.dropped.insert(
        "alpha blending (a surface with an alpha below a half is a hole, others are opaque)");
  if (cutoff <= 0.0) return;
  // Coverage below a half is a hole here, alpha below the cut-off there.
  result.dissolve = alpha * static_cast<float>(0.5 / cutoff);
  if (texture) result.mask = imageOf(*texture);
}

void GltfMaterials::readEmission(const GltfValue& source, ModelMaterial& result) {
  glm::vec3 emission = vector3(source.numbers("emissiveFactor", 3, 0, kMostLight), glm::vec3(0.0f));
  if (const auto strength = extensionOf(source, "KHR_materials_emissive_strength"))
    emission *= static_cast<float>(strength->number("emissiveStrength", 1.0, 0, kMostLight));
  const auto texture = source.find("emissiveTexture");
  if (texture && emission != glm::vec3(0.0f)) {
    losses_.reduced.insert("emission of textures becomes its mean");
    emission *= meanOf(*texture, true);
  }
  result.values.emission = glm::min(emission, glm::vec3(static_cast<float>(kMostLight)));
  if (result.values.emissive() && source.flag("doubleSided", false))
    losses_.reduced.insert("double-sided emission leaves front sides only");
}

void GltfMaterials::noteLosses(const GltfValue& source) {
  if (source.has("normalTexture")) losses_.dropped.insert("normal textures");
  if (source.has("occlusionTexture")) losses_.reduced.insert("occlusion textures are left to the light");
  const auto extensions = source.find("extensions");
  if (!extensions) return;
  for (const std::string& name : extensions->names()) {
    constexpr std::string_view kPrefix = "KHR_materials_";
    if (name == "KHR_materials_emissive_strength" || name == "KHR_materials_unlit") continue;
    losses_.dropped.insert(name.substr(0, kPrefix.size()) == kPrefix ? name.substr(kPrefix.size()) : name);
  }
}

}  // namespace lumivox
