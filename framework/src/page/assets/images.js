"use strict";
// Images, reference and FLIP maps, and a frame with a slider between any two of them.
const imageSection = (function () {
  const { images, h, caption, folded, exposureText, shortName, parametersText, componentTitle, pngAddress, whenShown } = lumivox;

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
             h("p", null, h("label", null, "Left: ", selects[0]), " ", h("label", null, "Right: ", selects[1])), canvas, slider);
  }

  /** All images of one component of a scene; null without any. */
  function component(scene, own, name) {
    const references = [], shown = [], maps = [], strips = [], more = [];
    let first = 0;
    const referenceFigure = layer => {
      const reference = own.references.find(one => one.layer === layer);
      if (!reference) return null;
      if (!references.some(one => one.title === "reference: " + layer)) references.push({ title: "reference: " + layer, address: pngAddress(reference.png) });
      return h("figure", null, h("img", { class: "reference", alt: "reference: " + layer, src: pngAddress(reference.png) }),
               h("figcaption", null, "reference: " + layer));
    };
    own.points.forEach((outputs, index) => {
      const point = scene.points[index];
      for (const output of outputs) {
        if (output.component !== name || (name === "final" && output.output !== "whole_image")) continue;
        const title = shortName(point.pipeline) + ", " + parametersText(point.parameters);
        if (point.default) first = shown.length;
        shown.push({ title, address: pngAddress(output.png) });
        const strip = h("div", { class: "strip" },
          h("figure", null, h("img", { alt: title, src: pngAddress(output.png) }), h("figcaption", null, title)),
          output.against.map(map => {
            maps.push({ title: "FLIP: " + title + " against " + map.reference, address: pngAddress(map.png) });
            return [referenceFigure(map.reference),
                    h("figure", null, h("img", { alt: "FLIP map against " + map.reference, src: pngAddress(map.png) }),
                      h("figcaption", null, "FLIP against " + map.reference + ": mean " + map.flip.toFixed(3)))];
          }));
        (point.default ? strips : more).push(strip);
      }
    });
    if (shown.length === 0) return null;
    const choices = [...references, ...shown, ...maps];
    return [h("h4", null, componentTitle(name)),
            wipe(scene, name, choices, references.length + first, references.length > 0 ? references.length - 1 : shown.length - 1), strips,
            more.length > 0 && folded("Other points of the sweeps", more)];
  }

  return function (scene, index) {
    const own = (images.scenes || [])[index] || { references: [], points: [] };
    const isBlack = name => scene.comparisons.some(one => one.component === name && one.metric === "rmse" && one.front.length === 0);
    const order = scene.components.filter(name => name === "final").concat(scene.components.filter(name => name !== "final"));
    const black = order.filter(isBlack);
    return [
      h("h3", null, "Images, reference and FLIP maps"),
      caption(`All images of the scene are shown at ${exposureText(scene)}, with the tone curve “${scene.reference.tone}”; occlusion, a `
        + "fraction, is shown as it is. A FLIP map is dark where a viewer sees no difference and bright where the difference is plain. NaN pixels are "
        + "magenta. Images are means over positions in the pixel, as the reference is. The slider moves the border between any two of them."),
      order.filter(name => !isBlack(name)).map(name => component(scene, own, name)),
      black.length > 0 && caption("Not shown, since it is exactly that of the reference: " + black.map(componentTitle).join(", ") + ".")];
  };
})();
