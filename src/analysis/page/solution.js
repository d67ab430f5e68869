// The solution that a page holds: values, statistics and what a plot draws of them.
// Each signal is a Legendre series on every piece of its run; before the first piece there may be bins of time, of which only the least and the largest
// value, the mean and the mean square are known.
function solutionOf(data) {
  for (const signal of data.signals) {
    const lengths = Uint8Array.from(signal.lengths, digit => parseInt(digit, 16) + 1);
    const starts = new Uint32Array(lengths.length + 1);
    lengths.forEach((length, k) => { starts[k + 1] = starts[k] + length; });
    Object.assign(signal, data.records[signal.record], {starts, coefficients: Float64Array.from(signal.coefficients)});
    signal.extremes = new Map();
    signal.exactFrom = signal.begin = signal.bins.length ? signal.bins[0] : signal.edges[0];
    signal.end = signal.edges[signal.edges.length - 1];
  }

  // The last k with list[k] <= value, at least 0.
  function placeIn(list, value) {
    let low = 0, high = list.length - 1;
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (list[middle] <= value) low = middle; else high = middle - 1;
    }
    return low;
  }

  // Clenshaw's recurrence: the sum of c[k] P_k(x) from c[begin] to before c[end].
  function series(c, begin, end, x) {
    let b1 = 0, b2 = 0;
    for (let k = end - begin - 1; k >= 1; --k) [b1, b2] = [c[begin + k] + (2 * k + 1) / (k + 1) * x * b1 - (k + 1) / (k + 2) * b2, b1];
    return c[begin] + x * b1 - b2 / 2;
  }

  const valueIn = (signal, piece, x) => series(signal.coefficients, signal.starts[piece], signal.starts[piece + 1], x);
  const placeInPiece = (signal, piece, time) => {
    const from = signal.edges[piece], to = signal.edges[piece + 1];
    return Math.max(-1, Math.min(1, (2 * time - from - to) / (to - from)));
  };
  const lastPiece = signal => signal.edges.length - 2;
  // The piece right of a time, or left of it.
  const pieceAt = (signal, time, left = false) => {
    const k = Math.min(placeIn(signal.edges, time), lastPiece(signal));
    return left && k > 0 && signal.edges[k] === time ? k - 1 : k;
  };

  // After a jump, or before it; null where it is not known.
  function valueAt(signal, time, isBefore = false) {
    if (!(time >= signal.edges[0] && time <= signal.end)) return null;
    const piece = pieceAt(signal, time, isBefore);
    return valueIn(signal, piece, placeInPiece(signal, piece, time));
  }

  // P'_{k+1} = P'_{k-1} + (2k + 1) P_k.
  function derivative(c) {
    const result = new Float64Array(Math.max(c.length - 1, 1));
    for (let k = c.length - 2; k >= 0; --k) result[k] = (2 * k + 1) * (c[k + 1] + (k + 2 < result.length ? result[k + 2] / (2 * k + 5) : 0));
    return result;
  }

  // The least and the largest value of a piece for x from lower to upper.
  function extremesIn(signal, piece, lower, upper) {
    const isWhole = lower === -1 && upper === 1;
    if (isWhole && signal.extremes.has(piece)) return signal.extremes.get(piece);
    const ends = [valueIn(signal, piece, lower), valueIn(signal, piece, upper)];
    const length = signal.starts[piece + 1] - signal.starts[piece];
    const straight = 2;
    if (length > straight) {
      const slope = derivative(signal.coefficients.subarray(signal.starts[piece], signal.starts[piece + 1]));
      const at = x => series(slope, 0, slope.length, x);
      const parts = 4 * length;
      for (let k = 0; k < parts; ++k) {
        let a = lower + (upper - lower) * k / parts, b = lower + (upper - lower) * (k + 1) / parts;
        const rises = at(a) > 0;
        if (rises === at(b) > 0) continue;
        for (let halving = 0; halving < 50; ++halving) {
          const middle = (a + b) / 2;
          if (at(middle) > 0 === rises) a = middle; else b = middle;
        }
        ends.push(valueIn(signal, piece, (a + b) / 2));
      }
    }
    const found = {low: Math.min(...ends), high: Math.max(...ends)};
    if (isWhole) signal.extremes.set(piece, found);
    return found;
  }

  const mayLeave = (signal, piece, low, high) => {
    const begin = signal.starts[piece], end = signal.starts[piece + 1];
    let reach = 0;
    for (let k = begin + 1; k < end; ++k) reach += Math.abs(signal.coefficients[k]);
    return signal.coefficients[begin] - reach < low || signal.coefficients[begin] + reach > high;
  };

  // Sixteen points and weights: exact for the square of a series.
  const gauss = (() => {
    const count = 16, points = [], weights = [], c = new Float64Array(count + 1);
    c[count] = 1;
    const slope = derivative(c);
    for (let k = 0; k < count; ++k) {
      let x = -Math.cos(Math.PI * (k + 0.75) / (count + 0.5));
      for (let step = 0; step < 20; ++step) x -= series(c, 0, count + 1, x) / series(slope, 0, count, x);
      points.push(x);
      weights.push(2 / ((1 - x * x) * series(slope, 0, count, x) ** 2));
    }
    return {points, weights};
  })();

  const legendre = gauss.points.map((unused, k) => gauss.points.map(x => { const c = new Float64Array(k + 1); c[k] = 1; return series(c, 0, k + 1, x); }));

  // Exact, over [from, to]; where there are only bins these are edges of bins.
  function measure(signal, from, to) {
    let low = Infinity, high = -Infinity, area = 0, square = 0;
    for (let k = 0; k + 1 < signal.bins.length; ++k) {
      if (signal.bins[k + 1] <= from || signal.bins[k] >= to) continue;
      const length = signal.bins[k + 1] - signal.bins[k];
      low = Math.min(low, signal.least[k]);
      high = Math.max(high, signal.largest[k]);
      area += length * signal.mean[k];
      square += length * signal.square[k];
    }
    for (let k = pieceAt(signal, Math.max(from, signal.edges[0])); k <= lastPiece(signal) && signal.edges[k] < to; ++k) {
      const lower = placeInPiece(signal, k, from), upper = placeInPiece(signal, k, to);
      if (upper <= lower) continue;
      const length = Math.min(to, signal.edges[k + 1]) - Math.max(from, signal.edges[k]);
      const begin = signal.starts[k], end = signal.starts[k + 1], c = signal.coefficients;
      if (lower === -1 && upper === 1) {  // Parseval
        area += length * c[begin];
        for (let j = begin; j < end; ++j) square += length * c[j] * c[j] / (2 * (j - begin) + 1);
      } else {
        gauss.points.forEach((point, i) => {
          const value = valueIn(signal, k, lower + (upper - lower) * (point + 1) / 2);
          area += length * gauss.weights[i] / 2 * value;
          square += length * gauss.weights[i] / 2 * value * value;
        });
      }
      if (!mayLeave(signal, k, low, high)) continue;
      const extremes = extremesIn(signal, k, lower, upper);
      low = Math.min(low, extremes.low);
      high = Math.max(high, extremes.high);
    }
    return {low, high, mean: area / (to - from), rms: Math.sqrt(Math.max(square, 0) / (to - from))};
  }

  // The values of a signal in each of so many columns of [from, to]: the first, the extremes, the last.
  function columnsOf(signal, from, to, count) {
    const values = new Array(4 * count).fill(null), width = (to - from) / count;
    let bin = placeIn(signal.bins, from), piece = pieceAt(signal, Math.max(from, signal.edges[0]));
    for (let k = 0; k < count; ++k) {
      const begin = Math.max(from + k * width, signal.begin), end = Math.min(from + (k + 1) * width, signal.end);
      if (end <= begin) continue;
      let low = Infinity, high = -Infinity, first = null, last = null;
      while (bin + 2 < signal.bins.length && signal.bins[bin + 1] <= begin) ++bin;
      for (let b = bin; b + 1 < signal.bins.length && signal.bins[b] < end; ++b) {
        if (signal.bins[b + 1] <= begin || !Number.isFinite(signal.largest[b] - signal.least[b])) continue;
        low = Math.min(low, signal.least[b]);
        high = Math.max(high, signal.largest[b]);
      }
      if (low <= high) first = last = (low + high) / 2;
      while (piece < lastPiece(signal) && signal.edges[piece + 1] <= begin) ++piece;
      for (let p = piece; p <= lastPiece(signal) && signal.edges[p] < end; ++p) {
        const lower = placeInPiece(signal, p, begin), upper = placeInPiece(signal, p, end);
        if (upper <= lower) continue;
        if (first === null) first = valueIn(signal, p, lower);
        last = valueIn(signal, p, upper);
        if (!mayLeave(signal, p, low, high)) continue;
        const extremes = extremesIn(signal, p, lower, upper);
        low = Math.min(low, extremes.low);
        high = Math.max(high, extremes.high);
      }
      const falls = last < first, isPlain = low === Math.min(first, last) && high === Math.max(first, last);
      values[4 * k] = first;
      values[4 * k + 1] = isPlain ? first + (last - first) / 3 : falls ? high : low;
      values[4 * k + 2] = isPlain ? last - (last - first) / 3 : falls ? low : high;
      values[4 * k + 3] = last;
    }
    return values;
  }

  // The series that has these values at the sixteen points.
  const projected = values =>
    Float64Array.from(values, (unused, k) => values.reduce((sum, value, i) => sum + (2 * k + 1) / 2 * gauss.weights[i] * value * legendre[k][i], 0));

  // A signal that a function makes of others, on the pieces where these are known: each is halved until sixteen coefficients resolve it. Where there are only
  // bins it lies between bounds; its mean is not known there.
  function derived(name, unit, sources, {at, within}) {
    const edges = [sources[0].edges[0]], lengths = [], coefficients = [], resolution = 1e-12, deepest = 10;
    let largest = 0;
    const add = (piece, lower, upper, depth) => {
      const values = gauss.points.map(point => at(sources.map(source => valueIn(source, piece, lower + (upper - lower) * (point + 1) / 2))));
      const c = projected(values);
      largest = Math.max(largest, ...values.map(Math.abs));
      if (Math.abs(c[13]) + Math.abs(c[14]) + Math.abs(c[15]) > resolution * largest && depth < deepest) {
        add(piece, lower, (lower + upper) / 2, depth + 1);
        add(piece, (lower + upper) / 2, upper, depth + 1);
        return;
      }
      const from = sources[0].edges[piece], to = sources[0].edges[piece + 1];
      edges.push(upper === 1 ? to : from + (upper + 1) / 2 * (to - from));
      lengths.push(c.length);
      coefficients.push(...c);
    };
    for (let piece = 0; piece <= lastPiece(sources[0]); ++piece) add(piece, -1, 1, 0);
    const starts = new Uint32Array(lengths.length + 1);
    lengths.forEach((length, k) => { starts[k + 1] = starts[k] + length; });
    const {bins} = sources[0], spans = sources[0].least.map((unused, k) => within(sources.map(source => [source.least[k], source.largest[k]])));
    return {name, unit, colour: "", record: sources[0].record, isDerived: true, bins, least: spans.map(span => span[0]), largest: spans.map(span => span[1]), mean: [], square: [],
      edges, starts, coefficients: Float64Array.from(coefficients), extremes: new Map(), exactFrom: edges[0], begin: bins.length ? bins[0] : edges[0], end: edges[edges.length - 1]};
  }

  // The pieces of a signal within [from, to] with their series; those that the window cuts are expanded anew.
  function piecesWithin(signal, from, to) {
    const pieces = [];
    for (let k = pieceAt(signal, from); k <= lastPiece(signal) && signal.edges[k] < to; ++k) {
      const lower = placeInPiece(signal, k, from), upper = placeInPiece(signal, k, to);
      if (upper <= lower) continue;
      let c = signal.coefficients.subarray(signal.starts[k], signal.starts[k + 1]);
      if (lower !== -1 || upper !== 1) {
        const values = gauss.points.map(point => valueIn(signal, k, lower + (upper - lower) * (point + 1) / 2));
        c = projected(values).subarray(0, c.length);
      }
      pieces.push({from: Math.max(from, signal.edges[k]), to: Math.min(to, signal.edges[k + 1]), c});
    }
    return pieces;
  }

  return {placeIn, valueAt, measure, columnsOf, derived, piecesWithin};
}
