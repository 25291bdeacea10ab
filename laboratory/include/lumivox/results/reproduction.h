// Tables and figures of papers as texts: the published set-up is measured or shown. Numbers are compared as
// ratios to the table's first row, since no two devices have the same times; curves by how they grow;
// images by what the paper claims of them, and by whoever looks at them.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lumivox/base/image.h"
#include "lumivox/gpu/device.h"
#include "lumivox/measure/metrics.h"
#include "lumivox/pipeline/pipeline.h"

namespace lumivox {

/// The quantity of a published number, and its unit in the text.
enum class PublishedQuantity {
  time,       ///< of passes or of the frame, ms
  frameRate,  ///< of the frame, 1/s; compared as the frame's time
  fragments,  ///< voxel fragments of an output, a number
  memory,     ///< of passes, of all that an output holds, or of the whole frame at its peak, MB (10^6 bytes)
  voxelBytes  ///< of all that an output holds, for each of its finest voxels that has an opacity, B
};
inline constexpr PublishedQuantity kPublishedQuantities[] = {
    PublishedQuantity::time, PublishedQuantity::frameRate, PublishedQuantity::fragments,
    PublishedQuantity::memory, PublishedQuantity::voxelBytes};
const char* name(PublishedQuantity quantity);  ///< "frame_rate"
const char* unit(PublishedQuantity quantity);  ///< "1/s"

/// The set-up measured or shown for one number, point or panel.
struct PublishedSetUp {
  SourcePlace place;
  PublishedQuantity quantity = PublishedQuantity::time;
  std::filesystem::path scene;
  std::shared_ptr<const Pipeline> pipeline;  ///< null with `absent`, and where the reference is shown
  std::string camera;
  double time = 0.0;  ///< s
  ParameterValues settings;
  int subdivisions = 0;             ///< how many times every triangle of the scene is split into four first
  std::vector<std::string> passes;  ///< whose times or bytes are added up; empty: the whole frame
  std::string pass,
      port;  ///< an output that is kept: its fragments are counted, its image is shown; may be empty
  std::string absent;      ///< why it cannot be measured
  std::string substitute;  ///< the stand-in for the published set-up, so that a verdict would not count
};

/// One number of a published table, and how it is measured here.
struct PublishedRow : PublishedSetUp {
  std::string name;
  double published = 0.0;  ///< in the quantity's unit
  std::string over;        ///< the row that it is divided by; empty: the first one
};

/// The growth that a paper states for a number.
enum class Growth { unsaid, sublinear, linear, superlinear };
const char* name(Growth growth);

/// One curve of a figure.
struct PublishedCurve {
  std::string name;
  SourcePlace place;
  std::string over;  ///< "triangles" of the scene, or a parameter of the pipeline: the horizontal axis
  Growth growth = Growth::unsaid;
  std::vector<PublishedSetUp> points;  ///< all of one quantity
};

/// One image of a figure: an output of a pass, the whole image of the pipeline, or a layer of the
/// reference.
struct PublishedPanel : PublishedSetUp {
  std::string name;
  std::string reference;  ///< layer of the path-traced reference in place of a pipeline; empty: none
};

/// What a panel is claimed to have less of than another one.
enum class ClaimedQuantity {
  luminance,  ///< mean, W/(sr m²)
  colour,     ///< mean difference of the largest and the smallest channel, over the mean luminance
  detail      ///< mean difference of neighbouring pixels, over the mean luminance: noise, bands, edges
};
inline constexpr ClaimedQuantity kClaimedQuantities[] = {ClaimedQuantity::luminance, ClaimedQuantity::colour,
                                                         ClaimedQuantity::detail};
const char* name(ClaimedQuantity quantity);

/// A sentence of a paper about the images of a figure, as far as it says which one has less of something.
struct PublishedClaim {
  std::string name;        ///< the sentence
  std::string less, than;  ///< panels
  std::string darkIn;      ///< the panel whose darkest quarter of pixels is compared; empty: all pixels are
  ClaimedQuantity quantity = ClaimedQuantity::luminance;
  double times = 1.0;  ///< how many times `than` counts
};

/// A text `*.reproduction`: one published table or figure.
struct PublishedResult {
  std::filesystem::path file;
  std::string id;  ///< "004-table-3"
  std::string title, paper, device;
  int width = 0, height = 0;        ///< of the published image; 0: the camera's
  std::vector<std::string> scaled;  ///< parameters that a reduced set-up makes smaller with the image
  double softwareScale = 1.0;       ///< reduction by default on a software rasteriser
  std::vector<std::string>
      differences;  ///< of the set-up from the published one that do not change the verdict
  std::vector<PublishedRow> rows;
  std::vector<PublishedCurve> curves;
  std::vector<PublishedPanel> panels;
  std::vector<PublishedClaim> claims;
  int columns = 0;  ///< of the sheet that holds the panels; 0: as square as it goes
  std::shared_ptr<const dsl::Document> document;

  /// Throws DiagnosticsError with every finding that needs no technique library, those of its pipelines among
  /// them.
  static PublishedResult load(const std::filesystem::path& file);
  /// Of rows, points and panels, in the order of the text.
  std::vector<const PublishedSetUp*> setUps() const;
};

/// First author and year of its paper in place of the paper's number: "gomes2015-table-3" for "004-table-3".
/// The id itself where it begins with no number or the paper names no author and year.
std::string citedName(const PublishedResult& result);

/// Tables of the grammar, for describe and the reference.
const std::vector<dsl::BlockSpecification>& reproductionSpecifications();

/// All findings against the techniques.
void checkReproduction(const PublishedResult& result, TechniqueSource& techniques);

enum class Verdict {
  reference,      ///< the row that the others are divided by
  reproduced,     ///< the measured ratio, with its uncertainty, lies within the factor of the published one
  notReproduced,  ///< all of it lies beyond
  notComparable   ///< something of the set-up is missing, or the uncertainty reaches across the limit
};
const char* name(Verdict verdict);  ///< "not reproduced"

/// One set-up as far as it could be measured.
struct MeasuredSetUp {
  std::optional<TimingStatistics> measured;  ///< in that unit, but for frame rates, which are frame times, ms
  std::string whyNot;                        ///< not comparable, measured or not
  bool failed = false;                       ///< it should have been measured, and something went wrong
};
struct MeasuredRow : MeasuredSetUp {
  std::string name;
  PublishedQuantity quantity = PublishedQuantity::time;
  double published = 0.0;  ///< in the quantity's unit
  std::string over;        ///< the row that it is divided by; empty: the first one
};
struct MeasuredPoint : MeasuredSetUp {
  double x = 0.0;  ///< NaN where it is not known, since its scene is not here
};
struct MeasuredCurve {
  std::string name, over;
  PublishedQuantity quantity = PublishedQuantity::time;
  Growth growth = Growth::unsaid;
  std::vector<MeasuredPoint> points;
};

struct JudgedRow {
  Verdict verdict = Verdict::notComparable;
  double publishedRatio = 0.0;  ///< NaN where there is none
  double ratio = 0.0, lowRatio = 0.0,
         highRatio = 0.0;  ///< measured, and as far as it reaches; NaN where there is none
  std::string why;         ///< of a row that is not comparable
};
struct JudgedTable {
  Verdict verdict = Verdict::notComparable;
  std::string why;
  std::vector<JudgedRow> rows;
};
struct JudgedCurve {
  Verdict verdict = Verdict::notComparable;
  std::string why;
  Measured exponent;  ///< of the power law through the medians; NaN where there is none
};

/// An image of a figure.
struct ShownPanel {
  std::string name;
  ImageBuffer image;   ///< linear; empty where there is none
  std::string whyNot;  ///< why there is none, or its stand-in
  bool failed = false;
  bool radiance = true;        ///< false: a fraction, which no exposure changes
  double meanLuminance = 0.0;  ///< W/(sr m²), or a mean fraction; NaN where there is no image
};

/// A claim with what both panels have; NaN where there is no image.
struct MeasuredClaim : PublishedClaim {
  double lessValue = 0.0, thanValue = 0.0;
  std::string whyNot;  ///< not comparable, measured or not
};
struct JudgedClaim {
  Verdict verdict = Verdict::notComparable;
  std::string why;
};

struct ReproducedResult {
  PublishedResult published;
  std::vector<MeasuredRow> rows;
  JudgedTable judged;  ///< the rows
  std::vector<MeasuredCurve> curves;
  std::vector<JudgedCurve> judgedCurves;
  std::vector<ShownPanel> panels;
  std::vector<MeasuredClaim> claims;
  std::vector<JudgedClaim> judgedClaims;
  double exposure = 0.0;  ///< EV, one for all panels
  double scale = 1.0;
  std::vector<std::string> setUps;  ///< "scenes/a.scene, a.pipeline: resolution=64, 256 x 192 pixels"
  gpu::DeviceInfo device;
  std::string host, date, command;
  int repeats = 0;
  bool failed() const;  ///< something should have been measured, and went wrong
};

/// A file of results as they were measured, without the pixels of images.
std::string reproductionsAsJson(const std::vector<ReproducedResult>& results);
/// Not judged: see judged(). Error that names the file and the place for anything that reproductionsAsJson()
/// does not write.
std::vector<ReproducedResult> readReproductions(const std::filesystem::path& file);

/// How kept results differ from the texts that they were measured by: rows, curves, claims and published
/// numbers. Empty: they fit.
std::vector<std::string> staleReproductions(const std::vector<ReproducedResult>& results,
                                            const std::vector<PublishedResult>& published);

}  // namespace lumivox
