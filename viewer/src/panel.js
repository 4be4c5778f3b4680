// The panel beside the stage: colours of particles, walls by patch, the view, the cutting plane, pictures and films.
import { Vector3 } from 'three';
import { button, checkbox, choice, element, numberField, slider } from './dom.js';
import { css, pageColours, patchColour, scaleGradient, shortLength, shortNumber } from './colours.js';
import { quantities } from './particles.js';
import { presets } from './stage.js';
import { hitModes, wallModes } from './walls.js';

function scaleLegend(name, low, high) {
  const bar = element('div', { class: 'bar' });
  bar.style.background = scaleGradient(name, pageColours());
  return element('div', { class: 'legend' }, bar, element('div', { class: 'ends' }, element('span', {}, low), element('span', {}, high)));
}

function swatch(colour) {
  const made = element('i', {});
  made.style.background = css(colour);
  return made;
}

export class Panel {
  /** @param viewer the parts; @param actions what buttons do: frame, savePicture, saveFilm, wholeScreen */
  constructor(viewer, actions) {
    Object.assign(this, { viewer, particles: viewer.particles, walls: viewer.walls, stage: viewer.stage, actions });
    this.legend = element('div', {});
    this.limits = element('div', {});
    this.patches = element('div', {});
    this.hits = element('div', {});
    const content = element('div', { class: 'drawer' }, ...this.particlePart(), ...this.wallPart(), ...this.viewPart(), ...this.cutPart(), ...this.filePart());
    this.element = element('div', { class: 'side' }, this.grip(), content);
    this.refresh();
  }

  /** On narrow screens the panel is a sheet: its grip opens and closes it, by a click or by pulling. */
  grip() {
    let from = null;
    const open = (on) => {
      this.element.classList.toggle('open', on);
      grip.setAttribute('aria-expanded', on);
    };
    const grip = button('Options', () => open(!this.element.classList.contains('open')), { class: 'grip', 'aria-expanded': 'false' });
    grip.addEventListener('pointerdown', (e) => {
      from = e.clientY;
      grip.setPointerCapture(e.pointerId); // the finger leaves the grip
    });
    grip.addEventListener('pointerup', (e) => {
      if (from !== null && Math.abs(e.clientY - from) > 24) {
        open(e.clientY < from);
        grip.addEventListener('click', (c) => c.stopImmediatePropagation(), { once: true, capture: true });
      }
      from = null;
    });
    return grip;
  }

  particlePart() {
    if (!this.particles) return [];
    const { particles } = this;
    this.quantity = choice('Colour by', quantities, 'speed', (name) => {
      particles.colourBy(name);
      this.changeParticles();
    });
    return [element('h2', {}, 'Particles'), element('label', {}, 'colour by', this.quantity), this.legend, this.limits,
      element('label', {}, 'size', this.sizeSlider()), checkbox('tails of all', false, (on) => { particles.hasTails = on; this.stage.draw(); })];
  }

  sizeSlider() {
    return slider('Size of the points', { min: -2, max: 2, step: 0.1, value: Math.log2(this.particles.scale) }, (v) => {
      this.particles.scale = 2 ** v;
      this.stage.draw();
    });
  }

  changeParticles() {
    this.particles.restyle();
    this.refresh();
    this.viewer.redraw();
  }

  /** Fields for the range of the colours and the values that are shown. */
  limitFields() {
    const { particles } = this;
    const { name, categories } = particles.colouredBy;
    if (categories) return [];
    const pair = (store, label, values) => element('div', { class: 'pair' }, label,
      ...[0, 1].map((k) => numberField(`${label} ${k === 0 ? 'from' : 'to'}`, Number.isFinite(values[k]) ? Number(values[k].toPrecision(4)) : '', (v) => {
        store[name] = [...(store[name] ?? [])];
        store[name][k] = v;
        this.changeParticles();
      })));
    return [element('details', {}, element('summary', {}, 'range'), pair(particles.ranges, 'colours', particles.range), pair(particles.thresholds, 'show', particles.threshold),
      checkbox('log scale', particles.isLog, (on) => { particles.isLog = on; this.changeParticles(); }))];
  }

  /** The ends of the scale in words. The usual speeds end below the greatest one. */
  rangeTexts() {
    const { particles } = this;
    const { unit } = particles.colouredBy;
    const [low, high] = particles.range;
    const isCut = particles.colouredBy.name === 'speed' && high < 0.999 * particles.speedMax;
    return [shortNumber(low), `${isCut ? '≥ ' : ''}${shortNumber(high)} ${unit}`.trim()];
  }

  wallPart() {
    if (this.walls.sets.length === 0) return [];
    const { walls } = this;
    const parts = [element('h2', {}, 'Walls'), this.patches];
    if (walls.hasHits) {
      parts.push(element('label', {}, 'colour by', choice('Colour walls by', hitModes, walls.byHits, (mode) => { walls.byHits = mode; this.changeWalls(); })), this.hits);
      this.hitLog = checkbox('log scale of hits', walls.isLog, (on) => { walls.isLog = on; this.changeWalls(); });
    }
    if (this.stage.dimension === 3) parts.push(checkbox('edges', false, (on) => { walls.wires = on; this.changeWalls(); }));
    return parts;
  }

  changeWalls() {
    this.walls.restyle();
    this.refresh();
    this.stage.draw();
  }

  viewPart() {
    const all = button('Show all (F)', () => this.actions.frame());
    if (this.stage.dimension === 2) return [element('h2', {}, 'View'), all];
    const from = choice('View from', [['', 'chosen'], ...presets.map((p) => [p, p])], '', (p) => this.stage.look(p));
    return [element('h2', {}, 'View'), element('label', {}, 'from', from, all)];
  }

  cutPart() {
    const isFlat = this.stage.dimension === 2;
    const axes = isFlat ? ['x', 'y'] : ['x', 'y', 'z'];
    const views = isFlat ? [] : [['view', 'across the view']];
    const { box } = this.stage;
    let direction = null;
    const change = () => {
      const share = Number(place.value) / 1000;
      this.stage.clip(direction, share);
      const k = axes.indexOf(axis.value);
      where.hidden = direction === null;
      where.textContent = direction === null ? '' : k < 0
        ? `${shortLength((share - 0.5) * 2 * box.radius)} from the middle`
        : `${axis.value} = ${shortLength(box.low[k] + share * box.size[k])}`;
      this.viewer.redraw();
    };
    const place = slider('Place of the cut', { min: 0, max: 1000, step: 1, value: 500 }, change);
    const where = element('output', { class: 'where', hidden: true });
    // The plane keeps its direction when the scene turns, so that one can look at the cut.
    const turn = () => {
      const k = axes.indexOf(axis.value);
      direction = axis.value === '' ? null : k < 0 ? this.stage.towardsViewer : new Vector3().setComponent(k, 1);
      place.disabled = direction === null;
      again.hidden = axis.value !== 'view';
      change();
    };
    const axis = choice('Cut', [['', 'none'], ...axes.map((a) => [a, `across ${a}`]), ...views], '', turn);
    const again = button('Cut across the present view', turn, { hidden: true });
    place.disabled = true;
    return [element('h2', {}, 'Cutting plane'), element('label', {}, 'cut', axis), place, where, again];
  }

  filePart() {
    const film = button('Film (WebM)', async () => {
      film.disabled = true;
      try {
        await this.actions.saveFilm((share) => { film.textContent = `${Math.round(100 * share)} %`; });
      } catch (error) {
        film.title = error.message;
      }
      film.textContent = 'Film (WebM)';
      film.disabled = false;
    });
    return [element('h2', {}, 'Take away'), element('p', { class: 'row' }, button('Picture (PNG)', () => this.actions.savePicture()), film,
      button('Full screen', () => this.actions.wholeScreen()))];
  }

  /** Legends and patches with the colours of the page as they are now. */
  refresh() {
    const page = pageColours();
    if (this.particles) {
      const q = this.particles.colouredBy;
      const wasOpen = this.limits.querySelector('details')?.open === true;
      this.legend.replaceChildren(q.categories
        ? element('div', { class: 'legend' }, ...q.categories.slice(0, 12).map((name, i) =>
          element('span', { class: 'entry' }, swatch(q.colour(i, page)), name)))
        : scaleLegend(q.name, ...this.rangeTexts()));
      this.limits.replaceChildren(...this.limitFields());
      if (wasOpen && this.limits.firstChild) this.limits.firstChild.open = true;
    }
    this.patches.replaceChildren(...this.walls.usedPatches().map((patch) => {
      const name = this.walls.patches[patch] || 'no patch';
      const mode = choice(`Wall ${name}`, wallModes.map((m) => [m, m]), this.walls.modes[patch], (value) => {
        this.walls.modes[patch] = value;
        this.changeWalls();
      });
      return element('div', { class: 'patch' }, swatch(patchColour(patch, page)), element('span', { title: name }, name), mode);
    }));
    const { byHits } = this.walls;
    if (!byHits) this.hits.replaceChildren();
    else {
      const [low, high] = this.walls.rangeOf(byHits);
      const unit = byHits === 'count' ? 'hits' : this.stage.dimension === 2 ? 'per m' : 'per m²';
      this.hits.replaceChildren(scaleLegend('hits', shortNumber(low), `${byHits === 'area' ? '≥ ' : ''}${shortNumber(high)} ${unit}`), this.hitLog);
    }
  }
}
