// The container of glTF 2.0: the JSON text with the place of each value, and the bytes that it names. Every
// value is checked where it is read; an Error names the file and the JSON pointer or the byte.
#pragma once

#include <cstddef>
#include <filesystem>
#include <glm/glm.hpp>
#include <initializer_list>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "lumivox/base/hash.h"

namespace lumivox {

/// A value of the JSON text and where it is.
class GltfValue {
 public:
  using Json = nlohmann::json;
  GltfValue(const Json* json, std::string pointer, const std::filesystem::path* file)
      : json_(json), pointer_(std::move(pointer)), file_(file) {}

  [[noreturn]] void refuse(const std::string& what, const std::string& expected) const;
  const std::string& pointer() const { return pointer_; }

  bool has(const char* name) const;
  /// A member that must be there.
  GltfValue member(const char* name) const;
  std::optional<GltfValue> find(const char* name) const;
  /// A member that is an array of objects, or nothing where there is none.
  std::size_t count(const char* name) const;
  /// Of an array.
  std::size_t size() const;
  GltfValue at(std::size_t index) const;
  /// The object `index` of the member array `name`, which count() has found.
  GltfValue item(const char* name, std::size_t index) const;
  std::vector<std::string> names() const;  ///< of an object's members

  double asNumber(double low, double high) const;
  std::uint64_t asWhole(std::uint64_t most) const;
  std::string asText() const;

  double number(const char* name, double fallback, double low = -1e30, double high = 1e30) const;
  std::uint64_t whole(const char* name, std::uint64_t fallback, std::uint64_t most) const;
  bool flag(const char* name, bool fallback) const;
  std::string text(const char* name, const std::string& fallback = {}) const;
  /// So many numbers, or nothing where the member is missing.
  std::optional<std::vector<double>> numbers(const char* name, std::size_t count, double low = -1e30,
                                             double high = 1e30) const;
  /// An index into one of the document's arrays of `count` objects `what`.
  std::optional<std::size_t> index(const char* name, std::size_t count, const char* what) const;
  std::size_t asIndex(std::size_t count, const char* what) const;

 private:
  const Json* json_;
  std::string pointer_;
  const std::filesystem::path* file_;
};

class GltfDocument {
 public:
  /// Reads a .gltf or a .glb file: the first bytes tell which. Everything that is read goes into `hasher`.
  GltfDocument(const std::filesystem::path& file, Hasher& hasher);

  GltfValue root() const { return {&json_, "", &file_}; }
  const std::filesystem::path& file() const { return file_; }
  /// The bytes of a buffer view, and its stride (0: tightly packed).
  struct View {
    std::string_view bytes;
    std::size_t stride = 0;
  };
  View view(std::size_t index);
  /// What a data: URI holds, as text of bytes; nothing for another URI.
  static std::optional<std::string> dataOf(const std::string& uri, const GltfValue& place);
  /// The file beside the document that a URI names. Refuses one that leaves the folder.
  std::filesystem::path fileOf(const std::string& uri, const GltfValue& place) const;

 private:
  void readContainer(Hasher& hasher);
  void parse(std::string_view text);
  std::string_view buffer(std::size_t index);

  std::filesystem::path file_;
  Hasher& hasher_;
  std::string bytes_;        // of the file
  std::string_view binary_;  // of the chunk BIN of a .glb file
  bool hasBinary_ = false;
  nlohmann::json json_;
  std::map<std::size_t, std::string> buffers_;  // of other files and of data: URIs
};

/// Values of an accessor (glTF 2.0, Sec. 3.6.2), sparse ones filled in.
class GltfAccessor {
 public:
  GltfAccessor(GltfDocument& document, std::size_t index);

  std::size_t count() const { return count_; }
  std::size_t components() const { return components_; }
  const GltfValue& place() const { return place_; }
  /// Refuses another number of components.
  const GltfAccessor& require(std::initializer_list<std::size_t> components, const char* what) const;

  /// All components as numbers, integers as they are or, if the accessor or the caller says so, normalised.
  std::vector<float> floats() const;
  std::vector<glm::vec3> vectors3() const;
  std::vector<glm::vec2> vectors2() const;
  /// Of unsigned integers only.
  std::vector<std::uint32_t> indices() const;

 private:
  float component(const char* at) const;
  void readSparse(GltfDocument& document);
  template <class Vector>
  std::vector<Vector> elements() const;
  template <class Element>
  void fill(std::vector<Element>& values) const;

  GltfValue place_;
  const char* data_ = nullptr;  // null: zeros
  std::size_t stride_ = 0, count_ = 0, components_ = 1, componentSize_ = 4;
  unsigned type_ = 5126;
  bool normalised_ = false;
  std::vector<std::uint32_t> sparseIndices_;
  std::string_view sparseValues_;
};

/// What of a model a scene cannot show: dropped wholly, or reduced to something simpler.
struct GltfLosses {
  std::set<std::string> dropped, reduced;
};

}  // namespace lumivox
