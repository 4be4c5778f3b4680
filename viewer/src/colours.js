// Colours: those of the page, and scales for numbers.

const viridis = ['#440154', '#482878', '#3e4a89', '#31688e', '#26828e', '#1f9e89', '#35b779', '#6ece58', '#b5de2b', '#fde725'];

/** "#rrggbb" as three numbers from 0 to 1. */
export function parseColour(text) {
  const t = text.trim();
  const hex = t.length === 4 ? [1, 2, 3].map((i) => t[i] + t[i]) : [1, 3, 5].map((i) => t.slice(i, i + 2));
  return hex.map((x) => parseInt(x, 16) / 255);
}

const stops = viridis.map(parseColour);

/** The colour of a share from 0 to 1. */
export function scaleColour(share) {
  const x = Math.max(0, Math.min(1, share)) * (stops.length - 1);
  const i = Math.min(Math.floor(x), stops.length - 2);
  return stops[i].map((c, k) => c + (stops[i + 1][k] - c) * (x - i));
}

export const scaleGradient = `linear-gradient(to right, ${viridis.join(', ')})`;

/** The page's colours as they are now: they change with the scheme. */
export function pageColours() {
  const style = getComputedStyle(document.documentElement);
  const get = (name) => parseColour(style.getPropertyValue(name) || '#888888');
  return {
    background: get('--panel'),
    text: get('--text'),
    muted: get('--muted'),
    line: get('--line'),
    accent: get('--accent'),
    categories: [6, 0, 1, 2, 3, 4, 5, 7].map((i) => get(`--c${i}`)),
  };
}

/**
 * The colour of a patch, wherever it is shown; 0 is no patch. The first patch is neutral: most walls belong to it. If
 * there are more patches than colours, these come again, each mixed with another one. src/report/chart.cpp has the same rule.
 */
export function patchColour(patch, page) {
  if (patch === 0) return page.line;
  const { categories } = page;
  const n = categories.length;
  const round = Math.floor((patch - 1) / n);
  const other = categories[(patch - 1 + 5 * round) % n];
  return categories[(patch - 1) % n].map((c, k) => 0.75 * c + 0.25 * other[k]);
}

const toLinear = (c) => (c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4);

/** Materials of three take linear colours; those of the page are not. */
export function linear(colour) {
  return colour.map(toLinear);
}

/** A number for people, of three digits. */
export function shortNumber(x) {
  if (x === 0) return '0';
  const size = Math.abs(x);
  if (size >= 1e6 || size < 1e-3) return x.toExponential(2);
  return size >= 1000 ? Math.round(x).toLocaleString('en') : Number(x.toPrecision(3)).toString();
}
