// The models of scenes/models, each written into a folder.
#pragma once

#include <filesystem>

namespace lumivox::models {

void writeCornell(const std::filesystem::path& directory);
void writeCorridor(const std::filesystem::path& directory);
void writeFurnace(const std::filesystem::path& directory);
void writeSkylight(const std::filesystem::path& directory);
void writeSky(const std::filesystem::path& directory);
void writeQuad(const std::filesystem::path& directory);
void writeBlock(const std::filesystem::path& directory);
void writeWavingCloth(const std::filesystem::path& directory);
void writeMovingShapes(const std::filesystem::path& directory);
void writeVase(const std::filesystem::path& directory);
void writeTurned(const std::filesystem::path& directory);
void writeTables(const std::filesystem::path& directory);
void writeTableTextures(const std::filesystem::path& directory);
void writeArcade(const std::filesystem::path& directory);
void writeArcadeTextures(const std::filesystem::path& directory);
void writeStressModels(const std::filesystem::path& directory);

}  // namespace lumivox::models
