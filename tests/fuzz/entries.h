// The doors through which hostile files come, one function each. A file is taken, or refused with an Error;
// whatever else happens (another exception, a broken promise, a report of a sanitizer) ends the process.
// libFuzzer drives them (preset "fuzz"), and every test run drives them with the seeds and with what was ever
// found.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace lumivox::fuzz {

/// A scene text. One without findings must lay out to a text that lays out to itself.
void sceneText(std::string_view input);
/// The same for a pipeline text, as far as it needs no technique library.
void pipelineText(std::string_view input);
/// An OBJ file; what follows the first line "%%MTL" is the material file beside it, "model.mtl".
void objModel(std::string_view input);
/// A glTF file; one that begins with "glTF" is a .glb. What follows the first line "%%BIN" is the buffer
/// beside it, "model.bin".
void gltfModel(std::string_view input);
/// A PLY file.
void plyModel(std::string_view input);
/// A shader pack. After "%%CONTENT\n" comes a content alone, which gets a right header, so that the checksum
/// hides nothing of what lies behind it.
void shaderPack(std::string_view input);

/// An EXR image: what a cache of references may hold.
void exrImage(std::string_view input);
/// A Radiance image, and the environment map that it makes.
void hdrImage(std::string_view input);
/// An OpenVDB file with one grid: the density of a medium.
void volumeFile(std::string_view input);

/// The texts of a capture, which load with pictures that lie there already. What precedes the first line
/// "%%FILE name" is the inside of a block `capture`; each such line begins one of the files that kTexts of
/// entries.cpp names, in the folders "tum", "frames", "redwood" and "exr".
void captureTexts(std::string_view input);
/// A .sens file: the frames of a depth camera in one file.
void sensFile(std::string_view input);
/// A depth image: a grey PNG of 16 bits.
void depthPng(std::string_view input);

struct Entry {
  const char* name;  ///< of its folder of seeds
  void (*run)(std::string_view input);
};
const std::vector<Entry>& entries();

}  // namespace lumivox::fuzz
