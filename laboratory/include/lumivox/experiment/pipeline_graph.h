// A pipeline as a picture: its passes, the outputs that they read of each other, and what a scene leaves out.
#pragma once

#include <filesystem>
#include <string>

#include "lumivox/pipeline/pipeline.h"

namespace lumivox {

/// The pipeline in the language of Graphviz: a box for each pass, an arrow from an output to each input that
/// is connected to it, an ellipse for each output of the pipeline. What the explanation of a run on this
/// scene leaves out is grey and dashed, with the reason. `scene` is the scene's name in the caption.
/// DiagnosticsError like checkPipeline().
std::string graphText(const Pipeline& pipeline, TechniqueSource& techniques, const ParameterValues& settings,
                      const Explanation& explanation, const std::string& scene);

/// Graphviz' program that lays graphs out, by $PATH. AbsentError, which says how to go without it, when it is
/// nowhere.
std::filesystem::path dotProgram();

/// Writes the picture (.svg), which holds the text as a comment, or the text alone (.dot, .gv, without
/// Graphviz). Nothing half-written stays. AbsentError without Graphviz; Error with its own message when it
/// fails.
void writeGraph(const std::filesystem::path& file, const std::string& text);

}  // namespace lumivox
