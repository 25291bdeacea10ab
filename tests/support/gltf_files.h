// glTF files written for tests: numbers become accessors of one buffer, the rest is text.
#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

namespace lumivox::test {

inline std::string base64(std::string_view bytes) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < 3; ++k)
      bits = bits << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k)
      text += i + k > bytes.size() ? '=' : kDigits[bits >> (18 - 6 * k) & 63u];
  }
  return text;
}

class GltfWriter {
 public:
  /// A buffer view of numbers; its index.
  template <class T>
  int view(const std::vector<T>& numbers) {
    while (binary_.size() % 4 != 0) binary_ += '\0';
    views_.push_back(fmt::format(R"({{"buffer":0,"byteOffset":{},"byteLength":{}}})", binary_.size(),
                                 numbers.size() * sizeof(T)));
    binary_.append(reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(T));
    return static_cast<int>(views_.size()) - 1;
  }
  /// An accessor as text; its index.
  int accessor(std::string text) {
    accessors_.push_back(std::move(text));
    return static_cast<int>(accessors_.size()) - 1;
  }
  /// An accessor of all numbers; `more` follows its members, such as `,"normalized":true`.
  template <class T>
  int numbers(const std::vector<T>& values, const std::string& type, const std::string& more = "") {
    const std::size_t components = type == "SCALAR" ? 1
                                   : type == "MAT4" ? 16
                                                    : static_cast<std::size_t>(type.back() - '0');
    return accessor(fmt::format(R"({{"bufferView":{},"componentType":{},"count":{},"type":"{}"{}}})",
                                view(values), componentOf(T{}), values.size() / components, type, more));
  }

  /// The document; `body` holds its other members. The buffer is in a data: URI unless `bufferUri` names it.
  std::string gltf(const std::string& body, const std::string& bufferUri = "") const {
    const std::string uri =
        bufferUri.empty() ? "data:application/octet-stream;base64," + base64(binary_) : bufferUri;
    return document(body, fmt::format(R"("uri":"{}",)", uri));
  }
  std::string glb(const std::string& body) const {
    std::string json = document(body, "");
    while (json.size() % 4 != 0) json += ' ';
    std::string binary = binary_;
    while (binary.size() % 4 != 0) binary += '\0';
    const auto number = [](std::size_t value) {
      const auto bits = static_cast<std::uint32_t>(value);
      return std::string(reinterpret_cast<const char*>(&bits), 4);
    };
    return "glTF" + number(2) + number(12 + 8 + json.size() + 8 + binary.size()) + number(json.size()) +
           "JSON" + json + number(binary.size()) + std::string("BIN\0", 4) + binary;
  }
  const std::string& binary() const { return binary_; }

 private:
  static int componentOf(float) { return 5126; }
  static int componentOf(std::int8_t) { return 5120; }
  static int componentOf(std::uint8_t) { return 5121; }
  static int componentOf(std::int16_t) { return 5122; }
  static int componentOf(std::uint16_t) { return 5123; }
  static int componentOf(std::uint32_t) { return 5125; }

  std::string document(const std::string& body, const std::string& uri) const {
    const auto list = [](const char* name, const std::vector<std::string>& items) {
      return items.empty() ? std::string() : fmt::format(",\"{}\":[{}]", name, fmt::join(items, ","));
    };
    const std::string buffers =
        binary_.empty() ? "" : fmt::format(R"(,"buffers":[{{{}"byteLength":{}}}])", uri, binary_.size());
    return R"({"asset":{"version":"2.0"})" + buffers + list("bufferViews", views_) +
           list("accessors", accessors_) + (body.empty() ? "" : "," + body) + "}";
  }

  std::string binary_;
  std::vector<std::string> views_, accessors_;
};

/// A unit right triangle in the plane z = 0, with 16-bit indices: members `scenes`, `nodes` and `meshes`.
/// `node` and `primitive` are further members, each with a comma before it.
inline std::string triangleBody(GltfWriter& writer, const std::string& node = "",
                                const std::string& primitive = "") {
  const int positions = writer.numbers<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3");
  const int indices = writer.numbers<std::uint16_t>({0, 1, 2}, "SCALAR");
  return fmt::format(R"("scene":0,"scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0,"name":"triangle"{}}}],)"
                     R"("meshes":[{{"primitives":[{{"attributes":{{"POSITION":{}}},"indices":{}{}}}]}}])",
                     node, positions, indices, primitive);
}

}  // namespace lumivox::test
