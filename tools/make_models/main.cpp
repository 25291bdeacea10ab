// make_models FOLDER: writes the committed models anew, e.g. `build/bin/make_models scenes/models`.
#include <cstdio>
#include <filesystem>

#include "lumivox/base/error.h"
#include "models.h"

int main(int argumentCount, char** arguments) {
  if (argumentCount != 2) {
    std::fprintf(stderr, "usage: make_models FOLDER\n");
    return 2;
  }
  const std::filesystem::path directory = arguments[1];
  try {
    std::filesystem::create_directories(directory / "textures");
    lumivox::models::writeCornell(directory);
    lumivox::models::writeCorridor(directory);
    lumivox::models::writeFurnace(directory);
    lumivox::models::writeSkylight(directory);
    lumivox::models::writeSky(directory);
    lumivox::models::writeQuad(directory);
    lumivox::models::writeBlock(directory);
    lumivox::models::writeWavingCloth(directory);
    lumivox::models::writeMovingShapes(directory);
    lumivox::models::writeVase(directory);
    lumivox::models::writeTurned(directory);
    lumivox::models::writeTables(directory);
    lumivox::models::writeTableTextures(directory / "textures");
    lumivox::models::writeArcade(directory);
    lumivox::models::writeArcadeTextures(directory / "textures");
    lumivox::models::writeStressModels(directory);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "make_models: %s\n", error.what());
    return 2;
  }
  return 0;
}
