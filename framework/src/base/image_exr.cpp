// OpenEXR images: layers by name, attributes as text. Files are read and written whole, so that writes are
// atomic and errors name the file.
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputPart.h>
#include <ImfMultiPartInputFile.h>
#include <ImfOutputFile.h>
#include <ImfPartType.h>
#include <ImfStringAttribute.h>
#include <ImfVersion.h>
#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <cstring>
#include <new>
#include <set>
#include <span>
#include <sstream>
#include <string_view>

#include "base/deflate_limit.h"
#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "lumivox/base/image.h"

namespace lumivox {
namespace {

class MemoryInput : public Imf::IStream {
 public:
  explicit MemoryInput(const std::string& bytes, const std::string& name)
      : Imf::IStream(name.c_str()), bytes_(bytes) {}
  bool read(char destination[], int count) override {
    if (count < 0 ||
        static_cast<std::uint64_t>(count) > bytes_.size() - std::min<std::uint64_t>(place_, bytes_.size())) {
      throw Iex::InputExc("the file ends too early");
    }
    std::memcpy(destination, bytes_.data() + place_, static_cast<std::size_t>(count));
    place_ += static_cast<std::uint64_t>(count);
    return place_ < bytes_.size();
  }
  std::uint64_t tellg() override { return place_; }
  void seekg(std::uint64_t place) override { place_ = place; }

 private:
  const std::string& bytes_;
  std::uint64_t place_ = 0;
};

class MemoryOutput : public Imf::OStream {
 public:
  explicit MemoryOutput(const std::string& name) : Imf::OStream(name.c_str()) {}
  void write(const char source[], int count) override {
    const std::size_t end = static_cast<std::size_t>(place_) + static_cast<std::size_t>(count);
    if (end > bytes_.size()) bytes_.resize(end);
    std::memcpy(bytes_.data() + place_, source, static_cast<std::size_t>(count));
    place_ = end;
  }
  std::uint64_t tellp() override { return place_; }
  void seekp(std::uint64_t place) override { place_ = place; }
  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
  std::uint64_t place_ = 0;
};

/// A channel's layer is everything before the last dot of its name: "direct.variance.R" is R of
/// "direct.variance".
struct ChannelName {
  std::string layer, component;
  explicit ChannelName(const std::string& full) {
    const std::size_t dot = full.rfind('.');
    layer = dot == std::string::npos ? "" : full.substr(0, dot);
    component = dot == std::string::npos ? full : full.substr(dot + 1);
  }
};

std::string channelName(const std::string& layer, std::string_view component) {
  return layer.empty() ? std::string(component) : fmt::format("{}.{}", layer, component);
}

/// Channel orders of images. A layer takes the first order of which it has all components.
const std::vector<std::vector<std::string>> kComponentOrders = {
    {"R", "G", "B", "A"}, {"R", "G", "B"}, {"X", "Y", "Z"}, {"R", "G"}, {"X", "Y"}, {"U", "V"}, {"Y"}, {"R"}};

/// The full channel names of one image to be read, in order.
struct LayerPlan {
  std::string name;
  std::vector<std::string> channels;
};

/// Groups the channels of one part into layers. A channel outside of the known orders (depth, masks) becomes
/// a layer of its own under its full name, or under the layer's name if it is the layer's only channel.
std::vector<LayerPlan> planLayers(const Imf::ChannelList& channels) {
  std::map<std::string, std::vector<std::string>> componentsOfLayer;
  for (auto channel = channels.begin(); channel != channels.end(); ++channel) {
    const ChannelName name(channel.name());
    componentsOfLayer[name.layer].push_back(name.component);
  }
  const auto upper = [](std::string text) {
    std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::toupper(c); });
    return text;
  };
  std::vector<LayerPlan> plans;
  for (auto& [layer, components] : componentsOfLayer) {
    const auto find = [&, &present = components](const std::string& wanted) {
      const auto exact = std::find(present.begin(), present.end(), wanted);
      if (exact != present.end()) return exact;
      return std::find_if(present.begin(), present.end(),
                          [&](const auto& each) { return upper(each) == wanted; });
    };
    for (const auto& order : kComponentOrders) {
      const bool complete =
          std::all_of(order.begin(), order.end(),
                      [&, &present = components](const auto& each) { return find(each) != present.end(); });
      if (!complete) continue;
      LayerPlan plan{layer, {}};
      for (const std::string& component : order) {
        const auto found = find(component);
        plan.channels.push_back(channelName(layer, *found));
        components.erase(found);
      }
      plans.push_back(plan);
      break;
    }
    const bool alone =
        components.size() == 1 && !layer.empty() && (plans.empty() || plans.back().name != layer);
    for (const std::string& component : components) {
      const std::string full = channelName(layer, component);
      plans.push_back({alone ? layer : full, {full}});
    }
  }
  return plans;
}

std::size_t pixelTypeBytes(Imf::PixelType type) {
  return type == Imf::HALF ? 2 : 4;
}

/// The largest ratio of pixel bytes to file bytes: a header that claims more is wrong.
std::uint64_t mostExpansion(Imf::Compression compression) {
  switch (compression) {
    case Imf::NO_COMPRESSION:
      return 1;
    case Imf::RLE_COMPRESSION:
      return 64;  // a run of at most 128 bytes takes two
    case Imf::ZIP_COMPRESSION:
    case Imf::ZIPS_COMPRESSION:
    case Imf::PXR24_COMPRESSION:
      return 2 * kMostDeflateExpansion;  // twice for PXR24
    default:
      return std::uint64_t{1} << 17;  // DWA: a deflated mean for every 8 x 8 block
  }
}

/// Refuses bad parts before memory is allocated for the pixels.
void checkPart(const Imf::MultiPartInputFile& file, int part, std::uint64_t fileBytes,
               std::uint64_t mostPixels) {
  const Imf::Header& header = file.header(part);
  if (header.hasType() && header.type() != Imf::SCANLINEIMAGE && header.type() != Imf::TILEDIMAGE) {
    throw Error(fmt::format(
        "contains a part of type '{}'; expected scanlines or tiles with one value a pixel", header.type()));
  }
  if (!file.partComplete(part)) throw Error("is incomplete: pixels are missing");
  const Imath::Box2i window = header.dataWindow();
  const std::int64_t width = std::int64_t{window.max.x} - window.min.x + 1;
  const std::int64_t height = std::int64_t{window.max.y} - window.min.y + 1;
  constexpr std::int64_t kLongestSide = std::int64_t{1} << 24;
  if (width < 1 || height < 1 || width > kLongestSide || height > kLongestSide) {
    throw Error(fmt::format("has a data window of {} x {} pixels; expected 1 to {} each", width, height,
                            kLongestSide));
  }
  std::uint64_t channelCount = 0, storedBytes = 0;
  for (auto channel = header.channels().begin(); channel != header.channels().end();
       ++channel, ++channelCount) {
    if (channel.channel().xSampling != 1 || channel.channel().ySampling != 1) {
      throw Error(
          fmt::format("has the subsampled channel '{}'; expected a value in every pixel", channel.name()));
    }
    storedBytes += pixelTypeBytes(channel.channel().type);
  }
  if (channelCount == 0) throw Error("has no channels");
  constexpr std::uint64_t kMostChannels = 1u << 12;
  if (channelCount > kMostChannels)
    throw Error(fmt::format("has {} channels; expected at most {}", channelCount, kMostChannels));
  const std::uint64_t pixels = static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height);
  if (pixels * storedBytes > fileBytes * mostExpansion(header.compression())) {
    throw Error(fmt::format("claims {} x {} pixels with {} channels, too many for a file of {}", width,
                            height, channelCount, formatBytes(fileBytes)));
  }
  if (pixels > mostPixels)
    throw Error(fmt::format("has {} x {} pixels, {} as floats; expected at most {} pixels", width, height,
                            formatBytes(pixels * channelCount * sizeof(float)), mostPixels));
  requireMemory(pixels * channelCount * sizeof(float),
                fmt::format("an EXR of {} x {} pixels with {} channels", width, height, channelCount));
}

/// The library accepts a block that unpacks to fewer bytes than the header promises, and leaves the other
/// pixels undefined. So blocks of the common compressions are measured first.
void checkBlocks(Imf::InputPart& part) {
  const Imf::Header& header = part.header();
  const auto compression = header.compression();
  const bool packed = compression == Imf::ZIP_COMPRESSION || compression == Imf::ZIPS_COMPRESSION;
  if (header.hasTileDescription() || (!packed && compression != Imf::NO_COMPRESSION)) return;
  const Imath::Box2i window = header.dataWindow();
  std::size_t rowBytes = 0;
  for (auto channel = header.channels().begin(); channel != header.channels().end(); ++channel) {
    rowBytes +=
        pixelTypeBytes(channel.channel().type) * static_cast<std::size_t>(window.max.x - window.min.x + 1);
  }
  constexpr int kZipRows = 16;  // OpenEXR file layout: scan lines of a ZIP block
  const int rowsOfBlock = compression == Imf::ZIP_COMPRESSION ? kZipRows : 1;
  std::vector<Bytef> unpacked;
  for (int y = window.min.y; y <= window.max.y; y += rowsOfBlock) {
    const char* block = nullptr;
    int blockBytes = 0;
    part.rawPixelData(y, block, blockBytes);
    const std::size_t expected =
        rowBytes * static_cast<std::size_t>(std::min(rowsOfBlock, window.max.y - y + 1));
    if (static_cast<std::size_t>(blockBytes) == expected) continue;  // stored unpacked
    unpacked.resize(expected);
    uLongf unpackedBytes = static_cast<uLongf>(expected);
    if (!packed ||
        uncompress(unpacked.data(), &unpackedBytes, reinterpret_cast<const Bytef*>(block),
                   static_cast<uLong>(blockBytes)) != Z_OK ||
        unpackedBytes != expected) {
      throw Error(fmt::format("the block of pixels at row {} is damaged", y - window.min.y));
    }
  }
}

void addTexts(const Imf::Header& header, std::map<std::string, std::string>& attributes) {
  for (auto attribute = header.begin(); attribute != header.end(); ++attribute) {
    const auto* text = dynamic_cast<const Imf::StringAttribute*>(&attribute.attribute());
    const std::string_view name = attribute.name();
    if (text != nullptr && name != "type" && name != "name") attributes.emplace(name, text->value());
  }
}

void readPart(Imf::MultiPartInputFile& file, int partIndex, LayeredImage& result) {
  const Imf::Header& header = file.header(partIndex);
  const Imath::Box2i window = header.dataWindow();
  const int width = window.max.x - window.min.x + 1, height = window.max.y - window.min.y + 1;
  Imf::InputPart part(file, partIndex);
  checkBlocks(part);
  const std::string partName = file.parts() > 1 && header.hasName() ? header.name() : "";

  Imf::FrameBuffer frame;
  for (const LayerPlan& plan : planLayers(header.channels())) {
    // Parts with the same channel names are distinguished by the part's name.
    std::string name = plan.name.empty() ? partName : plan.name;
    if (result.layers.count(name) != 0) name = channelName(partName, plan.name);
    if (result.layers.count(name) != 0) throw Error(fmt::format("has the layer '{}' twice", name));
    const int channels = static_cast<int>(plan.channels.size());
    ImageBuffer& image = result.layers.emplace(name, ImageBuffer(width, height, channels)).first->second;
    const std::size_t pixelStride = sizeof(float) * static_cast<std::size_t>(channels);
    for (std::size_t c = 0; c < plan.channels.size(); ++c) {
      frame.insert(plan.channels[c],
                   Imf::Slice::Make(Imf::FLOAT, image.values().data() + c, window, pixelStride,
                                    pixelStride * static_cast<std::size_t>(width)));
    }
  }
  part.setFrameBuffer(frame);
  part.readPixels(window.min.y, window.max.y);

  addTexts(header, result.attributes);
}

void addAttributes(const std::map<std::string, std::string>& attributes, Imf::Header& header) {
  static const std::set<std::string> kReserved = {"name", "type", "version", "chunkCount", "view", "tiles"};
  constexpr std::size_t kLongestName = 255;  // of an attribute, in the format's version with long names
  for (const auto& [name, value] : attributes) {
    if (name.empty() || name.size() > kLongestName || kReserved.count(name) != 0 ||
        header.find(name) != header.end()) {
      throw Error(fmt::format("cannot store an attribute named '{}'", name));
    }
    header.insert(name, Imf::StringAttribute(value));
  }
}

std::span<const std::string_view> componentsFor(int channels) {
  static constexpr std::string_view kOne[] = {"Y"}, kTwo[] = {"X", "Y"}, kMore[] = {"R", "G", "B", "A"};
  switch (channels) {
    case 1:
      return kOne;
    case 2:
      return kTwo;
    case 3:
      return std::span(kMore).first(3);
    case 4:
      return kMore;
    default:
      return {};
  }
}

/// The channel of depths along the view axis, and the name of its layer.
constexpr const char* kDepth = "Z";

/// Holds the names of layers of several channels that are no radiance, with commas between them.
constexpr const char* kNotRadiance = "lumivox.not_radiance";

void readNotRadiance(LayeredImage& image) {
  const auto listed = image.attributes.find(kNotRadiance);
  if (listed == image.attributes.end()) return;
  std::stringstream names(listed->second);
  for (std::string name; std::getline(names, name, ',');)
    if (const auto layer = image.layers.find(name); layer != image.layers.end())
      layer->second.setRadiance(false);
}

std::map<std::string, std::string> attributesOf(const LayeredImage& image) {
  std::map<std::string, std::string> result = image.attributes;
  std::string names;
  for (const auto& [name, layer] : image.layers)
    if (layer.channels() > 1 && !layer.isRadiance()) names += (names.empty() ? "" : ",") + name;
  result.erase(kNotRadiance);
  if (!names.empty()) result[kNotRadiance] = names;
  return result;
}

/// Checks that no attribute of the first header (behind magic number and version) reaches beyond the end of
/// the file: OpenEXR allocates whatever size an attribute claims.
void requireAttributesWithin(std::string_view bytes) {
  std::size_t at = 8;
  const auto word = [&] {
    const std::size_t end = std::min(bytes.find('\0', at), bytes.size());
    const std::string_view text = bytes.substr(std::min(at, end), end - std::min(at, end));
    at = end + 1;
    return text;
  };
  for (std::string_view name = word(); !name.empty(); name = word()) {
    word();  // its type
    std::int32_t size = -1;
    if (at + sizeof(size) <= bytes.size()) std::memcpy(&size, bytes.data() + at, sizeof(size));
    at += sizeof(size);
    if (size < 0 || at + static_cast<std::size_t>(size) > bytes.size())
      throw Error(fmt::format("is damaged: its attribute '{}' goes on beyond the end", name.substr(0, 64)));
    at += static_cast<std::size_t>(size);
  }
}

}  // namespace

LayeredImage readExr(const std::filesystem::path& path, std::uint64_t mostPixels) {
  const std::string bytes = readFile(path, kLargestExrFile);
  LayeredImage result;
  try {
    MemoryInput stream(bytes, path.string());
    constexpr int kThreads = 0;
    constexpr bool kRebuildTable = false;  // a file without its chunk table is incomplete
    Imf::MultiPartInputFile file(stream, kThreads, kRebuildTable);
    for (int part = 0; part < file.parts(); ++part) {
      checkPart(file, part, bytes.size(), mostPixels);
      if (file.header(part).dataWindow() != file.header(0).dataWindow()) {
        throw Error("contains parts of different sizes; expected one size");
      }
    }
    for (int part = 0; part < file.parts(); ++part) readPart(file, part, result);
    readNotRadiance(result);
  } catch (const Error& error) {
    throw Error(fmt::format("{}: {}", path.string(), error.what()));
  } catch (const std::bad_alloc&) {
    throw Error(fmt::format("{}: needs more memory than is available", path.string()));
  } catch (const std::exception& error) {
    throw Error(fmt::format("{}: is not a readable OpenEXR image: {}", path.string(), error.what()));
  }
  return result;
}

std::map<std::string, std::string> readExrAttributes(const std::filesystem::path& path) {
  constexpr std::uint64_t kLongestHeader = std::uint64_t{1} << 20;
  const std::string bytes = readFileStart(path, kLongestHeader);
  std::map<std::string, std::string> attributes;
  try {
    MemoryInput stream(bytes, path.string());
    char begin[8];  // magic number and version
    stream.read(begin, sizeof(begin));
    if (!Imf::isImfMagic(begin)) throw Error("is not an OpenEXR image");
    requireAttributesWithin(bytes);
    int version = static_cast<unsigned char>(begin[4]) | static_cast<unsigned char>(begin[5]) << 8 |
                  static_cast<unsigned char>(begin[6]) << 16 | static_cast<unsigned char>(begin[7]) << 24;
    Imf::Header header;
    header.readFrom(stream, version);
    addTexts(header, attributes);
  } catch (const std::exception& error) {
    throw Error(fmt::format("{}: {}", path.string(), error.what()));
  }
  return attributes;
}

void writeExr(const std::filesystem::path& path, const LayeredImage& image) {
  std::string bytes;
  try {
    if (image.layers.empty()) throw Error("an image without layers cannot be written");
    const ImageBuffer& first = image.layers.begin()->second;
    if (first.empty()) throw Error(fmt::format("layer '{}' is empty", image.layers.begin()->first));
    Imf::Header header(first.width(), first.height());
    header.compression() = Imf::ZIP_COMPRESSION;
    // Radiance hardly repeats, so a longer search gains almost nothing: files are within 1 % of those of the
    // library's default level (4).
    header.zipCompressionLevel() = 1;
    Imf::FrameBuffer frame;
    for (const auto& [name, layer] : image.layers) {
      const bool isDepth = name == kDepth && layer.channels() == 1;
      const auto components = componentsFor(layer.channels());
      if (layer.width() != first.width() || layer.height() != first.height() || components.empty()) {
        throw Error(fmt::format("layer '{}' is {} x {} pixels with {} channels; expected {} x {} with 1 to 4",
                                name, layer.width(), layer.height(), layer.channels(), first.width(),
                                first.height()));
      }
      const std::size_t pixelStride = sizeof(float) * components.size();
      for (std::size_t c = 0; c < components.size(); ++c) {
        const std::string full = isDepth ? name : channelName(name, components[c]);
        header.channels().insert(full, Imf::Channel(Imf::FLOAT));
        frame.insert(full,
                     Imf::Slice::Make(Imf::FLOAT, layer.values().data() + c, header.dataWindow(), pixelStride,
                                      pixelStride * static_cast<std::size_t>(layer.width())));
      }
    }
    addAttributes(attributesOf(image), header);
    MemoryOutput stream(path.string());
    {
      Imf::OutputFile file(stream, header);
      file.setFrameBuffer(frame);
      file.writePixels(first.height());
    }
    bytes = stream.bytes();
  } catch (const std::exception& error) {
    throw Error(fmt::format("{}: {}", path.string(), error.what()));
  }
  writeFileAtomically(path, bytes);
}

}  // namespace lumivox
