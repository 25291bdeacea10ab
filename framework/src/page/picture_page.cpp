#include "page/picture_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "page/page_parts.h"

namespace lumivox::page {
namespace {

/// A picture of the page that the frame with the slider can show: the id of its element, and its title.
struct Shown {
  std::string id, title;
};

/// Writes the pictures of one scene and remembers what it wrote.
class PictureWriter {
 public:
  PictureWriter(std::size_t sceneIndex, const AnalysedScene& scene) : index_(sceneIndex), scene_(scene) {}

  std::string component(const std::string& component) {
    shown_.clear();
    truths_.clear();
    maps_.clear();
    leftFirst_ = 0;
    double exposure = 1.0;
    std::string strips, more;
    for (const PointRecord& record : scene_.points)
      for (const OutputPictures& pictures : record.pictures) {
        if (pictures.component != component || (component == "final" && pictures.output != kWholePicture))
          continue;
        for (const TruthRecord& truth : scene_.truths)
          if (!pictures.against.empty() && truth.layer == pictures.against.back().truth)
            exposure = truth.exposure;
        if (record.isDefault) leftFirst_ = shown_.size();
        const std::string one = strip(
            pictures, shortName(record.point.pipeline) + ", " + parametersText(record.point.parameters));
        (record.isDefault ? strips : more) += one;
      }
    if (strips.empty() && more.empty()) return {};
    std::string html = fmt::format("<h4>{} <span class=\"soft\">(exposure {:.3g})</span></h4>\n",
                                   escaped(componentTitle(component)), exposure) +
                       wipe(component) + strips;
    if (!more.empty())
      html += "<details><summary>Other points of the sweeps</summary>\n" + more + "</details>\n";
    return html;
  }

 private:
  std::string image(const std::string& png, const std::string& text, std::vector<Shown>& list,
                    const std::string& title) {
    list.push_back({fmt::format("picture-{}-{}", index_, count_++), title});
    return fmt::format("<img id=\"{}\" alt=\"{}\" src=\"data:image/png;base64,{}\">", list.back().id,
                       escaped(text), base64(png));
  }

  std::string truthFigure(const std::string& layer) {
    const auto known = std::any_of(scene_.truths.begin(), scene_.truths.end(),
                                   [&](const TruthRecord& truth) { return truth.layer == layer; });
    if (!known) return {};
    const std::string id = fmt::format("truth-{}-{}", index_, layer);
    if (std::none_of(truths_.begin(), truths_.end(), [&](const Shown& one) { return one.id == id; }))
      truths_.push_back({id, "truth: " + layer});
    return fmt::format(
        "<figure><div class=\"truth {}\" style=\"aspect-ratio:{}/{}\" role=\"img\" "
        "aria-label=\"truth: {}\"></div><figcaption>truth: {}</figcaption></figure>\n",
        escaped(id), scene_.width, scene_.height, escaped(layer), escaped(layer));
  }

  std::string strip(const OutputPictures& pictures, const std::string& title) {
    std::string html = "<div class=\"strip\">\n<figure>" + image(pictures.picture, title, shown_, title) +
                       "<figcaption>" + escaped(title) + "</figcaption></figure>\n";
    for (const OutputPictures::Against& against : pictures.against) {
      html += truthFigure(against.truth);
      html += "<figure>" +
              image(against.flipMap, "FLIP map against " + against.truth, maps_,
                    "FLIP: " + title + " against " + against.truth) +
              fmt::format("<figcaption>FLIP against {}: mean {:.3f}</figcaption></figure>\n",
                          escaped(against.truth), against.flip);
    }
    return html + "</div>\n";
  }

  std::string options(const std::string& selected) const {
    std::string html;
    for (const std::vector<Shown>* list : {&truths_, &shown_, &maps_})
      for (const Shown& one : *list)
        html += fmt::format("<option value=\"{}\"{}>{}</option>", escaped(one.id),
                            one.id == selected ? " selected" : "", escaped(one.title));
    return html;
  }

  /// Two pictures in one frame, the slider between them.
  std::string wipe(const std::string& component) const {
    const std::string right = truths_.empty() ? shown_.back().id : truths_.back().id;
    return fmt::format(
        "<div class=\"wipe\" data-wipe=\"{}\"><p><label>Left: <select>{}</select></label> <label>Right: "
        "<select>{}</select></label></p>\n<canvas width=\"{}\" height=\"{}\" role=\"img\" aria-label=\"two "
        "pictures of {}, one on each side of the slider\"></canvas>\n<input type=\"range\" min=\"0\" "
        "max=\"100\" value=\"50\" aria-label=\"where one picture ends and the other begins\"></div>\n",
        escaped(component), options(shown_[leftFirst_].id), options(right), scene_.width, scene_.height,
        escaped(componentTitle(component)));
  }

  std::size_t index_, count_ = 0;
  std::size_t leftFirst_ = 0;  ///< into shown_: what the frame shows on its left at first
  const AnalysedScene& scene_;
  std::vector<Shown> shown_, truths_, maps_;
};

}  // namespace

std::string truthStyles(const AnalysedReport& data) {
  std::string css;
  for (std::size_t i = 0; i < data.analysed.size(); ++i)
    for (const TruthRecord& truth : data.analysed[i].truths)
      css += fmt::format(".truth-{}-{} {{ background-image: url(data:image/png;base64,{}); }}\n", i,
                         truth.layer, base64(truth.picture));
  return css;
}

std::string pictureSection(std::size_t sceneIndex, const AnalysedScene& scene) {
  std::string html =
      "<h3>Pictures, truth and FLIP maps</h3>\n<p class=\"caption\">All pictures of one component are shown "
      "at one exposure, which puts the 99th percentile of its full truth at 0.8 before the sRGB curve. A "
      "FLIP map is dark where a viewer sees no difference and bright where the difference is plain. NaN "
      "pixels are magenta. Pictures are means over positions in the pixel, as the truth is. The slider "
      "moves the border between any two of them.</p>\n";
  PictureWriter writer(sceneIndex, scene);
  // The whole picture is what a reader looks for first.
  std::vector<std::string> order = componentsOf(pointsOf(scene));
  std::stable_partition(order.begin(), order.end(),
                        [](const std::string& component) { return component == "final"; });
  std::string black;
  for (const std::string& component : order) {
    const PipelineComparison* comparison = comparisonOf(scene, component, false, "rmse");
    if (comparison != nullptr && comparison->front.empty())
      black += (black.empty() ? "" : ", ") + escaped(componentTitle(component));
    else
      html += writer.component(component);
  }
  if (!black.empty())
    html += "<p class=\"caption\">Not shown, since it is exactly that of the truth: " + black + ".</p>\n";
  return html;
}

const char* const kPictureScript = R"js(
"use strict";
for (const frame of document.querySelectorAll("[data-wipe]")) {
  const [left, right] = frame.querySelectorAll("select"), slider = frame.querySelector("input");
  const canvas = frame.querySelector("canvas"), context = canvas.getContext("2d");
  const pictures = [new Image(), new Image()];
  const enlarged = Math.max(1, Math.round(640 / canvas.width));  // so that the border is a thin line
  canvas.width *= enlarged;
  canvas.height *= enlarged;
  // A truth is a style; its first element has the address.
  const address = id => {
    const element = document.getElementById(id);
    return element ? element.src : getComputedStyle(document.querySelector("." + CSS.escape(id))).backgroundImage.slice(5, -2);
  };
  const draw = () => {
    const border = Math.round(slider.value / 100 * canvas.width);
    context.imageSmoothingEnabled = false;
    context.drawImage(pictures[1], 0, 0, canvas.width, canvas.height);
    context.save();
    context.beginPath(); context.rect(0, 0, border, canvas.height); context.clip();
    context.drawImage(pictures[0], 0, 0, canvas.width, canvas.height);
    context.restore();
    context.fillStyle = "#ffffff";
    context.fillRect(border - 1, 0, 2, canvas.height);
  };
  const load = async () => {
    pictures[0].src = address(left.value);
    pictures[1].src = address(right.value);
    await Promise.all(pictures.map(picture => picture.decode()));
    draw();
  };
  slider.addEventListener("input", draw);
  left.addEventListener("change", load);
  right.addEventListener("change", load);
  load();
}
)js";

}  // namespace lumivox::page
