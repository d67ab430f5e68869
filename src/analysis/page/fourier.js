// Exact Fourier coefficients of a signal over a whole number of periods.
// A piece from a to b is a sum of c_n P_n(x), x from -1 to 1. With j_n the spherical Bessel functions, the integral of P_n(x) exp(-izx) over
// [-1, 1] is 2 (-i)^n j_n(z) (DLMF 10.54.2), so that a piece of length h around m adds h exp(-iwm) times the sum of c_n (-i)^n j_n(wh/2).

// j_0(z) to j_{count-1}(z): upwards where that is stable, else downwards from zero far above (Miller), scaled by j_0 or j_1.
function sphericalBessel(z, count) {
  const values = new Float64Array(count);
  if (z === 0) { values[0] = 1; return values; }
  const j0 = Math.sin(z) / z, j1 = z < 1e-3 ? z / 3 * (1 - z * z / 10) : (Math.sin(z) / z - Math.cos(z)) / z;
  if (z > count) {
    values[0] = j0;
    if (count > 1) values[1] = j1;
    for (let n = 1; n + 1 < count; ++n) values[n + 1] = (2 * n + 1) / z * values[n] - values[n - 1];
    return values;
  }
  let above = 0, here = 1e-300;
  for (let n = count + 30; n > 0; --n) {
    [above, here] = [here, (2 * n + 1) / z * here - above];
    if (n - 1 < count) values[n - 1] = here;
    if (n < count) values[n] = above;
    if (Math.abs(here) > 1e200) { here *= 1e-200; above *= 1e-200; for (let k = n - 1; k < count; ++k) values[k] *= 1e-200; }
  }
  const scale = Math.abs(j0) > Math.abs(j1) ? j0 / here : j1 / above;
  for (let n = 0; n < count; ++n) values[n] *= scale;
  return values;
}

// Harmonics 0 to count of a frequency, {magnitude, phase} with the phase of A sin(wt + phase) in degrees from the begin of the window.
function harmonicsOf(signal, from, to, frequency, count) {
  const real = new Float64Array(count + 1), imaginary = new Float64Array(count + 1);
  for (const {from: begin, to: end, c} of piecesWithin(signal, from, to)) {
    const length = end - begin, middle = (begin + end) / 2 - from;
    for (let k = 0; k <= count; ++k) {
      const w = 2 * Math.PI * k * frequency, bessel = sphericalBessel(w * length / 2, c.length);
      let even = 0, odd = 0;  // the sum of c_n (-i)^n j_n is even - i odd
      for (let n = 0; n < c.length; ++n) {
        const term = (n & 2 ? -1 : 1) * c[n] * bessel[n];
        if (n & 1) odd += term; else even += term;
      }
      const turns = k * frequency * middle, angle = 2 * Math.PI * (turns - Math.round(turns)), cos = Math.cos(angle), sin = Math.sin(angle);
      real[k] += length * (even * cos - odd * sin);
      imaginary[k] -= length * (even * sin + odd * cos);
    }
  }
  const window = to - from;
  return Array.from(real, (value, k) => k === 0 ? {magnitude: value / window, phase: 0}
    : {magnitude: 2 * Math.hypot(value, imaginary[k]) / window, phase: Math.atan2(imaginary[k], value) * 180 / Math.PI + 90})
    .map(({magnitude, phase}) => ({magnitude, phase: phase > 180 ? phase - 360 : phase}));
}

// The period with which some times repeat; null where they do not.
function periodOf(times, tolerance) {
  const longest = 64, last = times.length - 1;
  for (let lag = 1; lag <= longest && 2 * lag < times.length; ++lag) {
    const mean = (times[last] - times[last % lag]) / Math.floor(last / lag);
    if (times.every((time, k) => k + lag > last || Math.abs(times[k + lag] - time - mean) <= tolerance * mean)) return Number(mean.toPrecision(9));
  }
  return null;
}

// The period of what happens from `from` to `to`: of the sources' edges, of the corners of the solution, or about that of diodes and switches.
function repeatOfEvents(from, to) {
  const mostTimes = 2000, marksOf = name => data.marks.find(marks => marks.name === name)?.x ?? [];
  for (const [times, tolerance] of [[marksOf("edges"), 1e-6], [data.records[0]?.edges ?? [], 1e-6], [marksOf("switching"), 1e-3]]) {
    const period = periodOf(times.filter(time => time >= from && time <= to).slice(-mostTimes), tolerance);
    if (period) return period;
  }
  return null;
}
