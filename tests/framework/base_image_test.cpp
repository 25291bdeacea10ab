// Float images, EXR, PNG and the sRGB transfer functions.
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfMultiPartOutputFile.h>
#include <ImfOutputFile.h>
#include <ImfOutputPart.h>
#include <ImfPartType.h>
#include <ImfStringAttribute.h>
#include <ImfTiledOutputFile.h>
#include <half.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <vector>

#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "lumivox/base/image.h"
#include "support/facts.h"
#include "support/support.h"

using namespace lumivox;
using lumivox::test::messageOf;
using lumivox::test::Tells;
using lumivox::test::TemporaryDirectory;

namespace {

ImageBuffer numbered(int width, int height, int channels, float start) {
  ImageBuffer image(width, height, channels);
  for (float& value : image.values()) value = start += 0.37f;
  return image;
}

bool sameBits(const ImageBuffer& a, const ImageBuffer& b) {
  return a.sameShape(b) &&
         std::memcmp(a.values().data(), b.values().data(), a.values().size() * sizeof(float)) == 0;
}

/// A file that a foreign program wrote, of 32-bit channels in scan lines.
void writeForeign(const std::filesystem::path& path, Imf::Header header, const Imf::FrameBuffer& frame) {
  Imf::OutputFile file(path.c_str(), header);
  file.setFrameBuffer(frame);
  file.writePixels(header.dataWindow().max.y - header.dataWindow().min.y + 1);
}

/// A file of this name is refused by its name wherever it is cut.
template <class Read>
void refuseCuts(const std::string& name, const std::string& content, Read&& read, std::size_t step = 1) {
  const TemporaryDirectory directory;
  for (std::size_t size = 0; size < content.size(); size += step) {
    CAPTURE(size);
    const auto path = directory.write(name, content.substr(0, size));
    REQUIRE_THROWS_MATCHES(read(path), Error, Tells(name));
  }
}

/// A valid small EXR, to be damaged.
std::string exrBytes(const TemporaryDirectory& directory, int width = 16, int height = 40) {
  const auto path = directory.path() / "whole.exr";
  writeExr(path, {{{"", numbered(width, height, 3, 0.0f)}}, {}});
  return readFile(path);
}

/// The place of the data window's four 32-bit numbers (least significant byte first) in an EXR's header.
std::size_t dataWindowPlace(const std::string& bytes) {
  // Attribute layout: name, 0, type, 0, size (4 bytes), value.
  const std::string lead = std::string("dataWindow") + '\0' + "box2i" + '\0';
  return bytes.find(lead) + lead.size() + 4;
}

void setInt32(std::string& bytes, std::size_t place, std::int32_t value) {
  for (int i = 0; i < 4; ++i)
    bytes[place + static_cast<std::size_t>(i)] = static_cast<char>(value >> (8 * i));
}

}  // namespace

TEST_CASE("an EXR returns every layer bit for bit, with dots in names, and its attributes") {
  const TemporaryDirectory directory;
  LayeredImage written;
  written.layers[""] = numbered(7, 5, 3, 0.0f);
  written.layers["direct"] = numbered(7, 5, 4, 100.0f);
  written.layers["direct.variance"] = numbered(7, 5, 3, 200.0f);
  written.layers["depth"] = numbered(7, 5, 1, 300.0f);
  written.layers["motion.last.frame"] = numbered(7, 5, 2, 400.0f);
  written.layers["depth"].at(3, 2, 0) = std::numeric_limits<float>::quiet_NaN();
  written.layers["depth"].at(4, 2, 0) = std::numeric_limits<float>::infinity();
  written.layers["depth"].at(5, 2, 0) = -1e-42f;  // denormal
  written.attributes = {
      {"scene", "Cornell box"}, {"samples", "1024"}, {"note", "two\nlines, µ"}, {"none", ""}};
  const auto path = directory.path() / "layers.exr";
  writeExr(path, written);
  const LayeredImage read = readExr(path);
  REQUIRE(read.layers.size() == written.layers.size());
  for (const auto& [name, image] : written.layers) {
    INFO(name);
    REQUIRE(read.layers.count(name) == 1);
    REQUIRE(sameBits(read.layers.at(name), image));
  }
  REQUIRE(read.attributes == written.attributes);
}

TEST_CASE("the same image gives the same EXR bytes") {
  const TemporaryDirectory directory;
  const LayeredImage image{{{"a", numbered(33, 21, 3, 0.0f)}}, {{"seed", "1"}}};
  writeExr(directory.path() / "one.exr", image);
  writeExr(directory.path() / "two.exr", image);
  REQUIRE(readFile(directory.path() / "one.exr") == readFile(directory.path() / "two.exr"));
}

TEST_CASE("row 0 is the top row of a foreign tiled half-float EXR with a data window, too") {
  const TemporaryDirectory directory;
  const std::string path = (directory.path() / "tiled.exr").string();
  constexpr int kWidth = 10, kHeight = 6;
  const Imath::Box2i window({-3, 100}, {-3 + kWidth - 1, 100 + kHeight - 1});
  Imf::Header header(Imath::Box2i({0, 0}, {99, 199}), window);
  header.setTileDescription(Imf::TileDescription(4, 4, Imf::ONE_LEVEL));
  for (const char* name : {"R", "G", "B", "Z", "id"}) {
    header.channels().insert(name, Imf::Channel(std::string(name) == "id" ? Imf::UINT : Imf::HALF));
  }
  std::vector<half> values(kWidth * kHeight);
  std::vector<unsigned> ids(kWidth * kHeight);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      values[static_cast<std::size_t>(y * kWidth + x)] =
          half(static_cast<float>(y) + 0.0625f * static_cast<float>(x));
      ids[static_cast<std::size_t>(y * kWidth + x)] = static_cast<unsigned>(1000 * y + x);
    }
  }
  {
    Imf::TiledOutputFile file(path.c_str(), header);
    Imf::FrameBuffer frame;
    for (const char* name : {"R", "G", "B", "Z"})
      frame.insert(name, Imf::Slice::Make(Imf::HALF, values.data(), window));
    frame.insert("id", Imf::Slice::Make(Imf::UINT, ids.data(), window));
    file.setFrameBuffer(frame);
    file.writeTiles(0, file.numXTiles() - 1, 0, file.numYTiles() - 1);
  }
  const LayeredImage image = readExr(path);
  // R, G, B form the main image; depth and identifier stand beside it under their own names.
  REQUIRE(image.layers.size() == 3);
  const ImageBuffer& main = image.layers.at("");
  REQUIRE((main.width() == kWidth && main.height() == kHeight && main.channels() == 3));
  REQUIRE(main.at(7, 4, 2) == 4.0f + 7.0f / 16.0f);
  REQUIRE(image.layers.at("Z").at(9, 5, 0) == 5.0f + 9.0f / 16.0f);
  REQUIRE(image.layers.at("id").at(2, 3, 0) == 3002.0f);
}

TEST_CASE("foreign channel names group sensibly") {
  const TemporaryDirectory directory;
  const std::string path = (directory.path() / "foreign.exr").string();
  Imf::Header header(1, 1);
  const std::vector<std::string> names = {
      "r",    "g",       "b",       "normal.X", "normal.Y", "normal.Z", "view.V",    "uv.U",
      "uv.V", "light.A", "light.B", "light.G",  "light.R",  "only.R",   "odd.first", "odd.second"};
  std::vector<float> values(names.size());
  Imf::FrameBuffer frame;
  for (std::size_t i = 0; i < names.size(); ++i) {
    values[i] = static_cast<float>(i + 1);
    header.channels().insert(names[i], Imf::Channel(Imf::FLOAT));
    frame.insert(names[i], Imf::Slice::Make(Imf::FLOAT, &values[i], header.dataWindow()));
  }
  writeForeign(path, header, frame);
  const auto layers = readExr(path).layers;
  const auto values_of = [&](const std::string& name) { return layers.at(name).values(); };
  CHECK(layers.size() == 8);
  CHECK(values_of("") == std::vector<float>{1, 2, 3});
  CHECK(values_of("normal") == std::vector<float>{4, 5, 6});
  CHECK(values_of("view") == std::vector<float>{7});
  CHECK(values_of("uv") == std::vector<float>{8, 9});
  CHECK(values_of("light") == std::vector<float>{13, 12, 11, 10});
  CHECK(values_of("only") == std::vector<float>{14});
  CHECK(values_of("odd.first") == std::vector<float>{15});
  CHECK(values_of("odd.second") == std::vector<float>{16});
}

TEST_CASE("the parts of a multi-part EXR become layers under their names") {
  const TemporaryDirectory directory;
  const std::string path = (directory.path() / "parts.exr").string();
  std::vector<float> values = {1, 2, 3, 4, 5, 6};
  std::vector<Imf::Header> headers;
  for (const char* name : {"left", "right"}) {
    Imf::Header header(1, 1);
    header.setName(name);
    header.setType(Imf::SCANLINEIMAGE);
    header.compression() = Imf::NO_COMPRESSION;
    for (const char* channel : {"R", "G", "B", "depth.Z"})
      header.channels().insert(channel, Imf::Channel(Imf::FLOAT));
    headers.push_back(header);
  }
  {
    Imf::MultiPartOutputFile file(path.c_str(), headers.data(), 2);
    for (int part = 0; part < 2; ++part) {
      Imf::FrameBuffer frame;
      std::size_t next = part == 0 ? 0 : 2;
      for (const char* channel : {"R", "G", "B", "depth.Z"}) {
        frame.insert(channel, Imf::Slice::Make(Imf::FLOAT, &values[next++], headers[0].dataWindow()));
      }
      Imf::OutputPart output(file, part);
      output.setFrameBuffer(frame);
      output.writePixels(1);
    }
  }
  const auto layers = readExr(path).layers;
  REQUIRE(layers.size() == 4);
  CHECK(layers.at("left").values() == std::vector<float>{1, 2, 3});
  CHECK(layers.at("right").values() == std::vector<float>{3, 4, 5});
  CHECK(layers.at("depth").values() == std::vector<float>{4});
  CHECK(layers.at("right.depth").values() == std::vector<float>{6});
}

TEST_CASE("an EXR with subsampled channels is refused and named") {
  const TemporaryDirectory directory;
  const auto path = directory.path() / "chroma.exr";
  Imf::Header header(2, 2);
  header.channels().insert("Y", Imf::Channel(Imf::FLOAT));
  header.channels().insert("RY", Imf::Channel(Imf::FLOAT, 2, 2));
  std::vector<float> values(4);
  Imf::FrameBuffer frame;
  frame.insert("Y", Imf::Slice::Make(Imf::FLOAT, values.data(), header.dataWindow()));
  frame.insert("RY", Imf::Slice::Make(Imf::FLOAT, values.data(), header.dataWindow(), 0, 0, 2, 2));
  writeForeign(path, header, frame);
  REQUIRE_THROWS_MATCHES(readExr(path), Error, Tells("chroma.exr", "RY"));
}

TEST_CASE("an EXR cut at any length is an error that names the file") {
  const TemporaryDirectory directory;
  const std::string bytes = exrBytes(directory);
  refuseCuts(
      "cut.exr", bytes.substr(0, 400), [](const auto& path) { return readExr(path); }, 7);
  refuseCuts(
      "cut.exr", bytes, [](const auto& path) { return readExr(path); }, 97);
  REQUIRE_NOTHROW(readExr(directory.write("cut.exr", bytes)));
}

TEST_CASE("an EXR with any one byte of its header changed is read or refused, and nothing else happens") {
  const TemporaryDirectory directory;
  const std::string bytes = exrBytes(directory, 8, 8);
  for (std::size_t place = 0; place < std::min<std::size_t>(bytes.size(), 420); ++place) {
    std::string damaged = bytes;
    damaged[place] = static_cast<char>(damaged[place] ^ 0x85);
    const auto path = directory.write("damaged.exr", damaged);
    try {
      readExr(path);
    } catch (const Error& error) {
      REQUIRE_THAT(error.what(), Tells("damaged.exr"));
    }
  }
}

TEST_CASE("an EXR that claims another size than it has is refused before memory is taken") {
  const TemporaryDirectory directory;
  // One column more than the blocks hold, and one less.
  const std::int32_t side = GENERATE(2'000'000'000, 9'000'000, 16, 14);
  std::string bytes = exrBytes(directory);
  setInt32(bytes, dataWindowPlace(bytes) + 8, side);
  REQUIRE_THROWS_MATCHES(readExr(directory.write("wide.exr", bytes)), Error, Tells("wide.exr"));
  setInt32(bytes, dataWindowPlace(bytes) + 12, side);
  REQUIRE_THROWS_MATCHES(readExr(directory.write("both.exr", bytes)), Error, Tells("both.exr"));
}

TEST_CASE("what is no EXR, or missing, or a directory, is an error that names it") {
  const TemporaryDirectory directory;
  REQUIRE_THROWS_MATCHES(readExr(directory.write("text.exr", "this is no image")), Error,
                         Tells("text.exr", "OpenEXR"));
  REQUIRE_THROWS_MATCHES(readExr(directory.path() / "none.exr"), Error, Tells("none.exr"));
  REQUIRE_THROWS_AS(readExr(directory.path()), Error);
}

TEST_CASE("an image that cannot be written leaves the earlier file as it was") {
  const TemporaryDirectory directory;
  const auto path = directory.path() / "kept.exr";
  writeExr(path, {{{"", numbered(4, 4, 3, 0.0f)}}, {}});
  const std::string before = readFile(path);
  const auto refuse = [&](const LayeredImage& image, const std::string& reason) {
    REQUIRE_THROWS_MATCHES(writeExr(path, image), Error, Tells("kept.exr", reason));
    REQUIRE(readFile(path) == before);
  };
  refuse({}, "without layers");
  refuse({{{"a", numbered(4, 4, 3, 0.0f)}, {"b", numbered(4, 5, 3, 0.0f)}}, {}}, "'b'");
  refuse({{{"a", numbered(4, 4, 5, 0.0f)}}, {}}, "5 channels");
  refuse({{{"a", ImageBuffer()}}, {}}, "empty");
  refuse({{{"a", numbered(4, 4, 1, 0.0f)}}, {{"compression", "none"}}}, "compression");
  refuse({{{"a", numbered(4, 4, 1, 0.0f)}}, {{"type", "deepscanline"}}}, "type");
  REQUIRE_THROWS_AS(writeExr(directory.path() / "no" / "folder.exr", {{{"", numbered(1, 1, 1, 0.0f)}}, {}}),
                    Error);
  REQUIRE(std::distance(std::filesystem::directory_iterator(directory.path()), {}) == 1);
}

TEST_CASE("an image larger than the memory is refused with the sizes") {
  REQUIRE_THROWS_MATCHES(ImageBuffer(2'000'000'000, 2'000'000'000, 2'000'000'000), Error,
                         Tells("2000000000 x 2000000000"));
  REQUIRE_THROWS_MATCHES(ImageBuffer(1 << 30, 1 << 14, 3), Error, Tells("192.0 TiB"));
  REQUIRE_THROWS_AS(ImageBuffer(0, 4, 3), Error);
  REQUIRE_THROWS_AS(ImageBuffer(4, -1, 3), Error);
  REQUIRE_THROWS_AS(ImageBuffer(4, 4, 0), Error);
}

TEST_CASE("the sRGB transfer functions are each other's inverse and meet the standard's values") {
  // IEC 61966-2-1: 0.5 encoded is ((0.5 + 0.055) / 1.055)^2.4 = 0.21404114; mid grey 0.18 encodes to 1.055 *
  // 0.18^(1/2.4) - 0.055.
  REQUIRE(srgbToLinear(0.5f) == Approx(0.21404114).epsilon(1e-6));
  REQUIRE(linearToSrgb(0.18f) == Approx(0.46135613).epsilon(1e-6));
  REQUIRE(srgbToLinear(0.04f) == Approx(0.04 / 12.92));
  REQUIRE((srgbToLinear(0.0f) == 0.0f && srgbToLinear(1.0f) == 1.0f && linearToSrgb(0.0f) == 0.0f));
  REQUIRE(linearToSrgb(1.0f) == Approx(1.0f));
  for (int i = 0; i <= 255; ++i) {
    const float encoded = static_cast<float>(i) / 255.0f;
    REQUIRE(std::lround(255.0f * linearToSrgb(srgbToLinear(encoded))) == i);
  }
}

TEST_CASE("an EXR whose attribute claims more bytes than there are is refused before they are asked for") {
  const TemporaryDirectory place;
  const auto file = place.path() / "a.exr";
  writeExr(file, {{{"", ImageBuffer(2, 2, 3, 0.5f)}}, {{"said", "a text"}}});
  std::string bytes = readFile(file);
  const std::size_t at = bytes.find(std::string("said\0string\0", 12)) + 12;
  REQUIRE(at < bytes.size());
  CHECK(readExrAttributes(file).at("said") == "a text");
  const std::int32_t claimed = 1634533376;
  std::memcpy(bytes.data() + at, &claimed, sizeof(claimed));
  place.write("a.exr", bytes);
  CHECK_THROWS_MATCHES(readExrAttributes(file), Error, Tells("said"));
}

TEST_CASE("an EXR keeps which of its layers are no radiance") {
  const TemporaryDirectory place;
  LayeredImage image;
  for (const char* name : {"", "light", "colours", "places"}) image.layers[name] = ImageBuffer(2, 2, 3, 0.5f);
  image.layers["openness"] = ImageBuffer(2, 2, 1, 0.5f);
  for (const char* name : {"colours", "places"}) image.layers[name].setRadiance(false);
  const auto again = [&](const LayeredImage& written) {
    writeExr(place.path() / "a.exr", written);
    return readExr(place.path() / "a.exr");
  };
  LayeredImage read = again(image);
  for (auto& [name, layer] : read.layers) {
    CAPTURE(name);
    CHECK(layer.isRadiance() == (name == "" || name == "light"));
    layer.setRadiance(name != "light");
  }
  // Not what was read before is kept, but what is so.
  read = again(read);
  CHECK_FALSE(read.layers.at("light").isRadiance());
  CHECK(read.layers.at("colours").isRadiance());
}

TEST_CASE("a PNG holds the exposed, clipped sRGB values, and NaN is magenta") {
  const TemporaryDirectory directory;
  ImageBuffer image(3, 2, 3);
  const float infinity = std::numeric_limits<float>::infinity();
  image.values() = {0.0f, 0.09f, 0.5f, 7.0f, -2.0f, infinity, 0.25f, std::nanf(""), 0.25f,
                    1,    1,     1,    0,    0,     0,        0.09f, 0.09f,         0.09f};
  writePng(directory.path() / "p.png", image, {1.0, Tone::srgb});
  const ByteImage bytes = readByteImage(directory.path() / "p.png");
  REQUIRE((bytes.width == 3 && bytes.height == 2 && bytes.channels == 3));
  // 0.09 at 1 EV is 0.18: 255 * 0.46135613 = 117.6 -> 118.
  REQUIRE(bytes.values == std::vector<unsigned char>{0, 118, 255, 255, 0, 255, 255, 0, 255, 255, 255, 255, 0,
                                                     0, 0, 118, 118, 118});
  REQUIRE(encodePng(image, {1.0, Tone::srgb}) == readFile(directory.path() / "p.png"));
  CHECK(readPngAttributes(directory.path() / "p.png").empty());
  // Texts beside the pixels change none of them.
  const std::vector<unsigned char> pixels = readByteImage(directory.path() / "p.png").values;
  const std::map<std::string, std::string> texts{{"lumivox.exposure_ev", "1.00"}, {"title", ""}};
  writePng(directory.path() / "t.png", image, {1.0, Tone::srgb}, texts);
  CHECK(readPngAttributes(directory.path() / "t.png") == texts);
  CHECK(readByteImage(directory.path() / "t.png").values == pixels);

  ImageBuffer grey(1, 1, 1, 0.18f);
  writePng(directory.path() / "g.png", grey);
  REQUIRE(readByteImage(directory.path() / "g.png").values == std::vector<unsigned char>{118, 118, 118});
  REQUIRE_THROWS_AS(encodePng(ImageBuffer(1, 1, 4)), Error);
  REQUIRE_THROWS_AS(encodePng(ImageBuffer()), Error);
}

TEST_CASE("a tone curve decides what becomes of exposed radiance, and knows its name") {
  const float infinity = std::numeric_limits<float>::infinity();
  ImageBuffer image(6, 1, 1);
  image.values() = {0.0f, -1.0f, 0.09f, 0.25f, 3.0f, infinity};
  const auto grey = [&](Tone tone, double exposure) {
    std::vector<int> values;
    const std::vector<unsigned char> bytes = displayBytes(image, {exposure, tone});
    for (std::size_t i = 0; i < bytes.size(); i += 3) values.push_back(bytes[i]);
    return values;
  };
  // 255 x the values; 255 x the sRGB codes of 0.18 and 0.5.
  CHECK(grey(Tone::linear, 1.0) == std::vector<int>{0, 0, 46, 128, 255, 255});
  CHECK(grey(Tone::srgb, 1.0) == std::vector<int>{0, 0, 118, 188, 255, 255});
  // Narkowicz 2016 at x = 0.6 v: x (2.51 x + 0.03) / (x (2.43 x + 0.59) + 0.14), then the sRGB curve.
  const auto expected = [](double v) {
    const double x = 0.6 * v;
    const double shown = x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14);
    return static_cast<int>(std::lround(255.0f * linearToSrgb(static_cast<float>(shown))));
  };
  const std::vector<int> filmic = grey(Tone::filmic, 1.0);
  CHECK(filmic == std::vector<int>{0, 0, expected(0.18), expected(0.5), expected(6.0), 255});
  CHECK(filmic[4] < 255);  // a light of six times white keeps its shape
  for (const Tone tone : {Tone::linear, Tone::srgb, Tone::filmic}) CHECK(toneNamed(name(tone)) == tone);
  CHECK_THROWS_AS(toneNamed("sRGB"), Error);
  CHECK(std::isnan(toneMapped(std::nanf(""), Tone::filmic)));
}

TEST_CASE("every float of a PNG becomes its byte of the sRGB curve, exactly about each step") {
  const auto expected = [](float linear) {
    return static_cast<unsigned char>(std::lround(255.0f * linearToSrgb(std::clamp(linear, 0.0f, 1.0f))));
  };
  std::vector<float> values{0.0f,
                            -0.0f,
                            1.0f,
                            2.0f,
                            -1.0f,
                            std::numeric_limits<float>::denorm_min(),
                            std::numeric_limits<float>::max(),
                            std::nextafter(1.0f, 0.0f)};
  for (int byte = 0; byte < 255; ++byte) {
    // The curve rounds up from byte to byte + 1 at about byte + 1/2.
    float value = srgbToLinear((static_cast<float>(byte) + 0.5f) / 255.0f);
    for (int i = 0; i < 40; ++i) value = std::nextafter(value, 0.0f);
    for (int i = 0; i < 80; ++i, value = std::nextafter(value, 1.0f)) values.push_back(value);
  }
  for (int i = 0; i < 20000; ++i) values.push_back(static_cast<float>(i) / 20000.0f);
  while (values.size() % 100 != 0) values.push_back(0.3f);
  ImageBuffer image(100, static_cast<int>(values.size() / 100), 1);
  image.values() = values;
  const TemporaryDirectory directory;
  writePng(directory.path() / "p.png", image);
  const ByteImage bytes = readByteImage(directory.path() / "p.png");
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < values.size(); ++i) wrong += bytes.values[3 * i] != expected(values[i]) ? 1 : 0;
  CHECK(wrong == 0);
}

TEST_CASE("a PNG of any size and content is read back as it was, and what repeats takes little room") {
  const TemporaryDirectory directory;
  const auto readBack = [&](const ImageBuffer& image) {
    writePng(directory.path() / "p.png", image);
    const ByteImage bytes = readByteImage(directory.path() / "p.png");
    REQUIRE(bytes.width == image.width());
    REQUIRE(bytes.height == image.height());
    for (std::size_t i = 0; i < image.values().size(); ++i) {
      if (bytes.values[i] != std::lround(255.0f * linearToSrgb(image.values()[i]))) return false;
    }
    return true;
  };
  // Noise, flat, ramps along x and y and both: each is best predicted by another filter.
  for (const auto& [width, height] : {std::pair(1, 1), std::pair(1, 9), std::pair(9, 1), std::pair(57, 31)}) {
    for (int kind = 0; kind < 5; ++kind) {
      CAPTURE(width, height, kind);
      ImageBuffer image(width, height, 3);
      for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
          for (int c = 0; c < 3; ++c) {
            const unsigned noise =
                static_cast<unsigned>(x * 7919 + y * 104729 + c * 31) * 2654435769u >> 8 & 255u;
            const float value[] = {static_cast<float>(noise) / 255.0f, 0.4f, static_cast<float>(x) / 60.0f,
                                   static_cast<float>(y) / 40.0f, static_cast<float>(x + 2 * y) / 130.0f};
            image.at(x, y, c) = value[kind];
          }
        }
      }
      CHECK(readBack(image));
    }
  }
  ImageBuffer ramp(256, 256, 3);
  for (std::size_t i = 0; i < ramp.values().size(); ++i)
    ramp.values()[i] = static_cast<float>(i / 3 % 256) / 256.0f;
  CHECK(encodePng(ramp).size() < 256 * 256 * 3 / 50);
}

TEST_CASE("the attributes of an EXR are told without its pixels") {
  const TemporaryDirectory directory;
  const auto path = directory.path() / "a.exr";
  writeExr(path, {{{"", numbered(64, 64, 3, 0.0f)}},
                  {{"scene", "x"}, {"a long name that takes a lot of room", "y"}}});
  CHECK(readExrAttributes(path) == readExr(path).attributes);
  CHECK(readExrAttributes(path).at("scene") == "x");
  refuseCuts("bad.exr", readFile(path).substr(0, 61), readExrAttributes, 6);
  CHECK_THROWS_MATCHES(readExrAttributes(directory.write("bad.exr", std::string(100, 'x'))), Error,
                       Tells("bad.exr"));
}

TEST_CASE("a PNG that is cut, damaged or something else is an error that names the file") {
  const TemporaryDirectory directory;
  ImageBuffer image(20, 20, 3);
  for (std::size_t i = 0; i < image.values().size(); ++i)
    image.values()[i] = static_cast<float>(i * 7919 % 256) / 255.0f;
  const std::string whole = encodePng(image);
  refuseCuts("cut.png", whole, readByteImage, 11);
  // A changed byte breaks the checksum of its chunk (or the signature, or the frame of the chunk).
  for (std::size_t place = 0; place < whole.size(); place += 13) {
    std::string damaged = whole;
    damaged[place] = static_cast<char>(damaged[place] ^ 0x20);
    const auto path = directory.write("damaged.png", damaged);
    REQUIRE_THROWS_MATCHES(readByteImage(path), Error, Tells("damaged.png"));
  }
  const auto text = directory.write("text.png", "this is a text and no image at all");
  REQUIRE_THROWS_MATCHES(readByteImage(text), Error, Tells("text.png"));
  REQUIRE_THROWS_AS(readByteImage(directory.path() / "none.png"), Error);
}

TEST_CASE("a TGA is read, raw and in runs, and refused when it is cut") {
  const TemporaryDirectory directory;
  const auto header = [](char type, char width, char height, char bits) {
    std::string bytes(18, '\0');
    bytes[2] = type;
    bytes[12] = width;
    bytes[14] = height;
    bytes[16] = bits;
    bytes[17] = 0x20;  // row 0 at the top
    return bytes;
  };
  const std::string raw = header(2, 2, 1, 24) + "\x01\x02\x03\x04\x05\x06";  // blue, green, red
  const auto rawPath = directory.write("raw.tga", raw);
  REQUIRE(readByteImage(rawPath).values == std::vector<unsigned char>{3, 2, 1, 6, 5, 4});
  const std::string runs =
      header(10, 5, 1, 24) + "\x83\x01\x02\x03" + std::string("\0\x07\x08\x09", 4);  // four equal, then one
  const auto runsPath = directory.write("runs.tga", runs);
  REQUIRE(readByteImage(runsPath).values ==
          std::vector<unsigned char>{3, 2, 1, 3, 2, 1, 3, 2, 1, 3, 2, 1, 9, 8, 7});
  for (const std::string& whole : {raw, runs}) refuseCuts("cut.tga", whole, readByteImage);
}

TEST_CASE("a JPEG is read, and refused when it is cut") {
  const TemporaryDirectory directory;
  // A baseline JPEG of one grey 8 x 8 block, written out by hand: quantisation all 1, one Huffman code of
  // length 1 for each table (0: no difference / end of block), and the scan's bits 00 padded with ones: 0x3F.
  std::string bytes = "\xFF\xD8";
  const auto segment = [&](unsigned char marker, const std::string& content) {
    bytes += '\xFF';
    bytes += static_cast<char>(marker);
    bytes += '\0';
    bytes += static_cast<char>(content.size() + 2);
    bytes += content;
  };
  const std::string table =
      std::string("\x01", 1) + std::string(15, '\0') + std::string(1, '\0');  // counts, then the one symbol
  segment(0xDB, std::string(1, '\0') + std::string(64, '\x01'));
  segment(0xC0, std::string("\x08\0\x08\0\x08\x01\x01\x11\0", 9));
  segment(0xC4, std::string(1, '\0') + table);
  segment(0xC4, std::string(1, '\x10') + table);
  segment(0xDA, std::string("\x01\x01\0\0\x3F\0", 6));
  bytes += "\x3F\xFF\xD9";
  const auto path = directory.write("grey.jpg", bytes);
  const ByteImage image = readByteImage(path);
  REQUIRE((image.width == 8 && image.height == 8 && image.channels == 1));
  REQUIRE(image.values ==
          std::vector<unsigned char>(64, 128));  // no coefficient: the level shift alone (T.81, A.3.1)
  refuseCuts("cut.jpg", bytes, readByteImage);
}
