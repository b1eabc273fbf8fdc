// Numbers as texts, and sensible ranges.

/**
 * A number with a few digits, without trailing zeros.
 * @param {number | null | undefined} value
 * @param {number} [digits]
 */
export function readable(value, digits = 8) {
  if (value === null || value === undefined || !Number.isFinite(value)) return "–";
  const size = Math.abs(value);
  const rounded = Number(value.toPrecision(digits));
  return size >= 1e7 || (size > 0 && size < 1e-4) ? String(rounded.toExponential()).replace("e+", "e") : String(rounded);
}

/**
 * A complex number.
 * @param {[number | null, number | null]} pair
 */
export function complex([re, im]) {
  if (!im) return readable(re, 6);
  // Beside the other part it is rounding.
  const real = Math.abs(re ?? 0) < 1e-13 * Math.abs(im) ? 0 : re;
  return `${readable(real, 6)} ${im < 0 ? "−" : "+"} ${readable(Math.abs(im), 6)}i`;
}

/**
 * A range about a value in which a slider moves: from nothing to twice the value.
 * @param {number} value
 * @returns {[number, number]}
 */
export function sliderRange(value) {
  if (value === 0) return [-1, 1];
  return value > 0 ? [0, 2 * value] : [2 * value, 0];
}

/**
 * Round values that divide a range into a few parts.
 * @param {number} low
 * @param {number} high
 * @param {number} [parts]
 */
export function ticks(low, high, parts = 5) {
  const span = high - low;
  if (!(span > 0) || !Number.isFinite(span)) return [];
  const rough = span / parts;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((factor) => factor * power).find((size) => size >= rough) ?? rough;
  const values = [];
  for (let index = Math.ceil(low / step - 1e-9); index * step <= high + 1e-9 * span; index++) values.push(index * step);
  return values;
}

/**
 * The least and the greatest of finite values, with some room; a window around them where they are equal.
 * @param {Iterable<number>} values
 * @param {number} [room]
 * @returns {[number, number]}
 */
export function extent(values, room = 0.05) {
  let [low, high] = [Infinity, -Infinity];
  for (const value of values) {
    if (!Number.isFinite(value)) continue;
    low = Math.min(low, value);
    high = Math.max(high, value);
  }
  if (low > high) return [0, 1];
  if (high - low <= 1e-12 * Math.max(Math.abs(low), Math.abs(high))) {
    const half = low === 0 ? 1 : Math.abs(low) / 2;
    return [low - half, high + half];
  }
  return [low - room * (high - low), high + room * (high - low)];
}
