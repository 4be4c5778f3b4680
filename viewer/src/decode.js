// Decodes the blocks of a report: docs/report.md has the format.

/** Bytes of a block. Throws where it is missing or damaged. */
export async function readBlock(number) {
  const element = document.getElementById(`b${number}`);
  if (!element) throw new Error(`block ${number} is missing`);
  const text = atob(element.textContent);
  const packed = new Uint8Array(text.length); // a loop takes a tenth of what from() takes
  for (let i = 0; i < text.length; ++i) packed[i] = text.charCodeAt(i);
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream('gzip'));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/** A block of numbers: `kind` is a typed array. A null block gives null. */
export async function readNumbers(number, kind) {
  if (number === null || number === undefined) return null;
  const bytes = await readBlock(number);
  return new kind(bytes.buffer, 0, Math.floor(bytes.byteLength / kind.BYTES_PER_ELEMENT));
}

const unzigzag = (z) => (z >>> 1) ^ -(z & 1);

/** Undoes second differences of 16 bits: the low bytes of all values, then the high bytes. */
function undoSecondDifferences(bytes, out, first, count, each) {
  const n = count * each;
  if (bytes.length < 2 * n) throw new Error('a group of frames is too short');
  const base = first * each;
  for (let i = 0; i < n; ++i) {
    const code = bytes[i] | (bytes[n + i] << 8);
    const k = base + i;
    if (i < each) out[k] = code;
    else if (i < 2 * each) out[k] = out[k - each] + unzigzag(code);
    else out[k] = 2 * out[k - each] - out[k - 2 * each] + unzigzag(code);
  }
}

/** Undoes first differences of 8 bits. */
function undoFirstDifferences(bytes, out, first, count, each) {
  const n = count * each;
  if (bytes.length < n) throw new Error('a group of frames is too short');
  const base = first * each;
  for (let i = 0; i < n; ++i) out[base + i] = i < each ? bytes[i] : out[base + i - each] + unzigzag(bytes[i]);
}

/** A quantity over the frames, decoded group by group. One with fewer frames than the scene stands still afterwards. */
export class Series {
  /** @param {{groups: {first: number, count: number, block: number}[]}} description
   *  @param {number} each values in a frame
   *  @param {8|16} bits */
  constructor(description, each, bits) {
    this.groups = description.groups;
    this.each = each;
    this.bits = bits;
    const last = this.groups[this.groups.length - 1];
    this.frames = last ? last.first + last.count : 0;
    this.values = new (bits === 16 ? Uint16Array : Uint8Array)(this.frames * each);
    this.done = this.groups.map(() => false);
  }

  place(f) {
    return Math.max(0, this.groups.findLastIndex((g) => g.first <= f));
  }

  /** Whether a frame can be read, or the one that stands for it. */
  has(f) {
    return this.groups.length === 0 || this.done[this.place(f)];
  }

  get isWhole() {
    return this.done.every((d) => d);
  }

  /** Decodes the group of a frame. Groups do not need one another. */
  async decodeAt(f) {
    const at = this.place(f);
    if (this.groups.length === 0 || this.done[at]) return;
    const group = this.groups[at];
    const bytes = await readBlock(group.block);
    (this.bits === 16 ? undoSecondDifferences : undoFirstDifferences)(bytes, this.values, group.first, group.count, this.each);
    this.done[at] = true;
  }

  /** The values of a frame; those of the last one where there is none. */
  frame(f) {
    const k = Math.max(0, Math.min(f, this.frames - 1));
    return this.values.subarray(k * this.each, (k + 1) * this.each);
  }
}

/** The box of all positions. The scene is drawn around its centre, so that floats are precise. */
export class Box {
  constructor([low, high]) {
    this.low = low;
    this.high = high;
    this.size = low.map((x, k) => high[k] - x);
    this.radius = Math.max(Math.hypot(...this.size) / 2, 1e-30);
  }

  /** Writes coordinates around the centre, a share `mixing` of the way from `values` to `next`. */
  toScene(values, out, next = values, mixing = 0) {
    for (let k = 0; k < 3; ++k) {
      const size = this.size[k];
      for (let i = k; i < values.length; i += 3) out[i] = ((values[i] + (next[i] - values[i]) * mixing) / 65535 - 0.5) * size;
    }
    return out;
  }

  /** The middle, in the run's own coordinates. */
  get middle() {
    return this.low.map((x, k) => x + this.size[k] / 2);
  }

  /** The position in the run's own coordinates. */
  toRun(values, item) {
    return [0, 1, 2].map((k) => this.low[k] + (values[3 * item + k] / 65535) * this.size[k]);
  }
}
