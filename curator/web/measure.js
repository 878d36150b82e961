// A ruler on the model: two places that were picked, the straight line between them, and how exact its length is.

// metres as a visitor's terminal says it: no digits below the error, which is rounded up to one (ui/measure_view.c).
function lengthText(metres, digit) {
  const step = 10 ** digit, rounded = Math.round(metres / step) * step;
  const [power, unit] = rounded > 0.999999 ? [0, "m"] : rounded > 0.009999 ? [-2, "cm"] : [-3, "mm"];
  return `${(rounded / 10 ** power).toFixed(Math.max(0, power - digit))} ${unit}`;
}

function textOf(metres, error) {
  let digit = Math.floor(Math.log10(Math.max(error, 1e-4))), leading = Math.ceil(Math.max(error, 1e-4) / 10 ** digit - 1e-6);
  if (leading > 9) [digit, leading] = [digit + 1, 1];
  return `${lengthText(metres, digit)} ± ${lengthText(leading * 10 ** digit, digit)}`;
}

export class Ruler {
  // scanError: in metres; undefined: the content does not say it.
  constructor(scanError) {
    Object.assign(this, { scanError, ends: [] });
  }

  // pixelError: of the place, in metres; the full model is measured, so only the pixel and the scan are inexact.
  add(at, pixelError) {
    if (this.ends.length === 2) this.ends = [];
    this.ends.push({ at, pixelError });
  }

  text() {
    if (this.ends.length < 2) return this.ends.length ? "Click the second place." : "Click two places on the model.";
    const [a, b] = this.ends, length = Math.hypot(...a.at.map((c, i) => c - b.at[i]));
    const error = Math.hypot(a.pixelError, b.pixelError, Math.SQRT2 * (this.scanError || 0));
    return `${textOf(length, error)}${this.scanError ? "" : ", without the scan's own error: temple.ini has no error_mm"}`;
  }

  // pixelOf: where a point is in the picture; null: behind the eye.
  draw(ink, pixelOf) {
    const pixels = this.ends.map(end => pixelOf(end.at)).filter(pixel => pixel);
    for (const [width, colour] of [[7, "#000c"], [3, "#fff"]]) {
      ink.lineWidth = width;
      ink.strokeStyle = colour;
      ink.beginPath();
      if (pixels.length === 2) for (const pixel of pixels) ink.lineTo(...pixel);
      for (const [x, y] of pixels) {
        ink.moveTo(x + 6, y);
        ink.arc(x, y, 6, 0, 2 * Math.PI);
      }
      ink.stroke();
    }
  }
}
