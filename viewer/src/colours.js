// Colours: those of the page, and a scale for each quantity.

// Each on light and on dark pages: the dark ends of scales are no sight on a dark page.
const scales = {
  speed: [['#0d0887', '#47039f', '#7301a8', '#9c179e', '#bd3786', '#d8576b', '#ed7953', '#fa9e3b', '#fdc926', '#f0f921'], // plasma
    ['#6650f0', '#9146ea', '#b848cc', '#d8579d', '#ec6d6b', '#f98d43', '#fdb62f', '#f4ee3a']],
  residence: [['#440154', '#482878', '#3e4a89', '#31688e', '#26828e', '#1f9e89', '#35b779', '#6ece58', '#b5de2b', '#fde725'], // viridis
    ['#7160d8', '#4f82d8', '#3a9fc4', '#2cb5a5', '#45c989', '#7fda62', '#c2e344', '#fde725']],
  id: [['#00224e', '#123570', '#3b496c', '#575d6d', '#707173', '#8a8678', '#a59c74', '#c3b369', '#e1cc55', '#fee838'], // cividis
    ['#5f7fc4', '#8291b4', '#9fa1a2', '#b7af8d', '#cec071', '#e5d256', '#fee838']],
  // What was hit most stands out most.
  hits: [['#fff1d6', '#fdc98a', '#f98b4b', '#e34a33', '#a8142b', '#5e0b2e'], ['#3b1a55', '#7a2272', '#c03a60', '#f06c36', '#fcb519', '#fcffa4']],
};

/** "#rrggbb" as three numbers from 0 to 1. */
export function parseColour(text) {
  const t = text.trim();
  const hex = t.length === 4 ? [1, 2, 3].map((i) => t[i] + t[i]) : [1, 3, 5].map((i) => t.slice(i, i + 2));
  return hex.map((x) => parseInt(x, 16) / 255);
}

const luminanceOf = (colour) => linear(colour).reduce((sum, c, k) => sum + c * [0.2126, 0.7152, 0.0722][k], 0);
const stopsOf = (name, page) => scales[name][page.isDark ? 1 : 0].map(parseColour);

/** The colour of a share from 0 to 1 in the scale of a quantity. */
export function scaleColour(name, share, page) {
  const list = stopsOf(name, page);
  const x = Math.max(0, Math.min(1, share)) * (list.length - 1);
  const i = Math.min(Math.floor(x), list.length - 2);
  return list[i].map((c, k) => c + (list[i + 1][k] - c) * (x - i));
}

export const scaleGradient = (name, page) => `linear-gradient(to right, ${stopsOf(name, page).map(css).join(', ')})`;

export const css = (colour) => `rgb(${colour.map((c) => Math.round(255 * c)).join(' ')})`;

/** The page's colours as they are now: they change with the scheme. */
export function pageColours() {
  const style = getComputedStyle(document.documentElement);
  const get = (name) => parseColour(style.getPropertyValue(name) || '#888888');
  const background = get('--panel');
  return {
    background,
    luminance: luminanceOf(background),
    isDark: luminanceOf(background) < 0.2,
    text: get('--text'),
    muted: get('--muted'),
    line: get('--line'),
    accent: get('--accent'),
    wall: get('--wall'),
    rim: get('--rim'),
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

/** Colours in linear light. */
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

/** A length for people: metres with a prefix. */
export function shortLength(x) {
  if (x === 0) return '0 m';
  for (const [unit, size] of [['km', 1e3], ['m', 1], ['mm', 1e-3], ['µm', 1e-6], ['nm', 1e-9]])
    if (Math.abs(x) >= 0.999 * size && Math.abs(x) < 1e6) return `${Number((x / size).toPrecision(3))} ${unit}`;
  return `${x.toExponential(2)} m`;
}
