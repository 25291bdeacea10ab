"use strict";
// Images, reference and FLIP maps, and a frame with a slider between any two of them.
const imagesOf = (function () {
  const { images, h, caption, folded, counted, exposureText, shortName, broken, pipelineName, parametersText, componentTitle, pngAddress,
          whenShown } = lumivox;
  const ownOf = index => (images.scenes || [])[index] || { references: [], points: [] };
  const figure = (address, alt, kind, text) => h("figure", null, h("img", { class: kind, alt, src: address }), h("figcaption", null, text));
  /** Of the whole image only the composite counts, which every pipeline has. */
  const isOf = (output, component) => output.component === component && (component !== "final" || output.output === "whole_image");

  /** Two images in one frame, the slider between them. `choices`: { title, address }. */
  function wipe(scene, component, choices, left, right) {
    const select = chosen => h("select", null, choices.map((one, index) => h("option", { value: index, selected: index === chosen }, one.title)));
    const selects = [select(left), select(right)];
    const enlarged = Math.max(1, Math.round(640 / scene.width));  // so that the border is a thin line
    const canvas = h("canvas", { width: scene.width * enlarged, height: scene.height * enlarged, role: "img",
      "aria-label": "two images of " + componentTitle(component) + ", one on each side of the slider" });
    const slider = h("input", { type: "range", min: 0, max: 100, value: 50, "aria-label": "where one image ends and the other begins" });
    const shown = [new Image(), new Image()];
    const draw = () => {
      const context = canvas.getContext("2d"), border = Math.round(slider.value / 100 * canvas.width);
      context.imageSmoothingEnabled = false;
      context.drawImage(shown[1], 0, 0, canvas.width, canvas.height);
      context.save();
      context.beginPath(); context.rect(0, 0, border, canvas.height); context.clip();
      context.drawImage(shown[0], 0, 0, canvas.width, canvas.height);
      context.restore();
      context.fillStyle = "#ffffff";
      context.fillRect(border - 1, 0, 2, canvas.height);
    };
    const load = async () => {
      shown.forEach((image, side) => { image.src = choices[selects[side].value].address; });
      await Promise.all(shown.map(image => image.decode()));
      draw();
    };
    slider.addEventListener("input", draw);
    selects.forEach(one => one.addEventListener("change", load));
    whenShown(load);
    return h("div", { class: "wipe", "data-wipe": component },
             h("p", { class: "choices" }, h("label", null, "Left ", selects[0]), h("label", null, "Right ", selects[1])), canvas, slider);
  }

  /** The reference and the images of the default points in the light that is compared, in one row. */
  function row(scene, index, comparison) {
    const own = ownOf(index), figures = [];
    let layer = null;
    own.points.forEach((outputs, at) => {
      const point = scene.points[at], output = outputs.find(one => isOf(one, comparison.component));
      if (!point.default || !output || point.pipeline in scene.same_passes) return;
      const map = output.against[comparison.against === "bias" ? 0 : output.against.length - 1];
      if (map) layer = map.reference;
      figures.push(figure(pngAddress(output.png), shortName(point.pipeline), null,
                          [pipelineName(point.pipeline), map && h("span", { class: "soft" }, " FLIP " + map.flip.toFixed(3))]));
    });
    if (figures.length === 0) return null;
    const reference = own.references.find(one => one.layer === layer);
    const first = reference && figure(pngAddress(reference.png), "reference: " + layer, "reference",
                                      ["reference ", h("span", { class: "soft" }, broken(layer))]);
    return h("div", { class: "row", role: "group", "aria-label": "images of " + componentTitle(comparison.component),
                      style: "--figures:" + (figures.length + (first ? 1 : 0)) }, first, figures);
  }

  /** All images of one component of a scene; null without any. */
  function component(scene, own, name) {
    const references = [], shown = [], maps = [], strips = [], more = [];
    let first = 0;
    const referenceFigure = layer => {
      const reference = own.references.find(one => one.layer === layer);
      if (!reference) return null;
      if (!references.some(one => one.title === "reference: " + layer))
        references.push({ title: "reference: " + layer, address: pngAddress(reference.png) });
      return figure(pngAddress(reference.png), "reference: " + layer, "reference", broken("reference: " + layer));
    };
    own.points.forEach((outputs, index) => {
      const point = scene.points[index];
      for (const output of outputs) {
        if (!isOf(output, name) || point.pipeline in scene.same_passes) continue;
        const title = shortName(point.pipeline) + ", " + parametersText(point.parameters);
        if (point.default) first = shown.length;
        shown.push({ title, address: pngAddress(output.png) });
        (point.default ? strips : more).push(h("div", { class: "strip" },
          figure(pngAddress(output.png), title, null, broken(title)),
          output.against.map(map => {
            maps.push({ title: "FLIP: " + title + " against " + map.reference, address: pngAddress(map.png) });
            return [referenceFigure(map.reference), figure(pngAddress(map.png), "FLIP map against " + map.reference, null,
                                                           broken("FLIP against " + map.reference + ": mean " + map.flip.toFixed(3)))];
          })));
      }
    });
    if (shown.length === 0) return null;
    const choices = [...references, ...shown, ...maps];
    return folded(counted(componentTitle(name), shown.length, "image"),
      choices.length > 1 && wipe(scene, name, choices, references.length + first, references.length > 0 ? references.length - 1 : shown.length - 1), strips,
      more.length > 0 && folded(counted("Other points of the sweeps", more.length), more));
  }

  function all(scene, index) {
    const own = ownOf(index);
    const isBlack = name => scene.comparisons.some(one => one.component === name && one.front.length === 0);
    const black = scene.components.filter(isBlack);
    return [
      caption(`All images of the scene are shown at ${exposureText(scene)}, with the tone curve “${scene.reference.tone}”; occlusion, a `
        + "fraction, is shown as it is. A FLIP map is dark where a viewer sees no difference and bright where the difference is plain. NaN pixels are "
        + "magenta. Images are means over positions in the pixel, as the reference is. The slider moves the border between any two of them."),
      scene.components.filter(name => !isBlack(name)).map(name => component(scene, own, name)),
      black.length > 0 && caption("Not shown, since it is exactly that of the reference: " + black.map(componentTitle).join(", ") + ".")];
  }

  return { row, all };
})();
